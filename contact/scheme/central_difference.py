"""Central differences with forward increment Lagrange multipliers, on rods with lumped mass.

M (u_{n+1} - 2 u_n + u_{n-1})/h^2 + K u_n = f + Q^T force_n,  g(u_{n+1}) >= 0, force_n >= 0, complementary
(Carpenter, Taylor, Katona, Int. J. Numer. Meth. Eng. 32, 1991, 103). One scalar per contact:
force = -g*/(h^2/m_l + h^2/m_r), g* the gap of the free step. Explicit, h omega_max <= 2, second order in
smooth motion; no penetration; the nodes that meet lose the energy of their own mass at each impact, and the
first force is a spike that grows as 1/h.
"""

from __future__ import annotations

from dataclasses import dataclass

from contact.errors import InputError
from contact.model.law import Law, Unilateral
from contact.scheme.chain_stepper import ChainStepper, chain_step, prepare_chain, require_chain
from contact.scheme.protocol import Problem


@dataclass(frozen=True, slots=True)
class CentralDifference:
    """Central differences + forward increment Lagrange multipliers (law: Unilateral).

    >>> CentralDifference()
    CentralDifference()
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> ChainStepper:
        """Check law and step; raises InputError, LimitError."""
        from contact.scheme.loop_chain import advance_lagrange

        chain = require_chain(problem, "CentralDifference")
        if not isinstance(law, Unilateral):
            raise InputError(f"law: found {law!r}, expected Unilateral() with CentralDifference")
        h = chain_step(chain, dt, courant)
        omega = chain.omega_max()
        label = f"central difference + forward Lagrange, dt omega_max = {h * omega:.3g} (limit 2)"
        return prepare_chain(chain, advance_lagrange, h, omega, label)
