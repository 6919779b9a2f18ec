"""From fitted poles to modes: those of each band's core, once, labelled, with partners and what could have been missed.

A response that was multiplied by exp(-t/tau) before its transform, by an exponential window, has its poles moved by
-1/tau: measured is p - 1/tau, so that the damping ratio is too high by 1/(tau omega), nearly. Residues stay.
"""

from dataclasses import dataclass, replace

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.circle.orientation import Circle, Label, quadrature
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.sensor_grid import SensorGrid
from casingfem.experiment.identify.mode_shapes import mode_shape, residue_matrix
from casingfem.experiment.identify.poles.pole_fit import PoleFit
from casingfem.experiment.identify.poles.pole_selection import cut_off, hidden_split
from casingfem.experiment.identify.verdict import verdicts
from casingfem.io.arrays import Array, FloatArray, IntArray

BALANCE = 0.2  # least `balance` of a shape that is two
CHANCE = 25.0  # chi-squared, two degrees of freedom, below which two poles are not told apart
CANCEL = 0.1  # of the residues of two neighbours, that is left of their sum
PAIR_SPAN = 0.3  # relative split beyond which two modes of one n are no pair
APART = 0.7  # least quadrature of partners
ENTRY = "exponential_window_s"  # of a card
TELLS = 2.0  # standard deviations that damping must be above zero


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FoundMode:
    """One mode, or a pair that is not resolved; see `Identified` for the names.

    `double` says that the residues hold two shapes: the mode is a pair, unless its partner stands elsewhere.
    """

    freq: float
    sigma_freq: float
    zeta: float
    sigma_zeta: float
    n: int
    purity: float
    angle: float
    sigma_angle: float
    shape: FloatArray
    sigma_shape: FloatArray
    residues: Array
    residue_scale: float
    collinearity: float
    signal: float
    split_bound: float
    double: bool
    doubt: str = ""
    unresolved: bool = False


def found_modes(
    fits: list[PoleFit],
    cores: list[tuple[float, float]],
    grid: SensorGrid,
    signs: FloatArray,
    circle: Circle | None,
    keep: bool = False,
    belong: IntArray | None = None,
) -> tuple[list[FoundMode], tuple[str, ...]]:
    """Modes of all bands, ascending, and what was left out, in words; one that two bands found counts once.

    With `keep` nothing is left out, and neighbours stay two: they were picked. The circle has the sensors that
    `belong` there, all if None.
    """
    modes: list[FoundMode] = []
    left_out: list[tuple[float, str]] = []
    for fit, (low, high) in zip(fits, cores, strict=True):
        here = [_mode(fit, pole, grid, signs, circle, belong) for pole in range(len(fit.freq))]
        judged = verdicts(fit, [mode.collinearity for mode in here])
        gone = [k for k, (_, out) in enumerate(judged) if out and not keep]
        left_out += [(here[k].freq, judged[k][0]) for k in gone if low <= here[k].freq < high]
        here = [replace(mode, doubt=doubt) for mode, (doubt, _) in zip(here, judged, strict=True)]
        here = here if keep else _merged(fit, here, gone)
        inside = [mode for mode in here if low <= mode.freq < high]
        modes += [mode for mode in inside if not (modes and _same(modes[-1], mode))]
    words = tuple(f"left out: {freq:.2f} Hz, {why}" for freq, why in sorted(left_out))
    return sorted(modes, key=lambda mode: mode.freq), words


def _same(first: FoundMode, second: FoundMode) -> bool:
    near = abs(first.freq - second.freq) < 0.5 * first.zeta * first.freq
    return near and abs(float(first.shape @ second.shape)) > 0.9


