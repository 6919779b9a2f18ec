"""What a verdict is given: what a pole is worth, and what the fit leaves about it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from casingfem.experiment.identify import verdict
from casingfem.experiment.identify.poles.pole_fit import fit_poles
from casingfem.experiment.identify.poles.pole_selection import gains, penalty
from casingfem.experiment.identify.verdict import _misfit, verdicts
from tests.casingfem.experiment.identify.test_mode_numbers import fitted
from tests.casingfem.experiment.identify.test_verdict_bounds import beside, noisy

WORDS = "hardly above what the fit leaves, whose lines are alike"


@pytest.mark.parametrize(("factor", "doubtful"), [(2.99, True), (3.01, False)])
@pytest.mark.parametrize("by_setups", [False, True])
def test_a_pole_is_worth_the_more_of_what_it_takes_here_and_over_the_set_ups(factor, doubtful, by_setups):
    """The noise is so high that the first of two poles gains so many times its price, the second much less."""
    fit = fitted("real")
    fit = replace(fit, A=fit.A * np.array([1.0, 0.05])[:, None, None])
    own = gains(replace(fit, window=replace(fit.window, floor=1e6)))[0] * 1e12 / penalty(fit.window)
    floor = np.sqrt(own / (0.01 if by_setups else factor))
    fit = replace(fit, window=replace(fit.window, floor=floor), worth=np.array([factor, 0.0]) * by_setups)
    first, second = verdicts(fit, [1.0, 1.0])
    assert (WORDS in first[0]) is doubtful
    assert WORDS in second[0]


def test_no_poles_have_no_verdict():
    assert verdicts(fit_poles(fitted("real").window, np.zeros(0), np.zeros(0)), []) == []


@pytest.mark.parametrize("floor", [0.0, 2.0])
def test_a_misfit_is_the_mean_square_about_a_pole_over_the_noise_of_neighbouring_lines(floor):
    rng = np.random.default_rng(23)
    spread = rng.standard_normal((100, 3)) + 1j * rng.standard_normal((100, 3)) + 2.0
    fit = noisy(spread)
    fit.window.floor = floor
    about = spread[38:62]
    third = np.abs(np.diff(about, 3, axis=0))
    noise = np.mean((np.median(third, axis=0) / np.sqrt(40.0 * np.log(2.0))) ** 2)
    want = 0.5 * np.mean(np.abs(about) ** 2) / max(noise, floor**2)
    assert _misfit(fit, 0) == pytest.approx(want, rel=1e-12)
    assert _misfit(noisy(0.0 * spread), 0) == 0.0


@pytest.mark.parametrize(("lines", "told"), [(7, False), (8, True)])
def test_eight_lines_about_a_pole_tell_its_noise(lines, told):
    rng = np.random.default_rng(24)
    spread = rng.standard_normal((lines, 2)) + 1j * rng.standard_normal((lines, 2))
    assert (_misfit(noisy(spread, freq=3.0), 0) > 0.0) is told


@pytest.mark.parametrize(("size", "low"), [(0.168, True), (0.17, False)])
def test_a_low_peak_is_below_the_skirt_of_the_higher_one(monkeypatch, size, low):
    """2.99 bandwidths off that is 1/hypot(1, 5.8) of its peak."""
    assert bool(beside(monkeypatch, away=2.99, mac=0.81, size=size)) is low


@pytest.mark.parametrize(("turn", "alike"), [(1.0, True), (-1.0, False)])
def test_shapes_are_alike_with_both_parts(monkeypatch, turn, alike):
    """Of one real part, their imaginary parts equal or opposite."""
    monkeypatch.setattr(verdict, "_misfit", lambda *_: 1.0)
    real, imaginary = np.eye(8)[:2]
    A = np.array([[0.1 * real, 0.1 * imaginary], [real, turn * imaginary]])
    fit = SimpleNamespace(freq=np.array([100.0, 101.0]), zeta=np.array([0.01, 0.01]), A=A)
    assert bool(list(verdict._beside(fit, 0))) is alike
