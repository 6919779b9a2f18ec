"""Meshes from files: five formats of the same part, hand-written files, and what readers drop or mistake."""

import struct
import warnings

import meshio
import numpy as np
import pytest

import casingfem as cf
from reports.verification.modes.mesh_files import BRICK20, GMSH_ORDER, WRITERS, group_name

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-thin-curved")  # coarse rings, only compared with each other

WALL = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.03)
ENDS = {"base": (2, 0.0), "top": (2, 1.0)}


def part(kind):
    if kind.startswith(("quad", "triangle")):
        ends = {"base": (1, 0.0), "top": (1, 1.0)}
        return cf.imported.grid_mesh(kind, (8, 2), lambda u: WALL(np.insert(u, 0, 0.5, axis=1)), groups=ends, wrap=0)
    return cf.imported.grid_mesh(kind, (1, 8, 2), WALL, groups=ENDS, wrap=1)


@pytest.mark.slow
def test_five_formats_give_the_same_frequencies(tmp_path, steel):
    mesh = part("hexahedron20")
    exact = cf.modes(cf.Solid(mesh=mesh, material=steel, supports={"base": cf.Clamped()}), 6).freq
    for name, (file, write) in WRITERS.items():
        write(mesh, tmp_path / file)
        group = group_name(name, "base", ["base", "top"])
        back = cf.Solid(mesh=cf.read_mesh(tmp_path / file), material=steel, supports={group: cf.Clamped()})
        np.testing.assert_allclose(cf.modes(back, 6).freq, exact, rtol=1e-11)


def test_orders_of_gmsh_and_nastran_as_their_manuals_draw_them():
    """Gmsh: edges 0-1 0-3 0-4 1-2 1-5 2-3 2-6 3-7 4-5 4-7 5-6 6-7; Nastran: lower ring, uprights, upper ring."""
    cube = cf.imported.grid_mesh("hexahedron27", (1, 1, 1), lambda u: u)
    places = cube.points[cube.cells[0]]
    gmsh = [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)]
    middles = [places[list(pair)].mean(axis=0) for pair in gmsh]
    np.testing.assert_allclose(places[list(GMSH_ORDER["hexahedron20"])][8:20], middles)
    faces = [(0, 1, 2, 3), (0, 1, 5, 4), (0, 3, 7, 4), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 6, 7), range(8)]
    inner = [places[list(face)].mean(axis=0) for face in faces]
    np.testing.assert_allclose(places[list(GMSH_ORDER["hexahedron27"])][20:], inner)
    nastran = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5), (2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4)]
    middles = [places[list(pair)].mean(axis=0) for pair in nastran]
    np.testing.assert_allclose(places[list(BRICK20)][8:], middles)


def write(path, text):
    path.write_text(text)
    return path


INP = """*Heading
** one tetrahedron in two node blocks, sets nested and generated
*Part, name=P
*Node, nset=First
 10, 0., 0., 0.
 20, 2., 0., 0.
*NODE
 30, 0., 2., 0.
 40, 0., 0., 2.
*Element, type=C3D4, elset=Body
 7, 10, 20, 30, 40
*Nset, nset=Some, generate
 10, 30, 10
*Nset, nset=All
 Some, 40
*Elset, elset=Everything
 body
*Surface, name=Floor, type=ELEMENT
 Everything, S1
*Material, name=steel
*Elastic
 210e9, .3
*End Part
"""


SIDES = """*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 2., 0., 0.
6, 2., 1., 0.
*ELEMENT, TYPE={kind}, ELSET=ALL
1, 1, 2, 3, 4
2, 2, 5, 6, 3
*SURFACE, NAME=UP
ALL, {side}
*SURFACE, NAME=END
2, {edge}
"""


@pytest.mark.parametrize(("kind", "side", "edge"), [("S4R", "SPOS", "E2"), ("S4", "S2", "S4"), ("CPS4", "SNEG", "S2")])
def test_sides_and_edges_of_shells_are_groups_by_their_abaqus_and_calculix_names(kind, side, edge, tmp_path):
    mesh = cf.read_mesh(write(tmp_path / "a.inp", SIDES.format(kind=kind, side=side, edge=edge)))
    assert mesh.groups["UP"].cells.tolist() == [0, 1]
    assert mesh.groups["UP"].facets is None
    (facet,) = mesh.groups["END"].facets
    assert set(mesh.facets[tuple(facet)].tolist()) == {4, 5}
    with pytest.raises(cf.errors.ModelError, match="a surface on face 'E5' of quad elements"):
        cf.read_mesh(write(tmp_path / "a.inp", SIDES.format(kind=kind, side=side, edge="E5")))


