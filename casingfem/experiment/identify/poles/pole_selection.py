"""How many poles a window has: poles are left out and added as long as the data say so.

The yardstick is the Bayesian information criterion (Schwarz, Ann. Statist. 6, 1978, 461): a pole stays if leaving it
out raises the sum of squares, in units of the noise, by more than (its parameters) ln(number of data). A second pole
beside the first has to earn itself the same way, so that a single mode is not split in two; two close poles with the
same shape are a misfit of one mode and are merged; so is, where channels are too few to tell shapes, a low peak within
the bandwidth of a high one. A pole whose damping nobody can tell is none, but for one narrower than the lines: that has
to earn itself by its skirts, which a single wrong line has not.
"""

from dataclasses import replace

import numpy as np

from casingfem.experiment.identify.poles.pole_fit import PoleFit, fit_poles
from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.poles.stabilisation import ZETA_MAX
from casingfem.io.arrays import Array, FloatArray

GRID = 400  # frequencies tried for a further pole
BEYOND = 0.03  # of the frequency
UNSURE = 0.3  # standard deviation of ln zeta beyond which a pole is no resonance
LEAST_GAIN = 0.25  # of the penalty, that a place must be worth by the gradient before it is tried
CHANNELS = 30, 60  # combinations of them that the search sees, where there are more than so many
MOST_LINES = 1000  # that the search sees
TRIAL_STEPS = 15  # of a fit that tries a further pole
SEARCH_STEPS = 20  # of a fit while poles come and go: with too many poles it creeps, and only the last must converge
MORE = 4  # poles that are added to half as many as the start has, at most
MOSTLY = 0.5  # of the squares that polynomials leave: what one pole explains is a peak, whatever the noise
TRIES = 3  # places tried before the search ends
NEAR, SAME = 3.0, 0.9  # half-power bandwidths; MAC
ENOUGH = 6  # channels below which shapes say nothing
LOW = 0.25  # of a higher peak within whose bandwidth, where shapes say nothing, a pole is its misfit
MISFIT = 1.3  # deviation over noise, squared, that asks for complex residues
NARROW = 1.0  # lines in a half-power bandwidth, below which skirts tell a peak, nothing its damping
SKIRT = 1.5, 3  # lines from a narrow pole, where its skirts begin; lines of a skirt on either side at least
BESIDE, WIDE = 2, 3  # lines from a narrow pole to its peak; lines of half the peak's power, that no narrow one has
LOCAL = 5.0, 12  # about a pole: half-power half-widths, lines at least


def penalty(window: Window) -> float:
    """Fall of the sum of squares, in units of the noise, that a pole must bring."""
    return float((window.Y.shape[1] * window.columns + 2) * np.log(window.Y.size))


def gains(fit: PoleFit) -> FloatArray:
    """Rise of the sum of squares, in units of the noise there, if a pole were left out and the others stayed."""
    each = range(len(fit.freq))
    rise = [np.einsum("sc,st,tc->", fit.A[k], np.linalg.inv(fit.gram[k, :, k, :]), fit.A[k]) for k in each]
    return np.array([rise[k] / noise_at(fit, k) / alike_lines(fit, k) for k in each], float)


def lines_of(fit: PoleFit) -> FloatArray:
    """Lines in the half-power bandwidth of each pole."""
    return np.asarray(2.0 * fit.zeta * fit.freq / float(fit.window.freq[1] - fit.window.freq[0]))


def has_skirts(fit: PoleFit, pole: int) -> bool:
    """Whether a pole explains, beyond the lines next to it, more than its penalty: hum or a wrong line does not."""
    window, step = fit.window, float(fit.window.freq[1] - fit.window.freq[0])
    kept = np.abs(window.freq - fit.freq[pole]) > SKIRT[0] * step
    above = int(np.sum(window.freq[kept] > fit.freq[pole]))
    if min(above, int(kept.sum()) - above) < SKIRT[1]:
        return False
    return bool(gains(fit_poles(window.cut(kept), fit.freq, fit.zeta, steps=0))[pole] > penalty(window))


