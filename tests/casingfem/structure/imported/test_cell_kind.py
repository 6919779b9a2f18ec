"""Kinds of cells: shape functions at the nodes, facets, quadrature."""

import numpy as np
import pytest

from casingfem.structure.imported.mesh.cell_kind import KINDS, SOLIDS, rule, shape_functions
from casingfem.structure.imported.mesh.serendipity import Pyramid13, Wedge15, gauss


@pytest.mark.parametrize("name", KINDS)
def test_each_shape_function_is_one_at_its_own_node(name):
    values, _ = shape_functions(name, np.ascontiguousarray(KINDS[name].places.T))
    np.testing.assert_allclose(values, np.eye(KINDS[name].nodes), atol=1e-13)


@pytest.mark.parametrize("name", KINDS)
def test_quadrature_has_positive_weights_and_integrates_the_square_of_every_function(name):
    _, weights, values, slopes = rule(name)
    assert weights.min() > 0.0
    _, fine, more, _ = rule(name, 8)
    np.testing.assert_allclose((values * weights) @ values.T, (more * fine) @ more.T, atol=1e-14)
    np.testing.assert_allclose(slopes.sum(axis=1), 0.0, atol=1e-13)


@pytest.mark.parametrize("name", KINDS)
def test_fields_of_each_degree_pass_with_their_slopes(name):
    """Linear ones through corners, quadratic ones too where edges have middles; those of r, s, t by hand."""
    kind, rng = KINDS[name], np.random.default_rng(6)
    x = 0.05 + 0.3 * rng.random((kind.dim, 4))
    values, slopes = shape_functions(name, x)
    a, B = rng.standard_normal(kind.dim), rng.standard_normal((kind.dim, kind.dim))
    B = (B + B.T) * bool(kind.middles)
    at = 0.7 + kind.places @ a + np.einsum("ki,ij,kj->k", kind.places, B, kind.places)
    np.testing.assert_allclose(at @ values, 0.7 + a @ x + np.einsum("ip,ij,jp->p", x, B, x), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(np.einsum("dkp,k->dp", slopes, at), a[:, None] + 2.0 * B @ x, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("name", ["wedge15", "pyramid13"])
def test_slopes_are_derivatives_of_each_function(name):
    x, h = 0.05 + 0.3 * np.random.default_rng(8).random((3, 4)), 1e-5
    _, slopes = shape_functions(name, x)
    for d, step in enumerate(h * np.eye(3)[:, :, None]):
        ahead, behind = (shape_functions(name, x + sign * step)[0] for sign in (1.0, -1.0))
        np.testing.assert_allclose(slopes[d], (ahead - behind) / (2.0 * h), atol=1e-8)


@pytest.mark.parametrize("kind", [Wedge15(), Pyramid13()])
def test_masses_of_straight_quadratic_cells_are_exact(kind):
    """Products of two shape functions against nine Gauss points along each side of a cube drawn to the cell."""
    t, along = gauss(9)
    r, s, z = (v.ravel() for v in np.meshgrid(t, t, t, indexing="ij"))
    weight = np.einsum("i,j,k->ijk", along, along, along).ravel()
    if isinstance(kind, Wedge15):
        finer, weight = (r, s * (1.0 - r), z), weight * (1.0 - r)
    else:
        finer, weight = (r * (1.0 - z), s * (1.0 - z), z), weight * (1.0 - z) ** 2
    N, (points, own) = kind.values(*finer), kind.quadrature()
    mass = (N * weight) @ N.T
    np.testing.assert_allclose((kind.values(*points) * own) @ kind.values(*points).T, mass, atol=1e-14 * mass.max())


@pytest.mark.parametrize("name", SOLIDS)
def test_facets_point_outwards_and_enclose_the_cell(name):
    kind = KINDS[name]
    places = kind.places
    flux = 0.0
    for nodes in kind.facet_nodes:
        _, weights, values, slopes = rule(kind.facet)
        x = values.T @ places[nodes]
        tangents = np.einsum("dkq,kc->dqc", slopes, places[nodes])
        flux += np.einsum("qc,qc,q", x, np.cross(tangents[0], tangents[1]), weights) / 3.0
    assert flux == pytest.approx(1.0 if "hexa" in name else 1.0 / 6.0, rel=1e-12)  # Gauss: the volume
