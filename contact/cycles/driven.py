"""A modal body under a harmonic force before unilateral contacts, as a piecewise linear motion that contacts switch."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from contact.base.arrays import Array, readonly, require_count, require_not_negative, require_positive
from contact.base.errors import InputError
from contact.cycles.known import Known
from contact.cycles.passage import Motion
from contact.cycles.switched import Drive, Forcing, Plant
from contact.model.bodies.patch import Patch

RIGID = 1e-6  # frequency over that of the force which represents a rigid mode: 4e-12 of its flight over a period
ANGLE = 0.5  # of the fastest vibration between two evaluations of the gaps [rad]
FEWEST, MOST = 128, 65536  # evaluations in a period
Parameter = Literal["freq_hz", "amplitude", "clearance"]


class Family(Protocol):
    """A family of periodically forced motions over one parameter."""

    @property
    def name(self) -> str:
        """Name of the parameter."""
        ...

    def at(self, value: float) -> tuple[Motion, float]:
        """The motion at a value of the parameter, and the period of its forcing [s]."""
        ...

    @property
    def channels(self) -> tuple[str, ...]:
        """Displacements [m] whose amplitude is reported."""
        ...

    @property
    def begin(self) -> Array:
        """State in which runs start."""
        ...


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class DrivenBody:
    """A modal body under amplitude cos(2 pi freq_hz t) [N] at one channel, before k contacts.

    q'' + C q' + K q = rows_d^T F cos + load + W^T lam,  gap = clearance + N q + S lam + lam/stiffness,
    W = N - mu s T, s the sign of the slip T q' - slide of each contact.

    `patch` names body, contacts, constant load and where runs start. A contact whose own S and 1/`stiffness` [N/m] are
    zero is rigid and its impacts have Newton's `restitution`; with 0 it stays closed until its force is zero. Friction
    `mu` needs one tangent for each contact and a ground that slides, fast enough that no slip changes its direction.
    `shown` are the channels whose amplitude is given, all by default. Raises InputError.

    >>> from contact.model.bodies.modal_body import ModalBody
    >>> mass = ModalBody(omega=[1.0], zeta=[0.025], channels=("x",), rows=[[-1.0]], S=[[0.0]])
    >>> driven = DrivenBody(patch=Patch(body=mass, normal=("x",), clearance=0.1), channel="x", amplitude=0.02,
    ...                     stiffness=100.0)
    >>> driven.over("freq_hz", freq_hz=0.2).name
    'freq_hz'
    """

    patch: Patch
    channel: str
    amplitude: float
    stiffness: ArrayLike = math.inf
    restitution: ArrayLike = 0.0
    mu: float = 0.0
    shown: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        k, body = self.patch.contacts, self.patch.body
        require_not_negative(amplitude=self.amplitude, mu=self.mu)
        if self.mu > 0.0 and (self.patch.dimensions != 2 or not np.all(np.asarray(self.patch.slide) != 0.0)):
            expected = "one tangent and a slide other than 0 for each contact; for other friction simulate with ct.run"
            raise InputError(f"mu: found friction, expected {expected}")
        for name in (self.channel, *self.shown):
            body.channel(name)
        stiffness = readonly(np.broadcast_to(np.asarray(self.stiffness, float), (k,)))
        restitution = readonly(np.broadcast_to(np.asarray(self.restitution, float), (k,)))
        if not np.all(stiffness > 0.0):
            raise InputError(f"stiffness: found {stiffness.min():g} N/m, expected > 0 (inf or no value: rigid)")
        if not np.all((restitution >= 0.0) & (restitution <= 1.0)):
            raise InputError(f"restitution: found {restitution.tolist()}, expected 0 to 1")
        object.__setattr__(self, "stiffness", stiffness)
        object.__setattr__(self, "restitution", restitution)
        object.__setattr__(self, "shown", self.shown or tuple(dict.fromkeys(body.channels)))
        S = self.compliance()
        soft = np.flatnonzero(np.diag(S) > 0.0)
        if soft.size < k and np.abs(S[np.diag(S) == 0.0]).max() > 0.0:
            raise InputError(
                "S: found a zero on the diagonal and non-zero entries in its row, expected a positive semidefinite "
                "matrix"
            )
        if soft.size and not np.linalg.eigvalsh((S + S.T)[np.ix_(soft, soft)])[0] > 1e-12 * np.diag(S).max():
            raise InputError(
                "S: found a singular compliance of the contacts, expected a positive definite one: give each a "
                "stiffness"
            )
        rigid = self.patch.rows()[:: self.patch.dimensions][np.diag(S) == 0.0]
        if len(rigid) and np.linalg.matrix_rank(rigid) < len(rigid):
            raise InputError(
                "normal: found linearly dependent rows of rigid contacts, expected a stiffness for each contact"
            )

    def pushes(self) -> Array:
        """Forces on the patch's rows by unit forces at each contact, normal and along the slide: (k dimensions, k)."""
        patch = self.patch
        found = np.zeros((patch.contacts * patch.dimensions, patch.contacts))
        found[:: patch.dimensions] = np.eye(patch.contacts)
        if self.mu > 0.0:
            found[1::2] = np.diag(self.mu * np.sign(np.asarray(patch.slide)[:, 0]))
        return found

    def compliance(self) -> Array:
        """Compliance of the contacts, (k, k) [m/N]: that of the body S, with friction, plus that of the obstacles."""
        own = self.patch.compliance()[:: self.patch.dimensions] @ self.pushes()
        return np.asarray(own + np.diag(1.0 / np.asarray(self.stiffness)))

    def over(self, name: Parameter, *, freq_hz: float, looks: int | None = None) -> ForcedFamily:
        """Motions over one parameter, the others unchanged; `freq_hz` is its value, or its neighbourhood if it varies.

        `looks` is the number of times in a period at which gaps are examined. It does not limit the accuracy of located
        events.
        """
        require_positive(freq_hz=freq_hz)
        if name not in ("freq_hz", "amplitude", "clearance"):
            raise InputError(f"name: found {name!r}, expected 'freq_hz', 'amplitude' or 'clearance'")
        if looks is not None:
            require_count(8, looks=looks)
        omega = self.patch.body.omega
        scale = readonly(np.where(omega > 0.0, omega, 2.0 * math.pi * freq_hz))
        plant = _plant(self, freq_hz, scale)
        return ForcedFamily(
            body=self, name=name, freq_hz=freq_hz, plant=plant, scale=scale, looks=looks, known=Known(plant),
            drive=_drive(self, scale, freq_hz),
        )  # fmt: skip


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ForcedFamily:
    """A driven body over its frequency [Hz], its force [N] or the clearance of all contacts [m]."""

    body: DrivenBody
    name: str
    freq_hz: float
    plant: Plant
    scale: Array  # of the velocities [rad/s]
    looks: int | None
    known: Known
    drive: Drive  # at `freq_hz`

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels whose amplitude is given."""
        return self.body.shown

    def at(self, value: float) -> tuple[Motion, float]:
        """Motion at a value of the parameter, and the period of the force [s]."""
        body, freq_hz = self.body, self.freq_hz
        if self.name == "freq_hz":
            freq_hz = value
            require_positive(freq_hz=freq_hz)
            same = self.drive
            drive = Drive(w=2.0 * math.pi * freq_hz, harmonics=same.harmonics, b=same.b, c=same.c, d=same.d)
        elif self.name == "amplitude":
            drive = _drive(replace(body, amplitude=value), self.scale, freq_hz)
        else:
            drive = _drive(replace(body, patch=replace(body.patch, clearance=value)), self.scale, freq_hz)
        period = 1.0 / freq_hz
        step = looks_of(period, self.plant.rate, self.looks)
        return Motion(plant=self.plant, drive=drive, step=step, known=self.known), period

    @property
    def begin(self) -> Array:
        """State in which runs start: that of the patch."""
        return self.state(np.asarray(self.body.patch.displacement), np.asarray(self.body.patch.velocity))

    def state(self, displacement: ArrayLike, velocity: ArrayLike) -> Array:
        """State of modal displacements and velocities, (2 m,)."""
        return np.concatenate([np.asarray(displacement, float), np.asarray(velocity, float) / self.scale])


def looks_of(period: float, rate: float, looks: int | None) -> float:
    """Time between samples of the gaps [s]: the given number in a period, by default from the fastest vibration."""
    return period / (looks or min(max(math.ceil(period * rate / ANGLE), FEWEST), MOST))


def _plant(body: DrivenBody, freq_hz: float, scale: Array) -> Plant:
    """The linear system: state (q, q'/scale), gaps, shown channels; rigid modes get a negligible frequency."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        plant = _unchecked(body, freq_hz, scale)
    if not all(np.isfinite(part).all() for part in (plant.A, plant.B, plant.D, plant.E, plant.rate)):
        raise InputError("body: found frequencies, shapes or compliances whose products overflow: check their units")
    return plant


def _unchecked(body: DrivenBody, freq_hz: float, scale: Array) -> Plant:
    modes, d = body.patch.body, body.patch.dimensions
    C, K = modes.without_rotation().matrices()  # a patch does not turn
    K += np.diag(np.where(modes.omega > 0.0, 0.0, RIGID * 2.0 * math.pi * freq_hz) ** 2)
    rows, pushes, S = body.patch.rows(), body.pushes(), body.compliance()
    N, W = rows[::d], pushes.T @ rows
    A = np.block([[np.zeros_like(K), np.diag(scale)], [-K / scale[:, None], -C * (scale / scale[:, None])]])
    soft = np.diag(S) > 0.0
    springs = (N[soft].T / np.diag(S)[soft]) @ W[soft]
    stiffest = float(np.linalg.norm(K, 2)) if np.isfinite(K).all() else math.inf
    held = stiffest + (float(np.linalg.norm(springs, 2)) if np.isfinite(springs).all() else math.inf)
    at = [modes.channel(name) for name in body.shown]
    moved = modes.S[np.ix_(at, body.patch.channels())] @ pushes  # by forces on the patch's rows
    D, T = modes.rows[at], rows[1::d] if body.mu > 0.0 else rows[:0]
    away = -np.sign(np.asarray(body.patch.slide))[: len(T)]  # the slip's
    return Plant(
        A=A, B=np.vstack([np.zeros_like(W.T), W.T / scale[:, None]]), C=np.hstack([N, np.zeros_like(N)]), S=S,
        D=np.block([[D, np.zeros_like(D)], [np.zeros_like(T), away * T * scale]]),
        E=np.vstack([moved, np.zeros((len(T), len(N)))]), restitution=np.asarray(body.restitution),
        rate=max(math.sqrt(held), 2.0 * math.pi * freq_hz), slips=tuple((i, len(D) + i) for i in range(len(T))),
        hidden=len(T),
    )  # fmt: skip


def _drive(body: DrivenBody, scale: Array, freq_hz: float) -> Drive:
    """Harmonic force F cos(w t) at a channel; the residual compliance adds its direct effect on gaps and channels."""
    modes, patch = body.patch.body, body.patch
    at, none = modes.channel(body.channel), np.zeros(scale.size)
    met, shown = patch.channels()[:: patch.dimensions], [modes.channel(name) for name in body.shown]
    slip = np.abs(np.asarray(patch.slide)[:, 0]) if body.mu > 0.0 else np.zeros(0)

    def periodic(rest: ArrayLike, wave: Array) -> Forcing:
        return Forcing(np.array(rest, dtype=float), (body.amplitude * wave[:, None]).astype(complex))

    return Drive(
        w=2.0 * math.pi * freq_hz, harmonics=np.ones(1),
        b=periodic(
            np.concatenate([none, np.asarray(patch.load) / scale]), np.concatenate([none, modes.rows[at] / scale])
        ),
        c=periodic(patch.opening, modes.S[met, at]),
        d=periodic(np.concatenate([np.zeros(len(shown)), slip]), np.concatenate([modes.S[shown, at], 0.0 * slip])),
    )  # fmt: skip