def test_inp_keeps_numbers_blocks_nested_sets_and_surfaces(tmp_path):
    mesh = cf.read_mesh(write(tmp_path / "a.inp", INP), scale=1e-3)
    assert mesh.node_numbers.tolist() == [10, 20, 30, 40]
    assert mesh.cell_numbers.tolist() == [7]
    np.testing.assert_allclose(mesh.points.max(axis=0), 2e-3)
    members = {name: group.nodes.tolist() for name, group in mesh.groups.items()}
    assert members == {
        "Body": [0, 1, 2, 3], "Everything": [0, 1, 2, 3], "Floor": [0, 1, 2], "First": [0, 1], "Some": [0, 1, 2],
        "All": [0, 1, 2, 3],
    }  # fmt: skip
    assert mesh.groups["Everything"].cells.tolist() == [0]
    assert mesh.groups["Floor"].facets.tolist() == [[0, 0]]


BDF = """SOL 103
SPC = 3
BEGIN BULK
$ one tetrahedron: small, large and free fields, short exponents
GRID    1               0.      0.      0.
GRID*   2                               20.-1           0.
*       0.
GRID,3,,0.,2.0D0,0.
GRID,4,0,0.,
,2.+0
CTETRA  7       5       1       2       3       4
SPC1    3       123     1       THRU    3
SPC     4       4       3       0.
MAT1,1,2.1+11,,.3,7800.
ENDDATA
GRID    99      0       9.      9.      9.
"""


def test_bdf_reads_all_three_field_widths(tmp_path):
    text = BDF.replace("GRID,4,0,0.,\n,2.+0\n", "GRID,4,0,0.,0.,2.+0\n")
    mesh = cf.read_mesh(write(tmp_path / "a.bdf", text))
    np.testing.assert_allclose(mesh.points, [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]])
    assert mesh.cell_numbers.tolist() == [7]
    assert mesh.groups["PID 5"].cells.tolist() == [0]
    assert mesh.groups["SPC 3 123"].nodes.tolist() == [0, 1, 2]
    assert mesh.groups["SPC 4"].nodes.tolist() == [3]


