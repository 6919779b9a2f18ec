"""Matrices written for other programs: what each line says, and that our readers find the same in it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.io import loadmat
from scipy.sparse import csc_array

import casingfem as cf

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


def written(folder, form, matrices=SET):
    """The text of each file, or its bytes."""
    files = {path.name: path.read_bytes() for path in cf.imported.write_matrices(folder / f"p.{form}", matrices)}
    return {name: content if form in ("npz", "mat") else content.decode() for name, content in files.items()}


def same(found, wanted):
    np.testing.assert_array_equal(found.toarray(), wanted)


def test_matrix_market_files_are_symmetric_with_all_digits_and_have_tables_beside_them(tmp_path):
    files = written(tmp_path, "mtx", replace(SET, C=csc_array(0.5 * K)))
    assert sorted(files) == ["p_C.mtx", "p_K.mtx", "p_M.mtx", "p_dofs.csv", "p_nodes.csv"]
    assert files["p_K.mtx"].splitlines()[0] == "%%MatrixMarket matrix coordinate real symmetric"
    assert files["p_dofs.csv"] == "node,direction\n41,x\n41,z\n12,ry\n12,rz\n900,q\n"
    assert files["p_nodes.csv"].splitlines()[:2] == ["node,x,y,z", "41,0.0,2.0,-3e-07"]
    paths = [tmp_path / f"p_{name}.mtx" for name in "KMC"]
    found = cf.imported.read_matrices(paths, dofs=tmp_path / "p_dofs.csv", nodes=tmp_path / "p_nodes.csv")
    for own, wanted in ((found.K, K), (found.M, M), (found.C, 0.5 * K)):
        same(own, wanted)
    assert found.dofs.tolist() == DOFS.tolist()
    assert {node: x.tolist() for node, x in found.points.items()} == {n: POINTS[n].tolist() for n in (41, 12)}


def test_dmig_cards_have_fixed_columns(tmp_path):
    """Large fields: a name in eight characters, four numbers in sixteen each, and what goes on below."""
    (text,) = written(tmp_path, "pch").values()
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
        (text,) = written(tmp_path, "pch", matrices).values()
        assert [line[8:16].strip() for line in text.splitlines() if line.startswith("DMIG ")] == names
    columns = [line[24:56].split() for line in lines if line.startswith("DMIG*")]
    assert columns[:5] == [[str(node), str(direction)] for node, direction in DOFS.tolist()]
    assert [node for node, _ in columns[5:]] == ["41", "12", "12", "900"]  # the second has no mass


def test_dmig_cards_are_read_again_to_ten_digits(tmp_path):
    written(tmp_path, "pch")
    found = cf.imported.read_matrices(tmp_path / "p.pch")
    order = [DOFS.tolist().index(dof) for dof in found.dofs.tolist()]
    np.testing.assert_allclose(found.K.toarray(), K[np.ix_(order, order)], rtol=1e-9)
    np.testing.assert_array_equal(found.M.toarray(), M[np.ix_(order, order)])
    assert sorted(found.points) == [12, 41]
    np.testing.assert_allclose(found.points[12], POINTS[12], rtol=1e-9)


def test_op4_files_have_strings_of_what_is_not_zero(tmp_path):
    files = written(tmp_path, "op4")
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
    found = cf.imported.read_matrices(tmp_path / "p.op4", dofs=tmp_path / "p_dofs.csv")
    same(found.K, K)
    same(found.M, M)
    full = cf.imported.MatrixSet(K=csc_array(np.arange(1.0, 26.0).reshape(5, 5)), M=csc_array(M), dofs=DOFS)
    lines = written(tmp_path, "op4", full)["p.op4"].splitlines()
    assert [len(line) // 23 for line in lines[3:5]] == [3, 2]  # three values a line
    assert lines[1:3] == ["       1       0      12", "      11       1"]
    assert lines[21:23] == ["       6       1       1", " 1.0000000000000000E+00"]
    same(cf.imported.read_matrices(tmp_path / "p.op4", dofs=tmp_path / "p_dofs.csv").K, full.K.toarray())


def test_arrays_are_read_again_as_they_are(tmp_path):
    assert list(written(tmp_path, "npz", DAMPED)) == ["p.npz"]
    found = cf.imported.read_matrices(tmp_path / "p.npz")
    for own, wanted in ((found.K, K), (found.M, M), (found.C, 0.5 * K)):
        same(own, wanted)
    assert (found.dofs.tolist(), found.points) == (DOFS.tolist(), {})
    written(tmp_path, "npz")
    points = cf.imported.read_matrices(tmp_path / "p.npz").points
    assert {node: x.tolist() for node, x in points.items()} == {n: POINTS[n].tolist() for n in (41, 12)}


@pytest.mark.filterwarnings("ignore:[^a-z]*The default value for .spmatrix.:DeprecationWarning")
def test_matlab_finds_matrices_and_tables_by_name(tmp_path):
    (name,) = written(tmp_path, "mat")
    found = loadmat(tmp_path / name)
    same(found["K"], K)
    same(found["M"], M)
    assert ("C" in found, name, found["dofs"].tolist()) == (False, "p.mat", DOFS.tolist())
    assert found["nodes"].tolist() == [[41.0, *POINTS[41]], [12.0, *POINTS[12]]]


def test_another_ending_is_refused_with_those_that_there_are(tmp_path):
    with pytest.raises(cf.errors.ModelError, match=r"found p\.xyz, expected .* ends in \.mtx, \.pch, .*matrix-f"):
        cf.imported.write_matrices(tmp_path / "p.xyz", SET)
    assert not list(tmp_path.iterdir())
