"""Read matrices of any format, in any order of the files; the ending of each file states its format."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from scipy.sparse import csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import IntArray
from casingfem.structure.imported.matrix.arrays import read_arrays
from casingfem.structure.imported.matrix.bulk import Bulk, read_bulk
from casingfem.structure.imported.matrix.matrix_set import MatrixSet, fault, role_of, roles_of, without_null
from casingfem.structure.imported.matrix.op4 import read_op4
from casingfem.structure.imported.matrix.tables import nodes_and_axes, read_dofs
from casingfem.structure.imported.matrix.text import read_calculix, read_mtx_pair

BULK = (".pch", ".bdf", ".dmig", ".dat", ".nas", ".asm")
ARRAYS = (".npz", ".mat", ".h5", ".hdf5")
CALCULIX = (".sti", ".mas", ".dof")
ENDINGS = (*BULK, ".op4", ".mtx", *CALCULIX, *ARRAYS)


def read_matrices(
    paths: str | Path | Sequence[str | Path], *, nodes: str | Path | None = None, dofs: str | Path | None = None
) -> MatrixSet:
    """Read K, M and maybe C and K4 (structural damping) of a part, in the file's own units.

    Parameters
    ----------
    paths
        Files of DMIG cards (.pch, .bdf), of OP4, one of CalculiX (.sti, .mas and .dof side by side), .mat, HDF5 or npz,
        or the .mtx files of K, M and maybe C. Beside matrices of another format, bulk data (.pch, .bdf, .dat, .asm)
        give the rows (EXTRN), the grids with their own axes (GRID, CORD), and structural damping (PARAM G).
    nodes
        A table with the columns node, x, y, z, and maybe xx, xy, xz, yx, yy, yz: the directions of the node's own x and
        y, along which its dofs are.
    dofs
        A table with the columns node, direction (x, y, z, rx, ry, rz, q, or 1 to 6 and 0), a line for each row of the
        matrices; for formats that do not state the dofs.

    Raises
    ------
    ModelError
        `matrix-file`, `matrix-names`, `matrix-dofs`, `matrix-size`: what is missing or wrong in the files, with its
        line if it is on one.

    Examples
    --------
    >>> import tempfile
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=6, rows=2, around=1))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = cf.imported.write_matrices(f"{folder}/plate.npz", cf.modal.structure_matrices(plate))
    ...     found = read_matrices(file)
    >>> found.K.shape
    (420, 420)
    """
    files = [Path(path) for path in ([paths] if isinstance(paths, str | Path) else paths)]
    beside = [file for file in files if file.suffix.lower() in BULK]
    others = [file for file in files if file not in beside]
    endings = {file.suffix.lower() for file in others}
    several = endings <= {".mtx"} or endings <= {".op4"}
    if not files or not endings <= set(ENDINGS) or (len(others) > 1 and not several):
        found = ", ".join(file.name for file in files) or "no file"
        raise ModelError("matrix-format", f"found {found}")
    rows = None if dofs is None else read_dofs(Path(dofs))
    bulk = read_bulk(beside) if beside else None
    if not others:
        assert bulk is not None
        found_set = of_dmig(bulk)
    else:
        found_set = of_others(others, rows if rows is not None or bulk is None else bulk.rows, bulk)
    found_set = with_bulk(found_set, bulk)
    if nodes is None:
        return found_set
    points, axes = nodes_and_axes(Path(nodes))
    return replace(found_set, points={**found_set.points, **points}, axes={**found_set.axes, **axes})


def of_others(files: Sequence[Path], rows: IntArray | None, bulk: Bulk | None) -> MatrixSet:
    """Matrices of files other than bulk data; the bulk data may not contain matrices too."""
    if bulk is not None and (again := [name for name in bulk.dmig.names if role_of(name) in ("K", "M")]):
        names = ", ".join(file.name for file in files)
        found = f"found the matrix {again[0]} on DMIG cards, and matrices in {names} too"
        raise fault(bulk.source, f"{found}, expected matrices in one of them")
    ending = files[0].suffix.lower()
    if ending in CALCULIX:
        return read_calculix(files[0])
    if ending == ".mtx":
        return read_mtx_pair(list(files), rows)
    return of_op4(files, rows) if ending == ".op4" else read_arrays(files[0], rows)


def of_op4(paths: Sequence[Path], dofs: IntArray | None) -> MatrixSet:
    """K, M, C and K4 of OP4 files, which do not state the meaning of rows; null ones of 1 x 1 count as absent."""
    source = ", ".join(path.name for path in paths)
    every: dict[str, csc_array] = {}
    for path in paths:
        matrices = read_op4(path)
        if again := [name for name in matrices if name in every and role_of(name)]:
            raise fault(
                path.name, f"found the matrix {again[0]}, which another of the files contains too, expected one"
            )
        every |= matrices
    square = without_null(every)
    roles = roles_of(list(square), source)
    if dofs is None:
        raise ModelError("matrix-dofs", f"{source}: found OP4 files alone, which contain no dofs")
    left_out = tuple(name for name, A in every.items() if name not in roles.values() and A.count_nonzero())
    named = {role: square[name] for role, name in roles.items()}
    return MatrixSet(**named, dofs=dofs, source=source, left_out=left_out)


def of_dmig(bulk: Bulk) -> MatrixSet:
    """K, M, C and K4 from DMIG cards."""
    dmig = bulk.dmig
    roles = roles_of(dmig.names, bulk.source)
    matrices, dofs = dmig.matrices(roles)
    left_out = (*(name for name in dmig.names if name not in roles.values()), *sorted(dmig.others))
    return MatrixSet(**matrices, dofs=dofs, source=bulk.source, left_out=left_out)


def with_bulk(matrices: MatrixSet, bulk: Bulk | None) -> MatrixSet:
    """Positions, axes, boundary and structural damping of bulk data added to matrices."""
    if bulk is None:
        return matrices
    K4 = matrices.K4
    if bulk.g:
        K4 = csc_array(bulk.g * matrices.K + (0.0 * matrices.K if K4 is None else K4))
    points, axes = {**matrices.points, **bulk.points}, {**matrices.axes, **bulk.axes}
    return replace(matrices, points=points, axes=axes, K4=K4, boundary=bulk.boundary)
