"""Values and slopes of nodal fields at places of a surface."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.mesh.place import interpolation, place_jets
from casingfem.structure.mesh.shell_mesh import make_grid

PLATE = make_grid(cf.Plate(length=2.0, width=3.0), cf.ShellMesh(order=3, rows=(0.0, 0.3, 1.0), around=4))
CYLINDER = make_grid(cf.Cylinder(radius=1.0, height=0.7), cf.ShellMesh(order=8, rows=(0.0, 0.4, 1.0), around=5))
TURN = 2.0 * np.pi


def test_value_and_slopes_of_a_polynomial_are_exact_in_every_element():
    """x^3 y^2 on elements of different sizes, at their corners too."""
    a, b = (v.ravel() for v in np.meshgrid([0.0, 0.2, 0.6, 1.1, 2.0], [-1.5, -0.75, -0.1, 0.4, 1.5]))
    nodes, jets = place_jets(PLATE, a, b)
    values = np.einsum("jpk,pk->jp", jets, PLATE.nodes[0, nodes] ** 3 * PLATE.nodes[1, nodes] ** 2)
    np.testing.assert_allclose(values, [a**3 * b**2, 3 * a**2 * b**2, 2 * a**3 * b], rtol=1e-11, atol=1e-11)


def test_a_place_is_seen_by_the_nodes_of_its_own_element():
    """Rows at 0, 0.6, 2 and columns of 0.75: element 4 i + j; on a line between two, the latter."""
    found = [interpolation(PLATE, np.array([a]), np.array([b]))[0][0].tolist() for a, b in [(0.59, 0.7), (0.6, 0.0)]]
    assert found == [PLATE.elements[2].tolist(), PLATE.elements[6].tolist()]


@pytest.mark.parametrize("theta", [0.3, 0.3 + TURN, 0.3 - 2.0 * TURN, TURN - 0.1, -0.1])
def test_angles_are_counted_around(theta):
    nodes, jets = place_jets(CYLINDER, np.array([0.5]), np.array([theta]))
    z, angle = CYLINDER.nodes[:, nodes]
    values = np.einsum("jpk,pk->j", jets, z**2 * np.cos(angle))
    expected = [0.25 * np.cos(theta), np.cos(theta), -0.25 * np.sin(theta)]
    np.testing.assert_allclose(values, expected, atol=2e-6)


@pytest.mark.parametrize(
    ("a", "b", "told"),
    [
        ([1.0, -1e-8], [0.0, 0.0], "expected 0 to 2"),
        ([2.0 + 1e-8, 1.0], [0.0, 0.0], "expected 0 to 2"),
        ([1.0, 1.0], [0.0, -1.5 - 1e-8], "expected -1.5 to 1.5"),
        ([1.0, 1.0], [1.5 + 1e-8, 0.0], "expected -1.5 to 1.5"),
    ],
)
def test_places_off_the_surface_are_refused(a, b, told):
    with pytest.raises(ValueError, match=f"at: found .*off the surface; {told}"):
        place_jets(PLATE, np.array(a), np.array(b))


@pytest.mark.parametrize(("a", "b"), [(-1.5e-9, 0.0), (2.0 + 1.5e-9, 0.0), (1.0, -1.5 - 2.5e-9), (1.0, 1.5 + 2.5e-9)])
def test_round_off_beyond_an_edge_is_taken_for_the_edge(a, b):
    inside = np.clip(a, 0.0, 2.0), np.clip(b, -1.5, 1.5)
    np.testing.assert_array_equal(
        interpolation(PLATE, np.array([a]), np.array([b]))[1], interpolation(PLATE, *map(np.array, inside))[1]
    )
