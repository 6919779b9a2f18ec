"""Matrices of other programs: every format gives the same basis; what is wrong is named with its line."""

import json
import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.io import mmread, mmwrite, savemat
from scipy.sparse import csc_array, tril

import casingfem as cf
import contact as ct
from casingfem.cli import main
from tests.probed import numbers_of_document

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
NAMES = ("q", "x", "y", "z", "rx", "ry", "rz")
MARKET = "%%MatrixMarket matrix coordinate real symmetric\n"
MESH = cf.imported.grid_mesh(
    "hexahedron20", (3, 1, 1), lambda u: (u - [0.0, 0.5, 0.5]) * [0.11, 0.04, 5.4e-3],
    groups={"root": (0, 0.0), "tip": (0, 1.0)},
)  # fmt: skip
BLADE = cf.Solid(mesh=MESH, material=STEEL, supports={"root": cf.Clamped()})
NODES = tuple(MESH.node_numbers[MESH.groups["tip"].nodes[[0, -1]]].tolist())
EXACT = cf.reduce(BLADE, cf.modal.AtNodes(NODES), modes=6)
SET = cf.modal.structure_matrices(BLADE)


def body(read, **kind):
    labels = [(node, NAMES[direction]) for node, direction in read.dofs.tolist()]
    points = {node: x.tolist() for node, x in read.points.items()}
    return ct.ModalBody.from_matrices(
        read.M, read.K, read.C, dofs=labels, points=points, contact=NODES, modes=6, **kind
    )


def compliance(basis):
    return (basis.rows / basis.omega**2) @ basis.rows.T + basis.S


def same(found, digits=1e-9):
    """The basis of the matrices is that of the structure: frequencies, statics, motions of the channels."""
    np.testing.assert_allclose(found.omega, EXACT.omega, rtol=digits)
    size = np.abs(EXACT.compliance).max()
    np.testing.assert_allclose(compliance(found), EXACT.compliance, atol=10 * digits * size)
    np.testing.assert_allclose(np.abs(found.rows), np.abs(EXACT.rows), atol=1e3 * digits * np.abs(EXACT.rows).max())
    assert found.channels == EXACT.channels


def written(folder, form, matrices=SET, stem="part"):
    cf.imported.write_matrices(folder / f"{stem}.{form}", matrices)
    tables = {"nodes": folder / f"{stem}_nodes.csv", "dofs": folder / f"{stem}_dofs.csv"}
    given = {"mtx": tables, "op4": tables}.get(form, {})
    files = [folder / f"{stem}_{k}.mtx" for k in "KM"] if form == "mtx" else [folder / f"{stem}.{form}"]
    return cf.imported.read_matrices(files, **given)


@pytest.mark.parametrize(
    ("form", "digits"), [("mtx", 1e-9), ("op4", 1e-9), ("npz", 1e-9), ("mat", 1e-9), ("pch", 1e-5)]
)
@pytest.mark.slow
def test_every_format_gives_the_same_basis(form, digits, tmp_path):
    """To round-off; DMIG cards have ten digits."""
    read = written(tmp_path, form)
    same(body(read), digits)
    assert set(read.points) == set(SET.points)
    np.testing.assert_allclose(read.points[NODES[0]], SET.points[NODES[0]], rtol=1e-9)


def test_matrices_in_millimetres_and_tonnes():
    """Mass in t, stiffness in N/mm, points in mm."""
    read = replace(SET, M=1e-3 * SET.M, K=1e-3 * SET.K, points={n: 1e3 * x for n, x in SET.points.items()})
    found = body(read, units="mm-t-s")
    same(found)
    facts = json.loads(found.provenance)["matrices"]
    mass = 7800 * 0.11 * 0.04 * 5.4e-3
    assert 0.7 * mass < facts["mass"][0] < mass  # of the dofs that move
    np.testing.assert_allclose(np.asarray(facts["centre"])[1:], 0.0, atol=1e-12)


def test_calculix_files(tmp_path):
    """Lower or upper triangle, one row a line, dofs as node.direction."""
    for name, A in (("sti", SET.K), ("mas", SET.M)):
        part = tril(A).tocoo()
        lines = [f"{j + 1} {i + 1} {v:.16e}" for i, j, v in zip(part.row, part.col, part.data, strict=True)]
        (tmp_path / f"job.{name}").write_text("\n".join(lines) + "\n")
    (tmp_path / "job.dof").write_text("".join(f"{node}.{direction}\n" for node, direction in SET.dofs.tolist()))
    same(body(cf.imported.read_matrices([tmp_path / "job.sti"])))


def test_abaqus_mtx_files(tmp_path):
    """Node, dof, node, dof, value a line, lower triangle, the mass in an order of its own."""
    for name, A, turn in (("STIF1", SET.K, 1), ("MASS1", SET.M, -1)):
        part = tril(A).tocoo()
        lines = [
            f"{SET.dofs[i][0]},{SET.dofs[i][1]}, {SET.dofs[j][0]},{SET.dofs[j][1]}, {v:.17e}"
            for i, j, v in zip(part.row, part.col, part.data, strict=True)
        ]
        (tmp_path / f"job_{name}.mtx").write_text("** written\n" + "\n".join(lines[::turn]) + "\n")
    found = cf.imported.read_matrices([tmp_path / "job_MASS1.mtx", tmp_path / "job_STIF1.mtx"])
    same(body(found))


def test_symmetric_dmig_has_each_entry_on_either_side_of_the_diagonal(tmp_path):
    """Nastran sorts by number: below the diagonal is what scalar point 1 has with grid 101, and 101 with 102."""
    lines = ["DMIG,KAAX,0,6,1,0", "DMIG,KAAX,1,0,,1,0,5.", ",101,1,-2.", "DMIG,KAAX,101,1,,101,1,4.", ",102,1,-1."]
    lines += ["DMIG,KAAX,102,1,,102,1,4.", "DMIG,MAAX,0,6,1,0"]
    lines += [f"DMIG,MAAX,{dof},,{dof},1." for dof in ("1,0", "101,1", "102,1")]
    (tmp_path / "part.pch").write_text("\n".join(lines) + "\n")
    found = cf.imported.read_matrices(tmp_path / "part.pch")
    assert found.dofs.tolist() == [[101, 1], [102, 1], [1, 0]]
    np.testing.assert_array_equal(found.K.toarray(), [[4.0, -1.0, -2.0], [-1.0, 4.0, 0.0], [-2.0, 0.0, 5.0]])


ROWS = ((9, 1), (2, 1), (2, 3))  # a lower triangle in this order is none in the ascending one
MIXED = {"K": np.array([[5.0, -1, 0.5], [-1, 4, -2], [0.5, -2, 3]]), "M": np.diag([1.0, 2.0, 3.0])}


def market_text(A):
    return f"{DENSE}3 3\n" + "".join(f"{v}\n" for v in A.ravel())


def abaqus_text(A):
    """The lower triangle in the order of `ROWS`, zeros left out."""
    ends = [(i, j) for i in range(3) for j in range(i + 1) if A[i, j]]
    return "".join(f"{ROWS[i][0]},{ROWS[i][1]}, {ROWS[j][0]},{ROWS[j][1]}, {A[i, j]}\n" for i, j in ends)


