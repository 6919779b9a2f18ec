"""From the tables of a study to what is computed: interfaces, start values, hashes, what holds a mesh."""

import hashlib
from importlib.metadata import version
from pathlib import Path

import pytest

import casingfem as cf
from casingfem.linalg.krylov import START_SEED
from casingfem.study.cyclic import read_deviations
from casingfem.study.imported import build_supports, is_imported, mesh_interface
from casingfem.study.load import load_interface, load_update, source, tables_of, with_start_value
from casingfem.study.problems import Problems
from casingfem.study.tables.tasks import ParameterTable, ReduceTable, StudyFile
from tests.casingfem.study.study_texts import named

FRUSTUM = cf.Frustum(r_base=0.5, r_top=0.4, height=0.25)
PLATE = cf.Plate(length=0.3, width=0.1)
SHELL = cf.Shell(chart=FRUSTUM, thickness=3e-3, material=cf.Material(E=210e9, nu=0.3, rho=7800.0))


@pytest.fixture
def problems():
    return Problems(Path("s.toml"))


@pytest.mark.parametrize(
    ("keys", "chart", "interface"),
    [
        ({"interface": "top"}, FRUSTUM, cf.Rim("top", 40)),
        ({"interface": "base", "n_max": 3, "axial": True, "lines": [0.1, 0.2]}, FRUSTUM,
         cf.Rim("base", 3, axial=True, lines=(0.1, 0.2))),
        ({"interface": "tip"}, PLATE, cf.Tip("tip")),
        ({"interface": "tip", "nodes": 4}, PLATE, cf.TipNodes("tip", 4)),
    ],
)  # fmt: skip
def test_the_interface_of_a_chart(problems, keys, chart, interface):
    assert load_interface(ReduceTable(**keys), chart, problems) == interface
    assert problems == []


@pytest.mark.parametrize(
    ("keys", "chart", "words"),
    [
        ({"at": [1]}, FRUSTUM, ["reduce.at: found [1], expected no such key: it is for imported meshes [study-key]"]),
        ({"interface": "top", "axis": "z", "point": [0.0, 0.0, 0.0]}, FRUSTUM,
         ["reduce.axis: found z, expected no such key: it is for imported meshes [study-key]",
          "reduce.point: found [0.0, 0.0, 0.0], expected no such key: it is for imported meshes [study-key]"]),
        ({"interface": "tip"}, FRUSTUM,
         ["reduce.interface: found 'tip', expected one of the chart's edges base, top [interface-edge]"]),
        ({"interface": "left"}, PLATE,
         ["reduce.interface: found 'left', expected one of the chart's edges root, tip [interface-edge]"]),
        ({"interface": "top", "nodes": 2}, FRUSTUM,
         ["reduce.nodes: found 2, expected no such key: a casing's rim has no pieces [study-key]"]),
        ({"interface": "tip", "n_max": 3, "axial": True, "lines": [0.1]}, PLATE,
         ["reduce.n_max: found 3, expected no such key: an open chart has no harmonics around [study-key]",
          "reduce.axial: found True, expected no such key: an open chart has no harmonics around [study-key]",
          "reduce.lines: found [0.1], expected no such key: an open chart has no harmonics around [study-key]"]),
    ],
)  # fmt: skip
def test_keys_that_an_interface_of_a_chart_has_not(problems, keys, chart, words):
    load_interface(ReduceTable(**keys), chart, problems)
    assert named(problems) == words


def test_there_is_no_interface_without_a_table_or_a_chart(problems):
    assert load_interface(None, FRUSTUM, problems) is None
    assert load_interface(ReduceTable(interface="tip"), None, problems) is None
    assert mesh_interface(None, None, problems) is None
    assert problems == []


