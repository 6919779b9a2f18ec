"""One mode where a peak lies at different frequencies in the channels of one test.

Channels that are measured one after another see a mode at slightly different frequencies. A fit of all channels then
has several poles at one peak. With k poles of all C channels it has k (2 C + 2) real parameters. One mode with a
frequency of its own in each channel, and one damping ratio, has 3 C + 1. The model of the smaller information criterion
(Schwarz, Ann. Stat. 6, 1978, 461) is kept,

    N ln max(R/N, 1) + m ln N,

R the sum of squares of N real numbers over the noise, m the parameters. Few models of a measured peak are exact: if
the fit of k poles leaves more than `inexact` times the noise, the noise is at least `misfit` of the peak. Two modes
that a person sees leave more. On a circle of sensors modes come in pairs of nearly one frequency, so this step is left
out there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from casingfem.experiment.identify.pole_fit import PoleFit, State, finished, refined, state, widths
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, IntArray


def one_a_peak(fit: PoleFit, directions: IntArray, rules: Thresholds = USUAL) -> tuple[PoleFit, tuple[str, ...]]:
    """The fit with one mode at each peak that differs between channels, and notes.

    `directions` (channels,) are those of the sensors: modes of different directions are not one.
    """
    notes, tried = list[str](), list[complex]()
    while fit.refined and (group := _group(fit, tried, rules)) is not None:
        tried += fit.poles[group].tolist()
        strongest = np.abs(fit.A[group]).argmax(axis=1)
        if len(np.unique(np.abs(directions[strongest]))) > 1:
            continue
        own = _each_alone(fit, group, _most(fit, group, rules))
        if own:
            fit, note = _as_one(fit, group, own)
            notes.append(note)
    return fit, tuple(notes)


def _group(fit: PoleFit, tried: list[complex], rules: Thresholds) -> IntArray | None:
    """The strongest pole that is not `tried` yet and has weaker poles within its bandwidth, with these, ascending."""
    for k in np.argsort(-fit.peaks).tolist():
        near = np.abs(fit.poles.imag - fit.poles[k].imag) < rules.near * widths(fit.poles)[k]
        group = np.flatnonzero(near & (fit.peaks <= fit.peaks[k]))
        if fit.poles[k] not in tried and len(group) > 1:
            return group
    return None


def _most(fit: PoleFit, group: IntArray, rules: Thresholds) -> float:
    """Sum of squares below which one mode in place of a group has the smaller information criterion."""
    count, channels = 2.0 * fit.window.Y.size, fit.window.Y.shape[1]
    noise = count
    if fit.squares > rules.inexact * count:
        noise = max(count, rules.misfit**2 * float(np.sum(np.abs(_response(fit, group)) ** 2)))
    fewer = len(group) * (2 * channels + 2) - (3 * channels + 1)
    return float(max(fit.squares, noise) * count ** (fewer / count))


def _each_alone(fit: PoleFit, group: IntArray, most: float) -> list[State]:
    """One pole of each channel in place of a group, of one damping ratio; none if their squares are above `most`.

    The other poles are subtracted. The strongest channels are fitted first: they leave the most.
    """
    inside = _response(fit, group)
    Y = fit.rest + inside + fit.window.polynomials @ fit.B
    weights = np.sum(np.abs(fit.A[group]) ** 2, axis=1)
    start, total = np.array([weights @ fit.poles[group] / weights.sum()]), 0.0
    windows = [replace(fit.window, Y=Y[:, [k]]) for k in range(Y.shape[1])]
    omega, decay, size = np.zeros((3, len(windows)))
    for k in np.argsort(-np.sum(np.abs(inside) ** 2, axis=0)).tolist():
        at = refined(windows[k], start)
        total += at.squares
        if total >= most:
            return []
        omega[k], decay[k], size[k] = at.poles[0].imag, np.log(-at.poles[0].real), np.abs(at.A[0, 0]) ** 2
    sigma = np.exp(np.average(decay, weights=size + 1e-300))
    own = [state(w, np.array([-sigma + 1j * at]), w.polynomials) for w, at in zip(windows, omega, strict=True)]
    return own if sum(each.squares for each in own) < most else []


def _response(fit: PoleFit, group: IntArray) -> Array:
    return fit.window.resonances(fit.poles[group])[0] @ fit.A[group]


def _as_one(fit: PoleFit, group: IntArray, own: list[State]) -> tuple[PoleFit, str]:
    """The fit with one mode in place of a group, at the mean frequency of the channels by energy, and a note."""
    A, poles = np.array([each.A[0, 0] for each in own]), np.array([each.poles[0] for each in own])
    share = np.abs(A) ** 2 / np.sum(np.abs(A) ** 2)
    omega = float(share @ poles.imag)
    mean, scatter = complex(poles[0].real, omega), float(np.sqrt(share @ (poles.imag - omega) ** 2))
    kept = np.delete(np.arange(len(fit)), group)
    at = state(fit.window, np.append(fit.poles[kept], mean), fit.window.polynomials)
    rest = np.concatenate([each.rest for each in own], axis=1)
    beside = np.concatenate([each.A[1:] for each in own], axis=1)
    one = finished(
        fit.window,
        at._replace(
            A=np.concatenate([fit.A[kept], A[None], beside]), rest=rest, squares=float(np.vdot(rest, rest).real)
        ),
    )
    k = int(np.argmin(np.abs(one.poles - mean)))
    scores = one.scores.copy()
    scores[k, k] = max(scores[k, k], (scatter / mean.real) ** 2 * float(share @ share))
    note = (
        f"the peak at {abs(mean) / (2.0 * np.pi):.2f} Hz differs between channels, by {100.0 * scatter / mean.imag:.2g}"
        " % (standard deviation); it is given as one mode. Measure all channels at once; if it may be a pair, add a"
        " reference"
    )
    return replace(one, scores=scores), note
