"""From tables to a shell, part by part: every key goes to its place, and what is wrong is named with its key."""

import warnings
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf
from casingfem.study.build import build_chart, build_field, build_mesh, build_random, build_shell
from casingfem.study.problems import Problems
from casingfem.study.tables.fields import ImperfectionTable
from casingfem.study.tables.shapes import BladeTable, DomeTable, MeshTable
from casingfem.study.tables.tasks import StudyFile

HERE = Path()
STEEL = {"E": 210e9, "nu": 0.3, "rho": 7800.0}
ALUMINIUM = {"E": 70e9, "nu": 0.33, "rho": 2700.0}
CASING = {
    "material": STEEL,
    "chart": {"kind": "frustum", "r_base": 0.5, "r_top": 0.4, "height": 0.25},
    "shell": {"thickness": 3e-3},
    "support": {"base": {"kind": "clamped"}},
    "mesh": {"order": 4, "rows": 1, "around": 9},
}
PLATE = CASING | {
    "chart": {"kind": "plate", "length": 0.2, "width": 0.04},
    "support": {"root": {"kind": "clamped"}},
    "mesh": {"order": 4, "rows": 1, "around": 1},
}


def built(tables):
    """The shell of some tables and what was wrong, without the file's name."""
    problems = Problems(Path("s.toml"))
    shell = build_shell(StudyFile.model_validate(tables), problems)
    return shell, [problem.removeprefix("s.toml: ") for problem in problems]