@pytest.mark.parametrize("of_k", [market_text, abaqus_text])
@pytest.mark.parametrize("of_m", [market_text, abaqus_text])
@pytest.mark.parametrize("listed", ["dofs.csv", "K.dof"])
def test_rows_of_matrix_market_and_abaqus_are_brought_into_one_order(of_k, of_m, listed, tmp_path):
    (tmp_path / "K.mtx").write_text(of_k(MIXED["K"]))
    (tmp_path / "M.mtx").write_text(of_m(MIXED["M"]))
    point, head = (",", "node,direction\n") if listed == "dofs.csv" else (".", "")
    (tmp_path / listed).write_text(head + "".join(f"{node}{point}{direction}\n" for node, direction in ROWS))
    table = {"dofs": tmp_path / listed} if listed == "dofs.csv" else {}
    found = cf.imported.read_matrices([tmp_path / "K.mtx", tmp_path / "M.mtx"], **table)
    order = [ROWS.index(tuple(dof)) for dof in found.dofs.tolist()]
    assert sorted(order) == [0, 1, 2]
    for name, A in (("K", found.K), ("M", found.M)):
        np.testing.assert_array_equal(A.toarray(), MIXED[name][np.ix_(order, order)])


def test_mass_of_other_size_than_its_list_of_dofs_is_refused_beside_stiffness_of_abaqus(tmp_path):
    (tmp_path / "K.mtx").write_text("9,1,9,1,2.0\n")
    (tmp_path / "M.mtx").write_text(f"{DENSE}1 1\n3.0\n")
    (tmp_path / "dofs.csv").write_text("node,direction\n2,x\n9,x\n")
    with pytest.raises(
        cf.errors.ModelError, match=r"K\.mtx, M\.mtx: found a mass or damping matrix of 1 rows, and 2 dofs"
    ):
        cf.imported.read_matrices([tmp_path / "K.mtx", tmp_path / "M.mtx"], dofs=tmp_path / "dofs.csv")


def test_small_fields_and_full_matrices_of_dmig(tmp_path):
    """Form 1, small fields, an entry a line after the first; a scalar point has component 0."""
    text = """BEGIN BULK
DMIG    KAAX    0       1       1       0
DMIG    KAAX    7       1               7       1       3.+6            +A
+A      101     0       -1.+6
DMIG    KAAX    101     0               7       1       -1.+6           +B
+B      101     0       1.+6
DMIG    MAAX    0       6       2       0
DMIG,MAAX,7,1,,7,1,2.
DMIG,MAAX,101,0,,101,0,1.
ENDDATA
"""
    (tmp_path / "set.pch").write_text(text)
    read = cf.imported.read_matrices([tmp_path / "set.pch"])
    assert read.dofs.tolist() == [[7, 1], [101, 0]]
    np.testing.assert_array_equal(read.K.toarray(), [[3e6, -1e6], [-1e6, 1e6]])
    np.testing.assert_array_equal(read.M.toarray(), np.diag([2.0, 1.0]))


def binary_op4(name, A, kind="<f8", long=True, dense=False):
    """A matrix in OP4's records, as Nastran writes them."""
    order, words = kind[0], int(kind[-1]) // 4

    def record(data):
        length = np.array([len(data)], f"{order}i4").tobytes()
        return length + data + length

    def ints(*values):
        return np.array(values, f"{order}i4").tobytes()

    m, n = A.shape
    out = record(ints(n, -m if long else m, 6 if m == n else 2, words) + name.ljust(8).encode())
    for j in range(n):
        column = A[:, [j]].toarray().ravel().astype(kind)
        rows = np.flatnonzero(column)
        if dense:
            values = column[rows[0] : rows[-1] + 1]
            out += record(ints(j + 1, rows[0] + 1, words * len(values)) + values.tobytes())
            continue
        data = b""
        for part in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1):
            length = words * len(part)
            head = ints(length + 1, part[0] + 1) if long else ints(part[0] + 1 + 65536 * (length + 1))
            data += head + column[part].tobytes()
        out += record(ints(j + 1, 0, len(data) // 4) + data)
    return out + record(ints(n + 1, 1, words) + np.ones(1, kind).tobytes())


@pytest.mark.parametrize("kind", ["<f8", ">f8", "<f4"])
@pytest.mark.parametrize("layout", [{"long": True}, {"long": False}, {"long": False, "dense": True}])
def test_binary_op4(kind, layout, tmp_path):
    path = tmp_path / "part.op4"
    path.write_bytes(binary_op4("KGG", SET.K, kind, **layout) + binary_op4("MGG", SET.M, kind, **layout))
    dofs = tmp_path / "dofs.csv"
    dofs.write_text("node,direction\n" + "".join(f"{node},{NAMES[to]}\n" for node, to in SET.dofs.tolist()))
    found = cf.imported.read_matrices(path, dofs=dofs)
    for read, A in ((found.K, SET.K), (found.M, SET.M)):
        np.testing.assert_array_equal(read.toarray(), A.toarray().astype(kind))


@pytest.mark.parametrize("row", [0, 3])
def test_op4_entries_outside_of_their_matrix_are_refused(row, tmp_path):
    """Strings of three values that begin above the first row of four, or end below the last."""
    text = f"       1      -4       2       2L       1P,3E23.16\n       1       0       8\n       7{row:8d}\n"
    text += " 1.0000000000000000E+00 2.0000000000000000E+00 3.0000000000000000E+00\n"
    text += "       2       1       1\n 1.0000000000000000E+00\n"
    (tmp_path / "a.op4").write_text(text)
    with pytest.raises(
        cf.errors.ModelError, match=f"L: found rows {row} to {row + 2} of column 1 in a matrix of 4 x 1"
    ):
        cf.imported.read_matrices(tmp_path / "a.op4")


OP4 = """       2       2       2       2K       1P,3E23.16
       1       1       4
 1.0000000000000000E+00 2.0000000000000000E+00
       3       1       1
 1.0000000000000000E+00
"""
STRINGS = OP4.replace("       1       1       4\n", "       1       0       5\n  196609\n")  # one, from row 1


def column_of(folder, content):
    """The first column of K in an OP4 file that has M too."""
    content = content.encode() if isinstance(content, str) else content
    (folder / "a.op4").write_bytes(content)
    (folder / "dofs.csv").write_text("node,direction\n1,x\n2,x\n")
    found = cf.imported.read_matrices(folder / "a.op4", dofs=folder / "dofs.csv").K.toarray()
    assert not found[:, 1:].any()
    return found[:, 0].tolist()


def test_the_two_values_of_a_small_op4_file(tmp_path):
    for text in (OP4, STRINGS, "\n" + OP4 + "\n"):
        assert column_of(tmp_path, text + OP4.replace("K ", "M ")) == [1.0, 2.0]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        *(
            (f"{'2K':>8}", f"{kind:>7}K", f"K: found type {kind}, 2 rows, 2 columns, expected a real matrix")
            for kind in (-1, 0, 5)
        ),
        ("2K  ", "3KAA", "KAA: found type 3, 2 rows, 2 columns, expected a real matrix"),
        ("2K  ", "4KAA", "KAA: found type 4, 2 rows, 2 columns, expected a real matrix"),
        ("       2       2  ", "       0       2  ", "K: found 2 rows, 0 columns, expected 1 to 2147483647 of"),
        ("       2       2  ", "       2       0  ", "K: found 0 rows, 2 columns, expected 1 to 2147483647 of"),
        ("       2       2  ", "2     2147483648  ", "K: found 2147483648 rows, 2 columns, expected 1 to 2147483647"),
        ("3E23.16", "3F23.16", "line 1: found ' .*2K .*', expected the header of a matrix"),
        ("2       2K", "        2K", "line 1: found ' .*2K .*', expected the header of a matrix"),
        ("       2       2  ", "       2       x  ", "line 1: found '       2       x .*', expected whole numbers"),
        ("       1       4", "       1       x", "line 2: found '       1       1       x', expected whole numbers"),
        (
            "       1       1       4",
            "       1       1",
            "line 2: found '       1       1', expected column, row, words",
        ),
        ("       1       1       4", "  196609", "line 2: found '  196609', expected column, row, words"),
        ("       4\n", "       4\n  196609\n", "line 3: found '  196609', expected column, row, words"),
        ("2.0000", "2.000x", "line 3: found ' 1.00.*', expected numbers of 23 characters"),
        ("       3       1       1\n 1.0000000000000000E+00\n", "", "K: the file ends in column 1 of 2: cut short"),
        (OP4.partition("\n")[2], "", "K: the file ends in column 0 of 2: cut short"),
    ],
)
def test_text_op4_that_is_damaged_is_named_with_its_line(old, new, message, tmp_path):
    assert OP4.count(old) == 1
    (tmp_path / "a.op4").write_text(OP4.replace(old, new))
    with pytest.raises(cf.errors.ModelError, match=rf"a\.op4: {message}.*matrix-file"):
        cf.imported.read_matrices(tmp_path / "a.op4")