@pytest.mark.parametrize(
    ("keys", "interface", "words"),
    [
        ({"at": [3, 1]}, cf.modal.AtNodes((3, 1)), []),
        ({"interface": "rim"}, cf.Tip("rim"), []),
        ({"interface": "rim", "nodes": 3}, cf.TipNodes("rim", 3), []),
        ({"interface": "rim", "axial": True}, cf.Rim("rim", 40, axial=True), []),
        ({"interface": "rim", "n_max": 5, "axis": "x", "point": [1.0, 2.0, 3.0]},
         cf.Rim("rim", 5, axis=(1.0, 0.0, 0.0), point=(1.0, 2.0, 3.0)), []),
        ({"at": [3], "nodes": 2, "axial": False}, cf.modal.AtNodes((3,)),
         ["reduce.axial: found False, expected no such key here [study-key]",
          "reduce.nodes: found it beside at, expected the nodes alone [study-key]",
          "reduce.axial: found it beside at, expected the nodes alone [study-key]"]),
        ({"interface": "rim", "lines": []}, cf.Tip("rim"),
         ["reduce.lines: found [], expected no such key here [study-key]"]),
    ],
)  # fmt: skip
def test_the_interface_of_a_mesh(problems, keys, interface, words):
    assert mesh_interface(ReduceTable(**keys), None, problems) == interface
    assert named(problems) == words


@pytest.mark.parametrize(
    ("data", "imported"),
    [
        ({"solid": {}}, True),
        ({"shell": {"mesh": "a"}}, True),
        ({"shell": {"thickness": 1.0}}, False),
        ({"shell": "mesh"}, False),
        ({}, False),
    ],
)
def test_a_study_is_of_a_mesh_where_it_names_one(data, imported):
    assert is_imported(data) is imported


def test_a_mesh_is_held_by_groups(problems):
    tables = {
        "a": {"kind": "fixed", "directions": ["z", "x"]}, "b": {"kind": "elastic", "k_face": 2.0},
        "c": {"kind": "clamped"}, "d": {"kind": "symmetry"}, "e": {"kind": "elastic", "k_z": 1.0, "k_face": 1.0},
        "f": {"kind": "fixed", "directions": ["x", "x"]}, "g": {"kind": "clamped"},
    }  # fmt: skip
    held = build_supports(StudyFile.model_validate({"support": tables}).support, problems)
    assert held == {
        "a": cf.imported.Fixed(directions=("z", "x")),
        "b": cf.ElasticEdge(k_face=2.0),
        "c": cf.Clamped(),
        "g": cf.Clamped(),
    }
    assert [problem.partition(" [")[0] for problem in named(problems)][:2] == [
        "support.d.kind: found 'symmetry', expected clamped, fixed or elastic on an imported mesh",
        "support.e: found k_z, expected k_face alone on a mesh",
    ]
    assert named(problems)[2].startswith("support.f: ")


@pytest.mark.parametrize(
    ("start", "lower", "upper", "E"),
    [
        (None, 210e9, 220e9, 210e9),
        (None, 200e9, 210e9, 210e9),
        (205e9, 205e9, 206e9, 205e9),
        (206e9, 205e9, 206e9, 206e9),
    ],
)
def test_a_start_lies_within_its_bounds_or_on_them(start, lower, upper, E):
    entry = ParameterTable(name="material.E", lower=lower, upper=upper, start=start)
    assert with_start_value(SHELL, entry).material.E == E


@pytest.mark.parametrize(
    ("start", "words"),
    [
        (None, r"material.E: found the start 2.1e\+11, expected it within \[2.2e\+11, 2.3e\+11\]"),
        (2.31e11, r"material.E: found the start 2.31e\+11"),
        (2.19e11, r"material.E: found the start 2.19e\+11"),
    ],
)
def test_a_start_beyond_its_bounds_is_refused(start, words):
    with pytest.raises(ValueError, match=words):
        with_start_value(SHELL, ParameterTable(name="material.E", lower=2.2e11, upper=2.3e11, start=start))


