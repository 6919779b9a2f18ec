"""Halves of a wheel: a half turn lays each face on the other, so that the pairs are found both ways."""

import numpy as np
import pytest
from scipy.linalg import eigh

import casingfem as cf
from casingfem.structure.imported.cyclic.faces import Turn, paired_faces
from casingfem.structure.imported.cyclic.sector import assemble_cyclic
from casingfem.structure.imported.cyclic.wheel import wheel_mesh, wheel_structure
from tests.casingfem.structure.imported.parts import STEEL, flat, squares

HALF = Turn((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), np.pi)
CONE = cf.imported.revolved((0.5, 0.4), (0.0, 0.2), 0.3)
POINT, AXIS = np.array([0.3, -0.2, 0.1]), np.array([2.0, -1.0, 2.0]) / 3.0
ONTO = np.stack([np.cross([0.0, 1.0, 0.0], AXIS), np.cross(AXIS, np.cross([0.0, 1.0, 0.0], AXIS)), AXIS], axis=1)
ONTO /= np.linalg.norm(ONTO, axis=0)  # axes of a wheel about AXIS


def ring(turns, wrap=None, counts=(3, 4), wound=0.0):
    def place(u):
        r, theta = 1.0 + u[:, 0], 2.0 * np.pi * turns * u[:, 1] + wound * u[:, 0]
        return flat(np.stack([r * np.cos(theta), r * np.sin(theta)], axis=1))

    return cf.imported.grid_mesh("quad", counts, place, wrap=wrap)


def sets(pairs):
    return sorted((min(pair), max(pair)) for pair in zip(*(nodes.tolist() for nodes in pairs), strict=True))


def test_each_pair_of_a_half_is_found_once():
    pairs = paired_faces(ring(0.5), HALF, None, None)
    assert sets(pairs) == [(0, 4), (5, 9), (10, 14), (15, 19)]
    assert not set(pairs.low) & set(pairs.high)


@pytest.mark.parametrize("wound", [4.0, -4.0])
def test_faces_may_wind_around_the_axis(wound):
    """Cells elsewhere lie on either side of a facet, the one beside it on its own."""
    pairs = paired_faces(ring(0.5, counts=(24, 9), wound=wound), HALF, None, None)
    assert sets(pairs) == [(10 * k, 10 * k + 9) for k in range(25)]


def test_an_edge_across_the_axis_is_laid_on_itself():
    """One square on one side of it, and two with a node on the axis."""
    one = squares([[-1, 0], [1, 0], [1, 2], [-1, 2]], [[0, 1, 2, 3]])
    assert sets(paired_faces(one, HALF, None, None)) == [(0, 1)]
    two = squares([[-1, 0], [0, 0], [1, 0], [1, 2], [0, 2], [-1, 2]], [[0, 1, 4, 5], [1, 2, 3, 4]])
    assert sets(paired_faces(two, HALF, None, None)) == [(0, 2), (1, 1)]


def test_a_whole_ring_is_no_half_with_a_hole_neither():
    """The nodes of the hole are not laid on nodes of the surface, those of the rims are."""
    whole = ring(1.0, wrap=1, counts=(3, 8))
    cut = squares(whole.points[:, :2], np.delete(whole.cells, 10, axis=0))
    assert len(cut.boundary) == len(whole.boundary) + 4
    for mesh in (whole, cut):
        with pytest.raises(
            cf.errors.ModelError, match=r"turned by 180 degrees .*the part repeats itself within.*cyclic-sectors"
        ):
            paired_faces(mesh, HALF, None, None)


@pytest.mark.filterwarnings("ignore:.*mesh-thin-curved")
@pytest.mark.parametrize("kind", ["hexahedron20", "quad9"])
def test_both_diameters_of_two_halves_have_the_frequencies_of_the_whole(kind):
    """About a slanted axis."""
    solid = kind == "hexahedron20"

    def place(u):
        parts = [u[:, 0], 0.5 * u[:, 1], u[:, 2]] if solid else [np.full(len(u), 0.5), 0.5 * u[:, 0], u[:, 1]]
        return CONE(np.column_stack(parts)) @ ONTO.T + POINT

    mesh = cf.imported.grid_mesh(kind, (1, 4, 1) if solid else (4, 1), place, groups={"base": (1 + solid, 0.0)})
    given = {"mesh": mesh, "material": STEEL, "supports": {"base": cf.Clamped()}}
    part = cf.Solid(**given) if solid else cf.MeshShell(thickness=0.05, **given)
    sector = cf.imported.CyclicSector(structure=part, sectors=2, axis=tuple(AXIS), point=tuple(POINT))
    assert len(wheel_mesh(sector).points) == 2 * (len(mesh.points) - len(sector.pairs.low))
    system = assemble_cyclic(sector)
    each = [eigh(*(A.toarray() for A in system.matrices(n)[:2]), eigvals_only=True) for n in sector.diameters]
    whole = wheel_structure(sector).assembled()
    expected = eigh(whole.K.toarray(), whole.M.toarray(), eigvals_only=True)
    found = np.sort(np.concatenate(each))
    assert len(found) == len(expected)
    np.testing.assert_allclose(found[:30], expected[:30], rtol=1e-7)
