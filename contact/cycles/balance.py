"""Periodic motions by harmonic balance: a second way to the orbits of `shooting`, for contacts that give way.

The gaps are series of H harmonics. The contacts' forces follow from the gaps in time and return as series (alternating
frequency/time: Cameron and Griffin, J. Appl. Mech. 56, 1989, 149), here without samples of the force. The modes are
eliminated, so that the unknowns are the harmonics of the gaps alone (Krack and Gross, Harmonic Balance for Nonlinear
Vibration Problems, 2019, 4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array, readonly, require_count, require_finite
from contact.base.errors import InputError, NumericsError
from contact.cycles.driven import Family
from contact.cycles.harmonics import (
    Pressed,
    Response,
    complexes,
    in_time,
    outputs,
    pressed,
    reals,
    response,
    samples_of,
)
from contact.cycles.orbit_series import gaps_of
from contact.cycles.passage import Motion
from contact.cycles.shooting import Orbit
from contact.cycles.switched import Complex
from contact.io.threads import with_one_thread

HARMONICS = 30
CLOSE = 1e-7  # of the gaps: Newton's last step; the error is of the order of its square
NEWTON = 25
HALVINGS = 3
STIFFER, LEAST = 3.0, 1.05  # factor of the contacts' stiffness between two steps from the motion without contact


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Balanced:
    """A periodic motion of H harmonics, an approximation of an orbit; its stability is not known.

    `y` (k, H + 1) are the harmonics of each gap less the compliance of its own contact, `force` (k, H + 1) those of the
    contacts' forces [N], `displacement` (H + 1,) those of each channel [m]: u = Re sum u_h e^{i h w t}, w = 2 pi over
    the period. `amplitude` max |u| [m] by channel; `x` the state at phase 0 of the forcing, a guess for `orbit`.

    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> one = ct.cycles.balance(driven.over("freq_hz", freq_hz=0.1), 0.1)
    >>> round(one.amplitude["x"], 4), one.harmonics, one.contacts
    (0.033, 30, 0)
    """

    name: str
    value: float
    period: float
    periods: int
    x: Array
    y: Complex
    force: Complex
    displacement: dict[str, Complex]
    amplitude: dict[str, float]
    iterations: int

    @property
    def harmonics(self) -> int:
        """Number of harmonics H."""
        return len(self.y[0]) - 1

    @property
    def contacts(self) -> int:
        """Number of contacts that touch during the period."""
        return len(np.flatnonzero(np.abs(self.force).max(axis=1)))

    def __repr__(self) -> str:
        size = ", ".join(f"{name} {value:.6g} m" for name, value in self.amplitude.items())
        return f"harmonic balance at {self.name} {self.value:.8g}, {self.harmonics} harmonics: {size}"


@with_one_thread
def balance(
    family: Family, value: float, *, harmonics: int = HARMONICS, guess: Balanced | Orbit | None = None, periods: int = 1
) -> Balanced:
    """The periodic motion at a value of the parameter by harmonic balance, with H = `harmonics` of the period.

    y_h = still_h + R_h lam_h for h = 0 to H, lam = max(0, -y/s) in time (Cameron and Griffin 1989). Here y is the gap
    less the spring of its own contact, of compliance s, and R the receptance of the body at the contacts. Newton's
    method starts from `guess`, a motion or an orbit. By default it starts from the motion without contact, and the
    contacts get stiffer step by step. The motion repeats after `periods` periods of the forcing, or as the guess does.
    The error of the amplitude falls at least as H^-3 once H exceeds the frequencies that the contacts excite.

    The result is approximate and says nothing of stability: `orbit(family, value, guess=found.x)` gives the orbit with
    its multipliers. Raises InputError for a rigid contact, or a forcing above the last harmonic; NumericsError where
    Newton's method finds no motion, or where friction would change its direction.

    >>> import contact as ct
    >>> mass = ct.ModalBody(omega=[1.0], zeta=[0.025], channels=("x", "stop"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    >>> patch = ct.Patch(body=mass, normal=("stop",), clearance=0.1)
    >>> driven = ct.cycles.DrivenBody(patch=patch, channel="x", amplitude=0.02, stiffness=100.0, shown=("x",))
    >>> family = driven.over("freq_hz", freq_hz=0.16)
    >>> found = ct.cycles.balance(family, 0.16)
    >>> one = ct.cycles.orbit(family, 0.16, guess=found.x)
    >>> bool(abs(found.amplitude["x"] / one.amplitude["x"] - 1.0) < 1e-4), one.stable
    (True, True)
    """
    require_finite(value=value)
    require_count(periods=periods)
    require_count(harmonics=harmonics)
    motion, _ = family.at(value)
    periods = periods if guess is None else guess.periods
    here = response(motion, harmonics, periods)
    y = here.still if guess is None else _begin(family, guess, harmonics, here)
    found = solved(here, y) if guess is not None or not pressed(y, here.own).lam.any() else stiffened(here)
    if found is None:
        raise NumericsError(
            f"{family.name} = {value:.8g}: found no motion of {harmonics} harmonics after {NEWTON} Newton steps: start "
            "from a neighbouring one, or take another number of harmonics"
        )
    return balanced(family, value, motion, periods, here, *found)


def stiffened(here: Response) -> tuple[Complex, int] | None:
    """The solution from the motion without contact, with contacts that get stiffer; None where a step has none."""
    y, part, ratio = here.still, 0.0, STIFFER
    soft = min(1.0, float(here.own.min() / np.abs(here.receptance).max()))  # stiffness of the body over the contacts'
    while ratio > LEAST:
        trial = min(max(ratio * part, soft), 1.0)
        found = solved(here._replace(own=here.own / trial), y)
        if found is None:
            ratio = np.sqrt(ratio)
            continue
        y, part = found[0], trial
        if part == 1.0:
            return found
    return None


def _begin(family: Family, guess: Balanced | Orbit, harmonics: int, here: Response) -> Complex:
    """The guess as a series of these harmonics."""
    if isinstance(guess, Orbit):
        return gaps_of(family, guess, harmonics)
    y = guess.y
    if len(y) != len(here.own):
        raise InputError(f"guess: found {len(y)} contacts, expected {len(here.own)}")
    found = np.zeros((len(y), harmonics + 1), dtype=complex)
    kept = min(harmonics + 1, y.shape[1])
    found[:, :kept] = y[:, :kept]
    return found


def scales(here: Response) -> Array:
    """Weights of the equations, by real unknown: one over what a force of a unit penetration changes."""
    size = 1.0 / (1.0 + np.abs(here.receptance) @ (1.0 / here.own))
    return np.concatenate([size, size[1:]]).ravel()


def linear(here: Response, y: Complex) -> tuple[Array, Pressed]:
    """Residual y - still - R lam by real unknown, and the forces."""
    forces = pressed(y, here.own)
    return reals(y - here.still - np.einsum("hab,bh->ah", here.receptance, forces.lam)), forces


def jacobian(here: Response, forces: Pressed) -> Array:
    """Derivative of the residual by the real unknowns, square."""
    H, k = len(here.receptance) - 1, len(here.own)
    moved = here.receptance[:, :, None, :] * forces.by.transpose(1, 2, 0)[:, None]
    moved = moved.reshape(H + 1, k, -1)
    J = -np.concatenate([moved.real, moved.imag[1:]]).reshape(k * (2 * H + 1), -1)
    J[np.diag_indices_from(J)] += 1.0
    return J


def solved(here: Response, y: Complex) -> tuple[Complex, int] | None:
    """Newton's method on the gaps' series, and its number of steps; None where it does not converge."""
    weight, k, v = scales(here), len(here.own), reals(y)
    off, forces = linear(here, y)
    for step in range(1, NEWTON + 1):
        try:
            change = -np.linalg.solve(weight[:, None] * jacobian(here, forces), weight * off)
        except np.linalg.LinAlgError:
            return None
        size, before = float(np.linalg.norm(change)), float(np.linalg.norm(weight * off))
        if not size < np.inf:
            return None
        if size <= CLOSE * float(np.linalg.norm(v + change)):
            return complexes(v + change, k), step
        for half in range(HALVINGS):
            trial = v + 0.5**half * change
            off, forces = linear(here, complexes(trial, k))
            if np.linalg.norm(weight * off) <= (1.0 - 1e-4 * 0.5**half) * before:
                break
        v = trial
    return None


def balanced(
    family: Family, value: float, motion: Motion, periods: int, here: Response, y: Complex, iterations: int
) -> Balanced:
    """The result of a solution, with its channels; raises NumericsError where a slip changes its sign."""
    harmonics = y.shape[1] - 1
    lam = pressed(y, here.own).lam
    x, seen = outputs(motion, here.w, harmonics, periods, lam)
    _require_slip(motion, seen, y, value)
    channels = dict(zip(family.channels, _kept(seen[: len(family.channels)]), strict=True))
    return Balanced(
        name=family.name, value=float(value), period=2.0 * np.pi / here.w, periods=periods, y=_kept(y), x=readonly(x),
        force=_kept(lam), displacement=channels, amplitude={name: largest(u) for name, u in channels.items()},
        iterations=iterations,
    )  # fmt: skip


def _kept(z: Complex) -> Complex:
    z.setflags(write=False)
    return z


def largest(u: Complex) -> float:
    """Largest magnitude of a series (H + 1,), from samples and one Newton step at the largest of them."""
    samples, h = samples_of(u.size - 1), np.arange(u.size)
    at = 2.0 * np.pi * int(np.abs(in_time(u, samples)).argmax()) / samples
    turned = u * np.exp(1j * h * at)
    slope, bend = float((1j * h * turned).real.sum()), float((-(h**2) * turned).real.sum())
    move = -slope / bend if abs(slope) < abs(bend) * 2.0 * np.pi / samples else 0.0
    return float(abs((turned * np.exp(1j * h * move)).real.sum()))


def _require_slip(motion: Motion, seen: Complex, y: Complex, value: float) -> None:
    """Raise NumericsError where a contact slips backwards while it is closed."""
    count = samples_of(y.shape[1] - 1)
    for contact, row in motion.plant.slips:
        if np.any((in_time(y[contact], count) < 0.0) & (in_time(seen[row], count) <= 0.0)):
            raise NumericsError(
                f"found contact {contact + 1} at the change from slip to stick at {value:.8g}, expected slip in one "
                "direction: simulate with ct.run, which computes sticking"
            )
