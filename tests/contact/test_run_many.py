"""Many runs at once: each as if it were run alone."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, flap_blade, ring

RECORD = ct.Record(every=50, state_every=100)

pytestmark = pytest.mark.slow  # they compile loops for seconds


def scene(
    *, speed_hz=20.0, mu=0.0, clearance=2e-4, imperfect=0.0, t_end=0.1, dt=2e-5, skip=True, record=RECORD, **more
):
    rim = ct.RotatingRim(
        ring(S=4e-7, zeta=0.01, imperfect=imperfect), blade(S=1e-6, zeta=0.01), clearance=clearance,
        speed_hz=speed_hz, out_of_roundness=[{"p": 2, "cos": 2.5e-4}], angle_deg=45.0, **{"lean_deg": 25.0} | more,
    )  # fmt: skip
    return ct.Scene(
        what=rim, law=ct.Coulomb(mu=mu) if mu else ct.Unilateral(), t_end=t_end, dt=dt, record=record,
        scheme=ct.ExactModal(skip=skip),
    )  # fmt: skip


def different():
    """More runs than slots, no two alike, one without contact, one that skips nothing, two lengths, two steps."""
    return [
        scene(), scene(speed_hz=15.0, mu=0.2, clearance=1.5e-4, imperfect=0.05), scene(clearance=1e-2),
        scene(speed_hz=30.0, clearance=1e-4, t_end=0.05), scene(mu=0.1, clearance=-1e-5, imperfect=0.05, lean_deg=10.0),
        scene(speed_hz=5.0, mu=0.1, clearance=1e-4, dt=1e-5, t_end=0.03), scene(skip=False),
        scene(mu=0.2, clearance=1.7e-4, lean_deg=-10.0), scene(speed_hz=-18.0, mu=0.2), scene(speed_hz=19.0),
        scene(speed_hz=0.1, mu=0.2, clearance=-1e-4, blade_velocity=[1.0, 0.0], t_end=0.03),
    ]  # fmt: skip


def test_each_run_is_as_if_alone():
    """Slots add in another order: what touches differs in its last bits, and equal bits mean that it was run singly."""
    scenes = different()
    for one, many in zip(map(ct.run, scenes), ct.run_many(scenes), strict=True):
        assert np.array_equal(many.state, one.state) == (one.contact_steps[0] == 0)
        scale = max(np.abs(one.state).max(), 1e-30)
        assert np.abs(many.state - one.state).max() <= 1e-12 * scale
        assert np.array_equal(many.time, one.time)
        assert np.array_equal(many.state_time, one.state_time)
        assert np.allclose(many.force, one.force, rtol=0.0, atol=1e-10 * np.abs(one.force).max())
        assert np.allclose(many.gap, one.gap, rtol=0.0, atol=1e-12 * np.abs(one.gap).max())
        assert np.allclose(many.impulse_history, one.impulse_history, rtol=0.0, atol=1e-11 * one.impulse[0])
        assert np.array_equal(many.contact_steps, one.contact_steps)
        assert len(many.intervals[0]) == len(one.intervals[0])
        assert np.allclose(many.intervals[0], one.intervals[0], rtol=0.0, atol=1e-9)
        assert many.sticking == one.sticking
        for name in ("heat", "drive"):
            assert getattr(many.notes, name) == pytest.approx(getattr(one.notes, name), rel=1e-9, abs=1e-13)
        for name in ("contact", "rotation", "friction", "damping"):
            value = getattr(one.energy, name)
            assert getattr(many.energy, name) == pytest.approx(value, rel=1e-9, abs=1e-13 * one.energy.scale)
        assert abs(many.energy.unaccounted) <= 1e-11 * max(one.energy.scale, 1e-300)
        for name in ("impulse", "peak_force"):
            assert getattr(many, name) == pytest.approx(getattr(one, name), rel=1e-11)
        assert many.max_penetration == pytest.approx(one.max_penetration, abs=1e-17)
        assert many.residual[0] == pytest.approx(one.residual[0], abs=1e-17)
        assert np.array_equal(many.reversals, one.reversals)
        assert (many.steps, many.scheme, many.every) == (one.steps, one.scheme, one.every)
    alone = [ct.run(scene) for scene in scenes]
    assert sum(one.contact_steps[0] > 0 for one in alone) == 9
    assert max(one.reversals[0] for one in alone) > 10


def test_batches_of_the_forward_law_are_as_if_alone_beside_averaged_ones():
    forward = replace(scene(mu=0.1), scheme=ct.ExactModal(law="forward"))
    alone, (many, averaged) = ct.run(forward), ct.run_many([forward, scene(mu=0.1)])
    assert "forward" in many.scheme
    assert "averaged" in averaged.scheme
    assert alone.contact_steps[0] > 0
    np.testing.assert_allclose(many.force, alone.force, rtol=0.0, atol=1e-10 * alone.peak_force[0])
    assert np.array_equal(many.contact_steps, alone.contact_steps)
    assert not np.array_equal(many.force, averaged.force)


def test_neighbours_and_order_change_no_bit():
    scenes = different()
    forward = ct.run_many(scenes)
    backward = ct.run_many(scenes[::-1])[::-1]
    alone = [ct.run_many([one])[0] for one in scenes]
    for a, b, c in zip(forward, backward, alone, strict=True):
        for other in (b, c):
            assert np.array_equal(a.state, other.state)
            assert np.array_equal(a.force, other.force)
            assert a.impulse.tobytes() == other.impulse.tobytes()
            assert a.energy == other.energy
            assert a.intervals == other.intervals


def test_what_batches_do_not_take_runs_singly_and_failures_are_reported():
    stiff = ct.RotatingRim(ring(S=0.0), flap_blade(S=0.0), clearance=-1e-5, speed_hz=5.0, lean_deg=45.0)
    rod = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=20, x=5.0, velocity=-10.0)
    scenes = [
        scene(record=ct.Record(at=[0.01, 0.05])), ct.Scene(what=[rod, ct.Wall()], t_end=2.0, courant=0.9),
        ct.Scene(what=stiff, law=ct.Coulomb(mu=20.0), t_end=0.01, dt=1e-5), scene(dt=1.0), scene(),
    ]  # fmt: skip
    done = []
    found = ct.run_many(scenes, ended=lambda i, outcome: done.append((i, type(outcome).__name__)))
    assert found[0].time.tolist() == [0.01, 0.05]
    assert found[1].steps == 134
    assert isinstance(found[2], ct.LimitError)
    assert "the blade jams" in str(found[2])
    assert isinstance(found[3], ct.LimitError)
    assert isinstance(found[4], ct.Result)
    assert done == [(0, "Result"), (1, "Result"), (2, "LimitError"), (3, "LimitError"), (4, "Result")]


def test_a_run_that_goes_on_ends_as_one_that_was_longer_from_the_start():
    """The first run is alone and continues, the second has a slot and is repeated; the third does not go on."""
    rod = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=20, x=5.0, velocity=-10.0)
    scenes = [ct.Scene(what=[rod, ct.Wall()], t_end=2.0, courant=0.9), scene(t_end=0.03), scene(t_end=0.02)]
    lengths = {0: [], 1: [], 2: []}

    def longer(i, outcome):
        lengths[i].append(outcome.steps)
        return 2 * outcome.steps if i < 2 and len(lengths[i]) < 3 else 0

    found = ct.run_many(scenes, longer=longer)
    assert lengths == {0: [134, 268, 536], 1: [1500, 3000, 6000], 2: [1000]}
    for one, result in zip(scenes, found, strict=True):
        whole = ct.run(replace(one, t_end=(result.steps - 0.5) * result.dt))
        assert whole.steps == result.steps
        assert np.allclose(result.force, whole.force, rtol=0.0, atol=1e-10 * max(whole.peak_force[0], 1e-30))
        assert np.allclose(result.intervals[0], whole.intervals[0], rtol=0.0, atol=1e-9)
        assert result.energy.contact == pytest.approx(whole.energy.contact, rel=1e-9, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("modes", [(2, 3), (3, 2)])
def test_friction_and_one_mode_less_is_not_a_run_without_friction(modes: tuple[int, int]) -> None:
    """Both have as many numbers in their state: modes and forces at the tip."""

    def scene(count: int, law: Any) -> ct.Scene:
        omega, rows = 500.0 * np.arange(1, count + 1), np.ones((2, count))
        tip = ct.ModalBody(
            omega=omega, zeta=np.full(count, 0.002), channels=("span", "flap"), rows=rows, S=np.eye(2) * 1e-8
        )
        rim = ct.RotatingRim(ring(), tip, clearance=-1e-5, speed_hz=5.0, lean_deg=10.0)
        return ct.Scene(what=rim, law=law, scheme=ct.ExactModal(), t_end=0.01, dt=1e-5)

    scenes = [scene(modes[0], ct.Coulomb(mu=0.1)), scene(modes[1], ct.Unilateral())]
    together = ct.run_many(scenes)
    for one, outcome in zip(scenes, together, strict=True):
        assert isinstance(outcome, ct.Result)
        assert outcome.impulse == pytest.approx(ct.run(one).impulse, rel=1e-12)
        assert outcome.state.shape == ct.run(one).state.shape


def test_growth_of_batches_is_checked_at_half_the_step_as_that_of_a_run_alone():
    """Friction above the lean feeds the rim; the rim that nothing touches has no growth to check."""
    digs = replace(ring(), thickness=1e-3)
    grows = [
        ct.Scene(
            what=ct.RotatingRim(digs, blade(), clearance=clearance, speed_hz=20.0, lean_deg=10.0),
            law=ct.Coulomb(mu=0.3), t_end=0.4, dt=2e-5,
        ) for clearance in (-1e-5, 1e-2)
    ]  # fmt: skip
    slots, still = ct.run_many(grows)
    with pytest.raises(ct.NumericsError) as alone:
        ct.run(grows[0])
    assert isinstance(slots, ct.NumericsError)
    for found in (slots.result.growth, alone.value.result.growth):
        assert (found.state, found.check) == ("grows", "converged")
    assert slots.result.growth.half_step == pytest.approx(alone.value.result.growth.half_step, rel=1e-6)
    assert still.growth.check == ""
