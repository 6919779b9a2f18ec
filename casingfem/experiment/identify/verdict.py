"""How sure a mode is: sure, doubtful with the reasons in words, or left out.

A pole may lower the sum of squares and yet be no mode: it follows what the model lacks. Each test below asks for what
a mode has beyond that; one that fails two limits by far is left out.
"""

from collections.abc import Iterator

import numpy as np

from casingfem.experiment.identify.poles.bands import line_noise
from casingfem.experiment.identify.poles.pole_fit import PoleFit
from casingfem.experiment.identify.poles.pole_selection import (
    NARROW,
    WIDE,
    cut_off,
    gains,
    has_skirts,
    lines_high,
    lines_of,
    near,
    noise_at,
    penalty,
)

FREQ = 0.1, 0.5  # standard deviation of the frequency over the half-power bandwidth, or a line: doubtful, left out
ZETA = 0.08, 0.6  # of ln zeta
DAMPED = 0.06, 0.3  # damping ratio
CLOSE, KNOWN = 1.0, 1.5e-4  # bandwidths to a neighbour, within which ln f is doubtful beyond that standard deviation
RIVAL = 2e-4  # of ln f, beyond which another reading of the set-ups that may well be makes it doubtful
GAIN = 3.0, 0.0  # fall of the sum of squares over what a pole must bring
PEAK = 3.0, 0.5  # peak over the fit's deviation about it, both rms over the channels; more where these are few
CONFIRM = 6  # channels that confirm each other: of fewer a peak must be higher
IN_PHASE = 0.6, 0.0  # share of the shape's energy that is in phase
BESIDE = 3.0, 6, 0.8  # bandwidths to a stronger neighbour; channels below which shapes say nothing; MAC, else
WITHIN = 0.5  # bandwidths, within which one of the same shape is doubtful however high
MISFIT = 3.0, 6.0, 0.7  # squares over the noise's about a pole; bandwidths to a neighbour whose peak is so much larger
LEAST_LINES = 8  # about a pole, that tell its noise
SEEN = 0.3  # share of the set-ups that have the energy: of a peak that lies elsewhere in the others
FEW = 0.12, 8  # share of the channels that has the energy: of a local mode; from so many channels on


def verdicts(fit: PoleFit, collinearity: list[float]) -> list[tuple[str, bool]]:
    """For each pole of a fit what is doubtful about it, "" where nothing is, and whether it is to be left out."""
    worth = np.maximum(gains(fit) / penalty(fit.window), fit.worth)
    found = []
    for pole, phase in enumerate(collinearity):
        reasons = [*_reasons(fit, pole, float(worth[pole]), phase), *_close(fit, pole), *_beside(fit, pole)]
        found.append(("; ".join(text for text, _ in reasons), any(out for _, out in reasons)))
    return found


def _reasons(fit: PoleFit, pole: int, worth: float, phase: float) -> Iterator[tuple[str, bool]]:
    """What speaks against a pole, and whether so much that it is left out."""
    f, zeta = float(fit.freq[pole]), float(fit.zeta[pole])
    variance = fit.noise * np.diag(fit.covariance)
    lines = float(lines_of(fit)[pole])
    cut = cut_off(fit, pole)
    freq = float(np.sqrt(variance[pole])) / (2.0 * zeta) * min(lines, 1.0)
    damping = float(np.hypot(np.sqrt(variance[len(fit.freq) + pole]), cut[1] / zeta))
    narrow = lines < NARROW
    size = np.linalg.norm(fit.A[pole], axis=0)
    peak = float(np.sqrt(np.mean(size**2))) * (f / fit.window.scale) ** fit.window.power / (2.0 * zeta)
    ratio = peak / np.sqrt(2.0 * noise_at(fit, pole))
    share = float(np.sum(size**2) ** 2 / np.sum(size**4)) / len(size)
    if freq > FREQ[0]:
        yield f"frequency uncertain by {freq:.2g} of {'a line' if narrow else 'its bandwidth'}", freq > FREQ[1]
    if narrow and not has_skirts(fit, pole):
        yield f"bandwidth of {lines:.2g} lines, no skirts beyond the nearest: hum?", True
    elif narrow and (high := lines_high(fit, pole)) >= WIDE:
        yield f"damping: {high} lines have half the peak's power, one explains it best: noise on the peak?", False
    elif narrow:
        least = 100.0 * zeta * (1.0 + 2.0 * damping)
        yield f"damping: narrower than the lines ({lines:.2g}), below {least:.2g} %", False
    elif damping > ZETA[0]:
        yield f"damping uncertain by {100.0 * damping:.0f} %", damping > ZETA[1]
    if zeta > DAMPED[0]:
        yield f"damping of {100.0 * zeta:.2g} %", zeta > DAMPED[1]
    if worth < GAIN[0]:
        yield "hardly above what the fit leaves, whose lines are alike", False
    asked = PEAK[0] * max(1.0, CONFIRM / len(size))
    if ratio < asked:
        few = f", in {len(size)} channel{'s' * (len(size) > 1)}: {asked:.2g} are asked for" if ratio >= PEAK[0] else ""
        yield f"peak {ratio:.2g} times what the fit leaves there{few}", ratio < PEAK[1]
    if phase < IN_PHASE[0]:
        yield f"only {100.0 * phase:.0f} % of its shape in phase", False
    if fit.seen[pole] < SEEN:
        yield f"seen in {100.0 * fit.seen[pole]:.0f} % of the set-ups: a peak of another mode there?", False
    if len(size) >= FEW[1] and share < FEW[0]:
        yield f"seen by {max(1, round(share * len(size)))} of {len(size)} channels: local, of a fixture?", False


