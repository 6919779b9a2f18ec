"""What matrices are by their names, entries on one side or both, and which sets are none."""

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf

ONE = csc_array(np.eye(1))


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("KAAX", "K"), ("maa", "M"), ("BAA", "C"), ("C", "C"), ("K2GG", "K"), ("K4AA", "K4"), ("kit_M", "M"),
        ("Mine_K", "K"),
        ("part.c", "C"), ("part-k", "K"), ("kit_x", "K"), ("MASS1", "M"), ("job_STIF1", "K"), ("job_DAMP1", "C"),
        ("kdmpv", "C"), ("PAX", ""), ("Stiffness", "K"), ("x", ""), ("K_MASS", "M"), ("x_K4AA", "K4"),
    ],
)  # fmt: skip
def test_what_a_name_states(name, role, tmp_path):
    """Beside a stiffness and a mass, unless the name is one itself."""
    others = {"MGGX": np.full((1, 1), 3.0), "KGGX": np.full((1, 1), 4.0)}
    others.pop({"K": "KGGX", "M": "MGGX"}.get(role, ""), None)
    found = read(tmp_path, others | {name: np.full((1, 1), 2.0)})
    assert {own: A[0, 0] for own, A in found.named.items() if A[0, 0] == 2.0} == ({role: 2.0} if role else {})


def read(folder, matrices):
    np.savez(folder / "a.npz", dofs=np.array([[1, 1]]), **matrices)
    return cf.imported.read_matrices(folder / "a.npz")


@pytest.mark.parametrize(
    ("names", "roles"),
    [
        (["K", "M"], {"K": "K", "M": "M"}),
        (["MAA", "BAA", "KAA", "P"], {"K": "KAA", "M": "MAA", "C": "BAA"}),
        (["KASMX", "KGGX", "MGGX", "MASMX"], {"K": "KGGX", "M": "MGGX"}),
        (["Kab", "m"], {"K": "Kab", "M": "m"}),  # alone, it need be no set of Nastran's
        (["K2GG", "M2GG", "B2GG", "K42GG"], {"K": "K2GG", "M": "M2GG", "C": "B2GG", "K4": "K42GG"}),
        (["job_STIF1", "job_MASS1", "job_DMPV1"], {"K": "job_STIF1", "M": "job_MASS1", "C": "job_DMPV1"}),
    ],
)
def test_which_matrix_is_which(names, roles, tmp_path):
    found = read(tmp_path, {name: np.full((1, 1), 1.0 + k) for k, name in enumerate(names)})
    assert {role: names[int(A[0, 0]) - 1] for role, A in found.named.items()} == roles


@pytest.mark.parametrize(
    ("names", "told"),
    [
        ([], "found the matrices none; 0 of these"),
        (["M"], "found the matrices M; 0 of these"),
        (["K"], "found the matrices K; 0 of these"),
        (["KAA", "KGG", "M"], "found the matrices KAA, KGG, M; 2 of these"),
        (["K", "Kab", "M"], "found the matrices K, Kab, M; 2 of these"),
        (["K", "M", "C", "Ba"], "found the matrices K, M, C, Ba; 2 of these"),
    ],
)
def test_none_or_several_of_a_kind_are_refused(names, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.npz: {told}.*matrix-names"):
        read(tmp_path, dict.fromkeys(names, np.eye(1)))


def test_entries_of_one_side_are_those_of_the_other_unless_both_are_given(tmp_path):
    """Files of CalculiX: in whatever order of rows, (0, 1) above the diagonal and (2, 0) below it."""
    (tmp_path / "a.dof").write_text("1.1\n2.1\n3.1\n")
    (tmp_path / "a.mas").write_text("1 1 5.\n1 2 1.5\n2 1 1.5\n3 1 -2.\n")
    (tmp_path / "a.sti").write_text("1 1 5.\n1 2 1.5\n3 1 -2.\n2 2 4.\n")
    found = cf.imported.read_matrices(tmp_path / "a.sti")
    np.testing.assert_array_equal(found.K.toarray(), [[5.0, 1.5, -2.0], [1.5, 4.0, 0.0], [-2.0, 0.0, 0.0]])
    np.testing.assert_array_equal(found.M.toarray(), [[5.0, 1.5, 0.0], [1.5, 0.0, 0.0], [-2.0, 0.0, 0.0]])


def test_a_set_has_a_dof_for_each_row():
    two = csc_array(np.eye(2))
    dofs = np.array([[7, 1], [7, 2]])
    assert cf.imported.MatrixSet(K=two, M=two, dofs=dofs).source == "matrices"
    for changes, told in (
        ({"M": ONE}, "found K of 2 x 2, M of 1 x 1, and 2 dofs"),
        ({"C": csc_array(np.ones((2, 3)))}, "found K of 2 x 2, M of 2 x 2, C of 2 x 3, and 2 dofs"),
        ({"dofs": dofs[:1]}, "found K of 2 x 2, M of 2 x 2, and 1 dofs"),
    ):
        with pytest.raises(cf.errors.ModelError, match=f"a: {told}.*matrix-size"):
            cf.imported.MatrixSet(**({"K": two, "M": two, "dofs": dofs, "source": "a"} | changes))
    with pytest.raises(cf.errors.ModelError, match=r"a: found direction 2 of node 7 in two rows.*matrix-dofs"):
        cf.imported.MatrixSet(
            K=csc_array(np.eye(3)), M=csc_array(np.eye(3)), dofs=np.array([[7, 2], [7, 1], [7, 2]]), source="a"
        )
    empty = csc_array((0, 0))
    with pytest.raises(cf.errors.ModelError, match=r"a: found no entries and no dofs.*matrix-file"):
        cf.imported.MatrixSet(K=empty, M=empty, dofs=np.zeros((0, 2), dtype=int), source="a")
