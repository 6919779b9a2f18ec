"""Meridians of several pieces: straight lines and arcs from point to point, with fillets where they meet at an angle.

In the plane of r and z a piece starts in a direction phi and has the curvature kappa, positive to the left,

    dr/ds = cos(phi + kappa s),   dz/ds = sin(phi + kappa s).

A fillet of radius rho is tangent to both pieces: its centre is at distance rho from each. For rho of the wall's
thickness and below, the bend acts as the rigid joint of two walls: the section keeps its angle, without a separate
joint in the theory. A corner without radius has no curvature to integrate and is refused.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, FloatArray
from casingfem.structure.geometry.revolved import MeridianPoints

SMOOTH = 1e-6  # rad: pieces whose directions differ by less meet without a corner
STEPS = 30  # of Newton's method for the centre of a fillet

Point = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A piece of a meridian: its end, its curvature, and its joint with the previous piece.

    Parameters
    ----------
    to
        Its end (r, z) [m].
    radius
        Radius of an arc of less than half a turn [m], positive if it bends to the left with r to the right and z up;
        None for a straight piece.
    fillet
        Radius of the corner at its start [m]; by default that of the meridian.

    >>> Piece(to=(0.5, 0.2)).radius is None
    True
    """

    to: Point
    radius: float | None = None
    fillet: float | None = None


class Bend(NamedTuple):
    """An arc or line of constant curvature: start (2,), direction there [rad], curvature [1/m], length [m]."""

    start: FloatArray
    phi: float
    kappa: float
    length: float

    def at(self, s: Array) -> MeridianPoints:
        """Radius, height and derivatives at s from its start."""
        half, turned = 0.5 * self.kappa * s, self.phi + self.kappa * s
        chord = s * np.sinc(half / np.pi)  # 2 sin(kappa s/2)/kappa
        c, d = np.cos(turned), np.sin(turned)
        r, z = self.start[0] + chord * np.cos(self.phi + half), self.start[1] + chord * np.sin(self.phi + half)
        return MeridianPoints(r, c, -self.kappa * d, z, d, self.kappa * c)

    @property
    def end(self) -> FloatArray:
        """End point, (2,)."""
        at = self.at(np.array(self.length))
        return np.array([at.r, at.z], dtype=float)

    def offset(self, x: FloatArray) -> tuple[float, FloatArray]:
        """Distance of a point to its left, and the direction of increase."""
        normal = np.array([-np.sin(self.phi), np.cos(self.phi)])
        if self.kappa == 0.0:
            return float((x - self.start) @ normal), normal
        away = x - self.start - normal / self.kappa
        size, sense = float(np.linalg.norm(away)), np.sign(self.kappa)
        return 1.0 / self.kappa - float(sense) * size, -sense * away / size

    def place(self, x: FloatArray) -> float:
        """Arc length of a point on it."""
        if self.kappa == 0.0:
            return float((x - self.start) @ [np.cos(self.phi), np.sin(self.phi)])
        chord = x - self.start
        turned = np.arctan2(chord[1], chord[0]) - self.phi  # half the turn
        return float(2.0 * ((turned + np.pi) % (2.0 * np.pi) - np.pi) / self.kappa)

    def between(self, first: float, last: float) -> "Bend":
        """The part between two arc lengths."""
        at = self.at(np.array(first))
        return Bend(np.array([at.r, at.z], dtype=float), self.phi + self.kappa * first, self.kappa, last - first)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PiecewiseMeridian:
    """Straight pieces and arcs from `start` on, as the profile of a `Revolved` chart.

    Parameters
    ----------
    start
        Start at the base (r, z) [m].
    pieces
        Pieces in order, up to the top.
    fillet
        Radius of the corners [m]; about the wall's thickness for two walls at an angle.

    Raises
    ------
    ModelError
        `meridian-pieces` for a corner without a fillet, a fillet that does not fit, or an arc that does not reach its
        end; `meridian-axis` if the meridian reaches the axis.

    Examples
    --------
    >>> drum = PiecewiseMeridian(start=(0.3, 0.0), pieces=(Piece(to=(0.3, 0.1)), Piece(to=(0.2, 0.2))), fillet=0.01)
    >>> len(drum.lines), round(drum.length, 4)
    (4, 0.241)
    """

    start: Point
    pieces: tuple[Piece, ...]
    fillet: float | None = None
    bends: tuple[Bend, ...] = field(init=False, repr=False)
    owners: tuple[tuple[float, float], ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "pieces", tuple(self.pieces))
        if not self.pieces:
            raise ModelError("meridian-pieces", "chart.piece: found none, expected one or more")
        own = unjoined(self.start, self.pieces)
        bends, owners = joined(own, [self.fillet if p.fillet is None else p.fillet for p in self.pieces])
        object.__setattr__(self, "bends", tuple(bends))
        object.__setattr__(self, "owners", tuple(owners))
        lowest = float(self.at(np.linspace(0.0, self.length, 721)).r.min())
        if lowest <= 1e-9 * self.length:
            first = self.start[0] <= lowest
            r, z = self.start if first else min(piece.to for piece in self.pieces)
            found = f"a radius of {lowest:.3g} m on the meridian, near {'start' if first else 'to'} = [{r:g}, {z:g}]"
            raise ModelError("meridian-axis", f"chart.piece: found {found}")

    @property
    def lines(self) -> FloatArray:
        """Arc lengths at which the curvature jumps."""
        return np.concatenate([[0.0], np.cumsum([bend.length for bend in self.bends])])

    @property
    def length(self) -> float:
        """End of s [m]."""
        return float(self.lines[-1])

    def at(self, s: Array) -> MeridianPoints:
        """Radius, height and their derivatives at s; at a jump, those of the following part."""
        s = np.asarray(s)
        lines = self.lines
        which = np.clip(np.searchsorted(lines, s, side="right") - 1, 0, len(self.bends) - 1)
        table = np.zeros((6, *s.shape))
        for k, bend in enumerate(self.bends):
            here = which == k
            table[:, here] = np.stack(bend.at(s[here] - lines[k]))
        return MeridianPoints(*table)


