"""One step of a fit of set-ups, against the equations of all unknowns at once; how far steps may go."""

import numpy as np
import pytest

from casingfem.experiment.identify.setups import own_shifts
from casingfem.experiment.identify.setups.inner_products import Problem
from casingfem.experiment.identify.setups.own_shifts import _At, apart, linked, near_each_other
from tests.casingfem.experiment.identify.setups.test_inner_products import FREQ, SETUPS, truth

SPAN = 92.0, 110.0
START = np.array([0.021, 0.027])


def blocks(data, freq, zeta):
    """Normal equations of each set-up with raised diagonals, and gradients."""
    at = _At.of(Problem.of(data, SETUPS), np.log(freq), np.repeat(np.log(zeta)[:, None], 3, axis=1))
    size = np.array([np.diag(normal) for normal in at.normal])
    extra = 1e-3 * size + 1e-12 * size.max(axis=1, keepdims=True)
    return [normal + np.diag(more) for normal, more in zip(at.normal, extra, strict=True)], at.gradient


@pytest.mark.parametrize("off", [1.0005, 1.04])
@pytest.mark.parametrize("fit", [apart, linked])
def test_a_step_is_that_of_all_equations_within_a_half_bandwidth_and_the_span(monkeypatch, off, fit):
    monkeypatch.setattr(own_shifts, "STEPS", 1)
    _, data = truth()
    freq = np.clip(FREQ * off, *SPAN)
    normal, gradient = blocks(data, freq, START)
    if fit is apart:
        steps = np.array([-np.linalg.solve(one, right) for one, right in zip(normal, gradient, strict=True)])
        by_freq, by_zeta = steps[:, :2].T, steps[:, 2:].T
    else:
        whole, right = np.zeros((8, 8)), np.zeros(8)
        for k in range(3):
            here = [2 * k, 2 * k + 1, 6, 7]
            whole[np.ix_(here, here)] += normal[k]
            right[here] += gradient[k]
        step = -np.linalg.solve(whole, right)
        by_freq, by_zeta = step[:6].reshape(3, 2).T, np.repeat(step[6:, None], 3, axis=1)
    own = fit(data, SETUPS, freq, START, 1e-6, SPAN)
    p = np.clip(np.log(freq) + np.clip(by_freq, -START[:, None], START[:, None]), *np.log(SPAN))
    q = np.log(START)[:, None] + np.clip(by_zeta, -0.7, 0.7)
    better = ~np.isclose(own.freq, freq, rtol=1e-12).all(axis=0)  # a step that gains nothing is not made
    np.testing.assert_allclose(np.log(own.freq[:, better]), p[:, better], rtol=1e-9)
    np.testing.assert_allclose(np.log(own.zeta[:, better]), q[:, better], rtol=1e-7)
    assert better.any()
    if off > 1.01:
        assert np.abs(by_freq).max() > START.min()


def test_peaks_stay_within_the_span_and_damping_below_three_tenths():
    _, data = truth()
    start = np.array([[99.0] * 3, FREQ[1]])
    for fit in (apart, linked):
        own = fit(data, SETUPS, start, START, 1e-6, (98.5, 110.0))
        np.testing.assert_allclose(own.freq[0], 98.5, rtol=1e-12)  # 97 lies beyond
        damped = fit(data, SETUPS, FREQ[:1], np.array([0.3]), 1e-6, (91.0, 91.1))
        assert damped.zeta.max() <= 0.3 * (1.0 + 1e-12)


def test_modes_that_coincide_share_their_residues():
    modes, data = truth()
    twice = np.vstack([FREQ, FREQ[:1]])
    own = linked(data, SETUPS, twice, np.append(modes.zeta, modes.zeta[0]), 1e-6, SPAN)
    assert np.isfinite(own.residues).all()
    assert own.squares < 1e-6 * np.sum(data.Y**2)


def test_frequencies_of_a_mode_are_moved_to_within_a_distance_of_their_median():
    p = np.array([[1.0, 1.5, 3.0], [5.0, 5.1, 4.0]])
    assert near_each_other(p, 0.75).tolist() == [[1.0, 1.5, 2.25], [5.0, 5.1, 4.25]]
    assert near_each_other(p, np.inf) is p
    held = linked(truth()[1], SETUPS, FREQ, START, 1e-6, SPAN, 1e-4).freq
    middle = np.median(np.log(held), axis=1, keepdims=True)
    assert np.abs(np.log(held) - middle).max() <= 1e-4 * (1.0 + 1e-9)
