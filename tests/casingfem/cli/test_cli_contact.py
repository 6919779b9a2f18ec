"""Commands on scenes: interactions and campbell with their pictures, what --out holds, runs that diverge."""

import io
import json
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

import casingfem as cf
import contact as ct
from casingfem.cli import main, pictures
from casingfem.plot.interaction import figure_interactions
from casingfem.plot.motion import figure_orbit, figure_spectrum, waterfall
from casingfem.plot.sweep import figure_sweep
from contact.model.gaps.bladed_disk import pair_rim

DATA = Path(__file__).parents[3] / "data"


def call(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.mark.slow
def test_interactions_print_write_and_draw_one_table(tmp_path):
    found = call("interactions", DATA / "scenes" / "pair.toml", "--out", tmp_path, "--json")
    assert found.exit_code == 0
    document = json.loads(found.stdout)
    (row,) = document["interactions"]
    assert row["closed_1_s"] == pytest.approx(3.788, rel=1e-3)
    assert (row["n"], row["wave"], row["verdict"]) == (8, "with", "unstable")
    text = (tmp_path / "interactions.csv").read_text()
    assert text.startswith("# COMPUTED")
    table = pd.read_csv(io.StringIO(text), comment="#")
    assert table.columns.tolist() == list(row)
    assert table["closed_1_s"].tolist() == [row["closed_1_s"]]
    assert all(f"# {name}: " in text for name in row)
    assert (tmp_path / "interactions.png").read_bytes()[1:4] == b"PNG"
    printed = call("interactions", DATA / "scenes" / "pair.toml").stdout
    assert "3.79" in printed
    assert max(map(len, printed.splitlines()[:2])) <= 100
    stability = call("stability", DATA / "scenes" / "pair.toml", "--out", tmp_path)
    assert "`casingfem interactions SCENE` runs the scene itself and lists the dangerous" in stability.stdout
    assert (tmp_path / "stability.png").exists()


@pytest.mark.slow
def test_interactions_of_a_scene_run_it_and_shade_what_is_unstable(tmp_path):
    from reports.verification.robustness.diverging import RIM, at, bodies

    bodies(tmp_path)
    scene = tmp_path / "rim.toml"
    scene.write_text(at(60.0, ("t_end = 2.0", "t_end = 0.1"), scene=RIM))
    found = call("interactions", scene, "--runs", "6", "--json")
    assert found.exit_code == 0
    document = json.loads(found.stdout)
    peaks = document["closed_contact"]["peaks"]
    assert len(document["runs"]) <= 6 + len(peaks)
    assert {row["verdict"] for row in document["interactions"]} >= {"unstable"}
    assert call("interactions", scene, "--runs", "1").exit_code == 2


@pytest.mark.parametrize(
    ("count", "size", "every"), [(10, 5, 1), (1_000_001, 40, 1), (1_000_000, 40, 3), (7, 10**7, 2)]
)
def test_states_for_pictures_are_the_most_that_fit(count, size, every):
    """Stored together with a sample; one more of them would not fit."""

    @dataclass
    class Ready:
        record: ct.Record
        count: int
        stepper: SimpleNamespace

    record = pictures.with_states(Ready(ct.Record(every=every), count, SimpleNamespace(size=size))).record
    assert record.every == every
    assert record.state_every % every == 0
    assert count * size <= pictures.STATES * record.state_every
    closer = record.state_every - every
    assert closer == 0 or count * size > pictures.STATES * closer


def test_each_track_of_a_coating_has_its_own_picture(monkeypatch):
    monkeypatch.setattr("casingfem.plot.contact.figure_wear", lambda track: track)
    monkeypatch.setattr("casingfem.plot.style.png", lambda figure: f"picture of {figure}".encode())
    assert pictures.coatings(("a",)) == {"coating.png": b"picture of a"}
    assert pictures.coatings(("a", "b")) == {"coating_1.png": b"picture of a", "coating_2.png": b"picture of b"}


@pytest.mark.slow
def test_the_picture_shades_the_ranges_that_the_table_calls_unstable_and_no_other():
    tip = ct.ModalBody(omega=[240.0 * np.pi], zeta=[2e-4], channels=("span", "flap"), rows=[[0.4**-0.5], [0.0]],
                       S=np.eye(2) * 1e-4)  # fmt: skip
    casing = pair_rim(ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5, zeta=2e-4), radius=0.5)
    for clearance, shaded in ((-1e-5, 1), (1e-3, 0)):
        rim = ct.RotatingRim(casing, tip, clearance=clearance, speed_hz=20.0)
        found = ct.interactions(ct.Scene(what=rim, t_end=0.5, dt=1e-4), np.linspace(45.0, 60.0, 61), runs=6)
        figure = figure_interactions(found)
        for axes in figure.axes:
            bands = [patch.get_extents().transformed(axes.transData.inverted()) for patch in axes.patches]
            assert [(band.x0, band.x1) for band in bands] == [
                pytest.approx((row.from_hz, row.to_hz)) for row in found.of("unstable")
            ]
            assert len(bands) == shaded
        upper, lower, _ = figure.axes
        assert upper.get_ylabel() == "frequency at the blade [Hz]"
        points = [line for line in lower.lines if line.get_marker() in ("^", "o")]
        assert sorted(line.get_xdata()[0] for line in points) == [run.speed_hz for run in found.runs]


