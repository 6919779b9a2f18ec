"""Mesh files that include others, and last lines without an end: the same mesh, a warning, or an error."""

import warnings

import numpy as np
import pytest

import casingfem as cf

CELL = "*ELEMENT, TYPE=C3D4, ELSET=BODY\n1, 1, 2, 3, 4\n"
NODES = ("1, 0., 0., 0.\n", "2, 1.5, 0., 0.\n", "3, 0., 1.5, 0.\n", "4, 0., 0., 1.5\n")
THREE = CELL + "*NODE\n" + "".join(NODES[:3])
ABAQUS = THREE + NODES[3]
ELEMENTS = "*NODE\n" + "".join(NODES) + "*ELEMENT, TYPE=C3D4\n"
CARD = "CTETRA,1,1,1,2,3,4\nPSOLID,1,1\n"
PLACES = ((0.0, 0.0, 0.0), (1.5, 0.0, 0.0), (0.0, 1.5, 0.0), (0.0, 0.0, 1.5))
FREE = CARD + "".join(f"GRID,{k},,{x},{y},{z}\n" for k, (x, y, z) in enumerate(PLACES, 1))
NARROW = CARD + "".join(f"GRID    {k:8d}{'':8s}{x:8.5f}{y:8.5f}{z:8.5f}\n" for k, (x, y, z) in enumerate(PLACES, 1))
WIDE = CARD + "".join(
    f"GRID*   {k:16d}{'':16s}{x:16.13f}{y:16.13f}\n*       {z:16.13f}\n" for k, (x, y, z) in enumerate(PLACES, 1)
)
FORMS = {"abaqus.inp": ABAQUS, "free.bdf": FREE, "narrow.nas": NARROW, "wide.bdf": WIDE}


def read(path, text):
    """The mesh of a text, and whether a last line without an end was warned of."""
    path.write_text(text)
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        mesh = cf.read_mesh(path)
    return mesh, any("mesh-last-line" in str(one.message) for one in given)


def same(one, other):
    return (
        np.array_equal(one.points, other.points)
        and np.array_equal(one.cells, other.cells)
        and list(one.groups) == list(other.groups)
    )


@pytest.mark.parametrize("name", FORMS)
def test_a_file_that_was_cut_anywhere_in_its_last_lines_is_refused_or_warned_of_unless_its_mesh_is_the_same(
    name, tmp_path
):
    text = FORMS[name]
    whole, warned = read(tmp_path / name, text)
    assert not warned
    np.testing.assert_allclose(whole.points, PLACES)
    found = set()
    for end in range(len(text) - 1, len(text) - 60, -1):
        try:
            mesh, warned = read(tmp_path / name, text[:end])
        except cf.errors.ModelError:
            found.add("refused")
        else:
            assert warned or same(mesh, whole)
            found.add("warned" if warned else "same")
    assert "refused" in found


WHOLE = {
    "a keyword that is not read": ("inp", ABAQUS + "*BOUNDARY\n3, 1, 3"),
    "the end of a step": ("inp", ABAQUS + "*END STEP"),
    "a comment": ("inp", ABAQUS + "** made by hand"),
    "blanks": ("inp", ABAQUS + "   "),
    "a number that a blank follows": ("inp", ABAQUS[:-1] + " "),
    "a number that a comma follows": ("inp", ABAQUS[:-2] + ","),
    "a number as wide as all others": ("inp", THREE + "5, 0.5, 2.5, 0.5\n4, 0.0, 1.0, 1.0"),
    "whole numbers of one width": ("inp", ELEMENTS + "21, 1, 2, 3, 4\n22, 1, 2, 3, 4"),
    "a card that is not read": ("bdf", FREE + "EIGRL,1,,,10"),
    "the end of the data": ("bdf", FREE + "ENDDATA"),
    "what follows the end of the data": ("bdf", FREE + "ENDDATA\nGRID,1,,0."),
    "a field of eight full columns": ("bdf", NARROW[:-1]),
}  # fmt: skip
SHORT = {
    "a decimal that ends in its point": ("inp", THREE + "5, 1., 1., 1.\n4, 0., 0., 1."),
    "a decimal beside wider ones": ("inp", THREE + "5, 0., 0., 1.5\n4, 0., 1.55, 0.5"),
    "in free fields": ("bdf", FREE[:-3] + "."),
    "in columns": ("nas", NARROW[:-5] + "0"),
}  # fmt: skip
CUT = {
    "fewer fields": ("inp", THREE + "4, 0., 0."),
    "a whole number beside wider ones": ("inp", ELEMENTS + "1, 1, 2, 3, 99\n2, 1, 2, 3, 10"),
    "an exponent that may go on": ("inp", THREE + "4, 0., 0., 1.5E+0"),
    "a decimal without its point": ("inp", THREE + "4, 0., 0., 1"),
    "the first line of its keyword": ("inp", CELL + "*NODE\n" + NODES[0][:-1]),
    "a keyword that may go on": ("inp", ABAQUS + "*NOD"),
    "a name of a set": ("inp", ABAQUS + "*NSET, NSET=A\n1, 2\nBO"),
    "a name of a card that may go on": ("bdf", FREE + "GRI"),
    "another card above": ("bdf", FREE + "CTETRA,7,1,1,2,3"),
}  # fmt: skip


