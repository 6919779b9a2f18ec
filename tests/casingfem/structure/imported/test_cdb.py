"""Ansys archives: bricks, tetrahedra, shells, collapsed bricks, components, materials; what is cut short is refused."""

import re

import numpy as np
import pytest

import casingfem as cf

ELEMENTS = {"hexahedron": 185, "hexahedron20": 186, "tetra10": 187, "tetra": 285, "quad": 181, "quad8": 281}
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)


def place(u):
    return np.insert(u, 2, 0.0, axis=1) if u.shape[1] == 2 else u * [1.0, 0.3, 0.2]


def cdb(points, cells, element, *, materials=None, more=""):
    """An archive as Ansys writes it: fixed columns, nodes and elements in blocks, components by number."""
    count, size = len(points), len(cells)
    materials = materials or [1] * size
    lines = ["/PREP7", f"ET,1,{element}", f"NBLOCK,6,SOLID,{count:9d},{count:9d}", "(3i9,6e21.13e3)"]
    for k, row in enumerate(points, 1):
        reals = (f"{x:20.13E}".replace("E+", "E+0").replace("E-", "E-0") for x in row)
        lines.append(f"{k:9d}{0:9d}{0:9d}" + "".join(reals))
    lines += ["N,R5.3,LOC,       -1,", f"EBLOCK,19,SOLID,{size:9d},{size:9d}", "(19i9)"]
    for k, row in enumerate(cells, 1):
        numbers = [materials[k - 1], 1, 1, 1, 0, 0, 0, 0, len(row), 0, k, *(np.asarray(row) + 1).tolist()]
        lines += ["".join(f"{n:9d}" for n in numbers[j : j + 19]) for j in range(0, len(numbers), 19)]
    lines.append("       -1")
    return "\n".join(lines) + "\n" + more


def component(name, kind, members):
    rows = ["".join(f"{n:10d}" for n in members[k : k + 8]) for k in range(0, len(members), 8)]
    return f"CMBLOCK,{name:8},{kind:4},{len(members):8d}\n(8i10)\n" + "\n".join(rows) + "\n"


def written(path, mesh, **more):
    path.write_text(cdb(mesh.points, mesh.cells, ELEMENTS[mesh.kind], **more))
    return cf.read_mesh(path)


def test_node_blocks_with_whole_numbers_of_two_widths(tmp_path):
    """As Workbench writes them: (1i7,2i9,6e21.13)."""
    mesh = cf.imported.grid_mesh("hexahedron", (2, 1, 1), place)
    text = cdb(mesh.points, mesh.cells, ELEMENTS["hexahedron"])
    head, nodes, rest = re.split(r"(?<=e3\)\n)|(?=N,R5)", text)
    narrow = "".join(line[2:] + "\n" for line in nodes.splitlines())
    path = tmp_path / "workbench.cdb"
    path.write_text(head.replace("(3i9,6e", "(1i7,2i9,6e") + narrow + rest)
    np.testing.assert_allclose(cf.read_mesh(path).points, mesh.points, atol=1e-12)


def test_each_of_several_blocks_counts_its_own(tmp_path):
    mesh = cf.imported.grid_mesh("hexahedron", (3, 1, 1), place)
    head, nodes, elements = re.split(r"(?=NBLOCK)|(?=EBLOCK)", cdb(mesh.points, mesh.cells, ELEMENTS["hexahedron"]))

    def halves(block, count):
        first, form, *rows = block.splitlines()
        rows, end = rows[:count], rows[count]
        for part in (rows[:1], rows[1:]):
            size = f",{len(part):9d}"
            yield "\n".join([first.replace(f",{count:9d}", size), form, *part, end, ""])

    path = tmp_path / "blocks.cdb"
    path.write_text(head + "".join(halves(nodes, len(mesh.points))) + "".join(halves(elements, 3)))
    assert np.array_equal(cf.read_mesh(path).cells, mesh.cells)


