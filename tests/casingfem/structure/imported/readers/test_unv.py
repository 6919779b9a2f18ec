"""Universal files as meshes: order of the nodes, groups, units, what is left out and what is refused."""

import warnings

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.structure.imported.parts import STEEL

DESCRIPTORS = {"quad": 94, "quad8": 95, "tetra": 111, "tetra10": 118, "hexahedron": 115, "hexahedron20": 116}


def data_set(number, *lines):
    return "\n".join(["    -1", f"{number:6d}", *lines, "    -1", ""])


def nodes(points, labels=None, system=0):
    rows = []
    for label, x in zip(labels or range(1, len(points) + 1), points, strict=True):
        rows += [f"{label:10d}{system:10d}{0:10d}{11:10d}", "".join(f"{v:25.16E}".replace("E", "D") for v in x)]
    return data_set(2411, *rows)


def eight(numbers):
    return ["".join(f"{n:10d}" for n in numbers[k : k + 8]) for k in range(0, len(numbers), 8)]


BEAMS = (21, 22, 23, 24, 25)


def elements(descriptor, cells, first=1, number=2412):
    rows = []
    section = ["         0         1         1"] if descriptor in (11, *BEAMS) else []
    for label, cell in enumerate(cells, first):
        facts = [label, descriptor, 1, 1, *([1, 1] if number == 780 else []), 7, len(cell)]
        rows += [*eight(facts), *section, *eight(list(cell))]
    return data_set(number, *rows)


def group(name, members, kind, number=2467):
    width = [0, 0] if number == 2467 else []
    flat = [n for member in members for n in (kind, member, *width)]
    return data_set(number, *eight([3, 0, 0, 0, 0, 0, 0, len(members)]), name, *eight(flat))


def ring(corners, middle):
    """Corners and the middles between them in turn, as universal files go round a face."""
    n = len(corners)
    return [node for k in range(n) for node in (corners[k], middle(corners[k], corners[(k + 1) % n]))]


def around(mesh, cell):
    """The nodes of a cell in the order of a universal file, from where they are: rings, uprights between them."""
    kind, numbers = mesh.kind, {tuple(np.round(mesh.points[node], 9)): int(node) for node in cell}
    corners = list(cell[: len(mesh.cell_kind.corners)])
    if not mesh.cell_kind.middles:
        return corners

    def middle(a, b):
        return numbers[tuple(np.round(0.5 * (mesh.points[a] + mesh.points[b]), 9))]

    if kind == "quad8":
        return ring(corners, middle)
    if kind == "tetra10":
        return [*ring(corners[:3], middle), *(middle(a, corners[3]) for a in corners[:3]), corners[3]]
    low, high = corners[:4], corners[4:]
    return [*ring(low, middle), *(middle(a, b) for a, b in zip(low, high, strict=True)), *ring(high, middle)]


def written(mesh, label=lambda node: int(node) + 1, **more):
    cells = [[label(node) for node in around(mesh, cell)] for cell in mesh.cells]
    held = [label(node) for node in mesh.groups["root"].nodes]
    labels = [label(node) for node in range(len(mesh.points))]
    return (
        nodes(mesh.points, labels) + elements(DESCRIPTORS[mesh.kind], cells, **more)
        + group("root", held, 7) + group("half", range(1, 2), 8)
    )  # fmt: skip


def read(folder, text, **given):
    (folder / "part.unv").write_text(text)
    return cf.read_mesh(folder / "part.unv", **given)


