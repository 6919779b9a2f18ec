"""A shell: chart, thickness, material, supports and imperfection fields. A value; nothing is computed here."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, pairwise
from types import MappingProxyType
from typing import NamedTuple, cast

import numpy as np

from casingfem.arrays import Array
from casingfem.errors import ModelError, doubt
from casingfem.structure.bolt_mesh import SEEN, following, springs_per_wave, spurious_split
from casingfem.structure.bolts import Bolts
from casingfem.structure.chart import Chart, Surface, require_positive
from casingfem.structure.chart_checks import check_chart, check_symmetry
from casingfem.structure.edge_form import Sprung
from casingfem.structure.extent import check_wall
from casingfem.structure.field import Field, relative
from casingfem.structure.material import Material
from casingfem.structure.mesh import ShellMesh
from casingfem.structure.point_mass import PointMass
from casingfem.structure.random_field import typical
from casingfem.structure.ring import Ring
from casingfem.structure.rotation import Rotation
from casingfem.structure.strip import Strip, breaks_between, check_strips, spread
from casingfem.structure.support import Clamped, ElasticEdge, ShearDiaphragm, Support, Symmetry, grip
from casingfem.structure.survey_check import check_survey, surveys
from casingfem.structure.taper import Taper

SUPPORTS: tuple[type, ...] = (Clamped, ShearDiaphragm, Symmetry, ElasticEdge, Bolts, Ring)
DEFECTS = ("radius", "thickness", "modulus", "density")  # quantity -> Shell.<quantity>_defect


class ShellGeometry(NamedTuple):
    """Mid-surface, thickness and material at points."""

    surface: Surface
    thickness: Array
    E: Array
    nu: Array
    rho: Array


def default_mesh(shell: "Shell") -> ShellMesh:
    """The mesh used when none is given; `python -m reports.frustum_convergence` measures the choice.

    Around a casing: 8 nodes a wave at twice the nodal diameters of the lowest mode, estimated as .46 R/sqrt(t h);
    17 where something varies around, so that turning it changes no frequency by more than some 1e-10 and what symmetry
    forbids to split stays whole (`reports.splitting`); and 14 nodes a wave of the fields themselves, harmonics below
    2 % of their largest left aside. An odd number, since even ones fare worse when fields are turned; where springs
    vary, a multiple of the common period if that exceeds twice those nodal diameters. Along the meridian: the shear
    layer of a free edge, about 2 t wide, takes a row of its own; the rest is divided by the bending length sqrt(R t).
    Strips put an element line at each of their ends, and each stretch between them is divided on its own.
    Bolts are followed: a multiple of their number around, which by itself keeps whole what symmetry does, at 8 nodes a
    wave where nothing else varies; and a layer along their edge, which is free between them.
    """
    (a0, a1), (b0, b1) = np.real(shell.chart.bounds)
    t, length, span = shell.thinnest, float(a1 - a0), float(b1 - b0)
    if not shell.chart.periodic:
        corner = shell.chart.surface(np.array([a0]), np.array([b1]), None)
        size = float(np.linalg.norm(np.real(corner.x2))) * span
        around = int(np.clip(round(2.0 * size / length), 2, 8))
        rows = int(np.clip(round(2.0 * length / size), 2, 8))
        return ShellMesh(order=8, rows=divided(shell, 1.0 / rows) if shell.strips else rows, around=around)
    order = 7
    middle = np.array([0.5 * (a0 + a1)]), np.zeros(1)
    radius = float(np.linalg.norm(np.real(shell.chart.surface(*middle, None).x2)))
    lowest = 0.46 * radius / np.sqrt(t * length)
    finest = max((finest_harmonic(shell, f) for f in shell.defects.values()), default=0)
    bolted = {edge: support.count for edge, support in grips(shell).items() if isinstance(support, Bolts)}
    patterned = any(isinstance(support, ElasticEdge) and support.patterns for support in grips(shell).values())
    only_bolts = bool(bolted) and not (shell.defects or shell.masses or patterned)  # which the mesh follows
    elements = max((16.0 if shell.axisymmetric or only_bolts else 34.0) * lowest, 14.0 * finest) / order
    around = int(np.clip(2 * np.ceil((elements - 1.0) / 2.0) + 1, 21, 75))
    springy = any(not s.uniform for s in shell.supports.values() if isinstance(s, Sprung | Ring))
    period = around_period(shell) if springy else 1
    whole = period * -(-around // period) if period > 1 else 0
    if 4.4 * lowest < whole <= 1.25 * around:  # what symmetry forbids to split, the mesh leaves whole
        around = whole
    if bolted:
        around = following(around, int(np.lcm.reduce(list(bolted.values()))))
    held = {shell.chart.edges[edge] for edge in shell.supports.keys() - bolted.keys()}
    at_ends = np.real(shell.geometry(np.array([a0, a1]), np.zeros(2)).thickness)
    layers = [0.0 if (0, k) in held else float(np.clip(2.5 * at_ends[k] / length, 1e-3, 0.1)) for k in range(2)]
    longest = max(7.0 * np.sqrt(radius * t) / length, 0.25)  # reports.locking
    return ShellMesh(order=order, rows=divided(shell, longest, (layers[0], layers[1])), around=around)


def divided(shell: "Shell", longest: float, layers: tuple[float, float] = (0.0, 0.0)) -> tuple[float, ...]:
    """Breaks of the rows: a layer at either end, and stretches between strip ends in equal rows below `longest`.

    A layer wider than half of its stretch is left out.
    """
    breaks = breaks_between(shell.strips, shell.chart.bounds[0])
    rows: set[float] = set()
    for low, high in pairwise(breaks):
        first = layers[0] * (low == 0.0 and layers[0] < 0.5 * (high - low))
        last = layers[1] * (high == 1.0 and layers[1] < 0.5 * (high - low))
        count = max(1, int(np.ceil((high - low - first - last) / longest - 1e-9)))
        rows |= {low, high, *np.linspace(low + first, high - last, count + 1).tolist()}
    return tuple(sorted(rows))


def sampled_geometry(shell: "Shell", around: int) -> ShellGeometry:
    """The shell at five places along each row of its mesh and `around` places across: every strip has its share."""
    (a0, a1), (b0, b1) = np.real(shell.chart.bounds)
    lines = a0 + (a1 - a0) * shell.mesh.breaks
    along = lines[:-1, None] + np.diff(lines)[:, None] * np.linspace(0.0, 1.0, 5)
    middle = 0.5 * (lines[:-1] + lines[1:])
    return shell.geometry(along[:, :, None], np.linspace(b0, b1, around), middle[:, None, None])


def grips(shell: "Shell") -> dict[str, object]:
    """Edge -> what holds it from outside, a ring's own support under a ring."""
    return {edge: grip(support) for edge, support in shell.supports.items()}


