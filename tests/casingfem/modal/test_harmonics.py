"""Circumferential content: labels, purity, orientation, partners; on shapes whose answer is known."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import casingfem as cf
from casingfem.modal.harmonics import align_pair, find_doublets, orientation, quadrature, ring_content
from casingfem.structure.mesh.shell_mesh import make_grid

CHART = cf.Frustum(r_base=0.5, r_top=0.45, height=0.25)
GRID = make_grid(CHART, cf.ShellMesh(order=7, rows=(0.0, 0.4, 1.0), around=13))


def radial_wave(n, angle, amplitude=1.0, grid=GRID):
    """A radial wave cos n(theta - angle), growing along the axis, as a nodal field (nodes, 5)."""
    z, theta = grid.nodes
    u = amplitude * (z + 0.1) * np.cos(n * (theta - angle))
    return np.stack([u * np.cos(theta), u * np.sin(theta), *np.zeros((3, len(z)))], axis=1)


def content(*fields):
    return ring_content(CHART, GRID, np.stack(fields, axis=-1), n_max=30)


@pytest.mark.parametrize("n", range(0, 17))
def test_a_pure_wave_is_labelled_with_its_n(n):
    label, purity = content(radial_wave(n, 0.2)).label()
    assert label.tolist() == [n]
    assert purity[0] == pytest.approx(1.0, abs=1e-4)


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 14), st.floats(-4.0, 4.0))
def test_orientation_is_the_angle_of_an_antinode(n, angle):
    rings = content(radial_wave(n, angle))
    found = orientation(rings.profile(0, n), n)
    assert 0.0 <= found < np.pi / n
    off = np.mod(found - angle + 0.5 * np.pi / n, np.pi / n) - 0.5 * np.pi / n
    assert abs(off) < 1e-5


def test_orientation_does_not_depend_on_sign_or_on_a_node_circle():
    wave = radial_wave(5, 0.3)
    turned = wave * np.where(GRID.nodes[0] > 0.1, -1.0, 1.0)[:, None]
    rings = content(wave, -wave, turned)
    found = [orientation(rings.profile(k, 5), 5) for k in range(3)]
    np.testing.assert_allclose(found, 0.3, atol=1e-7)


def test_orientation_means_nothing_without_diameters():
    assert np.isnan(orientation(content(radial_wave(0, 0.0)).profile(0, 0), 0))


def test_orientation_at_the_seam_is_zero_not_half_a_wave():
    rings = content(radial_wave(4, -1e-13))
    assert orientation(rings.profile(0, 4), 4) == 0.0


@settings(max_examples=25, deadline=None)
@given(st.floats(0.0, 1.0), st.integers(1, 6), st.integers(7, 12))
def test_purity_is_the_share_of_energy(share, n, other):
    assume(abs(share - 0.5) > 0.01)
    mixed = radial_wave(n, 0.1, np.sqrt(share)) + radial_wave(other, 0.7, np.sqrt(1 - share))
    label, purity = content(mixed).label()
    assert label[0] == (n if share > 0.5 else other)
    assert purity[0] == pytest.approx(max(share, 1 - share), abs=1e-4)


def test_axisymmetric_motion_counts_twice_a_wave_of_equal_amplitude():
    """A constant's mean square is one, a cosine's one half."""
    label, purity = content(radial_wave(0, 0.0) + radial_wave(3, 0.0)).label()
    assert label[0] == 0
    assert purity[0] == pytest.approx(2 / 3, abs=1e-6)


def test_hoop_and_axial_motions_count_too():
    z, theta = GRID.nodes
    hoop = np.cos(6 * theta)
    field = np.stack([-hoop * np.sin(theta), hoop * np.cos(theta), *np.zeros((3, len(z)))], axis=1)
    axial = np.stack([*np.zeros((2, len(z))), np.sin(4 * theta), *np.zeros((2, len(z)))], axis=1)
    assert content(field, axial).label()[0].tolist() == [6, 4]


def test_partners_stand_a_quarter_wave_apart():
    a, b, same = radial_wave(5, 0.1), radial_wave(5, 0.1 + np.pi / 10), radial_wave(5, 0.1)
    rings = content(a, b, same)
    assert quadrature(rings.profile(0, 5), rings.profile(1, 5)) == pytest.approx(1.0, abs=1e-6)
    assert quadrature(rings.profile(0, 5), rings.profile(2, 5)) == pytest.approx(0.0, abs=1e-6)


def test_doublets_are_the_nearest_partners_of_one_n():
    fields = [
        radial_wave(5, 0.1),
        radial_wave(4, 0.2),
        radial_wave(5, 0.1 + np.pi / 10),
        radial_wave(0, 0.0),
        radial_wave(4, 0.2 + np.pi / 8),
        radial_wave(5, 0.1),
    ]
    rings = content(*fields)
    n, _ = rings.label()
    assert find_doublets(rings, n) == [(0, 2), (1, 4)]


@pytest.mark.parametrize(("apart", "pairs"), [(0.45, []), (0.55, [(0, 1)])])
def test_waves_are_partners_where_more_than_half_is_a_quarter_wave_apart(apart, pairs):
    rings = content(radial_wave(5, 0.1), radial_wave(5, 0.1 + np.arcsin(apart) / 5))
    assert find_doublets(rings, np.array([5, 5])) == pairs


def test_weights_of_rings_integrate_along_the_meridian():
    """Over 0 to 1, a ring between two rows counts for both."""
    weights, z = content(radial_wave(2, 0.0)).weights, np.unique(GRID.nodes[0].round(12))
    z = z / z[-1]
    np.testing.assert_allclose([weights @ z**k for k in range(4)], [1.0, 1 / 2, 1 / 3, 1 / 4], rtol=1e-9)


@settings(max_examples=20, deadline=None)
@given(st.floats(-3.0, 3.0), st.integers(1, 9), st.booleans())
def test_a_perfect_pair_is_turned_into_cosine_and_sine(angle, n, swap):
    fields = [radial_wave(n, angle), radial_wave(n, angle + np.pi / (2 * n))]
    fields = fields[::-1] if swap else fields
    rings = content(*fields)
    turned = np.stack(fields, axis=-1) @ align_pair(rings.profile(0, n), rings.profile(1, n))
    np.testing.assert_allclose(turned[:, :, 0], radial_wave(n, 0.0), atol=1e-7)
    np.testing.assert_allclose(turned[:, :, 1], radial_wave(n, np.pi / (2 * n)), atol=1e-7)


def test_a_pair_without_radial_motion_is_turned_and_not_stretched():
    along = np.exp(1j * np.linspace(0.0, 2.0, 4))
    first, second = np.zeros((2, 12), dtype=complex)
    first[4:8], second[4:8] = along, 1j * along
    turn = align_pair(first, second)
    np.testing.assert_allclose(turn.T @ turn, np.eye(2), atol=1e-14)
