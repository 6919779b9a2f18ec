"""Time records of the test rig: modes propagated exactly under sampled forces, then the measuring chain.

Between two samples a force is linear, and for such a force q'' + 2 zeta omega q' + omega^2 q = p is solved exactly
(matrix exponential; Van Loan, IEEE Trans. Automat. Contr. 23, 1978, 395). Computed samples are `FINER` times as dense
as the stored ones, and p - (second difference)/12 instead of p gives the piecewise linear force the spectrum of the
smooth one, with an error of theta^4/90 at theta radians per step, 1e-4 at the highest frequency allowed, fs/2.56. An
anti-alias filter without delay, equal for all channels, precedes the stored samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.linalg import expm
from scipy.signal import firwin, lfilter, oaconvolve

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.records.take import Take
from casingfem.experiment.rig.excitation import Excitation
from casingfem.experiment.rig.rig import DERIVATIVES, SYNTHETIC, UNITS, Converter, Quantity, Rig, noise
from casingfem.io.arrays import FloatArray, freeze

FINER = 8
MARGIN = 10 * FINER  # fine samples to each side that the anti-alias filter reads
BAND = 2.56  # samples a second over the highest frequency, at least, as analysers have it
HEADROOM = 1.25  # full scale of a converter over the largest value, where none is given


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Record:
    """Forces and responses, evenly sampled; arrays are read-only.

    Attributes
    ----------
    fs
        Samples per second [Hz].
    block
        Samples of a block, which an analyser transforms at once, and after which bursts and taps repeat.
    force, response
        [N], (drives, samples); [m, m/s or m/s^2], (sensors, samples).
    quantity
        Kind of the responses over forces.
    rig, drives, sensors
        Measuring points: probes of the rig.
    card
        Source lines, the first is marked SYNTHETIC.
    """

    fs: float
    block: int
    force: FloatArray
    response: FloatArray
    quantity: Quantity
    rig: Rig
    drives: tuple[int, ...]
    sensors: tuple[int, ...]
    card: tuple[str, ...]

    def __post_init__(self) -> None:
        freeze(self, "force", "response")

    @property
    def time(self) -> FloatArray:
        """Times [s], (samples,)."""
        return np.arange(self.force.shape[1]) / self.fs

    def functions(self) -> tuple[FrfSet, FrfSet]:
        """Responses and forces as sets of time records, for files."""

        def records(values: FloatArray, at: tuple[int, ...], unit: str) -> FrfSet:
            point, direction = np.array([self.rig.probes[k][:2] for k in at]).T
            places: dict[str, Any] = {"response_point": point, "response_direction": direction}
            return FrfSet.from_arrays(kind="time", x=self.time, responses=values, unit=unit, card=self.card, **places)

        unit = UNITS[self.quantity].removesuffix("/N").strip("()")
        return records(self.response, self.sensors, unit), records(self.force, self.drives, "N")

    def take(self) -> Take:
        """Forces and responses in the form for `cf.frf.estimate`."""
        response, force = self.functions()
        return Take(response=response, force=force, name="the rig's record")

    def __repr__(self) -> str:
        seconds = self.force.shape[1] / self.fs
        return (
            f"Record({len(self.force)} forces, {len(self.response)} responses, {seconds:g} s at {self.fs:g} Hz, "
            f"{self.force.shape[1] // self.block} blocks of {self.block})"
        )


def record(
    rig: Rig,
    excitations: Sequence[Excitation],
    *,
    drives: Sequence[int],
    sensors: Sequence[int],
    fs: float,
    block: int,
    blocks: int,
    seed: int,
    quantity: Quantity = "accelerance",
    card: Sequence[str] = (),
) -> Record:
    """Sensor signals from rest without noise; excitations at different drives are independent.

    Raises
    ------
    InputError
        Excitations do not match the drives or exceed fs/2.56, there are too few samples, or probes do not exist.

    Examples
    --------
    >>> from casingfem.experiment.rig.excitation import Random
    >>> rig = Rig.of(omega=[600.0], zeta=[0.01], rows=[[1.0]])
    >>> record(rig, [Random(rms=1.0, band=(50.0, 150.0))], drives=[0], sensors=[0], fs=512.0, block=256, blocks=4,
    ...        seed=11)
    Record(1 forces, 1 responses, 2 s at 512 Hz, 4 blocks of 256)
    """
    to, by = rig.checked(sensors), rig.checked(drives)
    if len(excitations) != len(by):
        raise InputError(f"excitations: found {len(excitations)}, expected one for each of {len(by)} drives")
    if block < 16 or blocks < 1:
        raise InputError(f"block {block}, blocks {blocks}: expected 16 samples or more, one block or more")
    most = max(excitation.highest for excitation in excitations)
    if not fs >= BAND * most:
        raise InputError(f"fs: found {fs:g} Hz, expected {BAND} times the highest frequency of the force, {most:g} Hz")
    rng = np.random.default_rng(seed)
    fine = np.arange(block * blocks * FINER) / (fs * FINER)
    force = np.array([excitation.force(fine, block / fs, rng) for excitation in excitations])
    return Record(
        fs=fs,
        block=block,
        force=kept(smoothed(force)),
        response=respond(rig, smoothed(prefiltered(force)), fs * FINER, by, to, quantity),
        quantity=quantity,
        rig=rig,
        drives=tuple(by),
        sensors=tuple(to),
        card=(SYNTHETIC, *card, f"excitation: {'; '.join(map(repr, excitations))}; seed {seed}"),
    )


def measured(
    clean: Record, *, seed: int, snr_db: float | None = None, bits: int | None = None, full_scale: float | None = None
) -> Record:
    """The record after the measuring chain: noise below each signal's rms, then quantisation, also of the force.

    Without `full_scale` each channel has a range 1.25 times its largest value.

    >>> import casingfem as cf
    >>> rig = cf.rig.Rig.of(omega=[600.0], zeta=[0.01], rows=[[1.0]])
    >>> force = [cf.rig.Random(rms=1.0, band=(60.0, 140.0))]
    >>> clean = cf.rig.record(rig, force, drives=[0], sensors=[0], fs=512.0, block=256, blocks=4, seed=1)
    >>> cf.rig.measured(clean, seed=2, snr_db=40.0, bits=16).card[-2:]
    ('noise: 40 dB below the rms of each response, seed 2', 'converter: 16 bits over +-1.25 x the largest value')
    """
    rng = np.random.default_rng(seed)
    response, notes = clean.response, []
    if snr_db is not None:
        response = response + noise(response, snr_db, rng)
        notes.append(f"noise: {snr_db:g} dB below the rms of each response, seed {seed}")
    force = clean.force
    if bits is not None:
        force, response = (np.array([digitised(v, bits, full_scale) for v in rows]) for rows in (force, response))
        over = "1.25 x the largest value" if full_scale is None else full_scale
        notes.append(f"converter: {bits} bits over +-{over}")
    return replace(clean, force=force, response=response, card=(*clean.card, *notes))


def digitised(values: FloatArray, bits: int, full_scale: float | None) -> FloatArray:
    """One channel after its converter."""
    largest = float(np.abs(values).max())
    return Converter(bits=bits, full_scale=full_scale or HEADROOM * largest or 1.0).convert(values)


def respond(
    rig: Rig, force: FloatArray, fs: float, drives: Sequence[int], sensors: Sequence[int], quantity: Quantity
) -> FloatArray:
    """Responses (sensors, stored samples) from rest to forces (drives, MARGIN + samples + MARGIN) of `smoothed`.

    Forces are linear between samples; only every `FINER`th response is computed.
    """
    order, by, to = DERIVATIVES[quantity], list(drives), list(sensors)
    motions = modal_motions(rig, rig.rows[by].T, force, fs, order)
    beyond = kept(differences(force, fs, order))
    return np.asarray(rig.rows[to] @ motions + rig.S[np.ix_(to, by)] @ beyond)


def prefiltered(force: FloatArray) -> FloatArray:
    """Samples whose linear interpolation has the spectrum of the smooth force: see the module."""
    return np.asarray(force - np.diff(np.pad(force, ((0, 0), (1, 1)), mode="edge"), 2, axis=1) / 12.0)


def smoothed(values: FloatArray) -> FloatArray:
    """Values after an anti-alias filter, from MARGIN samples before the first to MARGIN after the last.

    The filter is flat to .42 of the stored sampling frequency and 50 dB down beyond .58 of it. Modes and filter are
    linear and time-invariant, so filtering the few forces filters all responses.
    """
    taps = firwin(2 * MARGIN + 1, 1.0 / FINER, window=("kaiser", 5.0))
    return np.asarray(oaconvolve(values, taps[None], axes=1))


def kept(values: FloatArray) -> FloatArray:
    """Every `FINER`th of the smoothed values, from the first sample to the last."""
    return values[:, MARGIN:-MARGIN:FINER]


def modal_motions(rig: Rig, participation: FloatArray, force: FloatArray, fs: float, order: int) -> FloatArray:
    """Each mode's q, q' or q'' at the stored samples, (modes, samples).

    Between stored samples, x = (q, q') follows x_+ = A x + sum_j C_j p_j over the FINER + 1 samples p_j of the modal
    force. By Cayley and Hamilton each row of x has its own recursion, x_++ - tr(A) x_+ + det(A) x = u_+ + (A - tr A) u,
    with u the sum.
    """
    A, C = passages(rig, fs)
    trace, det = A[:, 0, 0] + A[:, 1, 1], A[:, 0, 0] * A[:, 1, 1] - A[:, 0, 1] * A[:, 1, 0]
    windows = np.swapaxes(sliding_window_view(force, FINER + 1, axis=1)[:, ::FINER], 1, 2)
    by = np.einsum("kd,kji->kidj", participation, C)
    lines = windows.reshape(len(force) * (FINER + 1), -1)
    motions = np.empty((len(rig), kept(force).shape[1]))
    for k, less in enumerate(A - trace[:, None, None] * np.eye(2)):
        u = by[k].reshape(2, -1) @ lines
        u[:, 1:] += less @ u[:, :-1]
        x = lfilter([1.0], [1.0, -trace[k], det[k]], u if order == 2 else u[order : order + 1])
        x = x[:, MARGIN // FINER - 1 :][:, : motions.shape[1]]  # u of a window ends one sample later
        if order < 2:
            motions[k] = x[0]
        else:
            w = rig.omega[k]
            motions[k] = participation[k] @ kept(force) - 2.0 * rig.zeta[k] * w * x[1] - w**2 * x[0]
    return motions


def passages(rig: Rig, fs: float) -> tuple[FloatArray, FloatArray]:
    """A (modes, 2, 2) and C (modes, FINER + 1, 2) of FINER steps under a force that is linear within each step."""
    h = 1.0 / fs
    system = np.zeros((len(rig), 4, 4))
    system[:, 0, 1], system[:, 1, 2], system[:, 2, 3] = h, h, 1.0
    system[:, 1, 0], system[:, 1, 1] = -(rig.omega**2) * h, -2.0 * rig.zeta * rig.omega * h
    phi = expm(system)
    one, held, slope = phi[:, :2, :2], phi[:, :2, 2], phi[:, :2, 3]
    C = np.zeros((len(rig), FINER + 1, 2))
    for j in range(FINER):
        C[:, : j + 1] = np.einsum("mik,mjk->mji", one, C[:, : j + 1])
        C[:, j] += held - slope
        C[:, j + 1] += slope
    return np.linalg.matrix_power(one, FINER), C


def differences(force: FloatArray, fs: float, order: int) -> FloatArray:
    """Time derivative of sampled forces by central differences."""
    if order == 0:
        return force
    if order == 1:
        return np.asarray(np.gradient(force, 1.0 / fs, axis=1))
    padded = np.pad(force, ((0, 0), (1, 1)))
    return np.asarray(np.diff(padded, 2, axis=1) * fs**2)
