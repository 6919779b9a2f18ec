"""Fit all modes of responses: close modes together as a group, the others subtracted, one after another.

The fits begin with the poles that recur (`lscf`), or with picked ones. They end when every visible peak has a mode and
no pole moves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.counting import asked, counted, outer_terms
from casingfem.experiment.identify.lscf import bands_of, compressed
from casingfem.experiment.identify.pole_fit import PoleFit, Window, fit_poles, widths
from casingfem.experiment.identify.responses import Responses
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, IntArray
from contact.io.progress import each

PASSES = False, True, True  # whether each fit may add poles; every fit may remove some
SETTLING, SETTLED = 6, 1e-3  # most repetitions of all fits; change below which they end, in standard deviations
ENDS = 0.1  # of a window's lines, by which its ends move before its lines are chosen again


class SetUp(NamedTuple):
    """Channels measured together (channels,), their responses, and the fits of their modes."""

    channels: IntArray
    data: Responses
    fits: list[PoleFit]

    @property
    def modes(self) -> Modal:
        """The modes of all fits."""
        return modal_of(self.fits, len(self.channels))


class Modal(NamedTuple):
    """Poles [rad/s] (modes,) and residues over the noise (modes, channels), of columns of unit peak."""

    poles: Array
    A: Array

    def without(self, group: IntArray) -> Modal:
        """All modes but a group."""
        left = np.delete(np.arange(len(self.poles)), group)
        return Modal(self.poles[left], self.A[left])

    def with_poles(self, poles: Array) -> Modal:
        """These modes and further poles, whose residues are not known."""
        more = Modal(poles, np.zeros((len(poles), self.A.shape[1])))
        return Modal.join([self, more], self.A.shape[1])

    @classmethod
    def join(cls, parts: list[Modal], channels: int) -> Modal:
        """Modes of several parts, ascending."""
        poles = np.concatenate([np.zeros(0, complex), *(part.poles for part in parts)])
        A = np.concatenate([np.zeros((0, channels), complex), *(part.A for part in parts)])
        order = np.argsort(poles.imag)
        return cls(poles[order], A[order])


def modal_of(fits: list[PoleFit], channels: int) -> Modal:
    """Modes of all fits, in ascending order."""
    return Modal.join([Modal(fit.poles, fit.A) for fit in fits], channels)


def all_fitted(data: Responses, modes: Modal, rules: Thresholds = USUAL) -> list[PoleFit]:
    """Fit all groups of modes: add and remove poles until every visible peak has one."""
    channels, fits = data.Y.shape[1], list[PoleFit]()
    for number, more in enumerate(PASSES, 1):
        what = f"fit {number} of {len(PASSES)}: group"
        known = fits if number > 1 and more == PASSES[number - 2] else []
        fits = fitted_groups(data, modes.with_poles(missing_peaks(data, modes)), more, rules, what, known)
        modes = modal_of(fits, channels)
    fits = settled_fits(data, fits, rules)
    return fits + unexplained(data, fits, rules)


def picked_fits(data: Responses, modes: Modal, rules: Thresholds = USUAL) -> list[PoleFit]:
    """Fit the picked modes: refine them, without adding or removing any."""
    return settled_fits(data, fitted_groups(data, modes, None, rules), rules)


def with_residues(data: Responses, poles: Array, rules: Thresholds = USUAL) -> Modal:
    """Residues of poles by linear least squares with polynomials, band by band (LSFD)."""
    parts = []
    for core, lines, _ in bands_of(data, rules):
        low, high = data.freq[lines.start], data.freq[lines.stop - 1]
        here = poles[(poles.imag >= 2.0 * np.pi * low) & (poles.imag <= 2.0 * np.pi * high)]
        fit = fit_poles(_window(data, lines, data.Y[lines], rules), here, steps=0)
        first, end = (2.0 * np.pi * data.freq[k] if k < len(data.freq) else np.inf for k in (core.start, core.stop))
        inside = (fit.poles.imag >= first) & (fit.poles.imag < end)
        parts.append(Modal(fit.poles[inside], fit.A[inside]))
    return Modal.join(parts, data.Y.shape[1])


def groups(poles: Array, step: float, rules: Thresholds = USUAL) -> list[IntArray]:
    """Indices of poles (ascending) that are fitted together; `step` [rad/s] is the distance of lines."""
    if not len(poles):
        return []
    wide = widths(poles)
    gap = np.diff(poles.imag) / np.maximum(rules.overlap * np.maximum(wide[1:], wide[:-1]), rules.overlap_lines * step)
    cut = gap > 1.0
    parts = np.split(np.arange(len(poles)), np.flatnonzero(cut) + 1)
    done: list[IntArray] = []
    while parts:
        part = parts.pop(0)
        if len(part) <= rules.together:
            done.append(part)
        else:
            inner = gap[part[:-1]]
            middle = len(part) // 2
            near = range(max(1, middle - 1), min(len(part), middle + 2))
            at = max(near, key=lambda k: float(inner[k - 1]))
            parts = [part[:at], part[at:], *parts]
    return done


def _lines_about(data: Responses, poles: Array, group: IntArray, rules: Thresholds) -> slice:
    """Lines around a group of poles: up to half of the distance to its neighbours, and some beyond."""
    step = data.step
    reach = np.maximum(rules.reach * widths(poles[group]), rules.reach_lines * step)
    low, high = float((poles[group].imag - reach).min()), float((poles[group].imag + reach).max())
    first, last = poles[group[0]], poles[group[-1]]
    enough = rules.overlap_lines * step
    if group[0] > 0:
        other = poles[group[0] - 1]
        between = other.imag + (first.imag - other.imag) * 0.5
        low = max(low, min(between, first.imag + 1.5 * first.real, first.imag - enough))
    if group[-1] + 1 < len(poles):
        other = poles[group[-1] + 1]
        between = last.imag + (other.imag - last.imag) * 0.5
        high = min(high, max(between, last.imag - 1.5 * last.real, last.imag + enough))
    lines = np.searchsorted(data.freq, [low / (2.0 * np.pi), high / (2.0 * np.pi)]).tolist()
    least = 3 * (len(group) + rules.terms)
    if lines[1] - lines[0] < least:
        middle = sum(lines) // 2
        lines = [middle - least // 2, middle + least - least // 2]
    return slice(max(0, lines[0]), min(len(data.freq), max(lines[1], lines[0] + 2)))


def _window(data: Responses, lines: slice, Y: Array, rules: Thresholds) -> Window:
    """A window of lines with responses Y (its lines, channels)."""
    along = data.along[lines]
    floor = rules.floor * float(np.sqrt(0.5 * np.mean(np.abs(Y) ** 2))) if Y.size else 0.0
    return Window(freq=data.freq[lines], Y=along[:, None] * Y, along=along, end=data.end, leak=data.leak,
                  floor=floor, terms=rules.terms)  # fmt: skip


def _response(data: Responses, modes: Modal, lines: slice) -> Array:
    """Sum of modes at given lines (lines, channels)."""
    freq = data.freq[lines]
    window = Window(freq=freq, Y=np.zeros((len(freq), 0)), along=np.ones(len(freq)), end=data.end, leak=data.leak)
    return window.resonances(modes.poles)[0] @ modes.A


def _alone(data: Responses, modes: Modal, group: IntArray, rules: Thresholds) -> tuple[slice, Array]:
    """Lines about a group of modes, and the responses there with all other modes subtracted."""
    lines = _lines_about(data, modes.poles, group, rules)
    return lines, data.Y[lines] - _response(data, modes.without(group), lines)


def fitted_groups(
    data: Responses,
    modes: Modal,
    more: bool | None,
    rules: Thresholds = USUAL,
    what: str = "group",
    known: Sequence[PoleFit] = (),
) -> list[PoleFit]:
    """Fit all groups of modes, each with the modes of the other groups subtracted; `what` is reported with its number.

    If `more` is False, poles may be removed. If it is True, they may also be added. If it is None, their number is
    fixed. A group of `known` fits is fitted again only if the other modes have changed.
    """
    parts, fits = groups(modes.poles, data.step, rules), {fit.poles.tobytes(): fit for fit in known}
    return [
        fitted_group(data, modes, group, more, rules, fits.get(modes.poles[group].tobytes()))
        for group in each(parts, what)
    ]


def fitted_group(
    data: Responses,
    modes: Modal,
    group: IntArray,
    more: bool | None,
    rules: Thresholds = USUAL,
    known: PoleFit | None = None,
) -> PoleFit:
    """Fit one group of modes, with the other modes subtracted; `known` is an earlier fit of the group."""
    lines = _lines_about(data, modes.poles, group, rules)
    if known is not None:
        lines = _kept(lines, int(np.searchsorted(data.freq, known.window.freq[0])), len(known.window.freq))
    Y = data.Y[lines] - _response(data, modes.without(group), lines)
    whole = _window(data, lines, Y, rules)
    if known is not None and _unchanged(known, whole):
        return known
    few = compressed(whole.Y)
    small = whole if few is whole.Y else replace(whole, Y=few)
    seen = data.freq[data.peaks.at]
    here = seen[(seen >= whole.freq[0]) & (seen <= whole.freq[-1])]
    start = modes.poles[group]
    if more is None:
        if known is None or known.window.terms > small.terms:
            small = replace(small, terms=outer_terms(small, start, rules))
        fit = fit_poles(small, start)
    else:
        fit = counted(small, start, here, more, rules)
        small = replace(small, terms=outer_terms(fit.window, fit.poles, rules))
        if small.terms > fit.window.terms:
            fit = fit_poles(small, fit.poles)
    return fit if few is whole.Y else fit_poles(replace(whole, terms=small.terms), fit.poles, steps=0)


def _kept(lines: slice, first: int, count: int) -> slice:
    """The `count` lines from `first` on of an earlier fit, unless the ends have moved by a tenth of its lines."""
    moved = max(abs(lines.start - first), abs(lines.stop - first - count))
    return slice(first, first + count) if moved <= max(1, ENDS * count) else lines


def _unchanged(known: PoleFit, window: Window) -> bool:
    """Whether the responses of a window have changed so little that no pole moves significantly.

    A change of norm d moves a pole by at most d standard deviations of white noise of unit variance.
    """
    before = known.window
    if len(before.freq) != len(window.freq) or before.freq[0] != window.freq[0]:
        return False
    change = float(np.linalg.norm(window.Y - before.Y))
    return change < SETTLED * float(np.sqrt(known.noise.min(initial=np.inf)))


def settled_fits(data: Responses, fits: list[PoleFit], rules: Thresholds = USUAL) -> list[PoleFit]:
    """Repeat the fits, each with the latest other modes subtracted, until no pole moves significantly."""
    for _ in range(SETTLING):
        again = fitted_groups(data, modal_of(fits, data.Y.shape[1]), None, rules, known=fits)
        moved = _moved(fits, again)
        fits = again
        if moved < SETTLED:
            break
    return fits


def _moved(before: list[PoleFit], after: list[PoleFit]) -> float:
    """Largest change of a pole in its standard deviations; inf if the groups have changed."""
    if [len(fit) for fit in before] != [len(fit) for fit in after]:
        return float("inf")
    pairs = [(a.poles, b.poles, b.sigma) for a, b in zip(before, after, strict=True) if len(b)]
    return max((float(np.max(np.abs(new - old) / -new.real / sigma[0])) for old, new, sigma in pairs), default=0.0)


def missing_peaks(data: Responses, modes: Modal) -> Array:
    """Start values of poles [rad/s] at visible peaks that no mode explains."""
    step = float(data.freq[1] - data.freq[0])
    starts = []
    for at, lines in zip(data.peaks.at.tolist(), data.peaks.width.tolist(), strict=True):
        width = max(lines, 1.0) * step
        reach = np.maximum(0.5 * widths(modes.poles) / (2.0 * np.pi), max(0.5 * width, step))
        if not np.any(np.abs(modes.poles.imag / (2.0 * np.pi) - data.freq[at]) < reach):
            starts.append(2.0 * np.pi * (-0.5 * width + 1j * data.freq[at]))
    return np.array(starts, complex)


def unexplained(data: Responses, fits: list[PoleFit], rules: Thresholds = USUAL) -> list[PoleFit]:
    """Poles at the visible peaks that the fits do not explain.

    Start values, each alone with the other modes subtracted.
    """
    modes = modal_of(fits, data.Y.shape[1])
    alone = []
    for start in missing_peaks(data, modes):
        lines = _lines_about(data, np.array([start]), np.array([0]), rules)
        window = _window(data, lines, data.Y[lines] - _response(data, modes, lines), rules)
        alone.append(replace(fit_poles(window, np.array([start]), steps=0), refined=False))
    return alone


def refined_end(data: Responses, poles: Array, rules: Thresholds = USUAL) -> float:
    """Refine the duration of the recorded ringing [s] so that the strongest modes fit best.

    The impulse response gives this duration to a few samples; the likelihood of the modes gives it to a fraction of a
    sample.
    """
    if not np.isfinite(data.end) or not len(poles):
        return data.end
    power = np.sum(np.abs(data.Y) ** 2, axis=1)
    at = np.clip(np.searchsorted(data.freq, poles.imag / (2.0 * np.pi)), 0, len(power) - 1)
    strongest = int(np.argmax(power[at] * np.exp(2.0 * poles.real * data.end)))
    group = next(g for g in groups(poles, data.step, rules) if strongest in g)
    lines = _lines_about(data, poles, group, rules)
    Y = compressed(data.Y[lines])
    sample = 1.0 / float(data.freq[-1] - data.freq[0])
    best, reach = data.end, max(3.0, len(data.freq) / 60.0) * sample * 1.5
    while reach > 0.02 * sample:
        tried = best + reach * np.linspace(-1.0, 1.0, 9)
        windows = [_window(data._replace(end=end), lines, Y, rules) for end in tried.tolist()]
        fits = [fit_poles(window, poles[group], steps=8) for window in windows]
        k = int(np.argmin([fit.squares for fit in fits]))
        best, reach = float(tried[k]), reach / 3.0
    return best


def with_leakage(parts: list[SetUp], rules: Thresholds = USUAL) -> list[SetUp]:
    """The set-ups, fitted again with the Hann window whose leakage the responses show; else as they are."""
    if not _leaks(parts, rules):
        return parts
    wide = [part.data._replace(leak=float(part.data.freq[1] - part.data.freq[0])) for part in parts]
    return [part._replace(data=data, fits=all_fitted(data, part.modes, rules))
            for part, data in zip(parts, wide, strict=True)]  # fmt: skip


def _leaks(parts: list[SetUp], rules: Thresholds) -> bool:
    """Decide from the strongest modes of all set-ups whether a Hann window leaks over neighbouring lines.

    Up to eight groups of each set-up are fitted with and without the window. The window is accepted if it lowers the
    sum of squares of more than half of the groups, and if the total decrease is more than one pole would have to give.
    """
    tested, falls = list[tuple[Responses, Modal, IntArray]](), list[float]()
    for part in parts:
        data, modes = part.data, part.modes
        if np.isfinite(data.end):
            return False
        strength = np.sum(np.abs(modes.A) ** 2, axis=1)
        ranked = sorted(groups(modes.poles, data.step, rules), key=lambda g: -float(strength[g].max()))
        tested += [(data, modes, group) for group in ranked[:8]]
    for data, modes, group in tested:
        lines, rest = _alone(data, modes, group, rules)
        Y, line = compressed(rest), float(data.freq[1] - data.freq[0])
        plain, wide = (
            fit_poles(_window(data._replace(leak=leak), lines, Y, rules), modes.poles[group]) for leak in (0.0, line)
        )
        falls.append((plain.squares - wide.squares) / float(max(plain.noise.max(), wide.noise.max())))
        if 2 * sum(fall <= 0.0 for fall in falls) >= len(tested):
            return False
    return sum(falls) > asked(max((len(part.channels) for part in parts), default=1), rules)
