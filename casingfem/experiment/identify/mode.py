"""Turn a fitted pole into a mode: shape, nodal diameters, smallest detectable split, reasons why it is doubtful.

The residues of one mode over sensors o and references i are phi_o phi_i, of rank one. Their first singular vectors are
the shape and the references' share; a second singular value above the noise shows that one pole represents two modes
of the same frequency.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from casingfem.experiment.circle.orientation import Circle, Label
from casingfem.experiment.frf.sensor_grid import SensorGrid, radial_signs
from casingfem.experiment.identify.counting import asked, repeated
from casingfem.experiment.identify.pole_fit import PoleFit, widths
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, FloatArray, IntArray

NOWHERE = float("nan")
TWO = 0.1  # least ratio of singular values of residues that contain two shapes
FEW = 6  # channels from which on they confirm each other; fewer need clearer peaks


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mode:
    """One mode, or an unresolved pair; see `Identified` for the names.

    `double` is True if the residues over several references contain two shapes. The covariance of the shape is
    diag(direct) + moved moved^T, (sensors,) and (sensors, numbers).
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
    direct: FloatArray
    moved: FloatArray
    residues: Array
    residue_scale: float
    collinearity: float
    signal: float
    split_bound: float
    double: bool
    reason: str = ""
    unresolved: bool = False

    @property
    def sigma_shape(self) -> FloatArray:
        """Standard deviation of the shape at each sensor, (sensors,)."""
        return np.asarray(np.sqrt(self.direct + np.sum(self.moved**2, axis=1)))


class Shape(NamedTuple):
    """Real shape of unit norm at the sensors, its errors (see `Mode`), its share in phase, and whether it is double."""

    values: FloatArray
    direct: FloatArray
    moved: FloatArray
    collinearity: float
    double: bool


class Sensors(NamedTuple):
    """Sensors of a test, the power of j omega of its responses, the circle, and the sensors used for labels."""

    grid: SensorGrid
    power: int
    circle: Circle | None
    labelled: IntArray

    @classmethod
    def of(cls, grid: SensorGrid, power: int, circle: Circle | None, kept: IntArray | None = None) -> Sensors:
        """All sensors, or those that are used for labels."""
        return cls(grid, power, circle, np.arange(len(grid)) if kept is None else kept)

    def seeing(self, residues: Array) -> tuple[IntArray, Circle]:
        """Sensors that label a mode with these residues (sensors, references), and their circle.

        Some set-ups may lack the mode; their sensors are left out.
        """
        assert self.circle is not None
        seen = np.intersect1d(self.labelled, np.flatnonzero(np.any(residues, axis=1)))
        if len(seen) == len(self.labelled):
            return seen, self.circle
        return seen, Circle.of(self.grid.theta[seen], max(self.circle.n_max, 0))


class Residues(NamedTuple):
    """Residues of 1/(s - p) at all channels, and their noise.

    `values` (channels,) complex; `direct` (channels,) is the variance of the real part, independent between channels;
    `moved` (channels, numbers), complex, is the change of the residues by independent errors of the poles, each of unit
    variance.
    """

    values: Array
    direct: FloatArray
    moved: Array


class Found(NamedTuple):
    """A pole before its shape is known.

    Frequency [Hz] and damping with uncertainties, residues, peak, bound of a split.
    """

    freq: float
    sigma_freq: float
    zeta: float
    sigma_zeta: float
    residues: Residues
    signal: float
    split_bound: float


def found_in(fit: PoleFit, noise: FloatArray, rules: Thresholds = USUAL) -> list[Found]:
    """The poles of a fit whose channels have this noise (channels,)."""
    spread = np.sqrt(np.tile(fit.noise, 2))
    values, vectors = np.linalg.eigh(fit.covariance * np.outer(spread, spread))
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    found = []
    for k, pole in enumerate(fit.poles.tolist()):
        omega, size = abs(pole), -pole.real * noise
        followed = -fit.tilt[k][:, None] * np.concatenate([fit.A, fit.A])
        direct = fit.noise[k] * float(fit.gram[k, k].real) * size**2
        residues = Residues(fit.A[k] * size, direct, size[:, None] * (followed.T @ root))
        by_freq, by_zeta = fit.sigma[:, k].tolist()
        zeta = -pole.real / omega
        found.append(
            Found(omega / (2.0 * np.pi), -pole.real * by_freq / (2.0 * np.pi), zeta, zeta * by_zeta, residues,
                  float(fit.peaks[k]), hidden_split(fit, k, rules))
        )  # fmt: skip
    return found


