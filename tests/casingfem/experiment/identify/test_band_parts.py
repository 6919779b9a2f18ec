"""What a band's fit is given and what is taken from it: lines, windows, orders, modes of its core."""

import numpy as np
import pytest

from casingfem.experiment.identify import band_fits
from casingfem.experiment.identify.band_fits import (
    Responses,
    _aligned_fits,
    _by_misfit,
    _modes,
    _picks,
    _residues,
    _sides,
    _sweep,
    _window,
    core_of,
)
from casingfem.experiment.identify.poles.bands import Band
from casingfem.experiment.identify.poles.pole_fit import fit_poles
from casingfem.experiment.identify.poles.pole_selection import alike_lines, noise_at
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.shifted import Shifted

LINES = np.arange(90.0, 112.0, 0.25)
NOISE = np.array([0.5, 2.0, 1.0])


def responses(power=2, along=None):
    """Two modes in three channels, noise of its own in each, (channels, lines)."""
    rng = np.random.default_rng(11)
    freq, zeta = np.array([98.0, 103.0]), np.array([5e-3, 6e-3])
    each = freq**2 / (freq**2 - LINES[:, None] ** 2 + 2j * zeta * freq * LINES[:, None])
    H = (1j * LINES[:, None]) ** power * (each @ np.array([[1.0, -0.5, 0.3], [0.2, 0.8, -0.6]]))
    H = H + NOISE * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    return Responses(LINES, H.T, NOISE, power, np.ones(len(LINES)) if along is None else along)


def test_a_core_ends_before_its_next_line():
    assert core_of(LINES, Band((4, 20), (0, 40), 1)) == (91.0, 95.0)
    assert core_of(LINES, Band((4, 88), (0, 88), 1)) == (91.0, 112.0)


def test_picked_poles_have_the_damping_of_the_nearest_stable_one():
    band, picked = Band((0, 88), (8, 40), 1), np.array([91.9, 92.0, 95.0, 99.75, 99.8])
    stable = np.array([[89.0, 0.1], [94.0, 0.02], [98.0, 0.03]])
    assert _picks(LINES, band, picked, stable).tolist() == [[92.0, 0.02], [95.0, 0.02], [99.75, 0.03]]
    assert _picks(LINES, band, picked, np.zeros((0, 2)))[:, 1].tolist() == [0.002] * 3


def test_modes_lie_inside_a_window_with_its_first_and_last_line():
    modes = Modes(np.array([[91.9], [92.0], [95.0], [99.75], [99.8]]), np.full(5, 0.01), np.ones((5, 3)))
    inside, outside = _sides(responses(), Band((9, 30), (8, 40), 1), modes)
    assert inside.tolist() == [[92.0, 0.01], [95.0, 0.01], [99.75, 0.01]]
    assert outside.freq.tolist() == [[91.9], [99.8]]


@pytest.mark.parametrize(
    ("count", "peaks", "order", "most"),
    [(80, 1, None, 11), (80, 1, 5, 5), (59, 1, None, 9), (88, 20, None, 14), (88, 0, None, 8)],
)
def test_a_sweep_has_eight_orders_and_three_for_each_peak_or_a_sixth_of_the_lines(
    monkeypatch, count, peaks, order, most
):
    asked = []
    monkeypatch.setattr(band_fits, "lscf_poles", lambda freq, H, order: asked.append((freq, H, order)))
    monkeypatch.setattr(band_fits, "stabilise", lambda swept, freq, H: (freq, H))
    data = responses()
    freq, weighted = _sweep(data, Band((5, 20), (4, 4 + count), peaks), order)
    lines = slice(4, 4 + count)
    assert asked[0][2] == most
    np.testing.assert_array_equal(freq, LINES[lines])
    np.testing.assert_allclose(weighted, data.H[:, lines] / NOISE[:, None], rtol=1e-14)


def test_a_window_is_weighted_by_noise_and_lines_and_knows_no_mode_outside():
    along = np.linspace(0.4, 1.0, len(LINES))
    data = responses(along=along)._replace(leak=0.3)
    band = Band((5, 20), (4, 60), 1)
    plain = _window(data, band)
    want = (data.H[:, 4:60] / NOISE[:, None] * along[4:60]).T
    np.testing.assert_allclose(plain.as_complex, want, rtol=1e-14)
    assert (plain.power, plain.residues, plain.leak) == (2, "real", 0.3)
    np.testing.assert_allclose(plain.weight, 1.0 / NOISE)
    assert plain.floor == pytest.approx(3e-4 * np.sqrt(0.5 * np.mean(np.abs(want) ** 2)), rel=1e-12)
    other = Modes(np.array([[108.0]]), np.array([0.01]), np.array([[0.3, 0.2j, -0.1]]))
    less = _window(data, band, other)
    f, gone = LINES[4:60, None], 0.0
    for by, share in ((-0.3, 1 / 6), (0.0, 2 / 3), (0.3, 1 / 6)):
        x = f + by
        gone = gone + share * (1j * x) ** 2 * 108.0**2 / (108.0**2 - x**2 + 2j * 0.01 * 108.0 * x)
    gone = gone * along[4:60, None] * other.residues / NOISE
    np.testing.assert_allclose(less.as_complex, want - gone, rtol=1e-9)


