"""Response of a bladed wheel to an engine order over speed, and the amplification by mistuning.

(K (1 + 2 i zeta) + R^T L R - w^2) a = R^T f,  w = order times the speed, f_j = F e^(2 pi i order j/N),

with hysteretic damping 2 zeta of the material and the aerodynamic influence L. Amplitudes are |R a|.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.io.arrays import Array, FloatArray
from casingfem.modal.cyclic.bladed import BladedWheel, Influence, excited, whitehead
from casingfem.modal.cyclic.mistuned import Deviations
from contact.io.columns import Column
from contact.io.keys import Key
from contact.io.reported import Reported

ROUND = (-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0)  # half widths about a pole at which amplitudes are computed
ZOOM, ROUNDS = 9, 4  # frequencies about the largest, and how often they come closer
AIRS, AGREE = 8, 1e-7  # how often the air is taken at another frequency, and the change at which that ends
CHUNK = 64  # frequencies together
RESPONSE = (
    Column("speed_hz", "Speed of rotation.", lambda one: one.speed_hz, head="speed", unit="Hz", format=".6g"),
    Column("freq_hz", "Frequency of the excitation, the engine order times the speed.",
           lambda one: one.order * one.speed_hz, head="frequency", unit="Hz", format=".6g"),
    Column("largest_m", "Largest amplitude of all blades.", lambda one: one.amplitude.max(axis=1), head="largest",
           unit="m", format=".5g"),
    Column("blade", "Blade with the largest amplitude, from 1.", lambda one: one.amplitude.argmax(axis=1) + 1,
           format="d"),
    Column("tuned_m", "Amplitude of every blade of the tuned wheel.", lambda one: one.tuned, head="tuned", unit="m",
           format=".5g"),
)  # fmt: skip
DRAWS = (
    Column("draw", "Number of the draw, from 0.", lambda one: np.arange(len(one.amplification)), format="d"),
    Column("amplification", "Largest amplitude of the mistuned wheel over that of the tuned one.",
           lambda one: one.amplification, format=".5f"),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderLoad:
    """Load case of a wheel: engine order, speeds, force, damping, and number of mistuned draws.

    >>> OrderLoad(order=3, from_hz=20.0, to_hz=40.0, zeta=1e-3).speeds[[0, -1]].tolist()
    [20.0, 40.0]
    """

    order: Annotated[int, Key("engine order", least=1, most=1000)]
    from_hz: Annotated[float, Key("lowest speed [turns/s]", "positive")]
    to_hz: Annotated[float, Key("highest speed [turns/s]", "positive")]
    steps: Annotated[int, Key("number of speeds from the lowest to the highest", least=2, most=100_000)] = 401
    force: Annotated[float, Key("amplitude of the force on the channel of each blade [N]", "positive")] = 1.0
    zeta: Annotated[float, Key("damping ratio of the material [-]", "ratio", "zeta")] = 0.0
    channel: Annotated[
        str, Key("channel of the tip at which the force acts and the response is given: span, flap or chord")
    ] = "flap"
    sigma: Annotated[
        float | None, Key("standard deviation of the blades' relative frequencies, to draw; no draws if left out [-]",
                          "positive", most=0.2)
    ] = None  # fmt: skip
    draws: Annotated[int, Key("number of draws", least=1, most=10_000_000)] = 1000
    seed: Annotated[int, Key("seed of the draws; the same seed gives the same draws", least=0)] = 1

    def __post_init__(self) -> None:
        if not 0.0 < self.from_hz < self.to_hz:
            found = f"from_hz = {self.from_hz:g}, to_hz = {self.to_hz:g}"
            raise InputError("response", found=found, expected="0 < from_hz < to_hz")

    @property
    def speeds(self) -> FloatArray:
        """Speeds [turns/s], (steps,)."""
        return np.linspace(self.from_hz, self.to_hz, self.steps)


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class EngineOrderResponse(Reported):
    """Amplitudes [m] of the blades over speed, (speeds, N), and of the tuned wheel, (speeds,).

    `peak` and `peak_hz` are the largest amplitude and its speed, also between the listed speeds; `tuned_peak` and
    `tuned_peak_hz` those of the tuned wheel. `diameter` is the nodal diameter that the order excites.

    >>> wheel = BladedWheel.chain(blades=12, freq_hz=100.0, mass=0.2, coupling=0.01)
    >>> found = engine_order_response(wheel, 3, [33.0, 33.5], force=1.0, zeta=1e-3)
    >>> found.diameter, round(found.amplification, 6), round(found.bound, 3)
    (3, 1.0, 2.232)
    """

    COLUMNS: ClassVar = RESPONSE

    order: int
    diameter: int
    speed_hz: FloatArray
    amplitude: FloatArray
    tuned: FloatArray
    peak: float
    peak_hz: float
    tuned_peak: float
    tuned_peak_hz: float

    @property
    def amplification(self) -> float:
        """Largest amplitude over that of the tuned wheel."""
        return self.peak / self.tuned_peak

    @property
    def bound(self) -> float:
        """Whitehead's bound."""
        return whitehead(self.amplitude.shape[1])

    @property
    def words(self) -> str:
        """One line."""
        n = f"{self.diameter} nodal diameter{'' if self.diameter == 1 else 's'}"
        return (
            f"Engine order {self.order} excites {n}: the largest amplitude is {self.peak:.5g} m at "
            f"{self.peak_hz:.6g} Hz ({60.0 * self.peak_hz:,.5g} rpm), {self.amplification:.4g} times that of the tuned "
            f"wheel; Whitehead's bound is {self.bound:.4g}."
        )


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Amplification(Reported):
    """Amplification factors of drawn wheels, (draws,), and the deviations of the worst one, (N,).

    >>> wheel = BladedWheel.chain(blades=6, freq_hz=100.0, mass=0.2, coupling=0.01)
    >>> found = amplification(wheel, 2, sigma=0.01, draws=20, seed=5, zeta=1e-3)
    >>> bool(found.amplification.max() < found.bound), found.worst.shape
    (True, (6,))
    """

    COLUMNS: ClassVar = DRAWS

    order: int
    sigma: float
    seed: int
    amplification: FloatArray
    worst: FloatArray

    @property
    def bound(self) -> float:
        """Whitehead's bound."""
        return whitehead(self.worst.size)

    def quantile(self, share: float | Sequence[float]) -> FloatArray:
        """Amplification that a given share of the draws does not exceed."""
        return np.asarray(np.quantile(self.amplification, share))

    @property
    def words(self) -> str:
        """One line."""
        half, most = self.quantile([0.5, 0.99])
        return (
            f"Amplification of {len(self.amplification):,} draws of {100.0 * self.sigma:g} %: median {half:.4g}, 99 % "
            f"below {most:.4g}, largest {self.amplification.max():.4g}; Whitehead's bound is {self.bound:.4g}."
        )


