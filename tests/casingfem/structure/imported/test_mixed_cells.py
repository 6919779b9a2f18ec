"""Meshes of several kinds: wedges, pyramids, tetrahedra among bricks, linear or quadratic; triangles among squares."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.cells.mapped import facet_shape_products, mapped
from casingfem.structure.imported.loads import nodal_loads
from casingfem.structure.imported.mesh.cell_kind import KINDS
from casingfem.structure.imported.mesh.collapsed import mirror, native, right_handed, written_as
from casingfem.structure.imported.readers.draft import Block, Draft, build

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
WEDGES = ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))  # of a brick
BASES = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))  # of pyramids in it
QUIET = ("mesh-linear-cells", "mesh-thin-curved")
pytestmark = [pytest.mark.filterwarnings(f"ignore:.*{code}") for code in QUIET]


def mixed(counts, *, bend=0.0):
    """A bar of 1 x 0.2 x 0.1 m: wedges at its root, bricks, then pyramids, the lowest of them cut to tetrahedra."""

    def place(u):
        return (u + bend * np.sin(7.0 * u[:, [1, 2, 0]]) * u * (1.0 - u)) * [1.0, 0.2, 0.1]

    bricks = cf.imported.grid_mesh("hexahedron", counts, place, groups={"root": (0, 0.0)})
    middle = bricks.points[bricks.cells].mean(axis=1)
    first, last = middle[:, 0] < 1.0 / counts[0], middle[:, 0] > 1.0 - 1.0 / counts[0]
    points = np.vstack([bricks.points, middle[last]])
    apex = len(bricks.points) + np.arange(np.count_nonzero(last))
    pyramids = np.concatenate([np.column_stack([bricks.cells[last][:, list(base)], apex]) for base in BASES])
    low = points[pyramids[:, :4], 2].max(axis=1) < 1e-12
    parts = {
        "hexahedron": bricks.cells[~first & ~last],
        "wedge": np.concatenate([bricks.cells[first][:, list(wedge)] for wedge in WEDGES]),
        "pyramid": pyramids[~low],
        "tetra": np.concatenate([pyramids[low][:, [0, 1, 2, 4]], pyramids[low][:, [0, 2, 3, 4]]]),
    }
    starts = np.cumsum([1, *(len(cells) for cells in parts.values())])
    blocks = [Block(k, cells, s + np.arange(len(cells))) for (k, cells), s in zip(parts.items(), starts, strict=False)]
    root = {"root": bricks.groups["root"].nodes}
    numbers = np.arange(1, len(points) + 1)
    return build(Draft(points=points, node_numbers=numbers, blocks=blocks, node_sets=root), "mixed"), bricks


def test_constant_strains_are_exact_through_all_kinds():
    """K u of a linear field is zero at inner nodes; energy and mass are those of the volume."""
    mesh, _ = mixed((4, 2, 2), bend=0.15)
    system = cf.Solid(mesh=mesh, material=STEEL).assembled()
    slope = np.random.default_rng(4).normal(size=(3, 3))
    u = (mesh.points @ slope.T).ravel()
    force = (system.K @ u).reshape(-1, 3)
    inner = np.setdiff1d(mesh.used, mesh.facet_nodes(mesh.boundary))
    assert len(inner) == 3 + 4  # of the grid, and the pyramids' common corners
    assert np.abs(force[inner]).max() < 1e-9 * np.abs(force).max()
    eps, mu, lam = 0.5 * (slope + slope.T), 210e9 / 2.6, 210e9 * 0.3 / (1.3 * 0.4)
    along = np.tile([1.0, 0.0, 0.0], len(mesh.points))
    volume = along @ system.M @ along / 7800.0
    assert u @ force.ravel() == pytest.approx(volume * (2.0 * mu * np.sum(eps**2) + lam * np.trace(eps) ** 2), rel=1e-6)
    assert volume == pytest.approx(0.02, rel=1e-3)  # bent faces of wedges are no longer those of bricks


def test_facets_of_collapsed_cells_are_squares_and_triangles():
    mesh, bricks = mixed((4, 2, 2))
    assert repr(mesh).startswith("MeshData(mixed: 42 hexahedron, 34 of them collapsed, 49 nodes")
    faces = mesh.facet_nodes(mesh.boundary)
    assert mapped("quad", mesh.points, faces).measure.sum() == pytest.approx(2.0 * (0.2 + 0.1 + 0.02), rel=1e-12)
    assert len(mesh.group_facets("root")) == len(bricks.group_facets("root")) == 4
    below = np.flatnonzero(mesh.points[:, 2] < 1e-12)
    corners = np.array([len(set(face)) for face in faces.tolist() if np.isin(face, below).all()])
    assert sorted(corners) == [3] * 8 + [4] * 4  # of four wedges and four tetrahedra; of bricks


def test_collapsed_bricks_are_tetrahedra():
    """The stiffness to round-off; of the mass, whose quadrature they share with bricks, the sum."""
    tetra = cf.imported.grid_mesh("tetra", (3, 2, 1), lambda u: u * [1.0, 0.2, 0.1])
    bricks = replace(tetra, kind="hexahedron", cells=written_as("hexahedron", "tetra", tetra.cells, tetra.points))
    own, collapsed = (cf.Solid(mesh=mesh, material=STEEL).assembled() for mesh in (tetra, bricks))
    assert abs(own.K - collapsed.K).max() < 1e-12 * abs(own.K).max()
    assert collapsed.M.sum() == pytest.approx(own.M.sum(), rel=1e-12)


@pytest.mark.parametrize("kind", ["tetra", "tetra10", "hexahedron", "hexahedron20", "hexahedron27"])
def test_cells_numbered_the_other_way_round_are_mirrored(kind):
    """Which nodes a cell has stays; its volume turns; and what is right-handed is left."""
    mesh = cf.imported.grid_mesh(kind, (2, 1, 1), lambda u: u * [1.0, 0.2, 0.1])
    turned = mesh.cells[:, mirror(kind)]
    assert np.array_equal(np.sort(turned, axis=1), np.sort(mesh.cells, axis=1))
    volumes = [mapped(kind, mesh.points, cells).measure.sum(axis=1) for cells in (turned, mesh.cells)]
    np.testing.assert_allclose(volumes[0], -volumes[1], rtol=1e-12)
    assert np.array_equal(right_handed(kind, turned, mesh.points), mesh.cells)
    assert np.array_equal(right_handed(kind, mesh.cells, mesh.points), mesh.cells)


def test_a_mixed_bar_is_stressed_alike_everywhere():
    """Stress at nodes of cells of every kind, of a bar pulled evenly."""
    mesh, _ = mixed((8, 2, 2))
    axial = cf.Material(E=210e9, nu=0.0, rho=7800.0)
    solid = cf.Solid(mesh=mesh, material=axial, supports={"root": cf.Clamped()})
    system = solid.assembled()
    pulled = np.zeros((len(mesh.points), 3))
    pulled[:, 0] = 1e-3 * mesh.points[:, 0]
    for node in range(0, len(mesh.points), 5):
        row = cf.modal.NodeStress(name="s", node=int(mesh.node_numbers[node]), component="xx").row(system)
        assert np.sum(row * pulled) == pytest.approx(210e6, rel=1e-6)


def plate(thirds, count):
    """A square plate of 0.4 m, clamped along one side, `thirds` of its squares cut to two triangles each."""
    side = {"base": (0, 0.0)}
    squares = cf.imported.grid_mesh("quad", (count, count), lambda u: np.insert(0.4 * u, 2, 0.0, axis=1), groups=side)
    cut = np.arange(len(squares.cells)) % 3 < thirds
    halves = np.concatenate([squares.cells[cut][:, [0, 1, 2]], squares.cells[cut][:, [0, 2, 3]]])
    parts = {"quad": squares.cells[~cut], "triangle": halves}
    blocks = [
        Block(k, cells, 1000 * j + np.arange(len(cells))) for j, (k, cells) in enumerate(parts.items()) if cells.size
    ]
    numbers, base = np.arange(1, len(squares.points) + 1), {"base": squares.groups["base"].nodes}
    mesh = build(Draft(points=squares.points, node_numbers=numbers, blocks=blocks, node_sets=base), "plate")
    return cf.MeshShell(mesh=mesh, thickness=4e-3, material=STEEL, supports={"base": cf.Clamped()})


@pytest.mark.slow
def test_a_cantilevered_plate_of_squares_and_triangles_converges():
    """Towards Kirchhoff's plate: A. Leissa, J. Sound Vib. 31, 1973, 257, table C17, bounds from above by 0.6 %."""
    leissa = np.array([3.4917, 8.5246, 21.429, 27.331, 31.111])
    unit = np.sqrt(210e9 * 4e-3**3 / (12.0 * 0.91) / (7800.0 * 4e-3)) / (2.0 * np.pi * 0.4**2)
    for thirds in (1, 3):
        coarse, fine = (cf.modes(plate(thirds, count), 5).freq / unit / leissa - 0.994 for count in (8, 16))
        assert np.all(np.abs(fine) < 0.04)
        assert np.abs(fine[3:]).max() < 0.4 * np.abs(coarse[3:]).max()