def _close(fit: PoleFit, pole: int) -> Iterator[tuple[str, bool]]:
    """Whether a neighbour is so close that the frequency is not known well, though to a part of the bandwidth."""
    gaps = np.abs(np.delete(fit.freq, pole) - fit.freq[pole]) / (2.0 * fit.zeta[pole] * fit.freq[pole])
    sigma = float(np.hypot(np.sqrt(fit.noise * fit.covariance[pole, pole]), fit.matching[pole]))
    if gaps.size and gaps.min() < CLOSE and sigma > KNOWN:
        yield f"frequency uncertain by {100.0 * sigma:.2g} %: the next mode is {gaps.min():.2g} bandwidths away", False
    elif fit.rival[pole] > RIVAL:
        yield f"frequency: the set-ups can nearly as well be read {100.0 * fit.rival[pole]:.2g} % off", False


def _beside(fit: PoleFit, pole: int) -> Iterator[tuple[str, bool]]:
    """Whether a stronger neighbour's peak, which the fit may not follow, explains a pole."""
    peaks = np.linalg.norm(fit.A.reshape(len(fit.A), -1), axis=1) / fit.zeta
    shapes = fit.A[:, 0] + 1j * fit.A[:, 1] if fit.A.shape[1] == 2 else fit.A[:, 0]  # in units of the noise
    misfit = _misfit(fit, pole)
    for other in np.flatnonzero((peaks > peaks[pole]) & (fit.zeta < DAMPED[0])).tolist():
        width = 2.0 * np.sqrt(fit.zeta[pole] * fit.freq[pole] * fit.zeta[other] * fit.freq[other])
        gap = abs(float(fit.freq[pole] - fit.freq[other]))
        away = gap / width
        skirt = peaks[other] / np.hypot(1.0, gap / (fit.zeta[other] * fit.freq[other]))  # a misfit of it is lower
        low = away < WITHIN or peaks[pole] < skirt
        mac = abs(np.vdot(shapes[pole], shapes[other])) ** 2
        alike = mac > BESIDE[2] * np.vdot(shapes[pole], shapes[pole]).real * np.vdot(shapes[other], shapes[other]).real
        if away < BESIDE[0] and ((alike and low) or shapes.shape[1] < BESIDE[1]):
            why = "of the same shape" if shapes.shape[1] >= BESIDE[1] else "too few channels to tell their shapes"
            yield f"{away:.1f} bandwidths from the stronger mode at {fit.freq[other]:.2f} Hz, {why}: one mode?", False
            return
        if misfit > MISFIT[0] and away < MISFIT[1] and peaks[pole] < MISFIT[2] * peaks[other]:
            left = f"where the fit leaves {np.sqrt(misfit):.1f} times the noise"
            yield f"beside the stronger mode at {fit.freq[other]:.2f} Hz, {left}", False
            return


def _misfit(fit: PoleFit, pole: int) -> float:
    """Mean square of the deviation about a pole over that of the noise, by differences between neighbouring lines."""
    about = near(fit, pole)
    if len(about) < LEAST_LINES:
        return 0.0
    noise = max(float(np.mean(line_noise(about.T) ** 2)), fit.window.floor**2, 1e-300)
    return 0.5 * float(np.mean(np.abs(about) ** 2)) / noise