def test_campbell_of_a_study_at_rest_is_refused_and_a_turning_one_drawn(tmp_path):
    refused = call("campbell", DATA / "studies" / "frustum.toml")
    assert refused.exit_code == 2
    assert "rotation" in refused.stderr


@pytest.mark.slow
def test_campbell_of_a_blade_that_stands_asks_for_a_speed(tmp_path):
    study = tmp_path / "blade.toml"
    text = (DATA / "studies" / "rotating_blade.toml").read_text(encoding="utf-8")
    study.write_text(text.replace("speed_hz = 100.0", "speed_hz = 0.0"), encoding="utf-8")
    refused = call("campbell", study)
    assert refused.exit_code == 2
    assert "--to-hz: STUDY is at rest: give the highest speed" in refused.stderr
    given = call("campbell", study, "--count", 1, "--steps", 2, "--to-hz", 10.0, "--json")
    assert given.exit_code == 0, given.stderr
    assert json.loads(given.stdout)["speed_hz"] == [0.0, pytest.approx(10.0)]


@pytest.mark.parametrize(
    ("speed", "words", "top", "steps", "count"),
    [
        ("100.0", (), 150.0, 16, 6),
        ("20.0", (), 30.0, 16, 6),
        ("100.0", ("--to-hz", 7, "--steps", 3, "--count", 2), 7.0, 3, 2),
    ],
)
def test_a_campbell_diagram_goes_from_rest_to_half_as_much_again_as_the_study(
    tmp_path, monkeypatch, speed, words, top, steps, count
):
    study, heard = tmp_path / "blade.toml", []
    text = (DATA / "studies" / "rotating_blade.toml").read_text(encoding="utf-8")
    study.write_text(text.replace("speed_hz = 100.0", f"speed_hz = {speed}"), encoding="utf-8")

    def compute(*given):
        heard.extend(given)
        raise SystemExit(7)  # what it answers is judged elsewhere

    monkeypatch.setattr(import_module("casingfem.modal.campbell"), "campbell", compute)
    assert call("campbell", study, *words).exit_code == 7
    np.testing.assert_allclose(heard[1] / (2.0 * np.pi), np.linspace(0.0, top, steps))
    assert heard[2] == count


