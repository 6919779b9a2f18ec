"""Sets that replace others: whole for every reader, wherever their writer is killed, and recovered by a command."""

import errno
import json
import os
import shutil
import stat
import subprocess
import sys
import threading
import time
from itertools import count
from pathlib import Path

import pytest
from click.testing import CliRunner

from casingfem.cli import main
from contact.io import outfiles
from contact.io.infiles import read_bytes
from contact.io.outfiles import write_files
from contact.io.publication import lock
from contact.io.publication.digests import digest_of
from contact.io.publication.manifest import HERE, MANIFEST
from contact.io.publication.recovery import recover
from contact.io.publication.staging import start_of

OLD = {"a.csv": "old a", "sub/b.csv": "old b", "gone.csv": "not of the new set"}
NEW = {"a.csv": "new a", "sub/b.csv": "new b", "added.csv": "only in the new set"}
AFTER = {**OLD, **NEW}
MOVES = ("link", "replace", "rename", "unlink", "rmdir", "mkdir")


class KilledError(BaseException):
    """Where the writer ends."""


def found(folder):
    """Visible files, and all others."""
    files = {str(path.relative_to(folder)): path.read_text() for path in folder.rglob("*") if path.is_file()}
    visible = {name: text for name, text in files.items() if not name.startswith(".")}
    return visible, files.keys() - visible.keys()


def killed(monkeypatch, folder, at):
    """Write NEW over OLD up to an operation on the disk; whether there were so many."""
    write_files(folder, OLD)
    done = count()
    with monkeypatch.context() as patched:
        for name, own in {name: getattr(os, name) for name in MOVES}.items():

            def counted(*given, act=own, **named):
                if next(done) >= at:
                    raise KilledError  # and whatever is tried after the end is not done either
                return act(*given, **named)

            patched.setattr(os, name, counted)
        patched.setattr(shutil, "rmtree", lambda *given, **named: None)
        try:
            write_files(folder, NEW)
        except KilledError:
            return True
    return False


@pytest.fixture
def stopped(tmp_path, monkeypatch):
    """A folder in which the writer was killed when one of three new files was in its place."""
    folder = tmp_path / "out"
    for at in count():
        shutil.rmtree(folder, ignore_errors=True)
        assert killed(monkeypatch, folder, at)
        visible, _ = found(folder)
        if visible == {"gone.csv": OLD["gone.csv"], "a.csv": NEW["a.csv"]}:
            return folder


def all_read(folder):
    """What a reader gets of each file of the new set; None where it is refused."""
    texts = {}
    for name in NEW:
        try:
            texts[name] = read_bytes(folder / name).decode()
        except FileNotFoundError:
            continue
        except OSError as error:
            advised = f"expected all or none: run `casingfem recover {folder}`" in error.strerror
            texts[name] = None if advised else error.strerror
    return texts


def test_wherever_the_writer_is_killed_readers_and_recovery_see_one_set(tmp_path, monkeypatch):
    folder, ends = tmp_path / "out", []
    for at in count():
        shutil.rmtree(folder, ignore_errors=True)
        if not killed(monkeypatch, folder, at):
            break
        lying = found(folder)
        texts = all_read(folder)
        olds = {name: text for name, text in OLD.items() if name in NEW}
        assert texts in ({}, olds, NEW) or set(texts.values()) == {None}
        visible = {name: text for name, text in lying[0].items() if name in NEW}
        assert not (set(visible.values()) & set(olds.values()) and set(visible.values()) & set(NEW.values()))
        assert found(folder) == lying, "reading changed something"
        recover(folder)
        ends.append(found(folder)[0])
        assert ends[-1] in (OLD, AFTER)
        assert set(all_read(folder).values()) <= {*OLD.values(), *NEW.values()}
    assert at > 15
    assert ends == sorted(ends, key=lambda end: end == AFTER), "what is announced is finished"
    assert OLD in ends
    assert AFTER in ends


def test_the_next_writer_finishes_what_a_killed_one_left(stopped):
    write_files(stopped, {"c.csv": "c"})
    assert found(stopped) == ({**AFTER, "c.csv": "c"}, set())


def test_a_damaged_set_is_taken_back(stopped):
    staged = next(stopped.glob(".set.*/new/added.csv"))
    staged.write_text(NEW["added.csv"].upper())
    result = CliRunner().invoke(main, ["recover", str(stopped)])
    assert result.exit_code == 0
    assert result.stdout == (
        f"{stopped}: restored the former files of a set of 3: a.csv, sub/b.csv, added.csv\n"
        "damaged or missing files of the set: added.csv; run the command that wrote it again\n"
    )
    assert found(stopped)[0] == OLD