def test_cells_that_collapse_to_nothing_and_kinds_that_do_not_mix_are_refused():
    mesh, _ = mixed((2, 1, 1))
    flat = mesh.cells.copy()
    flat[0] = flat[0][[0, 1, 2, 2, 0, 1, 2, 2]]
    with pytest.raises(cf.errors.ModelError, match="a node twice"):
        cf.Solid(mesh=replace(mesh, cells=flat), material=STEEL)
    bricks = cf.imported.grid_mesh("hexahedron20", (1, 1, 1), lambda u: u)
    folded = bricks.cells.copy()
    folded[0, 8:] = folded[0, 0]
    with pytest.raises(cf.errors.ModelError, match=r"1 cell .* that contain a node twice"):
        cf.Solid(mesh=replace(bricks, cells=folded), material=STEEL)
    points = np.random.default_rng(1).normal(size=(25, 3))
    kinds = {"quad8": 8, "quad9": 9}
    blocks = [Block(kind, np.arange(n)[None], np.array([n])) for kind, n in kinds.items()]
    with pytest.raises(cf.errors.ModelError, match=r"1 quad8, 1 quad9; .*mesh-mixed-cells"):
        build(Draft(points=points, node_numbers=np.arange(25), blocks=blocks), "part")


def quadratic(counts, *, bend=0.0, left_out=()):
    """The bar of `mixed` with middle nodes, its edges bent; edges (by half their length along x) without middles."""
    linear, _ = mixed(counts)
    points, blocks, number = list(linear.points), [], 1
    middles = {}
    for name, rows, slots in native("hexahedron20", linear.cells[:, [*range(8), *[0] * 12]]):
        cells = linear.cells[rows][:, slots[: len(KINDS[name].corners)]]
        ends = np.sort(cells[:, np.array(KINDS[name].edges)], axis=2)
        for edge in map(tuple, ends.reshape(-1, 2).tolist()):
            if edge not in middles:
                middle = linear.points[list(edge)].mean(axis=0)
                out = any(low <= middle[0] < high for low, high in left_out)
                middles[edge] = -1 if out else len(points)
                points += [] if out else [middle]
        places = np.array([[middles[tuple(edge)] for edge in cell] for cell in ends.tolist()])
        blocks.append(Block(name, np.hstack([cells, places]), number + np.arange(len(cells))))
        number += len(cells)
    x = np.array(points)
    u = x / [1.0, 0.2, 0.1]
    x = x + bend * np.sin(7.0 * u[:, [1, 2, 0]]) * u * (1.0 - u) * [1.0, 0.2, 0.1]
    root = {"root": np.flatnonzero(np.abs(x[:, 0]) < 1e-9)}
    return build(Draft(points=x, node_numbers=np.arange(1, len(x) + 1), blocks=blocks, node_sets=root), "mixed")