def engine_order_response(
    wheel: BladedWheel, order: int, speed_hz: ArrayLike, *, force: float = 1.0, zeta: float = 0.0,
    deviations: Deviations | None = None, influence: Influence | None = None,
) -> EngineOrderResponse:  # fmt: skip
    """Amplitudes of a wheel's blades under an engine order over speed.

    Parameters
    ----------
    order
        Engine order, 1 or more; forces `force` [N] on the channel of each blade with the phase 2 pi order j/N.
    speed_hz
        Speeds [turns/s], (speeds,); the largest amplitude between the first and the last is also found.
    zeta
        Damping ratio of the material; the loss factor is 2 zeta.
    deviations
        Relative deviation of each blade's frequency, (N,); None for a tuned wheel.
    influence
        Aerodynamic influence coefficients.

    Raises
    ------
    InputError
        For an impossible order, speed or damping, and for a wheel without damping.

    Examples
    --------
    >>> wheel = BladedWheel.chain(blades=12, freq_hz=100.0, mass=0.2, coupling=0.01)
    >>> found = engine_order_response(wheel, 9, [10.0, 12.0], zeta=1e-3)
    >>> f"{found.tuned_peak:.6g}", f"{1.0 / (0.2 * 2e-3 * (2 * np.pi * 100.0) ** 2 * 1.02):.6g}"
    ('0.00620841', '0.00620841')
    """
    speeds = checked_speeds(order, speed_hz, zeta)
    values = None if deviations is None else np.asarray(deviations, dtype=float)
    ends = float(speeds[0]) * order, float(speeds[-1]) * order
    tuned_peak, tuned_at = largest(wheel, order, ends, force, zeta, None, influence)
    peak, at = (tuned_peak, tuned_at) if values is None else largest(wheel, order, ends, force, zeta, values, influence)
    tuned = amplitudes(wheel, order, speeds * order, force, zeta, None, influence)
    found = tuned if values is None else amplitudes(wheel, order, speeds * order, force, zeta, values, influence)
    return EngineOrderResponse(
        order=order, diameter=excited(order, wheel.blades), speed_hz=speeds, amplitude=found, tuned=tuned.max(axis=1),
        peak=peak, peak_hz=at / order, tuned_peak=tuned_peak, tuned_peak_hz=tuned_at / order,
    )  # fmt: skip


