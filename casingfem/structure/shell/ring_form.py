"""The forms of a ring on an edge: its stiffness, its mass, its support, over the shell's dofs and one more a node."""

import numpy as np

from casingfem.io.arrays import Array, IntArray
from casingfem.structure.edge.curved_beam import (
    MOTIONS,
    beam_strain,
    make_beam,
    section_axes,
    section_inertia,
    section_stiffness,
    tie,
)
from casingfem.structure.edge.ring import Ring
from casingfem.structure.mesh.edge_form import EdgeForm, EdgeLine, PointSprings, Sprung, places_of
from casingfem.structure.mesh.kinematics import DOFS, frame
from casingfem.structure.mesh.shell_mesh import Grid
from casingfem.structure.shell.parts import ShellParts

SPIN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])  # e_z x, d/dtheta of cylindrical unit vectors
PHASE = np.array([1.0, 1j, 1.0, 1.0, 1j, 1j])  # hoop motions and the turn about the normal are in quadrature


def outward(shell: ShellParts, name: str) -> int:
    """Which way an edge looks along its shell: -1 at a base, 1 at a top, 0 between."""
    return 0 if name in shell.stations else 1 if shell.chart.edges[name][1] else -1


def ties(shell: ShellParts, a: Array, b: Array, place: Array) -> tuple[Array, Array, Array]:
    """At an edge's nodes: motions at a (radial, axial) place from the edge (q, 6, 6), its points and radial axes."""
    surface = shell.geometry(a, b).surface
    basis = frame(surface)
    radial, _, axial = shell.chart.directions(a, b)
    arm = place[0] * radial + place[1] * axial
    return tie(basis.e1, basis.e2, basis.normal, arm), (surface.x + arm).T, radial.T


def node_dofs(grid: Grid, name: str, own: IntArray) -> IntArray:
    """Dofs of the nodes along an edge: five of the shell and the ring's own, (nodes, 6)."""
    nodes = grid.edges[name].nodes
    return np.concatenate([nodes[:, None] * DOFS + np.arange(DOFS), own[:, None]], axis=1)


def ring_forms(shell: ShellParts, grid: Grid, name: str, ring: Ring, own: IntArray) -> tuple[EdgeForm, EdgeForm]:
    """Stiffness and mass of a ring; `own` numbers its turns about the normal, one a node."""
    edge = grid.edges[name]
    a, b = grid.nodes[:, edge.nodes]
    G, points, towards = ties(shell, a, b, ring.centre(outward(shell, name)))
    material = ring.material or shell.material
    beam = make_beam(points, towards, edge.parts, grid.mesh.order, ring.section, material)
    dofs = node_dofs(grid, name, own)
    elements, gauss_points, rows, functions, _ = beam.strain.shape
    strain = np.einsum("egimk,emkl->egiml", beam.strain, G[edge.parts])
    at_points = np.repeat(dofs[edge.parts].reshape(elements, -1), gauss_points, axis=0)
    stiffness = EdgeForm(at_points, strain.reshape(-1, rows, functions * MOTIONS), beam.D.reshape(-1, rows, rows))
    places = edge.parts.ravel()
    return stiffness, EdgeForm(dofs=dofs[places], B=G[places], D=beam.inertia.reshape(-1, MOTIONS, MOTIONS))


def support_form(shell: ShellParts, grid: Grid, name: str, ring: Ring, own: IntArray, line: EdgeLine) -> EdgeForm:
    """The springs of a ring's own support, at its foot."""
    assert isinstance(ring.support, Sprung)
    springs = ring.support.springs(on_ring(line, ring))
    nodes = grid.edges[name].nodes
    a, b = grid.nodes[:, nodes]
    G, _, radial = ties(shell, a, b, ring.support_point(outward(shell, name)))
    at = places_of(nodes, springs.nodes)
    B = np.einsum("qm,qmik->qimk", springs.values, G[at]).reshape(len(at), MOTIONS, -1)
    dofs = node_dofs(grid, name, own)[at].reshape(len(at), -1)
    return EdgeForm(dofs=dofs, B=B, D=support_stiffness(springs, np.einsum("qm,qmi->qi", springs.values, radial[at])))


def on_ring(line: EdgeLine, ring: Ring) -> EdgeLine:
    """The edge as the ring's support sees it: as wide as the section."""
    wide = ring.section.width + 0.0 * line.nodal.thickness
    return line._replace(nodal=line.nodal._replace(thickness=wide))


def support_stiffness(springs: PointSprings, radial: Array) -> Array:
    """Springs on (u, phi) at a foot, (q, 6, 6): rotational ones about the hoop and axial directions.

    A line of face does not oppose a turn about the radial axis except by its length, which u already feels.
    """
    D = np.zeros((len(radial), MOTIONS, MOTIONS), dtype=np.result_type(springs.blocks, springs.rotation))
    D[:, :3, :3] = springs.blocks
    D[:, 3:, 3:] = springs.rotation[:, None, None] * (np.eye(3) - radial[:, :, None] * radial[:, None, :])
    return D


def harmonic_ring(shell: ShellParts, name: str, ring: Ring, n: int, z: Array, line: EdgeLine) -> tuple[Array, Array]:
    """Stiffness and mass (6, 6) of n nodal diameters of a ring on a perfect casing, per unit angle, at z (1,).

    At theta = 0 d/ds = (i n + e_z x)/R of motions e^(i n theta); phases as in `structure.axisymmetric` make it real.
    """
    G, points, towards = ties(shell, z, np.zeros(1), ring.centre(outward(shell, name)))
    radius, axes = section_axes(np.matmul(SPIN, points[0]), towards[0])
    derivative = np.kron(np.eye(2), 1j * n * np.eye(3) + SPIN) / radius
    strain = beam_strain(axes.astype(complex), np.ones(1), np.zeros(1))[:, 0, :]  # what does not differentiate
    strain = strain + np.kron(np.eye(2), axes) @ derivative
    material = ring.material or shell.material
    motions = G[0] * PHASE
    K = radius * (strain @ motions).conj().T @ section_stiffness(ring.section, material) @ strain @ motions
    M = radius * motions.conj().T @ section_inertia(ring.section, material, axes) @ motions
    if ring.support is not None:
        springs = ring.support.springs(on_ring(line, ring))
        foot = ties(shell, z, np.zeros(1), ring.support_point(outward(shell, name)))[0][0] * PHASE
        K = K + foot.conj().T @ support_stiffness(springs, towards)[0] @ foot
    return K.real, M.real
