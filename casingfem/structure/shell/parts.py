"""Parts of a shell as given: chart, wall, material, supports and imperfection fields."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array
from casingfem.structure.edge.ring import EdgeMass, Ring, Stiffener
from casingfem.structure.edge.support import Support
from casingfem.structure.field.field import Field, relative
from casingfem.structure.geometry.chart import Chart, Surface, is_axisymmetric
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.geometry.stations import Taper
from casingfem.structure.geometry.strip import Strip, spread
from casingfem.structure.material import Material
from casingfem.structure.mesh.edge_form import Sprung
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.plies import Ply, mirrored

DEFECTS = ("radius", "thickness", "modulus", "density")  # quantity -> Shell.<quantity>_defect


class ShellGeometry(NamedTuple):
    """Mid-surface, thickness and material at points."""

    surface: Surface
    thickness: Array
    E: Array
    nu: Array
    rho: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShellParts:
    """The fields of a `Shell`, which documents them, without checks and without a mesh."""

    chart: Chart
    thickness: float
    material: Material
    supports: Mapping[str, Support] = field(default_factory=dict)
    radius_defect: Field | None = None
    thickness_defect: Field | None = None
    modulus_defect: Field | None = None
    density_defect: Field | None = None
    shear_correction: float | None = None
    wall: str = "curved"
    plies: tuple[Ply, ...] = ()
    strips: tuple[Strip, ...] = ()
    stiffeners: tuple[Stiffener, ...] = ()
    taper: Taper | None = None
    rotation: Rotation | None = None
    masses: Mapping[str, Sequence[EdgeMass]] = field(default_factory=dict)
    mesh: ShellMesh = None  # type: ignore[assignment]  # `Shell` chooses one where left out

    @property
    def defects(self) -> dict[str, Field]:
        """The existing imperfection fields by quantity: radius, thickness, modulus, density."""
        fields = {quantity: getattr(self, f"{quantity}_defect") for quantity in DEFECTS}
        return {quantity: field for quantity, field in fields.items() if field is not None}

    @property
    def stations(self) -> dict[str, float]:
        """Lines between the edges that have stiffeners, by name: their first parameters."""
        return {f"stiffener {k}": stiffener.at for k, stiffener in enumerate(self.stiffeners, 1)}

    @property
    def rings(self) -> dict[str, Ring]:
        """Rings by their lines: those on edges, then stiffeners."""
        on_edges = {edge: support for edge, support in self.supports.items() if isinstance(support, Ring)}
        between = zip(self.stations, (stiffener.ring for stiffener in self.stiffeners), strict=True)
        return on_edges | dict(between)

    def line_at(self, name: str) -> float:
        """The first parameter of the line of a ring: an edge or a station."""
        if name in self.stations:
            return self.stations[name]
        return self.chart.bounds[0][self.chart.edges[name][1]]

    @property
    def axisymmetric(self) -> bool:
        """Whether nothing varies around: an axisymmetric chart at rest, no fields, uniform springs, balanced plies."""
        even = all(support.uniform for support in self.supports.values() if isinstance(support, Sprung | Ring))
        even = even and (self.taper is None or self.taper.even) and (not self.plies or mirrored(self.plies))
        return is_axisymmetric(self.chart) and even and not self.defects and not self.masses and self.rotation is None

    @property
    def layers(self) -> tuple[Ply, ...]:
        """The plies in the order of the surface's normal, which points into cylinders and frusta."""
        (a0, a1), (b0, b1) = np.real(self.chart.bounds)
        places = np.linspace(a0, a1, 5), np.full(5, 0.5 * (b0 + b1))
        surface = self.chart.surface(*places, None)
        normal = np.cross(np.real(surface.x1), np.real(surface.x2), axis=0)
        out = float(np.sum(normal * np.real(self.chart.directions(*places)[0])))
        return self.plies if out >= 0.0 else self.plies[::-1]

    @property
    def thinnest(self) -> float:
        """The smallest design thickness of wall and strips [m], with taper and without imperfections."""
        taper = 1.0 if self.taper is None else self.taper.lowest
        return taper * float(np.real([self.thickness, *(strip.thickness for strip in self.strips)]).min())

    def shear_factor(self, nu: Array) -> Array:
        """Factor of the transverse shear stiffness for a Poisson's ratio nu."""
        if self.shear_correction is not None:
            return np.asarray(self.shear_correction) + 0.0 * nu
        return 5.0 / (6.0 - nu) if self.wall == "curved" else np.full_like(nu, 5.0 / 6.0)

    def geometry(self, a: Array, b: Array, inside: Array | None = None) -> ShellGeometry:
        """Mid-surface, thickness and material at parameters (a, b).

        `inside` is a value of the first parameter that shows the side of a strip's end to which a point belongs, such
        as the middle of its element. Without it a point on such a line belongs to the strip.
        """
        defect = None if self.radius_defect is None else self.radius_defect.derivatives(a, b)
        where = np.broadcast_arrays(a if inside is None else inside, a, b)[0]
        thickness = spread(self.strips, where, self.thickness, [strip.thickness for strip in self.strips])
        if self.taper is not None:
            thickness = thickness * self.taper.factor(self.chart.bounds, a, b)
        materials = [strip.material or self.material for strip in self.strips]
        E, nu, rho = (
            spread(self.strips, where, getattr(self.material, name), [getattr(m, name) for m in materials])
            for name in ("E", "nu", "rho")
        )
        thickness = thickness * relative(self.thickness_defect, a, b)
        E, rho = E * relative(self.modulus_defect, a, b), rho * relative(self.density_defect, a, b)
        return ShellGeometry(self.chart.surface(a, b, defect), thickness, E, nu, rho)


def sampled_geometry(shell: ShellParts, around: int) -> ShellGeometry:
    """The shell at five points along each row of its mesh and `around` points across, for every strip."""
    (a0, a1), (b0, b1) = np.real(shell.chart.bounds)
    lines = a0 + (a1 - a0) * shell.mesh.breaks
    along = lines[:-1, None] + np.diff(lines)[:, None] * np.linspace(0.0, 1.0, 5)
    middle = 0.5 * (lines[:-1] + lines[1:])
    return shell.geometry(along[:, :, None], np.linspace(b0, b1, around), middle[:, None, None])