@pytest.mark.parametrize("name", ["a.csv", "sub/b.csv", "added.csv"])
def test_what_was_changed_since_is_left_alone(stopped, name):
    """In a place that is taken, that was made free, that was free."""
    (stopped / name).write_text("mine")
    before = found(stopped)
    result = CliRunner().invoke(main, ["recover", str(stopped)])
    assert result.exit_code == 2
    assert f"{stopped}: found files changed after the writing program was stopped: {name}" in result.stderr
    assert found(stopped) == before
    (stopped / name).unlink()
    recover(stopped)
    assert found(stopped)[0] in (OLD, AFTER)


def test_without_its_staging_folder_a_set_cannot_be_recovered(stopped):
    for staging in stopped.glob(".set.*"):
        shutil.rmtree(staging)
    before = found(stopped)
    result = CliRunner().invoke(main, ["recover", str(stopped)])
    assert result.exit_code == 2
    assert "1 of 3 new files" in result.stderr
    assert f"move {MANIFEST} to another folder" in result.stderr
    assert found(stopped) == before


def test_the_command_states_what_it_did(stopped):
    (stopped / ".new").mkdir()
    (stopped / ".new" / "a.csv").write_text("of another version, or of the user")
    result = CliRunner().invoke(main, ["recover", str(stopped), "--json"])
    said = json.loads(result.stdout)
    assert (said["action"], said["files"], said["left"]) == ("finished", list(NEW), [".new"])
    assert (stopped / ".new" / "a.csv").read_text() == "of another version, or of the user"
    result = CliRunner().invoke(main, ["recover", str(stopped)])
    assert f"{stopped}: every set is complete\n" in result.stdout
    result = CliRunner().invoke(main, ["recover", str(stopped / "a.csv")])
    assert (result.exit_code, "found no such folder" in result.stderr) == (2, True)


def manifest_text(files, staging=f".set.{HERE}-1-0-{'0' * 32}.part"):
    document = {"format": "casingfem-publication-1", "staging": staging, "files": files}
    return json.dumps({**document, "sha256": digest_of(document)})


def entry(name):
    return {"name": name, "size": 1, "sha256": "0" * 64, "replaces": None}


@pytest.mark.parametrize(
    "text",
    [
        "", "[]", "{", manifest_text([entry("../b")]), manifest_text([entry("/passwd")]), manifest_text([entry("")]),
        manifest_text([entry("a"), entry("a")]), manifest_text([entry("a")], "victim"), manifest_text([{"name": "a"}]),
        manifest_text([entry("a")], f".x/../set.{HERE}-1-0-{'0' * 32}.part"), manifest_text([entry("a")]) [:-9],
        manifest_text([entry("a")]).replace('"size": 1', '"size": 2'), manifest_text([entry("a\0b")]), "[" * 10**5,
    ],
)  # fmt: skip
def test_a_manifest_that_is_none_stops_no_reader_and_is_touched_by_nobody(tmp_path, text):
    (tmp_path / MANIFEST).write_text(text)
    (tmp_path / "a").write_text("mine")
    (tmp_path / "victim").mkdir()
    assert read_bytes(tmp_path / "a") == b"mine"
    result = CliRunner().invoke(main, ["recover", str(tmp_path)])
    assert result.exit_code == 2
    assert "of another program" in result.stderr
    with pytest.raises(OSError, match="of another program"):
        write_files(tmp_path, NEW)
    assert {path.name for path in tmp_path.iterdir()} == {MANIFEST, "a", "victim"}


def test_a_manifest_that_is_a_folder_a_link_or_a_pipe(tmp_path):
    (tmp_path / "real").write_text(manifest_text([entry("a")]))
    (tmp_path / "a").write_text("mine")
    place = tmp_path / MANIFEST
    for make in (place.mkdir, lambda: place.symlink_to("real"), lambda: os.mkfifo(place)):
        make()
        assert read_bytes(tmp_path / "a") == b"mine"
        with pytest.raises(OSError, match="of another program"):
            recover(tmp_path)
        place.rmdir() if stat.S_ISDIR(place.lstat().st_mode) else place.unlink()


@pytest.mark.parametrize("linked", ["new", "old", "staging", "sub"])
def test_no_link_is_followed(stopped, tmp_path, linked):
    victim = tmp_path / "victim"
    staging = next(stopped.glob(".set.*"))
    place = {"new": staging / "new", "old": staging / "old", "staging": staging, "sub": stopped / "sub"}[linked]
    shutil.move(place, victim)
    place.symlink_to(victim)
    before = found(tmp_path)
    for act in (lambda: recover(stopped), lambda: write_files(stopped, NEW)):
        with pytest.raises(OSError, match="found a link"):
            act()
    assert found(tmp_path) == before


