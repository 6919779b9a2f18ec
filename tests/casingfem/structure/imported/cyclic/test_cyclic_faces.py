"""Faces of a sector: turns, pairs of nodes on both sides of what is allowed, and what is refused by name."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.cyclic.faces import Pairs, Turn, found_pairs, named, paired_faces, require_facets
from tests.casingfem.structure.imported.parts import flat, squares

QUARTER = Turn((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), np.pi / 2.0)
SIXTH = Turn((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), np.pi / 3.0)


def annulus(angle=np.pi / 2.0, shift=(0.0, 0.0, 0.0), **given):
    """Squares from r = 1 to 2, two across and three around; nodes 4 k + j at angle j, their shortest edge r dtheta."""

    def place(u):
        r, theta = 1.0 + u[:, 0], angle * u[:, 1]
        return flat(np.stack([r * np.cos(theta), r * np.sin(theta)], axis=1)) + shift

    return cf.imported.grid_mesh("quad", (2, 3), place, groups={"low": (1, 0.0), "high": (1, 1.0)}, **given)


def shifted(mesh, node, by):
    points = mesh.points.copy()
    points[node] += by
    return cf.imported.MeshData(kind=mesh.kind, points=points, cells=mesh.cells, groups=mesh.groups, source="disk.inp")


def edge():
    """The shortest: the chord of thirty degrees at r = 1."""
    return 2.0 * np.sin(np.pi / 12.0)


def test_a_turn_about_a_slanted_axis_through_a_point():
    """About (1, 1, 1) by a third: x to y to z to x; the point stays."""
    turn = Turn((2.0, 2.0, 2.0), (1.0, 0.0, -1.0), 2.0 * np.pi / 3.0)
    np.testing.assert_allclose(turn.matrix, [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-15)
    points = np.array([[1.0, 0.0, -1.0], [3.0, 5.0, 7.0]])
    np.testing.assert_allclose(turn.places(points), [[1, 0, -1], [9, 2, 4]], atol=1e-13)
    np.testing.assert_allclose(turn.places(points, 2), [[1, 0, -1], [6, 8, 1]], atol=1e-13)
    np.testing.assert_allclose(turn.places(points, 3), points, atol=1e-13)
    assert str(QUARTER) == "turned by 90 degrees about (0, 0, 1) through (0, 0, 0)"
    assert str(turn) == "turned by 120 degrees about (2, 2, 2) through (1, 0, -1)"


def test_components_across_the_axis_turn_by_the_angle():
    turn = Turn((0.3, -1.0, 2.0), (1.0, 0.0, -1.0), 0.7)
    points = np.array([[1.0, 0.0, -1.0], [3.0, 5.0, 7.0], [-2.0, 0.5, 1.0]])
    across = turn.across(points)
    np.testing.assert_allclose(turn.across(turn.places(points)), np.exp(0.7j) * across, atol=1e-13)
    arms, a = points - turn.point, np.array(turn.axis) / np.linalg.norm(turn.axis)
    np.testing.assert_allclose(np.abs(across) ** 2, (arms**2).sum(axis=1) - (arms @ a) ** 2, atol=1e-12)


@pytest.mark.parametrize("names", [None, ("low", "high"), ("high", "low")])
def test_nodes_of_the_faces_are_paired_from_low_to_high(names):
    mesh = annulus()
    pairs = paired_faces(mesh, QUARTER, names, None)
    assert sorted(zip(*(nodes.tolist() for nodes in pairs), strict=True)) == [(0, 3), (4, 7), (8, 11)]


@pytest.mark.parametrize(("part", "found"), [(0.9e-3, True), (1.1e-3, False)])
@pytest.mark.parametrize("names", [None, ("low", "high")])
def test_pairs_may_miss_by_a_thousandth_of_the_shortest_edge(part, found, names):
    mesh = shifted(annulus(), 7, [0.0, 0.0, part * edge()])
    if found:
        assert len(paired_faces(mesh, QUARTER, names, None).low) == 3
        return
    told = f"disk.inp: turned by 90 degrees.*, node 5 comes to lie {part * edge():.3g} m from the nearest, 8"
    with pytest.raises(cf.errors.ModelError, match=told):
        paired_faces(mesh, QUARTER, names, None)
    assert len(paired_faces(mesh, QUARTER, names, 1.01 * part * edge()).low) == 3


@pytest.mark.parametrize(("part", "told"), [(0.24, "node 5 comes to lie"), (0.26, "facets of the faces: found none")])
def test_nodes_that_miss_by_more_than_a_quarter_are_no_pair(part, told):
    """Then nodes 0 and 8 are paired alone, between which there is no facet."""
    with pytest.raises(cf.errors.ModelError, match=told):
        paired_faces(shifted(annulus(), 7, [0.0, 0.0, part * edge()]), QUARTER, None, None)


def test_the_worst_miss_is_named_and_with_no_hit_the_nearest():
    mesh = shifted(shifted(annulus(), 7, [0.0, 0.0, 0.05]), 11, [0.0, 0.0, 0.03])
    with pytest.raises(cf.errors.ModelError, match=r"node 5 comes to lie 0\.05 m from the nearest, 8"):
        found_pairs(mesh, QUARTER, 1e-6, 0.1)
    with pytest.raises(cf.errors.ModelError, match=r"node 5 comes to lie 0\.05 m"):
        named(mesh, QUARTER, ("low", "high"), 0.04)
    mesh = shifted(shifted(mesh, 3, [0.0, 0.0, 0.2]), 7, [0.0, 0.0, 0.2])
    with pytest.raises(cf.errors.ModelError, match=r"node 9 comes to lie 0\.03 m from the nearest, 12"):
        found_pairs(mesh, QUARTER, 1e-6, 1e-3)


def test_a_full_sector_of_another_angle_is_told_how_many_there_are():
    with pytest.raises(
        cf.errors.ModelError,
        match=r"faces 90 degrees apart .*as 4 sectors have, beside 6 sectors, 60 degrees",
    ):
        named(annulus(), SIXTH, ("low", "high"), 1e-3)
    with pytest.raises(cf.errors.ModelError, match=r"faces 90 degrees apart .*as 4 sectors have"):
        named(annulus(), SIXTH, ("high", "low"), 1e-3)
    with pytest.raises(cf.errors.ModelError, match=r"faces 0 degrees apart .*as 0 sectors have"):
        named(annulus(), SIXTH, ("low", "low"), 1e-3)


@pytest.mark.parametrize(("angle", "fits"), [(0.9995, True), (0.9985, False), (1.0005, True), (1.0015, False)])
@pytest.mark.parametrize("names", [("low", "high"), ("high", "low")])
def test_angles_may_be_a_thousandth_off(angle, fits, names):
    mesh = annulus(angle * np.pi / 2.0)
    if fits:
        assert named(mesh, QUARTER, names, 0.1).low.tolist() == [0, 4, 8]
    else:
        with pytest.raises(cf.errors.ModelError, match="as 4 sectors have, beside 4 sectors"):
            named(mesh, QUARTER, names, 0.1)


@pytest.mark.parametrize("names", [("low", "high"), ("high", "low")])
def test_faces_of_a_half_are_named_in_either_order(names):
    half = Turn((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), np.pi)
    pairs = named(annulus(np.pi), half, names, 1e-6)
    assert {frozenset(pair) for pair in zip(*(nodes.tolist() for nodes in pairs), strict=True)} == {
        frozenset(pair) for pair in ((0, 3), (4, 7), (8, 11))
    }


def test_named_faces_have_as_many_nodes_each_with_a_partner_of_its_own():
    mesh = annulus()
    few = cf.imported.MeshData(
        kind="quad",
        points=mesh.points,
        cells=mesh.cells,
        source="disk.inp",
        groups={"low": cf.imported.Group(nodes=[0, 4, 8]), "high": cf.imported.Group(nodes=[3, 7])},
    )
    with pytest.raises(cf.errors.ModelError, match=r"disk\.inp: found 3 nodes in 'low', 2 in 'high'"):
        named(few, QUARTER, ("low", "high"), 1e-3)
    near = shifted(mesh, 4, mesh.points[8] - mesh.points[4])  # two low nodes at one place
    with pytest.raises(cf.errors.ModelError, match="comes to lie"):
        named(near, Turn((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), np.pi / 2.0), ("low", "high"), 5.0)


def test_nodes_of_a_group_that_no_cell_has_are_passed_over():
    mesh = annulus()
    more = cf.imported.MeshData(kind="quad", points=np.vstack([mesh.points, [[9.0, 9.0, 9.0]]]), cells=mesh.cells,
                    groups={"low": cf.imported.Group(nodes=[0, 4, 8, 12]), "high": mesh.groups["high"]})  # fmt: skip
    assert named(more, QUARTER, ("low", "high"), 1e-6).low.tolist() == [0, 4, 8]


def test_a_part_that_repeats_itself_is_no_sector():
    with pytest.raises(cf.errors.ModelError, match=r"turned by 30 degrees .*, the part repeats itself within"):
        paired_faces(annulus(), Turn((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), np.pi / 6.0), None, None)


def test_nodes_on_the_axis_alone_are_no_faces():
    points = [[0, 0], [1, 0.2], [1.2, 0.7], [0.4, 0.9]]
    with pytest.raises(cf.errors.ModelError, match="found no nodes of faces but those on the axis"):
        paired_faces(squares(points, [[0, 1, 2, 3]]), QUARTER, None, None)


def test_facets_are_laid_on_facets():
    """Two edges along the low face; on the high face its outer two nodes are joined past the middle one."""
    mesh = annulus()
    pairs = Pairs(np.array([0, 4, 8]), np.array([3, 7, 11]))
    require_facets(mesh, pairs)
    cells = mesh.cells.copy()
    cells[cells == 7] = len(mesh.points)
    torn = cf.imported.MeshData(kind="quad", points=np.vstack([mesh.points, mesh.points[7:8]]), cells=cells)
    with pytest.raises(cf.errors.ModelError, match=r"a facet comes to lie on nodes \[4, 8\], which are no facet"):
        require_facets(torn, pairs)
    with pytest.raises(cf.errors.ModelError, match="found none"):
        require_facets(mesh, Pairs(np.array([0, 8]), np.array([3, 11])))
