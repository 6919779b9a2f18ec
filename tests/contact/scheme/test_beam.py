"""Hinged beam in an eccentric circle: rigid closed forms, invariants, and the flexible ring."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

import contact as ct

pytestmark = pytest.mark.slow  # whichever comes first compiles the loop

BEAM = ct.bodies.HingedBeam(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, torque=1.0, elements=10)
CIRCLE = ct.bodies.BeamInCircle(BEAM, radius=0.502, offset=6e-3)
RING = ct.bodies.ThinRing(radius=0.502, width=0.02, height=0.005, E=210e9, rho=7800.0, k_r=1e6, k_t=1e5)


@pytest.fixture(scope="module")
def met():
    """An explicit run to 1.4 times the first contact."""
    return ct.run(CIRCLE, t_end=1.4 * CIRCLE.first_contact_time, courant=0.5, record=ct.Record(every=1, state_every=1))


def test_first_contact_is_where_and_when_a_rigid_beam_meets_the_circle(met):
    first = int(np.flatnonzero(met.force[:, -1] > 0.0)[0])
    tip = met.state[first].reshape(-1, 3)[-1]
    assert math.atan2(tip[1], tip[0]) == pytest.approx(CIRCLE.first_contact_angle, rel=3e-3)
    assert met.time[first] == pytest.approx(CIRCLE.first_contact_time, rel=3e-3)
    assert not met.force[:first].any()


def test_nothing_leaves_the_circle_and_only_closed_gaps_press(met):
    nodes = met.state.reshape(len(met.state), -1, 3)
    r = np.hypot(nodes[..., 0] - CIRCLE.offset, nodes[..., 1])
    assert r.max() <= CIRCLE.radius * (1.0 + 4e-16)
    assert met.residual.max() == 0.0
    assert met.force.min() >= 0.0
    assert met.force.max() > 0.0


def test_the_largest_frequency_of_an_element_is_that_of_its_matrices():
    L = BEAM.length / BEAM.elements
    EA, EI, mass = BEAM.E * 1e-4, BEAM.E * 0.02 * 0.005**3 / 12.0, BEAM.rho * 1e-4
    K = np.zeros((6, 6))
    K[np.ix_([0, 3], [0, 3])] = EA / L * np.array([[1.0, -1.0], [-1.0, 1.0]])
    bending = [[12, 6 * L, -12, 6 * L], [6 * L, 4 * L**2, -6 * L, 2 * L**2]]
    bending += [[-12, -6 * L, 12, -6 * L], [6 * L, 2 * L**2, -6 * L, 4 * L**2]]
    K[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = EI / L**3 * np.array(bending)
    half = 0.5 * L * np.array([mass, mass, BEAM.rho * 0.02 * 0.005**3 / 12.0])
    assert BEAM.omega_max() == pytest.approx(math.sqrt(eigh(K, np.diag(np.tile(half, 2)))[0][-1]), rel=1e-9)


def test_energy_equals_the_work_of_the_torque_before_contact():
    """The torque hits the light hinge node at once: an error of h^2."""
    energy = ct.run(CIRCLE, t_end=0.95 * CIRCLE.first_contact_time, courant=0.2).energy
    work = energy.start.potential - energy.end.potential
    assert abs(energy.end.total - energy.start.total) <= 1e-6 * work
    assert energy.end.kinetic == pytest.approx(work, rel=1e-2)  # nearly all of it


def test_the_ledger_balances_to_round_off_and_contact_never_gives_energy(met):
    assert abs(met.energy.unaccounted) <= 1e-12 * met.energy.end.kinetic
    assert -0.2 * met.energy.end.kinetic < met.energy.contact < 0.0


def test_implicit_newmark_agrees_with_the_explicit_impulse(met):
    finer = replace(CIRCLE, beam=replace(BEAM, elements=20))
    implicit = ct.run(
        finer, scheme=ct.scheme.Newmark(beta=0.5, gamma=0.55), t_end=1.4 * CIRCLE.first_contact_time, dt=1e-4
    )
    assert implicit.impulse.sum() == pytest.approx(met.impulse.sum(), rel=0.02)
    assert abs(implicit.energy.unaccounted) <= 1e-8 * implicit.energy.end.kinetic
    assert implicit.max_penetration.max() <= 1e-12


def test_a_run_through_the_front_door_reports_it():
    result = ct.run(CIRCLE, t_end=0.5, courant=0.5, record=ct.Record(every=1000))
    assert len(result.intervals[-1]) > 0
    assert result.energy.unaccounted == pytest.approx(0.0, abs=1e-12 * result.energy.scale)
    assert result.state_of("beam 1").shape[1] == 33


def test_ring_modes_are_those_of_a_ring_and_elements_converge_to_them():
    free = replace(RING, k_r=0.0, k_t=0.0)
    R, EI = RING.radius, RING.E * RING.width * RING.height**3 / 12.0
    for n in (2, 3, 5):  # inextensional bending (Hoppe 1871)
        bending = math.sqrt(EI / (free.line_mass * R**4) * n**2 * (n**2 - 1) ** 2 / (n**2 + 1)) / (2.0 * math.pi)
        assert free.frequencies(n)[0] == pytest.approx(bending, rel=1e-3)
    assert free.frequencies(1)[0] == pytest.approx(0.0, abs=1e-3)
    exact = ct.bodies.ring_modes(RING, 8)
    errors = [
        np.abs(ct.bodies.ring_elements(RING, e, 8).omega[:13] / exact.omega[:13] - 1.0).max() for e in (16, 32, 64)
    ]
    assert errors[2] < 1e-4
    assert errors[0] > 8.0 * errors[1] > 64.0 * errors[2]


def test_finite_element_rows_are_those_of_the_modes():
    exact, found = ct.bodies.ring_modes(RING, 4), ct.bodies.ring_elements(RING, 60, 4)
    kept = found.omega < 0.9 * exact.omega[exact.omega > 5e3].min()
    low = exact.omega < 0.9 * exact.omega[exact.omega > 5e3].min()
    # mobilities between all channels, with their signs, summed over modes: indifferent to how doublets are turned
    ours, theirs = (
        body.rows[:, few] / body.omega[few] ** 2 @ body.rows[:, few].T for body, few in ((found, kept), (exact, low))
    )
    assert np.abs(ours - theirs).max() <= 1e-3 * np.abs(theirs).max()
    n, m = exact.channel("radial.sin2"), exact.channel("tangential.cos2")
    assert ours[n, m] == pytest.approx(theirs[n, m], rel=1e-3)


def test_bending_of_a_ring_does_not_stretch_it():
    """w + v' = 0: W cos n theta goes with v = -W/n sin n theta, W sin n theta with v = W/n cos n theta."""
    body = ct.bodies.ring_modes(replace(RING, k_r=0.0, k_t=0.0), 3)
    for n in (2, 3):
        for radial, hoop, ratio in ((f"cos{n}", f"sin{n}", -1.0 / n), (f"sin{n}", f"cos{n}", 1.0 / n)):
            w, v = body.rows[body.channel(f"radial.{radial}")], body.rows[body.channel(f"tangential.{hoop}")]
            bends = int(np.flatnonzero(w)[0])
            assert v[bends] / w[bends] == pytest.approx(ratio, rel=1e-3)


