"""Matrices written for other programs: what each line says, and that our readers find the same in it."""

import numpy as np
import pytest
from scipy.io import loadmat
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.imported.matrix.arrays import read_arrays
from casingfem.structure.imported.matrix.op4 import read_op4
from casingfem.structure.imported.matrix.tables import read_dofs, read_nodes
from casingfem.structure.imported.matrix.text import read_market
from casingfem.structure.imported.matrix.write import NAMES, dmig, market, mat, matrix_files, npz, op4, tables

K = np.array(
    [
        [8.0, -1.5, 0, 0, 0.25],
        [-1.5, 9.0, 0, 0, 0],
        [0, 0, 7.0, -2.0, 0],
        [0, 0, -2.0, 6.0, 1 / 3],
        [0.25, 0, 0, 1 / 3, 5.0],
    ]
)
M = np.diag([1.0, 0.0, 3.0, 4.0, 5.0])
DOFS = np.array([[41, 1], [41, 3], [12, 5], [12, 6], [900, 0]])
POINTS = {12: np.array([1.5, -0.25, 1 / 3]), 41: np.array([0.0, 2.0, -3e-7]), 77: np.zeros(3)}
SET = cf.imported.MatrixSet(K=csc_array(K), M=csc_array(M), dofs=DOFS, points=POINTS)
DAMPED = cf.imported.MatrixSet(K=csc_array(K), M=csc_array(M), C=csc_array(0.5 * K), dofs=DOFS)


def stored(folder, files):
    for name, content in files.items():
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return folder


def same(found, wanted):
    np.testing.assert_array_equal(found.toarray(), wanted)


def test_tables_have_a_line_for_each_row_and_each_node_of_a_row(tmp_path):
    files = tables(SET, "p")
    assert files["p_dofs.csv"] == "node,direction\n41,x\n41,z\n12,ry\n12,rz\n900,q\n"
    assert files["p_nodes.csv"].splitlines()[:2] == ["node,x,y,z", "41,0.0,2.0,-3e-07"]
    stored(tmp_path, files)
    assert read_dofs(tmp_path / "p_dofs.csv").tolist() == DOFS.tolist()
    places = read_nodes(tmp_path / "p_nodes.csv")
    assert {node: x.tolist() for node, x in places.items()} == {n: POINTS[n].tolist() for n in (41, 12)}
    assert [NAMES.index(name) for name in ("q", "x", "z", "rx", "rz")] == [0, 1, 3, 4, 6]


def test_matrix_market_files_are_symmetric_with_all_digits(tmp_path):
    files = market(DAMPED, "p")
    assert sorted(files) == ["p_C.mtx", "p_K.mtx", "p_M.mtx", "p_dofs.csv", "p_nodes.csv"]
    assert files["p_K.mtx"].splitlines()[0] == b"%%MatrixMarket matrix coordinate real symmetric"
    stored(tmp_path, files)
    for name, wanted in (("K", K), ("M", M), ("C", 0.5 * K)):
        same(read_market(tmp_path / f"p_{name}.mtx"), wanted)


def test_dmig_cards_have_fixed_columns():
    """Large fields: a name in eight characters, four numbers in sixteen each, and what goes on below."""
    (text,) = dmig(SET, "p").values()
    lines = text.splitlines()
    first, second = ([line[:8], *(line[k : k + 16].strip() for k in range(8, 72, 16)), line[72:]] for line in lines[:2])
    assert first == ["GRID*   ", "41", "", "0.000000000E+00", "2.000000000E+00", "*"]
    assert second == ["*       ", "-3.000000000E-07", "", "", "", ""]
    assert lines[4:9] == [
        "DMIG    K2GG           0       6       2       0",
        "DMIG*   K2GG                          41               1",
        "*                     41               1 8.000000000D+00",
        "*                     41               3-1.500000000D+00",
        "*                    900               0 2.500000000D-01",
    ]
    for matrices, names in ((SET, ["K2GG", "M2GG"]), (DAMPED, ["K2GG", "M2GG", "B2GG"])):
        (text,) = dmig(matrices, "p").values()
        assert [line[8:16].strip() for line in text.splitlines() if line.startswith("DMIG ")] == names
    columns = [line[24:56].split() for line in lines if line.startswith("DMIG*")]
    assert columns[:5] == [[str(node), str(direction)] for node, direction in DOFS.tolist()]
    assert [node for node, _ in columns[5:]] == ["41", "12", "12", "900"]  # the second has no mass


