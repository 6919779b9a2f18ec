"""Free flights of rims that are skipped, alone and in lanes, against the same runs step by step; uncompiled."""

import numpy as np
import pytest

from tests.contact.plain import plain

H, STEPS = 2e-5, 420
SPARSE = {"every": 60, "state_every": 120}


def lobed(module, *, clearance=2e-4, zeta=0.01, speed=100.0, imperfect=0.05):
    """Two lobes reach .05 mm into the blade's circle, twice a turn of 500 steps."""
    made = module("tests.contact.synthetic_rim")
    return module("contact").RotatingRim(
        made.ring(S=4e-7, zeta=zeta, imperfect=imperfect), made.blade(S=1e-6, zeta=zeta), clearance=clearance,
        speed_hz=speed, lean_deg=25.0, out_of_roundness=[{"p": 2, "cos": 2.5e-4}], angle_deg=45.0,
    )  # fmt: skip


def followed(module, skip, record, split=STEPS, *, mu=0.3, law="forward", **rim):
    """What a run notes, its sums, where it ends and how many steps it skipped."""
    ct = module("contact")
    scheme = ct.ExactModal(law=law, skip=skip)
    run = scheme.prepare(lobed(module, **rim), ct.Coulomb(mu=mu) if mu else ct.Unilateral(), dt=H, courant=None)
    kept = ct.Record(**record)
    out = module("contact.record.record").samples(kept, STEPS, 1, run.size, kept.steps(dt=H, count=STEPS))
    for first, steps in ((0, split), (split, STEPS - split)):
        assert steps == 0 or run.advance(out, first, steps) == -1
    m = run.rim.state.memory
    ends = [run.rim.state.q, run.rim.state.d, m[:2], m[4:7], m[8:]]
    filled, flight = run.sums.filled, run.rim.flight
    seen = [
        out.time[: filled[0]], out.force[: filled[0]], out.gap[: filled[0]], out.impulse[: filled[0]],
        out.state_time[: filled[1]], out.state[: filled[1]], out.event_kind[: filled[2]], out.event_time[: filled[2]],
    ]  # fmt: skip
    return ends, seen, run.sums, flight.taken


@pytest.mark.parametrize(
    ("record", "split", "case"),
    [
        (SPARSE, STEPS, {}),
        (SPARSE, 131, {"mu": 0.0, "law": "averaged"}),
        ({"at": [50 * H, 77 * H, 380 * H]}, STEPS, {"speed": -100.0, "imperfect": 0.0}),
        ({"every": 60}, STEPS, {"zeta": 0.0, "clearance": 6e-4}),  # it never touches
    ],
)
def test_skips_change_nothing_but_round_off(record, split, case):
    with plain() as module:
        whole = followed(module, False, record, split, **case)
        ends, seen, sums, taken = followed(module, True, record, split, **case)
    assert whole[3].tolist() == [0, 0]
    assert taken[1] > 120
    assert (whole[2].contact_steps[0] > 5) == ("clearance" not in case)
    for found, exact in zip([*ends, *seen], [*whole[0], *whole[1]], strict=True):
        assert found.shape == exact.shape
        np.testing.assert_allclose(found, exact, rtol=1e-8, atol=1e-9 * np.abs(exact).max(initial=0.0))
    for name in ("impulse", "work", "rotation", "friction", "damping", "peak", "penetration", "contact_steps"):
        exact = getattr(whole[2], name)
        np.testing.assert_allclose(getattr(sums, name), exact, rtol=1e-8, atol=1e-18)


def test_lanes_skip_each_by_itself():
    with plain() as module:
        ct = module("contact")

        def scene(skip, clearance, speed, law, every):
            return ct.Scene(
                what=lobed(module, clearance=clearance, speed=speed), scheme=ct.ExactModal(law=law, skip=skip),
                law=ct.Coulomb(mu=0.3), dt=H, t_end=STEPS * H, record=ct.Record(every=every, state_every=2 * every),
            )  # fmt: skip

        cases = [(2e-4, 100.0, "forward", 40), (2.1e-4, -80.0, "averaged", 25), (7e-4, 90.0, "forward", 60)]
        many = ct.run_many([scene(True, *case) for case in cases])
        alone = [ct.run(scene(False, *case)) for case in cases]
    for one, other in zip(alone, many, strict=True):
        for name in ("time", "state_time", "contact_steps"):
            np.testing.assert_array_equal(getattr(other, name), getattr(one, name))
        for name in ("force", "gap", "state", "impulse", "peak_force", "max_penetration"):
            exact = getattr(one, name)
            np.testing.assert_allclose(getattr(other, name), exact, rtol=1e-8, atol=1e-9 * np.abs(exact).max())
        assert other.energy.damping == pytest.approx(one.energy.damping, rel=1e-8)
        assert abs(other.energy.unaccounted) <= 1e-10 * other.energy.scale
    assert [result.contact_steps[0] > 5 for result in many] == [True, True, False]