@pytest.mark.parametrize("case", WHOLE)
def test_a_last_line_that_must_be_whole_is_taken_without_its_end(case, tmp_path):
    ending, text = WHOLE[case]
    mesh, warned = read(tmp_path / f"a.{ending}", text)
    assert not warned
    assert same(mesh, read(tmp_path / f"b.{ending}", text + "\n")[0])


@pytest.mark.parametrize("case", SHORT)
def test_a_last_number_that_may_lack_digits_is_warned_of(case, tmp_path):
    ending, text = SHORT[case]
    mesh, warned = read(tmp_path / f"a.{ending}", text)
    assert warned
    assert same(mesh, read(tmp_path / f"b.{ending}", text + "\n")[0])


@pytest.mark.parametrize("case", CUT)
def test_a_last_line_that_may_lack_a_part_is_refused(case, tmp_path):
    ending, text = CUT[case]
    with pytest.raises(
        cf.errors.ModelError, match=rf"a\.{ending}: found no line break after the last line, .*: cut short\?"
    ):
        read(tmp_path / f"a.{ending}", text)


INCLUDE = {"inp": "*Include, input='{}'\n", "bdf": "INCLUDE '{}'\n"}


@pytest.mark.parametrize("ending", INCLUDE)
@pytest.mark.parametrize("deep", [1, 2, 20])
def test_a_file_in_pieces_is_the_file_at_any_depth(ending, deep, tmp_path):
    """Each piece includes the next one after its first line."""
    lines = {"inp": ABAQUS, "bdf": FREE}[ending].splitlines(keepends=True)
    expected, _ = read(tmp_path / f"whole.{ending}", "".join(lines))
    names = [f"main.{ending}", *(f"piece{k}.txt" for k in range(1, deep + 1))]
    comment = {"inp": "** a piece\n", "bdf": "$ a piece\n"}[ending]
    for k, name in enumerate(names):
        own = [lines[k]] if k < len(lines) else [comment]
        rest = [INCLUDE[ending].format(names[k + 1])] if k < deep else lines[k + 1 :]
        (tmp_path / name).write_text("".join([*own, *rest]))
    assert same(cf.read_mesh(tmp_path / names[0]), expected)


def test_files_that_include_each_other_too_deep_or_in_a_circle_are_refused_with_the_line(tmp_path):
    for k in range(21):
        (tmp_path / f"{k}.inp").write_text(f"*INCLUDE, INPUT={k + 1}.inp\n")
    (tmp_path / "21.inp").write_text(ABAQUS)
    with pytest.raises(cf.errors.ModelError, match=r"0\.inp: line 1 of 20\.inp: found 21\.inp, which includes itself"):
        cf.read_mesh(tmp_path / "0.inp")
    (tmp_path / "main.inp").write_text(ABAQUS + "*INCLUDE, INPUT=a.inp\n")
    (tmp_path / "a.inp").write_text("**\n**\n*INCLUDE, INPUT=main.inp\n")
    with pytest.raises(cf.errors.ModelError, match=r"main\.inp: line 3 of a\.inp: found main\.inp, which includes"):
        cf.read_mesh(tmp_path / "main.inp")
    (tmp_path / "a.inp").write_text("**\n*INCLUDE, INPUT=no.inp\n")
    with pytest.raises(cf.errors.ModelError, match=r"main\.inp: line 2 of a\.inp: found no file no\.inp"):
        cf.read_mesh(tmp_path / "main.inp")


def test_an_included_file_is_looked_for_beside_the_one_that_names_it_and_then_beside_the_first(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "main.inp").write_text(CELL + "*INCLUDE, INPUT=parts\\a.inp\n")
    (tmp_path / "parts" / "a.inp").write_text("*NODE\n*INCLUDE, INPUT=b.inp\n")
    (tmp_path / "b.inp").write_text("".join(NODES).replace("1.5", "3.0"))
    np.testing.assert_allclose(cf.read_mesh(tmp_path / "main.inp").points, 2.0 * np.array(PLACES))
    (tmp_path / "parts" / "b.inp").write_text("".join(NODES))
    np.testing.assert_allclose(cf.read_mesh(tmp_path / "main.inp").points, PLACES)