@pytest.mark.parametrize("kind", DESCRIPTORS)
def test_cells_nodes_and_groups_are_those_that_were_written(kind, tmp_path):
    """Node labels are 7, 10, 13, ...; the first cell is the group half."""
    dim = 2 if kind.startswith("quad") else 3
    sides = np.array([0.4, 0.2, 0.1])[:dim]
    mesh = cf.imported.grid_mesh(
        kind, (2, 1, 1)[:dim], lambda u: np.pad(u * sides, ((0, 0), (0, 3 - dim))), groups={"root": (0, 0.0)}
    )
    found = read(tmp_path, written(mesh, lambda node: 3 * int(node) + 7))
    assert found.kind == kind
    np.testing.assert_array_equal(found.cells, mesh.cells)
    np.testing.assert_allclose(found.points, mesh.points, rtol=1e-15)
    assert found.node_numbers[:3].tolist() == [7, 10, 13]
    assert list(found.groups) == ["root", "half"]
    assert found.groups["root"].nodes.tolist() == mesh.groups["root"].nodes.tolist()
    assert found.groups["half"].cells.tolist() == [0]


SQUARE = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0.5, 0]]
PLATE = nodes(SQUARE) + elements(44, [[1, 2, 3, 4]]) + elements(41, [[2, 5, 3]], 2) + elements(11, [[4, 1]], 3)


def test_squares_triangles_and_edges_make_a_shell_with_a_group_of_edges(tmp_path):
    mesh = read(tmp_path, PLATE + group("edge", [3], 8))
    assert (mesh.kind, len(mesh.cells), mesh.collapsed.tolist()) == ("quad", 2, [False, True])
    assert mesh.groups["edge"].facets.shape == (1, 2)
    assert mesh.facet_nodes(mesh.groups["edge"].facets).tolist() == [[3, 0]]
    shell = cf.MeshShell(mesh=mesh, thickness=0.1, material=STEEL, supports={"edge": cf.Clamped()})
    assert shell.assembled().rigid == 0


@pytest.mark.parametrize(("descriptor", "count"), [(71, 3), (71, 4), (74, 3), (74, 4)])
def test_membranes_are_reported_by_their_nodes(descriptor, count, tmp_path):
    mesh = read(tmp_path, nodes(SQUARE) + elements(descriptor, [[1, 2, 3, 4][:count]]))
    assert mesh.collapsed.tolist() == [count == 3]


def test_wedges_and_pyramids_with_middle_nodes_keep_their_volume(tmp_path):
    """Nodes written ring by ring, as the format's description has them; straight sides, volumes 1/2 and 1/3."""
    low, high = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 1]])
    base, apex = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([0.0, 0.0, 1.0])

    def around_ring(x):
        return [point for a, b in zip(x, np.roll(x, -1, axis=0), strict=True) for point in (a, 0.5 * (a + b))]

    wedge = [*around_ring(low), *(0.5 * (low + high)), *around_ring(high)]
    pyramid = [*around_ring(base), *(0.5 * (base + apex)), apex]
    for descriptor, points, volume in ((113, wedge, 0.5), (114, pyramid, 1.0 / 3.0)):
        mesh = read(tmp_path, nodes(points) + elements(descriptor, [list(range(1, len(points) + 1))]))
        solid = cf.Solid(mesh=mesh, material=STEEL)
        assert solid.assembled().M.sum() == pytest.approx(3.0 * STEEL.rho * volume, rel=1e-12)


def test_sets_of_older_programs_are_read_too(tmp_path):
    rows = [f"{k:10d}{0:10d}{0:10d}{11:10d}" + "".join(f"{v:13.5E}" for v in x) for k, x in enumerate(SQUARE, 1)]
    text = data_set(15, *rows) + elements(94, [[1, 2, 3, 4]], number=780) + group("corner", [1, 2], 7, number=2432)
    mesh = read(tmp_path, text)
    assert mesh.groups["corner"].nodes.tolist() == [0, 1]
    np.testing.assert_allclose(mesh.points, SQUARE)


def test_a_stated_unit_of_length_is_taken_once(tmp_path):
    units = data_set(164, "         5MM (MILLI-NEWTON)             2", "  1.0D+03  1.0D+03  1.0D+00", "  2.7315D+02")
    assert read(tmp_path, units + PLATE).size == pytest.approx(1e-3 * np.sqrt(5.0))
    with pytest.raises(
        cf.errors.ModelError, match=r"part\.unv: .* states its unit of length, 0\.001 m; expected neither.*mesh-scale"
    ):
        read(tmp_path, units + PLATE, scale=1e-3)
    assert read(tmp_path, PLATE, scale=1e-3).size == pytest.approx(1e-3 * np.sqrt(5.0))


