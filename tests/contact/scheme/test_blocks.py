"""Sums of waves in blocks: eight rows at a time for one run, four rows or single ones for eight lanes."""

import math

import numpy as np
import pytest

import contact as ct
from contact.model.trig import Terms
from contact.scheme.modal.batch import AWAY, NEVER, WIDTH, Job, Layout, _blocks, batch
from contact.scheme.modal.blocks import _alike, row_blocks, rows_of_waves
from tests.contact.synthetic_rim import blade, ring


def sums(table):
    """Terms of a dense table (sums, waves)."""
    owner, wave = np.nonzero(table)
    start = np.concatenate(([0], np.cumsum(np.bincount(owner, minlength=len(table)))))
    return Terms(start=start, wave=wave, value=table[owner, wave])


def sparse(seed, rows=7, waves=9):
    rng = np.random.default_rng(seed)
    return rng.standard_normal((rows, waves)) * (rng.random((rows, waves)) < 0.4)


def test_rows_of_waves_stand_in_columns_of_cosines_and_sines():
    rng = np.random.default_rng(2)
    cos, sin, harmonic = rng.standard_normal((2, 2, 9)), rng.standard_normal((2, 2, 9)), np.array([1, 3])
    table = rows_of_waves(harmonic, cos, sin, 5)
    assert table.shape == (2, 16, 10)
    exact = np.zeros((2, 16, 10))
    for p, n in enumerate(harmonic):
        exact[:, :9, 2 * n], exact[:, :9, 2 * n + 1] = cos[:, p], sin[:, p]
    assert table.tolist() == exact.tolist()


def test_blocks_of_eight_hold_every_entry_once_and_an_even_number():
    table = np.stack([np.pad(sparse(k, 20, 10), ((0, 4), (0, 0))) for k in (3, 4)])
    start, wave, value, _ = row_blocks(table)
    assert start.size == 2 * 3 + 1
    assert not (np.diff(start) % 2).any()
    found = np.zeros((2, 24, 10))
    for block in range(6):
        row, rows = divmod(block, 3)
        for j in range(start[block], start[block + 1]):
            column = 2 * wave[j] if wave[j] < 5 else 2 * (wave[j] - 5) + 1
            found[row, 8 * rows : 8 * rows + 8, column] += value[j]
    assert found.tolist() == table.tolist()


@pytest.mark.parametrize(("missing", "together"), [(4, True), (5, False)])
def test_four_blocks_are_summed_together_up_to_a_quarter_more_entries(missing, together):
    """20 waves in union of four blocks are 16 entries and a quarter."""
    used = np.ones((1, 6, 5), dtype=bool)
    used[0, :4].flat[:missing] = False
    before = used.copy()
    assert _alike(used).tolist() == [int(together), 0, 0, 0, 0, 0]
    assert used[0, :4].all() if together else (used == before).all()
    assert (used[0, 4:] == before[0, 4:]).all()


def test_rows_are_put_together_where_they_add_the_fewest_waves():
    has = np.array(
        [
            [1, 1, 0, 0, 0, 0],
            [0, 0, 1, 1, 1, 0],
            [0, 0, 0, 0, 0, 1],
            [0, 0, 1, 1, 0, 0],
            [0, 0, 1, 0, 0, 0],
            [1, 0, 0, 0, 0, 0],
        ],
        dtype=bool,
    )
    # the widest row first; of two that add nothing the wider one; of equals the first
    assert [block.tolist() for block in _blocks(has, 2)] == [[1, 3], [0, 5], [2, 4]]
    assert [block.tolist() for block in _blocks(has, 3)] == [[1, 3, 4], [0, 5, 2]]
    assert [block.tolist() for block in _blocks(has, 1)] == [[1], [0], [3], [2], [4], [5]]


