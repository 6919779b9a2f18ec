"""Springs, masses and rings on the edges of a shell, as quadratic forms over its dofs.

A ring has stiffness, mass and a support over the shell's dofs and one more dof at each node.
"""

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, IntArray
from casingfem.structure.edge.bolts import Bolts
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
from casingfem.structure.edge.support import outer_support
from casingfem.structure.mesh.edge_form import (
    EdgeForm,
    EdgeLine,
    LineFrame,
    PointSprings,
    Sprung,
    places_of,
    single_place,
    spring_form,
)
from casingfem.structure.mesh.kinematics import DOFS, dot, frame
from casingfem.structure.mesh.shell_mesh import Grid, edge_breaks, rim_values
from casingfem.structure.shell.parts import ShellParts

SPIN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])  # e_z x, d/dtheta of cylindrical unit vectors
PHASE = np.array([1.0, 1j, 1.0, 1.0, 1j, 1j])  # hoop motions and the turn about the normal are in quadrature


def outward(shell: ShellParts, name: str) -> int:
    """Direction in which an edge faces along its shell: -1 at a base, 1 at a top, 0 between."""
    return 0 if name in shell.stations else 1 if shell.chart.edges[name][1] else -1


def ties(shell: ShellParts, a: Array, b: Array, place: Array) -> tuple[Array, Array, Array]:
    """At an edge's nodes: motions at a (radial, axial) position from the edge (q, 6, 6), its points and radial axes."""
    surface = shell.geometry(a, b).surface
    basis = frame(surface)
    radial, _, axial = shell.chart.directions(a, b)
    arm = place[0] * radial + place[1] * axial
    return tie(basis.e1, basis.e2, basis.normal, arm), (surface.x + arm).T, radial.T


def node_dofs(grid: Grid, name: str, own: IntArray) -> IntArray:
    """Dofs of the nodes along an edge: five of the shell and the ring's own, (nodes, 6)."""
    return np.concatenate([grid.edges[name].nodes[:, None] * DOFS + np.arange(DOFS), own[:, None]], axis=1)


def ring_forms(shell: ShellParts, grid: Grid, name: str, ring: Ring, own: IntArray) -> tuple[EdgeForm, EdgeForm]:
    """Stiffness and mass of a ring; `own` numbers its rotations about the normal, one for each node."""
    edge = grid.edges[name]
    a, b = grid.nodes[:, edge.nodes]
    G, points, towards = ties(shell, a, b, ring.centre(outward(shell, name)))
    beam = make_beam(points, towards, edge.parts, grid.mesh.order, ring.section, ring.material or shell.material)
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


def bolt_stiffness(shell: ShellParts, name: str) -> Array:
    """Stiffness of one bolt of an edge on u_r, u_theta, u_z, w_1, w_2 (5, 5), with a ring also on its turn (6, 6)."""
    z, start = np.array([shell.line_at(name)]), np.zeros(1)
    line, support = single_place(line_frame(shell, 1, z, start)), shell.supports[name]
    bolts = outer_support(support)
    assert isinstance(bolts, Bolts)
    springs = bolts.single(line)
    if not isinstance(support, Ring):
        return np.asarray(spring_form(springs).D[0])
    foot, _, radial = ties(shell, z, start, support.support_point(outward(shell, name)))
    return np.asarray(foot[0].T @ support_stiffness(springs, radial)[0] @ foot[0])


def on_ring(line: EdgeLine, ring: Ring) -> EdgeLine:
    """The edge for the ring's support: as wide as the section."""
    return line._replace(nodal=line.nodal._replace(thickness=ring.section.width + 0.0 * line.nodal.thickness))


