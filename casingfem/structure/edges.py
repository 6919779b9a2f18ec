"""What a shell carries on its edges, as quadratic forms over its dofs."""

import numpy as np

from casingfem.arrays import Array
from casingfem.structure.edge_form import EdgeForm, EdgeLine, LineFrame, Sprung, single_place, spring_form
from casingfem.structure.kinematics import dot
from casingfem.structure.mesh import Grid, edge_breaks, rim_values
from casingfem.structure.shell import Shell


def edge_line(shell: Shell, grid: Grid, name: str) -> EdgeLine:
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


def line_frame(shell: Shell, along: int, a: Array, b: Array, inside: Array | None = None) -> LineFrame:
    """An edge along one parameter at (a, b); `inside` tells the side of a strip's end, as in `Shell.geometry`."""
    geometry = shell.geometry(a, b, inside)
    tangent = geometry.surface.x2 if along == 1 else geometry.surface.x1
    return LineFrame(
        a=a,
        b=b,
        directions=shell.chart.directions(a, b),
        thickness=geometry.thickness,
        stretch=np.sqrt(dot(tangent, tangent)),
    )


def edge_stiffness(shell: Shell, grid: Grid) -> list[EdgeForm]:
    """Stiffness of all that stands on the edges, held dofs included."""
    return [
        spring_form(support.springs(edge_line(shell, grid, name)))
        for name, support in shell.supports.items()
        if isinstance(support, Sprung)
    ]


def harmonic_stiffness(shell: Shell, name: str, z: Array) -> Array:
    """The same of one edge of a perfect casing, per unit angle, on the five dofs of its node at z (1,)."""
    support = shell.supports[name]
    if not isinstance(support, Sprung):
        return np.zeros((5, 5))
    line = single_place(line_frame(shell, 1, z, np.zeros(1)))
    return np.asarray(spring_form(support.springs(line)).D[0])
