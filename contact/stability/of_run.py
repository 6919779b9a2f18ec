"""Growth of the motion in a run: windows of its modal energy, its dominant wave, its energy source."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, Indices
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.deflection import Sizes, sizes
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.limits import WALL
from contact.model.gaps.rub import ContactPoint, Rub, rub_of
from contact.model.rotor.rotor import Rotor
from contact.record.energy import Divergence, EnergyBudget
from contact.record.growth import Cause, Ending, RunGrowth
from contact.stability.envelope import Envelope, Fit, envelope, growth_of
from contact.stability.mode_groups import Groups, Parts, largest_mode, parts_of

SLIGHT, SURE = 0.3, 0.15  # e-folds over the last stretch that are none, and those that its whole interval must have
RISE = 0.4  # e-folds that a bounded motion may rise in as much time again as the run took: by half
GREAT = 1.0  # e-folds that the whole interval must have where the motion was as large before
Some = NDArray[np.bool_]
ONE = (ContactPoint(),)
LAST = 10  # the last part of a run has one in so many of its windows
ANGLE = 0.5  # radians by which a wave's phase may be uncertain from one state to the next
SMALL = 0.02  # of the largest area: an orbit without one
CLOSE = 0.05  # of a mode's frequency: by how much contact may shift it


class Ran(Protocol):
    """Interface of the data that are read from a result."""

    @property
    def state_time(self) -> Array:
        """Times of the states [s], (ns,)."""
        ...

    @property
    def state(self) -> Array:
        """Modal coordinates, (ns, m)."""
        ...

    @property
    def tip_force(self) -> Array:
        """Forces on the tips [N], (ns, K d)."""
        ...

    @property
    def channels(self) -> Array:
        """Rows that are stored instead of states."""
        ...

    @property
    def contact_steps(self) -> Array:
        """Steps in which each contact was closed, (K,)."""
        ...

    @property
    def steps(self) -> int:
        """Number of steps."""
        ...

    @property
    def dt(self) -> float:
        """Step [s]."""
        ...

    @property
    def energy(self) -> EnergyBudget:
        """Energy budget."""
        ...

    @property
    def divergence(self) -> Divergence | None:
        """Why the run ended early."""
        ...


class Seen(NamedTuple):
    """Data from a problem: casing and modes, the first tip's rim line, speed [rad/s], wall [m]."""

    casing: ModalBody
    parts: Parts
    line: int
    speed: float
    wall: float


def of_run(what: object, result: Ran) -> RunGrowth | None:
    """Growth of the motion in a run of a rim, a rub or a disk; None for other problems, and without stored states.

    The states may be few, about 200, and far apart (`contact.stability.envelope` has the equations): a sweep uses 256.
    Deflection is the largest around the rim (`contact.model.gaps.deflection`), to which the limit of half the wall
    applies.

    >>> import contact as ct
    >>> from contact.model.gaps.bladed_disk import pair_rim
    >>> pair = ct.gaps.ModalPair(n=4, freq_hz=100.0, modal_mass=1.5, zeta=0.01)
    >>> blade = ct.ModalBody(omega=[900.0], zeta=[0.01], channels=("span", "flap"), rows=[[0.0], [1.0]], S=np.eye(2))
    >>> rim = ct.RotatingRim(
    ...     pair_rim(pair, radius=0.5), blade, clearance=1e-2, speed_hz=5.0, casing_velocity=[1e-3, 0.0]
    ... )
    >>> result = ct.run(rim, t_end=0.3, dt=1e-4, record=ct.Record(state_every=10))
    >>> found = ct.stability.of_run(rim, result)
    >>> found.state, round(found.energy_rate, 2), found.body, found.nodal_diameters  # -2 zeta omega
    ('decays', -12.57, 'casing', 4)
    """
    seen = _seen(what, result.steps * result.dt)
    if seen is None or result.channels.size or not len(result.state):
        return None
    parts = seen.parts
    q = result.state[:, : parts.omega.size]
    turn = 2.0 * math.pi / abs(seen.speed) if seen.speed else math.inf
    found = envelope(result.state_time, q, parts.omega, parts.groups.of, turn, rub_of(what).repeats)
    if found is None:
        return None
    moved = sizes(rub_of(what), result.state_time, q[:, : seen.casing.omega.size], result.tip_force)
    return _verdict(seen, result, q, found, moved)


