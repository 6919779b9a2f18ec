"""casingfem update with measured shapes: MAC before and after in document, print and page are those of the modes."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main

CASING = """
[material]
E = 210e9
nu = 0.3
rho = 7800.0
[chart]
kind = "frustum"
r_base = 0.50
r_top = 0.45
height = 0.25
[shell]
thickness = 3.0e-3
[[imperfection]]
of = "radius"
harmonics = [{p = 14, cos = 0.0003, sin = 0.0001}, {p = 16, cos = COS, sin = SIN}]
[support.base]
kind = "clamped"
[mesh]
order = 5
rows = 1
around = 11
"""
UPDATE = """
[update]
table = "table.csv"
shapes = "shapes.uff"
shape_sigma = 0.01
[[update.parameter]]
name = "radius.p16.cos"
lower = -0.002
upper = 0.002
[[update.parameter]]
name = "radius.p16.sin"
lower = -0.002
upper = 0.002
"""
TRUTH, START = {"COS": "0.0006", "SIN": "0.0001"}, {"COS": "0.0003", "SIN": "0.0004"}
ROWS, SENSORS = 6, 20
pytestmark = pytest.mark.slow


def written(path, values, more=""):
    text = CASING
    for name, value in values.items():
        text = text.replace(name, value)
    path.write_text(text + more, encoding="utf-8")
    return path


def invoke(*arguments):
    done = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert done.exit_code == 0, done.output
    return done.stdout


@pytest.fixture(scope="module")
def updated(tmp_path_factory):
    """An update whose table has six rows, four with a shape, and a shape of no row: folder, what it printed, truth."""
    folder = tmp_path_factory.mktemp("fit")
    truth = written(folder / "truth.toml", TRUTH, "[modes]\ncount = 12\n")
    found = cf.modes(cf.load_study(truth).shell, 12)
    invoke("modes", truth, "--uff", "--modes", "1,2,3,4,9", "--out", folder)
    at_some_nodes(folder / "modes.uff", folder / "shapes.uff", np.arange(SENSORS) * 16)
    n = found.nodal_diameters
    cf.FrequencyTable.from_arrays(freq_hz=found.freq[:ROWS], sigma_hz=0.02, n=n[:ROWS]).to_csv(folder / "table.csv")
    study = written(folder / "study.toml", START, UPDATE)
    return folder, invoke("update", study, "--out", folder / "out"), found


def document_of(folder):
    return json.loads((folder / "out" / "update.json").read_text(encoding="utf-8"))


def at_some_nodes(source, target, kept):
    """Write the shapes of a universal file at some of its nodes."""
    file = cf.uff.read_uff(source)
    whole, few = file.nodes, {}
    for name in ("labels", "points", "systems", "motions"):
        few[name] = getattr(whole, name)[kept]
    shapes = []
    for shape in file.shapes:
        at = [shape.nodes.tolist().index(label) for label in few["labels"]]
        shapes.append(replace(shape, nodes=shape.nodes[at], values=shape.values[at]))
    cf.uff.write_uff(target, header=file.header, units=file.units, nodes=cf.uff.Nodes(**few), shapes=shapes)


def mac(a, b):
    return float((a @ b) ** 2 / ((a @ a) * (b @ b)))


@pytest.mark.parametrize("side", ["before", "after"])
def test_the_mac_of_each_shape_is_that_with_the_mode_it_pairs_with(updated, side):
    folder, _, _ = updated
    at = folder / "study.toml" if side == "before" else folder / "out" / "study_updated.toml"
    study = cf.load_study(at)
    modes = cf.modes(study.shell, 12)
    readings, shapes = study.shapes.readings(modes), study.shapes.shapes
    np.testing.assert_array_equal(shapes, cf.load_study(folder / "study.toml").shapes.shapes)  # the updated study's too
    rows = document_of(folder)["shapes"]["rows"]
    assert [row["mode"] for row in rows] == [1, 2, 3, 4]
    for k, row in enumerate(rows):
        mode = row[f"computed_{side}"] - 1
        assert row[f"mac_{side}"] == pytest.approx(mac(shapes[:, k], readings[:, mode]), abs=1e-6)
        pair = next((list(pair) for pair in modes.doublets if mode in pair), [mode])
        together = [j for j, other in enumerate(rows) if other[f"computed_{side}"] - 1 in pair]
        plane = cf.correlation.subspace_mac(shapes[:, together], readings[:, pair])
        assert row[f"plane_{side}"] == pytest.approx(plane, abs=1e-6)
        assert row["n"] == modes.nodal_diameters[mode]


def test_a_fit_of_the_wave_that_splits_a_pair_turns_its_members_to_the_measured_ones(updated):
    folder, _, found = updated
    document = document_of(folder)
    rows = document["shapes"]["rows"]
    turned = [row for row in rows if row["n"] == 8]
    assert turned
    assert max(row["mac_before"] for row in turned) < 0.95
    assert min(row["mac_after"] for row in rows) > 0.9999
    assert all(row["plane_before"] < row["plane_after"] for row in rows)
    values = {entry["name"]: entry["value"] for entry in document["parameters"]}
    assert values["radius.p16.cos"] == pytest.approx(float(TRUTH["COS"]), abs=2e-6)
    assert values["radius.p16.sin"] == pytest.approx(float(TRUTH["SIN"]), abs=2e-6)
    assert document["shapes"]["unused_hz"] == [pytest.approx(found.freq[8], rel=1e-6)]
    worst = document["shapes"]["worst_sensors"]
    assert len(worst) == 6
    assert [one["comac_after"] for one in worst] == sorted(one["comac_after"] for one in worst)
    assert all(one["comac_before"] <= one["comac_after"] + 1e-9 <= 1.0 + 2e-9 for one in worst)


def test_print_and_page_give_the_means_of_the_document_and_name_what_is_left_over(updated):
    folder, text, found = updated
    rows = document_of(folder)["shapes"]["rows"]
    means = [np.mean([row[f"plane_{side}"] for row in rows]) for side in ("before", "after")]
    first = re.search(r"shapes of 4 of 6 rows: MAC of planes ([\d.]+) -> ([\d.]+) in the mean, least ([\d.]+)", text)
    assert [float(first[1]), float(first[2])] == pytest.approx(means, abs=6e-4)
    assert float(first[3]) == pytest.approx(min(row["plane_after"] for row in rows), abs=6e-4)
    assert f"shapes without a row in the table: {found.freq[8]:.2f} Hz" in text
    page = (folder / "out" / "update.html").read_text(encoding="utf-8")
    assert "<h2>Mode shapes</h2>" in page
    assert "Without a shape: modes 5, 6 of the table" in page
    assert f"Measured shapes without a row in the table: {found.freq[8]:.2f} Hz" in page
    assert f"{means[0]:.3f} before the update and {means[1]:.3f} after it" in page
