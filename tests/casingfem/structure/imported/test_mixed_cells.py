"""Meshes of several kinds: wedges, pyramids, tetrahedra among bricks, linear or quadratic; triangles among squares."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.structure.imported.bulk_data import EDGES, read
from tests.casingfem.structure.imported.parts import link

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
WEDGES = ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))  # of a brick
BASES = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))  # of pyramids in it
QUIET = ("mesh-linear-cells", "mesh-thin-curved")
pytestmark = [pytest.mark.filterwarnings(f"ignore:.*{code}") for code in QUIET]


def parts_of_bar(counts, *, bend=0.0):
    """A bar of 1 x 0.2 x 0.1 m: wedges at its root, bricks, then pyramids, the lowest of them cut to tetrahedra.

    Points, cells by kind, and nodes of the root; and the bricks.
    """

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
    return points, parts, bricks.groups["root"].nodes, bricks


def with_root(mesh):
    """The grids of SPC 3 as the group "root"."""
    return replace(mesh, groups={"root": mesh.groups["SPC 3"]})


def mixed(folder, counts, **more):
    points, parts, root, _ = parts_of_bar(counts, **more)
    return with_root(read(folder, points, parts.items(), root))


def soft(node):
    """A spring of no weight between node 0 and another, so that the mesh is one part."""
    return (replace(link(0, node), stiffness=1e-3),)


def flat_area(points, faces):
    """Area of each facet by its corners, which are in one plane."""
    a, b, c, d = np.moveaxis(points[faces[:, :4]], 1, 0)
    return 0.5 * np.linalg.norm(np.cross(c - a, d - b), axis=1)


def test_constant_strains_are_exact_through_all_kinds(tmp_path):
    """K u of a linear field is zero at inner nodes; energy and mass are those of the volume."""
    mesh = mixed(tmp_path, (4, 2, 2), bend=0.15)
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


def test_facets_of_collapsed_cells_are_squares_and_triangles(tmp_path):
    mesh, bricks = mixed(tmp_path, (4, 2, 2)), parts_of_bar((4, 2, 2))[3]
    assert repr(mesh).startswith("MeshData(mixed.bdf: 42 hexahedron, 34 of them collapsed, 49 nodes")
    faces = mesh.facet_nodes(mesh.boundary)
    assert flat_area(mesh.points, faces).sum() == pytest.approx(2.0 * (0.2 + 0.1 + 0.02), rel=1e-12)
    assert len(mesh.group_facets("root")) == len(bricks.group_facets("root")) == 4
    below = np.flatnonzero(mesh.points[:, 2] < 1e-12)
    corners = np.array([len(set(face)) for face in faces.tolist() if np.isin(face, below).all()])
    assert sorted(corners) == [3] * 8 + [4] * 4  # of four wedges and four tetrahedra; of bricks


def test_collapsed_bricks_are_tetrahedra(tmp_path):
    """Tetrahedra beside a brick are stored as bricks: their stiffness to round-off, and the sum of their mass."""
    tetra = cf.imported.grid_mesh("tetra", (3, 2, 1), lambda u: u * [1.0, 0.2, 0.1])
    brick = cf.imported.grid_mesh("hexahedron", (1, 1, 1), lambda u: np.add(u, [9.0, 0.0, 0.0]))
    points, n = np.vstack([tetra.points, brick.points]), 3 * len(tetra.points)
    both = read(tmp_path, points, [("tetra", tetra.cells), ("hexahedron", brick.cells + len(tetra.points))])
    both = replace(both, attachments=cf.imported.Attachments(springs=soft(n // 3)))
    assert (both.kind, both.collapsed.sum()) == ("hexahedron", len(tetra.cells))
    own, collapsed = (cf.Solid(mesh=mesh, material=STEEL).assembled() for mesh in (tetra, both))
    assert abs(own.K - collapsed.K[:n, :n]).max() < 1e-12 * abs(own.K).max()
    assert collapsed.M[:n, :n].sum() == pytest.approx(own.M.sum(), rel=1e-12)


@pytest.mark.parametrize("kind", ["tetra", "tetra10", "hexahedron", "hexahedron20"])
def test_cells_numbered_the_other_way_round_are_mirrored(kind, tmp_path):
    """Of a mirrored bar each cell keeps its nodes and has a volume above 0; what is right-handed is left."""
    mesh = cf.imported.grid_mesh(kind, (2, 1, 1), lambda u: u * [1.0, 0.2, 0.1])
    same = read(tmp_path, mesh.points, [(kind, mesh.cells)])
    assert np.array_equal(same.cells, mesh.cells)
    turned = read(tmp_path, mesh.points * [1.0, -1.0, 1.0], [(kind, mesh.cells)])
    assert np.array_equal(np.sort(turned.cells, axis=1), np.sort(mesh.cells, axis=1))
    masses = [cf.Solid(mesh=one, material=STEEL).assembled().M.sum() / 3.0 for one in (turned, mesh)]
    assert masses == pytest.approx([7800.0 * 0.02] * 2, rel=1e-12)
    again = read(tmp_path, turned.points * [1.0, -1.0, 1.0], [(kind, turned.cells)])
    assert np.array_equal(again.cells, mesh.cells)


def test_a_mixed_bar_is_stressed_alike_everywhere(tmp_path):
    """Stress at nodes of cells of every kind, of a bar pulled evenly."""
    mesh = mixed(tmp_path, (8, 2, 2))
    axial = cf.Material(E=210e9, nu=0.0, rho=7800.0)
    solid = cf.Solid(mesh=mesh, material=axial, supports={"root": cf.Clamped()})
    system = solid.assembled()
    pulled = np.zeros((len(mesh.points), 3))
    pulled[:, 0] = 1e-3 * mesh.points[:, 0]
    for node in range(0, len(mesh.points), 5):
        row = cf.modal.NodeStress(name="s", node=int(mesh.node_numbers[node]), component="xx").row(system)
        assert np.sum(row * pulled) == pytest.approx(210e6, rel=1e-6)


def plate(folder, thirds, count):
    """A square plate of 0.4 m, clamped along one side, `thirds` of its squares cut to two triangles each."""
    side = {"base": (0, 0.0)}
    squares = cf.imported.grid_mesh("quad", (count, count), lambda u: np.insert(0.4 * u, 2, 0.0, axis=1), groups=side)
    cut = np.arange(len(squares.cells)) % 3 < thirds
    halves = np.concatenate([squares.cells[cut][:, [0, 1, 2]], squares.cells[cut][:, [0, 2, 3]]])
    parts = {"quad": squares.cells[~cut], "triangle": halves}
    blocks = [(kind, cells) for kind, cells in parts.items() if cells.size]
    mesh = read(folder, squares.points, blocks, squares.groups["base"].nodes)
    mesh = replace(mesh, groups={"base": mesh.groups["SPC 3"]})
    return cf.MeshShell(mesh=mesh, thickness=4e-3, material=STEEL, supports={"base": cf.Clamped()})


@pytest.mark.slow
def test_a_cantilevered_plate_of_squares_and_triangles_converges(tmp_path):
    """Towards Kirchhoff's plate: A. Leissa, J. Sound Vib. 31, 1973, 257, table C17, bounds from above by 0.6 %."""
    leissa = np.array([3.4917, 8.5246, 21.429, 27.331, 31.111])
    unit = np.sqrt(210e9 * 4e-3**3 / (12.0 * 0.91) / (7800.0 * 4e-3)) / (2.0 * np.pi * 0.4**2)
    for thirds in (1, 3):
        coarse, fine = (cf.modes(plate(tmp_path, thirds, count), 5).freq / unit / leissa - 0.994 for count in (8, 16))
        assert np.all(np.abs(fine) < 0.04)
        assert np.abs(fine[3:]).max() < 0.4 * np.abs(coarse[3:]).max()


