"""Numbers of charts and supports in words, each with the unit of its key in study.toml."""

import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import NamedTuple

import numpy as np

from casingfem.plot.page import raised
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.geometry.blade import Blade, TwistedPlate
from casingfem.structure.geometry.chart import Cylinder, Frustum, Panel, Plate
from casingfem.structure.geometry.pieces import PiecewiseMeridian
from casingfem.structure.geometry.revolved import Arc
from casingfem.structure.geometry.smooth import SmoothMeridian
from casingfem.study.tables import shapes, supports
from casingfem.study.tables.table import Table

DECLARED: dict[type, type[Table]] = {
    Frustum: shapes.FrustumTable,
    Cylinder: shapes.CylinderTable,
    Panel: shapes.PanelTable,
    Plate: shapes.PlateTable,
    TwistedPlate: shapes.TwistedPlateTable,
    Blade: shapes.BladeTable,
    Arc: shapes.DomeTable,
    ElasticEdge: supports.ElasticTable,
    Bolts: supports.BoltsTable,
    Ring: supports.RingTable,
}
WRITTEN = {"-": "", "degrees": "°", "deg": "°"}


class Quantity(NamedTuple):
    """The unit of a field, and the factor from the field's own unit to it."""

    unit: str
    factor: float = 1.0


def quantity(owner: object, name: str) -> Quantity:
    """Unit of a field from its key in study.toml; an angle whose key ends in _deg is shown in degrees.

    >>> bolts = Bolts(count=8, k=1e8)
    >>> [quantity(bolts, name).unit for name in ("k_rot", "count", "first_angle")]
    ['N m/rad', '', '°']
    >>> [quantity(ElasticEdge(k_face=1e9), name).unit for name in ("k_face", "k_z")]
    ['N/m³', 'N/m per m']
    """
    table = DECLARED.get(type(owner))
    keys = {} if table is None else table.model_fields
    angle = name not in keys and f"{name}_deg" in keys
    key = keys.get(f"{name}_deg" if angle else name)
    found = None if key is None else re.search(r"\[([^\],]+)\]", key.description or "")
    unit = "" if found is None else found[1].replace("^3", "³")
    return Quantity(WRITTEN.get(unit, unit), 180.0 / np.pi if angle else 1.0)


def values_of(owner: object) -> str:
    """The numbers of a chart or a support with their units; zeros are omitted.

    >>> values_of(Bolts(count=8, k=(1e8, 1e8, 2e8), first_angle=np.pi / 2, loose={3: 0.5}))
    'count 8, first_angle 90 °, k (10⁸, 10⁸, 2 × 10⁸) N/m, loose: bolt 3 times 0.5'
    """
    if not is_dataclass(owner):
        return ""
    numbers, laws = list[str](), list[str]()
    for name in (field.name for field in fields(owner)):
        value, (unit, factor) = getattr(owner, name), quantity(owner, name)
        if isinstance(value, int | float) and value != 0.0:
            numbers.append(f"{name} {number(factor * value)} {unit}".rstrip())
        elif isinstance(value, tuple) and value and all(isinstance(x, int | float) for x in value):
            laws.append(f"{name} ({', '.join(number(factor * x) for x in value)}) {unit}".rstrip())
        elif isinstance(value, tuple) and value:
            laws.append(f"{name} ({', '.join(map(str, value))})")
    loose = getattr(owner, "loose", None)
    if isinstance(loose, Mapping) and loose:
        laws.append("loose: " + ", ".join(f"bolt {bolt} times {factor:g}" for bolt, factor in loose.items()))
    return ", ".join(numbers + laws)


def number(value: float) -> str:
    """A number with at most six digits.

    >>> number(1e8), number(0.25)
    ('10⁸', '0.25')
    """
    return raised(f"{value:g}")


def spaced(owner: object) -> str:
    """The name of a class as separate words.

    >>> spaced(ElasticEdge(k_face=1e9))
    'Elastic edge'
    """
    return re.sub(r"(?<!^)(?=[A-Z])", " ", type(owner).__name__).capitalize()


def chart_rows(chart: object) -> list[tuple[str, str]]:
    """The surface, and the pieces of its meridian if it has any.

    >>> chart_rows(Cylinder(radius=0.1, height=0.25))
    [('surface', 'Cylinder: radius 0.1 m, height 0.25 m')]
    """
    profile = getattr(chart, "profile", None)
    if isinstance(profile, PiecewiseMeridian):
        return meridian_rows(profile)
    if isinstance(profile, SmoothMeridian):
        ends = f"from {place(profile.points[0])} to {place(profile.points[-1])}"
        words = f"Smooth meridian through {len(profile.points)} points {ends}, {profile.length:.6g} m long"
        return [("surface", words)]
    if isinstance(profile, Arc):
        return [("surface", f"Dome: {values_of(profile)}")]
    return [("surface", f"{spaced(chart)}: {values_of(chart)}")]


def meridian_rows(profile: PiecewiseMeridian) -> list[tuple[str, str]]:
    """Start and length of a meridian, and of each piece its end, shape, fillet and part of the arc length s."""
    corners = "" if profile.fillet is None else f"; fillets {profile.fillet:g} m"
    count = f"{len(profile.pieces)} piece{'s' * (len(profile.pieces) > 1)}"
    words = f"Meridian of {count} from {place(profile.start)} on, {profile.length:.6g} m long{corners}"
    rows = [("surface", words)]
    for k, (piece, (start, end)) in enumerate(zip(profile.pieces, profile.owners, strict=True), 1):
        shape = "straight" if piece.radius is None else f"arc of radius {piece.radius:g} m"
        own = "" if piece.fillet is None else f", fillet {piece.fillet:g} m at its start"
        rows.append((f"piece {k}", f"to {place(piece.to)}, {shape}{own}; s from {start:.6g} to {end:.6g} m"))
    return rows


def place(point: tuple[float, float]) -> str:
    """A point of a meridian.

    >>> place((0.6, 0.0))
    'r 0.6 m, z 0 m'
    """
    return f"r {point[0]:g} m, z {point[1]:g} m"