def support_stiffness(springs: PointSprings, radial: Array) -> Array:
    """Springs on (u, phi) at a foot, (q, 6, 6): rotational ones about the hoop and axial directions.

    A narrow face resists rotation about the radial axis only through its length, which u already includes.
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


class EdgeForms(NamedTuple):
    """Forms of stiffness and mass on the edges, and the number of their own dofs."""

    stiffness: list[EdgeForm]
    mass: list[EdgeForm]
    own: int


def edge_line(shell: ShellParts, grid: Grid, name: str) -> EdgeLine:
    """An edge of a shell in the form for its supports."""
    edge = grid.edges[name]
    nodes = edge.nodes[edge.parts]
    a, b = grid.nodes[:, nodes]
    inside = a.mean(axis=1, keepdims=True) if edge.along == 0 else a
    end = (a, b)[1 - edge.along].ravel()[:1]  # the parameter that is constant on the edge
    return EdgeLine(
        nodes=nodes.ravel(),
        weights=edge.shares.ravel(),
        nodal=line_frame(shell, edge.along, *(x.ravel() for x in np.broadcast_arrays(a, b, inside))),
        breaks=edge_breaks(grid, name),
        order=grid.mesh.order,
        closed=grid.periodic,
        frame=lambda x: line_frame(shell, edge.along, *((end + 0.0 * x, x) if edge.along == 1 else (x, end + 0.0 * x))),
        interpolate=lambda x: rim_values(grid, name, x),
    )


def line_frame(shell: ShellParts, along: int, a: Array, b: Array, inside: Array | None = None) -> LineFrame:
    """An edge along one parameter at (a, b); `inside` shows the side of a strip's end, as in `Shell.geometry`."""
    geometry = shell.geometry(a, b, inside)
    surface = geometry.surface
    tangent, second = (surface.x2, surface.x22) if along == 1 else (surface.x1, surface.x11)
    basis, square = frame(surface), dot(tangent, tangent)
    stretch, tangents = np.sqrt(square), np.stack([basis.e1, basis.e2], axis=1)
    bend = (shell.wall == "curved") * dot(basis.normal, second) / square
    return LineFrame(a, b, shell.chart.directions(a, b), geometry.thickness, stretch, tangents, bend)


def edge_forms(shell: ShellParts, grid: Grid) -> EdgeForms:
    """Stiffness and mass of everything on the edges, including fixed dofs."""
    own = own_dofs(shell, grid)
    rings = [ring_forms(shell, grid, name, ring, own[name]) for name, ring in shell.rings.items()]
    stiffness = [beam for beam, _ in rings] + holding_forms(shell, grid)
    mass = [inertia for _, inertia in rings] + mass_forms(shell, grid)
    return EdgeForms(stiffness, mass, own=sum(map(len, own.values())))


def holding_forms(shell: ShellParts, grid: Grid) -> list[EdgeForm]:
    """The springs that support the edges from outside, including those under rings."""
    own = own_dofs(shell, grid)
    forms = []
    for name, support in shell.supports.items():
        line = edge_line(shell, grid, name)
        if isinstance(support, Ring):
            if support.support is not None:
                forms.append(support_form(shell, grid, name, support, own[name], line))
        elif isinstance(support, Sprung):
            forms.append(spring_form(support.springs(line)))
    return forms


def mass_forms(shell: ShellParts, grid: Grid) -> list[EdgeForm]:
    """The masses on the edges: on the edge itself, or on the centre line of its ring."""
    own = own_dofs(shell, grid)
    forms = []
    for name, masses in shell.masses.items():
        support, nodes = shell.supports.get(name), grid.edges[name].nodes
        motions = np.tile(np.eye(3, DOFS), (len(nodes), 1, 1))
        dofs = nodes[:, None] * DOFS + np.arange(DOFS)
        if isinstance(support, Ring):
            a, b = grid.nodes[:, nodes]
            motions = ties(shell, a, b, support.centre(outward(shell, name)))[0][:, :3]
            dofs = node_dofs(grid, name, own[name])
        at, values = rim_values(grid, name, np.array([mass.angle for mass in masses]))
        at = places_of(nodes, at)
        B = np.einsum("qm,qmik->qimk", values, motions[at]).reshape(len(at), 3, -1)
        D = np.array([mass.mass for mass in masses])[:, None, None] * np.eye(3)
        forms.append(EdgeForm(dofs=dofs[at].reshape(len(at), -1), B=B, D=D))
    return forms


def own_dofs(shell: ShellParts, grid: Grid) -> dict[str, IntArray]:
    """Numbers of the rings' own dofs, one for each node of their lines, after those of all nodes."""
    first, own = grid.nodes.shape[1] * DOFS, {}
    for name in shell.rings:
        own[name] = first + np.arange(len(grid.edges[name].nodes))
        first += len(own[name])
    return own


def harmonic_forms(shell: ShellParts, name: str, n: int, z: Array) -> tuple[Array, Array]:
    """Stiffness and mass of one edge or station of a perfect casing, n diameters, per unit angle.

    On the dofs of the line's node at z (1,): (5, 5), or (6, 6) with a ring, the turn about the normal last.
    """
    line = single_place(line_frame(shell, 1, z, np.zeros(1)))
    if name in shell.rings:
        return harmonic_ring(shell, name, shell.rings[name], n, z, line)
    support = shell.supports[name]
    springs = spring_form(support.springs(line)).D[0] if isinstance(support, Sprung) else np.zeros((DOFS, DOFS))
    return springs, np.zeros((DOFS, DOFS))