def updating(*names, **more):
    entries = [{"name": name, "lower": 1e-3, "upper": 1e12} for name in names]
    return StudyFile.model_validate({"update": {"table": "none.csv", "parameter": entries}, **more})


def test_what_an_update_lacks_is_said_of_each_part(problems):
    tables = updating("material.E", "material.E", "material.nu", rotation={"speed_hz": 1.0})
    table, parameters, start = load_update(tables, SHELL, problems)
    assert (table, start.material.E) == (None, 210e9)
    assert [p.name for p in parameters] == ["material.E", "material.nu"]
    assert [problem.partition(" [")[0].partition(",")[0] for problem in named(problems)] == [
        "update: found an update beside",
        "update.table: none.csv: found no such file",
        "update.parameter[2]: name: found material.E again",
    ]


def test_without_an_update_the_study_is_where_it_begins(problems):
    assert load_update(StudyFile(), SHELL, problems) == (None, (), SHELL)
    assert load_update(updating("material.E"), None, problems)[2] is None


def test_the_source_is_the_hash_of_every_file_that_is_named(tmp_path):
    names = ["survey.csv", "table.csv", "shapes.uff", "blades.csv", "solid.inp", "shell.inp"]
    for name in names:
        (tmp_path / name).write_text(f"* {name}\n")
    tables = StudyFile.model_validate({
        "imperfection": [{"of": "radius", "survey": "survey.csv"}, {"of": "radius", "harmonics": []}],
        "update": {"table": "table.csv", "shapes": "shapes.uff",
                   "parameter": [{"name": "material.E", "lower": 1.0, "upper": 2.0}]},
        "cyclic": {"sectors": 3, "mistuning": "blades.csv"},
        "solid": {"mesh": "solid.inp"}, "shell": {"thickness": 1e-3, "mesh": "shell.inp"},
    })  # fmt: skip
    found = source(tmp_path / "study.toml", b"text", tables)
    whole = b"\0".join([b"text", *((tmp_path / name).read_bytes() for name in names)])
    assert found["sha256"] == hashlib.sha256(whole).hexdigest()
    assert (found["study"], found["seed"]) == ("study.toml", START_SEED)
    assert found["versions"] == {name: version(name) for name in ("casingfem", "numpy", "scipy", "scikit-fem")}
    bare = StudyFile.model_validate({"cyclic": {"sectors": 3, "mistuning": [0.1, 0.2, 0.3]}})
    assert source(tmp_path / "a.toml", b"text", bare)["sha256"] == hashlib.sha256(b"text").hexdigest()


@pytest.mark.parametrize(
    ("content", "code"), [(None, "study-file"), (b"a = = 1", "study-toml"), (b"a = 1\nb = '\xff'", "study-file")]
)
def test_a_file_that_is_no_study_has_its_code(tmp_path, content, code):
    file = tmp_path / "study.toml"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(cf.errors.InputError) as caught:
        tables_of(file)
    assert (caught.value.codes, str(caught.value).startswith(f"{file}: ")) == ((code,), True)


def test_deviations_of_blades_come_in_the_order_of_their_numbers(tmp_path):
    file = tmp_path / "blades.csv"
    file.write_text("deviation,blade\n0.3,3\n-0.1,1\n0.2,2\n")
    assert read_deviations(file).tolist() == [-0.1, 0.2, 0.3]
    for rows, words in (
        ("0.1,0\n0.2,1\n", r"blades 0, 1, ...; expected each of 1 to 2 once"),
        ("0.1,1\n0.2,3\n", r"blades 1, 3, ...; expected each of 1 to 2 once"),
        ("".join(f"0.1,{k}\n" for k in (9, 8, 7, 6, 5, 4)), r"blades 4, 5, 6, 7, 8, ...; expected each of 1 to 6 once"),
    ):
        file.write_text(f"deviation,blade\n{rows}")
        with pytest.raises(ValueError, match=words):
            read_deviations(file)
