"""Growth of the motion of a run: exact of free decay, that of the poles while contact stays closed, none at an end."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.stability.envelope import envelope, growth_of
from contact.stability.of_run import groups_of
from tests.contact.synthetic_rim import blade, ring

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
    found = ct.stability.of_run(rim, ct.run(rim, t_end=0.5, dt=1e-4, record=ct.Record(state_every=5)))
    assert found.state == "bounded"
    assert found.amplitude == pytest.approx(1e-3 / 1.5**0.5 / (2.0 * np.pi * 100.0), rel=1e-3)
    assert found.words.startswith("The motion is bounded: the rim deflects by 0.0013 mm, steady within ")
    assert found.steady < 0.05
    assert found.time_to_half_wall == np.inf


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.slow
def test_a_wave_with_the_blades_and_one_against_them_are_told_apart(sense):
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


def test_a_limit_cycle_after_its_rise_is_bounded_and_its_rise_alone_grows():
    t = np.linspace(0.0, 4.0, 801)
    size = 1e-3 / np.sqrt(1.0 + 1e6 * np.exp(-20.0 * t))  # x' = 10 x (1 - (x/1e-3)^2)
    q = size[:, None] * np.stack([np.cos(700.0 * t), np.sin(700.0 * t)], axis=1)
    omega, one = np.full(2, 700.0), np.zeros(2, dtype=int)
    whole, rise = envelope(t, q, omega, one), envelope(t[:90], q[:90], omega, one)
    assert abs(growth_of(whole.time, whole.energy[:, 0]).rate) < 0.05
    grows = growth_of(rise.time, rise.energy[:, 0])
    assert grows.low < grows.rate < grows.high
    assert grows.rate == pytest.approx(10.0, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize(("depends", "share"), [(0.0, 0.92), (0.5, 0.8)])
def test_interval_of_growth_has_the_true_one_though_windows_depend_on_each_other(depends, share):
    rng, inside, t = np.random.default_rng(3), 0, np.linspace(0.0, 1.0, 32)
    for _ in range(400):
        noise = rng.standard_normal(80)
        for k in range(1, 80):
            noise[k] += depends * noise[k - 1]
        fit = growth_of(t, np.exp(2.0 * (3.0 * t + 0.1 * noise[-32:])))
        inside += fit.low <= 3.0 <= fit.high
    assert inside >= share * 400


def test_an_approach_to_an_end_state_is_no_growth():
    t = np.linspace(0.0, 4.0, 801)
    size = np.sqrt(1.0 - np.exp(-3.0 * t))
    q = size[:, None] * np.stack([np.cos(700.0 * t), np.sin(700.0 * t)], axis=1)
    found = envelope(t, q, np.full(2, 700.0), np.zeros(2, dtype=int))
    assert abs(growth_of(found.time, found.energy[:, 0]).rate) < 0.01


def test_modes_are_grouped_by_the_nodal_diameters_of_rim_and_disk():
    disk = ct.BladedDisk(blades=6, freq_hz=300.0, modal_mass=0.5, coupling=0.1)
    groups = groups_of((ring(), disk.body()), disk.tips())
    assert [groups.named[k] for k in groups.of[:10:2]] == [("casing", n) for n in range(2, 7)]
    assert [groups.named[k][1] for k in groups.of[10:]] == [0, 1, 1, 2, 2, 3]
    single = groups_of((ring(), blade()), (ct.ContactPoint(),))
    assert single.named[-1] == ("blades", None)


def test_without_states_or_a_rim_there_is_no_growth():
    rod = ct.Rod(length=1.0, area=1e-4, E=2e11, rho=7800.0, elements=5, x=0.0)
    assert (
        ct.stability.of_run([rod, ct.Wall(x=-1e-3)], ct.run([rod, ct.Wall(x=-1e-3)], t_end=1e-4, courant=0.9)) is None
    )
