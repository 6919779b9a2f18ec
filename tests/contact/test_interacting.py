"""The table of dangerous speeds: closed forms, runs beside its rows, ranges, ranks, scenes of many tips."""

import time
from dataclasses import replace
from itertools import count

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.probed import finite, numbers_of_notes, numbers_of_result

PAIR = ct.gaps.HandPair(
    casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5, zeta=2e-4),
    blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4, zeta=2e-4), compliance=1e-4,
)  # fmt: skip
SPEEDS = np.linspace(45.0, 60.0, 61)


def pair_scene(clearance=-1e-5, casing=None, t_end=0.5, pair=PAIR, **more):
    """The pair as a rim and a blade that turns: f_c + f_b = n f at 52.5 turns/s without contact."""
    tip = ct.ModalBody(
        omega=[pair.blade.omega], zeta=[pair.blade.zeta], channels=("span", "flap"),
        rows=[[pair.blade.modal_mass**-0.5], [0.0]], S=np.eye(2) * pair.compliance,
    )  # fmt: skip
    rim = ct.RotatingRim(
        casing or ct.gaps.pair_rim(PAIR.casing, radius=0.5), tip, clearance=clearance, speed_hz=20.0, **more
    )
    return ct.Scene(what=rim, t_end=t_end, dt=1e-4)


def test_the_sum_condition_of_turning_blades_is_the_one_dangerous_speed(held):
    """A band of 0.3 turns/s between runs that are 1.4 turns/s apart: closed contact proposes it, its run decides."""
    found = ct.interactions(pair_scene(t_end=1.2), SPEEDS, runs=12)
    (formula,) = ct.stability.peaks(PAIR, SPEEDS).rows
    (row,) = found.rows
    assert row.at.verdict == "unstable"
    assert row.at.speed_hz == pytest.approx(formula.speed_hz, rel=1e-4)
    assert row.at.closed == pytest.approx(formula.growth, rel=0.01)
    assert row.at.growth == pytest.approx(formula.growth, rel=0.01)
    assert row.at.low < formula.growth < row.at.high
    assert (row.n, row.wave, row.body) == (8, "with", "casing")
    assert (row.from_hz, row.to_hz) == (row.peak.from_hz, row.peak.to_hz)
    assert {run.verdict for run in found.runs if run != row.at} == {"safe"}
    assert len(found.runs) == 13
    held(1e-4, **numbers_of_result(found), words=numbers_of_notes(found.words), document=finite(found.to_dict()))
    assert "13 runs of the scene at constant speeds from 45 to 60 Hz (2,700 to 3,600 rpm): 1 unstable" in found.words


def test_a_motion_mostly_of_the_blade_is_named_by_its_mode(held):
    """At a sum condition the energies are as the frequencies: 100 Hz of the casing, 250 Hz of the blade's mode 2."""
    casing = ct.gaps.pair_rim(replace(PAIR.casing, freq_hz=100.0), radius=0.5)
    tip = ct.ModalBody(
        omega=2.0 * np.pi * np.array([60.0, 250.0]), zeta=[1e-2, 2e-4], channels=("span", "flap"),
        rows=[[0.1, 1.6], [0.0, 0.0]], S=np.eye(2) * PAIR.compliance,
    )  # fmt: skip
    rim = ct.RotatingRim(casing, tip, clearance=-1e-2, speed_hz=20.0)
    found = ct.interactions(ct.Scene(what=rim, t_end=2.0, dt=1e-4), np.linspace(42.0, 46.0, 41), runs=2)
    (row,) = found.rows
    assert row.peak.casing_share == pytest.approx(100.0 / 350.0, abs=0.02)
    assert (row.at.verdict, row.n, row.mode, row.peak.mode) == ("unstable", None, 2, 2)
    assert "blade mode 2" in repr(found)
    held(1e-4, **numbers_of_result(found), words=numbers_of_notes(found.words))
    (record,) = found.to_dict()["interactions"]
    assert (record["body"], record["blade_mode"]) == ("blades", 2)


