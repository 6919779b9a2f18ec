"""Counts that round-off outweighs: said so, never an error, whatever BLAS sums; counts that hold still find a miss."""

import numpy as np
import pytest
from scipy.sparse import block_diag, csc_array

import casingfem as cf
from casingfem.linalg.eigen import gap_after, solve_band, solve_modes
from casingfem.linalg.pencil import UNIT, Pencil, clear_of_eigenvalues, make_pencil, round_off, warn_of_count
from casingfem.modal import fourier

SOFT = np.arange(1.0, 21.0)
DROWNED = "round-off moves the next by .*modes-round-off"


def stiff(largest, hidden=20):
    """K with eigenvalues SOFT and others near `largest` in a random basis, M = 1: round-off of these moves those."""
    rng = np.random.default_rng(5)
    values = np.r_[SOFT, largest * rng.uniform(0.5, 1.0, hidden)]
    Q, _ = np.linalg.qr(rng.standard_normal((len(values), len(values))))
    K = (Q * values) @ Q.T
    return csc_array(0.5 * (K + K.T)), np.ones(len(values))


def miscounting(by):
    """`Pencil.count_below` that is wrong by so many."""
    right = Pencil.count_below
    return lambda *arguments: right(*arguments) + by


def test_round_off_bounds_what_a_change_of_the_last_bits_does_to_eigenvalues():
    K, mass = stiff(1e8)
    K = make_pencil(K, mass).A.toarray()
    values, vectors = np.linalg.eigh(K)
    noise = round_off(K, vectors)
    rng = np.random.default_rng(8)
    for _ in range(20):
        change = np.triu(rng.choice([-UNIT, UNIT], K.shape))
        moved = np.einsum("ij,ik,kj->j", vectors, K * (change + np.triu(change, 1).T), vectors)
        assert np.all(np.abs(moved) <= noise)
    signs = np.outer(np.sign(vectors[:, 3]), np.sign(vectors[:, 3])) * np.sign(K) * UNIT
    assert vectors[:, 3] @ (K * signs) @ vectors[:, 3] == pytest.approx(noise[3], rel=1e-12)
    assert clear_of_eigenvalues(values[3] - 1.01 * noise[3], values[3:], noise[3:])
    assert not clear_of_eigenvalues(values[3] - 0.99 * noise[3], values[3:], noise[3:])


@pytest.mark.parametrize("by", [-1, 0, 1])
def test_modes_that_round_off_drowns_are_not_counted_and_no_error(monkeypatch, by):
    monkeypatch.setattr(Pencil, "count_below", miscounting(by))
    with pytest.warns(cf.errors.ModelWarning, match=DROWNED):
        found = solve_modes(*stiff(1e18), 4, shift=-1e-2)
    assert found.sturm_count is None
    assert len(found.eigenvalues) >= 4


@pytest.mark.parametrize("by", [-1, 0, 1])
@pytest.mark.parametrize("band", [(0.0, 10.5), (3.5, 10.5)])
def test_a_band_that_round_off_drowns_is_not_counted_and_no_error(monkeypatch, by, band):
    monkeypatch.setattr(Pencil, "count_below", miscounting(by))
    with pytest.warns(cf.errors.ModelWarning, match=DROWNED):
        found = solve_band(*stiff(3e15), band, shift=-1e-2)
    assert found.sturm_count is None


def test_the_warning_names_the_upper_end_where_round_off_reaches_both():
    with pytest.warns(cf.errors.ModelWarning, match=r"those below 0\.5157 Hz cannot be counted"):
        solve_band(*stiff(3e15), (3.5, 10.5), shift=-1e-2)


def test_the_warning_says_how_far_the_nearest_mode_moves():
    values = (2 * np.pi * np.array([1.0, 9.9, 12.0])) ** 2
    noise = (2 * np.pi) ** 2 * (np.array([10.1, 10.5, 11.0]) ** 2 - 10.0**2)
    with pytest.warns(
        cf.errors.ModelWarning, match=r"those below 10 Hz cannot be counted, round-off moves the next by 0\.5 Hz"
    ):
        warn_of_count((2 * np.pi * 10.0) ** 2, values, noise)