def test_cells_that_collapse_to_nothing_and_kinds_that_do_not_mix_are_refused(tmp_path):
    mesh = mixed(tmp_path, (2, 1, 1))
    flat = mesh.cells.copy()
    flat[0] = flat[0][[0, 1, 2, 2, 0, 1, 2, 2]]
    with pytest.raises(cf.errors.ModelError, match="a node twice"):
        cf.Solid(mesh=replace(mesh, cells=flat), material=STEEL)
    bricks = cf.imported.grid_mesh("hexahedron20", (1, 1, 1), lambda u: u)
    folded = bricks.cells.copy()
    folded[0, 8:] = folded[0, 0]
    with pytest.raises(cf.errors.ModelError, match=r"1 cell .* that contain a node twice"):
        cf.Solid(mesh=replace(bricks, cells=folded), material=STEEL)
    (tmp_path / "part.bdf").write_text(MIXED_SQUARES, encoding="utf-8")
    with pytest.raises(cf.errors.ModelError, match=r"1 quad8, 1 quad9; .*mesh-mixed-cells"):
        cf.read_mesh(tmp_path / "part.bdf")


def quadratic(folder, counts, *, bend=0.0, left_out=()):
    """The bar of `mixed` with middle nodes, its edges bent; edges (by half their length along x) without middles."""
    corners, parts, _, _ = parts_of_bar(counts)
    points, blocks, middles = list(corners), [], {}
    names = {"tetra": "tetra10", "pyramid": "pyramid13", "wedge": "wedge15", "hexahedron": "hexahedron20"}
    for linear_kind, cells in parts.items():
        name = names[linear_kind]
        ends = np.sort(cells[:, np.array(EDGES[name])], axis=2)
        for edge in map(tuple, ends.reshape(-1, 2).tolist()):
            if edge not in middles:
                middle = corners[list(edge)].mean(axis=0)
                out = any(low <= middle[0] < high for low, high in left_out)
                middles[edge] = -1 if out else len(points)
                points += [] if out else [middle]
        places = np.array([[middles[tuple(edge)] for edge in cell] for cell in ends.tolist()])
        blocks.append((name, np.hstack([cells, places])))
    x = np.array(points)
    u = x / [1.0, 0.2, 0.1]
    x = x + bend * np.sin(7.0 * u[:, [1, 2, 0]]) * u * (1.0 - u) * [1.0, 0.2, 0.1]
    return with_root(read(folder, x, blocks, np.flatnonzero(np.abs(x[:, 0]) < 1e-9)))