def field_samples(defect: Field) -> int:
    """Points around that show a field whole: four a wave of its highest harmonic, where it says which."""
    return 4 * max(64, 1 + int(getattr(defect, "max_harmonic", None) or 0))


def harmonic_amplitudes(shell: "Shell", defect: Field) -> Array:
    """Largest amplitude of each harmonic 1, 2, ... around of a field over five heights; random parts are typical."""
    (a0, a1), _ = shell.chart.bounds
    points = field_samples(defect)
    theta = 2.0 * np.pi * np.arange(points) / points
    values = np.real(typical(defect).derivatives(np.linspace(a0, a1, 5)[:, None], theta[None, :]).value)
    return np.asarray(np.abs(np.fft.rfft(values, axis=1)).max(axis=0)[1 : points // 2])


def around_period(shell: "Shell", floor: float = 1e-3) -> int:
    """The greatest common divisor of all that varies around: a mesh of as many elements shares its symmetry."""
    period = 0
    springs = [s.patterns.values() for s in grips(shell).values() if isinstance(s, ElasticEdge)]
    for defect in (*shell.defects.values(), *chain.from_iterable(springs)):
        amplitude = harmonic_amplitudes(shell, defect)
        period = int(np.gcd.reduce([period, *(1 + np.flatnonzero(amplitude > floor * amplitude.max())).tolist()]))
    for support in grips(shell).values():
        if isinstance(support, Bolts):
            period = int(np.gcd(period, support.period))
    return period


def finest_harmonic(shell: "Shell", defect: Field, floor: float = 0.02) -> int:
    """The highest circumferential harmonic of a field above `floor` times its largest, by sampling."""
    amplitude = harmonic_amplitudes(shell, defect)
    above = np.flatnonzero(amplitude > floor * amplitude.max())
    return int(above[-1]) + 1 if amplitude.max() > 0.0 else 0


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
    >>> from casingfem.structure.chart import Frustum
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