def of_rotor_run(what: Rotor | Rub, result: Ran) -> RunGrowth | None:
    """Growth of the motion in a rotor's run, alone or in a casing; `amplitude` is the largest distance of the disk.

    The distance is from the disk's mean position over the whole turns of the last half of the run. None with too few
    states.

    >>> import contact as ct
    >>> disk = ct.rotor.Jeffcott(mass=1.0, stiffness=1e4, zeta=0.02)
    >>> rotor = ct.rotor.Rotor.of(disk, 5.0, displacement=[1e-3, 0.0])
    >>> result = ct.run(rotor, t_end=2.0, dt=1e-3, record=ct.Record(state_every=2))
    >>> found = of_rotor_run(rotor, result)
    >>> found.state, round(found.rate, 2)  # -zeta sqrt(k/m)
    ('decays', -2.0)
    """
    rotor = what.rotor if isinstance(what, Rub) else what
    if rotor is None or result.channels.size or len(result.state) < 3:
        return None
    seen = _seen(what, result.steps * result.dt)
    if seen is None:
        groups = Groups(np.zeros(rotor.body.omega.size, dtype=np.int64), (("rotor", None),))
        speed = rotor.speed.omega(result.steps * result.dt)
        parts = Parts(rotor.body.omega, groups, np.arange(1, rotor.body.omega.size + 1))
        seen = Seen(rotor.body, parts, 0, speed, math.inf)
    q = result.state[:, : seen.parts.omega.size]
    turn = 2.0 * math.pi / abs(seen.speed) if seen.speed else math.inf
    found = envelope(result.state_time, q, seen.parts.omega, seen.parts.groups.of, turn)
    if found is None:
        return None
    path, half = disk_path(what, q), len(q) // 2
    moved = np.abs(path - path[_first_of_turns(result.state_time, turn) :].mean())
    growth = _verdict(seen._replace(wall=math.inf), result, q, found, Sizes(moved, lambda at, _: moved[at]))
    return replace(growth, amplitude=float(moved[half:].max()))  # the transient after the loss of a blade has decayed


def _first_of_turns(time: Array, turn: float) -> int:
    """First of the states that make up the whole turns of the last half of a run; the half without a whole one.

    >>> [_first_of_turns(np.linspace(0.0, 1.0, 101), turn) for turn in (0.2, 0.5, np.inf)]
    [61, 51, 50]
    """
    half = time.size // 2
    step = float(time[-1] - time[0]) / (time.size - 1)
    turns = math.floor((time.size - half) * step / turn + 1e-9)
    return time.size - round(turns * turn / step) if turns else half


def disk_path(what: Rotor | Rub, q: Array) -> NDArray[np.complex128]:
    """Position x + i y of a disk (ns,) [m] from modal coordinates (ns, m) of a rotor or of all bodies of a rub."""
    rotor = what.rotor if isinstance(what, Rub) else what
    assert rotor is not None
    first = what.flexible if isinstance(what, Rub) else 0
    return np.asarray(q[:, first : first + rotor.body.omega.size] @ (rotor.plane[0] + 1j * rotor.plane[1]))


