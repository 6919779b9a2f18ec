"""Plausibility of a shell's size, curvature and thickness: impossible walls, and probably unintended models.

Impossible walls are refused; the others, such as mixed-up units or walls too thick or too thin, give a warning. Each
has a code in `casingfem.faults`, and a threshold with its reason.
"""

from collections.abc import Iterator
from functools import lru_cache
from itertools import chain
from typing import NamedTuple

import numpy as np

from casingfem.errors import ModelError, warn
from casingfem.io.arrays import FloatArray
from casingfem.structure.edge.support import Clamped, ElasticEdge
from casingfem.structure.field.survey.stray import LARGEST
from casingfem.structure.geometry.chart import Panel
from casingfem.structure.geometry.chart_checks import real
from casingfem.structure.geometry.revolved import RevolvedPanel, chart_lines
from casingfem.structure.material import Material
from casingfem.structure.shell.parts import ShellParts

FOLDED = 2.0  # wall times curvature: the inner face of a bend has no radius left


class Extent(NamedTuple):
    """Size of a shell [m]: diagonal, lengths of its lines along both parameters, largest curvature [1/m]."""

    diagonal: float
    sides: FloatArray
    curvature: FloatArray
    thickness: FloatArray


def stretches(shell: ShellParts) -> FloatArray:
    """The middle of every interval between jumps of the meridian's curvature or of the wall, also of short ones."""
    ends = [end for strip in shell.strips for end in (strip.start, strip.end)]
    breaks = np.unique(np.real([*shell.chart.bounds[0], *chart_lines(shell.chart), *ends]))
    return np.asarray(0.5 * (breaks[1:] + breaks[:-1]))


class Sampled(NamedTuple):
    """A shell on a grid of points: places (3, along, around), curvature [1/m] and thickness [m], (points,)."""

    x: FloatArray
    curvature: FloatArray
    thickness: FloatArray


def sampled(shell: ShellParts, along: FloatArray, around: int = 361) -> Sampled:
    """A shell at some values of its first parameter, and evenly over the second."""
    b0, b1 = np.real(np.array(shell.chart.bounds[1]))
    a, b = np.meshgrid(along, np.linspace(b0, b1, around), indexing="ij")
    geometry = shell.geometry(a.ravel(), b.ravel())
    s = real(geometry.surface)
    normal = np.cross(s.x1, s.x2, axis=0)
    normal = normal / np.linalg.norm(normal, axis=0)
    g11, g12, g22 = (np.einsum("ip,ip->p", u, v) for u, v in ((s.x1, s.x1), (s.x1, s.x2), (s.x2, s.x2)))
    b11, b12, b22 = (np.einsum("ip,ip->p", u, normal) for u in (s.x11, s.x12, s.x22))
    area = g11 * g22 - g12**2
    mean, gauss = (b11 * g22 - 2.0 * b12 * g12 + b22 * g11) / (2.0 * area), (b11 * b22 - b12**2) / area
    curvature = np.abs(mean) + np.sqrt(np.maximum(mean**2 - gauss, 0.0))
    return Sampled(s.x.reshape(3, *a.shape), curvature, np.real(geometry.thickness))


@lru_cache(maxsize=8)  # a shell is asked for it when it is made, and again when its modes are computed
def extent(shell: ShellParts) -> Extent:
    """Sizes on a lattice of points; curvature and thickness at each, (points,)."""
    a0, a1 = np.real(np.array(shell.chart.bounds[0]))
    at = sampled(shell, np.linspace(a0, a1, 9))
    lengths = [np.linalg.norm(np.diff(at.x, axis=k), axis=0).sum(axis=k - 1) for k in (1, 2)]
    diagonal, sides = float(np.linalg.norm(np.ptp(at.x, axis=(1, 2)))), np.array([own.max() for own in lengths])
    return Extent(diagonal, sides, at.curvature, at.thickness)


def check_wall(shell: ShellParts) -> None:
    """Refuse a wall as thick as its radius of curvature, or as thick as the structure is long and wide."""
    size = extent(shell)
    bent = float((size.thickness * size.curvature).max())
    if bent > 1.0 + 1e-9:  # a fillet of the wall's thickness represents a corner
        raise ModelError(
            "shell-thickness-size", f"the wall thickness is {bent:.3g} times its smallest radius of curvature"
        )
    short = sampled(shell, stretches(shell))
    bent = float((short.thickness * short.curvature).max())
    if bent > FOLDED + 1e-9:
        raise ModelError(
            "shell-thickness-size",
            f"the wall thickness is {bent:.3g} times the radius of curvature of a bend, so that the wall overlaps "
            "itself",
        )
    thickest = float(size.thickness.max())
    if thickest >= (longest := size.sides.max()):
        found = f"the wall is {thickest:.3g} m thick on a surface {longest:.3g} m long"
        raise ModelError("shell-thickness-size", found)


SOUND = (200.0, 20_000.0)  # m/s: sqrt(E/rho) from hard rubber to diamond
DENSITY = (1.0, 25_000.0)  # kg/m^3: from aerogel to osmium
WEIGHTLESS = 0.01  # kg/m^3: below, a carrier is meant to weigh nothing; g/cm^3 and lb/in^3 lie above
SIZE = (1e-3, 25.0)  # m: from a chip to the largest turbine casing; beyond, lengths are probably in mm or km
ASPECT = 1000.0
THICK = 0.2  # wall times curvature: at .1 the shell is 1.4 % off the three-dimensional solution (README), here more
STOUT = 0.6  # wall over the shortest side
THIN = 1e-5  # wall over diagonal: 3 mm written as 3e-6 on half a metre; rockets and cans lie above 2e-4
SHEAR = (0.5, 1.0, 10.0)  # 5/6 and its kin up to 1; above 10 it means the limit of thin shells
TWIST = np.pi  # rad: more is probably in degrees
SOFT = 1e-9  # springs per length over E: a casing on softer ones swings below a hertz
NEARLY_CLOSED = 0.99  # of a full turn
DEFECT = LARGEST  # relative; others 1: a wall half or twice as thick is a law, not an imperfection