def test_where_nothing_touches_every_speed_is_safe(held):
    found = ct.interactions(pair_scene(clearance=1e-3), SPEEDS, runs=12)
    (row,) = found.rows
    assert row.at.verdict == "safe"
    assert row.at.closed > 3.0
    assert all(run.verdict == "safe" and run.amplitude_m == 0.0 for run in found.runs)
    assert "Every speed is safe." in found.words
    held(1e-4, **numbers_of_result(found), words=numbers_of_notes(found.words))
    assert repr(found).splitlines()[2] == "52.677-53.01 Hz: The contact never closes."


def test_a_calm_motion_is_run_four_times_as_long_where_its_contact_opens_and_closed_contact_would_grow():
    """Lobes of the rim touch the tip for a fifth of the time; closed contact grows at the sum condition only."""
    scene = pair_scene(clearance=2e-5, t_end=0.6, out_of_roundness=[{"p": 3, "cos": 2.5e-5}])
    runs = ct.interactions(scene, np.linspace(50.0, 56.0, 61), runs=4).runs
    assert {run.verdict for run in runs} == {"safe"}
    assert all(0.1 < run.contact < 0.3 for run in runs)
    grows = [run.closed > 3.0 for run in runs]
    assert sum(grows) == 1
    assert [run.seconds for run in runs] == pytest.approx([2.4 if one else 0.6 for one in grows])


def test_a_bounded_motion_beyond_half_the_wall_is_not_safe():
    """At these speeds nothing grows, and the rim deflects by micrometres."""
    apart, verdicts = np.linspace(45.0, 50.0, 6), {}
    for wall in (3e-3, 1e-8):
        casing = replace(ct.gaps.pair_rim(PAIR.casing, radius=0.5), thickness=wall)
        scene = replace(pair_scene(casing=casing), on_limit="flag")
        verdicts[wall] = {run.verdict for run in ct.interactions(scene, apart, runs=3).runs}
    assert verdicts == {3e-3: {"safe"}, 1e-8: {"resonance"}}
    stopped = ct.interactions(pair_scene(casing=casing), apart, runs=3)
    assert {run.deflection for run in stopped.runs} == {"> 5e-06"}  # half of 1e-5 mm, whatever the last step reached
    assert repr(stopped).splitlines()[1].split()[-3:] == [">", "5e-06", "unstable"]


def test_a_pair_by_hand_is_decided_by_its_poles():
    found = ct.interactions(PAIR, SPEEDS)
    (row,) = found.rows
    assert (row.at.verdict, found.runs) == ("unstable", ())
    assert "always closed" in repr(found)
    assert ct.interactions(PAIR, [20.0, 24.0]).rows == ()


def test_a_split_pair_of_one_n_has_one_row():
    """Two modes of n = 8 that are 0.02 % apart: two narrow bands of one motion."""
    casing = ct.gaps.pair_rim(PAIR.casing, radius=0.5).detuned(2e-4, seed=3)
    found = ct.interactions(pair_scene(casing=casing), SPEEDS, runs=12)
    assert [row.n for row in found.rows] == [8]
    assert "pairs of the casing are split" in found.words


def disk_scene():
    """A disk of nine blades that is pressed into a ring of n = 3."""
    disk = ct.gaps.BladedDisk(blades=9, freq_hz=115.0, modal_mass=0.1, compliance=5e-5, lean_deg=45.0)
    casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=3, freq_hz=290.0, modal_mass=2.0), radius=0.5)
    kick = ct.gaps.Start(velocity=np.array([1e-2, 0.0]))
    rub = ct.Rub(casing, (disk.body(),), disk.tips(), clearance=-1e-3, casing_start=kick)
    return ct.Scene(what=rub, t_end=0.2, dt=1e-4)


@pytest.mark.slow
def test_several_tips_have_rows_of_the_disks_n():
    found = ct.interactions(disk_scene(), np.linspace(125.0, 145.0, 41), runs=6)
    worst = found.rows[0]
    assert (worst.at.verdict, worst.n) == ("unstable", 3)
    assert 0.5 * worst.at.closed < worst.at.growth < worst.at.closed
    assert all(run.verdict == "safe" for run in found.runs if run.closed < 1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("psi", "unstable", "slow"), [(0.5, 4, 1), (1.0, 6, 0)])
