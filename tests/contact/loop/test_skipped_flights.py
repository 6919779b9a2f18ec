"""Free flights of rims that are skipped, alone and in lanes, against the same runs step by step; uncompiled."""

import numpy as np
import pytest

from tests.contact.plain import plain

H, STEPS = 2e-5, 340
SPARSE = {"every": 60, "state_every": 120}


def lobed(module, *, clearance=2e-4, zeta=0.01, speed=100.0, imperfect=0.05):
    """Two lobes reach .05 mm into the blade's circle, twice a turn of 500 steps."""
    made = module("tests.contact.synthetic_rim")
    return module("contact").RotatingRim(
        made.ring(S=4e-7, zeta=zeta, imperfect=imperfect), made.blade(S=1e-6, zeta=zeta), clearance=clearance,
        speed_hz=speed, lean_deg=25.0, out_of_roundness=[{"p": 2, "cos": 2.5e-4}], angle_deg=45.0,
    )  # fmt: skip


def prepared(module, skip, *, mu=0.3, law="forward", **rim):
    ct = module("contact")
    scheme = ct.ExactModal(law=law, skip=skip)
    return scheme.prepare(lobed(module, **rim), ct.Coulomb(mu=mu) if mu else ct.Unilateral(), dt=H, courant=None)


def told(run, out, samples, states, events):
    """Where a run ends, what it noted, its sums and how many steps it skipped."""
    ends = [run.state.q, run.state.d, run.state.lam, run.state.heat, run.state.drive]
    seen = [
        out.time[:samples], out.force[:samples], out.gap[:samples], out.impulse[:samples], out.state_time[:states],
        out.state[:states], out.event_kind[:events], out.event_time[:events],
    ]  # fmt: skip
    return ends, seen, run.sums, run.flight.taken


def followed(module, skip, record, split=STEPS, **case):
    run, kept = prepared(module, skip, **case), module("contact").Record(**record)
    out = module("contact.record.record").samples(kept, STEPS, 1, run.size, kept.steps(dt=H, count=STEPS))
    for first, steps in ((0, split), (split, STEPS - split)):
        assert steps == 0 or run.advance(out, first, steps) == -1
    return told(run, out, *run.sums.filled)


def same(one, other):
    for found, exact in zip([*other[0], *other[1]], [*one[0], *one[1]], strict=True):
        assert found.shape == exact.shape
        np.testing.assert_allclose(found, exact, rtol=1e-8, atol=1e-9 * np.abs(exact).max(initial=0.0))
    for name in ("impulse", "work", "rotation", "friction", "damping", "peak", "penetration", "contact_steps"):
        np.testing.assert_allclose(getattr(other[2], name), getattr(one[2], name), rtol=1e-8, atol=1e-18)
    assert one[3].tolist() == [0, 0]
    assert other[3][1] > 120


@pytest.mark.slow
@pytest.mark.parametrize(
    ("record", "split", "case"),
    [
        (SPARSE, STEPS, {}),
        (SPARSE, 131, {"mu": 0.0, "law": "averaged"}),
        ({"at": [50 * H, 77 * H, 310 * H]}, STEPS, {"speed": -100.0, "imperfect": 0.0}),
        ({"every": 60}, STEPS, {"zeta": 0.0, "clearance": 6e-4}),  # it never touches
    ],
)
def test_skips_change_nothing_but_round_off(record, split, case):
    with plain() as module:
        whole, skipped = (followed(module, skip, record, split, **case) for skip in (False, True))
    assert (whole[2].contact_steps[0] > 5) == ("clearance" not in case)
    same(whole, skipped)


@pytest.mark.slow
def test_lanes_skip_each_by_itself():
    cases = {
        0: (40, {}), 3: (25, {"clearance": 2.1e-4, "speed": -80.0, "law": "averaged"}),
        4: (60, {"clearance": 7e-4, "speed": 90.0}),
    }  # fmt: skip
    with plain() as module:
        lanes_of, record = module("contact.scheme.modal.batch"), module("contact").Record
        alone, jobs, ended = {}, {}, {}
        for k, (every, case) in cases.items():
            kept = {"every": every, "state_every": 2 * every}
            alone[k] = followed(module, False, kept, **case)
            jobs[k] = lanes_of.Job(run=prepared(module, True, **case), steps=STEPS, record=record(**kept))
        many = lanes_of.batch(list(jobs.values()))
        events = {k: [] for k in jobs}
        for k, job in jobs.items():
            many.load(k, job)
        for _ in range(20):
            for k, found in many.advance().items():
                events[k].append(found)
            for k in set(jobs) - set(ended):
                if many.lanes.step[k] == STEPS:
                    out = many.unload(k, jobs[k], events[k])
                    ended[k] = told(jobs[k].run, out, len(out.time), len(out.state_time), len(out.event_time))
                    same(alone[k], ended[k])
            if len(ended) == len(jobs):
                break
    assert {k: bool(found[2].contact_steps[0] > 5) for k, found in ended.items()} == {0: True, 3: True, 4: False}
