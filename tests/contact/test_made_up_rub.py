"""Forces, motions and films of a rub whose result is made up: every sum written out once more, tip by tip."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact import histories as film
from contact.histories import force_table, strain_energy, tip_motion
from contact.recovery import at_points, rub_forces
from tests.contact.synthetic_rub import N_MAX, SIZE, nodes, rim3

STILL = ct.record.Stored(kinetic=0.0, strain=0.0, potential=0.0, residual=0.0, discrete=0.0)
TIPS = tuple(
    ct.ContactPoint(
        blade=blade, line=line, span=f"node{k}.span", flap=f"node{k}.flap", axial=f"node{k}.chord", angle_deg=angle,
        lean_deg=lean,
    )
    for blade, line, k, angle, lean in ((1, 1, 0, 25.0, 15.0), (0, 0, 1, 130.0, -20.0), (0, 1, 0, 200.0, 5.0))
)  # fmt: skip
RUB = ct.Rub(
    rim3(), [nodes(2), nodes(1, seed=6)], TIPS, speed=ct.Speed.constant(7.0),
    profile=ct.RimProfile.fourier([{"p": 3, "cos": 1e-4, "sin": 2e-4}]),
)  # fmt: skip
STATES = 6
RNG = np.random.default_rng(4)
TIME = 0.01 * np.arange(11)
DRAWN = RNG.standard_normal((STATES, 10 + 3 + 3 + 9))
RESULT = ct.Result(
    time=TIME,
    force=RNG.random((11, 3)),
    gap=RNG.standard_normal((11, 3)),
    impulse_history=np.cumsum(0.01 * RNG.random((11, 3)), axis=0),
    impulse=np.ones(3),
    peak_force=np.ones(3),
    max_penetration=np.zeros(3),
    residual=np.zeros(3),
    contact_steps=np.ones(3),
    reversals=np.zeros(3),
    state_time=TIME[::2],
    state=DRAWN[:, :16],
    tip_force=DRAWN[:, 16:],
    intervals=((), (), ()),
    energy=ct.record.EnergyBudget(start=STILL, end=STILL, contact=0.0, rotation=0.0, friction=0.0, damping=0.0),
    motions=(),
    blocks=(("casing", 0, 10), ("blade 1", 10, 13), ("blade 2", 13, 16)),
    steps=11,
    dt=0.01,
    window=0.05,
    seconds=0.1,
    scheme="made up",
    source={},
    channels=np.zeros((0, 25)),
)
FORCES = RESULT.tip_force.reshape(STATES, 3, 3)
PHI = np.radians([25.0, 130.0, 200.0]) - 2.0 * math.pi * 7.0 * TIME[::2, None]  # (states, tips)
ROUND = np.array([[math.cos(n * a) for n in range(6)] + [math.sin(n * a) for n in range(1, 6)] for a in PHI.ravel()])
ROUND = ROUND.reshape(STATES, 3, SIZE)
LEANS = np.radians([15.0, -20.0, 5.0])


def test_forces_on_the_casing_are_those_of_the_tips_at_their_angles():
    expected = np.zeros((STATES, 2, 3, SIZE))  # by line and direction
    for s in range(STATES):
        for j, tip in enumerate(TIPS):
            for i in range(3):
                expected[s, tip.line, i] += FORCES[s, j, i] * ROUND[s, j]
    time, found = rub_forces(RUB, RESULT, "casing")
    np.testing.assert_array_equal(time, TIME[::2])
    np.testing.assert_allclose(found, expected.reshape(STATES, -1), rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize(("name", "channels", "own"), [("blade 1", 6, ((1, 3), (2, 0))), ("blade 2", 3, ((0, 0),))])
def test_forces_on_a_blade_push_against_its_normal(name, channels, own):
    expected = np.zeros((STATES, channels))
    for j, at in own:
        c, s = math.cos(LEANS[j]), math.sin(LEANS[j])
        normal, along, axial = FORCES[:, j].T
        expected[:, at] -= c * normal - s * along
        expected[:, at + 1] -= s * normal + c * along
        expected[:, at + 2] -= axial
    np.testing.assert_allclose(rub_forces(RUB, RESULT, name)[1], expected, rtol=1e-12, atol=1e-13)


def test_names_without_forces_and_results_without_states_are_refused():
    with pytest.raises(ct.InputError, match="found 'blade 3', expected one of casing, blade 1, blade 2"):
        rub_forces(RUB, RESULT, "blade 3")
    bare = replace(RESULT, state=RESULT.state[:0], tip_force=RESULT.tip_force[:0], state_time=TIME[:0])
    with pytest.raises(ct.InputError, match="state: found none stored, expected a record with state_every or at"):
        rub_forces(RUB, bare, "casing")


def test_points_move_by_their_modes_and_their_own_compliance():
    body, q, forces = nodes(1), np.array([[1.0, -2.0, 3.0]]), np.array([[10.0, 20.0, -5.0]])
    with pytest.raises(ct.InputError, match="recovery: found none in this basis"):
        at_points(body, q, forces)
    rows = np.array([[1.0, 2.0, 3.0], [0.0, 1.0, -1.0]])
    kept = replace(body, recovery=rows)
    assert at_points(kept, q, forces).tolist() == [[6.0, -5.0]]
    whole = replace(kept, recovery_S=np.array([[0.1, 0.2, 0.3], [-0.1, 0.0, 0.2]]))
    np.testing.assert_allclose(at_points(whole, q, forces), [[6.0 + 3.5, -5.0 - 2.0]], rtol=1e-14)


def rim_channels():
    """Motion of the casing by line and direction, residual compliance included."""
    moved = RESULT.state_of("casing") @ RUB.casing.rows.T + rub_forces(RUB, RESULT, "casing")[1] @ RUB.casing.S.T
    return moved.reshape(STATES, 2, 3, SIZE)


def test_the_first_tip_and_the_rim_before_it_move_as_their_channels():
    motion = tip_motion(RUB, RESULT)
    np.testing.assert_array_equal(motion.time, TIME[::2])
    rim = [[rim_channels()[s, 1, i] @ ROUND[s, 0] for i in (0, 1)] for s in range(STATES)]
    np.testing.assert_allclose(motion.rim, rim, rtol=1e-11, atol=1e-12)
    body = RUB.blades[1]
    span, flap, _ = (RESULT.state_of("blade 2") @ body.rows.T + rub_forces(RUB, RESULT, "blade 2")[1] @ body.S.T).T
    c, s = math.cos(LEANS[0]), math.sin(LEANS[0])
    np.testing.assert_allclose(motion.tip, np.stack([c * span + s * flap, c * flap - s * span], axis=1), rtol=1e-11)


def without_states(count):
    few = {name: getattr(RESULT, name)[:count] for name in ("state", "tip_force", "state_time")}
    return replace(RESULT, **few)


def test_motions_need_two_states_and_no_channels():
    assert tip_motion(RUB, without_states(2)) is not None
    assert film.rub_film(RUB, without_states(2)) is not None
    for result in (without_states(1), replace(RESULT, channels=np.ones((1, 25)))):
        assert tip_motion(RUB, result) is None
        assert film.rub_film(RUB, result) is None
    assert film.rub_film(RUB, replace(RESULT, time=TIME[:0])) is None
    assert film.rub_film([ct.Wall()], RESULT) is None
    assert tip_motion([ct.Wall()], RESULT) is None


def test_strain_energy_is_half_the_square_of_frequency_times_motion():
    found = strain_energy(RUB, RESULT)
    assert list(found) == ["casing", "blade 1", "blade 2"]
    for name, omega in (("casing", RUB.casing.omega), ("blade 1", [700.0, 2300.0, 8000.0])):
        q = RESULT.state_of(name)
        expected = [sum(0.5 * w**2 * x**2 for w, x in zip(omega, row, strict=True)) for row in q]
        np.testing.assert_allclose(found[name], expected, rtol=1e-12)
    assert len(strain_energy(RUB, without_states(1))["casing"]) == 1
    assert strain_energy(RUB, without_states(0)) == {}
    assert strain_energy(RUB, replace(RESULT, channels=np.ones((1, 25)))) == {}


def test_a_film_has_the_line_of_the_first_tip_and_all_tips_on_it():
    shown = film.rub_film(RUB, RESULT, places=8)
    at = [int(np.flatnonzero(TIME[::2] == time)[0]) for time in shown.time]
    channels = rim_channels()[at, 1, 0]
    cos, sin = channels[:, : N_MAX + 1], np.hstack([np.zeros((len(at), 1)), channels[:, N_MAX + 1 :]])
    np.testing.assert_allclose(shown.cos, cos[:, shown.n], rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(shown.sin, sin[:, shown.n], rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(shown.turned, 2.0 * math.pi * 7.0 * shown.time, rtol=1e-12)
    theta = 2.0 * math.pi * np.arange(8) / 8
    np.testing.assert_allclose(shown.profile, 1e-4 * np.cos(3.0 * theta) + 2e-4 * np.sin(3.0 * theta), atol=1e-17)
    assert (shown.radius, shown.left_out, shown.stretches.tolist()) == (0.4, 1, [0])
    np.testing.assert_allclose(shown.angle, np.radians([25.0, 200.0]), rtol=1e-14)
    rows = [2 * k for k in at]
    np.testing.assert_array_equal(shown.gap, RESULT.gap[rows][:, [0, 2]])
    np.testing.assert_array_equal(shown.force, RESULT.windowed_force()[rows][:, [0, 2]])
    assert len(film.rub_film(RUB, RESULT).profile) == 360
    late = replace(RESULT, state_time=RESULT.state_time + 0.02)  # the last lies after all samples
    np.testing.assert_array_equal(film.rub_film(RUB, late).gap[-1], RESULT.gap[-1, [0, 2]])


def stored(count, step, mode=0):
    """States in which one mode of the casing moves alone."""
    state = np.zeros((count, 16))
    state[:, mode] = 1e-3 * np.cos(np.arange(count))
    return replace(RESULT, state=state, tip_force=np.zeros((count, 9)), state_time=step * np.arange(count))


def test_a_film_has_eight_frames_in_a_period_of_the_motion():
    """The first mode turns with 300 rad/s: 1e-4 s between states, 2 pi / 300 / 8 s between frames: 26 states."""
    result = stored(200, 1e-4)
    at, stretches = film.frames(RUB, result, 100)
    assert (at.tolist(), stretches.tolist()) == (list(range(0, 200, 26)), [0])
    assert film.frames(RUB, stored(200, 1.0), 200)[0].tolist() == list(range(200))
    resting = replace(result, state=np.zeros((200, 16)))
    assert film.frames(RUB, resting, 200)[0].tolist() == list(range(200))
    both = replace(result, state=stored(200, 1e-4).state + stored(200, 1e-4, mode=2).state)
    omega = math.sqrt((300.0**2 + RUB.casing.omega[2] ** 2) / 2.0)
    every = math.floor(2.0 * math.pi / (8.0 * 1e-4 * omega))
    assert every > 1
    assert film.frames(RUB, both, 200)[0].tolist() == list(range(0, 200, every))


def test_a_run_too_long_is_shown_in_eight_stretches_from_its_begin_to_its_end():
    result = stored(26 * 40 + 1, 1e-4)
    at, stretches = film.frames(RUB, result, 39)  # four frames in each of the eight
    assert stretches.tolist() == list(range(0, 32, 4))
    parts = at.reshape(8, 4)
    assert (np.diff(parts, axis=1) == 26).all()
    assert (parts[0, 0], parts[-1, -1]) == (0, 26 * 40)
    assert np.ptp(np.diff(parts[:, 0])) <= 1
    assert film.frames(RUB, stored(26 * 40, 1e-4), 40)[1].tolist() == [0]  # as many as fit, whole


def test_the_harmonics_kept_are_the_fewest_with_nearly_all_of_the_motion():
    cos, sin = np.array([[0.0, 3.0, 0.0, 1e-2], [0.0, 3.0, 1.0, 0.0]]), np.zeros((2, 4))
    assert film.largest(cos, sin).tolist() == [1, 2]
    assert film.largest(sin, cos).tolist() == [1, 2]
    assert film.largest(np.array([[1.0, 1.0]]), np.array([[0.0, 0.02]])).tolist() == [0, 1]
    assert film.largest(np.array([[1.0, 0.02]]), np.zeros((1, 2))).tolist() == [0, 1]
    assert film.largest(np.array([[1.0, 0.005]]), np.zeros((1, 2))).tolist() == [0]
    assert film.largest(np.zeros((1, 3)), np.zeros((1, 3))).tolist() == [0, 1, 2]


@pytest.mark.parametrize(("rows", "starts"), [(11, range(11)), (10, range(0, 11, 2)), (4, (0, 3, 6, 9)), (1, (0,))])
def test_a_row_of_forces_sums_up_its_samples(rows, starts):
    table = force_table(RESULT, rows)
    ends = [*[*starts][1:], 11]
    impulse = np.vstack([np.zeros(3), RESULT.impulse_history])  # up to half a step after each sample
    np.testing.assert_array_equal(table["time_s"], TIME[[*starts]])
    for k in range(3):
        for row, (a, b) in enumerate(zip(starts, ends, strict=True)):
            mean = (impulse[b, k] - impulse[a, k]) / (0.01 * (b - a))
            assert table[f"force{k + 1}_mean_N"][row] == pytest.approx(mean, rel=1e-11)
            assert table[f"force{k + 1}_peak_N"][row] == RESULT.force[a:b, k].max()
            assert table[f"gap{k + 1}_least_m"][row] == RESULT.gap[a:b, k].min()
    assert len(table) == 10
