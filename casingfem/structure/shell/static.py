"""Static solution: K u = f."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, frozen
from casingfem.linalg.factor import solve_held
from casingfem.structure.mesh.place import interpolation
from casingfem.structure.mesh.shell_mesh import Grid
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.loads import Load
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System
from contact.io.reported import Reported

NODAL = ("u_x_m", "u_y_m", "u_z_m", "w_1_rad", "w_2_rad")


def deflected(fields: FloatArray, energy: float) -> str:
    """One line on displacements (nodes, 3 or 5) and the strain energy [J].

    >>> deflected(np.array([[0.0, 3e-3, 4e-3]]), 2.0)
    'Deflection(at most 0.005 m of 1 nodes, strain energy 2 J)'
    """
    most = float(np.linalg.norm(fields[:, :3], axis=1).max())
    return f"Deflection(at most {most:.4g} m of {len(fields)} nodes, strain energy {energy:.4g} J)"


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Deflection(Reported):
    """A static solution.

    Attributes
    ----------
    fields
        u_x, u_y, u_z [m], w_1, w_2 [rad] at the nodes of `grid`, (nodes, 5).
    energy
        Strain energy u^T K u/2 [J].

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=6, rows=2, around=1))
    >>> found = cf.shell.solve_static(plate, [cf.loads.EdgeLoad(edge="tip", force=(0.0, 0.0, 1.0))])
    >>> f"{found.at(0.2, 0.05)[2] * 1e3:.2f} mm", bool(found.energy > 0.0)
    ('0.15 mm', True)
    """

    shell: Shell
    grid: Grid
    fields: FloatArray
    energy: float

    def columns(self) -> dict[str, FloatArray]:
        """One row for each node: position and displacement [m], rotations [rad]."""
        x = np.real(self.shell.geometry(*self.grid.nodes).surface.x).reshape(3, -1)
        return dict(zip(("x_m", "y_m", "z_m", *NODAL), (*x, *self.fields.T), strict=False))

    def __repr__(self) -> str:
        return deflected(self.fields, self.energy)

    def at(self, a: float, b: float) -> FloatArray:
        """Displacement (u_x, u_y, u_z) [m] at parameters (a, b) of the chart, (3,)."""
        nodes, weights = interpolation(self.grid, np.array([a]), np.array([b]))
        return np.asarray(weights[0] @ self.fields[nodes[0], :3])


def solve_static(shell: Shell, loads: Sequence[Load], *, system: System | None = None) -> Deflection:
    """Displacements of a supported shell under simultaneous loads.

    K u = f, linear, about the unloaded shape.

    Parameters
    ----------
    shell
        The structure, supported against every rigid motion that the loads drive.
    loads
        `SurfaceLoad`, `Pressure`, `Gravity`, `EdgeLoad`, `PointLoad`, or a load of your own.
    system
        The assembled shell, if it exists already.

    Raises
    ------
    ModelError
        load-none without loads; static-loose if a rigid motion is not restrained.

    Examples
    --------
    >>> from casingfem.structure.geometry.chart import Plate
    >>> from casingfem.structure.shell.loads import EdgeLoad
    >>> from casingfem.structure.material import Material
    >>> from casingfem.structure.edge.support import Clamped
    >>> steel = Material(E=210e9, nu=0.0, rho=7800.0)
    >>> strip = Shell(chart=Plate(length=1.0, width=0.1), thickness=0.01, material=steel, supports={"root": Clamped()})
    >>> bent = solve_static(strip, [EdgeLoad(edge="tip", force=(0.0, 0.0, 1e3))])
    >>> f"{bent.at(1.0, 0.0)[2] * 1e3:.3f} mm"  # F L^3/(3 E I) = 19.048 mm, and .001 mm of shear
    '19.049 mm'
    """
    if not loads:
        raise ModelError("load-none", "solve_static: found no loads, expected at least one")
    system = system or assemble(shell)
    nodal = np.sum([load.nodal(shell, system.grid) for load in loads], axis=0)
    u = solve_held(system.stiffness, system.restrict(nodal[:, :, None])[:, 0])
    energy = 0.5 * float(u @ (system.stiffness @ u))
    return Deflection(shell=shell, grid=system.grid, fields=frozen(system.expand(u[:, None])[:, :, 0]), energy=energy)
