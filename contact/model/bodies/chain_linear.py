"""A chain of rods and masses as a LinearBody; walls and fixed ends stay as coordinates that cannot move."""

from __future__ import annotations

from functools import partial

import numpy as np

from contact.base.arrays import Array
from contact.model.bodies.body import PointMass, Wall
from contact.model.bodies.chain import Chain
from contact.model.bodies.linear import Forcing, LinearBody, Part


def linear(chain: Chain) -> LinearBody:
    """M, C, K, Q and gap0 of a chain: one coordinate a node, held nodes with unit mass and no stiffness.

    >>> from contact.model.bodies.body import Rod
    >>> from contact.model.bodies.chain import assemble
    >>> body = linear(assemble([Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=2, x=0.5), Wall(x=0.0)]))
    >>> body.size, body.gap0.tolist(), body.M.diagonal().tolist()
    (4, [0.5], [1.0, 0.25, 0.5, 0.25])
    """
    from scipy.sparse import csr_array, diags_array

    n = chain.mass.size
    free = chain.inverse_mass > 0.0
    mass = np.where(free, chain.mass, 1.0)
    between = np.where(free[:-1] & free[1:], chain.stiffness, 0.0)
    diagonal = np.where(free, _sums(chain), 0.0)
    K = diags_array([-between, diagonal, -between], offsets=[-1, 0, 1], shape=(n, n)).tocsr()
    left, contacts = chain.left, np.arange(chain.left.size)
    values = np.concatenate([-1.0 * free[left], 1.0 * free[left + 1]])
    Q = csr_array((values, (np.tile(contacts, 2), np.concatenate([left, left + 1]))), shape=(left.size, n))
    Q.eliminate_zeros()
    return LinearBody(
        M=mass, K=K, C=np.where(free, chain.damping, 0.0), Q=Q, load=chain.load, velocity=chain.velocity,
        gap0=chain.position[left + 1] - chain.position[left], parts=_parts(chain), forcing=_forcing(chain),
        potential=chain.potential,
    )  # fmt: skip


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
            rigid=not isinstance(body, Wall),
        )
        for b, (body, number) in enumerate(zip(chain.bodies, chain.numbers, strict=True))
    )  # fmt: skip


def _wave(omega: float, phase: float, time: Array) -> Array:
    return np.asarray(np.cos(omega * time + phase))


def _forcing(chain: Chain) -> tuple[Forcing, ...]:
    found = []
    for b, body in enumerate(chain.bodies):
        if isinstance(body, PointMass) and body.force:
            shape = np.zeros(chain.mass.size)
            shape[chain.first[b]] = body.force
            omega = 2.0 * np.pi * body.force_hz
            found.append(Forcing(shape=shape, amplitude=partial(_wave, omega, np.radians(body.force_deg))))
    return tuple(found)
