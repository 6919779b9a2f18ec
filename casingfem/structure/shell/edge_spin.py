"""Terms that rotation adds to a shell through rings and point masses on its edges.

A ring is a geometrically exact beam (Simo & Vu-Quoc, Comput. Methods Appl. Mech. Eng. 58, 1986, 79) on rigid arms. With
centre line x, tangent t, displacement u and rotation vector phi its strains to second order are

    Gamma = u' - phi x t - phi x u' + phi x (phi x t)/2,   kappa = phi' - phi x phi'/2,

and a point of its section or the end of an arm r is displaced by u + phi x r + phi x (phi x r)/2. The shell's node has
the tangential motion w of its director and the rotation o about its normal: phi = n x w + o n + o w/2 to second order,
which changes the normal exactly by w. As for the shell (`prestress`), with the static response u1 to the centrifugal
forces

    v K_sigma v = int (n, m).Q(v, v) - f.Y(v, v),   v K_u v = 2 int E(v).D.Q(u1, v),   v K2 v = int Q(u1, v).D.Q(u1, v),

with the forces n and moments m of u1 in the beam, its section stiffness D, the quadratic strains Q/2 and motions Y/2,
and the difference f of centrifugal and inner forces at the nodes of the centre line. Masses add softening and Coriolis
forces, those of sections by their second moments. Springs under a ring are linear.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.sparse import block_diag, bsr_array, csc_array, eye_array

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.structure.edge.curved_beam import make_beam, section_axes, section_inertia
from casingfem.structure.edge.ring import Ring
from casingfem.structure.geometry.rotation import Rotation, skew
from casingfem.structure.mesh.edge_form import EdgeForm
from casingfem.structure.mesh.element import gauss, lagrange, lobatto
from casingfem.structure.mesh.kinematics import DOFS, frame
from casingfem.structure.mesh.shell_mesh import rim_values
from casingfem.structure.shell.edges import mass_forms, node_dofs, outward, own_dofs, ties
from casingfem.structure.shell.system import System


class Moved(NamedTuple):
    """Stiffness that a static state adds, to first and to second order, as forms on all dofs."""

    first: list[EdgeForm]
    second: list[EdgeForm]


@dataclass(frozen=True, eq=False, kw_only=True)
class EdgeSpin:
    """Rings and masses on the edges of a shell, and an axis."""

    system: System
    rotation: Rotation

    @cached_property
    def rings(self) -> "list[TurningRing]":
        """The rings of the shell."""
        own, shell = own_dofs(self.system.shell, self.system.grid), self.system.shell
        return [TurningRing(self.system, self.rotation, name, ring, own[name]) for name, ring in shell.rings.items()]

    @cached_property
    def masses(self) -> list[EdgeForm]:
        """The masses, as forms on the displacements at their positions."""
        return mass_forms(self.system.shell, self.system.grid)

    @property
    def inertia(self) -> tuple[list[EdgeForm], list[EdgeForm]]:
        """Spin softening and Coriolis forces at 1 rad/s."""
        P, turn = self.rotation.plane, np.cross(self.rotation.direction, np.eye(3)).T
        soft = [form._replace(D=form.D @ P) for form in self.masses]
        coriolis = [form._replace(D=2.0 * form.D @ turn) for form in self.masses]
        for ring in self.rings:
            soft.append(ring.form(ring.softening))
            coriolis.append(ring.form(ring.coriolis))
        return soft, coriolis

    @property
    def force(self) -> FloatArray:
        """Centrifugal force at 1 rad/s on all dofs, those of nodes in Cartesian axes."""
        nodes, own = len(self.system.frames), self.system.own
        total = np.zeros(nodes * DOFS + own)
        for name, form in zip(self.system.shell.masses, self.masses, strict=True):
            pull = np.einsum("qij,qj->qi", form.D, self.away(name))
            np.add.at(total, form.dofs, np.einsum("qil,qi->ql", form.B, pull))
        for ring in self.rings:
            np.add.at(total, ring.dofs, np.einsum("nik,ni->nk", ring.arms, ring.load))
        return total

    def away(self, name: str) -> FloatArray:
        """Distances of an edge's masses from the axis, (masses, 3)."""
        shell, grid = self.system.shell, self.system.grid
        angles = np.array([mass.angle for mass in shell.masses[name]])
        nodes, values = rim_values(grid, name, angles)
        a, b = grid.nodes
        ring = shell.supports.get(name)
        place = ring.centre(outward(shell, name)) if isinstance(ring, Ring) else np.zeros(2)
        points = ties(shell, a, b, place)[1]
        at = np.einsum("qm,qmi->qi", values, points[nodes])
        return np.asarray((at - np.asarray(self.rotation.centre)) @ self.rotation.plane)

    def moved(self, fields: FloatArray, own: FloatArray) -> Moved:
        """Terms due to static motions of the nodes (nodes, 5) and of the rings' own dofs (own,)."""
        motions, found = np.concatenate([fields.ravel(), own]), Moved([], [])
        for ring in self.rings:
            held = [
                (form, self.away(name))
                for name, form in zip(self.system.shell.masses, self.masses, strict=True)
                if name == ring.name
            ]
            for forms, part in zip(found, ring.moved(motions, held), strict=True):
                forms.extend(part)
        return found

    def on_unknowns(self, forms: list[EdgeForm]) -> csc_array:
        """Forms on the unknowns of the system."""
        size = len(self.system.frames) * DOFS + self.system.own
        return on_unknowns(self.system, sum((form.matrix(size) for form in forms), start=csc_array((size, size))))


