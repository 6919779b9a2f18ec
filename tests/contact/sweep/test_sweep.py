"""Sweeps from scene files: what is run, what the table says, the same bits whatever happens on the way."""

import csv
import os
import sys
import time
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import contact as ct
from contact.io import workers
from contact.model.trig import harmonics
from contact.scene.load import scene_data, scene_of
from contact.scene.roundness import RandomRoundness
from contact.sweep import dask_cluster as sweep_dask
from contact.sweep import plan as sweep_plan
from contact.sweep import spread, sweep
from contact.sweep.columns import COLUMNS
from contact.sweep.plan import load_sweep
from contact.sweep.row import Store, row_of, sweep_record
from reports.verification.robustness import sweep_kills
from tests.contact.synthetic_rim import N_MAX, SIZE, blade, ring
from tests.contact.synthetic_rub import nodes, rim3

SCENE = """
[scene]
kind = "rim"
t_end = 0.04
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 25.0
[contact]
clearance = 2e-4
friction = 0.1
angle_deg = 45.0
out_of_roundness = [{p = 2, cos = 2.5e-4}]
[speed]
hz = 20.0
[scheme]
kind = "exact-modal"
dt = 2e-5
"""
GRID = """
[sweep]
[[sweep.vary]]
key = "speed.hz"
from = 15.0
to = 25.0
steps = 3
[[sweep.vary]]
key = "contact.friction"
values = [0.0, 0.1, 100.0]
"""
RUB = """
[scene]
kind = "rub"
t_end = 0.02
[casing]
basis = "casing.npz"
[[blade]]
basis = "blade.npz"
count = 1
[contact]
clearance = -2e-5
profile = "round.csv"
[speed]
hz = 3.0
[scheme]
kind = "exact-modal"
dt = 4e-5
[sweep]
[[sweep.vary]]
key = "blade[1].count"
values = [1, 2]
[[sweep.vary]]
key = "speed.hz"
values = [2.0, 3.5]
"""


@pytest.fixture
def scene(tmp_path):
    """Write a scene with this [sweep] beside its bases."""

    def write(table, base=SCENE):
        ring(S=0.0, zeta=0.01).save(tmp_path / "casing.npz")
        ring(S=0.0, zeta=0.01, imperfect=0.05).save(tmp_path / "split.npz")
        blade(S=0.0, zeta=0.01).save(tmp_path / "blade.npz")
        file = tmp_path / "scene.toml"
        file.write_text(base + table)
        return file

    return write


def read(text):
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


@pytest.mark.slow
def test_a_grid_is_every_combination_and_the_table_states_what_each_did(scene):
    plan = load_sweep(scene(GRID))
    assert [run.values for run in plan.runs][:4] == [(15.0, 0.0), (15.0, 0.1), (15.0, 100.0), (20.0, 0.0)]
    result = sweep.run_sweep(plan)
    text = sweep.table(result)
    assert text.startswith("# COMPUTED: sweep of scene.toml, 9 runs\n# casingfem: ")
    assert "# sha256: " in text
    rows = read(text)
    assert [row["status"] for row in rows] == ["done", "done", "refused"] * 3
    assert "contact.friction: found 100, expected 0 to" in rows[2]["why"]
    assert list(rows[0])[:4] == ["run", "speed.hz", "contact.friction", "status"]
    alone = ct.run(scene_of(plan.data(plan.runs[1]), plan.file), record=sweep_record(2000))
    assert float(rows[1]["impulse_N_s"]) == pytest.approx(alone.impulse[0], rel=1e-12)
    assert float(rows[1]["contact_fraction"]) == alone.contact_steps[0] / alone.steps
    assert float(rows[1]["friction_J"]) == pytest.approx(alone.energy.friction, rel=1e-9)
    assert result.failed == 3


