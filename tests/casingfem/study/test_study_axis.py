"""[rotation] of a study: where the axis of a casing, of a blade on its hub and of an imported part lies."""

from pathlib import Path

import numpy as np
import pytest

import casingfem as cf
from casingfem.study.cyclic import axis_vector, build_mesh_rotation, build_rotation, vector
from casingfem.study.problems import Problems
from casingfem.study.tables.shapes import RotationTable
from tests.casingfem.study.study_texts import named

FRUSTUM = cf.Frustum(r_base=0.5, r_top=0.4, height=0.25)
PLATE = cf.Plate(length=0.3, width=0.1)


@pytest.fixture
def problems():
    return Problems(Path("s.toml"))


@pytest.mark.parametrize(
    ("keys", "axis", "centre"),
    [
        ({}, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)),
        ({"axis": "x"}, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        ({"axis": "y", "centre": [1.0, 2.0, 3.0]}, (0.0, 1.0, 0.0), (1.0, 2.0, 3.0)),
        ({"axis": "z", "point": [4.0, 5.0, 6.0]}, (0.0, 0.0, 1.0), (4.0, 5.0, 6.0)),
        ({"axis": [1.0, 2.0, 3.0]}, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0)),
    ],
)
def test_a_part_turns_about_the_axis_of_its_table(problems, keys, axis, centre):
    made = [build_rotation(RotationTable(speed_hz=3.0, **keys), FRUSTUM, problems)]
    if keys:
        made.append(build_mesh_rotation(RotationTable(speed_hz=3.0, **keys), problems))
    assert problems == []
    for rotation in made:
        assert (rotation.axis, rotation.centre) == (axis, centre)
        assert rotation.omega == pytest.approx(18.84955592153876, rel=1e-15)


@pytest.mark.parametrize(
    ("keys", "axis", "centre"),
    [
        ({"hub_radius": 0.2}, (0.0, 1.0, 0.0), (-0.2, 0.0, 0.0)),
        ({"hub_radius": 0.0}, (0.0, 1.0, 0.0), (0.0, 0.0, 0.0)),
        ({"stagger_deg": 30.0}, (0.0, np.sqrt(0.75), 0.5), (0.0, 0.0, 0.0)),
    ],
)
def test_a_blade_turns_on_its_hub(problems, keys, axis, centre):
    rotation = build_rotation(RotationTable(speed_hz=3.0, **keys), PLATE, problems)
    assert rotation.axis == pytest.approx(axis, abs=1e-15)
    assert rotation.centre == pytest.approx(centre, abs=1e-15)


BESIDE = "rotation: found hub_radius or stagger_deg beside axis, centre or point, expected one way to place the axis"


@pytest.mark.parametrize(
    ("keys", "chart", "words"),
    [
        ({"hub_radius": 0.0, "axis": "y"}, PLATE, BESIDE),
        ({"hub_radius": 0.2, "point": [0.0, 0.0, 0.0]}, PLATE, BESIDE),
        ({"stagger_deg": 1.0, "centre": [0.0, 0.0, 0.0]}, PLATE, BESIDE),
        ({}, PLATE, "rotation: found neither hub_radius nor axis on an open chart, expected hub_radius, or axis and"),
        ({"hub_radius": 0.2}, FRUSTUM, "rotation: found a hub radius or a stagger on a closed casing"),
    ],
)
def test_an_axis_is_placed_in_one_way(problems, keys, chart, words):
    assert build_rotation(RotationTable(speed_hz=3.0, **keys), chart, problems) is None
    (problem,) = named(problems)
    assert problem.startswith(words)


def test_nothing_turns_without_a_table_or_a_chart(problems):
    assert build_rotation(None, FRUSTUM, problems) is None
    assert build_rotation(RotationTable(speed_hz=3.0), None, problems) is None
    assert build_mesh_rotation(None, problems) is None
    assert problems == []


def test_a_mesh_has_no_hub_and_must_name_its_axis(problems):
    table = RotationTable(speed_hz=3.0, hub_radius=0.2, stagger_deg=0.0)
    assert build_mesh_rotation(table, problems) is None
    assert [problem.partition(",")[0] for problem in named(problems)] == [
        "rotation.hub_radius: found it on an imported mesh",
        "rotation.stagger_deg: found it on an imported mesh",
        "rotation.axis: found nothing",
    ]
    problems.clear()
    assert build_mesh_rotation(RotationTable(speed_hz=3.0, axis=[0.0, 0.0, 0.0]), problems) is None
    assert named(problems)[0].startswith("rotation: found axis (0.0, 0.0, 0.0)")


def test_axes_and_points_that_are_left_out_are_z_and_the_origin():
    assert (axis_vector(None), axis_vector("y"), axis_vector([3.0, 2.0, 1.0])) == (
        (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (3.0, 2.0, 1.0)
    )  # fmt: skip
    assert (vector(None), vector([3.0, 2.0, 1.0])) == ((0.0, 0.0, 0.0), (3.0, 2.0, 1.0))
