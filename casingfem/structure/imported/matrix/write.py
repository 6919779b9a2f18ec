"""Write matrices for other programs: Matrix Market, DMIG cards, OP4, npz, .mat; with tables of dofs and nodes."""

from collections.abc import Callable, Mapping
from io import BytesIO, StringIO
from pathlib import Path
from types import MappingProxyType

import numpy as np
from scipy.io import mmwrite, savemat
from scipy.sparse import csc_array, tril

from casingfem.errors import ModelError
from casingfem.structure.imported.matrix.arrays import to_columns
from casingfem.structure.imported.matrix.matrix_set import MatrixSet
from contact.io.npz import save_npz
from contact.io.outfiles import write_files

ROUND_OFF = 1e-13  # of the largest entry
NAMES = ("q", "x", "y", "z", "rx", "ry", "rz")


def write_matrices(path: str | Path, matrices: MatrixSet) -> list[Path]:
    """Write matrices in the format that the ending of the path names; returns the files.

    Parameters
    ----------
    path
        Ends in .pch (DMIG cards), .op4, .npz or .mat; .mtx gives one Matrix Market file a matrix, `part_K.mtx` and so
        on. OP4 and Matrix Market have tables of dofs and nodes beside them, which `read_matrices` takes.
    matrices
        As from `read_matrices`, `cf.modal.structure_matrices` or `cf.modal.basis_matrices`; in their own units.

    Raises
    ------
    ModelError
        `matrix-format` for another ending.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> two = cf.imported.MatrixSet(K=csc_array(np.eye(2)), M=csc_array(np.eye(2)), dofs=np.array([[7, 1], [7, 2]]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [file.name for file in cf.imported.write_matrices(f"{folder}/part.mtx", two)]
    ['part_K.mtx', 'part_M.mtx', 'part_dofs.csv', 'part_nodes.csv']
    """
    file = Path(path)
    form = file.suffix.lower().removeprefix(".")
    if form not in FORMS:
        raise ModelError("matrix-format", f"found {file.name}, expected a path that ends in .{', .'.join(FORMS)}")
    files = matrix_files(matrices, file.stem, form)
    write_files(file.parent, files)
    return [file.parent / name for name in sorted(files)]


def matrix_files(matrices: MatrixSet, stem: str, form: str) -> dict[str, str | bytes]:
    """Files by name, for `form` mtx, pch, op4, npz or mat.

    >>> two = MatrixSet(K=csc_array(np.eye(2)), M=csc_array(np.eye(2)), dofs=np.array([[7, 1], [7, 2]]))
    >>> sorted(matrix_files(two, "part", "mtx"))
    ['part_K.mtx', 'part_M.mtx', 'part_dofs.csv', 'part_nodes.csv']
    """
    return FORMS[form](matrices, stem)


def tables(matrices: MatrixSet, stem: str) -> dict[str, str | bytes]:
    """Tables of dofs, a line for each row, and of nodes."""
    dofs = "".join(f"{node},{NAMES[direction]}\n" for node, direction in matrices.dofs.tolist())
    nodes = "".join(f"{node},{x!r},{y!r},{z!r}\n" for node, (x, y, z) in places(matrices))
    return {f"{stem}_dofs.csv": "node,direction\n" + dofs, f"{stem}_nodes.csv": "node,x,y,z\n" + nodes}


def places(matrices: MatrixSet) -> list[tuple[int, list[float]]]:
    """Nodes that have dofs, with their positions."""
    known = dict.fromkeys(matrices.dofs[:, 0].tolist())
    return [(node, np.asarray(matrices.points[node]).tolist()) for node in known if node in matrices.points]


def symmetry(A: csc_array) -> str:
    """Matrix Market's word for the symmetry of a matrix: symmetric, skew-symmetric or general, up to round-off."""
    level = ROUND_OFF * float(np.abs(A.data).max(initial=0.0))
    for name, sign in (("symmetric", -1.0), ("skew-symmetric", 1.0)):
        if not A.nnz or np.abs((A + sign * A.T).data).max(initial=0.0) <= level:
            return name
    return "general"


def market(matrices: MatrixSet, stem: str) -> dict[str, str | bytes]:
    """Matrix Market, one file a matrix."""
    files = tables(matrices, stem)
    for name, A in matrices.named.items():
        stream = BytesIO()
        mmwrite(stream, A, symmetry=symmetry(A), precision=17)
        files[f"{stem}_{name}.mtx"] = stream.getvalue()
    return files


