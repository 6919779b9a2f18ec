"""Modes of solids on meshes: labels on bodies of revolution, rigid motions, mechanisms, the same table as shells."""

import numpy as np
import pytest

import casingfem as cf

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-thin-curved")  # coarse rings, only compared with each other

WALL = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.05)
BASE = {"base": (2, 0.0)}


def ring(kind="hexahedron20", counts=(1, 18, 2), place=WALL, wrap=1):
    return cf.imported.grid_mesh(kind, counts, place, groups=BASE, wrap=wrap)


@pytest.fixture(scope="module")
def found(steel):
    return cf.modes(cf.Solid(mesh=ring(counts=(1, 24, 4)), material=steel, supports={"base": cf.Clamped()}), 8)


def test_ring_has_doublets_with_pure_labels_in_the_order_of_the_shell(found, steel):
    """The chart shell gives this n, within the 3.3 % that a thick wall and a coarse mesh cost."""
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
    with pytest.raises(ValueError, match=r"found .fourier., expected .auto. for an imported structure"):
        cf.modes(found.structure, 4, method="fourier")


@pytest.mark.parametrize("speed", [0.0, 10.0])
def test_a_band_without_modes_is_an_empty_table(steel, speed):
    turning = cf.Rotation(omega=speed) if speed else None
    part = cf.Solid(mesh=ring(counts=(1, 12, 1)), material=steel, supports={"base": cf.Clamped()}, rotation=turning)
    none = cf.modes(part, band=(1.0, 2.0))
    assert len(none) == none.sturm_count == len(none.records()) == 0
    assert "0 modes" in repr(none)


def test_unstructured_tetrahedra_are_labelled_too(steel):
    """Turned rows of tetrahedra: no two rings of nodes at the same angles."""

    def twisted(u):
        return WALL(np.stack([u[:, 0], u[:, 1] + 0.006 * np.sin(4 * u[:, 2] + 2 * u[:, 0]), u[:, 2]], axis=1))

    low = cf.modes(
        cf.Solid(mesh=ring("tetra10", (1, 18, 2), twisted), material=steel, supports={"base": cf.Clamped()}), 6
    )
    assert low.purity.min() > 0.97
    assert len(low.doublets) == 3
    assert low.splits.max() < 0.01


def test_free_body_shows_its_rigid_motions_first(steel):
    low = cf.modes(cf.Solid(mesh=ring(), material=steel), 8)
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
    with pytest.warns(cf.errors.ModelWarning, match="found 7 modes near 0 Hz, expected 6"):
        cf.modes(cf.Solid(mesh=mesh, material=steel), 8)


@pytest.mark.parametrize(("wanted", "count"), [((), 40), ((2,), 2)])
def test_forty_modes_are_computed_if_nothing_is_stated(steel, wanted, count):
    skin = cf.imported.grid_mesh(
        "quad9", (3, 2), lambda u: np.insert(u * [0.3, 0.1], 2, 0.0, axis=1), groups={"root": (0, 0.0)}
    )
    found = cf.modes(cf.MeshShell(mesh=skin, thickness=3e-3, material=steel, supports={"root": cf.Clamped()}), *wanted)
    assert len(found) == count
    assert found.nodal_diameters.tolist() == [-1] * count
    assert found.fields.shape == (35, 5, count)
    assert set(found.seconds) == {"assemble", "solve", "label"}
    assert all(0.0 <= spent < 100.0 for spent in found.seconds.values())
