"""How strongly each nodal diameter of a rim vibrates in a run."""

import numpy as np

import contact as ct
from casingfem.io.arrays import FloatArray


def radial_power(casing: ct.ModalBody, q: FloatArray) -> FloatArray:
    """Square of the rim's radial motion by nodal diameters [m^2], (times, n_max + 1), about its mean over the times."""
    N = casing.n_max
    radial = q @ casing.rows[: 2 * N + 1].T
    power = (radial - radial.mean(axis=0)) ** 2  # the vibration about the static push
    total = power[:, : N + 1]
    total[:, 1:] = 0.5 * (total[:, 1:] + power[:, N + 1 :])
    return np.asarray(total)


def rim_levels(casing: ct.ModalBody, result: ct.Result, last: float = 0.25) -> FloatArray:
    """RMS radial motion by nodal diameters over the last part of a run [m], (n_max + 1,)."""
    late = result.state_time >= (1.0 - last) * result.state_time[-1]
    return np.asarray(np.sqrt(radial_power(casing, result.state_of("casing")[late]).mean(axis=0)))


def level_history(casing: ct.ModalBody, result: ct.Result, windows: int) -> tuple[FloatArray, FloatArray]:
    """Middle of each window [s], (windows,), and RMS motion by nodal diameters in it [m], (windows, n_max + 1)."""
    power = radial_power(casing, result.state_of("casing"))
    size = len(power) // windows
    levels = np.sqrt(power[: windows * size].reshape(windows, size, -1).mean(axis=1))
    return result.state_time[: windows * size].reshape(windows, size).mean(axis=1), levels


def excess_db(levels: FloatArray, n: int) -> float:
    """Level of n over the highest other one [dB].

    >>> round(excess_db(np.array([0.0, 1.0, 10.0]), 2), 9)
    20.0
    """
    return float(20.0 * np.log10(levels[n] / np.delete(levels, n).max()))
