"""Two of many changes: found where the one that explains most alone is neither; what unknown couplings add."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.locate.misfit import Point, half_split, mixing, widened
from casingfem.locate.sparse_search import Bounds, best_addition, best_pair, fitted, search
from casingfem.modal.harmonics import Rings

BOUNDS = Bounds(lower=-np.ones(6), upper=np.zeros(6))


def between(truth):
    """Residuals J (x - truth); column 2 is nearly the sum of columns 0 and 1, and so explains most alone."""
    J = np.random.default_rng(4).standard_normal((20, 6))
    J[:, 2] = J[:, 0] + J[:, 1] + 0.1 * J[:, 2]

    def evaluate(x):
        left = 30.0 * J @ (x - truth)
        return Point(x, None, left, 30.0 * J, float(left @ left))

    return evaluate


def test_a_pair_is_found_though_a_third_place_explains_more_alone():
    truth = np.array([-0.7, -0.7, 0.0, 0.0, 0.0, 0.0])
    evaluate = between(truth)
    none = evaluate(np.zeros(6))
    first, one = best_addition(evaluate, none, [], BOUNDS)
    assert first == 2
    assert best_addition(evaluate, one, [2], BOUNDS)[1].chi2 > 1.0
    pair, at = best_pair(evaluate, none, BOUNDS)
    assert pair == [0, 1]
    np.testing.assert_allclose(at.x, truth, atol=1e-9)
    assert search(evaluate, BOUNDS, most=3, level=0.01)[0] == [0, 1]


def test_the_dozen_pairs_that_promise_most_are_refitted(monkeypatch):
    """Of fifteen; where r is linear and no bound near, a promise is what least squares leave."""
    evaluate, wide, asked = between(np.array([-0.6, 0.2, 0.1, -0.3, 0.5, -0.1])), np.full(6, 100.0), []

    def told(evaluate, start, active, bounds):
        asked.append((np.flatnonzero(start.x).tolist(), list(active)))
        return fitted(evaluate, start, active, bounds)

    monkeypatch.setitem(best_pair.__globals__, "fitted", told)
    none = evaluate(np.zeros(6))
    pair, at = best_pair(evaluate, none, Bounds(lower=-wide, upper=wide))
    assert asked[:6] == [([], [c]) for c in range(6)]
    J = none.jacobian

    def left(on):
        return np.sum((none.values + J[:, on] @ np.linalg.lstsq(J[:, on], -none.values, rcond=None)[0]) ** 2)

    ranked = sorted(([a, b] for a in range(6) for b in range(a + 1, 6)), key=left)
    assert [active for _, active in asked[6:]] == ranked[:12]
    assert all(len(start) == 1 and start[0] in active for start, active in asked[6:])
    assert pair == ranked[0]
    assert at.chi2 == pytest.approx(left(pair), rel=1e-9)


def test_a_fit_stays_within_its_bounds():
    evaluate = between(np.array([-1.4, 0.3, 0.0, 0.0, 0.0, 0.0]))
    at = fitted(evaluate, evaluate(np.zeros(6)), [0, 1], BOUNDS)
    assert at.x[0] == pytest.approx(-1.0)
    assert at.x[1] == pytest.approx(0.0, abs=1e-9)


def test_unknown_couplings_scatter_mixed_modes_by_what_is_said():
    """Two pairs and two single modes, turned at random; 4,000 symmetric W without parts within pairs."""
    rng, c = np.random.default_rng(12), 1e-3
    y = np.eye(6)
    y[:5, :5], _ = np.linalg.qr(rng.standard_normal((5, 5)))
    tight = SimpleNamespace(coordinates=np.eye(6), doublets=((0, 1), (2, 3)))
    said = mixing(SimpleNamespace(M=np.eye(6)), tight, SimpleNamespace(coordinates=y))
    W = np.sqrt(2.0) * c * rng.standard_normal((4000, 6, 6))  # of omega^2, relative: 2 c in a pair's (cos, sin) plane
    W = np.triu(W, 1)
    W[:, 0, 1] = W[:, 2, 3] = 0.0
    W = W + W.transpose(0, 2, 1)
    scatter = 0.5 * np.einsum("ki,wkl,li->wi", y, W, y, optimize=True).std(axis=0)
    np.testing.assert_allclose(scatter, c * said, rtol=0.05, atol=1e-12)
    basis = rng.standard_normal((6, 6))  # no orthonormal one
    tight, found = (SimpleNamespace(coordinates=basis @ a, doublets=tight.doublets) for a in (np.eye(6), y))
    back = np.linalg.inv(basis)
    np.testing.assert_allclose(mixing(SimpleNamespace(M=back.T @ back), tight, found), said, rtol=1e-9, atol=1e-6)
    assert said[5] == 0.0
    assert said.max() > 0.7


def test_unknown_couplings_widen_the_rows_of_modes_that_mix():
    """Modes 3 and 4 mix half and half, so do 2 and 5, mode 1 stays alone; row 5 is beyond the reach of its mode."""
    amplitudes = np.zeros((6, 1, 3, 5), dtype=complex)
    amplitudes[np.arange(1, 6), 0, 0, np.arange(5)] = 1.0
    y, half = np.eye(5), np.sqrt(0.5)
    for pair in ([2, 3], [1, 4]):
        y[np.ix_(pair, pair)] = [[half, -half], [half, half]]
    rings = Rings(amplitudes=amplitudes, weights=np.ones(1))
    found = SimpleNamespace(freq=np.array([50.0, 100.0, 150.0, 200.0, 450.0]), rigid=0, rings=rings, coordinates=y)
    freq, sigma = np.array([50.0, 101.0, 151.0, 199.0, 400.0]), np.array([0.1, 0.2, 0.3, 0.4, 0.5])
    table = cf.FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=sigma, n=[1, 2, 3, 4, 5])
    tight = SimpleNamespace(coordinates=np.eye(5), doublets=())
    wider = widened(table, SimpleNamespace(M=np.eye(5)), tight, found, 2e-3, 0.1)
    share = np.array([0.0, half, half, half, 0.0])  # of p = 1/2, 1/2
    np.testing.assert_allclose(wider.sigma_hz, np.hypot(sigma, 2e-3 * share * freq), rtol=1e-12)
    np.testing.assert_array_equal(wider.freq_hz, freq)


@pytest.mark.parametrize(
    ("angles", "freq", "half"),
    [
        ((np.nan, np.nan), (100.0, 104.0), 0.0),
        ((0.0, 30.0), (100.0, 104.0), 0.0),
        ((30.0, 0.0), (100.0, 104.0), 0.25 * 2.0 * (104.0**2 - 100.0**2) / (0.5 * (104.0**2 + 100.0**2))),
        ((np.nan, np.nan), (100.0, 106.0), 0.25 * (106.0**2 - 104.0**2) / (0.5 * (106.0**2 + 100.0**2))),
    ],
)
def test_half_the_split_that_manufacture_makes_is_what_the_design_leaves(angles, freq, half):
    """A pair n = 3 that the design splits to 100 and 104 Hz, antinodes at 0 and 30 deg; another n without a partner."""
    amplitudes = np.zeros((4, 1, 3, 3), complex)
    amplitudes[3, 0, 0, :2] = 1.0, -1j
    found = SimpleNamespace(
        omega=2.0 * np.pi * np.array([100.0, 104.0, 200.0]), doublets=((0, 1),), nodal_diameters=np.array([3, 3, 0]),
        doublet_of=lambda mode: 0 if mode < 2 else -1, rings=SimpleNamespace(amplitudes=amplitudes),
    )  # fmt: skip
    table = cf.FrequencyTable.from_arrays(
        freq_hz=[*freq, 300.0], sigma_hz=0.1, n=[3, 3, 0], angle_deg=[*angles, np.nan]
    )
    single = SimpleNamespace(rows=(2,), modes=(2,))
    assert half_split(found, table, [SimpleNamespace(rows=(0, 1), modes=(0, 1)), single]) == pytest.approx(half)
    assert half_split(found, table, [single]) == 0.0