def _mode(
    fit: PoleFit, pole: int, grid: SensorGrid, signs: FloatArray, circle: Circle | None, belong: IntArray | None
) -> FoundMode:
    shape = mode_shape(fit, pole, grid.channels)
    sigma = np.sqrt(np.maximum(fit.noise * np.diag(fit.covariance), 0.0))
    freq, zeta = float(fit.freq[pole]), float(fit.zeta[pole])
    cut = cut_off(fit, pole)
    label = Label(-1, *[float("nan")] * 3)
    if circle is not None:
        some = np.arange(len(signs)) if belong is None else belong
        covariance = (shape.covariance * np.outer(signs, signs))[np.ix_(some, some)]
        label = circle.label((shape.values * signs)[some], covariance)
    peak = np.linalg.norm(fit.A[pole]) / (2.0 * zeta) * (freq / fit.window.scale) ** fit.window.power
    double = shape.second > 1.0 and shape.balance > BALANCE
    return FoundMode(
        freq=freq,
        sigma_freq=freq * float(np.linalg.norm([sigma[pole], fit.matching[pole], cut[0]])),
        zeta=zeta,
        sigma_zeta=float(np.hypot(sigma[len(fit.freq) + pole] * zeta, cut[1])),
        n=label.n,
        purity=label.purity,
        angle=label.angle,
        sigma_angle=label.sigma,
        shape=shape.values,
        sigma_shape=np.sqrt(np.diag(shape.covariance)),
        residues=residue_matrix(fit, pole, grid.channels),
        residue_scale=fit.window.scale,
        collinearity=shape.collinearity,
        signal=float(peak / np.sqrt(2.0 * fit.noise * fit.A.shape[2])),
        split_bound=hidden_split(fit, pole) / (shape.balance if double else 1.0),
        double=double,
    )


def _merged(fit: PoleFit, modes: list[FoundMode], gone: list[int]) -> list[FoundMode]:
    """Put neighbours whose poles differ by no more than chance into one: a pair whose members are not told apart."""
    distinct: list[FoundMode] = []
    last = -2
    for k, mode in enumerate(modes):
        if k in gone:
            last = k
        elif k and last != k - 1 and mode.n == modes[k - 1].n and not _distinct(fit, k - 1, k):
            distinct[-1] = _one_of(fit, modes, k - 1, k)
            last = k
        else:
            distinct.append(mode)
    return distinct


def _distinct(fit: PoleFit, low: int, high: int) -> bool:
    """Whether two neighbouring poles differ in frequency or damping by more than chance allows, in any set-up."""
    if fit.apart[low] > CHANCE:
        return True
    if fit.freq[high] - fit.freq[low] > 2.0 * max(fit.zeta[low], fit.zeta[high]) * fit.freq[low]:
        return True
    if _left_of(fit, low, high) < CANCEL:
        return False  # a double pole: of how far apart they are and how large, the data tell the product alone
    m = len(fit.freq)
    change = np.zeros((2, 2 * m))
    change[[0, 1], [low, m + low]], change[[0, 1], [high, m + high]] = -1.0, 1.0
    gap = change @ np.log(np.r_[fit.freq, fit.zeta])
    covariance = fit.noise * change @ fit.covariance @ change.T
    return bool(gap @ np.linalg.solve(covariance, gap) > CHANCE)


def _left_of(fit: PoleFit, low: int, high: int) -> float:
    """What is left of the residues of two poles in their sum."""
    return float(np.linalg.norm(fit.A[low] + fit.A[high]) / (np.linalg.norm(fit.A[low]) + np.linalg.norm(fit.A[high])))


def _one_of(fit: PoleFit, modes: list[FoundMode], low: int, high: int) -> FoundMode:
    """The best common pole of two, by their covariance; for a pair that is not told apart."""
    m = len(fit.freq)
    values = []
    for at, logs in (([low, high], np.log(fit.freq)), ([m + low, m + high], np.log(fit.zeta))):
        covariance = fit.noise * fit.covariance[np.ix_(at, at)]
        weights = np.linalg.solve(covariance, np.ones(2))
        gap = np.sqrt(np.array([-1.0, 1.0]) @ covariance @ np.array([-1.0, 1.0]))
        values.append((float(np.exp(weights @ logs[[low, high]] / weights.sum())), 1.0 / np.sqrt(weights.sum()), gap))
    (freq, sigma, gap), (zeta, sigma_zeta, _) = values
    left = _left_of(fit, low, high)
    bound = float(np.log(fit.freq[high] / fit.freq[low]) / (left if left < CANCEL else 1.0) + 2.0 * gap)
    stronger = modes[low] if modes[low].signal > modes[high].signal else modes[high]
    one = replace(stronger, freq=freq, sigma_freq=float(freq * sigma), zeta=zeta, sigma_zeta=float(zeta * sigma_zeta))
    return replace(without_antinode(replace(one, split_bound=bound)), unresolved=True)


def without_antinode(mode: FoundMode) -> FoundMode:
    """A mode that may stand for a pair: without orientation, and uncertain by half the largest split."""
    nothing = float("nan")
    sigma = float(np.hypot(mode.sigma_freq, 0.5 * mode.split_bound * mode.freq))
    return replace(mode, sigma_freq=sigma, angle=nothing, sigma_angle=nothing)


