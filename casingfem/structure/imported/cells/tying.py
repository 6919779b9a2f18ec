"""Strains of the degenerated shell, sampled at tying points where quadrature points would cause locking.

MITC9: along r, eps_rr, chi_rr and gamma_r are sampled at two Gauss points in r times three in s, so that they are
linear in r and quadratic in s; the components along s vice versa; eps_rs and chi_rs at two times two. Constant strains
are then exact on parallelograms and nearly so on others. MITC4: gamma_r is sampled in the middle of the edges along r,
gamma_s in those along s; other strains are not tied. MITC6 (triangles of six nodes) after Lee & Bathe, Comput. Struct.
82, 2004, 945: with q along the third edge, e_rr, e_ss and e_qq = (e_rr + e_ss)/2 - e_rs are linear; (gamma_r, gamma_s)
= (p1 + s m, p2 - r m) with linear p1, p2, m. Each is sampled at the Gauss points of its edges. The remaining terms,
which the paper takes from one point of the cell, are here averaged over the cell. Then the change by tying has no
resultant, which removes a second-order error of frequencies.
"""

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import FloatArray, frozen
from casingfem.structure.imported.mesh.cell_kind import rule, shape_functions

ROWS = {"rr": (0, 3, 6), "ss": (1, 4, 7), "rs": (2, 5)}  # of (eps 3, chi 3, gamma 2)
TWO = 0.5 + 0.5 * np.array([-1.0, 1.0]) / np.sqrt(3.0)  # Gauss points on [0, 1]
INSIDE = np.array([[1.0, 4.0, 1.0], [1.0, 1.0, 4.0]]) / 6.0  # the mean here is that of a quadratic over a triangle
Terms = list[tuple[FloatArray, FloatArray]]
THREE = 0.5 + 0.5 * np.array([-1.0, 0.0, 1.0]) * np.sqrt(0.6)


class Tied(NamedTuple):
    """Strain rows `made` at the quadrature points: rows `of` at points (2, ties), summed with weights (q, ties)."""

    made: tuple[int, ...]
    of: tuple[int, ...]
    places: FloatArray
    weights: FloatArray


def lagrange(nodes: FloatArray, x: FloatArray) -> FloatArray:
    """Lagrange polynomials on nodes at x, (nodes, points)."""
    rows = [np.prod([(x - b) / (a - b) for j, b in enumerate(nodes) if j != i], axis=0) for i, a in enumerate(nodes)]
    return np.array([row * np.ones_like(x) for row in rows])


@cache
def tying(kind: str) -> tuple[Tied, ...]:
    """Tying points of the assumed strains at the quadrature points of a kind of cell."""
    points = rule(kind)[0]
    if kind == "triangle6":
        return (*in_plane(points), *across(points))
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
        found.append(Tied(rows, rows, frozen(places), frozen(weights)))
    if kind == "quad":
        plane = (0, 1, 2, 3, 4, 5)
        found.append(Tied(plane, plane, points, np.eye(points.shape[1])))
    return tuple(found)


def in_plane(points: FloatArray) -> list[Tied]:
    """Membrane strains and changes of curvature of a triangle at points (2, q): 2 e_rs = e_rr + e_ss - 2 e_qq."""
    along = {"rr": [TWO, [0.0, 0.0]], "ss": [[0.0, 0.0], TWO], "qq": [TWO[::-1], TWO]}
    places = {name: frozen(np.hstack([np.array(edge), INSIDE])) for name, edge in along.items()}
    linear = {name: linear_weights(at, points) for name, at in places.items()}
    rr, ss, rs = (rows[:2] for rows in ROWS.values())
    signs = {("rr", rr): 1.0, ("ss", ss): 1.0, ("qq", rr): -1.0, ("qq", ss): -1.0, ("qq", rs): 1.0}
    sheared = [Tied(rs, of, places[at], frozen(sign * linear[at])) for (at, of), sign in signs.items()]
    return [Tied(of, of, places[at], frozen(linear[at])) for at, of in (("rr", rr), ("ss", ss))] + sheared