@pytest.mark.slow
def test_constant_strains_are_exact_through_all_quadratic_kinds():
    """As above, with bent edges; a node load and a stress know what the cells are."""
    mesh = quadratic((4, 2, 2), bend=0.05)
    assert repr(mesh).startswith("MeshData(mixed: 42 hexahedron20, 34 of them collapsed, 185 nodes")
    solid = cf.Solid(mesh=mesh, material=STEEL)
    system = solid.assembled()
    slope = np.random.default_rng(4).normal(size=(3, 3))
    field = mesh.points @ slope.T
    force = (system.K @ field.ravel()).reshape(-1, 3)
    inner = np.setdiff1d(mesh.used, mesh.facet_nodes(mesh.boundary))
    assert len(inner) == 57
    assert np.abs(force[inner]).max() < 1e-12 * np.abs(force).max()
    eps, mu, lam = 0.5 * (slope + slope.T), 210e9 / 2.6, 210e9 * 0.3 / (1.3 * 0.4)
    volume = system.M.sum() / 3.0 / 7800.0
    energy = volume * (2.0 * mu * np.sum(eps**2) + lam * np.trace(eps) ** 2)
    assert np.sum(field * force) == pytest.approx(energy, rel=1e-12)
    assert volume == pytest.approx(0.02, rel=1e-12)
    stress = 2.0 * mu * eps + lam * np.trace(eps) * np.eye(3)
    for node in range(0, len(mesh.points), 9):
        row = cf.modal.NodeStress(name="s", node=int(mesh.node_numbers[node]), component="xy").row(system)
        assert np.sum(row * field) == pytest.approx(stress[0, 1], rel=1e-4)
    weight = cf.loads.Gravity(acceleration=(0.0, 0.0, -9.81))
    assert nodal_loads(solid, weight)[:, 2].sum() == pytest.approx(-9.81 * 7800.0 * volume, rel=1e-12)


