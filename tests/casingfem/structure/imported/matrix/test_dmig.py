"""DMIG cards field by field: headers, columns, grids, what is passed over and what is refused."""

import numpy as np
import pytest

import casingfem as cf

HEAD = "DMIG,KAA,0,{form},{kind},0\n"
MASS = "DMIG,MAA,0,6,2,0\nDMIG,MAA,7,1,,7,1,2.\nDMIG,MAA,7,3,,7,3,3.\nDMIG,MAA,4,,,4,,5.\n"
FULL = "DMIG,KAA,7,1,,7,1,10.\n,7,3,-1.\nDMIG,KAA,7,3,,7,3,20.\n,7,1,-2.\nDMIG,KAA,4,,,4,,30.\n,7,3,-3.\n"


def read(folder, text):
    (folder / "a.pch").write_text(text)
    return cf.imported.read_matrices(folder / "a.pch")


def test_a_column_has_the_entries_of_its_rows(tmp_path):
    """Two rows a card; a missing component is that of a scalar point, which stand last."""
    text = HEAD.format(form=1, kind=2) + FULL.replace("\n,7,3,-1.", "\n,,,,,7,3,-1.") + MASS
    found = read(tmp_path, "GRID,7,,1.,2.,3.\n" + text)
    assert found.dofs.tolist() == [[7, 1], [7, 3], [4, 0]]
    np.testing.assert_array_equal(found.K.toarray(), [[10.0, -2.0, 0.0], [-1.0, 20.0, -3.0], [0.0, 0.0, 30.0]])
    np.testing.assert_array_equal(found.M.toarray(), np.diag([2.0, 3.0, 5.0]))
    assert found.C is None
    assert {number: x.tolist() for number, x in found.points.items()} == {7: [1.0, 2.0, 3.0]}
    assert found.source == "a.pch"


def test_a_symmetric_matrix_has_each_entry_on_both_sides(tmp_path):
    """One of which is given on both: the others are mirrored."""
    text = HEAD.format(form=6, kind=1) + FULL.replace("-2.", "-1.")
    found = read(tmp_path, text + MASS.replace("MAA", "maa"))
    np.testing.assert_array_equal(found.K.toarray(), [[10.0, -1.0, 0.0], [-1.0, 20.0, -3.0], [0.0, -3.0, 30.0]])


def test_damping_is_read_where_it_is_given(tmp_path):
    text = "DMIG,BAA,0,6,2,0\nDMIG,BAA,7,1,,7,3,.5\n"
    found = read(tmp_path, HEAD.format(form=1, kind=2) + FULL + MASS + text)
    np.testing.assert_array_equal(found.C.toarray(), [[0.0, 0.5, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0]])


@pytest.mark.parametrize(("form", "kind"), [(9, 2), (2, 2), (1, 3), (6, 4), (9, 5)])
def test_what_is_rectangular_or_complex_is_passed_over_unless_it_is_one_of_a_set(form, kind, tmp_path):
    text = HEAD.format(form=1, kind=2) + FULL + MASS
    other = f"DMIG,KVIS,0,{form},{kind},0\nDMIG,KVIS,7,1,,9,1,10.\n"
    assert read(tmp_path, other + text).dofs.tolist() == [[7, 1], [7, 3], [4, 0]]
    with pytest.raises(
        cf.errors.ModelError,
        match=rf"a\.pch: line 1: DMIG: found KAA of form {form} and type {kind}, expected form 1 or 6",
    ):
        read(tmp_path, HEAD.format(form=form, kind=kind) + FULL + MASS)


@pytest.mark.parametrize(("form", "kind"), [(3, 2), (1, 5), (1, ""), ("", 2), (6, 0)])
def test_forms_and_types_that_there_are_not_are_refused(form, kind, tmp_path):
    with pytest.raises(
        cf.errors.ModelError, match=rf"line 1: DMIG: found KXY of form {form} and type {kind}, expected form 1 or 6"
    ):
        read(tmp_path, f"DMIG,KXY,0,{form},{kind},0\n")


@pytest.mark.parametrize(
    ("card", "told"),
    [
        ("DMIG,KAA", "found 1 fields, expected a name, a node and a component"),
        ("DMIG,KAA,8", "found 2 fields, expected a name, a node and a component"),
        ("DMIG,KBB,7,1,,7,1,1.", "found a column of KBB before its header"),
        ("DMIG,KAA,7,1,,7,1", "found 7, 1, expected node, component and value of a row"),
        ("DMIG,KAA,7,1,,,1,1.", "found , 1, 1., expected node, component and value of a row"),
        ("DMIG,KAA,7,1,,7,1,,2.", "found 7, 1, , 2., expected node, component and value of a row"),
        ("DMIG,KAA,x,1,,7,1,1.", "found 'x', expected a whole number"),
        ("DMIG,KAA,7,x,,7,1,1.", "found 'x', expected a whole number"),
        ("DMIG,KAA,7,1,,7,x,1.", "found 'x', expected a whole number"),
        ("DMIG,KAA,7,1,,7,1,x", "found 'x', expected a real number"),
    ],
)
def test_columns_that_are_not_whole_are_refused(card, told, tmp_path):
    text = HEAD.format(form=1, kind=2) + FULL + MASS
    with pytest.raises(cf.errors.ModelError, match=rf"a\.pch: line 12: DMIG: {told}"):
        read(tmp_path, f"{text}{card}\n")


def test_a_second_header_of_one_name_is_a_column(tmp_path):
    """Node 0: a matrix begins but once."""
    text = HEAD.format(form=1, kind=2) + FULL + MASS
    assert read(tmp_path, text + "DMIG,KAA,0,6\n").dofs.tolist() == [[7, 1], [7, 3], [4, 0]]
