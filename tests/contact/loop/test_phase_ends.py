"""Extremes and dips in the first and the last step of a phase, where there are no three looks; uncompiled."""

import numpy as np
import pytest

from tests.contact.plain import names

N = names("loop.phase")
OMEGA, FADE = 3.0, -0.2


def phase(rest):
    """Two watched values of one mode, Re row e^(lam t) + rest: a contact's and another."""
    zero = np.zeros((2, 1))
    return N.PhaseArrays(
        lam=np.array([[FADE], [OMEGA]]), beta=zero, rows=np.array([[[1.0], [0.4]], [[0.0], [-0.7]]]),
        rest=np.array(rest), wave=np.zeros((2, 2, 1)), harmonic=np.ones(1),
    )  # fmt: skip


def value(row, t, rest):
    return rest[row] + np.real([1.0, 0.4 - 0.7j][row] * np.exp((FADE + 1j * OMEGA) * np.asarray(t)))


def passed(rest, end, longest, contacts):
    p = phase(rest)
    w = N.phase_work(p)
    w.y[:] = [[1.0], [0.0]]
    w.most[:], w.least[:] = -1e9, 1e9
    return N.pass_phase(p, w, contacts, 0.0, end, longest), w


@pytest.mark.parametrize("longest", [0.35, 0.6, 9.0])
def test_extremes_in_any_step_are_found(longest):
    """Steps are shorter than half a vibration: a value turns once at most in one."""
    rest = [5.0, 5.0]
    for end in np.linspace(0.3, 1.9, 17):
        hit, w = passed(rest, end, min(longest, 1.0), 2)
        assert (hit, w.at[0]) == (-1, end)
        for row in (0, 1):
            seen = value(row, np.linspace(0.0, end, 4001), rest)
            assert w.most[row] == pytest.approx(seen.max(), abs=2e-6)
            assert w.least[row] == pytest.approx(seen.min(), abs=2e-6)


@pytest.mark.parametrize("after", [0.02, 0.1, 0.2])
@pytest.mark.parametrize("longest", [0.3, 0.45, 1.5])
def test_a_dip_in_the_last_step_is_an_event(after, longest):
    """The first gap is least at t = (pi - atan(.2/3))/3."""
    turn = (np.pi - np.arctan(-FADE / OMEGA)) / OMEGA
    lowest = value(0, turn, [0.0, 0.0])
    for depth in (1e-6, -1e-6):
        rest = [-lowest - depth, 9.0]
        hit, w = passed(rest, turn + after, longest, 1)
        assert hit == (0 if depth > 0.0 else -1)
        if depth > 0.0:
            assert w.at[0] == pytest.approx(turn - np.sqrt(2.0 * depth / -lowest) / OMEGA, abs=2e-5)
            assert value(0, w.at[0], rest) == pytest.approx(0.0, abs=1e-13)
