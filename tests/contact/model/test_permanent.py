"""Contact that stays closed: the mean of a turning compliance, modes that are equal, what turns into itself."""

import math

import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring


def test_diameters_of_a_pair_are_none_or_more():
    assert ct.gaps.ModalPair(n=0, freq_hz=1.0, modal_mass=1.0).n == 0
    for n in (-1, 2.5, math.nan, math.inf):
        with pytest.raises(ct.InputError, match=f"n: found {n}, expected a whole number of nodal diameters >= 0"):
            ct.gaps.ModalPair(n=n, freq_hz=1.0, modal_mass=1.0)


def test_bodies_that_are_rigid_beside_their_modes_have_no_closed_contact():
    with pytest.raises(ct.InputError, match="S: found 0 m/N"):
        ct.gaps.rim_contact(ct.RotatingRim(ring(S=0.0), blade(S=0.0), clearance=0.0, speed_hz=5.0))


def test_waves_of_a_rim_are_named_direction_by_direction():
    assert ct.bodies.rim_channels(1, 1) == ("radial.cos0", "radial.cos1", "radial.sin1")
    assert ct.bodies.rim_channels(0, 3) == ("radial.cos0", "tangential.cos0", "axial.cos0")
    assert ct.bodies.rim_channels(0, lines=2) == tuple(
        f"line{k}.{d}.cos0" for k in (0, 1) for d in ("radial", "tangential")
    )
