"""Rotation of a shell: stiffness K(Omega) = K + Omega^2 K1 + Omega^4 K2, and the gyroscopic matrix Omega G.

In the rotating frame, with strains quadratic in the displacements and the director a3 + w - |w|^2 a3/2 (it keeps its
length to second order), small motions v about the steady shape u0 = Omega^2 u1 have the stiffness

    K(Omega) = K + Omega^2 K1 + Omega^4 K2,   K1 = K_sigma + K_u - S,
    v K_sigma v = int [N_ij D_i v.D_j v + 2 M_ij D_i v.D_j w - M_ij (e_i.D_j a3) w.w + 2 Q_i D_i v.w] J
    v K_u v = 2 int E(v) : C : E2(u1, v) J
    v K2 v = int E2(u1, v) : C : E2(u1, v) J
    v S v = int [m0 |P v|^2 + 2 m1 P v.w + m2 ((a.a3)^2 |w|^2 - (a.w)^2) - m1 a3.P(x - c) |w|^2] J
    v' G v = 2 int [m0 v'.(a x v) + m1 (v'.(a x w) + w'.(a x v)) + m2 w'.(a x w)] J

N, M, Q: resultants of u1 = K^-1 f, f the centrifugal force m0 P(x - c) + m1 P a3 with its moment m1 P(x - c) + m2 P a3
on the normal at 1 rad/s, m0, m1, m2 the moments of the wall's mass (`wall.inertia`); E the linear strains of the shell,
E2 their bilinear part, the same form with E in place of N, M, Q; P the projection onto the plane of rotation, a the
axis. K_sigma is the stress stiffening, S the spin softening; K + Omega^2 K_u + Omega^4 K2 is the stiffness of the shape
x + u0: of the order of the strain for casings and radial blades, more where the centrifugal force bends or untwists. K1
is exact: it comes from one energy that rigid rotations leave unchanged, moments included, so that a rotating shell has
its exact rigid motions. Terms t^2/12 N of the squared curvatures are omitted, as in Naghdi's strains. At Omega^4 the
second-order stress of u0 is omitted; `Spin.nonlinear` measures it. Rings and masses on edges: `edge_spin`. (Membrane
part: Washizu, Variational Methods in Elasticity and Plasticity, 1982; softening and Coriolis terms: Genta, Dynamics of
Rotating Systems, 2005.)
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.sparse import block_diag, csc_array

from casingfem.errors import warn
from casingfem.io.arrays import Array, FloatArray
from casingfem.linalg.factor import solve_held
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.mesh.jet_form import JET, element_sum, jet_elements, nodal_forces, point_jets, scatter_blocks
from casingfem.structure.mesh.kinematics import DOFS, Rates, dot, frame, strain_slots
from casingfem.structure.mesh.shell_mesh import Grid
from casingfem.structure.shell.edge_spin import EdgeSpin, on_unknowns
from casingfem.structure.shell.nodal_mass import NodalMass
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System
from casingfem.structure.shell.wall import constitutive, curvature

Times = Callable[[FloatArray], tuple[FloatArray, FloatArray, FloatArray]]  # motions -> G, K1 and K2 times them
LINEAR = 0.3  # quadratic strains of the steady state above this part of the linear ones call for a warning


class Products(NamedTuple):
    """Effect of rotation on motions, and the lowest and highest speed [rad/s] of its validity; None: every speed."""

    times: Times
    speeds: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class Spin:
    """Terms that rotation at 1 rad/s adds to the matrices of a shell at rest, on its free dofs.

    Attributes
    ----------
    K1, K2
        Factors of omega^2 and omega^4, (free, free), symmetric [kg, kg s^2].
    G
        Gyroscopic matrix, (free, free), skew [kg]: times omega and the velocities.
    fields
        Static displacements at 1 rad/s, (nodes, dofs) [m s^2, s^2]: times omega^2.
    nonlinear
        Root of the energy of the static state's quadratic strains over that of its linear ones [s^2]: times omega^2.
    """

    K1: csc_array
    K2: csc_array
    G: csc_array
    fields: FloatArray
    nonlinear: float

    def stiffness(self, omega: float) -> csc_array:
        """omega^2 K1 + omega^4 K2.

        Warns (`rotation-large`) if linear statics no longer describe the steady state.
        """
        part = omega**2 * self.nonlinear
        if part > LINEAR:
            found = f"quadratic strains {part:.2g} times as large as the linear ones"
            warn("rotation-large", f"rotation: found {found}", stacklevel=4)
        return csc_array(omega**2 * self.K1 + omega**4 * self.K2)


@dataclass(frozen=True, eq=False, kw_only=True)
class Turning:
    """A shell at rest and an axis: its centrifugal load, and the terms of rotation from the static response.

    Attributes
    ----------
    system
        The supported shell at rest.
    rotation
        Axis; its speed is not used.
    mass
        Lobatto mass of every node (`nodal_mass`).
    """

    system: System
    rotation: Rotation
    mass: NodalMass

    @cached_property
    def nodes(self) -> tuple[FloatArray, FloatArray]:
        """Distances from the axis P(x - c) and normals at the nodes, (nodes, 3) each."""
        grid = self.system.grid
        surface = self.system.shell.geometry(*grid.nodes).surface
        away = (surface.x.T - np.asarray(self.rotation.centre)) @ self.rotation.plane
        return away, frame(surface).normal.T

    @cached_property
    def edges(self) -> EdgeSpin | None:
        """Rings and masses on the edges."""
        return EdgeSpin(system=self.system, rotation=self.rotation) if carries_more(self.system) else None

    @property
    def load(self) -> FloatArray:
        """Centrifugal forces and moments at 1 rad/s on the free dofs, (free,)."""
        force, own = centrifugal(self.rotation, self.mass, *self.nodes), np.zeros(self.system.own)
        if self.edges is not None:
            more = self.edges.force
            force, own = force + more[: force.size].reshape(force.shape), more[force.size :]
        return np.asarray(self.system.restrict(force[:, :, None], own[:, None])[:, 0])

    @property
    def blocks(self) -> tuple[FloatArray, FloatArray]:
        """Blocks of S and of G at the nodes, (nodes, 5, 5)."""
        return softening(self.rotation, self.mass, *self.nodes), gyroscopic(self.rotation, self.mass)

    def spin(self, u: FloatArray) -> Spin:
        """K1, K2, G and the static state, from the static response u (free,) to the load."""
        system, fields = self.system, self.system.expand(u[:, None])
        at_points, nonlinear = point_stiffness(system.shell, system.grid, fields)
        first, second = (self.added_up(jet_elements(system.grid, H)) for H in at_points)
        soft, G = (self.scattered(blocks) for blocks in self.blocks)
        if self.edges is not None:
            moved = self.edges.moved(fields[:, :, 0], system.expand_own(u[:, None])[:, 0])
            ready = [self.edges.on_unknowns(forms) for forms in (*moved, *self.edges.inertia)]
            first, second, soft, G = (a + b for a, b in zip((first, second, soft, G), ready, strict=True))
        return Spin(
            K1=csc_array(first - soft), K2=csc_array(second), G=csc_array(G), fields=fields[:, :, 0],
            nonlinear=nonlinear,
        )  # fmt: skip

    def added_up(self, matrices: FloatArray) -> csc_array:
        """Matrices of the elements, summed on the free dofs."""
        total = element_sum(matrices, self.system.grid, self.system.frames, self.system.free)
        return (total if self.system.change is None else total.changed(self.system.change)).tocsc()

    def scattered(self, blocks: FloatArray) -> csc_array:
        """Blocks of the nodes (nodes, 5, 5) on the free dofs."""
        if self.edges is None:
            return scatter_blocks(blocks, self.system.frames, self.system.free)
        return on_unknowns(self.system, block_diag([*blocks, csc_array((self.system.own,) * 2)], format="csc"))

    def products(self, u: FloatArray) -> Products:
        """G, K1 and K2 times motions (free, k), from the static response u (free,) to the load.

        Without rings and masses no matrix is assembled.
        """
        if self.edges is not None:
            return products_of(self.spin(u))
        system, (soft, G) = self.system, self.blocks
        (first, second), _ = point_stiffness(system.shell, system.grid, system.expand(u[:, None]))

        def times(vectors: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
            fields = system.expand(vectors)
            jets = point_jets(system.grid, fields)
            stiff, more = (nodal_forces(system.grid, form @ jets) for form in (first, second))
            coriolis, stiffening, further = (
                np.asarray(system.restrict(part)) for part in (G @ fields, stiff - soft @ fields, more)
            )
            return coriolis, stiffening, further

        return Products(times)


def products_of(spin: Spin, speeds: tuple[float, ...] = ()) -> Products:
    """G, K1 and K2 times motions (free, k), known between two `speeds` [rad/s] or at every speed."""
    return Products(lambda vectors: (spin.G @ vectors, spin.K1 @ vectors, spin.K2 @ vectors), speeds)


def carries_more(system: System) -> bool:
    """Whether there are rings or masses on the edges."""
    return bool(system.own) or system.change is not None


def spun(turning: Turning) -> Spin:
    """K1, K2, G and the static state of a shell that rotates about an axis.

    Raises
    ------
    ModelError
        `static-loose` if the centrifugal force drives a rigid motion that is not restrained.
    """
    return turning.spin(solve_held(turning.system.stiffness, turning.load))


def centrifugal(rotation: Rotation, mass: NodalMass, away: FloatArray, n: FloatArray) -> FloatArray:
    """Nodal forces and moments at 1 rad/s, (nodes, 5); `away` is P(x - c) and n the normals, (nodes, 3) each."""
    m0, m1, m2 = (moment[:, None] for moment in mass.moments.T)
    out = n @ rotation.plane
    moment = np.einsum("nik,ni->nk", mass.tangents, m1 * away + m2 * out)
    return np.concatenate([m0 * away + m1 * out, moment], axis=1)


def softening(rotation: Rotation, mass: NodalMass, away: FloatArray, n: FloatArray) -> FloatArray:
    """Blocks of S at the nodes, (nodes, 5, 5)."""
    a, P, tangents = rotation.direction, rotation.plane, mass.tangents
    m0, m1, m2 = (moment[:, None, None] for moment in mass.moments.T)
    along = np.einsum("nik,i->nk", tangents, a)
    blocks = np.zeros((len(n), DOFS, DOFS))
    blocks[:, :3, :3] = m0 * P
    blocks[:, :3, 3:] = m1 * np.matmul(P, tangents)
    blocks[:, 3:, :3] = blocks[:, :3, 3:].swapaxes(1, 2)
    lean = ((n @ a) ** 2)[:, None, None] * np.eye(2) - along[:, :, None] * along[:, None, :]
    blocks[:, 3:, 3:] = m2 * lean - m1 * np.einsum("ni,ni->n", n, away)[:, None, None] * np.eye(2)
    return blocks


def gyroscopic(rotation: Rotation, mass: NodalMass) -> FloatArray:
    """Blocks of G at the nodes, (nodes, 5, 5)."""
    turn = np.cross(rotation.direction, np.eye(3)).T  # turn v = a x v
    m0, m1, m2 = (moment[:, None, None] for moment in mass.moments.T)
    across = np.matmul(turn, mass.tangents)
    blocks = np.zeros((len(mass.moments), DOFS, DOFS))
    blocks[:, :3, :3] = 2.0 * m0 * turn
    blocks[:, :3, 3:] = 2.0 * m1 * across
    blocks[:, 3:, :3] = -blocks[:, :3, 3:].swapaxes(1, 2)
    blocks[:, 3:, 3:] = 2.0 * m2 * np.matmul(mass.tangents.swapaxes(1, 2), across)
    return blocks


def gradients(rates: Rates) -> Array:
    """D_1 u, D_2 u, D_1 w, D_2 w and w as vectors, by the jets: (5 vectors, 3 components, 3 slots, 5 dofs, ...)."""
    basis, D, normal, turn = rates
    e, n = (basis.e1, basis.e2), basis.normal
    g = np.zeros((5, 3, 3, DOFS, *turn.shape[1:]))
    for i in range(2):
        for alpha in range(2):
            g[i, range(3), 1 + alpha, range(3)] = D[i, alpha]
            for k in range(2):
                g[2 + i, :, 1 + alpha, 3 + k] = D[i, alpha] * e[k]
        # D_i e1 = -turn_i e2 - (e1.D_i a3) a3,  D_i e2 = turn_i e1 - (e2.D_i a3) a3
        g[2 + i, :, 0, 3] = -turn[i] * e[1] - dot(e[0], normal[i]) * n
        g[2 + i, :, 0, 4] = turn[i] * e[0] - dot(e[1], normal[i]) * n
        g[4, :, 0, 3 + i] = e[i]
    return g


def quadratic_strains(rates: Rates) -> Array:
    """Bilinear parts of the eight strains on (D_1 u, D_2 u, D_1 w, D_2 w, w): (8, 5, 5, ...), symmetric.

    E_k(v, v) = sum S[k, p, q] g_p(v).g_q(v)/2.
    """
    e = (rates.basis.e1, rates.basis.e2)
    bend = np.array([[dot(e[i], rates.normal[j]) for j in range(2)] for i in range(2)])  # e_i . D_j a3
    S = np.zeros((8, 5, 5, *rates.turn.shape[1:]))
    pairs = ((0, 0), (1, 1), (0, 1))
    for k, (i, j) in enumerate(pairs):
        twice = 1.0 if i == j else 2.0
        for p, q in {(i, j), (j, i)}:
            S[k, p, q] = 1.0
            S[3 + k, p, 2 + q] = S[3 + k, 2 + q, p] = 1.0
        S[3 + k, 4, 4] = -0.5 * twice * (bend[i, j] + bend[j, i])
    for i in range(2):
        S[6 + i, i, 4] = S[6 + i, 4, i] = 1.0
    return S


def point_stiffness(shell: Shell, grid: Grid, fields: FloatArray) -> tuple[tuple[Array, Array], float]:
    """K_sigma + K_u and K2 at the quadrature points on the jets, (elements, points, 15, 15), weighted.

    And the root of the energy of the quadratic strains of `fields` (nodes, 5, 1) over that of the linear ones.
    """
    geometry = shell.geometry(*grid.parameters, grid.middle)
    L, rates = strain_slots(geometry.surface)
    L = np.moveaxis(L, 0, 1).reshape(len(L[0]), JET, *L.shape[3:])
    D = constitutive(shell, geometry, curvature(rates)) * (rates.basis.jacobian * grid.measure)
    jets = np.moveaxis(point_jets(grid, fields)[..., 0], -1, 0)
    g = gradients(rates).reshape(5, 3, JET, *rates.turn.shape[1:])
    S = quadratic_strains(rates)
    strain = np.einsum("tjeq,jeq->teq", L, jets)
    stress = np.einsum("steq,teq->seq", D, strain)
    H = np.einsum("pcieq,kpreq,keq,rcjeq->eqij", g, S, stress, g, optimize=True)
    moved = np.einsum("rcjeq,jeq->rceq", g, jets)
    second = np.einsum("pcieq,kpreq,rceq->kieq", g, S, moved, optimize=True)  # E2(u1, v) = second v
    pulled = np.einsum("kteq,tjeq->kjeq", D, second)
    cross = np.einsum("kieq,kjeq->eqij", L, pulled)
    bowed = 0.5 * np.einsum("kieq,ieq->keq", second, jets)
    energies = [np.einsum("keq,kteq,teq->", part, D, part, optimize=True) for part in (bowed, strain)]
    stiff = H + cross + cross.swapaxes(2, 3), np.einsum("kieq,kjeq->eqij", second, pulled)
    return stiff, float(np.sqrt(energies[0] / energies[1])) if energies[1] > 0.0 else 0.0
