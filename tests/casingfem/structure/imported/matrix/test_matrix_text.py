"""Lists of entries: Matrix Market, Abaqus and CalculiX files line by line, and rows brought into one order."""

import re

import numpy as np
import pytest

import casingfem as cf

SPARSE = "%%MatrixMarket matrix coordinate {} {}\n"
DENSE = "%%MatrixMarket matrix array real {}\n"


def file(folder, text, name="a.mtx"):
    path = folder / name
    path.write_text(text)
    return path


def stiffness(folder, text, size):
    """K of a file, beside a mass of that size, both with rows of one node after the other."""
    rows = "".join(f"{k} {k} 1.\n" for k in range(1, size + 1))
    file(folder, SPARSE.format("real", "general") + f"{size} {size} {size}\n{rows}", "M.mtx")
    file(folder, "".join(f"{k}.1\n" for k in range(1, size + 1)), "K.dof")
    return cf.imported.read_matrices([file(folder, text, "K.mtx"), folder / "M.mtx"]).K


def test_abaqus_entries_are_ordered_by_node_and_direction_and_mirrored(tmp_path):
    """Numbers between commas and blanks, with comments, and with the exponents of Fortran."""
    mass = "".join(f"{n},{d} {n},{d} 1.\n" for n, d in ((4, 3), (9, 2), (4, 1)))
    text = "** a\n% b\n\n9,2, 9,2, 5.0\n9 2 4 3 -1.5D0\n4,3, 4,3, 7d0\n4,1, 4,1, 2.0\n4,1,4,3,.25\n"
    found = cf.imported.read_matrices([file(tmp_path, text, "a_K.mtx"), file(tmp_path, mass, "a_M.mtx")])
    assert found.dofs.tolist() == [[4, 1], [4, 3], [9, 2]]
    np.testing.assert_array_equal(found.K.toarray(), [[2.0, 0.25, 0.0], [0.25, 7.0, -1.5], [0.0, -1.5, 5.0]])
    for row, told in (
        ("4,1,4,1", "found 4 columns, expected 5"),
        ("4,1,4,1,x", "'x'"),
        ("4,.5,4,1,1", "not whole num"),
    ):
        with pytest.raises(cf.errors.ModelError, match=rf"a_K\.mtx: .*{told}"):
            cf.imported.read_matrices([file(tmp_path, f"{row}\n", "a_K.mtx"), tmp_path / "a_M.mtx"])
    more = file(tmp_path, mass + "9,3 9,3 1.\n", "a_M.mtx")
    with pytest.raises(cf.errors.ModelError, match=re.escape("no stiffness at node 9, direction 3")):
        cf.imported.read_matrices([file(tmp_path, text, "a_K.mtx"), more])


@pytest.mark.parametrize("field", ["real", "integer", "REAL"])
def test_entries_of_a_general_matrix_are_where_they_are_given(field, tmp_path):
    text = SPARSE.format(field, "general") + "% a comment\n3 3 4\n1 2 5\n3 1 -2\n2 2 4\n3 3 1\n"
    wanted = [[0.0, 5.0, 0.0], [0.0, 4.0, 0.0], [-2.0, 0.0, 1.0]]
    np.testing.assert_array_equal(stiffness(tmp_path, text, 3).toarray(), wanted)


def test_entries_of_a_symmetric_matrix_are_on_both_sides(tmp_path):
    text = SPARSE.format("real", "symmetric") + "3 3 3\n1 1 5.\n3 1 -2.\n3 3 1.\n"
    wanted = [[5.0, 0.0, -2.0], [0.0, 0.0, 0.0], [-2.0, 0.0, 1.0]]
    np.testing.assert_array_equal(stiffness(tmp_path, text, 3).toarray(), wanted)


def test_entries_of_a_skew_matrix_are_on_the_other_side_with_the_other_sign(tmp_path):
    text = SPARSE.format("real", "skew-symmetric") + "3 3 2\n2 1 5.\n3 1 -2.\n"
    wanted = [[0.0, -5.0, 2.0], [5.0, 0.0, 0.0], [-2.0, 0.0, 0.0]]
    np.testing.assert_array_equal(stiffness(tmp_path, text, 3).toarray(), wanted)


