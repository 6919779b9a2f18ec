"""Parts of files on their way: whose they are, what stands in their way, what is left of them."""

import errno
import os
import time

import pytest

from contact.io.outfiles import (
    HERE,
    NEW,
    PART,
    _dead,
    clear_parts,
    in_the_way,
    settle,
    write_atomic,
    write_files,
)


def part_of(host, process):
    return PART.fullmatch(f".a.npz.{host}-{process}-0.part")


def test_a_part_is_dead_where_its_process_ran_here_and_has_ended(monkeypatch):
    assert not _dead(part_of(HERE, os.getpid()))
    assert _dead(part_of(HERE, 10**30))  # a number that no process has
    assert not _dead(part_of(f"{HERE}x", 10**30))
    for error, dead in ((ProcessLookupError, True), (PermissionError, False)):

        def kill(process, signal, error=error):
            assert (process, signal) == (4711, 0)
            raise error

        monkeypatch.setattr(os, "kill", kill)
        assert _dead(part_of(HERE, 4711)) is dead


@pytest.mark.parametrize(("age", "left"), [(86_400.0 - 600.0, True), (86_400.0 + 600.0, False)])
def test_parts_of_another_machine_are_cleared_after_a_day(tmp_path, age, left):
    for name in ("a.npz", "b.npz"):
        part = tmp_path / f".{name}.{HERE}x-1-0.part"
        part.write_text("half")
        os.utime(part, (time.time() - age,) * 2)
    clear_parts(tmp_path, "a.npz")
    assert {path.name[1:6] for path in tmp_path.iterdir()} == ({"a.npz", "b.npz"} if left else {"b.npz"})
    clear_parts(tmp_path)
    assert len(list(tmp_path.iterdir())) == (2 if left else 0)
    clear_parts(tmp_path / "none")


def test_what_stands_in_the_way_of_a_folder(tmp_path):
    (tmp_path / "file").write_text("x")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    assert in_the_way(tmp_path) is None
    assert in_the_way(tmp_path / "new" / "deep") is None
    assert in_the_way(tmp_path / "file") == "found a file, expected a folder or none"
    assert in_the_way(tmp_path / "link") == "found a link to nothing, expected a folder or none"
    assert (
        in_the_way(tmp_path / "link" / "a")
        == f"found a link to nothing, {tmp_path / 'link'}, expected a folder or none"
    )


def test_files_are_text_bytes_or_written_by_a_function(tmp_path):
    write = {"a.txt": "ä", "deep/b.bin": b"\x00\x01", "c.txt": lambda path: path.write_text("by it")}
    assert write_files(tmp_path / "far" / "new" / "out", write) == [
        tmp_path / "far" / "new" / "out" / name for name in write
    ]
    out = tmp_path / "far" / "new" / "out"
    assert (out / "a.txt").read_bytes() == "ä".encode()
    assert (out / "deep/b.bin").read_bytes() == b"\x00\x01"
    assert (out / "c.txt").read_text() == "by it"
    assert sorted(path.name for path in out.iterdir()) == ["a.txt", "c.txt", "deep"]
    assert write_atomic(out / "more" / "deep" / "d.txt", "d") == out / "more" / "deep" / "d.txt"
    assert (out / "more" / "deep" / "d.txt").read_text() == "d"
    assert [path.name for path in (tmp_path / "far" / "new").iterdir()] == ["out"]


@pytest.mark.parametrize(("number", "words"), [(errno.EACCES, "Permission denied"), (None, "told without a number")])
def test_an_error_of_a_writer_names_the_file_that_was_to_be(tmp_path, number, words):
    def refused(path):
        raise OSError(number, words, str(path)) if number else OSError(words)

    for files in ({"x.png": refused}, {"a.csv": "a", "x.png": refused}):
        with pytest.raises(OSError, match=words) as caught:
            write_files(tmp_path / "out", files)
        assert (caught.value.errno, caught.value.filename) == (number or errno.EIO, str(tmp_path / "out" / "x.png"))
    assert not any(path.is_file() for path in tmp_path.rglob("*"))


def test_settling_moves_what_is_new_and_leaves_the_rest(tmp_path):
    (tmp_path / NEW / "deep").mkdir(parents=True)
    (tmp_path / NEW / "deep" / "a").write_text("new")
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "a").write_text("old")
    (tmp_path / "b").write_text("old")
    settle(tmp_path)
    assert sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*")) == ["b", "deep", "deep/a"]
    assert (tmp_path / "deep" / "a").read_text() == "new"
    settle(tmp_path)
    assert (tmp_path / "b").read_text() == "old"
