"""Faces tied to faces: the nearest places, both sides of each tolerance, what is refused or doubted."""

from dataclasses import replace

import pytest

import casingfem as cf

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


def test_names_that_are_no_faces_are_refused():
    mesh = pair(0.0)
    for given, told in (
        ({"follower": "b.lov", "master": "a.high"}, r"no group 'b\.lov' \(did you mean b\.low"),
        ({"follower": "b.low", "master": "c"}, "no group 'c'"),
        ({"follower": "b.low", "master": "edge"}, "group 'edge' without facets"),
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