def test_all_entries_are_given_column_by_column(tmp_path):
    text = DENSE.format("general") + "% a comment\n2 2\n1.0\n2d0\n\n3.0 4.0\n"
    np.testing.assert_array_equal(stiffness(tmp_path, text, 2).toarray(), [[1.0, 3.0], [2.0, 4.0]])
    text = DENSE.format("symmetric") + "3 3\n1 2 3 4 5 6\n"
    np.testing.assert_array_equal(stiffness(tmp_path, text, 3).toarray(), [[1, 2, 3], [2, 4, 5], [3, 5, 6]])
    assert stiffness(tmp_path, DENSE.format("symmetric") + "1 1\n7.\n", 1).toarray().tolist() == [[7.0]]


def test_a_matrix_without_entries_is_zero(tmp_path):
    found = stiffness(tmp_path, SPARSE.format("real", "general") + "2 2 0\n", 2)
    assert (found.shape, found.nnz) == ((2, 2), 0)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "%%MatrixMarket matrix coordinate real\n",
            "found matrix coordinate real, expected matrix coordinate or array, real",
        ),
        ("%%MatrixMarket\n", "found no kind, expected matrix"),
        (SPARSE.format("pattern", "general"), "found matrix coordinate pattern general, expected"),
        (DENSE.format("skew-symmetric"), "found matrix array real skew-symmetric, expected"),
        (
            SPARSE.format("real", "skew-symmetric") + "2 2 1\n2 2 1.\n",
            "found entries on or above the diagonal of a skew-symmetric matrix",
        ),
        ("%%MatrixMarket tensor array real general\n", "found tensor array real general, expected"),
        ("%%MatrixMarket matrix list real general\n", "found matrix list real general, expected"),
        (
            "%%MatrixMarket matrix array real general more\n",
            "found matrix array real general more, expected",
        ),
        (
            SPARSE.format("real", "general"),
            r"found no line with the numbers of rows, columns and entries: cut short\?",
        ),
        (SPARSE.format("real", "general") + "2 2 1\n3 1 1.\n", "found an entry outside the matrix, expected rows"),
        (SPARSE.format("real", "general") + "2 2 1\n1 3 1.\n", "found an entry outside the matrix, expected rows"),
        (SPARSE.format("real", "general") + "2 2 1\n1 0 1.\n", "found an entry outside the matrix, expected rows"),
        (SPARSE.format("real", "general") + "2 2 1\n0 1 1.\n", "found an entry outside the matrix, expected rows"),
        (
            SPARSE.format("real", "general") + "2 2 2\n1 1 1.\n",
            r"found 1 entries, expected 2: cut short\?",
        ),
        (
            SPARSE.format("real", "general") + "2 3 0\n",
            "found a matrix of 2 x 3, expected a square one of 1 to 100000000",
        ),
        (
            SPARSE.format("real", "symmetric") + "2 2 1\n1 2 1.\n",
            "found entries above the diagonal of a symmetric matrix",
        ),
        (SPARSE.format("real", "general") + "2 2 1.5\n", "found rows or nodes that are not whole numbers"),
        (DENSE.format("general") + "2\n", "found '2', expected the numbers of rows and columns"),
        (
            DENSE.format("general") + f"2 {'1' * 16}\n",
            "found '2 1111111111111111', expected the numbers of rows and columns",
        ),
        (DENSE.format("general") + f"2 {'1' * 15}\n", "found a matrix of 2 x 1{15}, expected a square one"),
        (
            DENSE.format("general") + "2 2\n1 2 3\n",
            r"found 3 entries, expected 4: cut short\?",
        ),
        (DENSE.format("symmetric") + "3 3\n1 2 3 4 5 6 7\n", "found 7 entries, expected 6"),
        (
            DENSE.format("symmetric") + "3 3\n1 2 3 4 5\n",
            r"found 5 entries, expected 6: cut short\?",
        ),
    ],
)
def test_what_is_no_matrix_is_refused(text, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"K\.mtx: {told}"):
        stiffness(tmp_path, text, 2)


