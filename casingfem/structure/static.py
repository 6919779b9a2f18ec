"""Static solution of any structure: a shell on a chart, or an imported part."""

from collections.abc import Sequence
from typing import overload

from casingfem.structure.imported.assembly import MeshStructure, MeshSystem, require_structure
from casingfem.structure.imported.loads import MeshDeflection, MeshLoad, solve_mesh_static
from casingfem.structure.shell.loads import Load
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.static import Deflection
from casingfem.structure.shell.static import solve_static as solve_shell_static
from casingfem.structure.shell.system import System


@overload
def solve_static(structure: Shell, loads: Sequence[Load], *, system: System | None = None) -> Deflection: ...
@overload
def solve_static(
    structure: MeshStructure, loads: Sequence[MeshLoad], *, system: MeshSystem | None = None
) -> MeshDeflection: ...
def solve_static(structure, loads, *, system=None):  # type: ignore[no-untyped-def]
    """Displacements of a supported structure under simultaneous loads.

    K u = f, linear, about the unloaded shape.

    Parameters
    ----------
    structure
        A `Shell`, or an imported `Solid` or `MeshShell`, supported against every rigid motion that the loads drive.
    loads
        On a chart `SurfaceLoad`, `Pressure`, `Gravity`, `EdgeLoad`, `PointLoad` of `cf.loads`; on an imported part
        `Gravity`, `EdgeLoad` on a group of facets, `cf.imported.NodeLoad`, `FacetPressure`; or loads of your own.
    system
        The assembled structure, if it exists already.

    Raises
    ------
    ModelError
        load-none without loads; load-edge for a load that the structure does not support; static-loose if a rigid
        motion is not restrained; structure-unknown for another object.

    Examples
    --------
    >>> import casingfem as cf
    >>> steel = cf.Material(E=210e9, nu=0.0, rho=7800.0)
    >>> beam = cf.imported.grid_mesh("hexahedron20", (8, 1, 1), lambda u: u * [1.0, 0.1, 0.1],
    ...                              groups={"root": (0, 0.0), "tip": (0, 1.0)})
    >>> solid = cf.Solid(mesh=beam, material=steel, supports={"root": cf.Clamped()})
    >>> bent = cf.solve_static(solid, [cf.loads.EdgeLoad(edge="tip", force=(0.0, 0.0, 1e5))])
    >>> f"{bent.fields[:, 2].max() * 1e3:.3f} mm"  # F L^3/(3 E I) = 0.190 mm, and 0.001 mm of shear
    '0.191 mm'
    """
    if isinstance(structure, Shell):
        return solve_shell_static(structure, loads, system=system)
    require_structure(structure, "solve_static")
    return solve_mesh_static(structure, loads, system=system)
