"""A shell: chart, thickness, material, supports and imperfection fields. A value; nothing is computed here."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple, cast

import numpy as np

from casingfem.errors import ModelError, doubt
from casingfem.io.arrays import Array
from casingfem.structure.edge.bolt_mesh import SEEN, following, springs_per_wave, spurious_split
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.point_mass import PointMass
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.support import Clamped, ElasticEdge, ShearDiaphragm, Support, Symmetry, grip
from casingfem.structure.field.fourier import Field, relative
from casingfem.structure.geometry.chart import Chart, Surface, require_positive
from casingfem.structure.geometry.chart_checks import check_chart, check_symmetry
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.geometry.strip import Strip, check_strips, spread
from casingfem.structure.geometry.survey_check import check_survey, surveys
from casingfem.structure.geometry.taper import Taper
from casingfem.structure.material import Material
from casingfem.structure.mesh.edge_form import Sprung
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.default_mesh import default_mesh
from casingfem.structure.shell.extent import check_wall
from casingfem.structure.shell.variation import field_samples, finest_harmonic, grips

SUPPORTS: tuple[type, ...] = (Clamped, ShearDiaphragm, Symmetry, ElasticEdge, Bolts, Ring)
DEFECTS = ("radius", "thickness", "modulus", "density")  # quantity -> Shell.<quantity>_defect


class ShellGeometry(NamedTuple):
    """Mid-surface, thickness and material at points."""

    surface: Surface
    thickness: Array
    E: Array
    nu: Array
    rho: Array


def sampled_geometry(shell: "Shell", around: int) -> ShellGeometry:
    """The shell at five places along each row of its mesh and `around` places across: every strip has its share."""
    (a0, a1), (b0, b1) = np.real(shell.chart.bounds)
    lines = a0 + (a1 - a0) * shell.mesh.breaks
    along = lines[:-1, None] + np.diff(lines)[:, None] * np.linspace(0.0, 1.0, 5)
    middle = 0.5 * (lines[:-1] + lines[1:])
    return shell.geometry(along[:, :, None], np.linspace(b0, b1, around), middle[:, None, None])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shell:
    """A shear-deformable shell on a chart.

    Parameters
    ----------
    chart
        Mid-surface: Frustum, Cylinder, Panel, Plate, TwistedPlate, Blade, or anything that satisfies `Chart`.
    thickness
        Nominal thickness t [m].
    material
        Isotropic material.
    supports
        Edge name -> support; edges not named are free.
    radius_defect
        Relative radius field f: r = r0 (1 + f).
    thickness_defect, modulus_defect, density_defect
        Relative fields of the thickness t (1 + f), of Young's modulus E (1 + f), of the density rho (1 + f).
    shear_correction
        Factor of the transverse shear stiffness; a large one gives the thin-shell (Kirchhoff-Love) limit.
    strips
        Bands along the first parameter with a thickness, or a material, of their own.
    taper
        How the thickness is meant to vary: factors of it from root to tip and across.
    rotation
        Steady rotation: speed and axis; at rest if left out.
    masses
        Edge -> point masses on it, or on the centre line of its ring.
    mesh
        Order and element counts; a default for the kind of chart if left out.

    Raises
    ------
    ModelError
        Not positive thickness, an unknown edge, or a field as large as what it varies.
    ModelError
        Springs that a pattern makes negative (`springs-negative`); strips that overlap or leave the shell
        (`strip-overlap`, `strip-outside`), or end where a given mesh has no element line (`strip-off-line`).

    Examples
    --------
    >>> from casingfem.structure.geometry.chart import Frustum
    >>> steel = Material(E=210e9, nu=0.3, rho=7800.0)
    >>> casing = Shell(chart=Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3, material=steel,
    ...                supports={"base": Clamped()})
    >>> casing.mesh.order
    7
    """

    chart: Chart
    thickness: float
    material: Material
    supports: Mapping[str, Support] = field(default_factory=dict)
    radius_defect: Field | None = None
    thickness_defect: Field | None = None
    modulus_defect: Field | None = None
    density_defect: Field | None = None
    shear_correction: float = 5.0 / 6.0
    strips: tuple[Strip, ...] = ()
    taper: Taper | None = None
    rotation: Rotation | None = None
    masses: Mapping[str, Sequence[PointMass]] = field(default_factory=dict)
    mesh: ShellMesh = None  # type: ignore[assignment]  # chosen in __post_init__ where left out

    def __post_init__(self) -> None:
        require_positive("shell", thickness=self.thickness, shear_correction=self.shear_correction)
        check_chart(self.chart)
        known = self.chart.edges
        for edge, support in self.supports.items():
            if edge not in known:
                raise ModelError(
                    "support-edge", f"support.{edge}: this chart has no edge {edge!r}; it has {', '.join(known)}"
                )
            if not isinstance(support, SUPPORTS):
                raise ModelError(
                    "support-kind",
                    f"support.{edge}: expected {', '.join(kind.__name__ for kind in SUPPORTS)}, "
                    f"found {type(support).__name__}",
                )
            held, _ = known[edge]
            if isinstance(support, Ring) and held != 0:
                raise ModelError("ring-edge", f"support.{edge}: a ring on an edge that runs along the axis")
            across = [other for other in self.supports if known[other][0] != 0 and self.supports[other].held]
            if isinstance(support, Ring) and across:  # nothing would hold the ring's own turn at the corner
                raise ModelError("ring-edge", f"support.{edge}: a ring ends on the held edge {across[0]!r}")
            if isinstance(support, Symmetry):
                check_symmetry(self.chart, edge)
            holding = grip(support)
            if isinstance(holding, Bolts):
                low, high = (float(np.real(end)) for end in self.chart.bounds[1 - held])
                holding.require_on((low, high), self.chart.periodic and held == 0, edge)
        for edge, masses in self.masses.items():
            if edge not in known or not all(isinstance(mass, PointMass) for mass in masses):
                raise ModelError("mass-edge", f"masses.{edge}: expected masses on one of {', '.join(known)}")
        object.__setattr__(self, "masses", MappingProxyType({e: tuple(m) for e, m in self.masses.items() if m}))
        object.__setattr__(self, "supports", MappingProxyType(dict(self.supports)))
        object.__setattr__(self, "strips", tuple(self.strips))
        ends = self.chart.bounds[0]
        check_strips(self.strips, ends, None)
        if cast(ShellMesh | None, self.mesh) is None:
            object.__setattr__(self, "mesh", default_mesh(self))
        check_strips(self.strips, ends, ends[0] + (ends[1] - ends[0]) * self.mesh.breaks)
        for quantity, defect in self.defects.items():
            self._check_field(f"{quantity}_defect", defect)
            for survey in surveys(defect):
                check_survey(survey, quantity, self.chart, float(np.real(self.thickness)))
        check_wall(self)
        for edge, holding in grips(self).items():
            if isinstance(holding, ElasticEdge) and holding.patterns:
                self._check_springs(edge, holding)
            if isinstance(holding, Bolts) and self.chart.periodic:
                self._check_bolt_mesh(edge, holding)

    def _check_bolt_mesh(self, edge: str, bolts: Bolts) -> None:
        if self.mesh.around == following(self.mesh.around, bolts.count):
            return
        wall, steel = self.thickness, self.material
        if isinstance(ring := self.supports[edge], Ring):
            wall, steel = ring.section.width, ring.material or steel
        ratio = springs_per_wave(bolts, float(np.real(steel.E)), float(np.real(steel.nu)), float(np.real(wall)))
        split = spurious_split(bolts, self.mesh, ratio)
        if split > SEEN:
            doubt(
                "bolt-mesh",
                f"support.{edge}: {bolts.count} bolts on {self.mesh.around} elements around split pairs that equal "
                f"bolts keep whole by some {split:.0e}",
                stacklevel=5,
            )

    def _check_springs(self, edge: str, support: ElasticEdge) -> None:
        held, end = self.chart.edges[edge]
        points = max(361, *(2 * field_samples(field) + 1 for field in support.patterns.values()))
        ends = [np.linspace(*span, points) for span in self.chart.bounds]
        ends[held] = np.full(points, self.chart.bounds[held][end])
        for spring in (name for name in support.patterns if getattr(support, name)):
            lowest = float(np.real(support.factor(spring, *ends)).min())
            if not lowest >= 0.0:
                raise ModelError(
                    "springs-negative", f"support.{edge}.around makes {spring} negative (factor {lowest:.3g})"
                )

    def _check_field(self, name: str, defect: Field) -> None:
        counts = (9, max(361, 2 * field_samples(defect) + 1))
        a, b = (np.linspace(*ends, count) for ends, count in zip(self.chart.bounds, counts, strict=True))
        values = np.real(defect.derivatives(a[:, None], b[None, :]).value)
        if not np.all(np.isfinite(values)):
            raise ModelError("field-not-finite", f"{name}: the field is not finite everywhere on the surface")
        if values.min() <= -0.9 or values.max() > 9.0:
            reached = values.min() if values.min() <= -0.9 else values.max()
            raise ModelError("field-range", f"{name}: the field reaches {reached:.3g}, it may run from -0.9 to 9")
        nodes = self.mesh.order * self.mesh.around
        finest = finest_harmonic(self, defect) if self.chart.periodic else 0
        if 2 * finest > nodes:
            raise ModelError(
                "field-mesh", f"{name}: {finest} waves on {nodes} nodes around; the mesh resolves {nodes // 2} at most"
            )

    @property
    def defects(self) -> dict[str, Field]:
        """The imperfection fields there are, by quantity: radius, thickness, modulus, density."""
        fields = {quantity: getattr(self, f"{quantity}_defect") for quantity in DEFECTS}
        return {quantity: field for quantity, field in fields.items() if field is not None}

    @property
    def axisymmetric(self) -> bool:
        """Whether nothing varies around: no fields, springs equal all along their edges, and at rest."""
        even = all(support.uniform for support in self.supports.values() if isinstance(support, Sprung | Ring))
        even = even and (self.taper is None or self.taper.even)
        return self.chart.periodic and even and not self.defects and not self.masses and self.rotation is None

    @property
    def thinnest(self) -> float:
        """The least thickness of wall and strips [m], taper included, imperfections not."""
        taper = 1.0 if self.taper is None else self.taper.lowest
        return taper * float(np.real([self.thickness, *(strip.thickness for strip in self.strips)]).min())

    def geometry(self, a: Array, b: Array, inside: Array | None = None) -> ShellGeometry:
        """Mid-surface, thickness and material at parameters (a, b).

        `inside` is a value of the first parameter that tells whose side of a strip's end a point belongs to: the
        middle of its element. Without it a point on such a line is the strip's.
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
        return ShellGeometry(
            surface=self.chart.surface(a, b, defect),
            thickness=thickness * relative(self.thickness_defect, a, b),
            E=E * relative(self.modulus_defect, a, b),
            nu=nu,
            rho=rho * relative(self.density_defect, a, b),
        )