def beside_stiff(largest):
    """What round-off of `stiff` drowns up to 20, and, apart from it, what it leaves alone from 98 on."""
    K = block_diag([stiff(largest)[0], np.diag(np.arange(98.0, 110.0))], format="csc")
    return csc_array(K), np.ones(K.shape[0])


def test_round_off_at_the_lower_end_alone_leaves_a_band_uncounted():
    with pytest.warns(cf.errors.ModelWarning, match=r"those below 0\.2978 Hz cannot be counted"):
        found = solve_band(*beside_stiff(3e15), (3.5, 100.5), shift=-1e-2)
    assert found.sturm_count is None


def test_round_off_that_reaches_below_zero_leaves_a_band_from_zero_counted():
    K, mass = beside_stiff(6e15)
    values, vectors = np.linalg.eigh(K.toarray())
    assert np.any(round_off(K, vectors) > values + 1e-2)
    assert solve_band(K, mass, (0.0, 100.5), shift=-1e-2).sturm_count == 23


def test_what_stands_clear_of_round_off_is_counted():
    K, mass = stiff(1e8)
    assert solve_modes(K, mass, 4, shift=-1e-2).sturm_count == 4
    assert solve_band(K, mass, (3.5, 10.5), shift=-1e-2).sturm_count == 7


@pytest.mark.parametrize("by", [-1, 1])
def test_a_wrong_count_clear_of_round_off_is_an_error(monkeypatch, by):
    K, mass = stiff(1e8)
    monkeypatch.setattr(Pencil, "count_below", miscounting(by))
    with pytest.raises(cf.errors.NumericsError, match=f"{4 + by} modes lie below"):
        solve_modes(K, mass, 4, shift=-1e-2)


def test_the_gap_after_a_count_is_one_wider_than_round_off_if_there_is_one():
    values = np.array([1.0, 1.001, 1.5, 1.6, 1.601])
    assert gap_after(values, 1) == (1, pytest.approx(1.0005))
    assert gap_after(values, 1, noise=0.1) == (2, pytest.approx(1.2505))
    assert gap_after(values, 1, noise=0.3) == (1, pytest.approx(1.0005))


@pytest.fixture(scope="module")
def foil(frustum):
    """So thin that round-off reaches its modes, and its first two."""
    shell = frustum(thickness=3e-5)
    return shell, cf.modes(shell, 2)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*shell-thin")
@pytest.mark.parametrize("by", [pytest.param(-1, marks=pytest.mark.campaign), 0, 1])
def test_a_harmonic_with_a_mode_on_the_end_of_a_band_is_not_counted_where_round_off_reaches_it(
    monkeypatch, foil, by
):  # fmt: skip
    shell, first = foil
    right, n = fourier.inertia_below, first.nodal_diameters[0]

    def wrong(meridian, sigma):
        return max(0, right(meridian, sigma) + by * (meridian.n == n and sigma > 0.3 * first.omega[0] ** 2))

    monkeypatch.setattr(fourier, "inertia_below", wrong)
    with pytest.warns(cf.errors.ModelWarning, match=DROWNED):
        found = cf.modes(shell, band=(0.5 * first.freq[0], first.freq[0]))
    assert found.sturm_count is None


@pytest.mark.parametrize("wanted", [{"count": 6}, {"band": (300.0, 400.0)}])
def test_a_wrong_inertia_of_a_harmonic_clear_of_round_off_is_an_error(monkeypatch, frustum, wanted):
    right = fourier.inertia_below
    monkeypatch.setattr(fourier, "inertia_below", lambda meridian, sigma: right(meridian, sigma) + (sigma > 5e6))
    with pytest.raises(cf.errors.NumericsError, match="were found"):
        cf.modes(frustum(), **wanted)
