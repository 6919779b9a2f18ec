"""Shells on quadrilateral meshes: rank, patch test, plates and the frustum against the chart shell, supports, folds."""

import numpy as np
import pytest

import casingfem as cf

WALL = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 3e-3)
QUADRATIC = ("quad8", "quad9")


@pytest.fixture
def carbon():
    return cf.shell.Lamina(E1=140e9, E2=10e9, nu12=0.3, G12=5e9, G13=5e9, G23=3.8e9, rho=1600.0)


def flat(u):
    return np.insert(u, 2, 0.0, axis=1)


def distorted(u):
    return flat(u + 0.05 * np.sin(3 * u[:, ::-1]) * u * (1 - u))


def skewed(u):
    return flat(np.stack([u[:, 0] + 0.2 * u[:, 1], u[:, 1]], axis=1))


def straight(u):
    """Nine cells with straight sides, no two parallel: the corners of `distorted`, bilinear between them."""
    cell = np.minimum((3 * u).astype(int), 2)
    a, b = (3 * u - cell).T[:, :, None]
    corners = [distorted((cell + np.array(step)) / 3) for step in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return (1 - a) * (1 - b) * corners[0] + a * (1 - b) * corners[1] + a * b * corners[2] + (1 - a) * b * corners[3]


def frustum(kind, counts, t=3e-3):
    mesh = cf.imported.grid_mesh(
        kind, counts, lambda u: WALL(np.insert(u, 0, 0.5, axis=1)), groups={"base": (1, 0.0), "top": (1, 1.0)}, wrap=0
    )
    return mesh, t


@pytest.mark.parametrize("kind", ["quad", *QUADRATIC])
@pytest.mark.parametrize("place", [distorted, lambda u: flat(u) + np.array([[0, 0, 0.5]]) * (u[:, :1] ** 2 + u[:, 1:])])
def test_no_hourglass_modes(kind, place, steel):
    """Six rigid motions and no more: reduced integration of nine nodes would leave seven others."""
    counts = (3, 3) if kind == "quad" else (2, 2)
    mesh = cf.imported.grid_mesh(kind, counts, lambda u: place(0.5 * u), groups={})
    shell = cf.MeshShell(mesh=mesh, thickness=0.02, material=steel)
    for groups in (shell.materials, shell.thicknesses, shell.supports):
        with pytest.raises(TypeError):
            groups["all"] = steel
    system = shell.assembled()
    values = np.linalg.eigvalsh(system.K.toarray())
    assert np.abs(values[:6]).max() < 1e-12 * values[-1]
    assert values[6] > 1e-7 * values[-1]
    assert system.rigid == 6


@pytest.mark.parametrize(
    ("kind", "place", "allowed"),
    [("quad", straight, 1e-10), ("quad9", skewed, 1e-10), ("quad9", straight, 1e-4)],
)
def test_constant_membrane_strain_needs_no_inner_forces(kind, place, allowed, steel):
    """Exact on parallelograms; where no sides are parallel, strains tied in two directions miss a little."""
    shell = cf.MeshShell(mesh=cf.imported.grid_mesh(kind, (3, 3), place), thickness=0.02, material=steel)
    system = shell.assembled()
    field = np.zeros((len(system.points), 5))
    field[:, :3] = system.points @ np.array([[1.0, 0.3, 0.0], [0.2, -0.5, 0.0], [0.0, 0.0, 0.0]])
    force = (system.K @ field.ravel()).reshape(-1, 5)
    boundary = np.unique(shell.mesh.facet_nodes(shell.mesh.boundary))
    inner = np.setdiff1d(np.arange(len(force)), boundary)
    assert np.abs(force[inner]).max() < allowed * np.abs(force).max()


@pytest.mark.slow
@pytest.mark.parametrize("kind", QUADRATIC)
@pytest.mark.parametrize("t", [1e-2, 1e-4])
def test_cantilever_plate_is_that_of_the_chart_shell_and_does_not_lock(kind, t, steel):
    mesh = cf.imported.grid_mesh(kind, (8, 8), flat, groups={"root": (0, 0.0)})
    found = cf.modes(cf.MeshShell(mesh=mesh, thickness=t, material=steel, supports={"root": cf.Clamped()}), 5).freq
    chart = cf.Shell(
        chart=cf.Plate(length=1.0, width=1.0), thickness=t, material=steel, supports={"root": cf.Clamped()}
    )
    np.testing.assert_allclose(found, cf.modes(chart, 5).freq, rtol=4e-3)


@pytest.mark.slow
def test_eight_nodes_are_nine_with_the_middle_put_in(steel):
    eight, t = frustum("quad8", (41, 3))
    nine, _ = frustum("quad9", (41, 3))
    a, b = (
        cf.modes(cf.MeshShell(mesh=m, thickness=t, material=steel, supports={"base": cf.Clamped()}), 4)
        for m in (eight, nine)
    )
    assert len(a.structure.mesh.points) == len(eight.points) + len(eight.cells)
    np.testing.assert_allclose(a.freq, b.freq, rtol=1e-4)


@pytest.mark.parametrize("counts", [(41, 4), pytest.param((81, 8), marks=pytest.mark.slow)])
def test_frustum_converges_to_the_chart_shell(counts, steel):
    """Eight modes, n = 7 to 9; the error falls eightfold and more with half the cell."""
    mesh, t = frustum("quad9", counts)
    found = cf.modes(cf.MeshShell(mesh=mesh, thickness=t, material=steel, supports={"base": cf.Clamped()}), 8)
    chart = cf.Shell(
        chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25),
        thickness=t,
        material=steel,
        supports={"base": cf.Clamped()},
    )
    exact = cf.modes(chart, 8)
    error = np.abs(found.freq / exact.freq - 1).max()
    assert error < (0.022 if counts[0] == 41 else 1.5e-3)
    assert found.splits.max() < 1e-9
    assert found.purity.min() > 0.99
    np.testing.assert_array_equal(found.nodal_diameters, exact.nodal_diameters)


