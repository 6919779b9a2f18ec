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
"""
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A study, its shapes as a universal file, and tables of a tight casing and of one with bolt 4 loose.

    The measured casing is not round: that splits pairs in both tables, and only a baseline accounts for it.
    """
    where = tmp_path_factory.mktemp("study")
    (where / "casing.toml").write_text(STUDY, encoding="utf-8")
    shell = cf.load_study(where / "casing.toml").shell
    bolts = shell.supports["base"]
    assert isinstance(bolts, cf.Bolts)
    shell = replace(shell, radius_defect=cf.FourierField.of({10: 1e-4, 12: 2e-4}))
    tight = cf.modes(shell, 14, method="shell")
    (where / "with_loose.toml").write_text(
        STUDY.replace("count = 12", "count = 12\nloose = [{bolt = 4, factor = 0.2}]", 1)
    )
    for study, shown, file in (("casing", "1,2,3,4,5,6", "shapes"), ("with_loose", "1,2,3,4,5,6,7,8,9,10", "loose")):
        words = ("--uff", "--sigma", "2e-4", "--modes", shown, "--out", where / study)
        done = invoke("modes", where / f"{study}.toml", *words)
        assert done.exit_code == 0, done.output
        (where / study / "modes.uff").rename(where / f"{file}.uff")
    for name, found in (("tight", tight), ("loose", cf.modes(loosened(shell, bolts), 14))):
        n, angle = found.nodal_diameters, found.angle_deg.copy()
        for low, high in found.doublets:
            if np.isnan(angle[low]):
                angle[[low, high]] = 0.0, 90.0 / n[low]
        table = cf.FrequencyTable.from_arrays(
            freq_hz=found.freq[:10], sigma_hz=1e-4 * found.freq[:10], n=n[:10], angle_deg=angle[:10]
        )
        table.to_csv(where / f"{name}.csv")
    return where


def loosened(shell, bolts):
    return replace(shell, supports={"base": replace(bolts, loose={4: 0.2})})


def invoke(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.mark.slow
def test_correlate_writes_pictures_and_a_document(folder, tmp_path):
    result = invoke("correlate", folder / "casing.toml", folder / "shapes.uff", "--json", "--out", tmp_path)
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert [row["mode"] for row in document["shapes"]] == [1, 2, 3, 4, 5, 6]
    assert min(row["subspace_mac"] for row in document["shapes"]) > 0.999
    made = {path.name for path in tmp_path.iterdir() if path.suffix != ".parquet"}
    assert made == {"correlation.csv", "correlation.json", "mac.png", "comac.png"}


def test_correlate_refuses_a_file_without_shapes(folder, tmp_path):
    (tmp_path / "empty.uff").write_text("    -1\n   151\n" + "x\n" * 7 + "    -1\n", encoding="ascii")
    result = invoke("correlate", folder / "casing.toml", tmp_path / "empty.uff")
    assert result.exit_code == 2
    assert "expected modes in sets 55" in result.stderr
    assert str(folder / "casing.toml") not in result.stderr  # the study is not at fault


@pytest.mark.slow
def test_correlate_refuses_shapes_that_pair_with_no_mode(folder):
    result = invoke("correlate", folder / "casing.toml", folder / "shapes.uff", "--reach", "1e-9")
    assert result.exit_code == 2, result.exception  # the file has six digits
    assert "found no shape that pairs with a mode" in result.stderr


@pytest.mark.slow
def test_the_line_of_low_comac_stays_a_line(folder):
    shapes = cf.correlation.MeasuredShapes.from_uff(folder / "shapes.uff")
    found = cf.correlate(cf.modes(cf.load_study(folder / "casing.toml").shell, 10, method="shell"), shapes)
    line = repr(replace(found, comac=np.zeros_like(found.comac))).splitlines()[-1]
    assert re.fullmatch(r"COMAC below 0.9: sensors (\d+, ){11}\d+ and \d+ more", line), line


@pytest.mark.slow
def test_locate_names_the_bolt_or_the_opposite_one(folder, tmp_path):
    result = invoke(
        "locate", folder / "casing.toml", folder / "loose.csv", "--baseline", folder / "tight.csv",
        "--shapes", folder / "loose.uff", "--json", "--out", tmp_path,
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


@pytest.mark.slow
def test_computed_modes_go_to_locate_and_correlate_as_they_are(folder):
    result = invoke(
        "locate", folder / "casing.toml", folder / "with_loose" / "modes.csv",
        "--baseline", folder / "casing" / "modes.csv", "--shapes", folder / "loose.uff", "--json",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["by_shapes"][0]["places"] == [4]
    result = invoke("correlate", folder / "with_loose.toml", folder / "loose.uff", "--json")
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
        "locate", folder / "casing.toml", folder / "loose.csv", "--shapes", folder / "loose.uff", "--among", "mass"
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
