"""Rods, masses and walls on one axis, assembled into a chain of nodes with contacts between neighbours."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, Indices, readonly, require_finite
from contact.base.errors import InputError
from contact.model.bodies.body import Body, PointMass, Rod, Wall


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Chain:
    """Nodes from left to right; body b owns nodes first[b] .. first[b+1]-1.

    m_i u_i'' = k_i (u_{i+1} - u_i) - k_{i-1} (u_i - u_{i-1}) + f_i;  contact j lies between node left[j]
    and the next one: g_j = x_{l+1} + u_{l+1} - x_l - u_l. Shapes: N nodes, N - 1 springs (zero between
    bodies), N springs and dashpots to the ground. Walls and fixed ends have `inverse_mass` zero. `potential` [J] is
    that of gravity and of stretched ground springs at t = 0.
    """

    bodies: tuple[Body, ...]
    numbers: tuple[int, ...]  # place of each body in the user's list
    gravity: float
    first: Indices
    position: Array
    mass: Array
    inverse_mass: Array
    stiffness: Array
    ground: Array
    damping: Array
    velocity: Array
    load: Array
    left: Indices
    potential: float

    @property
    def crossing_time(self) -> float:
        """Shortest time of a wave through an element [s], infinite when there is no rod."""
        return min((b.crossing_time for b in self.bodies if isinstance(b, Rod)), default=math.inf)


def assemble(bodies: Sequence[Body], *, gravity: float = 0.0) -> Chain:
    """Assemble a chain; x is height: `gravity` > 0 [m/s^2] pulls every body towards -x.

    Raises InputError when bodies overlap, when nothing can touch, or for a mass between two bodies.

    >>> chain = assemble([Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=2, x=0.5), Wall(x=0.0)])
    >>> chain.mass.tolist(), chain.left.tolist()
    ([0.0, 0.25, 0.5, 0.25], [0])
    """
    require_finite(gravity=gravity)
    numbers = tuple(sorted(range(len(bodies)), key=lambda i: (_extent(bodies[i])[0], _extent(bodies[i])[1])))
    ordered = tuple(bodies[i] for i in numbers)
    _require_apart(ordered, numbers)
    parts = [_nodes(body, has_left=i > 0, has_right=i < len(ordered) - 1) for i, body in enumerate(ordered)]
    position, mass, held, springs = (np.concatenate(column) for column in zip(*parts, strict=True))
    first = np.concatenate(([0], np.cumsum([part[0].size for part in parts]))).astype(np.int64)
    inverse = np.where(held, 0.0, 1.0 / np.where(held, 1.0, mass))
    speed = np.repeat([0.0 if isinstance(b, Wall) else b.velocity for b in ordered], np.diff(first))
    left = first[1:-1] - 1
    _require_contacts(ordered, numbers, inverse, left)
    ground, damping, stretch = _to_the_ground(ordered, mass, first)
    return Chain(
        bodies=ordered, numbers=numbers, gravity=gravity, first=first,
        position=readonly(position), mass=readonly(mass), inverse_mass=readonly(inverse),
        stiffness=readonly(springs[:-1]), velocity=readonly(np.where(held, 0.0, speed)),
        ground=readonly(ground), damping=readonly(damping),
        load=readonly(np.where(held, 0.0, -gravity * mass - ground * stretch)), left=left,
        potential=float(np.sum(np.where(held, 0.0, gravity * mass * position + 0.5 * ground * stretch**2))),
    )  # fmt: skip


def _to_the_ground(ordered: Sequence[Body], mass: Array, first: Indices) -> tuple[Array, Array, Array]:
    """Ground springs [N/m], dashpots [N s/m] and initial stretches [m] of all nodes."""
    ground, damping, stretch = np.zeros((3, mass.size))
    for b, body in enumerate(ordered):
        nodes = slice(int(first[b]), int(first[b + 1]))
        if isinstance(body, PointMass):
            ground[nodes], damping[nodes], stretch[nodes] = body.stiffness, body.damping, body.stretch
        elif isinstance(body, Rod):
            damping[nodes] = body.damping * mass[nodes]
    return ground, damping, stretch


def _extent(body: Body) -> tuple[float, float]:
    return (body.x, body.x + body.length) if isinstance(body, Rod) else (body.x, body.x)


def _name(body: Body, number: int) -> str:
    return f"body {number + 1} ({type(body).__name__.lower()} at x = {body.x:g})"


def _require_apart(ordered: Sequence[Body], numbers: Sequence[int]) -> None:
    if len(ordered) < 2:
        raise InputError(f"bodies: found {len(ordered)}, expected at least two, or one and a wall")
    for i in range(len(ordered) - 1):
        end, start = _extent(ordered[i])[1], _extent(ordered[i + 1])[0]
        if start < end:
            a, b = _name(ordered[i], numbers[i]), _name(ordered[i + 1], numbers[i + 1])
            raise InputError(f"x: {a} and {b} overlap by {end - start:g} m, expected a gap >= 0")


def _require_contacts(ordered: Sequence[Body], numbers: Sequence[int], inverse: Array, left: Indices) -> None:
    """Every pair of neighbours must have a side that moves."""
    for i, node in enumerate(left.tolist()):
        if inverse[node] == 0.0 and inverse[node + 1] == 0.0:
            a, b = _name(ordered[i], numbers[i]), _name(ordered[i + 1], numbers[i + 1])
            raise InputError(
                f"bodies: nothing can touch between {a} and {b}: both ends are held (`fixed`, or a wall); free one "
                "of them or leave one out"
            )


def _nodes(body: Body, *, has_left: bool, has_right: bool) -> tuple[Array, Array, NDArray[np.bool_], Array]:
    """Positions, masses, held flags and springs to the next node of one body."""
    if not isinstance(body, Rod):
        point = body.mass if isinstance(body, PointMass) else 0.0
        return np.array([body.x]), np.array([point]), np.array([point == 0.0]), np.zeros(1)
    n = body.elements
    mass = np.full(n + 1, body.mass / n)
    mass[[0, n]] *= 0.5
    if body.end_mass > 0.0:
        mass[0 if contact_end(body, has_left=has_left, has_right=has_right) == "left" else n] += body.end_mass
    held = np.zeros(n + 1, dtype=bool)
    if body.fixed != "none":
        held[0 if body.fixed == "left" else n] = True
    springs = np.full(n + 1, body.E * body.area * n / body.length)
    springs[n] = 0.0
    return body.x + body.length * np.arange(n + 1) / n, mass, held, springs


def contact_end(rod: Rod, *, has_left: bool, has_right: bool) -> str:
    """Return the end of a rod that carries its end mass: the free one, or the one that faces a neighbour."""
    if rod.fixed != "none":
        return "right" if rod.fixed == "left" else "left"
    if has_left and has_right:
        raise InputError("end_mass: found on a free rod between two bodies, expected a rod with one contact end")
    return "left" if has_left else "right"
