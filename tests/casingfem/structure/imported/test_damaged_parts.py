"""Damage that a campaign of mutations found to end in a traceback, or to fill the memory: refused, the file named."""

from io import BytesIO

import numpy as np
import pytest
from scipy.io import savemat

import casingfem as cf
from reports.verification.robustness.mesh_samples import SHELLS_BDF, TIED_INP, tetra_cdb
from reports.verification.robustness.sample_files import matrices

SET = matrices()
DOFS = {"dofs": SET.dofs}
PARTS = {f"{name}_{part}": getattr(A, part) for name, A in (("K", SET.K), ("M", SET.M)) for part in
         ("data", "indices", "indptr")}  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"K_indices": SET.K.indices + 8388613}, "K: .*indices"),
        ({"K_indices": SET.K.indices + 0.5j}, "K: found indices or indptr of real numbers"),
        ({"K_indptr": SET.K.indptr[None]}, "K: "),
        (
            {
                "K_indptr": np.where(
                    np.isin(np.arange(7), (3, 4)), (0, 0, 0, 2**30 + 2**29, -(2**30) - 2**29, 0, 0), SET.K.indptr
                ).astype(np.int32)
            },
            "K: found an indptr that decreases",
        ),
        ({"K_data": SET.K.data + 1j}, "found complex numbers"),
        ({"dofs": SET.dofs + 0.5}, "dofs: found other values"),
        ({"dofs": np.full((6, 2), np.nan)}, "dofs: found other values"),
        ({"dofs": SET.dofs.astype(str)}, r"dofs: found other values \(of type <U21\)"),
        ({"nodes": np.array([[np.nan, 0.0, 0.0, 0.0]])}, r"nodes: found other values \(of type float64\)"),
    ],
)
def test_arrays_that_are_no_matrices(changes, message, tmp_path):
    np.savez(tmp_path / "a.npz", **PARTS | DOFS | changes)
    with pytest.raises(cf.errors.ModelError, match=rf"a\.npz: (found )?{message}"):
        cf.imported.read_matrices(tmp_path / "a.npz")


@pytest.mark.slow
def test_a_matlab_file_whose_rows_are_beyond_its_matrix(tmp_path):
    stream = BytesIO()
    savemat(stream, {"K": SET.K, "M": SET.M} | DOFS)
    content = bytearray(stream.getvalue())
    rows = SET.K.indices.astype("<i4").tobytes()
    at = content.find(rows)
    assert at > 0
    content[at] = 133
    (tmp_path / "a.mat").write_bytes(content)
    with pytest.raises(cf.errors.ModelError, match=r"a\.mat: K: .*indices"):
        cf.imported.read_matrices(tmp_path / "a.mat")


@pytest.mark.parametrize(("old", "new"), [(b"SNOD", b"SNOX"), (b"TREE", b"TRXE")])
@pytest.mark.slow
def test_a_damaged_hdf5_file(old, new, tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["K"], file["M"], file["dofs"] = SET.K.toarray(), SET.M.toarray(), SET.dofs
    content = (tmp_path / "a.h5").read_bytes()
    assert old in content
    (tmp_path / "a.h5").write_bytes(content.replace(old, new))
    with pytest.raises(cf.errors.ModelError, match=r"a\.h5: found no readable HDF5 file"):
        cf.imported.read_matrices(tmp_path / "a.h5")


@pytest.mark.slow
def test_an_hdf5_matrix_that_states_it_fills_the_memory(tmp_path):
    """Nothing is stored of it: the file has some kilobytes."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("K", shape=(200_000, 200_000), dtype="f8", chunks=(1000, 1000))
        file["M"], file["dofs"] = SET.M.toarray(), SET.dofs
    with pytest.raises(cf.errors.ModelError, match=r"a\.h5: found no readable HDF5 file \(its reader took more than"):
        cf.imported.read_matrices(tmp_path / "a.h5")


@pytest.mark.parametrize("number", ["nan", "1e300", "7.5", "inf"])
def test_nodes_of_a_mtx_file_that_are_no_numbers_of_nodes(number, tmp_path):
    for name in ("K", "M"):
        (tmp_path / f"{name}.mtx").write_text(f"{number},1,7,1, 2.0\n")
    with pytest.raises(cf.errors.ModelError, match=r"K\.mtx: found rows or nodes that are not whole numbers"):
        cf.imported.read_matrices([tmp_path / "K.mtx", tmp_path / "M.mtx"])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("         1         2\n", "         1-999999999\n", "found a range up to 999999999, expected at most"),
        ("(8i10)", "(8i0)", "expected columns such as"),
        ("(3i9,", "(0i9,", "expected columns such as"),
        ("(19i9)", "(999999999i9)", "expected columns such as"),
    ],
)
def test_an_archive_that_would_fill_the_memory(old, new, message, tmp_path):
    text = tetra_cdb()
    assert old in text
    (tmp_path / "a.cdb").write_text(text.replace(old, new))
    with pytest.raises(cf.errors.ModelError, match=rf"a\.cdb: line \d+: .*{message}"):
        cf.read_mesh(tmp_path / "a.cdb")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("TYPE=NODE\nside\n", "TYPE=NODE\n", r"\*SURFACE one\.right: found no"),
        ("plate, SPOS\n", "", r"\*SURFACE one\.top: found no"),
        ("*INSTANCE, NAME=two", "*INSTANCE, NAME=one", "found the name 'ONE', expected a name that no other instance"),
        ("*INSTANCE, NAME=one,", "*INSTANCE,", "found the name '', expected a name that no other instance"),
        ("9001, .1, .1", "9" * 5000 + ", .1, .1", "expected numbers below"),
        ("3, 9, 3\n", "3, " + "9" * 40 + ", 3\n", "expected numbers below"),
        (".2, 0., 0.\n.2,", ".2, nan, 0.\n.2,", "expected numbers below"),
        (".2, 0., 0.\n.2,", ".2, 1e300, 0.\n.2,", "expected numbers below"),
        ("1., 0., 0.5\n", "1., 0., 1e999\n", "expected numbers below"),
        ("*NSET, NSET=root\n1,", "*NSET, NSET=root\n" + "1" * 5000 + ",", "no set '1111"),
    ],
)
def test_an_input_file_of_instances(old, new, message, tmp_path):
    assert TIED_INP.count(old) == 1
    (tmp_path / "a.inp").write_text(TIED_INP.replace(old, new))
    with pytest.raises(cf.errors.InputError, match=rf"a\.inp: line \d+: .*{message}"):
        cf.read_mesh(tmp_path / "a.inp")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("CTRIA6,1,7,1,3,9,2,6,5", "CTRIA6,1,7,0,3,9,2,6,5", "element 1 with 5 nodes, expected 3 corners"),
        ("CQUAD4,3,8,3,10,11,6", "CQUAD4,3,8,0,10,11,6", "element 3 with 3 nodes, expected 4 corners"),
        ("GRID,11,,.3", "GRID,11,,1e300", "found '1e300', expected a real number"),
    ],
)
def test_bulk_data_with_numbers_that_are_none(old, new, message, tmp_path):
    """A corner 0 is a node left out, which middles may be."""
    assert SHELLS_BDF.count(old) == 1
    (tmp_path / "a.bdf").write_text(SHELLS_BDF.replace(old, new))
    with pytest.raises(cf.errors.ModelError, match=rf"a\.bdf: line \d+: .*{message}"):
        cf.read_mesh(tmp_path / "a.bdf")