def dense(lanes, rows, waves, value, many):
    """What a lane's blocks sum, as a table (rows and one more, waves)."""
    found = np.zeros((rows + 1, waves))
    for b in range(lanes.start.size - 1):
        for j in range(lanes.start[b], lanes.start[b + 1]):
            for r in range(many):
                found[lanes.row[many * b + r] // WIDTH, lanes.wave[j] // WIDTH] += value[many * j + r]
    return found


def test_lanes_with_the_same_sums_share_them_in_blocks_of_four_rows():
    table = sparse(5)
    layout = Layout.of([sums(table), sums(table.copy())])
    lanes = layout.empty(sums(table))
    assert layout.alike
    assert lanes.value.shape == (0, WIDTH)
    found = dense(lanes, 7, layout.top, lanes.alike, 4)
    np.testing.assert_array_equal(found[:7], table[:, : layout.top])
    assert not found[7].any()
    layout.load(lanes, sums(table), 0)  # nothing to do


def test_lanes_with_different_sums_have_each_their_own_column():
    tables = [sparse(seed) for seed in (6, 7, 8)]
    layout = Layout.of([sums(table) for table in tables])
    lanes = layout.empty(sums(tables[0]))
    assert not layout.alike
    assert lanes.alike.size == 0
    for k, table in ((2, tables[1]), (5, tables[2]), (0, tables[0]), (5, tables[0]), (5, tables[2])):
        layout.load(lanes, sums(table), k)
    for k, table in ((0, tables[0]), (2, tables[1]), (5, tables[2])):
        found = dense(lanes, 7, layout.top, lanes.value[:, k], 1)
        np.testing.assert_array_equal(found[:7], table[:, : layout.top])
    assert not lanes.value[:, 1].any()


def rim(**more):
    given = {"clearance": -1e-5, "speed_hz": 20.0, "lean_deg": 25.0, "angle_deg": 45.0} | more
    waviness = [{"p": 2, "cos": 2.5e-4}]
    return ct.RotatingRim(ring(S=4e-7, zeta=0.01), blade(S=1e-6, zeta=0.01), out_of_roundness=waviness, **given)


def job(*, mu=0.0, steps=100, record=None, skip=True, dt=2e-5, **more):
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    run = ct.ExactModal(skip=skip).prepare(rim(**more), law, dt=dt, courant=None)
    return Job(run=run, steps=steps, record=record or ct.Record())


def test_a_run_in_a_lane_has_its_own_numbers_and_others_are_away():
    jobs = [job(), job(mu=0.2, speed_hz=-7.0, steps=40, record=ct.Record(every=4, state_every=8))]
    lanes = batch(jobs)
    assert lanes.rubs
    assert lanes.lanes.away.tolist() == [AWAY] * WIDTH
    lanes.load(3, jobs[1])
    state, own = lanes.lanes, jobs[1].run
    speed = -7.0 * 2.0 * math.pi
    assert state.away[3] == 0.0
    assert (state.live[3], state.step[3], state.end[3], state.failed[3]) == (1, 0, 40, 0)
    found = [float(getattr(state, name)[3]) for name in ("angle", "speed", "surface", "mu", "h")]
    assert found == pytest.approx([math.pi / 4.0, speed, 0.45 * speed, 0.2, 2e-5], rel=1e-12)
    for name in ("q", "d", "al", "be", "c", "weight"):
        assert getattr(state, name)[:, 3].tolist() == getattr(own.state, name).tolist()
    assert (lanes.kept.every[:, 3].tolist(), lanes.kept.due[:, 3].tolist()) == ([4, 8], [0, 0])
    assert lanes.kept.time.shape == (WIDTH, 101)
    assert lanes.kept.state.shape == (WIDTH, 6, own.size)
    lanes.load(3, jobs[0])
    assert (lanes.kept.every[:, 3].tolist(), lanes.kept.due[:, 3].tolist()) == ([1, NEVER], [0, NEVER])
    assert not batch(jobs[:1]).rubs
    assert batch(jobs[:1]).kept.state.shape == (WIDTH, 0, jobs[0].run.size)


def test_a_run_that_skips_nothing_never_looks_for_a_flight():
    lanes = batch([job(), job(skip=False)])
    lanes.load(0, job())
    lanes.load(1, job(skip=False))
    assert lanes.lanes.retry[:2].tolist() == [0, NEVER]
    assert lanes.flights.powers.shape[0] == 1
    two = [job(), job(dt=1e-5)]
    lanes = batch(two)
    lanes.load(1, two[1])
    assert lanes.flights.powers.shape[0] == WIDTH
    np.testing.assert_array_equal(lanes.flights.powers[1], two[1].run.flight.powers)
    assert lanes.lanes.alike.size == 0
    np.testing.assert_array_equal(batch(two[:1] * 2).lanes.alike[2], two[0].run.state.c)


def test_a_run_read_back_has_what_its_lane_has_now():
    one = job(mu=0.2, steps=40, record=ct.Record(every=4, state_every=8))
    lanes = batch([one])
    lanes.load(2, one)
    lanes.lanes.q[:, 2], lanes.lanes.d[:, 2], lanes.lanes.memory[:, 2] = 3.0, 4.0, 5.0
    lanes.lanes.step[2], lanes.sums.impulse[2], lanes.flights.taken[2] = 17, 6.0, (2, 9)
    lanes.kept.filled[:, 2] = 5, 2
    lanes.kept.force[2, :5], lanes.kept.state[2, :2] = np.arange(5.0), 8.0
    out = lanes.unload(2, one, [(np.array([1, 0]), np.array([0.1, 0.2])), (np.array([1]), np.array([0.3]))])
    s = one.run.state
    assert set(s.q) | set(s.d) | set(s.heat) | set(s.drive) == {3.0, 4.0, 5.0}
    assert s.lam.tolist() == [5.0, -25.0]
    assert (one.run.steps, one.run.sums.impulse[0], one.run.flight.taken.tolist()) == ([17], 6.0, [2, 9])
    assert out.force[:, 0].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert out.state.tolist() == [[8.0] * one.run.size] * 2
    assert (out.event_kind.tolist(), out.event_time.tolist()) == ([1, 0, 1], [0.1, 0.2, 0.3])
    assert (lanes.lanes.live[2], lanes.lanes.away[2]) == (0, AWAY)
    assert lanes.lanes.limits[:, 2].tolist() == [math.inf, math.inf, 0.0, 0.0]


def test_events_are_told_by_lane():
    lanes = batch([job()])
    lanes.sums.filled[2] = 3
    lanes.events.event_contact[:4], lanes.events.event_kind[:4] = (5, 1, 5, 7), (1, 2, 3, 4)
    lanes.events.event_time[:4] = 0.5, 0.6, 0.7, 0.8
    found = {k: (kind.tolist(), when.tolist()) for k, (kind, when) in lanes._events().items()}
    assert found == {5: ([1, 3], [0.5, 0.7]), 1: ([2], [0.6])}
