"""Matrices as lists of entries: Matrix Market, Abaqus's .mtx, CalculiX's .sti, .mas and .dof."""

from pathlib import Path

import numpy as np
from scipy.sparse import coo_array, csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.matrix.matrix_set import MatrixSet, fault, from_triples, roles_of
from contact.io.infiles import read_bytes, read_loose_text

KINDS = {"coordinate": ("general", "symmetric", "skew-symmetric"), "array": ("general", "symmetric")}
MOST = 10**8  # rows
PLAIN = str.maketrans(",Dd", " Ee")  # blanks between numbers, exponents as Python has them
MOST_NUMBER = 1e15  # of a node: beyond, a float does not distinguish them
Labelled = tuple[csc_array, IntArray | None]  # a matrix, and what its rows are where the file states it


def numbers(path: Path, columns: int) -> FloatArray:
    """A table (rows, columns) of numbers separated by commas or blanks; lines from `*` or `%` are skipped."""
    given = read_loose_text(path).splitlines()
    lines = [line.translate(PLAIN) for line in given if line.strip() and line.lstrip()[0] not in "*%#"]
    try:
        table = np.loadtxt(lines, ndmin=2) if lines else np.zeros((0, columns))
    except ValueError as error:
        raise fault(path.name, str(error)) from None
    if table.shape[1] != columns:
        raise fault(path.name, f"found {table.shape[1]} columns, expected {columns}")
    return np.asarray(table)


def whole(table: FloatArray, path: Path) -> IntArray:
    """Columns as integers."""
    if not (np.isfinite(table).all() and np.all(np.abs(table) < MOST_NUMBER)) or np.any(table % 1.0):
        raise fault(path.name, "found rows or nodes that are not whole numbers")
    return table.astype(np.int64)


def read_mtx(path: Path) -> Labelled:
    """A matrix of a .mtx file, Matrix Market's or Abaqus's (node, dof, node, dof, value a line)."""
    if read_bytes(path)[:14] == b"%%MatrixMarket":
        return read_market(path), None
    table = numbers(path, 5)
    dofs, place = np.unique(whole(table[:, :4], path).reshape(-1, 2, 2).reshape(-1, 2), axis=0, return_inverse=True)
    rows, columns = place.ravel().reshape(-1, 2).T
    return from_triples(rows, columns, table[:, 4], len(dofs)), dofs


def read_market(path: Path) -> csc_array:
    """A real matrix of Matrix Market, read line by line: scipy's reader crashes on some truncated files.

    Raises
    ------
    ModelError
        `matrix-file` for another kind of matrix, entries outside of it, or fewer or more than announced.
    """
    head = read_loose_text(path).partition("\n")[0].lower().split()
    shaped = len(head) == 5 and head[1] == "matrix" and head[2] in ("coordinate", "array")
    if not shaped or head[3] not in ("real", "integer") or head[4] not in KINDS[head[2]]:
        found = " ".join(head[1:]) or "no kind"
        kinds = "real, general or symmetric, or skew-symmetric by coordinates"
        raise fault(path.name, f"found {found}, expected matrix coordinate or array, {kinds}")
    if head[2] == "array":
        return dense_market(path, symmetric=head[4] == "symmetric")
    table = numbers(path, 3)
    if not len(table):
        raise fault(path.name, "found no line with the numbers of rows, columns and entries: cut short?")
    size, columns, count = whole(table[0], path).tolist()
    entries = table[1:]
    check_square(path, size, columns)
    check_count(path, len(entries), count)
    places = whole(entries[:, :2], path) - 1
    if count and not (places.min() >= 0 and places.max() < size):
        raise fault(path.name, f"found an entry outside the matrix, expected rows and columns 1 to {size}")
    rows, columns = places.T
    A = coo_array((entries[:, 2], (rows, columns)), shape=(size, size))
    if head[4] == "general":
        return csc_array(A)
    if head[4] == "skew-symmetric":
        if np.any(columns >= rows):
            found = "found entries on or above the diagonal of a skew-symmetric matrix"
            raise fault(path.name, f"{found}, expected entries below it alone")
        return csc_array(A - A.T)
    if np.any(columns > rows):
        found = "found entries above the diagonal of a symmetric matrix"
        raise fault(path.name, f"{found}, expected entries on and below it alone")
    return from_triples(rows, columns, entries[:, 2], size)


def check_square(path: Path, rows: int, columns: int) -> None:
    """Refuse a matrix that is not square, empty or too large."""
    if rows != columns or not 0 < rows <= MOST:
        raise fault(path.name, f"found a matrix of {rows} x {columns}, expected a square one of 1 to {MOST} rows")


def check_count(path: Path, found: int, wanted: int) -> None:
    """Refuse fewer or more entries than a matrix has."""
    if found != wanted:
        short = ": cut short?" if found < wanted else ""
        raise fault(path.name, f"found {found} entries, expected {wanted}{short}")


def real(word: str, path: Path) -> float:
    """A real number, also with Fortran's exponent letter D."""
    try:
        return float(word.replace("D", "E").replace("d", "e"))
    except ValueError:
        raise fault(path.name, f"found {word!r}, expected a number") from None


