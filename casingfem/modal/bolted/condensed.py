"""Harmonics of a casing condensed on the motions of edges: static shapes, and the modes while these edges are fixed.

For each number n of nodal diameters the casing without its bolts is one meridian problem (`structure.axisymmetric`).
With x the motions of the bolted edges and q the amplitudes of the modes phi with x = 0 (Craig & Bampton, AIAA J. 6,
1968, 1313),

    y = Psi x + Phi q,   K = diag(Psi^T K Psi, lambda),   M = [Psi^T M Psi, Psi^T M Phi; Phi^T M Psi, I].

Phi also has the shapes under the inertia of Psi, which make up for the modes left out (`inertial_shapes`). Above the
nodal diameters of the modes, the static shapes alone remain. They change smoothly with log n, so that a polynomial
through a few n gives all others.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from scipy.linalg import cho_factor, cho_solve, eigh

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.structure.mesh.kinematics import DOFS
from casingfem.structure.shell.axisymmetric import Meridian, harmonic_matrices
from casingfem.structure.shell.shell import Shell

DEPENDENT = 1e-8  # squared part of a shape below which others contain it
SAMPLES = 12  # nodal diameters solved for to know the static shapes of all short waves: 1e-6 of a frequency at most


class Interface(NamedTuple):
    """Motions of the bolted edges: of the nodes (edges,), and of the rings on them, numbered among the rings' own.

    A ring's number is -1 if the edge has none. `hoop` (motions,) marks those in quadrature, `edge` (motions,) numbers
    the edges, and `part` (motions,) the motions of one edge: u_r, u_theta, u_z, w_1, w_2 and the turn of a ring.
    """

    nodes: IntArray
    rings: IntArray

    @property
    def edge(self) -> IntArray:
        """Number of the edge of each motion."""
        return np.repeat(np.arange(len(self.nodes)), DOFS + (self.rings >= 0))

    @property
    def part(self) -> IntArray:
        """Number of each motion among those of its edge."""
        return np.concatenate([np.arange(DOFS + (ring >= 0)) for ring in self.rings.tolist()])

    @property
    def hoop(self) -> IntArray:
        """1 for motions along the hoop or in phase with them, 0 for the others."""
        return np.isin(self.part, (1, 4, 5)).astype(int)

    def of(self, meridian: Meridian) -> FloatArray:
        """Motions of the edges from the free dofs, (motions, free)."""
        every = np.eye(len(meridian.free))
        fields, own = meridian.expand(every), meridian.expand_own(every)
        rows = []
        for node, ring in zip(self.nodes.tolist(), self.rings.tolist(), strict=True):
            rows += [fields[node], own[ring : ring + 1] if ring >= 0 else own[:0]]
        return np.concatenate(rows)


@dataclass(frozen=True, slots=True, eq=False)
class Condensed:
    """One harmonic on the motions of edges and its fixed modes, columns x and then q.

    K and M (columns, columns) per unit angle; shapes `fields` (nodes, 5, columns) and `own` (rings, columns), both as
    `Meridian.expand` has them. `edges` is the number of columns x.
    """

    n: int
    K: FloatArray
    M: FloatArray
    fields: FloatArray
    own: FloatArray
    edges: int

    @property
    def motions(self) -> FloatArray:
        """Motions of the meridian's nodes and then of the rings, (5 nodes + rings, columns)."""
        return np.vstack([self.fields.reshape(-1, self.fields.shape[-1]), self.own])


class Split(NamedTuple):
    """One harmonic with the motions of its edges apart: K (free, free), the numbers of the other free dofs.

    `static` (free, motions) are the static shapes Psi, and `frame` is that of all harmonics.
    """

    n: int
    K: FloatArray
    static: FloatArray
    frame: "Frame"

    @property
    def held(self) -> FloatArray:
        """K with the edges fixed."""
        return self.K[np.ix_(self.frame.inside, self.frame.inside)]


class Frame(NamedTuple):
    """What all harmonics share: a meridian, its free dofs at the edges and inside.

    `back` (k, k) gives those at the edges from the motions.
    """

    meridian: Meridian
    inside: IntArray
    at_edges: IntArray
    back: FloatArray

    @property
    def mass(self) -> FloatArray:
        """The diagonal of M with the edges fixed."""
        return self.meridian.mass[self.inside]


def make_frame(shell: Shell, interface: Interface) -> Frame:
    """The free dofs of all harmonics: M, supports and the rings' masses are the same for every n."""
    meridian = harmonic_matrices(shell, 0)
    motions = interface.of(meridian)
    at_edges = np.flatnonzero(np.any(motions != 0.0, axis=0))
    inside = np.setdiff1d(np.arange(len(meridian.free)), at_edges)
    return Frame(meridian, inside, at_edges, np.asarray(np.linalg.inv(motions[:, at_edges]), dtype=float))


