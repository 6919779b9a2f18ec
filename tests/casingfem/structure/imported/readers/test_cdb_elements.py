"""What an element of an Ansys archive is, by its name and its nodes."""

import pytest

import casingfem as cf
from tests.casingfem.structure.imported.archives import elements_block, nodes_block, read, row

N8, N10, N20 = list(range(1, 9)), list(range(1, 11)), list(range(1, 21))
# SOLID186 as the Element Reference draws them: I J K L M N O P, then Q R S T U V W X Y Z A B
WEDGE = [1, 2, 3, 3, 5, 6, 7, 7, 9, 10, 3, 12, 13, 14, 7, 16, 17, 18, 19, 19]
PYRAMID = [1, 2, 3, 4, 5, 5, 5, 5, 9, 10, 11, 12, 5, 5, 5, 5, 17, 18, 19, 20]
TETRA = [1, 2, 3, 3, 5, 5, 5, 5, 9, 10, 3, 12, 5, 5, 5, 5, 17, 18, 19, 19]


TWENTY = cf.imported.grid_mesh("hexahedron20", (1, 1, 1), lambda u: u).points + 1.0


def of_one(folder, element, nodes):
    """An archive of one element on twenty nodes."""
    rows = [f"{k:8d}{0:8d}" + "".join(f"{x:10.3f}" for x in row) for k, row in enumerate(TWENTY.tolist(), 1)]
    block = ["NBLOCK,6,SOLID,20,20", "(2i8,6e10.3)", *rows, "N,R5.3,LOC,       -1,"]
    return read(folder, ["/PREP7", f"ET,7,{element}", *block, *elements_block(row(4, 7, 300, nodes))])


@pytest.mark.parametrize(
    ("element", "nodes", "kind", "cell"),
    [
        ("SOLID185", N8, "hexahedron", N8),
        ("45", N8, "hexahedron", N8),
        ("SOLSH190", N8, "hexahedron", N8),
        ("185", [1, 2, 3, 3, 5, 6, 7, 7], "hexahedron", [1, 2, 3, 3, 5, 6, 7, 7]),  # a wedge, in the way of bricks
        ("185", [1, 2, 3, 4, 5, 5, 5, 5], "hexahedron", [1, 2, 3, 4, 5, 5, 5, 5]),
        ("185", [1, 2, 3, 3, 5, 5, 5, 5], "tetra", [1, 2, 3, 5]),
        ("185", [1, 2, 3, 4], "tetra", [1, 2, 3, 4]),
        ("186", N20, "hexahedron20", N20),
        ("95", N20[:18], "hexahedron20", N20[:18]),  # without its last middles
        ("186", N8, "hexahedron", N8),
        ("186", N20[:9], "hexahedron20", N20[:9]),
        ("186", TETRA, "tetra10", [1, 2, 3, 5, 9, 10, 12, 17, 18, 19]),
        ("187", N10, "tetra10", N10),
        ("92", N10[:8], "tetra10", N10[:8]),
        ("187", N10[:4], "tetra", N10[:4]),
        ("285", N10[:4], "tetra", N10[:4]),
        ("SHELL181", [1, 2, 3, 4], "quad", [1, 2, 3, 4]),
        ("SHELL181", [1, 2, 3, 3], "quad", [1, 2, 3, 3]),
        ("63", [1, 2, 3], "quad", [1, 2, 3, 3]),
        ("281", N8, "quad8", N8),
        ("93", N8[:6], "quad8", N8[:6]),
    ],
)
def test_what_an_element_is(element, nodes, kind, cell, tmp_path):
    mesh = of_one(tmp_path, element, nodes)
    assert mesh.kind == kind
    assert (mesh.cells[0, : len(cell)] + 1).tolist() == cell


@pytest.mark.parametrize(
    ("element", "nodes", "kind", "given"),
    [
        ("186", WEDGE, "hexahedron20", [1, 2, 3, 5, 6, 7, 9, 10, 12, 13, 14, 16, 17, 18, 19]),
        ("186", PYRAMID, "hexahedron20", [1, 2, 3, 4, 5, 9, 10, 11, 12, 17, 18, 19, 20]),
        ("281", [1, 2, 3, 3, 12, 13, 3, 11], "quad8", [1, 2, 3, 11, 12, 13]),
    ],
)
def test_collapsed_elements_have_each_of_their_nodes(element, nodes, kind, given, tmp_path):
    mesh = of_one(tmp_path, element, nodes)
    assert mesh.kind == kind
    assert sorted(set((mesh.cells[0] + 1).tolist())) == given


@pytest.mark.parametrize(
    ("element", "nodes", "found"),
    [
        ("185", [1, 2, 3, 4, 5], "1 polyhedron"),
        ("186", [1, 1, 3, 4, 5, 6, 7, 8, *N20[8:]], "1 polyhedron"),
        ("187", N10[:3], "1 tetra14"),
        ("181", [1, 2, 3, 4, 5], "1 polygon"),
    ],
)
def test_elements_of_other_shapes_are_refused(element, nodes, found, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.cdb: found {found}; .*mesh-unsupported-cell"):
        of_one(tmp_path, element, nodes)


@pytest.mark.parametrize("element", ["MESH200", "MASS21", "SOLID"])
def test_elements_of_other_types_are_left_out(element, tmp_path):
    with (
        pytest.warns(cf.errors.ModelWarning, match=f"1 elements? of type {element}"),
        pytest.raises(cf.errors.ModelError, match="mesh-no-cells"),
    ):
        of_one(tmp_path, element, [1, 2, 3])


@pytest.mark.parametrize(
    ("element", "nodes", "wanted"),
    [
        (281, [21, 22, 23, 24, 0, 0, 0, 0], "quad"),
        (281, [21, 22, 23, 24, 0, 0, 0, 25], "quad8"),
        (281, [21, 22, 23, 23, 0, 0, 23, 0], "quad"),
        (281, [21, 22, 23, 23, 25, 0, 23, 0], "quad8 of three"),
        (187, [21, 22, 23, 25, 0, 0, 0, 0, 0, 0], "tetra10"),
    ],
)
def test_middle_nodes_that_are_zero_are_left_out(element, nodes, wanted, tmp_path):
    mesh = read(tmp_path, ["/PREP7", f"ET,7,{element}", *nodes_block(), *elements_block(row(4, 7, 300, nodes))])
    assert mesh.kind == wanted.partition(" ")[0]
    if wanted in ("quad8", "tetra10"):
        given = [(place, n) for place, n in enumerate(nodes) if n]
        assert [mesh.node_numbers[mesh.cells[0, place]] for place, _ in given] == [n for _, n in given]
        assert (mesh.node_numbers == 0).sum() == nodes.count(0)


@pytest.mark.parametrize("at", range(4))
def test_a_corner_that_is_zero_is_refused(at, tmp_path):
    nodes = [21, 22, 23, 24]
    nodes[at] = 0
    with pytest.raises(cf.errors.ModelError, match=r"a\.cdb: found element 300 without one of its corner.*mesh-file"):
        read(tmp_path, ["/PREP7", "ET,7,285", *nodes_block(), *elements_block(row(4, 7, 300, nodes))])
