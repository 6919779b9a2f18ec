"""Spectral element: quadrature, Lagrange polynomials, conformity."""

import numpy as np
import pytest

from casingfem.structure.mesh.element import ElementQuadLobatto, gauss, lagrange, lobatto

ORDERS = range(2, 13)


@pytest.mark.parametrize("order", ORDERS)
def test_lobatto_rule_is_exact_to_degree_2p_minus_1_and_no_further(order):
    x, w = lobatto(order)
    assert x[0] == 0.0
    assert x[-1] == 1.0
    for degree in range(2 * order):
        assert w @ x**degree == pytest.approx(1.0 / (degree + 1), rel=1e-13)
    t = 2 * x - 1
    assert w @ np.polynomial.legendre.legval(t, np.eye(order + 1)[order]) ** 2 != pytest.approx(
        1 / (2 * order + 1), rel=0.1
    )


@pytest.mark.parametrize("count", range(1, 14))
def test_gauss_rule_is_exact_to_degree_2n_minus_1(count):
    x, w = gauss(count)
    for degree in range(2 * count):
        assert w @ x**degree == pytest.approx(1.0 / (degree + 1), rel=1e-13)


@pytest.mark.parametrize("order", ORDERS)
def test_points_and_weights_are_symmetric(order):
    x, w = lobatto(order)
    np.testing.assert_allclose(x, 1.0 - x[::-1], atol=3e-16)
    np.testing.assert_allclose(w, w[::-1], rtol=1e-13)


@pytest.mark.parametrize("order", ORDERS)
def test_lagrange_reproduces_every_polynomial_of_its_order_and_its_slope(order):
    x, nodes = np.linspace(0.0, 1.0, 17), lobatto(order)[0]
    values, slopes = lagrange(order, x)
    for degree in range(order + 1):
        np.testing.assert_allclose(nodes**degree @ values, x**degree, atol=1e-12)
        slope = degree * x ** max(degree - 1, 0)
        np.testing.assert_allclose(nodes**degree @ slopes, slope, atol=1e-10)


@pytest.mark.parametrize("order", ORDERS)
def test_basis_is_nodal_and_a_partition_of_unity(order):
    element = ElementQuadLobatto(order)
    at_nodes = np.stack([element.lbasis(element.doflocs.T, i)[0] for i in range(len(element.doflocs))])
    np.testing.assert_allclose(at_nodes, np.eye(len(element.doflocs)), atol=1e-11)
    table = element.tabulate((np.linspace(0, 1, 5), np.linspace(0, 1, 4)))
    np.testing.assert_allclose(table.sum(axis=1), np.outer([1.0, 0.0, 0.0], np.ones(20)), atol=1e-10)


@pytest.mark.parametrize("order", [2, 5, 9])
def test_tabulation_equals_the_basis_functions_point_by_point(order):
    element, a, b = ElementQuadLobatto(order), np.linspace(0, 1, 4), np.linspace(0.1, 0.8, 3)
    points = np.stack([np.repeat(a, 3), np.tile(b, 4)])
    table = element.tabulate((a, b))
    for i in range(table.shape[1]):
        value, gradient = element.lbasis(points, i)
        np.testing.assert_allclose(table[:, i], np.stack([value, *gradient]), atol=1e-11)


def test_refuses_order_zero():
    with pytest.raises(ValueError, match="at least 1"):
        lobatto(0)


@pytest.mark.parametrize("order", [1, *ORDERS])
def test_points_and_weights_are_real_numbers(order):
    """Roots of polynomials are complex from numpy 2.5 on; scikit-fem then loses the element without a word."""
    assert [part.dtype for part in lobatto(order)] == [np.float64, np.float64]
    assert ElementQuadLobatto(order).doflocs.dtype == np.float64


@pytest.mark.parametrize("order", ORDERS)
def test_inner_points_are_where_the_polynomial_is_level(order):
    t = 2.0 * lobatto(order)[0][1:-1] - 1.0
    slope, bend = (np.polynomial.legendre.legder(np.eye(order + 1)[order], m) for m in (1, 2))
    step = np.polynomial.legendre.legval(t, slope) / np.polynomial.legendre.legval(t, bend)
    assert np.abs(step).max() < 1e-15


def test_values_and_slopes_at_a_table_of_places():
    places = np.array([[0.1, 0.4, 0.9], [0.0, 0.3, 1.0]])
    for table, row in zip(lagrange(3, places), lagrange(3, places.ravel()), strict=True):
        np.testing.assert_allclose(table, row.reshape(4, 2, 3), atol=1e-14)