def impulse(ring, t_end):
    circle = ct.bodies.BeamInCircle(replace(BEAM, elements=10), radius=0.502, offset=6e-3, ring=ring)
    result = ct.run(circle, t_end=t_end, courant=0.5, record=ct.Record(every=100))
    assert abs(result.energy.unaccounted) <= 1e-12 * result.energy.end.kinetic
    assert result.residual.max() <= 1e-15
    return float(result.impulse.sum())


def test_modal_and_finite_element_rings_give_one_impulse():
    t_end = 1.15 * CIRCLE.first_contact_time
    modal = impulse(ct.bodies.ring_modes(RING, 20), t_end)
    assert impulse(ct.bodies.ring_elements(RING, 60, 20), t_end) == pytest.approx(modal, rel=1e-2)


@pytest.mark.parametrize("scheme", [ct.CentralDifference(), ct.scheme.Newmark(beta=0.5, gamma=0.55)], ids=str)
def test_a_beam_that_is_set_spinning_turns_that_way_at_that_speed(scheme):
    beam = replace(BEAM, torque=0.0, spin=2.0, elements=3)
    result = ct.run(
        replace(CIRCLE, beam=beam, radius=1.0), scheme=scheme, t_end=0.1, dt=1e-5, record=ct.Record(state_every=100)
    )
    nodes = result.state.reshape(len(result.state), -1, 3)
    turned = np.arctan2(nodes[..., 1], nodes[..., 0])[:, 1:]
    assert turned == pytest.approx(np.repeat(2.0 * result.state_time[:, None], 3, axis=1), abs=1e-6)
    assert nodes[..., 2] == pytest.approx(np.repeat(2.0 * result.state_time[:, None], 4, axis=1), abs=1e-6)


