"""Sweeps from scene files: what is run, what the table says, the same bits whatever happens on the way."""

import csv
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from synthetic_rim import blade, ring

import contact as ct
from contact.scene.load import scene_of
from contact.sweep import dask_cluster as sweep_dask
from contact.sweep import sweep
from contact.sweep.plan import load_sweep
from contact.sweep.row import growth_rate, row_of, sweep_record
from contact.sweep.store import Store

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


def test_a_grid_is_every_combination_and_the_table_says_what_each_did(scene):
    plan = load_sweep(scene(GRID))
    assert [run.values for run in plan.runs][:4] == [(15.0, 0.0), (15.0, 0.1), (15.0, 100.0), (20.0, 0.0)]
    result = sweep.run_sweep(plan)
    text = sweep.table(result)
    assert text.startswith("# COMPUTED: sweep of scene.toml, 9 runs\n# casingfem: ")
    assert "# sha256: " in text
    rows = read(text)
    assert [row["status"] for row in rows] == ["done", "done", "refused"] * 3
    assert "the blade jams" in rows[2]["why"]
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


def test_the_hash_follows_all_that_defines_a_run(scene, tmp_path):
    file = scene(GRID)
    first = [run.digest for run in load_sweep(file).runs]
    assert [run.digest for run in load_sweep(file).runs] == first
    file.write_text(file.read_text() + "# a remark\n")
    assert [run.digest for run in load_sweep(file).runs] == first
    ring(S=0.0, zeta=0.011).save(tmp_path / "casing.npz")
    assert not set(first) & {run.digest for run in load_sweep(file).runs}


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


def test_bodies_on_an_axis_are_swept_too(tmp_path):
    file = tmp_path / "ball.toml"
    file.write_text(
        (Path(__file__).parents[2] / "data/scenes/two_rods.toml").read_text()
        + """
[sweep]
[[sweep.vary]]
key = "rod[1].velocity"
values = [1.0, 2.0]
"""
    )
    rows = read(sweep.table(sweep.run_sweep(load_sweep(file))))
    assert [row["status"] for row in rows] == ["done", "done"]
    assert float(rows[1]["impulse_N_s"]) == pytest.approx(2.0 * float(rows[0]["impulse_N_s"]), rel=0.05)
    assert rows[0]["dominant_n"] == ""


@pytest.mark.parametrize(("table", "words"), [
    ("", "sweep: missing"),
    ("[sweep]\n", "sweep.vary: missing"),
    ('[sweep]\nvary = [{key = "speed.hz"}]', "found neither values nor both from and to"),
    ('[sweep]\nvary = [{key = "speed.hz", from = 1, to = 2}]', "steps missing"),
    ('[sweep]\nvary = [{key = "speed.hz", values = [1], log = true}]', "values found beside"),
    ('[sweep]\nvary = [{key = "speed.hz", from = 0, to = 2, steps = 3, log = true}]', "log found with from or to <= 0"),
    ('[sweep]\nkind = "random"\nvary = [{key = "speed.hz", from = 1, to = 2}]', "draws and seed belong to"),
    ('[sweep]\nvary = [{key = "motor.hz", values = [1]}]', "the scene has no 'motor' there"),
    ('[sweep]\nvary = [{key = "speed.rpm", values = [1]}]', "speed.rpm: unknown key"),
    ('[sweep]\nvary = [{key = "contact.out_of_roundness[2].cos", values = [1]}]', "no 'out_of_roundness[2]' there"),
    ('[sweep]\nvary = [{key = "speed", values = [1]}]', "expected table.key of the scene"),
    ('[sweep]\nkind = "list"\nvary = [{key = "speed.hz", values = [1]}, {key = "blade.lean_deg", values = [1, 2]}]',
     "lists of [1, 2] values"),
    ('[sweep]\nvary = [{key = "speed.hz", values = [1]}, {key = "speed.hz", values = [1]}]', "found a key twice"),
    ('[sweep]\nvary = [{key = "casing.basis", values = ["none.npz"]}]', "none.npz"),
])  # fmt: skip
def test_bad_sweeps_are_refused_with_their_key(scene, table, words):
    with pytest.raises(ct.SceneError) as error:
        load_sweep(scene(table))
    assert words in str(error.value)
    assert "scene.toml" in str(error.value)


