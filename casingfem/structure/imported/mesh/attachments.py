"""Point masses, springs, rigid and mean connections, equations between nodes and ties, as values.

Nodes are indices into the points of a mesh. Components 0 to 5 are displacements along x, y, z and rotations about them.
A node outside all cells has all six. A node of a shell has three displacements and two rotations (none about its
normal). A node of a solid has three displacements.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple, TypeAlias

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray, frozen
from casingfem.structure.geometry.rotation import skew

Renumbering: TypeAlias = Callable[[IntArray], IntArray]


class Term(NamedTuple):
    """A coefficient times one component of a node's motion.

    >>> Term(node=3, component=2, coefficient=-1.0).component
    2
    """

    node: int
    component: int
    coefficient: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PointMass:
    """A rigid mass at a node.

    Attributes
    ----------
    node
        The node to which it is attached.
    mass
        m [kg].
    inertia
        Inertia about its own centre [kg m^2], (3, 3), symmetric.
    offset
        Vector from the node to its centre [m].
    where
        Its card and line, for messages.

    >>> PointMass(node=3, mass=2.0, offset=(0.0, 0.0, 0.1)).matrix[0].tolist()
    [2.0, 0.0, 0.0, 0.0, 0.2, 0.0]
    """

    node: int
    mass: float
    inertia: FloatArray = field(default_factory=lambda: np.zeros((3, 3)))
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    where: str = "mass"

    @property
    def matrix(self) -> FloatArray:
        """Mass on the node's six components, (6, 6): m |u + theta x offset|^2 + theta.J theta."""
        moved = np.hstack([np.eye(3), -skew(np.asarray(self.offset))])
        whole = self.mass * moved.T @ moved
        whole[3:, 3:] += self.inertia
        return np.asarray(whole)

    @property
    def turns(self) -> bool:
        """Whether the mass also acts on rotations: it has an inertia or an offset."""
        return bool(np.any(self.inertia)) or any(self.offset)


@dataclass(frozen=True, slots=True, kw_only=True)
class Spring:
    """A stiffness on a combination of motions, k (sum of terms)^2/2: to the ground, or between two nodes.

    >>> Spring(terms=(Term(0, 2, 1.0), Term(5, 2, -1.0)), stiffness=1e6).nodes
    (0, 5)
    """

    terms: tuple[Term, ...]
    stiffness: float
    where: str = "spring"

    @property
    def nodes(self) -> tuple[int, ...]:
        """Nodes that it joins."""
        return tuple(term.node for term in self.terms)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rigid:
    """Components of nodes that follow a reference node as a rigid body (RBE2, kinematic coupling).

    >>> Rigid(reference=9, nodes=np.array([1, 2, 3])).components
    (0, 1, 2, 3, 4, 5)
    """

    reference: int
    nodes: IntArray
    components: tuple[int, ...] = (0, 1, 2, 3, 4, 5)
    where: str = "rigid connection"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mean:
    """Components of a reference node that follow the mean motion of nodes, by weighted least squares (RBE3).

    >>> Mean(reference=9, nodes=np.array([1, 2, 3]), weights=np.ones(3)).components
    (0, 1, 2, 3, 4, 5)
    """

    reference: int
    nodes: IntArray
    weights: FloatArray
    components: tuple[int, ...] = (0, 1, 2, 3, 4, 5)
    where: str = "mean connection"

    def renumbered(self, new: Renumbering) -> "Mean":
        """The same connection with other numbers of nodes; weights of nodes that are merged are added."""
        nodes, place = np.unique(new(self.nodes), return_inverse=True)
        weights = np.bincount(place.ravel(), self.weights).astype(np.float64)
        return replace(self, reference=int(new(np.array([self.reference]))[0]), nodes=nodes, weights=weights)


