"""Parts of commands by themselves: numbers of modes and nodes, files, exit codes, warnings."""

import json
import warnings
from pathlib import Path
from types import SimpleNamespace

import click
import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import matrices, mode_files, running, study


@pytest.mark.parametrize(("text", "found"), [(None, None), ("3", (3,)), ("2, 1,2", (2, 1)), ("10,1", (10, 1))])
def test_modes_are_chosen_once_each_in_the_order_given(text, found):
    assert study.numbers(None, None, text) == found


@pytest.mark.parametrize("text", ["", "0", "1,0", "1,,2", "-1", "1.0", "one"])
def test_numbers_of_modes_begin_with_one(text):
    with pytest.raises(click.BadParameter, match="expected mode numbers such as 1,2,5"):
        study.numbers(None, None, text)


@pytest.mark.parametrize(("text", "found"), [(None, None), ("0", [0]), ("6, 79,6", [6, 79, 6])])
def test_nodes_are_taken_as_they_are_given(text, found):
    assert matrices.node_list(None, None, text) == found


@pytest.mark.parametrize("text", ["", "6,", "-6", "a"])
def test_nodes_are_whole_numbers(text):
    with pytest.raises(click.BadParameter, match="expected node numbers such as 6,79"):
        matrices.node_list(None, None, text)


def test_modes_that_are_shown_are_among_those_computed():
    assert mode_files.indices([0] * 3, None) is None
    assert mode_files.indices([0] * 3, (3, 1)) == [2, 0]
    with pytest.raises(click.UsageError, match="--modes: found 4, expected numbers up to the 3 modes computed"):
        mode_files.indices([0] * 3, (1, 4, 2))


def test_the_table_of_modes_states_its_uncertainty_and_has_no_damping():
    row = {"mode": 1, "n": None, "freq_hz": 200.0, "angle_deg": 5.0, "n_purity": 0.9, "m": 2, "doublet": None,
           "split_rel": None, "rigid": False}  # fmt: skip
    found = SimpleNamespace(records=lambda: [row])
    source = {"study": "a.toml", "sha256": "abc", "versions": {"casingfem": "1", "numpy": "2"}}
    lines = mode_files.modes_csv(found, SimpleNamespace(source=source), 1e-3).splitlines()
    assert lines[0].endswith("modes of a.toml (sha256 abc)")
    assert lines[1:3] == ["# by casingfem 1, numpy 2", "# sigma_hz: 0.001 of the frequency, as stated by --sigma"]
    cells = dict(zip(lines[3].split(","), lines[4].split(","), strict=True))
    assert (cells["freq_hz"], float(cells["sigma_hz"]), cells["zeta"], cells["n"]) == ("200.0", 0.2, "", "")
    assert len(lines) == 5


# --- what all commands share ----------------------------------------------------------------------------------


def delivered(capsys, tmp_path, files, **keys):
    running.deliver({"a": 1}, "words", **{"as_json": False, "out": tmp_path, "files": files, **keys})
    return capsys.readouterr().out.splitlines()


def test_files_are_written_and_told_by_name_or_by_folder(capsys, tmp_path):
    files = {"a.txt": "a", "deep/b.txt": "b", "deep/c.txt": "c"}
    assert delivered(capsys, tmp_path, files) == [
        "words", f"wrote {tmp_path / 'a.txt'}", f"wrote 2 files to {tmp_path / 'deep'}"
    ]  # fmt: skip
    assert (tmp_path / "deep" / "c.txt").read_text() == "c"


def test_nothing_is_written_without_out_or_files(capsys, tmp_path):
    assert delivered(capsys, tmp_path / "none", {}) == ["words"]
    assert delivered(capsys, tmp_path, {"a.txt": "a"}, out=None) == ["words"]
    assert list(tmp_path.iterdir()) == []


def test_json_is_one_document_with_the_warnings_and_nothing_else(capsys, tmp_path):
    lines = delivered(capsys, tmp_path, {"a.txt": "a"}, as_json=True)
    assert (len(lines), json.loads(lines[0])["a"]) == (1, 1)
    assert "warnings" in json.loads(lines[0])
    assert (tmp_path / "a.txt").is_file()


