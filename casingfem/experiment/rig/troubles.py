"""Imperfections of a real hammer test that a virtual rig lacks: each can be switched on, and its exact effect is kept.

Each mode k of set-up s is a pole p = -zeta omega + j omega sqrt(1 - zeta^2) with residues A, so that

    H(f) = s^q [sum_k A_k/(s - p_k) + A_k*/(s - p_k*) + S],   s = 2 pi j f + 1/tau,

with the time constant tau of an exponential window and q = 0, 1, 2. Leakage of averaged random blocks under a Hann
window is H smoothed by the window's power spectrum (Bendat & Piersol, Random Data, 4th ed., 2010, section 8.5). A
record that ends D seconds after the hit, before the ringing has decayed, has

    H_D = H - sum_k p_k^q A_k e^{(p_k - s) D}/(s - p_k) + conjugates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated, Any, NamedTuple

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.rig.rig import DERIVATIVES, Quantity, Rig
from casingfem.io.arrays import Array, FloatArray, IntArray, freeze
from contact.io.keys import Key

AVERAGES = 5  # hits of an average, for the coherence
HANN = np.arange(-3.75, 3.8, 0.25)  # lines over which a Hann window leaks
FIXTURE_ZETA, FIXTURE_SIZE = 0.008, 0.3  # damping of local modes, their peaks over the median of the others'
SPOILT = ("dead", "noisy", "flipped", "swapped")
NOISY = 10.0  # times the noise of other channels
HIT_DELAY = 0.023  # s, from the first to the second hit


@dataclass(frozen=True, slots=True, kw_only=True)
class Troubles:
    """Imperfections of a simulated test; by default none.

    Parameters
    ----------
    snr_db
        Level of noise below the rms of each channel [dB].
    colour
        The noise's amplitude falls as f^-colour.
    coherent
        Share of the noise power that is common to all channels of a drive.
    setups, shift
        Number of groups in which sensors are measured. The frequency of each mode differs between groups by up to
        `shift` (relative: a roving mass, a moved hammer).
    half_rim
        Keep only the first half of the sensors.
    dead, noisy, swapped, flipped
        Channels without signal, with ten times the noise, exchanged in pairs, with wrong sign.
    double_hit
        Size of a second hit over the first; noise rises where their spectra cancel.
    exponential
        Time constant of an exponential window [s].
    cut_off
        Records last one over the line spacing and end before the ringing has decayed.
    pre_trigger
        Time that such a record has before the hit [s].
    leakage
        Leakage of a Hann window, as with random forces.
    fixture
        Number of local modes, each at a few neighbouring sensors.
    phase_deg
        Rms phase of the shapes' components, as with nonproportional damping.

    Examples
    --------
    >>> Troubles(snr_db=30.0, dead=1).dead
    1
    """

    snr_db: float = 40.0
    colour: Annotated[
        float, Key("exponent of the noise, whose amplitude falls as f^-colour [-]", least=-2.0, most=4.0)
    ] = 0.0
    coherent: Annotated[float, Key("share of the noise's power common to all channels [-]", least=0.0, most=1.0)] = 0.0
    setups: Annotated[
        int, Key("number of set-ups, groups of sensors that are measured one after the other", most=1000)
    ] = 1
    shift: Annotated[float, Key("largest relative shift of a mode between set-ups [-]", least=0.0, most=0.05)] = 0.0
    half_rim: Annotated[bool, Key("whether only the first half of the sensors is measured")] = False
    dead: Annotated[int, Key("number of channels without signal", least=0)] = 0
    noisy: Annotated[int, Key("number of channels with ten times the noise", least=0)] = 0
    swapped: Annotated[int, Key("number of exchanged pairs of channels", least=0)] = 0
    flipped: Annotated[int, Key("number of channels with the wrong sign", least=0)] = 0
    double_hit: Annotated[
        float, Key("force of a second hit of the hammer over that of the first [-]", least=0.0, most=0.99)
    ] = 0.0
    exponential: Annotated[float, Key("time constant of an exponential window [s]", "not negative")] = 0.0
    cut_off: Annotated[
        bool, Key("whether records end 1/resolution_hz after their start, before the vibration has decayed")
    ] = False
    pre_trigger: Annotated[float, Key("time before the hit in records that are cut off [s]", "not negative")] = 0.0
    leakage: Annotated[bool, Key("whether the responses have the leakage of a Hann window")] = False
    fixture: Annotated[int, Key("number of local modes of a fixture", least=0, most=100)] = 0
    phase_deg: Annotated[float, Key("rms phase in the shapes of complex modes [degrees]", least=0.0, most=90.0)] = 0.0

    def __post_init__(self) -> None:
        ranges = {"coherent": (0.0, 1.0), "shift": (0.0, 0.05), "double_hit": (0.0, 0.99), "phase_deg": (0.0, 90.0)}
        for name, (low, high) in ranges.items():
            if not low <= getattr(self, name) <= high:
                raise InputError(f"{name}: found {getattr(self, name)!r}, expected {low:g} to {high:g}")
        if self.pre_trigger and not self.cut_off:
            raise InputError("pre_trigger", found=f"{self.pre_trigger!r} s without cut_off", expected="cut_off = true")
        if self.cut_off and self.leakage:
            expected = "one of them: a Hann window belongs to random forces"
            raise InputError("cut_off", found="cut_off and leakage", expected=expected)
        for name in ("dead", "noisy", "swapped", "flipped", "fixture", "exponential", "pre_trigger", "setups"):
            if not getattr(self, name) >= (1 if name == "setups" else 0):
                raise InputError(f"{name}: found {getattr(self, name)!r}, expected none, or a number")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TroubledTruth:
    """Exact data of a simulated test: poles of each set-up, and the faulty channels.

    `freq` [Hz] and `zeta` (setups, modes) are those of the responses, including the effect of the window; `peak`
    (modes,) the rms of each mode's peak over that of the noise there; `left` (modes,) the part of its ringing
    (amplitude) at the end of truncated records, 0 for others; `fixture_hz` the local modes; `setup` (channels,);
    `dead`, `noisy`, `flipped` channels, `swapped` pairs of them.
    """

    freq: FloatArray
    zeta: FloatArray
    peak: FloatArray
    left: FloatArray
    fixture_hz: FloatArray
    setup: IntArray
    dead: tuple[int, ...]
    noisy: tuple[int, ...]
    swapped: tuple[tuple[int, int], ...]
    flipped: tuple[int, ...]

    def records(self) -> dict[str, Any]:
        """All of it as plain lists; channels are counted from 1."""
        return {
            "freq_hz": self.freq.tolist(),
            "zeta": self.zeta.tolist(),
            "peak_over_noise": self.peak.tolist(),
            "ringing_left": self.left.tolist(),
            "fixture_hz": self.fixture_hz.tolist(),
            "setup": (self.setup + 1).tolist(),
            **{name: [k + 1 for k in getattr(self, name)] for name in ("dead", "noisy", "flipped")},
            "swapped": [[a + 1, b + 1] for a, b in self.swapped],
        }

    def __post_init__(self) -> None:
        freeze(self, "freq", "zeta", "peak", "left", "fixture_hz", "setup")


class TroubledTest(NamedTuple):
    """Responses, their coherence, and the exact data."""

    frfs: FrfSet
    coherence: FrfSet
    truth: TroubledTruth


def troubled_frfs(
    rig: Rig,
    freq: FloatArray,
    what: Troubles,
    *,
    sensors: Sequence[int],
    drives: Sequence[int],
    seed: int,
    quantity: Quantity = "accelerance",
    card: Sequence[str] = (),
) -> TroubledTest:
    """Frequency responses at evenly spaced lines [Hz], with the imperfections `what`.

    Examples
    --------
    >>> rig = Rig.of(omega=[600.0, 900.0], zeta=0.01, rows=np.ones((5, 2)))
    >>> test = troubled_frfs(rig, np.arange(50.0, 200.0, 0.5), Troubles(setups=2, shift=0.01), sensors=range(4),
    ...                    drives=[4], seed=11)
    >>> test.truth.setup.tolist(), test.truth.freq.shape
    ([0, 0, 1, 1], (2, 2))
    """
    rng = np.random.default_rng(seed)
    seen = list(sensors)[: -(-len(sensors) // 2)] if what.half_rim else list(sensors)
    exact = rig.frfs(freq, sensors=seen, drives=drives, quantity=quantity, card=card)
    setup = np.tile(np.arange(len(seen)) * min(what.setups, len(seen)) // len(seen), len(drives))
    omega = rig.omega * (1.0 + what.shift * rng.uniform(-1.0, 1.0, (what.setups, len(rig))) * (what.setups > 1))
    poles = omega * (-rig.zeta + 1j * np.sqrt(1.0 - rig.zeta**2))
    phases = np.exp(1j * np.radians(what.phase_deg) * rng.standard_normal((len(seen), len(rig))))
    rows, pushed = rig.rows[seen] * phases, rig.rows[list(drives)]
    residues = (pushed[:, None, :] * rows[None]).reshape(-1, len(rig))
    static = rig.S[np.ix_(seen, list(drives))].T.reshape(-1, 1)
    local, parts = _fixture(what, freq, residues, rig, len(drives), rng)
    shortest = 1.0 / float(freq[-1])
    if 0.0 < what.exponential < shortest:
        expected = f"none, or at least {shortest:.3g} s, one period of the last line"
        raise InputError("troubles.exponential", found=f"{what.exponential:g} s", expected=expected)
    power, decay = DERIVATIVES[quantity], 1.0 / what.exponential if what.exponential else 0.0

    end = _end(what, freq)

    def seen_at(lines: FloatArray) -> Array:
        s = 2j * np.pi * lines + decay
        H = modal_sum(parts, local, s, power, end) + static * s**power
        for k in range(what.setups):
            H[setup == k] += modal_sum(residues[setup == k], poles[k], s, power, end)
        return np.asarray(H)

    clean = seen_at(freq)
    if what.leakage:
        step = float(freq[1] - freq[0])
        weights = zip(hann_power(HANN), HANN.tolist(), strict=True)
        clean = np.sum([weight * seen_at(freq + x * step) for weight, x in weights], axis=0)
    if what.dead >= len(clean):
        raise InputError("troubles.dead", found=str(what.dead), expected=f"less than the {len(clean)} channels")
    spoilt = {name: getattr(what, name) * (2 if name == "swapped" else 1) for name in SPOILT}
    if sum(spoilt.values()) > len(clean):
        named = ", ".join(f"{name} {getattr(what, name)}" for name, count in spoilt.items() if count)
        raise InputError(
            "troubles", found=named, expected=f"at most the {len(clean)} channels in all, a swapped pair as two"
        )
    order = rng.permutation(len(clean)).tolist()
    dead, noisy, flipped, rest = (
        sorted(order[low:high])
        for low, high in pairwise(np.cumsum([0, what.dead, what.noisy, what.flipped, len(order)]))
    )
    swapped = tuple((rest[2 * k], rest[2 * k + 1]) for k in range(what.swapped))
    sigma = _noise_size(what, freq, clean, noisy)
    H = clean + sigma * _noise(what, clean.shape, len(drives), rng)
    H[dead] -= clean[dead]
    coherence = np.abs(clean) ** 2 / (np.abs(clean) ** 2 + AVERAGES * sigma**2)
    coherence[dead] = 0.0
    H[flipped] *= -1.0
    for pair in swapped:
        H[list(pair)], coherence[list(pair)] = H[list(pair[::-1])], coherence[list(pair[::-1])]
    shifted = poles - decay  # what the window adds
    own, zeta = np.abs(shifted) / (2.0 * np.pi), -shifted.real / np.abs(shifted)
    middle = own.mean(axis=0)
    peaks = np.abs(residues) * (2.0 * np.pi * middle) ** (power - 2) / (2.0 * zeta.mean(axis=0))
    at, alive = np.clip(np.searchsorted(freq, middle), 0, len(freq) - 1), np.setdiff1d(np.arange(len(H)), dead)
    truth = TroubledTruth(
        freq=own, zeta=zeta, fixture_hz=np.abs(local - decay) / (2.0 * np.pi), setup=setup, dead=tuple(dead),
        noisy=tuple(noisy), swapped=swapped, flipped=tuple(flipped),
        left=np.exp(poles.real.mean(axis=0) * end),
        peak=np.sqrt(np.mean((peaks[alive] / sigma[alive][:, at]) ** 2, axis=0)),
    )  # fmt: skip
    frfs = replace(exact, responses=H, card=(*exact.card, f"troubles: {what}, seed {seed}"))
    return TroubledTest(frfs, replace(frfs, kind="spectrum", responses=coherence, unit=""), truth)


def modal_sum(residues: Array, poles: Array, s: Array, power: int, end: float = np.inf) -> Array:
    """Sum of s^q A/(s - p) + s^q A*/(s - p*), without the ringing after `end` [s]; A = r/(2 j omega_d).

    Without an end and with q = 0 this is r/(s^2 + 2 zeta omega s + omega^2) for real r.
    """
    A = residues / (2j * poles.imag)

    def columns(p: Array) -> Array:
        rest = p**power * np.exp((p - s) * end) if np.isfinite(end) else 0.0
        return np.asarray((s**power - rest) / (s - p))

    return np.asarray(A @ columns(poles[:, None]) + A.conj() @ columns(poles.conj()[:, None]))


def _end(what: Troubles, freq: FloatArray) -> float:
    """Seconds of ringing in a record; infinite unless records are truncated."""
    if not what.cut_off:
        return np.inf
    seconds = 1.0 / float(freq[1] - freq[0])
    if not what.pre_trigger < seconds:
        raise InputError(
            "troubles.pre_trigger", found=f"{what.pre_trigger:g} s",
            expected=f"less than the record, {seconds:g} s at these lines",
        )  # fmt: skip
    return seconds - what.pre_trigger


def hann_power(lines: FloatArray) -> FloatArray:
    """Power spectrum of a Hann window by distance in lines, with sum 1."""
    x = lines + 1e-9
    shape = np.sinc(x) / (1.0 - x**2)
    return np.asarray(shape**2 / np.sum(shape**2))


def _fixture(
    what: Troubles, freq: FloatArray, residues: Array, rig: Rig, drives: int, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Poles and residues (channels, modes) of local modes."""
    own = 2.0 * np.pi * rng.uniform(freq[0] + 0.1 * np.ptp(freq), freq[-1] - 0.1 * np.ptp(freq), what.fixture)
    inside = (rig.freq > freq[0]) & (rig.freq < freq[-1])
    if not what.fixture:
        return own.astype(complex), np.zeros((len(residues), 0), complex)
    if not inside.any():
        band = f"{freq[0]:g} to {freq[-1]:g} Hz"
        raise InputError("troubles.fixture", found=f"no mode of the structure from {band}", expected="one in the band")
    usual = float(np.median(np.abs(residues[:, inside]) / (2.0 * rig.zeta[inside] * rig.omega[inside] ** 2)))
    sensors = len(residues) // drives
    parts = np.zeros((len(residues), what.fixture), complex)
    for k in range(what.fixture):
        near = (int(rng.integers(sensors)) + np.arange(-1, 2)) % sensors
        for drive in range(drives):
            at = near + drive * sensors
            parts[at, k] = FIXTURE_SIZE * np.array([0.5, 1.0, 0.5]) * usual * 2.0 * FIXTURE_ZETA * own[k] ** 2
    return own * (-FIXTURE_ZETA + 1j * np.sqrt(1.0 - FIXTURE_ZETA**2)), parts


def _noise_size(what: Troubles, freq: FloatArray, H: Array, noisy: list[int]) -> FloatArray:
    """Standard deviation of the complex noise, (channels, lines)."""
    colour = (freq / freq.mean()) ** -what.colour
    hits = np.abs(1.0 + what.double_hit * np.exp(-2j * np.pi * freq * HIT_DELAY))
    sigma = np.sqrt(np.mean(np.abs(H) ** 2, axis=1))[:, None] * 10.0 ** (-what.snr_db / 20.0) * colour / hits
    sigma[noisy] *= NOISY
    return np.asarray(sigma)


def _noise(what: Troubles, shape: tuple[int, ...], drives: int, rng: np.random.Generator) -> Array:
    """Complex noise of variance one, partly common to the channels of each drive."""
    own = rng.standard_normal((2, *shape))
    common = np.repeat(rng.standard_normal((2, drives, shape[1])), shape[0] // drives, axis=1)
    turn = np.exp(2j * np.pi * rng.uniform(size=(shape[0], 1)))
    mixed = np.sqrt(1.0 - what.coherent) * (own[0] + 1j * own[1])
    return np.asarray((mixed + np.sqrt(what.coherent) * turn * (common[0] + 1j * common[1])) / np.sqrt(2.0))