def amplification(
    wheel: BladedWheel, order: int, *, sigma: float, draws: int, seed: int, zeta: float,
    influence: Influence | None = None, band_hz: tuple[float, float] = (0.0, math.inf),
) -> Amplification:  # fmt: skip
    """Amplification factors of wheels with normally distributed blade deviations of standard deviation `sigma`.

    `band_hz` is the range of excitation frequencies. The aerodynamic influence is that at the tuned resonance. Raises
    the errors of `engine_order_response`.

    >>> wheel = BladedWheel.chain(blades=6, freq_hz=100.0, mass=0.2, coupling=0.01)
    >>> found = amplification(wheel, 2, sigma=0.01, draws=50, seed=5, zeta=1e-3)
    >>> bool(1.0 < found.quantile(0.5) < found.bound)
    True
    """
    checked_speeds(order, [1.0], zeta)
    if not 0.0 < sigma < 0.2 or draws < 1:
        given = f"sigma = {sigma:g}, draws = {draws}"
        raise InputError("response.mistuning", found=given, expected="0 < sigma < 0.2, one draw or more")
    tuned, at = largest(wheel, order, band_hz, 1.0, zeta, None, influence)
    rng, found, worst = np.random.default_rng(seed), np.empty(draws), np.zeros(wheel.blades)
    for k in range(draws):
        values = np.maximum(sigma * rng.standard_normal(wheel.blades), -0.9)
        found[k] = largest(wheel, order, band_hz, 1.0, zeta, values, influence, at)[0] / tuned
        if found[k] == found[: k + 1].max():
            worst = values
    return Amplification(order=order, sigma=sigma, seed=seed, amplification=found, worst=worst)


def checked_speeds(order: int, speed_hz: ArrayLike, zeta: float) -> FloatArray:
    """Check that speeds (speeds,) are ascending and positive."""
    speeds = np.atleast_1d(np.asarray(speed_hz, dtype=float))
    if order < 1:
        raise InputError("response.order", found=str(order), expected="an engine order of 1 or more")
    if not 0.0 <= zeta < 1.0:
        raise InputError("response.zeta", found=f"{zeta:g}", expected="a ratio from 0 up to 1")
    if speeds.ndim != 1 or not speeds.size or not np.isfinite(speeds).all() or speeds[0] <= 0.0 or np.any(
        np.diff(speeds) <= 0.0
    ):  # fmt: skip
        raise InputError("response.speed_hz", found=f"{speed_hz!r}", expected="ascending speeds above 0")
    return speeds


