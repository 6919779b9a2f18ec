"""Facets of imported parts seen as a tip or a rim: areas, normals, pieces and harmonics of boxes and rings, by hand."""

from itertools import pairwise

import numpy as np
import pytest

import casingfem as cf
from casingfem.modal.interface.mesh_rows import facets_of, node_places, node_rows, rim_rows, tip_frame, tip_rows
from casingfem.structure.geometry.rotation import axis_frame

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
GROUPS = {"root": (0, 0.0), "tip": (0, 1.0), "side": (1, 1.0), "top": (2, 1.0)}
SPAN = np.array([2.0, 1.0, 2.0]) / 3.0
CHORD = np.array([-2.0, 2.0, 1.0]) / 3.0
FLAP = np.cross(SPAN, CHORD)
LENGTHS = (2.0, 0.6, 0.2)  # along span, chord, and flap


def box(kind="hexahedron20", counts=(1, 3, 1), groups=GROUPS):
    """A box along three oblique axes."""
    axes = np.array([SPAN, CHORD, FLAP]) * np.array(LENGTHS)[:, None]
    mesh = cf.imported.grid_mesh(kind, counts, lambda u: u @ axes + [0.1, 0.2, 0.3], groups=groups)
    return cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.Clamped()}).assembled()


def sheet(flip=False, counts=(2, 3)):
    """The same without its thickness; `flip` turns the surface over."""

    def place(u):
        across = 1.0 - u[:, 1] if flip else u[:, 1]
        return np.outer(u[:, 0] * 2.0, SPAN) + np.outer(across * 0.6, CHORD) + [0.1, 0.2, 0.3]

    mesh = cf.imported.grid_mesh("quad9", counts, place, groups={"root": (0, 0.0), "tip": (0, 1.0), "side": (1, 1.0)})
    return cf.MeshShell(mesh=mesh, thickness=0.01, material=STEEL, supports={"root": cf.Clamped()}).assembled()


@pytest.mark.parametrize("kind", ["hexahedron20", "hexahedron27", "tetra10"])
def test_an_end_face_has_its_area_its_moments_and_its_normal(kind):
    system = box(kind)
    facets = facets_of(system, "tip")
    assert facets.weight.sum() == pytest.approx(0.12, rel=1e-12)
    np.testing.assert_allclose(facets.outward, np.tile(SPAN, (len(facets.x), 1)), atol=1e-12)
    along = (facets.x - [0.1, 0.2, 0.3]) @ CHORD
    np.testing.assert_allclose([facets.weight @ along**k for k in (1, 2)], [0.12 * 0.3, 0.12 * 0.36 / 3.0], rtol=1e-10)
    points = system.points[facets.nodes]
    np.testing.assert_allclose(np.einsum("qk,qkc->qc", facets.values, points), facets.x, atol=1e-12)
    sums = facets.sums(np.stack([np.ones_like(along), along]), len(points := system.points))
    np.testing.assert_allclose(sums @ np.ones(len(points)), [0.12, 0.12 * 0.3], rtol=1e-10)
    np.testing.assert_allclose(facets_of(system, "root").outward[0], -SPAN, atol=1e-12)


@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize(
    ("group", "length", "normal"), [("tip", 0.6, SPAN), ("root", 0.6, -SPAN), ("side", 2.0, CHORD)]
)
def test_an_edge_of_a_shell_looks_outwards_in_its_surface(flip, group, length, normal):
    facets = facets_of(sheet(flip), group)
    assert facets.weight.sum() == pytest.approx(length, rel=1e-12)
    sign = -1.0 if flip and group == "side" else 1.0
    np.testing.assert_allclose(facets.outward, np.tile(sign * normal, (len(facets.x), 1)), atol=1e-12)


def test_a_tip_of_a_solid_has_its_chord_along_its_longest_side_and_positive():
    """CHORD's first two components are equal in size: a box along its negative has the same axes."""
    system = box()
    frame = tip_frame(system, facets_of(system, "tip"), "tip")
    chord = frame[2]
    assert abs(chord @ CHORD) == pytest.approx(1.0, rel=1e-12)
    assert chord[np.abs(chord).argmax()] > 0.0
    np.testing.assert_allclose(frame[0], SPAN, atol=1e-12)
    np.testing.assert_allclose(frame[1], np.cross(SPAN, chord), atol=1e-12)
    np.testing.assert_allclose(np.cross(chord, frame[1]), SPAN, atol=1e-12)


@pytest.mark.parametrize("flip", [False, True])
def test_a_tip_of_a_shell_flaps_along_its_surface_normal(flip):
    system = sheet(flip)
    span, flap, chord = tip_frame(system, facets_of(system, "tip"), "tip")
    normal = np.cross(SPAN, CHORD) * (-1.0 if flip else 1.0)
    np.testing.assert_allclose(span, SPAN, atol=1e-12)
    np.testing.assert_allclose(flap, normal, atol=1e-12)
    np.testing.assert_allclose(chord, np.cross(flap, span) * np.sign(np.cross(flap, span) @ chord), atol=1e-12)
    np.testing.assert_allclose(np.cross(chord, flap), span, atol=1e-12)


