"""From the residues of a fitted pole to a real shape at the sensors, with its covariance.

The residues of one mode over sensors o and references i are phi_o phi_i, of rank one. Their first singular vectors
are the shape and the references' share; a second singular value above the noise says that one pole stands for two
modes of the same frequency.
"""

from dataclasses import dataclass

import numpy as np

from casingfem.experiment.identify.poles.pole_fit import PoleFit
from casingfem.io.arrays import Array, FloatArray, IntArray, freeze


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shape:
    """Real shape at the sensors, unit norm, with its covariance (sensors, sensors).

    `parts` (references, columns) are what the residues are multiplied by to give `values`; `collinearity` is the
    share of the energy that is in phase; `second` the second singular value in units of the largest that noise gives,
    `balance` twice the product of the first two over the sum of their squares: 1 where two modes share alike.
    """

    values: FloatArray
    covariance: FloatArray
    parts: FloatArray
    collinearity: float
    second: float
    balance: float

    def __post_init__(self) -> None:
        freeze(self, "values", "covariance", "parts")


def residue_matrix(fit: PoleFit, pole: int, grid: IntArray) -> Array:
    """Residues (sensors, references) of a pole; grid (sensors, references) has the channel of each."""
    a = fit.A[pole] / fit.window.weight
    return np.asarray((a[0] + 1j * a[1] if len(a) == 2 else a[0])[grid])


def mode_shape(fit: PoleFit, pole: int, grid: IntArray) -> Shape:
    """Shape of one pole of a fit."""
    matrix = residue_matrix(fit, pole, grid)
    u, sizes, v = np.linalg.svd(matrix, full_matrices=False)
    turn = np.exp(-0.5j * np.angle(np.sum(u[:, 0] ** 2)))
    factor = v[0].conj() * turn / sizes[0]
    peak = int(np.argmax(np.abs((matrix @ factor).real)))
    factor *= np.sign((matrix @ factor).real[peak])
    whole = matrix @ factor
    parts = np.stack([factor.real, -factor.imag], axis=1)[:, : fit.A.shape[1]]
    covariance = shape_covariance(fit, (pole, parts), (pole, parts), grid)
    norm = float(np.linalg.norm(whole.real))
    limit = _noise_size(fit, pole, grid)
    return Shape(
        values=whole.real / norm,
        covariance=covariance / norm**2,
        parts=parts / norm,
        collinearity=norm**2 / float(np.linalg.norm(whole) ** 2),
        second=float(sizes[1] / limit) if len(sizes) > 1 else 0.0,
        balance=float(2.0 * sizes[0] * sizes[1] / np.sum(sizes[:2] ** 2)) if len(sizes) > 1 else 0.0,
    )


def _noise_size(fit: PoleFit, pole: int, grid: IntArray) -> float:
    """Size (spectral norm) that noise may give a residue matrix: three sigma beyond its mean.

    Direct noise is alike in all entries, sigma (sqrt m + sqrt n) for an m x n matrix; that through the poles is one
    matrix for each of their parameters.
    """
    m, n = grid.shape
    weight = fit.window.weight[grid]
    direct = np.sqrt(np.trace(fit.gram[pole, :, pole, :]) * np.mean(1.0 / weight**2))
    variance = 0.0
    for column in range(n):
        for part in np.eye(fit.A.shape[1]):
            slopes = pole_slopes(fit, pole, part[None], grid[:, [column]])
            variance += float(np.einsum("oj,jk,ok->", slopes, fit.covariance, slopes))
    return float(np.sqrt(fit.noise) * (direct * (np.sqrt(m) + np.sqrt(n) + 3.0) + 3.0 * np.sqrt(variance)))


def shape_covariance(
    fit: PoleFit, first: tuple[int, FloatArray], second: tuple[int, FloatArray], grid: IntArray
) -> FloatArray:
    """Covariance (sensors, sensors) of two real shapes, each (pole, parts), of one fit.

    Noise reaches a residue directly, by (Phi^T Phi)^-1, and through the poles, by dA/dp.
    """
    (k, parts_k), (m, parts_m) = first, second
    weight = fit.window.weight[grid]
    direct = np.einsum("rs,st,rt,or->o", parts_k, fit.gram[k, :, m, :], parts_m, 1.0 / weight**2)
    a, b = (pole_slopes(fit, pole, parts, grid) for pole, parts in (first, second))
    return np.asarray(fit.noise * (np.diag(direct) + a @ fit.covariance @ b.T))


def pole_slopes(fit: PoleFit, pole: int, parts: FloatArray, grid: IntArray) -> FloatArray:
    """Derivative of a shape by (ln f, ln zeta) of all poles, (sensors, 2 poles)."""
    A = np.concatenate([fit.A, fit.A]) / fit.window.weight  # residues that belong to each parameter
    moved = -np.einsum("sjt,jtc->sjc", fit.tilt[pole], A)
    return np.asarray(np.einsum("rs,sjor->oj", parts, moved[:, :, grid]))