def amplitudes(
    wheel: BladedWheel, order: int, freq_hz: FloatArray, force: float, zeta: float, deviations: FloatArray | None,
    influence: Influence | None,
) -> FloatArray:  # fmt: skip
    """Amplitudes [m] at each frequency of the excitation, (frequencies, N), by one solution each."""
    K, f, unit = wheel.mistuned(deviations) * (1.0 + 2j * zeta), force * wheel.load(order), np.eye(len(wheel.stiffness))
    omega, found = 2.0 * np.pi * freq_hz, np.empty((freq_hz.size, wheel.blades))
    for first in range(0, omega.size, CHUNK):
        some = omega[first : first + CHUNK]
        A = K - some[:, None, None] ** 2 * unit
        if influence is not None:
            A = A + np.array([wheel.air(influence, w) for w in some.tolist()])
        a = np.linalg.solve(A, np.broadcast_to(f, (some.size, f.size))[:, :, None])[:, :, 0]
        found[first : first + CHUNK] = np.abs(a @ wheel.rows.T)
    return found


def largest(
    wheel: BladedWheel, order: int, band_hz: tuple[float, float], force: float, zeta: float,
    deviations: FloatArray | None, influence: Influence | None, at_hz: float = 0.0,
) -> tuple[float, float]:  # fmt: skip
    """Largest amplitude [m] in a band and its frequency [Hz], from the poles of the wheel.

    The aerodynamic influence is that at `at_hz`; if that is 0, at the largest amplitude, iterated until both agree to
    AGREE.
    """
    if influence is not None and at_hz == 0.0:
        before, at = 0.0, near(wheel, order, band_hz)
        for _ in range(AIRS):
            before, (top, at) = at, largest(wheel, order, band_hz, force, zeta, deviations, influence, at)
            if abs(at - before) <= AGREE * at:
                break
        return top, at
    lam, P, g = poles(wheel, order, zeta, deviations, influence, at_hz)
    root = np.sqrt(lam)
    if not (root.imag > 0.0).all():
        expected = "zeta above 0, or aerodynamic influence that damps every wave"
        raise InputError("response.zeta", found="a wheel without damping, or one that flutters", expected=expected)
    low, high = (2.0 * np.pi * end for end in band_hz)
    centres = root.real + np.multiply.outer(ROUND, root.imag)
    places = np.unique(np.clip(centres.ravel(), low, high))
    step = float(root.imag.min())
    for _ in range(1 + ROUNDS):
        size = np.abs((g / (lam - places[:, None] ** 2)) @ P.T).max(axis=1)
        best = int(size.argmax())
        top, at = float(size[best]), float(places[best])
        places = np.clip(at + step * np.linspace(-1.0, 1.0, ZOOM), low, high)
        step *= 2.0 / (ZOOM - 1)
    return force * top, at / (2.0 * np.pi)


def poles(
    wheel: BladedWheel, order: int, zeta: float, deviations: FloatArray | None, influence: Influence | None,
    at_hz: float,
) -> tuple[Array, Array, Array]:  # fmt: skip
    """Squared complex frequencies (D,), blade motion of each mode (N, D), and its modal force from the order (D,)."""
    K, f = wheel.mistuned(deviations), wheel.load(order)
    if influence is None:
        squares, turn = np.linalg.eigh(K)
        return squares * (1.0 + 2j * zeta), wheel.rows @ turn, turn.T @ f
    lam, turn = np.linalg.eig(K * (1.0 + 2j * zeta) + wheel.air(influence, 2.0 * np.pi * at_hz))
    return lam, wheel.rows @ turn, np.linalg.solve(turn, f)


def near(wheel: BladedWheel, order: int, band_hz: tuple[float, float]) -> float:
    """The tuned frequency of the excited diameter in the band, or the nearest one [Hz]."""
    own = wheel.freq[wheel.diameters == excited(order, wheel.blades)]
    away = np.maximum(band_hz[0] - own, 0.0) + np.maximum(own - band_hz[1], 0.0)
    return float(own[int(away.argmin())])
