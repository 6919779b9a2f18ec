"""Contact that stays closed: the mean of a turning compliance, modes that are equal, what turns into itself."""

import math

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring


def test_diameters_of_a_pair_are_none_or_more():
    assert ct.gaps.ModalPair(n=0, freq_hz=1.0, modal_mass=1.0).n == 0
    for n in (-1, 2.5, math.nan, math.inf):
        with pytest.raises(ct.InputError, match=f"n: found {n}, expected a whole number of nodal diameters >= 0"):
            ct.gaps.ModalPair(n=n, freq_hz=1.0, modal_mass=1.0)


@pytest.mark.parametrize("speed_hz", [0.0, 37.0, 81.0])
def test_poles_of_a_disk_in_a_casing_are_those_of_two_coupled_waves(speed_hz):
    """((s - i n Omega)^2 + w_c^2 + K/m_c) (s^2 + w_b^2 + K/m_b) = K^2/(m_c m_b), K = k blades/2, and conjugates."""
    casing, disk = (
        ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.5),
        ct.gaps.ModalPair(n=2, freq_hz=60.0, modal_mass=0.5),
    )
    K, turn = 0.5 * 2e4 * 10, 2j * 2.0 * np.pi * speed_hz
    one = np.poly1d([1.0, -2.0 * turn, turn**2 + casing.omega**2 + K / casing.modal_mass])
    two = np.poly1d([1.0, 0.0, disk.omega**2 + K / disk.modal_mass])
    expected = (one * two - K**2 / (casing.modal_mass * disk.modal_mass)).roots
    found = ct.stability.poles(ct.gaps.disk_contact(casing, disk, stiffness=2e4, blades=10), [speed_hz])[0]
    off = np.abs(np.r_[expected, expected.conj()][:, None] - found).min(axis=1)
    assert len(found) == 8
    assert off.max() < 1e-5 * np.abs(found).max()  # equal poles at rest are split by round-off


def test_bodies_that_are_rigid_beside_their_modes_have_no_closed_contact():
    with pytest.raises(ct.InputError, match="S: found 0 m/N"):
        ct.gaps.rim_contact(ct.RotatingRim(ring(S=0.0), blade(S=0.0), clearance=0.0, speed_hz=5.0))


def test_waves_of_a_rim_are_named_direction_by_direction():
    assert ct.bodies.rim_channels(1, 1) == ("radial.cos0", "radial.cos1", "radial.sin1")
    assert ct.bodies.rim_channels(0, 3) == ("radial.cos0", "tangential.cos0", "axial.cos0")
    assert ct.bodies.rim_channels(0, lines=2) == tuple(
        f"line{k}.{d}.cos0" for k in (0, 1) for d in ("radial", "tangential")
    )