def test_lists_draws_strings_and_seeds(scene):
    together = """
[sweep]
kind = "list"
[[sweep.vary]]
key = "casing.basis"
values = ["casing.npz", "split.npz"]
[[sweep.vary]]
key = "contact.out_of_roundness[1].cos"
values = [2e-4, 3e-4]
"""
    plan = load_sweep(scene(together))
    assert [run.values for run in plan.runs] == [("casing.npz", 2e-4), ("split.npz", 3e-4)]
    assert plan.data(plan.runs[1])["contact"]["out_of_roundness"][0]["cos"] == 3e-4
    assert plan.data(plan.runs[0])["contact"]["out_of_roundness"][0]["cos"] == 2e-4
    written = plan.base["contact"]["out_of_roundness"][0]["cos"]
    assert written not in (2e-4, 3e-4), "runs do not change the tables of the scene"
    random = """
[sweep]
kind = "random"
draws = 40
seed = 12
[[sweep.vary]]
key = "contact.clearance"
from = 1e-5
to = 1e-3
log = true
[[sweep.vary]]
key = "casing.seed"
from = 0
to = 9
[[sweep.vary]]
key = "casing.scatter"
values = [0.01]
[[sweep.vary]]
key = "blade.freq_hz"
from = 100.0
to = 140.0
"""
    plan = load_sweep(scene(random))
    again = load_sweep(scene(random.replace("draws = 40", "draws = 10")))
    assert again.runs == plan.runs[:10]  # a draw depends on its number alone
    clearance = np.array([run.values[0] for run in plan.runs])
    assert 1e-5 < clearance.min() < 5e-5 < 2e-4 < clearance.max() < 1e-3
    assert {type(run.values[1]) for run in plan.runs} == {int}
    assert plan.source["seed"] == "12"
    built = scene_of(plan.data(plan.runs[0]), plan.file)
    assert built.what.blade.omega[0] == pytest.approx(2.0 * np.pi * plan.runs[0].values[3])
    assert len(np.unique(built.what.casing.omega)) == 10  # pairs are split
    assert len({run.digest for run in plan.runs}) == 40


def test_draws_and_steps_fill_their_ranges_evenly(scene):
    """Whole numbers with both ends, numbers and listed values each as often, steps even in the logarithm."""
    random = """
[sweep]
kind = "random"
draws = 400
seed = 3
[[sweep.vary]]
key = "casing.seed"
from = 2
to = 4
[[sweep.vary]]
key = "speed.hz"
from = 10.0
to = 30.0
[[sweep.vary]]
key = "contact.friction"
values = [0.1, 0.2, 0.3]
[[sweep.vary]]
key = "contact.clearance"
from = 1e-5
to = 1e-3
log = true
"""
    file = scene(random)
    table = sweep_plan._table(scene_data(file)[0]["sweep"], file)
    seed, hz, friction, clearance = np.array(list(sweep_plan._combinations(table, file))).T
    for found, values in ((seed, [2, 3, 4]), (friction, [0.1, 0.2, 0.3])):
        assert np.unique(found).tolist() == values
        assert [np.count_nonzero(found == value) for value in values] == pytest.approx([400 / 3] * 3, abs=40)
    for even, low, high in ((hz, 10.0, 30.0), (np.log10(clearance), -5.0, -3.0)):
        assert np.histogram(even, bins=4, range=(low, high))[0] == pytest.approx([100] * 4, abs=40)
    grid = '[sweep]\nvary = [{key = "contact.clearance", from = 1e-5, to = 1e-3, steps = 5, log = true}]\n'
    found = [run.values[0] for run in load_sweep(scene(grid)).runs]
    assert found == pytest.approx([1e-5 * 10.0 ** (k / 2.0) for k in range(5)], rel=1e-12)


DRAWS = """
[contact.random_out_of_roundness]
seed = 5
spectrum = [
    {p = 2, median = 1e-4, high = 3e-4}, {p = 3, median = 4e-5, high = 1e-4}, {p = 7, median = 2e-5, high = 9e-5},
]
"""


def drawn(scene, draws, table=DRAWS, **more):
    text = table + f'[sweep]\n[[sweep.vary]]\nkey = "contact.draw"\nvalues = {draws}\n'
    return load_sweep(scene(text, **more))


@pytest.mark.slow
def test_imperfection_draws_depend_on_seed_and_number_alone(scene):
    """In any order, among any others, in the file or varied: the numbers are those of casingfem's RandomField."""
    from casingfem.structure.field.random import RandomField, Spectrum

    plan, other = drawn(scene, [0, 1, 2, 3]), drawn(scene, [7, 3, 1])
    assert other.runs[1] == plan.runs[3]
    assert other.runs[2] == plan.runs[1]
    assert [run.values for run in other.runs] == [(7,), (3,), (1,)]
    assert len({run.digest for run in (*plan.runs, *other.runs)}) == 5
    rows = [float(row["impulse_N_s"]) for row in read(sweep.table(sweep.run_sweep(plan)))]
    again = [float(row["impulse_N_s"]) for row in read(sweep.table(sweep.run_sweep(other)))]
    assert again[1:] == [rows[3], rows[1]]
    assert len(set(rows)) == 4
    alone = ct.load_scene(scene(DRAWS, SCENE.replace("friction = 0.1", "friction = 0.1\ndraw = 3")))
    assert ct.run(alone, record=sweep_record(2000)).impulse[0] == pytest.approx(rows[3], rel=1e-12)
    spectrum = Spectrum(p=[2, 3, 7], median=[1e-4, 4e-5, 2e-5], high=[3e-4, 1e-4, 9e-5])
    fit = RandomField(spectrum=spectrum, seed=5, draw=3).fit
    terms = alone.what.out_of_roundness
    assert terms[0] == {"p": 2, "cos": 2.5e-4, "sin": 0.0}  # the given harmonic stays
    assert [t["cos"] for t in terms[1:]] == pytest.approx(fit.cos[:, 0].tolist(), rel=1e-12)
    assert [t["sin"] for t in terms[1:]] == pytest.approx(fit.sin[:, 0].tolist(), rel=1e-12)


