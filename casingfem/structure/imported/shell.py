"""Shells on imported meshes: the degenerated shell (Ahmad) with tied strains (MITC).

The geometry is x + z n, with shape functions for the mid-surface x and the director n alike; displacements are u + z w,
with w in the tangent plane of each node, so a node has five dofs. With covariant components along r and s,

    eps_ab = sym(x,a . u,b),   chi_ab = sym(x,a . w,b + n,a . u,b),   gamma_a = x,a . w + n . u,a

are those of the shell on a chart. Quadratic cells take them from tying points instead of the quadrature points (MITC9:
Bucalem & Bathe, Int. J. Numer. Meth. Eng. 36, 1993, 3729), which frees thin shells from locking and, unlike reduced
integration, leaves no hourglass modes. Cells of eight nodes get a ninth in their middle, which leaves the geometry
unchanged and avoids locking. Linear cells tie the transverse shear alone (MITC4: Dvorkin & Bathe, Eng. Comput. 1, 1984,
77). Triangles of six nodes are stored as collapsed quadrilaterals and integrated as triangles (MITC6). Where walls meet
at an angle, nodes have six dofs, and every wall has a director of its own (`mesh/joints.py`).
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.sparse import csc_array

from casingfem.errors import ModelError, warn
from casingfem.io.arrays import FloatArray, read_only
from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.geometry.rotation import Rotation, Vector
from casingfem.structure.imported.assembly import MeshSystem, assembled
from casingfem.structure.imported.cells.mapped import cell_dofs, facet_shape_products, scatter, shape_products
from casingfem.structure.imported.cells.shell import (
    DOFS,
    ShellCells,
    consistent_mass,
    directors,
    five_dofs,
    mass_moments,
    stiffness,
    tangent_frames,
)
from casingfem.structure.imported.cells.support import check_support
from casingfem.structure.imported.checks import check_groups, check_mesh, check_units
from casingfem.structure.imported.mesh.cell_kind import SHELLS, shape_functions
from casingfem.structure.imported.mesh.findings import cells_named
from casingfem.structure.imported.mesh.joints import joints_of
from casingfem.structure.imported.mesh.mesh_data import MeshData, natives
from casingfem.structure.imported.mesh.walls import (
    FOLDED,
    SHARP,
    cell_normals,
    neighbours,
    one_wall,
    walls_apart,
)
from casingfem.structure.imported.spin import MeshSpin, MeshTurning, mesh_spin, spun
from casingfem.structure.shell.checks import WALLS
from contact.io.brief import brief

BENT, ROUND = 10.0, 1e-6  # degrees between neighbours from which a warning is given; of round-off
ACROSS = 1e-3  # of 1 less the cosine to the normal: below, a wall does not see a direction


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeshShell(ShellCells):
    """An elastic shell on an imported mesh of quadrilaterals and triangles.

    Parameters
    ----------
    mesh
        Cells of kind quad, quad8 or quad9 (`read_mesh`); triangles are collapsed quadrilaterals. quad8 is stored as
        quad9, with the new nodes after the others.
    thickness
        Wall thickness t [m], half of it on each side of the mesh.
    material
        Isotropic material.
    thicknesses, materials
        Group of cells -> its thickness [m], its material.
    supports
        Group -> `Clamped`, `Fixed` (displacements), or `ElasticEdge(k_face=...)` on the group's edges: t k_face per
        length on displacements, t^3/12 k_face on rotations.
    shear_correction
        Factor of the transverse shear stiffness; 5/(6 - nu), or 5/6 on a linear wall, if left out.
    wall
        "curved" or "linear", as in `Shell`, for stiffness and inertia. The curvature is that of the nodes' normals.
    plies
        Layers along the normals of the cells. They fill the wall in proportion to their thicknesses. The wall must be
        linear, and groups may not have materials. A layer without a lamina has the shell's material.
    angle_from
        Reference direction of the plies' angles, projected on the wall; angles are right-handed about the normals.
    rotation
        Steady rotation: speed and axis; at rest if left out.

    Raises
    ------
    ModelError
        For a faulty mesh, an unknown group, or an impossible support.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.imported.grid_mesh("quad8", (4, 4), lambda u: np.insert(u, 2, 0.0, axis=1))
    >>> shell = cf.MeshShell(mesh=plate, thickness=0.01, material=cf.Material(E=210e9, nu=0.3, rho=7800.0))
    >>> shell.mesh.kind, shell.assembled().rigid
    ('quad9', 6)
    """

    __repr__ = brief

    def __post_init__(self) -> None:
        if self.mesh.kind not in SHELLS:
            raise ModelError("mesh-not-shell", f"{self.mesh.source}: cells of kind {self.mesh.kind}")
        named = {f"thicknesses.{name}": t for name, t in self.thicknesses.items()}
        for key, t in {"thickness": self.thickness, **named}.items():
            if not (np.isfinite(t) and t > 0.0):
                raise ModelError("shell-thickness", f"shell.{key} must be above 0, found {t!r}")
        check_groups(self.mesh, [*self.supports, *self.thicknesses, *self.materials])
        for name, support in self.supports.items():
            check_support(self.mesh, name, support)
        check_mesh(self.mesh)
        check_units(self.mesh, self.material)
        object.__setattr__(self, "mesh", with_centres(self.mesh))
        object.__setattr__(self, "apart", walls_apart(self.mesh))
        object.__setattr__(self, "supports", read_only(self.supports))
        object.__setattr__(self, "thicknesses", read_only(self.thicknesses))
        object.__setattr__(self, "materials", read_only(self.materials))
        check_folds(self)
        check_layers(self)
        self.walls()

    def density(self) -> FloatArray:
        """Mass per area of each cell [kg/m^2], (cells,)."""
        if self.wall == "linear":
            return self.inertia(np.arange(len(self.mesh.cells)), np.zeros((3, 1, 1)))[0, :, 0]
        _, size = shape_products(self.mesh.points, self.mesh.cells, natives(self.mesh))
        return np.asarray(mass_moments(self, directors(self.apart.mesh))[0].sum(axis=(1, 2)) / size)

    def weight(self, acceleration: Vector) -> FloatArray:
        """Nodal forces and moments of gravity on all dofs, (nodes, dofs).

        The mass matrix times a unit-acceleration field of all nodes.
        """
        mesh = self.apart.mesh
        normals = directors(mesh)
        frames = tangent_frames(normals)
        mass = consistent_mass(self, normals, frames).reshape(*mesh.cells.shape, DOFS, -1, DOFS)
        loads = np.zeros((len(mesh.points), DOFS))
        np.add.at(loads, mesh.cells, mass[..., :3].sum(axis=3) @ np.asarray(acceleration))
        return joints_of(self.apart, normals, frames).onto_nodes(loads.ravel()).reshape(len(self.mesh.points), -1)

    def assembled(self) -> MeshSystem:
        """The matrices on its free dofs, at its speed of rotation if it has one."""
        system = assemble_mesh_shell(self)
        return system if self.rotation is None else spun(system, self.spin(system, self.rotation), self.rotation.omega)

    def spin(self, at_rest: MeshSystem, rotation: Rotation) -> MeshSpin:
        """Terms that rotation about an axis adds to the matrices at rest."""
        return mesh_spin(self.turning(at_rest, rotation))

    def turning(self, at_rest: MeshSystem, rotation: Rotation) -> MeshTurning:
        """Centrifugal load about an axis, and the terms that rotation adds to modes."""
        from casingfem.structure.imported.shell_spin import shell_inertia, shell_stiffening

        inertia, stiffening = shell_inertia(self, rotation), partial(shell_stiffening, self)
        return MeshTurning(system=at_rest, rotation=rotation, inertia=inertia, stiffening=stiffening)


def check_layers(shell: MeshShell) -> None:
    """Refuse unknown kinds of walls, and layers together with features that assume one isotropic wall."""
    if shell.wall not in WALLS:
        raise ModelError("shell-wall", f"shell.wall: expected {' or '.join(WALLS)}, found {shell.wall!r}")
    if not shell.plies:
        return
    if shell.wall != "linear" or shell.materials:
        found = "materials of groups" if shell.materials else f"wall {shell.wall!r}"
        raise ModelError("shell-plies", f'shell.plies: found {found}, expected wall "linear" and one material')
    direction = np.asarray(shell.angle_from, dtype=float)
    size = float(np.linalg.norm(direction))
    if not (np.isfinite(size) and size > 0.0):
        expected = "expected a vector of three finite numbers that is not 0"
        raise ModelError("shell-plies", f"shell.angle_from: found {shell.angle_from!r}, {expected}")
    seen = 1.0 - np.abs(cell_normals(shell.mesh) @ direction).max(axis=1) / size
    if seen.min() < ACROSS:
        normal = f"which is normal to {cells_named(shell.mesh, np.flatnonzero(seen < ACROSS))}"
        expected = "expected a direction along the wall"
        raise ModelError("shell-plies", f"shell.angle_from: found {shell.angle_from!r}, {normal}; {expected}")


def with_centres(mesh: MeshData) -> MeshData:
    """Add the ninth node to eight-noded cells, at the middle given by their shape functions; others are unchanged."""
    if mesh.kind != "quad8":
        return mesh
    weights, _ = shape_functions("quad8", np.array([[0.5], [0.5]]))
    whole = np.flatnonzero(~mesh.collapsed)
    centres = np.einsum("k,ekc->ec", weights[:, 0], mesh.points[mesh.cells[whole]])
    ninth = mesh.cells[:, 3].copy()  # triangles have none of their own
    ninth[whole] = len(mesh.points) + np.arange(len(centres))
    points, cells = np.vstack([mesh.points, centres]), np.column_stack([mesh.cells, ninth])
    numbers = np.concatenate([mesh.node_numbers, np.zeros(len(centres), dtype=np.int64)])
    return replace(mesh, kind="quad9", points=points, cells=cells, node_numbers=numbers)


def check_folds(shell: MeshShell) -> None:
    """Warn of kinks that may be meant as smooth; refuse walls folded back at a node, where no director can exist."""
    mesh = shell.apart.mesh
    own = cell_normals(mesh)
    cosine = np.where(own.any(axis=2), np.einsum("ekc,ekc->ek", own, directors(mesh)[mesh.cells]), 1.0).min(axis=1)
    angle = 2.0 * np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    if angle.max() > FOLDED + ROUND:
        found = f"{cells_named(mesh, np.flatnonzero(angle > FOLDED + ROUND))} fold by up to {angle.max():.0f} degrees"
        raise ModelError("mesh-fold", f"{mesh.source}: {found}")
    given = neighbours(shell.mesh)
    folds = one_wall(given, FOLDED)
    turn = np.degrees(np.arccos(np.clip(given.ahead[folds], -1.0, 1.0)))
    corners = turn > SHARP
    np.maximum.at(angle, given.facets[folds][corners, :, 0], turn[corners, None])
    if angle.max() > BENT:
        found = f"{cells_named(mesh, np.flatnonzero(angle > BENT))} meet at up to {angle.max():.0f} degrees"
        warn("mesh-kink", f"{mesh.source}: {found}", stacklevel=4)


def assemble_mesh_shell(shell: MeshShell) -> MeshSystem:
    """Assemble stiffness and consistent mass of a shell on its free dofs."""
    mesh = shell.apart.mesh
    size = DOFS * len(mesh.points)
    normals = directors(mesh)
    frames = tangent_frames(normals)
    dofs = cell_dofs(mesh.cells, DOFS)
    K = scatter(stiffness(shell, normals, frames), dofs, size)
    M = scatter(consistent_mass(shell, normals, frames), dofs, size)
    t, E, _, rho = shell.walls()
    joints = joints_of(shell.apart, normals, frames)
    return assembled(
        shell, K, M, edge_springs(shell, frames), joints.rigid(shell.mesh.points), float(t.min()),
        float(np.sqrt((E / rho).min())), joints,
    )  # fmt: skip


def edge_springs(shell: MeshShell, frames: FloatArray) -> list[csc_array]:
    """Springs of each elastic edge, on the dofs of walls' nodes."""
    mesh = shell.apart.mesh
    size = DOFS * len(mesh.points)
    springs = []
    for name, support in shell.supports.items():
        if isinstance(support, ElasticEdge):
            facets = shell.mesh.group_facets(name)
            products, nodes, _ = facet_shape_products(mesh, facets)
            k, t = support.k_face, shell.walls()[0, facets[:, 0], None, None]
            matrices = five_dofs(k * products * np.stack([t, 0.0 * t, t**3 / 12.0]), frames[nodes])
            springs.append(scatter(matrices, cell_dofs(nodes, DOFS), size))
    return springs