@dataclass(frozen=True, slots=True, kw_only=True)
class Equation:
    """A sum of terms that is zero; it determines the first term from the others.

    >>> Equation(terms=(Term(0, 2, 1.0), Term(5, 2, -1.0))).nodes
    (0, 5)
    """

    terms: tuple[Term, ...]
    where: str = "equation"

    @property
    def nodes(self) -> tuple[int, ...]:
        """Nodes that it joins."""
        return tuple(term.node for term in self.terms)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tie:
    """Nodes that follow weighted sums of others, all components of each: u_i = sum_k weights_ik u_others_ik.

    `nodes` (n,), `others` and `weights` (n, k); where a support fixes a component, the support prevails over the tie.

    >>> Tie(nodes=np.array([9]), others=np.array([[1, 2]]), weights=np.array([[0.5, 0.5]])).where
    'tie'
    """

    nodes: IntArray
    others: IntArray
    weights: FloatArray
    where: str = "tie"

    def renumbered(self, new: Renumbering) -> "Tie":
        """The same tie with other numbers of nodes, without nodes that are merged with one of their masters."""
        nodes, others = new(self.nodes), new(self.others)
        apart = ~((nodes[:, None] == others) & (self.weights != 0.0)).any(axis=1)
        return replace(self, nodes=nodes[apart], others=others[apart], weights=self.weights[apart])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attachments:
    """All attachments of a mesh: masses, springs, connections, equations and ties.

    >>> found = Attachments(masses=(PointMass(node=3, mass=2.0),))
    >>> bool(found), found.ties, found.nodes.tolist()
    (True, (), [3])
    """

    masses: tuple[PointMass, ...] = ()
    springs: tuple[Spring, ...] = ()
    rigids: tuple[Rigid, ...] = ()
    means: tuple[Mean, ...] = ()
    equations: tuple[Equation, ...] = ()
    glued: tuple[Tie, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.masses or self.springs or self.ties)

    def __repr__(self) -> str:
        kinds = (
            ("point mass", "es", self.masses), ("spring", "s", self.springs), ("rigid connection", "s", self.rigids),
            ("mean connection", "s", self.means), ("equation", "s", self.equations), ("tie", "s", self.glued),
        )  # fmt: skip
        parts = (f"{len(items)} {name}{plural * (len(items) > 1)}" for name, plural, items in kinds if items)
        return ", ".join(parts) or "nothing"

    @property
    def weighed(self) -> bool:
        """Whether there are masses or springs; their values are in the file's units of mass and force."""
        return bool(self.masses or self.springs)

    @property
    def ties(self) -> tuple[Rigid | Mean | Equation | Tie, ...]:
        """Attachments that make some motions depend on others."""
        return (*self.rigids, *self.means, *self.equations, *self.glued)

    @property
    def links(self) -> Iterator[IntArray]:
        """Nodes that each attachment joins, two or more."""
        for ends in self.pairs:
            if len(set(ends)) > 1:
                yield np.array(ends, dtype=np.int64)
        yield from self.bodies

    @property
    def pairs(self) -> list[tuple[int, ...]]:
        """Nodes of each spring and equation."""
        return [spring.nodes for spring in self.springs] + [equation.nodes for equation in self.equations]

    @property
    def bodies(self) -> list[IntArray]:
        """Nodes of each rigid and mean connection, the reference last, and of each tie."""
        rigid = [np.append(rigid.nodes, rigid.reference) for rigid in self.rigids]
        mean = [np.append(mean.nodes, mean.reference) for mean in self.means]
        return [*rigid, *mean, *(np.append(tie.nodes, tie.others) for tie in self.glued)]

    @property
    def nodes(self) -> IntArray:
        """Every node that an attachment names, ascending."""
        ends = [node for pair in self.pairs for node in pair] + [mass.node for mass in self.masses]
        return np.unique(np.concatenate([np.array(ends, dtype=np.int64), *self.bodies]))

    def renumbered(self, new: Renumbering) -> "Attachments":
        """The same attachments with other numbers of nodes; `new` maps an array of old numbers to new ones."""

        def one(node: int) -> int:
            return int(new(np.array([node]))[0])

        def terms(of: tuple[Term, ...]) -> tuple[Term, ...]:
            return tuple(term._replace(node=one(term.node)) for term in of)

        return Attachments(
            masses=tuple(replace(mass, node=one(mass.node)) for mass in self.masses),
            springs=tuple(replace(spring, terms=terms(spring.terms)) for spring in self.springs),
            rigids=tuple(replace(r, reference=one(r.reference), nodes=np.unique(new(r.nodes))) for r in self.rigids),
            means=tuple(mean.renumbered(new) for mean in self.means),
            equations=tuple(replace(equation, terms=terms(equation.terms)) for equation in self.equations),
            glued=tuple(tie.renumbered(new) for tie in self.glued),
        )

    def in_si(self, length: float, mass: float, time: float) -> "Attachments":
        """The same attachments in m, kg, s; the arguments are the sizes of the file's units in SI."""

        def stiff(spring: Spring) -> float:
            turning = all(term.component > 2 for term in spring.terms)
            return spring.stiffness * mass / time**2 * (length**2 if turning else 1.0)

        def terms(of: tuple[Term, ...]) -> tuple[Term, ...]:  # of displacements in m
            return tuple(t if t.component > 2 else t._replace(coefficient=t.coefficient / length) for t in of)

        def arms(spring: Spring) -> tuple[Term, ...]:  # turns beside displacements have arms in the file's length
            if all(term.component > 2 for term in spring.terms):
                return spring.terms
            return tuple(t._replace(coefficient=t.coefficient * length) if t.component > 2 else t for t in spring.terms)

        def weighed(m: PointMass) -> PointMass:
            inertia, (x, y, z) = frozen(np.asarray(m.inertia) * mass * length**2), m.offset
            return replace(m, mass=m.mass * mass, inertia=inertia, offset=(x * length, y * length, z * length))

        springs = tuple(replace(s, stiffness=stiff(s), terms=arms(s)) for s in self.springs)
        equations = tuple(replace(equation, terms=terms(equation.terms)) for equation in self.equations)
        return replace(self, masses=tuple(map(weighed, self.masses)), springs=springs, equations=equations)


NOTHING = Attachments()