def test_the_hash_of_a_draw_covers_the_seed_and_the_spectrum(scene):
    first = [run.digest for run in drawn(scene, [0, 1]).runs]
    for old, new in (("seed = 5", "seed = 6"), ("median = 4e-5", "median = 4.1e-5"), ("p = 7", "p = 6")):
        assert not set(first) & {run.digest for run in drawn(scene, [0, 1], DRAWS.replace(old, new)).runs}


@pytest.mark.slow
def test_draws_have_the_rms_and_the_quantiles_they_are_given():
    table = RandomRoundness(seed=11, harmonics=[2, 5, 9], rms=3e-5)
    theta = 2.0 * np.pi * np.arange(64) / 64
    for draw in range(5):
        d = sum(t["cos"] * np.cos(t["p"] * theta) + t["sin"] * np.sin(t["p"] * theta) for t in table.terms(draw))
        assert np.sqrt(np.mean(d**2)) == pytest.approx(3e-5, rel=1e-12)
    table = RandomRoundness(seed=11, spectrum=[{"p": 4, "median": 1e-4, "high": 2.5e-4}])
    size = np.array([np.hypot(t["cos"], t["sin"]) for k in range(4000) for t in table.terms(k)])
    assert np.mean(size > 1e-4) == pytest.approx(0.5, abs=0.025)  # three standard deviations of 4,000 draws
    assert np.mean(size > 2.5e-4) == pytest.approx(0.1, abs=0.015)


@pytest.mark.parametrize(("old", "new", "words"), [
    ("spectrum", "spectra", "contact.random_out_of_roundness.spectra: unknown key"),
    ("spectrum =", "harmonics = [2]\nspectrum =", "spectrum and harmonics: found both"),
    ("spectrum =", "rms = 0.0\nspectrum =", "random_out_of_roundness.rms: found 0.0"),
    ("seed = 5", "seed = -1", "random_out_of_roundness.seed: found -1"),
    ("p = 7", "p = 3", "harmonics [2, 3, 3] found, expected each once, ascending"),
    ("high = 1e-4}", "high = 1e-5}", "high = 1e-05 found below median = 4e-05"),
])  # fmt: skip
def test_broken_random_roundness_is_refused(scene, old, new, words):
    assert old in DRAWS
    with pytest.raises(ct.scene.SceneError) as error:
        drawn(scene, [0], DRAWS.replace(old, new, 1))
    assert words in str(error.value)


@pytest.mark.slow
def test_whole_numbers_stay_whole_and_files_of_lists_are_hashed(tmp_path):
    rim3().save(tmp_path / "casing.npz")
    nodes(1).save(tmp_path / "blade.npz")
    (tmp_path / "round.csv").write_text("theta_deg,depth_m\n0,0\n90,2e-5\n200,-1e-5\n")
    file = tmp_path / "scene.toml"
    file.write_text(RUB)
    plan = load_sweep(file)
    assert [run.values for run in plan.runs] == [(1, 2.0), (1, 3.5), (2, 2.0), (2, 3.5)]
    rows = read(sweep.table(sweep.run_sweep(plan)))
    assert [row["blade[1].count"] for row in rows] == ["1", "1", "2", "2"]
    assert [row["status"] for row in rows] == ["done"] * 4
    assert {int(row["dominant_n"]) for row in rows} <= set(range(6))
    assert all(float(row["blade_rms_m"]) > 0.0 for row in rows)
    first = {run.digest for run in plan.runs}
    (tmp_path / "round.csv").write_text("theta_deg,depth_m\n0,0\n90,2e-5\n200,-2e-5\n")
    second = {run.digest for run in load_sweep(file).runs}
    nodes(1, seed=8).save(tmp_path / "blade.npz")
    third = {run.digest for run in load_sweep(file).runs}
    assert len(first | second | third) == 12


@pytest.mark.slow  # compiles the loop of a rim
def test_a_task_reads_what_another_process_has_run_meanwhile(scene, tmp_path, monkeypatch):
    plan = load_sweep(scene(GRID))
    (task, *_) = sweep.tasks(plan, {}, tmp_path / "store", 1)
    Store.open(tmp_path / "store")
    first = sweep.run_task(task)
    assert len(first) == len(task.runs)
    monkeypatch.setattr(sweep, "_scene", lambda *given: pytest.fail("what is there was run again"))
    assert sweep.run_task(task) == first