@pytest.mark.parametrize("kind", ELEMENTS)
def test_a_mesh_comes_back(kind, tmp_path):
    dims = 2 if kind.startswith("quad") else 3
    mesh = cf.imported.grid_mesh(kind, (3, 2, 1)[:dims], place)
    ends = [int(n) + 1 for n in np.flatnonzero(mesh.points[:, 0] < 1e-9)]
    more = component("ROOT", "NODE", ends) + component("HALF", "ELEM", [1, 2])
    found = written(tmp_path / "part.cdb", mesh, more=more, materials=[1, *[2] * (len(mesh.cells) - 1)])
    assert found.kind == kind
    np.testing.assert_allclose(found.points, mesh.points, atol=1e-12)
    assert np.array_equal(found.cells, mesh.cells)
    assert found.groups["ROOT"].nodes.tolist() == [n - 1 for n in ends]
    assert found.groups["HALF"].cells.tolist() == [0, 1]
    assert found.groups["MAT 1"].cells.tolist() == [0]
    assert len(found.groups["MAT 2"].cells) == len(mesh.cells) - 1


def test_the_part_has_its_modes(tmp_path):
    mesh = cf.imported.grid_mesh("hexahedron20", (4, 1, 1), place, groups={"root": (0, 0.0)})
    root = component("ROOT", "NODE", (mesh.groups["root"].nodes + 1).tolist())
    found = written(tmp_path / "part.cdb", mesh, more=root)
    exact = cf.modes(cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.Clamped()}), 4)
    again = cf.modes(cf.Solid(mesh=found, material=STEEL, supports={"ROOT": cf.Clamped()}), 4)
    np.testing.assert_allclose(again.freq, exact.freq, rtol=1e-9)


def test_bricks_collapsed_to_tetrahedra(tmp_path):
    """SOLID186 with K = L and M = N = O = P, middle nodes repeated alike; SOLID185 without them."""
    mesh = cf.imported.grid_mesh("tetra10", (1, 1, 1), place)
    i, j, k, m, ij, jk, ki, im, jm, km = mesh.cells.T
    brick = np.stack([i, j, k, k, m, m, m, m, ij, jk, k, ki, m, m, m, m, im, jm, km, km], axis=1)
    (tmp_path / "part.cdb").write_text(cdb(mesh.points, brick, 186))
    assert np.array_equal(cf.read_mesh(tmp_path / "part.cdb").cells, mesh.cells)
    (tmp_path / "part.cdb").write_text(cdb(mesh.points, brick[:, :8], 185))
    found = cf.read_mesh(tmp_path / "part.cdb")
    assert (found.kind, found.cells.tolist()) == ("tetra", mesh.cells[:, :4].tolist())


def test_what_is_no_solid_is_counted(tmp_path):
    mesh = cf.imported.grid_mesh("hexahedron", (2, 1, 1), place)
    text = cdb(mesh.points, mesh.cells, 185).replace("ET,1,185", "ET,1,185\nET,2,154")
    text = text.replace("EBLOCK,19,SOLID,        2,        2", "EBLOCK,19,SOLID,        3,        3")
    face = [1, 2, 1, 1, 0, 0, 0, 0, 4, 0, 3, *(mesh.cells[0, :4] + 1).tolist()]
    text = text.replace("\n       -1\n", "\n" + "".join(f"{n:9d}" for n in face) + "\n       -1\n")
    (tmp_path / "part.cdb").write_text(text)
    with pytest.warns(cf.errors.ModelWarning, match="1 elements of type 154"):
        assert len(cf.read_mesh(tmp_path / "part.cdb").cells) == 2