def lines_high(fit: PoleFit, pole: int) -> int:
    """Lines next to each other about a pole on which the data have half the power of their highest, or more."""
    power = np.sum(np.abs(fit.window.as_complex) ** 2, axis=1)
    at = int(np.abs(fit.window.freq - fit.freq[pole]).argmin())
    low = max(at - BESIDE, 0)
    top = low + int(power[low : at + BESIDE + 1].argmax())
    below = np.flatnonzero(power < 0.5 * power[top])
    ends = np.r_[-1, below, len(power)]
    k = int(np.searchsorted(ends, top))
    return int(ends[k] - ends[k - 1] - 1)


def cut_off(fit: PoleFit, pole: int) -> tuple[float, float]:
    """Standard deviations of ln f and zeta as the record ends before the mode does.

    Of a mode's ring exp(-pi B/step) is left at the end of a record 1/step long, B its half-power bandwidth; without it
    one only knows that the peak lies between two lines, and that B is below their distance; or, where more lines are as
    high, that noise on them hides it.
    """
    ratio, lines = float(fit.window.freq[1] - fit.window.freq[0]) / fit.freq[pole], lines_of(fit)[pole]
    left = float(np.exp(-np.pi * lines))
    high = lines_high(fit, pole) if lines < NARROW else 1
    return float(ratio * left / np.sqrt(12.0)), float(0.5 * ratio * left * (high if high >= WIDE else 1))


def near(fit: PoleFit, pole: int) -> Array:
    """The deviation about a pole, (lines, channels)."""
    lines = fit.window.freq
    at = int(np.searchsorted(lines, fit.freq[pole]))
    width = max(LOCAL[1], int(LOCAL[0] * fit.zeta[pole] * fit.freq[pole] / (lines[1] - lines[0])))
    return np.asarray(fit.spread[max(at - width, 0) : at + width])


def noise_at(fit: PoleFit, pole: int) -> float:
    """Variance of an entry about a pole: noise of estimated responses is larger on peaks than on average."""
    about = near(fit, pole)
    return max(fit.noise, 0.5 * float(np.mean(np.abs(about) ** 2)) if about.size else 0.0)


