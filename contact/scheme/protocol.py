"""Interface between `run` and a scheme: a numbered contract and two small protocols.

1. `Scheme.prepare` takes the physics and the law, checks its limits and refuses with numbers (LimitError) or
   an InputError when law or scene are not its own; it returns a Stepper at t = 0.
2. `Stepper.advance(out, first, steps)` takes whole steps first .. first + steps - 1 in one compiled call, fills
   `out`, adds to `sums`, and returns -1, or the step that failed.
3. The force of step n acts at the time of its sample: t_n = n h in leapfrog schemes, t_n + h/2 where it is the
   mean over the step, t_{n+1} where it balances the end of the step. It makes the law valid for the gap stored
   beside it; where the law is one of velocities, `residual` is theirs times h.
4. `stored()` and `motions()` read the present state and change nothing.
5. The energy ledger closes: change of stored energy = work of contact, damping and loads along the displacement +
   the scheme's own gain. With v_m, f_m means of the step's two ends, a one-step scheme moves by h v_m + s under
   the mean force f_m + Q^T force + delta; its own gain is du.delta - s.M dv/h, from the formulas of s and delta.
"""

from __future__ import annotations

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
    """A problem that gives how far its constant loads move it within a step; optional for a problem of one's own."""

    @property
    def load_response(self) -> float:
        """f^T M^-1 f of the constant loads [J/s^2]: times h^2, what the energy of a leapfrog scheme is off by."""


Problem = Linear | Modal | PointGap | RotatingRim | BeamInCircle | Patch | Rub | Rotor


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Rigid part of one body's motion: `mean_velocity` [m/s], `momentum` [kg m/s]; NaN where it has none.

    `number` is the body's place in the user's list, `kind` mass | rod | casing | blade | body.

    >>> Motion(kind="mass", number=0, mean_velocity=0.5, momentum=1.0).momentum
    1.0
    """

    kind: str
    number: int
    mean_velocity: float
    momentum: float


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Notes:
    """Notes of a run beside its forces.

    `flags`: where it left the range of its theory, in words and numbers; `heat` (K,) dissipated by slip and `drive`
    (K,) the work of whatever turns the rim against friction [J]; none where the scheme does not sum them. `orbit` with
    which the run of a rotor ends; the largest `deflection` of a rim [m] where it is beyond half its wall, else 0;
    energy and momentum of the `spin` of a rotor whose speed follows from its torques.
    """

    flags: tuple[Flag, ...] = ()
    heat: Array = field(default_factory=lambda: np.zeros(0))
    drive: Array = field(default_factory=lambda: np.zeros(0))
    orbit: Orbit | None = None
    deflection: float = 0.0
    spin: SpinBudget | None = None


Block = tuple[str, int, int]


class Stepper(Protocol):
    """A run in progress; see the module's contract. `PlainStepper` answers the last five for most schemes.

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
        """Period of the highest frequency [s]: forces averaged over it converge, raw ones do not."""

    @property
    def sums(self) -> Tally:
        """Sums of all steps so far."""

    @property
    def size(self) -> int:
        """Number of coordinates."""

    @property
    def blocks(self) -> tuple[Block, ...]:
        """Name, first and one past the last coordinate of each body."""

    def advance(self, out: Samples, first: int, steps: int) -> int:
        """Advance by whole steps; -1, or the step that failed."""

    @property
    def memory(self) -> tuple[Any, ...]:
        """Arrays that `advance` changes, in tuples of any depth: written back, a run goes on to the same bits."""

    def why(self) -> Flag:
        """Explain a failed step, with its code."""

    def stored(self) -> Stored:
        """Energy now."""

    def motions(self) -> tuple[Motion, ...]:
        """Rigid motion of each body now."""

    @property
    def start(self) -> Stored:
        """Energy of the given state, read before the first step."""

    @property
    def overlap(self) -> float:
        """Overlap of the bodies at t = 0 [m]."""

    @property
    def limits(self) -> Array | None:
        """Those of `motion_limits`: `advance` stops after the step that passed one; None without limits."""

    def notes(self) -> Notes:
        """Notes on the run so far, beside its forces."""

    def wear(self) -> tuple[Wear, ...]:
        """Wear of each track of a coating so far."""


class PlainStepper(ABC):
    """A base for steppers without overlap, limits, notes and coating, whose `stored()` at t = 0 is exact.

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
        """Energy of the given state, read before the first step."""
        return self.stored()

    @property
    def overlap(self) -> float:
        """Bodies do not overlap at t = 0."""
        return 0.0

    @property
    def limits(self) -> Array | None:
        """No limits of motion."""
        return None

    def notes(self) -> Notes:
        """Nothing beside the forces."""
        return Notes()

    def wear(self) -> tuple[Wear, ...]:
        """No coating."""
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
