"""What is wrong with a study file, in words: key, what was found, what was expected, code."""

import errno
from pathlib import Path

import pytest

import casingfem as cf
from casingfem.study.load import validated
from casingfem.study.problems import Problems, StudyError, shown, table_of

GOOD = {
    "material": {"E": 210e9, "nu": 0.3, "rho": 7800.0},
    "chart": {"kind": "cylinder", "radius": 0.5, "height": 0.2},
    "shell": {"thickness": 3e-3},
}
PARAMETER = {"name": "material.E", "lower": 1.0, "upper": 2.0}
PLACE = {"interface": "top"}
LINES = {"kind": "exact", "band_hz": [1.0, 2.0], "resolution_hz": 0.5}


def said(**tables):
    """The problems of a file with some tables in place of the good ones, without its name."""
    problems = Problems(Path("s.toml"))
    validated({key: table for key, table in (GOOD | tables).items() if table is not None}, problems)
    assert all(problem.startswith("s.toml: ") for problem in problems)
    return [problem.removeprefix("s.toml: ") for problem in problems]


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"material": GOOD["material"] | {"E": -1.0}},
         "material.E: found -1.0, expected greater than 0 (Young's modulus [Pa]) [material-modulus]"),
        ({"material": GOOD["material"] | {"nu": 0.5}},
         "material.nu: found 0.5, expected less than 0.5 (Poisson's ratio [-]) [material-poisson]"),
        ({"material": GOOD["material"] | {"rho": "heavy"}},
         "material.rho: found 'heavy', expected a number (density [kg/m^3]) [material-density]"),
        ({"material": GOOD["material"] | {"rho": 1e-26}},
         "material.rho: found 1e-26, expected at least 1e-25 [material-density]"),
        ({"material": 3}, "material: found 3, expected a table of keys (E, nu, rho) [study-value]"),
        ({"support": 3}, "support: found 3, expected a table of keys (edge or group -> kind and stiffnesses) "
                         "[study-value]"),
        ({"chart": {"radius": 0.5}}, "chart.kind: found nothing, expected one of frustum, cylinder, panel, plate, "
                                     "twisted-plate, dome, meridian, points, blade [study-value]"),
        ({"chart": {"kind": "cone"}}, "chart.kind: found 'cone', expected one of frustum, cylinder, panel, plate, "
                                      "twisted-plate, dome, meridian, points, blade [study-value]"),
        ({"chart": GOOD["chart"] | {"height": 0.0}},
         "chart.height: found 0.0, expected greater than 0 (length along the axis [m]) [chart-dimension]"),
        ({"chart": {"kind": "cylinder", "radius": 0.5}},
         "chart.height: found nothing, expected its length along the axis [m] [study-missing]"),
        ({"shell": {"thickness": True}},
         "shell.thickness: found true, expected a number (nominal wall thickness [m]) [shell-thickness]"),
        ({"shell": {"thickness": 3e-3, "thick": 1}}, "shell.thick: found an unknown key, expected one of "),
        ({"strip": [{"from": 0.0, "to": 0.1, "thickness": 0.0}]},
         "strip[1].thickness: found 0.0, expected greater than 0 (its wall thickness [m]) [shell-thickness]"),
        ({"mesh": {"order": 2.5}}, "mesh.order: found 2.5, expected a whole number (polynomial order) [mesh-order]"),
        ({"mesh": {"around": 0}}, "mesh.around: found 0, expected greater than or equal to 1 (elements around) "
                                  "[mesh-around]"),
        ({"modes": {"count": "all"}}, "modes.count: found 'all', expected a whole number (number of modes) "
                                      "[modes-count]"),
        ({"modes": {"elastic_only": 1}},
         "modes.elastic_only: found 1, expected true or false (rigid modes are an error) [study-value]"),
        ({"modes": {"band_hz": [2.0, 1.0]}},
         "modes: found band_hz = [2.0, 1.0], expected two frequencies in order [study-value]"),
        ({"imperfection": [{"of": "radius", "harmonics": [{"p": -1}]}]},
         "imperfection[1].harmonics[1].p: found -1, expected greater than or equal to 0 (number of waves around) "
         "[field-harmonics]"),
        ({"imperfection": [{"of": "radius", "harmonics": [{"p": 1, "sin": 2.0}]}]}, "[field-range]"),
        ({"support": {"base": {"kind": "elastic", "k_rot": -1.0}}},
         "support.base.k_rot: found -1.0, expected greater than or equal to 0 (rotational springs [N m/rad per m]) "
         "[support-springs]"),
        ({"update": {"table": 3, "parameter": [PARAMETER]}},
         "update.table: found 3, expected text in quotes (frequency table CSV, relative to this file) [study-value]"),
        ({"update": {"table": "a", "parameter": []}},
         "update.parameter: found [], expected at least one [[update.parameter]] [study-missing]"),
        ({"reduce": PLACE | {"out": "a/b.npz"}},
         "reduce.out: found 'a/b.npz', expected a file name ending in .npz [study-value]"),
        ({"rig": {"seed": 1, "zeta": 0.1, "drive": [{"height": 0.1}], "test": LINES | {"kind": "loud"}}},
         "rig.test.kind: found 'loud', expected 'exact', 'random', 'burst-random' or 'impact' (exact, or by which "
         "force) [study-value]"),
    ],
)  # fmt: skip
def test_a_value_that_is_refused_is_told_with_its_key_meaning_and_code(tables, words):
    (problem,) = said(**tables)
    assert words in problem if words.startswith("[") else problem.startswith(words), problem