def test_the_hash_follows_all_that_defines_a_run(scene, tmp_path):
    file = scene(GRID)
    first = [run.digest for run in load_sweep(file).runs]
    assert [run.digest for run in load_sweep(file).runs] == first
    file.write_text(file.read_text() + "# a remark\n")
    assert [run.digest for run in load_sweep(file).runs] == first
    ring(S=0.0, zeta=0.011).save(tmp_path / "casing.npz")
    assert not set(first) & {run.digest for run in load_sweep(file).runs}


def test_the_hash_follows_the_versions_and_the_definition_of_what_is_measured(scene, monkeypatch):
    file = scene(GRID)
    found = [load_sweep(file).runs[0].digest]
    with monkeypatch.context() as patched:
        patched.setattr(sweep_plan, "MEASURES", sweep_plan.MEASURES + 1)
        found.append(load_sweep(file).runs[0].digest)
    monkeypatch.setattr(sweep_plan, "versions", lambda: {"numpy": "0"})
    found.append(load_sweep(file).runs[0].digest)
    assert len(set(found)) == 3


@pytest.mark.slow
def test_order_processes_and_resuming_change_no_bit(scene, tmp_path):
    plan = load_sweep(scene(GRID))
    plain = sweep.table(sweep.run_sweep(plan))
    store = tmp_path / "store"
    seen = []
    half = load_sweep(scene(GRID.replace("steps = 3", "steps = 2").replace("to = 25.0", "to = 20.0")))
    sweep.run_sweep(half, folder=store)
    result = sweep.run_sweep(load_sweep(scene(GRID)), folder=store, jobs=2, progress=seen.append)
    assert sweep.table(result) == plain
    assert result.resumed == 3 * 2
    assert seen[-1] == 9
    assert len(Store.open(store).files()) == 9
    assert sweep.run_sweep(plan, folder=store).resumed == 9
    altered = Store.open(store).files()[4]
    altered.write_text(altered.read_text().replace('"closings": ', '"closings": 1', 1))
    again = sweep.run_sweep(plan, folder=store)
    assert (again.resumed, sweep.table(again)) == (8, plain)


def test_bodies_on_an_axis_are_swept_too(tmp_path):
    file = tmp_path / "ball.toml"
    file.write_text(
        (Path(__file__).parents[3] / "data/scenes/two_rods.toml").read_text()
        + """
[sweep]
[[sweep.vary]]
key = "rod[1].velocity"
values = [2.0, 4.0]
"""
    )
    rows = read(sweep.table(sweep.run_sweep(load_sweep(file))))
    assert [row["status"] for row in rows] == ["done", "done"]
    assert float(rows[0]["impulse_N_s"]) > 1.0
    assert float(rows[1]["impulse_N_s"]) == pytest.approx(2.0 * float(rows[0]["impulse_N_s"]), rel=0.05)
    assert rows[0]["dominant_n"] == ""


