"""Solids on imported meshes: tetrahedra and hexahedra, linear and quadratic, isoparametric.

    a(u, v) = int lambda div u div v + 2 mu eps(u):eps(v),   m(u, v) = int rho u.v

Geometry and displacements have the same shape functions, so the curved faces of quadratic cells are kept. Cells are
integrated in batches; the mass is consistent.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, read_only
from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.geometry.rotation import Rotation, rigid_motions
from casingfem.structure.imported.assembly import MeshSystem, assembled
from casingfem.structure.imported.cells.mapped import cell_dofs, facet_shape_products, mapped, scatter
from casingfem.structure.imported.cells.solid import SolidCells, cell_matrices, consistent_mass, stiffness
from casingfem.structure.imported.cells.support import check_support
from casingfem.structure.imported.checks import check_groups, check_mesh, check_units
from casingfem.structure.imported.mesh.cell_kind import SOLIDS
from casingfem.structure.imported.spin import MeshSpin, MeshTurning, spun
from contact.io.brief import brief


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solid(SolidCells):
    """An elastic solid on an imported mesh.

    Parameters
    ----------
    mesh
        Cells of one kind: tetra, tetra10, hexahedron, hexahedron20 or hexahedron27. Bricks may include collapsed ones
        (`read_mesh`).
    material
        Material of all cells that `materials` does not name.
    materials
        Group of cells -> material.
    supports
        Group -> `Clamped`, `Fixed`, or `ElasticEdge(k_face=...)`, a foundation [N/m^3] on the group's facets.
    rotation
        Steady rotation: speed and axis; at rest if left out.

    Raises
    ------
    ModelError
        For a faulty mesh, an unknown group, or a support that solids cannot have.

    Examples
    --------
    >>> import casingfem as cf
    >>> cube = cf.imported.grid_mesh("tetra10", (1, 1, 1), lambda u: u)
    >>> system = cf.Solid(mesh=cube, material=cf.Material(E=210e9, nu=0.3, rho=7800.0)).assembled()
    >>> system.size, system.rigid, round(float(system.M.sum()), 6)  # three times the mass
    (81, 6, 23400.0)
    """

    __repr__ = brief

    def __post_init__(self) -> None:
        if self.mesh.kind not in SOLIDS:
            raise ModelError("mesh-not-solid", f"{self.mesh.source}: cells of kind {self.mesh.kind}")
        check_groups(self.mesh, [*self.materials, *self.supports])
        for name, support in self.supports.items():
            check_support(self.mesh, name, support)
        check_mesh(self.mesh)
        check_units(self.mesh, self.material)
        object.__setattr__(self, "materials", read_only(self.materials))
        object.__setattr__(self, "supports", read_only(self.supports))
        self.constants()

    def density(self) -> FloatArray:
        """Mass per volume of each cell [kg/m^3], (cells,)."""
        return np.asarray(self.constants()[2])

    def assembled(self) -> MeshSystem:
        """The matrices on its free dofs, at its speed of rotation if it has one."""
        system = assemble_solid(self)
        return system if self.rotation is None else spun(system, self.spin(system, self.rotation), self.rotation.omega)

    def spin(self, at_rest: MeshSystem, rotation: Rotation) -> MeshSpin:
        """Terms that rotation about an axis adds to the matrices at rest."""
        from casingfem.structure.imported.solid_spin import solid_spin

        return solid_spin(at_rest, self, rotation)

    def turning(self, at_rest: MeshSystem, rotation: Rotation) -> MeshTurning:
        """Centrifugal load about an axis, and the terms that rotation adds to modes."""
        from casingfem.structure.imported.solid_spin import solid_turning

        return solid_turning(at_rest, self, rotation)

    def steady_shape(self) -> FloatArray:
        """Displacements of the nodes [m] in steady rotation, (nodes, 3): growth and untwist, on the deformed shape.

        Raises
        ------
        ModelError
            `rotation-none` without a rotation; `static-loose` if the centrifugal force drives a free rigid motion.
        NumericsError
            If Newton's method does not converge: the part has no steady shape at this speed.

        Examples
        --------
        A rod of length L that turns about its end grows by rho Omega^2 L^3 / (3 E).

        >>> import casingfem as cf
        >>> sizes = [1.0, 0.02, 0.02]
        >>> bar = cf.imported.grid_mesh("hexahedron20", (4, 1, 1), lambda u: u * sizes, groups={"root": (0, 0.0)})
        >>> steel = cf.Material(E=210e9, nu=0.0, rho=7800.0)
        >>> spin = cf.Rotation(omega=100.0, axis=(0.0, 0.0, 1.0), centre=(0.0, 0.01, 0.01))
        >>> rod = cf.Solid(mesh=bar, material=steel, supports={"root": cf.Clamped()}, rotation=spin)
        >>> round(float(1e6 * rod.steady_shape()[:, 0].max()), 1), round(1e6 * 7800.0 * 100.0**2 / (3.0 * 210e9), 1)
        (123.8, 123.8)
        """
        from casingfem.structure.imported.solid_spin import steady_state

        if self.rotation is None:
            raise ModelError("rotation-none", "steady_shape: found a structure without rotation, expected one with")
        at_rest = replace(self, rotation=None).assembled()
        linear = self.spin(at_rest, self.rotation).fields
        return steady_state(at_rest, self, self.rotation, self.rotation.omega**2 * linear).fields


def assemble_solid(solid: Solid) -> MeshSystem:
    """Assemble stiffness and consistent mass of a solid on its free dofs."""
    mesh = solid.mesh
    size = 3 * len(mesh.points)
    dofs = cell_dofs(mesh.cells, 3)
    constants = solid.constants()
    E, _, rho = constants
    of = (lambda on, rows: stiffness(on, constants[:, rows]), lambda on, rows: consistent_mass(on, rho[rows]))
    K, M = (scatter(matrices, dofs, size) for matrices in cell_matrices(mesh.kind, mesh.points, mesh.cells, *of))
    area = facet_shape_products(mesh, mesh.boundary)[2].sum()
    volume = mapped(mesh.kind, mesh.points, mesh.cells).measure.sum()
    wall, sound = float(2.0 * volume / area), float(np.sqrt((E / rho).min()))
    return assembled(solid, K, M, foundations(solid), rigid_motions(mesh.points), wall, sound)


def foundations(solid: Solid) -> list[csc_array]:
    """Springs of each elastic foundation: integral of k u.v over the facets of its group."""
    size = 3 * len(solid.mesh.points)
    springs = []
    for name, support in solid.supports.items():
        if isinstance(support, ElasticEdge):
            products, nodes, _ = facet_shape_products(solid.mesh, solid.mesh.group_facets(name))
            springs.append(scatter(support.k_face * np.kron(products, np.eye(3)), cell_dofs(nodes, 3), size))
    return springs
