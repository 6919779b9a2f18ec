"""The gate for files that a user names: what passes, what is refused, and that nothing waits for ever."""

import errno
import os
import threading
from pathlib import Path

import numpy as np
import pytest

from casingfem.io import strict_csv
from contact.io import infiles
from contact.io.npz import load_npz, write_npz
from contact.io.toml import read_toml

TEXT = b"# SYNTHETIC\nz_m,theta_deg\n0.1,30\n"
pytestmark = pytest.mark.skipif(os.name != "posix", reason="named pipes are of POSIX systems")


@pytest.fixture
def pipe(tmp_path, monkeypatch):
    """A named pipe, and what writes into it from a thread; nobody waits longer than 0.2 s for it."""
    monkeypatch.setattr(infiles, "SILENCE", 0.2)
    os.mkfifo(tmp_path / "pipe")
    writers = []

    def write(*pieces):
        def run():
            try:
                with (tmp_path / "pipe").open("wb", buffering=0) as stream:
                    for piece in pieces:
                        stream.write(piece)
            except BrokenPipeError:  # the reader has had enough
                pass

        writers.append(threading.Thread(target=run))
        writers[-1].start()
        return tmp_path / "pipe"

    yield write
    for writer in writers:
        while writer.is_alive():  # a writer that nobody listens to waits until somebody opens the pipe
            os.close(os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK))
            writer.join(0.05)


def refused(path, number, words, **bound):
    with pytest.raises(OSError, match=words) as caught:
        infiles.read_bytes(path, **bound)
    assert (caught.value.errno, caught.value.filename) == (number, str(path))
    assert caught.value.strerror.startswith("found ")
    assert ", expected " in caught.value.strerror


def test_what_is_no_file_is_refused_in_a_sentence(tmp_path):
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "dangling").symlink_to("nowhere")
    (tmp_path / "table.csv").write_bytes(TEXT)
    refused(tmp_path, errno.EISDIR, "found a folder")
    refused(Path("/dev/zero"), errno.EINVAL, "found a device")
    refused(tmp_path / "loop", errno.ELOOP, "found a link that leads back to itself")
    refused(tmp_path / "dangling", errno.ENOENT, "found a link to 'nowhere', which does not exist")
    refused(tmp_path / "tabel.csv", errno.ENOENT, r"found no such file, expected one \(did you mean table.csv\?\)")
    refused(tmp_path / "none" / "a.csv", errno.ENOENT, "found no folder")
    refused(tmp_path / "table.csv" / "a.csv", errno.ENOTDIR, "found a file where its folder should be")
    refused(tmp_path / "table.csv", errno.EFBIG, "expected a file of at most 1e-05 MB", most=10)


def test_a_file_that_is_mostly_a_hole_is_refused_by_its_size(tmp_path):
    with (tmp_path / "hole.csv").open("wb") as stream:
        stream.truncate(10**12)
    refused(tmp_path / "hole.csv", errno.EFBIG, r"found 1e\+06 MB, expected a file of at most 256 MB", most=256e6)


def test_a_pipe_is_read_to_its_end_by_every_parser(pipe, tmp_path):
    assert infiles.read_bytes(pipe(b"one ", b"two")) == b"one two"
    assert infiles.read_bytes(pipe(b"")) == b""
    assert strict_csv.read(pipe(TEXT)).numbers("z_m") == [0.1]
    assert read_toml(pipe(b"[speed]\nhz = 5.0\n"))[1] == {"speed": {"hz": 5.0}}
    arrays = write_npz(tmp_path / "a.npz", {"x": np.arange(3.0)}).read_bytes()
    assert load_npz(pipe(arrays))["x"].tolist() == [0.0, 1.0, 2.0]


def test_a_pipe_is_bounded_in_size_and_time(pipe, tmp_path, monkeypatch):
    refused(tmp_path / "pipe", errno.ETIMEDOUT, "found a pipe without data for 0.2 s")
    refused(pipe(*[b"x" * 4096] * 100), errno.EFBIG, "found a pipe with more than 0.1 MB", most=1e5)
    monkeypatch.setattr(infiles, "LONGEST", 0.0)
    refused(pipe(b"x"), errno.ETIMEDOUT, "found a pipe that is still open after 0 s")


def test_within_one_command_a_pipe_gives_the_same_again(pipe):
    with infiles.pipes_read_once():
        path = pipe(TEXT)
        assert infiles.read_bytes(path) == TEXT
        with infiles.pipes_read_once():
            assert infiles.read_bytes(path) == TEXT
    refused(path, errno.ETIMEDOUT, "without data")


def test_a_library_that_opens_files_itself_gets_no_pipe(pipe, tmp_path):
    (tmp_path / "a.msh").write_bytes(b"x")
    assert infiles.regular_file(tmp_path / "a.msh") == tmp_path / "a.msh"
    with pytest.raises(OSError, match="found a pipe, expected a file on a disk"):
        infiles.regular_file(tmp_path / "pipe")


def test_the_mark_of_utf_8_is_no_character_of_a_text(tmp_path):
    marked = tmp_path / "marked"
    marked.write_bytes(b"\xef\xbb\xbf[speed]\nhz = 5.0\n")
    assert read_toml(marked)[1] == {"speed": {"hz": 5.0}}
    marked.write_bytes(b"\xef\xbb\xbf" + TEXT)
    assert strict_csv.read(marked).card == ("SYNTHETIC",)
    assert infiles.read_text(marked) == infiles.read_loose_text(marked) == TEXT.decode()


@pytest.mark.parametrize(
    ("data", "line", "found"),
    [
        (b"a\nb\xe4\n", 2, r"byte 0xe4, which is not UTF-8 \('ä' in Latin-1\)"),
        (b"\xef\xbb\xbfa\n\x80", 2, "byte 0x80, which is not UTF-8,"),
        ("a = 1\n".encode("utf-16"), 1, "the mark of UTF-16"),
        ("a\nb".encode("utf-16-le"), 1, "a zero byte, as in UTF-16 without a mark"),
    ],
)
def test_another_encoding_is_named_with_its_line(data, line, found):
    with pytest.raises(infiles.TextError, match=f"^line {line}: found {found}.* expected UTF-8 text"):
        infiles.text_of(data)
    assert infiles.text_of("ä;b".encode("utf-16"), utf16=True) == "ä;b"
    with pytest.raises(infiles.TextError, match="line 2: found bytes that are not UTF-16"):
        infiles.text_of("ä\nb".encode("utf-16")[:-1], utf16=True)
