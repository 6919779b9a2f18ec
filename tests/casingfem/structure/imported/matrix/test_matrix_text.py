"""Lists of entries: Matrix Market, Abaqus and CalculiX files line by line, and rows brought into one order."""

import re

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.imported.matrix.text import (
    aligned,
    check_count,
    check_square,
    numbers,
    read_calculix,
    read_dof,
    read_market,
    read_mtx,
    read_mtx_pair,
    real,
    whole,
)

SPARSE = "%%MatrixMarket matrix coordinate {} {}\n"
DENSE = "%%MatrixMarket matrix array real {}\n"


def file(folder, text, name="a.mtx"):
    path = folder / name
    path.write_text(text)
    return path


def test_a_table_is_of_numbers_between_commas_and_blanks(tmp_path):
    text = "* a\n  % b\n# c\n\n 1,2, 3\n4 5d1 6.5D-1\n"
    assert numbers(file(tmp_path, text), 3).tolist() == [[1, 2, 3], [4, 50, 0.65]]
    assert numbers(file(tmp_path, "7 8\n"), 2).tolist() == [[7, 8]]
    assert numbers(file(tmp_path, "* a\n\n"), 5).shape == (0, 5)
    for text, told in (("1 2\n", "found 2 columns, expected 3"), ("1 2 3 4\n", "found 4 columns, expected 3")):
        with pytest.raises(cf.errors.ModelError, match=rf"a\.mtx: {told}: .*matrix-file"):
            numbers(file(tmp_path, text), 3)
    with pytest.raises(cf.errors.ModelError, match=r"a\.mtx: .*'x'"):
        numbers(file(tmp_path, "1 2 x\n"), 3)


def test_what_counts_is_whole_and_has_fifteen_digits(tmp_path):
    assert whole(np.array([[1.0, -3.0], [999e12, -999e12]]), tmp_path).tolist() == [
        [1, -3],
        [999 * 10**12, -999 * 10**12],
    ]
    for odd in (0.5, np.nan, np.inf, -np.inf, 1e15, -1e15):
        with pytest.raises(cf.errors.ModelError, match=r"a\.mtx: found rows or nodes that are not whole numbers"):
            whole(np.array([[1.0, odd]]), tmp_path / "a.mtx")


def test_abaqus_entries_are_ordered_by_node_and_direction_and_mirrored(tmp_path):
    matrix, dofs = read_mtx(
        file(tmp_path, "9,2, 9,2, 5.0\n9,2, 4,3, -1.5\n4,3, 4,3, 7.0\n4,1, 4,1, 2.0\n4,1,4,3,.25\n")
    )
    assert dofs.tolist() == [[4, 1], [4, 3], [9, 2]]
    np.testing.assert_array_equal(matrix.toarray(), [[2.0, 0.25, 0.0], [0.25, 7.0, -1.5], [0.0, -1.5, 5.0]])
    assert read_mtx(file(tmp_path, SPARSE.format("real", "general") + "1 1 1\n1 1 3.\n"))[1] is None


@pytest.mark.parametrize("field", ["real", "integer", "REAL"])
def test_entries_of_a_general_matrix_stand_where_they_are_given(field, tmp_path):
    text = SPARSE.format(field, "general") + "% a comment\n3 3 4\n1 2 5\n3 1 -2\n2 2 4\n3 3 1\n"
    wanted = [[0.0, 5.0, 0.0], [0.0, 4.0, 0.0], [-2.0, 0.0, 1.0]]
    np.testing.assert_array_equal(read_market(file(tmp_path, text)).toarray(), wanted)


def test_entries_of_a_symmetric_matrix_stand_on_both_sides(tmp_path):
    text = SPARSE.format("real", "symmetric") + "3 3 3\n1 1 5.\n3 1 -2.\n3 3 1.\n"
    wanted = [[5.0, 0.0, -2.0], [0.0, 0.0, 0.0], [-2.0, 0.0, 1.0]]
    np.testing.assert_array_equal(read_market(file(tmp_path, text)).toarray(), wanted)


def test_entries_of_a_skew_matrix_stand_on_the_other_side_with_the_other_sign(tmp_path):
    text = SPARSE.format("real", "skew-symmetric") + "3 3 2\n2 1 5.\n3 1 -2.\n"
    wanted = [[0.0, -5.0, 2.0], [5.0, 0.0, 0.0], [-2.0, 0.0, 0.0]]
    np.testing.assert_array_equal(read_market(file(tmp_path, text)).toarray(), wanted)


