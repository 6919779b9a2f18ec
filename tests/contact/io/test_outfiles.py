"""Sets of files: all of the old or all of the new, whatever comes between."""

import errno
import os
import re
import subprocess
import sys
import time

import pytest
from click.testing import CliRunner

from casingfem.cli import main
from casingfem.io import strict_csv
from contact.io.outfiles import HERE, NEW, settle, write_files

OLD = {"a.csv": "old,a\n1,2\n", "sub/b.csv": "old,b\n1,2\n"}
SET = {"a.csv": "new,a\n1,2\n", "sub/b.csv": "new,b\n1,2\n"}


def found(folder):
    return {str(path.relative_to(folder)): path.read_text() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.fixture
def broken_off(tmp_path, monkeypatch):
    """A folder with an old set, over which a new one was written up to the move of its second file."""
    folder, moves, replace = tmp_path / "out", [], os.replace
    write_files(folder, OLD)

    def killed(source, target):
        moves.append(target)
        if len(moves) == 2:
            raise KeyboardInterrupt
        replace(source, target)

    with monkeypatch.context() as patched:
        patched.setattr(os, "replace", killed)
        with pytest.raises(KeyboardInterrupt):
            write_files(folder, SET)
    return folder


def test_a_set_broken_off_between_two_moves_is_no_mixture_and_is_finished_later(broken_off):
    assert found(broken_off) == {"a.csv": SET["a.csv"], f"{NEW}/sub/b.csv": SET["sub/b.csv"]}
    settle(broken_off)
    assert found(broken_off) == SET


def test_reading_leaves_it_as_it_is(broken_off):
    before = found(broken_off)
    strict_csv.read(broken_off / "a.csv")
    CliRunner().invoke(main, ["modes", str(broken_off / "study.toml")])
    assert found(broken_off) == before


def test_the_next_set_is_not_mixed_with_one_broken_off(broken_off):
    write_files(broken_off, {"a.csv": "third", "c.csv": "third"})
    assert found(broken_off) == {"a.csv": "third", "c.csv": "third", "sub/b.csv": SET["sub/b.csv"]}


def test_what_a_killed_process_left_is_cleared_and_nothing_else(tmp_path):
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    parts = {
        "dead": f".a.npz.{HERE}-{ended.pid}-0.part", "dead set": f".set.{HERE}-{ended.pid}-0.part",
        "alive": f".a.npz.{HERE}-{os.getppid()}-0.part", "elsewhere": f".a.npz.{HERE}x-{ended.pid}-0.part",
        "old": f".b.npz.{HERE}x-{ended.pid}-0.part", "no part of ours": ".a.part",
    }  # fmt: skip
    for what, name in parts.items():
        (tmp_path / name).mkdir() if what == "dead set" else (tmp_path / name).write_text("half")
    os.utime(tmp_path / parts["old"], (time.time() - 2 * 86_400,) * 2)
    write_files(tmp_path, {"c.csv": "x"})
    kept = {"alive", "elsewhere", "no part of ours"}
    assert {path.name for path in tmp_path.iterdir()} == {parts[what] for what in kept} | {"c.csv"}


def full(path):
    """A writer whose disk is full: the library says so without a name."""
    path.write_text("half")
    raise OSError(errno.ENOSPC, "No space left on device")


@pytest.mark.parametrize("there", [True, False])
def test_a_full_disk_names_the_file_and_leaves_nothing(tmp_path, there):
    folder = tmp_path / "out"
    if there:
        write_files(folder, OLD)
    for files in (SET | {"c.png": full}, {"c.png": full}):
        with pytest.raises(OSError, match="No space left on device") as caught:
            write_files(folder, files)
        assert (caught.value.errno, caught.value.filename) == (errno.ENOSPC, str(folder / "c.png"))
        assert found(tmp_path) == ({f"out/{name}": text for name, text in OLD.items()} if there else {})


def test_what_cannot_hold_a_set_is_refused_before_anything_is_written(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    (tmp_path / "file").write_text("x")
    (tmp_path / "out" / "a.csv").mkdir(parents=True)
    for name, words in {"link": "found a link to nothing", "file": "found a file", "out": "found a folder"}.items():
        with pytest.raises(OSError, match=words):
            write_files(tmp_path / name, SET)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "link", "out"]
    result = CliRunner().invoke(main, ["schema", "--out", str(tmp_path / "link")])
    assert result.exit_code == 2
    assert result.stderr == f"{tmp_path / 'link'}: found a link to nothing, expected a folder or none\n"


@pytest.mark.parametrize("others", [1, 9, 10])
def test_a_folder_is_left_as_it_was_when_others_come_first_ten_times(tmp_path, monkeypatch, others):
    folder, tries, rename = tmp_path / "out", [], os.rename
    write_files(folder, OLD)

    def late(source, target):
        tries.append(target)
        if len(tries) <= others:
            raise OSError(errno.ENOTEMPTY, "Directory not empty")
        rename(source, target)

    monkeypatch.setattr(os, "rename", late)
    if others < 10:
        write_files(folder, SET)
        assert found(tmp_path) == {f"out/{name}": text for name, text in SET.items()}
        return
    with pytest.raises(FileExistsError, match="found a folder that others write to all the time") as caught:
        write_files(folder, SET)
    assert (caught.value.errno, caught.value.filename, len(tries)) == (errno.EEXIST, str(folder / NEW), 10)
    assert found(tmp_path) == {f"out/{name}": text for name, text in OLD.items()}


def test_a_folder_that_cannot_take_its_name_is_no_crowd(tmp_path, monkeypatch):
    def refused(source, target):
        raise PermissionError(errno.EACCES, "Permission denied", str(source))

    monkeypatch.setattr(os, "rename", refused)
    with pytest.raises(PermissionError, match="Permission denied"):
        write_files(tmp_path / "out", SET)
    assert found(tmp_path) == {}


def test_a_file_in_the_way_of_a_folder_is_named(tmp_path):
    file, out = tmp_path / "file", tmp_path / "file" / "deep" / "out"
    file.write_text("x")
    words = f"found a file, {file}, expected a folder or none"
    for files in (SET, {"a.csv": "x"}):
        with pytest.raises(NotADirectoryError, match=re.escape(words)) as caught:
            write_files(out, files)
        assert caught.value.filename == str(out)
    (tmp_path / "study.toml").write_text("nothing is read before the way is free")
    for command in main.commands:
        arguments = [command, str(tmp_path / "study.toml"), "--out", str(out)]
        if all(parameter.name != "out" for parameter in main.commands[command].params):
            continue
        result = CliRunner().invoke(main, arguments)
        assert result.stderr == f"{out}: {words}\n", command
    result = CliRunner().invoke(main, ["import", str(tmp_path / "study.toml"), "--out", str(out / "a.npz")])
    assert result.stderr == f"{out / 'a.npz'}: {words}\n"
    assert result.exit_code == 2
