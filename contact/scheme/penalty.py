"""Central differences with an explicit contact spring, on rods with lumped mass.

M (u_{n+1} - 2 u_n + u_{n-1})/h^2 + K u_n = f + Q^T force_n,  force_n = stiffness <-g(u_n)>. The spring
counts in the stability limit h omega_max <= 2, taken with every contact closed. The force error does not
fall with the mesh, and energy grows at the limit: kept for comparison.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from contact.errors import InputError
from contact.model.law import Law, Penalty
from contact.record import Samples, Tally
from contact.scheme.chain_stepper import ChainStepper, chain_step, prepare_chain, require_chain
from contact.scheme.protocol import Problem

if TYPE_CHECKING:
    from contact.scheme.loop_chain import ChainState


@dataclass(frozen=True, slots=True)
class PenaltyDifference:
    """Central differences + explicit penalty (law: Penalty).

    >>> PenaltyDifference()
    PenaltyDifference()
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> ChainStepper:
        """Check law and step, contact spring included; raises InputError, LimitError."""
        from contact.scheme.loop_chain import advance_penalty

        chain = require_chain(problem, "PenaltyDifference")
        if not isinstance(law, Penalty):
            raise InputError(f"law: found {law!r}, expected Penalty(stiffness=...) with PenaltyDifference")
        stiffness = law.stiffness
        h = chain_step(chain, dt, courant, contact_stiffness=stiffness)

        def loop(state: ChainState, sums: Tally, out: Samples, dt: float, first: int, steps: int) -> int:
            return advance_penalty(state, sums, out, dt, first, steps, stiffness)

        closed = h * chain.omega_max(stiffness)
        label = f"central difference + penalty {stiffness:.3g} N/m, dt omega_max closed = {closed:.3g} (limit 2)"
        return prepare_chain(chain, loop, h, chain.omega_max(), label)
