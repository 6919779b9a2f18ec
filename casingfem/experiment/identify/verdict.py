"""Verdict on each mode: sure, or doubtful with reasons and remedies."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from casingfem.experiment.identify.counting import repeated, widths
from casingfem.experiment.identify.mode import Mode
from casingfem.experiment.identify.pole_fit import PoleFit
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import IntArray

FEW = 6  # channels from which on they confirm each other; fewer need clearer peaks
MANY = 8  # channels from which on a mode can be local
NEAR_COPY = 2.0  # bandwidths within which a mode may be that of another set-up
UNSEEN, DEVIATIONS = 0.1, 3.0  # of one mode at a sensor: share of the other mode; its own standard deviations
PURE = 0.9  # share of n from which a shape is that of a mode
HALF = 0.5  # bandwidths within which two modes may be one; assurance above which shapes are similar
SAME = 2.0  # standard deviations within which two frequencies do not differ


def reasons(fit: PoleFit, phases: list[float], rules: Thresholds = USUAL) -> list[str]:
    """Reasons why each pole of a fit is doubtful, "" for a sure one.

    `phases` are the shares of the shapes' energy that are in phase.
    """
    twice = repeated(fit, rules)
    return ["; ".join(_reasons(fit, k, phases[k], bool(twice[k]), rules)) for k in range(len(fit))]


def _reasons(fit: PoleFit, k: int, phase: float, twice: bool, rules: Thresholds) -> Iterator[str]:
    wide = float(widths(fit.poles)[k]) / (2.0 * np.pi)
    lines = wide * 2.0 * np.pi / fit.window.step
    by_freq, by_zeta = (0.5 * float(fit.sigma[0, k]), float(fit.sigma[1, k]))
    size = np.abs(fit.A[k]) ** 2
    share = float(size.sum() ** 2 / (np.sum(size**2) + 1e-300)) / len(size)
    channels = len(size)
    seconds = 4.0 / max(wide, 1e-9)
    if not fit.refined:
        yield (
            "its peak does not have the shape of a resonance: noise, a tone, or a structure that is not linear? Measure"
            " again with more averages, and with another force"
        )
        return
    if lines < rules.narrow and _one_line(fit, k):
        yield "one line without skirts: mains hum or another tone? Measure again at another time"
        return
    if by_freq > rules.sure_freq:
        yield (
            f"its frequency is known to {100.0 * by_freq:.0f} % of its bandwidth only: measure longer, more averages,"
            " or another reference"
        )
    if by_zeta > rules.known_zeta:
        if lines < rules.narrow:
            yield (
                f"its damping is uncertain by {100.0 * by_zeta:.0f} %: the bandwidth is {lines:.2g} lines; a record of"
                f" {seconds:.2g} s would show it"
            )
        else:
            yield f"its damping is uncertain by {100.0 * by_zeta:.0f} %: measure longer, or more averages"
    zeta = float(-fit.poles[k].real / abs(fit.poles[k]))
    if zeta > rules.damped:
        yield f"its damping of {100.0 * zeta:.2g} % is that of a residual, or of several modes"
    ratio = float(fit.peaks[k] / np.sqrt(fit.local[k]))
    least = rules.sure_peak * max(1.0, FEW / channels)
    if ratio < least:
        few = f" in {channels} channel{'s' * (channels > 1)}" if channels < FEW else ""
        yield f"its peak is {ratio:.2g} times what the fit leaves there{few}, {least:.2g} are needed: use more sensors"
    if phase < rules.in_phase:
        yield f"only {100.0 * phase:.0f} % of its shape is in phase: two modes, or a sensor's phase?"
    if channels >= MANY and share < rules.local:
        yield (
            f"only {max(1, round(share * channels))} of {channels} channels see it: a local mode, of a fixture or a"
            " sensor's mount?"
        )
    if twice:
        yield "it repeats the shape of a stronger mode within a bandwidth: one mode? Check for loose parts or level"


def without_copies(modes: list[Mode], directions: IntArray) -> list[Mode]:
    """The modes (ascending); of two close modes that no sensor sees together, the weaker one is doubtful.

    Two unrecognised set-ups of few modes give such copies. Modes of pure n, or of different `directions` (sensors,),
    are no copies.
    """
    text = "no sensor sees both it and the mode at {:.2f} Hz: one mode in two set-ups? Measure all sensors at once"
    return _weaker(modes, lambda k, j: text if _apart(modes[k], modes[j], directions) else "")


def without_twins(modes: list[Mode], doublets: tuple[tuple[int, int], ...]) -> list[Mode]:
    """Mark the weaker of two modes (ascending) within half a bandwidth that may be one resonance as doubtful.

    A resonance leaves two poles if its peak moves from hit to hit, or if it is not linear. The shapes of the two poles
    are then similar, or their frequencies do not differ. Shapes of normal modes are nearly orthogonal at many sensors:
    of random shapes at 8 sensors 3 % have an assurance above 0.5. The two modes of a doublet are kept, and modes of
    nodal diameters may have one frequency.
    """

    def why(k: int, j: int) -> str:
        one, other = modes[k], modes[j]
        gap = other.freq - one.freq
        if (k, j) in doublets or gap > HALF * 2.0 * min(one.zeta * one.freq, other.zeta * other.freq):
            return ""
        if len(one.shape) >= MANY and float(one.shape @ other.shape) ** 2 > HALF:
            return (
                "its shape and frequency are nearly those of the stronger mode at {:.2f} Hz: one mode that differs from"
                " hit to hit or with the force? Check for loose parts or level"
            )
        waves = min(one.n, other.n) > 0  # modes of a circle come in pairs
        same = not waves and gap < SAME * float(np.hypot(one.sigma_freq, other.sigma_freq))
        return (
            "its frequency is that of the stronger mode at {:.2f} Hz within their uncertainty: one peak that is not"
            " that of a linear resonance? Measure with another force, or another reference"
        ) if same else ""  # fmt: skip

    return _weaker(modes, why)


def _weaker(modes: list[Mode], why: Callable[[int, int], str]) -> list[Mode]:
    """Give the weaker of two close modes (ascending) a reason, its own or that of `why` (lower, upper)."""
    done = list(modes)
    for k, one in enumerate(modes):
        for j in range(k + 1, len(modes)):
            other = modes[j]
            if other.freq - one.freq > NEAR_COPY * 2.0 * max(one.zeta * one.freq, other.zeta * other.freq):
                break
            weaker, at = min((k, other), (j, one), key=lambda m: (not modes[m[0]].reason, modes[m[0]].signal))
            if not done[weaker].reason and (text := why(k, j)):
                done[weaker] = replace(done[weaker], reason=text.format(at.freq))
    return done


def _apart(one: Mode, other: Mode, directions: IntArray) -> bool:
    """Whether each sensor sees only one of two modes, and neither is the mode of a circle or of a direction."""
    if min(one.purity, other.purity) > PURE:
        return False
    sizes = [np.abs(mode.shape) for mode in (one, other)]
    seen = [size > np.maximum(UNSEEN * size.max(), DEVIATIONS * mode.sigma_shape)
            for size, mode in zip(sizes, (one, other), strict=True)]  # fmt: skip
    if np.any(seen[0] & seen[1]) or not (seen[0].any() and seen[1].any()):
        return False
    first, second = (np.abs(directions[some]) for some in seen)
    return bool(np.isin(first, second).any())


def _one_line(fit: PoleFit, k: int) -> bool:
    """Whether the peak is a single line: the neighbouring lines are not above the residual of the fit."""
    at = int(np.argmin(np.abs(2.0 * np.pi * fit.window.freq - fit.poles[k].imag)))
    column = fit.window.resonances(fit.poles[[k]])[0][:, 0]
    size = float(np.sqrt(np.mean(np.abs(fit.A[k]) ** 2) / 2.0))
    beside = [j for j in (at - 1, at + 1) if 0 <= j < len(column)]
    skirts = float(np.max(np.abs(column[beside]))) * size
    rest = float(np.sqrt(0.5 * np.mean(np.abs(fit.rest[beside]) ** 2)))
    return skirts < 3.0 * max(rest, 1.0) or abs(column[at]) > 30.0 * np.max(np.abs(column[beside]))
