"""Growth in a run of a contact that is pressed closed, at one speed, for comparison with the poles."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from contact.base.arrays import Array, readonly
from contact.base.errors import InputError
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.bladed_disk import pair_rim
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import ClosedContact, HandPair, rub_contact
from contact.model.gaps.rub import ContactPoint, Rub, Start, rub_of
from contact.model.gaps.rub_laws import Closing, RimProfile
from contact.model.law import Coulomb, Unilateral
from contact.model.speed import Speed
from contact.record.record import Record
from contact.run import run
from contact.scheme.modal.coupled import poles
from contact.scheme.modal.exact_modal import ExactModal
from contact.stability.closed_contact import first_order, poles_each
from contact.stability.split_casing import mean_contact, perfect_mean

PRESS, PUSHED = 1e-5, 1e-3  # of the radius, how much contacts overlap, small beside what slips in a period; of the
# force, how much vibrates at first
FOLDS, LONGEST, FEWEST = 5.0, 2.0, 40  # e-folds that are run, seconds at most, periods at least
A_PERIOD = 10.0  # samples
PHASE, FOLLOWED, TURNED = 0.4, 0.02, 0.1  # radians of the fastest mode, of the leading motion, of the highest
# harmonic, in a step


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfirmingRun:
    """A run compared with the poles: `speed_hz` [turns/s], growth by both [1/s], over `seconds` of motion.

    The same bodies with every contact pressed together, started in the motion that grows fastest. The run therefore
    satisfies the assumptions of the theory: contacts stay closed and slide.
    """

    speed_hz: float
    poles: float
    run: float
    seconds: float

    @property
    def off(self) -> float:
        """Growth of the run over that of the poles, minus 1."""
        return self.run / self.poles - 1.0 if self.poles else math.nan

    def to_dict(self) -> dict[str, float]:
        """JSON-ready."""
        return {
            "speed_hz": self.speed_hz, "growth_poles_1_s": self.poles, "growth_run_1_s": self.run,
            "off_rel": self.off, "seconds": self.seconds,
        }  # fmt: skip

    def __repr__(self) -> str:
        return (
            f"run at {self.speed_hz:.5g} Hz, contact pressed closed: growth {self.run:.4g} 1/s over {self.seconds:.3g} "
            f"s, {self.poles:.4g} 1/s by poles ({100.0 * self.off:+.2g} %)"
        )


def confirming_run(what: RotatingRim | Rub | HandPair, speed_hz: float, *, mu: float = 0.0) -> ConfirmingRun:
    """Growth in time of closed, sliding contact at one speed [turns/s], started in its leading motion.

    Raises InputError where the contacts do not press at rest, so that none stays closed.
    """
    rub, mu = closed_rub(what, speed_hz, mu)
    contact = rub_contact(rub, mu=mu)
    leading = max(poles_each(contact, np.array([speed_hz]))[0], key=lambda s: float(s.real))
    fastest = float(np.abs(poles(*contact.matrices(2.0 * math.pi * speed_hz)).imag).max(initial=0.0))
    dt, period = _step(rub, fastest, leading), 2.0 * math.pi / max(abs(leading.imag), 1.0)
    press, q, v = _start(contact, speed_hz, leading, -rub.clearance, dt)
    m = contact.casing
    sizes = np.cumsum([body.omega.size for body in rub.blades])[:-1]
    blades = zip(np.split(q[m:], sizes), np.split(v[m:], sizes), strict=True)
    rub = replace(
        rub, clearance=-press, casing_start=Start(displacement=readonly(q[:m]), velocity=readonly(v[:m])),
        blade_starts=tuple(Start(displacement=readonly(x), velocity=readonly(y)) for x, y in blades),
    )  # fmt: skip
    seconds = float(np.clip(FOLDS / max(abs(leading.real), 1e-9), min(FEWEST * period, LONGEST), LONGEST))
    seconds = min(seconds, FOLDS / leading.real) if leading.real > 0.0 else seconds
    every = max(1, int(min(period / A_PERIOD, seconds / FEWEST / A_PERIOD) / dt))
    result = run(
        rub, law=Coulomb(mu=mu) if mu else Unilateral(), scheme=ExactModal(), t_end=seconds, dt=dt,
        record=Record(every=every), on_limit="flag",
    )  # fmt: skip
    mean = np.diff(result.impulse_history, axis=0) / (every * result.dt)
    closed = np.all(result.force[1:] > 0.0, axis=1)
    last = int(np.argmin(closed)) if not closed.all() else closed.size
    k = int(np.std(mean[:last], axis=0).argmax())  # the tip that moves most
    rate = exponent(mean[:last, k], every * result.dt, abs(leading.imag) / (2.0 * math.pi))
    return ConfirmingRun(speed_hz=speed_hz, poles=float(leading.real), run=rate, seconds=last * every * result.dt)


def exponent(values: Array, step: float, freq_hz: float) -> float:
    """Growth [1/s] of the motion near a frequency, which may be 0: c + e^(s t) (a cos w t + b sin w t), least squares.

    With an oscillation, c is a parabola, because another motion may drift slowly.

    >>> t = 1e-3 * np.arange(2000)
    >>> noise = 0.1 * np.sin(1900.0 * t)
    >>> round(exponent(5.0 + np.exp(1.5 * t) * np.sin(700.0 * t) + noise, 1e-3, 700.0 / (2.0 * np.pi)), 2)
    1.5
    """
    from scipy.optimize import least_squares

    if values.size < 8:
        return math.nan
    t = step * np.arange(values.size)
    scale, span, w = float(np.std(values)) or 1.0, float(t[-1]), 2.0 * math.pi * freq_hz

    def left(found: Array) -> Array:
        grown = np.exp(found[0] / span * t)
        columns = [np.ones(t.size), grown]
        if found.size > 1:
            phase = (w + found[1] / span) * t
            columns[1:] = [t / span, (t / span) ** 2, grown * np.cos(phase), grown * np.sin(phase)]
        basis = np.stack(columns, axis=1)
        return np.asarray((values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0]) / scale)

    best = least_squares(left, np.full(2 if w * span > 1.0 else 1, 1e-3))
    return float(best.x[0] / span)


def _start(
    contact: ClosedContact, speed_hz: float, leading: complex, press: float, dt: float
) -> tuple[float, Array, Array]:
    """Overlap, displacement and velocity in the bodies' frames at t = 0: equilibrium, and the leading motion.

    Faster than its waves a rim gives way outwards: there a gap, not an overlap, has contacts that press at rest.
    A run starts from the free motion through both; the velocity is that of one which makes the step before t = 0 as
    if the contact had pressed then too.
    """
    m, speed = contact.omega.size, 2.0 * math.pi * speed_hz
    bodies, W = first_order(contact, speed), contact.pushes(math.copysign(1.0, speed))
    matrix, overlap = bodies.closed(), np.full(len(contact.Q), press)
    x = -np.linalg.solve(matrix, bodies.B @ np.linalg.solve(bodies.S, overlap))
    force = np.linalg.solve(bodies.S, overlap - bodies.C @ x)
    if force.max() < 0.0:
        press, overlap, x, force = -press, -overlap, -x, -force
    if not force.min() > 0.0:
        found = f"forces at rest from {force.min():g} to {force.max():g} N at {speed_hz:g} Hz"
        raise InputError(f"contact: found {found}, expected all above 0: not every contact stays closed")
    values, vectors = np.linalg.eig(matrix)
    shape = vectors[:, int(np.abs(values - leading).argmin())]
    moved = float(np.abs(np.linalg.solve(bodies.S, bodies.C @ shape)).max())
    x = x + shape.real * (PUSHED * float(force.min()) / moved)
    push = W.T @ np.linalg.solve(bodies.S, overlap - bodies.C @ x)
    return press, x[:m], contact.rates * x[m:] + _before(contact, speed, dt) @ push


def _before(contact: ClosedContact, speed: float, dt: float) -> Array:
    """Velocity per constant force whose free motion makes the same step before t = 0 as that force does, (m, m) [s]."""
    from scipy.linalg import expm

    m, (C, K) = contact.omega.size, contact.matrices(speed)
    A = np.zeros((3 * m, 3 * m))
    A[:m, m : 2 * m] = A[m : 2 * m, 2 * m :] = np.eye(m)
    A[m : 2 * m, :m], A[m : 2 * m, m : 2 * m] = -K, -C
    back = expm(-dt * A)
    return np.asarray(np.linalg.solve(back[:m, m : 2 * m], back[:m, 2 * m :]))


def _step(rub: Rub, fastest: float, leading: complex) -> float:
    """Step [s] that resolves the fastest mode [rad/s], the motion that is followed, and the turning."""
    return min(PHASE / fastest, FOLLOWED / abs(leading), TURNED / (rub.casing.n_max * max(rub.speed.fastest, 1e-9)))


def closed_rub(what: RotatingRim | Rub | HandPair, speed_hz: float, mu: float) -> tuple[Rub, float]:
    """The same bodies as a rub at this speed whose contacts overlap and whose rim is round, and its friction."""
    if isinstance(what, HandPair):
        return _closed(_of_pair(what), speed_hz), what.friction
    rub = rub_of(what)
    if rub is None:
        raise InputError(f"what: found {type(what).__name__}, expected a RotatingRim, a Rub or a HandPair")
    return _closed(rub, speed_hz), mu


def _closed(what: Rub, speed_hz: float) -> Rub:
    casing = perfect_mean(what.casing) if mean_contact(what)[1] else what.casing  # of split pairs the mean
    tips = tuple(replace(tip, clearance=0.0, axial=None) for tip in what.tips)
    least = min(casing.line_radius(tip.line) for tip in tips)
    return replace(
        what, casing=casing, tips=tips, clearance=-PRESS * least, speed=Speed.constant(speed_hz),
        profile=RimProfile(), closing=Closing.none(), whirl=(), forces=(), thickness=math.inf,
        casing_start=Start(), blade_starts=(),
    )  # fmt: skip


def _of_pair(what: HandPair) -> Rub:
    """A leaning blade moves only along its flap."""
    x, a = what.blade.modal_mass**-0.5, math.radians(what.lean_deg)
    blade = ModalBody(
        omega=np.array([what.blade.omega]), zeta=np.array([what.blade.zeta]), channels=("span", "flap"),
        rows=np.array([[0.0], [x / math.sin(a)]] if a else [[x], [0.0]]), S=np.eye(2) * what.compliance,
    )  # fmt: skip
    casing = pair_rim(what.casing, radius=0.5)
    return Rub(casing, (blade,), (ContactPoint(lean_deg=what.lean_deg),))
