"""Contact that stays closed: the mean of a turning compliance, modes that are equal, what turns into itself."""

import math

import numpy as np
import pytest

import contact as ct
from contact.model.gaps.permanent import ClosedContact, equal_modes, mean_compliance
from contact.model.gaps.rub_system import rub_system
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import N_MAX, nodes, rim3, tips


def test_the_mean_compliance_of_a_turn_is_that_over_many_angles():
    system = rub_system(ct.Rub(rim3(), (nodes(2),), tips(2)), 2)
    mean, varies = mean_compliance(system, N_MAX)
    around = np.array([system.compliance(turned) for turned in 2.0 * np.pi * np.arange(997) / 997])
    np.testing.assert_allclose(mean, around.mean(axis=0), rtol=1e-10, atol=1e-12 * np.abs(mean).max())
    most = np.abs(around - mean).max() / np.abs(mean).max()
    assert 0.8 * most < varies <= most * (1.0 + 1e-9)


@pytest.mark.parametrize(("apart", "groups"), [(1e-9, [[0, 1], [2]]), (1e-6, [[0], [1], [2]])])
def test_modes_are_equal_to_eight_digits_and_in_damping(apart, groups):
    omega = np.array([100.0, 100.0 * (1.0 + apart), 300.0])
    assert [group.tolist() for group in equal_modes(omega, np.full(3, 0.01))] == groups
    assert [group.tolist() for group in equal_modes(omega, np.array([0.01, 0.02, 0.01]))] == [[0], [1], [2]]


def test_diameters_of_a_pair_are_none_or_more():
    assert ct.gaps.ModalPair(n=0, freq_hz=1.0, modal_mass=1.0).n == 0
    for n in (-1, 2.5, math.nan, math.inf):
        with pytest.raises(ct.InputError, match=f"n: found {n}, expected a whole number of nodal diameters >= 0"):
            ct.gaps.ModalPair(n=n, freq_hz=1.0, modal_mass=1.0)


def closed(S):
    return ClosedContact(omega=[1.0], zeta=[0.0], G=[[0.0]], Q=[[1.0]] * len(S), T=[[0.0]] * len(S), S_nn=S,
                         S_nt=np.zeros((len(S), len(S))), casing=0)  # fmt: skip


@pytest.mark.parametrize(
    ("S", "lowest"),
    [([[0.0]], "0"), ([[-1e-9]], "-1e-09"), ([[1.0, 2.0], [2.0, 1.0]], "-1"), ([[1.0, 0.0], [4.0, 1.0]], "-1")],
)
def test_a_closed_contact_gives_way_whatever_presses_it(S, lowest):
    """The mean of both couplings counts: forces do no work beside it."""
    with pytest.raises(ct.InputError, match=rf"S: found smallest compliance {lowest} m/N, expected > 0"):
        closed(S)


def test_a_closed_contact_is_one_or_more():
    none = {"Q": np.zeros((0, 1)), "T": np.zeros((0, 1)), "S_nn": np.zeros((0, 0)), "S_nt": np.zeros((0, 0))}
    with pytest.raises(ct.InputError, match="Q: found no contact, expected a row for each of one or more"):
        ClosedContact(omega=[1.0], zeta=[0.0], G=[[0.0]], casing=0, **none)


def test_a_closed_contact_may_give_way_by_next_to_nothing():
    assert closed([[1e-300]]).joined(1.0) == pytest.approx(np.array([[1e300]]), rel=1e-14)
    assert closed([[1.0, 0.0], [1.9, 1.0]]).joined(1.0) == pytest.approx(np.array([[0.1]]), rel=1e-12)


def test_bodies_that_are_rigid_beside_their_modes_have_no_closed_contact():
    with pytest.raises(ct.InputError, match="S: found smallest compliance 0 m/N, expected > 0"):
        ct.gaps.rim_contact(ct.RotatingRim(ring(S=0.0), blade(S=0.0), clearance=0.0, speed_hz=5.0))