def test_rows_are_ranked_by_verdict_and_by_what_the_runs_show(psi, unstable, slow):
    """Five pairs and a blade: unstable rows by the growth of their worst run, slow and safe ones by closed contact."""
    soft = blade(psi=psi, S=2e-5, zeta=5e-4)
    rim = ct.RotatingRim(ring(zeta=5e-4), soft, clearance=-1e-5, speed_hz=5.0, lean_deg=45.0)
    scene = ct.Scene(what=rim, t_end=1.2, dt=1e-4, on_limit="flag")
    found = ct.interactions(scene, np.linspace(85.0, 140.0, 111), runs=3)
    verdicts = [row.at.verdict for row in found.rows]
    assert verdicts == ["unstable"] * (unstable + slow) + verdicts[unstable + slow :]
    assert "unstable" not in verdicts[unstable + slow :]
    assert [row.at.slow for row in found.rows[: unstable + slow]] == [False] * unstable + [True] * slow
    growth = [row.at.growth for row in found.rows[:unstable]]
    assert growth == sorted(growth, reverse=True)
    closed = [row.at.closed for row in found.rows[unstable:]]
    assert closed == sorted(closed, reverse=True)
    by_pole = [row.at.closed for row in found.rows[:unstable]]
    assert (by_pole == sorted(by_pole, reverse=True)) == (psi == 0.5)  # the runs may rank otherwise than closed contact
    for row in found.rows[:unstable]:
        own = [run for run in found.runs if row.from_hz <= run.speed_hz <= row.to_hz and run.verdict == "unstable"]
        assert row.at.growth == max(run.growth for run in own)


@pytest.mark.slow
def test_rows_of_one_verdict_are_ranked_by_its_own_quantity():
    """After a row whose run grows: slow ones by closed contact, then resonances by amplitude, not by growth."""
    rim = ct.RotatingRim(
        replace(ring(zeta=5e-4), thickness=1e-6), blade(psi=0.5, S=2e-5, zeta=5e-4), clearance=-1e-5, speed_hz=5.0,
        lean_deg=45.0,
    )  # fmt: skip
    scene = ct.Scene(what=rim, t_end=0.6, dt=1e-4, on_limit="flag")
    found = ct.interactions(scene, np.linspace(85.0, 140.0, 56), runs=8)
    fast, slow, resonances = (
        [row.at for row in found.rows if (row.at.verdict, row.at.slow) == kind]
        for kind in (("unstable", False), ("unstable", True), ("resonance", False))
    )
    assert [row.at for row in found.rows] == [*fast, *slow, *resonances]
    assert len(fast) == 1
    for rows, key in ((slow, "closed"), (resonances, "amplitude_m")):
        sizes, growth = ([getattr(at, name) for at in rows] for name in (key, "growth"))
        assert len(rows) > 2
        assert sizes == sorted(sizes, reverse=True)
        assert growth != sorted(growth, reverse=True)


def test_a_growth_too_slow_for_the_runs_is_that_of_closed_contact():
    """The contact stays closed, so that a run long enough shows the growth of the poles, an e-fold in 1.6 s."""
    damped = replace(PAIR, casing=replace(PAIR.casing, zeta=2.6e-3), blade=replace(PAIR.blade, zeta=2.6e-3))
    (formula,) = ct.stability.peaks(damped, SPEEDS).rows
    kick = {"clearance": -1e-4, "casing": ct.gaps.pair_rim(damped.casing, radius=0.5), "pair": damped}
    short, long = (ct.interactions(pair_scene(t_end=t, **kick), SPEEDS, runs=2).rows[0].at for t in (0.2, 4.0))
    assert (short.verdict, short.slow, long.verdict, long.slow) == ("unstable", True, "unstable", False)
    assert short.closed == pytest.approx(formula.growth, rel=0.02)
    assert long.growth == pytest.approx(formula.growth, rel=0.02)
    assert short.note.startswith(f"The contact stays closed and grows by {short.closed:.2g} 1/s")