def test_springs_and_unknown_sets_are_left_out_with_a_warning(tmp_path):
    beams = elements(21, [[1, 2], [2, 3]], 20) + group("rib", [21], 8)
    text = (
        PLATE + beams + elements(136, [[1, 2]], 9) + data_set(791, "1") + data_set(151, "a title") + group("g", [1], 11)
    )
    left = "1 element with descriptor 136, 1 set 791, 1 member of type 11 of group 'g', 1 beam in no group"
    with pytest.warns(cf.errors.ModelWarning, match=left + r".*mesh-left-out"):
        assert len(read(tmp_path, text).cells) == 2


@pytest.mark.parametrize("descriptor", BEAMS)
def test_every_beam_has_a_line_on_its_section_and_a_rod_is_no_beam(descriptor, tmp_path):
    for other, words in ((descriptor, "1 beam in no group"), (11, None)):
        text = PLATE + elements(other, [[1, 2, 3]], 20)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            assert len(read(tmp_path, text).cells) == 2
        assert [words in str(one.message) for one in caught] == ([True] if words else [])


def system(label, kind, origin):
    rows = [*np.eye(3), origin]
    return [f"{label:10d}{kind:10d}{8:10d}", "CS", *("".join(f"{v:25.16E}" for v in row) for row in rows)]


def test_nodes_in_the_global_system_by_another_number_pass_and_others_are_refused(tmp_path):
    cells = elements(44, [[1, 2, 3, 4]])
    systems = data_set(2420, "1", "part", *system(1, 0, np.zeros(3)), *system(2, 0, np.ones(3)))
    assert len(read(tmp_path, systems + nodes(SQUARE[:4], system=1) + cells).points) == 4
    with pytest.raises(cf.errors.ModelError, match=r"nodes in local coordinate systems, the"):
        read(tmp_path, systems + nodes(SQUARE[:4], system=2) + cells)


@pytest.mark.parametrize(("text", "told"), [
    ("", r"found 0 nodes and no elements.*mesh-no-cells"),
    (nodes(SQUARE), r"found 5 nodes and no elements"),
    ("solid\n", r"line 1: found 'solid', expected -1 at the begin of a set"),
    (PLATE[:-8], r"line 25: found set 2412 without -1 at its end: cut short\?"),
    ("    -1\n", r"line 1: found the end of the file"),
    (data_set(2411, "1 0 0 11", "0.0 x 0.0"), r"line 4: found '0\.0 x 0\.0', expected 3 numbers"),
    (data_set(2411, "1 0 0"), r"line 4: found the end of set 2411 within a node"),
    (data_set(2411, "1 0 a 11", "0 0 0"), r"line 3: found '1 0 a 11', expected at least 4 whole numbers"),
    (nodes(SQUARE) + elements(44, [[1, 2, 3]]), r"line 16: found element 1 with 3 nodes, expected 4 for descriptor 44"),
    (nodes(SQUARE) + elements(44, [[1, 2, 3, 9]]), r"node 9, although it is used"),
    (nodes(SQUARE) + elements(84, [[1, 2, 3, 4]]), r"element 1 with descriptor 84.*mesh-unsupported-cell"),
    (nodes([*SQUARE, SQUARE[0]], [1, 2, 3, 4, 5, 1]) + elements(44, [[1, 2, 3, 4]]), r"node 1 twice"),
    (PLATE + elements(44, [[1, 2, 3, 4]]), r"element 1 twice"),
    (PLATE + group("g", [77], 8), r"element 77, although it is used"),
    (PLATE + data_set(2467, "1 0 0 0 0 0 0 9"), r"found the end of set 2467 within a group"),
    (PLATE + data_set(2467, "1 0 0 0 0 0 0 9", "g", "7 1 0 0"), r"set 2467 within group 'g'"),
    (PLATE + data_set(164, "5 mm", "0.0 1.0 1.0"), r"found 0 as the factor of lengths, expected a number above 0"),
])  # fmt: skip
def test_damaged_files_are_refused_by_line(text, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=told):
        read(tmp_path, text)


