"""Tips of a rub that close one at a time take the closed form, others the solver; far ones are not looked at."""

import numpy as np
import pytest

from tests.contact.plain import plain

H, STEPS = 2e-5, 12


def prepared(module, angles, *, clearance, mu, axial=False):
    ct, made = module("contact"), module("tests.contact.synthetic_rub")
    tips = [tip for angle in angles for tip in made.tips(1, angle=angle, axial=axial)]
    what = ct.Rub(made.rim3(), (made.nodes(1),), tips, clearance=clearance, speed=ct.Speed(time=[0.0], hz=[3.0]))
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    return ct.ExactModal().prepare(what, law, dt=H, courant=None)


@pytest.mark.parametrize(("mu", "axial", "iterates"), [(0.2, False, False), (0.0, False, False), (0.2, True, True)])
def test_one_tip_with_one_direction_of_slip_needs_no_iterations(mu, axial, iterates):
    with plain() as module:
        run = prepared(module, [10.0], clearance=-2e-5, mu=mu, axial=axial)
        record = module("contact.record.record")
        out = record.samples(record.Record(), STEPS, 1, run.state.seen.size)
        assert run.advance(out, 0, STEPS) == -1
    most, total, steps, fault = run.state.counts
    assert steps > 3
    assert fault == 0.0
    assert (most > 0.0, total >= most) == (iterates, True)
    assert run.sums.contact_steps.max() > 3


def test_tips_that_are_far_are_marked_so_with_a_bound_of_their_gap():
    with plain() as module:
        run = prepared(module, [10.0, 80.0], clearance=3e-3, mu=0.2)
        s, record = run.state, module("contact.record.record")
        out = record.samples(record.Record(every=50), STEPS, 2, s.seen.size)
        s.d[:] = 1e-8
        assert run.advance(out, 1, STEPS) == -1
    assert s.inside.tolist() == [0, 0]
    assert (s.gap > 1e-3).all()
    assert (s.gap <= 3e-3 + 1e-12).all()
    assert not s.known.any()
    assert not s.counts.any()


@pytest.mark.parametrize(("count", "mu", "used"), [(1, 0.2, False), (2, 0.2, True), (2, 0.0, False)])
def test_a_start_for_sliding_tips_is_there_for_several_with_friction(count, mu, used):
    with plain() as module:
        run = prepared(module, [10.0, 80.0][:count], clearance=1e-3, mu=mu)
        work = module("contact.loop.rub.state").work_space(run.state, run.arrays.rows)
    assert work.all_sliding.used == used
    assert np.array_equal(work.S_at, np.full(work.S_at.size, -2))
