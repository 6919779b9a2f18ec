"""Determine the number of poles in a window: remove poles that noise explains, add poles that the residual needs.

A pole of C channels has 2 C + 2 real parameters. It is justified when the fall of the sum of squares, over the
variance of the noise about it, is above the chi-squared value that chance exceeds once in a million; noise that is
correlated over K lines counts K times (`PoleFit.noise`). Two poles within a bandwidth must differ in shape.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import chdtri

from casingfem.experiment.identify.pole_fit import PoleFit, Window, finished, fit_poles, refined, tried, widths
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, BoolArray, FloatArray

TRY_STEPS = 12
GRID, GRID_WIDTHS = 120, (0.5, 1.0, 2.0)  # most frequencies, and dampings of the usual one, at which a pole is tried
LINEAR = 0.3  # of the decrease that justifies a pole: least decrease before the poles beside it move


def counted(
    window: Window, poles: Array, seen: FloatArray | None = None, more: bool = True, rules: Thresholds = USUAL
) -> PoleFit:
    """Fit as many poles as the data justify, from start values [rad/s].

    `seen` [Hz] are visible peaks: the last pole of a visible peak is not removed. Poles are added only with `more`.

    Examples
    --------
    >>> lines, rng = np.arange(95.0, 105.0, 0.05), np.random.default_rng(4)
    >>> poles = 2 * np.pi * np.array([-0.4 + 100.0j, -0.4 + 100.1j])
    >>> Y = (1.0 / (2j * np.pi * lines[:, None] - poles)) @ np.array([[900.0, 500.0, -200.0], [100.0, -700.0, 800.0]])
    >>> Y = Y + rng.normal(size=Y.shape) + 1j * rng.normal(size=Y.shape)
    >>> window = Window(freq=lines, Y=Y, along=np.ones(200))
    >>> (counted(window, poles[:1]).poles.imag / (2 * np.pi)).round(1).tolist()
    [100.0, 100.1]
    """
    seen = np.zeros(0) if seen is None else seen
    fit = _without_needless(fit_poles(window, poles), seen, rules)
    most = rules.together + len(poles)
    while more and len(fit) < most and (larger := _with_more(fit, seen, rules)) is not None:
        fit = larger
    return fit


def outer_terms(window: Window, poles: Array, rules: Thresholds = USUAL) -> int:
    """Number of polynomials that the residual of some poles [rad/s] needs.

    One more is added while the decrease of the sum of squares would justify a pole. Modes just outside a wide window
    leave a smooth residual, which would move the poles inside.

    Examples
    --------
    >>> lines, rng = np.arange(90.0, 110.0, 0.05), np.random.default_rng(4)
    >>> poles = 2 * np.pi * np.array([-0.4 + 100.0j, -0.4 + 113.0j])
    >>> Y = (1.0 / (2j * np.pi * lines[:, None] - poles)) @ np.array([[900.0, 500.0], [9000.0, 7000.0]])
    >>> Y = Y + rng.normal(size=Y.shape) + 1j * rng.normal(size=Y.shape)
    >>> window = Window(freq=lines, Y=Y, along=np.ones(len(lines)))
    >>> outer_terms(window, fit_poles(window, poles[:1]).poles)
    4
    """
    needed, squares = asked(window.Y.shape[1], rules), refined(window, poles, 0).squares
    while window.terms < rules.terms_most:
        more = replace(window, terms=window.terms + 1)
        at = refined(more, poles, 0)
        fall = squares - at.squares
        if fall < needed or fall < needed * float(finished(more, at).noise.max(initial=1.0)):
            break
        window, squares = more, at.squares
    return window.terms


def worth(fit: PoleFit, rules: Thresholds = USUAL) -> FloatArray:
    """Improvement by each pole relative to that expected by chance, (poles,); a pole above 1 is justified."""
    return np.asarray(fit.gains() / (fit.noise * asked(fit.window.Y.shape[1], rules)))


def asked(channels: int, rules: Thresholds = USUAL) -> float:
    """Required decrease of the sum of squares, in variances of the noise, for a pole seen by a number of channels."""
    return float(chdtri(2 * channels + 2, rules.chance))


def _without_needless(fit: PoleFit, seen: FloatArray, rules: Thresholds) -> PoleFit:
    """Remove, one by one, the least significant poles and the poles that repeat a shape."""
    while len(fit):
        value = worth(fit, rules)
        twice = repeated(fit, rules)
        value[twice] = np.minimum(value[twice], 0.5 * value[twice] / (value.max() + 1.0))
        value[undetermined(fit, rules)] *= 0.1
        value[_last_of_a_peak(fit, seen) & ~twice] = np.inf
        weakest = int(np.argmin(value))
        if value[weakest] >= 1.0:
            break
        fit = fit_poles(fit.window, np.delete(fit.poles, weakest))
    return fit


def repeated(fit: PoleFit, rules: Thresholds = USUAL) -> BoolArray:
    """For each pole whether a stronger pole within a bandwidth has the same shape, (poles,)."""
    count = len(fit)
    apart = np.abs(fit.poles.imag[:, None] - fit.poles.imag)
    wide = np.maximum(widths(fit.poles)[:, None], widths(fit.poles))
    close = (apart < rules.near * np.maximum(wide, fit.window.step)) & ~np.eye(count, dtype=bool)
    stronger = fit.peaks[None, :] > fit.peaks[:, None]
    return np.asarray((close & stronger & (fit.alike() > rules.same_shape)).any(axis=1))


def undetermined(fit: PoleFit, rules: Thresholds = USUAL) -> BoolArray:
    """Poles whose frequency or damping the data do not determine, or wider than a third of the window, (poles,)."""
    by_freq, by_zeta = fit.sigma
    wide = widths(fit.poles) > 2.0 * np.pi * (fit.window.freq[-1] - fit.window.freq[0]) / 3.0
    return np.asarray((0.5 * by_freq > rules.known_freq) | (by_zeta > rules.known_zeta) | wide)


def _last_of_a_peak(fit: PoleFit, seen: FloatArray) -> BoolArray:
    """For each pole whether it is the only one that explains a visible peak, (poles,)."""
    alone = np.zeros(len(fit), bool)
    for freq in seen.tolist():
        reach = np.maximum(widths(fit.poles), 2.0 * fit.window.step)
        near = np.flatnonzero(np.abs(fit.poles.imag - 2.0 * np.pi * freq) < reach)
        if len(near) == 1:
            alone[near] = True
    return alone


def _with_more(fit: PoleFit, seen: FloatArray, rules: Thresholds) -> PoleFit | None:
    """Add one pole, or two, if all poles are then justified; else return None.

    If two poles are missing, a single added pole lies between them: its damping is undetermined, or its shape is that
    of a neighbour. So two poles are tried where the fit leaves much more than noise.
    """
    larger = _with_one_more(fit, rules)
    if larger is None or _justified(larger, rules):
        return larger
    two = _with_one_more(larger, rules) if fit.local.max(initial=0.0) > rules.much_left else None
    if two is None:
        return None
    two = _without_needless(two, seen, rules)
    fall = fit.squares - two.squares
    return two if len(two) > len(fit) and _justified(two, rules) and fall >= _needed(two, rules) else None


def _with_one_more(fit: PoleFit, rules: Thresholds) -> PoleFit | None:
    """Add one pole if it lowers the sum of squares by more than chance; else return None."""
    start, fall = _best_start(fit)
    least = asked(fit.window.Y.shape[1], rules)
    if fall < LINEAR * least:
        return None
    poles, squares = tried(fit.window, start, TRY_STEPS)
    if fit.squares - squares < least:
        return None
    larger = fit_poles(fit.window, poles)
    return larger if fit.squares - larger.squares >= _needed(larger, rules) else None


def _needed(fit: PoleFit, rules: Thresholds) -> float:
    """Least decrease of the sum of squares that justifies a pole, in the noise about the quietest pole."""
    return float(fit.noise.min()) * asked(fit.window.Y.shape[1], rules)


def _justified(fit: PoleFit, rules: Thresholds) -> bool:
    """Whether every pole is worth its parameters, has a shape of its own, and is determined."""
    return not (worth(fit, rules).min() < 1.0 or repeated(fit, rules).any() or undetermined(fit, rules).any())


def _best_start(fit: PoleFit) -> tuple[Array, float]:
    """Start values with one more pole, and the decrease of the sum of squares there.

    With g the column of a pole, projected, and R the residual, the residues of g alone lower the sum by
    |g^H R|^2/|g|^2 (Rao's score test). The pole of the largest decrease is taken from a grid, which has the line of the
    largest residual too.
    """
    window = fit.window.merged
    low, high = (2.0 * np.pi * fit.window.freq[[0, -1]]).tolist()
    usual = float(np.median(-fit.poles.real)) if len(fit) else 2.0 * fit.window.step
    count = int(np.clip(2.0 * (high - low) / usual, 2, GRID))
    worst = 2.0 * np.pi * fit.window.freq[np.argmax(np.sum(np.abs(fit.rest) ** 2, axis=1))]
    at = np.append(np.linspace(low, high, count), worst)
    grid = np.concatenate([-usual * width + 1j * at for width in GRID_WIDTHS])
    columns = window.resonances(grid)[0]
    Q = np.linalg.qr(np.concatenate([window.resonances(fit.poles)[0], window.polynomials], axis=1))[0]
    rest = window.Y - Q @ (Q.conj().T @ window.Y)
    seen = Q.conj().T @ columns
    whole = np.sum(np.abs(columns) ** 2, axis=0)
    left = whole - np.sum(np.abs(seen) ** 2, axis=0)
    falls = np.sum(np.abs(columns.conj().T @ rest) ** 2, axis=1) / np.maximum(left, 1e-6 * whole + 1e-300)
    best = int(np.argmax(falls))
    return np.append(fit.poles, grid[best]), float(falls[best])