TURN = np.array([[1.1, 0.3, 0.2], [-0.2, 0.9, 0.4], [0.1, -0.3, 1.2]])  # no two edges of a cell are alike
CORNERS = {
    "wedge": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]],
    "pyramid": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.4, 0.4, 1]],
    "triangle": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
}


def half(a, b):
    return 0.5 * (np.asarray(a) + np.asarray(b))


def quadratic(kind):
    """Places of the nodes of a quadratic cell in the order of a universal file: rings, and what is between them."""
    c = (np.array(CORNERS[kind], dtype=float) @ TURN).tolist()
    if kind == "triangle":
        return ring(c, half)
    if kind == "pyramid":
        return [*ring(c[:4], half), *(half(a, c[4]) for a in c[:4]), c[4]]
    low, high = c[:3], c[3:]
    return [*ring(low, half), *(half(a, b) for a, b in zip(low, high, strict=True)), *ring(high, half)]


@pytest.mark.parametrize(("kind", "descriptor"), [("wedge", 113), ("pyramid", 114), ("triangle", 42), ("triangle", 92)])
def test_middles_of_wedges_pyramids_and_triangles_lie_between_their_corners(kind, descriptor, tmp_path):
    places = quadratic(kind)
    mesh = read(tmp_path, nodes(places) + elements(descriptor, [range(1, len(places) + 1)]))
    assert sorted(set(mesh.cells[0].tolist())) == list(range(len(places)))
    corners, edges = mesh.cell_kind.corners, mesh.cell_kind.edges
    at = mesh.points[mesh.cells[0]]
    assert {tuple(np.round(p, 9)) for p in at[: len(corners)]} == {
        tuple(np.round(p, 9)) for p in np.array(CORNERS[kind]) @ TURN
    }
    for place, (a, b) in enumerate(edges, len(corners)):
        np.testing.assert_allclose(at[place], half(at[a], at[b]), atol=1e-12)


def test_lines_of_quadratic_edges_have_their_middle_last(tmp_path):
    corners = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    places = ring(corners, half)
    text = nodes(places) + elements(45, [range(1, 9)]) + elements(24, [[7, 8, 1]], 2) + group("edge", [2], 8)
    mesh = read(tmp_path, text)
    (edge,) = mesh.facet_nodes(mesh.groups["edge"].facets)
    ends, middle = mesh.points[edge[:2]], mesh.points[edge[2]]
    np.testing.assert_allclose(middle, half(*ends), atol=1e-12)
    assert sorted(edge.tolist()) == [0, 6, 7]


@pytest.mark.parametrize("number", [55, 56, 57, 58, 82, 151, 2414, 999, 54])
def test_sets_without_a_part_of_the_mesh_are_passed_over_and_others_named(number, tmp_path):
    mesh = cf.imported.grid_mesh("hexahedron", (1, 1, 1), lambda u: u)
    cell = [int(k) + 1 for k in mesh.cells[0]]
    path = tmp_path / "part.unv"
    path.write_text(nodes(mesh.points) + data_set(number, "anything", "else") + elements(115, [cell]))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert len(cf.read_mesh(path).cells) == 1
    said = " ".join(str(one.message) for one in caught)
    assert (f"set {number}" in said) is (number in (999, 54))


def test_a_node_of_set_15_has_four_whole_numbers_and_a_place(tmp_path):
    path = tmp_path / "part.unv"
    for words in ("1 0 0 11 0.0 0.0", "1 0 0 1.5 0.0 0.0 0.0"):
        path.write_text(data_set(15, words))
        with pytest.raises(cf.errors.ModelError, match=f"found '{words}', expected four whole numbers and x, y, z"):
            cf.read_mesh(path)
