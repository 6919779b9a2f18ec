"""Central differences with exact modal coefficients (Gautschi form), residual compliance and one contact.

D* = al D - be q + c f;  g* = g_0(t+h) + Q(t+h)(q + D*);  H_d = Q(t+h) diag(c) W(t), W = Q - mu sgn(v_t) T;
 forward:  (H_d + S) force = -g*                          (Carpenter's law with S; safe down to S = 0)
 averaged: (H_d/4 + S) force = -(g*/4 + g_n/2 + g_{n-1}/4)   (second order; rho = H_d/S <= 1)
then D = D* + c W force, q += D. g_n is the gap of q alone, without S force.

A rod of 50 modes loses 1 % of its energy per impact with the forward law. With the averaged law the error is 4e-4 at
rho = .64 and 3e-5 at rho = .04, of either sign. After a shock the massless end vibrates on S, so use impulses and
windowed forces. Limits that are checked: omega_max h <= 2.5 (there is a step resonance at pi; put higher modes into S),
rho <= 1 for the averaged law, n_max Omega h <= .3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from operator import itemgetter
from typing import Literal, cast

import numpy as np

from contact.base.arrays import require_positive
from contact.base.errors import InputError, LimitError, rounded_down
from contact.model.bodies.body_matrices import BodyMatrices
from contact.model.bodies.chain import Chain
from contact.model.bodies.patch import Patch
from contact.model.gaps.gap import PointGap, RotatingRim
from contact.model.gaps.modal_system import ModalSystem, point_system
from contact.model.gaps.rod_modes import chain_gap
from contact.model.gaps.rub import Rub, rub_of
from contact.model.gaps.rub_system import matrices_of, rub_system
from contact.model.law import Law
from contact.model.rotor.rotor import Rotor
from contact.scheme.modal.at_speeds import at_speeds
from contact.scheme.modal.modal_stepper import energy_stepper, modal_stepper
from contact.scheme.modal.patch_stepper import patch_stepper
from contact.scheme.modal.propagator import Propagator, propagator, step_of
from contact.scheme.modal.rub_delassus import rub_delassus
from contact.scheme.modal.rub_stepper import rub_stepper
from contact.scheme.protocol import Modal, Problem, Stepper
from contact.scheme.rotor.stepper import rotor_stepper

Numbers = tuple[float, float, float]
LAWS = ("auto", "forward", "averaged", "energy")
ABOVE = 1.2  # times the speed at the start: the highest speed of a rotor whose speed is unknown
SPINS = 64  # steps that it takes with the coefficients of one speed
AUTO_RHO = 0.1  # "auto" takes the averaged law up to here: beyond, long series of impacts gain energy


@dataclass(frozen=True, slots=True, kw_only=True)
class ExactModal:
    """Exact-modal scheme for modal bodies, or for two rods by their first `modes` modes.

    `law` "forward", "averaged" (refused when rho = H_d/S > 1), "auto" (averaged up to rho = .1, else forward; the
    result names it) or "energy", the discrete gradient of `energy_stepper`, for undamped fixed points. `omega_h_limit`
    is the largest omega_max h accepted by the first two, below pi. `skip`: with one tip on a rim, skip time in which no
    contact is possible, from one stored step to the next (`contact.scheme.modal.free_flight`).

    >>> ExactModal(law="averaged").modes
    50
    """

    law: Literal["auto", "forward", "averaged", "energy"] = "auto"
    modes: int = 50
    omega_h_limit: float = 2.5
    skip: bool = True

    def __post_init__(self) -> None:
        if self.law not in LAWS:
            raise InputError(f"law: found {self.law!r}, expected one of {', '.join(map(repr, LAWS))}")
        if not 0.0 < self.omega_h_limit < 3.1:
            raise InputError(f"omega_h_limit: found {self.omega_h_limit!r}, expected between 0 and 3.1 (below pi)")
        require_positive(modes=self.modes)

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> Stepper:
        """Convert the scene to modal form and check the limits; raises InputError, LimitError.

        `courant` means omega_max h/2, as for central differences; with neither, omega_max h = .8.
        """
        if law.updates > 0:
            expected = "Unilateral(), Coulomb(mu=...), Abradable(...) or a law with a response for ExactModal"
            raise InputError(f"law: found {law!r}, expected {expected}")
        if law.coating is not None and not isinstance(problem, RotatingRim | Rub):
            raise InputError(f"law: found Abradable on {type(problem).__name__}, expected a RotatingRim or a Rub")
        return _prepared(problem, self, law, dt, courant)

    def one_contact(self, system: ModalSystem, law: Law, dt: float | None, courant: float | None) -> Stepper:
        """Stepper for one contact in modal form."""
        mu = law.mu
        if mu > 0.0:
            raise InputError("law: found Coulomb friction on a scene without tangential motion, expected a rim")
        h = step_of(float(system.omega.max(initial=0.0)), dt, courant)
        parts = propagator(system.omega, system.zeta, system.load, h)
        if self.law == "energy":
            if law.response is not None:
                raise InputError(
                    f"law: found {law.words} with law = 'energy', expected 'auto', 'averaged' or 'forward'"
                )
            return energy_stepper(system, parts)
        self._require_slow(parts.top, h)
        H, S, rho = _delassus(system, parts)
        averaged = self._averaged(H, S, rho) if law.response is None else self.law != "forward"
        top = float(system.omega.max(initial=0.0))
        chosen = "averaged" if averaged else "forward"
        reached = f"dt omega_max = {h * top:.3g} (limit {self.omega_h_limit:g}), rho = {rho:.3g}"
        label = f"exact modal, {chosen} law, {reached}"
        return modal_stepper(system, parts, averaged=averaged, law=law, label=label)

    def patch(self, problem: Patch, law: Law, dt: float | None, courant: float | None) -> Stepper:
        """Stepper for several contacts of one body."""
        mu, gives_way = law.mu, law.response is not None
        if self.law == "energy" or (self.law == "averaged" and not gives_way):
            raise InputError(f"law: found {self.law!r} with several contacts, expected 'forward' or 'auto'")
        if mu > 0.0 and problem.dimensions == 1:
            found = "Coulomb friction on a Patch without tangent"
            raise InputError(f"law: found {found}, expected tangent channels")
        body, load = problem.body, np.asarray(problem.load)
        still = BodyMatrices.of_one(body)
        speeds = at_speeds(still, body.omega, body.zeta, load, 0.0, 0.0, 0.0, lambda top: step_of(top, dt, courant))
        parts = speeds.parts[0]
        h = parts.h
        self._require_slow(parts.top, h)
        reached = f"dt omega_max = {h * parts.top:.3g} (limit {self.omega_h_limit:g})"
        averaged = gives_way and self.law != "forward"
        label = f"exact modal, {'averaged' if averaged else 'forward'} law in every contact, {reached}"
        return patch_stepper(problem, speeds, law, label, averaged=averaged)

    def rub(
        self, rub: Rub, law: Law, dt: float | None, courant: float | None, rim: RotatingRim | None = None
    ) -> Stepper:
        """Stepper for tips at a rotating rim.

        `rim` is the same scene in the form in which several runs may share steps.
        """
        if self.law == "energy":
            raise InputError("law: found 'energy' on a rotating rim, expected 'auto', 'forward' or 'averaged'")
        mu = law.mu
        dimensions = rub.dimensions if mu > 0.0 else 1
        system = rub_system(rub, dimensions)
        low, high = (2.0 * math.pi * float(f(rub.speed.hz)) for f in (np.min, np.max))
        fastest = float(np.abs(rub.speed.table[:, 3]).max())
        if rub.spin is not None:  # unknown beforehand: from standstill to a fifth above the start
            start, most = rub.speed.omega(0.0), rub.spin.most_hz
            top = ABOVE * start if most is None else math.copysign(2.0 * math.pi * most, start)
            low, high = sorted((0.0, top))
        speeds = at_speeds(
            system.matrices, system.omega, system.zeta, system.load, low, high, fastest,
            lambda top: step_of(top, dt, courant),
        )  # fmt: skip
        if rub.spin is not None:
            speeds = replace(speeds, stretch=SPINS)
        h = speeds.parts[0].h
        self._require_slow(speeds.top, h)
        n_max = max([system.rim.n_max, *(p for p, _, _ in rub.profile.terms)])
        _require_slow_turn(n_max, rub.speed.fastest, h)
        H, S, rho = max((rub_delassus(rub, system, part, mu) for part in speeds.parts), key=itemgetter(2))
        averaged = self._averaged(H, S, rho) if law.response is None else self.law != "forward"
        top = h * speeds.top
        label = (
            f"exact modal, {'averaged' if averaged else 'forward'} law at {system.contacts} "
            f"{'tip' if system.contacts == 1 else 'tips'}, dt omega_max = "
            f"{top:.3g} (limit {self.omega_h_limit:g}), n_max Omega dt = {n_max * rub.speed.fastest * h:.3g} "
            f"(limit 0.3), rho = {rho:.3g}"
        )
        return rub_stepper(
            rub, system, speeds, law=law, dimensions=dimensions, averaged=averaged, label=label, stiffest=H,
            skip=self.skip, rim=rim,
        )  # fmt: skip

    def _averaged(self, H: float, S: float, rho: float) -> bool:
        """Whether to use the averaged law; raises LimitError if it is requested and unstable."""
        averaged = self.law == "averaged" or (self.law == "auto" and rho <= AUTO_RHO)
        if averaged and rho > 1.0:
            raise LimitError(
                f"law: found rho = H_d/S = {rho:.4g} (H_d = {H:.4g}, S = {S:.4g} m/N), expected <= 1 for the "
                f"averaged law: reduce dt (H_d falls as dt^2), keep fewer modes, or use law = 'forward'"
            )
        return averaged

    def _require_slow(self, top: float, h: float) -> None:
        if h * top > self.omega_h_limit * (1.0 + 1e-12):
            raise LimitError(
                f"dt: found omega_max dt = {h * top:.6g}, expected <= {self.omega_h_limit:g} (step "
                f"resonance at pi): use dt <= {rounded_down(self.omega_h_limit / top, 4)} s, or keep modes up to "
                f"{rounded_down(self.omega_h_limit / h, 5)} rad/s (ModalBody.truncated)"
            )


def _require_slow_turn(n_max: int, speed: float, h: float) -> None:
    angle = n_max * abs(speed) * h
    if angle > 0.3:
        found = f"n_max Omega dt = {angle:.4g} rad with n_max = {n_max}"
        raise LimitError(f"dt: found {found}, expected <= 0.3: use dt <= {rounded_down(0.3 * h / angle, 4)} s")


def _delassus(system: ModalSystem, parts: Propagator) -> Numbers:
    """H_d, S and rho = H_d/S of a fixed contact point (rho = inf if S is 0)."""
    H, S = float(parts.c @ system.Q**2), system.S_nn(0.0)
    if H + S <= 0.0:
        raise LimitError(
            f"law: found H_d + S = {H + S:.4g} m/N, expected > 0, otherwise no force opens the gap: reduce dt"
        )
    return H, S, H / S if S > 0.0 else math.inf


def _prepared(problem: Problem, scheme: ExactModal, law: Law, dt: float | None, courant: float | None) -> Stepper:
    if isinstance(problem, Patch):
        return scheme.patch(problem, law, dt, courant)
    if isinstance(problem, Rotor):
        return rotor_stepper(problem, law, step_of(float(problem.body.omega.max(initial=0.0)), dt, courant))
    if isinstance(problem, Rub):
        return scheme.rub(problem, law, dt, courant)
    if isinstance(problem, RotatingRim):
        rub = rub_of(problem)
        alone = matrices_of(rub).coupled or law.response is not None or law.coating is not None
        return scheme.rub(rub, law, dt, courant, rim=None if alone else problem)
    return scheme.one_contact(_system(problem, scheme.modes), law, dt, courant)


def _system(problem: Problem, modes: int) -> ModalSystem:
    if isinstance(problem, PointGap):
        return _gap_system(problem)
    if isinstance(problem, Chain):
        return point_system(chain_gap(problem, modes=modes))
    if not hasattr(problem, "modal_form"):
        name = type(problem).__name__
        raise InputError(f"scheme: found ExactModal for {name}, expected another scheme, such as CentralDifference")
    return cast(Modal, problem).modal_form(modes)


def _gap_system(problem: PointGap) -> ModalSystem:
    for side in problem.sides:
        if BodyMatrices.of_one(side.body).coupled:
            found = f"coupled modes of {side.name} (by damping or stiffness)"
            raise InputError(f"sides: found {found}, expected uncoupled modes at a PointGap: use a Patch of that body")
    return point_system(problem)
