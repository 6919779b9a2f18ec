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
from contact.io.outfiles import write_files
from contact.io.publication.manifest import HERE
from contact.io.publication.staging import start_of

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
        if str(target) == str(folder / "sub" / "b.csv"):
            raise KeyboardInterrupt
        replace(source, target)

    with monkeypatch.context() as patched:
        patched.setattr(os, "replace", killed)
        with pytest.raises(KeyboardInterrupt):
            write_files(folder, SET)
    return folder


def test_the_next_set_is_not_mixed_with_one_broken_off(broken_off):
    write_files(broken_off, {"a.csv": "third", "c.csv": "third"})
    assert found(broken_off) == {"a.csv": "third", "c.csv": "third", "sub/b.csv": SET["sub/b.csv"]}


def test_what_a_killed_process_left_is_cleared_and_nothing_else(tmp_path):
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    key, alive = "0123456789abcdef" * 2, os.getppid()
    parts = {
        "dead": f".a.npz.{HERE}-{ended.pid}-0-{key}.part", "dead set": f".set.{HERE}-{ended.pid}-0-{key}.part",
        "dead and full": f".full.{HERE}-{ended.pid}-0-{key}.part",
        "alive": f".a.npz.{HERE}-{alive}-{start_of(alive)}-{key}.part",
        "elsewhere": f".a.npz.{HERE}x-{ended.pid}-0-{key}.part", "old": f".b.npz.{HERE}x-{ended.pid}-0-{key}.part",
        "link": f".c.npz.{HERE}-{ended.pid}-0-{key}.part", "no part of ours": ".a.part",
        "number again": f".d.npz.{HERE}-{alive}-1-{key}.part",
        "not so long": f".a.npz.{HERE}-{ended.pid}-0-{key[1:]}.part",
    }  # fmt: skip
    for what, name in parts.items():
        if what == "link":
            (tmp_path / name).symlink_to("target")
        elif what in ("dead set", "dead and full"):
            (tmp_path / name / "new").mkdir(parents=True)
        else:
            (tmp_path / name).write_text("half")
    (tmp_path / parts["dead set"] / "new" / parts["dead"]).write_text("half of a file of the set")
    (tmp_path / parts["dead and full"] / "new" / "mine").write_text("no manifest names it")
    os.utime(tmp_path / parts["old"], (time.time() - 2 * 86_400,) * 2)
    write_files(tmp_path, {"c.csv": "x"})
    kept = {"dead and full", "alive", "elsewhere", "link", "no part of ours", "not so long"}
    assert {path.name for path in tmp_path.iterdir()} == {parts[what] for what in kept} | {"c.csv"}


def full(path):
    """A writer whose disk is full: the library states it without a name."""
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


def test_what_cannot_keep_a_set_is_refused_before_anything_is_written(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    (tmp_path / "file").write_text("x")
    (tmp_path / "out" / "a.csv").mkdir(parents=True)
    for name, words in {"link": "found a broken link", "file": "found a file", "out": "found a folder"}.items():
        with pytest.raises(OSError, match=words):
            write_files(tmp_path / name, SET)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "link", "out"]
    result = CliRunner().invoke(main, ["schema", "--out", str(tmp_path / "link")])
    assert result.exit_code == 2
    assert result.stderr == f"{tmp_path / 'link'}: found a broken link, expected a folder or an unused name\n"


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
    words = f"found a file, {file}, expected a folder or an unused name"
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