@pytest.mark.parametrize("name", ["material", "chart", "shell"])
def test_a_table_that_is_missing_is_named(name):
    (problem,) = said(**{name: None})
    assert problem.startswith(f"{name}: found nothing, expected a table [{name}]: ")
    assert problem.endswith("[study-missing]")


@pytest.mark.parametrize(
    ("tables", "missing"),
    [
        ({"chart": None, "shell": None, "solid": {"mesh": "a.inp"}}, []),
        ({"chart": None, "shell": {"thickness": 1e-3, "mesh": "a.inp"}}, []),
        ({"chart": None, "shell": None, "solid": {"mesh": "a.inp"}, "material": None}, ["material"]),
    ],
)
def test_a_mesh_needs_no_chart(tables, missing):
    assert [problem.partition(":")[0] for problem in said(**tables)] == missing


def test_tables_in_order_are_read_beside_those_that_are_not():
    problems = Problems(Path("s.toml"))
    tables = validated(GOOD | {"shell": {"thickness": -1.0}, "modes": {"count": 7}}, problems)
    assert (tables.shell, tables.modes.count, tables.chart.radius) == (None, 7, 0.5)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (True, "true"),
        (False, "false"),
        (1.0, "1.0"),
        ("x" * 58, "'" + "x" * 58 + "'"),
        ("x" * 59, "'" + "x" * 56 + "..."),
    ],
)
def test_a_long_value_is_cut_to_sixty_characters(value, text):
    assert shown(value) == text
    assert len(text) <= 60


def test_errors_of_the_input_become_problems_and_others_pass():
    problems = Problems(Path("s.toml"))
    with problems.at("update.table"):
        raise FileNotFoundError(errno.ENOENT, "found no such file, expected one", "a.csv")
    with problems.at("rig"):
        raise ValueError("rig: one\nrig two\nthree")
    with problems.at("imperfection[1].survey"):
        raise ValueError("a point at the axis")
    assert problems == [
        "s.toml: update.table: a.csv: found no such file, expected one [study-file]",
        "s.toml: rig: one [study-value]",
        "s.toml: rig: two [study-value]",
        "s.toml: rig: three [study-value]",
        "s.toml: imperfection[1].survey: a point at the axis [survey-table]",
    ]
    with pytest.raises(KeyError), problems.at("rig"):
        raise KeyError("a mistake in the program")
    assert len(problems) == 5


@pytest.mark.parametrize(
    ("code", "key", "named"),
    [
        ("shell-thickness", "support", "shell"),
        ("material-poisson", "support", "material"),
        ("chart-dimension", "imperfection", "chart"),
        ("mesh-order", "shell", "mesh"),
        ("mesh-order", "mesh.rows", "mesh.rows"),
        ("shell-thickness", "shell.plies", "shell.plies"),
        ("strip-extent", "strip[1]", "strip[1]"),
        ("mesh-no-group", "solid", "solid"),
        ("mesh-group", "solid", "solid"),
        ("mesh-support", "shell", "shell"),
        ("", "rig", "rig"),
    ],
)
def test_an_error_of_another_table_is_told_of_that(code, key, named):
    error = ValueError("wrong")
    if code:
        error.code = code
    assert table_of(error, key) == named


def test_a_study_error_has_the_code_of_each_line():
    error = StudyError(["a [study-value]", "b", "c [mesh-order]"])
    assert (error.problems, error.codes) == (
        ("a [study-value]", "b", "c [mesh-order]"),
        ("study-value", "", "mesh-order"),
    )
    assert str(error) == "a [study-value]\nb\nc [mesh-order]"


def test_a_model_error_keeps_its_code_in_a_study():
    problems = Problems(Path("s.toml"))
    with problems.at("support"):
        raise cf.errors.ModelError("shell-thickness", "shell.thickness must be above 0, found -3.0")
    (problem,) = problems
    assert problem.startswith("s.toml: shell: shell.thickness must be above 0, found -3.0: ")
    assert problem.endswith("[shell-thickness]")