def paired(modes: list[FoundMode]) -> tuple[tuple[int, int], ...]:
    """Doublets (lower, upper): neighbours of the same n a quarter wave apart."""
    pairs, taken = [], set[int]()
    for k, mode in enumerate(modes):
        if k in taken or mode.n < 1 or mode.unresolved:
            continue
        later = (m for m in range(k + 1, len(modes)) if m not in taken and not modes[m].unresolved)
        partner = next((m for m in later if modes[m].n == mode.n), None)
        if partner is None or modes[partner].freq - mode.freq > PAIR_SPAN * mode.freq:
            continue
        if quadrature(mode.angle, modes[partner].angle, mode.n) > APART:
            pairs.append((k, partner))
            taken |= {k, partner}
    return tuple(pairs)


def settled(modes: list[FoundMode], doublets: tuple[tuple[int, int], ...]) -> list[FoundMode]:
    """The modes, where those that hold two shapes and have no partner stand for a pair.

    A mode of n >= 1 without partner may be a pair that the references drive in one plane only: it has the antinode
    of the drive then, so none is given, and its frequency is uncertain by half the split that would be hidden.
    """
    members = {k for pair in doublets for k in pair}
    alone = [k not in members and mode.n > 0 and not mode.unresolved for k, mode in enumerate(modes)]
    return [
        replace(without_antinode(mode), unresolved=mode.double) if single else mode
        for mode, single in zip(modes, alone, strict=True)
    ]


def notes_of(modes: list[FoundMode], doublets: tuple[tuple[int, int], ...]) -> tuple[str, ...]:
    """What cannot be told apart, in words."""
    members = {k for pair in doublets for k in pair}
    notes = []
    for k, mode in enumerate(modes):
        share = mode.split_bound / (2.0 * mode.zeta)
        if mode.unresolved:
            notes.append(
                f"pair at {mode.freq:.2f} Hz: split below {share:.2g} of its bandwidth ({mode.split_bound:.1e}"
                " relative), given as one frequency"
            )
        elif mode.n > 0 and k not in members:
            notes.append(
                f"n = {mode.n} at {mode.freq:.2f} Hz has no partner: the references do not drive it, or the split is"
                f" below {share:.2g} of its bandwidth ({mode.split_bound:.1e} relative); no orientation is given"
            )
    return tuple(notes)


def window_time(frfs: FrfSet, given: float | None) -> float | None:
    """Time constant [s] of the exponential window: as given, or from the card `exponential_window_s: 2.0`, or None.

    >>> card = ["exponential_window_s: 2.0"]
    >>> window_time(FrfSet.from_arrays(kind="frf", x=[1.0], responses=[[1j]], unit="m/N", card=card), None)
    2.0
    """
    entries = [value.strip() for key, _, value in (line.partition(":") for line in frfs.card) if key.strip() == ENTRY]
    if given is None and not entries:
        return None
    word = repr(given) if given is not None else entries[-1]
    try:
        tau = float(word)
    except ValueError:
        tau = np.nan
    if not (np.isfinite(tau) and tau > 0.0):
        raise InputError(frfs.path, found=f"{ENTRY} {word}", expected="the window's time constant [s], above 0")
    return tau


def without_window(modes: list[FoundMode], tau: float) -> list[FoundMode]:
    """Modes of poles p + 1/tau; damping that is not above zero is doubtful, and is given as zero at least."""
    return [_without(mode, tau) for mode in modes]


def _without(mode: FoundMode, tau: float) -> FoundMode:
    omega = 2.0 * np.pi * mode.freq
    decay, damped = mode.zeta * omega - 1.0 / tau, omega * np.sqrt(1.0 - mode.zeta**2)
    own = float(np.hypot(decay, damped))
    added = f"no damping beyond the {100.0 / (tau * omega):.2g} % of the exponential window"
    unclear = decay / omega < TELLS * mode.sigma_zeta
    doubt = "; ".join(part for part in (mode.doubt, added if unclear else "") if part)
    return replace(mode, freq=own / (2.0 * np.pi), zeta=max(decay, 0.0) / own, doubt=doubt)


def window_note(tau: float) -> str:
    """What is said of the damping."""
    return f"damping is without the 1/(tau omega) of an exponential window, tau = {tau:g} s"