def test_facets_that_look_to_all_sides_are_no_tip():
    """Both ends of a box, one of them by a part of its area: half the area must be left."""
    mesh_groups = {"all": (0, 1.0)} | GROUPS
    system = box(groups=mesh_groups)
    facets = facets_of(system, "tip")
    other = facets_of(system, "root")
    both = facets._replace(**{k: np.concatenate([getattr(facets, k), getattr(other, k)]) for k in facets._fields})
    with pytest.raises(cf.errors.ModelError, match="the facets of 'ends' point to all sides"):
        tip_frame(system, both, "ends")
    less, more = (both._replace(weight=np.concatenate([s * facets.weight, other.weight])) for s in (0.333, 0.334))
    np.testing.assert_allclose(tip_frame(system, less, "ends")[0], -SPAN, atol=1e-12)  # (1 - s)/(1 + s) of .5 at 1/3
    with pytest.raises(cf.errors.ModelError, match="point to all sides"):
        tip_frame(system, more, "ends")


def motion(system):
    """A displacement that is quadratic along the chord, of which the pieces have exact means."""
    y = (system.points - [0.1, 0.2, 0.3]) @ CHORD
    return np.stack([1.0 + y, y**2, 3.0 * y], axis=1), lambda a, b: np.array(
        [1.0 + 0.5 * (a + b), (a * a + a * b + b * b) / 3.0, 1.5 * (a + b)]
    )


@pytest.mark.parametrize("make", [box, sheet])
def test_pieces_of_a_tip_have_the_means_of_their_parts(make):
    system = make()
    field, mean = motion(system)
    rows, frame = tip_rows(system, cf.TipNodes("tip", 3))
    found = np.einsum("knc,nc->k", rows, field).reshape(3, 3)
    ends = np.linspace(0.0, 0.6, 4) if frame[2] @ CHORD > 0.0 else np.linspace(0.6, 0.0, 4)
    expected = [frame @ mean(a, b) for a, b in pairwise(ends)]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
    whole, _ = tip_rows(system, cf.Tip("tip"))
    np.testing.assert_allclose(np.einsum("knc,nc->k", whole, field), frame[:2] @ mean(0.0, 0.6), rtol=1e-9)


@pytest.mark.parametrize("count", [0, 101])
def test_a_tip_has_one_to_a_hundred_pieces(count):
    with pytest.raises(cf.errors.ModelError, match=f"TipNodes.count must lie between 1 and 100, found {count}"):
        tip_rows(box(), cf.TipNodes("tip", count))


def test_a_piece_without_a_facet_is_named():
    """Five points along the chord of one cell: of a hundred pieces the first one that holds none."""
    with pytest.raises(cf.errors.ModelError, match=r"TipNodes: piece \d+ of 100 on 'tip' has no facet"):
        tip_rows(box(counts=(1, 1, 1)), cf.TipNodes("tip", 100))


AXIS = (0.0, 0.6, 0.8)
CENTRE = np.array([0.3, -0.1, 0.2])


def ring(count=24, radius=lambda theta: 0.5 + 0.0 * theta, part=1.0):
    """A ring about an oblique axis; by its angle from the first of the axes that the rows name."""
    e1, e2, a = axis_frame(AXIS)

    def place(u):
        theta = 2.0 * np.pi * part * u[:, 0]
        r = radius(theta)
        plane = np.outer(r * np.cos(theta), e1) + np.outer(r * np.sin(theta), e2)
        return CENTRE + plane + np.outer(0.2 * u[:, 1] - 0.05, a)

    mesh = cf.imported.grid_mesh(
        "quad9", (count, 1), place, groups={"base": (1, 0.0), "top": (1, 1.0)}, wrap=0 if part == 1.0 else None
    )
    return cf.MeshShell(mesh=mesh, thickness=0.01, material=STEEL, supports={"base": cf.Clamped()}).assembled(), (
        e1,
        e2,
        a,
    )


def test_a_rim_about_any_axis_reads_waves_along_its_radius_its_angle_and_its_axis():
    system, (e1, e2, a) = ring()
    view = rim_rows(system, cf.Rim("top", n_max=3, axial=True, axis=AXIS, point=tuple(CENTRE)))
    x = system.points - CENTRE
    theta = np.arctan2(x @ e2, x @ e1)
    c, s = np.cos(theta)[:, None], np.sin(theta)[:, None]
    radial, hoop, axial = (
        0.5 + 2.0 * np.cos(3 * theta),
        3.0 * np.sin(theta),
        -0.7 * np.sin(2 * theta) + 0.2 * np.cos(theta),
    )
    field = radial[:, None] * (c * e1 + s * e2) + hoop[:, None] * (c * e2 - s * e1) + axial[:, None] * a
    found = np.einsum("knc,nc->k", view.rows, field).reshape(3, 7)  # cos0 .. cos3, sin1 .. sin3
    expected = np.zeros((3, 7))
    expected[0, [0, 3]], expected[1, 4], expected[2, [5, 1]] = (0.5, 2.0), 3.0, (-0.7, 0.2)
    np.testing.assert_allclose(found, expected, atol=2e-3)
    np.testing.assert_allclose(view.line, [[0.15, 0.5]], rtol=1e-3)
    np.testing.assert_allclose(view.axes, [e1, e2, a], atol=1e-14)
    assert view.shape.shape == (1, 7)
    assert np.abs(view.shape[0, 1:]).max() < 1e-4
    assert view.shape[0, 0] == 0.0
    two = rim_rows(system, cf.Rim("top", n_max=3, axis=AXIS, point=tuple(CENTRE)))
    np.testing.assert_array_equal(two.rows, view.rows[:14])


