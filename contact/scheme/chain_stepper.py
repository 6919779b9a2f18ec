"""Central differences on a chain: the state, step size and readings both contact laws share."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact.energy import Stored
from contact.errors import InputError, LimitError
from contact.model.arrays import require_positive
from contact.model.body import PointMass, Rod
from contact.model.chain import Chain
from contact.record import Samples, Tally, tally
from contact.scheme.protocol import Block, Motion

if TYPE_CHECKING:
    from contact.scheme.loop_chain import ChainState

Loop = Callable[["ChainState", Tally, Samples, float, int, int], int]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ChainStepper:
    """M (u_{n+1} - 2 u_n + u_{n-1})/h^2 + K u_n = f + Q^T force_n with lumped M."""

    chain: Chain
    state: ChainState
    sums: Tally
    loop: Loop
    dt: float
    window: float
    label: str

    @property
    def size(self) -> int:
        """Number of nodes."""
        return self.state.u.size

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Nodes of each body, from left to right."""
        names = [
            f"{type(body).__name__.lower()} {n + 1}"
            for body, n in zip(self.chain.bodies, self.chain.numbers, strict=True)
        ]
        first = self.chain.first.tolist()
        return tuple(zip(names, first[:-1], first[1:], strict=True))

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; -1, or the step that failed."""
        return self.loop(self.state, self.sums, out, self.dt, first, steps)

    def why(self) -> str:
        """Explain a failed step: an explicit scheme within its limit fails only on NaN."""
        return "the gap is not a number"

    def stored(self) -> Stored:
        """Discrete energy v^T M v/2 + u_{n-1}^T K u_n/2 and the potential of the load at the half step."""
        c, u, d = self.chain, self.state.u, self.state.d
        old = u - d
        kinetic = 0.5 * float(np.sum(c.mass * (d / self.dt) ** 2))
        strain = 0.5 * float(np.sum(c.stiffness * np.diff(old) * np.diff(u)))
        potential = -float(c.load @ (c.position + 0.5 * (u + old)))
        total = kinetic + strain + potential
        return Stored(kinetic=kinetic, strain=strain, potential=potential, residual=0.0, discrete=total)

    def motions(self) -> tuple[Motion, ...]:
        """Momentum and mean velocity of rods and masses, at the half step."""
        found = []
        for b, body in enumerate(self.chain.bodies):
            if isinstance(body, Rod | PointMass):
                nodes = slice(int(self.chain.first[b]), int(self.chain.first[b + 1]))
                mass = self.chain.mass[nodes]
                momentum = float(mass @ self.state.d[nodes]) / self.dt
                kind = "rod" if isinstance(body, Rod) else "mass"
                speed = momentum / float(mass.sum())
                found.append(Motion(kind=kind, number=self.chain.numbers[b], mean_velocity=speed, momentum=momentum))
        return tuple(found)


def chain_state(chain: Chain, h: float) -> ChainState:
    """State at t = 0, with D chosen so that u_1 = u_0 + h v_0 + h^2 a_0/2 (second order)."""
    from contact.scheme.loop_chain import ChainState

    rate = h * h * chain.inverse_mass
    d = h * chain.velocity - 0.5 * rate * chain.load
    n, contacts = chain.mass.size, chain.left.size
    return ChainState(
        u=np.zeros(n), d=d, spring=np.zeros(n + 1), stiffness=chain.stiffness, rate=rate, load=chain.load,
        left=chain.left, clearance=chain.position[chain.left + 1] - chain.position[chain.left],
        force=np.zeros(contacts), gap=np.zeros(contacts), before=np.zeros(contacts),
    )  # fmt: skip


def chain_step(chain: Chain, dt: float | None, courant: float | None, *, contact_stiffness: float = 0.0) -> float:
    """Time step from `dt`, or `courant` times the crossing time of the smallest element.

    Raises LimitError beyond h omega_max = 2, the stability limit of central differences.
    """
    if (dt is None) == (courant is None):
        raise InputError("dt: found both or neither of dt and courant, expected one of them")
    if dt is not None:
        require_positive(dt=dt)
        h = dt
    else:
        assert courant is not None
        require_positive(courant=courant)
        if math.isinf(chain.crossing_time):
            raise InputError("courant: found a scene without rods, expected dt")
        h = courant * chain.crossing_time
    product = h * chain.omega_max(contact_stiffness)
    if product > 2.0 * (1.0 + 1e-9):
        raise LimitError(
            f"dt: found {h:.6g} s, dt * omega_max = {product:.4g}, expected <= 2 (stability of central "
            f"differences): take dt <= {2.0 * h / product:.6g} s"
        )
    return h


def prepare_chain(chain: Chain, loop: Loop, h: float, omega_max: float, label: str) -> ChainStepper:
    """Stepper at t = 0."""
    window = 2.0 * math.pi / omega_max if omega_max > 0.0 else h
    return ChainStepper(
        chain=chain, state=chain_state(chain, h), sums=tally(chain.left.size), loop=loop, dt=h,
        window=max(window, h), label=label,
    )  # fmt: skip


def require_chain(problem: object, scheme: str) -> Chain:
    """Return the chain, or raise InputError that says what this scheme is for."""
    if not isinstance(problem, Chain):
        raise InputError(f"scheme: found {scheme} for {type(problem).__name__}, expected ExactModal (it is for rods)")
    return problem
