"""Point masses, springs and connections of an Abaqus or CalculiX input file.

Elements MASS, ROTARYI, SPRING1, SPRING2, SPRINGA with *MASS, *ROTARY INERTIA, *SPRING; *COUPLING with *KINEMATIC,
*KINEMATIC COUPLING, *RIGID BODY of nodes, *MPC of the kinds BEAM and PIN, *EQUATION; *DISTRIBUTING COUPLING with
elements DCOUP3D, *COUPLING with *DISTRIBUTING on a surface of nodes. Unsupported variants are refused with keyword and
line.
"""

from collections.abc import Callable

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.mesh.attachments import Attachments, Equation, Mean, PointMass, Rigid, Spring, Term
from casingfem.structure.imported.readers.inp_cards import Card
from casingfem.structure.imported.readers.inp_names import Names

ELEMENTS = {"MASS": 1, "ROTARYI": 1, "SPRING1": 1, "SPRING2": 2, "SPRINGA": 2, "DCOUP3D": 1}  # nodes of each
PROPERTIES = {"MASS": ("MASS",), "ROTARY INERTIA": ("ROTARYI",), "SPRING": ("SPRING1", "SPRING2", "SPRINGA"),
              "DISTRIBUTING COUPLING": ("DCOUP3D",)}  # fmt: skip
CONNECTIONS = ("COUPLING", "DISTRIBUTING", "KINEMATIC", "KINEMATIC COUPLING", "RIGID BODY", "EQUATION", "MPC")
MPCS = ("BEAM", "PIN")
REFUSED = ("ORIENTATION", "NONLINEAR", "ROT NODE", "ELSET", "PIN NSET", "ANALYTICAL SURFACE")


