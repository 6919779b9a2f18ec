"""What reading adds to a file's arrays: units, blocks, copies, flags, numbers that are too large."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.read import (
    LONGEST,
    blocks_of,
    is_flag,
    read_vtu,
    require_modest,
    sizes_of,
    without_copies,
)
from casingfem.structure.imported.readers.draft import Block

FILE = Path("part.msh")


@pytest.mark.parametrize(("scale", "units", "sizes"), [
    (0.5, None, (0.5, 1.0, 1.0)), (1.0, "mm-t-s", (1e-3, 1e3, 1.0)), (1.0, "m-kg-s", (1.0, 1.0, 1.0)),
])  # fmt: skip
def test_sizes_of_units(scale, units, sizes):
    assert sizes_of("part.inp", scale, units) == pytest.approx(sizes, rel=1e-14)


def test_units_stand_instead_of_a_scale_and_must_be_known():
    with pytest.raises(cf.errors.ModelError, match=r"part\.inp: found scale = 0\.001 beside units 'mm-t-s'") as caught:
        sizes_of("part.inp", 1e-3, "mm-t-s")
    assert caught.value.code == "mesh-scale"
    with pytest.raises(cf.errors.ModelError, match=r"part\.inp: .*furlong"):
        sizes_of("part.inp", 1.0, "furlong-t-s")


@pytest.mark.parametrize(("given", "told"), [
    ({"scale": 0.0}, "scale must be above 0, found 0.0"), ({"scale": -1.0}, "scale must be"),
    ({"scale": np.inf}, "scale must be above 0, found inf"), ({"join": -1e-9}, "join must be 0 or a distance"),
    ({"join": np.inf}, "join must be 0 or a distance, found inf"),
])  # fmt: skip
def test_scale_and_join_are_finite_numbers(given, told):
    with pytest.raises(cf.errors.ModelError, match=f"part.msh: {told}"):
        cf.read_mesh(FILE, **given)


def test_endings_that_no_reader_has_are_refused():
    with pytest.raises(cf.errors.ModelError, match=r"part\.stp: found the ending '\.stp'"):
        cf.read_mesh("part.stp")


def found(*cells, points=4):
    blocks = [SimpleNamespace(type=kind, data=np.array(rows)) for kind, rows in cells]
    return SimpleNamespace(points=np.zeros((points, 3)), cells=blocks)


def test_blocks_are_numbered_on_in_the_order_of_the_file():
    blocks = blocks_of(found(("line", [[0, 1], [1, 2], [2, 3]]), ("triangle", [[0, 1, 3], [0, 1, 2]])), FILE)
    assert [(b.kind, b.numbers.tolist()) for b in blocks] == [("line", [1, 2, 3]), ("triangle", [4, 5])]


@pytest.mark.parametrize(("row", "number"), [([2, 4], 5), ([-1, 2], 5)])
def test_the_cell_that_names_a_node_that_is_not_given_is_named(row, number):
    mesh = found(("triangle", [[0, 1, 2], [0, 1, 3]]), ("line", [[0, 1], [0, 3], row, row]))
    with pytest.raises(cf.errors.ModelError, match=f"part.msh: cell {number} names a node that is not given"):
        blocks_of(mesh, FILE)


def test_of_cells_written_for_each_of_their_groups_the_first_stays():
    """Cells a b a c b: what is left is a b c, in the order of the file; groups name each once."""
    cells = np.array([[7, 8], [1, 2], [7, 8], [0, 5], [1, 2]])
    blocks, sets = without_copies(
        [Block("line", cells, np.arange(11, 16)), Block("vertex", np.array([[3], [3]]), np.arange(16, 18))],
        {"one": [(0, np.array([2, 3, 0]))], "other": [(0, np.array([4])), (1, np.array([1]))]},
    )
    assert blocks[0].cells.tolist() == [[7, 8], [1, 2], [0, 5]]
    assert blocks[0].numbers.tolist() == [11, 12, 14]
    assert (blocks[1].cells.tolist(), blocks[1].numbers.tolist()) == ([[3]], [16])
    told = {name: [(k, rows.tolist()) for k, rows in parts] for name, parts in sets.items()}
    assert told == {"one": [(0, [0, 2])], "other": [(0, [1]), (1, [0])]}


@pytest.mark.parametrize(("parts", "flag"), [
    ([[0, 1, 1]], True), ([[0, 1], [1]], True), ([[0, 1], [2]], False), ([[0, 2]], False), ([[-1, 1]], False),
    ([[0.0, 1.0]], False), ([[[0, 1]]], False), ([[True, False]], True),
])  # fmt: skip
def test_flags_are_whole_numbers_0_and_1(parts, flag):
    assert is_flag(parts) is flag
    assert is_flag([np.array([0, 1], dtype=np.uint8)])


TEXT = b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"


@pytest.mark.parametrize(("number", "refused"), [(b"10000000", False), (b"10000001", True), (b"-10000001", True),
                                                 (b"-9999999", False), (b"9" * 40, True)])  # fmt: skip
def test_numbers_of_nodes_are_not_beyond_ten_million_in_a_short_file(number, refused):
    content = TEXT + b"$Nodes\n1\n" + number + b" 0 0 0\n$EndNodes"
    if not refused:
        require_modest(content, FILE)
        return
    told = f"part.msh: the number {number[:30].decode()} in a file of {len(content)} bytes, expected at most 10000000"
    with pytest.raises(cf.errors.ModelError, match=told):
        require_modest(content, FILE)


def test_coordinates_with_many_digits_are_no_numbers_of_nodes():
    require_modest(TEXT + b"$Nodes\n1\n1 0.123456789 123456789.5 1e123456789\n$EndNodes", FILE)


@pytest.mark.parametrize(("length", "refused"), [(LONGEST, False), (LONGEST + 1, True)])
def test_names_have_a_longest_line(length, refused):
    content = TEXT + b"$PhysicalNames\n" + b"a" * length + b"\nb\n$EndPhysicalNames\n" + b"c" * 20_000
    if refused:
        with pytest.raises(cf.errors.ModelError, match=r"\$PhysicalNames: a line of more than 10000 characters"):
            require_modest(content, FILE)
    else:
        require_modest(content, FILE)


@pytest.mark.parametrize(("text", "count"), [(b"<VTKFile></VTKFile>", 0), (b"<Piece a='1'><Piece a='2'>", 2)])
def test_a_grid_has_one_piece(text, count, tmp_path):
    (tmp_path / "part.vtu").write_bytes(text)
    with pytest.raises(cf.errors.ModelError, match=rf"part\.vtu: {count} pieces, expected one"):
        read_vtu(tmp_path / "part.vtu")


@pytest.mark.parametrize("directions", [(), ("x", "x"), ("x", "w"), ("r",)])
def test_directions_are_some_of_the_axes_each_once(directions):
    with pytest.raises(ValueError, match=r"directions must name some of x, y, z, each once, found \("):
        cf.imported.Fixed(directions=directions)
    assert cf.imported.Fixed(directions=["z", "y"]).directions == ("z", "y")
    assert cf.imported.Fixed(directions=("z", "y")).held == (2, 1)