GMSH_TWICE = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
3 1 "body"
3 2 "hot part"
2 5 "floor"
$EndPhysicalNames
$Nodes
4
3 0 0 0
9 1 0 0
4 0 1 0
6 0 0 1
$EndNodes
$Elements
4
1 4 2 1 1 3 9 4 6
2 4 2 2 1 3 9 4 6
3 2 2 5 1 3 4 9
4 2 2 8 1 3 9 6
$EndElements
"""


def test_gmsh_cells_in_two_groups_are_one_cell_and_numbers_without_names_are_groups(tmp_path):
    mesh = cf.read_mesh(write(tmp_path / "a.msh", GMSH_TWICE))
    assert mesh.cells.tolist() == [[0, 1, 2, 3]]
    assert {name: group.cells.tolist() for name, group in mesh.groups.items()} == {
        "body": [0], "hot part": [0], "floor": [], "surface 8": [],
    }  # fmt: skip
    assert mesh.groups["floor"].nodes.tolist() == [0, 1, 2]
    assert mesh.group_facets("surface 8").tolist() == [[0, 1]]


def test_join_closes_a_seam(steel, tmp_path):
    slit = cf.imported.grid_mesh("hexahedron20", (1, 8, 2), WALL, groups=ENDS)
    with pytest.raises(cf.errors.ModelError, match="mesh-open-seam"):
        cf.Solid(mesh=slit, material=steel)
    WRITERS["VTU"][1](slit, tmp_path / "slit.vtu")
    closed = cf.read_mesh(tmp_path / "slit.vtu", join=1e-6)
    whole = cf.modes(cf.Solid(mesh=closed, material=steel, supports={"base": cf.Clamped()}), 6).freq
    wrapped = cf.Solid(mesh=part("hexahedron20"), material=steel, supports={"base": cf.Clamped()})
    np.testing.assert_allclose(whole, cf.modes(wrapped, 6).freq, rtol=1e-9)


ELEMENTS = GMSH_TWICE.partition("$Elements")[0] + "$Elements\n{}\n$EndElements\n"
BROKEN = {
    "a.txt": ("", "mesh-format"),
    "empty.msh": ("", "cut short"),
    "cut.msh": (GMSH_TWICE[:-20], "cut short"),
    "fewer.msh": (GMSH_TWICE.replace("6 0 0 1\n$End", "$End"), "mesh-file"),
    "node.msh": (
        GMSH_TWICE.replace("3 9 4 6\n2", "3 9 4 7\n2"),
        "with a node that the file does not define|not define",
    ),
    "kind.msh": (GMSH_TWICE.replace("1 4 2 1 1 3 9 4 6", "1 444 2 1 1 3 9 4 6"), "mesh-file"),
    "version.msh": (GMSH_TWICE.replace("2.2 0 8", "9.9 0 8"), "mesh-file"),
    "type.inp": (INP.replace("C3D4", "XYZ9"), r"line 10: found \*ELEMENT of type 'XYZ9'"),
    "twice.inp": (INP.replace(" 40, 0.", " 30, 0."), "node 30 twice"),
    "missing.inp": (INP.replace("20, 30, 40\n", "20, 30, 41\n"), "node 41, although it is used"),
    "short.inp": (INP.replace("20, 30, 40\n", "20, 30\n"), "found 4 numbers, expected a multiple of 5"),
    "word.inp": (INP.replace("2., 0., 0.", "2., 0., x"), "line 6: found '20, 2., 0., x'"),
    "plane.inp": (INP.replace("2., 0., 0.", "2., 0."), "expected a node number and x, y, z"),
    "include.inp": (INP + "*INCLUDE, INPUT=b.inp\n", "line 24: found no file b.inp; .*mesh-include"),
    "itself.inp": (INP + "*include, input=itself.inp\n", "itself.inp, which includes itself"),
    "include.bdf": ("INCLUDE 'b.bdf'\n" + BDF, "line 1: found no file b.bdf"),
    "set.inp": (INP.replace(" Some, 40", " Sum, 40"), "no set 'Sum' above this line"),
    "face.inp": (INP.replace("S1\n", "S5\n"), "face 'S5' of tetra"),
    "parts.inp": (INP + "*Part, name=Q\n", "several parts"),
    "moved.inp": (INP + "*Instance, name=I, part=Q\n 1., 0., 0.\n", r"\*INSTANCE: found no part 'Q'"),
    "system.bdf": (BDF.replace("GRID    1       ", "GRID    1       7"), "coordinate system 7"),
    "number.bdf": (BDF.replace("CTETRA  7", "CTETRA  x"), "found 'x', expected a whole number"),
    "real.bdf": (BDF.replace("20.-1", "20.-x"), "expected a real number"),
    "middle.bdf": (BDF.replace("3       4\n", "3\n"), "found element 7 with 3 nodes, expected 4 corners, then middle"),
    "nothing.bdf": ("BEGIN BULK\nENDDATA\n", "mesh-no-cells"),
    "joined.inp": (
        INP.replace("30, 40\n", "30, 40, 8, 10, 20, 30, 40\n"),
        "line 11: found an element of 10 numbers, expected 5",
    ),
    "digits.inp": (INP.replace(" 7, 10", f" 7, {10**20}"), "line 11: found .*, expected numbers below"),
    "node.inp": (INP.replace(" 10, 0., 0.", " 1.5, 0., 0."), "line 5: found the node 1.5, expected a whole number"),
    "range.inp": (INP.replace("10, 30, 10", "10, 1000000000000"), "999999999991 numbers, more than the file can"),
    "step.inp": (INP.replace("10, 30, 10", "10, 30, 0"), "expected first, last, step"),
    "last.inp": (INP[: INP.index("*Surface") - 2], "found no line break after the last line, 'bod': cut short?"),
    "no element.inp": (INP[: INP.index(" 7, 10")], "found 4 nodes and no elements"),
    "no node.inp": ("*NODE\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n", "found 0 nodes and no elements"),
    "name.inp": (
        INP.replace("elset=Body", "elset=Bo\u202edy").replace(" body\n", " 7\n"),
        "group .Bo",
    ),
    "half.bdf": (BDF.replace("*       0.\n", ""), "line 6: GRID: found grid 2 without z, expected it on a second line"),
    "set.bdf": (
        BDF.replace("SPC1    3       123     1       THRU    3", "SPC1    3"),
        "SPC1: found the fields 3",
    ),
    "element.bdf": (
        BDF.replace("CTETRA  7       5       1       2       3       4", "CTETRA"),
        "found 0 fields",
    ),
    "digits.bdf": (BDF.replace("GRID,3,", f"GRID,{10**20},"), "expected a number of at most eight digits"),
    "nan.bdf": (BDF.replace("2.0D0", "nan"), "found 'nan', expected a real number"),
    "last.bdf": (BDF[: BDF.index("MAT1") - 1], "found no line break after the last line, .*: cut short?"),
    "lines.msh": (ELEMENTS.format("2\n1 1 2 1 1 3 9\n2 1 2 1 1 9 4"), "lines.msh: found 2 line; .*mesh-no-cells"),
    "nothing.msh": (ELEMENTS.format(0), "nothing.msh: found no cells; .*mesh-no-cells"),
    "number.msh": (GMSH_TWICE.replace("\n4 0 ", "\n1600000000 0 "), "the number 1600000000 in a file of .* bytes"),
    "name.msh": (
        GMSH_TWICE.replace('"', '"' + 1000 * "many words ", 1),
        r"\$PhysicalNames: found a line that is too long, expected at most 10000",
    ),
    "mark.msh": (GMSH_TWICE.replace('"', '"\u202e', 1), "found the group '.u202e"),
    "pieces.vtu": ("<VTKFile></VTKFile>", "0 pieces, expected one"),
    "two.vtu": ("<VTKFile><Piece></Piece><Piece></Piece></VTKFile>", "2 pieces, expected one"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files_are_refused_with_the_place(name, tmp_path):
    text, message = BROKEN[name]
    with pytest.raises(cf.errors.ModelError, match=message) as caught:
        cf.read_mesh(write(tmp_path / name, text))
    assert name in str(caught.value)


@pytest.mark.slow
def test_a_binary_file_that_states_it_fills_the_memory_is_not_read(tmp_path):
    head = b"$MeshFormat\n2.2 1 8\n" + struct.pack("<i", 1) + b"\n$EndMeshFormat\n"
    nodes = b"$Nodes\n%d\n" % 10**9 + struct.pack("<iddd", 1, 0.0, 0.0, 0.0) + b"\n$EndNodes\n"
    (tmp_path / "a.msh").write_bytes(head + nodes + b"$Elements\n0\n$EndElements\n")
    with pytest.raises(
        cf.errors.ModelError, match=r"a\.msh: cannot be read \(its reader took more than .*GB, or crashed.*mesh-file"
    ):
        cf.read_mesh(tmp_path / "a.msh")


@pytest.mark.parametrize(
    "faces",
    [
        ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)),
        ((0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (0, 2, 5, 3)),  # of two sizes
    ],
)
def test_polyhedra_are_refused_by_their_name(faces, tmp_path):
    kind = f"polyhedron{max(map(max, faces)) + 1}"
    meshio.Mesh(np.eye(6, 3), [(kind, [[np.array(face) for face in faces]])]).write(tmp_path / "a.vtu")
    with pytest.raises(cf.errors.ModelError, match=rf"a.vtu: found {kind}; .*mesh-unsupported-cell"):
        cf.read_mesh(tmp_path / "a.vtu")


def test_what_meshio_drops_without_a_word_is_counted(tmp_path):
    """A VTU with a cell of unknown kind: meshio leaves the cell out."""
    mesh = part("hexahedron20")
    WRITERS["VTU"][1](mesh, tmp_path / "a.vtu")
    text = (tmp_path / "a.vtu").read_text().replace('"types" format="ascii">\n25', '"types" format="ascii">\n99')
    with pytest.raises(cf.errors.ModelError, match="15 cells that can be read"):
        cf.read_mesh(write(tmp_path / "a.vtu", text))


def test_defaults_of_grids_are_those_of_grdset(tmp_path):
    """CP, PS where a GRID leaves them blank, wherever the card stands; 0 is not blank."""
    path = tmp_path / "told.bdf"
    turned = "CORD2R,7,0,0.,0.,0.,1.,0.,0.\n,0.,1.,0.\n"  # z along x, x along y
    bare = BDF.replace("SPC1    3       123     1       THRU    3\n", turned)
    path.write_text(bare.replace("ENDDATA", "GRDSET,,7,,,,,345\nENDDATA"))
    found = cf.read_mesh(path)
    assert np.allclose(found.points, [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0], [0.0, 0.0, 0.0]])
    assert found.groups["SPC PS 345"].nodes.tolist() == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("ending", "whole", "line"),
    [("inp", INP, "*Include, Input={}\n"), ("bdf", BDF, "INCLUDE '{}'\n"), ("nas", BDF, "include {}\n")],
)
def test_included_files_are_where_they_are_named(ending, whole, line, tmp_path):
    """In a folder of its own, and from there back beside the first file."""
    lines = whole.splitlines(keepends=True)
    (tmp_path / "parts").mkdir()
    path, inner, last = tmp_path / f"a.{ending}", tmp_path / "parts" / "b.txt", tmp_path / "c.txt"
    path.write_text("".join(lines[:4]) + line.format(r"parts\b.txt") + "".join(lines[12:]))
    inner.write_text("".join(lines[4:8]) + line.format("c.txt"))
    last.write_text("".join(lines[8:12]))
    plain = tmp_path / f"whole.{ending}"
    plain.write_text(whole)
    found, expected = cf.read_mesh(path), cf.read_mesh(plain)
    assert np.array_equal(found.points, expected.points)
    assert np.array_equal(found.cells, expected.cells)
    assert list(found.groups) == list(expected.groups)
    last.write_text("".join(lines[8:12]).replace("10, 20", "x, 20").replace("CTETRA  7", "CTETRA  x"))
    with pytest.raises(cf.errors.ModelError, match=r"line \d of c.txt: .*found '.*x"):
        cf.read_mesh(path)


@pytest.mark.slow
def test_truncated_binary_is_refused(tmp_path):
    WRITERS["Gmsh 4.1, binary"][1](part("tetra10"), tmp_path / "a.msh")
    content = (tmp_path / "a.msh").read_bytes()
    place = content.index(b"$Elements\n") + 40
    (tmp_path / "a.msh").write_bytes(content[:place] + content[place + 400 :])
    with pytest.raises(cf.errors.ModelError, match="mesh-file"):
        cf.read_mesh(tmp_path / "a.msh")


def test_middles_of_shells_that_are_left_out_are_put_in_free(tmp_path):
    """Without any they are cells of four; else the others are in the middle of their edges, and nothing ties them."""
    grids = "".join(f"GRID,{k},,{x},{y},0.\n" for k, (x, y) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0)), 1))
    text = "BEGIN BULK\n" + grids.replace("1,0.\n", "1.,0.\n") + "CQUAD8,9,1,1,2,3,4{}\nENDDATA\n"
    assert cf.read_mesh(write(tmp_path / "a.bdf", text.format(""))).kind == "quad"
    found = cf.read_mesh(write(tmp_path / "a.bdf", text.format(",5")))
    assert (found.kind, len(found.points), bool(found.attachments)) == ("quad8", 8, False)
    np.testing.assert_array_equal(found.points[found.cells[0, 4:], :2], [[0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5]])


def test_mixed_cells_and_loose_facets_are_named(tmp_path):
    skins = SIDES.format(kind="S4", side="SPOS", edge="E1") + "*ELEMENT, TYPE=S9\n9, 1, 2, 3, 4, 5, 6, 1, 2, 3\n"
    with pytest.raises(cf.errors.ModelError, match=r"2 quad, 1 quad9; .*mesh-mixed-cells"):
        cf.read_mesh(write(tmp_path / "a.inp", skins))
    loose = "*NODE\n50, 5., 5., 5.\n*ELEMENT, TYPE=CPS3, ELSET=Skin\n9, 10, 20, 50\n"
    with pytest.warns(cf.errors.ModelWarning, match="'Skin' with 1 of 1 facets that belong to no cell"):
        cf.read_mesh(write(tmp_path / "b.inp", INP + loose))


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("a.inp", INP + "*TIE, NAME=t, CYCLIC SYMMETRY\n a, b\n", r"\*TIE of cyclic symmetry \(line 24\)"),
        ("a.bdf", "RBE1,9,1,123,2", r"1 RBE1 \(from line \d+\)"),
        (
            "b.bdf",
            "CGAP,9,3,1,2\nMPCADD,3,1,2\nCGAP,10,3,1,2\nCGAP,11,3,1,2",
            r"3 CGAP \(from line \d+\), 1 MPCADD \(from line \d+\)",
        ),
    ],
)
def test_constraints_that_are_not_taken_over_are_doubted(name, text, told, tmp_path):
    if name.endswith("bdf"):
        text = BDF.replace("GRID,4,0,0.,\n,2.+0\n", "GRID,4,,0.,0.,2.\n").replace("MAT1", text + "\nMAT1")
    with pytest.warns(cf.errors.ModelWarning, match=f"{name}: {told}; .*mesh-left-out"):
        cf.read_mesh(write(tmp_path / name, text))


FLAT = "BEGIN BULK\n" + "".join(f"GRID,{k + 1},,{k % 3}.,{k // 3}.,0.\n" for k in range(9))
# as the Quick Reference Guide has them: T1 to T4 of CQUAD8 are before the angle and the offset
SHELL_CARDS = {
    "CQUAD4": ("1,3,9,7", ""), "CQUADR": ("1,3,9,7", ""), "CTRIA3": ("1,3,9", ""), "CTRIAR": ("1,3,9", ""),
    "CTRIA6": ("1,3,9,2,6,5", ""), "CQUAD8": ("1,3,9,7,2,6,8,4", ",,,,"),
}  # fmt: skip


def in_lines(card):
    """A card of free fields, eight of them a line behind its name."""
    fields = card.split(",")
    return ",".join(fields[:9]) + "".join("\n," + ",".join(fields[k : k + 8]) for k in range(9, len(fields), 8)) + "\n"


@pytest.mark.filterwarnings("ignore:.*mesh-orphan-nodes")
@pytest.mark.parametrize("name", SHELL_CARDS)
def test_an_offset_of_a_shell_is_reported_as_left_out_and_an_angle_is_none(name, tmp_path):
    nodes, between = SHELL_CARDS[name]
    card = f"{name},1,1,{nodes}{between},30."
    with pytest.warns(cf.errors.ModelWarning, match=rf"1 offset \(ZOFFS\) of {name} \(from line 11\).*mesh-left-out"):
        cf.read_mesh(write(tmp_path / "a.bdf", FLAT + in_lines(card + ",.01")))
    with warnings.catch_warnings():
        warnings.filterwarnings("error", message=".*mesh-left-out")
        assert len(cf.read_mesh(write(tmp_path / "b.bdf", FLAT + in_lines(card))).cells) == 1


@pytest.mark.parametrize("setting", [{"scale": 0.0}, {"scale": np.nan}, {"join": -1.0}])
def test_scale_and_join_must_be_usable(setting, tmp_path):
    with pytest.raises(cf.errors.ModelError, match="mesh-scale"):
        cf.read_mesh(write(tmp_path / "a.inp", INP), **setting)


def test_negative_physical_numbers_are_not_lost(tmp_path):
    """Gmsh 2.2 marks a reversed surface by a negative number."""
    mesh = cf.read_mesh(write(tmp_path / "a.msh", GMSH_TWICE.replace("3 2 2 5 1", "3 2 2 -5 1")))
    assert mesh.groups["floor"].nodes.tolist() == [0, 1, 2]


def test_gmsh_41_bits_are_as_the_manual_has_them(tmp_path):
    WRITERS["Gmsh 4.1, binary"][1](part("tetra"), tmp_path / "a.msh")
    content = (tmp_path / "a.msh").read_bytes()
    start = content.index(b"$Nodes\n") + 7
    assert struct.unpack("<4Q", content[start : start + 32]) == (1, 48, 1, 48)
