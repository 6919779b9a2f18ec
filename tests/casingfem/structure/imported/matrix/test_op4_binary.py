"""Binary OP4 files record by record: every layout and byte order, and damage named with its place."""

import numpy as np
import pytest

import casingfem as cf

A = np.array([[0.0, 2.5, 0.0, 0.0], [1.5, 0.0, 0.0, 0.0], [-3.0, 0.0, 0.0, 0.0], [0.0, 4.0, 7.0, 0.0]])


def read(folder, content):
    (folder / "a.op4").write_bytes(content)
    (folder / "dofs.csv").write_text("node,direction\n1,x\n2,x\n3,x\n4,x\n")
    return cf.imported.read_matrices(folder / "a.op4", dofs=folder / "dofs.csv")


def record(*parts, order="<"):
    data = b"".join(np.array(p, f"{order}i4").tobytes() if isinstance(p, list) else p for p in parts)
    size = np.array([len(data)], f"{order}i4").tobytes()
    return size + data + size


def binary(layout, order="<", kind=2, name=b"K       ", end=True):
    """`A` as records: "dense", "short" or "long" row numbers."""
    real, words = f"{order}f{4 * kind}", kind
    out = record([4, -4 if layout == "long" else 4, 2, kind], name, order=order)
    for j, strings in enumerate(([(2, [1.5, -3.0])], [(1, [2.5]), (4, [4.0])], [(4, [7.0])]), 1):
        if layout == "dense":
            column = np.zeros(4)
            for row, numbers in strings:
                column[row - 1 : row - 1 + len(numbers)] = numbers
            rows = np.flatnonzero(column)
            data = column[rows[0] : rows[-1] + 1].astype(real)
            out += record([j, rows[0] + 1, words * len(data)], data.tobytes(), order=order)
            continue
        parts = []
        for row, numbers in strings:
            size = words * len(numbers)
            head = [size + 1, row] if layout == "long" else [row + 65536 * (size + 1)]
            parts += [head, np.array(numbers, real).tobytes()]
        length = sum(4 * len(p) if isinstance(p, list) else len(p) for p in parts) // 4
        out += record([j, 0, length], *parts, order=order)
    return out + (record([5, 1, words], np.ones(1, real).tobytes(), order=order) if end else b"")


@pytest.mark.parametrize("layout", ["dense", "short", "long"])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("kind", [1, 2])
def test_a_binary_file_in_every_layout(layout, order, kind, tmp_path):
    names = (b"K       ", b"M       ", b"\xe4 b     ")
    found = read(tmp_path, b"".join(binary(layout, order, kind, name=name) for name in names))
    for one in (found.K, found.M):
        np.testing.assert_array_equal(one.toarray(), A)
    assert found.left_out == ("\xe4 b",)


@pytest.mark.parametrize("cut", [1, 5, 20, 23])
def test_a_binary_file_cut_in_its_last_record_is_refused(cut, tmp_path):
    whole = binary("long")
    at = len(whole) - 28
    with pytest.raises(cf.errors.ModelError, match=rf"a\.op4: byte {at}: found an incomplete record: cut short"):
        read(tmp_path, whole[:-cut])


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (binary("long", end=False), r"byte 164: found an incomplete record: cut short\?"),
        (binary("long") + b"\0\0\0\0\0\0\0\0", "byte 192: found 0 bytes, expected the"),
        (
            binary("long") + b"\xff\xff\xff\xff\xff\xff\xff\xff",
            r"byte 192: found an incomplete record: cut short\?",
        ),
        (
            record([4, 4, 2, 2], b"K       ") + record([1, 1], b"\0\0\0"),
            "byte 32: found a column of 11 bytes, expected 12",
        ),
        (
            record([4, 4, 2, 2], b"K       ") + record([1, 1, 3], b"\0" * 16),
            "byte 32: found 16 bytes of values, expected 12",
        ),
        (record([4, 4, 2, 5], b"K       "), "K: found type 5, 4 rows, 4 columns, expected a real matrix"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_damaged_records_are_named_with_their_place(content, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.op4: {told}"):
        read(tmp_path, content)


def test_complex_records_are_passed_over(tmp_path):
    """Each value has a real and an imaginary part, in strings and in whole columns."""
    numbers = np.array([1.0, 2.0, 3.0, 4.0]).tobytes()
    head, last = record([1, 4, 2, 4], b"V       "), record([2, 1, 4], numbers[:16])
    for column in (record([1, 1, 8], numbers), record([1, 0, 9], [1 + 65536 * 9], numbers)):
        found = read(tmp_path, head + column + last + binary("short") + binary("short", name=b"M       "))
        np.testing.assert_array_equal(found.K.toarray(), A)
        assert found.left_out == ()
