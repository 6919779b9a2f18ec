"""Files that include others: whose lines stand where, names with either slash, how deep, which are listed."""

import pytest

import casingfem as cf
from casingfem.io.included import included_files, read_lines


def test_lines_stand_in_place_of_the_name_with_the_file_they_are_of(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "main.inp").write_text("*NODE\n*INCLUDE, INPUT=sub/a.inp\n*END\n")
    (tmp_path / "sub/a.inp").write_text("1, 2.\n*Include, input='b.inp'\n3, 4.\n*INCLUDE, INPUT=c.inp\n")
    (tmp_path / "sub/b.inp").write_text("5, 6.\n")
    (tmp_path / "c.inp").write_text("** beside the first\n")
    assert read_lines(tmp_path / "main.inp") == [
        ("1", "*NODE"), ("1 of a.inp", "1, 2."), ("1 of b.inp", "5, 6."), ("3 of a.inp", "3, 4."),
        ("1 of c.inp", "** beside the first"), ("3", "*END"),
    ]  # fmt: skip
    found = included_files(tmp_path / "main.inp")
    assert found == [tmp_path / "sub/a.inp", tmp_path / "sub/b.inp", tmp_path / "c.inp"]


def test_backslashes_of_another_system_separate_folders(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "main.bdf").write_text("INCLUDE 'sub\\a.bdf'\nGRID,1\n")
    (tmp_path / "sub/a.bdf").write_text("GRID,2\n")
    assert read_lines(tmp_path / "main.bdf") == [("1 of a.bdf", "GRID,2"), ("2", "GRID,1")]


def test_a_file_included_twice_is_read_twice_and_listed_once(tmp_path):
    (tmp_path / "main.inp").write_text("*INCLUDE, INPUT=a.inp\n*INCLUDE, INPUT=a.inp\n")
    (tmp_path / "a.inp").write_text("1\n")
    assert read_lines(tmp_path / "main.inp") == [("1 of a.inp", "1")] * 2
    assert included_files(tmp_path / "main.inp") == [tmp_path / "a.inp"]


def test_other_files_include_none(tmp_path):
    (tmp_path / "mesh.vtu").write_text("*INCLUDE, INPUT=a.inp\n")
    assert included_files(tmp_path / "mesh.vtu") == []
    assert included_files(tmp_path / "none.inp") == []


@pytest.mark.parametrize("depth", [20, 21])
def test_files_include_each_other_twenty_deep_at_most(depth, tmp_path):
    for k in range(depth):
        (tmp_path / f"{k}.inp").write_text(f"*INCLUDE, INPUT={k + 1}.inp\n")
    (tmp_path / f"{depth}.inp").write_text("last\n")
    if depth == 20:
        assert read_lines(tmp_path / "0.inp") == [("1 of 20.inp", "last")]
        return
    with pytest.raises(cf.errors.ModelError, match=r"0\.inp: line 1 of 20\.inp: 21\.inp includes itself"):
        read_lines(tmp_path / "0.inp")


def test_a_file_that_includes_one_above_it_is_refused_with_its_line(tmp_path):
    (tmp_path / "main.inp").write_text("**\n*INCLUDE, INPUT=a.inp\n")
    (tmp_path / "a.inp").write_text("1\n2\n*INCLUDE, INPUT=main.inp\n")
    with pytest.raises(cf.errors.ModelError, match=r"main\.inp: line 3 of a\.inp: main\.inp includes itself"):
        read_lines(tmp_path / "main.inp")
    (tmp_path / "a.inp").write_text("1\n*INCLUDE, INPUT=no.inp\n")
    with pytest.raises(cf.errors.ModelError, match=r"main\.inp: line 2 of a\.inp: found no file no\.inp"):
        read_lines(tmp_path / "main.inp")
