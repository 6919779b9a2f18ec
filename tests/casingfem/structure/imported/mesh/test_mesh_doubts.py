"""Doubts about a mesh one by one, both sides of each bound; groups and units."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.checks import (
    check_groups,
    check_units,
    linear,
    orphans,
    slender,
    thin_and_curved,
)
from tests.casingfem.structure.imported.parts import box, codes, flat, link, moved, squares, tapered


def test_nodes_of_no_cell_are_orphans_unless_something_hangs_there():
    x = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [3, 0]]
    assert [f.message for f in orphans(squares(x, [[0, 1, 2, 3]]))] == ["2 nodes (5, 6) without a cell"]
    hung = squares(x, [[0, 1, 2, 3]], attachments=cf.imported.Attachments(springs=(link(1, 4), link(0, 5))))
    assert orphans(hung) == []


@pytest.mark.parametrize(("mesh", "found"), [
    (box(1, 5, 99), []),
    (box(1, 5, 101), ["1 cell (1), longest to shortest edge up to 101"]),
    (tapered(0.021), []),
    (tapered(0.019), ["1 cell (1) nearly folded"]),
    (squares([[0, 0], [1, 0], [0, 1]], [[0, 1, 2, 2]]), []),
])  # fmt: skip
def test_slender_and_nearly_folded_cells(mesh, found):
    assert [f.message for f in slender(mesh)] == found


def test_a_collapsed_quadratic_cell_is_measured_as_the_triangle_it_is():
    """Of the triangle with a middle at .26 of its side the least area is .04 of the mean one's, at .251 much less."""
    for place, found in ((0.5, []), (0.2505, ["mesh-distorted-cell"])):
        x = [[0, 0], [1, 0], [0, 1], [place, 0], [0.5, 0.5], [0, 0.5]]
        assert codes(slender(squares(x, [[0, 1, 2, 2, 3, 4, 2, 5]], "quad8"))) == found


@pytest.mark.parametrize(
    ("bow", "found"), [(0.074, []), (0.076, ["1 cell (1) thin and curved, bow up to 0.15 of the thickness"])]
)
def test_a_bow_is_measured_by_the_shortest_edge(bow, found):
    """A brick of 2 x 3 x .5: .15 of .5 is .075."""
    brick = box(2, 3, 0.5, kind="hexahedron20")
    assert [f.message for f in thin_and_curved(moved(brick, 8, [0.0, 0.0, bow]))] == found


def test_shells_and_linear_bricks_are_not_asked_for_a_bow():
    assert thin_and_curved(moved(cf.imported.grid_mesh("quad8", (1, 1), flat), 4, [0.0, 0.3, 0.0])) == []
    assert thin_and_curved(box(1, 1, 1)) == []


def test_linear_solids_are_told():
    assert [f.message for f in linear(box(1, 1, 1, counts=(2, 1, 1)))] == ["2 cells of kind hexahedron"]
    assert codes(linear(box(1, 1, 1, kind="tetra"))) == ["mesh-linear-cells"]
    assert linear(box(1, 1, 1, kind="tetra10")) == linear(tapered(0.5)) == []


def test_groups_are_asked_by_name_and_for_a_node_in_use():
    mesh = squares(
        [[0, 0], [1, 0], [1, 1], [0, 1], [5, 5]],
        [[0, 1, 2, 3]],
        groups={"root": cf.imported.Group(nodes=np.array([0, 4])), "far": cf.imported.Group(nodes=np.array([4]))},
    )
    check_groups(mesh, ["root"])
    with pytest.raises(cf.errors.ModelError, match="group 'far' has no node of a cell"):
        check_groups(mesh, ["root", "far"])
    with pytest.raises(
        cf.errors.ModelError, match=r"no group 'rooot' \(did you mean 'root'\?\); its groups: 'root', 'far'"
    ):
        check_groups(mesh, ["rooot"])
    with pytest.raises(cf.errors.ModelError, match="no group 'root'; its groups: none"):
        check_groups(tapered(0.5), ["root"])


@pytest.mark.parametrize(("size", "speed", "codes"), [
    (24.0, 5000.0, []), (26.0, 5000.0, ["mesh-units"]), (26.0, 199.0, ["material-units"]),
    (26.0, 200.0, ["mesh-units"]),
    (26.0, 20_000.0, ["mesh-units"]), (24.0, 20_001.0, ["material-units"]), (24.0, 200.0, []),
])  # fmt: skip
def test_sizes_and_speeds_of_sound_at_their_bounds(size, speed, codes, recwarn):
    """The diagonal of 3-4-5, and E = c^2 rho."""
    check_units(cf.imported.grid_mesh("quad", (1, 1), lambda u: flat(u * [0.6 * size, 0.8 * size])),
                cf.Material(E=speed**2 * 4.0, nu=0.3, rho=4.0))  # fmt: skip
    assert [w.message.code for w in recwarn if isinstance(w.message, cf.errors.ModelWarning)] == codes