def test_a_scene_with_a_sweep_runs_as_it_stands(scene):
    assert ct.run(ct.load_scene(scene(GRID))).steps == 2000


def test_growth_rows_and_records():
    t = np.linspace(0.0, 1.0, 2000)
    wave = np.exp(-3.0 * t) * np.sin(300.0 * t)
    assert growth_rate(t, wave[:, None]) == pytest.approx(-3.0, rel=0.02)
    late = np.where(t < 0.4, 0.0, wave)
    assert growth_rate(t, late[:, None]) == pytest.approx(-3.0, rel=0.15)
    assert np.isnan(growth_rate(t, np.zeros((2000, 1))))
    assert np.isnan(growth_rate(t[:20], wave[:20, None]))
    assert sweep_record(1_000_000).every == 3889
    assert row_of(None, ct.LimitError("too far"))["why"] == "too far"


def test_amplitudes_and_dominant_n_are_those_of_a_known_motion(scene):
    """Only the pair n = 3 moves: its level is that of one cosine."""
    free = ct.RotatingRim(
        ring(S=0.0, zeta=0.0), blade(S=0.0, zeta=0.0), clearance=0.04, speed_hz=20.0,
        casing_velocity=[0.0, 0.0, 1.0, *[0.0] * 7],
    )  # fmt: skip
    scene = ct.Scene(what=free, t_end=0.5, dt=2e-5, record=sweep_record(25_000))
    row = row_of(scene, ct.run(scene))
    expected = 1.0 / np.sqrt(1.0 + 1.0 / 9.0) / (2.0 * np.pi * 160.0) / np.sqrt(2.0)
    assert row["dominant_n"] == 3
    assert row["dominant_rms_m"] == pytest.approx(expected / np.sqrt(2.0), rel=0.05)
    assert abs(row["growth_1_s"]) < 0.3
    assert row["contact_fraction"] == 0.0


def test_without_a_scheduler_and_without_the_package(scene, monkeypatch):
    plan = load_sweep(scene(GRID))
    monkeypatch.setattr(sweep_dask, "PATIENCE", "1s")
    with pytest.raises(ct.InputError, match="found nobody at"):
        list(sweep.run_sweep(plan, scheduler="tcp://127.0.0.1:1").rows)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ct.InputError, match=r"install casingfem\[cluster\]"):
        sweep.run_sweep(plan, scheduler="tcp://127.0.0.1:1")


@pytest.mark.slow
def test_a_killed_driver_and_killed_workers_lose_nothing(scene, tmp_path):
    """kill -9 of the driver midway: its workers end too; the resumed table is that of an undisturbed run."""
    many = GRID.replace("steps = 3", "steps = 60").replace("values = [0.0, 0.1, 100.0]", "values = [0.0, 0.1]")
    file = scene(many, SCENE.replace("t_end = 0.04", "t_end = 0.4"))
    plan, store = load_sweep(file), tmp_path / "store"
    code = (
        "import sys\nfrom pathlib import Path\nfrom contact.sweep.sweep import run_sweep\n"
        "from contact.sweep.plan import load_sweep\n"
        "if __name__ == '__main__':\n    run_sweep(load_sweep(sys.argv[1]), folder=Path(sys.argv[2]), jobs=2)\n"
    )
    script = tmp_path / "drive.py"
    script.write_text(code)
    root = str(Path(__file__).parents[2])
    driver = subprocess.Popen(
        [sys.executable, str(script), str(file), str(store)], env={**os.environ, "PYTHONPATH": root}
    )
    deadline = time.monotonic() + 240.0
    while len(list((store / "runs").glob("??/*.json"))) < 8 and time.monotonic() < deadline:
        time.sleep(0.02)
    driver.send_signal(signal.SIGKILL)
    driver.wait()
    kept = len(Store.open(store).files())
    assert 8 <= kept < 120
    assert Store.open(store).unreadable() == []
    result = sweep.run_sweep(plan, folder=store)
    assert result.resumed >= kept
    assert sweep.table(result) == sweep.table(sweep.run_sweep(plan))