@pytest.mark.parametrize(("out", "taken"), [("new", True), ("new.npz", True), ("file", False), ("file/a.npz", False)])
def test_a_file_in_the_way_of_out_is_told_at_once(capsys, tmp_path, out, taken):
    (tmp_path / "file").write_text("mine")
    assert running.free_way(None, None, None) is None
    if taken:
        assert running.free_way(None, None, tmp_path / out) == tmp_path / out
        return
    with pytest.raises(SystemExit) as ended:
        running.free_way(None, None, tmp_path / out)
    assert ended.value.code == 2
    assert capsys.readouterr().err.startswith(f"{tmp_path / out}: ")


def ended(error, **given):
    """Exit code and stderr of a command that raises."""

    @click.command()
    @click.pass_context
    def command(context):
        def body(**_):
            raise error

        running.with_exit_codes(body)(**given)

    result = CliRunner().invoke(command, [])
    return result.exit_code, result.stderr, result.exception


def own(base, text):
    """An error of one of the packages."""
    return type("Own", (base,), {"__module__": "contact.some"})(text)


FILE = Path("a.toml")


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (own(ValueError, "b: found 1"), 2, "a.toml: b: found 1\n"),
        (own(ValueError, "a.toml: b: found 1"), 2, "a.toml: b: found 1\n"),
        (own(RuntimeError, "no factor"), 3, "command a.toml: the numerics failed: no factor\n"),
        (np.linalg.LinAlgError("singular"), 3, "command a.toml: the numerics failed: singular\n"),
        (FileNotFoundError(2, "No such file", "t.csv"), 2, "t.csv: No such file\n"),
        (OSError("full"), 2, "standard output: full\n"),
        (KeyboardInterrupt(), 130, "stopped: nothing was kept; run the same command again\n"),
    ],
)
def test_errors_become_a_line_and_an_exit_code(error, code, words):
    assert ended(error, file=FILE)[:2] == (code, words)


def test_an_error_that_names_any_path_given_is_told_as_it_is():
    error = own(ValueError, "t.csv: line 3")
    assert ended(error, file=FILE, table=Path("t.csv"))[1] == "t.csv: line 3\n"
    assert ended(own(ValueError, "wrong"), files=(Path("m.mtx"), Path("k.mtx")))[1] == "m.mtx, k.mtx: wrong\n"


@pytest.mark.parametrize("error", [ValueError("a mistake"), BrokenPipeError("pipe"), KeyError("k")])
def test_mistakes_of_the_program_stay_what_they_are(error):
    assert ended(error, file=FILE)[2] is error
    assert not running.is_own_error(error)


def test_the_source_of_a_page_is_name_and_hash_of_its_file(tmp_path):
    (tmp_path / "a.toml").write_bytes(b"abc")
    source = running.source_of(tmp_path / "a.toml")
    assert source["file"] == "a.toml"
    assert source["sha256"] == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"


def test_a_doubt_is_told_once_and_three_of_a_kind_at_most(capsys):
    with running.collecting():
        assert running.collected() == []
        for text in ("a", "b", "a", "c", "d"):
            warnings.warn(cf.errors.ModelWarning("shell-free", text), stacklevel=1)
        warnings.warn(cf.errors.ModelWarning("mesh-coarse", "e"), stacklevel=1)
        with pytest.warns(DeprecationWarning, match="old"):
            warnings.warn("old", DeprecationWarning, stacklevel=1)
    found = running.collected()
    assert [entry["code"] for entry in found] == ["shell-free"] * 3 + ["mesh-coarse"]
    assert [entry["message"][0] for entry in found] == ["a", "b", "c", "e"]
    lines = capsys.readouterr().err.splitlines()
    assert [line[:10] for line in lines] == [f"warning: {x}" for x in "abce"]
    found.clear()
    assert len(running.collected()) == 4
