"""Polynomials and sparse sums of waves, by their definitions."""

import numpy as np
import pytest

from contact.model.trig import Terms, Trig, fourier, harmonics, pruned, quadratic, terms, trig, turned_back

P = Trig(harmonic=np.array([0, 2, 5]), cos=np.array([1.5, -2.0, 0.25]), sin=np.array([0.0, 3.0, -4.0]))


def value(phi):
    return 1.5 - 2.0 * np.cos(2 * phi) + 0.25 * np.cos(5 * phi) + 3.0 * np.sin(2 * phi) - 4.0 * np.sin(5 * phi)


def test_values_degree_and_largest_coefficient():
    assert P(0.7) == pytest.approx(value(0.7), rel=1e-12)
    at = np.array([-0.4, 0.1, 2.2])
    assert P.at(at) == pytest.approx(value(at), rel=1e-12)
    assert (P.degree, P.largest) == (5, 4.0)
    none = fourier([])
    assert (none.degree, none.largest, none(0.3), none.harmonic.size) == (0, 0.0, 0.0, 0)


def test_coefficients_of_round_off_are_left_out():
    found = trig(np.array([0.0, 4.0, 3e-13, 5e-13, 0.0]), np.array([0.0, 0.0, -3e-13, 0.0, -2.0]))
    assert found.harmonic.tolist() == [1, 3, 4]
    assert (found.cos.tolist(), found.sin.tolist()) == ([4.0, 5e-13, 0.0], [0.0, 0.0, -2.0])
    assert trig(np.zeros(3), np.zeros(3)).harmonic.size == 0
    assert trig(np.array([1e-13, 1.0]), np.zeros(2)).harmonic.tolist() == [1]


def test_coefficients_up_to_a_noise_are_taken_away_one_by_one():
    found = pruned(P, 2.0)
    assert found.harmonic.tolist() == [2, 5]
    assert (found.cos.tolist(), found.sin.tolist()) == ([0.0, 0.0], [3.0, -4.0])
    assert pruned(P, 0.25).cos.tolist() == [1.5, -2.0, 0.0]
    assert pruned(P, 1.0).harmonic.tolist() == [0, 2, 5]


def test_waves_of_an_angle_and_of_one_turned_back():
    phi = np.array([[0.3], [-1.1]])
    expected = [1.0, *(f(n * 0.3) for f in (np.cos, np.sin) for n in (1, 2, 3))]
    assert harmonics(3, phi)[0, 0] == pytest.approx(expected, rel=1e-15)
    by = np.array([0.0, 0.9])
    found = turned_back(harmonics(3, phi), by)
    assert found.shape == (2, 2, 1, 7)
    np.testing.assert_allclose(found[1], harmonics(3, phi - 0.9), atol=1e-14)
    np.testing.assert_allclose(found[0], harmonics(3, phi), atol=1e-15)


def test_a_quadratic_form_of_waves_is_a_polynomial_of_twice_their_degree():
    block = np.random.default_rng(3).standard_normal((5, 5))
    found = quadratic(block, 2)
    for phi in (0.0, 0.4, 2.9):
        h = np.array([1.0, np.cos(phi), np.cos(2 * phi), np.sin(phi), np.sin(2 * phi)])
        assert found(phi) == pytest.approx(h @ block @ h, rel=1e-12)
    assert found.degree == 4
    assert quadratic(np.diag([2.0]), 0)(0.7) == pytest.approx(2.0, rel=1e-14)


def test_what_cancels_in_a_quadratic_form_is_left_out():
    """cos^2 - sin^2 = cos 2 phi: no constant; entries of opposite sign leave nothing at all."""
    assert quadratic(np.diag([0.0, 1.0, -1.0]), 1).harmonic.tolist() == [2]
    assert quadratic(np.array([[0.0, 3.0, 0.0], [-3.0, 0.0, 0.0], [0.0, 0.0, 0.0]]), 1).harmonic.size == 0


def test_terms_of_one_harmonic_are_added():
    found = fourier([(2, 1.0, -3.0), (0, 0.5, 0.0), (2, 0.25, 1.0)])
    assert (found.harmonic.tolist(), found.cos.tolist(), found.sin.tolist()) == ([0, 2], [0.5, 1.25], [0.0, -2.0])


def sums():
    """2 cos phi - 3 sin phi, nothing, 4 + 5 sin 2 phi."""
    return terms(np.array([0, 2, 2]), np.array([1, 0, 2]), np.array([2.0, 4.0, 0.0]), np.array([-3.0, 0.0, 5.0]), 3)


def test_sums_of_waves_know_their_owners_and_their_table():
    found = sums()
    assert (found.start.tolist(), found.wave.tolist(), found.value.tolist()) == (
        [0, 2, 2, 4], [2, 3, 0, 5], [2.0, -3.0, 4.0, 5.0],
    )  # fmt: skip
    assert found.sums == 3
    assert found.owner.tolist() == [0, 0, 2, 2]
    assert found.full(6).tolist() == [[0, 0, 2, -3, 0, 0], [0] * 6, [4, 0, 0, 0, 0, 5]]


def test_first_sums_and_sums_in_a_row():
    found = sums()
    two = found.first(2)
    assert (two.start.tolist(), two.wave.tolist(), two.value.tolist()) == ([0, 2, 2], [2, 3], [2.0, -3.0])
    row = two.followed_by(found)
    assert row.full(6).tolist() == [*two.full(6).tolist(), *found.full(6).tolist()]
    assert row.start.tolist() == [0, 2, 2, 4, 4, 6]


@pytest.mark.parametrize("name", ["start", "wave", "value"])
def test_sums_equal_others_to_the_bit(name):
    found, given = sums(), {"start": sums().start, "wave": sums().wave, "value": sums().value}
    assert found.equals(Terms(**given))
    given[name] = given[name].copy()
    given[name][1] += 1
    assert not found.equals(Terms(**given))
