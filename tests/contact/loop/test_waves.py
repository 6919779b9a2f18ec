"""Rows as sums of waves: the same in blocks, in lanes and as formulas."""

import numpy as np
import pytest

import contact as ct
from contact.jit.compiled import jit_entry
from contact.jit.vector import load, put
from contact.loop.batch.step import add_up, touch
from contact.loop.batch.waves import (
    FORCE,
    FREE,
    SCALE,
    TEST,
    cosine,
    fill_lanes,
    half_turns,
    sign_of,
    sine,
    skip_in_batch,
    within,
)
from contact.model.gaps.limits import REACHED, TIP
from contact.model.gaps.modal_system import NOISE, rim_system
from contact.model.trig import Terms
from contact.scheme.modal.batch import WIDTH, Job, Layout, batch
from tests.contact.synthetic_rim import blade, ring


def system(imperfect, cos=2.5e-4):
    rim = ct.RotatingRim(
        ring(S=4e-7, imperfect=imperfect), blade(S=1e-6), clearance=2e-4, speed_hz=20.0, lean_deg=25.0,
        out_of_roundness=[{"p": 2, "cos": cos}, {"p": 5, "sin": 1e-5}],
    )  # fmt: skip
    return rim_system(rim)


def rows_at(system, phi):
    """Normal rows, then clearance, S_nn, S_nt, S_tt, as formulas."""
    found = [part(phi) for part in (system.clearance, system.S_nn, system.S_nt, system.S_tt)]
    return np.concatenate([system.table.rows(phi)[0], found])


@jit_entry
def both(phi, found):
    """Cosines and sines of eight angles."""
    turns = half_turns(load(phi, 0))
    x, sign = within(load(phi, 0), turns), sign_of(turns)
    put(found, 0, sign * cosine(x))
    put(found, WIDTH, sign * sine(x))


@jit_entry
def sum_lanes(terms, waves, found):
    """Rows of eight runs."""
    fill_lanes(terms, waves, found)


@pytest.mark.parametrize("largest", [1.0, 1e3, 1e6])
def test_eight_cosines_and_sines_to_round_off(largest):
    rng, found = np.random.default_rng(7), np.zeros((2, WIDTH))
    for _ in range(500):
        phi = rng.uniform(-largest, largest, WIDTH)
        both(phi, found)
        assert np.abs(found - [np.cos(phi), np.sin(phi)]).max() < 4e-16


