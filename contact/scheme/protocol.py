"""Interface between `run` and a scheme: a numbered contract and two small protocols.

1. `Scheme.prepare` takes the physics and the law, checks its limits and raises LimitError with the numbers, or
   InputError for a law or scene that it does not support; it returns a Stepper at t = 0.
2. `Stepper.advance(out, first, steps)` takes whole steps first .. first + steps - 1 in one compiled call, fills `out`,
   adds to `sums`, and returns -1, or the step that failed.
3. The force of step n acts at the time of its sample: t_n = n h in leapfrog schemes, t_n + h/2 where it is the mean
   over the step, t_{n+1} where it balances the end of the step. It makes the law valid for the gap stored with it; for
   a law of velocities, `residual` is their violation times h.
4. `stored()` and `motions()` evaluate the current state without changing it.
5. The energies balance: change of stored energy = work of contact, damping and loads along the displacement + the gain
   of the scheme. With v_m, f_m means of the step's two ends, a one-step scheme moves by h v_m + s under the mean force
   f_m + Q^T force + delta; its gain is du.delta - s.M dv/h, from the formulas of s and delta.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Any, Protocol, runtime_checkable

import numpy as np

from contact.base.arrays import Array
from contact.io.trust import Flag
from contact.model.bodies.beam import BeamInCircle
from contact.model.bodies.linear_system import Linear
from contact.model.bodies.patch import Patch
from contact.model.gaps.gap import PointGap, RotatingRim
from contact.model.gaps.modal_system import ModalSystem
from contact.model.gaps.rub import Rub
from contact.model.law import Law
from contact.model.rotor.rotor import Rotor
from contact.record.energy import Stored
from contact.record.orbit import Orbit
from contact.record.record import Samples, Tally
from contact.record.spin import SpinBudget
from contact.record.wear import Wear


class Modal(Protocol):
    """Interface of your own gap for the exact-modal scheme."""

    def modal_form(self, modes: int) -> ModalSystem:
        """Modes and rows of one contact; `modes` of a continuous body."""


@runtime_checkable
class Loaded(Protocol):
    """Problem that states the motion due to its constant loads within a step; optional for a problem of your own."""

    @property
    def load_response(self) -> float:
        """f^T M^-1 f of the constant loads [J/s^2]; times h^2, the energy offset of a leapfrog scheme."""


Problem = Linear | Modal | PointGap | RotatingRim | BeamInCircle | Patch | Rub | Rotor


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Rigid part of one body's motion: `mean_velocity` [m/s], `momentum` [kg m/s]; NaN without one.

    `number` is the body's index in the user's list, `kind` mass | rod | casing | blade | body.

    >>> Motion(kind="mass", number=0, mean_velocity=0.5, momentum=1.0).momentum
    1.0
    """

    kind: str
    number: int
    mean_velocity: float
    momentum: float


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Notes:
    """Results of a run besides its forces.

    `flags`: where the run left the range of its theory; `heat` (K,) dissipated by slip and `drive` (K,) the work of the
    drive against friction [J]; None if the scheme does not sum them. `orbit` at the end of the run of a rotor; the
    largest `deflection` of a rim [m] if it exceeds half its wall, else 0; energy and momentum of the `spin` of a rotor
    whose speed follows from its torques.
    """

    flags: tuple[Flag, ...] = ()
    heat: Array = field(default_factory=lambda: np.zeros(0))
    drive: Array = field(default_factory=lambda: np.zeros(0))
    orbit: Orbit | None = None
    deflection: float = 0.0
    spin: SpinBudget | None = None


Block = tuple[str, int, int]


class Stepper(Protocol):
    """Interface of a run; see the module's contract.

    `PlainStepper` implements the last five functions for most schemes.

    >>> import contact as ct
    >>> mass = ct.LinearBody(M=[2.0], K=[[800.0]], Q=[[1.0]], gap0=[0.01], velocity=[-0.5])
    >>> stepper = ct.MoreauJean().prepare(mass, ct.Unilateral(), dt=1e-4, courant=None)
    >>> stepper.dt, stepper.size, round(stepper.stored().kinetic, 6)
    (0.0001, 1, 0.25)
    """

    @property
    def dt(self) -> float:
        """Time step [s]."""

    @property
    def label(self) -> str:
        """Scheme, law and limits in words."""

    @property
    def window(self) -> float:
        """Period of the highest frequency [s]: forces averaged over it converge, raw forces do not."""

    @property
    def sums(self) -> Tally:
        """Sums of all steps so far."""

    @property
    def size(self) -> int:
        """Number of coordinates."""

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Name, first coordinate and one past the last coordinate of each body."""

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; returns -1, or the step that failed."""

    @property
    def memory(self) -> tuple[Any, ...]:
        """Arrays that `advance` changes, in nested tuples; after restoring them a run continues with identical bits."""

    def why(self) -> Flag:
        """Explain a failed step, with its code."""

    def stored(self) -> Stored:
        """Energy now."""

    def motions(self) -> tuple[Motion, ...]:
        """Rigid motion of each body now."""

    @property
    def start(self) -> Stored:
        """Energy of the given state, evaluated before the first step."""

    @property
    def overlap(self) -> float:
        """Overlap of the bodies at t = 0 [m]."""

    @property
    def limits(self) -> Array | None:
        """Limits of `motion_limits`: `advance` stops after the step that passed one; None without limits."""

    def notes(self) -> Notes:
        """Results so far besides the forces."""

    def wear(self) -> tuple[Wear, ...]:
        """Wear of each track of a coating so far."""


class PlainStepper(ABC):
    """Base class for steppers without overlap, limits, notes and coating, whose `stored()` at t = 0 is exact.

    >>> class AtRest(PlainStepper):  # a run in which nothing moves
    ...     def stored(self) -> Stored:
    ...         return Stored(kinetic=0.0, strain=0.0, potential=0.0, residual=0.0, discrete=0.0)
    >>> AtRest().overlap, AtRest().limits, AtRest().start.total
    (0.0, None, 0.0)
    """

    __slots__ = ()

    @abstractmethod
    def stored(self) -> Stored:
        """Energy now."""

    @property
    def start(self) -> Stored:
        """Energy of the given state, evaluated before the first step."""
        return self.stored()

    @property
    def overlap(self) -> float:
        """Zero: bodies do not overlap at t = 0."""
        return 0.0

    @property
    def limits(self) -> Array | None:
        """None: no limits of motion."""
        return None

    def notes(self) -> Notes:
        """Empty: no results besides the forces."""
        return Notes()

    def wear(self) -> tuple[Wear, ...]:
        """Empty: no coating."""
        return ()


class Scheme(Protocol):
    """A time scheme: a frozen value that prepares runs.

    >>> import contact as ct
    >>> scheme: Scheme = ct.MoreauJean(theta=0.5)  # whatever has `prepare` is a scheme
    >>> callable(scheme.prepare)
    True
    """

    def prepare(self, problem: Problem, law: Law, *, dt: float | None, courant: float | None) -> Stepper:
        """Check the limits and return a Stepper at t = 0."""


def window(top: float, dt: float) -> float:
    """Period [s] of the highest mode `top` [rad/s]; the step if that is longer or there is no such mode.

    >>> window(100.0, 1e-3) == 2.0 * math.pi / 100.0, window(100.0, 0.1), window(0.0, 0.1)
    (True, 0.1, 0.1)
    """
    return max(2.0 * math.pi / top, dt) if top > 0.0 else dt
