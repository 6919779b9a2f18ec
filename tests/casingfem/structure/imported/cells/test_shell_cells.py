"""Cells of imported shells: directors, frames, walls, and what rotation adds, against integrals of uniform fields."""

from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.cells.mapped import shape_products
from casingfem.structure.imported.cells.shell import (
    ShellCells,
    consistent_mass,
    directors,
    five_dofs,
    tangent_frames,
    wall_stiffness,
)
from casingfem.structure.imported.cells.support import by_group
from casingfem.structure.imported.cells.tying import lagrange, linear_weights, local_frame, to_local
from casingfem.structure.imported.mesh.mesh_data import natives
from casingfem.structure.imported.mesh.walls import cell_normals
from casingfem.structure.imported.shell_spin import placed, shell_inertia, sym
from casingfem.structure.shell.wall import curved_wall
from tests.casingfem.structure.imported.parts import STEEL, flat, squares

RNG = np.random.default_rng(9)
TURN = np.linalg.qr(RNG.standard_normal((3, 3)))[0]
TURN *= np.sign(np.linalg.det(TURN))
PLATE = cf.imported.grid_mesh("quad9", (2, 1), lambda u: flat(u * [2.0, 3.0]) @ TURN.T + [1.0, -2.0, 0.5])
FLAT = np.zeros((3, 1, 1))


def wall(**given):
    """What the cells of a shell ask of it; two cells of different walls."""
    walls = np.array([[0.2, 0.1], [3.0, 11.0], [0.2, 0.35], [5.0, 7.0]])
    shell = {"mesh": PLATE, "shear_correction": None, "wall": "curved", "plies": (), "material": STEEL, "fibres": None}
    whole = shell | {"walls": lambda: walls} | given
    made = SimpleNamespace(apart=SimpleNamespace(mesh=whole["mesh"]), **whole)
    made.inertia = partial(ShellCells.inertia, made)
    return made


def test_normals_of_a_turned_plate_and_of_a_triangle():
    np.testing.assert_allclose(cell_normals(PLATE), np.broadcast_to(TURN[:, 2], (2, 9, 3)), atol=1e-13)
    triangle = squares([[0, 0], [1, 0], [1, 1], [0, 0], [0, 1]], [[0, 1, 2, 2]])
    np.testing.assert_allclose(cell_normals(triangle), np.broadcast_to([0.0, 0.0, 1.0], (1, 4, 3)), atol=1e-14)
    six = squares([[0, 0], [2, 0], [2, 2], [1, 0], [2, 1], [1, 1]], [[0, 1, 2, 2, 3, 4, 2, 5]], "quad8")
    assert np.linalg.norm(cell_normals(six)[0], axis=1).tolist() == pytest.approx([1, 1, 0, 1, 1, 1, 0, 1])


