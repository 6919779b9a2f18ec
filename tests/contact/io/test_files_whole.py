"""Files on their way: a folder that is not there gets a whole set, and a file that cannot be written is named."""

import numpy as np
import pytest
from click.testing import CliRunner

import contact as ct
from casingfem.cli import main

BODY = ct.ModalBody(omega=[10.0], zeta=[0.0], channels=("span",), rows=[[1.0]], S=[[0.0]])


def test_a_folder_that_is_not_there_gets_the_whole_set_and_nothing_stays_beside_it(tmp_path):
    out = tmp_path / "far" / "new" / "out"
    done = CliRunner().invoke(main, ["new", str(out)])
    assert done.exit_code == 0, done.output
    assert sorted(path.name for path in out.iterdir()) == [
        "blade.toml", "casing.toml", "frequencies.csv", "rub.toml", "survey.csv"
    ]  # fmt: skip
    assert [path.name for path in (tmp_path / "far" / "new").iterdir()] == ["out"]


def test_a_file_takes_the_place_of_an_older_one_whole(tmp_path):
    path = tmp_path / "deep" / "body.npz"
    path.parent.mkdir()
    path.write_bytes(b"older")
    BODY.save(path)
    np.testing.assert_array_equal(ct.ModalBody.load(path).omega, BODY.omega)
    assert [file.name for file in path.parent.iterdir()] == ["body.npz"]


@pytest.mark.parametrize("name", ["file/body.npz", "folder"])
def test_a_file_that_cannot_be_written_is_named_and_nothing_is_left(tmp_path, name):
    (tmp_path / "file").write_text("x")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError, match=name.partition("/")[0]) as caught:
        BODY.save(tmp_path / name)
    assert caught.value.filename == str(tmp_path / name.partition("/")[0])
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["file", "folder"]
    assert (tmp_path / "file").read_text() == "x"