def test_a_motion_that_opens_the_contact_and_is_bounded_states_so_below_the_table():
    """Two tenths of a micrometre of overlap: the pole grows until the contact opens."""
    found = ct.interactions(pair_scene(clearance=-2e-7, t_end=4.0, casing_velocity=[1e-3, 0.0]), SPEEDS, runs=2)
    (row,) = found.rows
    assert row.at.closed > 3.0
    assert row.at.state == "bounded"
    assert row.at.note.startswith("The contact opens (closed ")
    assert f"bounded at {1e3 * (1.0 - row.at.steady) * row.at.amplitude_m:.2g} to " in repr(found)  # it beats
    assert found.to_dict()["interactions"][0]["note"] == row.at.note


def test_a_scene_that_is_refused_at_a_speed_is_not_decided_there():
    scene = replace(pair_scene(), scheme=ct.ExactModal(omega_h_limit=0.1))
    found = ct.interactions(scene, SPEEDS, runs=2)
    assert {run.verdict for run in found.runs} == {"not decided"}
    assert "the run was refused: dt: found omega_max dt" in found.words


def test_a_motion_of_round_off_is_safe_where_the_same_motion_is_unstable():
    """The model is linear while contact stays closed: only the size of the motion differs."""
    for overlap, verdict in ((1e-20, "safe"), (1e-5, "unstable")):
        found = ct.interactions(pair_scene(clearance=-overlap), SPEEDS, runs=2)
        assert [row.at.verdict for row in found.rows] == [verdict]
        assert found.rows[0].at.growth > 3.0


def test_the_printed_table_has_at_most_a_hundred_characters_and_every_row_on_one_line():
    found = ct.interactions(pair_scene(), SPEEDS, runs=4)
    assert max(map(len, repr(found).splitlines()[: 1 + len(found.rows)])) <= 100
    assert len(repr(found).splitlines()) == 1 + len(found.rows) + 1
    head = repr(found).splitlines()[0]
    assert [word.strip() for word in head.split("  ")[:2]] == ["range [rpm]", "range [Hz]"]


def test_the_document_has_the_table_the_runs_and_closed_contact():
    found = ct.interactions(pair_scene(), SPEEDS, runs=4)
    document = found.to_dict()
    assert [row["verdict"] for row in document["interactions"]] == ["unstable"]
    assert document["interactions"][0]["half_wall_s"] is None  # no wall is known
    assert len(document["runs"]) == len(found.runs) == 5
    assert document["closed_contact"]["peaks"][0]["n"] == 8
    assert found.of("unstable") == found.rows


@pytest.mark.slow
def test_the_table_is_the_same_from_two_processes(monkeypatch):
    clock = count(0.0, 100.0)  # processes start only for runs that take longer than they do to start
    monkeypatch.setattr(time, "perf_counter", lambda: next(clock))
    speeds = np.linspace(125.0, 145.0, 11)
    alone, shared = (ct.interactions(disk_scene(), speeds, runs=5, processes=k) for k in (1, 2))
    assert shared.to_dict() == alone.to_dict()


@pytest.mark.parametrize(
    ("run", "wave", "n", "body"),
    [
        ({"verdict": "unstable", "wave": "against", "n": 5, "body": "blades"}, "against", 5, "blades"),
        ({"verdict": "unstable", "wave": "", "n": 8}, "with", 8, "casing"),  # not shown by the run: from the pole
        ({"verdict": "unstable", "wave": "", "n": 5}, "", 5, "casing"),  # another motion than that of the pole
        ({"verdict": "safe", "wave": "against", "n": 5, "body": "blades"}, "with", 8, "casing"),
        ({"verdict": "safe", "wave": "", "n": 5, "body": "rotor"}, "with", 8, "rotor"),
    ],
)
def test_the_run_that_decided_states_the_motion_and_the_pole_where_no_run_grew(run, wave, n, body):
    pair = ct.gaps.HandPair(
        casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
        blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4,
    )  # fmt: skip
    (row,) = ct.interactions(pair, [50.0, 52.5, 53.0, 55.0]).rows
    found = replace(row, at=replace(row.at, **run))
    assert (found.wave, found.n, found.body) == (wave, n, body)
    assert replace(found, peak=None).wave == run["wave"]
