"""The pieces of the meridian method: floors by their formulas, lowest values, inertias, shapes spread around."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.modal.fourier import (
    harmonic_floor,
    inertia_below,
    lowest,
    members,
    resolving,
    revolve_own,
    revolve_shape,
    ring_floor,
    shown,
)
from casingfem.modal.modes import count_below, count_or_band, plate_count
from casingfem.structure.mesh.shell_mesh import make_grid
from contact.io.progress import listening

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
TUBE = cf.Shell(
    chart=cf.Cylinder(radius=0.4, height=0.3),
    thickness=8e-3,
    material=STEEL,
    mesh=cf.ShellMesh(order=4, rows=1, around=5),
)


def series(bending, shear):
    return bending * shear / (bending + shear)


@pytest.mark.parametrize("n", [2, 3, 12])
def test_the_floor_of_a_wall_is_ring_bending_in_series_with_shear(n):
    G = 210e9 / 2.6
    bending = 210e9 * 8e-3**2 / (12.0 * 7800.0 * 0.4**4) * n**2 * (n**2 - 1) ** 2 / (n**2 + 1)
    factor = np.real(TUBE.shear_factor(np.array(0.3)))
    assert harmonic_floor(TUBE, n) == pytest.approx(
        0.7 * series(bending, factor * G * n**2 / (7800.0 * 0.4**2)), rel=1e-9
    )
    assert harmonic_floor(TUBE, 1) == harmonic_floor(TUBE, 0) == 0.0


def test_the_floor_takes_the_largest_radius(frustum):
    cone = frustum(thickness=8e-3)
    assert harmonic_floor(cone, 5) == harmonic_floor(
        frustum(thickness=8e-3, chart=cf.Cylinder(radius=0.5, height=0.25)), 5
    )


@pytest.mark.parametrize("thick", [1e-3, 2.0])
def test_the_floor_is_the_lowest_of_wall_and_rings(thick):
    """A ring as thin as a wire lies below the wall, a stout one above."""
    ring = cf.Ring(section=cf.edge.Section.rectangle(width=1e-2 * thick, depth=1e-2 * thick))
    shell = replace(TUBE, supports={"top": ring})
    wall, own = harmonic_floor(TUBE, 4), ring_floor(shell, "top", ring, 4)
    assert (own < wall) == (thick < 1.0)
    assert harmonic_floor(shell, 4) == min(wall, own)


@pytest.mark.parametrize(("J", "least"), [(2e-8, 3e-9), (1e-10, 9e-9)])
def test_the_floor_of_a_ring_is_its_weaker_bending_with_torsion_in_series_with_shear(J, least):
    """Torsion counts where it is softer than bending. The ring's own material, at its own radius."""
    own, n = cf.Material(E=70e9, nu=0.25, rho=2700.0), 5
    section = cf.edge.Section(width=0.02, depth=0.01, area=2e-4, I_r=least, I_z=5e-9, J=J, shear=0.8)
    ring = cf.Ring(section=section, material=own, offset=(-0.03, 0.01))
    shell = replace(TUBE, supports={"top": ring})
    radius = 0.4 - 0.03
    G, weak, line = 70e9 / 2.5, 70e9 * min(least, 5e-9), 2700.0 * 2e-4
    ratio = max(1.0, weak / (G * J))
    assert (ratio > 1.0) == (J < 1e-9)
    bending = weak / (line * radius**4) * n**2 * (n**2 - 1) ** 2 / (n**2 + ratio)
    expected = 0.5 * series(bending, 0.8 * G * n**2 / (2700.0 * radius**2))
    assert ring_floor(shell, "top", ring, n) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("n", "around"), [(0, 5), (3, 5), (4, 6), (10, 15)])
def test_a_mesh_has_six_nodes_a_wave(n, around):
    assert resolving(TUBE, n).mesh.around == around
    assert (resolving(TUBE, n) is TUBE) == (around == 5)
    assert resolving(TUBE, n).mesh.order == 4


@dataclass(frozen=True)
class Pencil:
    """A harmonic by its matrices."""

    K: np.ndarray
    mass: np.ndarray
    n: int = 3

    def energies(self, x):
        return x.T @ self.K @ x

    def expand(self, x):
        return np.repeat(x[None], 5, axis=1)[:, :5]

    def expand_own(self, x):
        return x[:1]


def pencil(values, seed=3):
    """A full K whose eigenvalues over an uneven mass are given."""
    turn, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((len(values), len(values))))
    root = np.sqrt(np.linspace(0.5, 3.0, len(values)))
    return Pencil(root[:, None] * (turn @ np.diag(values) @ turn.T) * root, root**2)


VALUES = [-2.0, 0.5, 3.0, 4.0, 40.0]


@pytest.mark.parametrize(("sigma", "count"), [(-2.1, 0), (-1.9, 1), (0.6, 2), (3.5, 3), (39.0, 4), (41.0, 5)])
def test_the_inertia_counts_eigenvalues_below_a_place(sigma, count):
    assert inertia_below(pencil(VALUES), sigma) == count


@pytest.mark.parametrize("shift", [3.0, 0.05, 0.0005])
@pytest.mark.parametrize("count", [1, 3, 5, 9])
def test_the_lowest_values_of_a_harmonic_are_mass_normalised(shift, count):
    """Where the shift leaves K indefinite, a hundred or ten thousand times as much is taken."""
    given = pencil(VALUES)
    values, vectors = lowest(given, count, shift)
    np.testing.assert_allclose(values, VALUES[:count], atol=1e-9)
    np.testing.assert_allclose(vectors.T @ (given.mass[:, None] * vectors), np.eye(len(values)), atol=1e-9)
    np.testing.assert_allclose(vectors.T @ given.K @ vectors, np.diag(values), atol=1e-9)