def forces_of(solid, load):
    """Forces on the nodes (nodes, 3) of a load, on a solid with elastic supports alone: K u of its deflection."""
    system = solid.assembled()
    return system.expand(system.K @ system.collect(cf.solve_static(solid, [load]).fields))[:, :, 0]


@pytest.mark.slow
def test_constant_strains_are_exact_through_all_quadratic_kinds(tmp_path):
    """As above, with bent edges; a node load and a stress know what the cells are."""
    mesh = quadratic(tmp_path, (4, 2, 2), bend=0.05)
    assert repr(mesh).startswith("MeshData(mixed.bdf: 42 hexahedron20, 34 of them collapsed, 185 nodes")
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
    held = replace(solid, supports={"root": cf.ElasticEdge(k_face=1e12)})
    assert forces_of(held, weight)[:, 2].sum() == pytest.approx(-9.81 * 7800.0 * volume, rel=1e-7)


@pytest.mark.parametrize("omega", [0.0, pytest.param(300.0, marks=pytest.mark.slow)])
def test_all_quadratic_kinds_swing_like_bricks_alone(omega, tmp_path):
    """Modes at rest and at speed against a mesh of bricks as fine: 0.5 % at the worst."""
    spin = cf.Rotation(omega=omega, axis=(0.0, 0.0, 1.0), centre=(-0.5, 0.0, 0.0)) if omega else None
    bricks = cf.imported.grid_mesh("hexahedron20", (4, 2, 2), lambda u: u * [1.0, 0.2, 0.1], groups={"root": (0, 0.0)})
    found, exact = (
        cf.modes(cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.Clamped()}, rotation=spin), 5).freq
        for mesh in (quadratic(tmp_path, (4, 2, 2)), bricks)
    )
    np.testing.assert_allclose(found, exact, rtol=6e-3)
    assert np.abs(found / exact - 1.0).max() > 1e-4


