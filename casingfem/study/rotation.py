"""[rotation] of a study file: speed, and where the axis lies."""

import numpy as np

from casingfem.structure.geometry.chart import Chart
from casingfem.structure.geometry.rotation import Rotation, Vector
from casingfem.study.problems import Problems
from casingfem.study.tables.shapes import RotationTable

NAMED = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def build_rotation(table: RotationTable | None, chart: Chart | None, problems: Problems) -> Rotation | None:
    """The rotation of a study: of a blade on its hub, or about an axis in the chart's coordinates.

    A closed casing turns about z unless an axis is named; an open chart needs a hub radius or an axis.
    """
    if table is None or chart is None:
        return None
    point = table.centre or table.point
    on_hub = table.hub_radius is not None or table.stagger_deg != 0.0
    if on_hub and (table.axis is not None or point is not None):
        problems.add("rotation", "a hub radius or a stagger beside an axis or a centre", "one way to place the axis")
        return None
    if not on_hub and table.axis is None and not chart.periodic:
        problems.add("rotation", "neither hub_radius nor axis on an open chart", "hub_radius, or axis and centre")
        return None
    omega = 2.0 * np.pi * table.speed_hz
    with problems.at("rotation"):
        if on_hub:
            stagger = float(np.radians(table.stagger_deg))
            return Rotation.of_blade(chart, omega=omega, hub_radius=table.hub_radius or 0.0, stagger=stagger)
        return Rotation(omega=omega, axis=axis_vector(table.axis), centre=vector(point))
    return None


def build_mesh_rotation(table: RotationTable | None, problems: Problems) -> Rotation | None:
    """The rotation of an imported part: about an axis in the mesh's coordinates, which must be named."""
    if table is None:
        return None
    for key in ("hub_radius", "stagger_deg"):
        if key in table.model_fields_set:
            problems.add(f"rotation.{key}", "it on an imported mesh", "axis and point", "structure-chart")
    if table.axis is None:
        problems.add(
            "rotation.axis", "nothing", "the axis of an imported part, such as [1.0, 0.0, 0.0]", "study-missing"
        )
        return None
    with problems.at("rotation"):
        omega, point = 2.0 * np.pi * table.speed_hz, table.centre or table.point
        return Rotation(omega=omega, axis=axis_vector(table.axis), centre=vector(point))
    return None


def axis_vector(axis: str | list[float] | None) -> Vector:
    """An axis as a study has it: by name or by its components; z if left out."""
    return NAMED[axis] if isinstance(axis, str) else NAMED["z"] if axis is None else vector(axis)


def vector(numbers: list[float] | None) -> Vector:
    """Three numbers; the origin if left out."""
    x, y, z = numbers or (0.0, 0.0, 0.0)
    return x, y, z
