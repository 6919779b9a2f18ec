"""What a shell carries on its edges, as quadratic forms over its dofs."""

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import Array, IntArray
from casingfem.structure.edge.ring import Ring
from casingfem.structure.mesh.edge_form import (
    EdgeForm,
    EdgeLine,
    LineFrame,
    Sprung,
    places_of,
    single_place,
    spring_form,
)
from casingfem.structure.mesh.kinematics import DOFS, dot, frame
from casingfem.structure.mesh.shell_mesh import Grid, edge_breaks, rim_values
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.ring_form import harmonic_ring, node_dofs, outward, ring_forms, support_form, ties


class EdgeForms(NamedTuple):
    """What stands on the edges: forms of stiffness and mass, and how many dofs of its own it brings."""

    stiffness: list[EdgeForm]
    mass: list[EdgeForm]
    own: int


def edge_line(shell: ShellParts, grid: Grid, name: str) -> EdgeLine:
    """An edge of a shell, as its supports see it."""
    edge = grid.edges[name]
    nodes = edge.nodes[edge.parts]
    a, b = grid.nodes[:, nodes]
    inside = a.mean(axis=1, keepdims=True) if edge.along == 0 else a
    end = (a, b)[1 - edge.along].ravel()[:1]  # the parameter that the edge holds
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
    """An edge along one parameter at (a, b); `inside` tells the side of a strip's end, as in `Shell.geometry`."""
    geometry = shell.geometry(a, b, inside)
    surface = geometry.surface
    tangent, second = (surface.x2, surface.x22) if along == 1 else (surface.x1, surface.x11)
    basis, square = frame(surface), dot(tangent, tangent)
    stretch, tangents = np.sqrt(square), np.stack([basis.e1, basis.e2], axis=1)
    bend = (shell.wall == "curved") * dot(basis.normal, second) / square
    return LineFrame(a, b, shell.chart.directions(a, b), geometry.thickness, stretch, tangents, bend)


def edge_forms(shell: ShellParts, grid: Grid) -> EdgeForms:
    """Stiffness and mass of all that stands on the edges, held dofs included."""
    own = own_dofs(shell, grid)
    rings = [ring_forms(shell, grid, name, ring, own[name]) for name, ring in shell.rings.items()]
    stiffness = [beam for beam, _ in rings] + holding_forms(shell, grid)
    mass = [inertia for _, inertia in rings] + mass_forms(shell, grid)
    return EdgeForms(stiffness, mass, own=sum(map(len, own.values())))


def holding_forms(shell: ShellParts, grid: Grid) -> list[EdgeForm]:
    """The springs that hold the edges from outside, those under rings included."""
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
    """Stiffness and mass of what stands on one edge or station of a perfect casing, n diameters, per unit angle.

    On the dofs of the line's node at z (1,): (5, 5), or (6, 6) with a ring, the turn about the normal last.
    """
    line = single_place(line_frame(shell, 1, z, np.zeros(1)))
    if name in shell.rings:
        return harmonic_ring(shell, name, shell.rings[name], n, z, line)
    support = shell.supports[name]
    springs = spring_form(support.springs(line)).D[0] if isinstance(support, Sprung) else np.zeros((DOFS, DOFS))
    return springs, np.zeros((DOFS, DOFS))