@pytest.mark.slow
def test_facets_of_quadratic_kinds_have_pressures_and_foundations(tmp_path):
    """The pressure on the whole skin adds up to nothing, and its moment of places to the volume."""

    def skinned(bend):
        mesh = quadratic(tmp_path, (3, 1, 2), bend=bend)
        nodes = mesh.facet_nodes(mesh.boundary).ravel()
        skin = replace(mesh, groups={"skin": cf.imported.Group(nodes=nodes, facets=mesh.boundary)})
        return mesh, cf.Solid(mesh=skin, material=STEEL), cf.ElasticEdge(k_face=1e9)

    mesh, solid, springs = skinned(0.04)
    force = forces_of(replace(solid, supports={"skin": springs}), cf.imported.FacetPressure(group="skin", pressure=3.0))
    assert np.abs(force.sum(axis=0)).max() < 1e-9
    volume = solid.assembled().M.sum() / 3.0 / 7800.0
    assert np.sum(force * mesh.points) == pytest.approx(-3.0 * 3.0 * volume, rel=1e-8)
    mesh, solid, springs = skinned(0.0)
    more = replace(solid, supports={"skin": springs}).assembled().K - solid.assembled().K
    assert more.sum() == pytest.approx(3.0 * 1e9 * 2.0 * (0.2 + 0.1 + 0.02), rel=1e-9)


def test_linear_cells_among_quadratic_ones_stay_joined_to_them(tmp_path):
    """Half of a bar linear, half quadratic: neighbours share middle nodes, linear motions are exact."""
    bricks = cf.imported.grid_mesh("hexahedron20", (2, 1, 1), lambda u: u * [1.0, 0.2, 0.1], groups={"root": (0, 0.0)})
    blocks = [("hexahedron20", bricks.cells[:1]), ("hexahedron", bricks.cells[1:, :8])]
    mesh = read(tmp_path, bricks.points, blocks)
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
def test_middle_nodes_that_are_left_out_move_as_the_mean_of_their_ends(tmp_path):
    """All of them out: the linear cells themselves, to round-off. Some of them out: constant strains stay exact."""
    bricks = cf.imported.grid_mesh("hexahedron", (2, 1, 1), lambda u: u * [1.0, 0.2, 0.1])
    wedges = np.array([bricks.cells[0][list(wedge)] for wedge in WEDGES])
    apart = cf.imported.grid_mesh("hexahedron20", (1, 1, 1), lambda u: np.add(u, [9.0, 0.0, 0.0]))
    linear_cells = [("wedge", wedges), ("hexahedron", bricks.cells[1:])]
    alone = read(tmp_path, bricks.points, linear_cells)
    beside = read(
        tmp_path, np.vstack([bricks.points, apart.points]), [*linear_cells, ("hexahedron20", apart.cells + 12)]
    )
    beside = replace(beside, attachments=replace(beside.attachments, springs=soft(12)))
    assert (alone.kind, beside.kind) == ("hexahedron", "hexahedron20")
    values = [cf.Solid(mesh=mesh, material=STEEL).assembled().K[:36, :36].toarray() for mesh in (alone, beside)]
    np.testing.assert_allclose(*(np.linalg.eigvalsh(K)[6:] for K in values), rtol=1e-9)
    some = quadratic(tmp_path, (4, 1, 2), left_out=((0.3, 0.6),))
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


MIXED_SQUARES = "\n".join([
    "BEGIN BULK", *(f"GRID,{k + 1},,{0.1 * (k % 5)},{0.1 * (k // 5)},0.0" for k in range(25)),
    "CQUAD8,1,1,1,3,13,11,2,8\n,12,6", "CQUAD,2,1,13,15,25,23,14,20\n,24,18,19", "ENDDATA\n",
])  # fmt: skip
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
    assert flat_area(mesh.points, faces) == pytest.approx([1.0, 0.5])
    system = cf.Solid(mesh=mesh, material=STEEL).assembled()
    assert system.M.sum() / 3.0 == pytest.approx(1.5 * 7800.0, rel=1e-12)
