"""Event-driven runs against closed forms: impacts of masses and rods, springs, damping, short contacts, bad input."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contact as ct

G = 10.0
BEAM = ct.gaps.Cantilever(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0)


def event_driven(what, t_end, dt, **more):
    """Run to `t_end`, with the state there as the last one."""
    given = {name: more.pop(name) for name in ("restitution", "modes") if name in more}
    more = {"record": ct.Record(state_every=1)} | more
    return ct.run(what, scheme=ct.scheme.EventDriven(**given), t_end=t_end, dt=dt, **more)


def dropped(height, e, time):
    """Height and velocity of a ball, and the speeds of its impacts before `time`; at rest after the last of them."""
    speed, at = math.sqrt(2.0 * G * height), math.sqrt(2.0 * height / G)
    if time < at:
        return height - 0.5 * G * time**2, -G * time, []
    speeds = [speed]
    speed *= e
    while speed > 1e-5 * speeds[0] and at + 2.0 * speed / G <= time:
        at += 2.0 * speed / G
        speeds.append(speed)
        speed *= e
    left = time - at
    return (
        (left * (speed - 0.5 * G * left), speed - G * left, speeds) if speed > 1e-5 * speeds[0] else (0.0, 0.0, speeds)
    )


@pytest.mark.parametrize("dt", [0.37, 1e-3])
def test_bounces_of_a_ball_are_those_of_the_closed_form(dt):
    mass = 2.0
    result = event_driven([ct.Wall(), ct.PointMass(mass=mass, x=5.0)], 7.0, dt, gravity=G, restitution=0.8)
    end = result.steps * result.dt
    height, velocity, speeds = dropped(5.0, 0.8, end)
    assert len(speeds) >= 5
    assert result.gap[-1, 0] == pytest.approx(height, rel=1e-12)
    assert result.motions[0].mean_velocity == pytest.approx(velocity, rel=1e-12)
    assert result.impulse[0] == pytest.approx(sum(1.8 * mass * v for v in speeds), rel=1e-12)
    lost = sum(0.5 * mass * v * v * (1.0 - 0.64) for v in speeds)
    assert result.energy.lost_in_contact == pytest.approx(lost, rel=1e-12)
    assert abs(result.energy.unaccounted) < 1e-13 * result.energy.scale


def test_a_ball_that_starts_on_the_wall_rebounds_at_once_and_loses_the_energy_of_its_impact():
    result = event_driven([ct.Wall(), ct.PointMass(mass=2.0, x=0.0, velocity=-3.0)], 1.0, 0.1, restitution=0.5)
    assert result.impulse[0] == pytest.approx(2.0 * 3.0 * 1.5, rel=1e-12)
    assert result.energy.lost_in_contact == pytest.approx(0.5 * 2.0 * 9.0 * (1.0 - 0.25), rel=1e-12)
    assert abs(result.energy.unaccounted) < 1e-13 * result.energy.scale


def test_a_ball_comes_to_rest_after_its_last_bounce_and_then_presses_with_its_weight():
    e = 0.5
    result = event_driven([ct.Wall(), ct.PointMass(mass=2.0, x=5.0)], 4.0, 0.01, gravity=G, restitution=e)
    rest = math.sqrt(2.0 * 5.0 / G) * (1.0 + 2.0 * e / (1.0 - e))  # sum of all flights
    left = 2.0 * 1e-5 * 10.0 / G / (1.0 - e)  # flights slower than 1e-5 of the first impact are left out
    assert result.intervals[0][-1][0] == pytest.approx(rest, abs=left)
    assert result.force[-1, 0] == pytest.approx(2.0 * G, rel=1e-12)
    assert result.impulse[0] == pytest.approx(2.0 * G * result.steps * result.dt, rel=2e-5)
    assert result.gap[-1, 0] == 0.0


def test_impulse_of_two_rods_converges_with_the_number_of_modes_at_any_step():
    rod = {"length": 0.254, "area": 6.4516e-4, "E": 206.8427e9, "rho": 7844.181}
    bodies = [ct.Rod(**rod, x=-0.254 - 2.54e-4, velocity=5.13588), ct.Rod(**rod)]
    exact = ct.reference.two_rods(bodies[1], gap=2.54e-4, velocity=5.13588)
    errors = [
        event_driven(bodies, 2.5e-4, dt, modes=modes).impulse[0] / exact.impulse - 1.0
        for modes, dt in ((10, 1e-6), (20, 2.5e-4), (40, 1e-7))
    ]
    assert abs(errors[0]) < 3e-3
    assert abs(errors[1]) < 0.7 * abs(errors[0])
    assert abs(errors[2]) < 0.7 * abs(errors[1])


def test_bouncing_bar_keeps_its_energy_and_has_the_impulse_of_six_impacts():
    bar = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, x=5.0)
    result = event_driven([bar, ct.Wall()], 16.0, 0.5, gravity=G, modes=25)
    energy = result.energy
    assert result.impulse[0] == pytest.approx(ct.reference.bouncing_bar(6).impulse, rel=1e-3)
    assert energy.end.total == pytest.approx(energy.start.total, rel=1e-13)
    assert len(result.intervals[0]) == 6


@pytest.mark.parametrize("stiffness", [1.0, 1e8, 1e16])
def test_a_mass_on_a_contact_spring_rebounds_after_half_a_period_however_stiff_the_spring(stiffness):
    mass, speed = 3.0, 2.0
    ball = ct.PointMass(mass=mass, x=1.0, velocity=-speed)
    result = event_driven([ct.Wall(), ball], 8.0, 0.25, law=ct.Penalty(stiffness=stiffness))
    begin, end = result.intervals[0][0]
    assert begin == pytest.approx(0.5, rel=1e-14)
    assert end - begin == pytest.approx(math.pi * math.sqrt(mass / stiffness), rel=1e-6 if stiffness > 1e10 else 1e-12)
    assert result.motions[0].mean_velocity == pytest.approx(speed, rel=1e-12)
    assert result.impulse[0] == pytest.approx(2.0 * mass * speed, rel=1e-6 if stiffness > 1e10 else 1e-12)


def test_energy_in_a_closed_contact_is_accounted_for():
    ball = ct.PointMass(mass=3.0, x=1.0, velocity=-2.0)
    result = event_driven([ct.Wall(), ball], 0.8, 0.1, law=ct.Penalty(stiffness=20.0))
    w, time = math.sqrt(20.0 / 3.0), result.steps * result.dt - 0.5
    assert result.gap[-1, 0] == 0.0  # the contact is closed: the spring takes the overlap
    assert result.energy.end.residual == pytest.approx(0.5 * 3.0 * 2.0**2 * math.sin(w * time) ** 2, rel=1e-12)
    assert result.impulse[0] == pytest.approx(3.0 * 2.0 * (1.0 - math.cos(w * time)), rel=1e-12)
    assert abs(result.energy.unaccounted) < 1e-13 * result.energy.scale


def test_many_short_contacts_of_a_mass_on_a_rod_of_many_modes_end():
    bodies = [ct.PointMass(mass=1.0, velocity=1.0), ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, fixed="right")]
    result = event_driven(bodies, 1.0, 1.6e-3, modes=200)
    assert abs(result.energy.unaccounted) < 1e-11 * result.energy.scale


def test_damped_modes_before_two_coupled_contacts_move_as_the_differential_equations_say():
    omega, zeta = np.array([0.0, 9.0, 22.0, 41.0]), np.array([0.0, 0.02, 0.05, 0.01])
    rows = np.random.default_rng(5).normal(size=(2, 4))
    S, clearance = np.array([[2e-3, 5e-4], [5e-4, 1e-3]]), np.array([0.02, 0.01])
    load, velocity = -rows.T @ [1.0, 1.6], np.array([0.3, -0.2, 0.4, 0.1])
    body = ct.ModalBody(omega=omega, zeta=zeta, channels=("a", "b"), rows=rows, S=S)
    patch = ct.Patch(body=body, normal=("a", "b"), clearance=clearance, load=load, velocity=velocity)

    def rate(_time, x):
        gap = clearance + rows @ x[:4]
        tried = [(), (0,), (1,), (0, 1)]
        lam = np.zeros(2)
        for closed in tried:  # the set whose forces press and whose open gaps are open
            lam = np.zeros(2)
            at = list(closed)
            lam[at] = -np.linalg.solve(S[np.ix_(at, at)], gap[at])
            if np.all(lam >= 0.0) and np.all((gap + S @ lam)[[i for i in range(2) if i not in closed]] >= 0.0):
                break
        return np.concatenate([x[4:], load - 2.0 * zeta * omega * x[4:] - omega**2 * x[:4] + rows.T @ lam])

    start = np.concatenate([np.zeros(4), velocity])
    end = solve_ivp(rate, (0.0, 1.0), start, method="DOP853", rtol=1e-9, atol=1e-12, max_step=2e-3).y[:4, -1]
    for dt in (1.0, 0.01):
        result = event_driven(patch, 1.0 + dt, dt, record=ct.Record(at=[1.0]))
        assert result.state[-1] == pytest.approx(end, abs=1e-7 * np.abs(end).max())
        assert abs(result.energy.unaccounted) < 1e-12 * result.energy.scale
        assert result.energy.damping < -1e-2 * result.energy.scale
    assert all(len(intervals) > 1 for intervals in result.intervals)


@pytest.mark.parametrize("dt", [0.05, 0.93e-3])
def test_contacts_shorter_than_a_step_are_not_missed(dt):
    w, inside = 2.0 * math.pi * 50.0, 1e-9  # touches for 3e-5 of a period
    body = ct.ModalBody(omega=[w], zeta=[0.0], channels=("x",), rows=[[1.0]], S=[[0.0]])
    start = {"displacement": [1e-3], "clearance": 1e-3 * (1.0 - inside)}
    patch = ct.Patch(body=body, normal=("x",), **start)
    result = event_driven(patch, 0.2, dt, restitution=1.0)
    speed = w * 1e-3 * math.sqrt(2.0 * inside - inside**2)
    count = (
        int(
            (result.steps * result.dt - math.acos(-1.0 + inside) / w)
            // ((2.0 * math.pi - 2.0 * math.acos(1.0 - inside)) / w)
        )
        + 1
    )
    assert count >= 10
    assert result.impulse[0] == pytest.approx(2.0 * speed * count, rel=1e-6)


def test_a_block_that_falls_flat_rests_on_both_feet():
    body = ct.ModalBody(
        omega=[0.0, 0.0],
        zeta=[0.0, 0.0],
        channels=("left", "right"),
        rows=[[0.5, 0.7], [0.5, -0.7]],
        S=np.zeros((2, 2)),
    )
    load = -np.array([0.5 * 4.0 * G, 0.0]) - 0.3 * np.array([0.0, 0.7])
    patch = ct.Patch(body=body, normal=("left", "right"), clearance=0.2, load=[load[0], 0.0])
    result = event_driven(patch, 1.0, 0.03)
    falls = math.sqrt(2.0 * 0.2 / (0.5 * 0.5 * 4.0 * G))
    assert [intervals[0][0] for intervals in result.intervals] == pytest.approx([falls, falls], rel=1e-12)
    assert result.force[-1] == pytest.approx([2.0 * G, 2.0 * G], rel=1e-9)
    assert result.max_penetration.max() < 1e-12


def test_a_rocking_block_comes_to_rest_on_the_reactions_of_statics():
    rows = np.array([[0.5, 0.7], [0.5, -0.9]])
    body = ct.ModalBody(
        omega=[0.0, 0.0], zeta=[0.0, 0.0], channels=("left", "right"), rows=rows, S=np.zeros((2, 2))
    )  # fmt: skip
    load = np.array([-20.0, 1.0])
    patch = ct.Patch(body=body, normal=("left", "right"), clearance=[0.2, 0.25], load=load, velocity=[0.0, 0.3])
    result = event_driven(patch, 3.0, 0.01, restitution=0.5)
    assert result.force[-1] == pytest.approx(np.linalg.solve(rows.T, -load), rel=1e-9)
    fallen = np.linalg.solve(rows, [-0.2, -0.25])
    assert result.energy.lost_in_contact == pytest.approx(0.5 * 0.3**2 + load @ fallen, rel=1e-9)
    assert abs(result.energy.unaccounted) < 1e-13 * result.energy.scale


def test_impacts_of_a_beam_do_not_depend_on_the_interval_of_the_samples():
    gap = BEAM.before_stop(clearance=1e-3, velocity=0.5, modes=5)
    runs = [event_driven(gap, 0.05 + dt, dt, record=ct.Record(at=[0.05])) for dt in (0.05, 1e-3, 7.8125e-6)]
    for run in runs[:-1]:
        assert run.state[-1] == pytest.approx(runs[-1].state[-1], abs=1e-9 * np.abs(runs[-1].state[-1]).max())
    assert runs[-1].energy.end.total == pytest.approx(runs[-1].energy.start.total, rel=1e-12)
    assert len(runs[-1].intervals[0]) > 5


def test_a_beam_stays_at_the_reaction_of_its_stop():
    gap = BEAM.before_stop(clearance=0.0, load=20.0, modes=4)
    side = gap.sides[0]
    damped = ct.ModalBody(omega=side.body.omega, zeta=np.full(4, 0.3), channels=("tip", "uniform"), rows=side.body.rows,
                          S=side.body.S)  # fmt: skip
    still = ct.PointGap(sides=(ct.gaps.Side(body=damped, channel="tip", sign=-1, load=side.load),), clearance=0.0)
    result = event_driven(still, 2.0, 0.1)
    pressed = float(gap.sides[0].body.S[0, 1]) * 20.0  # by the load through the residual compliance: outside of the run
    reaction = (3.0 * 20.0 * 0.5 / 8.0 * 0.5**3 / (3.0 * BEAM.EI) - pressed) / (0.5**3 / (3.0 * BEAM.EI))
    assert result.force[-1, 0] == pytest.approx(reaction, rel=1e-9)


@pytest.mark.parametrize(
    ("what", "given", "words"),
    [
        ([ct.Wall(), ct.PointMass(mass=1.0, x=1.0)], {"restitution": 1.2}, "restitution: found 1.2, expected 0 to 1"),
        ([ct.Wall(), ct.PointMass(mass=1.0, x=1.0)], {"modes": 0}, "modes: found 0"),
        ([ct.Wall(), ct.PointMass(mass=1.0, x=1.0)], {"law": ct.laws.Hertz(k=1e6)}, "expected Unilateral()"),
        ([ct.Wall(), ct.PointMass(mass=1.0, x=1.0)], {"dt": None}, "dt: found none"),
        (ct.LinearBody(M=[2.0], K=[[8.0]], Q=[[1.0]], gap0=[1.0]), {}, "expected rods and masses"),
    ],
)  # fmt: skip
def test_what_an_event_driven_run_refuses(what, given, words):
    with pytest.raises(ct.InputError) as error:
        event_driven(what, 1.0, given.pop("dt", 0.1), **given)
    assert words in str(error.value)


@pytest.mark.parametrize("others", [0, 1])
def test_modes_are_refused_only_where_they_are_critically_damped(others):
    """A mode of 3 rad/s without and with a second one; c = 2 w makes its pole a double one."""

    def run(c):
        m = 1 + others
        body = ct.ModalBody(
            omega=[3.0, 5.0][:m], zeta=np.zeros(m), channels=("a",), rows=np.ones((1, m)), S=np.zeros((1, 1)),
            damping=np.diag([c, 1.0][:m]),
        )  # fmt: skip
        return event_driven(ct.Patch(body=body, normal=("a",), clearance=0.1, velocity=np.full(m, -1.0)), 1.0, 0.1)

    with pytest.raises(ct.InputError, match="zeta: found critically damped modes"):
        run(6.0)
    below, above = (run(6.0 * (1.0 + off)) for off in (-1e-4, 1e-4))
    assert below.impulse == pytest.approx(above.impulse, rel=1e-3)
    assert max(abs(one.energy.unaccounted / one.energy.scale) for one in (below, above)) < 1e-11


def test_contacts_that_repeat_each_other_need_a_compliance():
    body = ct.ModalBody(omega=[3.0], zeta=[0.0], channels=("a", "b"), rows=[[1.0], [2.0]], S=np.zeros((2, 2)))
    with pytest.raises(ct.InputError, match="linearly dependent rigid contacts, expected a compliance"):
        event_driven(ct.Patch(body=body, normal=("a", "b"), clearance=1.0), 1.0, 0.1)


def patch(S, **given):
    body = ct.ModalBody(omega=[3.0, 5.0], zeta=[0.0, 0.0], channels=("a", "b"), rows=np.eye(2), S=S, **given)
    return ct.Patch(body=body, normal=("a", "b"), clearance=[1.0, 0.5])


@pytest.mark.parametrize(
    ("what", "words"),
    [
        (patch([[0.0, 1e-9], [1e-9, 1.0]]), "S: found a zero on the diagonal with other entries"),
        (patch([[1.0, 1.0], [1.0, 1.0]]), "S: found a singular compliance of the contacts"),
        (patch(np.zeros((2, 2)), damping=[[0.1, 0.2], [0.0, 0.1]]), "damping: found a matrix that is not symmetric"),
    ],
)
def test_contacts_have_unique_forces_and_bodies_symmetric_matrices(what, words):
    assert event_driven(patch(np.diag([0.0, 1.0]), damping=[[0.1, 0.2], [0.2, 0.5]]), 0.01, 0.01).steps == 1
    with pytest.raises(ct.InputError, match=words):
        event_driven(what, 1.0, 0.1)


def test_too_many_bounces_in_a_step_end_the_run_with_advice():
    ball = ct.PointMass(mass=1.0, x=1e-6)
    with pytest.raises(ct.NumericsError, match=r"opened and closed over 1000 times in a step of 10 s: give it a compl"):
        event_driven([ct.Wall(), ball], 10.0, 10.0, gravity=G, restitution=1.0)


def test_a_run_continues_from_a_checkpoint_with_identical_bits(tmp_path):
    gap = BEAM.before_stop(clearance=1e-3, velocity=0.5, modes=5)
    scheme, record = ct.scheme.EventDriven(), ct.Record(every=50)
    whole = ct.run(gap, scheme=scheme, t_end=0.05, dt=1e-6, record=record)
    again = ct.run(gap, scheme=scheme, t_end=0.05, dt=1e-6, record=record, checkpoint=tmp_path / "run.npz")
    assert np.array_equal(whole.force, again.force)