def test_dmig_cards_are_read_again_to_ten_digits(tmp_path):
    found = cf.imported.read_matrices(stored(tmp_path, dmig(SET, "p")) / "p.pch")
    order = [DOFS.tolist().index(dof) for dof in found.dofs.tolist()]
    np.testing.assert_allclose(found.K.toarray(), K[np.ix_(order, order)], rtol=1e-9)
    np.testing.assert_array_equal(found.M.toarray(), M[np.ix_(order, order)])
    assert sorted(found.points) == [12, 41]
    np.testing.assert_allclose(found.points[12], POINTS[12], rtol=1e-9)


def test_op4_files_have_strings_of_what_is_not_zero(tmp_path):
    files = op4(SET, "p")
    assert files["p.op4"].splitlines()[:9] == [
        "       5      -5       6       2K       1P,3E23.16",
        "       1       0      10",  # strings of two values and of one, each behind two words
        "       5       1",
        " 8.0000000000000000E+00-1.5000000000000000E+00",
        "       3       5",
        " 2.5000000000000000E-01",
        "       2       0       6",
        "       5       1",
        "-1.5000000000000000E+00 9.0000000000000000E+00",
    ]
    assert sorted(files) == ["p.op4", "p_dofs.csv", "p_nodes.csv"]
    found = read_op4(stored(tmp_path, files) / "p.op4")
    same(found["K"], K)
    same(found["M"], M)
    full = cf.imported.MatrixSet(K=csc_array(np.arange(1.0, 26.0).reshape(5, 5)), M=csc_array(M), dofs=DOFS)
    lines = op4(full, "p")["p.op4"].splitlines()
    assert [len(line) // 23 for line in lines[3:5]] == [3, 2]  # three values a line
    assert lines[1:3] == ["       1       0      12", "      11       1"]
    assert lines[21:23] == ["       6       1       1", " 1.0000000000000000E+00"]
    same(read_op4(stored(tmp_path, op4(full, "p")) / "p.op4")["K"], full.K.toarray())


def test_arrays_are_read_again_as_they_are(tmp_path):
    (name,) = files = npz(DAMPED, "p")
    assert name == "p.npz"
    found = read_arrays(stored(tmp_path, files) / name, None)
    for own, wanted in ((found.K, K), (found.M, M), (found.C, 0.5 * K)):
        same(own, wanted)
    assert (found.dofs.tolist(), found.points) == (DOFS.tolist(), {})
    points = read_arrays(stored(tmp_path, npz(SET, "p")) / name, None).points
    assert {node: x.tolist() for node, x in points.items()} == {n: POINTS[n].tolist() for n in (41, 12)}


@pytest.mark.filterwarnings("ignore:[^a-z]*The default value for .spmatrix.:DeprecationWarning")
def test_matlab_finds_matrices_and_tables_by_name(tmp_path):
    (name,) = files = mat(SET, "p")
    found = loadmat(stored(tmp_path, files) / name)
    same(found["K"], K)
    same(found["M"], M)
    assert ("C" in found, name, found["dofs"].tolist()) == (False, "p.mat", DOFS.tolist())
    assert found["nodes"].tolist() == [[41.0, *POINTS[41]], [12.0, *POINTS[12]]]


@pytest.mark.parametrize("form", ["mtx", "pch", "op4", "npz", "mat"])
def test_a_form_is_called_by_its_ending(form):
    assert any(name.endswith(f".{form}") for name in matrix_files(SET, "p", form))
