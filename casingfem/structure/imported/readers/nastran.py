"""Point masses, springs and connections of a Nastran bulk data file (MSC Nastran Quick Reference Guide).

CONM2; CELAS1, CELAS2 with PELAS; CBUSH with PBUSH (`nastran_cards.py`); RBE2, RBE3, RBAR; one set of MPC; PARAM WTMASS.
Unsupported variants are refused with card and line.
"""

import re
from collections.abc import Callable, Mapping

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.mesh.attachments import Attachments, Equation, Mean, PointMass, Rigid, Spring, Term
from casingfem.structure.imported.readers.bdf_cards import Card
from casingfem.structure.imported.readers.nastran_cards import NastranCards, bush_springs

WHOLE = ({0, 1, 2}, {3, 4, 5}, {0, 1, 2, 3, 4, 5})  # components that mean the same in every system of coordinates
ROUND = 1e-12  # components of a unit vector that are round-off
LEFT_OUT = re.compile(
    r"C(?!ORD|OORD|SET|REEP|LOAD|AERO|HBDY|ONV|SUPER|SCHD|SLOT|TABLE|YJOIN|YAX|YSYM|YSUP)"
    r"|RBE|RROD|RTRPLT|RSPLINE|RSSCON|RJOINT|MPC|NSM|DMIG|GENEL|SPOINT|EPOINT"
)  # other cards with stiffness, mass or constraints


