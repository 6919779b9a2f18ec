"""Runs end in the step after which a tip, a rim or a gap has moved further than it may; uncompiled."""

import numpy as np
import pytest

from tests.contact.plain import plain

H = 2e-5


def prepared(module, kind):
    ct = module("contact")
    rims, rubs = module("tests.contact.synthetic_rim"), module("tests.contact.synthetic_rub")
    waves = [{"p": 2, "cos": 2e-5}]
    if kind == "rim":
        what = ct.RotatingRim(
            rims.ring(S=4e-7), rims.blade(S=1e-6), clearance=-1.85e-5, speed_hz=20.0, lean_deg=25.0,
            out_of_roundness=waves,
        )  # fmt: skip
    elif kind == "rub":
        what = ct.Rub(
            rubs.rim3(), (rubs.nodes(1),), rubs.tips(1, angle=0.0), clearance=-1.85e-5, speed=ct.Speed.constant(20.0),
            profile=ct.RimProfile.fourier(waves),
        )  # fmt: skip
    else:
        body = ct.ModalBody(omega=[0.0], zeta=[0.0], channels=("x",), rows=[[1.0]], S=np.zeros((1, 1)))
        what = ct.Patch(body=body, normal=("x",), clearance=[0.01], velocity=[1.0])
    return ct.ExactModal(skip=False).prepare(what, ct.Unilateral(), dt=H, courant=None)


@pytest.mark.parametrize("kind", ["rim", "rub"])
def test_a_tip_that_moves_further_than_it_may_ends_its_run(kind):
    with plain() as module:
        record, limits = module("contact.record.record"), module("contact.model.gaps.limits")
        free, held = prepared(module, kind), prepared(module, kind)
        out = record.samples(record.Record(every=1), 120, 1, free.size + 3)
        assert free.advance(out, 0, 120) == -1
        first = int(np.argmax(out.force[:, 0] > 0.0))
        assert first > 0
        held.limits[limits.TIP] = 1e-13
        out = record.samples(record.Record(every=1), 120, 1, free.size + 3)
        assert held.advance(out, 0, 120) == first + 1
        assert held.sums.filled[0] == first + 1
    assert free.limits[limits.REACHED + limits.TIP] > 1e-13


@pytest.mark.parametrize("kind", ["rim", "rub"])
def test_a_rim_is_looked_at_every_so_many_steps(kind):
    with plain() as module:
        record, limits = module("contact.record.record"), module("contact.model.gaps.limits")
        run = prepared(module, kind)
        run.limits[[limits.RIM, limits.WATCHED]] = 1e-15
        out = record.samples(record.Record(every=1), 400, 1, run.size + 3)
        failed = run.advance(out, 0, 400)
    assert failed % limits.LOOK == 1
    assert out.force[: failed - 1].max() > 0.0
    last = failed - 1 - limits.LOOK
    assert last < 0 or out.force[: last + 1].max() == 0.0 or last == 0


def test_a_gap_that_opens_further_than_it_may_ends_its_run():
    with plain() as module:
        record, limits = module("contact.record.record"), module("contact.model.gaps.limits")
        run = prepared(module, "patch")
        run.limits[limits.TIP] = 5.5 * H
        out = record.samples(record.Record(every=1), 20, 1, 1)
        assert run.advance(out, 0, 20) == 6
    np.testing.assert_allclose(run.limits[limits.REACHED + limits.TIP], 6.0 * H, rtol=1e-12)
