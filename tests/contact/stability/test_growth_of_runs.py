"""Growth of the motion of a run: exact of free decay, that of the poles while contact stays closed, none at an end."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade
from tests.probed import finite

PAIR = ct.gaps.ModalPair(n=4, freq_hz=100.0, modal_mass=1.5, zeta=0.004)


def free(zeta=0.004, *, n=4, speed_hz=5.0, velocity=(1e-3, 0.0)):
    """A rim beside a blade that it never meets."""
    return ct.RotatingRim(
        ct.gaps.pair_rim(replace(PAIR, n=n, zeta=zeta), radius=0.5), blade(), clearance=1e-2, speed_hz=speed_hz,
        casing_velocity=list(velocity),
    )  # fmt: skip


@pytest.mark.parametrize(("state_every", "off"), [(5, 0.01), (53, 0.06)])  # dense, and half a period apart
@pytest.mark.slow
def test_energy_of_a_free_rim_decays_by_twice_its_damping(state_every, off, held):
    rim = free()
    result = ct.run(rim, t_end=1.0, dt=1e-4, record=ct.Record(state_every=state_every))
    found = ct.stability.of_run(rim, result)
    assert found.state == "decays"
    assert found.energy_rate == pytest.approx(-2.0 * 0.004 * 2.0 * np.pi * 100.0, rel=off)
    assert found.low < -0.004 * 2.0 * np.pi * 100.0 < found.high
    assert (found.body, found.nodal_diameters) == ("casing", 4)
    held(1e-5, found=finite(found))


@pytest.mark.slow
def test_a_free_rim_without_damping_is_bounded_at_its_amplitude(held):
    rim = free(zeta=0.0)
    found = ct.stability.of_run(rim, ct.run(rim, t_end=0.5, dt=1e-4, record=ct.Record(state_every=1)))
    assert found.state == "bounded"
    assert found.amplitude == pytest.approx(1e-3 / 1.5**0.5 / (2.0 * np.pi * 100.0), rel=0.005)
    bounded = "The motion is bounded: at the end of the run the rim deflects by 0.0013 mm, steady within "
    assert found.words.startswith(bounded)
    assert found.steady < 0.05
    assert found.time_to_half_wall == np.inf
    held(1e-5, found=finite(found))


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.slow
def test_a_wave_with_the_blades_and_one_against_them_are_distinguished(sense, held):
    """The blades run towards -theta in a casing whose angle grows; cos(n theta - w t) runs towards +theta."""
    rub = ct.Rub(
        ct.gaps.pair_rim(PAIR, radius=0.5),
        (blade(),),
        (ct.ContactPoint(),),
        clearance=1e-2,
        speed=ct.Speed.constant(7.0),
        casing_start=ct.gaps.Start(
            displacement=np.array([1e-4, 0.0]), velocity=np.array([0.0, sense * 1e-4 * 2.0 * np.pi * 100.0])
        ),
    )
    found = ct.stability.of_run(rub, ct.run(rub, t_end=0.2, dt=1e-4, record=ct.Record(state_every=10)))
    assert found.cause.travel == pytest.approx(-sense, abs=0.01)
    assert f"{'against' if sense > 0.0 else 'with'} the rotation of the blades" in found.cause.words
    standing = ct.stability.of_run(free(), ct.run(free(), t_end=0.2, dt=1e-4, record=ct.Record(state_every=10)))
    assert abs(standing.cause.travel) < 0.01
    held(1e-5, found=finite(found), standing=finite(standing))


@pytest.mark.slow
@pytest.mark.parametrize("shift", [0.0, 0.5 * np.pi])
def test_a_wave_of_the_blades_has_its_nodal_diameters_wherever_its_nodes_are(shift, held):
    disk = ct.gaps.BladedDisk(blades=12, freq_hz=100.0, modal_mass=0.4, coupling=0.05)
    body, flaps = disk.body(), np.cos(3.0 * np.arange(12) * np.pi / 6.0 - shift)
    start = ct.gaps.Start(displacement=np.linalg.solve(body.rows[1::2], 1e-4 * flaps), velocity=np.zeros(12))
    rub = ct.Rub(
        ct.gaps.pair_rim(PAIR, radius=0.5), (body,), disk.tips(), clearance=1e-2, speed=ct.Speed.constant(7.0),
        blade_starts=(start,),
    )  # fmt: skip
    cause = ct.stability.of_run(rub, ct.run(rub, t_end=0.1, dt=2e-4, record=ct.Record(state_every=10))).cause
    assert (cause.body, cause.n) == ("blades", 3)
    assert cause.share == pytest.approx(1.0, abs=1e-6)
    held(1e-5, cause=finite(cause))


@pytest.mark.slow
def test_growth_of_a_contact_that_stays_closed_is_that_of_its_pole(held):
    """A pressed pair at the speed of its sum condition: the fastest pole, until the motion opens the contact."""
    pair = ct.gaps.HandPair(
        casing=ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=1.5),
        blade=ct.gaps.ModalPair(freq_hz=100.0, modal_mass=0.2), compliance=1e-4,
    )  # fmt: skip
    found = ct.stability.of_contact(pair.contact(), np.linspace(95.0, 110.0, 151))
    body = ct.ModalBody(
        omega=[2.0 * np.pi * 100.0], zeta=[0.0], channels=("span", "flap"), rows=[[0.2**-0.5], [0.0]],
        S=1e-4 * np.eye(2),
    )  # fmt: skip
    rim = replace(ct.gaps.pair_rim(pair.casing, radius=0.5), thickness=4e-3)
    rub = ct.Rub(rim, (body,), clearance=-1e-2, speed=ct.Speed.constant(found.peak_speed_hz))
    result = ct.run(rub, t_end=0.3, dt=2e-5, record=ct.Record(state_every=10))
    assert result.contact_steps[0] == result.steps
    grown = ct.stability.of_run(rub, result)
    assert grown.state == "grows"
    assert grown.rate == pytest.approx(found.peak_growth, rel=0.1)
    assert grown.cause.source == "the turning rim"
    assert grown.cause.travel > 0.9  # the wave that the blade overtakes
    held(1e-4, grown=finite(grown))
    further = ct.stability.of_run(rub, ct.run(rub, t_end=0.4, dt=2e-5, record=ct.Record(state_every=10)))
    assert further.time_to_half_wall == pytest.approx(grown.time_to_half_wall, rel=0.05)


def test_a_slow_growth_after_a_long_start_is_not_bounded(held):
    """A mode of the blade that contact does not see decays for 0.6 s before a pole of 1.6 1/s shows in the energy."""
    pair = ct.gaps.HandPair(
        casing=ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=1.5),
        blade=ct.gaps.ModalPair(freq_hz=100.0, modal_mass=0.2), compliance=1e-4,
    )  # fmt: skip
    pole = ct.stability.of_contact(pair.contact(), np.array([102.01, 102.02])).growth[0]
    body = ct.ModalBody(
        omega=[2.0 * np.pi * 100.0, 2.0 * np.pi * 250.0], zeta=[0.0, 0.005], channels=("span", "flap"),
        rows=[[0.2**-0.5, 0.0], [0.0, 0.0]], S=1e-4 * np.eye(2),
    )  # fmt: skip
    rub = ct.Rub(
        replace(ct.gaps.pair_rim(pair.casing, radius=0.5), thickness=4e-3), (body,), clearance=-1e-4,
        speed=ct.Speed.constant(102.01), blade_starts=(ct.gaps.Start(velocity=np.array([0.0, 3.0])),),
    )  # fmt: skip
    result = ct.run(rub, t_end=0.8, dt=4e-5)
    assert result.contact_steps[0] == result.steps  # the motion is linear
    assert 1.5 < pole < 1.8
    assert result.growth.since > 0.5
    assert result.growth.state == "undecided"
    held(1e-4, growth=finite(result.growth))


def test_a_level_that_has_jumped_late_in_the_run_is_not_bounded():
    rim = free(zeta=0.0)
    result = ct.run(rim, t_end=1.0, dt=1e-4, record=ct.Record(state_every=5))
    jumped = result.state.copy()
    jumped[result.state_time > 0.6] *= 2.0
    assert ct.stability.of_run(rim, result).state == "bounded"
    assert ct.stability.of_run(rim, replace(result, state=jumped)).state == "undecided"


def grown(*, closed, outcome="grows"):
    """Growth of a run whose contact is closed for a fraction of the time."""
    cause = ct.record.Cause(body="casing", n=4, share=0.9, travel=1.0, source="friction", work=1.0, closed=closed)
    return ct.record.RunGrowth(
        rate=9.0, low=8.0, high=10.0, state=outcome, amplitude=1e-4, steady=0.5, since=0.1, time_to_half_wall=0.5,
        cause=cause,
    )  # fmt: skip


def test_a_growth_that_passes_the_limit_at_half_the_step_too_is_not_numerical():
    less = grown(closed=0.3).checked(1.0, 0.1, 0.3)
    assert (less.outcome, less.check) == ("numerical", "numerical")
    both = replace(less, passes=True)
    assert (both.outcome, both.check) == ("grows", "depends on the step")
    assert both.flags[0].code == "growth-numerical"


def test_a_run_stopped_before_its_growth_is_known_is_judged_by_the_limit_at_half_the_step(held):
    """A rim thrown beyond half its wall in a tenth of a period, whatever the step."""
    casing = replace(ct.gaps.pair_rim(PAIR, radius=0.5), thickness=2e-4)
    rim = ct.RotatingRim(casing, blade(), clearance=1e-2, speed_hz=5.0, casing_velocity=[0.7, 0.0])
    with pytest.raises(ct.NumericsError, match="At half the step the motion passes this limit too: converged") as stop:
        ct.run(rim, t_end=0.1, dt=2e-6)
    found = stop.value.result.growth
    assert (found.passes, found.check, found.outcome) == (True, "converged", found.state)
    held(1e-4, found=finite(found))
    within = replace(found, passes=False)
    assert (within.check, within.outcome, within.flags[0].code) == ("numerical", "numerical", "growth-numerical")


def test_without_states_or_a_rim_there_is_no_growth():
    rod = ct.Rod(length=1.0, area=1e-4, E=2e11, rho=7800.0, elements=5, x=0.0)
    assert (
        ct.stability.of_run([rod, ct.Wall(x=-1e-3)], ct.run([rod, ct.Wall(x=-1e-3)], t_end=1e-4, courant=0.9)) is None
    )