def in_lanes(layout, lanes, sums, phi):
    """Rows (sums + 1, 8) at one angle; the last is that of no sum."""
    n = np.arange(layout.top // 2 + 1)
    waves = np.repeat(np.stack([np.cos(n * phi), np.sin(n * phi)], axis=1)[:, :, None], WIDTH, axis=2)
    found = np.full((sums + 1, WIDTH), np.nan)
    sum_lanes(lanes, np.ascontiguousarray(waves), found)
    return found


@pytest.mark.slow
def test_lanes_of_unlike_runs_hold_the_rows_of_each():
    systems = [system(0.0), system(0.05), system(0.05, cos=1e-4)]
    parts = [one.sums()[0] for one in systems]
    layout = Layout.of(parts)
    lanes, m, phi = layout.empty(parts[0]), systems[0].omega.size, 0.77
    assert not layout.alike
    assert lanes.row.size == lanes.start.size - 1 == m + 4
    for k, part in enumerate(parts):
        layout.load(lanes, part, k)
    found = in_lanes(layout, lanes, m + 4, phi)
    for k, one in enumerate(systems):
        assert np.allclose(found[: m + 4, k], rows_at(one, phi), rtol=0.0, atol=1e-14)
    assert not found[: m + 4, 3:].any()


def test_like_runs_share_their_coefficients():
    """In blocks of four rows, the last filled up with none."""
    systems = [system(0.05), system(0.05, cos=1e-4)]
    parts = [one.table.terms()[0] for one in systems]
    layout = Layout.of(parts)
    lanes, m, phi = layout.empty(parts[0]), systems[0].omega.size, 0.77
    assert layout.alike
    assert np.array_equal(np.sort(lanes.alike[lanes.alike != 0.0]), np.sort(parts[0].value))
    assert lanes.row.size == 4 * (lanes.start.size - 1) >= m
    found = in_lanes(layout, lanes, m, phi)
    assert np.allclose(found[:m], systems[0].table.rows(phi)[0][:, None], rtol=0.0, atol=1e-14)
    assert not found[m].any() or m % 4 == 0


@pytest.mark.parametrize("unlike", [[1.0, 3.0], [1.0, 3.0, 1.0], [1.0, 1.0, 3.0], [3.0, 1.0, 1.0]])
def test_runs_of_which_any_two_differ_keep_their_own_coefficients(unlike):
    parts = [Terms(start=np.arange(3), wave=np.array([2, 5]), value=np.array([7.0, last])) for last in unlike]
    layout = Layout.of(parts)
    lanes = layout.empty(parts[0])
    assert not layout.alike
    for k, part in enumerate(parts):
        layout.load(lanes, part, k)
    assert lanes.value[layout.place, : len(parts)].tolist() == [[7.0] * len(parts), unlike]


def test_rows_with_the_same_waves_stand_together():
    """Sums 0, 3, 4 and 6 have wave 2, the others wave 5."""
    wave = np.array([2, 5, 5, 2, 2, 5, 2])
    layout = Layout.of([Terms(start=np.arange(8), wave=wave, value=np.ones(7))])
    assert layout.row.tolist() == [8 * row for row in (0, 3, 4, 6, 1, 2, 5, 7)]
    assert (layout.start.tolist(), layout.wave.tolist()) == ([0, 1, 2], [16, 40])
    assert layout.place.tolist() == [0, 4, 5, 1, 2, 6, 3]


def test_cosines_and_sines_below_the_noise_are_left_out():
    one = system(0.0)
    found = one.table.terms()[0]
    assert np.abs(found.value).min() > NOISE * np.abs(found.value).max()
    assert found.value.size == one.omega.size  # a mode of a perfect ring has one wave, a blade's mode too


@pytest.mark.slow
def test_a_leap_of_a_lane_is_no_longer_than_its_powers_reach():
    """Maps over 1, 2 and 4 steps: seven at most, out of reach for ever."""
    rim = ct.RotatingRim(
        ring(S=4e-7, zeta=0.01), blade(S=1e-6), clearance=0.03, speed_hz=20.0, blade_velocity=[0.3, -0.2],
    )  # fmt: skip
    run = ct.ExactModal().prepare(rim, ct.Unilateral(), dt=2e-5, courant=None)
    job = Job(run=run, steps=100, record=ct.Record())
    lanes = batch([job])
    lanes.load(0, job)
    s, flights = lanes.lanes, lanes.flights._replace(powers=lanes.flights.powers[:, :3].copy())
    q, d = s.q[:, 0].copy(), s.d[:, 0].copy()
    for _ in range(7):
        d = s.al[:, 0] * d - s.be[:, 0] * q
        q = q + d
    assert skip_in_batch(s, flights, lanes.sums, s.d, 0, 100) == 7
    assert (s.step[0], flights.taken[0].tolist()) == (7, [1, 7])
    np.testing.assert_allclose(s.q[:, 0], q, rtol=0.0, atol=1e-13 * np.abs(q).max())
    np.testing.assert_allclose(s.d[:, 0], d, rtol=0.0, atol=1e-13 * np.abs(d).max())


@jit_entry
def step_sums(s, sums, Q, Q_next):
    """What a step adds to the sums of eight runs."""
    return add_up(s, sums, Q, Q_next)


@pytest.mark.slow
def test_a_step_adds_to_the_sums_of_each_lane_what_is_its_own():
    """Gaps and forces of one step, no two alike, after others with extremes of their own."""
    rim = ct.RotatingRim(ring(S=4e-7), blade(S=1e-6), clearance=2e-4, speed_hz=20.0)
    run = ct.ExactModal().prepare(rim, ct.Unilateral(), dt=2e-5, courant=None)
    lanes = batch([Job(run=run, steps=100, record=ct.Record())])
    s, sums, k = lanes.lanes, lanes.sums, np.arange(WIDTH)
    before, gap, force = 1e-6 * (7.0 - k), 2e-6 * (k - 3.5), np.where(k % 3 == 0, 10.0 + k, 0.0)
    s.h[:] = 1e-5 * (1 + k)
    s.work[TEST], s.work[FORCE], s.work[SCALE] = gap - 1e-7 * force, force, 1e-7
    sums.penetration[:], sums.peak[:], sums.impulse[:] = before, 11.0, k
    step_sums(s, sums, s.Q, s.Q_next)
    np.testing.assert_allclose(sums.penetration, np.maximum(before, -gap), rtol=1e-12)
    np.testing.assert_allclose(sums.impulse, k + force * s.h, rtol=1e-12)
    np.testing.assert_array_equal(sums.peak, np.maximum(11.0, force))
    np.testing.assert_allclose(sums.residual, np.abs(np.minimum(1e-7 * force, gap)), rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("limit", [3e-3, 4.1e-3])
def test_a_step_notes_how_far_each_tip_has_moved_against_its_rim_either_way(limit):
    """From the clearance ahead; one of them passes 3 mm."""
    rim = ct.RotatingRim(ring(S=4e-7), blade(S=1e-6), clearance=2e-4, speed_hz=20.0)
    run = ct.ExactModal().prepare(rim, ct.Unilateral(), dt=2e-5, courant=None)
    lanes = batch([Job(run=run, steps=100, record=ct.Record())])
    s, moved = lanes.lanes, 1e-3 * (np.arange(WIDTH) - 4.0)
    m = len(s.q)
    s.Q[m], s.Q_next[m] = 7e-3, 2e-4
    s.work[FREE], s.work[SCALE] = moved + 2e-4, 1.0
    s.limits[REACHED + TIP], s.limits[TIP] = 1.5e-3, limit
    assert step_sums(s, lanes.sums, s.Q, s.Q_next) == (limit < 4e-3)
    np.testing.assert_allclose(s.limits[REACHED + TIP], np.maximum(1.5e-3, np.abs(moved)), rtol=1e-12)


@jit_entry
def forces(s, Q, Q_next, waves, new):
    """Forces of eight runs without friction."""
    touch(s, Q, Q_next, waves, new, False)


@pytest.mark.slow
def test_a_lane_without_a_force_that_opens_its_gap_fails_alone():
    """Beside one that pushes, an open one and one where no run is."""
    rim = ct.RotatingRim(ring(S=4e-7), blade(S=1e-6), clearance=2e-4, speed_hz=20.0)
    run = ct.ExactModal().prepare(rim, ct.Unilateral(), dt=2e-5, courant=None)
    s = batch([Job(run=run, steps=100, record=ct.Record())]).lanes
    s.live[:4], s.step[:] = [1, 1, 1, 0], 5
    s.work[TEST, :4] = -1e-6, -1e-6, 1e-6, -1e-6
    s.Q[len(s.q) + 1] = np.where(np.arange(WIDTH) == 1, -1e-7, 1e-7)
    forces(s, s.Q, s.Q_next, s.waves, s.d)
    np.testing.assert_allclose(s.work[FORCE], [10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], rtol=1e-12)
    assert s.failed.tolist() == [0, 1, 0, 0, 0, 0, 0, 0]
    assert (s.retry > s.step).tolist() == [True, True, *[False] * 6]  # no skip is tried just after a contact