@pytest.mark.parametrize(("table", "words"), [
    ("", "sweep: missing"),
    ("[sweep]\n", "sweep.vary: missing"),
    ('[sweep]\nvary = [{key = "speed.hz"}]', "found neither values nor both from and to"),
    ('[sweep]\nvary = [{key = "speed.hz", from = 1, to = 2}]', "steps missing"),
    ('[sweep]\nvary = [{key = "speed.hz", values = [1], log = true}]', "values found with"),
    ('[sweep]\nvary = [{key = "speed.hz", values = [1], from = 1}]', "values found with"),
    ('[sweep]\nvary = [{key = "speed.hz", values = [1], to = 2}]', "values found with"),
    ('[sweep]\nvary = [{key = "speed.hz", values = [1], steps = 3}]', "values found with"),
    ('[sweep]\nvary = [{key = "speed.hz", from = 0, to = 2, steps = 3, log = true}]', "log found with from or to <= 0"),
    ('[sweep]\nkind = "random"\nvary = [{key = "speed.hz", from = 1, to = 2}]', "neither draws nor seed found"),
    ('[sweep]\nkind = "random"\ndraws = 2\nseed = 1\nvary = [{key = "speed.hz", from = 1, to = 2, steps = 3}]',
     "speed.hz: steps found with kind = 'random', expected only from and to"),
    ('[sweep]\nkind = "random"\ndraws = 2\nvary = [{key = "speed.hz", from = 1, to = 2}]', "draws found with kind"),
    ('[sweep]\ndraws = 2\nseed = 1\nvary = [{key = "speed.hz", values = [1]}]', "draws and seed found with kind"),
    ('[sweep]\nvary = [{key = "speed.hz", values = []}]', "values: found none, expected at least one"),
    ('[sweep]\nvary = [{key = "motor.hz", values = [1]}]', "the scene has no table 'motor'"),
    ('[sweep]\nvary = [{key = "speed.rpm", values = [1]}]', "speed: hz and rpm both found, expected one"),
    ('[sweep]\nvary = [{key = "blade.lean_deg", values = [80]}]', "sweep.vary[1].values: blade.lean_deg: found 80"),
    ('[sweep]\nvary = [{key = "speed.hz", values = [1]}, {key = "contact.clearance", from = 0.5, to = 1, steps = 2}]',
     "sweep.vary[2].from: contact.clearance: found 0.5 m"),
    ('[sweep]\nvary = [{key = "contact.out_of_roundness[2].cos", values = [1]}]', "no table 'out_of_roundness[2]'"),
    ('[sweep]\nvary = [{key = "speed", values = [1]}]', "expected a key of the scene, such as speed.hz"),
    ('[sweep]\nkind = "list"\nvary = [{key = "speed.hz", values = [1]}, {key = "blade.lean_deg", values = [1, 2]}]',
     "lists of [1, 2] values"),
    ('[sweep]\nvary = [{key = "speed.hz", values = [1]}, {key = "speed.hz", values = [1]}]', "found a key twice"),
    ('[sweep]\nvary = [{key = "casing.basis", values = ["none.npz"]}]', "none.npz"),
])  # fmt: skip
def test_bad_sweeps_are_refused_with_their_key(scene, table, words):
    with pytest.raises(ct.scene.SceneError) as error:
        load_sweep(scene(table))
    assert words in str(error.value)
    assert "scene.toml" in str(error.value)


@pytest.mark.parametrize(
    ("key", "name"),
    [("contact.clearance", "contact.clearance_m"), ("speed.hz", "speed.hz"), ("blade.lean_deg", "blade.lean_deg"),
     ("contact.friction", "contact.friction"), ("scheme.dt", "scheme.dt_s")],
)  # fmt: skip
def test_columns_of_varied_keys_end_in_the_unit_that_the_scene_file_has(scene, key, name):
    plan = load_sweep(scene(f'[sweep]\nvary = [{{key = "{key}", values = [1e-6]}}]'))
    assert sweep.columns(plan)[1] == name


@pytest.mark.slow
def test_a_scene_with_a_sweep_runs_as_it_is(scene):
    assert ct.run(ct.load_scene(scene(GRID))).steps == 2000


def test_records_and_rows_of_what_is_refused():
    assert sweep_record(1_000_000).every == 3889
    assert row_of(None, ct.LimitError("too far"))["why"] == "too far"


@pytest.mark.parametrize("zeta", [0.0, 0.01])
def test_amplitudes_and_dominant_n_are_those_of_a_known_motion(zeta):
    """Only the pair n = 3 and the blade's flap move: each level is that of one cosine, and decays as it does."""
    free = ct.RotatingRim(
        ring(S=0.0, zeta=zeta), blade(S=0.0, zeta=0.0), clearance=0.04, speed_hz=20.0,
        casing_velocity=[0.0, 0.0, 1.0, *[0.0] * 7], blade_velocity=[0.0 if zeta else 0.3, 0.0],
    )  # fmt: skip
    scene = ct.Scene(what=free, t_end=0.2, dt=2e-5, record=sweep_record(10_000))
    row = row_of(scene, ct.run(scene))
    rate = zeta * 2.0 * np.pi * 160.0
    late = np.sqrt((np.exp(-0.3 * rate) - np.exp(-0.4 * rate)) / (0.1 * rate)) if zeta else 1.0  # over .15 .. .2 s
    expected = late / np.sqrt(1.0 + 1.0 / 9.0) / (2.0 * np.pi * 160.0) / np.sqrt(2.0)
    assert row["dominant_n"] == 3
    assert row["dominant_rms_m"] == pytest.approx(expected / np.sqrt(2.0), rel=0.05)
    assert row["amplitude_m"] == pytest.approx(row["dominant_rms_m"], rel=1e-9)
    assert row["growth_1_s"] == pytest.approx(-rate, rel=0.03, abs=0.3)
    if not zeta:
        assert row["blade_rms_m"] == pytest.approx(0.3 * 0.08 / (2.0 * np.pi * 120.0) / np.sqrt(2.0), rel=0.02)


