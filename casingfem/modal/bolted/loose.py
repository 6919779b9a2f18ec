"""Loose bolts as a change of a casing on tight ones, in a small basis (Rayleigh-Ritz).

Tight bolts couple few harmonics each, loose ones all. With C = diag(+-1) and B (unknowns, springs) the patches of the
loose bolts as springs on moments of the motion, the stiffness is

    K - B C B^T,   in the basis of the tight casing's modes up to a frequency, S = (K + s M)^-1 B, (K + s M)^-1 M S.

S has the static shapes under forces at the springs, the last part those under the inertia of S. They make up for the
modes left out, with an error of fourth order in an eigenvalue over that of the first mode left out. The number of
eigenvalues below a shift sigma follows from the inertia of K - sigma M and of C - B^T (K - sigma M)^-1 B (Haynsworth,
Linear Algebra Appl. 1, 1968, 73).
"""

from collections.abc import Sequence
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eigh
from scipy.special import eval_gegenbauer

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.bolted.coupled import Coupling, Dofs, Group, merged
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.mesh.element import gauss

DEGREES, EXACT = 10, 14  # moments of the motion over a narrow patch, and Gauss points beyond their number or n width/2
SOFT = 1e-12  # part of a bolt's largest stiffness below which a component has none
DEPENDENT = 1e-11  # squared part of a shape below which others contain it
FELT = 1e-6  # part of its force by which a spring is relieved: below, its loss changes nothing
STRONG = 0.1  # the same for springs with the shape under its inertia
REACH = 4.0  # modes of the tight casing up to this multiple of the highest eigenvalue, twice its frequency: 1e-6
SHIFT = 1e-2  # s, as part of that eigenvalue: static shapes exist for a casing that is free to move, too


class LooseBolts(NamedTuple):
    """Springs that loose bolts lack, each on one moment of the motion over a patch.

    The arrays have one entry for each spring: `edge`, `angle` of the bolt and half the `width` of its patch [rad], the
    `degree` k of the moment int p phi_k x dtheta, `factors` on the motions of the edge (springs, parts), and `sign`,
    which is -1 for a bolt that is stiffer than the others.
    """

    edge: IntArray
    angle: FloatArray
    width: FloatArray
    degree: IntArray
    factors: FloatArray
    sign: FloatArray

    def on(self, coupling: Coupling, dofs: Dofs) -> FloatArray:
        """B (unknowns, springs); unknowns that are not motions of the edges have none."""
        B = np.zeros((len(dofs.n), len(self.sign)))
        moving = np.flatnonzero(dofs.column < len(coupling.interface.part))
        own = dofs.of(moving)
        waves = coupling.waves(own)[:, None] * np.exp(1j * np.outer(own.n, self.angle))
        for width in np.unique(self.width):
            here = np.flatnonzero(self.width == width)
            waves[:, here] *= moments(own.n * width, 1 + max(self.degree[here]))[:, self.degree[here]]
        there = coupling.interface.edge[own.column][:, None] == self.edge
        B[moving] = np.where(there, waves.real * self.factors[:, coupling.interface.part[own.column]].T, 0.0)
        return B


def moments(x: FloatArray, degrees: int) -> Array:
    """Moments of e^(i x xi) over a patch with the polynomials that are orthonormal for its density, (x, degrees).

    The sum of the products of two waves' moments over all degrees is the integral of the waves' product.

    >>> m = moments(np.array([0.0, 1.5]), 10)
    >>> round(float(abs(m[0, 0])), 9), bool(np.all(abs(m[0, 1:]) < 1e-12)), round(float(np.sum(np.abs(m[1]) ** 2)), 9)
    (1.0, True, 1.0)
    """
    places, weights = gauss(EXACT + max(degrees, int(np.max(x, initial=0.0))))
    xi = 2.0 * places - 1.0
    density = weights * 1.875 * (1.0 - xi**2) ** 2
    polynomials = eval_gegenbauer(np.arange(degrees), 2.5, xi[:, None])
    polynomials /= np.sqrt(density @ polynomials**2)
    return np.asarray(np.exp(1j * np.outer(x, xi)) @ (density[:, None] * polynomials))


def loose_bolts(bolts: Sequence[Bolts], stiffness: Sequence[FloatArray], waves: int) -> LooseBolts:
    """The springs that the loose bolts of each edge lack.

    `stiffness` is that of one tight bolt on the edge's motions, and `waves` the highest n that is not static.

    >>> loose_bolts([Bolts(count=8, k=1.0, loose={2: 0.25})], [np.eye(3)], 20).factors.shape == (3 * (DEGREES + 2), 3)
    True
    """
    parts = max(len(D) for D in stiffness)
    rows: list[tuple[int, float, float, int, FloatArray, float]] = []
    for edge, (support, D) in enumerate(zip(bolts, stiffness, strict=True)):
        values, axes = np.linalg.eigh(D)
        springs = np.zeros((np.count_nonzero(values > SOFT * values[-1]), parts))
        springs[:, : len(D)] = (axes * np.sqrt(np.maximum(values, 0.0)))[:, values > SOFT * values[-1]].T
        degrees = DEGREES + int(waves * 0.5 * support.patch)
        for number, factor in support.loose.items():
            lack = 1.0 - float(np.real(factor))
            angle, amount = float(support.angles[number - 1]), np.sqrt(abs(lack))
            every = product(amount * springs, range(degrees)) if lack else ()
            rows += [(edge, angle, 0.5 * support.patch, k, spring, float(np.sign(lack))) for spring, k in every]
    numbers = np.array([(*row[:4], row[5]) for row in rows]).reshape(-1, 5).T
    factors = np.array([row[4] for row in rows]).reshape(-1, parts)
    edges, angles, widths, orders, signs = numbers
    return LooseBolts(edges.astype(int), angles, widths, orders.astype(int), factors, signs)