@pytest.mark.slow
def test_campbell_of_a_blade(tmp_path):
    found = call(
        "campbell", DATA / "studies" / "rotating_blade.toml", "--count", 2, "--steps", 3, "--to-hz", 50.0,
        "--out", tmp_path, "--json",
    )  # fmt: skip
    assert found.exit_code == 0
    document = json.loads(found.stdout)
    assert document["speed_hz"] == pytest.approx([0.0, 25.0, 50.0])
    meets = [(met["order"], met["mode"]) for met in document["crossings"]]
    assert (4, 1) in meets
    rows = (tmp_path / "campbell.csv").read_text().splitlines()
    assert rows[1] == "speed_hz,mode1_hz,mode2_hz"
    assert [float(cell) for cell in rows[-1].split(",")[1:]] == document["freq_hz"][-1]
    assert (tmp_path / "campbell.png").exists()


def test_a_campbell_diagram_marks_engine_orders():
    data = cf.modal.Campbell(
        omega=2.0 * np.pi * np.array([0.0, 50.0]), freq=np.array([[100.0], [110.0]]), southwell=np.array([2.0]),
        overlap=np.ones((2, 1)),
    )  # fmt: skip
    (axes,) = data.plot(orders=4).axes
    dots = [line for line in axes.lines if line.get_marker() == "o"]
    assert [(round(float(x), 2), round(float(y), 1)) for dot in dots for x, y in dot.get_xydata()] == [
        (35.71, 107.1), (26.32, 105.3),
    ]  # fmt: skip
    assert "3 at 35.71 Hz, 4 at 26.32 Hz" in data.table(4)
    assert cf.campbell is not None


@pytest.mark.slow
def test_a_run_that_diverges_writes_all_it_has_and_ends_with_3(tmp_path):
    from reports.verification.robustness.diverging import RIM, at, bodies

    bodies(tmp_path)
    scene = tmp_path / "rim.toml"
    scene.write_text(at(150.0, scene=RIM))
    found = call("rub", scene, "--out", tmp_path / "out")
    assert found.exit_code == 3
    assert "diverged: the rim moved" in found.stderr
    assert "diverged" in found.stdout
    kept = ct.Result.load(tmp_path / "out" / "rub.npz")
    assert kept.divergence.limit == "wall"
    assert json.loads((tmp_path / "out" / "rub.json").read_text())["divergence"]["growth_1_s"] > 100.0


@pytest.mark.slow
def test_out_holds_pictures_and_the_forces(tmp_path):
    from reports.verification.robustness.diverging import RIM, at, bodies

    bodies(tmp_path)
    scene = tmp_path / "rim.toml"
    scene.write_text(at(20.0, ("t_end = 2.0", "t_end = 0.2"), scene=RIM))
    out = tmp_path / "out"
    assert call("rub", scene, "--out", out, "--pictures").exit_code == 0
    names = ("", "_angle", "_energy", "_orbit", "_spectrum", "_spectrum_tip", "_waves")
    shown = {f"rub{name}.png" for name in names}
    assert shown <= {path.name for path in out.iterdir()}
    lines = (out / "rub_forces.csv").read_text().splitlines()
    assert lines[0].startswith("# COMPUTED: contact forces")
    assert lines[1] == "time_s,force1_mean_N,force1_peak_N,gap1_least_m"
    kept = ct.Result.load(out / "rub.npz")
    assert len(lines) - 2 == kept.time.size == 10_000
    forces = np.loadtxt(out / "rub_forces.csv", delimiter=",", skiprows=2)
    assert forces[:, 2].max() == pytest.approx(kept.peak_force[0], rel=1e-8)
    page = call("report", scene, "--out", out)
    assert page.exit_code == 0
    html = (out / "report.html").read_text()
    for words in ("Dangerous speeds", "Orbits of the first tip", "runs of the scene at", "kind = &#34;rim&#34;"):
        assert words in html
    assert html.count("<img") == len(names) + 2  # the Campbell diagram and the interaction map


