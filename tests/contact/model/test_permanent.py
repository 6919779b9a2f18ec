"""Contact that stays closed: the mean of a turning compliance, modes that are equal, what turns into itself."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.model.bodies.modal_body import rim_channels
from contact.model.gaps.permanent import (
    ClosedContact,
    SplitError,
    _generator,
    equal_modes,
    mean_compliance,
    rub_contact,
)
from contact.model.gaps.rub_system import rub_system
from tests.contact.synthetic_rim import blade, flap_blade, ring
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
    assert closed([[1e-300]]).compliance(1.0).tolist() == [[1e-300]]
    assert closed([[1.0, 0.0], [1.9, 1.0]]).compliance(1.0).tolist() == [[1.0, 0.0], [1.9, 1.0]]


def test_bodies_that_are_rigid_beside_their_modes_have_no_closed_contact():
    with pytest.raises(ct.InputError, match="S: found smallest compliance 0 m/N, expected > 0"):
        ct.gaps.rim_contact(ct.RotatingRim(ring(S=0.0), blade(S=0.0), clearance=0.0, speed_hz=5.0))


def tables(alpha=0.0):
    """Radial and tangential waves of a pair of n = 2, turned by an angle of its own, and of a breathing mode."""
    c, s = math.cos(alpha), math.sin(alpha)
    cos, sin = np.zeros((3, 3)), np.zeros((3, 3))
    cos[2, :2], sin[2, :2], cos[0, 2] = [3.0 * c, -3.0 * s], [3.0 * s, 3.0 * c], 5.0
    hoop_cos, hoop_sin = np.zeros((3, 3)), np.zeros((3, 3))
    hoop_cos[2, :2], hoop_sin[2, :2] = [1.5 * s, 1.5 * c], [-1.5 * c, 1.5 * s]
    return [cos, sin, hoop_cos, hoop_sin]


@pytest.mark.parametrize("alpha", [0.0, 0.7])
def test_a_pair_turns_into_itself_by_its_number_of_waves(alpha):
    G, left = _generator(np.array([4.0, 4.0, 9.0]), np.zeros(3), tables(alpha))
    np.testing.assert_allclose(G, [[0, 2, 0], [-2, 0, 0], [0, 0, 0]], atol=1e-12)
    assert left < 1e-12
    apart, left = _generator(np.array([4.0, 4.1, 9.0]), np.zeros(3), tables(alpha))
    assert not apart.any()
    assert left == pytest.approx(1.0)
    assert _generator(np.array([1.0]), np.zeros(1), [np.ones((1, 1)), np.zeros((1, 1))]) == (np.zeros((1, 1)), 0.0)


def test_what_turns_leave_counts_by_the_slope_of_the_rows():
    """A first wave of .06 beside a second of 3: slopes of .06 and 6 each way."""
    cos, sin, hoop_cos, hoop_sin = tables()
    cos[1, 0] = 0.06
    _, left = _generator(np.array([4.0, 4.0, 9.0]), np.zeros(3), [cos, sin, hoop_cos, hoop_sin])
    size = math.sqrt(2.0 * 36.0 + 2.0 * 9.0 + 0.06**2)
    assert left == pytest.approx(math.hypot(0.06, 2.0 * 0.06) / size, rel=1e-3)


def rub(**more):
    tips = (ct.ContactPoint(angle_deg=25.0, lean_deg=15.0), ct.ContactPoint(blade=1, angle_deg=200.0))
    return ct.Rub(ring(), (blade(), blade(psi=0.6)), tips, **more)


def test_a_closed_rub_has_its_rows_where_its_tips_stand():
    contact, scene = rub_contact(rub(), mu=0.2), rub()
    assert (contact.casing, contact.mu) == (10, 0.2)
    np.testing.assert_array_equal(contact.omega, np.r_[ring().omega, blade().omega, blade().omega])
    n = np.arange(1, 7)
    for j, (tip, body) in enumerate(zip(scene.tips, scene.blades, strict=True)):
        phi = math.radians(tip.angle_deg)
        waves = np.r_[1.0, np.cos(n * phi), np.sin(n * phi)]
        normal, tangent = tip.directions(body) @ body.rows
        at = slice(10 + 2 * j, 12 + 2 * j)
        for row, casing, own in ((contact.Q[j], ring().rows[:13], normal), (contact.T[j], ring().rows[13:], tangent)):
            np.testing.assert_allclose(row[:10], waves @ casing, atol=1e-12)
            np.testing.assert_allclose(row[at], -own, rtol=1e-12)
            assert np.count_nonzero(row[10:]) == np.count_nonzero(own)
    system = rub_system(scene, 2)
    S, varies = mean_compliance(system, 6)
    np.testing.assert_allclose(contact.S_nn, S[::2, ::2], rtol=1e-12)
    np.testing.assert_allclose(contact.S_nt, S[::2, 1::2], rtol=1e-12)
    assert varies < 1e-12
    assert rub_contact(rub()).mu == 0.0


def test_the_turn_of_a_casing_moves_its_rows():
    """Q exp(G phi) are the rows of tips that stand further by phi."""
    from scipy.linalg import expm

    contact, phi = rub_contact(rub()), 0.3
    tips = [replace(tip, angle_deg=tip.angle_deg + math.degrees(phi)) for tip in rub().tips]
    further = rub_contact(replace(rub(), tips=tips))
    np.testing.assert_allclose(contact.Q @ expm(contact.G * phi), further.Q, atol=1e-9)
    np.testing.assert_allclose(contact.T @ expm(contact.G * phi), further.T, atol=1e-9)


def test_pairs_apart_by_more_than_a_hundred_millionth_are_split():
    casing = ring()
    for apart, split in ((0.9e-8, False), (1.2e-8, True)):
        omega = casing.omega * np.where(np.arange(10) % 2, 1.0 + apart, 1.0)
        scene = replace(rub(), casing=replace(casing, omega=omega))
        if split:
            with pytest.raises(
                SplitError, match=r"found pairs that do not turn into themselves \(1\.0e\+00 of the rows"
            ):
                rub_contact(scene)
        else:
            rub_contact(scene)


def contact(**more):
    given = {"omega": [1.0, 2.0], "zeta": [0.0, 0.1], "G": np.zeros((2, 2)), "Q": [[1.0, -2.0]], "T": [[0.5, 3.0]],
             "S_nn": [[0.2]], "S_nt": [[0.05]], "casing": 1}  # fmt: skip
    return ClosedContact(**given | more)


def test_what_contact_forces_push_and_give_by_sense():
    one = contact(mu=0.4)
    for sense in (1.0, -1.0):
        W = np.array([[1.0 - 0.2 * sense, -2.0 - 1.2 * sense]])
        np.testing.assert_allclose(one.pushes(sense), W, rtol=1e-14)
        np.testing.assert_allclose(one.compliance(sense), [[0.2 - 0.02 * sense]], rtol=1e-14)
    assert contact().mu == 0.0
    assert not one.Q.flags.writeable


@pytest.mark.parametrize(
    ("name", "value"),
    [("zeta", [0.0]), ("G", np.zeros((2, 3))), ("Q", [[1.0, 2.0, 3.0]]), ("T", [[1.0]]), ("S_nn", np.eye(2)),
     ("S_nt", np.zeros((2, 2))), ("mu", -0.1)],
)  # fmt: skip
def test_arrays_of_a_closed_contact_fit_each_other(name, value):
    with pytest.raises(ct.InputError, match=f"{name}: found"):
        contact(**{name: value})


def test_waves_of_a_rim_are_named_direction_by_direction():
    assert rim_channels(1, 1) == ("radial.cos0", "radial.cos1", "radial.sin1")
    assert rim_channels(0, 3) == ("radial.cos0", "tangential.cos0", "axial.cos0")
    assert rim_channels(0, lines=2) == tuple(f"line{k}.{d}.cos0" for k in (0, 1) for d in ("radial", "tangential"))


def test_blades_of_unlike_numbers_of_modes_have_their_own_rows():
    blades = (flap_blade(), blade())
    found = rub_contact(ct.Rub(ring(), blades, [ct.ContactPoint(blade=k, angle_deg=90.0 * k) for k in (0, 1)]))
    assert found.Q[0, 10:].tolist() == [0.0, 0.0, 0.0]
    assert found.T[0, 10:].tolist() == [-1.0, 0.0, 0.0]
    np.testing.assert_allclose(found.Q[1, 10:], [0.0, *-blade().rows[0]], rtol=1e-14)
    np.testing.assert_allclose(found.T[1, 10:], [0.0, *-blade().rows[1]], rtol=1e-14)


def test_a_compliance_varies_by_the_largest_way_it_leaves_its_mean_up_or_down():
    """By d (cos^2 phi + cos^2 2 phi), which leaves its mean by d (cos 2 phi + cos 4 phi)/2: d one way, 9 d/16 other."""
    casing, d = ring(), 2e-9
    S = casing.S - d * np.diag(np.isin(np.arange(26), [1, 2]))
    for sense in (1.0, -1.0):
        one = ct.Rub(replace(casing, S=casing.S + sense * (S - casing.S)), (blade(),))
        mean, varies = mean_compliance(rub_system(one, 2), 6)
        assert varies == pytest.approx(d / np.abs(mean).max(), rel=1e-9)
        assert mean[0, 0] == pytest.approx(7e-8 - sense * d + 2e-8, rel=1e-12)
