"""What an element of an Ansys archive is, by its name and its nodes."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.readers.cdb import kind_of
from tests.casingfem.structure.imported.archives import elements_block, nodes_block, read, row


def kind(element, nodes):
    found = kind_of(element, np.array(nodes))
    return None if found is None else (found[0], found[1].tolist())


N8, N10, N20 = list(range(1, 9)), list(range(1, 11)), list(range(1, 21))
# SOLID186 as the Element Reference draws them: I J K L M N O P, then Q R S T U V W X Y Z A B
WEDGE = [1, 2, 3, 3, 5, 6, 7, 7, 9, 10, 3, 12, 13, 14, 7, 16, 17, 18, 19, 19]
PYRAMID = [1, 2, 3, 4, 5, 5, 5, 5, 9, 10, 11, 12, 5, 5, 5, 5, 17, 18, 19, 20]
TETRA = [1, 2, 3, 3, 5, 5, 5, 5, 9, 10, 3, 12, 5, 5, 5, 5, 17, 18, 19, 19]


@pytest.mark.parametrize(
    ("element", "nodes", "wanted"),
    [
        ("SOLID185", N8, ("hexahedron", N8)),
        ("45", N8, ("hexahedron", N8)),
        ("SOLSH190", N8, ("hexahedron", N8)),
        ("185", [1, 2, 3, 3, 5, 6, 7, 7], ("hexahedron", [1, 2, 3, 3, 5, 6, 7, 7])),  # a wedge, in the way of bricks
        ("185", [1, 2, 3, 4, 5, 5, 5, 5], ("hexahedron", [1, 2, 3, 4, 5, 5, 5, 5])),
        ("185", [1, 2, 3, 3, 5, 5, 5, 5], ("tetra", [1, 2, 3, 5])),
        ("185", [1, 2, 3, 4], ("tetra", [1, 2, 3, 4])),
        ("185", [1, 2, 3, 4, 5], ("polyhedron", [1, 2, 3, 4, 5])),
        ("186", N20, ("hexahedron20", N20)),
        ("95", N20[:18], ("hexahedron20", [*N20[:18], 0, 0])),
        ("186", N8, ("hexahedron", N8)),
        ("186", N20[:9], ("hexahedron20", [*N20[:9], *[0] * 11])),
        ("186", WEDGE, ("wedge15", [1, 2, 3, 5, 6, 7, 9, 10, 12, 13, 14, 16, 17, 18, 19])),
        ("186", PYRAMID, ("pyramid13", [1, 2, 3, 4, 5, 9, 10, 11, 12, 17, 18, 19, 20])),
        ("186", TETRA, ("tetra10", [1, 2, 3, 5, 9, 10, 12, 17, 18, 19])),
        ("186", [1, 1, 3, 4, 5, 6, 7, 8, *N20[8:]], ("polyhedron", [1, 1, 3, 4, 5, 6, 7, 8, *N20[8:]])),
        ("187", N10, ("tetra10", N10)),
        ("92", N10[:8], ("tetra10", [*N10[:8], 0, 0])),
        ("187", N10[:4], ("tetra", N10[:4])),
        ("285", N10[:4], ("tetra", N10[:4])),
        ("187", N10[:3], ("tetra14", N10[:3])),
        ("SHELL181", [1, 2, 3, 4], ("quad", [1, 2, 3, 4])),
        ("SHELL181", [1, 2, 3, 3], ("triangle", [1, 2, 3])),
        ("63", [1, 2, 3], ("triangle", [1, 2, 3])),
        ("281", N8, ("quad8", N8)),
        ("93", N8[:6], ("quad8", [*N8[:6], 0, 0])),
        ("281", [1, 2, 3, 3, 12, 23, 3, 31], ("triangle6", [3, 1, 2, 31, 12, 23])),
        ("181", [1, 2, 3, 4, 5], ("polygon", [1, 2, 3, 4, 5])),
        ("MESH200", [1, 2, 3], None),
        ("MASS21", [1], None),
        ("SOLID", [1, 2, 3, 4], None),
    ],
)  # fmt: skip
def test_what_an_element_is(element, nodes, wanted):
    assert kind(element, nodes) == wanted


@pytest.mark.parametrize(
    ("element", "nodes", "wanted"),
    [
        (281, [21, 22, 23, 24, 0, 0, 0, 0], "quad"),
        (281, [21, 22, 23, 24, 0, 0, 0, 25], "quad8"),
        (281, [21, 22, 23, 23, 0, 0, 23, 0], "triangle"),
        (281, [21, 22, 23, 23, 25, 0, 23, 0], "triangle6"),
        (187, [21, 22, 23, 25, 0, 0, 0, 0, 0, 0], "tetra10"),
    ],
)
def test_middle_nodes_that_are_zero_are_left_out(element, nodes, wanted, tmp_path):
    (block,) = read(
        tmp_path, ["/PREP7", f"ET,7,{element}", *nodes_block(), *elements_block(row(4, 7, 300, nodes))]
    ).blocks
    assert block.kind == wanted
    if wanted in ("quad8", "tetra10"):
        assert block.cells[0].tolist() == [n - 21 if n else -1 for n in nodes]


@pytest.mark.parametrize("at", range(4))
def test_a_corner_that_is_zero_is_refused(at, tmp_path):
    nodes = [21, 22, 23, 24]
    nodes[at] = 0
    with pytest.raises(cf.errors.ModelError, match=r"a\.cdb: element 300 lacks a corner: .*mesh-file"):
        read(tmp_path, ["/PREP7", "ET,7,285", *nodes_block(), *elements_block(row(4, 7, 300, nodes))])