@pytest.mark.slow
def test_out_has_one_picture_unless_all_are_asked_for_and_rods_have_no_orbit(tmp_path):
    scene = DATA / "scenes" / "two_rods.toml"
    assert call("contact", scene, "--pictures").exit_code == 2  # without a folder
    for more, drawn in (((), {"contact.png"}), (("--pictures",), {"contact_spectrum.png", "contact_energy.png"})):
        assert call("contact", scene, "--out", tmp_path, *more).exit_code == 0
        shown = {path.name for path in tmp_path.iterdir() if path.suffix == ".png"}
        assert shown == drawn | {"contact.png"}


def test_a_table_of_forces_goes_to_parquet_where_pyarrow_is(tmp_path):
    arrow = pytest.importorskip("pyarrow.parquet")
    from casingfem.cli.tables import of_columns

    of_columns({"time_s": np.arange(3.0)})(tmp_path / "forces.parquet")
    assert arrow.read_table(tmp_path / "forces.parquet")["time_s"].to_pylist() == [0.0, 1.0, 2.0]


def test_a_waterfall_follows_a_tone_that_climbs():
    step = 1e-4
    t = step * np.arange(20_000)
    values = 1e-6 * np.sin(2.0 * np.pi * (100.0 * t + 100.0 * t**2))  # 100 Hz + 200 Hz/s
    starts, freq, amplitude = waterfall(values, step)
    seen = freq[amplitude.argmax(axis=1)]
    middle = step * (starts + 0.5 * (values.size - starts[-1]))
    np.testing.assert_allclose(seen, 100.0 + 200.0 * middle, atol=25.0)
    axes = figure_spectrum(t, values, label="tip", unit="m", top_hz=800.0).axes
    assert (axes[0].get_ylabel(), axes[1].get_xlabel()) == ("tip [m]", "time [s]")
    mesh = axes[1].collections[0]
    assert (mesh.norm.vmin, mesh.norm.vmax) == (-60.0, 0.0)
    short = figure_spectrum(t[:50], values[:50], label="tip", unit="m").axes
    assert "too short a record" in short[1].texts[0].get_text()


@pytest.mark.slow
def test_sweeps_draw_diverged_runs_apart():
    rows = [
        {"status": status, "amplitude_m": amplitude, "contact_fraction": 1.0, "growth_1_s": rate, "dominant_n": 3,
         "diverged_at_s": at}
        for status, amplitude, rate, at in (
            ("done", 1e-6, -1.0, None), ("diverged", 1e-3, 40.0, 0.3), ("done", 2e-6, -2.0, None),
            ("refused", None, None, None),
        )
    ]  # fmt: skip
    figure = figure_sweep(["speed.hz"], np.array([[1.0], [2.0], [3.0], [4.0]]), rows)
    assert [axes.get_ylabel() for axes in figure.axes][3] == "diverged after [s]"
    amplitude, late = figure.axes[0], figure.axes[3]
    assert amplitude.lines[0].get_xdata().tolist() == [1.0, 3.0]
    assert late.lines[0].get_ydata().tolist() == [0.3]
    marks = {line.get_label(): line.get_xdata().tolist() for line in amplitude.lines if len(line.get_xdata())}
    assert (marks["diverged"], marks["refused or failed"]) == ([2.0], [4.0])
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["diverged", "refused or failed"]
    grid = [dict(row) for row in rows]
    assert len(figure_sweep(["a", "b"], np.array([[1.0, 1], [1.0, 2], [2.0, 1], [2.0, 2]]), grid).axes) == 8


def test_the_picture_of_an_orbit_shows_the_peaks_of_short_contacts():
    peaks = np.zeros((1000, 2))
    peaks[500] = [4e-6, -3e-6]
    figure = figure_orbit(SimpleNamespace(time=np.arange(1000.0), tip=peaks, rim=peaks))
    for axes in figure.axes:
        assert axes.get_xlim()[0] < -3.0 < 0.0 < axes.get_xlim()[1]
        assert axes.get_ylim()[0] < 0.0 < 4.0 < axes.get_ylim()[1]