@pytest.mark.parametrize(("angle", "followed"), [(40.0, True), (50.0, False)])
def test_tied_nodes_have_the_director_of_the_wall_they_follow_up_to_an_angle(angle, followed):
    """The cosine of 45.6 degrees is 0.7."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    x = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 0], [1 + c, 0, s], [1 + c, 1, s], [1, 1, 0], [9, 9, 9]]
    tie = cf.imported.Tie(
        nodes=np.array([4, 7]), others=np.array([[1, 2], [1, 2]]), weights=np.array([[1.0, 0.0], [0.0, 1.0]])
    )
    mesh = replace(squares(np.zeros((9, 2)), [[0, 1, 2, 3], [4, 5, 6, 7]]), points=np.array(x, dtype=float),
                   attachments=cf.imported.Attachments(glued=(tie,)))  # fmt: skip
    found = directors(mesh)
    own = [0.0, 0.0, 1.0] if followed else [-s, 0.0, c]
    np.testing.assert_allclose(found[[4, 7]], [own, own], atol=1e-14)
    np.testing.assert_allclose(found[[5, 8]], [[-s, 0, c], [0, 0, 1]], atol=1e-14)
    given = RNG.standard_normal((9, 3))
    assert directors(replace(mesh, directors=given)) is given


def test_tangents_are_right_handed_about_the_normal():
    normals = np.array([[0.1, 0.7, np.sqrt(0.5)], [0, 0, 1], [-1, 0, 0], [0.6, 0.0, -0.8], [0.8, 0.6, 0.0]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    frames = tangent_frames(normals)
    np.testing.assert_allclose(np.cross(frames[:, 0], frames[:, 1]), normals, atol=1e-14)
    np.testing.assert_allclose(np.einsum("nac,nbc->nab", frames, frames), np.tile(np.eye(2), (5, 1, 1)), atol=1e-14)
    assert frames[0, 0, 0] == 0.0  # across the axis that is farthest from the normal


def test_scalar_matrices_on_five_dofs():
    """u.B v from the first, u.B w and w.B u from the second, w.B w along the tangents from the third."""
    frames = tangent_frames(np.linalg.qr(RNG.standard_normal((3, 3)))[0])[None]
    moments, B = RNG.standard_normal((3, 1, 3, 3)), RNG.standard_normal((3, 3))
    x, y = RNG.standard_normal((2, 3, 5))
    (u, p), (v, q) = ((one[:, :3], np.einsum("na,nac->nc", one[:, 3:], frames[0])) for one in (x, y))
    forms = ((0, u, v), (1, u, q), (1, p, v), (2, p, q))
    expected = sum(np.einsum("ij,ic,cd,jd->", moments[k, 0], one, B, other) for k, one, other in forms)
    assert x.ravel() @ five_dofs(moments, frames, B)[0] @ y.ravel() == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("given", "factor"), [({}, None), ({"shear_correction": 0.4}, 0.4)])
def test_factors_of_shear_if_none_is_given(given, factor):
    """5/(6 - nu) of curved walls and 5/6 of linear ones."""
    t, E, nu = 0.1, 11.0, 0.35
    for kind, usual in (("curved", 5.0 / (6.0 - nu)), ("linear", 5.0 / 6.0)):
        D = wall_stiffness(wall(wall=kind, **given), np.array([1]), FLAT)[0, 0]
        shear = (usual if factor is None else factor) * E / (2.0 * (1.0 + nu))
        np.testing.assert_allclose(D[6:, 6:], t * shear * np.eye(2), rtol=1e-12)
        plane = E / (1.0 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, 0.5 * (1 - nu)]])
        np.testing.assert_allclose(D[:3, :3], t * plane, rtol=1e-12)
        np.testing.assert_allclose(D[3:6, 3:6], t**3 / 12.0 * plane, rtol=1e-12)
        np.testing.assert_allclose(D[:3, 3:], 0.0, atol=1e-15)
        np.testing.assert_allclose(D[3:6, 6:], 0.0, atol=1e-15)


@pytest.mark.parametrize("b", [(3.0, -1.0, 2.0), (30.0, -10.0, 20.0)])
def test_a_wall_is_bent_no_more_sharply_than_it_is_thick(b):
    """The principal curvatures are 1 -+ sqrt(4 + 4): times .2 the larger is .77, or 7.7, which is taken as 1."""
    sharpest = 0.2 * max(abs(np.linalg.eigvalsh([[b[0], b[2]], [b[2], b[1]]])))
    curvature = np.array(b)[:, None, None] / max(sharpest, 1.0)
    shear = 5.0 / (6.0 - 0.2) * 3.0 / 2.4
    one = np.ones((1, 1))
    expected = np.moveaxis(curved_wall(3.0 * one, 0.2 * one, shear * one, 0.2 * one, curvature), (0, 1), (-2, -1))
    found = wall_stiffness(wall(), np.array([0]), np.array(b)[:, None, None])
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-15)


def test_local_axes_of_slanted_tangents():
    """e_i = D_ia x,a; e1 along x,r, or as near as it can be to a direction."""
    x_r, x_s = np.array([[2.0, 0.5, 0.3]]), np.array([[-0.4, 3.0, 0.7]])
    normal = np.cross(x_r[0], x_s[0]) / np.linalg.norm(np.cross(x_r[0], x_s[0]))
    along = np.array([0.3, -0.2, 1.0])
    for given, wanted in ((None, x_r[0]), (along, along - (along @ normal) * normal)):
        frame, D = local_frame(x_r, x_s, given)
        np.testing.assert_allclose(frame[0, 0], wanted / np.linalg.norm(wanted), atol=1e-14)
        np.testing.assert_allclose(frame[0, 1], np.cross(normal, frame[0, 0]), atol=1e-14)
        np.testing.assert_allclose(D[0] @ np.stack([x_r[0], x_s[0]]), frame[0], atol=1e-14)


def test_covariant_strains_become_those_along_the_axes():
    """eps_ij = D_ia D_jb e_ab with shears doubled, chi alike, gamma_i = D_ia gamma_a."""
    D, eps, chi = RNG.standard_normal((3, 2, 2))
    eps, chi = eps + eps.T, chi + chi.T
    gamma = RNG.standard_normal(2)

    def in_rows(one, other):
        return np.array([one[0, 0], one[1, 1], 2 * one[0, 1], other[0, 0], other[1, 1], 2 * other[0, 1]])

    found = to_local(D[None])[0] @ np.concatenate([in_rows(eps, chi), gamma])
    expected = np.concatenate([in_rows(D @ eps @ D.T, D @ chi @ D.T), D @ gamma])
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13)


def test_weights_of_tying_points_pass_what_they_are_made_for():
    nodes, x = np.array([0.1, 0.4, 0.9]), np.array([0.0, 0.3, 1.0])
    for degree in range(3):
        np.testing.assert_allclose(nodes**degree @ lagrange(nodes, x), x**degree, atol=1e-13)
    assert lagrange(np.array([0.5]), x).tolist() == [[1.0, 1.0, 1.0]]
    places, points = RNG.random((2, 5)), RNG.random((2, 4))
    a, b, c = 0.3, -0.7, 1.1
    weights = linear_weights(places, points)
    np.testing.assert_allclose(
        weights @ (a + b * places[0] + c * places[1]), a + b * points[0] + c * points[1], rtol=1e-9
    )
    bump = np.array([0.0, 0.0, 2.0, -1.0, -1.0])  # without a value at the first two, or a mean of the others
    np.testing.assert_allclose(weights @ bump, 0.0, atol=1e-10)


def test_inertia_of_a_turning_plate():
    """Uniform velocities v, w: m v.w, m v.P w, 2 m v.(a x w); uniform leanings p, q alike with the rotary inertia.

    The softening of leanings is that of arms n + p: (n.a)^2 p.q - (p.a)(q.a).
    """
    a = np.array([2.0, -1.0, 2.0]) / 3.0
    rotation = cf.Rotation(omega=1.0, axis=(2.0, -1.0, 2.0), centre=(0.3, 0.1, -0.2))
    of = shell_inertia(wall(), rotation)
    n, frames = TURN[:, 2], tangent_frames(np.tile(TURN[:, 2], (9, 1)))
    v, w, p, q = RNG.standard_normal((4, 3))
    p, q = p - (p @ n) * n, q - (q @ n) * n
    still = np.zeros((9, 2))
    vw = [np.hstack([np.tile(x, (9, 1)), still]).ravel() for x in (v, w)]
    pq = [np.hstack([np.zeros((9, 3)), np.einsum("nac,c->na", frames, x)]).ravel() for x in (p, q)]
    t, _, _, rho = wall().walls()
    mass, rotary = 3.0 * rho * t, 3.0 * rho * t**3 / 12.0
    normals = np.tile(n, (len(PLATE.points), 1))
    for found, moved, leaning in (
        (consistent_mass(wall(), normals, tangent_frames(normals)), v @ w, p @ q),
        (of.softening, v @ w - (v @ a) * (w @ a), (n @ a) ** 2 * (p @ q) - (p @ a) * (q @ a)),
        (of.gyroscopic, 2.0 * v @ np.cross(a, w), 2.0 * p @ np.cross(a, q)),
    ):
        np.testing.assert_allclose(vw[0] @ found @ vw[1], mass * moved, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(pq[0] @ found @ pq[1], rotary * leaning, rtol=1e-10, atol=1e-13)
        np.testing.assert_allclose(vw[0] @ found @ pq[1], 0.0, atol=1e-13)
    middle = np.array([PLATE.points[cell].mean(axis=0) for cell in PLATE.cells]) - rotation.centre
    np.testing.assert_allclose(of.force @ vw[0], mass * ((middle - np.outer(middle @ a, a)) @ v), rtol=1e-11)
    np.testing.assert_allclose(of.force @ pq[0], -rotary * (n @ a) * (a @ p), rtol=1e-10)


def test_scalar_forms_on_motions_and_directors():
    """uu u.u + 2 uw u.w + ww w.w of each node."""
    uu, uw = RNG.standard_normal((2, 1, 3, 3))
    uu, ww = uu + uu.swapaxes(1, 2), RNG.standard_normal((1, 3))
    e = tangent_frames(np.linalg.qr(RNG.standard_normal((3, 3)))[0])[None]
    x = RNG.standard_normal((3, 5))
    u, w = x[:, :3], np.einsum("na,nac->nc", x[:, 3:], e[0])
    expected = (
        np.einsum("ij,ic,jc->", uu[0], u, u) + 2.0 * np.einsum("ij,ic,jc->", uw[0], u, w) + ww[0] @ (w * w).sum(axis=1)
    )
    assert x.ravel() @ placed(uu, uw, ww, e)[0] @ x.ravel() == pytest.approx(expected, rel=1e-12)
    one, other = RNG.standard_normal((2, 3, 2))
    outer = np.array([np.outer(one[:, t], other[:, t]) for t in range(2)])
    np.testing.assert_array_equal(sym(one, other, twice=False), outer)
    np.testing.assert_array_equal(sym(one, other, twice=True), outer + outer.transpose(0, 2, 1))


def test_products_of_shape_functions_have_the_area_of_the_plate():
    products, size = shape_products(PLATE.points, PLATE.cells, natives(PLATE))
    np.testing.assert_allclose(size, [3.0, 3.0], rtol=1e-13)
    np.testing.assert_allclose(products.sum(axis=(1, 2)), size, rtol=1e-13)


def test_numbers_of_groups_stand_instead_of_the_common_ones():
    mesh = replace(PLATE, groups={"one": cf.imported.Group(nodes=[0], cells=[1]), "none": cf.imported.Group(nodes=[0])})
    assert by_group(mesh, (1.0, 2.0), {"one": (5.0, 7.0)}).tolist() == [[1.0, 5.0], [2.0, 7.0]]
    with pytest.raises(cf.errors.ModelError, match="grid: material of group 'none'"):
        by_group(mesh, (1.0,), {"none": (2.0,)})
    twice = replace(
        mesh, groups={**mesh.groups, "other": cf.imported.Group(nodes=[0], cells=[0, 1])}, cell_numbers=np.array([7, 8])
    )
    with pytest.raises(cf.errors.ModelError, match="grid: cell 8 has the materials of 'one' and 'other'"):
        by_group(twice, (1.0,), {"one": (2.0,), "other": (3.0,)})
