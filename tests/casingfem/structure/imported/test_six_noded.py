"""Shells of six-noded triangles, alone and among quadrilaterals; cells turned round so that normals agree."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.cells.tying import covariant_strains, tied_covariant
from casingfem.structure.imported.loads import nodal_loads
from casingfem.structure.imported.mesh.cell_kind import KINDS, rule
from casingfem.structure.imported.mesh.collapsed import native
from casingfem.structure.imported.mesh.walls import cell_normals
from casingfem.structure.imported.readers.draft import Block, Draft, build
from tests.casingfem.structure.imported.parts import STEEL

HALVES = ([0, 1, 2, 4, 5, 8], [0, 2, 3, 8, 6, 7])  # triangles of a square of nine nodes
FLAT = np.array([[0.0, 0.0], [1.0, 0.1], [0.2, 0.9], [0.5, 0.05], [0.6, 0.5], [0.1, 0.45]])  # one with straight sides


def drafted(mesh, cut, *, linear=(), turned=()):
    """A grid of nine-noded squares, those of the mask `cut` in two triangles each.

    Of each kind the cells `linear` have no middle nodes; the triangles `turned` go the other way round.
    """
    triangles = np.concatenate([mesh.cells[cut][:, half] for half in HALVES])
    triangles[list(turned)] = triangles[list(turned)][:, [0, 2, 1, 5, 4, 3]]
    parts = []
    for kind, cells in (("quad8", mesh.cells[~cut][:, :8]), ("triangle6", triangles)):
        low = np.isin(np.arange(len(cells)), linear)
        parts += [(kind, cells[~low]), (kind[:-1], cells[low][:, : KINDS[kind[:-1]].nodes])]
    used, numbers = np.unique(np.concatenate([cells.ravel() for _, cells in parts])), iter(range(1, 10**6))
    blocks = [
        Block(kind, np.searchsorted(used, cells), np.array([next(numbers) for _ in cells]))
        for kind, cells in parts
        if len(cells)
    ]
    sets = {"base": np.flatnonzero(np.isin(used, mesh.groups["base"].nodes))}
    numbers = np.arange(1, len(used) + 1)
    return build(Draft(points=mesh.points[used], node_numbers=numbers, blocks=blocks, node_sets=sets), "part")


def square(count, **options):
    """A square plate of 0.4 m clamped along one side, every third of its squares whole, the others cut."""
    grid = cf.imported.grid_mesh(
        "quad9", (count, count), lambda u: np.insert(0.4 * u, 2, 0.0, axis=1), groups={"base": (0, 0.0)}
    )
    return drafted(grid, np.arange(count**2) % 3 > 0, **options)


def plate(count, thickness=4e-3, **options):
    return cf.MeshShell(
        mesh=square(count, **options), thickness=thickness, material=STEEL, supports={"base": cf.Clamped()}
    )


@pytest.mark.parametrize(
    "bent",
    [
        lambda x, y: (x * x - x * y, 0.5 * x * y - y * y, 0.0, 0.0, 0.0),
        lambda x, y: (0.0, 0.0, 0.3 * x * x + 0.2 * x * y + 0.5 * y * y, 0.1 * x + 0.2 * y, 0.4 * x - 0.2 * y),
    ],
)
def test_linear_strains_pass_through_the_tying_points(bent):
    """Of a flat triangle: quadratic motions in the plane, quadratic deflections with linear turns."""
    x, n = np.insert(FLAT, 2, 0.0, axis=1)[None], np.tile([0.0, 0.0, 1.0], (1, 6, 1))
    e = np.tile(np.eye(3)[:2], (1, 6, 1, 1))
    motion = np.array([bent(*place) for place in FLAT]).ravel()
    tied = tied_covariant("triangle6", x, n, e) @ motion
    plain = covariant_strains("triangle6", rule("triangle6")[0], range(8), x, n, e) @ motion
    assert np.abs(plain).max() > 0.1
    np.testing.assert_allclose(tied, plain, rtol=0.0, atol=1e-14)


def test_what_tying_changes_has_no_mean_over_the_cell():
    """Of any motion of a flat triangle: its transverse shear is quadratic at most, its other strains linear."""
    x, n = np.insert(FLAT, 2, 0.0, axis=1)[None], np.tile([0.0, 0.0, 1.0], (1, 6, 1))
    e = np.tile(np.eye(3)[:2], (1, 6, 1, 1))
    points, weights, *_ = rule("triangle6")
    changed = tied_covariant("triangle6", x, n, e) - covariant_strains("triangle6", points, range(8), x, n, e)
    assert np.abs(changed[:, :, 6:]).max() > 0.01
    np.testing.assert_allclose(np.einsum("q,eqrd->erd", weights, changed), 0.0, atol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("thickness", [0.04, 1e-3])
def test_a_plate_of_squares_and_triangles_converges(thickness):
    """Towards nine-noded squares of a finer mesh, thick and thin; the thin one locked would be far off."""
    side = {"base": (0, 0.0)}
    fine = cf.imported.grid_mesh("quad9", (8, 8), lambda u: np.insert(0.4 * u, 2, 0.0, axis=1), groups=side)
    shell = cf.MeshShell(mesh=fine, thickness=thickness, material=STEEL, supports={"base": cf.Clamped()})
    exact = cf.modes(shell, 5).freq
    coarse, found = (cf.modes(plate(count, thickness), 5).freq / exact - 1.0 for count in (3, 6))
    assert np.abs(found).max() < 0.012
    assert np.abs(found).max() < 0.4 * np.abs(coarse).max()


@pytest.mark.slow
def test_linear_cells_among_quadratic_ones_are_raised():
    """Their edges take the middles of their neighbours, or free ones: the plate is as good as with all of them."""
    whole, some = plate(6), plate(6, linear=[1, 2, 7])
    assert some.mesh.kind == whole.mesh.kind == "quad9"
    assert some.assembled().K.shape == whole.assembled().K.shape
    np.testing.assert_allclose(cf.modes(some, 5).freq, cf.modes(whole, 5).freq, rtol=1e-9)


@pytest.mark.slow
def test_a_frustum_of_triangles_has_the_modes_of_its_chart():
    """Doublets of each harmonic, in order; the mesh is told to be round."""
    material, base = STEEL, {"base": cf.Clamped()}
    exact = cf.modes(cf.Shell(chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=20e-3, material=material,
                              supports=base), 4)  # fmt: skip

    def place(u):
        r, theta = 0.5 - 0.05 * u[:, 1], 2.0 * np.pi * u[:, 0]
        return np.stack([r * np.cos(theta), r * np.sin(theta), 0.25 * u[:, 1]], axis=1)

    grid = cf.imported.grid_mesh("quad9", (32, 4), place, wrap=0, groups={"base": (1, 0.0)})
    mesh = drafted(grid, np.ones(len(grid.cells), dtype=bool))
    found = cf.modes(cf.MeshShell(mesh=mesh, thickness=20e-3, material=material, supports=base), 4)
    assert found.nodal_diameters.tolist() == exact.nodal_diameters.tolist()
    np.testing.assert_allclose(found.freq, exact.freq, rtol=7e-3)


@pytest.mark.slow
def test_triangles_turn_as_squares_do():
    """Prestress and spin of a fast plate: the change of its frequencies is that of nine-noded squares."""
    rotation = cf.Rotation(omega=500.0, axis=(0.0, 0.0, 1.0), centre=(-0.2, 0.2, 0.0))
    grid = cf.imported.grid_mesh(
        "quad9", (4, 4), lambda u: np.insert(0.4 * u, 2, 0.0, axis=1), groups={"base": (0, 0.0)}
    )
    held = {"base": cf.Clamped()}
    rose = []
    for mesh in (grid, drafted(grid, np.ones(16, dtype=bool))):
        shell = cf.MeshShell(mesh=mesh, thickness=4e-3, material=STEEL, supports=held)
        fast = replace(shell, rotation=rotation)
        rose.append(cf.modes(fast, 2).freq ** 2 - cf.modes(shell, 2).freq ** 2)
    assert (np.abs(rose[0]) > 100.0).all()
    np.testing.assert_allclose(rose[1], rose[0], rtol=0.02)


def test_mass_and_loads_of_a_mixed_plate_are_those_of_its_area():
    shell = plate(3)
    weight = nodal_loads(shell, cf.loads.Gravity(acceleration=(0.0, 0.0, -9.81))).sum(axis=0)
    np.testing.assert_allclose(weight, [0.0, 0.0, -9.81 * 7800.0 * 4e-3 * 0.16, 0.0, 0.0], atol=1e-12)
    pressed = nodal_loads(shell, cf.loads.Pressure(pressure=1e3)).sum(axis=0)
    np.testing.assert_allclose(pressed, [0.0, 0.0, 160.0], atol=1e-10)
    M = cf.MeshShell(mesh=shell.mesh, thickness=4e-3, material=STEEL).assembled().M
    assert M[::5, ::5].sum() == pytest.approx(7800.0 * 4e-3 * 0.16, rel=1e-12)


def test_cells_that_point_against_their_neighbours_are_turned_round():
    """The fewer ones, named; the modes are those of the mesh that was in order."""
    right = square(4)
    with pytest.warns(cf.errors.ModelWarning, match=r"3 cells \(\d+, \d+, \d+\).*mesh-turned-shell"):
        mended = square(4, turned=[0, 3, 11])
    assert (cell_normals(mended)[..., 2] >= 0.0).all()
    assert [set(cell) for cell in mended.cells.tolist()] == [set(cell) for cell in right.cells.tolist()]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        square(4)


def test_triangles_of_ansys_shells_are_collapsed_squares():
    """SHELL281: I, J, K, K, M, N, K, P."""
    kind, rows, slots = next(iter(native("quad8", np.array([[1, 2, 3, 3, 12, 23, 3, 31]]))))
    assert (kind, rows.tolist()) == ("triangle6", [0])
    assert np.array([1, 2, 3, 3, 12, 23, 3, 31])[slots].tolist() == [3, 1, 2, 31, 12, 23]