def test_strings_of_long_rows_have_two_numbers(tmp_path):
    (tmp_path / "a.op4").write_text(STRINGS.replace("       2       2  ", "       2      -2  "))
    with pytest.raises(cf.errors.ModelError, match=r"a\.op4: line 3: found '  196609', expected column, row, words"):
        cf.imported.read_matrices(tmp_path / "a.op4")
    (tmp_path / "a.op4").write_text(STRINGS.replace("  196609", "       5       1"))
    with pytest.raises(cf.errors.ModelError, match=r"line 3: found '       5       1', expected column, row, words"):
        cf.imported.read_matrices(tmp_path / "a.op4")


@pytest.mark.parametrize(
    ("kind", "text", "taken", "refused"),
    [(2, OP4, (2, 8), (1, 9)), (1, OP4, (2, 6), (1, 7)), (2, STRINGS, (2, 8), (1, 9))],
)
def test_columns_of_op4_with_fewer_or_more_words_than_values_are_refused(kind, text, taken, refused, tmp_path):
    """Two values of a word or two each, and up to four words of their string, which programs count or do not."""
    for words in (*taken, *refused):
        told = text.replace(f"{'2K':>8}", f"{kind:>7}K").replace("       4\n", f"{words:8d}\n")
        told = told.replace("       5\n", f"{words:8d}\n")
        if words in taken:
            assert column_of(tmp_path, told + OP4.replace("K ", "M ")) == [1.0, 2.0]
            continue
        short = ": cut short.; " if words > 2 else "; export it again"
        said = f"K: found 2 values in column 1, expected {words} words as announced{short}"
        with pytest.raises(cf.errors.ModelError, match=said):
            column_of(tmp_path, told)


def record(*numbers, more=b""):
    data = np.array(numbers, "<i4").tobytes() + more
    return np.int32(len(data)).tobytes() + data + np.int32(len(data)).tobytes()


HEAD, TWO = record(2, 2, 2, 2, more=b"K       "), np.array([1.0, 2.0]).tobytes()
COLUMN, LAST = record(1, 1, 4, more=TWO), record(3, 1, 2, more=TWO[:8])


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (HEAD + COLUMN + record(3, 1, 0) + HEAD.replace(b"K", b"M") + COLUMN + LAST, ""),
        (HEAD + COLUMN + LAST + HEAD.replace(b"K", b"M") + COLUMN + LAST, ""),
        (HEAD + COLUMN + LAST[:-1], "byte 68: found an incomplete record: cut short"),
        (HEAD + COLUMN + LAST + b"\0\0\0", r"byte 96: found an incomplete record: cut short\?"),
        (HEAD + COLUMN + LAST[:-1] + b"\1", "byte 68: found an incomplete record: cut short"),  # its lengths differ
        (HEAD + COLUMN, "byte 68: found an incomplete record: cut short"),
        (HEAD + COLUMN + record(3, 1, more=b"\0\0\0"), "byte 68: found a column of 11 bytes, expected 12 or"),
        (
            HEAD + COLUMN + LAST + record(1, 2, 2, 2, 0, more=b"\0\0\0"),
            "byte 96: found 23 bytes, expected",
        ),
        (
            HEAD + COLUMN + LAST + record(1, 2, 2, 2, 0, 0, more=b"\0"),
            "byte 96: found 25 bytes, expected",
        ),
        (HEAD + record(1, 1, 3, more=TWO) + LAST, "byte 32: found 16 bytes of values, expected 12"),
        (HEAD + record(1, 1, 5, more=TWO) + LAST, "byte 32: found 16 bytes of values, expected 20"),
        (record(2, 2, 2, 5, more=b"K       ") + COLUMN + LAST, "K: found type 5, 2 rows, 2 columns, expected a real"),
    ],
)
def test_binary_op4_is_read_whole_or_refused_in_words(content, message, tmp_path):
    if not message:
        assert column_of(tmp_path, content) == [1.0, 2.0]
        return
    with pytest.raises(cf.errors.ModelError, match=rf"a\.op4: {message}.*matrix-file"):
        column_of(tmp_path, content)


@pytest.mark.parametrize("long", [False, True])
@pytest.mark.parametrize("length", [-1, 0, 1, 3, 4])
def test_strings_of_other_lengths_than_their_column_keeps_are_refused(length, long, tmp_path):
    """In words: one double has two, which is all that the column holds."""
    head, own = (-3, [length + 1, 1]) if long else (3, [1 + 65536 * (length + 1)])
    begun = record(1, head, 2, 2, more=b"K       ")
    column = record(1, 0, len(own) + 2, *own, more=TWO[:8])
    (tmp_path / "a.op4").write_bytes(begun + column + LAST)
    told = f"a string of {length} words in column 1, expected a multiple of 2 and at most 2"
    with pytest.raises(
        cf.errors.ModelError, match=rf"a\.op4: found a record that does not fit its matrix \({told}\).*matrix-f"
    ):
        cf.imported.read_matrices(tmp_path / "a.op4")


