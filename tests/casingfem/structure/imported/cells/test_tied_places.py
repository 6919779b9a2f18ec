"""What tying makes of strains given at places: fields it passes, places where it takes them as they are, means."""

from itertools import product

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.imported.cells import mapped as summing
from casingfem.structure.imported.cells.mapped import cell_dofs, scatter
from casingfem.structure.imported.cells.shell import directors
from casingfem.structure.imported.cells.tying import across, in_plane, tied_strains, tying
from casingfem.structure.imported.mesh.cell_kind import KINDS, rule

RNG = np.random.default_rng(17)
GAUSS = np.array([0.5 - np.sqrt(3.0) / 6.0, 0.5 + np.sqrt(3.0) / 6.0])
BELOW, LEFT = np.array([GAUSS, [0.0, 0.0]]), np.array([[0.0, 0.0], GAUSS])
SLOPING = np.array([GAUSS[::-1], GAUSS])
WITHIN = np.array([[2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6]])  # where quadratics have their mean over a triangle
ROWS = range(8)


def tied(table, fields, count):
    """Strains (8, count) that a table of tying takes from fields, functions of places -> (8, places)."""
    found = np.zeros((8, count))
    for made, of, places, weights in table:
        found[list(made)] += fields(np.asarray(places))[list(of)] @ weights.T
    return found


def polynomial(terms):
    """A field for each of the eight strains, of powers (i, j) of r and s."""
    factors = RNG.standard_normal((8, len(terms)))
    return lambda x: factors @ np.array([x[0] ** i * x[1] ** j for i, j in terms])


