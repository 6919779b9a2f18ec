"""What single steps add to the books: violations of either sign, works of every node of a beam; uncompiled."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.contact.plain import names

N = names("loop.tally", "record.record")
IMPLICIT, LIMITS = names("loop.beam.implicit"), names("loop.limits")


@pytest.mark.parametrize(
    ("force", "gap", "violated"),
    [(3.0, -0.2, 0.2), (0.0, -0.2, 0.2), (3.0, 0.2, 0.12), (-3.0, 0.5, 0.12), (0.0, 0.2, 0.0)],
)
def test_a_law_is_violated_by_a_gap_or_a_force_of_the_wrong_sign_or_by_both_at_once(force, gap, violated):
    sums, out = N.tally(2), N.samples(N.Record(), 3, 2, 1)
    N.note_contact(sums, out, 1, 0.5, 4.0, force, gap, 0.04, 0.3, -0.1)
    assert sums.residual.tolist() == [0.0, pytest.approx(violated, rel=1e-15)]
    assert sums.penetration.tolist() == [0.0, max(-gap, 0.0)]
    assert sums.closed.tolist() == [0, int(force > 0.0)]


def test_contact_forces_of_every_node_work_by_the_trapezoid():
    rng, h, offset = np.random.default_rng(8), 0.3, 0.05
    x, new = rng.standard_normal((2, 4, 3))
    last, force = np.array([2.0, 0.0, 3.0]), np.array([5.0, 7.0, 0.0])
    s = SimpleNamespace(x=x, force=force, last=last, offset=offset, ledger=np.array([0.5, 0.25, 0.0]))
    sums = N.tally(3)
    sums.work[:] = 1.0
    IMPLICIT.contact_work(s, sums, new, h)
    works, moment = np.ones(3), 0.25
    for at, size in ((x, last), (new, force)):
        for i in range(3):
            out = at[i + 1, :2] - [offset, 0.0]
            push = -size[i] * out / math.hypot(*out)
            works[i] += 0.5 * push @ (new - x)[i + 1, :2]
            moment += 0.5 * h * (at[i + 1, 0] * push[1] - at[i + 1, 1] * push[0])
    np.testing.assert_allclose(sums.work, works, rtol=1e-13)
    np.testing.assert_allclose(s.ledger, [0.5, moment, 0.0], rtol=1e-13)


def test_a_tip_s_farthest_motion_is_kept_whichever_way_it_goes():
    limits = np.array([2.0, 1.0, 0.0, 0.0])
    for moved, farthest in ((-0.5, 0.5), (0.25, 0.5), (0.75, 0.75), (-1.0, 1.0), (0.5, 1.0)):
        LIMITS.tip_motion(limits, moved)
        assert limits[LIMITS.REACHED + LIMITS.TIP] == farthest
    assert not LIMITS.outgrown(limits)  # as far as it may
    LIMITS.tip_motion(limits, -1.25)
    assert LIMITS.outgrown(limits)
    assert limits.tolist() == [2.0, 1.0, 0.0, 1.25]
