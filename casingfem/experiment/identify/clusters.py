"""Identify all modes of a test: fit close modes together in a window, subtract the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.counting import asked, counted, outer_terms, widths
from casingfem.experiment.identify.lscf import Candidates, Stabilisation, candidates, compressed
from casingfem.experiment.identify.pole_fit import PoleFit, Window, fit_poles
from casingfem.experiment.identify.spectra import Peaks, visible_peaks
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, FloatArray, IntArray
from contact.io.progress import each

SETTLING, SETTLED = 6, 1e-3  # most repetitions of all fits; change below which they end, in standard deviations
EMPTY_LINES = 1500  # of a band without visible peaks


class Responses(NamedTuple):
    """Responses Y (lines, channels) divided by their noise, at `freq` [Hz].

    `along` (lines,) has the weights of the lines.

    `end` is the duration of the recorded ringing [s]. `leak` is the distance of lines [Hz] over which a Hann window
    leaks, else 0. `peaks` are the visible peaks.
    """

    freq: FloatArray
    Y: Array
    along: FloatArray
    peaks: Peaks
    end: float = np.inf
    leak: float = 0.0

    def some(self, channels: IntArray, rules: Thresholds = USUAL) -> Responses:
        """The responses of some channels, with the visible peaks of these channels."""
        Y = self.Y[:, channels]
        return self._replace(Y=Y, peaks=visible_peaks(Y, rules))

    def window(self, lines: slice, Y: Array, rules: Thresholds = USUAL) -> Window:
        """A window of lines with responses Y (its lines, channels)."""
        along = self.along[lines]
        floor = rules.floor * float(np.sqrt(0.5 * np.mean(np.abs(Y) ** 2))) if Y.size else 0.0
        return Window(freq=self.freq[lines], Y=along[:, None] * Y, along=along, end=self.end, leak=self.leak,
                      floor=floor, terms=rules.terms)  # fmt: skip


class Modal(NamedTuple):
    """Poles [rad/s] (modes,) and residues over the noise (modes, channels), of columns of unit peak."""

    poles: Array
    A: Array

    def response(self, data: Responses, lines: slice) -> Array:
        """Sum of the modes at given lines (lines, channels)."""
        return _columns(data, self.poles, lines) @ self.A

    def some(self, kept: Array) -> Modal:
        """Some of the modes."""
        return Modal(self.poles[kept], self.A[kept])

    @classmethod
    def join(cls, parts: list[Modal], channels: int) -> Modal:
        """Modes of several parts, ascending."""
        poles = np.concatenate([np.zeros(0, complex), *(part.poles for part in parts)])
        A = np.concatenate([np.zeros((0, channels), complex), *(part.A for part in parts)])
        order = np.argsort(poles.imag)
        return cls(poles[order], A[order])


def _columns(data: Responses, poles: Array, lines: slice) -> Array:
    freq = data.freq[lines]
    window = Window(freq=freq, Y=np.zeros((len(freq), 0)), along=np.ones(len(freq)), end=data.end, leak=data.leak)
    return window.resonances(poles)[0]


def bands(data: Responses, rules: Thresholds = USUAL) -> list[tuple[slice, slice, int]]:
    """Divide the lines into bands of a few visible peaks.

    Each band has the lines within which poles count, the lines of the window around it, and its number of peaks. The
    limits are in the deepest valleys between groups of peaks.
    """
    power = np.sum(np.abs(data.Y) ** 2, axis=1)
    at, most = data.peaks.at, rules.peaks_a_band
    cuts = [0]
    start = 0
    while len(at) - start > most:
        choices = range(start + most // 2, start + most)
        valleys = [int(at[k - 1] + np.argmin(power[at[k - 1] : at[k] + 1])) for k in choices]
        best = int(np.argmin([power[v] for v in valleys]))
        cuts.append(valleys[best])
        start += most // 2 + best
    cuts.append(len(power))
    whole = []
    for low, high in pairwise(cuts):
        pieces = max(1, -(-(high - low) // (4 * EMPTY_LINES)))
        edges = np.linspace(low, high, pieces + 1).astype(int).tolist()
        for first, end in pairwise(edges):
            margin = max(rules.reach_lines, (end - first) // 12)
            window = slice(max(0, first - margin), min(len(power), end + margin))
            inside = int(np.sum((at >= window.start) & (at < window.stop)))
            whole.append((slice(first, end), window, inside))
    return whole


def first_poles(
    data: Responses, most: int | None, say: Callable[[str], None], rules: Thresholds = USUAL
) -> tuple[Array, Stabilisation]:
    """Candidate poles of all bands [rad/s], and their stabilisation diagram."""
    parts: list[Candidates] = []
    cut = bands(data, rules)
    say("poles")
    for core, window, count in each(cut, "band"):
        Y = data.along[window, None] * data.Y[window]
        found = candidates(data.freq[window], Y, count, data.end, most, rules)
        low = data.freq[core.start] if core.start else -np.inf
        high = data.freq[core.stop] if core.stop < len(data.freq) else np.inf
        inside = (found.poles.imag >= 2.0 * np.pi * low) & (found.poles.imag < 2.0 * np.pi * high)
        drawn = (found.diagram.freq >= low) & (found.diagram.freq < high)
        diagram = Stabilisation(**{name: getattr(found.diagram, name)[drawn] for name in found.diagram.__slots__})
        parts.append(Candidates(found.poles[inside], diagram))
    return np.concatenate([np.zeros(0, complex), *(p.poles for p in parts)]), Stabilisation.join(
        [p.diagram for p in parts]
    )


def with_residues(data: Responses, poles: Array, rules: Thresholds = USUAL) -> Modal:
    """Residues of poles by linear least squares with polynomials, band by band (LSFD)."""
    parts = []
    for core, window, _ in bands(data, rules):
        low, high = data.freq[window.start], data.freq[window.stop - 1]
        here = poles[(poles.imag >= 2.0 * np.pi * low) & (poles.imag <= 2.0 * np.pi * high)]
        fit = fit_poles(data.window(window, data.Y[window], rules), here, steps=0)
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


def window_about(data: Responses, poles: Array, group: IntArray, rules: Thresholds = USUAL) -> slice:
    """Lines around a group of poles: up to half of the distance to its neighbours, and some beyond."""
    step = 2.0 * np.pi * float(data.freq[1] - data.freq[0])
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


def fitted_groups(data: Responses, modes: Modal, more: bool | None, rules: Thresholds = USUAL) -> list[PoleFit]:
    """Fit all groups of modes, each with the modes of the other groups subtracted.

    If `more` is False, poles may be removed. If it is True, they may also be added. If it is None, their number is
    fixed.
    """
    step = 2.0 * np.pi * float(data.freq[1] - data.freq[0])
    return [fitted_group(data, modes, group, more, rules) for group in each(groups(modes.poles, step, rules), "group")]


def settled_fits(data: Responses, fits: list[PoleFit], rules: Thresholds = USUAL) -> list[PoleFit]:
    """Repeat the fits, each with the latest other modes subtracted, until no pole moves significantly."""
    for _ in range(SETTLING):
        again = fitted_groups(data, modal_of(fits, data.Y.shape[1]), None, rules)
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


def fitted_group(
    data: Responses, modes: Modal, group: IntArray, more: bool | None, rules: Thresholds = USUAL
) -> PoleFit:
    """Fit one group of modes, with the other modes subtracted."""
    lines = window_about(data, modes.poles, group, rules)
    others = modes.some(np.delete(np.arange(len(modes.poles)), group))
    whole = data.window(lines, data.Y[lines] - others.response(data, lines), rules)
    small = replace(whole, Y=compressed(whole.Y))
    seen = data.freq[data.peaks.at]
    here = seen[(seen >= whole.freq[0]) & (seen <= whole.freq[-1])]
    start = modes.poles[group]
    fit = fit_poles(small, start, steps=0) if more is None else counted(small, start, here, more, rules)
    small = replace(small, terms=outer_terms(fit, rules))
    if more is None or small.terms > fit.window.terms:
        fit = fit_poles(small, fit.poles)
    return fit_poles(replace(whole, terms=small.terms), fit.poles, steps=0)


def modal_of(fits: list[PoleFit], channels: int) -> Modal:
    """Modes of all fits, in ascending order."""
    return Modal.join([Modal(fit.poles, fit.A) for fit in fits], channels)


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
        lines = window_about(data, np.array([start]), np.array([0]), rules)
        window = data.window(lines, data.Y[lines] - modes.response(data, lines), rules)
        alone.append(replace(fit_poles(window, np.array([start]), steps=0), refined=False))
    return alone


def refined_end(data: Responses, poles: Array, rules: Thresholds = USUAL) -> float:
    """Refine the duration of the recorded ringing [s] so that the strongest modes fit best.

    The impulse response gives this duration to a few samples; the likelihood of the modes gives it to a fraction of a
    sample.
    """
    if not np.isfinite(data.end) or not len(poles):
        return data.end
    step = 2.0 * np.pi * float(data.freq[1] - data.freq[0])
    power = np.sum(np.abs(data.Y) ** 2, axis=1)
    at = np.clip(np.searchsorted(data.freq, poles.imag / (2.0 * np.pi)), 0, len(power) - 1)
    strongest = int(np.argmax(power[at] * np.exp(2.0 * poles.real * data.end)))
    group = next(g for g in groups(poles, step, rules) if strongest in g)
    lines = window_about(data, poles, group, rules)
    Y = compressed(data.Y[lines])
    sample = 1.0 / float(data.freq[-1] - data.freq[0])
    best, reach = data.end, max(3.0, len(data.freq) / 60.0) * sample * 1.5
    while reach > 0.02 * sample:
        tried = best + reach * np.linspace(-1.0, 1.0, 9)
        fits = [fit_poles(data._replace(end=end).window(lines, Y), poles[group], steps=8) for end in tried.tolist()]
        k = int(np.argmin([fit.squares for fit in fits]))
        best, reach = float(tried[k]), reach / 3.0
    return best


def leaks(tests: list[tuple[Responses, Modal]], rules: Thresholds = USUAL) -> bool:
    """Decide from the strongest modes of all set-ups whether a Hann window leaks over neighbouring lines.

    Up to eight groups of each set-up are fitted with and without the window. The window is accepted if it lowers the
    sum of squares of more than half of the groups, and if the total decrease is more than one pole would have to give.
    """
    falls: list[float] = []
    for data, modes in tests:
        if np.isfinite(data.end):
            return False
        step = float(data.freq[1] - data.freq[0])
        strength = np.sum(np.abs(modes.A) ** 2, axis=1)
        ranked = sorted(groups(modes.poles, 2.0 * np.pi * step, rules), key=lambda g: -float(strength[g].max()))
        for group in ranked[:8]:
            lines = window_about(data, modes.poles, group, rules)
            others = modes.some(np.delete(np.arange(len(modes.poles)), group))
            Y = compressed(data.Y[lines] - others.response(data, lines))
            plain, wide = (
                fit_poles(data._replace(leak=leak).window(lines, Y, rules), modes.poles[group]) for leak in (0.0, step)
            )
            falls.append((plain.squares - wide.squares) / float(max(plain.noise.max(), wide.noise.max())))
    least = asked(max((data.Y.shape[1] for data, _ in tests), default=1), rules)
    return sum(falls) > least and sum(fall > 0.0 for fall in falls) > 0.5 * len(falls)