def test_op4_entries_that_are_given_again_are_refused(tmp_path):
    """A column twice in a text file, overlapping strings in a binary one: they were added."""
    lines = OP4.splitlines(keepends=True)
    (tmp_path / "a.op4").write_text("".join([*lines[:3], *lines[1:]]))
    with pytest.raises(
        cf.errors.ModelError, match=r"a\.op4: K: found row 1 of column 1 again, expected it once.*matrix-file"
    ):
        cf.imported.read_matrices(tmp_path / "a.op4")
    strings = [np.array([1 + row + 65536 * 5], "<i4").tobytes() + TWO for row in (0, 1)]
    begun = record(1, 3, 2, 2, more=b"K       ")
    (tmp_path / "a.op4").write_bytes(begun + record(1, 0, 10, more=b"".join(strings)) + LAST)
    with pytest.raises(
        cf.errors.ModelError, match=r"a\.op4: K: found row 2 of column 1 again, expected it once.*matrix-file"
    ):
        cf.imported.read_matrices(tmp_path / "a.op4")


def test_a_second_matrix_of_one_name_in_an_op4_file_is_refused(tmp_path):
    """What is no K, M or C may come again, as a load of each subcase."""
    for content in (OP4.encode() * 2, (HEAD + COLUMN + LAST) * 2):
        (tmp_path / "a.op4").write_bytes(content)
        with pytest.raises(
            cf.errors.ModelError, match=r"a\.op4: found the matrix K again, expected it once.*matrix-file"
        ):
            cf.imported.read_matrices(tmp_path / "a.op4")
    assert column_of(tmp_path, OP4.replace("2K ", "2PG") * 2 + OP4 + OP4.replace("K ", "M ")) == [1.0, 2.0]


def test_what_is_beside_the_matrices_of_a_superelement_is_passed_over(tmp_path):
    """Loads and recovery matrices of EXTSEOUT: rectangular, or complex, some with an M or a K at their beginning."""
    plain, whole = tmp_path / "plain.pch", tmp_path / "whole.pch"
    plain.write_text(PCH)
    header = "DMIG    {}   0       {}       {}       0\nDMIG*   {}                          7               1\n"
    beside = header.format("MUG1T", 9, 2, "MUG1T") + "*                      7               1 2.500000000D-01\n"
    beside += (
        header.format("KVIS ", 1, 3, "KVIS ") + "*                      7               1 2.5D-01         1.0D+00\n"
    )
    whole.write_text(beside + PCH + beside.replace("MUG1T", "VAX  ").replace("KVIS", "PAX "))
    found, expected = cf.imported.read_matrices(whole), cf.imported.read_matrices([plain])
    assert abs(found.K - expected.K).max() == abs(found.M - expected.M).max() == 0.0
    dofs = tmp_path / "dofs.csv"
    dofs.write_text("node,direction\n1,x\n2,x\n")
    K, M, tall = (csc_array(A) for A in ([[2.0, -1.0], [-1.0, 1.0]], np.eye(2), np.ones((3, 2))))
    parts = [binary_op4("KAA", K), binary_op4("KASMX", 7.0 * K), binary_op4("MUG1", tall), binary_op4("MAA", M)]
    (tmp_path / "part.op4").write_bytes(b"".join(parts))
    assert abs(cf.imported.read_matrices(tmp_path / "part.op4", dofs=dofs).K - K).max() == 0.0


def test_directions_of_a_table_of_dofs_by_letter_and_by_number(tmp_path):
    file = tmp_path / "dofs.csv"
    words = ("q", "x", "y", "z", "rx", "ry", "rz", *"0123456", "RZ")
    file.write_text("node,direction\n" + "".join(f"{k + 1},{word}\n" for k, word in enumerate(words)))
    np.savez(tmp_path / "a.npz", K=np.eye(15), M=np.eye(15))
    found = cf.imported.read_matrices(tmp_path / "a.npz", dofs=file).dofs
    assert found[:, 0].tolist() == list(range(1, 16))
    assert found[:, 1].tolist() == [*range(7), *range(7), 6]


@pytest.mark.slow
def test_dense_arrays_with_names_of_their_own(tmp_path):
    savemat(tmp_path / "a.mat", {"Kr": SET.K.toarray(), "Mr": SET.M.toarray(), "dofs": SET.dofs, "note": "by hand"})
    same(body(cf.imported.read_matrices([tmp_path / "a.mat"])))


@pytest.mark.slow
def test_matlab_hdf5(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, A in (("K", SET.K), ("M", SET.M)):
            group = file.create_group(name)
            group.attrs["MATLAB_sparse"] = A.shape[0]
            for part, values in (("data", A.data), ("ir", A.indices), ("jc", A.indptr)):
                group[part] = values
        file["dofs"] = SET.dofs
    same(body(cf.imported.read_matrices([tmp_path / "a.h5"])))


@pytest.mark.parametrize("method", ["free", "craig-bampton"])
@pytest.mark.parametrize("interface", [cf.modal.AtNodes(NODES), cf.TipNodes("tip", 1)], ids=["nodes", "pieces"])
def test_a_basis_is_its_matrices(method, interface):
    """Static compliance and dynamic compliance at some frequency, of the matrices and of the basis."""
    basis = cf.reduce(BLADE, interface, modes=7, method=method, zeta=0.01)
    matrices, k = cf.modal.basis_matrices(basis), len(basis.channels)
    for f in (0.0, 300.0, 1100.0):
        s = 2j * np.pi * f
        full = np.linalg.inv((matrices.K + s * matrices.C + s**2 * matrices.M).toarray())[:k, :k]
        modal = (basis.rows / (basis.omega**2 + 2 * s * basis.zeta * basis.omega + s**2)) @ basis.rows.T + basis.S
        np.testing.assert_allclose(full, modal, atol=1e-7 * np.abs(modal).max())
    if isinstance(interface, cf.modal.AtNodes):
        labels = [(node, NAMES[direction]) for node, direction in matrices.dofs.tolist()]
        back = ct.ModalBody.from_matrices(
            matrices.M, matrices.K, matrices.C, dofs=labels, contact=NODES, modes=len(labels)
        )
        np.testing.assert_allclose(back.omega, basis.omega, rtol=1e-7)
        np.testing.assert_allclose(compliance(back), basis.compliance, atol=1e-8 * np.abs(basis.compliance).max())
        np.testing.assert_allclose(back.S, basis.S, atol=1e-7 * np.abs(basis.compliance).max())
        np.testing.assert_allclose(back.zeta, 0.01, rtol=1e-5)


def test_a_shell_on_a_chart_as_matrices():
    plate = cf.Shell(
        chart=cf.Plate(length=0.1, width=0.05), thickness=2e-3, material=STEEL, supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=4, rows=2, around=1),
    )  # fmt: skip
    read = cf.modal.structure_matrices(plate)
    labels = [(node, NAMES[direction]) for node, direction in read.dofs.tolist()]
    tip = int(read.dofs[-1, 0])
    found = ct.ModalBody.from_matrices(read.M, read.K, dofs=labels, contact=[tip], modes=5)
    np.testing.assert_allclose(found.omega, cf.modes(plate, 5).omega, rtol=1e-8)
    ringed = cf.Shell(
        chart=cf.Cylinder(radius=0.5, height=0.2), thickness=0.01, material=STEEL,
        supports={"base": cf.Clamped(), "top": cf.ShearDiaphragm()}, mesh=cf.ShellMesh(order=4, rows=1, around=7),
    )  # fmt: skip
    with pytest.raises(cf.errors.ModelError, match="an edge that is fixed along its own directions"):
        cf.modal.structure_matrices(ringed)