def test_a_harmonic_that_no_shift_holds_is_refused():
    with pytest.raises(cf.errors.NumericsError, match="n = 3: round-off outweighs the stiffness"):
        lowest(pencil(VALUES), 2, 1e-4)


@pytest.mark.parametrize(("n", "kinds"), [(0, [False]), (3, [False, True])])
def test_each_value_with_diameters_is_a_cosine_and_a_sine(n, kinds):
    given = replace(pencil([1.0, 2.0]), n=n)
    found = members(given, np.array([1.0, 2.0]), np.eye(2))
    assert [(mode.value, mode.n, mode.sine) for mode in found] == [(v, n, s) for v in (1.0, 2.0) for s in kinds]
    assert np.array_equal(found[-1].turns, [0.0])
    unit = np.finfo(float).eps
    assert [mode.noise for mode in found] == pytest.approx([unit * abs(given.K[k, k]) for k in (0, 1) for _ in kinds])


def test_what_a_mode_shows_of_its_wave():
    wave = np.array([1.0 + 2.0j, -3.0 + 0.5j])
    assert shown(wave, 0, sine=False).tolist() == [3.0, -2.5]
    assert shown(wave, 2, sine=False).tolist() == [1.0, -3.0]
    assert shown(wave, 2, sine=True).tolist() == [2.0, 0.5]


@pytest.mark.parametrize("n", [0, 2])
@pytest.mark.parametrize("sine", [False, True])
def test_a_meridian_is_spread_around_by_its_wave(n, sine):
    """u = (r cos, hoop sin, axial cos) n theta: hoop in quadrature; half the mean square of a cosine is normalised."""
    grid = make_grid(TUBE.chart, TUBE.mesh, TUBE.stations)
    z, theta = grid.nodes
    shape = np.arange(25.0).reshape(5, 5) + 1.0
    field = revolve_shape(grid, shape, n, sine=sine)
    row = np.searchsorted(np.unique(z.round(9)), z.round(9))
    c, s = np.cos(n * theta), np.sin(n * theta)
    even, odd = (s, c) if sine else (c, -s)
    if n == 0:
        even, odd = np.ones_like(z), np.ones_like(z)
    radial, hoop, axial = shape[row, 0] * even, shape[row, 1] * odd, shape[row, 2] * even
    expected = [radial * np.cos(theta) - hoop * np.sin(theta), radial * np.sin(theta) + hoop * np.cos(theta), axial]
    size = np.sqrt(np.pi if n else 2.0 * np.pi)
    np.testing.assert_allclose(field[:, :3], np.stack(expected, axis=1) / size, atol=1e-12)


def test_turns_of_rings_are_spread_in_quadrature():
    rings = {edge: cf.Ring(section=cf.edge.Section.rectangle(width=0.02, depth=0.02)) for edge in ("base", "top")}
    shell = replace(TUBE, supports=rings)
    grid = make_grid(shell.chart, shell.mesh, shell.stations)
    found = revolve_own(grid, shell, np.array([2.0, -3.0]), 3, sine=False)
    theta = np.concatenate([grid.nodes[1, grid.edges[edge].nodes] for edge in shell.rings])
    turns = np.repeat([2.0, -3.0], len(theta) // 2)
    np.testing.assert_allclose(found, -turns * np.sin(3 * theta) / np.sqrt(np.pi), atol=1e-12)
    flat = revolve_own(grid, shell, np.array([2.0, -3.0]), 0, sine=False)
    np.testing.assert_allclose(flat, turns / np.sqrt(2.0 * np.pi), rtol=1e-12)


def test_what_is_asked_for_is_a_count_or_a_band():
    assert count_or_band(None, None) == 40
    assert count_or_band(3, None) == 3
    assert count_or_band(None, (0.0, 5.0)) == (0.0, 5.0)
    for band in ((-1.0, 5.0), (5.0, 5.0), (0.0, 1e15)):
        with pytest.raises(cf.errors.ModelError, match="the band runs from"):
            count_or_band(None, band)
    with pytest.raises(cf.errors.ModelError, match="both a count of modes and a band"):
        count_or_band(3, (0.0, 5.0))
    with pytest.raises(cf.errors.ModelError, match="count must be at least 1, found 0"):
        count_or_band(0, None)
    with pytest.raises(cf.errors.ModelError, match=r"modes below 1000000000000000\.0 Hz were to be counted"):
        count_below(TUBE, 1e15)


def test_modes_of_a_band_are_expected_by_the_density_of_a_plate():
    plate = cf.Shell(chart=cf.Plate(length=0.3, width=0.4), thickness=2e-3, material=STEEL)
    speed = np.sqrt(210e9 / (7800.0 * 0.91))
    assert plate_count(plate, (100.0, 500.0)) == pytest.approx(np.sqrt(3.0) * 0.12 * 400.0 / (speed * 2e-3), rel=1e-9)
    assert plate_count(plate, 7) == 7.0


@pytest.mark.parametrize("wanted", [{"count": 30}, {"band": (0.0, 4000.0)}])
def test_modes_by_harmonics_report_each_n_and_a_share_that_rises_to_the_last(wanted):
    heard = []
    with listening(lambda words, done, most: heard.append((words, done))):
        cf.modes(TUBE, **wanted)
    assert [words for words, _ in heard] == [f"n = {n}" for n in range(len(heard))]
    shares = [done for _, done in heard if done is not None]
    assert shares == sorted(shares)
    assert 0.5 < shares[-1] <= 0.99
