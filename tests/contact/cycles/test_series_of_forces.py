"""Series of contact forces over a period: max(0, -y/s) against a fine quadrature, also where a gap closes for a moment.

These tests call the series themselves: gaps that close for a part of a sample are drawn, which no scene offers.
"""

import numpy as np
import pytest

from contact.cycles.harmonics import complexes, in_harmonics, in_time, pressed, reals, samples_of

FINE = 1 << 18


def exact(y, own):
    """The series by a fine sum over the period."""
    angle = 2.0 * np.pi * np.arange(FINE) / FINE
    gap = np.real(y[0] + sum(y[h] * np.exp(1j * h * angle) for h in range(1, len(y))))
    return in_harmonics(np.maximum(0.0, -gap / own), len(y) - 1)


def drawn(seed, harmonics):
    rng = np.random.default_rng(seed)
    y = (rng.standard_normal(harmonics + 1) + 1j * rng.standard_normal(harmonics + 1)) / (
        1.0 + np.arange(harmonics + 1)
    )
    y[0] = 0.3 * rng.standard_normal()
    return y


@pytest.mark.parametrize("harmonics", [1, 2, 5, 12])
def test_forces_are_those_of_a_fine_sum(harmonics):
    y = np.array([drawn(seed, harmonics) for seed in range(12)])
    own = np.linspace(0.5, 2.0, 12)
    found = pressed(y, own)
    for k in range(12):
        np.testing.assert_allclose(found.lam[k], exact(y[k], own[k]), atol=2e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("depth", [1e-2, 1e-4, 1e-5, 1e-6])
@pytest.mark.parametrize("place", [0.0, 0.16, 0.3, 0.5, 4.8, 100.5, 509.5, 511.5, 511.99])
def test_a_gap_that_closes_or_opens_for_a_part_of_a_sample_does_so_in_its_series(sign, depth, place):
    """y = +-(1 - depth - cos(theta - place)): closed, or open, over 2 sqrt(2 depth) around a place between samples."""
    at = place * 2.0 * np.pi / samples_of(3)
    y = sign * np.array([[1.0 - depth, -np.exp(-1j * at), 0.0, 0.0]])
    half = np.arccos(1.0 - depth)
    touched = (np.sin(half) - half * np.cos(half)) / np.pi  # mean of cos - cos(half) over the part
    mean = touched if sign > 0.0 else touched + (1.0 - depth)
    (found,) = pressed(y, np.array([1.0])).lam
    assert found[0].real == pytest.approx(mean, rel=1e-6, abs=1e-15)
    first = (half - 0.5 * np.sin(2.0 * half)) / np.pi - (0.0 if sign > 0.0 else 1.0)
    assert found[1] == pytest.approx(first * np.exp(-1j * at), rel=1e-5, abs=1e-12)


def test_gaps_that_never_close_press_nothing_and_those_that_never_open_press_as_springs():
    y = np.array([[2.0, 0.5 + 0.3j, 0.1], [-2.0, 0.5 + 0.3j, 0.1]])
    found = pressed(y, np.array([0.5, 0.25]))
    np.testing.assert_allclose(found.lam[0], 0.0, atol=1e-15)
    np.testing.assert_allclose(found.lam[1], -4.0 * y[1], atol=1e-12)


@pytest.mark.parametrize("harmonics", [2, 5])
def test_derivatives_of_forces_are_their_differences(harmonics):
    y, own, step = np.array([drawn(seed, harmonics) for seed in range(4)]), np.linspace(0.5, 2.0, 4), 1e-6
    found = pressed(y, own)
    unknowns = reals(y)
    for place in range(2 * harmonics + 1):
        moved = np.zeros((2 * harmonics + 1, 4))
        moved[place] = step
        up, down = (pressed(complexes(unknowns + way * moved.ravel(), 4), own).lam for way in (1.0, -1.0))
        np.testing.assert_allclose(found.by[:, :, place], (up - down) / (2.0 * step), atol=1e-6)


def test_series_and_samples_and_real_unknowns_are_each_others_inverse():
    y = np.array([drawn(seed, 6) for seed in range(3)])
    assert samples_of(6) & (samples_of(6) - 1) == 0
    samples = in_time(y, samples_of(6))
    angle = 2.0 * np.pi * np.arange(samples.shape[1]) / samples.shape[1]
    gap = np.real(sum(y[:, h, None] * np.exp(1j * h * angle) for h in range(7)))
    np.testing.assert_allclose(samples, gap, atol=1e-12)
    np.testing.assert_allclose(in_harmonics(samples, 6), np.where(np.arange(7), y, y.real), atol=1e-12)
    np.testing.assert_allclose(complexes(reals(y), 3), np.where(np.arange(7), y, y.real), atol=1e-15)
