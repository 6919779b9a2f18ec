"""Travelling waves: against modes at rest, a ring in closed form, a rigid drum, a complete count."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from reports.verification import rotation as verify_rotation
from reports.verification.rotation import drum, in_plane, ring_waves

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)


@pytest.fixture(scope="module")
def casing():
    return cf.Shell(chart=cf.Frustum(r_base=0.20, r_top=0.18, height=0.1), thickness=3e-3, material=STEEL,
                    supports={"base": cf.Clamped()}, mesh=cf.ShellMesh(order=7, rows=1, around=9),
                    rotation=cf.Rotation(omega=200.0))  # fmt: skip


@pytest.mark.slow
def test_hardly_turning_the_modes_are_those_at_rest(casing):
    slow = replace(casing, rotation=cf.Rotation(omega=1e-3))
    found = cf.whirl_modes(slow, 6)
    np.testing.assert_allclose(found.freq, cf.modes(replace(casing, rotation=None), 6, method="shell").freq, rtol=1e-5)


@pytest.mark.slow
def test_turning_the_other_way_is_the_same_seen_in_a_mirror(casing):
    one, other = (cf.whirl_modes(replace(casing, rotation=cf.Rotation(omega=omega)), 4) for omega in (200.0, -200.0))
    np.testing.assert_allclose(one.freq, other.freq, rtol=1e-9)
    np.testing.assert_array_equal(one.sense, other.sense)


@pytest.mark.slow
def test_an_observer_at_rest_sees_forward_waves_faster(casing):
    found = cf.whirl_modes(casing, 4)
    turns = 200.0 / (2.0 * np.pi)
    np.testing.assert_allclose(found.freq_fixed, found.freq + found.sense * found.nodal_diameters * turns, rtol=1e-12)


@pytest.mark.slow
def test_ring_waves_reach_the_closed_form_with_the_speed_squared():
    """What is left is the ring's stretch, of the order of its strain rho Omega^2 R^2/E."""
    gaps = []
    for omega in (60.0, 240.0):
        k = 1.5 * omega**2
        found = cf.whirl_modes(drum(0.5, 0.004, 0.002, omega, k), 18)
        still = 3 * 8 / np.sqrt(10.0) * np.sqrt(210e9 * 0.002**2 / 12 / 7800.0) / 0.25
        gaps.append(in_plane(found, 3, 1) / ring_waves(3, omega, still=still, springs=k)[0] - 1.0)
    strain = 7800.0 * 240.0**2 * 0.25 / 210e9
    assert abs(gaps[1]) < 3.0 * strain
    assert gaps[1] / gaps[0] == pytest.approx(16.0, rel=0.35)


@pytest.mark.slow
def test_counts_out_of_reach_are_refused(casing):
    with pytest.raises(cf.errors.NumericsError, match="count must lie"):
        cf.whirl_modes(casing, 0)


@pytest.mark.campaign
def test_report_prints_a_campbell_table(tmp_path, capsys):
    verify_rotation.main(tmp_path, quick=True)
    assert "Southwell" in capsys.readouterr().out
    assert (tmp_path / "campbell.csv").exists()