def test_every_column_of_a_row_is_that_of_the_recorded_run(scene):
    """Each figure once from the series themselves, with its sign; another column fails here until it is compared."""
    file = scene(GRID, SCENE.replace("casing.npz", "split.npz").replace("clearance = 2e-4", "clearance = -1e-4"))
    plan = load_sweep(file)
    run = scene_of(plan.data(plan.runs[1]), plan.file)
    result = ct.run(run, record=ct.Record(state_every=1))
    row, what, energy = row_of(run, result), run.what, result.energy
    force, late = result.force[:, 0], slice(3 * result.steps // 4, None)
    rim = result.state_of("casing") @ what.casing.rows[:SIZE].T
    theta = 2.0 * np.pi * np.arange(64) / 64
    field = np.array([harmonics(N_MAX, angle) for angle in theta]) @ rim[late].T  # (around, time)
    waves = np.abs(np.fft.rfft(field - field.mean(axis=1, keepdims=True), axis=0)) ** 2 / 64**2
    levels = np.sqrt(waves.mean(axis=1) * np.where(np.arange(33) % 32, 2.0, 1.0))
    lean = np.radians(what.lean_deg)
    tip = result.state_of("blade") @ (np.cos(lean) * what.blade.rows[0] + np.sin(lean) * what.blade.rows[1])
    grown = ct.stability.of_run(what, result)
    expected = {
        "status": "done", "steps": 2000, "contact_fraction": np.mean(force > 0.0),
        "closings": np.count_nonzero(np.diff(np.r_[0, force > 0.0]) == 1), "impulse_N_s": force.sum() * 2e-5,
        "peak_force_N": force.max(), "max_penetration_m": max(0.0, -result.gap.min()), "residual_m": 0.0,
        "lost_in_contact_J": -energy.contact, "friction_J": energy.friction, "damping_J": energy.damping,
        "rotation_J": energy.rotation, "worn_J": None, "unaccounted_rel": 0.0,
        "amplitude_m": np.sqrt(np.mean((field - field.mean(axis=1, keepdims=True)) ** 2)),
        "blade_rms_m": np.sqrt(np.mean((tip[late] - tip[late].mean()) ** 2)),
        "motion": grown.outcome, "growth_1_s": grown.rate, "growth_low_1_s": grown.low, "growth_high_1_s": grown.high,
        "half_wall_at_s": None if np.isinf(grown.time_to_half_wall) else grown.time_to_half_wall, "growth_check": None,
        "body": grown.body, "n": grown.nodal_diameters, "source": grown.cause.source,
        "dominant_n": int(levels.argmax()), "dominant_rms_m": levels.max(), "diverged_at_s": None, "flags": "",
        "why": "",
    }  # fmt: skip
    assert set(expected) == set(COLUMNS)
    for name, value in expected.items():
        round_off = 1e-12 if name in ("unaccounted_rel", "residual_m") else 1e-17
        close = value is None or isinstance(value, str)
        assert row[name] == (value if close else pytest.approx(value, rel=1e-9, abs=round_off)), name
    assert len({row[name] for name in COLUMNS if name.endswith("_J")}) == 5  # no two alike


def lever():
    """Two modes of 1 and 4 Hz seen at two places."""
    return ct.ModalBody(
        omega=2.0 * np.pi * np.array([1.0, 4.0]), zeta=[0.0, 0.0], channels=("near", "far"),
        rows=[[0.5, 0.0], [-2.0, 0.25]], S=np.zeros((2, 2)),
    )  # fmt: skip


def moved(what):
    """Amplitude [m] of a run of 1 s that starts with modal velocities."""
    scene = ct.Scene(what=what, t_end=1.0, dt=1e-3, record=sweep_record(1000), law=ct.Coulomb(mu=0.0))
    return row_of(scene, ct.run(scene)).get("amplitude_m")


def test_amplitude_of_a_body_at_one_point_is_the_largest_displacement_of_its_channels():
    velocity = [2.0 * np.pi, 0.0]
    side = ct.gaps.Side(body=lever(), channel="near", sign=1, velocity=velocity)
    other = ct.gaps.Side(body=lever(), channel="near", sign=-1, velocity=velocity)
    assert moved(ct.PointGap(sides=(side,), clearance=10.0)) == pytest.approx(2.0, rel=1e-4)
    assert moved(ct.PointGap(sides=(side, other), clearance=10.0)) is None  # modes of two bodies
    patch = ct.Patch(body=lever(), normal=("near",), clearance=10.0, velocity=velocity)
    assert moved(patch) == pytest.approx(2.0, rel=1e-4)


def test_amplitude_of_a_chain_is_its_largest_coordinate():
    chain = [ct.Wall(), ct.PointMass(mass=1.0, x=1.0, velocity=0.5)]
    scene = ct.Scene(what=chain, scheme=ct.MoreauJean(), t_end=1.0, dt=1e-3, record=sweep_record(1000))
    result = ct.run(scene)
    assert row_of(scene, result)["amplitude_m"] == pytest.approx(np.abs(result.state).max(), rel=1e-12)
    assert row_of(scene, result)["amplitude_m"] == pytest.approx(0.5 * result.state_time[-1], rel=1e-9)


def test_wear_and_flags_of_a_row():
    worn = ct.Abradable(E=1e9, yield_stress=2e4, hardening=1e6, thickness=1e-3, width=0.02, tip=6e-3, bars=2)
    what = ct.RotatingRim(ring(zeta=0.01), blade(zeta=0.01), clearance=-2e-5, speed_hz=5.0, lean_deg=20.0)
    scene = ct.Scene(what=what, law=worn, t_end=0.05, dt=2e-5, record=sweep_record(2500))
    result = ct.run(scene)
    track = result.tracks[0]
    assert track.dissipated > 0.0
    assert row_of(scene, result)["worn_J"] == pytest.approx(track.dissipated, rel=1e-12)
    told = replace(result, energy=replace(result.energy, contact=result.energy.contact + 1.0))
    assert row_of(scene, told)["unaccounted_rel"] == pytest.approx(-1.0 / told.energy.scale, rel=1e-6)
    far = replace(result, state=result.state * (0.06 / np.abs(result.state_of("casing")).max()))
    assert "motion-radius" in row_of(scene, far)["flags"].split("; ")


@pytest.mark.slow
def test_without_a_scheduler_and_without_the_package(scene, monkeypatch):
    plan = load_sweep(scene(GRID))
    monkeypatch.setattr(sweep_dask, "PATIENCE", "1s")
    with pytest.raises(ct.InputError, match="found no scheduler at"):
        list(sweep.run_sweep(plan, scheduler="tcp://127.0.0.1:1").rows)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ct.InputError, match="pip install distributed"):
        sweep.run_sweep(plan, scheduler="tcp://127.0.0.1:1")