def test_a_rim_knows_the_harmonics_of_its_radius():
    system, _ = ring(radius=lambda theta: 0.5 + 4e-3 * np.cos(2 * theta) - 3e-3 * np.sin(3 * theta))
    view = rim_rows(system, cf.Rim("top", n_max=3, axis=AXIS, point=tuple(CENTRE)))
    np.testing.assert_allclose(view.shape[0], [0.0, 0.0, 4e-3, 0.0, 0.0, 0.0, -3e-3], atol=5e-5)


@pytest.mark.parametrize("n_max", [0, 17])
def test_a_rim_has_as_many_harmonics_as_a_third_of_its_nodes(n_max):
    system, _ = ring()
    with pytest.raises(cf.errors.ModelError, match=f"rim.n_max must lie between 1 and 16 on 'top', found {n_max}"):
        rim_rows(system, cf.Rim("top", n_max=n_max, axis=AXIS, point=tuple(CENTRE)))
    assert rim_rows(system, cf.Rim("top", n_max=16, axis=AXIS, point=tuple(CENTRE))).rows.shape == (66, 144, 3)


@pytest.mark.parametrize(("part", "gap"), [(0.9, "37"), (0.5, "181")])
def test_a_rim_with_a_gap_is_refused(part, gap):
    """To the nearest points of quadrature, half a degree from either end."""
    system, _ = ring(part=part)
    with pytest.raises(
        cf.errors.ModelError, match=rf"needs facets all around its axis, 'top' has a gap of {gap} degrees"
    ):
        rim_rows(system, cf.Rim("top", n_max=3, axis=AXIS, point=tuple(CENTRE)))


def test_lines_of_a_rim_need_a_chart():
    with pytest.raises(cf.errors.ModelError, match="on an imported mesh, expected a group"):
        rim_rows(ring()[0], cf.Rim("top", n_max=3, lines=(0.1,)))


def test_nodes_are_read_along_x_y_and_z_in_the_order_asked_for():
    system = box(counts=(1, 1, 1))
    mesh = system.structure.mesh
    tip = mesh.groups["tip"].nodes
    numbers = tuple(mesh.node_numbers[tip[[3, 0]]].tolist())
    assert node_places(system, numbers).tolist() == tip[[3, 0]].tolist()
    rows = node_rows(system, cf.modal.AtNodes(numbers))
    field = np.random.default_rng(3).standard_normal((len(system.points), 3))
    np.testing.assert_array_equal(np.einsum("knc,nc->k", rows, field), field[tip[[3, 0]]].ravel())


@pytest.mark.parametrize(
    ("twist", "words"),
    [((1, 1), "expected each once"), ((), "expected each once"), ((1, 10**6), "node 1000000 that no cell has")],
)
def test_nodes_that_are_not_there_or_twice_are_refused(twist, words):
    with pytest.raises(cf.errors.ModelError, match=words):
        node_places(box(counts=(1, 1, 1)), twist)


def test_a_node_that_is_held_cannot_be_pushed():
    system = box(counts=(1, 1, 1))
    mesh = system.structure.mesh
    number = int(mesh.node_numbers[mesh.groups["root"].nodes[0]])
    with pytest.raises(cf.errors.ModelError, match=f"node {number} is held, nothing can be pushed there"):
        node_rows(system, cf.modal.AtNodes((number,)))


def test_a_curved_tip_has_its_chord_square_to_its_mean_normal():
    """From end to end of the face x = 2 + .1 y^3 the mean normal is that of the straight line."""

    def place(u):
        return np.stack([u[:, 0] * (2.0 + 0.1 * u[:, 1] ** 3), 0.6 * u[:, 1], 0.2 * u[:, 2]], axis=1)

    mesh = cf.imported.grid_mesh("hexahedron20", (1, 3, 1), place, groups=GROUPS)
    system = cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.Clamped()}).assembled()
    frame = tip_frame(system, facets_of(system, "tip"), "tip")
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(frame[0], np.array([0.6, -0.1, 0.0]) / np.hypot(0.6, 0.1), atol=1e-9)
    np.testing.assert_allclose(frame[2], np.array([0.1, 0.6, 0.0]) / np.hypot(0.6, 0.1), atol=1e-9)