@pytest.mark.parametrize("size", ["0 0", "100000001 100000001", "2 3", "-1 -1"])
def test_sizes_beyond_their_bounds_are_refused(size, tmp_path):
    told = f"found a matrix of {size.replace(' ', ' x ')}, expected a square one of 1 to 100000000"
    with pytest.raises(cf.errors.ModelError, match=told):
        stiffness(tmp_path, SPARSE.format("real", "general") + f"{size} 1\n1 1 1.\n", 2)


def test_a_list_of_dofs(tmp_path):
    for ending in ("sti", "mas"):
        file(tmp_path, "1 1 1.\n2 2 1.\n3 3 1.\n", f"a.{ending}")
    file(tmp_path, " 7.1 \n\n12.6\n3.0\n", "a.dof")
    assert cf.imported.read_matrices(tmp_path / "a.sti").dofs.tolist() == [[7, 1], [12, 6], [3, 0]]
    for dof in ("7.7", "7", "7.", ".1", "x.1", "7.x", "-7.1", "7.-1"):
        file(tmp_path, f"7.1\n\n{dof}\n", "a.dof")
        told = rf"a\.dof: line 3: found '{dof}', expected node\.direction, such as 6\.1"
        with pytest.raises(cf.errors.ModelError, match=told):
            cf.imported.read_matrices(tmp_path / "a.sti")


def test_matrices_of_calculix(tmp_path):
    """Either triangle, rows counted from 1 in the order of the list."""
    file(tmp_path, "9.1\n2.3\n2.1\n", "job.dof")
    file(tmp_path, "1 1 5.\n1 2 -2.\n3 3 1.\n2 2 4.\n", "job.sti")
    file(tmp_path, "2 1 .5\n1 1 1.\n2 2 1.\n3 3 1.\n", "job.mas")
    for ending in (".sti", ".mas", ".dof"):
        found = cf.imported.read_matrices(tmp_path / f"job{ending}")
        np.testing.assert_array_equal(found.K.toarray(), [[5, -2, 0], [-2, 4, 0], [0, 0, 1]])
        np.testing.assert_array_equal(found.M.toarray(), [[1, 0.5, 0], [0.5, 1, 0], [0, 0, 1]])
        assert (found.dofs.tolist(), found.source, found.C) == ([[9, 1], [2, 3], [2, 1]], f"job{ending}", None)
    for row, told in (("4 1", 4), ("1 4", 4), ("0 1", 0), ("1 0", 0)):
        file(tmp_path, f"{row} 1.\n", "job.mas")
        with pytest.raises(cf.errors.ModelError, match=rf"job\.mas: found row {told}, and 3 dofs; .*matrix-size"):
            cf.imported.read_matrices(tmp_path / "job.sti")
    for ending in (".dof", ".mas"):
        (tmp_path / f"job{ending}").unlink()
        with pytest.raises(cf.errors.ModelError, match=rf"job\.sti: found no file job\{ending} beside it"):
            cf.imported.read_matrices(tmp_path / "job.sti")


def test_files_of_a_pair_are_distinguished_by_their_names(tmp_path):
    text = SPARSE.format("real", "general") + "2 2 2\n1 1 {}\n2 2 1.\n"
    paths = [file(tmp_path, text.format(f"{k}."), f"{name}.mtx") for k, name in enumerate(("p_M", "p_C", "p_K"), 1)]
    file(tmp_path, "9.1\n2.3\n", "p_K.dof")
    found = cf.imported.read_matrices(paths)
    assert [matrix[0, 0] for matrix in (found.M, found.C, found.K)] == [1.0, 2.0, 3.0]
    assert (found.dofs.tolist(), found.source) == ([[9, 1], [2, 3]], "p_M.mtx, p_C.mtx, p_K.mtx")
    given = cf.imported.read_matrices(paths[::2], dofs=file(tmp_path, "node,direction\n4,x\n5,x\n", "d.csv"))
    assert (given.dofs.tolist(), given.C) == ([[4, 1], [5, 1]], None)
    (tmp_path / "p_K.dof").unlink()
    with pytest.raises(
        cf.errors.ModelError, match=r"p_M\.mtx, p_K\.mtx: found no file p_K\.dof beside them.*matrix-dofs"
    ):
        cf.imported.read_matrices(paths[::2])