def test_all_entries_are_given_column_by_column(tmp_path):
    text = DENSE.format("general") + "% a comment\n2 2\n1.0\n2d0\n\n3.0 4.0\n"
    np.testing.assert_array_equal(read_market(file(tmp_path, text)).toarray(), [[1.0, 3.0], [2.0, 4.0]])
    text = DENSE.format("symmetric") + "3 3\n1 2 3 4 5 6\n"
    np.testing.assert_array_equal(read_market(file(tmp_path, text)).toarray(), [[1, 2, 3], [2, 4, 5], [3, 5, 6]])
    assert read_market(file(tmp_path, DENSE.format("symmetric") + "1 1\n7.\n")).toarray().tolist() == [[7.0]]


def test_a_matrix_without_entries_is_zero(tmp_path):
    found = read_market(file(tmp_path, SPARSE.format("real", "general") + "2 2 0\n"))
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
        ("%%MatrixMarket matrix array real general more\n", "found matrix array real general more, expected"),
        (SPARSE.format("real", "general"), "found no rows, columns and entries: cut short"),
        (SPARSE.format("real", "general") + "2 2 1\n3 1 1.\n", "found an entry outside of 2 x 2"),
        (SPARSE.format("real", "general") + "2 2 1\n1 3 1.\n", "found an entry outside of 2 x 2"),
        (SPARSE.format("real", "general") + "2 2 1\n1 0 1.\n", "found an entry outside of 2 x 2"),
        (SPARSE.format("real", "general") + "2 2 1\n0 1 1.\n", "found an entry outside of 2 x 2"),
        (SPARSE.format("real", "general") + "2 2 2\n1 1 1.\n", "found 1 entries, expected 2: cut short"),
        (
            SPARSE.format("real", "general") + "2 3 0\n",
            "found a matrix of 2 x 3, expected a square one of 1 to 100000000",
        ),
        (
            SPARSE.format("real", "symmetric") + "2 2 1\n1 2 1.\n",
            "found entries above the diagonal of a symmetric matrix",
        ),
        (SPARSE.format("real", "general") + "2 2 1.5\n", "found rows or nodes that are not whole numbers"),
        (DENSE.format("general") + "2\n", "found '2', expected rows and columns, whole numbers"),
        (DENSE.format("general") + f"2 {'1' * 16}\n", "found '2 1{16}', expected rows and columns, whole numbers"),
        (DENSE.format("general") + f"2 {'1' * 15}\n", "found a matrix of 2 x 1{15}, expected a square one"),
        (DENSE.format("general") + "2 2\n1 2 3\n", "found 3 entries, expected 4: cut short"),
        (DENSE.format("symmetric") + "3 3\n1 2 3 4 5 6 7\n", "found 7 entries, expected 6: write"),
        (DENSE.format("symmetric") + "3 3\n1 2 3 4 5\n", "found 5 entries, expected 6: cut short"),
    ],
)
def test_what_is_no_matrix_is_refused(text, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.mtx: {told}"):
        read_market(file(tmp_path, text))


def test_sizes_and_counts_at_their_bounds(tmp_path):
    for size in (1, 10**8):
        check_square(tmp_path, size, size)
    for rows, columns in ((0, 0), (10**8 + 1, 10**8 + 1), (2, 3), (-1, -1)):
        with pytest.raises(
            cf.errors.ModelError, match=f"found a matrix of {rows} x {columns}, expected a square one of 1 to 100000000"
        ):
            check_square(tmp_path, rows, columns)
    check_count(tmp_path, 3, 3)
    for found, wanted, short in ((2, 3, ": cut short"), (4, 3, ": write")):
        with pytest.raises(cf.errors.ModelError, match=f"found {found} entries, expected {wanted}{short}"):
            check_count(tmp_path, found, wanted)


def test_a_number_may_have_fortrans_exponent(tmp_path):
    assert [real(word, tmp_path) for word in ("1.5D2", "1.5d-1", "-2e1", "7")] == [150.0, 0.15, -20.0, 7.0]
    with pytest.raises(cf.errors.ModelError, match=r"a\.mtx: found '1.x', expected a number"):
        real("1.x", tmp_path / "a.mtx")


B = csc_array(np.array([[1.0, 2.0, 0.0], [2.0, 3.0, 4.0], [0.0, 4.0, 5.0]]))


def test_rows_are_put_where_another_matrix_has_them():
    labels, wanted = np.array([[9, 1], [2, 3], [2, 1]]), np.array([[2, 1], [2, 2], [2, 3], [9, 1]])
    # rows 9.1, 2.3, 2.1 go to places 3, 2, 0 of four
    expected = [[5.0, 0.0, 4.0, 0.0], [0.0, 0.0, 0.0, 0.0], [4.0, 0.0, 3.0, 2.0], [0.0, 0.0, 2.0, 1.0]]
    np.testing.assert_array_equal(aligned(B, labels, wanted, "a").toarray(), expected)
    assert aligned(B, labels, labels.copy(), "a") is B
    with pytest.raises(cf.errors.ModelError, match=re.escape("a: dof (9, 1) has mass or damping and no stiffness")):
        aligned(B, labels, wanted[:3], "a")
    with pytest.raises(cf.errors.ModelError, match="a: found mass or damping of 3 rows and a list of 2 dofs"):
        aligned(B, labels[:2], wanted, "a")


def test_a_list_of_dofs(tmp_path):
    assert read_dof(file(tmp_path, " 7.1 \n\n12.6\n3.0\n", "a.dof")).tolist() == [[7, 1], [12, 6], [3, 0]]
    assert read_dof(file(tmp_path, "\n", "a.dof")).shape == (0, 2)
    for dof in ("7.7", "7", "7.", ".1", "x.1", "7.x", "-7.1", "7.-1"):
        with pytest.raises(
            cf.errors.ModelError, match=rf"a\.dof: line 3: found '{dof}', expected node\.direction, such as 6\.1"
        ):
            read_dof(file(tmp_path, f"7.1\n\n{dof}\n", "a.dof"))


def test_matrices_of_calculix(tmp_path):
    """Either triangle, rows counted from 1 in the order of the list."""
    file(tmp_path, "9.1\n2.3\n2.1\n", "job.dof")
    file(tmp_path, "1 1 5.\n1 2 -2.\n3 3 1.\n2 2 4.\n", "job.sti")
    file(tmp_path, "2 1 .5\n1 1 1.\n2 2 1.\n3 3 1.\n", "job.mas")
    for ending in (".sti", ".mas", ".dof"):
        found = read_calculix(tmp_path / f"job{ending}")
        np.testing.assert_array_equal(found.K.toarray(), [[5, -2, 0], [-2, 4, 0], [0, 0, 1]])
        np.testing.assert_array_equal(found.M.toarray(), [[1, 0.5, 0], [0.5, 1, 0], [0, 0, 1]])
        assert (found.dofs.tolist(), found.source, found.C) == ([[9, 1], [2, 3], [2, 1]], f"job{ending}", None)
    for row, told in (("4 1", 4), ("1 4", 4), ("0 1", 0), ("1 0", 0)):
        file(tmp_path, f"{row} 1.\n", "job.mas")
        with pytest.raises(cf.errors.ModelError, match=rf"job\.mas: found row {told} of 3 dofs: .*matrix-size"):
            read_calculix(tmp_path / "job.sti")
    for ending in (".dof", ".mas"):
        (tmp_path / f"job{ending}").unlink()
        with pytest.raises(cf.errors.ModelError, match=rf"job\.sti: found no job\{ending} beside it"):
            read_calculix(tmp_path / "job.sti")


def test_files_of_a_pair_are_told_apart_by_their_names(tmp_path):
    text = SPARSE.format("real", "general") + "2 2 2\n1 1 {}\n2 2 1.\n"
    paths = [file(tmp_path, text.format(f"{k}."), f"{name}.mtx") for k, name in enumerate(("p_M", "p_C", "p_K"), 1)]
    file(tmp_path, "9.1\n2.3\n", "p_K.dof")
    found = read_mtx_pair(paths, None)
    assert [matrix[0, 0] for matrix in (found.M, found.C, found.K)] == [1.0, 2.0, 3.0]
    assert (found.dofs.tolist(), found.source) == ([[9, 1], [2, 3]], "p_M.mtx, p_C.mtx, p_K.mtx")
    given = read_mtx_pair(paths[::2], np.array([[4, 1], [5, 1]]))
    assert (given.dofs.tolist(), given.C) == ([[4, 1], [5, 1]], None)
    (tmp_path / "p_K.dof").unlink()
    with pytest.raises(cf.errors.ModelError, match=r"p_M\.mtx, p_K\.mtx: found no p_K\.dof beside it.*matrix-dofs"):
        read_mtx_pair(paths[::2], None)
