"""How large, how curved and how thick a shell is; walls that no surface can carry are refused."""

from typing import NamedTuple

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.structure.geometry.chart_checks import real
from casingfem.structure.geometry.revolved import chart_lines
from casingfem.structure.shell.parts import ShellParts

FOLDED = 2.0  # wall times curvature: the inner face of a bend has no radius left


class Extent(NamedTuple):
    """How large a shell is [m]: diagonal, the lengths of its lines along both parameters, largest curvature [1/m]."""

    diagonal: float
    sides: FloatArray
    curvature: FloatArray
    thickness: FloatArray


def stretches(shell: ShellParts) -> FloatArray:
    """The middle of every stretch between places where the meridian's curvature or the wall jumps: short ones too."""
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


def extent(shell: ShellParts, counts: tuple[int, int] = (9, 361)) -> Extent:
    """Sizes on a lattice of points; curvature and thickness at each, (points,)."""
    a0, a1 = np.real(np.array(shell.chart.bounds[0]))
    at = sampled(shell, np.linspace(a0, a1, counts[0]), counts[1])
    lengths = [np.linalg.norm(np.diff(at.x, axis=k), axis=0).sum(axis=k - 1) for k in (1, 2)]
    diagonal, sides = float(np.linalg.norm(np.ptp(at.x, axis=(1, 2)))), np.array([own.max() for own in lengths])
    return Extent(diagonal, sides, at.curvature, at.thickness)


def check_wall(shell: ShellParts) -> None:
    """Refuse a wall as thick as its radius of curvature, or as the structure is long and wide."""
    size = extent(shell)
    bent = float((size.thickness * size.curvature).max())
    if bent > 1.0 + 1e-9:  # a fillet of the wall's thickness stands for a corner
        raise ModelError("shell-thickness-size", f"the wall is {bent:.3g} times its smallest radius of curvature")
    short = sampled(shell, stretches(shell))
    bent = float((short.thickness * short.curvature).max())
    if bent > FOLDED + 1e-9:
        raise ModelError("shell-thickness-size", f"the wall is {bent:.3g} times the radius of a bend, and folds there")
    thickest = float(size.thickness.max())
    if thickest >= (longest := size.sides.max()):
        found = f"the wall is {thickest:.3g} m thick on a surface {longest:.3g} m long"
        raise ModelError("shell-thickness-size", found)
