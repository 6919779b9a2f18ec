"""Growth of the motion of a run: exact of free decay, that of the poles while contact stays closed, none at an end."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade

PAIR = ct.gaps.ModalPair(n=4, freq_hz=100.0, modal_mass=1.5, zeta=0.004)


def free(zeta=0.004, *, n=4, speed_hz=5.0, velocity=(1e-3, 0.0)):
    """A rim beside a blade that it never meets."""
    return ct.RotatingRim(
        ct.gaps.pair_rim(replace(PAIR, n=n, zeta=zeta), radius=0.5), blade(), clearance=1e-2, speed_hz=speed_hz,
        casing_velocity=list(velocity),
    )  # fmt: skip


@pytest.mark.parametrize(("state_every", "off"), [(5, 0.01), (53, 0.06)])  # dense, and half a period apart
@pytest.mark.slow
def test_energy_of_a_free_rim_decays_by_twice_its_damping(state_every, off):
    rim = free()
    result = ct.run(rim, t_end=1.0, dt=1e-4, record=ct.Record(state_every=state_every))
    found = ct.stability.of_run(rim, result)
    assert found.state == "decays"
    assert found.energy_rate == pytest.approx(-2.0 * 0.004 * 2.0 * np.pi * 100.0, rel=off)
    assert found.low < -0.004 * 2.0 * np.pi * 100.0 < found.high
    assert (found.body, found.nodal_diameters) == ("casing", 4)


@pytest.mark.slow
def test_a_free_rim_without_damping_is_bounded_at_its_amplitude():
    rim = free(zeta=0.0)
    found = ct.stability.of_run(rim, ct.run(rim, t_end=0.5, dt=1e-4, record=ct.Record(state_every=1)))
    assert found.state == "bounded"
    assert found.amplitude == pytest.approx(1e-3 / 1.5**0.5 / (2.0 * np.pi * 100.0), rel=0.005)
    assert found.words.startswith("The motion is bounded: the rim deflects by 0.0013 mm, steady within ")
    assert found.steady < 0.05
    assert found.time_to_half_wall == np.inf


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.slow
def test_a_wave_with_the_blades_and_one_against_them_are_distinguished(sense):
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


@pytest.mark.slow
def test_growth_of_a_contact_that_stays_closed_is_that_of_its_pole():
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
    further = ct.stability.of_run(rub, ct.run(rub, t_end=0.4, dt=2e-5, record=ct.Record(state_every=10)))
    assert further.time_to_half_wall == pytest.approx(grown.time_to_half_wall, rel=0.05)


def test_without_states_or_a_rim_there_is_no_growth():
    rod = ct.Rod(length=1.0, area=1e-4, E=2e11, rho=7800.0, elements=5, x=0.0)
    assert (
        ct.stability.of_run([rod, ct.Wall(x=-1e-3)], ct.run([rod, ct.Wall(x=-1e-3)], t_end=1e-4, courant=0.9)) is None
    )
