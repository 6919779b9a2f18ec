"""Matrices as named arrays: dense or in parts, with tables of dofs and nodes; what does not fit is refused."""

import re

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.imported.matrix.arrays import (
    fitting,
    hdf5_arrays,
    mat_arrays,
    put_together,
    read_arrays,
    read_from_mat,
    to_columns,
    whole_numbers,
)

K, M = np.array([[3.0, -1.0], [-1.0, 2.0]]), np.array([[5, 0], [0, 7]])
DOFS = np.array([[7, 1], [9, 3]])
WIDE = csc_array(np.array([[0.0, 2.0, 0.0], [1.0, 0.0, 4.0]]))


def read(folder, given=None, **arrays):
    np.savez(folder / "a.npz", **arrays)
    return read_arrays(folder / "a.npz", given)


def test_dense_arrays_with_tables(tmp_path):
    nodes = np.array([[9.0, 0.5, 1.5, 2.5], [7.0, 1.0, 2.0, 3.0]])
    found = read(
        tmp_path, K=K, M=M, dofs=DOFS.astype(float), nodes=nodes, C=0.5 * K, row=np.arange(2), wide=np.ones((2, 3))
    )
    np.testing.assert_array_equal(found.K.toarray(), K)
    np.testing.assert_array_equal(found.C.toarray(), 0.5 * K)
    assert (found.M.toarray().tolist(), found.M.dtype) == (M.tolist(), np.float64)
    assert (found.dofs.tolist(), found.dofs.dtype, found.source) == (DOFS.tolist(), np.int64, "a.npz")
    assert {node: x.tolist() for node, x in found.points.items()} == {9: [0.5, 1.5, 2.5], 7: [1.0, 2.0, 3.0]}


def test_a_table_that_is_given_stands_for_that_of_the_file(tmp_path):
    found = read(tmp_path, np.array([[1, 1], [2, 2]]), K=K, M=M, dofs=np.zeros((5, 9)))
    assert (found.dofs.tolist(), found.points, found.C) == ([[1, 1], [2, 2]], {}, None)


@pytest.mark.parametrize(
    ("arrays", "told"),
    [
        ({}, "a.npz: found no array dofs.*matrix-dofs"),
        ({"dofs": DOFS[:, :1]}, r"a.npz: dofs have shape \(2, 1\), expected \(n, 2\).*matrix-dofs"),
        (
            {"dofs": DOFS + 0.5},
            "a.npz: dofs: found float64, not all of them finite or whole, expected numbers.*matrix-dofs",
        ),
        ({"dofs": DOFS, "nodes": np.ones((2, 3))}, r"a.npz: nodes have shape \(2, 3\), expected \(n, 4\).*matrix-file"),
        ({"dofs": DOFS, "nodes": np.full((2, 4), 1.5)}, "a.npz: nodes: found float64, not all of them finite or whole"),
        (
            {"dofs": DOFS, "K": K * 1j},
            "a.npz: found K of complex numbers, expected K, M and C, each of real ones.*matrix-f",
        ),
        ({"dofs": DOFS, "K": K.astype(str)}, "a.npz: found the matrices M, 0 of them for K.*matrix-names"),
        ({"dofs": DOFS, "K": K[:1]}, "a.npz: found the matrices M, 0 of them for K.*matrix-names"),
    ],
)
def test_what_a_file_lacks_is_named(arrays, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=told):
        read(tmp_path, **({"K": K, "M": M} | arrays))


def test_tables_hold_whole_numbers_in_their_first_columns():
    for numbered, table in ((2, [[1.0, 2.0, 0.5]]), (1, [[1.0, 2.5, 0.5]]), (2, [[1, 2, 3]]), (2, np.zeros((0, 3)))):
        given = np.array(table)
        assert whole_numbers(given, 3, "matrix-file", "a: nodes", numbered) is given
    assert whole_numbers(np.array([[1.0, 2.0, 0.5]]), 3, "matrix-file", "a").tolist() == [[1.0, 2.0, 0.5]]
    for table in (
        [[1.0, 0.5, 2.0]],
        [[1.0, 2.0, np.nan]],
        [[np.inf, 2.0, 1.0]],
        [["1", "2", "3"]],
        [[True, False, True]],
    ):
        with pytest.raises(
            cf.errors.ModelError, match=r"a: nodes: found .*, not all of them finite or whole, expected numbers"
        ):
            whole_numbers(np.array(table), 3, "matrix-file", "a: nodes")
    with pytest.raises(cf.errors.ModelError, match=r"a have shape \(3,\), expected \(n, 3\)"):
        whole_numbers(np.zeros(3), 3, "matrix-file", "a")


def columns(data=(1.0, 2.0), rows=(0, 1), starts=(0, 1, 2)):
    return np.array(data), np.array(rows), np.array(starts)