class Stiffness:
    """K of any n from three others: strains are linear in n, so K is quadratic."""

    def __init__(self, shell: Shell, first: int, last: int) -> None:
        self.at = np.array([first, (first + last) // 2, last])
        self.known = [harmonic_matrices(shell, int(n)).K for n in self.at]

    def __call__(self, n: int) -> FloatArray:
        """K of n (free, free), by Lagrange's polynomials."""
        total = np.zeros_like(self.known[0])
        for k, known in enumerate(self.known):
            others = np.delete(self.at, k)
            total += np.prod((n - others) / (self.at[k] - others)) * known
        return total


def split(frame: Frame, n: int, K: FloatArray) -> Split:
    """One harmonic and its static shapes under unit motions of the edges."""
    static = np.zeros((len(K), len(frame.back)))
    static[frame.at_edges] = frame.back
    factor = cho_factor(K[np.ix_(frame.inside, frame.inside)])
    static[frame.inside] = cho_solve(factor, -K[np.ix_(frame.inside, frame.at_edges)] @ frame.back)
    return Split(n, K, static, frame)


def fixed_modes(part: Split, count: int) -> tuple[FloatArray, FloatArray]:
    """Lowest modes with the edges fixed, at most `count`: eigenvalues, and vectors on all free dofs (free, modes).

    As in `fourier.lowest`, eigenvectors of the inverse keep low eigenvalues from the round-off of K.
    """
    root = 1.0 / np.sqrt(part.frame.mass)
    inverse = cho_solve(cho_factor(root[:, None] * part.held * root), np.eye(len(root)))
    inverse, size = 0.5 * (inverse + inverse.T), len(root)
    values, vectors = eigh(inverse, subset_by_index=[max(0, size - count), size - 1])
    modes = np.zeros((len(part.K), len(values)))
    modes[part.frame.inside] = root[:, None] * vectors
    return 1.0 / values[::-1], modes[:, ::-1]


def inertial_shapes(part: Split, modes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shapes with fixed edges under the inertia of the static ones, without the fixed modes: eigenvalues and vectors.

    K_ii X = M_ii Psi_i, orthogonal to the modes and to each other in K and M. They make up for the modes left out: the
    error is of second order in an eigenvalue over that of the first mode left out.
    """
    inside, mass = part.frame.inside, part.frame.mass[:, None]
    factor, fixed = cho_factor(part.held), modes[inside]
    X = cho_solve(factor, mass * part.static[inside])
    for _ in range(2):
        X -= fixed @ (fixed.T @ (mass * X))
    X /= np.sqrt(np.sum(mass * X**2, axis=0))
    squares, turn = np.linalg.eigh(X.T @ (mass * X))
    X = X @ (turn / np.sqrt(np.maximum(squares, DEPENDENT)))[:, squares > DEPENDENT]
    values, turn = eigh(X.T @ part.held @ X, X.T @ (mass * X))
    shapes = np.zeros((len(part.K), len(values)))
    shapes[inside] = X @ turn
    return values, shapes


def condensed(part: Split, values: FloatArray, modes: FloatArray) -> Condensed:
    """One harmonic on its edges and fixed modes with their eigenvalues."""
    columns, edges = np.hstack([part.static, modes]), part.static.shape[1]
    K = np.diag(np.append(np.zeros(edges), values))
    K[:edges, :edges] = part.static.T @ part.K @ part.static
    meridian = part.frame.meridian
    M = columns.T @ (meridian.mass[:, None] * columns)
    return Condensed(part.n, K, M, meridian.expand(columns), meridian.expand_own(columns), edges)


class ShortWaves(NamedTuple):
    """Static shapes of many n from those of a few: `weights` (n, samples) of the sampled harmonics.

    Stiffness grows with n and mass falls with it, so n^-1 K and n M are interpolated.
    """

    n: IntArray
    samples: Sequence[Condensed]
    weights: FloatArray

    @property
    def K(self) -> FloatArray:
        """Stiffness of each n, (n, motions, motions)."""
        return self.n[:, None, None] * np.tensordot(self.weights, np.stack([s.K / s.n for s in self.samples]), 1)

    @property
    def M(self) -> FloatArray:
        """Mass of each n, (n, motions, motions)."""
        return np.tensordot(self.weights, np.stack([s.M * s.n for s in self.samples]), 1) / self.n[:, None, None]

    def motions(self, n: IntArray, waves: Array) -> Array:
        """Motions of the meridian's nodes and rings (n, 5 nodes + rings) from those of the edges (n, motions)."""
        weights = self.weights[n - self.n[0]].T
        parts = zip(weights, self.samples, strict=True)
        return np.asarray(sum((weight[:, None] * waves) @ each.motions.T for weight, each in parts))


def short_waves(shell: Shell, frame: Frame, first: int, last: int) -> ShortWaves:
    """Static shapes from n = first to last, by Chebyshev interpolation in log n."""
    n = np.arange(first, last + 1)
    places = 0.5 * (1.0 - np.cos(np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES))
    at = np.unique(np.append(np.round(first * (last / first) ** places).astype(int), (first, last)))

    def unit(k: IntArray) -> FloatArray:
        return np.asarray(2.0 * np.log(k / first) / np.log(last / first) - 1.0, dtype=float)

    basis = chebyshev.chebvander(unit(at), len(at) - 1)
    weights = np.asarray(np.linalg.solve(basis.T, chebyshev.chebvander(unit(n), len(at) - 1).T).T, dtype=float)
    stiffness, none = Stiffness(shell, first, last), (np.zeros(0), np.zeros((len(frame.meridian.free), 0)))
    parts = [split(frame, int(k), stiffness(int(k))) for k in at]
    return ShortWaves(n, [condensed(part, *none) for part in parts], weights)
