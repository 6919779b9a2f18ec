"""Matrices as named arrays: dense or in parts, with tables of dofs and nodes; what does not fit is refused."""

import re

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_array

import casingfem as cf

K, M = np.array([[3.0, -1.0], [-1.0, 2.0]]), np.array([[5, 0], [0, 7]])
DOFS = np.array([[7, 1], [9, 3]])
WIDE = csc_array(np.array([[0.0, 2.0, 0.0], [1.0, 0.0, 4.0]]))


def read(folder, table=None, **arrays):
    np.savez(folder / "a.npz", **arrays)
    if table is not None:
        (folder / "dofs.csv").write_text("node,direction\n" + table)
    return cf.imported.read_matrices(folder / "a.npz", dofs=None if table is None else folder / "dofs.csv")


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


def test_a_table_that_is_given_represents_that_of_the_file(tmp_path):
    found = read(tmp_path, "1,x\n2,y\n", K=K, M=M, dofs=np.zeros((5, 9)))
    assert (found.dofs.tolist(), found.points, found.C) == ([[1, 1], [2, 2]], {}, None)


@pytest.mark.parametrize(
    ("arrays", "told"),
    [
        ({}, r"a\.npz: found no array named dofs.*matrix-dofs"),
        ({"dofs": DOFS[:, :1]}, r"a\.npz: dofs: found the shape \(2, 1\), expected \(n, 2\).*matrix-dofs"),
        (
            {"dofs": DOFS + 0.5},
            r"a\.npz: dofs: found other values \(of type float64\), expected finite numbers.*matrix-dofs",
        ),
        (
            {"dofs": DOFS, "nodes": np.ones((2, 3))},
            r"a\.npz: nodes: found the shape \(2, 3\), expected \(n, 4\).*matrix-file",
        ),
        (
            {"dofs": DOFS, "nodes": np.full((2, 4), 1.5)},
            r"a\.npz: nodes: found other values \(of type float64\), expected finite numbers, and whole",
        ),
        (
            {"dofs": DOFS, "K": K * 1j},
            r"a\.npz: found complex numbers in K, expected real K, M and C.*matrix-f",
        ),
        ({"dofs": DOFS, "K": K.astype(str)}, "a.npz: found the matrices M; 0 of these names mean K.*matrix-names"),
        ({"dofs": DOFS, "K": K[:1]}, "a.npz: found the matrices M; 0 of these names mean K.*matrix-names"),
    ],
)
def test_what_a_file_lacks_is_named(arrays, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=told):
        read(tmp_path, **({"K": K, "M": M} | arrays))


@pytest.mark.parametrize("dofs", [[[1.0, 0.5]], [[1.0, np.nan]], [[np.inf, 2.0]], [["1", "2"]], [[True, False]]])
def test_dofs_that_are_not_whole_numbers_are_refused(dofs, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=r"a.npz: dofs: found other values \(of type .*, expected"):
        read(tmp_path, K=np.eye(1), M=np.eye(1), dofs=np.array(dofs))


def columns(data=(1.0, 2.0), rows=(0, 1), starts=(0, 1, 2)):
    """K in compressed columns."""
    return {"K_data": np.array(data), "K_indices": np.array(rows), "K_indptr": np.array(starts)}


def test_compressed_columns_that_fit(tmp_path):
    assert read(tmp_path, M=M, dofs=DOFS, **columns()).K.toarray().tolist() == [[1.0, 0.0], [0.0, 2.0]]
    shape = {"K_shape": np.array([[2, 2]])}
    for more in ({}, shape):
        found = read(tmp_path, M=M, dofs=DOFS, **columns(starts=(0, 2, 2)), **more)
        assert found.K.toarray().tolist() == [[1.0, 0.0], [2.0, 0.0]]
    for part in ("data", "indices"):
        some = {name: value for name, value in columns().items() if not name.endswith(part)}
        with pytest.raises(
            cf.errors.ModelError, match=re.escape("a.npz: K: found only a part of the arrays, expected K_data, K_in")
        ):
            read(tmp_path, M=M, dofs=DOFS, **some)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (columns(rows=(0.0, 1.0)), "found indices or indptr of real numbers"),
        (columns(starts=(0.0, 1.0, 2.0)), "found indices or indptr of real numbers"),
        (columns(rows=(0, 2)), "indices"),
        (columns(rows=(0, -1)), "indices"),
        (columns(starts=(0, 1, 3)), ""),
        (columns(starts=(1, 1, 2)), ""),
        (columns(starts=(0, 3, 2)), ""),
    ],
)
def test_compressed_columns_that_do_not_fit_are_refused(given, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.npz: .*{told}.*matrix-file"):
        read(tmp_path, M=M, dofs=DOFS, **given)


def test_matlab_variables_by_name_without_what_keeps_no_numbers(tmp_path):
    cells = np.empty((2, 2), dtype=object)
    cells[:] = "x"
    savemat(tmp_path / "a.mat", {"K": csc_array(K), "M": M, "dofs": DOFS, "W": WIDE, "cells": cells})
    found = cf.imported.read_matrices(tmp_path / "a.mat")
    np.testing.assert_array_equal(found.K.toarray(), K)
    np.testing.assert_array_equal(found.M.toarray(), M)


def test_hdf5_data_sets_and_sparse_groups(tmp_path):
    """MATLAB keeps arrays turned, and the number of rows as an attribute, without which a matrix is square."""
    h5py = pytest.importorskip("h5py")
    uneven = np.array([[1.0, 2.0], [3.0, 4.0]])
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["M"], file["C"], file["dofs"], file["row"] = uneven, uneven, DOFS, np.arange(3.0)
        file["C"].attrs["MATLAB_class"] = np.bytes_("double")
        file.create_dataset("text", data=["a", "b"], dtype=h5py.string_dtype())
        file.create_group("other")["data"] = np.arange(3)
        for name, matrix, rows in (("K", csc_array(uneven), 2), ("K4AA", csc_array(K), None)):
            group = file.create_group(name)
            group["data"], group["ir"], group["jc"] = matrix.data, matrix.indices, matrix.indptr
            if rows:
                group.attrs["MATLAB_sparse"] = rows
    found = cf.imported.read_matrices(tmp_path / "a.h5")
    for read_in, wanted in ((found.M, uneven), (found.C, uneven.T), (found.K, uneven), (found.K4, K)):
        np.testing.assert_array_equal(read_in.toarray(), wanted)


@pytest.mark.slow
def test_a_mat_file_of_version_73_is_read_as_hdf5(tmp_path):
    """512 bytes of MATLAB's own are before it."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.mat", "w", userblock_size=512) as file:
        file["K"], file["M"], file["dofs"] = K, M, DOFS
    assert (tmp_path / "a.mat").read_bytes()[512:516] == b"\x89HDF"
    assert cf.imported.read_matrices(tmp_path / "a.mat").K.toarray().tolist() == K.tolist()
