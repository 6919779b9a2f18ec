"""Order of the nodes of each kind, and cells that are collapsed or numbered the other way round, by their places."""

import numpy as np
import pytest
from meshio._vtk_common import meshio_to_vtk_type

from casingfem.structure.imported.mesh.cell_kind import KINDS, SHELLS, SOLIDS, VTK, shape_functions
from casingfem.structure.imported.mesh.collapsed import distinct, mirror, native, right_handed, spread, written_as

CUBE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
CUBE_EDGES = [[0.5, 0, 0], [1, 0.5, 0], [0.5, 1, 0], [0, 0.5, 0], [0.5, 0, 1], [1, 0.5, 1], [0.5, 1, 1], [0, 0.5, 1],
              [0, 0, 0.5], [1, 0, 0.5], [1, 1, 0.5], [0, 1, 0.5]]  # fmt: skip
CUBE_SIDES = [[0, 0.5, 0.5], [1, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 1, 0.5], [0.5, 0.5, 0], [0.5, 0.5, 1], [0.5, 0.5, 0.5]]
PLACES = {  # as in the file formats of VTK
    "line3": [[0], [1], [0.5]],
    "triangle6": [[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]],
    "quad9": [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5], [0.5, 0.5]],
    "tetra10": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0, 0], [0.5, 0.5, 0], [0, 0.5, 0], [0, 0, 0.5],
                [0.5, 0, 0.5], [0, 0.5, 0.5]],
    "hexahedron27": CUBE + CUBE_EDGES + CUBE_SIDES,
    "wedge15": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [0.5, 0, 0], [0.5, 0.5, 0],
                [0, 0.5, 0], [0.5, 0, 1], [0.5, 0.5, 1], [0, 0.5, 1], [0, 0, 0.5], [1, 0, 0.5], [0, 1, 0.5]],
    "pyramid13": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [0.5, 0, 0], [1, 0.5, 0], [0.5, 1, 0],
                  [0, 0.5, 0], [0, 0, 0.5], [0.5, 0, 0.5], [0.5, 0.5, 0.5], [0, 0.5, 0.5]],
}  # fmt: skip
PARTS = {"line": ("line3", 2), "triangle": ("triangle6", 3), "quad": ("quad9", 4), "quad8": ("quad9", 8),
         "tetra": ("tetra10", 4), "hexahedron": ("hexahedron27", 8), "hexahedron20": ("hexahedron27", 20)}  # fmt: skip
MIRRORS = {"tetra10": [1, 0, 2], "hexahedron20": None, "hexahedron27": None, "wedge15": None, "pyramid13": [1, 0, 2],
           "triangle6": [1, 0], "quad9": [1, 0], "quad": [1, 0]}  # axes exchanged, or z turned round  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_nodes_stand_in_vtks_order(kind):
    whole, count = PARTS.get(kind, (kind, None))
    assert KINDS[kind].places.tolist() == PLACES[whole][:count]
    assert KINDS[kind].nodes == len(PLACES[whole][:count])
    assert KINDS[kind].dim == len(PLACES[whole][0])


def test_numbers_and_lists_of_kinds():
    assert {kind: meshio_to_vtk_type[kind] for kind in VTK} == dict(VTK)
    assert set(VTK) == {*SOLIDS, *SHELLS}
    assert SOLIDS == ("tetra", "tetra10", "hexahedron", "hexahedron20", "hexahedron27")


@pytest.mark.parametrize("kind", KINDS)
def test_shape_functions_carry_linear_places_and_their_slopes(kind):
    dim = KINDS[kind].dim
    at = np.array([[0.2, 0.11], [0.3, 0.27], [0.15, 0.4]])[:dim]
    values, slopes = shape_functions(kind, at)
    places = KINDS[kind].places
    np.testing.assert_allclose(places.T @ values, at, atol=1e-13)
    carried = np.einsum("kd,ekp->pde", places, slopes)
    np.testing.assert_allclose(carried, np.tile(np.eye(dim), (2, 1, 1)), atol=1e-12)


@pytest.mark.parametrize("kind", ["line3", "triangle6", "quad8", "quad9", "tetra10", "hexahedron20", "hexahedron27",
                                  "wedge15", "pyramid13"])  # fmt: skip
def test_quadratic_shape_functions_carry_squares_along_straight_lines(kind):
    """x^2 and its slopes, of a pyramid too, whose functions are no polynomials."""
    at = np.array([[0.2, 0.11], [0.3, 0.27], [0.15, 0.4]])[: KINDS[kind].dim]
    values, slopes = shape_functions(kind, at)
    for d in range(KINDS[kind].dim):
        square = KINDS[kind].places[:, d] ** 2
        np.testing.assert_allclose(square @ values, at[d] ** 2, atol=1e-13)
        expected = np.zeros_like(at)
        expected[d] = 2.0 * at[d]
        np.testing.assert_allclose(np.einsum("k,ekp->ep", square, slopes), expected, atol=1e-12)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if KINDS[kind].facets])