@pytest.mark.slow
def test_elastic_edge_is_that_of_the_chart_shell(steel):
    mesh = cf.imported.grid_mesh("quad9", (8, 8), flat, groups={"root": (0, 0.0)})
    edge = cf.ElasticEdge(k_face=2e11)
    found = cf.modes(cf.MeshShell(mesh=mesh, thickness=0.01, material=steel, supports={"root": edge}), 4).freq
    chart = cf.Shell(chart=cf.Plate(length=1.0, width=1.0), thickness=0.01, material=steel, supports={"root": edge})
    held = cf.Shell(
        chart=cf.Plate(length=1.0, width=1.0), thickness=0.01, material=steel, supports={"root": cf.Clamped()}
    )
    exact = cf.modes(chart, 4).freq
    np.testing.assert_allclose(found, exact, rtol=4e-3)
    assert exact[0] < 0.97 * cf.modes(held, 4).freq[0]


def test_fixed_directions_leave_rotations_free(steel):
    """Held in z all round: a simply supported plate, pi^2 sqrt(D/rho t) (1 + 1) over its sides, less the shear."""
    edges = {"a": (0, 0.0), "b": (0, 1.0), "c": (1, 0.0), "d": (1, 1.0)}
    mesh = cf.imported.grid_mesh("quad9", (8, 8), flat, groups=edges)
    supports = {name: cf.imported.Fixed(directions=("z",)) for name in edges}
    found = cf.modes(cf.MeshShell(mesh=mesh, thickness=2e-3, material=steel, supports=supports), 4)
    D = 210e9 * 2e-3**3 / (12 * (1 - 0.3**2))
    exact = np.pi * np.sqrt(D / (7800.0 * 2e-3))  # 2 pi^2 sqrt(D/m)/(2 pi)
    assert found.rigid == 3
    assert found.freq[3] == pytest.approx(exact, rel=5e-3)


