"""Read matrices of any format, the ending tells which; those of Nastran's DMIG cards, by node and component, here.

DMIG, NAME, 0, IFO, TIN, TOUT, POLAR, , NCOL          the header: IFO 1 square, 6 symmetric
DMIG, NAME, GJ, CJ, , G1, C1, A1, B1, G2, C2, A2, B2  a column: node, component, and the entries of rows G, C
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from casingfem.errors import InputError, ModelError
from casingfem.io import strict_csv
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.io.included import read_lines
from casingfem.structure.imported.matrix.arrays import read_arrays
from casingfem.structure.imported.matrix.matrix_set import OF_A_SET, MatrixSet, from_triples, roles_of
from casingfem.structure.imported.matrix.op4 import read_op4
from casingfem.structure.imported.matrix.text import read_calculix, read_mtx_pair
from casingfem.structure.imported.readers.bdf import Parser
from casingfem.structure.imported.readers.bdf_cards import Card, cards

DMIG = (".pch", ".bdf", ".dmig", ".dat")
ARRAYS = (".npz", ".mat", ".h5", ".hdf5")
CALCULIX = (".sti", ".mas", ".dof")
ENDINGS = (*DMIG, ".op4", ".mtx", *CALCULIX, *ARRAYS)
DIRECTIONS = {"q": 0, "x": 1, "y": 2, "z": 3, "rx": 4, "ry": 5, "rz": 6} | {str(k): k for k in range(7)}


def read_matrices(
    paths: str | Path | Sequence[str | Path], *, nodes: str | Path | None = None, dofs: str | Path | None = None
) -> MatrixSet:
    """Read K, M and maybe C of a part, in the file's own units.

    Parameters
    ----------
    paths
        One file of DMIG cards (.pch, .bdf), OP4, CalculiX (.sti, .mas and .dof side by side), .mat, HDF5 or npz, or
        the .mtx files of K, M and maybe C.
    nodes
        A table with the columns node, x, y, z.
    dofs
        A table with the columns node, direction (x, y, z, rx, ry, rz, q, or 1 to 6 and 0), a line for each row of the
        matrices; for formats that do not say it.

    Raises
    ------
    ModelError
        `matrix-file`, `matrix-names`, `matrix-dofs`, `matrix-size`: what the files lack, with the line where it is one.
    """
    files = [Path(path) for path in ([paths] if isinstance(paths, str | Path) else paths)]
    endings = {file.suffix.lower() for file in files}
    rows = None if dofs is None else read_dofs(Path(dofs))
    if len(endings) != 1 or not endings <= set(ENDINGS) or (len(files) > 1 and endings != {".mtx"}):
        found = ", ".join(file.name for file in files) or "no file"
        raise ModelError("matrix-format", f"found {found}")
    first, ending = files[0], endings.pop()
    if ending in DMIG:
        found_set = read_dmig(first)
    elif ending in CALCULIX:
        found_set = read_calculix(first)
    elif ending == ".mtx":
        found_set = read_mtx_pair(files, rows)
    elif ending == ".op4":
        found_set = of_op4(first, rows)
    else:
        found_set = read_arrays(first, rows)
    if nodes is None:
        return found_set
    return replace(found_set, points={**found_set.points, **read_nodes(Path(nodes))})


def of_op4(path: Path, dofs: IntArray | None) -> MatrixSet:
    """K, M and C of an OP4 file, which does not say what its rows are."""
    matrices = read_op4(path)
    roles = roles_of([name for name, A in matrices.items() if A.shape[0] == A.shape[1]], path.name)
    if dofs is None:
        raise ModelError("matrix-dofs", f"{path.name}: an OP4 file has no dofs")
    return MatrixSet(**{role: matrices[name] for role, name in roles.items()}, dofs=dofs, source=path.name)


def read_nodes(path: Path) -> dict[int, FloatArray]:
    """Positions of nodes, from a table node, x, y, z."""
    table = table_with(path, ("node", "x", "y", "z"))
    numbers = table.integers("node")
    values, first = np.unique(numbers, return_index=True)
    if len(values) < len(numbers):
        again = int(np.setdiff1d(np.arange(len(numbers)), first)[0])
        raise table.refuse(row=again, column="node", found=f"node {numbers[again]} again", expected="each once")
    return dict(zip(numbers.tolist(), np.stack([table.numbers(axis) for axis in "xyz"], axis=1), strict=True))


def read_dofs(path: Path) -> IntArray:
    """Node and direction of each row, from a table node, direction, (n, 2)."""
    table = table_with(path, ("node", "direction"))
    rows = []
    for k, (node, word) in enumerate(zip(table.cells["node"], table.cells["direction"], strict=True)):
        direction = DIRECTIONS.get(word.strip().lower())
        if direction is None or not node.strip().isdecimal():
            raise table.refuse(row=k, found=f"{node}, {word}", expected=f"a node, and {', '.join(DIRECTIONS)}")
        rows.append((int(node), direction))
    return np.array(rows, dtype=np.int64)


def table_with(path: Path, columns: tuple[str, ...]) -> strict_csv.StrictCsv:
    """A table that has some columns."""
    table = strict_csv.read(path)
    if missing := [name for name in columns if name not in table.header]:
        found, expected = f"no column {', '.join(missing)}", f"columns {', '.join(columns)}"
        raise InputError(str(path), line=table.header_line, found=found, expected=expected)
    return table


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
    symmetric, others = set[str](), set[str]()
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
    return MatrixSet(**matrices, dofs=np.array(dofs), points=points, source=path.name)


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
        value, at = parser.real(card, row[2]), parser.integer(card, row[0])
        entries[name].append((node, component, at, parser.integer(card, row[1] or "0"), value))