def test_what_ties_nodes_to_others_has_no_matrices_of_its_nodes():
    tip = MESH.groups["tip"].nodes
    heavy = replace(
        MESH, attachments=cf.imported.Attachments(masses=(cf.imported.PointMass(node=int(tip[0]), mass=0.5),))
    )
    added = cf.modal.structure_matrices(replace(BLADE, mesh=heavy)).M - SET.M
    at = np.flatnonzero(SET.dofs[:, 0] == MESH.node_numbers[tip[0]])
    np.testing.assert_allclose(added.toarray()[np.ix_(at, at)], 0.5 * np.eye(3), atol=1e-12)
    assert added.sum() == pytest.approx(1.5, rel=1e-9)
    tied = replace(
        MESH, attachments=cf.imported.Attachments(rigids=(cf.imported.Rigid(reference=int(tip[0]), nodes=tip[1:]),))
    )
    with pytest.raises(cf.errors.ModelError, match=r"matrices: found connections between nodes in grid.*matrix-size"):
        cf.modal.structure_matrices(replace(BLADE, mesh=tied))


def test_bases_whose_channels_hang_together_are_refused():
    basis = cf.reduce(BLADE, cf.modal.AtNodes(NODES), modes=5)
    with pytest.raises(cf.errors.ModelError, match="a singular S"):
        cf.modal.basis_matrices(replace(basis, S=np.ones_like(basis.S) * 1e-9))
    with pytest.raises(cf.errors.ModelError, match="6 channels whose motions in 5 modes"):
        cf.modal.basis_matrices(replace(basis, S=np.zeros_like(basis.S)))


@pytest.mark.slow
def test_a_craig_bampton_set_from_outside_rubs_as_our_own():
    """The same set as matrices: impulses and contact times to 1e-6; near-by casings amplify round-off to 1.5e-6."""
    casing = cf.Shell(
        chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3, material=STEEL, wall="linear",
        supports={"base": cf.Clamped()}, mesh=cf.ShellMesh(order=6, rows=1, around=9),
    )  # fmt: skip
    own = cf.reduce(BLADE, cf.modal.AtNodes(NODES), modes=6, method="craig-bampton", zeta=0.002)
    matrices = cf.modal.basis_matrices(own)
    labels = [(node, NAMES[direction]) for node, direction in matrices.dofs.tolist()]
    n = len(labels)
    outside = ct.ModalBody.from_matrices(matrices.M, matrices.K, matrices.C, dofs=labels, contact=NODES, modes=n)
    rim = modal_body(cf.reduce(casing, cf.Rim("top", n_max=8), modes=18, zeta=0.002))
    tips = tuple(ct.ContactPoint(span=f"{node}.x", flap=f"{node}.z", lean_deg=10.0) for node in NODES)
    results = [
        ct.run(
            ct.Rub(rim, (blade,), tips, clearance=-2e-5, speed=ct.Speed.constant(5.0), thickness=3e-3),
            law=ct.Coulomb(mu=0.2), t_end=1e-3, dt=4e-7,
        )
        for blade in (modal_body(own), outside)
    ]  # fmt: skip
    one, other = results
    assert one.impulse.sum() > 0.0
    np.testing.assert_allclose(other.impulse, one.impulse, rtol=1e-6)
    assert len(one.intervals[0]) == len(other.intervals[0])
    np.testing.assert_allclose(other.intervals[0], one.intervals[0], rtol=1e-6)


def modal_body(basis):
    """A basis as contact takes it, without a file."""
    return ct.ModalBody(
        omega=basis.omega, zeta=basis.zeta, channels=basis.channels, rows=basis.rows, S=basis.S, kind=basis.kind,
        n_max=basis.n_max, radius=basis.radius,
    )  # fmt: skip


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_import_and_export_on_the_command_line(tmp_path, held):
    """A basis out as DMIG cards and in again; the printout says what the matrices are."""
    EXACT.save(tmp_path / "two.npz")
    ran = run("export", tmp_path / "two.npz", "--format", "pch", "--out", tmp_path / "out")
    assert ran.exit_code == 0, ran.stderr
    arguments = ["import", tmp_path / "out" / "two.pch", "--contact", f"{NODES[0]},{NODES[1]}", "--modes", "6"]
    ran = run(*arguments, "--out", tmp_path / "back.npz")
    assert ran.exit_code == 0, ran.stderr
    assert "12 unknowns, 6 of them without mass, 0 rigid modes" in ran.stdout
    assert "residual compliance: included" in ran.stdout
    np.testing.assert_allclose(cf.ModalBasis.load(tmp_path / "back.npz").omega, EXACT.omega, rtol=1e-6)
    document = json.loads(run(*arguments, "--json").stdout)
    assert document["matrices"]["massless"] == 6
    assert document["channels"] == list(EXACT.channels)
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.parametrize("form", ["mtx", "pch", "op4", "npz", "mat"])
@pytest.mark.parametrize("residual", [True, False])
def test_basis_that_turns_comes_back_with_its_matrices_in_every_format(residual, form, tmp_path):
    """Receptances at a speed, with Coriolis forces, damping between modes and a nonsymmetric stiffness."""
    rng = np.random.default_rng(5)
    G, damping = rng.standard_normal((2, 3, 3))
    basis = cf.ModalBasis(
        omega=np.array([40.0, 70.0, 90.0]), zeta=np.array([0.01, 0.0, 0.02]), channels=("6.x", "6.y"),
        rows=rng.standard_normal((2, 3)), S=1e-4 * np.array([[2.0, 1.0], [1.0, 3.0]]) * residual, kind="point",
        gyroscopic=G - G.T, damping=damping @ damping.T, stiffness=300.0 * (G - G.T),
    )  # fmt: skip
    basis.save(tmp_path / "rotor.npz")
    assert run("export", tmp_path / "rotor.npz", "--format", form, "--out", tmp_path).exit_code == 0
    files = sorted(tmp_path.glob("rotor_?.mtx")) if form == "mtx" else [*tmp_path.glob(f"rotor*.{form}")]
    files = [file for file in files if file.name != "rotor.npz"]
    arguments = ["import", *files, "--contact", "6", "--modes", "5", "--out", tmp_path / "back.npz"]
    arguments += ["--dofs", next(tmp_path.glob("*dofs.csv"))] if form in ("mtx", "op4") else []
    assert run(*arguments).exit_code == 2  # nonsymmetric matrices have to be meant
    ran = run(*arguments, "--nonsymmetric")
    assert ran.exit_code == 0, ran.stderr
    found = []
    for path in ("rotor.npz", "back.npz"):
        body = ct.ModalBody.load(tmp_path / path)
        C, K = body.matrices(11.0)
        dynamic = K + 55j * C - 55.0**2 * np.eye(len(K))
        found.append(body.rows @ np.linalg.solve(dynamic, body.rows.T) + body.S)
    np.testing.assert_allclose(found[1], found[0], atol=1e-6 * np.abs(found[0]).max())


