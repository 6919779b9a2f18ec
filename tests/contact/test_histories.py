"""Histories for pictures: a row's mean force is its impulse, tips and rim meet where they touch, energies are those."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips

pytestmark = pytest.mark.slow  # they compile loops


def rubbed():
    rim = ct.RotatingRim(ring(), blade(), clearance=-1e-5, speed_hz=5.0, lean_deg=10.0, angle_deg=30.0)
    law = ct.Coulomb(mu=0.1)
    return rim, law, ct.run(rim, law=law, t_end=0.05, dt=2e-5, record=ct.Record(state_every=1))


def test_rows_of_forces_lose_no_impulse_and_no_peak():
    _, _, result = rubbed()
    table = ct.recovery.force_table(result, rows=100)
    assert len(table["time_s"]) == 100
    spans = np.diff(np.append(table["time_s"], result.time[-1] + result.dt)) / result.dt
    assert np.sum(table["force1_mean_N"] * spans) * result.dt == pytest.approx(result.impulse[0])
    assert table["force1_peak_N"].max() == result.peak_force[0]
    assert table["gap1_least_m"].min() == result.gap.min()
    whole = ct.recovery.force_table(result)
    np.testing.assert_allclose(whole["force1_mean_N"], result.force[:, 0], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("make", ["rim", "rub", "second blade"])
def test_tip_and_rim_meet_where_they_touch(make):
    """While contact is closed, clearance + rim - tip along the normal is zero, residual compliance included."""
    if make == "rim":
        what, law, result = rubbed()
        closed = result.force[:, 0] > 0.05 * result.peak_force[0]
    else:
        second = make == "second blade"
        blades = [nodes(1, seed=3), nodes(1)] if second else [nodes(1)]
        what = ct.Rub(rim3(), blades, tips(1, blade=int(second)), clearance=-2e-5, speed=ct.Speed.constant(5.0))
        law = ct.Coulomb(mu=0.1)
        result = ct.run(what, law=law, t_end=0.02, dt=5e-6, record=ct.Record(state_every=1))
        closed = result.tip_force[:, 0] > 0.2 * result.peak_force[0]
    motion = ct.recovery.tip_motion(what, result)
    gap = what.clearance + motion.rim[:, 0] - motion.tip[:, 0]
    assert closed.sum() > 20
    assert np.abs(gap[closed]).max() < 0.05 * np.abs(motion.rim[closed, 0]).max()
    assert np.abs(motion.tip[:, 1]).max() > 0.0


@pytest.mark.parametrize(("t_end", "state_every", "stretches"), [(0.05, 1, 1), (5.0, 100, 8)])
def test_a_film_shows_the_rim_where_the_tips_are(t_end, state_every, stretches):
    """The harmonics that a film keeps give the rim at the tip, over the whole run and in stretches."""
    what = ct.RotatingRim(ring(), blade(), clearance=-1e-5, speed_hz=5.0, lean_deg=10.0, angle_deg=30.0)
    record = ct.Record(every=state_every, state_every=state_every)
    result = ct.run(what, law=ct.Coulomb(mu=0.1), t_end=t_end, dt=2e-5, record=record)
    motion, found = ct.recovery.tip_motion(what, result), ct.recovery.rub_film(what, result)
    assert len(found.stretches) == stretches
    assert len(found.time) <= 2000 < len(result.state_time)
    assert found.profile.size == 360
    if stretches > 1:  # the first begins with the run, and the last ends with it
        assert found.time[[0, -1]].tolist() == result.state_time[[0, -1]].tolist()
    parts = np.split(found.time, found.stretches[1:])
    assert max(np.ptp(np.diff(part)) for part in parts) < 1e-9  # even steps within each
    assert all(after[0] > before[-1] + 1e-9 for before, after in pairwise(parts))
    at = np.searchsorted(result.state_time, found.time)
    np.testing.assert_array_equal(result.state_time[at], found.time)
    phi = np.multiply.outer(found.angle - found.turned, found.n)
    rim = np.sum(found.cos * np.cos(phi) + found.sin * np.sin(phi), axis=1)
    left_out = rim - motion.rim[at, 0]
    assert np.linalg.norm(left_out) < 0.05 * np.linalg.norm(motion.rim[at, 0])
    assert np.median(np.abs(left_out)) < 1e-3 * np.abs(motion.rim[:, 0]).max()
    np.testing.assert_allclose(found.gap[:, 0], result.gap[np.searchsorted(result.time, found.time), 0])


def test_a_film_needs_two_states_and_samples_and_rods_have_none():
    what, _, result = rubbed()
    for count in (1, 2):
        few = replace(result, state=result.state[:count], state_time=result.state_time[:count])
        assert (ct.recovery.rub_film(what, few) is None) == (count < 2)
    assert ct.recovery.rub_film(what, replace(result, time=result.time[:0])) is None
    rods = [ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=10, x=0.1, velocity=-1.0), ct.Wall()]
    assert ct.recovery.rub_film(rods, ct.run(rods, t_end=0.1, courant=0.9, record=ct.Record(state_every=1))) is None


def test_a_film_of_tips_on_two_lines_has_those_of_the_first_line_and_its_radius_profile_and_forces():
    """The rim of the second line is another: its tips are left out and counted."""
    rim = replace(rim3(), lines=np.array([[0.0, 0.4], [0.1, 0.5]]))
    points = [replace(one, line=1 - one.line) for one in tips(3)]
    out = [{"p": 2, "cos": 1e-5, "sin": 2e-5}, {"p": 3, "cos": -3e-5}]
    what = ct.Rub(
        rim,
        [nodes(3)],
        points,
        clearance=-2e-5,
        speed=ct.Speed.constant(30.0),
        profile=ct.gaps.RimProfile.fourier(out),
        turning="casing",
    )
    result = ct.run(what, law=ct.Coulomb(mu=0.1), t_end=0.01, dt=5e-6, record=ct.Record(every=3, state_every=3))
    found = ct.recovery.rub_film(what, result, places=8)
    theta = 2.0 * np.pi * np.arange(8) / 8
    profile = 1e-5 * np.cos(2 * theta) + 2e-5 * np.sin(2 * theta) - 3e-5 * np.cos(3 * theta)
    np.testing.assert_allclose(found.profile, profile, atol=1e-18)
    assert (found.radius, found.left_out) == (0.5, 1)
    np.testing.assert_allclose(found.angle, np.radians([10.0, 11.0]))
    np.testing.assert_allclose(found.turned, 2.0 * np.pi * 30.0 * found.time, atol=1e-12)
    near = np.searchsorted(result.time, found.time)
    np.testing.assert_array_equal(found.gap, result.gap[near][:, [0, 2]])
    np.testing.assert_array_equal(found.force, result.windowed_force()[near][:, [0, 2]])
    assert found.stretches.tolist() == [0]
    power = np.mean(result.state_of("casing") ** 2, axis=0)
    omega = np.sqrt(power @ rim.omega**2 / power.sum())
    every = int(2.0 * np.pi / (8.0 * omega * 3 * result.dt))
    assert every > 1
    np.testing.assert_array_equal(found.time, result.state_time[::every])
    casing = ct.recovery.casing_motion(what, result)[::every]
    own = casing[:, 3 * 11 : 4 * 11]  # of the second line: three directions of eleven waves before it
    np.testing.assert_allclose(found.cos, own[:, found.n])
    sines = np.hstack([np.zeros((len(own), 1)), own[:, 6:]])
    np.testing.assert_allclose(found.sin, sines[:, found.n], atol=1e-20)


@pytest.mark.parametrize(
    ("amplitudes", "kept"),
    [
        ([0.0, 1.0, 0.0, 1e-3], [1]),
        ([1.0, 0.0, 0.0, 5.0**0.5, 3.0**0.5], [0, 3, 4]),
        (np.sqrt(np.arange(40.0)), list(range(20, 40))),  # no more than twenty, the largest
    ],
)
def test_a_film_keeps_the_harmonics_that_have_the_motion(amplitudes, kept):
    """One mode of the rim, with these amplitudes of 1, cos theta, cos 2 theta, ..."""
    N = len(amplitudes) - 1
    rows = np.zeros((2 * (2 * N + 1), 1))
    rows[: N + 1, 0] = amplitudes
    casing = ct.ModalBody(
        omega=[600.0], zeta=[0.0], channels=ct.bodies.rim_channels(N), rows=rows, S=np.zeros((len(rows),) * 2),
        kind="rim", n_max=N, radius=0.5,
    )  # fmt: skip
    rim = ct.RotatingRim(casing, blade(), clearance=1e-2, speed_hz=5.0, casing_velocity=[1e-3])
    result = ct.run(rim, t_end=0.05, dt=1e-4, record=ct.Record(state_every=1))
    assert ct.recovery.rub_film(rim, result).n.tolist() == kept


def test_energies_are_those_of_the_modes_and_what_has_none_has_no_history():
    rim, law, result = rubbed()
    found = ct.recovery.strain_energy(rim, result)
    assert set(found) == {"casing", "blade"}
    omega = np.concatenate([rim.casing.omega, rim.blade.omega])
    whole = 0.5 * np.sum((result.state[:, : omega.size] * omega) ** 2, axis=1)
    np.testing.assert_allclose(found["casing"] + found["blade"], whole)
    bare = ct.run(rim, law=law, t_end=0.01, dt=2e-5, record=ct.Record())
    assert ct.recovery.strain_energy(rim, bare) == {}
    assert ct.recovery.tip_motion(rim, bare) is None
    rods = [ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=10, x=0.1, velocity=-1.0), ct.Wall()]
    moved = ct.run(rods, t_end=1.0, courant=0.9, record=ct.Record(state_every=1))
    assert ct.recovery.tip_motion(rods, moved) is None
    assert ct.recovery.strain_energy(rods, moved) == {}
    assert ct.recovery.force_table(replace(bare, time=bare.time[:0], force=bare.force[:0]))["time_s"].size == 0


def wandering(turns, hz=40.0, turning="blades", record=None):
    """A blade that leans and a rim that rubs, over some turns from an angle that is not zero."""
    rim = ct.RotatingRim(
        ring(S=4e-7, zeta=0.3), blade(S=1e-6, zeta=0.3), clearance=-1e-5, speed_hz=hz, angle_deg=75.0,
        out_of_roundness=[{"p": 2, "cos": 1.2e-4}], turning=turning,
    )  # fmt: skip
    record = ct.Record(every=7, state_every=7) if record is None else record
    return rim, ct.run(rim, t_end=turns / abs(hz), dt=2e-5, record=record)


@pytest.mark.parametrize("hz", [40.0, -40.0])
@pytest.mark.parametrize(("bars", "rows"), [(36, 160), (50, 2), (7, 3)])
def test_forces_over_the_angle_are_the_largest_at_their_place_and_turn(hz, bars, rows):
    """By a loop over samples: the tip is at its angle less that turned, on a casing at rest."""
    what, result = wandering(5.3, hz)
    found = ct.recovery.force_over_angle(what, result, bars=bars, rows=rows)
    each = {160: 1, 2: 3, 3: 2}[rows]
    count = 5 // each
    expected = np.full((count, bars), np.nan)
    for t, force in zip(result.time, result.windowed_force()[:, 0], strict=True):
        turned = 2.0 * np.pi * hz * (t - result.time[0])
        row = min(int(abs(turned) / (2.0 * np.pi * each)), count - 1)
        place = int((np.radians(75.0) - 2.0 * np.pi * hz * t) % (2.0 * np.pi) / (2.0 * np.pi) * bars)
        expected[row, place] = np.nanmax([expected[row, place], force])
    np.testing.assert_array_equal(found.force, expected)
    assert np.nanmax(expected) > 0.0
    np.testing.assert_allclose(found.angle_deg, 360.0 * np.arange(bars + 1) / bars)
    assert (found.time[0], found.time[-1]) == (result.time[0], result.time[-1])
    np.testing.assert_allclose(np.diff(found.time)[: count - 1], each / 40.0, atol=8 * 2e-5)


def some(result, *parts):
    """A result with some of its samples and states, as of a run that was recorded unevenly."""
    kept = np.unique(np.concatenate([np.arange(len(result.time))[part] for part in parts]))
    changed = {}
    for name in ("time", "force", "gap", "impulse_history", "state_time", "state", "tip_force"):
        changed[name] = getattr(result, name)[kept]
    return replace(result, **changed)


def test_turns_are_those_from_the_first_to_the_last_sample():
    """Of 5.3 turns, 3.9 are left after 1.4, and as many if only the first or the last sample is beyond them."""
    what, result = wandering(5.3)
    turn = len(result.time) / 5.3
    late, early = slice(int(1.4 * turn), None), slice(0, int(3.9 * turn))
    for parts in ([late], [early], [slice(0, 1), slice(int(2.0 * turn), int(3.9 * turn))],
                  [early, slice(-1, None)], [slice(0, 1), slice(-1, None)]):  # fmt: skip
        found = some(result, *parts)
        turns = int((found.time[-1] - found.time[0]) * 40.0)
        assert ct.recovery.force_over_angle(what, found).force.shape == (turns, 180)
    assert ct.recovery.force_over_angle(what, some(result, slice(0, 1))) is None


def test_a_section_is_of_the_second_half_from_the_first_to_the_last_state():
    what, result = wandering(17.2)
    turn = len(result.time) / 17.2
    for first, last in ((3.0, 17.2), (0.0, 15.5)):
        parts = [slice(0, 1), slice(int(first * turn), int(last * turn)), slice(-1, None)]
        found = some(result, *parts)
        np.testing.assert_allclose(ct.recovery.once_a_turn(what, found).time, np.arange(9, 18) / 40.0)
    assert ct.recovery.rim_motion(what, some(result, slice(0, 2))).deflection.size == 2
    assert ct.recovery.rim_motion(what, some(result, slice(0, 1))) is None


def test_less_than_a_turn_and_other_problems_have_no_forces_over_the_angle():
    assert ct.recovery.force_over_angle(*wandering(0.95)) is None
    assert ct.recovery.force_over_angle(*wandering(1.05)).force.shape == (1, 180)
    rods = [ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=10, x=0.1, velocity=-1.0), ct.Wall()]
    moved = ct.run(rods, t_end=1.0, courant=0.9, record=ct.Record(state_every=1))
    assert ct.recovery.force_over_angle(rods, moved) is None
    assert ct.recovery.once_a_turn(rods, moved) is None
    assert ct.recovery.rim_motion(rods, moved) is None


@pytest.mark.parametrize("hz", [40.0, -40.0])
def test_a_section_has_the_motion_at_whole_turns_of_the_second_half(hz):
    what, result = wandering(17.2, hz)
    found, motion = ct.recovery.once_a_turn(what, result), ct.recovery.tip_motion(what, result)
    np.testing.assert_allclose(found.time, np.arange(9, 18) / 40.0, rtol=1e-12)
    np.testing.assert_array_equal(found.displacement, np.interp(found.time, motion.time, motion.tip[:, 0]))
    middle = (motion.tip[2:, 0] - motion.tip[:-2, 0]) / (motion.time[2:] - motion.time[:-2])
    np.testing.assert_allclose(found.velocity, np.interp(found.time, motion.time[1:-1], middle), rtol=1e-6)
    assert ct.recovery.once_a_turn(*wandering(15.2, hz)).time.size == 8
    assert ct.recovery.once_a_turn(*wandering(14.9, hz)) is None  # seven turns in the second half
    for every, enough in ((124, True), (127, False)):  # 1250 steps in a turn
        states = ct.Record(every=every, state_every=every)
        assert (ct.recovery.once_a_turn(*wandering(17.2, hz, record=states)) is not None) == enough


@pytest.mark.parametrize(("hz", "turning", "sign"), [(40.0, "blades", -1), (-40.0, "blades", 1), (40.0, "casing", -1)])
def test_waves_of_a_rim_are_its_channels_and_sum_up_to_its_deflection(hz, turning, sign):
    what, result = wandering(1.5, hz, turning)
    found, channels = ct.recovery.rim_motion(what, result), ct.recovery.casing_motion(what, result)
    N = what.casing.n_max
    np.testing.assert_allclose(found.waves.real, channels[:, : N + 1], atol=1e-18)
    np.testing.assert_allclose(found.waves.imag[:, 1:], channels[:, N + 1 : 2 * N + 1], atol=1e-18)
    theta = np.linspace(0.0, 2.0 * np.pi, 2881)
    around = (found.waves[:, :, None] * np.exp(-1j * np.arange(N + 1)[:, None] * theta)).real.sum(axis=1)
    np.testing.assert_allclose(found.deflection, np.abs(around).max(axis=1), rtol=2e-3)
    assert found.largest == found.deflection.max()
    assert (found.wall, found.allowed) == (np.inf, np.inf)
    assert found.with_blades == sign
    thick = replace(what, casing=replace(what.casing, thickness=0.02))
    assert ct.recovery.rim_motion(thick, result).allowed == 0.01
