"""Matrices of Nastran's DMIG cards, by node and component.

DMIG, NAME, 0, IFO, TIN, TOUT, POLAR, , NCOL          the header: IFO 1 square, 6 symmetric
DMIG, NAME, GJ, CJ, , G1, C1, A1, B1, G2, C2, A2, B2  a column: node, component, and the entries of rows G, C
"""

import numpy as np
from scipy.sparse import csc_array

from casingfem.io.arrays import IntArray
from casingfem.structure.imported.matrix.matrix_set import from_triples, is_part
from casingfem.structure.imported.readers.bdf import Parser
from casingfem.structure.imported.readers.bdf_cards import Card

Entry = tuple[int, int, int, int, float]  # column's node and component, row's node and component, value
SQUARE, RECTANGULAR, REAL, COMPLEX = ("1", "6"), ("2", "9"), ("1", "2"), ("3", "4")


class Dmig:
    """The DMIG cards of a file, added one by one."""

    def __init__(self, parser: Parser) -> None:
        self.parser = parser
        self.entries: dict[str, list[Entry]] = {}
        self.symmetric: set[str] = set()
        self.others: set[str] = set()  # rectangular and complex ones

    @property
    def names(self) -> list[str]:
        """Names of the square real matrices."""
        return list(self.entries)

    def take(self, card: Card) -> None:
        """Add one card, a header or a column; loads and recovery matrices are skipped by their names."""
        parser, fields = self.parser, card.fields
        if len(fields) < 3:
            raise parser.fault(card, f"found {len(fields)} fields, expected a name, a node and a component")
        name = fields[0].upper()
        if fields[1] == "0" and name not in self.entries:
            self.take_header(card, name)
            return
        if name in self.others:
            return
        if name not in self.entries:
            raise parser.fault(
                card, f"found a column of {name} before its header, expected the header (DMIG {name} 0 ...) first"
            )
        node, component = parser.integer(card, fields[1]), parser.integer(card, fields[2] or "0")
        for k in range(4, len(fields), 4):
            row = fields[k : k + 4]
            if not any(row):
                continue
            if len(row) < 3 or not row[0] or not row[2]:
                raise parser.fault(card, f"found {', '.join(row)}, expected node, component and value of a row")
            value, at = parser.real(card, row[2]), parser.integer(card, row[0])
            self.entries[name].append((node, component, at, parser.integer(card, row[1] or "0"), value))

    def take_header(self, card: Card, name: str) -> None:
        """A header: form, and type of the numbers."""
        form, kind = card.fields[2], (card.fields[3:4] or [""])[0]
        if (form in RECTANGULAR or kind in COMPLEX) and not is_part(name):
            self.others.add(name)
            return
        if form not in SQUARE or kind not in REAL:
            found = f"{name} of form {form} and type {kind}"
            raise self.parser.fault(card, f"found {found}, expected form 1 or 6 (square), type 1 or 2 (real)")
        self.entries[name] = []
        if form == "6":
            self.symmetric.add(name)

    def matrices(self, roles: dict[str, str]) -> tuple[dict[str, csc_array], IntArray]:
        """Matrices by role, and the dofs of their rows (n, 2): scalars last, as in a Craig-Bampton set."""
        known = {dof for name in roles.values() for entry in self.entries[name] for dof in (entry[:2], entry[2:4])}
        dofs = sorted(known, key=lambda dof: (dof[1] == 0, dof))
        place = {dof: k for k, dof in enumerate(dofs)}
        matrices = {}
        for role, name in roles.items():
            table = self.entries[name]
            columns = np.array([place[entry[:2]] for entry in table], dtype=np.int64)
            rows = np.array([place[entry[2:4]] for entry in table], dtype=np.int64)
            values = np.array([entry[4] for entry in table], dtype=float)
            matrices[role] = from_triples(rows, columns, values, len(dofs), symmetric=name in self.symmetric)
        return matrices, np.array(dofs, dtype=np.int64).reshape(-1, 2)