class Answers(list):
    """Futures, to which more are added while they are gone through."""

    add = list.append


class Cluster:
    """Workers that die as often as the task says before they answer."""

    def __init__(self):
        self.begun = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def submit(self, work, task, *, pure):
        assert not pure  # else a task that was lost would count as done
        future, died = Future(), self.begun.count(task) < task
        future.set_exception(ProcessLookupError()) if died else future.set_result(work(task))
        self.begun.append(task)
        return future


def test_a_task_whose_workers_on_a_cluster_die_goes_to_others_a_few_times(monkeypatch):
    cluster, met = Cluster(), []
    package = SimpleNamespace(
        Client=lambda address, timeout: met.append((address, timeout)) or cluster, as_completed=Answers,
        KilledWorker=ProcessLookupError,
    )  # fmt: skip
    monkeypatch.setitem(sys.modules, "distributed", package)
    rows = sweep_dask.on_cluster([2, 0, 1], lambda task: {"died": task}, "tcp://host:8786", 3)
    assert list(rows) == [{"died": 0}, {"died": 1}, {"died": 2}]
    assert (cluster.begun, met) == ([2, 0, 1, 2, 1, 2], [("tcp://host:8786", "20s")])
    with pytest.raises(ct.InputError, match=r"^scheduler: found a task whose worker died 3 times"):
        list(sweep_dask.on_cluster([3], lambda task: {}, "tcp://host:8786", 3))
    assert cluster.begun.count(3) == 3


def test_a_sweep_counts_what_is_done_and_states_why_the_first_other_is_not(scene):
    plan = load_sweep(scene(GRID.replace("[0.0, 0.1, 100.0]", "[0.0, 0.1]")))
    rows = [dict.fromkeys(COLUMNS) | {"status": "done", "why": "none"} for _ in plan.runs]
    result = sweep.SweepResult(plan=plan, rows=tuple(rows), resumed=0)
    assert (repr(result), result.why) == ("SweepResult(6 of 6 runs done, 0 diverged, 0 failed)", "")
    for k, status in {1: "diverged", 2: "refused", 4: "failed"}.items():
        rows[k] |= {"status": status, "why": f'{status}, "as it\nis"'}
    result = sweep.SweepResult(plan=plan, rows=tuple(rows), resumed=0)
    assert repr(result) == "SweepResult(3 of 6 runs done, 1 diverged, 2 failed)"
    assert result.why.startswith("diverged, ")
    assert [row["run"] for row in result.records()] == [1, 2, 3, 4, 5, 6]
    assert read(sweep.table(result))[4]["why"] == 'failed, "as it is"'