def dense_market(path: Path, *, symmetric: bool) -> csc_array:
    """A matrix of Matrix Market in the form that gives every entry, column by column."""
    lines = read_loose_text(path).splitlines()[1:]
    words = " ".join(line for line in lines if not line.startswith("%")).split()
    if len(words) < 2 or not all(word.isdecimal() and len(word) < 16 for word in words[:2]):
        raise fault(path.name, f"found {' '.join(words[:2])[:60]!r}, expected the numbers of rows and columns")
    size, columns = (int(word) for word in words[:2])
    check_square(path, size, columns)
    check_count(path, len(words) - 2, size * (size + 1) // 2 if symmetric else size * size)
    values = np.array([real(word, path) for word in words[2:]])
    if not symmetric:
        return csc_array(values.reshape(size, size).T)
    A = np.zeros((size, size))
    A.T[np.triu_indices(size)] = values
    return csc_array(A + np.tril(A, -1).T)


def read_mtx_pair(paths: list[Path], dofs: IntArray | None) -> MatrixSet:
    """K, M and maybe C and K4 of .mtx files, distinguished by their names.

    The dofs come from the files or from a separate list.

    Raises
    ------
    ModelError
        `matrix-dofs` if neither the files nor a list state the dofs of the rows.
    """
    named = {path.stem: path for path in paths}
    source = ", ".join(path.name for path in paths)
    roles = roles_of(list(named), source)
    read = {role: read_mtx(named[name]) for role, name in roles.items()}
    if dofs is None and any(own is None for _, own in read.values()):
        beside = named[roles["K"]].with_suffix(".dof")
        if not beside.exists():
            raise ModelError("matrix-dofs", f"{source}: found no file {beside.name} beside them")
        dofs = read_dof(beside)
    K, wanted = labelled(read["K"], dofs)
    others = {role: aligned(*labelled(read[role], dofs), wanted, source) for role in read if role != "K"}
    return MatrixSet(K=K, M=others["M"], C=others.get("C"), K4=others.get("K4"), G=others.get("G"), dofs=wanted,
                     source=source)  # fmt: skip


def labelled(matrix: Labelled, dofs: IntArray | None) -> tuple[csc_array, IntArray]:
    """A matrix and the dofs of its rows, from its file or from the list of dofs."""
    A, own = matrix
    labels = own if own is not None else dofs
    assert labels is not None
    return A, labels


def aligned(A: csc_array, labels: IntArray, wanted: IntArray, source: str) -> csc_array:
    """A matrix with its rows in the order of another's."""
    if np.array_equal(labels, wanted):
        return A
    if A.shape[0] != len(labels):
        found = f"a mass or damping matrix of {A.shape[0]} rows, and {len(labels)} dofs"
        raise ModelError("matrix-size", f"{source}: found {found}")
    place = {tuple(dof): k for k, dof in enumerate(wanted.tolist())}
    missing = [tuple(dof) for dof in labels.tolist() if tuple(dof) not in place]
    if missing:
        node, direction = missing[0]
        found = f"found mass or damping but no stiffness at node {node}, direction {direction}"
        raise ModelError("matrix-size", f"{source}: {found}")
    rows = np.array([place[tuple(dof)] for dof in labels.tolist()])
    entries = A.tocoo()
    return csc_array((entries.data, (rows[entries.row], rows[entries.col])), shape=(len(wanted), len(wanted)))


def read_dof(path: Path) -> IntArray:
    """CalculiX's list of dofs, one `node.direction` on each line, as (n, 2)."""
    rows = []
    for number, line in enumerate(read_loose_text(path).split("\n"), 1):
        if not line.strip():
            continue
        node, point, direction = line.strip().partition(".")
        if not (point and node.isdecimal() and direction.isdecimal() and int(direction) <= 6):
            raise fault(path.name, f"line {number}: found {line.strip()!r}, expected node.direction, such as 6.1")
        rows.append((int(node), int(direction)))
    return np.array(rows, dtype=np.int64).reshape(-1, 2)


def read_calculix(path: Path) -> MatrixSet:
    """The matrices of SOLVER=MATRIXSTORAGE: NAME.sti, NAME.mas and NAME.dof, given the path of any of them."""
    parts = {suffix: path.with_suffix(suffix) for suffix in (".sti", ".mas", ".dof")}
    for part in parts.values():
        if not part.exists():
            raise fault(path.name, f"found no file {part.name} beside it, expected .sti, .mas and .dof together")
    dofs = read_dof(parts[".dof"])
    matrices = []
    for suffix in (".sti", ".mas"):
        table = numbers(parts[suffix], 3)
        places = whole(table[:, :2], parts[suffix]) - 1
        for outside in places[(places < 0) | (places >= len(dofs))][:1]:
            raise ModelError("matrix-size", f"{parts[suffix].name}: found row {outside + 1}, and {len(dofs)} dofs")
        matrices.append(from_triples(places[:, 0], places[:, 1], table[:, 2], len(dofs)))
    return MatrixSet(K=matrices[0], M=matrices[1], dofs=dofs, source=path.name)