def dmig(matrices: MatrixSet, stem: str) -> dict[str, str | bytes]:
    """DMIG cards of large fields (ten digits), K2GG, M2GG, B2GG, GYRO, with the grids before them.

    Symmetric matrices (form 6) as lower triangles, others (form 1) with all entries.
    """
    out = StringIO()
    for node, x in places(matrices):
        a, b, c = (f"{value:16.9E}" for value in x)
        out.write(f"GRID*   {node:16d}{'':16}{a}{b}*\n*       {c}\n")
    titles = {"K": "K2GG", "M": "M2GG", "C": "B2GG", "K4": "K42GG", "G": "GYRO"}
    dofs = matrices.dofs.tolist()
    for role, A in matrices.named.items():
        name = titles[role]
        form = 6 if symmetry(A) == "symmetric" else 1
        out.write(f"DMIG    {name:8}{0:8d}{form:8d}{2:8d}{0:8d}\n")
        lower = csc_array(tril(A) if form == 6 else A)
        for column in range(len(dofs)):
            part = slice(*lower.indptr[column : column + 2])
            if part.start == part.stop:
                continue
            node, component = dofs[column]
            out.write(f"DMIG*   {name:16}{node:16d}{component:16d}\n")
            for row, value in zip(lower.indices[part].tolist(), lower.data[part].tolist(), strict=True):
                out.write(f"*       {dofs[row][0]:16d}{dofs[row][1]:16d}{value:16.9E}\n".replace("E", "D"))
    return {f"{stem}.pch": out.getvalue()}


def op4(matrices: MatrixSet, stem: str) -> dict[str, str | bytes]:
    """OP4 as text, sparse with long row numbers, all digits of a double."""
    out = StringIO()
    for name, A in matrices.named.items():
        n = A.shape[0]
        form = 6 if symmetry(A) == "symmetric" else 1
        out.write(f"{n:8d}{-n:8d}{form:8d}{2:8d}{name:8}1P,3E23.16\n")
        ordered = csc_array(A)
        ordered.sort_indices()
        for column in range(n):
            part = slice(*ordered.indptr[column : column + 2])
            rows, values = ordered.indices[part], ordered.data[part]
            if not len(rows):
                continue
            breaks = np.flatnonzero(np.diff(rows) > 1) + 1
            strings = list(zip(np.split(rows, breaks), np.split(values, breaks), strict=True))
            words = sum(2 + 2 * len(r) for r, _ in strings)
            out.write(f"{column + 1:8d}{0:8d}{words:8d}\n")
            for r, v in strings:
                out.write(f"{2 * len(r) + 1:8d}{r[0] + 1:8d}\n")
                for k in range(0, len(v), 3):
                    out.write("".join(f"{x:23.16E}" for x in v[k : k + 3]) + "\n")
        out.write(f"{n + 1:8d}{1:8d}{1:8d}\n{1.0:23.16E}\n")
    return {**tables(matrices, stem), f"{stem}.op4": out.getvalue()}


def with_tables(matrices: MatrixSet) -> dict[str, np.ndarray]:
    """Arrays together with the tables dofs and nodes."""
    nodes = np.array([[node, *x] for node, x in places(matrices)]).reshape(-1, 4)
    return {"dofs": matrices.dofs, "nodes": nodes}


def npz(matrices: MatrixSet, stem: str) -> dict[str, str | bytes]:
    """Compressed columns in an npz."""
    stream = BytesIO()
    arrays = {key: part for name, A in matrices.named.items() for key, part in to_columns(name, A).items()}
    save_npz(stream, {**arrays, **with_tables(matrices)})
    return {f"{stem}.npz": stream.getvalue()}


def mat(matrices: MatrixSet, stem: str) -> dict[str, str | bytes]:
    """MATLAB's .mat, version 5, sparse."""
    stream = BytesIO()
    savemat(stream, {**matrices.named, **with_tables(matrices)})
    return {f"{stem}.mat": stream.getvalue()}


FORMS: Mapping[str, Callable[[MatrixSet, str], dict[str, str | bytes]]] = MappingProxyType(
    {"mtx": market, "pch": dmig, "op4": op4, "npz": npz, "mat": mat}
)