def test_modes_of_a_core_alone_are_taken_and_bands_without_fit_have_none():
    data, band = responses(), Band((0, 52), (0, 88), 2)
    fit = fit_poles(_window(data, band), np.array([98.0, 103.0]), np.array([5e-3, 6e-3]), steps=0)
    one = _modes(data, [band, band], [None, fit])  # the core ends at 103 Hz
    assert (one.freq.tolist(), one.zeta.tolist()) == ([[98.0]], [5e-3])
    scale = LINES.mean()
    np.testing.assert_allclose(one.residues, fit.A[0] * NOISE / scale**2, rtol=1e-12)
    assert _modes(data, [Band((33, 53), (0, 88), 2)], [fit]).freq.tolist() == [[103.0]]
    together = _modes(data, [Band((32, 53), (0, 88), 2)], [fit])
    assert together.freq.tolist() == [[98.0], [103.0]]
    assert together.zeta.tolist() == [5e-3, 6e-3]
    window = fit.window
    back = _residues(window, together.residues)
    np.testing.assert_allclose(back, fit.A, rtol=1e-12)


def test_what_a_fit_leaves_about_a_pole_raises_its_sigma():
    data, band = responses(), Band((0, 88), (0, 88), 2)
    fit = fit_poles(_window(data, band), np.array([98.0, 103.2]), np.array([5e-3, 6e-3]), steps=0)
    want = [np.sqrt(noise_at(fit, k) / fit.noise * alike_lines(fit, k)) for k in range(2)]
    np.testing.assert_allclose(_by_misfit(fit), want, rtol=1e-12)


SETUPS = [np.array([0, 2]), np.array([1])]


@pytest.mark.parametrize("known", [1e-9, 1e-2])
@pytest.mark.parametrize("waves", [False, True])
def test_fits_of_aligned_data_know_what_set_ups_differ_by(known, waves):
    """A standard deviation is that of the set-ups or of white noise, raised by what is not white, once."""
    along = np.linspace(0.4, 1.0, len(LINES))
    along[50] = 0.0
    freq, zeta = np.array([[98.0, 98.4], [103.0, 102.7]]), np.array([5e-3, 6e-3])
    residues = 1e-3 * np.array([[1.0, -0.5, 0.3], [0.2, 0.8, -0.6]]) + 0j
    data = responses(along=along)
    seen = _window(data, Band((0, 88), (0, 88), 2))
    modes = Modes(freq, zeta, residues)
    rng = np.random.default_rng(19)
    missed = Modes(np.array([[104.0, 104.0]]), np.array([8e-3]), 5e-5 * np.array([[1.0, -0.5, 0.8]]) + 0j)
    H = modes.response(seen, SETUPS) + missed.response(seen, SETUPS)
    H = H + along[:, None] * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    data = data._replace(H=(H * NOISE / np.where(along > 0.0, along, 1.0)[:, None]).T)
    whole = _window(data, Band((0, 88), (0, 88), 2))
    each = np.array([0.3, 0.7])
    mean = {"mean_freq": np.exp(np.log(freq).mean(axis=1)), "sigma_mean": known * np.array([1.0, 2.0]),
            "rival": 0.1 * each} if waves else {}  # fmt: skip
    variance, worth = np.full((2, 2), known**2), 10.0 * each
    told = modes, variance, 3.0 * known * each, 0.01 * each, worth, SETUPS, 0.0, known, 9.0
    found = Shifted(*told, **mean)
    bands = [Band((0, 40), (0, 88), 1), Band((40, 88), (10, 88), 1)]
    first, second = _aligned_fits(data, bands, found, whole)
    straight = found.aligned(whole)
    centre, sigma = found.mean()
    for fit, lines in ((first, slice(0, 88)), (second, slice(10, 88))):
        plain = fit_poles(straight.cut(lines), centre, zeta, steps=0)
        np.testing.assert_allclose(fit.window.Y, straight.cut(lines).Y, atol=1e-9)
        np.testing.assert_allclose(fit.freq, centre, rtol=1e-14)
        np.testing.assert_allclose(fit.zeta, zeta, rtol=1e-14)
        np.testing.assert_allclose(fit.A[:, 0], residues.real / NOISE * fit.window.scale**2, rtol=1e-12)
        assert (fit.matching.tolist(), fit.worth.tolist()) == ((0.01 * each).tolist(), (10.0 * each).tolist())
        assert fit.rival.tolist() == ((0.1 * each).tolist() if waves else [0.0, 0.0])
        np.testing.assert_allclose(fit.seen, found.seen(), rtol=1e-12)
        np.testing.assert_allclose(fit.apart, found.apart(np.array([1]), np.array([0])), rtol=1e-12)
        white = np.sqrt(plain.noise * np.diag(plain.covariance)) / plain.raised
        misfit = np.sqrt([noise_at(plain, k) / plain.noise * alike_lines(plain, k) for k in range(2)])
        assert np.any(np.tile(misfit, 2) > 1.1 * plain.raised)
        least = 0.0 if waves else 1.0
        want = np.maximum(np.tile(misfit, 2), plain.raised) * np.maximum(np.r_[sigma, found.sigma_zeta], least * white)
        np.testing.assert_allclose(np.sqrt(fit.noise * np.diag(fit.covariance)), want, rtol=1e-6)
        ratio = fit.covariance / np.sqrt(np.outer(np.diag(fit.covariance), np.diag(fit.covariance)))
        usual = plain.covariance / np.sqrt(np.outer(np.diag(plain.covariance), np.diag(plain.covariance)))
        np.testing.assert_allclose(ratio, usual, rtol=1e-6, atol=1e-9)