def folded(angle):
    """Two halves of a plate that meet at an angle."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))

    def place(u):
        beyond = np.maximum(u[:, 0] - 0.5, 0.0)
        return np.stack([u[:, 0] - beyond * (1 - c), u[:, 1], beyond * s], axis=1)

    return cf.imported.grid_mesh("quad9", (4, 2), place)


def test_kinks_are_doubted_and_folds_are_not(steel):
    with pytest.warns(cf.errors.ModelWarning, match=r"4 cells \(3, 4, 5, 6\) meet at up to 20 degrees.*mesh-kink"):
        cf.MeshShell(mesh=folded(20.0), thickness=0.01, material=steel)
    cf.MeshShell(mesh=folded(90.0), thickness=0.01, material=steel)
    cf.MeshShell(mesh=folded(4.0), thickness=0.01, material=steel)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*mesh-thin-curved")
def test_a_wall_with_a_window_is_that_of_its_solid(steel):
    """A panel of 30 mm with a hole of four cells; without it the first frequency is another."""
    window = np.array([[2, 2], [2, 3], [3, 2], [3, 3]])
    ends = {"root": (0, 0.0)}

    def thick(u):
        theta, r = 0.5 - u[:, 1], 0.5 + 0.03 * (u[:, 2] - 0.5)
        return np.stack([r * np.cos(theta), r * np.sin(theta), 0.4 * u[:, 0]], axis=1)

    def without(mesh):
        cells = np.delete(mesh.cells, window @ [6, 1], axis=0)
        used, numbers = np.unique(cells, return_inverse=True)
        held = np.flatnonzero(np.isin(used, mesh.groups["root"].nodes))
        return cf.imported.MeshData(
            kind=mesh.kind,
            points=mesh.points[used],
            cells=numbers.reshape(cells.shape),
            groups={"root": cf.imported.Group(nodes=held)},
        )

    parts = {"material": steel, "supports": {"root": cf.Clamped()}}
    wall, block = (
        cf.imported.grid_mesh("quad9", (6, 6), panel, groups=ends),
        cf.imported.grid_mesh("hexahedron27", (6, 6, 1), thick, groups=ends),
    )
    pierced = cf.modes(cf.MeshShell(mesh=without(wall), thickness=0.03, **parts), 4).freq
    np.testing.assert_allclose(pierced, cf.modes(cf.Solid(mesh=without(block), **parts), 4).freq, rtol=1.6e-2)
    whole = cf.modes(cf.MeshShell(mesh=wall, thickness=0.03, **parts), 4).freq
    assert np.abs(pierced / whole - 1).max() > 0.05


def panel(u):
    """A cylindrical panel whose cells' normals point outwards."""
    theta = 0.5 - u[:, 1]
    return np.stack([0.5 * np.cos(theta), 0.5 * np.sin(theta), 0.4 * u[:, 0]], axis=1)


@pytest.mark.slow
def test_plies_are_those_of_the_chart_shell(steel, carbon):
    plies = (cf.shell.Ply(thickness=1.0), cf.shell.Ply(thickness=1.0, angle_deg=30.0, lamina=carbon),
             cf.shell.Ply(thickness=0.5, angle_deg=-60.0, lamina=carbon))  # fmt: skip
    parts = {"thickness": 0.02, "material": steel, "wall": "linear", "supports": {"root": cf.Clamped()}}
    mesh = cf.imported.grid_mesh("quad9", (10, 12), panel, groups={"root": (0, 0.0)})
    layered = cf.MeshShell(mesh=mesh, plies=plies, **parts)
    chart = cf.Shell(chart=cf.Panel(radius=0.5, length=0.4, angle=1.0), plies=plies, **parts)
    np.testing.assert_allclose(cf.modes(layered, 4).freq, cf.modes(chart, 4).freq, rtol=4e-3)
    steel_only = cf.MeshShell(mesh=mesh, plies=(cf.shell.Ply(thickness=0.5), cf.shell.Ply(thickness=1.5)), **parts)
    plain = cf.MeshShell(mesh=mesh, **parts).assembled()
    for name in ("K", "M"):  # layers of one material are one layer
        one, other = getattr(steel_only.assembled(), name), getattr(plain, name)
        assert abs(one - other).max() < 1e-12 * abs(other).max()
    assert layered.density() == pytest.approx(0.02 * (2 * 7800.0 + 3 * 1600.0) / 5)


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"wall": "thick"}, "shell-wall"),
        ({"wall": "curved"}, "shell-plies"),
        ({"angle_from": (0.0, 0.0, 0.0)}, "shell-plies"),
        ({"angle_from": (0.0, 0.0, 1.0)}, "shell-plies"),  # square to the plate
    ],
)
def test_refuses_walls_and_directions_that_are_none(changes, code, steel):
    parts = {"wall": "linear", "angle_from": (1.0, 0.0, 0.0), "plies": (cf.shell.Ply(thickness=1.0),)} | changes
    with pytest.raises(cf.errors.ModelError, match=code):
        cf.MeshShell(mesh=cf.imported.grid_mesh("quad9", (1, 1), flat), thickness=0.01, material=steel, **parts)


def test_refuses_what_is_no_shell(steel):
    brick = cf.imported.grid_mesh("hexahedron20", (1, 1, 1), lambda u: u)
    with pytest.raises(cf.errors.ModelError, match="mesh-not-shell"):
        cf.MeshShell(mesh=brick, thickness=0.01, material=steel)
    with pytest.raises(cf.errors.ModelError, match="shell-thickness"):
        cf.MeshShell(mesh=cf.imported.grid_mesh("quad9", (1, 1), flat), thickness=0.0, material=steel)
    mesh = cf.imported.grid_mesh("quad9", (1, 1), flat, groups={"root": (0, 0.0)})
    with pytest.raises(cf.errors.ModelError, match="mesh-support"):
        cf.MeshShell(mesh=mesh, thickness=0.01, material=steel, supports={"root": cf.ElasticEdge(k_r=1.0)})
