"""Faces tied to faces: the nearest places, both sides of each tolerance, what is refused or doubted."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.attachments.glue import faces_of, glued, inside, nearest_places, projected
from tests.casingfem.structure.imported.parts import box, flat

ENDS = {"low": (0, 0.0), "high": (0, 1.0)}


def pair(gap, raised=0.0):
    """A brick of 1 x 3 x 4 and half of its height beyond a gap; one corner of the other stands farther off."""
    first = cf.imported.grid_mesh("hexahedron", (1, 1, 1), lambda u: u * [1.0, 3.0, 4.0], groups=ENDS)
    other = cf.imported.grid_mesh(
        "hexahedron", (1, 1, 1), lambda u: u * [1.0, 3.0, 2.0] + [1.0 + gap, 0.0, 1.0], groups=ENDS
    )
    points = other.points.copy()
    points[other.groups["low"].nodes[0], 0] += raised
    return cf.imported.beside({"a": first, "b": replace(other, points=points)})


@pytest.mark.parametrize(("gap", "given"), [(0.24, {}), (0.5, {"tolerance": 0.51}), (-0.24, {})])
def test_nodes_within_a_twentieth_of_the_facet_are_moved_onto_it_and_follow(gap, given):
    """The facet of 3 x 4 has the size 5."""
    mesh = pair(gap)
    both = glued(mesh, cf.imported.Gluing(follower="b.low", master="a.high", **given))
    tie = both.attachments.glued[0]
    assert tie.nodes.tolist() == mesh.groups["b.low"].nodes.tolist()
    np.testing.assert_allclose(both.points[tie.nodes], mesh.points[tie.nodes] - [gap, 0.0, 0.0], atol=1e-13)
    carried = np.einsum("ik,ikc->ic", tie.weights, mesh.points[tie.others])
    np.testing.assert_allclose(carried, both.points[tie.nodes], atol=1e-12)
    assert np.count_nonzero(tie.weights, axis=1).tolist() == [2, 2, 2, 2]  # on an edge of the facet
    rest = np.setdiff1d(np.arange(len(mesh.points)), tie.nodes)
    np.testing.assert_array_equal(both.points[rest], mesh.points[rest])
    assert tie.where == "tie"


@pytest.mark.parametrize(("gap", "given"), [(0.26, {}), (0.5, {"tolerance": 0.49})])
def test_faces_that_are_farther_apart_are_refused_with_the_distance(gap, given):
    with pytest.raises(
        cf.errors.ModelError, match=rf"grid: tie: 'b\.low' stands {gap} m from 'a\.high' or farther.*\[mesh-tie\]"
    ):
        glued(pair(gap), cf.imported.Gluing(follower="b.low", master="a.high", **given))


def test_single_nodes_that_are_too_far_stay_where_they_are():
    mesh = pair(0.1, raised=0.2)
    with pytest.warns(cf.errors.ModelWarning, match=r"TIE 3: 1 node \(9\) of 'b\.low' off 'a\.high'.*mesh-tie-loose"):
        both = glued(mesh, cf.imported.Gluing(follower="b.low", master="a.high", where="TIE 3"))
    far = mesh.groups["b.low"].nodes[0]
    assert far not in both.attachments.glued[0].nodes
    assert len(both.attachments.glued[0].nodes) == 3
    np.testing.assert_array_equal(both.points[far], mesh.points[far])


def test_names_that_are_no_faces_are_refused():
    mesh = pair(0.0)
    for given, told in (
        ({"follower": "b.lov", "master": "a.high"}, r"no group 'b\.lov' \(did you mean b\.low"),
        ({"follower": "b.low", "master": "c"}, "no group 'c'"),
        ({"follower": "b.low", "master": "edge"}, "group 'edge' has no facets"),
    ):
        with pytest.raises(cf.errors.ModelError, match=told) as caught:
            cf.imported.tied(
                replace(mesh, groups={**mesh.groups, "edge": cf.imported.Group(nodes=[0, 1])}),
                [cf.imported.Gluing(**given)],
            )
        assert caught.value.code == "mesh-tie"


def test_nodes_that_follow_already_or_are_the_masters_own_are_passed_over():
    mesh = pair(0.0)
    once = cf.imported.tied(mesh, [cf.imported.Gluing(follower="b.low", master="a.high")])
    assert len(cf.imported.tied(once, [cf.imported.Gluing(follower="b.low", master="a.high")]).attachments.glued) == 1
    assert len(cf.imported.tied(mesh, [cf.imported.Gluing(follower="a.high", master="a.high")]).attachments.glued) == 0


def test_a_shell_is_followed_on_its_edges_or_its_cells():
    mesh = cf.imported.grid_mesh("quad8", (2, 1), flat, groups=ENDS)
    mesh = replace(mesh, groups={**mesh.groups, "skin": cf.imported.Group(nodes=mesh.cells[1], cells=[1])})
    kind, cells = faces_of(mesh, "skin")
    assert (kind, cells.tolist()) == ("quad8", [mesh.cells[1].tolist()])
    kind, edges = faces_of(mesh, "high")
    assert (kind, edges.shape) == ("line3", (1, 3))
    solid = replace(box(1, 1, 1), groups={"body": cf.imported.Group(nodes=np.arange(8), cells=[0])})
    assert [faces_of(solid, "body")[0], faces_of(solid, "body")[1].shape] == ["quad", (6, 4)]


@pytest.mark.parametrize(("kind", "place", "moved"), [
    ("line", [1.4], [1.0]), ("line", [-0.3], [0.0]), ("quad", [0.3, 1.7], [0.3, 1.0]),
    ("quad", [-0.1, 0.6], [0.0, 0.6]), ("quad", [0.9, 0.8], [0.9, 0.8]), ("triangle", [0.2, 0.3], [0.2, 0.3]),
    ("triangle", [0.8, 0.4], [0.7, 0.3]), ("triangle", [0.9, 1.5], [0.45, 0.55]),
    ("triangle6", [1.5, -1.0], [1.0, 0.0]), ("triangle", [1.5, 0.02], [0.99, 0.01]),
])  # fmt: skip
def test_places_are_kept_inside_their_facet(kind, place, moved):
    np.testing.assert_allclose(inside(kind, np.array([place])), [moved], atol=1e-14)


def test_the_nearest_facet_is_taken_and_its_size_told():
    """Two squares of side 1 and 3 in the planes z = 0 and z = 2; points above the first, below and beyond the other."""
    unit = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    facets = np.stack([unit, 3.0 * unit + [0, 0, 2]])
    points = np.array([[0.25, 0.5, 0.9], [0.25, 0.5, 1.2], [4.0, 1.5, 2.0], [0.25, 3.0, 1.0]])
    found = nearest_places("quad", facets, points)
    assert found.facet.tolist() == [0, 1, 1, 1]
    np.testing.assert_allclose(found.distance, [0.9, 0.8, 1.0, 1.0], rtol=1e-12)
    np.testing.assert_allclose(found.x, [[0.25, 0.5, 0], [0.25, 0.5, 2], [3, 1.5, 2], [0.25, 3, 2]], atol=1e-12)
    np.testing.assert_allclose(found.size, np.sqrt(2.0) * np.array([1, 3, 3, 3]), rtol=1e-14)
    np.testing.assert_allclose(found.weights[0], [0.75 * 0.5, 0.25 * 0.5, 0.25 * 0.5, 0.75 * 0.5], rtol=1e-12)


def test_places_on_a_bent_edge_are_level_under_the_point():
    """On the parabola (2 r, 4 r (1 - r)) the line from the place to the point is normal to it."""
    nodes = np.array([[[0, 0, 0], [2, 0, 0], [1, 1, 0.0]]])
    local, place = projected("line3", nodes, np.array([[1.4, 0.2, 0.5]]))
    r = local[0, 0]
    np.testing.assert_allclose(place[0], [2 * r, 4 * r * (1 - r), 0.0], atol=1e-13)
    assert 0.0 < r < 1.0
    away = np.array([1.4, 0.2, 0.5]) - place[0]
    assert away @ [2.0, 4.0 - 8.0 * r, 0.0] == pytest.approx(0.0, abs=1e-10)
