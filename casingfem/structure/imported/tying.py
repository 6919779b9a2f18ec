"""Strains of the degenerated shell on quadrilaterals, taken from tying points where quadrature points would lock.

MITC9: along r, eps_rr, chi_rr and gamma_r are sampled at two Gauss points in r times three in s, so that they are
linear in r and quadratic in s; the components along s the other way round; eps_rs and chi_rs at two times two.
Constant strains are then exact on parallelograms and nearly so on others.
MITC4: gamma_r is sampled in the middle of the edges along r, gamma_s in those along s; the rest is not tied.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np

from casingfem.io.arrays import FloatArray, frozen
from casingfem.structure.imported.cell_kind import rule, shape_functions

ROWS = {"rr": (0, 3, 6), "ss": (1, 4, 7), "rs": (2, 5)}  # of (eps 3, chi 3, gamma 2)
TWO = 0.5 + 0.5 * np.array([-1.0, 1.0]) / np.sqrt(3.0)  # Gauss points on [0, 1]
Terms = list[tuple[FloatArray, FloatArray]]
THREE = 0.5 + 0.5 * np.array([-1.0, 0.0, 1.0]) * np.sqrt(0.6)


def lagrange(nodes: FloatArray, x: FloatArray) -> FloatArray:
    """Lagrange polynomials on nodes at x, (nodes, points)."""
    rows = [np.prod([(x - b) / (a - b) for j, b in enumerate(nodes) if j != i], axis=0) for i, a in enumerate(nodes)]
    return np.array([row * np.ones_like(x) for row in rows])


@cache
def tying(kind: str) -> tuple[tuple[tuple[int, ...], FloatArray, FloatArray], ...]:
    """Strain rows, their tying points (2, ties), and the interpolation to the quadrature points (q, ties)."""
    points = rule(kind)[0]
    half, ends = np.array([0.5]), np.array([0.0, 1.0])
    sets: Sequence[tuple[tuple[int, ...], FloatArray, FloatArray]]
    if kind == "quad9":
        sets = [(ROWS["rr"], TWO, THREE), (ROWS["ss"], THREE, TWO), (ROWS["rs"], TWO, TWO)]
    else:
        sets = [((6,), half, ends), ((7,), ends, half)]
    found = []
    for rows, r, s in sets:
        places = np.stack([np.repeat(r, len(s)), np.tile(s, len(r))])
        weights = np.einsum("iq,jq->qij", lagrange(r, points[0]), lagrange(s, points[1])).reshape(len(points[0]), -1)
        found.append((rows, frozen(places), frozen(weights)))
    if kind == "quad":
        found.append(((0, 1, 2, 3, 4, 5), points, np.eye(points.shape[1])))
    return tuple(found)


def covariant_strains(
    kind: str, places: FloatArray, rows: Sequence[int], x: FloatArray, n: FloatArray, e: FloatArray
) -> FloatArray:
    """Rows of the covariant strains at local places, over the five dofs of each node, (cells, places, rows, 5 k).

    x, n are positions and directors of the nodes (cells, k, 3), e their tangents (cells, k, 2, 3).
    """
    N, slopes = shape_functions(kind, places)
    x_r, x_s = np.einsum("dkp,ekc->depc", slopes, x, optimize=True)
    n_r, n_s = np.einsum("dkp,ekc->depc", slopes, n, optimize=True)
    director = np.einsum("kp,ekc->epc", N, n)

    r, s = slopes
    terms: dict[int, tuple[Terms, Terms]] = {  # of each strain: (shape function, vector) on u and on w
        0: ([(r, x_r)], []),
        1: ([(s, x_s)], []),
        2: ([(s, x_r), (r, x_s)], []),
        3: ([(r, n_r)], [(r, x_r)]),
        4: ([(s, n_s)], [(s, x_s)]),
        5: ([(s, n_r), (r, n_s)], [(s, x_r), (r, x_s)]),
        6: ([(r, director)], [(N, x_r)]),
        7: ([(s, director)], [(N, x_s)]),
    }
    table = np.zeros((len(x), places.shape[1], len(rows), x.shape[1], 5))
    for k, row in enumerate(rows):
        for shape, vector in terms[row][0]:
            table[:, :, k, :, :3] += shape.T[None, :, :, None] * vector[:, :, None, :]
        for shape, vector in terms[row][1]:
            table[:, :, k, :, 3:] += shape.T[None, :, :, None] * np.einsum("epc,ekac->epka", vector, e, optimize=True)
    return table.reshape(*table.shape[:3], -1)


def tied_strains(
    kind: str, x: FloatArray, n: FloatArray, e: FloatArray, along: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Strains in a local frame at the quadrature points (cells, q, 8, 5 k), the measure (cells, q), the curvature.

    The frame's first direction is `along` as the surface sees it, or that of r. The curvature b_11, b_22, b_12 there,
    b_ij = -sym(e_i . D_j n), (3, cells, q), is that of the directors.
    """
    _, weights, _, slopes = rule(kind)
    covariant = tied_covariant(kind, x, n, e)
    x_r, x_s = np.einsum("dkq,ekc->deqc", slopes, x, optimize=True)
    frame, D = local_frame(x_r, x_s, along)
    turn = D @ np.moveaxis(np.einsum("dkq,ekc->deqc", slopes, n, optimize=True), 0, -2)
    b = -frame @ turn.swapaxes(-1, -2)
    curvature = np.stack([b[..., 0, 0], b[..., 1, 1], 0.5 * (b[..., 0, 1] + b[..., 1, 0])])
    return to_local(D) @ covariant, np.linalg.norm(np.cross(x_r, x_s), axis=-1) * weights, curvature


def tied_covariant(kind: str, x: FloatArray, n: FloatArray, e: FloatArray) -> FloatArray:
    """Covariant strains at the quadrature points, taken from where they are tied, (cells, q, 8, 5 k)."""
    covariant = np.empty((len(x), rule(kind)[0].shape[1], 8, 5 * x.shape[1]))
    for rows, places, spread in tying(kind):
        sampled = covariant_strains(kind, places, rows, x, n, e)
        covariant[:, :, list(rows)] = np.einsum("qt,etrd->eqrd", spread, sampled, optimize=True)
    return covariant


def local_frame(x_r: FloatArray, x_s: FloatArray, along: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Orthonormal tangents e1, e2 (..., 2, 3), and e_i = D_ia x,a (..., 2, 2); e1 as `along` as it can be."""
    normal = np.cross(x_r, x_s)
    normal = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
    e1 = x_r if along is None else along - (normal @ along)[..., None] * normal
    e1 = e1 / np.linalg.norm(e1, axis=-1, keepdims=True)
    frame = np.stack([e1, np.cross(normal, e1)], axis=-2)
    return frame, np.linalg.inv(np.stack([x_r, x_s], axis=-2) @ frame.swapaxes(-1, -2))


def to_local(D: FloatArray) -> FloatArray:
    """Covariant strains (eps, chi, gamma along r, s) -> strains along e_i = D_ia x,a (..., 2, 2), (..., 8, 8)."""
    (a, b), (c, d) = (D[..., 0, :].T, D[..., 1, :].T)
    T = np.zeros((*a.T.shape, 8, 8))
    plane = [[a * a, b * b, a * b], [c * c, d * d, c * d], [2 * a * c, 2 * b * d, a * d + b * c]]
    for i in range(3):
        for j in range(3):
            T[..., i, j] = T[..., 3 + i, 3 + j] = plane[i][j].T
    T[..., 6:, 6:] = D
    return T