@pytest.mark.filterwarnings("ignore:.*mesh-(orphan-nodes|thin-curved)")
def test_wedges_are_collapsed_bricks_and_quadratic_ones_what_they_are(tmp_path):
    """Of SOLID186 a wedge, and one without some of its middle nodes: half of the block."""
    mesh = cf.imported.grid_mesh("hexahedron27", (1, 1, 1), place)
    wedge = mesh.cells[:, [0, 1, 2, 2, 4, 5, 6, 6, 8, 9, 2, 24, 12, 13, 6, 25, 16, 17, 18, 18]]
    (tmp_path / "part.cdb").write_text(cdb(mesh.points, wedge[:, :8], 185))
    found = cf.read_mesh(tmp_path / "part.cdb")
    assert (found.kind, found.cells.tolist(), found.collapsed.tolist()) == ("hexahedron", wedge[:, :8].tolist(), [True])
    fewer = np.where(np.isin(np.arange(20), (9, 13, 16)), -1, wedge)  # written as 0
    for cells, tied in ((wedge, 0), (fewer, 3)):
        (tmp_path / "part.cdb").write_text(cdb(mesh.points, cells, 186))
        found = cf.read_mesh(tmp_path / "part.cdb")
        assert (found.kind, found.collapsed.tolist()) == ("hexahedron20", [True])
        assert sum(len(tie.nodes) for tie in found.attachments.glued) == tied
        solid = cf.Solid(mesh=found, material=cf.Material(E=210e9, nu=0.3, rho=7800.0))
        block = cf.Solid(mesh=mesh, material=solid.material).assembled()
        assert solid.assembled().M.sum() == pytest.approx(0.5 * block.M.sum(), rel=1e-3)


def test_triangles_are_collapsed_squares(tmp_path):
    mesh = cf.imported.grid_mesh("quad", (1, 1), place)
    (tmp_path / "part.cdb").write_text(cdb(mesh.points, mesh.cells[:, [0, 1, 2, 2]], 181))
    assert cf.read_mesh(tmp_path / "part.cdb").collapsed.tolist() == [True]


def test_a_shell_keeps_its_middle_nodes_where_one_of_them_is_left_out(tmp_path):
    mesh = cf.imported.grid_mesh("quad8", (2, 1), place)
    fewer = mesh.cells.copy()
    fewer[0, 4] = -1  # written as 0
    (tmp_path / "part.cdb").write_text(cdb(mesh.points, fewer, 281))
    found = cf.read_mesh(tmp_path / "part.cdb")
    assert found.kind == "quad8"
    assert np.array_equal(found.cells[fewer >= 0], fewer[fewer >= 0])
    middle = mesh.points[fewer[0, :2]].mean(axis=0)
    np.testing.assert_allclose(found.points[found.cells[0, 4]], middle, rtol=0.0, atol=1e-12)


def test_archives_cut_short_are_refused(tmp_path):
    mesh = cf.imported.grid_mesh("hexahedron20", (3, 1, 1), place)
    text = cdb(mesh.points, mesh.cells, 186)
    for keep in (0.2, 0.5, 0.8, 0.95):
        (tmp_path / "part.cdb").write_text("\n".join(text.splitlines()[: int(keep * text.count("\n"))]) + "\n")
        with pytest.raises(cf.errors.ModelError):
            cf.read_mesh(tmp_path / "part.cdb")
    (tmp_path / "part.cdb").write_text("/PREP7\n")
    with pytest.raises(cf.errors.ModelError):
        cf.read_mesh(tmp_path / "part.cdb")
    with pytest.raises(FileNotFoundError):
        cf.read_mesh(tmp_path / "none.cdb")