def test_a_staging_folder_of_a_killed_writer_with_a_link_inside(tmp_path):
    """Its manifest names a file of the user behind the link, which is not removed."""
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    (tmp_path / "victim").mkdir()
    (tmp_path / "victim" / "notes.txt").write_text("mine")
    staging = tmp_path / "out" / f".set.{HERE}-{ended.pid}-0-{'0' * 32}.part"
    staging.mkdir(parents=True)
    (staging / "new").symlink_to(tmp_path / "victim")
    (staging / "manifest.json").write_text(manifest_text([entry("notes.txt"), entry("../out/x")]))
    write_files(tmp_path / "out", NEW)
    assert (tmp_path / "victim" / "notes.txt").read_text() == "mine"
    assert found(tmp_path / "out")[0] == NEW


def test_a_set_whose_files_cannot_all_be_moved_leaves_the_one_before(tmp_path, monkeypatch):
    folder, replace = tmp_path / "out", os.replace
    write_files(folder, OLD)

    def refused(source, target):
        if str(target) == str(folder / "added.csv"):
            raise PermissionError(errno.EPERM, "Operation not permitted", str(target))
        replace(source, target)

    monkeypatch.setattr(os, "replace", refused)
    with pytest.raises(PermissionError):
        write_files(folder, NEW)
    assert found(folder) == (OLD, set())


def test_sets_keep_to_their_folder(tmp_path):
    (tmp_path / "out").mkdir()
    for name in ("../b.csv", "/b.csv", "1/2/3/4/b.csv", MANIFEST):
        with pytest.raises(OSError, match="a name outside the folder"):
            write_files(tmp_path / "out", {"a.csv": "a", name: "b"})
    (tmp_path / "out" / "sub").symlink_to(tmp_path)
    with pytest.raises(OSError, match="found a link"):
        write_files(tmp_path / "out", NEW)
    assert found(tmp_path) == ({}, set())


def test_two_writers_at_once_leave_one_set_or_the_other(tmp_path):
    folder = tmp_path / "out"
    sets = [{f"{k}.csv": str(n) for k in range(20)} for n in range(4)]
    write_files(folder, sets[0])
    writers = [threading.Thread(target=write_files, args=(folder, files)) for files in sets for _ in range(5)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    visible, hidden = found(folder)
    assert visible in sets
    assert hidden == set()


def test_a_reader_waits_for_a_writer_at_work_and_not_for_ever(stopped, monkeypatch):
    monkeypatch.setattr(lock, "WAIT", 0.1)
    with lock.alone(stopped), pytest.raises(OSError, match="found another program"):
        read_bytes(stopped / "a.csv")
    finisher = threading.Event()

    def write():
        with lock.alone(stopped) as certain:
            finisher.set()
            outfiles.settled(stopped, certain)

    monkeypatch.setattr(lock, "WAIT", 10.0)
    writer = threading.Thread(target=write)
    writer.start()
    finisher.wait()
    assert read_bytes(stopped / "added.csv").decode() == NEW["added.csv"]
    writer.join()


def test_without_hard_links_or_locks_sets_are_written_too(tmp_path, monkeypatch):
    def none(*given, **named):
        raise OSError(errno.EOPNOTSUPP, "Operation not supported")

    monkeypatch.setattr(os, "link", none)
    monkeypatch.setattr(lock.fcntl, "flock", none)
    for files in (OLD, NEW):
        write_files(tmp_path / "out", files)
    assert found(tmp_path / "out") == (AFTER, set())


def test_names_that_no_text_can_store(tmp_path):
    odd = ["line\nend.csv", "quote'\".csv", "\udcff.csv", "x" * 250 + ".csv", ".hidden", "-f"]
    folder = tmp_path / "out dir\n"
    for text in ("old", "new"):
        write_files(folder, dict.fromkeys(odd, text))
        assert {path.name: path.read_text() for path in folder.iterdir()} == dict.fromkeys(odd, text)
        outfiles.write_atomic(folder / odd[3], text)
        assert len(list(folder.iterdir())) == len(odd)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="the superuser may write everywhere")
def test_a_folder_that_may_not_be_written_is_named(tmp_path):
    folder = tmp_path / "out"
    write_files(folder, OLD)
    folder.chmod(0o500)
    with pytest.raises(PermissionError) as caught:
        write_files(folder, NEW)
    assert Path(caught.value.filename) == folder
    folder.chmod(0o700)
    assert found(folder) == (OLD, set())


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere the system does not state when a process began")
def test_a_process_is_known_by_its_start_until_it_ends():
    own = start_of(os.getpid())
    assert 0 < own < time.clock_gettime(time.CLOCK_BOOTTIME) * os.sysconf("SC_CLK_TCK")
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as child:
        began = start_of(child.pid)
        assert began > own
        assert start_of(child.pid) == began
        child.stdin.close()
        os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOWAIT)
        assert start_of(child.pid) == 0  # ended, and not yet waited for
    assert start_of(child.pid) == 0
