"""Shapes round a circle tell which mode of a set-up is which of the others."""

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.around import Around, Places
from casingfem.experiment.identify.setups.grouping import _told, matched, matching_sigma
from casingfem.experiment.identify.setups.own_shifts import OwnPeaks, linked

SETUPS = [np.arange(0, 4), np.arange(4, 8), np.arange(8, 12)]
THETA = np.radians(15.0 * np.arange(12) + np.array([1, -3, 2, 0, 3, -2, 1, 2, -1, 0, 3, -2]))
SPOILT = 2, 9  # dead; turned over


def shapes(n, turn):
    return np.cos(np.multiply.outer(np.atleast_1d(n), THETA) - np.atleast_1d(turn)[:, None])


def spoil(residues):
    residues = residues.copy()
    residues[:, SPOILT[0]] = 0.0
    residues[:, SPOILT[1]] *= -1.0
    return residues


@pytest.fixture(scope="module")
def around():
    rng = np.random.default_rng(3)
    residues = spoil(shapes(rng.integers(2, 10, 20), rng.uniform(0.0, 6.0, 20))).astype(complex)
    residues += 0.02 * (rng.standard_normal(residues.shape) + 1j * rng.standard_normal(residues.shape))
    places = Places(THETA, np.ones(12), np.zeros(12, int), tuple(range(12)))
    return Around.of(places, residues * rng.uniform(0.1, 10.0, 20)[:, None], np.ones(12))


def pair(gap, setup_exchanged):
    """Two of n = 5, a quarter wave apart, alike in damping and size; in one set-up as far apart the other way."""
    logs = np.array([[0.0, 2e-4, 1e-4], [gap, gap, gap]])
    own = spoil(shapes([5, 5], [0.3, 0.3 + np.pi / 2])).astype(complex)
    tiny = np.full((2, 3), 1e-12)
    right = OwnPeaks(400.0 * np.exp(logs), np.full((2, 3), 2e-3), tiny, tiny, own, 0.0)
    order = [np.array([1, 0]) if k == setup_exchanged else np.array([0, 1]) for k in range(3)]
    return right, right.ordered(order, SETUPS)


def test_channels_that_belong_elsewhere_weigh_little(around):
    good = np.setdiff1d(np.arange(12), SPOILT)
    assert around.scale[list(SPOILT)].max() < 0.2 * around.scale[good].min()


@pytest.mark.parametrize("setup", [0, 1, 2])
def test_an_exchange_in_one_set_up_is_undone(around, setup):
    right, wrong = pair(5e-4, setup)
    found = matched(wrong, SETUPS, 1e-3, around)
    first = int(np.argmin(np.abs(found.freq[:, 0] - right.freq[0, 0])))
    np.testing.assert_allclose(found.freq[[first, 1 - first]], right.freq, rtol=1e-12)
    assert matching_sigma(found, SETUPS, 1e-3, around)[0].max() < 1e-6
    assert matching_sigma(found, SETUPS, 1e-3)[0].max() > 1e-5  # their frequencies alone do not tell


def test_shapes_of_modes_that_meet_in_a_set_up_tell_nothing(around):
    """Their residues there are mixed: what they look like does not make the matching sure."""
    right, _ = pair(5e-4, 0)  # 5e-4, 3e-4 and 4e-4 apart
    for sigma, told in ((1e-3, 0.0), (1e-7, 1.0), (3e-4 * 0.1 / np.sqrt(2.0), 0.5)):
        vague = right._replace(variance=np.full((2, 3), sigma**2))
        np.testing.assert_allclose(_told(vague, 1), told, atol=2e-3)


def window(responses, lines):
    data = np.concatenate([responses.real, responses.imag])
    return Window(
        freq=lines,
        Y=data,
        power=0,
        residues="real",
        weight=np.ones(data.shape[1]),
        floor=0.0,
        along=np.ones(len(lines)),
    )


def test_a_set_up_that_hardly_sees_a_mode_keeps_it_near_the_others():
    """Without the limit its peak goes to a stray one beyond."""
    rng = np.random.default_rng(5)
    lines = np.arange(95.0, 106.0, 0.05)

    def peak(at):
        return at**2 / (at**2 - lines**2 + 2j * 0.004 * at * lines)

    seen, stray = peak(100.0), 0.05 * peak(103.0)
    responses = np.column_stack([seen, seen * 0.8, stray]) + 1e-3 * rng.standard_normal((len(lines), 3))
    setups, start = [np.array([k]) for k in range(3)], np.full((1, 3), 100.5)
    given = window(responses, lines), setups, start, np.array([0.004]), 1e-6, (97.0, 105.0)
    assert abs(linked(*given).freq[0, 2] - 103.0) < 0.05
    kept = linked(*given, 5e-3).freq[0]
    np.testing.assert_allclose(kept[:2], 100.0, atol=2e-3)
    assert kept[2] <= 100.0 * np.exp(5e-3) * (1.0 + 1e-6)


def test_residues_do_not_grow_against_each_other_where_they_are_held():
    """The difference of two peaks that nearly meet has residues of 5 and -5; few are as likely where 0.1 is usual."""
    lines = np.arange(95.0, 105.0, 0.05)

    def peak(at):
        return at**2 / (at**2 - lines**2 + 2j * 0.004 * at * lines)

    freq = np.array([[100.0], [100.05]])
    given = window(5.0 * (peak(100.0) - peak(100.05))[:, None], lines), [np.array([0])], freq, np.full(2, 4e-3), 1.0
    free = linked(*given, (97.0, 103.0)).residues
    np.testing.assert_allclose(free[:, 0], [5.0, -5.0], rtol=1e-3)
    held = linked(*given, (97.0, 103.0), np.inf, np.full(2, 1.0 / 0.1**2)).residues
    assert np.abs(held).max() < 1.0
