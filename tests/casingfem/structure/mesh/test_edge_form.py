"""Quadratic forms of what stands on an edge: products, matrices, springs on dofs."""

import numpy as np
import pytest

from casingfem.structure.mesh.edge_form import (
    EdgeForm,
    LineFrame,
    PointSprings,
    along_springs,
    places_of,
    single_place,
    spring_form,
)

RNG = np.random.default_rng(7)
DOFS = np.array([[4, 1, 0], [1, 5, 4]])
B = RNG.standard_normal((2, 2, 3))
D = np.array([[[2.0, 0.5], [0.5, 3.0]], [[7.0, -1.0], [-1.0, 4.0]]])


def dense(form, size):
    """The form written out: sum over points of S^T B^T D B S, where S picks the dofs."""
    picked = [np.eye(size)[dofs] for dofs in form.dofs]
    return sum(S.T @ b.T @ d @ b @ S for S, b, d in zip(picked, form.B, form.D, strict=True))


def test_the_matrix_of_a_form_sums_its_points():
    form = EdgeForm(dofs=DOFS, B=B, D=D)
    np.testing.assert_allclose(form.matrix(7).toarray(), dense(form, 7), rtol=1e-13, atol=1e-14)


def test_products_of_fields_are_those_with_the_matrix():
    form, fields = EdgeForm(dofs=DOFS, B=B, D=D), RNG.standard_normal((7, 2))
    np.testing.assert_allclose(form.product(fields), fields.T @ dense(form, 7) @ fields, rtol=1e-13)


@pytest.mark.parametrize("coupled", [False, True])
def test_springs_act_on_what_their_nodes_interpolate(coupled):
    """Energy of the displacement, of both turns and of the coupling between them, at a point between two nodes."""
    block = np.array([[3.0, 1.0, 0.0], [1.0, 5.0, 2.0], [0.0, 2.0, 7.0]])
    coupling = np.array([[0.5, -1.0], [0.25, 2.0], [1.5, 0.75]])
    springs = PointSprings(
        nodes=np.array([[2, 0]]),
        values=np.array([[0.7, 0.4]]),
        blocks=block[None],
        rotation=np.array([11.0]),
        coupling=coupling[None] if coupled else None,
    )
    fields = RNG.standard_normal((3, 5))
    at = 0.7 * fields[2] + 0.4 * fields[0]
    energy = at[:3] @ block @ at[:3] + 11.0 * (at[3] ** 2 + at[4] ** 2)
    if coupled:
        energy += 2.0 * at[:3] @ coupling @ at[3:]
    x = fields.ravel()
    assert x @ spring_form(springs).matrix(15) @ x == pytest.approx(energy, rel=1e-12)


def test_complex_springs_stay_complex():
    springs = PointSprings(np.array([[0]]), np.ones((1, 1)), np.eye(3)[None] * 2j, np.array([1.0]))
    assert spring_form(springs).matrix(5).toarray()[0, 0] == 2j


def test_places_of_nodes_in_a_list_that_is_not_in_order():
    nodes = np.array([8, 2, 11, 5])
    assert places_of(nodes, np.array([[5, 8, 2], [11, 2, 5]])).tolist() == [[3, 0, 1], [2, 1, 3]]


def test_springs_along_slanted_directions():
    """k_r r r^T + k_theta t t^T + k_z z z^T with directions that are neither the axes nor symmetric."""
    directions = np.linalg.qr(RNG.standard_normal((3, 3)))[0].T
    k = np.array([2.0, 5.0, 11.0])
    expected = sum(k[i] * np.outer(directions[i], directions[i]) for i in range(3))
    found = along_springs(np.stack([k, 2.0 * k], axis=1), np.stack([directions, directions], axis=2))
    np.testing.assert_allclose(found, [expected, 2.0 * expected], rtol=1e-13, atol=1e-14)


def test_a_single_place_is_one_node_of_weight_one():
    at = LineFrame(*(np.array([float(i)]) for i in range(7)))
    line = single_place(at)
    assert line.nodes.tolist() == [0]
    assert line.weights.tolist() == [1.0]
    assert line.breaks.tolist() == [0.0]
    assert line.order == 0
    assert line.closed is True
    assert line.nodal is line.frame(np.array([0.3])) is at
    nodes, values = line.interpolate(np.array([0.3]))
    assert (nodes.tolist(), values.tolist()) == ([[0]], [[1.0]])
