"""What is wrong with a study file, in words: key, what was found, what was expected, code; all problems at once."""

import re

import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from reports.verification.modes.mesh_files import WRITERS
from tests.casingfem.study.study_texts import PLATE, STEEL_PLATE, THIN, written

BASE = '[support.base]\nkind = "clamped"\n'
CASING = THIN + BASE
PARAMETER = '[[update.parameter]]\nname = "material.E"\nlower = 1e11\nupper = 3e11\n'
UPDATE = f'[update]\ntable = "table.csv"\n{PARAMETER}'
REDUCE = '[reduce]\ninterface = "top"\nmodes = 4\n'
RIG = "[rig]\nseed = 1\nzeta = 0.01\n[[rig.drive]]\nat = [0.1, 0.0]\n[[rig.sensor]]\nat = [0.1, 0.0]\n"
TEST = '[rig.test]\nkind = "exact"\nband_hz = [100.0, 200.0]\nresolution_hz = 1.0\n'
SCAN = "[rig.scan]\nheight = 0.1\ntones_hz = [150.0]\nmirror_hz = 2.0\nseconds = 1.0\nfs = 1000.0\norders = 2\n"
SOLID = '[material]\nE = 2e11\nnu = 0.3\nrho = 7800.0\n[solid]\nmesh = "MESH"\n[support.root]\nkind = "clamped"\n'
PANEL = (
    THIN.partition("[chart]")[0]
    + """[chart]
kind = "panel"
radius = 0.5
length = 0.25
angle_deg = 40.0
[shell]
thickness = 3e-3
[support.base]
kind = "clamped"
"""
)
WAVES = '[[imperfection]]\nof = "radius"\nseed = 1\nrandom = [{{p = 2, median = 1e-4}}, {{p = {p}, median = 1e-4}}]\n'
BOLTS = 'kind = "bolts"\ncount = 3\nk = 1e8\nwidth_m = 0.01\n'


