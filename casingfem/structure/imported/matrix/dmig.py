"""Nastran's DMIG cards, of punch and bulk data files: matrices by node and component, with the grids beside them.

DMIG, NAME, 0, IFO, TIN, TOUT, POLAR, , NCOL          the header: IFO 1 square, 6 symmetric
DMIG, NAME, GJ, CJ, , G1, C1, A1, B1, G2, C2, A2, B2  a column: node, component, and the entries of rows G, C
"""

from pathlib import Path

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.io.included import read_lines
from casingfem.structure.imported.matrix.matrix_set import OF_A_SET, MatrixSet, from_triples, roles_of
from casingfem.structure.imported.readers.bdf import Parser
from casingfem.structure.imported.readers.bdf_cards import Card, cards

Entry = tuple[int, int, int, int, float]  # column's node and component, row's node and component, value
SQUARE, RECTANGULAR, REAL, COMPLEX = ("1", "6"), ("2", "9"), ("1", "2"), ("3", "4")


def read_dmig(path: Path) -> MatrixSet:
    """K, M and C of a file with DMIG cards; points from its GRID cards.

    Raises
    ------
    ModelError
        With the line, for cards that cannot be read: complex or rectangular matrices, missing fields.
    """
    parser = Parser(path.name)
    entries: dict[str, list[Entry]] = {}
    symmetric: set[str] = set()
    others: set[str] = set()
    points: dict[int, FloatArray] = {}
    for card in cards(read_lines(path)):
        if card.name == "GRID":
            parser.take_grid(card)
            number, *x = parser.grids[-1]
            points[number] = np.array(x)
        elif card.name == "DMIG":
            take(parser, card, entries, symmetric, others)
    roles = roles_of(list(entries), path.name)
    known = {dof for name in roles.values() for entry in entries[name] for dof in (entry[:2], entry[2:4])}
    dofs = sorted(known, key=lambda dof: (dof[1] == 0, dof))  # scalars last, as in a Craig-Bampton set
    place = {dof: k for k, dof in enumerate(dofs)}
    matrices = {}
    for role, name in roles.items():
        table = entries[name]
        columns = np.array([place[entry[:2]] for entry in table])
        rows = np.array([place[entry[2:4]] for entry in table])
        values = np.array([entry[4] for entry in table])
        matrices[role] = from_triples(rows, columns, values, len(dofs), symmetric=name in symmetric)
    return MatrixSet(
        K=matrices["K"], M=matrices["M"], C=matrices.get("C"), dofs=np.array(dofs), points=points, source=path.name
    )


def take(parser: Parser, card: Card, entries: dict[str, list[Entry]], symmetric: set[str], others: set[str]) -> None:
    """One DMIG card: its header, or a column; loads and recovery matrices are passed over by their names."""
    fields = card.fields
    if len(fields) < 3:
        raise parser.fault(card, f"found {len(fields)} fields, expected a name, a node and a component")
    name = fields[0].upper()
    if fields[1] == "0" and name not in entries:
        form, kind = fields[2], (fields[3:4] or [""])[0]
        if (form in RECTANGULAR or kind in COMPLEX) and not OF_A_SET.fullmatch(name):
            others.add(name)
            return
        if form not in SQUARE or kind not in REAL:
            found = f"{name} of form {form} and type {kind}"
            raise parser.fault(card, f"found {found}, expected form 1 or 6 (square), type 1 or 2 (real)")
        entries[name] = []
        if form == "6":
            symmetric.add(name)
        return
    if name in others:
        return
    if name not in entries:
        raise parser.fault(card, f"found a column of {name} before its header")
    node, component = parser.integer(card, fields[1]), parser.integer(card, fields[2] or "0")
    for k in range(4, len(fields), 4):
        row = fields[k : k + 4]
        if not any(row):
            continue
        if len(row) < 3 or not row[0] or not row[2]:
            raise parser.fault(card, f"found {', '.join(row)}, expected node, component and value of a row")
        value = parser.real(card, row[2])
        entries[name].append(
            (node, component, parser.integer(card, row[0]), parser.integer(card, row[1] or "0"), value)
        )