def unjoined(start: Point, pieces: Sequence[Piece]) -> list[Bend]:
    """The pieces from point to point, without fillets."""
    bends, here = [], np.array(start, dtype=float)
    for number, piece in enumerate(pieces, 1):
        chord = np.array(piece.to, dtype=float) - here
        size, phi = float(np.linalg.norm(chord)), float(np.arctan2(chord[1], chord[0]))
        if not (np.isfinite(size) and size > 0.0):
            found = f"found a piece of length 0 at [r, z] = {here.tolist()} m"
            raise ModelError("meridian-pieces", f"chart.piece[{number}]: {found}")
        if piece.radius is None:
            bends.append(Bend(here, phi, 0.0, size))
        elif not abs(piece.radius) > 0.5 * size:
            found = f"chart.piece[{number}].radius: found {piece.radius:g} m for an arc whose ends are {size:g} m apart"
            raise ModelError("meridian-pieces", found)
        else:
            half = float(np.arcsin(0.5 * size / piece.radius))
            bends.append(Bend(here, phi - half, 1.0 / piece.radius, 2.0 * half * piece.radius))
        here = np.array(piece.to, dtype=float)
    return bends


def joined(own: Sequence[Bend], fillets: Sequence[float | None]) -> tuple[list[Bend], list[tuple[float, float]]]:
    """Parts with their fillets, and the extent of each piece to the middles of its fillets."""
    first, last = [0.0] * len(own), [bend.length for bend in own]
    corners: dict[int, Bend] = {}
    for k in range(1, len(own)):
        turn = own[k].phi - own[k - 1].phi - own[k - 1].kappa * own[k - 1].length
        turn = float((turn + np.pi) % (2.0 * np.pi) - np.pi)
        if abs(turn) <= SMOOTH:
            continue
        rho = fillets[k]
        where = f"chart.piece[{k + 1}].fillet: found {'none' if rho is None else f'{rho:g} m'}"
        if rho is None or not rho > 0.0 or abs(turn) > np.pi - 0.1:
            raise ModelError("meridian-pieces", f"{where} at a corner of {np.degrees(abs(turn)):.3g} degrees")
        corners[k], last[k - 1], first[k] = fillet_between(own[k - 1], own[k], rho, turn, where)
    bends, owners = list[Bend](), list[tuple[float, float]]()
    reached = begun = 0.0
    for k, bend in enumerate(own):
        if not last[k] - first[k] > 0.0:
            left = f"chart.piece[{k + 1}]: found fillets that are longer than the piece of {bend.length:g} m"
            raise ModelError("meridian-pieces", left)
        bends.append(bend.between(first[k], last[k]))
        reached += bends[-1].length
        if k + 1 in corners:
            bends.append(corners[k + 1])
            reached += bends[-1].length
        ended = reached - (0.5 * bends[-1].length if k + 1 in corners else 0.0)
        owners.append((begun, ended))
        begun = ended
    return bends, owners


def fillet_between(one: Bend, other: Bend, rho: float, turn: float, where: str) -> tuple[Bend, float, float]:
    """The fillet of a corner, and its end points on both pieces."""
    side = float(np.sign(turn)) * rho
    end = one.end
    normals = [one.offset(end)[1], other.offset(end)[1]]
    centre = end + side * (normals[0] + normals[1]) / (1.0 + normals[0] @ normals[1])
    for _ in range(STEPS):
        distances, gradients = zip(*(bend.offset(centre) for bend in (one, other)), strict=True)
        step = np.linalg.solve(np.array(gradients), side - np.array(distances))
        centre = centre + step
        if np.linalg.norm(step) <= 1e-14 * one.length:
            break
    feet = [centre - side * bend.offset(centre)[1] for bend in (one, other)]
    leaves, reaches = one.place(feet[0]), other.place(feet[1])
    phi = one.phi + one.kappa * leaves
    swept = float((other.phi + other.kappa * reaches - phi + np.pi) % (2.0 * np.pi) - np.pi)
    if not (0.0 < leaves <= one.length and 0.0 <= reaches < other.length and swept * turn > 0.0):
        raise ModelError("meridian-pieces", f"{where}, expected a smaller radius, so that both pieces reach the fillet")
    return Bend(feet[0], phi, 1.0 / side, abs(swept) * rho), leaves, reaches