def mode_of(found: Found, sensors: Sensors) -> Mode:
    """Compute the shape, nodal diameters and orientation of a mode."""
    grid = sensors.grid
    shape = _shape(found.residues, grid.channels)
    values = found.residues.values[grid.channels]
    label = Label(-1, NOWHERE, NOWHERE)
    if sensors.circle is not None:
        seen, circle = sensors.seeing(values)
        label = circle.label((shape.values * radial_signs(grid))[seen])
    omega = 2.0 * np.pi * found.freq
    pole = omega * (-found.zeta + 1j * np.sqrt(1.0 - found.zeta**2))
    unit = 2j * pole.imag * (omega / pole) ** sensors.power / omega**2
    return Mode(
        freq=found.freq, sigma_freq=found.sigma_freq, zeta=found.zeta, sigma_zeta=found.sigma_zeta, n=label.n,
        purity=label.purity, angle=label.angle, sigma_angle=NOWHERE, shape=shape.values, direct=shape.direct,
        moved=shape.moved, residues=values * unit, residue_scale=found.freq, collinearity=shape.collinearity,
        signal=found.signal, split_bound=found.split_bound, double=shape.double,
    )  # fmt: skip


def hidden_split(fit: PoleFit, k: int, rules: Thresholds = USUAL) -> float:
    """Largest relative split of a pole into two of the same shape that the data would not show.

    Two poles d apart differ from one at their middle by (d/2)^2 times the second derivative of a resonance, of squares
    (d/2 sigma)^4 times those of its peak; they cannot be distinguished from one pole if this is below the required
    decrease of the sum of squares.
    """
    gain = float(fit.gains()[k]) + 1e-300
    share = float(fit.noise[k]) * asked(fit.window.Y.shape[1], rules) / gain
    return float(2.0 * -fit.poles[k].real * share**0.25 / abs(fit.poles[k]))


def _shape(residues: Residues, channels: IntArray) -> Shape:
    """Compute a shape from residues; `channels` (sensors, references) has the channel number of each."""
    matrix = residues.values[channels]
    u, sizes, v = np.linalg.svd(matrix, full_matrices=False)
    turn = np.exp(-0.5j * np.angle(np.sum(u[:, 0] ** 2)))
    factor = v[0].conj() * turn / (sizes[0] + 1e-300)
    whole = matrix @ factor
    factor = factor * (np.sign(whole.real[int(np.argmax(np.abs(whole.real)))]) or 1.0)
    whole = matrix @ factor
    norm = float(np.linalg.norm(whole.real)) + 1e-300
    direct = residues.direct[channels] @ np.abs(factor) ** 2
    slopes = np.einsum("orp,r->op", residues.moved[channels], factor).real
    double = False
    if len(sizes) > 1:
        size = float(np.sqrt(2.0 * np.mean(residues.direct[channels])))
        limit = size * (np.sqrt(matrix.shape[0]) + np.sqrt(matrix.shape[1]) + 3.0)
        limit += 3.0 * float(np.linalg.norm(residues.moved[channels]))
        double = bool(sizes[1] > limit and sizes[1] > TWO * sizes[0])
    energy = float(np.linalg.norm(whole)) ** 2 + 1e-300
    return Shape(whole.real / norm, direct / norm**2, slopes / norm, norm**2 / energy, double)


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
        yield "its peak is one line without flanks: mains hum or another tone? Measure again at another time"
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
    if zeta > rules.zeta_most:
        yield f"its damping of {100.0 * zeta:.2g} % is that of a residual, or of several modes"
    ratio = float(fit.peaks[k] / np.sqrt(fit.local[k]))
    least = rules.sure_peak * max(1.0, FEW / channels)
    if ratio < least:
        few = f" in {channels} channel{'s' * (channels > 1)}" if channels < FEW else ""
        yield f"its peak is {ratio:.2g} times the residual there{few}, expected {least:.2g} or more: use more sensors"
    if phase < rules.in_phase:
        yield f"only {100.0 * phase:.0f} % of its shape is in phase: two modes, or a phase error of a sensor?"
    if share < rules.local:
        yield (
            f"only {max(1, round(share * channels))} of {channels} channels show it: a local mode, of a fixture or a"
            " sensor's mount?"
        )
    if twice:
        yield (
            "it has the shape of a stronger mode less than a bandwidth away: a single mode? Check for loose parts, and"
            " whether the frequency depends on the force"
        )


def _one_line(fit: PoleFit, k: int) -> bool:
    """Whether the peak is a single line: the neighbouring lines are not above the residual of the fit."""
    at = int(np.argmin(np.abs(2.0 * np.pi * fit.window.freq - fit.poles[k].imag)))
    column = fit.window.resonances(fit.poles[[k]])[0][:, 0]
    size = float(np.sqrt(np.mean(np.abs(fit.A[k]) ** 2) / 2.0))
    beside = [j for j in (at - 1, at + 1) if 0 <= j < len(column)]
    skirts = float(np.max(np.abs(column[beside]))) * size
    rest = float(np.sqrt(0.5 * np.mean(np.abs(fit.rest[beside]) ** 2)))
    return skirts < 3.0 * max(rest, 1.0) or abs(column[at]) > 30.0 * np.max(np.abs(column[beside]))
