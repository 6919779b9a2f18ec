"""Labels and antinodes on a circle of sensors."""

import numpy as np
import pytest

from casingfem.experiment.circle.orientation import Circle, quadrature

EVEN = 2 * np.pi * np.arange(24) / 24
UNEVEN = EVEN + np.radians(np.random.default_rng(31).uniform(-4, 4, 24))
SMALL = 1e-8 * np.eye(24)


def test_even_sensors_end_below_half_their_number_and_uneven_ones_tell_more():
    assert Circle.of(EVEN).n_max == 11
    assert Circle.of(UNEVEN).n_max > 14
    assert Circle.of(EVEN, n_max=5).n_max == 5


@pytest.mark.parametrize("theta", [EVEN, UNEVEN, UNEVEN[[0, 1, 2, 4, 5, 7, 8, 9, 11, 12, 13, 15, 16, 18, 20, 21, 23]]])
@pytest.mark.parametrize("n", [1, 2, 5, 7])
def test_pure_shapes_have_their_n_and_their_antinode(theta, n):
    angle = 0.7 * np.pi / n
    found = Circle.of(theta).label(-2 * np.cos(n * (theta - angle)), 1e-10 * np.eye(len(theta)))
    assert found.n == n
    assert found.purity == pytest.approx(1.0)
    assert found.angle == pytest.approx(angle, abs=1e-6)


def test_a_constant_has_no_antinode():
    found = Circle.of(UNEVEN).label(np.ones(24), SMALL)
    assert found.n == 0
    assert np.isnan(found.angle)


def test_another_n_beside_it_does_not_turn_the_antinode():
    shape = np.cos(6 * (UNEVEN - 0.2)) + 0.3 * np.cos(14 * UNEVEN + 1.0)
    found = Circle.of(UNEVEN).label(shape, SMALL)
    assert found.n == 6
    assert found.angle == pytest.approx(0.2, abs=2e-4)


@pytest.mark.slow
def test_the_uncertainty_is_the_scatter_of_repeated_tests():
    rng = np.random.default_rng(9)
    circle, sigma = Circle.of(UNEVEN), 0.02
    found = [
        circle.label(np.cos(5 * (UNEVEN - 0.3)) + sigma * rng.standard_normal(24), sigma**2 * np.eye(24))
        for _ in range(150)
    ]
    scatter = np.std([label.angle for label in found], ddof=1)
    assert scatter == pytest.approx(float(np.mean([label.sigma for label in found])), rel=0.2)


@pytest.mark.slow
@pytest.mark.parametrize("noise", [1e-5, 0.02])
def test_intervals_hold_beside_other_n_of_many_sizes(noise):
    """150 shapes with all other n, of sizes 1 to 1/25: at 95 % fewer than 133 hold in 1 of 1000 runs."""
    rng, circle, hits, off = np.random.default_rng(58), Circle.of(UNEVEN), 0, []
    for _ in range(150):
        n, at = int(rng.integers(3, 12)), rng.uniform(0, np.pi)
        shape = np.cos(n * (UNEVEN - at)) + noise * rng.standard_normal(24)
        for k, m in enumerate(rng.permutation([m for m in range(26) if m != n]), start=1):
            shape += 0.1 / k * rng.standard_normal(2) @ [np.cos(m * UNEVEN), np.sin(m * UNEVEN)]
        found = circle.label(shape, noise**2 * np.eye(24))
        off.append(np.arcsin(np.sin(n * (found.angle - at))) / n / found.sigma)
        hits += abs(off[-1]) < 1.96
    assert 133 <= hits < 150
    assert 0.5 < np.sqrt(np.mean(np.square(off))) < 1.5


def test_what_no_n_explains_has_no_label():
    found = Circle.of(EVEN, n_max=3).label(np.cos(8 * EVEN), SMALL)
    assert found.n == -1


def test_quadrature():
    assert quadrature(0.1, 0.1 + np.pi / 8, 4) == pytest.approx(1.0)
    assert quadrature(0.1, 0.1 + np.pi / 4, 4) == pytest.approx(0.0, abs=1e-12)


def test_few_uneven_sensors_tell_an_order_above_half_their_number():
    theta = 2 * np.pi * np.arange(12) / 12 + np.radians([0, 3, -2, 4, -4, 1, -3, 2, 4, -1, 3, -4])
    circle = Circle.of(theta)
    assert circle.label(np.cos(7 * (theta - 0.1)), 1e-8 * np.eye(12)).n == 7


def test_two_sensors_tell_nothing():
    circle = Circle.of(np.array([0.0, 1.0]))
    assert circle.n_max == -1
    assert circle.label(np.ones(2), np.eye(2)).n == -1