class NastranAttachments(NastranCards):
    """Attachments from the cards of a file, made after the whole file is read."""

    def attachments(
        self, points: FloatArray, index: Callable[[IntArray], IntArray], turned: Mapping[int, int]
    ) -> Attachments:
        """All attachments, with indices of nodes.

        `turned` maps grids whose displacements have another coordinate system to its number.
        """
        self.turned, self.points, self.index = turned, points, index
        scale = self.mass_factor()
        masses = tuple(self.point_mass(card, scale) for card in self.cards["CONM2"])
        cards = [card for name in ("CELAS1", "CELAS2") for card in self.cards[name] if not self.is_scalar(card)]
        springs = [self.spring(card, self.pelas()) for card in cards]
        springs += [spring for card in self.cards["CBUSH"] for spring in bush_springs(self, card)]
        rigids = [self.rigid(card) for card in self.cards["RBE2"]] + [self.bar(card) for card in self.cards["RBAR"]]
        means, equations = tuple(self.mean(card) for card in self.cards["RBE3"]), self.equations()
        rigid, elastic = tuple(rigids), tuple(springs)
        given = Attachments(masses=masses, springs=elastic, rigids=rigid, means=means, equations=equations)
        return given.renumbered(index)

    def components(self, card: Card, text: str) -> tuple[int, ...]:
        """Components such as 123 as indices from 0."""
        if not text or not set(text) <= set("123456") or len(set(text)) < len(text):
            raise self.numbers.fault(card, f"found the components {text!r}, expected some of 123456")
        return tuple(sorted(int(digit) - 1 for digit in text))

    def grid(self, card: Card, text: str, components: tuple[int, ...]) -> int:
        """A grid; refused if a card uses single components of it and these are along other axes."""
        grid = self.numbers.integer(card, text)
        if grid in self.turned and set(components) not in WHOLE:
            found = f"found single components of grid {grid}, which has its own displacement system (CD)"
            raise self.numbers.fault(card, f"{found}, expected 123, 456 or 123456")
        return grid

    def mass_factor(self) -> float:
        """PARAM, WTMASS: factor of all masses."""
        given = [card for card in self.cards["PARAM"] if self.field(card, 0).upper() == "WTMASS"]
        return [1.0, *(self.numbers.real(card, self.field(card, 1)) for card in given)][-1]

    def point_mass(self, card: Card, scale: float) -> PointMass:
        """CONM2: number, grid, system, mass, offset, then I11, I21, I22, I31, I32, I33."""
        real = [self.numbers.real(card, self.field(card, place)) for place in (3, 4, 5, 6, *range(8, 14))]
        mass, x, y, z, i11, i21, i22, i31, i32, i33 = real
        inertia = scale * np.array([[i11, -i21, -i31], [-i21, i22, -i32], [-i31, -i32, i33]])
        node = self.numbers.integer(card, self.field(card, 1))
        if (system := self.field(card, 2)) == "-1":  # the centre itself, in the basic system
            x, y, z = np.array([x, y, z]) - self.place(node)
        elif system not in ("", "0") and (any((x, y, z)) or inertia.any()):
            axes = self.systems.axes(card, self.numbers.integer(card, system), self.place(node))
            inertia = axes.T @ inertia @ axes
            x, y, z = np.array([x, y, z]) @ axes
        if mass < 0.0 or np.linalg.eigvalsh(inertia)[0] < -1e-9 * inertia.max():
            found = (
                f"found the mass {mass:g}" if mass < 0.0 else "found moments of inertia with a negative principal value"
            )
            raise self.numbers.fault(card, f"{found}, expected 0 or more")
        offset = (float(x), float(y), float(z))
        return PointMass(node=node, mass=scale * mass, inertia=inertia, offset=offset, where=self.where(card))

    def pelas(self) -> dict[int, float]:
        """Stiffness of each PELAS, two on a card."""
        given = [(card, k) for card in self.cards["PELAS"] for k in (0, 4) if self.field(card, k)]
        integer, real = self.numbers.integer, self.numbers.real
        return {integer(card, card.fields[k]): real(card, self.field(card, k + 1)) for card, k in given}

    def is_scalar(self, card: Card) -> bool:
        """Whether an end of a spring is a scalar point, component 0; such springs are skipped."""
        scalar = any(self.field(card, k) not in ("", "0") and self.field(card, k + 1) in ("", "0") for k in (2, 4))
        if scalar:
            self.numbers.leave_out(card, f"{card.name} at scalar points")
        return scalar

    def spring(self, card: Card, stiffness: dict[int, float]) -> Spring:
        """Read CELAS1: number, property, grid, component, grid, component; CELAS2 has a stiffness as property."""
        if card.name == "CELAS2":
            k = self.numbers.real(card, self.field(card, 1))
        else:
            owner = self.numbers.integer(card, self.field(card, 1) or self.field(card, 0))
            if owner not in stiffness:
                raise self.numbers.fault(card, f"found the property {owner} without a PELAS card, expected one")
            k = stiffness[owner]
        ends = [place for place in (2, 4) if self.field(card, place) not in ("", "0")]
        terms = tuple(term for j, place in enumerate(ends) for term in self.terms(card, place, 1.0 - 2.0 * j))
        if not terms:
            raise self.numbers.fault(card, "found no grid, expected one or two")
        if len({term.component > 2 for term in terms}) > 1:
            found = "found a spring between a displacement and a rotation"
            raise self.numbers.fault(card, f"{found}, expected two displacements or two rotations")
        return Spring(terms=terms, stiffness=self.positive(card, k), where=self.where(card))

    def terms(self, card: Card, place: int, coefficient: float) -> tuple[Term, ...]:
        """A grid and component as terms along the axes of the grid's own system; the largest term first."""
        components = self.components(card, self.field(card, place + 1))
        if len(components) > 1:
            raise self.numbers.fault(card, f"found the components {self.field(card, place + 1)}, expected one")
        grid, (component,) = self.numbers.integer(card, self.field(card, place)), components
        if grid not in self.turned:
            return (Term(grid, component, coefficient),)
        along = self.systems.axes(card, self.turned[grid], self.place(grid))[component % 3]
        first = component - component % 3
        order = np.argsort(-np.abs(along), kind="stable").tolist()
        return tuple(Term(grid, first + k, coefficient * float(along[k])) for k in order if abs(along[k]) > ROUND)

    def rigid(self, card: Card) -> Rigid:
        """Read RBE2: number, reference, components, grids, and optionally a thermal expansion."""
        components = self.components(card, self.field(card, 2))
        given = [text for text in card.fields[3:] if text]
        grids = [text for text in given if text.isdecimal()]
        if not set(given[:-1]) <= set(grids):  # the last may be a thermal expansion
            found = f"found {', '.join(sorted(set(given) - set(grids)))}"
            raise self.numbers.fault(card, f"{found}, expected the numbers of all grids, without THRU")
        if not grids:
            raise self.numbers.fault(card, "found no dependent grid, expected one or more")
        nodes = np.array([self.grid(card, text, components) for text in grids], dtype=np.int64)
        reference = self.numbers.integer(card, self.field(card, 1))
        return Rigid(reference=reference, nodes=nodes, components=components, where=self.where(card))

    def bar(self, card: Card) -> Rigid:
        """RBAR: number, grids A and B, independent components of each, dependent ones of each."""
        a, b, of_a, of_b, by_a, by_b = (self.field(card, place) for place in range(1, 7))
        if of_b == "123456" and not of_a:
            a, b, of_a, of_b, by_b = b, a, of_b, of_a, by_a
        if of_a != "123456" or of_b:
            raise self.numbers.fault(card, "found independent components at both ends, expected 123456 at one end")
        components = self.components(card, by_b or "123456")
        nodes = np.array([self.grid(card, b, components)])
        reference = self.numbers.integer(card, a)
        return Rigid(reference=reference, nodes=nodes, components=components, where=self.where(card))

    def mean(self, card: Card) -> Mean:
        """RBE3: number, -, reference, components, then groups of a weight, components and grids."""
        components = self.components(card, self.field(card, 3))
        weights, grids = list[float](), list[int]()
        rest = [text for text in card.fields[4:] if text]
        weight, place = 0.0, 0
        while place < len(rest) and (text := rest[place]).upper() != "ALPHA":
            if text[0].isalpha():
                raise self.numbers.fault(card, f"found {text}, expected weights, components and grids")
            if not text.isdecimal():  # a real number begins a group
                weight = self.positive(card, self.numbers.real(card, text))
                if rest[place + 1 : place + 2] != ["123"]:
                    found = f"found the components {', '.join(rest[place + 1 : place + 2]) or 'none'}"
                    raise self.numbers.fault(card, f"{found}, expected 123")
                place += 2
                continue
            if not weight:
                raise self.numbers.fault(card, f"found {text}, expected a weight such as 1.0")
            weights.append(weight)
            grids.append(self.numbers.integer(card, text))
            place += 1
        if not grids:
            raise self.numbers.fault(card, "found no grid with a weight, expected one or more")
        reference, where = self.grid(card, self.field(card, 2), components), self.where(card)
        nodes, shares = np.array(grids, dtype=np.int64), np.array(weights)
        return Mean(reference=reference, nodes=nodes, weights=shares, components=components, where=where)

    def equations(self) -> tuple[Equation, ...]:
        """MPC: set, then grid, component, coefficient, two on each line."""
        found = []
        for card in self.cards["MPC"]:
            if self.field(card, 0) != self.field(self.cards["MPC"][0], 0):
                raise self.numbers.fault(
                    card, "found MPC cards of a second set, expected one set: none is selected here"
                )
            places = [k + j for k in range(0, len(card.fields), 8) for j in (1, 4) if self.field(card, k + j)]
            parts = [self.terms(card, k, self.numbers.real(card, self.field(card, k + 2))) for k in places]
            if len(parts) < 2:
                raise self.numbers.fault(card, f"found {len(parts)} terms, expected two or more")
            terms = tuple(term for part in parts for term in part)
            found.append(Equation(terms=terms, where=self.where(card)))
        return tuple(found)