NUMBERS = "        8        0        1"  # how many nodes an element has, 0, its own number
BAD = {
    "number": (lambda text: text.replace("        1        0        0", "        x        0        0", 1),
               "line 5: found 'x', expected a whole number"),
    "coordinate": (lambda text: text.replace("E+000", "E+0x0", 1), "line 5: found .* expected coordinates"),
    "columns": (lambda text: text.replace("(19i9)", "(19)"), "expected the columns of a block"),
    "type": (lambda text: text.replace("ET,1,185", "ET,2,185"), "element 1 of type 1, expected a command ET for"),
    "one by one": (lambda text: text + "EN,9,1,2,3,4\n", "found the command EN for a single node or element"),
    "not solid": (lambda text: text.replace("EBLOCK,19,SOLID", "EBLOCK,15,"), "an EBLOCK that is not SOLID"),
    "fewer": (lambda text: text.replace("SOLID,        1,        1", "SOLID,        1,        2"),
              "found 1 items, expected 2: cut short"),
    "more": (lambda text: text.replace("SOLID,        8,        8", "SOLID,        8,        7"),
             "found 8 items, expected 7; export"),
    "no nodes": (lambda text: re.sub("        8(        0        1).*", r"        0\1", text),
                 "line 16: found 11 numbers, expected 11 and then the nodes of an element"),
    "kind": (lambda text: text + component("A", "LINE", [1, 2]), "expected CMBLOCK, name, NODE or ELEM"),
    "layout": (lambda text: text.replace("(3i9,6e21.13e3)", "(3i9)"),
               r"line 4: found '\(3i9\)', expected columns of whole and real numbers, such as"),
    "narrow": (lambda text: text.replace("6e21.13e3", "6e20.13e3"),
               "line 5: found a line of 90 characters, expected columns of 9 and 20"),
    "cut line": (lambda text: text.replace("E+000\n", "E+00\n", 1),
                 "line 5: found a line of 89 characters, expected columns of 9 and 21"),
    "long line": (lambda text: text.replace("E+000\n", "E+0000\n", 1),
                  "line 5: found a line of 91 characters, expected columns of 9 and 21"),
    "more nodes": (lambda text: text.replace(NUMBERS, "        7        0        1"),
                   "line 16: found element 1 with 8 nodes, expected"),
    "fewer nodes": (lambda text: text.replace(NUMBERS, "       10        0        1"),
                    r"line 16: found element 1 with 8 nodes, expected 10: cut short\?"),
    "one node fewer": (lambda text: text.replace(NUMBERS, "        9        0        1"),
                       r"line 16: found element 1 with 8 nodes, expected 9: cut short\?"),
    "corner": (lambda text: text.replace("        4\n       -1", "        0\n       -1"), "element 1 without one"),
    "first corner": (lambda text: text.replace(f"{NUMBERS}        1", f"{NUMBERS}       -1"),
                     "element 1 without one"),
    "component": (lambda text: text + component("A", "NODE", [1, 2]).replace("       2\n(8", "       5\n(8"),
                  "found 2 numbers"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_damage_is_named_with_its_line(name, tmp_path):
    change, message = BAD[name]
    mesh = cf.imported.grid_mesh("hexahedron", (1, 1, 1), place)
    text = cdb(mesh.points, mesh.cells, 185)
    assert change(text) != text
    (tmp_path / "part.cdb").write_text(change(text))
    with pytest.raises(cf.errors.ModelError, match=message):
        cf.read_mesh(tmp_path / "part.cdb")


def test_coordinates_that_are_left_out_at_the_end_of_a_line_are_zero(tmp_path):
    mesh = cf.imported.grid_mesh("hexahedron", (1, 1, 1), place)
    lines = cdb(mesh.points, mesh.cells, 185).splitlines(keepends=True)
    lines[8] = lines[8][: 3 * 9 + 21] + "\n"  # x of the fifth node
    lines[4] = lines[4][:9] + "\n"  # the number alone
    (tmp_path / "part.cdb").write_text("".join(lines))
    np.testing.assert_array_equal(
        cf.read_mesh(tmp_path / "part.cdb").points[[0, 4]], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    )


def test_an_archive_of_what_is_no_solid_or_shell_alone_is_refused(tmp_path):
    mesh = cf.imported.grid_mesh("hexahedron", (1, 1, 1), place)
    (tmp_path / "part.cdb").write_text(cdb(mesh.points, mesh.cells, 154))
    with (
        pytest.warns(cf.errors.ModelWarning, match="part.cdb: 1 elements of type 154; .*mesh-left-out"),
        pytest.raises(
            cf.errors.ModelError, match=r"part.cdb: found 8 nodes and no solid or shell elements.*mesh-no-cells"
        ),
    ):
        cf.read_mesh(tmp_path / "part.cdb")


def test_ranges_of_components(tmp_path):
    mesh = cf.imported.grid_mesh("hexahedron", (2, 1, 1), place)
    found = written(tmp_path / "part.cdb", mesh, more=component("A", "NODE", [1, -4, 6]))
    assert found.groups["A"].nodes.tolist() == [0, 1, 2, 3, 5]
