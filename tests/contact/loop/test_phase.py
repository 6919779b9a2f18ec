"""Passage through one phase: where what is watched turns or is zero, against closed forms."""

import numpy as np
import pytest

from contact.loop.phase import PhaseArrays, root, turn


@pytest.mark.slow
@pytest.mark.parametrize("rate", [-200.0, 200.0])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_turn_is_found_where_one_end_is_far_steeper_than_the_other(rate, sense):
    """exp(rate t) - sign(rate) t turns at -ln|rate|/rate; its slopes at both ends are as 1 to 200 and more."""
    phase = PhaseArrays(
        lam=np.array([[rate, 0.0], [0.0, 0.0]]), beta=np.array([[0.0, 1.0], [0.0, 0.0]]),
        rows=np.array([[[sense, -sense * np.sign(rate)]], [[0.0, 0.0]]]), rest=np.zeros(1),
        wave=np.zeros((2, 1, 0)), harmonic=np.zeros(0),
    )  # fmt: skip
    begin = np.array([[1.0, 0.0], [0.0, 0.0]])
    low, high = (0.0, 1.0) if rate < 0.0 else (-1.0, 0.0)
    assert turn(phase, begin, 0, 0.0, low, high, sense) == pytest.approx(-np.log(abs(rate)) / rate, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("gap", [0.125, 0.3, 0.375, 0.7, 0.96875])
def test_an_event_that_newton_s_method_meets_to_the_last_bit_is_where_it_is(gap):
    """A gap that closes at 1 m/s: the first step is exact, and what is left is no reason to look elsewhere."""
    phase = PhaseArrays(
        lam=np.zeros((2, 1)), beta=np.array([[-1.0], [0.0]]), rows=np.array([[[1.0]], [[0.0]]]), rest=np.zeros(1),
        wave=np.zeros((2, 1, 0)), harmonic=np.zeros(0),
    )  # fmt: skip
    assert root(phase, np.array([[gap], [0.0]]), 0, 0.0, 0.0, 1.0) == pytest.approx(gap, abs=1e-15)