def linear_weights(places: FloatArray, points: FloatArray) -> FloatArray:
    """Weights (q, 5) of values at places (2, 5) in the linear function at points (2, q).

    It has the values at the first two places and the mean of those at the last three.
    """
    seen = np.zeros((3, 5))
    seen[0, 0] = seen[1, 1] = 1.0
    seen[2, 2:] = 1.0 / 3.0
    here, there = (np.vstack([np.ones(x.shape[1]), x]) for x in (places, points))
    return np.asarray(there.T @ np.linalg.solve(seen @ here.T, seen))


def across(points: FloatArray) -> list[Tied]:
    """Transverse shear of a triangle at points (2, q)."""
    (near, far), no = TWO, (0.0, 0.0)
    places = np.hstack([np.array([[near, far, *no, far, near], [*no, near, far, near, far]]), INSIDE])
    seen = np.zeros((8, 2, 9))  # what is sampled of gamma_r and gamma_s at the places
    seen[range(6), :, range(6)] = [[1, 0], [1, 0], [0, 1], [0, 1], [-1, 1], [-1, 1]]
    seen[6, 0, 6:] = seen[7, 1, 6:] = 1.0 / 3.0
    sampled = np.einsum("ict,cft->if", seen, shear_functions(places))
    weights = np.einsum("mfq,fi,ict->mcqt", shear_functions(points), np.linalg.inv(sampled), seen)
    return [
        Tied((6 + made,), (6 + of,), frozen(places[:, used]), frozen(weights[made, of][:, used]))
        for made in (0, 1)
        for of in (0, 1)
        for used in [np.flatnonzero(seen[:, of].any(axis=0))]
    ]


def shear_functions(x: FloatArray) -> FloatArray:
    """The functions (p1 + s m, p2 - r m) with linear p1, p2, and m = r or s, at x (2, points), (2, 8, points)."""
    (r, s), no = x, np.zeros((3, x.shape[1]))
    linear = np.stack([np.ones_like(r), r, s])
    first, other = np.stack([r * s, s * s]), np.stack([-r * r, -r * s])
    return np.stack([np.concatenate([linear, no, first]), np.concatenate([no, linear, other])])


def covariant_strains(
    kind: str, places: FloatArray, rows: Sequence[int], x: FloatArray, n: FloatArray, e: FloatArray
) -> FloatArray:
    """Rows of the covariant strains at local points, over the five dofs of each node, (cells, points, rows, 5 k).

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

    The frame's first direction is `along` projected on the surface, or the direction of r. The curvature b_11, b_22,
    b_12 there, (3, cells, q), is that of the directors: b_ij = -sym(e_i . D_j n).
    """
    D, measure, curvature = surface(kind, x, n, along)
    return to_local(D) @ tied_covariant(kind, x, n, e), measure, curvature


def surface(
    kind: str, x: FloatArray, n: FloatArray, along: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """D of `local_frame`, the measure and the curvature at the quadrature points, as returned by `tied_strains`."""
    _, weights, _, slopes = rule(kind)
    x_r, x_s = np.einsum("dkq,ekc->deqc", slopes, x, optimize=True)
    frame, D = local_frame(x_r, x_s, along)
    turn = D @ np.moveaxis(np.einsum("dkq,ekc->deqc", slopes, n, optimize=True), 0, -2)
    b = -frame @ turn.swapaxes(-1, -2)
    curvature = np.stack([b[..., 0, 0], b[..., 1, 1], 0.5 * (b[..., 0, 1] + b[..., 1, 0])])
    return D, np.linalg.norm(np.cross(x_r, x_s), axis=-1) * weights, curvature


def tied_covariant(kind: str, x: FloatArray, n: FloatArray, e: FloatArray) -> FloatArray:
    """Covariant strains at the quadrature points from their tying points, (cells, q, 8, 5 k)."""
    covariant = np.zeros((len(x), rule(kind)[0].shape[1], 8, 5 * x.shape[1]))
    for made, of, places, weights in tying(kind):
        sampled = covariant_strains(kind, places, of, x, n, e)
        covariant[:, :, list(made)] += np.einsum("qt,etrd->eqrd", weights, sampled, optimize=True)
    return covariant


def local_frame(x_r: FloatArray, x_s: FloatArray, along: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Orthonormal tangents e1, e2 (..., 2, 3), and e_i = D_ia x,a (..., 2, 2); e1 closest to `along`."""
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