def test_progress_ends_at_the_number_of_runs_though_one_is_there_twice(scene, monkeypatch):
    plan = load_sweep(scene(GRID))
    plan = replace(plan, runs=(*plan.runs[:3], plan.runs[1]))
    row = dict.fromkeys(COLUMNS) | {"status": "done", "why": ""}
    monkeypatch.setattr(sweep, "run_task", lambda task: {digest: row for digest, _ in task.runs})
    seen = []
    assert len(sweep.run_sweep(plan, progress=seen.append).rows) == 4
    assert seen == [4]


def test_missing_runs_are_shared_out_in_whole_batches_of_eight(scene):
    """Two tasks for two processes, but 64 runs a task at most; what is there, or twice, is not run again."""
    plan = load_sweep(scene(GRID.replace("steps = 3", "steps = 90").replace("[0.0, 0.1, 100.0]", "[0.0, 0.1]")))
    there = {run.digest: {} for run in plan.runs[:150]}
    for jobs, kept, sizes in (
        (1, {}, [64, 64, 52]),
        (2, there, [16, 14]),
        (4, there, [8, 8, 8, 6]),
        (9, there, [8, 8, 8, 6]),
    ):
        parts = sweep.tasks(plan, kept, None, jobs)
        assert [len(part.runs) for part in parts] == sizes
        assert [run for part in parts for run in part.runs] == [(r.digest, r.values) for r in plan.runs[len(kept) :]]
    twice = replace(plan, runs=plan.runs[:3] * 2)
    assert [len(part.runs) for part in sweep.tasks(twice, {}, None, 1)] == [3]


def dies(task):
    """Ends its process until it has been begun as often as the task says; then its rows."""
    begun, often = task
    with begun.open("a") as file:
        file.write("x")
    if len(begun.read_text()) <= often:
        os._exit(1)
    return [often]


@pytest.mark.campaign  # where workers are no copies they import everything: 3 s
def test_a_task_that_kills_its_workers_time_and_again_is_reported(tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "TRIES", 2)
    assert list(spread.in_processes([(tmp_path / "once", 1)], dies, 1)) == [[1]]
    rows = spread.in_processes([(tmp_path / "never", 0), (tmp_path / "many", 9)], dies, 1)
    assert next(rows) == [0]
    with pytest.raises(
        ct.InputError,
        match=r"^workers: found 1 unfinished tasks after their process was killed 2 "
        r"times",
    ):
        next(rows)
    assert [len((tmp_path / name).read_text()) for name in ("once", "never", "many")] == [2, 1, 3]


class DyingPool:
    """Does some tasks; then its workers are dead."""

    def __init__(self, count):
        self.left = count

    def submit(self, work, task):
        if not self.left:
            raise BrokenProcessPool
        self.left -= 1
        done = Future()
        done.set_result(work(task))
        return done


@pytest.mark.parametrize("later", [3, 0])
def test_a_worker_that_dies_while_tasks_are_given_out_loses_none_of_them(later, monkeypatch):
    """Many deaths are no reason to stop while tasks are finished; five in succession without any are."""
    opened = []

    @contextmanager
    def dying_pool(_):
        opened.append(3 if len(opened) < 2 else later)
        yield DyingPool(opened[-1])

    monkeypatch.setattr(workers, "worker_pool", dying_pool)
    found = spread.in_processes(range(30), str, 2)
    if later:
        assert set(found) == set(map(str, range(30)))
        assert len(opened) == 10
        return
    assert [next(found) for _ in range(6)]
    with pytest.raises(
        ct.InputError, match="workers: found 24 unfinished tasks after their process was killed 5 times"
    ):
        next(found)
    assert len(opened) == 7


@pytest.mark.campaign
def test_a_killed_driver_and_killed_workers_lose_nothing(scene, tmp_path):
    """kill -9 of the driver midway: its workers end too; the resumed table is that of an undisturbed run."""
    many = GRID.replace("steps = 3", "steps = 60").replace("values = [0.0, 0.1, 100.0]", "values = [0.0, 0.1]")
    file = scene(many, SCENE.replace("t_end = 0.04", "t_end = 0.4"))
    plan, store = load_sweep(file), tmp_path / "store"
    driver = sweep_kills.driver(tmp_path, file, store)
    deadline = time.monotonic() + 240.0
    while sweep_kills.finished(store) < 8 and time.monotonic() < deadline:
        time.sleep(0.02)
    sweep_kills.kill(driver)
    kept = len(Store.open(store).files())
    assert 8 <= kept < 120
    assert Store.open(store).unreadable() == []
    assert sweep.run_sweep(plan, folder=store).resumed >= kept
    found = sweep_kills.compared(plan, sweep.run_sweep(plan), store)
    assert list(found.values()) == [120, 0, True, True]