def alike_lines(fit: PoleFit, pole: int) -> float:
    """Over how many lines the deviation about a pole is alike: 1 for white noise, more for what the model lacks.

    1 + 2 sum_l (1 - l/L) rho_l with the autocorrelation rho over the lines, up to L = a half-power bandwidth.
    """
    about, step = near(fit, pole), float(fit.window.freq[1] - fit.window.freq[0])
    most = min(int(2.0 * fit.zeta[pole] * fit.freq[pole] / step), len(about) // 3)
    whole = float(np.sum(np.abs(about) ** 2))
    if most < 2 or whole == 0.0:
        return 1.0
    spectrum = np.fft.fft(about, 2 * len(about), axis=0)  # so long that no lag comes round the end
    rho = np.fft.ifft(np.sum(spectrum.real**2 + spectrum.imag**2, axis=1)).real[1:most] / whole
    return max(1.0, 1.0 + 2.0 * float(np.sum((1.0 - np.arange(1, most) / most) * rho)))


def select_poles(window: Window, starts: FloatArray, *, search: bool = True) -> PoleFit:
    """Fit with as many poles as the data carry, from starts (poles, 2) of freq [Hz], zeta.

    Real residues first; complex ones if real ones leave more than the noise, or take more poles than the start has, and
    complex ones earn themselves. Where there are many channels or lines, how many poles there are is decided on fewer:
    principal components, every few lines. Without `search` the poles are those of the start, refined.
    """
    few = principal(window) if search else window
    found = _searched if search else _refined
    fit = found(few, starts)
    misfit, grown = fit.variance > max(MISFIT, few.floor**2), len(fit.freq) > len(starts)
    if few.residues == "real" and (misfit or grown):
        turned = found(replace(few, residues="complex"), np.column_stack([fit.freq, fit.zeta]) if misfit else starts)
        more = turned.parameters - fit.parameters
        if (fit.squares - turned.squares) / turned.noise > more * np.log(few.Y.size):
            fit = turned
    return fit if few is window else fit_poles(replace(window, residues=fit.window.residues), fit.freq, fit.zeta)


def principal(window: Window) -> Window:
    """A window with the strongest real combinations of its channels, and every so many lines, if there are many.

    Noise stays as it is.
    """
    stride = -(-len(window.freq) // MOST_LINES)
    if stride > 1:
        window = window.cut(slice(None, None, stride))
    if window.Y.shape[1] <= CHANNELS[1]:
        return window
    mixed = np.linalg.eigh(window.Y.T @ window.Y)[1][:, -CHANNELS[0] :]
    return replace(window, Y=window.Y @ mixed, weight=np.ones(CHANNELS[0]))


def reach(window: Window) -> tuple[float, float]:
    """Frequencies [Hz] between which poles are fitted: a little beyond the lines, whose ends neighbours raise."""
    return float(window.freq[0]) * (1.0 - BEYOND), float(window.freq[-1]) * (1.0 + BEYOND)


def _refined(window: Window, starts: FloatArray) -> PoleFit:
    return fit_poles(window, starts[:, 0], starts[:, 1])


def _searched(window: Window, starts: FloatArray) -> PoleFit:
    """Prune the starts, then add poles where the deviation asks for them."""
    fit = pruned(fit_poles(window, starts[:, 0], starts[:, 1], steps=SEARCH_STEPS))
    for _ in range(len(starts) // 2 + MORE):
        more = _one_more(fit)
        if more is None:
            break
        fit = more
    if not fit.converged:
        fit = fit_poles(window, fit.freq, fit.zeta)
    return fit if len(fit.freq) else _only_one(fit)


def _only_one(fit: PoleFit) -> PoleFit:
    """One pole where it explains most of what is there, though noise that rises with the peak denies it; or none.

    It is left to the verdict, which says why it is doubtful or left out: a peak is not passed over in silence.
    """
    for f, zeta in _places(fit)[:1]:
        one = fit_poles(fit.window, np.array([f]), np.array([zeta]))
        low, high = reach(fit.window)
        if one.squares < (1.0 - MOSTLY) * fit.squares and low < one.freq[0] < high and one.zeta[0] < ZETA_MAX:
            return one
    return fit


def pruned(fit: PoleFit) -> PoleFit:
    """Leave out poles, one by one, that do not earn themselves, are no resonance, or repeat a neighbour."""
    while len(fit.freq):
        ends = reach(fit.window)
        worth = gains(fit)
        outside = (fit.freq < ends[0]) | (fit.freq > ends[1]) | (fit.zeta >= ZETA_MAX)
        narrow = lines_of(fit) < NARROW
        unsure = ~narrow & (fit.noise * np.diag(fit.covariance)[len(fit.freq) :] > UNSURE**2)
        spikes = [bool(thin) and not has_skirts(fit, k) for k, thin in enumerate(narrow)]
        worth = np.where(outside | unsure | spikes, 0.0, worth)
        for low, high in _repeats(fit):
            worth[low if worth[low] < worth[high] else high] = 0.0
        least = int(worth.argmin())
        if worth[least] > penalty(fit.window):
            return fit
        kept = np.arange(len(fit.freq)) != least
        fit = fit_poles(fit.window, fit.freq[kept], fit.zeta[kept], steps=SEARCH_STEPS)
    return fit


def _repeats(fit: PoleFit) -> list[tuple[int, int]]:
    """Neighbouring poles within three bandwidths and of the same shape; where shapes say nothing, low within one.

    Each channel counts in units of its noise: one of another sensitivity would else decide alone.
    Two within half a bandwidth, or the lines next to them, are not told apart there, whatever their peaks.
    """
    step = float(fit.window.freq[1] - fit.window.freq[0])
    widths, gaps = np.maximum(2.0 * fit.zeta * fit.freq, step), np.diff(fit.freq)
    if fit.window.Y.shape[1] < ENOUGH:
        widths = np.maximum(widths, 2.0 * SKIRT[0] * step)
        peaks = np.linalg.norm(fit.A.reshape(len(fit.A), -1), axis=1) * fit.freq / widths
        pairs = [(k, k + 1, k + int(peaks[k + 1] > peaks[k])) for k in range(len(gaps))]
        return [
            (k, m)
            for k, m, high in pairs
            if gaps[k] < 0.5 * widths[high] or (gaps[k] < widths[high] and peaks[[k, m]].min() < LOW * peaks[high])
        ]
    shapes = fit.A[:, 0] + 1j * fit.A[:, 1] if fit.A.shape[1] == 2 else fit.A[:, 0]
    found = []
    for low in range(len(fit.freq) - 1):
        high = low + 1
        alike = abs(np.vdot(shapes[low], shapes[high])) ** 2
        norms = np.vdot(shapes[low], shapes[low]).real * np.vdot(shapes[high], shapes[high]).real
        if gaps[low] < NEAR * max(widths[low], widths[high]) and alike > SAME * norms:
            found.append((low, high))
    return found


def _one_more(fit: PoleFit) -> PoleFit | None:
    """A fit with more poles that have earned themselves, or as many but much better ones, or None.

    One pole at each of the places that promise most, then one at the first two at once: where several modes share
    a bandwidth, one more pole alone may only fall together with another.
    """
    places = _places(fit)
    together = [places[:2]] if len(places) > 1 else []
    for added in [[place] for place in places] + together:
        f, zeta = np.array(added).T
        trial = fit_poles(fit.window, np.append(fit.freq, f), np.append(fit.zeta, zeta), steps=TRIAL_STEPS)
        new = int(np.argmin(np.abs(trial.freq - f[0])))
        gain = (fit.squares - trial.squares) / noise_at(trial, new) / alike_lines(trial, new)
        if gain <= len(added) * penalty(fit.window):
            continue
        trial = pruned(trial)
        better = (fit.squares - trial.squares) / trial.noise > penalty(fit.window)
        if len(trial.freq) > len(fit.freq) or (len(trial.freq) == len(fit.freq) and better):
            return trial
    return None


def _places(fit: PoleFit) -> list[tuple[float, float]]:
    """Where one more pole would take most from the deviation: frequency and damping, best first, a bandwidth apart."""
    window = fit.window
    grid = np.linspace(*reach(window), min(GRID, 2 * len(window.freq)))
    R = np.concatenate([fit.spread.real, fit.spread.imag])
    Q = basis(fit)
    usual = float(np.median(fit.zeta)) if len(fit.zeta) else 2e-3
    tried = usual, 3.0 * usual
    gain = np.array([_gain(window.resonances(grid, z * np.ones(len(grid))), Q, R, window.columns) for z in tried])
    best, zeta = gain.max(axis=0), np.where(gain[0] >= gain[1], *tried)
    found: list[tuple[float, float]] = []
    while len(found) < TRIES and best.max() > LEAST_GAIN * penalty(window) * fit.noise:
        k = int(best.argmax())
        found.append((float(grid[k]), float(zeta[k])))
        best = np.where(np.abs(grid - grid[k]) < 2.0 * usual * grid[k], 0.0, best)
    return found


def _gain(g: FloatArray, Q: FloatArray, R: FloatArray, columns: int) -> FloatArray:
    """Fall of the sum of squares by each of the resonances g beside the terms Q, poles kept."""
    g = g[:, ::columns]
    size = np.sum(g * g, axis=0)
    across = size - np.sum((Q.T @ g) ** 2, axis=0)
    return np.asarray(np.sum((g.T @ R) ** 2, axis=1) / np.maximum(across, 1e-6 * size))


def basis(fit: PoleFit) -> FloatArray:
    """Orthonormal basis of all fitted terms, (2 lines, terms)."""
    columns = fit.window.resonances(fit.freq, fit.zeta), fit.window.residuals()
    return np.linalg.qr(np.concatenate(columns, axis=1))[0]


def hidden_split(fit: PoleFit, pole: int) -> float:
    """Relative split of two equally driven, orthogonal partners that the data would just not have shown.

    Split by delta, the two give g(f) (u + v) + (delta/2) g'(f) (u - v) with |u - v| = |u + v|; the second term is seen
    once its sum of squares across the fitted terms exceeds the penalty of a pole, noise against it (three sigma).
    """
    one = slice(pole, pole + 1)
    g = fit.window.slopes(fit.freq[one], fit.zeta[one])[:, 0]
    across = float(np.sum(g * g) - np.sum((basis(fit).T @ g) ** 2)) * float(np.sum(fit.A[pole] ** 2))
    seen = np.sqrt(penalty(fit.window)) + 3.0
    return float(2.0 * seen * np.sqrt(fit.noise / across)) if across > 0.0 else float("nan")