def on_unknowns(system: System, A: csc_array) -> csc_array:
    """A matrix on all dofs, those of nodes in Cartesian axes, on the unknowns of the system."""
    nodes = np.arange(len(system.frames) + 1)
    turn = block_diag([bsr_array((system.frames, nodes[:-1], nodes)), eye_array(system.own)], format="csc")
    found = csc_array(turn.T @ A @ turn)[system.free][:, system.free]
    return csc_array(found if system.change is None else system.change.T @ found @ system.change)


class TurningRing:
    """One ring with its nodes, its beam, and its terms of rotation; motions of a node are (u, w_1, w_2, o)."""

    def __init__(self, system: System, rotation: Rotation, name: str, ring: Ring, own: IntArray) -> None:
        shell, grid = system.shell, system.grid
        edge = grid.edges[name]
        a, b = grid.nodes[:, edge.nodes]
        self.name, self.rotation, self.cells = name, rotation, edge.parts
        self.dofs = node_dofs(grid, name, own)
        basis, material = frame(shell.geometry(a, b).surface), ring.material or shell.material
        self.e = np.stack([basis.e1, basis.e2], axis=-1).transpose(1, 0, 2)  # (nodes, 3, 2)
        self.arms, points, towards = ties(shell, a, b, ring.centre(outward(shell, name)))
        self.r = points - np.asarray(shell.geometry(a, b).surface.x.T)
        self.turn = self.arms[:, 3:, 3:]  # phi of (w_1, w_2, o)
        self.away = (points - np.asarray(rotation.centre)) @ rotation.plane
        order = grid.mesh.order
        self.beam = make_beam(points, towards, self.cells, order, ring.section, material)
        x, _ = gauss(order + 1)
        self.value, slope = (table.T for table in lagrange(order, x))
        length, self.axes = section_axes(slope @ points[self.cells], self.value @ towards[self.cells])
        self.slope = slope / length[..., None]
        at, share = lobatto(order)
        length, axes = section_axes(lagrange(order, at)[1].T @ points[self.cells], towards[self.cells])
        inertia = section_inertia(ring.section, material, axes) * (length * share)[..., None, None]
        blocks = np.zeros((len(points), 6, 6))
        np.add.at(blocks, self.cells, inertia)
        self.mass, J = blocks[:, 0, 0], blocks[:, 3:, 3:]
        self.moments = 0.5 * np.trace(J, axis1=1, axis2=2)[:, None, None] * np.eye(3) - J  # int r r^T dm

    def sections(self) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Points of the sections in pairs at +- r: mass of a pair (nodes,) [1 for r of its second moment], and r."""
        values, axes = np.linalg.eigh(self.moments)
        for k in range(3):
            yield np.maximum(values[:, k], 0.0), axes[:, :, k]

    def form(self, blocks: FloatArray) -> EdgeForm:
        """Blocks (nodes, 6, 6) on the motions of the centre line."""
        return EdgeForm(dofs=self.dofs, B=self.arms, D=blocks)

    def by_mass(self, between: FloatArray) -> FloatArray:
        """Blocks (nodes, 6, 6) of sum m (A v)^T `between` (A v), A v = u + phi x r of the points of the sections."""
        blocks = np.zeros((len(self.mass), 6, 6))
        blocks[:, :3, :3] = self.mass[:, None, None] * between
        for weight, r in self.sections():
            A = -skew(r)
            blocks[:, 3:, 3:] += weight[:, None, None] * (A.swapaxes(1, 2) @ between @ A)
        return blocks

    @property
    def softening(self) -> FloatArray:
        """Spin softening at 1 rad/s, (nodes, 6, 6)."""
        return self.by_mass(self.rotation.plane)

    @property
    def coriolis(self) -> FloatArray:
        """Coriolis forces at 1 rad/s, (nodes, 6, 6)."""
        return self.by_mass(2.0 * np.cross(self.rotation.direction, np.eye(3)).T)

    @property
    def load(self) -> FloatArray:
        """Centrifugal forces and moments at 1 rad/s on the centre line, (nodes, 6)."""
        moment = sum(weight[:, None] * np.cross(r, r @ self.rotation.plane) for weight, r in self.sections())
        return np.hstack([self.mass[:, None] * self.away, np.asarray(moment)])

    def moved(self, motions: FloatArray, held: list[tuple[EdgeForm, FloatArray]]) -> Moved:
        """Terms due to static motions of all dofs; `held` are masses on the centre line and their distances."""
        cells, beam, z = self.cells, self.beam, motions[self.dofs]
        y = np.einsum("nij,nj->ni", self.arms, z)
        local = y[cells]
        strain = np.einsum("egimk,emk->egi", beam.strain, local)
        stress = np.einsum("egij,egj->egi", beam.D, strain)
        phi = np.einsum("gm,emk->egk", self.value, local[..., 3:])
        du, dphi = (np.einsum("egm,emk->egk", self.slope, part) for part in (local[..., :3], local[..., 3:]))
        n, m = (np.einsum("egji,egj->egi", self.axes, part) for part in (stress[..., :3], stress[..., 3:]))
        H = self.by_stress(n, m)
        rows = self.gradients()
        at_points = self.dofs[cells].reshape(len(cells), 1, -1).repeat(len(self.value), 1)
        arms = self.arms[cells]
        B = np.einsum("egimk,emkl->egiml", rows, arms)
        bilinear = np.einsum("egij,egjml->egiml", self.quadratic(phi, du, dphi), B)
        bilinear += np.einsum("egimk,emkl->egiml", beam.strain, self.second(z)[cells])
        linear = np.einsum("egimk,emkl->egiml", beam.strain, arms)
        flat = at_points.reshape(-1, at_points.shape[2])
        L, Q, B = (part.reshape(len(flat), part.shape[2], -1) for part in (linear, bilinear, B))
        D = beam.D.reshape(len(flat), 6, 6)
        both, cross = np.concatenate([L, Q], axis=1), np.zeros((len(flat), 12, 12))
        cross[:, :6, 6:] = cross[:, 6:, :6] = D
        force = self.load.copy()
        np.subtract.at(force, cells, np.einsum("egimk,egi->emk", beam.strain, stress))
        for mass, away in held:
            self.add_pull(force, mass, away)
        at_nodes = EdgeForm(self.dofs, np.tile(np.eye(6), (len(z), 1, 1)), self.by_force(force))
        first = [EdgeForm(flat, B, H.reshape(len(flat), 9, 9)), EdgeForm(flat, both, cross), at_nodes]
        return Moved(first, [EdgeForm(flat, Q, D)])

    def add_pull(self, force: FloatArray, mass: EdgeForm, away: FloatArray) -> None:
        """Add the centrifugal force of masses to those of the nodes of the centre line."""
        nodes = mass.dofs[:, :: self.dofs.shape[1]]  # the first dof of each node
        at = np.searchsorted(np.sort(self.dofs[:, 0]), nodes)
        at = np.argsort(self.dofs[:, 0])[at]
        values = mass.B[:, 0, :: self.dofs.shape[1]]  # u_x of the centre line by u_x of the nodes
        pull = np.einsum("qij,qj->qi", mass.D, away)
        np.add.at(force[:, :3], at, values[:, :, None] * pull[:, None, :])

    def gradients(self) -> Array:
        """(phi, u', phi') at the points by the motions of the nodes, (elements, points, 9, functions, 6)."""
        rows = np.zeros((*self.slope.shape[:2], 9, self.slope.shape[2], 6))
        for k in range(3):
            rows[:, :, k, :, 3 + k] = self.value
            rows[:, :, 3 + k, :, k] = rows[:, :, 6 + k, :, 3 + k] = self.slope
        return rows

    def by_stress(self, n: Array, m: Array) -> Array:
        """Blocks of (n, m).Q(v, v) on (phi, u', phi'), (elements, points, 9, 9)."""
        t, H = self.axes[..., 0, :], np.zeros((*n.shape[:2], 9, 9))
        both = n[..., :, None] * t[..., None, :]
        along = np.einsum("...i,...i->...", n, t)[..., None, None]
        H[..., :3, :3] = 0.5 * (both + both.swapaxes(-1, -2)) - along * np.eye(3)
        H[..., :3, 3:6], H[..., :3, 6:] = skew(n), 0.5 * skew(m)
        H[..., 3:6, :3], H[..., 6:, :3] = skew(n).swapaxes(-1, -2), 0.5 * skew(m).swapaxes(-1, -2)
        return H

    def quadratic(self, phi: Array, du: Array, dphi: Array) -> Array:
        """Q(u1, v) by (phi, u', phi') of v, of those of u1, in the section's axes, (elements, points, 6, 9)."""
        t, Q = self.axes[..., 0, :], np.zeros((*phi.shape[:2], 6, 9))
        turned = skew(phi) @ skew(t) + skew(np.cross(phi, t))
        Q[..., :3, :3] = self.axes @ (skew(du) - 0.5 * turned)
        Q[..., :3, 3:6] = -self.axes @ skew(phi)
        Q[..., 3:, :3] = 0.5 * self.axes @ skew(dphi)
        Q[..., 3:, 6:] = -0.5 * self.axes @ skew(phi)
        return Q

    def second(self, z: FloatArray) -> Array:
        """Y(u1, v) by the motions v of a node, of those of u1, (nodes, 6, 6)."""
        found, turn, r = np.zeros((len(z), 6, 6)), self.turn, skew(self.r)
        phi = np.einsum("nij,nj->ni", turn, z[:, 3:])
        w = np.einsum("nij,nj->ni", self.e, z[:, 3:5])
        found[:, 3:, 3:5] = 0.5 * z[:, 5, None, None] * self.e
        found[:, 3:, 5] = 0.5 * w
        turned = skew(phi) @ r + skew(np.cross(phi, self.r))
        found[:, :3, 3:] = -0.5 * turned @ turn - r @ found[:, 3:, 3:]
        return found

    def by_force(self, force: FloatArray) -> FloatArray:
        """Blocks of -f.Y(v, v) on the motions of the nodes, and terms of the section points, (nodes, 6, 6)."""
        push, moment = force[:, :3], force[:, 3:] + np.cross(self.r, force[:, :3])
        stiff = arm_blocks(push, self.r)
        for weight, r in self.sections():
            stiff += weight[:, None, None] * arm_blocks(r @ self.rotation.plane, r)
        blocks = np.zeros((len(push), 6, 6))
        blocks[:, 3:, 3:] = self.turn.swapaxes(1, 2) @ stiff @ self.turn
        bent = 0.5 * np.einsum("nik,ni->nk", self.e, moment)
        blocks[:, 3:5, 5] -= bent
        blocks[:, 5, 3:5] -= bent
        return blocks


def arm_blocks(force: FloatArray, r: FloatArray) -> FloatArray:
    """(F.r) 1 - (F r^T + r F^T)/2 of forces on arms, (nodes, 3, 3): -F.phi x (phi x r) = phi S phi."""
    both = force[:, :, None] * r[:, None, :]
    return np.asarray(np.einsum("ni,ni->n", force, r)[:, None, None] * np.eye(3) - 0.5 * (both + both.swapaxes(1, 2)))
