"""Modes of solids on meshes: labels on bodies of revolution, rigid motions, mechanisms, the same table as shells."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.linalg import factor
from casingfem.linalg.multigrid import multigrid_modes
from casingfem.modal import mesh_modes as mesh_module
from casingfem.modal.mesh_modes import check_rigid, meridional_shapes, mesh_modes, projected
from casingfem.structure.imported.revolution import elements_around, round_about_z

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-thin-curved")  # coarse rings, only compared with each other

WALL = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.05)
BASE = {"base": (2, 0.0)}


def ring(kind="hexahedron20", counts=(1, 18, 2), place=WALL, wrap=1):
    return cf.imported.grid_mesh(kind, counts, place, groups=BASE, wrap=wrap)


@pytest.fixture(scope="module")
def found(steel):
    return mesh_modes(cf.Solid(mesh=ring(counts=(1, 24, 4)), material=steel, supports={"base": cf.Clamped()}), 8)


def test_ring_has_doublets_with_pure_labels_in_the_order_of_the_shell(found, steel):
    """The chart shell says which n, within the 3.3 % that a thick wall and a coarse mesh cost."""
    shell = cf.Shell(
        chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25),
        thickness=0.05,
        material=steel,
        supports={"base": cf.Clamped()},
    )
    same = cf.modes(shell, 8)
    assert found.sturm_count == 8
    assert len(found.doublets) == 4
    assert found.splits.max() < 1e-9
    assert found.purity.min() > 0.95
    assert found.nodal_diameters.tolist() == same.nodal_diameters.tolist()
    np.testing.assert_allclose(found.freq, same.freq, rtol=0.035)


def test_modes_are_mass_normalised_and_read_like_those_of_a_shell(found, steel):
    assert cf.modes(found.structure, 8).freq.tobytes() == found.freq.tobytes()
    lines = repr(found).splitlines()
    assert lines[0].split()[:4] == ["mode", "freq", "[Hz]", "n"]
    assert lines[-1].startswith("8 modes, ")
    assert found.records()[0]["doublet"] == 1
    with pytest.raises(ValueError, match="imported structure, found 'fourier'"):
        cf.modes(found.structure, 4, method="fourier")


@pytest.mark.parametrize("speed", [0.0, 10.0])
def test_a_band_without_modes_is_an_empty_table(steel, speed):
    turning = cf.Rotation(omega=speed) if speed else None
    part = cf.Solid(mesh=ring(counts=(1, 12, 1)), material=steel, supports={"base": cf.Clamped()}, rotation=turning)
    none = cf.modes(part, band=(1.0, 2.0))
    assert len(none) == none.sturm_count == len(none.records()) == 0
    assert "0 modes" in repr(none)


@pytest.mark.parametrize("n", [0, 2, 5])
def test_projection_finds_a_wave_put_in(found, n):
    """u_r = z cos n (theta - psi): all content at n, antinode at psi."""
    mesh = found.structure.mesh
    x, y, z = mesh.points.T
    theta = np.arctan2(y, x)
    u = z * np.cos(n * (theta - 0.2))
    field = np.stack([u * np.cos(theta), u * np.sin(theta), 0 * u], axis=1)[:, :, None]
    rings = projected(found.structure, field, 8)
    label, purity = rings.label()
    assert label[0] == n
    assert purity[0] > 0.999
    if n:
        angle = -np.angle(np.sum(rings.profile(0, n) ** 2)) / (2 * n)
        assert np.mod(angle - 0.2, np.pi / n) == pytest.approx(0, abs=1e-3) or np.mod(
            angle - 0.2, np.pi / n
        ) == pytest.approx(np.pi / n, abs=1e-3)


def test_unstructured_tetrahedra_are_labelled_too(steel):
    """Turned rows of tetrahedra: no two rings of nodes at the same angles."""

    def twisted(u):
        return WALL(np.stack([u[:, 0], u[:, 1] + 0.006 * np.sin(4 * u[:, 2] + 2 * u[:, 0]), u[:, 2]], axis=1))

    low = mesh_modes(
        cf.Solid(mesh=ring("tetra10", (1, 18, 2), twisted), material=steel, supports={"base": cf.Clamped()}), 6
    )
    assert low.purity.min() > 0.97
    assert len(low.doublets) == 3
    assert low.splits.max() < 0.01


@pytest.mark.parametrize(
    ("place", "wrap", "is_round"),
    [
        (WALL, 1, True),
        (lambda u: WALL(u * [1, 0.97, 1]), None, False),
        (lambda u: WALL(u) + np.array([0.1, 0, 0]), 1, False),
        (lambda u: WALL(u) * [1.05, 1, 1], 1, True),
        (lambda u: WALL(u) * [1.5, 1, 1], 1, False),
    ],
    ids=["ring", "sector", "off centre", "slightly oval", "oval"],
)
def test_bodies_of_revolution_are_recognised(place, wrap, is_round):
    assert round_about_z(ring(place=place, wrap=wrap)) is is_round


@pytest.mark.parametrize("kind", ["hexahedron20", "tetra10"])
def test_a_thin_square_is_not_round(kind):
    """One fiftieth thick: few of its facets lean, but more than a meridional section has."""
    assert not round_about_z(cf.imported.grid_mesh(kind, (4, 4, 1), lambda u: (u - 0.5) * [1.0, 1.0, 0.02]))


def test_elements_around():
    assert elements_around(ring("hexahedron20", (1, 18, 2))) == 18
    middle = cf.imported.grid_mesh("quad", (2, 2), lambda u: np.insert(u, 1, 0.0, axis=1))
    assert elements_around(middle) == 0  # a plate through the axis


def test_free_body_shows_its_rigid_motions_first(steel):
    low = mesh_modes(cf.Solid(mesh=ring(), material=steel), 8)
    assert low.rigid == 6
    assert low.freq[5] < 1e-2 < 100 < low.freq[6]
    assert low.nodal_diameters.tolist() == [-1] * 6 + [2, 2]
    assert [row["rigid"] for row in low.records()] == [True] * 6 + [False] * 2


def test_parts_that_hinge_are_doubted(steel):
    """Two bricks with one edge in common swing about it without strain."""
    one = cf.imported.grid_mesh("hexahedron20", (2, 2, 1), lambda u: u * [0.2, 0.2, 0.1])
    kept = one.cells[[0, 3]]
    used, cells = np.unique(kept, return_inverse=True)
    mesh = cf.imported.MeshData(kind=one.kind, points=one.points[used], cells=cells.reshape(kept.shape))
    with pytest.warns(cf.errors.ModelWarning, match="7 modes near zero, rigid motions explain 6"):
        mesh_modes(cf.Solid(mesh=mesh, material=steel), 8)


@pytest.mark.slow
def test_large_thick_solids_are_solved_by_multigrid_and_others_are_not(steel, monkeypatch):
    def block(size):
        mesh = cf.imported.grid_mesh("hexahedron20", (4, 3, 2), lambda u: u * np.array(size), groups={"root": (0, 0.0)})
        return cf.Solid(mesh=mesh, material=steel, supports={"root": cf.Clamped()})

    thick, thin = block((1.0, 0.8, 0.6)), block((1.0, 0.8, 0.02))
    exact = mesh_modes(thick, 5)
    calls = []
    monkeypatch.setattr(mesh_module, "multigrid_modes", lambda *a, **k: calls.append(k) or multigrid_modes(*a, **k))
    mesh_modes(thick, 5)
    assert not calls
    monkeypatch.setattr(mesh_module, "LARGE", 100)
    found = mesh_modes(thick, 5)
    mesh_modes(thin, 5)
    mesh_modes(thick, 5, multigrid=False)
    mesh_modes(thick, (0.0, 1.1 * exact.freq[0]))
    assert calls == [{"counted": True}]
    assert found.sturm_count == 5
    np.testing.assert_allclose(found.freq, exact.freq, rtol=1e-9)
    monkeypatch.setattr(mesh_module, "COUNTABLE", 100)
    assert "5 modes, 492 dofs, not counted" in repr(mesh_modes(thick, 5))


@pytest.mark.slow
def test_without_memory_for_a_factor_thick_solids_go_to_multigrid_and_others_are_refused(steel, monkeypatch):
    def block(size):
        mesh = cf.imported.grid_mesh("hexahedron20", (4, 3, 2), lambda u: u * np.array(size), groups={"root": (0, 0.0)})
        return cf.Solid(mesh=mesh, material=steel, supports={"root": cf.Clamped()})

    thick, thin = block((1.0, 0.8, 0.6)), block((1.0, 0.8, 0.02))
    exact = mesh_modes(thick, 5)
    monkeypatch.setattr(factor, "free_memory", lambda: 1e5)
    found = mesh_modes(thick, 5)
    assert found.sturm_count is None
    np.testing.assert_allclose(found.freq, exact.freq, rtol=1e-7)
    for structure, wanted in ((thin, 5), (thick, (0.0, 1.1 * exact.freq[0]))):
        with pytest.raises(cf.errors.NumericsError, match=r"takes .* GB, 0.0001 GB are free: .*\[modes-memory\]"):
            mesh_modes(structure, wanted)


@pytest.mark.filterwarnings("ignore:.*mesh-kink")
def test_digits_of_a_file_are_no_meridional_coordinate(steel):
    """A cylinder of straight edges: all its integration points have one radius but for the digits of the nodes."""
    around = cf.imported.grid_mesh(
        "quad", (24, 3), lambda u: cf.imported.revolved((0.2, 0.2), (0.0, 0.2), 0.0)(np.insert(u, 0, 0.5, 1)), wrap=0
    )
    mesh = replace(around, points=np.round(around.points, 9))
    wave = np.zeros((len(mesh.points), 5, 1))
    theta = np.arctan2(mesh.points[:, 1], mesh.points[:, 0])
    wave[:, :2, 0] = np.cos(2 * theta)[:, None] * mesh.points[:, :2] / 0.2
    label, purity = projected(cf.MeshShell(mesh=mesh, material=steel, thickness=2e-3), wave, 8).label()
    assert label.tolist() == [2]
    assert purity[0] > 0.999


def test_shares_of_waves_are_their_energies_and_twice_those_of_what_goes_all_around(found):
    """Radial, hoop and axial motions count alike; 1 mm of n = 0 counts as 1.4 mm of a wave."""
    mesh = found.structure.mesh
    theta = np.arctan2(mesh.points[:, 1], mesh.points[:, 0])
    c, s = np.cos(theta), np.sin(theta)
    fields = np.zeros((len(theta), 3, 3))
    radial, hoop = 3.0 * np.cos(2 * theta), 4.0 * np.sin(3 * theta)
    fields[:, 0, 0], fields[:, 1, 0] = radial * c - hoop * s, radial * s + hoop * c
    fields[:, 2, 1] = 1.0 + 2.0 * np.cos(4 * theta - 0.3)
    fields[:, 2, 2] = 5.0 * np.sin(2 * theta) + 5.0 * np.sin(theta)
    shares = projected(found.structure, fields, 6).shares()
    expected = np.zeros((7, 3))
    expected[[2, 3], 0] = 9.0 / 25.0, 16.0 / 25.0
    expected[[0, 4], 1] = 2.0 / 6.0, 4.0 / 6.0
    expected[[1, 2], 2] = 0.5
    np.testing.assert_allclose(shares, expected, atol=2e-3)


@pytest.mark.parametrize(("r", "count"), [(np.linspace(0.5, 1.0, 40), 4), (0.7 + 0.2 * np.sin(np.arange(40.0)), 10)])
def test_meridional_shapes_are_cubic_and_orthonormal(r, count):
    """Ten in a section; on a cone, where the radius follows z, four."""
    z, weight = np.linspace(0.0, 2.0, 40), np.linspace(1.0, 3.0, 40)
    shapes = meridional_shapes(r, z, weight)
    assert shapes.shape == (40, count)
    np.testing.assert_allclose(shapes.T @ (weight[:, None] * shapes), np.eye(count), atol=1e-9)
    cubic = (r - 2.0 * z) ** 3 + z**2 + r
    np.testing.assert_allclose(shapes @ (shapes.T @ (weight * cubic)), cubic, rtol=1e-7)


@pytest.mark.parametrize(("freq", "told"), [(0.795, True), (0.797, False)])
def test_motions_below_a_twentieth_of_the_scale_that_are_not_rigid_are_doubted(freq, told):
    """5 rad/s of a scale of 100: .7958 Hz; one rigid motion is known."""
    system = SimpleNamespace(
        rigid=1, frequency_scale=100.0, structure=SimpleNamespace(mesh=SimpleNamespace(source="part.inp"))
    )
    if told:
        with pytest.warns(
            cf.errors.ModelWarning, match=r"part\.inp: 2 modes near zero, rigid motions explain 1.*mesh-mechanism"
        ):
            check_rigid(system, np.array([0.0, freq, 5.0]))
    else:
        check_rigid(system, np.array([0.0, freq, 5.0]))


@pytest.mark.parametrize(("wanted", "count"), [((), 40), ((2,), 2)])
def test_forty_modes_are_computed_if_nothing_is_said(steel, wanted, count):
    skin = cf.imported.grid_mesh(
        "quad9", (3, 2), lambda u: np.insert(u * [0.3, 0.1], 2, 0.0, axis=1), groups={"root": (0, 0.0)}
    )
    found = mesh_modes(
        cf.MeshShell(mesh=skin, thickness=3e-3, material=steel, supports={"root": cf.Clamped()}), *wanted
    )
    assert len(found) == count
    assert found.nodal_diameters.tolist() == [-1] * count
    assert found.fields.shape == (35, 5, count)
    assert set(found.seconds) == {"assemble", "solve", "label"}
    assert all(0.0 <= spent < 100.0 for spent in found.seconds.values())