def test_import_takes_contact_and_positions_from_the_table_of_nodes(tmp_path, held):
    written(tmp_path, "mtx")
    tip = "node,x,y,z\n" + "".join(f"{n},{','.join(map(str, SET.points[n].tolist()))}\n" for n in NODES)
    (tmp_path / "tip.csv").write_text(tip)
    ran = run(
        "import", tmp_path / "part_K.mtx", tmp_path / "part_M.mtx", "--dofs", tmp_path / "part_dofs.csv",
        "--nodes", tmp_path / "tip.csv", "--modes", "6", "--json",
    )  # fmt: skip
    assert ran.exit_code == 0, ran.stderr
    document = json.loads(ran.stdout)
    np.testing.assert_allclose(document["freq_hz"], EXACT.freq, rtol=1e-9)
    assert document["channels"] == list(EXACT.channels)
    held(1e-4, document=numbers_of_document(document))


def test_import_names_its_files_where_a_message_does_not(tmp_path):
    (tmp_path / "K.mtx").write_text(ONE)
    (tmp_path / "M.mtx").write_text(ONE)
    ran = run("import", tmp_path / "K.mtx", tmp_path / "M.mtx", "--contact", "13")
    assert ran.exit_code == 2
    assert ran.stderr.startswith(f"{tmp_path / 'K.mtx'}, {tmp_path / 'M.mtx'}: contact: found node 13")


def test_import_needs_nodes_and_an_npz(tmp_path):
    (tmp_path / "set.pch").write_text(PCH)
    ran = run("import", tmp_path / "set.pch", "--contact", "7", "--out", tmp_path / "set.json")
    assert ran.exit_code == 2
    assert "--out: found 'set.json', expected a file name ending in .npz" in ran.stderr
    ran = run("import", tmp_path / "set.pch")
    assert ran.exit_code == 2
    assert "set.pch: found no nodes with contact; expected --contact, --nodes, or EXTRN" in ran.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["set.pch"]


