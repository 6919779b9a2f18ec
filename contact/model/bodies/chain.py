"""Rods, masses and walls on one axis, assembled into a chain of nodes with contacts between neighbours."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, Indices, readonly, require_finite
from contact.base.errors import InputError
from contact.model.bodies.body import Body
from contact.model.bodies.linear import Forcing, LinearBody, Part
from contact.model.rate import Rate


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
    in_order: ClassVar[bool] = True  # its matrices are bands as they are

    @property
    def crossing_time(self) -> float:
        """Shortest time of a wave through an element [s], infinite when there is no rod."""
        return min(body.crossing_time for body in self.bodies)

    def rates(self) -> tuple[Rate, ...]:
        """Rates of all bodies under the names of a scene file: mass[1], rod[2], numbered in the order given."""
        found: list[Rate] = []
        count: Counter[str] = Counter()
        for _, body in sorted(zip(self.numbers, self.bodies, strict=True), key=lambda pair: pair[0]):
            kind = type(body).__name__.lower().removeprefix("point")
            count[kind] += 1
            found += body.rates(f"{kind}[{count[kind]}]")
        return tuple(found)

    @property
    def load_response(self) -> float:
        """f^T M^-1 f of the constant loads [J/s^2]."""
        return float(np.sum(self.load**2 * self.inverse_mass))

    def linear_form(self) -> LinearBody:
        """M, C, K, Q and gap0: one coordinate for each node; fixed nodes get unit mass and no stiffness.

        >>> from contact.model.bodies.body import Rod, Wall
        >>> body = assemble([Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=2, x=0.5), Wall(x=0.0)]).linear_form()
        >>> body.size, body.gap0.tolist(), body.M.diagonal().tolist()
        (4, [0.5], [1.0, 0.25, 0.5, 0.25])
        """
        from scipy.sparse import csr_array, diags_array

        n = self.mass.size
        free = self.inverse_mass > 0.0
        mass = np.where(free, self.mass, 1.0)
        between = np.where(free[:-1] & free[1:], self.stiffness, 0.0)
        diagonal = np.where(free, _sums(self), 0.0)
        K = diags_array([-between, diagonal, -between], offsets=[-1, 0, 1], shape=(n, n)).tocsr()
        left, contacts = self.left, np.arange(self.left.size)
        values = np.concatenate([-1.0 * free[left], 1.0 * free[left + 1]])
        Q = csr_array((values, (np.tile(contacts, 2), np.concatenate([left, left + 1]))), shape=(left.size, n))
        Q.eliminate_zeros()
        return LinearBody(
            M=mass, K=K, C=np.where(free, self.damping, 0.0), Q=Q, load=self.load, velocity=self.velocity,
            gap0=self.position[left + 1] - self.position[left], parts=_parts(self), forcing=_forcing(self),
            potential=self.potential,
        )  # fmt: skip


def assemble(bodies: Sequence[Body], *, gravity: float = 0.0) -> Chain:
    """Assemble a chain; x is height: `gravity` > 0 [m/s^2] pulls every body towards -x.

    Raises InputError if bodies overlap, no contact is possible, or a mass is between two bodies.

    >>> from contact.model.bodies.body import Rod, Wall
    >>> chain = assemble([Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=2, x=0.5), Wall(x=0.0)])
    >>> chain.mass.tolist(), chain.left.tolist()
    ([0.0, 0.25, 0.5, 0.25], [0])
    """
    require_finite(gravity=gravity)
    numbers = tuple(sorted(range(len(bodies)), key=lambda i: (bodies[i].x, bodies[i].end)))
    ordered = tuple(bodies[i] for i in numbers)
    _require_apart(ordered, numbers)
    parts = [body.nodes(has_left=i > 0, has_right=i < len(ordered) - 1) for i, body in enumerate(ordered)]
    position, mass, springs, ground, damping, stretch = (
        np.concatenate([getattr(part, name) for part in parts])
        for name in ("position", "mass", "springs", "ground", "damping", "stretch")
    )
    held: NDArray[np.bool_] = np.concatenate([part.held for part in parts])
    first = np.concatenate(([0], np.cumsum([part.mass.size for part in parts]))).astype(np.int64)
    inverse = np.where(held, 0.0, 1.0 / np.where(held, 1.0, mass))
    speed = np.repeat([body.velocity for body in ordered], np.diff(first))
    left = first[1:-1] - 1
    _require_contacts(ordered, numbers, inverse, left)
    return Chain(
        bodies=ordered, numbers=numbers, gravity=gravity, first=first,
        position=readonly(position), mass=readonly(mass), inverse_mass=readonly(inverse),
        stiffness=readonly(springs[:-1]), velocity=readonly(np.where(held, 0.0, speed)),
        ground=readonly(ground), damping=readonly(damping),
        load=readonly(np.where(held, 0.0, -gravity * mass - ground * stretch)), left=left,
        potential=float(np.sum(np.where(held, 0.0, gravity * mass * position + 0.5 * ground * stretch**2))),
    )  # fmt: skip


def _name(body: Body, number: int) -> str:
    return f"body {number + 1} ({type(body).__name__.lower()} at x = {body.x:g})"


def _require_apart(ordered: Sequence[Body], numbers: Sequence[int]) -> None:
    if len(ordered) < 2:
        raise InputError(f"bodies: found {len(ordered)}, expected at least two, or one and a wall")
    for i in range(len(ordered) - 1):
        end, start = ordered[i].end, ordered[i + 1].x
        if start < end:
            a, b = _name(ordered[i], numbers[i]), _name(ordered[i + 1], numbers[i + 1])
            raise InputError(f"x: {a} and {b} overlap by {end - start:g} m, expected a gap >= 0")


def _require_contacts(ordered: Sequence[Body], numbers: Sequence[int], inverse: Array, left: Indices) -> None:
    """Raise InputError for a pair of neighbours that are both fixed."""
    for i, node in enumerate(left.tolist()):
        if inverse[node] == 0.0 and inverse[node + 1] == 0.0:
            a, b = _name(ordered[i], numbers[i]), _name(ordered[i + 1], numbers[i + 1])
            raise InputError(
                f"bodies: found fixed ends on both sides of the gap between {a} and {b} (`fixed`, or a wall), expected "
                "one that moves: free one end, or remove one body"
            )


def _sums(chain: Chain) -> Array:
    total = chain.ground.copy()
    total[:-1] += chain.stiffness
    total[1:] += chain.stiffness
    return total


def _parts(chain: Chain) -> tuple[Part, ...]:
    first = chain.first.tolist()
    return tuple(
        Part(
            name=f"{type(body).__name__.lower()} {number + 1}", start=first[b], end=first[b + 1], number=number,
            rigid=body.moves,
        )
        for b, (body, number) in enumerate(zip(chain.bodies, chain.numbers, strict=True))
    )  # fmt: skip


def _wave(omega: float, phase: float, time: Array) -> Array:
    return np.asarray(np.cos(omega * time + phase))


def _forcing(chain: Chain) -> tuple[Forcing, ...]:
    found = []
    for b, body in enumerate(chain.bodies):
        if body.force:
            shape = np.zeros(chain.mass.size)
            shape[chain.first[b]] = body.force
            omega = 2.0 * np.pi * body.force_hz
            found.append(Forcing(shape=shape, amplitude=partial(_wave, omega, np.radians(body.force_deg))))
    return tuple(found)