def test_shears_of_four_nodes_come_from_the_middles_of_the_edges():
    fields, (r, s) = polynomial(list(product(range(4), range(3)))), rule("quad")[0]
    found = tied(tying("quad"), fields, len(r))
    middle = [fields(np.array([[x], [y]]))[:, 0] for x, y in ((0.5, 0.0), (0.5, 1.0), (0.0, 0.5), (1.0, 0.5))]
    np.testing.assert_allclose(found[6], (1 - s) * middle[0][6] + s * middle[1][6], rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(found[7], (1 - r) * middle[2][7] + r * middle[3][7], rtol=1e-12, atol=1e-13)
    np.testing.assert_array_equal(found[:6], fields(rule("quad")[0])[:6])


def test_strains_of_nine_nodes_are_those_through_gauss_points():
    """Two along the strain's own direction, where r^2 passes for r - 1/6; three across: (s - 1/2)^3 for .15 (s - 1/2).

    Shear in the plane and of curvature two by two.
    """
    x = rule("quad9")[0]
    power = {0: lambda t: t**0, 1: lambda t: t, 2: lambda t: t - 1 / 6}  # through two points
    more = {**power, 2: lambda t: t**2, 3: lambda t: 1.5 * t**2 - 0.6 * t + 0.05}  # through three
    for i, j in product(range(3), range(4)):
        for rows, (p, q), (a, b) in (
            ((0, 3, 6), (i, j), (power, more)), ((1, 4, 7), (j, i), (more, power)),
            ((2, 5), (i, min(j, 2)), (power, power)),
        ):  # fmt: skip
            found = tied(tying("quad9"), lambda y, p=p, q=q: np.tile(y[0] ** p * y[1] ** q, (8, 1)), x.shape[1])
            expected = a[p](x[0]) * b[q](x[1])
            np.testing.assert_allclose(found[list(rows)], np.tile(expected, (len(rows), 1)), atol=1e-13)


def test_strains_of_six_nodes_are_linear_with_the_values_on_their_edges_and_the_mean():
    """e_rr on s = 0, e_ss on r = 0, e_qq = (e_rr + e_ss)/2 - e_rs on the third; curvatures alike."""
    fields = polynomial(list(product(range(4), range(3))))

    def third(e):
        return 0.5 * (e[[0, 3]] + e[[1, 4]]) - 0.5 * e[[2, 5]]

    def at(places):
        return tied(in_plane(places), fields, places.shape[1])

    for parts, edge in ((lambda e: e[[0, 3]], BELOW), (lambda e: e[[1, 4]], LEFT), (third, SLOPING)):
        np.testing.assert_allclose(parts(at(edge)), parts(fields(edge)), rtol=1e-11, atol=1e-12)
        mean = parts(fields(WITHIN)).mean(axis=1)
        np.testing.assert_allclose(parts(at(WITHIN)).mean(axis=1), mean, rtol=1e-11, atol=1e-12)
    points = RNG.random((2, 3))
    middle = points @ np.array([[0.5], [0.5], [0.0]])
    bend = at(points) @ [0.5, 0.5, 0.0] - at(middle)[:, 0]
    np.testing.assert_allclose(bend, 0.0, atol=1e-11)
    assert np.abs(at(points)[:6]).min() > 0.0
    assert not at(points)[6:].any()


def test_shears_of_six_nodes_have_the_values_along_their_edges_and_the_mean():
    """gamma_r on s = 0, gamma_s on r = 0, their difference on the third; (p1 + s m, p2 - r m) within."""
    fields = polynomial(list(product(range(4), range(3))))

    def at(places):
        return tied(across(places), fields, places.shape[1])

    for part, edge in ((lambda e: e[6], BELOW), (lambda e: e[7], LEFT), (lambda e: e[7] - e[6], SLOPING)):
        np.testing.assert_allclose(part(at(edge)), part(fields(edge)), rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(at(WITHIN)[6:].mean(axis=1), fields(WITHIN)[6:].mean(axis=1), rtol=1e-10, atol=1e-11)
    x = RNG.random((2, 12))
    r, s, one, no = *x, np.ones(12), np.zeros(12)
    basis = [(one, no), (r, no), (s, no), (no, one), (no, r), (no, s), (r * s, -r * r), (s * s, -r * s)]
    table = np.array([np.concatenate(pair) for pair in basis]).T
    found = at(x)[6:].ravel()
    best = np.linalg.lstsq(table, found, rcond=None)[0]
    np.testing.assert_allclose(table @ best, found, rtol=1e-9, atol=1e-10)
    assert np.abs(best).min() > 1e-3
    assert not at(x)[:6].any()


def test_the_tables_of_six_nodes_are_those_of_its_quadrature():
    x = rule("triangle6")[0]
    fields = polynomial([(0, 0), (1, 2), (3, 1)])
    found = tied(tying("triangle6"), fields, x.shape[1])
    both = tied(in_plane(x), fields, x.shape[1]) + tied(across(x), fields, x.shape[1])
    np.testing.assert_array_equal(found, both)


@pytest.mark.parametrize("kind", ["quad", "quad9", "triangle6"])
def test_strains_of_a_plate_along_a_direction_and_the_bend_of_its_directors(kind):
    """u = H x, w = S x and directors n - C x: eps = sym H, chi = sym S less that of n,a, gamma = w + H^T n; area."""
    places = KINDS[kind].places
    x = np.insert(places @ np.array([[2.0, 0.3], [-0.4, 1.5]]), 2, 0.0, axis=1)
    H, S = RNG.standard_normal((3, 3)), RNG.standard_normal((2, 2))
    flat = np.tile([0.0, 0.0, 1.0], (len(x), 1))
    C = np.array([[0.3, 0.1], [0.1, -0.2]])
    n = flat.copy()
    n[:, :2] -= x[:, :2] @ C
    e = np.tile(np.eye(3)[:2], (len(x), 1, 1))
    angle = 0.6
    Q = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    along = np.array([*Q[0], 7.0])
    _, measure, b = tied_strains(kind, x[None], n[None], e[None], along)
    assert measure.sum() == pytest.approx(3.12 * (0.5 if kind == "triangle6" else 1.0), rel=1e-12)
    bent = Q @ C @ Q.T
    np.testing.assert_allclose(
        b[:, 0], np.tile([[bent[0, 0]], [bent[1, 1]], [bent[0, 1]]], measure.shape[1]), atol=1e-12
    )
    table, *_ = tied_strains(kind, x[None], flat[None], e[None], along)
    lean = x[:, :2] @ S.T
    found = table[0] @ np.hstack([x @ H.T, lean]).ravel()
    eps, chi = Q @ (H[:2, :2] + H[:2, :2].T) @ Q.T, Q @ (S + S.T) @ Q.T
    uniform = np.tile([0.5 * eps[0, 0], 0.5 * eps[1, 1], eps[0, 1], 0.5 * chi[0, 0], 0.5 * chi[1, 1], chi[0, 1]],
                           (measure.shape[1], 1))  # fmt: skip
    np.testing.assert_allclose(found[:, :6], uniform, atol=1e-11)
    still = table[0] @ np.hstack([x @ H.T, np.tile([0.4, -0.9], (len(x), 1))]).ravel()
    np.testing.assert_allclose(still[:, 6:], np.tile(Q @ (H[2, :2] + [0.4, -0.9]), (measure.shape[1], 1)), atol=1e-11)


def test_followers_have_a_unit_director_between_those_of_two_walls():
    """A quarter of that of a flat wall, three of one that leans by 50 degrees."""
    c, s = np.cos(np.radians(50.0)), np.sin(np.radians(50.0))
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    lean = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    tie = cf.imported.Tie(nodes=np.array([4]), others=np.array([[1, 8]]), weights=np.array([[0.25, 0.75]]))
    mesh = cf.imported.MeshData(kind="quad", points=np.vstack([square, square + 3.0, square @ lean]),
                    cells=np.arange(12).reshape(3, 4), attachments=cf.imported.Attachments(glued=(tie,)))  # fmt: skip
    expected = np.array([-0.75 * s, 0.0, 0.25 + 0.75 * c])
    np.testing.assert_allclose(directors(mesh)[4], expected / np.linalg.norm(expected), atol=1e-14)


@pytest.mark.parametrize("chunk", [1, 40, 10**6])
def test_sums_of_many_batches_are_those_of_one(chunk, monkeypatch):
    """Cells far from each other, so that sums of unlike size are left to the end; then all of them once more."""
    monkeypatch.setattr(summing, "CHUNK", chunk)
    cells = np.concatenate([np.arange(22).reshape(11, 2), [[0, 5]], np.arange(4, 14).reshape(5, 2)])
    rows = cell_dofs(cells, 2)
    matrices = RNG.standard_normal((len(cells), 4, 4))
    expected = np.zeros((44, 44))
    for row, matrix in zip(rows, matrices, strict=True):
        expected[np.ix_(row, row)] += matrix
    found = scatter(matrices, rows, 44)
    assert isinstance(found, csc_array)
    np.testing.assert_allclose(found.toarray(), expected, atol=1e-14)
