"""Shell -> stiffness and mass matrices.

    a(U, V) = int E(U) : D : E(V) J,  m(U, V) = int [m0 u.v + m1 (u.y + v.w) + m2 w.y] J,  U = (u, w), V = (v, y)

E are the eight strains eps, chi, gamma (`mesh.kinematics`); the section stiffness D and the inertia m0, m1, m2 are
those of the wall (`wall`): for a flat wall D is t C on eps, t^3/12 C on chi and k G t on gamma; the inertia is rho t, 0
and rho t^3/12.

Element stiffness is a form on the jets of (u, w) at the quadrature points (`mesh.jet_form`). The mass uses the Lobatto
rule whose points are the nodes: M is a block for each node, and diagonal in dofs that `nodal_mass.diagonal_frames`
names. Element matrices are rotated to these dofs, and to the frames of edges that fix some. Fixed dofs are removed.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import qr
from scipy.sparse import block_diag, bsr_array, csc_array, diags_array, eye_array

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.linalg.pencil import diagonalised
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.mesh.edge_form import EdgeForm
from casingfem.structure.mesh.jet_form import JET, element_sum, jet_elements
from casingfem.structure.mesh.kinematics import DOFS, STRAINS, dot, frame, strain_slots
from casingfem.structure.mesh.shell_mesh import Grid, make_grid
from casingfem.structure.shell.edges import edge_forms
from casingfem.structure.shell.nodal_mass import diagonal_frames, nodal_mass
from casingfem.structure.shell.parts import ShellGeometry, ShellParts
from casingfem.structure.shell.prestress import Spin, Turning, spun
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System
from casingfem.structure.shell.wall import constitutive, curvature


def element_matrices(shell: Shell, grid: Grid) -> FloatArray:
    """Element stiffness matrices, (elements, 5 functions, 5 functions)."""
    return jet_elements(grid, wall_form(shell, shell.geometry(*grid.parameters, grid.middle), grid.measure))


def wall_form(shell: ShellParts, geometry: ShellGeometry, measure: FloatArray) -> Array:
    """Stiffness of the wall as a form on the jets of (u, w) at points (...): L^T D L J measure, (..., 15, 15)."""
    L, rates = strain_slots(geometry.surface)
    D = constitutive(shell, geometry, curvature(rates)) * (rates.basis.jacobian * measure)
    strains = np.ascontiguousarray(np.moveaxis(L, (1, 0, 2), (-3, -2, -1))).reshape(*L.shape[3:], STRAINS, JET)
    return np.asarray(strains.swapaxes(-1, -2) @ (np.moveaxis(D, (0, 1), (-2, -1)) @ strains))


def edge_rotation(shell: ShellParts, parameters: FloatArray, along: int) -> Array:
    """Frame of an edge at parameters (2, nodes): columns on the five dofs of a node, (nodes, 5, 5).

    Displacements across, along and normal to the edge; rotations of the normal across and along it.
    """
    surface = shell.geometry(*parameters).surface
    basis = frame(surface)
    tangent = surface.x2 if along == 1 else surface.x1
    tangent = tangent / np.sqrt(dot(tangent, tangent))
    across = np.cross(tangent, basis.normal, axis=0)
    turn = np.zeros((tangent.shape[1], DOFS, DOFS), dtype=tangent.dtype)
    turn[:, :3, :3] = np.stack([across, tangent, basis.normal], axis=-1).transpose(1, 0, 2)
    for i, e in enumerate((basis.e1, basis.e2)):
        turn[:, 3 + i, 3], turn[:, 3 + i, 4] = dot(e, across), dot(e, tangent)
    return turn


def held_frames(shell: ShellParts, grid: Grid) -> dict[str, Array]:
    """Frames (nodes, 5, 5) in which supports fix dofs of the nodes of their edges, by edge."""
    frames: dict[str, Array] = {}
    for name, support in shell.supports.items():
        edge = grid.edges[name]
        if support.held and support.frame == "edge":
            frames[name] = edge_rotation(shell, grid.nodes[:, edge.nodes], edge.along)
        elif support.held:
            frames[name] = np.tile(np.eye(DOFS), (len(edge.nodes), 1, 1))
    return frames


def admitted(shell: ShellParts, grid: Grid, fields: FloatArray) -> Array:
    """Nodal fields (nodes, 5, k) without directions A that the edges fix: P = I - A (A^T A)^-1 A^T.

    The function is analytic in the shell. A small change of the surface rotates the directions that a diaphragm fixes,
    and rotates the modes of the unchanged shell with them.
    """
    directions: dict[int, list[Array]] = {}
    changed = fields
    for name, turn in held_frames(shell, grid).items():
        on, A = grid.edges[name].nodes, turn[:, :, list(shell.supports[name].held)]
        changed = changed.astype(np.result_type(changed, A))
        changed[on] = fields[on] - A @ (A.swapaxes(1, 2) @ fields[on])  # A^T A = I on one edge
        for node, columns in zip(on.tolist(), A, strict=True):
            directions.setdefault(node, []).append(columns)
    for node, columns in directions.items():
        if len(columns) > 1:
            A = independent(np.hstack(columns))
            changed[node] = fields[node] - A @ np.linalg.solve(A.T @ A, A.T @ fields[node])
    return changed


def independent(directions: Array) -> Array:
    """The smallest number of columns (5, k) with the same span."""
    _, R, order = qr(np.real(directions), pivoting=True)
    return np.asarray(directions[:, order[: np.count_nonzero(np.abs(np.diag(R)) > 1e-6)]])


def held_dofs(shell: Shell, grid: Grid) -> tuple[IntArray, FloatArray]:
    """Free dof numbers, and the frames (nodes, 5, 5) in which the dofs of a node are expressed.

    A corner is fixed in every direction that one of its two edges fixes.
    """
    nodes = grid.nodes.shape[1]
    held = np.zeros((nodes, DOFS), dtype=bool)
    frames = np.tile(np.eye(DOFS), (nodes, 1, 1))
    directions: dict[int, list[FloatArray]] = {}
    for name, turn in held_frames(shell, grid).items():
        on, which = grid.edges[name].nodes, list(shell.supports[name].held)
        frames[on] = turn
        held[on[:, None], which] = True
        for node, columns in zip(on.tolist(), turn[:, :, which], strict=True):
            directions.setdefault(node, []).append(columns)
    for node, columns in directions.items():
        if len(columns) > 1:
            frames[node], held[node] = joint_frame(np.hstack(columns))
    return np.flatnonzero(~held.ravel()), frames


def on_free(forms: list[EdgeForm], frames: FloatArray, free: IntArray, own: int) -> csc_array:
    """Edge terms on the free dofs, in the nodal frames."""
    nodes = np.arange(len(frames) + 1)
    size = len(frames) * DOFS + own
    matrix = sum((form.matrix(size) for form in forms), start=csc_array((size, size)))
    if np.any(frames != np.eye(DOFS)):
        turn = block_diag([bsr_array((frames, nodes[:-1], nodes)), eye_array(own)], format="csc")
        matrix = turn.T @ matrix @ turn
    return csc_array(matrix[free][:, free])


def joint_frame(directions: FloatArray) -> tuple[FloatArray, Array]:
    """Frame (5, 5) whose first columns span the fixed directions (5, k) of several edges.

    Which of its columns are fixed, (5,).

    A column has either displacements or rotations.
    """
    turn, held = np.zeros((DOFS, DOFS)), np.zeros(DOFS, dtype=bool)
    for part in (slice(0, 3), slice(3, DOFS)):
        turn[part, part], values, _ = np.linalg.svd(directions[part])
        held[part][: np.count_nonzero(values > 1e-6)] = True
    return turn, held


def assemble(shell: Shell) -> System:
    """Assemble stiffness and lumped mass of a supported shell.

    A rotating shell has the stiffness at its speed, with centrifugal tension and spin softening (`prestress`).

    >>> from casingfem.structure.geometry.chart import Plate
    >>> from casingfem.structure.edge.support import Clamped
    >>> from casingfem.structure.material import Material
    >>> steel = Material(E=210e9, nu=0.3, rho=7800.0)
    >>> plate = Shell(chart=Plate(length=1.0, width=0.5), thickness=0.01, material=steel,
    ...               supports={"root": Clamped()})
    >>> system = assemble(plate)
    >>> bool(abs(system.K - system.K.T).max() < 1e-9 * abs(system.K).max())
    True
    """
    grid = make_grid(shell.chart, shell.mesh, shell.stations)
    free, frames = held_dofs(shell, grid)
    frames, diagonal = diagonal_frames(nodal_mass(shell, grid), frames, free)
    mass = diagonal.ravel()[free]
    forms = edge_forms(shell, grid)
    free = np.append(free, len(frames) * DOFS + np.arange(forms.own))
    K = element_sum(element_matrices(shell, grid), grid, frames, free, forms.stiffness)
    change = None
    if forms.mass:
        lumped = diags_array(np.append(mass, np.zeros(forms.own)))
        mass, change = diagonalised(csc_array(lumped + on_free(forms.mass, frames, free, forms.own)))
        K = K.changed(change)
    system = System(shell, grid, K, mass, free, frames, change, own=forms.own)
    if shell.rotation is None:
        return system
    return replace(system, stiffness=csc_array(system.K + spin(system, shell.rotation).stiffness(shell.rotation.omega)))


def spin(system: System, rotation: Rotation) -> Spin:
    """Terms that rotation at 1 rad/s adds to a shell assembled at rest."""
    return spun(turning(system, rotation))


def turning(system: System, rotation: Rotation) -> Turning:
    """Data for the rotation of a shell: its system at rest, and an axis."""
    return Turning(system=system, rotation=rotation, mass=nodal_mass(system.shell, system.grid))