@pytest.mark.parametrize("omega", [0.0, pytest.param(300.0, marks=pytest.mark.slow)])
def test_all_quadratic_kinds_swing_like_bricks_alone(omega):
    """Modes at rest and at speed against a mesh of bricks as fine: 0.5 % at the worst."""
    spin = cf.Rotation(omega=omega, axis=(0.0, 0.0, 1.0), centre=(-0.5, 0.0, 0.0)) if omega else None
    bricks = cf.imported.grid_mesh("hexahedron20", (4, 2, 2), lambda u: u * [1.0, 0.2, 0.1], groups={"root": (0, 0.0)})
    found, exact = (
        cf.modes(cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.Clamped()}, rotation=spin), 5).freq
        for mesh in (quadratic((4, 2, 2)), bricks)
    )
    np.testing.assert_allclose(found, exact, rtol=6e-3)
    assert np.abs(found / exact - 1.0).max() > 1e-4


@pytest.mark.slow
def test_facets_of_quadratic_kinds_have_pressures_and_foundations():
    """The pressure on the whole skin adds up to nothing, and its moment of places to the volume."""
    mesh = quadratic((3, 1, 2), bend=0.04)
    skin = replace(
        mesh, groups={"skin": cf.imported.Group(nodes=mesh.facet_nodes(mesh.boundary).ravel(), facets=mesh.boundary)}
    )
    solid = cf.Solid(mesh=skin, material=STEEL)
    force = nodal_loads(solid, cf.imported.FacetPressure(group="skin", pressure=3.0))
    assert np.abs(force.sum(axis=0)).max() < 1e-14
    volume = solid.assembled().M.sum() / 3.0 / 7800.0
    assert np.sum(force * mesh.points) == pytest.approx(-3.0 * 3.0 * volume, rel=1e-12)
    on = cf.Solid(mesh=skin, material=STEEL, supports={"skin": cf.ElasticEdge(k_face=1e9)})
    springs = on.assembled().K - solid.assembled().K
    area = facet_shape_products(mesh, mesh.boundary)[2].sum()
    assert springs.sum() == pytest.approx(3.0 * 1e9 * area, rel=1e-9)


def test_linear_cells_among_quadratic_ones_stay_joined_to_them():
    """Half of a bar linear, half quadratic: neighbours share middle nodes, linear motions are exact."""
    bricks = cf.imported.grid_mesh("hexahedron20", (2, 1, 1), lambda u: u * [1.0, 0.2, 0.1], groups={"root": (0, 0.0)})
    blocks = [Block("hexahedron20", bricks.cells[:1], np.array([1])),
              Block("hexahedron", bricks.cells[1:, :8], np.array([2]))]  # fmt: skip
    numbers = np.arange(1, len(bricks.points) + 1)
    mesh = build(Draft(points=bricks.points, node_numbers=numbers, blocks=blocks), "part")
    (tie,) = mesh.attachments.glued
    assert len(tie.nodes) == 8  # of twelve edges four are the other brick's
    with pytest.warns(cf.errors.ModelWarning, match="mesh-orphan-nodes"):
        solid = cf.Solid(mesh=mesh, material=STEEL)
    system = solid.assembled()
    assert system.rigid == 6
    field = (mesh.points @ np.random.default_rng(6).normal(size=(3, 3)))[:, :, None]
    field[np.setdiff1d(np.arange(len(field)), mesh.present)] = 0.0
    free = system.collect(field)
    np.testing.assert_allclose(system.expand(free), field, atol=1e-12)
    whole = cf.Solid(mesh=bricks, material=STEEL).assembled()
    energy = [float(u @ (s.K @ u)) for u, s in ((free[:, 0], system), (whole.collect(linear(bricks))[:, 0], whole))]
    assert energy[0] == pytest.approx(energy[1], rel=1e-10)