@pytest.fixture
def told(tmp_path):
    """The problems of a text, one a line."""
    cf.FrequencyTable.from_arrays(freq_hz=[370.0], sigma_hz=1.0, n=[8]).to_csv(tmp_path / "table.csv")
    file, write = WRITERS["Gmsh 2.2, text"]
    ends = {"root": (0, 0.0), "tip": (0, 1.0)}
    write(cf.imported.grid_mesh("hexahedron20", (2, 1, 1), lambda u: u, groups=ends), tmp_path / file)

    def problems(text, *command):
        path = written(tmp_path, text.replace("MESH", file))
        if command:
            done = CliRunner().invoke(main, [command[0], str(path), *command[1:]])
            assert done.exit_code == 2, done.output
            return done.stderr
        with pytest.raises(cf.errors.InputError) as caught:
            cf.load_study(path)
        error = caught.value
        assert str(error) == "\n".join(error.problems)
        assert list(error.codes) == [cf.errors.code_of(line) for line in error.problems]
        assert all(line.startswith(f"{path}: ") for line in error.problems)
        return str(error)

    return problems


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (THIN.replace("[material]", "[matter]"), r"(?s)material: found nothing.*matter: found an"),
        (CASING.replace('kind = "frustum"\n', ""), "chart.kind: found nothing, expected one of .*frustum"),
        (
            CASING + "[[imperfection]]\nsurvey = 's.csv'\n",
            'of: found nothing, expected "radius", "thickness", "modulus" or "density" ',
        ),
        (CASING.replace('"frustum"', '"cone"'), "chart.kind: found 'cone', expected one of .*frustum"),
        (CASING.replace("[material]", "material = 3\n[m]"), "material: found 3, expected a table"),
        (CASING.replace("thickness = 3.0e-3", "thickness = 0.0"), "thickness: found 0.0, expected greater than 0"),
        (CASING + "[cyclic]\nsectors = 4\n", r"cyclic: found \[cyclic\] and \[chart\]"),
        (CASING + UPDATE + PARAMETER, "found material.E again, expected each parameter once"),
        (CASING + UPDATE + "start = 4e11\n", r"found the start 4e\+11, expected it within \[1e\+11, 3e\+11\]"),
        (CASING + UPDATE.replace("table.csv", "none.csv"), "none.csv"),
        (CASING + UPDATE.partition("[[")[0], "update.parameter: found nothing"),
        (CASING + REDUCE + "axis = [0.0, 0.0, 1.0]\n", "reduce.axis: .*it is for imported meshes"),
        (CASING + REDUCE.replace("top", "rim"), "reduce.interface: found 'rim'"),
        (STEEL_PLATE.replace('kind = "clamped"\n', BOLTS), "bolts: found an edge without angles, 'root'"),
        (PANEL.replace('kind = "clamped"\n', BOLTS), "width_m: found an open edge, expected a closed casing"),
        (
            THIN + '[support.base]\nkind = "elastic"\nk_r = 1e8\naround = [{p = 4, cos = 0.1}, {p = 0, cos = 0.1}]\n',
            r"around: found harmonics \[4, 0\], expected each p >= 1 once",
        ),
        (CASING + WAVES.format(p=2), r"found harmonics \[2, 2\], expected each p once"),
        (SOLID + "[rotation]\nspeed_hz = 10.0\n", "rotation.axis: found nothing"),
        (SOLID + "[rotation]\nspeed_hz = 1.0\nhub_radius = 0.1\n", "rotation.hub_radius: found it on an imported mesh"),
        (SOLID.replace('kind = "clamped"', 'kind = "bolts"\ncount = 3\nk = 1.0'), "support.root.kind: found 'bolts'"),
        (SOLID.replace('"clamped"', '"elastic"\nk_r = 1.0'), "support.root: found k_r, expected k_face alone"),
        (SOLID + '[reduce]\nat = [1]\nmodes = 2\nnodes = 3\n', "reduce.nodes: found nodes and at"),
        (SOLID + REDUCE.replace("top", "tip") + "lines = [0.1]\n", "reduce.lines"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_by_its_key(told, text, words):
    found = told(text)
    assert re.search(words, found), found


@pytest.mark.parametrize(
    ("text", "command", "words"),
    [
        (CASING, ("update",), r"update: found nothing, expected a table \[update\]"),
        (CASING, ("reduce",), r"reduce: found nothing, expected a table \[reduce\]"),
        (PLATE + RIG + SCAN, ("rig",), "rig.scan: found an open chart, expected a closed casing"),
        (PLATE + RIG.replace("at = [0.1, 0.0]", "height = 0.1", 1) + TEST, ("rig",), r"drive.*found an open chart"),
        (PLATE + RIG + "count = 3\n" + TEST, ("rig",), "rig.sensor.*count: found 3, expected 1 on an open chart"),
        (SOLID, ("locate", "table.csv"), r"found an imported mesh, expected a shell on a \[chart\] for this command"),
        (CASING + UPDATE.replace("370", "1e9") + "[[update.parameter]]\n", ("update",), "update.parameter"),
    ],
)
def test_what_a_command_lacks_is_named_by_its_key(told, tmp_path, monkeypatch, text, command, words):
    monkeypatch.chdir(tmp_path)
    found = told(text, *command)
    assert re.search(words, found), found


def test_a_value_that_may_be_of_two_kinds_is_one_problem(told):
    lines = told(PLATE.replace("rows = 1, around = 1", 'rows = "two", around = 2.5')).splitlines()
    assert [line.partition(" (")[0].partition(": ")[2] for line in lines] == [
        "mesh.around: found 2.5, expected a whole number or a list",
        "mesh.rows: found 'two', expected a whole number or a list",
    ]
    assert told(PLATE.replace("around = 1", "around = [0.0, 0.4, 0.3, 1.0]")).count("must increase from 0 to 1") == 1


def test_a_file_that_is_no_study_has_its_code(tmp_path):
    (tmp_path / "binary.toml").write_bytes(b"[material]\nE = \xff\n")
    (tmp_path / "broken.toml").write_text("[material\n")
    for name in ("absent.toml", "binary.toml", "broken.toml", "."):
        with pytest.raises(cf.errors.InputError) as caught:
            cf.load_study(tmp_path / name)
        assert str(tmp_path) in str(caught.value)
    with pytest.raises(cf.errors.InputError, match=r"absent.toml: .*\[study-file\]"):
        cf.load_study(tmp_path / "absent.toml")


def test_a_shell_on_no_support_is_doubted_and_a_ring_of_rods_is_taken(tmp_path):
    with pytest.warns(cf.errors.ModelWarning, match=r"found no table \[support.EDGE\].*shell-free"):
        cf.load_study(written(tmp_path, THIN))
    ring = CASING + '[support.top]\nkind = "ring"\ndiameter = 0.02\n'
    ring += "[[stiffener]]\nat = 0.1\noffset = [0.01, 0.0]\ndiameter = 0.03\n"
    shell = cf.load_study(written(tmp_path, ring)).structure
    assert shell.supports["top"].section == cf.edge.Section.circle(diameter=0.02)
    assert [(one.at, one.offset, one.section) for one in shell.stiffeners] == [
        (0.1, (0.01, 0.0), cf.edge.Section.circle(diameter=0.03))
    ]


def test_an_imported_part_is_fixed_and_seen_as_its_tables_state(tmp_path):
    file, write = WRITERS["Gmsh 2.2, text"]
    ends = {"root": (0, 0.0), "tip": (0, 1.0)}
    write(cf.imported.grid_mesh("hexahedron20", (2, 1, 1), lambda u: u, groups=ends), tmp_path / file)
    text = SOLID.replace("MESH", file).replace('"clamped"', '"fixed"\ndirections = ["z", "x"]')
    text += '[support.tip]\nkind = "elastic"\nk_face = 2e9\n[reduce]\nat = [3, 1]\nmodes = 2\n'
    study = cf.load_study(written(tmp_path, text))
    assert study.structure.supports == {
        "root": cf.imported.Fixed(directions=("z", "x")),
        "tip": cf.ElasticEdge(k_face=2e9),
    }
    assert study.interface == cf.modal.AtNodes((3, 1))