class AbaqusAttachments:
    """Cards of a file, with the file's numbers of nodes and elements, collected until the whole file is read."""

    def __init__(self, names: Names) -> None:
        self.names = names
        self.elements: dict[int, tuple[str, IntArray, str]] = {}  # number -> type, nodes, line of the card
        self.properties: list[tuple[Card, IntArray]] = []  # card, elements
        self.equations: list[Equation] = []
        self.rigids: list[Callable[[], Rigid]] = []  # surfaces are known at the end
        self.means: list[Mean] = []
        self.weights: dict[str, tuple[IntArray, FloatArray]] = {}  # line of *DISTRIBUTING COUPLING -> nodes, weights
        self.coupling: Card | None = None

    def take_elements(self, line: str, kind: str, numbers: IntArray, nodes: IntArray) -> None:
        """Read elements of a type in `ELEMENTS`."""
        self.elements |= {int(number): (kind, row, line) for number, row in zip(numbers, nodes, strict=True)}

    def take(self, card: Card) -> None:
        """Read one card of `PROPERTIES` or `CONNECTIONS`."""
        for name in REFUSED:
            if name in card.parameters and not (name == "ELSET" and card.keyword in PROPERTIES):
                raise self.names.fault(card.line, f"*{card.keyword}: found {name}, which this program does not read")
        if card.keyword in PROPERTIES:
            self.properties.append((card, self.names.elements_of(card.parameters.get("ELSET", ""), card.line)))
            if card.keyword == "DISTRIBUTING COUPLING":
                self.weights[card.line] = self.weighted(card)
        elif card.keyword == "COUPLING":
            self.coupling = card
        elif card.keyword == "KINEMATIC COUPLING":
            for line, cells in self.rows(card):
                reach = self.span(line, cells[1:]) if cells[1:] else range(6)
                self.add_rigid(card, self.names.nodes_of(cells[0], line), tuple(reach))
        elif card.keyword == "RIGID BODY":
            name = card.parameters.get("NSET", card.parameters.get("TIE NSET", ""))
            self.add_rigid(card, self.names.nodes_of(name, card.line), tuple(range(6)))
        else:
            takers = {"DISTRIBUTING": self.take_distributing, "KINEMATIC": self.take_kinematic, "MPC": self.take_mpc}
            takers.get(card.keyword, self.take_equations)(card)

    @property
    def by_direction(self) -> bool:
        """Whether the card names single directions of nodes."""
        return bool(self.equations) or any(card.keyword == "SPRING" for card, _ in self.properties)

    def rows(self, card: Card) -> list[tuple[str, list[str]]]:
        """Data lines, split into cells."""
        return [(line, [cell.strip() for cell in text.rstrip(", ").split(",")]) for line, text in card.data]

    def number(self, line: str, cell: str) -> float:
        """A real number."""
        try:
            value = float(cell.upper().replace("D", "E"))
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            raise self.names.fault(line, f"found {cell!r}, expected a number")
        return value

    def component(self, line: str, cell: str) -> int:
        """A degree of freedom 1 to 6 as an index from 0."""
        if cell not in ("1", "2", "3", "4", "5", "6"):
            raise self.names.fault(line, f"found {cell!r}, expected a degree of freedom 1 to 6")
        return int(cell) - 1

    def span(self, line: str, cells: list[str]) -> range:
        """First and last degree of freedom."""
        ends = [self.component(line, cell) for cell in cells[:2]]
        return range(ends[0], ends[-1] + 1)

    def reference(self, card: Card) -> int:
        """The node given by REF NODE."""
        found = self.names.nodes_of(card.parameters.get("REF NODE", ""), card.line)
        if len(found) != 1:
            raise self.names.fault(card.line, f"*{card.keyword}: found {len(found)} nodes as REF NODE, expected one")
        return int(found[0])

    def add_rigid(self, card: Card, nodes: IntArray, components: tuple[int, ...]) -> None:
        """Add nodes that follow the card's reference node."""
        reference = self.reference(card)
        followers = np.setdiff1d(nodes, [reference])
        where = f"*{card.keyword} (line {card.line})"
        self.rigids.append(lambda: Rigid(reference=reference, nodes=followers, components=components, where=where))

    def coupled(self, card: Card) -> Card:
        """The *COUPLING before a card; each *COUPLING has one such card."""
        coupling, self.coupling = self.coupling, None
        if coupling is None:
            raise self.names.fault(card.line, f"found *{card.keyword} without *COUPLING, expected *COUPLING before it")
        return coupling

    def take_kinematic(self, card: Card) -> None:
        """Read *KINEMATIC of the *COUPLING before it: first and last degree of freedom a line; all without lines."""
        coupling = self.coupled(card)
        components = sorted({c for line, cells in self.rows(card) for c in self.span(line, cells)}) or range(6)
        reference, name = self.reference(coupling), coupling.parameters.get("SURFACE", "")

        def rigid() -> Rigid:
            nodes = np.setdiff1d(self.names.surface_nodes(name, coupling.line), [reference])
            where = f"*COUPLING (line {coupling.line})"
            return Rigid(reference=reference, nodes=nodes, components=tuple(components), where=where)

        self.rigids.append(rigid)

    def weighted(self, card: Card) -> tuple[IntArray, FloatArray]:
        """Lines with a node or node set and its weight."""
        nodes, weights = [], []
        for line, cells in self.rows(card):
            nodes.append(self.names.nodes_of(cells[0], line))
            weight = self.number(line, cells[1]) if len(cells) > 1 else 1.0
            if weight <= 0.0:
                raise self.names.fault(line, f"*{card.keyword}: found the weight {weight:g}, expected one above 0")
            weights.append(np.full(len(nodes[-1]), weight))
        if not nodes:
            raise self.names.fault(card.line, f"*{card.keyword}: found no nodes, expected one or more")
        return np.concatenate(nodes), np.concatenate(weights)

    def take_distributing(self, card: Card) -> None:
        """Read *DISTRIBUTING of the *COUPLING before it; all nodes have equal weight."""
        coupling = self.coupled(card)
        nodes = self.names.node_surface(coupling.parameters.get("SURFACE", ""))
        if nodes is None:
            self.names.leave_out("DISTRIBUTING on a surface of elements", card.line)
            return
        if card.parameters.get("WEIGHTING METHOD", "UNIFORM").upper() != "UNIFORM" or card.data:
            found = "a weighting method or degrees of freedom"
            raise self.names.fault(card.line, f"*DISTRIBUTING: found {found}, expected neither")
        where, reference = f"*COUPLING (line {coupling.line})", self.reference(coupling)
        self.means.append(Mean(reference=reference, nodes=nodes, weights=np.ones(len(nodes)), where=where))

    def take_mpc(self, card: Card) -> None:
        """Read *MPC: kind, the following node, the node that it follows."""
        for line, cells in self.rows(card):
            if cells[0].upper() not in MPCS or len(cells) != 3:
                known = ", ".join(MPCS)
                raise self.names.fault(line, f"*MPC: found {', '.join(cells)}, expected a kind ({known}) and two nodes")
            first, other = (self.names.nodes_of(cell, line) for cell in cells[1:])
            for node, reference in zip(first, np.broadcast_to(other, first.shape), strict=True):
                self.take_pair(line, cells[0].upper(), int(node), int(reference))

    def take_pair(self, line: str, kind: str, node: int, reference: int) -> None:
        """Make one node follow another, as a rigid connection (BEAM) or with equal displacements (PIN)."""
        where = f"*MPC {kind} (line {line})"
        if kind == "BEAM":
            self.rigids.append(lambda: Rigid(reference=reference, nodes=np.array([node]), where=where))
            return
        pairs = ((Term(node, c, 1.0), Term(reference, c, -1.0)) for c in range(3))
        self.equations += [Equation(terms=pair, where=where) for pair in pairs]

    def take_equations(self, card: Card) -> None:
        """Read *EQUATION: the number of terms, then node, degree of freedom and coefficient of each.

        Later lines may have further equations.
        """
        rows = self.rows(card)
        while rows:
            (line, head), rows = rows[0], rows[1:]
            count = int(self.number(line, head[0]))
            cells: list[str] = []
            while rows and len(cells) < 3 * count:
                cells, rows = cells + rows[0][1], rows[1:]
            if count < 2 or len(cells) != 3 * count:
                found = f"*EQUATION: found {len(cells)} cells, expected 3 for each of {count} terms"
                raise self.names.fault(line, found)
            terms = []
            for k in range(0, len(cells), 3):
                nodes = self.names.nodes_of(cells[k], line)
                if len(nodes) != 1:
                    raise self.names.fault(line, f"*EQUATION: found {len(nodes)} nodes in {cells[k]!r}, expected one")
                terms.append(Term(int(nodes[0]), self.component(line, cells[k + 1]), self.number(line, cells[k + 2])))
            self.equations.append(Equation(terms=tuple(terms), where=f"*EQUATION (line {line})"))

    def attachments(self, points: FloatArray, index: Callable[[IntArray], IntArray]) -> Attachments:
        """All attachments, with indices of nodes."""
        masses, springs = list[PointMass](), list[Spring]()
        means, owned = list(self.means), set[int]()
        for card, numbers in self.properties:
            for number in numbers.tolist():
                if number not in self.elements or self.elements[number][0] not in PROPERTIES[card.keyword]:
                    expected = " or ".join(PROPERTIES[card.keyword])
                    text = f"*{card.keyword}: found element {number} of another type, expected {expected}"
                    raise self.names.fault(card.line, text)
                kind, nodes, _ = self.elements[number]
                owned.add(number)
                where = f"{kind} {number} (line {card.line})"
                if kind == "DCOUP3D":
                    followed, weights = self.weights[card.line]
                    means.append(Mean(reference=int(nodes[0]), nodes=followed, weights=weights, where=where))
                elif kind in ("MASS", "ROTARYI"):
                    masses.append(self.point_mass(card, int(nodes[0]), where))
                else:
                    springs.append(self.spring(card, kind, nodes, points[index(nodes)], where))
        if missing := sorted(set(self.elements) - owned):
            kind, _, line = self.elements[missing[0]]
            needed = next(key for key, kinds in PROPERTIES.items() if kind in kinds)
            text = f"found element {missing[0]} of type {kind} without a property, expected *{needed} for it"
            raise self.names.fault(line, text)
        found = Attachments(
            masses=tuple(masses),
            springs=tuple(springs),
            rigids=tuple(make() for make in self.rigids),
            means=tuple(means),
            equations=tuple(self.equations),
        )
        return found.renumbered(index)

    def point_mass(self, card: Card, node: int, where: str) -> PointMass:
        """*MASS: m; *ROTARY INERTIA: I11, I22, I33."""
        line, cells = (self.rows(card) or [(card.line, [""])])[0]
        values = [self.number(line, cell) for cell in cells if cell]
        if card.parameters.get("TYPE", "ISOTROPIC").upper() != "ISOTROPIC" or not values or min(values) < 0.0:
            raise self.names.fault(line, f"*{card.keyword}: found {', '.join(cells)}, expected numbers of 0 or more")
        if card.keyword == "MASS":
            return PointMass(node=node, mass=values[0], where=where)
        if len(values) < 3 or any(values[3:]):
            found = f"*ROTARY INERTIA: found {', '.join(cells)}, expected I11, I22, I33 alone (no I12, I13, I23)"
            raise self.names.fault(line, found)
        return PointMass(node=node, mass=0.0, inertia=np.diag(values[:3]), where=where)

    def spring(self, card: Card, kind: str, nodes: IntArray, places: FloatArray, where: str) -> Spring:
        """*SPRING: degrees of freedom (SPRING1, SPRING2), then the stiffness."""
        rows = self.rows(card)
        if len(rows) != (1 if kind == "SPRINGA" else 2):
            expected = "1 (the stiffness)" if kind == "SPRINGA" else "2 (degrees of freedom, then the stiffness)"
            raise self.names.fault(card.line, f"*SPRING: found {len(rows)} data lines, expected {expected}")
        line, cells = rows[-1]
        stiffness = self.number(line, cells[0])
        if stiffness <= 0.0:
            raise self.names.fault(line, f"*SPRING: found the stiffness {stiffness:g}, expected one above 0")
        if kind != "SPRINGA":
            along = [self.component(rows[0][0], cell) for cell in rows[0][1][: len(nodes)]]
            if len(along) != len(nodes) or len({c > 2 for c in along}) > 1:
                found = f"*SPRING: found the degrees of freedom {', '.join(rows[0][1])}"
                expected = f"expected {len(nodes)}, all displacements (1 to 3) or all rotations (4 to 6)"
                raise self.names.fault(rows[0][0], f"{found}, {expected}")
            signs = zip(nodes.tolist(), along, (1.0, -1.0), strict=False)
            return Spring(terms=tuple(Term(*term) for term in signs), stiffness=stiffness, where=where)
        axis = places[1] - places[0]
        length = float(np.linalg.norm(axis))
        if not length > 0.0:
            which = where.removesuffix(f" (line {card.line})")
            raise self.names.fault(
                card.line, f"{which}: found two nodes at one place, expected a distance between them"
            )
        ends = zip(nodes.tolist(), (1.0, -1.0), strict=True)
        terms = [Term(node, c, sign * float(axis[c] / length)) for node, sign in ends for c in range(3) if axis[c]]
        return Spring(terms=tuple(terms), stiffness=stiffness, where=where)