@pytest.mark.parametrize("scheme", [ct.CentralDifference(), ct.scheme.Newmark(beta=0.25, gamma=0.5)], ids=str)
def test_angular_momentum_of_a_turning_beam_is_that_of_its_lumped_masses_and_sections(scheme):
    beam = replace(BEAM, torque=0.0, spin=2.0, elements=4, angle_deg=30.0, height=0.05)
    start = scheme.prepare(replace(CIRCLE, beam=beam, radius=1.0), ct.Unilateral(), dt=1e-6, courant=None)
    lumped = beam.mass * beam.length**2 * (1.0 / 3.0 + 1.0 / (6.0 * 4**2))
    sections = beam.mass * beam.height**2 / 12.0
    momentum, impulse = start.angular_momentum()
    assert momentum == pytest.approx(2.0 * (lumped + sections), rel=1e-12)
    assert impulse == 0.0


@pytest.mark.campaign
def test_a_stiffening_ring_becomes_the_rigid_circle():
    t_end = 1.15 * CIRCLE.first_contact_time
    rigid = impulse(None, t_end)
    gaps = [
        abs(impulse(ct.bodies.ring_modes(replace(RING, E=E, k_r=k, k_t=k), 10), t_end) / rigid - 1.0)
        for E, k in ((210e9, 1e6), (21e12, 1e9), (21e14, 1e12))
    ]
    assert gaps[0] > 3.0 * gaps[2]
    assert gaps[2] < 0.02


@pytest.mark.parametrize(("torque", "spin"), [(1.0, 0.0), (1.0, 2.0), (0.0, 2.0)])
@pytest.mark.parametrize(("angle_deg", "start_deg"), [(0.0, 0.0), (30.0, 30.0), (-390.0, -30.0)])
def test_torque_and_spin_bring_a_rigid_beam_to_the_circle(torque, spin, angle_deg, start_deg):
    scene = replace(CIRCLE, beam=replace(BEAM, torque=torque, spin=spin, angle_deg=angle_deg))
    t = scene.first_contact_time
    way = spin * t + 0.5 * torque / BEAM.inertia * t**2
    assert math.radians(start_deg) + way == pytest.approx(scene.first_contact_angle, rel=1e-12)


def test_a_beam_that_starts_where_its_tip_meets_the_circle_is_there_at_once():
    there = replace(BEAM, angle_deg=math.degrees(CIRCLE.first_contact_angle) * (1.0 - 1e-15))
    assert replace(CIRCLE, beam=there).first_contact_time == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize(
    ("motion", "words"),
    [
        ({"torque": 0.0}, "torque: found 0 N m and a spin of 0 rad/s, expected one of them > 0"),
        ({"torque": -1.0}, "torque: found -1.0, expected a finite number >= 0"),
        ({"spin": -1.0}, "spin: found -1.0, expected a finite number >= 0"),
    ],
)
def test_a_beam_that_turns_away_or_not_at_all_has_no_time_of_contact(motion, words):
    with pytest.raises(ct.InputError, match=words):
        _ = replace(CIRCLE, beam=replace(BEAM, **motion)).first_contact_time


def test_a_step_just_beyond_the_limit_is_refused_and_the_one_advised_is_taken():
    with pytest.raises(ct.LimitError, match=r"omega_max = 2\.0000000?2, expected <= 2 .*use dt <=") as caught:
        ct.run(CIRCLE, t_end=1e-4, courant=1.00000001)
    advised = float(str(caught.value).rpartition("<= ")[2].removesuffix(" s"))
    assert ct.run(CIRCLE, t_end=1e-4, dt=advised).dt == advised


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"offset": -1e-3}, "offset"),
        ({"radius": 0.49}, "starts"),
        ({"ring": ct.bodies.ring_modes(replace(RING, radius=0.4), 3)}, "ring"),
        ({"ring": ct.ModalBody(omega=[1.0], zeta=[0.0], channels=("span",), rows=[[1.0]], S=[[0.0]])}, "rim"),
    ],
)
def test_circles_that_cannot_be_are_refused(change, word):
    with pytest.raises(ct.InputError, match=word):
        replace(CIRCLE, **change)


def test_steps_beyond_the_limit_and_meaningless_loads_are_refused():
    with pytest.raises(ct.LimitError, match=r"dt \* omega_max"):
        ct.run(CIRCLE, t_end=0.1, dt=1e-5)
    with pytest.raises(ct.InputError, match="gravity"):
        ct.run(CIRCLE, t_end=0.1, courant=0.5, gravity=9.81)
    with pytest.raises(ct.InputError, match="elements"):
        replace(BEAM, elements=0)
    with pytest.raises(ct.InputError, match="flexible ring"):
        ct.run(
            replace(CIRCLE, ring=ct.bodies.ring_modes(RING, 2)),
            scheme=ct.scheme.Newmark(beta=0.5, gamma=0.55),
            t_end=0.1,
            dt=1e-4,
        )
    with pytest.raises(ct.InputError, match="law"):
        ct.run(CIRCLE, law=ct.Penalty(stiffness=1e9), scheme=ct.CentralDifference(), t_end=0.1, courant=0.5)
