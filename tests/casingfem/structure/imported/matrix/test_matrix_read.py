"""Which reader takes a file by its ending, and the tables of nodes and dofs beside it."""

import numpy as np
import pytest

import casingfem as cf

SPARSE = "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 {}\n"
DMIG = "GRID,7,,1.,2.,3.\nDMIG,K,0,6,2,0\nDMIG,K,7,1,,7,1,2.\nDMIG,M,0,6,2,0\nDMIG,M,7,1,,7,1,3.\n"
OP4 = "".join(
    f"{n:8d}{m:8d}{2:8d}{2:8d}{name:8}1P,3E23.16\n{1:8d}{1:8d}{2:8d}\n{x:23.16E}\n{n + 1:8d}{1:8d}{0:8d}\n"
    for name, m, n, x in (("K", 1, 1, 2.0), ("M", 1, 1, 3.0), ("MUG", 2, 1, 9.0))
)


def read_nodes(path):
    np.savez(path.with_name("one.npz"), K=np.eye(1), M=np.eye(1), dofs=np.array([[7, 1]]))
    return cf.imported.read_matrices(path.with_name("one.npz"), nodes=path).points


def read_dofs(path, size=3):
    np.savez(path.with_name("many.npz"), K=np.eye(size), M=np.eye(size))
    return cf.imported.read_matrices(path.with_name("many.npz"), dofs=path).dofs


def put(folder, **texts):
    for name, text in texts.items():
        (folder / name.replace("__", ".")).write_text(text)


@pytest.mark.parametrize(
    ("files", "given"),
    [
        *(({f"a__{ending}": DMIG}, {}) for ending in ("pch", "bdf", "dmig", "dat", "PCH")),
        ({"a__op4": OP4}, {"dofs"}),
        ({"k__mtx": SPARSE.format("2."), "m__mtx": SPARSE.format("3.")}, {"dofs"}),
        ({"a__sti": "1 1 2.\n", "a__mas": "1 1 3.\n", "a__dof": "7.1\n"}, {}),
    ],
)
def test_a_file_is_read_by_its_ending(files, given, tmp_path):
    put(tmp_path, **files, dofs__csv="node,direction\n7,x\n", nodes__csv="node,x,y,z\n9,4,5,6\n")
    paths = [tmp_path / name.replace("__", ".") for name in files]
    paths = paths if len(paths) == 2 else [str(paths[0])]
    tables = {name: tmp_path / f"{name}.csv" for name in given}
    for one in (paths, paths[0]) if len(paths) == 1 else (paths,):
        found = cf.imported.read_matrices(one, **tables)
        assert (found.K.toarray().tolist(), found.M.toarray().tolist(), found.C) == ([[2.0]], [[3.0]], None)
        assert found.dofs.tolist() == [[7, 1]]
        own = {7: [1.0, 2.0, 3.0]} if "GRID" in next(iter(files.values())) else {}
        assert {n: x.tolist() for n, x in found.points.items()} == own
        more = cf.imported.read_matrices(one, **tables, nodes=tmp_path / "nodes.csv").points
        assert {n: x.tolist() for n, x in more.items()} == own | {9: [4.0, 5.0, 6.0]}


def test_an_op4_file_needs_dofs_and_may_have_damping(tmp_path):
    put(
        tmp_path,
        a__op4=OP4 + OP4.partition("       1       1       2       2M")[0].replace("K ", "C "),
        d__csv="node,direction\n7,x\n",
    )
    assert cf.imported.read_matrices(tmp_path / "a.op4", dofs=tmp_path / "d.csv").C.toarray().tolist() == [[2.0]]
    with pytest.raises(
        cf.errors.ModelError, match=r"a\.op4: found OP4 files alone, which contain no dofs.*matrix-dofs"
    ):
        cf.imported.read_matrices(tmp_path / "a.op4")


@pytest.mark.parametrize(
    ("names", "found"),
    [
        ([], "no file"),
        (["a.xyz"], "a.xyz"),
        (["a.op4", "b.npz"], "a.op4, b.npz"),
        (["k.mtx", "m.npz"], "k.mtx, m.npz"),
        (["a"], "a"),
    ],
)
def test_files_that_nobody_reads_are_named(names, found, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"found {found}; .*matrix-format"):
        cf.imported.read_matrices([tmp_path / name for name in names])


def test_positions_of_nodes(tmp_path):
    put(tmp_path, n__csv="z,node,y,x\n1,7,2,3\n-4,5,0.5,6\n")
    assert {n: x.tolist() for n, x in read_nodes(tmp_path / "n.csv").items()} == {7: [3, 2, 1], 5: [6, 0.5, -4]}
    put(tmp_path, n__csv="node,x,y,z\n7,0,0,0\n5,0,0,0\n6,0,0,0\n5,0,0,1\n")
    with pytest.raises(
        cf.errors.InputError, match=r"n\.csv, line 5, column 'node': found node 5 again; expected each node once"
    ):
        read_nodes(tmp_path / "n.csv")


def test_directions_of_dofs(tmp_path):
    put(tmp_path, d__csv="direction,node\n Z , 7\nrx,12\n0,3\n")
    assert read_dofs(tmp_path / "d.csv").tolist() == [[7, 3], [12, 4], [3, 0]]
    for row, told in (("w,7", "7, w"), ("x,-7", "-7, x"), ("x,7.5", "7.5, x"), ("7,1", "1, 7")):
        put(tmp_path, d__csv=f"direction,node\nx,1\n{row}\n")
        with pytest.raises(
            cf.errors.InputError,
            match=rf"d\.csv, line 3: found {told}; expected the number of a node, and one of q, x, y, z, rx",
        ):
            read_dofs(tmp_path / "d.csv")


def test_columns_that_are_missing_are_named(tmp_path):
    put(tmp_path, n__csv="# a comment\nnode,y\n7,0\n")
    told = r"n\.csv, line 2: found no column x, z; expected columns node, x, y, z"
    with pytest.raises(cf.errors.InputError, match=told):
        read_nodes(tmp_path / "n.csv")
