"""Parts of files on their way: whose they are, what stands in their way, what is left of them."""

import errno

import pytest

from contact.io.outfiles import in_the_way, write_atomic, write_files


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
