"""Loads on a shell, as work-conjugate nodal forces (three forces, two moments of the normal).

Each load is a value with `nodal(shell, grid) -> (nodes, 5)`; a load of your own only needs that method.
Forces are in Cartesian axes with constant direction; a pressure acts along the surface normal a1 x a2.
"""

from dataclasses import dataclass
from typing import Protocol, TypeAlias

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.structure.mesh.kinematics import DOFS, frame
from casingfem.structure.mesh.place import interpolation
from casingfem.structure.mesh.shell_mesh import Grid
from casingfem.structure.shell.edges import edge_forms
from casingfem.structure.shell.nodal_mass import nodal_mass, nodal_sums
from casingfem.structure.shell.shell import Shell
from contact.io.names import hint

Vector: TypeAlias = tuple[float, float, float]


class Load(Protocol):
    """Interface of a load for a static solution.

    >>> import casingfem as cf
    >>> class Wind:
    ...     def nodal(self, shell, grid):
    ...         return cf.loads.Pressure(pressure=50.0).nodal(shell, grid)
    >>> load: Load = Wind()  # whatever has `nodal` is a load
    """

    def nodal(self, shell: Shell, grid: Grid) -> FloatArray:
        """Nodal forces, (nodes, 5)."""


def node_surface(shell: Shell, grid: Grid) -> FloatArray:
    """Surface area of each node by the Lobatto rule, (nodes,) [m^2].

    >>> from casingfem.structure.geometry.chart import Plate
    >>> from casingfem.structure.material import Material
    >>> from casingfem.structure.mesh.shell_mesh import make_grid
    >>> plate = Shell(chart=Plate(length=2.0, width=1.5), thickness=0.01, material=Material(E=1.0, nu=0.3, rho=1.0))
    >>> float(node_surface(plate, make_grid(plate.chart, plate.mesh)).sum().round(12))
    3.0
    """
    a, b = grid.nodes[:, grid.elements]
    return np.asarray(nodal_sums(grid, frame(shell.geometry(a, b).surface).jacobian[:, :, None])[:, 0])


def forces(grid: Grid, vectors: FloatArray) -> FloatArray:
    """Forces at the nodes (nodes, 3) as nodal loads without moments (nodes, 5).

    >>> import casingfem as cf
    >>> from casingfem.structure.mesh.shell_mesh import make_grid
    >>> grid = make_grid(cf.Plate(length=0.2, width=0.1), cf.ShellMesh(order=3, rows=1, around=1))
    >>> found = forces(grid, np.ones((grid.nodes.shape[1], 3)))
    >>> found.shape, found[0].tolist()
    ((16, 5), [1.0, 1.0, 1.0, 0.0, 0.0])
    """
    loads = np.zeros((grid.nodes.shape[1], DOFS))
    loads[:, :3] = vectors
    return loads


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceLoad:
    """A force per mid-surface area [N/m^2], Cartesian.

    >>> SurfaceLoad(force=(0.0, 0.0, -90.0)).force[2]
    -90.0
    """

    force: Vector

    def nodal(self, shell: Shell, grid: Grid) -> FloatArray:
        """Nodal forces, (nodes, 5)."""
        return forces(grid, node_surface(shell, grid)[:, None] * np.asarray(self.force))


@dataclass(frozen=True, slots=True, kw_only=True)
class Pressure:
    """A pressure [Pa] along the surface normal a1 x a2 (inwards on bodies of revolution about z: give -p to inflate).

    >>> Pressure(pressure=-1e5).pressure
    -100000.0
    """

    pressure: float

    def nodal(self, shell: Shell, grid: Grid) -> FloatArray:
        """Nodal forces, (nodes, 5)."""
        normal = frame(shell.geometry(*grid.nodes).surface).normal.T
        return forces(grid, self.pressure * node_surface(shell, grid)[:, None] * normal)


@dataclass(frozen=True, slots=True, kw_only=True)
class Gravity:
    """A body force: acceleration [m/s^2], Cartesian, times the mass of the shell.

    Raises
    ------
    ModelError
        `load-ring` if the shell has rings or point masses, whose weight is not modelled.

    >>> Gravity().acceleration
    (0.0, 0.0, -9.80665)
    """

    acceleration: Vector = (0.0, 0.0, -9.80665)

    def nodal(self, shell: Shell, grid: Grid) -> FloatArray:
        """Nodal forces, (nodes, 5)."""
        if edge_forms(shell, grid).mass:
            raise ModelError("load-ring", "gravity: found a ring or point masses on an edge")
        falling = np.append(self.acceleration, [0.0, 0.0])  # all nodes, without a rotation
        return nodal_mass(shell, grid).times(np.tile(falling[:, None], (grid.nodes.shape[1], 1, 1)))[:, :, 0]


@dataclass(frozen=True, slots=True, kw_only=True)
class EdgeLoad:
    """A force per length [N/m] along an edge, Cartesian.

    >>> EdgeLoad(edge="tip", force=(0.0, 0.0, 1e3)).edge
    'tip'
    """

    edge: str
    force: Vector

    def nodal(self, shell: Shell, grid: Grid) -> FloatArray:
        """Nodal forces, (nodes, 5)."""
        if self.edge not in grid.edges:
            found = f"load: found edge {self.edge!r}, expected one of {', '.join(grid.edges)}"
            raise ModelError("load-edge", found + hint(self.edge, grid.edges))
        edge = grid.edges[self.edge]
        surface = shell.geometry(*grid.nodes[:, edge.nodes]).surface
        loads = np.zeros((grid.nodes.shape[1], DOFS))
        loads[edge.nodes, :3] = edge.arc(surface)[:, None] * np.asarray(self.force)
        return loads


@dataclass(frozen=True, slots=True, kw_only=True)
class PointLoad:
    """A force [N], Cartesian, at the parameters `at` = (a, b) of the chart.

    On a shear-deformable shell the displacement under a point force has no limit: it grows as F/(2 pi kappa G t)
    ln(1/h) with the node distance h, as every plate with transverse shear does. Published values under point forces
    belong to thin-shell theory (a large `shear_correction` gives it) or to a particular mesh. Elsewhere the
    displacement converges.

    >>> PointLoad(at=(0.1, 0.0), force=(0.0, 0.0, 1.0)).at
    (0.1, 0.0)
    """

    at: tuple[float, float]
    force: Vector

    def nodal(self, shell: Shell, grid: Grid) -> FloatArray:
        """Nodal forces, (nodes, 5)."""
        try:
            nodes, weights = interpolation(grid, np.array([self.at[0]]), np.array([self.at[1]]))
        except ValueError as error:
            raise ModelError("load-place", f"load.at: {error}") from error
        loads = np.zeros((grid.nodes.shape[1], DOFS))
        # where one element closes on itself, a node is there twice
        np.add.at(loads[:, :3], nodes[0], weights[0][:, None] * np.asarray(self.force))
        return loads
