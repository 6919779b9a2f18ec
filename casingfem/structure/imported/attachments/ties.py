"""Elimination of tied motions: every dof of a mesh with attachments as a combination of its unknowns.

In addition to the dofs of the nodes (`dofs` each, node by node) there are three rotations for each node that has all
six components. These are the nodes outside all cells and the reference nodes of rigid connections. In a rigid
connection

    u_j = u + theta x (x_j - x),   w_j = theta x n_j on shells;

in a mean connection the motion of the reference fits u_j best, by least squares of sum w_j |u_j - u - theta x (x_j -
x)|^2 (RBE3: MSC Nastran Quick Reference Guide); an equation is solved for its first term. Motions that depend on
dependent motions are substituted.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.geometry.rotation import skew
from casingfem.structure.imported.mesh.attachments import Equation, Mean, PointMass, Rigid, Term, Tie
from casingfem.structure.imported.mesh.joints import Joints
from casingfem.structure.imported.mesh.mesh_data import MeshData

LEVELS = 6  # squarings: connections that hang on one another, 64 deep
FLAT = 1e-10  # least over largest spread of nodes below which their mean turn is not defined
ALIGNED = 0.9  # least cosine between the walls of tied shells
DIRECTIONS = ("x", "y", "z", "rotation about x", "rotation about y", "rotation about z")


@dataclass(frozen=True, eq=False, slots=True)
class Motions:
    """Motions of the nodes of a mesh with attachments.

    Attributes
    ----------
    mesh, dofs
        The mesh, and dofs of each of its nodes.
    turning
        Nodes with own rotations, ascending, (turning,).
    joints
        For shells: motion of the walls' nodes with the nodes. None for solids.
    """

    mesh: MeshData
    dofs: int
    turning: IntArray
    joints: Joints | None

    @property
    def size(self) -> int:
        """Number of dofs of nodes, plus the rotations after them."""
        return self.dofs * len(self.mesh.points) + 3 * len(self.turning)

    def turn(self, node: int) -> int:
        """Index of the first of the three rotations of a node; -1 if it has none of its own."""
        place = int(np.searchsorted(self.turning, node))
        own = place < len(self.turning) and self.turning[place] == node
        return self.dofs * len(self.mesh.points) + 3 * place if own else -1

    def place(self, dof: int) -> tuple[int, int]:
        """Node and component of a dof; dofs of a shell's director count as rotations."""
        behind = dof - self.dofs * len(self.mesh.points)
        return (int(self.turning[behind // 3]), 3 + behind % 3) if behind >= 0 else divmod(dof, self.dofs)

    def row(self, node: int, component: int, where: str) -> dict[int, float]:
        """One component of a node's motion as a combination of dofs: dof -> coefficient."""
        if component < 3:
            return {self.dofs * node + component: 1.0}
        if (turn := self.turn(node)) >= 0:
            return {turn + component - 3: 1.0}
        if self.joints is None:
            found = f"the {DIRECTIONS[component]}, expected x, y or z: nodes of solids have no rotations"
            raise self.fault(where, node, found)
        return {self.dofs * node + 3 + a: float(axis[component - 3]) for a, axis in self.turns(node)}

    def turns(self, node: int) -> list[tuple[int, FloatArray]]:
        """Rotational dofs of a shell's node, counted from its displacements, and their axes (3,)."""
        axes = np.zeros((0, 3)) if self.joints is None else self.joints.axes[node]
        return [(a, axis) for a, axis in enumerate(axes) if axis.any()]

    def felt(self, mass: PointMass) -> list[dict[int, float]]:
        """The components of a node's motion to which a mass at the node is connected, as combinations of dofs."""
        return [self.row(mass.node, component, mass.where) for component in range(6 if mass.turns else 3)]

    def combined(self, terms: Sequence[Term], where: str) -> dict[int, float]:
        """A sum of terms over the dofs."""
        total: dict[int, float] = {}
        for node, component, coefficient in terms:
            for dof, value in self.row(node, component, where).items():
                total[dof] = total.get(dof, 0.0) + coefficient * value
        return {dof: value for dof, value in total.items() if value}

    def fault(self, where: str, node: int, found: str) -> ModelError:
        """An error about a node with an impossible attachment."""
        source, number = self.mesh.source, self.mesh.node_numbers[node]
        return ModelError("mesh-attachment", f"{source}: {where}: node {number}: found {found}")


def motions_of(mesh: MeshData, dofs: int, joints: Joints | None = None) -> Motions:
    """Motions of the nodes; for shells, with the joints of their walls."""
    given = mesh.attachments
    alone = np.setdiff1d(given.nodes, mesh.used)
    pivots = np.array([rigid.reference for rigid in given.rigids], dtype=np.int64)
    return Motions(mesh, dofs, np.union1d(alone, pivots), joints)


class Rows:
    """Dependent dofs and their combinations of other dofs, each once."""

    def __init__(self, motions: Motions) -> None:
        self.motions = motions
        self.owner: dict[int, str] = {}
        self.own: set[int] = set()  # dofs that follow the turns of their own node
        self.entries: list[tuple[int, int, float]] = []

    def add(self, dof: int, node: int, of: dict[int, float], where: str) -> None:
        """Make a dof the sum of others."""
        if dof in self.owner:
            found = f"a motion that {self.owner[dof]} already prescribes, expected one connection for it"
            raise self.motions.fault(where, node, found)
        self.owner[dof] = where
        self.entries += [(dof, other, value) for other, value in of.items() if value]


def tied_rows(motions: Motions, held: IntArray) -> Rows:
    """Every dependent dof of the attachments of a mesh, without dofs `held` by supports."""
    rows = Rows(motions)
    for rigid in motions.mesh.attachments.rigids:
        take_rigid(rows, rigid)
    for mean in motions.mesh.attachments.means:
        take_mean(rows, mean)
    for equation in motions.mesh.attachments.equations:
        take_equation(rows, equation)
    for tie in motions.mesh.attachments.glued if motions.joints is None else motions.joints.glued:
        take_tie(rows, tie, held)
    return rows


def take_rigid(rows: Rows, rigid: Rigid) -> None:
    """Rows of a rigid connection."""
    motions, mesh, dofs = rows.motions, rows.motions.mesh, rows.motions.dofs
    reference, pivot = rigid.reference, rows.motions.turn(rigid.reference)
    arms = -skew(mesh.points[rigid.nodes] - mesh.points[reference])  # of theta in theta x r
    turning = [c for c in rigid.components if c > 2]
    of_shell = motions.joints is not None and bool(np.isin(reference, mesh.cells))
    if of_shell and dofs * reference + 3 not in rows.owner:
        tie_director(rows, reference, pivot, f"the rotation of the reference node of {rigid.where}")
        rows.own |= {dofs * reference + 3 + a for a, _ in motions.turns(reference)}
    for node, arm in zip(rigid.nodes.tolist(), arms, strict=True):
        if node == reference:
            found = "the reference node among the nodes that follow it, expected other nodes"
            raise motions.fault(rigid.where, node, found)
        for c in (c for c in rigid.components if c < 3):
            turned = {pivot + k: float(arm[c, k]) for k in range(3)}
            rows.add(dofs * node + c, node, {dofs * reference + c: 1.0} | turned, rigid.where)
        own = motions.turn(node)
        if own >= 0:
            for c in turning:
                rows.add(own + c - 3, node, {pivot + c - 3: 1.0}, rigid.where)
        elif turning and motions.joints is not None:
            if len(turning) < 3:
                found = "one or two rotations of a shell's node, expected all three or none"
                raise motions.fault(rigid.where, node, found)
            tie_director(rows, node, pivot, rigid.where)


def tie_director(rows: Rows, node: int, pivot: int, where: str) -> None:
    """Make the directors of a shell's node follow the rotation of a pivot: w_a = e_a.(theta x n) = theta.(n x e_a)."""
    for a, axis in rows.motions.turns(node):
        of = {pivot + k: float(axis[k]) for k in range(3)}
        rows.add(rows.motions.dofs * node + 3 + a, node, of, where)


def take_mean(rows: Rows, mean: Mean) -> None:
    """Rows of a mean connection."""
    motions, dofs, fit = rows.motions, rows.motions.dofs, fitted(rows.motions, mean)
    pivot = motions.turn(mean.reference)
    for c in mean.components:
        if c > 2 and pivot < 0:
            found = "rotations of a node that belongs to cells, expected x, y, z alone"
            raise motions.fault(mean.where, mean.reference, found)
        dof = dofs * mean.reference + c if c < 3 else pivot + c - 3
        of = {dofs * node + k: float(fit[c, j, k]) for j, node in enumerate(mean.nodes.tolist()) for k in range(3)}
        rows.add(dof, mean.reference, of, mean.where)


def fitted(motions: Motions, mean: Mean) -> FloatArray:
    """The six rigid motions that fit the motions of the nodes best, (6, nodes, 3).

    (A^T w A)^-1 A^T w with A = [1, -[r]].
    """
    mesh = motions.mesh
    arms = mesh.points[mean.nodes] - mesh.points[mean.reference]
    reach = max(float(np.abs(arms).max()), np.finfo(float).tiny)
    A = np.concatenate([np.broadcast_to(np.eye(3), (len(arms), 3, 3)), -skew(arms / reach)], axis=2)
    normal = np.einsum("j,jcs,jct->st", mean.weights, A, A)
    size = np.linalg.eigvalsh(normal)
    if not size[0] > FLAT * size[-1]:
        found = f"{len(arms)} nodes in a line, expected three that span a triangle"
        raise motions.fault(mean.where, mean.reference, found)
    fit = np.linalg.solve(normal, np.einsum("j,jcs->sjc", mean.weights, A).reshape(6, -1)).reshape(6, -1, 3)
    fit[3:] /= reach
    return np.asarray(fit)


def take_equation(rows: Rows, equation: Equation) -> None:
    """The row of an equation, solved for its first term."""
    motions, (first, *others) = rows.motions, equation.terms
    own = motions.row(first.node, first.component, equation.where)
    if first.coefficient == 0.0 or len(own) > 1:
        found = "a coefficient of 0" if first.coefficient == 0.0 else "a rotation of a shell's node"
        expected = "expected a term that the equation can be solved for"
        raise motions.fault(equation.where, first.node, f"{found} in the first term, {expected}")
    of = motions.combined([t._replace(coefficient=-t.coefficient / first.coefficient) for t in others], equation.where)
    rows.add(next(iter(own)), first.node, of, equation.where)


def take_tie(rows: Rows, tie: Tie, held: IntArray) -> None:
    """Rows of a tie: displacements, and directors from the others' shape functions, n + w ~ sum (n_k + w_k).

    A node's own director is n = sum n_k/|sum n_k| (`cells/shell.py`), so that rigid motions are reproduced.
    """
    motions, dofs, joints = rows.motions, rows.motions.dofs, rows.motions.joints
    fixed = set(held.tolist())
    for node, others, weights in zip(tie.nodes.tolist(), tie.others, tie.weights, strict=True):
        used = np.flatnonzero(weights)
        walls, share = others[used], weights[used]
        at = (walls if joints is None else joints.nodes[walls]).tolist()
        table = {c: [(dofs * k + c, w) for k, w in zip(at, share.tolist(), strict=True)] for c in range(3)}
        if joints is not None:
            along = share @ joints.normals[walls]
            if len(motions.turns(node)) > 2 or not along @ joints.normals[node] > ALIGNED:
                raise motions.fault(
                    tie.where, node, "walls that meet at an angle, expected walls in one smooth surface"
                )
            across = np.cross(joints.normals[walls][:, None], joints.frames[node]) * share[:, None, None]
            across /= np.linalg.norm(along)
            for a in (0, 1):
                turned = ((k, lean[a], *turn) for k, lean in zip(at, across, strict=True) for turn in motions.turns(k))
                table[3 + a] = [(dofs * k + 3 + b, float(lean @ axis)) for k, lean, b, axis in turned]
        for c, of in table.items():
            if dofs * node + c not in fixed:
                rows.add(dofs * node + c, node, dict(of), tie.where)


def eliminated(rows: Rows) -> csr_array:
    """Every dof as a combination of independent ones, (size, size); rows of independent dofs are unit rows.

    Raises
    ------
    ModelError
        `mesh-attachment` for connections that depend on each other in a cycle.
    """
    size = rows.motions.size
    dependent = np.zeros(size, dtype=bool)
    dependent[list(rows.owner)] = True
    free = np.flatnonzero(~dependent)
    i, j, value = np.array(rows.entries, dtype=float).reshape(-1, 3).T
    place = np.concatenate([i.astype(np.int64), free]), np.concatenate([j.astype(np.int64), free])
    R = coo_array((np.concatenate([value, np.ones(len(free))]), place), shape=(size, size)).tocsr()
    for _ in range(LEVELS):
        if not dependent[R.indices].any():
            break
        R = csr_array(R @ R)
        R.eliminate_zeros()
    left = R.indices[dependent[R.indices]]
    if not len(left):
        return csr_array(R)
    found = f"{rows.owner[int(left[0])]}: found connections that depend on one another in a circle"
    raise ModelError("mesh-attachment", f"{rows.motions.mesh.source}: {found}")
