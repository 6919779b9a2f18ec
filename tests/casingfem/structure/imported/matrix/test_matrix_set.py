"""What matrices are by their names, entries on one side or both, and which sets are none."""

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.imported.matrix.matrix_set import from_triples, role_of, roles_of

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
def test_what_a_name_says(name, role):
    assert role_of(name) == role


@pytest.mark.parametrize(
    ("names", "roles"),
    [
        (["K", "M"], {"K": "K", "M": "M"}),
        (["MAA", "BAA", "KAA", "P"], {"K": "KAA", "M": "MAA", "C": "BAA"}),
        (["KASMX", "KGGX", "MGGX", "MASMX"], {"K": "KGGX", "M": "MGGX"}),
        (["Kab", "m"], {"K": "Kab", "M": "m"}),  # alone, it need be no set of Nastran's
    ],
)
def test_which_matrix_is_which(names, roles):
    assert roles_of(names, "a") == roles


@pytest.mark.parametrize(
    ("names", "told"),
    [
        ([], "a: found the matrices none, 0 of them for K"),
        (["M"], "a: found the matrices M, 0 of them for K"),
        (["K"], "a: found the matrices K, 0 of them for M"),
        (["KAA", "KGG", "M"], "a: found the matrices KAA, KGG, M, 2 of them for K"),
        (["K", "Kab", "M"], "a: found the matrices K, Kab, M, 2 of them for K"),
        (["K", "M", "C", "Ba"], "a: found the matrices K, M, C, Ba, 2 of them for C"),
    ],
)
def test_none_or_several_of_a_kind_are_refused(names, told):
    with pytest.raises(cf.errors.ModelError, match=f"{told}.*matrix-names"):
        roles_of(names, "a")


def triples(*entries, **options):
    rows, columns, values = (np.array(part) for part in zip(*entries, strict=True))
    return from_triples(rows, columns, values.astype(float), 3, **options).toarray()


def test_entries_of_one_side_are_those_of_the_other():
    """In whatever order of rows: (0, 1) above the diagonal and (2, 0) below it."""
    wanted = [[5.0, 1.5, -2.0], [1.5, 4.0, 0.0], [-2.0, 0.0, 0.0]]
    np.testing.assert_array_equal(triples((0, 0, 5), (0, 1, 1.5), (2, 0, -2), (1, 1, 4)), wanted)


def test_entries_on_both_sides_are_each_their_own_unless_told_to_be_symmetric():
    entries = ((0, 0, 5), (0, 1, 1.5), (1, 0, 2.5), (2, 0, -2))
    np.testing.assert_array_equal(triples(*entries), [[5, 1.5, 0], [2.5, 0, 0], [-2, 0, 0]])
    entries = ((0, 0, 5), (0, 1, 1.5), (1, 0, 1.5), (2, 0, -2))
    np.testing.assert_array_equal(triples(*entries, symmetric=True), [[5, 1.5, -2], [1.5, 0, 0], [-2, 0, 0]])


def test_an_entry_of_zero_on_the_other_side_is_one_and_is_not_kept():
    found = from_triples(np.array([0, 1, 2]), np.array([1, 0, 2]), np.array([3.0, 0.0, 1.0]), 3)
    np.testing.assert_array_equal(found.toarray(), [[0, 3, 0], [0, 0, 0], [0, 0, 1]])
    assert found.nnz == 2


def test_a_set_has_a_dof_for_each_row():
    two = csc_array(np.eye(2))
    dofs = np.array([[7, 1], [7, 2]])
    assert cf.imported.MatrixSet(K=two, M=two, dofs=dofs).source == "matrices"
    for changes, told in (
        ({"M": ONE}, "found K 2 x 2, M 1 x 1 and 2 dofs"),
        ({"C": csc_array(np.ones((2, 3)))}, "found K 2 x 2, M 2 x 2, C 2 x 3 and 2 dofs"),
        ({"dofs": dofs[:1]}, "found K 2 x 2, M 2 x 2 and 1 dofs"),
    ):
        with pytest.raises(cf.errors.ModelError, match=f"a: {told}.*matrix-size"):
            cf.imported.MatrixSet(**({"K": two, "M": two, "dofs": dofs, "source": "a"} | changes))
    with pytest.raises(cf.errors.ModelError, match=r"a: found direction 2 of node 7 twice.*matrix-dofs"):
        cf.imported.MatrixSet(
            K=csc_array(np.eye(3)), M=csc_array(np.eye(3)), dofs=np.array([[7, 2], [7, 1], [7, 2]]), source="a"
        )
    empty = csc_array((0, 0))
    with pytest.raises(cf.errors.ModelError, match=r"a: found no entries and no dofs.*matrix-file"):
        cf.imported.MatrixSet(K=empty, M=empty, dofs=np.zeros((0, 2), dtype=int), source="a")
