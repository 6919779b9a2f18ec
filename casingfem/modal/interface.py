"""Interfaces: which displacements of a shell contact sees, as rows over its nodal fields."""

from dataclasses import dataclass

import numpy as np

from casingfem.arrays import FloatArray
from casingfem.errors import ModelError
from casingfem.modal.harmonics import ring_transform
from casingfem.structure.assembly import System
from casingfem.structure.kinematics import DOFS, frame


@dataclass(frozen=True, slots=True)
class Rim:
    """An edge of a casing, radial and tangential, by Fourier amplitudes up to n_max.

    u(theta) = sum_n c_n cos n theta + s_n sin n theta. A force at one angle reaches the shell through the same
    band: it acts on an arc of about 2 pi r/(2 n_max), which keeps its compliance finite as the mesh is
    refined (a point force on a shear-deformable edge would sink in without limit).

    >>> Rim("top", n_max=2).names
    ('cos0', 'cos1', 'cos2', 'sin1', 'sin2')
    """

    edge: str
    n_max: int = 40

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the harmonics of one direction."""
        n = range(1, self.n_max + 1)
        return ("cos0", *(f"cos{k}" for k in n), *(f"sin{k}" for k in n))


@dataclass(frozen=True, slots=True)
class Tip:
    """The tip edge of a blade as one place: mean displacement along the blade (span) and across it (flap).

    span points from the root to the tip, flap along the surface normal at mid-edge.
    """

    edge: str = "tip"


def rim_rows(system: System, rim: Rim) -> tuple[FloatArray, tuple[str, ...]]:
    """Rows (channels, 5 nodes) of a rim, and the channel names: radial, then tangential."""
    grid, chart = system.grid, system.shell.chart
    if not chart.periodic or rim.edge not in grid.edges:
        raise ModelError("interface-edge", f"a Rim needs a closed casing with an edge {rim.edge!r}")
    around = grid.mesh.order * grid.mesh.around
    if not 0 < rim.n_max <= around // 3:
        raise ModelError(
            "interface-harmonics", f"rim.n_max must lie between 1 and {around // 3} on this mesh, found {rim.n_max}"
        )
    _, transform = ring_transform(chart, grid, rim.n_max)
    real = np.concatenate([transform.real, -transform.imag[1:]])
    nodes = grid.edges[rim.edge].nodes
    c, s = np.cos(grid.nodes[1, nodes]), np.sin(grid.nodes[1, nodes])
    rows = np.zeros((2, len(real), grid.nodes.shape[1], DOFS))
    rows[0, :, nodes, 0], rows[0, :, nodes, 1] = (real * c).T, (real * s).T
    rows[1, :, nodes, 0], rows[1, :, nodes, 1] = (-real * s).T, (real * c).T
    names = tuple(f"{direction}.{name}" for direction in ("radial", "tangential") for name in rim.names)
    return rows.reshape(2 * len(real), -1), names


def tip_rows(system: System, tip: Tip) -> tuple[FloatArray, tuple[str, ...]]:
    """Rows (2, 5 nodes) of a blade tip: span and flap, averaged over the edge's length."""
    grid, shell = system.grid, system.shell
    if shell.chart.periodic or tip.edge not in grid.edges:
        raise ModelError("interface-edge", f"a Tip needs an open panel or plate with an edge {tip.edge!r}")
    edge = grid.edges[tip.edge]
    surface = shell.geometry(*grid.nodes[:, edge.nodes]).surface
    across = surface.x1 if edge.along == 1 else surface.x2
    weights = edge.arc(surface)
    weights = weights / weights.sum()
    middle = len(edge.nodes) // 2
    span = across[:, middle] / np.linalg.norm(across[:, middle])
    rows = np.zeros((2, grid.nodes.shape[1], DOFS))
    rows[0, edge.nodes, :3] = weights[:, None] * span
    rows[1, edge.nodes, :3] = weights[:, None] * frame(surface).normal[:, middle]
    return rows.reshape(2, -1), ("span", "flap")