def linear(mesh):
    """The same linear motion on a mesh of nothing but bricks."""
    return (mesh.points @ np.random.default_rng(6).normal(size=(3, 3)))[:, :, None]


@pytest.mark.slow
def test_middle_nodes_that_are_left_out_move_as_the_mean_of_their_ends():
    """All of them out: the linear cells themselves, to round-off. Some of them out: constant strains stay exact."""
    bricks = cf.imported.grid_mesh("hexahedron", (2, 1, 1), lambda u: u * [1.0, 0.2, 0.1])
    wedges = np.array([bricks.cells[0][list(wedge)] for wedge in WEDGES])
    values = []
    for kinds, middles in ((("wedge15", "hexahedron20"), (9, 12)), (("wedge", "hexahedron"), (0, 0))):
        blocks = [
            Block(kind, np.hstack([cells, np.full((len(cells), count), -1)]), number + np.arange(len(cells)))
            for kind, cells, count, number in zip(kinds, (wedges, bricks.cells[1:]), middles, (1, 3), strict=True)
        ]
        mesh = build(Draft(points=bricks.points, node_numbers=np.arange(1, 13), blocks=blocks), "part")
        K = cf.Solid(mesh=mesh, material=STEEL).assembled().K.toarray()
        values.append(np.linalg.eigvalsh(K)[6:])
    np.testing.assert_allclose(values[0], values[1], rtol=1e-9)
    some = quadratic((4, 1, 2), left_out=((0.3, 0.6),))
    (tie,) = some.attachments.glued
    assert 5 < len(tie.nodes) < 40
    assert not some.node_numbers[tie.nodes].any()
    system = cf.Solid(mesh=some, material=STEEL).assembled()
    assert system.rigid == 6
    field = (some.points @ np.random.default_rng(5).normal(size=(3, 3)))[:, :, None]
    free = system.collect(field)
    np.testing.assert_allclose(system.expand(free), field, atol=1e-12)
    inner = np.ones(len(some.points), dtype=bool)
    inner[some.facet_nodes(some.boundary)] = False
    forces = system.K @ free
    driven = system.restrict(np.broadcast_to(~inner[:, None, None], field.shape).astype(float))
    assert np.abs(forces[driven == 0.0]).max() < 1e-10 * np.abs(forces).max()


INP = """*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
9, 2., 0., 0.
10, 2., 0., 1.
*ELEMENT, TYPE=C3D8
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D6, ELSET=END
2, 2, 9, 3, 6, 10, 7
*SURFACE, NAME=TOP
1, S2
END, S2
"""


@pytest.mark.parametrize("nodes", ["2, 9, 3, 6, 10, 7", "6, 10, 7, 2, 9, 3"])
def test_bricks_and_wedges_of_an_input_file(nodes, tmp_path):
    """Wedges either way up, and surfaces with faces of both kinds."""
    path = tmp_path / "part.inp"
    text = INP.replace("2, 2, 9, 3, 6, 10, 7", f"2, {nodes}")
    path.write_text(text if nodes[0] == "2" else text.replace("END, S2", "END, S1"))
    mesh = cf.read_mesh(path)
    assert mesh.collapsed.tolist() == [False, True]
    faces = mesh.facet_nodes(mesh.groups["TOP"].facets)
    assert mapped("quad", mesh.points, faces).measure.sum(axis=1) == pytest.approx([1.0, 0.5])
    system = cf.Solid(mesh=mesh, material=STEEL).assembled()
    assert system.M.sum() / 3.0 == pytest.approx(1.5 * 7800.0, rel=1e-12)