def test_compressed_columns_that_fit():
    assert fitting("a", columns(), shape=(2, 2)).toarray().tolist() == [[1.0, 0.0], [0.0, 2.0]]
    assert fitting("a", columns(starts=(0, 2, 2)), shape=(2, 2)).toarray().tolist() == [[1.0, 0.0], [2.0, 0.0]]
    assert fitting("a", np.array([[1.0, 2.0]])).shape == (1, 2)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (columns(rows=(0.0, 1.0)), "found row numbers or starts of columns that are not whole numbers"),
        (columns(starts=(0.0, 1.0, 2.0)), "found row numbers or starts of columns that are not whole numbers"),
        (columns(rows=(0, 2)), "indices"),
        (columns(rows=(0, -1)), "indices"),
        (columns(starts=(0, 1, 3)), ""),
        (columns(starts=(1, 1, 2)), ""),
        (columns(starts=(0, 2)), ""),
        (columns(starts=(0, 3, 2)), ""),
    ],
)
def test_compressed_columns_that_do_not_fit_are_refused(given, told):
    with pytest.raises(cf.errors.ModelError, match=rf"a: .*{told}.*matrix-file"):
        fitting("a", given, shape=(2, 2))


def test_parts_of_arrays_are_put_together_by_their_names(tmp_path):
    parts = to_columns("wide_one", WIDE)
    assert sorted(parts) == ["wide_one_data", "wide_one_indices", "wide_one_indptr"]
    found = put_together(tmp_path, parts | {"wide_one_shape": np.array([[2, 3]]), "dense": K})
    assert sorted(found) == ["dense", "wide_one"]
    np.testing.assert_array_equal(found["wide_one"].toarray(), WIDE.toarray())
    square = put_together(tmp_path, to_columns("k", csc_array(K)))
    np.testing.assert_array_equal(square["k"].toarray(), K)
    for part in ("data", "indices"):
        some = {name: value for name, value in to_columns("k", csc_array(K)).items() if not name.endswith(part)}
        with pytest.raises(cf.errors.ModelError, match=re.escape("a.npz: k: expected k_data, k_indices, k_indptr")):
            put_together(tmp_path / "a.npz", some)


def test_matlab_variables_by_name_without_what_holds_no_numbers(tmp_path):
    cells = np.empty((2, 2), dtype=object)
    cells[:] = "x"
    savemat(tmp_path / "a.mat", {"K": K, "W": WIDE, "cells": cells})
    found = mat_arrays(tmp_path / "a.mat")
    assert sorted(found) == ["K", "W_data", "W_indices", "W_indptr", "W_shape", "cells"]
    np.testing.assert_array_equal(found["K"], K)
    assert found["W_shape"].tolist() == [2, 3]
    assert (found["cells"].shape, found["cells"].dtype.kind) == ((2, 2), "S")
    whole = put_together(tmp_path, found)
    np.testing.assert_array_equal(whole["W"].toarray(), WIDE.toarray())


def test_hdf5_data_sets_and_sparse_groups(tmp_path):
    """MATLAB keeps arrays turned, and the number of rows as an attribute, without which a matrix is square."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["plain"], file["row"] = np.arange(6.0).reshape(2, 3), np.arange(3.0)
        file["turned"] = np.arange(6.0).reshape(2, 3)
        file["turned"].attrs["MATLAB_class"] = np.bytes_("double")
        file.create_dataset("text", data=["a", "b"], dtype=h5py.string_dtype())
        file.create_group("other")["data"] = np.arange(3)
        for name, rows in (("W", 2), ("S", None)):
            matrix = WIDE if rows else csc_array(K)
            group = file.create_group(name)
            group["data"], group["ir"], group["jc"] = matrix.data, matrix.indices, matrix.indptr
            if rows:
                group.attrs["MATLAB_sparse"] = rows
    found = put_together(tmp_path, hdf5_arrays(tmp_path / "a.h5"))
    assert sorted(found) == ["S", "W", "plain", "row", "text", "turned"]
    assert found["plain"].tolist() == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]
    assert found["turned"].tolist() == [[0.0, 3.0], [1.0, 4.0], [2.0, 5.0]]
    assert found["row"].tolist() == [0.0, 1.0, 2.0]
    assert (found["text"].shape, found["text"].dtype.kind) == ((2,), "S")
    np.testing.assert_array_equal(found["W"].toarray(), WIDE.toarray())
    np.testing.assert_array_equal(found["S"].toarray(), K)


@pytest.mark.slow
def test_a_mat_file_of_version_73_is_read_as_hdf5(tmp_path):
    """512 bytes of MATLAB's own stand before it."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.mat", "w", userblock_size=512) as file:
        file["K"] = K
    assert (tmp_path / "a.mat").read_bytes()[512:516] == b"\x89HDF"
    assert read_from_mat(tmp_path / "a.mat")["K"].tolist() == K.tolist()
