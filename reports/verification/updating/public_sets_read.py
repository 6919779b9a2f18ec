"""Readers of public sets, each for the layout of its owners."""

import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from scipy.io import wavfile

from casingfem.errors import InputError
from casingfem.experiment.frf.files import read_frfs
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.loose_arrays import read_mat
from casingfem.io.arrays import Array, FloatArray
from contact.io.infiles import regular_file


def functions(freq: ArrayLike, H: Array, unit: str = "", *, points: Sequence[int] = (), references: int = 1) -> FrfSet:
    """Frequency responses H (channels, lines) without the line at 0 Hz; references follow one another at each point."""
    rows, lines = np.atleast_2d(H), np.asarray(freq, float)
    at = np.asarray(points or range(1, len(rows) // references + 1))
    return FrfSet.from_arrays(
        kind="frf", x=lines[lines > 0.0], responses=rows[:, lines > 0.0], unit=unit,
        response_point=np.repeat(at, references), reference_point=np.tile(np.arange(1, references + 1), len(at)),
    )  # fmt: skip


def records(fs: float, y: FloatArray, unit: str = "m/s^2") -> FrfSet:
    """Records y (channels, samples)."""
    return FrfSet.from_arrays(
        kind="time", x=np.arange(y.shape[1]) / fs, responses=y, unit=unit, response_point=np.arange(1, len(y) + 1)
    )


def columns(paths: list[Path], step: float) -> FrfSet:
    """A text file of complex numbers for each channel, one a line."""
    H = np.array([np.loadtxt(regular_file(path), dtype=complex) for path in paths])
    return functions(step * np.arange(H.shape[1]), H, "(m/s^2)/N")


def tables(paths: list[Path]) -> FrfSet:
    """An ASCII file of an analyser for each channel: nine lines, then frequency, real and imaginary part."""
    rows = [np.loadtxt(regular_file(path), skiprows=9, encoding="latin-1") for path in paths]
    return functions(rows[0][:, 0], np.array([row[:, 1] + 1j * row[:, 2] for row in rows]), "(m/s^2)/N")


def named(path: Path, **arrays: str) -> FrfSet:
    """A MATLAB file with arrays of other names."""
    return read_frfs(path, arrays=arrays) if arrays else read_frfs(path)


def analyser(paths: list[Path], channels: Sequence[int]) -> FrfSet:
    """MATLAB files of an analyser: H1_2 and so on, of two columns, frequency and response; a file for each hit."""
    files = [read_mat(path) for path in paths]
    freq = files[0][f"H1_{channels[0]}"][:, 0].real
    H = [file[f"H1_{channel}"][:, 1] for file in files for channel in channels]
    return functions(freq, np.array(H), "g/N", references=len(channels))


def logger(path: Path, name: str = "yspec") -> FrfSet:
    """A MATLAB file of a laboratory's logger: transfer functions, points of the transform, sampling rate."""
    stored = read_mat(path)
    H = stored[name].T
    rate, count = float(stored["freq"]), float(stored["npts"])
    return functions(rate / count * np.arange(H.shape[1]), H)


def real_and_imaginary(path: Path, name: str) -> FrfSet:
    """A MATLAB file with two columns, real and imaginary part, and the step `df` of the lines."""
    stored = read_mat(path)
    parts = stored[name]
    return functions(float(stored["df"]) * np.arange(len(parts)), parts[:, 0] + 1j * parts[:, 1], "m/N")


def two_directions(path: Path) -> FrfSet:
    """A MATLAB file with the responses of a tool in x and y."""
    stored = read_mat(path)
    H = np.array([np.ravel(stored[name]) for name in ("FRFX", "FRFY")])
    return functions(float(stored["df"]) * np.arange(H.shape[1]), H, "m/N")


def array_of_samples(path: Path, fs: float, channels: int) -> FrfSet:
    """A numpy file of samples (samples, channels), of which the first channels are read."""
    stored = np.load(regular_file(path), allow_pickle=False)
    return records(fs, stored.T[:channels], "")


def table_of_samples(path: Path, fs: float) -> FrfSet:
    """A text table of samples without a header, a column for each channel."""
    return records(fs, np.loadtxt(regular_file(path), delimiter=",").T)


def bridge(path: Path) -> FrfSet:
    """Instants `t` and displacements `rz` (sensors, samples)."""
    stored = read_mat(path)
    return records(1.0 / float(np.diff(np.ravel(stored["t"])).mean()), stored["rz"], "m")


def ringing(path: Path, seconds: float, band: tuple[float, float]) -> FrfSet:
    """The spectrum of a sound from its loudest sample on: responses to a hit whose spectrum is flat in the band."""
    with warnings.catch_warnings():  # of chunks with a title
        warnings.simplefilter("ignore", wavfile.WavFileWarning)
        fs, sound = wavfile.read(regular_file(path))
    y = np.atleast_2d(sound.astype(float).T)
    first = int(np.abs(y[0]).argmax())
    part = y[:, max(0, first - 40) : first + int(seconds * fs)]
    if part.shape[1] < 0.5 * seconds * fs:
        raise InputError(str(path), found=f"{part.shape[1] / fs:.3g} s of ringing", expected=f"{seconds:g} s")
    freq = np.fft.rfftfreq(part.shape[1], 1.0 / fs)
    kept = (freq >= band[0]) & (freq <= band[1])
    return functions(freq[kept], np.fft.rfft(part, axis=1)[:, kept] / fs)
