"""casingfem correlate and casingfem locate: files in, pictures and one document out."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from tests.casingfem.study.study_texts import THIN
from tests.probed import numbers_of_document

STUDY = (
    THIN
    + """
[support.base]
kind = "bolts"
count = 12
k = 1e9
k_rot = 1e6
[mesh]
order = 5
rows = [0.0, 0.05, 1.0]
around = 12
[modes]
count = 10
method = "shell"
"""
)


NOT_ROUND = """
[[imperfection]]
of = "radius"
harmonics = [{p = 10, cos = 1e-4}, {p = 12, cos = 2e-4}]
"""
LOOSE = "count = 12\nloose = [{bolt = 4, factor = 0.2}]"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A casing as designed, one as made, and that with bolt 4 loose: studies, tables of modes, shapes.

    The casing as made is not round: that splits pairs in both tables, and only a baseline accounts for it.
    """
    where = tmp_path_factory.mktemp("study")
    made = STUDY + NOT_ROUND
    for study, text, shown in (
        ("casing", STUDY, "1,2,3,4,5,6"),
        ("loose", made.replace("count = 12", LOOSE, 1), "1,2,3,4,5,6,7,8,9,10"),
    ):  # fmt: skip
        (where / f"{study}.toml").write_text(text, encoding="utf-8")
        words = ("--uff", "--sigma", "1e-4", "--modes", shown, "--out", where / study)
        done = invoke("modes", where / f"{study}.toml", *words)
        assert done.exit_code == 0, done.output
    (where / "tight.toml").write_text(made, encoding="utf-8")
    tight = cf.modes(cf.load_study(where / "tight.toml").shell, 10)
    cf.FrequencyTable.from_arrays(
        freq_hz=tight.freq, sigma_hz=1e-4 * tight.freq, n=tight.nodal_diameters, angle_deg=tight.angle_deg
    ).to_csv(where / "tight.csv")
    return where


def invoke(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.mark.slow
def test_correlate_writes_pictures_and_a_document(folder, tmp_path, held):
    result = invoke("correlate", folder / "casing.toml", folder / "casing" / "modes.uff", "--json", "--out", tmp_path)
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert [row["mode"] for row in document["shapes"]] == [1, 2, 3, 4, 5, 6]
    assert min(row["subspace_mac"] for row in document["shapes"]) > 0.999
    made = {path.name for path in tmp_path.iterdir() if path.suffix != ".parquet"}
    assert made == {"correlation.csv", "correlation.json", "mac.png", "comac.png"}
    held(1e-4, document=numbers_of_document(document))


def test_correlate_refuses_a_file_without_shapes(folder, tmp_path):
    (tmp_path / "empty.uff").write_text("    -1\n   151\n" + "x\n" * 7 + "    -1\n", encoding="ascii")
    result = invoke("correlate", folder / "casing.toml", tmp_path / "empty.uff")
    assert result.exit_code == 2
    assert "expected modes in sets 55" in result.stderr
    assert str(folder / "casing.toml") not in result.stderr  # the study is not at fault


@pytest.mark.slow
def test_correlate_refuses_shapes_that_pair_with_no_mode(folder):
    result = invoke("correlate", folder / "casing.toml", folder / "casing" / "modes.uff", "--reach", "1e-9")
    assert result.exit_code == 2, result.exception  # the file has six digits
    assert "found no shape that pairs with a mode" in result.stderr


@pytest.mark.slow
def test_the_line_of_low_comac_stays_a_line(folder):
    shapes = cf.correlation.MeasuredShapes.from_uff(folder / "casing" / "modes.uff")
    found = cf.correlate(cf.modes(cf.load_study(folder / "casing.toml").shell, 10, method="shell"), shapes)
    line = repr(replace(found, comac=np.zeros_like(found.comac))).splitlines()[-1]
    assert re.fullmatch(r"COMAC below 0.9: sensors (\d+, ){11}\d+ and \d+ more", line), line


@pytest.mark.slow
def test_locate_names_the_bolt_or_the_opposite_one_from_computed_modes_as_they_are(folder, tmp_path, held):
    result = invoke(
        "locate", folder / "casing.toml", folder / "loose" / "modes.csv", "--baseline", folder / "tight.csv",
        "--shapes", folder / "loose" / "modes.uff", "--json", "--out", tmp_path,
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    places = {one["place"] for explanation in document["explanations"] for one in explanation["found"]}
    assert places == {4, 10}
    assert document["by_shapes"][0]["places"] == [4]
    assert document["found"][0]["value"] == pytest.approx(0.2, abs=0.03)
    assert document["chi2"] < 10.0  # as designed, the splits of manufacture leave 37,000
    made = {path.name for path in tmp_path.iterdir() if path.suffix != ".parquet"}
    assert made == {"located.csv", "located.json", "located.png"}
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_computed_modes_go_to_correlate_as_they_are(folder):
    result = invoke("correlate", folder / "loose.toml", folder / "loose" / "modes.uff", "--json")
    assert result.exit_code == 0, result.output
    assert min(row["subspace_mac"] for row in json.loads(result.stdout)["shapes"]) > 0.999


@pytest.mark.slow
def test_locate_refuses_a_table_without_labels(folder, tmp_path):
    bare = cf.FrequencyTable.from_arrays(freq_hz=[366.0, 367.0], sigma_hz=0.1)
    bare.to_csv(tmp_path / "bare.csv")
    result = invoke("locate", folder / "casing.toml", tmp_path / "bare.csv")
    assert result.exit_code == 2
    assert "locate-unlabelled" in result.stderr


@pytest.mark.slow
def test_locate_refuses_to_judge_masses_by_shapes(folder):
    result = invoke(
        "locate",
        folder / "casing.toml",
        folder / "loose" / "modes.csv",
        "--shapes",
        folder / "loose" / "modes.uff",
        "--among",
        "mass",
    )
    assert result.exit_code == 2
    assert "--shapes found with a search for masses" in result.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--most", "0"), "0 is not in the range 1<=x<=12"),
        (("--most", "13"), "13 is not in the range 1<=x<=12"),
        (("--model-error", "-0.01"), "-0.01 is not in the range 0.0<=x<=0.5"),
        (("--model-error", "0.51"), "0.51 is not in the range 0.0<=x<=0.5"),
        (("--among", "screws"), "'screws' is not one of 'bolts', 'mass'"),
    ],
)
def test_locate_refuses_what_is_no_search(words, said):
    result = invoke("locate", "casing.toml", "table.csv", *words)
    assert result.exit_code == 2
    assert said in " ".join(result.stderr.split())
