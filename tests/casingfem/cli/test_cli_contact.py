"""Commands on scenes: interactions and campbell with their pictures, what --out holds, runs that diverge."""

import io
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

import casingfem as cf
import contact as ct
from casingfem.cli import main
from tests.probed import numbers_of_document

DATA = Path(__file__).parents[3] / "data"


def call(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.mark.slow
def test_interactions_print_write_and_draw_one_table(tmp_path, held):
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
    assert "`casingfem interactions SCENE` lists the dangerous speeds" in stability.stdout
    assert (tmp_path / "stability.png").exists()
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_interactions_of_a_scene_run_it_and_shade_what_is_unstable(tmp_path, held):
    from reports.verification.robustness.diverging import RIM, at, bodies

    bodies(tmp_path)
    scene = tmp_path / "rim.toml"
    scene.write_text(at(60.0, ("t_end = 2.0", "t_end = 0.1"), scene=RIM))
    found = call("interactions", scene, "--runs", "6", "--json")
    assert found.exit_code == 0
    document = json.loads(found.stdout)
    ran = [run["speed_hz"] for run in document["runs"]]
    assert set(np.linspace(ran[0], ran[-1], 6).tolist()) < set(ran)
    first = 6 + len(document["closed_contact"]["peaks"]) + 1  # and the scene's own speed
    assert len(ran) <= 8 * (first - 1) + 1  # each interval is halved three times at most
    assert {row["verdict"] for row in document["interactions"]} >= {"unstable"}
    assert call("interactions", scene, "--runs", "1").exit_code == 2
    held(1e-4, document=numbers_of_document(document))


def swept(folder, **values):
    """Rows of a sweep of a rubbing rim, and the printed lines on its motions; finished runs are read from the store."""
    from reports.verification.robustness.diverging import RIM, at

    scene = folder / "rim.toml"
    vary = "".join(f'[[sweep.vary]]\nkey = "{key.replace("_", ".")}"\nvalues = {v}\n' for key, v in values.items())
    scene.write_text(f"{at(60.0, ('t_end = 2.0', 't_end = 0.1'), scene=RIM)}[sweep]\n{vary}")
    words = "sweep", scene, "--jobs", 1, "--out", folder / "out"
    rows = json.loads(call(*words, "--json").stdout)["runs"]
    return rows, [line for line in call(*words).stdout.splitlines() if line.startswith(("motion", "fastest"))]


@pytest.mark.slow
def test_a_step_that_keeps_a_contact_closed_and_hides_its_growth_is_named(tmp_path):
    """At 2e-5 s the contact stays closed, and the motion decays although closed contact grows; at 1e-5 s it opens."""
    from reports.verification.robustness.diverging import RIM, at, bodies

    bodies(tmp_path)
    scene, found = tmp_path / "rim.toml", {}
    for dt in ("2e-5", "2e-6"):
        scan = "hz = 35.0\nscan = {from_hz = 34.0, to_hz = 36.0, steps = 21}"
        changed = (("t_end = 2.0", "t_end = 0.2"), ("dt = 2e-5", f"dt = {dt}"), ("hz = 35.0", scan))
        scene.write_text(at(35.0, *changed, scene=RIM))
        called = call("interactions", scene, "--runs", "2", "--json")
        assert called.exit_code == 0
        found[dt] = json.loads(called.stdout)["runs"]
    assert {(run["verdict"], run["check"]) for run in found["2e-5"]} == {("not decided", "numerical")}
    assert all(run["closed"] > 30.0 and run["growth"] < 0.0 and not run["opens"] for run in found["2e-5"])
    assert all(run["why"].endswith("at half the step it opens: reduce dt") for run in found["2e-5"])
    assert all(run["opens"] and "reduce dt" not in run["why"] for run in found["2e-6"])
    page = tmp_path / "out"
    scene.write_text(at(35.0, *changed[:1], changed[2], scene=RIM))
    assert call("report", scene, "--out", page).exit_code == 0
    text = (page / "report.html").read_text()
    assert "Not decided at 2,100 rpm (35 Hz) in a run of" in text
    assert "Reduce dt, then run the scene again." in text


@pytest.mark.slow
def test_a_sweep_names_the_motions_of_its_runs_and_the_fastest_growth_with_its_interval(tmp_path):
    from reports.verification.robustness.diverging import bodies

    bodies(tmp_path)
    rows, (motions, fastest) = swept(tmp_path, speed_hz=[60.0, 110.0, 150.0, 100.0], contact_clearance=[-1e-5, 1e-3])
    assert motions == "motion of the runs: 4 at rest, 3 grows, 1 bounded"
    most = max((row for row in rows if row["motion"] == "grows"), key=lambda row: row["growth_1_s"])
    between = f"95 %: {most['growth_low_1_s']:.3g} to {most['growth_high_1_s']:.3g}"
    assert (most["speed.hz"], most["n"]) == (150.0, 4)
    assert fastest == (
        f"fastest growth {most['growth_1_s']:.4g} 1/s ({between}) at speed.hz = 150.0, contact.clearance = -1e-05:"
        f" n = 4 of the casing, energy from the turning rim; half the wall at {most['half_wall_at_s']:.3g} s"
    )
    _, (motions, fastest) = swept(tmp_path, speed_hz=[110.0])  # a motion of blades that are not evenly spaced
    assert motions == "motion of the runs: 1 grows"
    assert " at speed.hz = 110.0: the blades, energy from friction; half the wall" in fastest
    assert swept(tmp_path, contact_clearance=[1e-3])[1] == ["motion of the runs: 1 at rest"]
    replace(ct.ModalBody.load(tmp_path / "casing.npz"), thickness=0.0).save(tmp_path / "casing.npz")
    assert swept(tmp_path, speed_hz=[150.0])[1][1].endswith(
        " at speed.hz = 150.0: n = 4 of the casing, energy from the turning rim"
    )


def test_a_sweep_of_rods_names_no_motion(tmp_path):
    scene = (DATA / "scenes" / "two_rods.toml").read_text()
    (tmp_path / "rods.toml").write_text(
        f'{scene}[sweep]\n[[sweep.vary]]\nkey = "scheme.courant"\nvalues = [0.5, 0.9]\n'
    )
    printed = call("sweep", tmp_path / "rods.toml", "--jobs", 1).stdout
    assert printed.startswith("2 runs over scheme.courant")
    assert "motion" not in printed


def test_campbell_of_a_study_at_rest_is_refused_and_a_turning_one_drawn(tmp_path):
    refused = call("campbell", DATA / "studies" / "frustum.toml")
    assert refused.exit_code == 2
    assert "rotation" in refused.stderr


@pytest.mark.slow
def test_campbell_of_a_blade_that_is_asks_for_a_speed(tmp_path):
    study = tmp_path / "blade.toml"
    text = (DATA / "studies" / "rotating_blade.toml").read_text(encoding="utf-8")
    study.write_text(text.replace("speed_hz = 100.0", "speed_hz = 0.0"), encoding="utf-8")
    refused = call("campbell", study)
    assert refused.exit_code == 2
    assert "--to-hz: missing, and the speed of STUDY is 0" in refused.stderr
    given = call("campbell", study, "--count", 1, "--steps", 2, "--to-hz", 10.0, "--json")
    assert given.exit_code == 0, given.stderr
    assert json.loads(given.stdout)["speed_hz"] == [0.0, pytest.approx(10.0)]


@pytest.mark.slow
def test_campbell_of_a_blade(tmp_path, held):
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
    held(1e-4, document=numbers_of_document(document))


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
    assert "diverged: the rim deflected by" in found.stderr
    assert "diverged" in found.stdout
    kept = ct.Result.load(tmp_path / "out" / "rub.npz")
    assert kept.divergence.limit == "wall"
    assert json.loads((tmp_path / "out" / "rub.json").read_text())["divergence"]["growth_1_s"] > 100.0


@pytest.mark.slow
def test_out_keeps_a_picture_and_the_forces_and_the_report_has_all(tmp_path):
    from reports.verification.robustness.diverging import RIM, at, bodies

    bodies(tmp_path)
    scene = tmp_path / "rim.toml"
    scene.write_text(at(20.0, ("t_end = 2.0", "t_end = 0.1"), scene=RIM))
    out = tmp_path / "out"
    assert call("rub", scene, "--out", out).exit_code == 0
    assert {path.name for path in out.iterdir() if path.suffix == ".png"} == {"rub.png"}
    lines = (out / "rub_forces.csv").read_text().splitlines()
    assert lines[0].startswith("# COMPUTED: contact forces")
    assert lines[1] == "time_s,force1_mean_N,force1_peak_N,gap1_least_m"
    kept = ct.Result.load(out / "rub.npz")
    assert len(lines) - 2 == kept.time.size == 5_000
    forces = np.loadtxt(out / "rub_forces.csv", delimiter=",", skiprows=2)
    assert forces[:, 2].max() == pytest.approx(kept.peak_force[0], rel=1e-8)
    page = call("report", scene, "--out", out)
    assert page.exit_code == 0
    html = (out / "report.html").read_text()
    for words in ("Dangerous speeds", "Orbits of the first tip", "runs of the scene at", "kind = &#34;rim&#34;"):
        assert words in html
    numbers = dict(re.findall(r"<tr><td>(.*?)</td><td[^>]*>(.*?)</td></tr>", html))
    stated = [numbers[name] for name in ("speed", "time simulated [s]", "time step [s]", "steps")]
    assert stated == ["1,200 rpm (20 Hz)", "0.1", "2 × 10⁻⁵", "5,000"]
    assert f"impulse {kept.impulse.sum():.4g} N s" in html
    assert "The law of contact and the balance of energy are satisfied to rounding." in html
    # gap and force, contact angle, energy, orbits, two spectra, waves; the Campbell diagram and the interaction map
    assert html.count("<img") == 9


@pytest.mark.slow
def test_out_has_one_picture_unless_all_are_asked_for_and_rods_have_no_orbit(tmp_path):
    scene = DATA / "scenes" / "two_rods.toml"
    assert call("contact", scene, "--pictures").exit_code == 2  # without a folder
    for more, drawn in (((), {"contact.png"}), (("--pictures",), {"contact_spectrum.png", "contact_energy.png"})):
        assert call("contact", scene, "--out", tmp_path, *more).exit_code == 0
        shown = {path.name for path in tmp_path.iterdir() if path.suffix == ".png"}
        assert shown == drawn | {"contact.png"}