PCH = """DMIG    KAAX           0       6       2       0
DMIG*   KAAX                           7               1
*                      7               1 1.000000000D+06
DMIG    MAAX           0       6       2       0
DMIG*   MAAX                           7               1
*                      7               1 1.000000000D+00
"""
BAD = {
    "complex": (PCH.replace("6       2       0\nDMIG*   K", "6       3       0\nDMIG*   K"), "line 1: DMIG: .*type 3"),
    "rectangular": (PCH.replace("0       6       2", "0       9       2", 1), "line 1: DMIG: found KAAX of form 9"),
    "no header": (PCH.split("\n", 1)[1], "line 1: DMIG: found a column of KAAX before its header"),
    "no mass": (PCH[: PCH.index("DMIG    MAAX")], "found the matrices KAAX; 0 of these"),
    "two": (PCH + PCH.replace("KAAX", "KBBX").replace("MAAX", "BAAX"), "2 of these"),
    "number": (PCH.replace("1.000000000D+06", "1.0x0000000D+06"), "line 2: DMIG: .*expected a real number"),
    "value": (PCH.replace(" 1.000000000D+06", ""), "expected node, component and value of a row"),
    "fields": (PCH + "DMIG,KAAX,8\n", "line 7: DMIG: found 2 fields, expected a name, a node and a component"),
    "blank": (PCH + "DMIG\n", "line 7: DMIG: found 0 fields, expected a name, a node and a component"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_punch_files_name_the_line(name, tmp_path):
    text, message = BAD[name]
    (tmp_path / "set.pch").write_text(text)
    with pytest.raises(cf.errors.ModelError, match=message):
        cf.imported.read_matrices([tmp_path / "set.pch"])
    assert run("import", tmp_path / "set.pch", "--contact", "7").exit_code == 2


def test_a_column_of_dmig_may_be_empty(tmp_path):
    (tmp_path / "set.pch").write_text(PCH + "DMIG,KAAX,7,1\n")
    assert cf.imported.read_matrices(tmp_path / "set.pch").K.toarray().tolist() == [[1e6]]


DENSE = "%%MatrixMarket matrix array real general\n"
ONE, CALCULIX = "1,1,1,1,2.\n", {"a.sti": "1 1 1.0\n", "a.mas": "1 1 1.0\n", "a.dof": "6.6\n"}
SQUARE = f"{DENSE}2 2\n1\n2\n3\n4\n"


@pytest.mark.parametrize(
    ("taken", "refused", "message"),
    [
        (CALCULIX, {"a.sti": "2 1 1.0\n"}, r"a\.sti: found row 2, and 1 dofs.*matrix-size"),
        (CALCULIX, {"a.mas": "1 2 1.0\n"}, r"a\.mas: found row 2, and 1 dofs.*matrix-size"),
        (CALCULIX, {"a.sti": "0 1 1.0\n"}, r"a\.sti: found row 0, and 1 dofs.*matrix-size"),
        ({"K.mtx": ONE, "M.mtx": ONE}, {"K.mtx": "", "M.mtx": ""}, "K.mtx, M.mtx: found no entries and no dofs"),
        (CALCULIX, {"a.mas": "1 1 1.0 1\n"}, "a.mas: found 4 columns, expected 3"),
        (CALCULIX, {"a.mas": "1 1 1.0x\n"}, "a.mas: .*'1.0x'"),
        *((CALCULIX, {"a.dof": f"{dof}\n"}, f"a.dof: line 1: found '{dof}', expected node") for dof in
          ("6.7", "6", "6.", ".1", "x.1", "6.-1")),
        ({"K.mtx": ONE, "M.mtx": ONE}, {"M.mtx": ONE + "2,1,2,1,3.\n"},
         r"K\.mtx, M\.mtx: found mass or damping but no stiffness.*matrix-size"),
        ({"K.mtx": ONE, "M.mtx": ONE}, {"M.mtx": "1,1,1,2.\n"}, "M.mtx: found 4 columns, expected 5"),
        ({"K.mtx": ONE, "M.mtx": ONE}, {"M.mtx": "1,1,1,1,2.,3.\n"}, "M.mtx: found 6 columns, expected 5"),
        ({"K.mtx": ONE, "M.mtx": ONE}, {"M.mtx": "1,1,1,1,2.\n2,1\n"}, "M.mtx: .*columns changed from 5 to 2"),
        *((
            {"K.mtx": f"{MARKET}2 2 1\n2 1 1.0\n", "M.mtx": f"{MARKET}2 2 1\n1 1 1.0\n", "K.dof": "6.0\n7.0\n"},
            {"K.mtx": f"{MARKET}{text}\n"}, f"K.mtx: {message}"
        ) for text, message in (
            ("2 2 1\n0 1 1.0", "found an entry outside the matrix, expected rows and columns 1 to 2"),
            ("2 2 1\n3 1 1.0", "found an entry outside the matrix, expected rows and columns 1 to 2"),
            ("2 2 1\n1 2 1.0", "found entries above the diagonal of a symmetric matrix"),
            ("2 2 2\n2 1 1.0", "found 1 entries, expected 2: cut short"),
            ("2 2 0\n2 1 1.0", "found 1 entries, expected 0; export it again"),
            ("2 3 1\n2 1 1.0", "found a matrix of 2 x 3, expected a square one of 1 to 100000000 rows; export it"),
            ("0 0 0", "found a matrix of 0 x 0, expected a square one"),
            (f"{10**8 + 1} {10**8 + 1} 0", "found a matrix of 100000001 x 100000001, expected a square one of 1 to"),
            ("", r"found no line with the numbers of rows, columns and entries: cut short\?"),
        )),
        *((
            {"K.mtx": SQUARE, "M.mtx": SQUARE, "K.dof": "6.1\n7.1\n"}, {"K.mtx": text}, f"K.mtx: {message}"
        ) for text, message in (
            (DENSE, r"found '', expected the numbers of rows and columns; .*matrix-file"),
            (SQUARE.replace("2 2", "2 x"), r"found '2 x', expected the numbers of rows and columns; .*matrix-file"),
            (SQUARE.replace("2 2", f"{'9' * 5000} 2"), "found '9{60}', expected the numbers of rows"),
            (SQUARE.replace("2 2", "-2 -2"), r"found '-2 -2', expected the numbers of rows and columns"),
            (SQUARE.replace("3", "3x"), r"found '3x', expected a number; .*matrix-file"),
            (SQUARE[:-2], "found 3 entries, expected 4: cut short"),
            (SQUARE + "5\n", "found 5 entries, expected 4; export it again"),
            (SQUARE.replace("2 2", "2 3"), "found a matrix of 2 x 3, expected a square one"),
            (SQUARE.replace("general", "symmetric"), "found 4 entries, expected 3; export it again"),
            (f"{DENSE}0 0\n", "found a matrix of 0 x 0, expected a square one"),
            (SQUARE.replace("matrix array", "vector coordinate"), "found vector coordinate real general, expected mat"),
            (SQUARE.replace("matrix array", "matrix banded"), "found matrix banded real general, expected matrix"),
            (SQUARE.replace("real", "complex"), "found matrix array complex general, expected matrix coord"),
            (SQUARE.replace("general", "hermitian"), "found matrix array real hermitian, expected matrix"),
            (SQUARE.replace(" general", ""), "found matrix array real, expected matrix coordinate or array"),
        )),
    ],
)  # fmt: skip
def test_lists_of_entries_are_read_whole_or_refused(taken, refused, message, tmp_path):
    for name, text in taken.items():
        (tmp_path / name).write_text(text)
    given = tmp_path / "a.sti" if "a.sti" in taken else [tmp_path / "K.mtx", tmp_path / "M.mtx"]
    cf.imported.read_matrices(given)
    for name, text in refused.items():
        (tmp_path / name).write_text(text)
    with pytest.raises(cf.errors.ModelError, match=message):
        cf.imported.read_matrices(given)


def test_columns_of_tables_of_nodes_and_dofs_are_asked_for_by_name(tmp_path):
    np.savez(tmp_path / "a.npz", K=np.eye(2), M=np.eye(2))
    nodes, dofs = tmp_path / "nodes.csv", tmp_path / "dofs.csv"
    nodes.write_text("# of the tip\nz,y,x,node\n4,3,2,1\n")
    dofs.write_text("direction,node,note\nx,1,a\ny,1,b\n")
    found = cf.imported.read_matrices(tmp_path / "a.npz", nodes=nodes, dofs=dofs)
    assert found.points[1].tolist() == [2.0, 3.0, 4.0]
    assert found.dofs.tolist() == [[1, 1], [1, 2]]
    nodes.write_text("# of the tip\nnode,x,z\n1,2,4\n")
    with pytest.raises(
        cf.errors.InputError, match=r"nodes.csv, line 2: found no column y; expected columns node, x, y, z"
    ):
        cf.imported.read_matrices(tmp_path / "a.npz", nodes=nodes, dofs=dofs)
    dofs.write_text("point,dir\n1,x\n")
    with pytest.raises(
        cf.errors.InputError, match=r"dofs.csv, line 1: found no column node, direction; expected columns node, d"
    ):
        cf.imported.read_matrices(tmp_path / "a.npz", dofs=dofs)


@pytest.mark.parametrize("names", [("a.npz", "b.npz"), ("K.mtx", "M.npz"), ("a.xyz",), ("K.mtx", "M")])
def test_files_that_do_not_go_together_are_named(names, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"found {', '.join(names)}; .*matrix-format"):
        cf.imported.read_matrices([tmp_path / name for name in names])


def test_no_file_of_matrices_is_refused():
    with pytest.raises(cf.errors.ModelError, match=r"found no file; .*matrix-format"):
        cf.imported.read_matrices([])


@pytest.mark.parametrize("part", ["data", "indices"])
def test_a_sparse_matrix_of_an_npz_has_three_parts(part, tmp_path):
    K = {"K_data": np.ones(1), "K_indices": np.zeros(1, int), "K_indptr": np.array([0, 1])}
    rest = {"M": np.eye(1), "dofs": np.array([[1, 1]])}
    np.savez(tmp_path / "a.npz", **K, **rest)
    assert cf.imported.read_matrices(tmp_path / "a.npz").K.toarray().tolist() == [[1.0]]
    del K[f"K_{part}"]
    np.savez(tmp_path / "a.npz", **K, **rest)
    with pytest.raises(
        cf.errors.ModelError, match=r"a.npz: K: found only a part of the arrays, expected K_data.*matrix-file"
    ):
        cf.imported.read_matrices(tmp_path / "a.npz")


def test_what_hdf5_needs_is_named(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(cf.errors.ModelError, match=r"a.h5: HDF5 needs h5py: .*test-data.*matrix-file"):
        cf.imported.read_matrices(tmp_path / "a.h5")


@pytest.mark.slow
def test_an_op4_file_cut_anywhere_is_refused_or_whole(tmp_path):
    small = cf.imported.MatrixSet(
        K=csc_array(np.diag([2.0, 3.0])), M=csc_array(np.eye(2)), dofs=np.array([[1, 1], [2, 1]])
    )
    cf.imported.write_matrices(tmp_path / "a.op4", small)
    text = (tmp_path / "a.op4").read_bytes()
    binary = binary_op4("K", small.K) + binary_op4("M", small.M)
    path = tmp_path / "a.op4"
    for content in (text, binary):
        for end in range(5, len(content) - 1, 3):
            path.write_bytes(content[:end])
            try:
                found = cf.imported.read_matrices(path, dofs=tmp_path / "a_dofs.csv")
            except cf.errors.ModelError:
                continue
            for read, A in ((found.K, small.K), (found.M, small.M)):
                np.testing.assert_allclose(read.toarray(), A.toarray(), rtol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({"a.op4": "x"}, "a.op4: line 1: found 'x'"),
        ({"a.sti": "1 1 1.0\n", "a.mas": "1 1 1.0\n"}, r"found no file a\.dof beside it"),
        ({"a.sti": "1 1 1.0\n", "a.mas": "1 1 1.0\n", "a.dof": "6.9\n"}, "line 1: found '6.9'"),
        ({"a.sti": "1 3 1.0\n", "a.mas": "1 1 1.0\n", "a.dof": "6.1\n"}, r"a\.sti: found row 3, and 1 dofs"),
        ({"a.sti": "1 1 x\n", "a.mas": "1 1 1.0\n", "a.dof": "6.1\n"}, "a.sti: .*x"),
        ({"a.sti": "1 1\n", "a.mas": "1 1 1.0\n", "a.dof": "6.1\n"}, "found 2 columns, expected 3"),
        ({"K.mtx": "%%MatrixMarket matrix array real general\n", "M.mtx": ""}, "K.mtx: "),
        ({"K.mtx": f"{MARKET}1 1 1\n1 1 1.7e", "M.mtx": ""}, "K.mtx: .*1.7e"),  # ends the program in scipy's reader
        ({"K.mtx": f"{MARKET}2 2 2\n1 1 1.0\n", "M.mtx": ""}, "K.mtx: found 1 entries, expected 2: cut short"),
        ({"K.mtx": f"{MARKET}1 1 1\n1 2 1.0\n", "M.mtx": ""}, "K.mtx: found an entry outside the matrix"),
        ({"K.mtx": f"{MARKET}2 2 1\n1 2 1.0\n", "M.mtx": ""}, "K.mtx: found entries above the diagonal"),
        ({"K.mtx": MARKET.replace("real", "complex"), "M.mtx": ""}, "K.mtx: found matrix coordinate complex"),
        ({"a.op4": f"{'2K':>8}{2:8d}{6:8d}{2:8d}KAAX    1P,3E23.16\n"}, "a.op4: line 1: found '.*2K"),
        ({"a.op4": "", "b.sti": ""}, "found a.op4, b.sti"),
        ({"a.xyz": ""}, "found a.xyz"),
        ({"a.mat": "no"}, "no readable .mat file"),
        ({"a.h5": "no"}, "no readable HDF5 file"),
    ],
)
def test_bad_files_are_named(files, message, tmp_path):
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    given = [tmp_path / name for name in files]
    with pytest.raises(cf.errors.InputError, match=message):
        cf.imported.read_matrices(
            given if len({path.suffix for path in given}) < 3 and given[0].suffix != ".sti" else given[:1]
        )


def matrix_market(path, A):
    mmwrite(path, A)
    return path


@pytest.mark.filterwarnings("ignore:The default value for `spmatrix`")
@pytest.mark.parametrize("dense", [False, True])
@pytest.mark.parametrize("symmetry", ["general", "symmetric"])
def test_matrix_market_is_read_as_scipy_reads_it(tmp_path, dense, symmetry):
    half = np.random.default_rng(5).normal(size=(4, 4)).round(3)
    A = half + half.T if symmetry == "symmetric" else half
    path = tmp_path / "K.mtx"
    mmwrite(path, A if dense else csc_array(np.where(np.abs(A) > 0.5, A, 0.0)), symmetry=symmetry, comment="a line")
    found = mmread(path)
    np.savetxt(tmp_path / "K.dof", [f"{node}.1" for node in range(1, 5)], fmt="%s")
    read = cf.imported.read_matrices([path, matrix_market(tmp_path / "M.mtx", np.eye(4))]).K
    np.testing.assert_array_equal(read.toarray(), found if dense else found.toarray())


@pytest.mark.parametrize("exponent", ["D", "d"])
def test_matrix_market_with_fortrans_exponents(exponent, tmp_path):
    coordinates = MARKET + "2 2 2\n1 1 3.0E1\n2 2 4.0E0\n"
    for text in (coordinates, f"{DENSE}2 2\n3.0E1\n0\n0\n4.0E+0\n"):
        (tmp_path / "K.mtx").write_text(re.sub(r"(?<=\.0)E", exponent, text))
        (tmp_path / "K.dof").write_text("1.1\n2.1\n")
        found = cf.imported.read_matrices([tmp_path / "K.mtx", matrix_market(tmp_path / "M.mtx", np.eye(2))])
        assert found.K.toarray().tolist() == [[30.0, 0.0], [0.0, 4.0]]


def test_formats_without_dofs_ask_for_them(tmp_path):
    written(tmp_path, "op4")
    written(tmp_path, "mtx")
    np.savez(tmp_path / "a.npz", K=np.eye(2), M=np.eye(2))
    for files in ([tmp_path / "part.op4"], [tmp_path / "part_K.mtx", tmp_path / "part_M.mtx"], [tmp_path / "a.npz"]):
        with pytest.raises(cf.errors.ModelError, match="matrix-dofs"):
            cf.imported.read_matrices(files)
    (tmp_path / "dofs.csv").write_text("node,direction\n7,x\n7,w\n")
    with pytest.raises(cf.errors.InputError, match="line 3: found 7, w"):
        cf.imported.read_matrices([tmp_path / "a.npz"], dofs=tmp_path / "dofs.csv")
    (tmp_path / "dofs.csv").write_text("node,direction\n7,x\n7,x\n")
    with pytest.raises(cf.errors.ModelError, match="found direction 1 of node 7 in"):
        cf.imported.read_matrices([tmp_path / "a.npz"], dofs=tmp_path / "dofs.csv")
    (tmp_path / "dofs.csv").write_text("node,direction\n7,x\n")
    with pytest.raises(cf.errors.ModelError, match="K of 2 x 2, M of 2 x 2, and 1 dofs"):
        cf.imported.read_matrices([tmp_path / "a.npz"], dofs=tmp_path / "dofs.csv")
    (tmp_path / "nodes.csv").write_text("node,x,y,z\n7,0,0,0\n7,0,0,1\n")
    (tmp_path / "dofs.csv").write_text("node,direction\n7,x\n7,y\n")
    with pytest.raises(cf.errors.InputError, match="found node 7 again"):
        cf.imported.read_matrices([tmp_path / "a.npz"], dofs=tmp_path / "dofs.csv", nodes=tmp_path / "nodes.csv")


@pytest.mark.parametrize(
    ("dofs", "shape"), [([[7, 1, 0], [7, 2, 0]], r"\(2, 3\)"), ([7, 7], r"\(2,\)")], ids=["columns", "row"]
)
def test_dofs_of_another_shape_are_refused(dofs, shape, tmp_path):
    np.savez(tmp_path / "a.npz", K=np.eye(2), M=np.eye(2), dofs=np.array(dofs))
    with pytest.raises(cf.errors.ModelError, match=rf"a.npz: dofs: found the shape {shape}, expected \(n, 2\)"):
        cf.imported.read_matrices([tmp_path / "a.npz"])