class Shapes(NamedTuple):
    """Motions of one group: y and z of `Group`, (unknowns, motions)."""

    group: Group
    long: FloatArray
    short: FloatArray

    def under(self, long: FloatArray, short: FloatArray, shift: float) -> "Shapes":
        """Static shapes of K + shift M under forces on the long and the short waves (unknowns, forces)."""
        group = self.group
        load = long + group.follow.T @ short
        y = cho_solve(cho_factor(group.K + shift * group.M), load) if len(load) else load
        return Shapes(group, y, cho_solve(cho_factor(group.short_K), short) if len(short) else short)

    def inertia(self) -> tuple[FloatArray, FloatArray]:
        """M times the motions, on the long and the short waves."""
        group = self.group
        followed = group.short_M @ (group.follow @ self.long)
        moved = group.short_M @ self.short
        return group.M @ self.long - group.follow.T @ followed, followed + moved

    def times(self, turn: FloatArray) -> "Shapes":
        """Combinations of them."""
        return Shapes(self.group, self.long @ turn, self.short @ turn)

    def beside(self, others: "Shapes") -> "Shapes":
        """These motions and then others."""
        return Shapes(self.group, np.hstack([self.long, others.long]), np.hstack([self.short, others.short]))

    def on(self, B: FloatArray) -> FloatArray:
        """Motions at the springs, B^T v (springs, motions)."""
        size = len(self.long)
        return np.asarray(B[:size].T @ self.long + B[size:].T @ (self.group.follow @ self.long + self.short))

    @property
    def K(self) -> FloatArray:
        """Stiffness between the motions."""
        return np.asarray(self.long.T @ self.group.K @ self.long + self.short.T @ self.group.short_K @ self.short)

    @property
    def M(self) -> FloatArray:
        """Mass between the motions."""
        long, short = self.inertia()
        return np.asarray(self.long.T @ long + (self.group.follow @ self.long + self.short).T @ short)


def basis(
    groups: Sequence[Group], forces: Sequence[FloatArray], reach: float, shift: float
) -> tuple[list[Shapes], list[IntArray]]:
    """Shapes of each group, and their numbers in the whole basis.

    Modes of the tight casing up to `reach` belong to one group each; the others are common to all groups: static shapes
    under `forces` B (unknowns, springs) of each group, and those under the inertia of these.
    """
    modes = [Shapes(group, vectors := group.modes(reach)[1], np.zeros((len(group.short.n), vectors.shape[1])))
             for group in groups]  # fmt: skip
    static = []
    for own, B in zip(modes, forces, strict=True):
        size = len(own.long)
        static.append(own.under(B[:size], B[size:], shift))
    felt, turn = np.linalg.eigh(sum(own.on(B) for own, B in zip(static, forces, strict=True)))
    strong, kept = turn[:, felt > STRONG], turn[:, felt > FELT]
    inert = [own.under(*own.times(strong).inertia(), shift) for own in static]
    common = [own.times(kept).beside(others) for own, others in zip(static, inert, strict=True)]
    ends = np.cumsum([0, *(own.long.shape[1] for own in modes)])
    shared = ends[-1] + np.arange(common[0].long.shape[1])
    numbers = [np.append(np.arange(low, high), shared) for low, high in pairwise(ends)]
    return [own.beside(others) for own, others in zip(modes, common, strict=True)], numbers


def loosened(
    groups: Sequence[Group], coupling: Coupling, loose: LooseBolts, most: float
) -> list[tuple[float, dict[int, Array]]]:
    """Eigenvalues up to `most` with the amplitudes n -> (columns,), ascending, from groups of the tight casing."""
    forces = [loose.on(coupling, group.dofs) for group in groups]
    shapes, numbers = basis(groups, forces, REACH * most, SHIFT * most)
    size = 1 + int(max(own.max() for own in numbers))
    K, M, motions = np.zeros((size, size)), np.zeros((size, size)), np.zeros((len(loose.sign), size))
    for own, place, B in zip(shapes, numbers, forces, strict=True):
        K[np.ix_(place, place)] += own.K
        M[np.ix_(place, place)] += own.M
        motions[:, place] += own.on(B)
    K -= motions.T @ (loose.sign[:, None] * motions)
    scale = 1.0 / np.sqrt(np.diag(M))
    squares, turn = np.linalg.eigh(scale[:, None] * M * scale)
    kept = squares > DEPENDENT * squares[-1]
    apart = scale[:, None] * (turn[:, kept] / np.sqrt(squares[kept]))
    values, vectors = eigh(apart.T @ K @ apart, subset_by_value=(-np.inf, most))
    found = [own.times((apart @ vectors)[place]) for own, place in zip(shapes, numbers, strict=True)]
    waves = [own.group.waves(own.long, own.short) for own in found]
    return [(float(value), merged([group[k] for group in waves])) for k, value in enumerate(values)]