def whirl_sense(path: NDArray[np.complex128], speed: float) -> str:
    """Sense of whirl of a path, by the area that it encloses over its last half: forward, backward or planar.

    >>> turned = np.exp(2j * np.pi * np.arange(64) / 16)
    >>> whirl_sense(turned, 10.0), whirl_sense(turned, -10.0), whirl_sense(turned.real + 0j, 10.0)
    ('forward', 'backward', 'planar')
    """
    late = path[len(path) // 2 :]
    late = late - late.mean()
    area, size = float((late[:-1].conj() * late[1:]).imag.sum()), float(np.abs(late[:-1] * late[1:]).sum())
    share = math.copysign(1.0, speed) * area / size if size > 0.0 else 0.0
    return "forward" if share > SMALL else "backward" if share < -SMALL else "planar"


def _seen(what: object, end: float) -> Seen | None:
    """Data of a problem whose run ended at `end` [s]; None if it is neither a rim nor a rub."""
    if isinstance(what, RotatingRim):
        parts = parts_of((what.casing, what.blade), ONE, what.casing.omega.size)
        return Seen(what.casing, parts, 0, what.speed, what.casing.line_wall(0) or math.inf)
    if isinstance(what, Rub):
        parts = parts_of(what.bodies, what.tips, what.flexible)
        return Seen(what.casing, parts, what.tips[0].line, what.speed.omega(end), what.wall)
    return None


def _verdict(seen: Seen, result: Ran, q: Array, found: Envelope, moved: Sizes) -> RunGrowth:
    total = found.energy.sum(axis=1)
    fit = growth_of(found.time, total)
    first = 0 if fit is None else fit.first
    since = float(found.start[first])
    late = result.state_time >= since
    amplitude, steady = _amplitude(result.state_time, moved, found.start[first:])
    moves = np.isfinite(total[-1]) and total[-1] > 0.0
    cause = _cause(seen, result, q, found.energy[first:], late) if moves else None
    if fit is None:
        none = math.nan
        state: Ending = "undecided" if moves else "at rest"
        return RunGrowth(
            rate=none, low=none, high=none, state=state, amplitude=amplitude, steady=steady, since=since,
            time_to_half_wall=_stopped(result), cause=cause,
        )  # fmt: skip
    span, whole = float(result.state_time[-1]) - since, float(np.ptp(result.state_time))
    state = _state(fit, span, whole, beyond=_beyond(total, first), risen=_risen(total))
    reaches = _half_wall(seen, result, fit.rate, moved, amplitude) if state == "grows" else _stopped(result)
    return RunGrowth(
        rate=fit.rate, low=fit.low, high=fit.high, state=state, amplitude=amplitude, steady=steady, since=since,
        time_to_half_wall=reaches, cause=cause,
    )  # fmt: skip


def _state(fit: Fit, span: float, whole: float, *, beyond: bool, risen: float) -> Ending:
    """State of the motion in the last `span` of `whole` seconds from its mean growth, which is known to `scatter`.

    A motion grows only if the whole interval is above 0, since a strongly curved envelope may be part of a slow beat.
    It must also end `beyond` all earlier levels, or rise by e^GREAT, since the level of an intermittent motion varies.
    It is bounded if the interval excludes a rise by e^RISE in as much time again as the run took: a short last stretch
    after a long start does not show that. Neither has its level `risen` by e^RISE since the first half of the run: a
    level that jumped may jump again.

    >>> fits = ((3, 1, 1), (3, -1, 1), (1, 0, 1), (2, 0, 2), (-3, -4, 1))
    >>> [_state(Fit(rate, low, 0.0, scatter, 0), 0.19, 0.19, beyond=True, risen=0.0) for rate, low, scatter in fits]
    ['grows', 'undecided', 'bounded', 'undecided', 'decays']
    >>> [_state(Fit(rate, rate - 2, 0.0, 1, 0), 0.2, 0.2, beyond=False, risen=0.0) for rate in (3, 9)]
    ['undecided', 'grows']
    >>> [
    ...     _state(Fit(0, -1, 1, 0.5, 0), 0.2, whole, beyond=True, risen=risen)
    ...     for whole, risen in ((0.7, 0.1), (0.9, 0.1), (0.7, 0.5))
    ... ]
    ['bounded', 'undecided', 'undecided']
    """
    folds, scatter = fit.rate * span, fit.scatter * span
    if folds > SLIGHT and folds - scatter > SURE:
        return "grows" if fit.low > 0.0 and (beyond or fit.low * span > GREAT) else "undecided"
    if folds < -SLIGHT and folds + scatter < -SURE:
        return "decays"
    return "bounded" if max((fit.rate + fit.scatter) * whole, risen) < RISE else "undecided"


def _beyond(energy: Array, first: int) -> bool:
    """Whether the energy of the last windows exceeds that of every window before number `first`.

    >>> _beyond(np.array([1.0, 3.0, 1.0, 2.0]), 2), _beyond(np.array([1.0, 3.0, 1.0, 4.0]), 2)
    (False, True)
    """
    end = float(energy[-max(1, energy.size // LAST) :].mean())
    return first == 0 or end > float(energy[:first].max())


def _risen(energy: Array) -> float:
    """By how many e-folds the amplitude of the last windows exceeds that of the first half; 0 if nothing moved there.

    >>> round(_risen(np.exp(2.0 * np.array([0.0, 0.0, 0.5, 0.5]))), 3), _risen(np.array([0.0, 0.0, 2.0, 2.0]))
    (0.5, 0.0)
    """
    before, end = (float(part.mean()) for part in (energy[: energy.size // 2], energy[-max(1, energy.size // LAST) :]))
    return 0.5 * math.log(end / before) if before > 0.0 and end > 0.0 else 0.0


def _stopped(result: Ran) -> float:
    """Time at which the run passed half the wall [s]; infinite if it did not."""
    ended = result.divergence
    return ended.time if ended is not None and ended.limit == "wall" else math.inf


def _half_wall(seen: Seen, result: Ran, rate: float, moved: Sizes, now: float) -> float:
    """Time from the start of the run at which the growing deflection, `now` at its end, reaches half the wall [s]."""
    stopped, allowed = _stopped(result), WALL * seen.wall
    if math.isfinite(stopped) or not (math.isfinite(allowed) and now > 0.0):
        return stopped
    beyond = moved.first_above(allowed)
    return float(
        result.state_time[-1] + math.log(allowed / now) / rate if beyond is None else result.state_time[beyond]
    )


def _amplitude(time: Array, moved: Sizes, start: Array) -> tuple[float, float]:
    """Largest deflection in the last part of the run, and the largest relative difference to that in its windows."""
    largest = moved.largest(np.minimum(np.searchsorted(time, start), time.size - 1))
    top = float(largest.max())
    return top, (1.0 - float(largest.min()) / top) if top > 0.0 else 0.0


def _cause(seen: Seen, result: Ran, q: Array, energy: Array, late: Some) -> Cause:
    """The group with most of the energy at the end."""
    last = energy[-max(1, len(energy) // 4) :].mean(axis=0)
    top = int(last.argmax())
    groups = seen.parts.groups
    body, n = groups.named[top]
    modes = np.flatnonzero(groups.of == top)
    mode = None
    if body == "blades" and n is None:
        mode = largest_mode(seen.parts.number[modes], np.var(seen.parts.omega[modes] * q[late][:, modes], axis=0))
    source, work = _source(result.energy)
    return Cause(
        body=body, n=n, share=float(last[top] / last.sum()), source=source, work=work,
        travel=_travel(seen, result, q, modes, n, late) if body == "casing" else math.nan,
        closed=float(np.max(result.contact_steps, initial=0)) / result.steps if result.steps else 0.0, mode=mode,
    )  # fmt: skip


def _source(energy: EnergyBudget) -> tuple[str, float]:
    """The largest work that entered over the run, and its source."""
    parts = {
        "friction": energy.friction, "the turning rim": energy.rotation, "gravity and whirl": energy.body_force,
        "varying loads": energy.external,
        "the numerical scheme": energy.algorithmic - energy.lost_in_contact - energy.explained,
    }  # fmt: skip
    name = max(parts, key=lambda one: parts[one])
    return (name, parts[name]) if parts[name] > 0.0 else ("", 0.0)


def _travel(seen: Seen, result: Ran, q: Array, modes: Indices, n: int | None, late: Some) -> float:
    """Part of a casing's wave that travels with the blades, from 1 to -1; nan if its states are too far apart.

    With z = a + i b of the rim's a cos n theta + b sin n theta, a wave towards +theta changes the phase of z by omega D
    from one state to the next, the opposite wave by -omega D. Both amplitudes follow by least squares over pairs of
    states.
    """
    speed, time, N = seen.speed, result.state_time, seen.casing.n_max
    q = q[late]
    if not n or not speed:
        return math.nan
    omega, rows = seen.casing.omega[modes], seen.casing.rows[:, modes]
    power = np.var(omega * q[:, modes], axis=0)
    mean = float(power @ omega / power.sum()) if power.sum() > 0.0 else 0.0
    turned = mean * float(time[-1] - time[0]) / (time.size - 1)
    every = max(1, round(0.5 * math.pi / turned)) if turned > 0.0 else 1
    q, turned = q[::every], turned * every
    if len(q) < 8 or CLOSE * turned > ANGLE or abs(math.sin(turned)) < 0.2:
        return math.nan
    line = seen.line * seen.casing.directions * (2 * N + 1)
    z = q[:, modes] @ (rows[line + n] + 1j * rows[line + N + n])
    z = z - z.mean()
    ahead = z[1:-1] - z[:-2] * np.exp(-1j * turned), z[1:-1] - z[:-2] * np.exp(1j * turned)
    with_theta, against = (float(np.vdot(part, part).real) for part in ahead)
    both = with_theta + against
    if not both > 0.0:
        return math.nan
    return -math.copysign(1.0, speed) * (with_theta - against) / both
