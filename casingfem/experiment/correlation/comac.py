"""Where shapes differ: coordinate modal assurance criteria over the channels of paired shapes.

    COMAC_c  = (sum_k |a_ck b_ck|)^2/(sum_k a_ck^2 sum_k b_ck^2)   (Lieven and Ewins, IMAC 1988)
    ECOMAC_c = sum_k |a_ck - b_ck|/(2 m)                          (Hunt, IMAC 1992)

The computed partner of a measured shape is its best approximation in the plane of the doublet, so that a rotated
doublet is no difference; of a single mode it is the mode itself, scaled.
"""

import numpy as np
from numpy.typing import ArrayLike

from casingfem.io.arrays import FloatArray


def nearest_in_plane(measured: ArrayLike, plane: ArrayLike) -> FloatArray:
    """Least-squares approximation of measured shapes (channels, m) by computed ones (channels, k).

    >>> nearest_in_plane([[1.0], [1.0], [0.5]], [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]).ravel().tolist()
    [1.0, 1.0, 0.0]
    """
    shapes, basis = np.asarray(measured, float), np.asarray(plane, float)
    return np.asarray(basis @ np.linalg.lstsq(basis, shapes, rcond=None)[0])


def comac(measured: ArrayLike, computed: ArrayLike) -> FloatArray:
    """COMAC of each channel over paired shapes (channels, m), in [0, 1]; nan where one side never moves.

    Low values can mean a small amplitude as well as an error: read them beside `ecomac`.

    >>> comac([[1.0, 2.0], [1.0, -1.0]], [[1.0, 2.0], [1.0, 3.0]]).round(3).tolist()
    [1.0, 0.8]
    """
    a, b = paired(measured, computed)
    below = np.sum(a**2, axis=1) * np.sum(b**2, axis=1)
    return np.asarray(np.sum(np.abs(a * b), axis=1) ** 2 / np.where(below > 0.0, below, np.nan))


def ecomac(measured: ArrayLike, computed: ArrayLike) -> FloatArray:
    """Enhanced COMAC of each channel: 0 where all shapes agree; each shape has unit length and the signs agree.

    A sensor that is turned over stands out here, but not in COMAC.

    >>> ecomac([[1.0], [1.0]], [[1.0], [-1.0]]).round(3).tolist()
    [0.0, 0.707]
    """
    a, b = paired(measured, computed)
    a, b = (x / np.linalg.norm(x, axis=0) for x in (a, b))
    signs = np.where(np.sum(a * b, axis=0) < 0.0, -1.0, 1.0)
    return np.asarray(np.abs(a - signs * b).mean(axis=1) / 2.0)


def paired(measured: ArrayLike, computed: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Both as (channels, m) of equal size.

    Raises
    ------
    ValueError
        Shapes that are not paired, or zero.
    """
    a, b = np.asarray(measured, float), np.asarray(computed, float)
    if a.ndim != 2 or a.shape != b.shape or not a.size:
        raise ValueError(f"paired shapes need equal sizes (channels, modes), not {a.shape} and {b.shape}")
    if not (np.all(np.any(a, axis=0)) and np.all(np.any(b, axis=0))):
        raise ValueError("paired shapes: one is zero at every channel")
    return a, b
