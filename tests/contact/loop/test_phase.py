"""Passage through one phase: where what is watched turns, against closed forms."""

import numpy as np
import pytest

from contact.loop.phase import PhaseArrays, turn


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
