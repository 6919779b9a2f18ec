"""Modes without the damping of an exponential window, whose time is given or stands on the card."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.identify.exponential import window_note, window_time, without_window
from casingfem.experiment.identify.mode import Mode


def mode(freq, **changes):
    given = {
        "freq": freq, "sigma_freq": 1.0, "zeta": 0.01, "sigma_zeta": 0.1, "n": 3, "purity": 0.9, "angle": 0.2,
        "sigma_angle": 0.01, "shape": np.array([1.0, 0.0]), "sigma_shape": np.zeros(2), "residues": np.zeros((1, 2)),
        "residue_scale": 1.0, "collinearity": 1.0, "signal": 5.0, "split_bound": 0.1, "double": False,
    }  # fmt: skip
    return Mode(**given | changes)


@pytest.mark.parametrize(("tau", "doubtful"), [(0.2, False), (0.159, True), (0.1, True)])
def test_poles_are_moved_back_by_the_window(tau, doubtful):
    """p + 1/tau: the part of the decay that is left, the damped frequency as it was."""
    before = mode(100.0, zeta=0.012, sigma_zeta=1e-3)
    (found,) = without_window([before], tau)
    pole = 200.0 * np.pi * (-0.012 + 1j * np.sqrt(1.0 - 0.012**2)) + 1.0 / tau
    assert found.freq == pytest.approx(abs(pole) / (2.0 * np.pi), rel=1e-12)
    assert found.zeta == pytest.approx(max(-pole.real, 0.0) / abs(pole), abs=1e-12)
    assert bool(found.reason) is doubtful
    assert "tau = 0.25 s" in window_note(0.25)


def test_damping_is_clear_above_two_standard_deviations():
    tau = 1.0 / (200.0 * np.pi * 0.01)  # 1 %
    for zeta, doubtful in ((0.01199, True), (0.01201, False)):
        (found,) = without_window([mode(100.0, zeta=zeta, sigma_zeta=1e-3, reason="why")], tau)
        added = "; its damping is within the 1 % that the exponential window adds: check tau"
        assert found.reason == "why" + added * doubtful


def test_the_time_of_a_window_is_given_or_read_from_the_last_line_of_the_card():
    card = ["exponential_window_s: 2.0", "other: 3", " exponential_window_s : 4.0 "]
    frfs = cf.frf.FrfSet.from_arrays(kind="frf", x=[1.0], responses=[[1j]], unit="m/N", card=card)
    assert window_time(frfs, None) == 4.0
    assert window_time(frfs, 0.5) == 0.5
    bare = cf.frf.FrfSet.from_arrays(kind="frf", x=[1.0], responses=[[1j]], unit="m/N")
    assert window_time(bare, None) is None
    for wrong in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(cf.errors.InputError, match="above 0"):
            window_time(bare, wrong)
