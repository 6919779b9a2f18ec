"""From the tables of a study file to the supports and loads of an edge: supports, bolts, rings, point masses."""

from typing import Any

import numpy as np

from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import EdgeMass, Ring, Stiffener, check_stiffeners
from casingfem.structure.edge.section import Section
from casingfem.structure.edge.support import Clamped, ElasticEdge, ShearDiaphragm, Support, Symmetry
from casingfem.structure.field.field import Field
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.geometry.blade import Blade, TwistedPlate
from casingfem.structure.geometry.chart import Chart, Plate
from casingfem.structure.material import Material
from casingfem.study.problems import Problems
from casingfem.study.tables import supports as kinds
from casingfem.study.tables.fields import Harmonic
from casingfem.study.tables.shapes import MassTable
from contact.io.names import hint
from contact.io.tables import value_of


def build_supports(
    tables: dict[str, kinds.SupportTable], chart: Chart | None, problems: Problems
) -> dict[str, Support]:
    """Supports by edge; unknown edges of the chart are reported."""
    supports: dict[str, Support] = {}
    for edge, table in tables.items():
        if chart is not None and edge not in chart.edges:
            expected = f"one of the chart's edges {', '.join(chart.edges)}{hint(edge, chart.edges)}"
            problems.add(f"support.{edge}", f"edge {edge!r}", expected, "support-edge")
            continue
        with problems.at(f"support.{edge}"):
            supports[edge] = build_support(table, edge, chart)
    return supports


def build_support(table: kinds.SupportTable, edge: str, chart: Chart | None) -> Support:
    """The support of a [support.EDGE] table."""
    if isinstance(table, kinds.BoltsTable):
        return build_bolts(table, edge, chart)
    if isinstance(table, kinds.RingTable):
        return build_ring(table, edge, chart)
    if isinstance(table, kinds.ElasticTable):
        return value_of(table, ElasticEdge, around=build_around(table))
    if isinstance(table, kinds.FixedTable):
        raise ValueError("kind: found 'fixed', which is for imported meshes, expected a kind for a chart's edge")
    if isinstance(table, kinds.SymmetryTable):
        return Symmetry()
    return Clamped() if table.kind == "clamped" else ShearDiaphragm()


def build_bolts(table: kinds.BoltsTable, edge: str, chart: Chart | None) -> Bolts:
    """Bolts of the file: degrees become radians, a width in metres an angle at the edge's mean radius."""
    require_angle(chart, edge, "bolts")
    width = {}
    if table.width_m is not None:
        if chart is None or not chart.periodic:
            raise ValueError("width_m: found an open edge, expected a closed casing; give width_deg")
        z = np.array([chart.bounds[0][chart.edges[edge][1]]])
        width["width"] = table.width_m / float(np.linalg.norm(chart.surface(z, np.zeros(1), None).x[:2]))
    parts = tuple(k or 0.0 for k in (table.k_r, table.k_theta, table.k_z))
    loose = {entry.bolt: entry.factor for entry in table.loose}
    return value_of(table, Bolts, k=parts if table.k is None else table.k, loose=loose, **width)


def build_ring(table: kinds.RingTable, edge: str, chart: Chart | None) -> Ring:
    """A ring of the file, with its own support."""
    held = None if table.support is None else build_support(table.support, edge, chart)
    return Ring(
        **build_section(table),
        offset=None if table.offset is None else (table.offset[0], table.offset[1]),
        foot=None if table.foot is None else (table.foot[0], table.foot[1]),
        support=held,  # type: ignore[arg-type]  # an elastic edge or bolts, as the table states
    )


def build_section(table: kinds.SectionTable) -> dict[str, Any]:
    """Section and material of a ring."""
    if table.diameter is not None:
        section = Section.circle(diameter=table.diameter)
    else:
        assert table.width is not None  # the table has seen to it
        assert table.depth is not None
        section = Section.rectangle(width=table.width, depth=table.depth)
    material = None if table.material is None else value_of(table.material, Material)
    return {"section": section, "material": material}


def build_stiffeners(
    tables: list[kinds.StiffenerTable], chart: Chart | None, problems: Problems
) -> tuple[Stiffener, ...]:
    """Rings on the wall; their errors are collected."""
    rings: list[Stiffener] = []
    for k, table in enumerate(tables):
        with problems.at(f"stiffener[{k + 1}]"):
            rings.append(Stiffener(at=table.at, offset=(table.offset[0], table.offset[1]), **build_section(table)))
    if chart is not None and len(rings) == len(tables):
        with problems.at("stiffener"):
            check_stiffeners(rings, chart.bounds[0], chart.periodic)
    return tuple(rings)


def build_masses(tables: list[MassTable], chart: Chart | None, problems: Problems) -> dict[str, list[EdgeMass]]:
    """Point masses by edge; unknown edges of the chart are reported."""
    masses: dict[str, list[EdgeMass]] = {}
    for k, table in enumerate(tables):
        if chart is not None and table.edge not in chart.edges:
            problems.add(f"mass[{k + 1}].edge", repr(table.edge), f"one of the chart's edges {', '.join(chart.edges)}")
            continue
        with problems.at(f"mass[{k + 1}]"):
            require_angle(chart, table.edge, "angle_deg")
            masses.setdefault(table.edge, []).append(value_of(table, EdgeMass))
    return masses


def require_angle(chart: Chart | None, edge: str, key: str) -> None:
    """Refuse an angle on an edge that is measured in metres: of a plate or blade, or along the axis."""
    if chart is not None and (isinstance(chart, Plate | TwistedPlate | Blade) or chart.edges[edge][0] != 0):
        raise ValueError(f"{key}: found an edge without angles, {edge!r}, expected one that runs around an axis")


def build_around(table: kinds.ElasticTable) -> Field | dict[str, Field] | None:
    """Variation of the springs of an elastic edge: common, or separate harmonics for each; None if uniform."""
    if isinstance(table.around, list):
        return series(table.around, "around", least=1) if table.around else None
    lists = {name: getattr(table.around, name) for name in ElasticEdge.stiffness_names}
    patterns: dict[str, Field] = {k: series(waves, f"around.{k}", least=1) for k, waves in lists.items() if waves}
    return patterns or None


def series(waves: list[Harmonic], key: str, least: int = 0) -> FourierField:
    """Harmonics of the file as a field."""
    numbers = [h.p for h in waves]
    if len(set(numbers)) < len(numbers) or min(numbers, default=least) < least:
        once = f"each p >= {least} once" if least else "each p once"
        raise ValueError(f"{key}: found harmonics {numbers}, expected {once}")
    return FourierField.of({h.p: (h.cos, h.sin) for h in waves})