def test_nodes_of_facets_stand_where_the_facets_own_kind_puts_them(kind):
    """The middle of each pair of a facet's corners has the node that its kind has there."""
    places, inner = KINDS[kind].places, KINDS[KINDS[kind].facet]
    for facet, nodes in zip(KINDS[kind].facets, KINDS[kind].facet_nodes, strict=True):
        for node, of in zip(nodes, inner.supports_of_nodes, strict=True):
            np.testing.assert_allclose(places[node], places[[facet[i] for i in of]].mean(axis=0), atol=1e-15)


@pytest.mark.parametrize(("kind", "axes"), MIRRORS.items())
def test_a_mirrored_cell_is_the_one_seen_in_a_mirror(kind, axes):
    places = KINDS[kind].places
    seen = places[:, axes] if axes else places * [1.0, 1.0, -1.0] + [0.0, 0.0, 1.0]
    assert places[mirror(kind)].tolist() == seen.tolist()


@pytest.mark.parametrize(("kind", "corners"), [("wedge", [3, 4, 5, 0, 1, 2]), ("pyramid", [0, 3, 2, 1, 4])])
def test_linear_wedges_and_pyramids_are_mirrored_too(kind, corners):
    points = KINDS[{"wedge": "wedge15", "pyramid": "pyramid13"}[kind]].places[: len(corners)]
    cell = np.arange(len(corners))[None]
    assert mirror(kind) == corners
    assert right_handed(kind, cell, points).tolist() == cell.tolist()
    both = np.vstack([cell, cell[:, corners]])
    assert right_handed(kind, both, points).tolist() == [cell[0].tolist()] * 2
    assert right_handed("quad", cell[:, :4], points).tolist() == cell[:, :4].tolist()


@pytest.mark.parametrize("kind", ["quad8", "quad9", "quad"])
@pytest.mark.parametrize("k", range(4))
def test_a_square_collapsed_at_any_side_is_a_triangle_seen_from_the_same_side(kind, k):
    """Corner k + 1 stands on corner k; the triangle's corners keep their sense and its middles stand in its sides."""
    x = np.array([[0.0, 0.0], [4.0, 0.5], [5.0, 3.0], [1.0, 4.0]])
    x[(k + 1) % 4] = x[k]
    number = np.arange(4)
    number[(k + 1) % 4] = k
    if k == 3:
        number = np.array([0, 1, 2, 0])
        x[3] = x[0] = [0.5, 1.0]
    cell = [*number]
    if kind != "quad":
        ends = [(number[i], number[(i + 1) % 4]) for i in range(4)]
        cell += [a if a == b else 4 + i for i, (a, b) in enumerate(ends)]
    if kind == "quad9":
        cell += [cell[0]]
    ((found, rows, slots),) = native(kind, np.array([cell]))
    assert (found, rows.tolist()) == ("triangle" if kind == "quad" else "triangle6", [0])
    own = np.array(cell)[slots]
    assert len(set(own.tolist())) == len(own)
    a, b, c = x[own[:3]]
    assert (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0] > 0.0
    for i, middle in enumerate(own[3:]):
        assert {own[i], own[(i + 1) % 3]} == set(ends[middle - 4])


def test_cells_that_are_whole_or_of_other_kinds_stay_what_they_are():
    whole = [(kind, rows.tolist(), slots.tolist()) for kind, rows, slots in native("quad", np.array([[0, 1, 2, 3]]))]
    assert whole == [("quad", [0], [0, 1, 2, 3])]
    folded = np.array([[0, 1, 1, 0], [4, 4, 5, 6], [0, 1, 2, 3], [7, 8, 9, 9]])
    found = {kind: rows.tolist() for kind, rows, _ in native("quad", folded[[0, 2]])}
    assert found == {"quad": [0, 1]}
    kinds = [(kind, rows.tolist()) for kind, rows, _ in native("quad", folded)]
    assert kinds == [("triangle", [1]), ("triangle", [3]), ("quad", [0, 2])]
    assert [kind for kind, _, _ in native("hexahedron", np.array([[0, 1, 2, 2, 3, 4, 5, 5]]))] == ["hexahedron"]


def test_corners_given_again_come_first_as_none():
    assert distinct(np.array([[[5, 2, 5, 9]], [[3, 3, 3, 3]]])).tolist() == [[[-1, 2, 5, 9]], [[-1, -1, -1, 3]]]


def test_a_cell_of_the_same_kind_is_written_as_it_is():
    cells = np.array([[3, 1, 2, 0]])
    assert written_as("tetra", "tetra", cells, np.zeros((4, 3))) is cells
    assert spread("hexahedron", "wedge") == [0, 1, 2, 2, 3, 4, 5, 5]
    assert spread("quad9", "triangle6") == [0, 1, 2, 2, 3, 4, 2, 5, 2]
