"""What a run notes of how far a tip has moved."""

import numpy as np
import pytest

from contact.jit.compiled import jit
from contact.loop.limits import outgrown, tip_motion
from contact.model.gaps.limits import REACHED, RIM, TIP, motion_limits


@jit
def noted(limits, motions):
    """How many of the motions are within the limits."""
    for k in range(motions.size):
        tip_motion(limits, motions[k])
        if outgrown(limits):
            return k
    return motions.size


@pytest.mark.parametrize(
    ("motions", "within", "reached"),
    [([0.01, -0.03, 0.02], 3, 0.03), ([0.05, 0.0], 2, 0.05), ([0.01, -0.06, 0.2], 1, 0.06)],
    ids=["within", "at the limit", "beyond"],
)
def test_the_largest_motion_is_kept_either_way_and_what_was_allowed_stays(motions, within, reached):
    limits = motion_limits(0.5, 3e-3)
    assert noted(limits, np.array(motions)) == within
    assert limits[REACHED + TIP] == reached
    assert limits[[RIM, TIP, REACHED + RIM]].tolist() == [1.5e-3, 0.05, 0.0]