@pytest.mark.parametrize(
    ("more", "start"),
    [
        ({"cyclic": {"sectors": 3}}, "cyclic: found it beside [chart], expected an imported mesh: the sector"),
        ({"strip": [{"from": 0.2, "to": 0.3, "thickness": 1e-3}]}, "strip: strip[1] from 0.2 to 0.3 m leaves"),
        ({"stiffener": [{"at": 0.3, "offset": [0.0, 0.0], "diameter": 0.01}]}, "stiffener: stiffener[1].at: found 0.3"),
        ({"support": {"bottom": {"kind": "clamped"}}},
         "support.bottom: found edge 'bottom', expected one of the chart's edges base, top"),
        ({"support": {"base": {"kind": "ring", "width": 0.1, "depth": 0.1, "material": STEEL, "support":
          {"kind": "bolts", "count": 2, "k": 1.0, "loose": [{"bolt": 3, "factor": 0.0}]}}}},
         "support.base: loose bolt 3"),
        ({"mass": [{"edge": "top", "angle_deg": 0.0, "mass": 0.1}, {"edge": "tip", "angle_deg": 0.0, "mass": 0.1}]},
         "mass[2].edge: found 'tip', expected one of the chart's edges base, top"),
        ({"rotation": {"speed_hz": 1.0, "axis": [0.0, 0.0, 0.0]}}, "rotation: found axis"),
        ({"imperfection": [{"of": "radius", "harmonics": [{"p": 3}, {"p": 3}]}]},
         "imperfection[1].harmonics: found harmonics [3, 3], expected each p once"),
        ({"imperfection": [{"of": "thickness", "random": [{"p": 3, "median": 0.1}] * 2, "seed": 1}]},
         "imperfection[1].random: found harmonics [3, 3], expected each p once"),
        ({"imperfection": [{"of": "radius", "survey": "none.csv"}] * 2},
         "imperfection: found 2 surveys of the radius, expected one: what both measured would count twice"),
        ({"mesh": {"rows": [0.0, 0.5]}}, "mesh: mesh.rows must increase from 0 to 1"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_part_leaves_no_shell(more, start):
    shell, problems = built(CASING | more)
    assert shell is None
    assert problems[0].startswith(start), problems


@pytest.mark.parametrize("missing", ["material", "chart", "shell"])
def test_without_one_of_its_tables_there_is_no_shell(missing):
    assert built({name: table for name, table in CASING.items() if name != missing}) == (None, [])


def test_surveys_of_two_quantities_are_not_two_of_one():
    surveys = [{"of": of, "survey": "none.csv"} for of in ("radius", "thickness")]
    _, problems = built(CASING | {"imperfection": surveys})
    assert [problem.partition(":")[0] for problem in problems] == ["imperfection[1].survey", "imperfection[2].survey"]


def test_a_wall_that_turns_inside_out_is_the_fault_of_its_fields():
    shell, problems = built(CASING | {"imperfection": [{"of": "radius", "harmonics": [{"p": 0, "cos": -1.0}]}]})
    assert shell is None
    assert problems[0].startswith("imperfection: ")


def test_what_stands_in_the_tables_stands_in_the_shell():
    more = {
        "shell": {"thickness": 4e-3, "wall": "linear"},
        "taper": {"along": [1.0, 0.5], "across": 1.0},
        "stiffener": [{"at": 0.1, "offset": [0.01, -0.02], "diameter": 0.006, "material": ALUMINIUM},
                      {"at": 0.2, "offset": [0.03, 0.0], "width": 0.01, "depth": 0.02}],
        "mass": [{"edge": "top", "angle_deg": 90.0, "mass": 0.1}, {"edge": "base", "angle_deg": -45.0, "mass": 0.2},
                 {"edge": "top", "angle_deg": 180.0, "mass": 0.3}],
        "rotation": {"speed_hz": 3.0},
        "mesh": {"order": 3, "rows": [0.0, 0.4, 0.8, 1.0], "around": 9},
        "imperfection": [{"of": "radius", "harmonics": [{"p": 2, "cos": 0.01, "sin": -0.02}]}],
    }  # fmt: skip
    shell, problems = built(CASING | more)
    assert problems == []
    assert (shell.thickness, shell.wall, shell.taper.along) == (4e-3, "linear", (1.0, 0.5))
    first, second = shell.stiffeners
    aluminium = cf.Material(**ALUMINIUM)
    assert first == cf.edge.Stiffener(
        at=0.1, offset=(0.01, -0.02), section=cf.edge.Section.circle(diameter=0.006), material=aluminium
    )
    assert second == cf.edge.Stiffener(
        at=0.2, offset=(0.03, 0.0), section=cf.edge.Section.rectangle(width=0.01, depth=0.02)
    )
    masses = {edge: [(round(m.angle, 12), m.mass) for m in held] for edge, held in shell.masses.items()}
    quarter, half = round(0.5 * np.pi, 12), round(np.pi, 12)
    assert masses == {"top": [(quarter, 0.1), (half, 0.3)], "base": [(round(-0.25 * np.pi, 12), 0.2)]}
    assert shell.rotation.omega == pytest.approx(6.0 * np.pi, rel=1e-15)
    assert shell.radius_defect.coefficients(2) == (0.01, -0.02)


@pytest.mark.parametrize(("support", "said"), [({}, ["s.toml: no [support.EDGE]"]), (CASING["support"], [])])
def test_a_shell_on_no_support_is_doubted(support, said):
    with warnings.catch_warnings(record=True) as doubts:
        warnings.simplefilter("always")
        shell, problems = built(CASING | {"support": support})
    assert (len(shell.supports), problems) == (len(support), [])
    found = [str(doubt.message) for doubt in doubts if "[shell-free]" in str(doubt.message)]
    assert [text.partition("]")[0] + "]" for text in found] == said


def test_a_dome_and_a_blade_have_radians():
    dome = build_chart(DomeTable(kind="dome", radius=0.2, start_deg=-30.0, end_deg=90.0, r0=0.05), HERE).profile
    assert isinstance(dome, cf.geometry.Arc)
    assert (dome.radius, dome.r0) == (0.2, 0.05)
    assert (dome.start, dome.end) == pytest.approx((-np.pi / 6, np.pi / 2), rel=1e-15)
    blade = build_chart(BladeTable(kind="blade", length=0.2, chord=[0.1, 0.08], camber_deg=30.0, sweep=0.01,
                                   twist_deg=[0.0, 45.0], lean=[0.0, 0.02]), HERE)  # fmt: skip
    assert isinstance(blade, cf.Blade)
    assert (blade.length, blade.chord, blade.sweep, blade.lean) == (0.2, (0.1, 0.08), 0.01, (0.0, 0.02))
    assert blade.camber == pytest.approx(np.pi / 6, rel=1e-15)
    assert blade.twist == pytest.approx((0.0, np.pi / 4), rel=1e-15)


def test_only_pieces_of_a_meridian_have_walls_of_their_own():
    dome = {"kind": "dome", "radius": 0.2, "start_deg": 0.0, "end_deg": 60.0}
    shell, problems = built(CASING | {"chart": dome})
    assert (shell.strips, problems) == ((), [])
    pieces = [{"to": [0.3, 0.1], "thickness": 4e-3}, {"to": [0.3, 0.2]}]
    meridian = {"kind": "meridian", "start": [0.3, 0.0], "piece": pieces}
    shell, problems = built(CASING | {"chart": meridian, "mesh": {"order": 3, "around": 9}})
    assert [(strip.start, strip.end, strip.thickness) for strip in shell.strips] == [(0.0, 0.1, 4e-3)]
    assert built({key: table for key, table in CASING.items() if key != "shell"} | {"chart": meridian}) == (None, [])


@pytest.mark.parametrize(
    ("given", "made"),
    [
        ({}, (5, 3, 7)),
        ({"order": 2}, (2, 3, 7)),
        ({"rows": 1}, (5, 1, 7)),
        ({"rows": [0.0, 0.25, 1.0]}, (5, (0.0, 0.25, 1.0), 7)),
        ({"around": 1}, (5, 3, 1)),
    ],
)
def test_a_mesh_keeps_what_the_study_leaves_out(given, made):
    mesh = build_mesh(MeshTable(**given), cf.ShellMesh(order=5, rows=3, around=7))
    assert (mesh.order, mesh.rows, mesh.around) == made


WAVES = [{"p": 2, "median": 0.1, "high": 0.5}, {"p": 4, "median": 0.02}]


def test_a_random_field_has_the_spectrum_seed_and_stream_of_its_table():
    table = ImperfectionTable(of="thickness", random=WAVES, seed=7, scale=0.5, p_max=4)
    field = build_random(table, 3, StudyFile(), HERE)
    assert (field.seed, field.stream, field.spectrum.p.tolist()) == (7, 3, [2, 3, 4])
    np.testing.assert_allclose(field.spectrum.median[[0, 2]], [0.05, 0.01], rtol=1e-14)
    # 90 % of Rayleigh amplitudes are below sqrt(ln 10/ln 2) medians
    np.testing.assert_allclose(field.spectrum.high[[0, 2]], [0.25, 0.01 * np.sqrt(np.log2(10.0))], rtol=1e-12)
    plain = build_random(ImperfectionTable(of="thickness", random=WAVES, seed=0), 1, StudyFile(), HERE)
    np.testing.assert_allclose(plain.spectrum.median[[0, 2]], [0.1, 0.02], rtol=1e-14)


def test_the_example_of_a_random_field_wants_chart_and_wall():
    table = ImperfectionTable(of="radius", random="example", seed=7)
    tables = StudyFile.model_validate(CASING)
    field = build_random(table, 2, tables, HERE)
    assert (field.spectrum.p[0], field.spectrum.p[-1], field.seed, field.stream) == (2, 32, 7, 2)
    assert field.spectrum.median[0] == pytest.approx(0.24 * 3e-3 / 0.45, rel=1e-12)
    assert build_random(table.model_copy(update={"p_max": 9}), 2, tables, HERE).spectrum.p[-1] == 9
    for name in ("chart", "shell"):
        assert build_random(table, 2, tables.model_copy(update={name: None}), HERE) is None


def test_the_stream_of_a_random_field_is_its_number_in_the_file():
    table = ImperfectionTable(of="thickness", random=WAVES, seed=7)
    problems = Problems(Path("s.toml"))
    field = build_field(table, "imperfection[12]", StudyFile.model_validate(CASING), problems)
    assert (field.stream, list(problems)) == (12, [])


@pytest.mark.parametrize(
    "chart",
    [
        {"kind": "plate", "length": 0.2, "width": 0.04},
        {"kind": "twisted-plate", "length": 0.2, "width": 0.04, "twist_deg": 10.0},
        {"kind": "blade", "length": 0.2, "chord": 0.04},
    ],
)
def test_a_plate_has_no_radius_but_a_thickness(chart):
    tables = StudyFile.model_validate(PLATE | {"chart": chart})
    problems = Problems(Path("s.toml"))
    wave = [{"p": 1, "cos": 0.1}]
    assert build_field(ImperfectionTable(of="radius", harmonics=wave), "imperfection[1]", tables, problems) is None
    assert problems == ["s.toml: imperfection[1].of: found 'radius' on a plate, which has none, expected thickness, or "
                        "a chart with a radius [field-no-radius]"]  # fmt: skip
    problems.clear()
    wall = build_field(ImperfectionTable(of="thickness", harmonics=wave), "imperfection[1]", tables, problems)
    assert (wall.coefficients(1), list(problems)) == ((0.1, 0.0), [])