Concern = tuple[str, str]  # code, message


def warn_of(shell: ShellParts) -> None:
    """Warn of everything implausible about a shell."""
    for code, message in chain.from_iterable(look(shell) for look in LOOKS):
        warn(code, message, stacklevel=4)


def material_warnings(shell: ShellParts) -> Iterator[Concern]:
    """Warnings about implausible materials."""
    others = [strip.material for strip in shell.strips if strip.material is not None]
    for material in dict.fromkeys([shell.material, *others]):
        yield from warnings_of(material)


def warnings_of(material: Material) -> Iterator[Concern]:
    """Warnings about one material."""
    E, nu, rho = (float(np.real(x)) for x in (material.E, material.nu, material.rho))
    speed = float(np.sqrt(E / rho))
    if E == rho == 1.0:  # a problem without units
        return
    if not SOUND[0] <= speed <= SOUND[1]:
        yield "material-units", f"E = {E:.3g} Pa and rho = {rho:.3g} kg/m^3 give a speed of sound of {speed:.3g} m/s"
    if WEIGHTLESS <= rho < DENSITY[0] or rho > DENSITY[1]:
        yield "material-density-units", f"material.rho = {rho:.3g} kg/m^3"
    if nu < 0.0:
        yield "material-poisson-negative", f"material.nu = {nu:g}"


def chart_warnings(shell: ShellParts) -> Iterator[Concern]:
    """Warnings about sizes and shapes that suggest other units, and fields too large for imperfections."""
    size = extent(shell)
    unitless = shell.material.E == shell.material.rho == 1.0
    if not unitless and not SIZE[0] <= size.diagonal <= SIZE[1]:
        yield "chart-units", f"the structure is {size.diagonal:.4g} m across"
    long, short = size.sides.max(), size.sides.min()
    if long > ASPECT * short:
        yield "chart-aspect", f"the surface is {long:.3g} m by {short:.3g} m"
    angle = float(np.real(shell.chart.angle)) if isinstance(shell.chart, Panel | RevolvedPanel) else 0.0
    twist = float(np.abs(np.real(getattr(shell.chart, "twist", 0.0))).max())
    if angle > NEARLY_CLOSED * 2.0 * np.pi:
        yield "chart-near-closed", f"chart.angle = {angle:.5g} rad of {2.0 * np.pi:.5g}"
    if twist > TWIST:
        yield "chart-twist-units", f"chart.twist = {twist:.4g} rad"
    for quantity, field in shell.defects.items():
        (a0, a1), (b0, b1) = np.real(shell.chart.bounds)
        a, b = np.linspace(a0, a1, 9)[:, None], np.linspace(b0, b1, 361)[None, :]
        largest = float(np.abs(np.real(field.derivatives(a, b).value)).max())
        if largest > DEFECT.get(quantity, 1.0):
            yield "field-large", f"{quantity}_defect reaches {largest:.3g} of the {quantity}"


def wall_warnings(shell: ShellParts) -> Iterator[Concern]:
    """Warnings about walls that are not those of a shell."""
    size = extent(shell)
    bent = float((size.thickness * size.curvature).max())
    stout = float(size.thickness.max() / size.sides.min())
    if bent > THICK:
        yield "shell-thick", f"the wall thickness is {bent:.2g} of its smallest radius of curvature"
    elif stout > STOUT:
        yield "shell-thick", f"the wall thickness is {stout:.2g} of the shortest side"
    thin = float(size.thickness.min() / size.diagonal)
    if thin < THIN:
        yield "shell-thin", f"the wall thickness is {thin:.2g} of the structure's diagonal"
    factor = 1.0 if shell.shear_correction is None else float(np.real(shell.shear_correction))
    if not (SHEAR[0] <= factor <= SHEAR[1] or factor >= SHEAR[2]):
        yield "shear-correction", f"shell.shear_correction = {factor:g}"


def spring_warnings(shell: ShellParts) -> Iterator[Concern]:
    """Warnings about springs without effect on such a wall."""
    E, t = float(np.real(shell.material.E)), float(np.real(shell.thickness))
    for edge, support in shell.supports.items():
        if isinstance(support, ElasticEdge):
            line = max(float(np.real(k)) for k in (support.k_r, support.k_theta, support.k_z))
            ratio = max(line, float(np.real(support.k_face)) * t, float(np.real(support.k_rot)) / t**2) / E
            if ratio < SOFT:
                yield "support-soft", f"support.{edge}: found springs of at most {ratio:.2g} E per metre of edge"


def mass_warnings(shell: ShellParts) -> Iterator[Concern]:
    """Warnings about masses on an edge that does not move."""
    for edge, masses in shell.masses.items():
        if masses and isinstance(shell.supports.get(edge), Clamped):
            yield "mass-held", f"masses.{edge}: found {len(masses)} masses on a clamped edge"


LOOKS = (material_warnings, chart_warnings, wall_warnings, spring_warnings, mass_warnings)
