"""Residuals of pairs, the phase of their lower member, and their derivatives, on modes whose numbers are given."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.correlation.matches import Match
from casingfem.modal.harmonics import Rings
from casingfem.modal.mode_set import ModeSet
from casingfem.updating.targets import (
    Rates,
    has_angle,
    is_doublet,
    jacobian,
    lower_phase,
    partner_turn,
    radial_amplitudes,
    residual_count,
    values,
    with_model_error,
)

N = 3
WEIGHTS = np.array([0.2, 0.5, 0.3])
PSI = 0.4  # antinode of the lower member, that of the upper one 90/n deg on


def amplitudes(psi=PSI):
    """Of a single n = 1 and a pair of n = 3 with hoop and axial motions, (4, rings, 3, modes)."""
    along = np.array([[1.0, 0.3, 0.1], [0.6, -0.2, 0.05], [0.2, 0.1, 0.3]])  # ring, component
    found = np.zeros((N + 1, 3, 3, 3), dtype=complex)
    found[1, :, :, 0] = along
    for mode, at in ((1, psi), (2, psi + np.pi / (2 * N))):
        found[N, :, :, mode] = along * np.exp(-1j * N * at) * np.array([1.0, 1j, 1.0])
    return found


def pair_of_modes(freq=(100.0, 300.0, 304.0), content=None):
    """Three modes: a single, and a pair of three nodal diameters."""
    nothing = np.full(3, np.nan)
    return ModeSet(
        freq=np.array(freq), fields=np.zeros((0, 5, 3)), nodal_diameters=np.array([1, N, N]), purity=np.ones(3),
        meridional=np.ones(3, dtype=int), doublets=((1, 2),), angle_deg=nothing, rigid=0, sturm_count=None, dofs=0,
        rings=Rings(amplitudes() if content is None else content, WEIGHTS),
    )  # fmt: skip


SINGLE = Match(rows=(1,), modes=(0,), n=1, confidence=1.0, measured_hz=(101.0,), computed_hz=(100.0,))
PAIR = Match(rows=(2, 0), modes=(1, 2), n=N, confidence=1.0, measured_hz=(301.0, 306.0), computed_hz=(300.0, 304.0))


def table(angle=(np.nan, np.nan, 20.0)):
    return cf.FrequencyTable.from_arrays(
        freq_hz=[306.0, 101.0, 301.0], sigma_hz=[0.3, 0.1, 0.4], n=[N, 1, N], angle_deg=angle
    )


def test_residuals_of_a_pair_are_its_mean_and_its_split_vector():
    """sigma = hypot(.3, .4): of the split, and twice that of the mean. Measured lower antinode 20 deg."""
    mean = [np.sqrt((a**2 + b**2) / 2.0) for a, b in ((300.0, 304.0), (301.0, 306.0))]
    split = [(b**2 - a**2) / (2.0 * m) for (a, b), m in zip(((300.0, 304.0), (301.0, 306.0)), mean, strict=True)]
    found = values(pair_of_modes(), table(), [PAIR, SINGLE])
    phase, measured = 2 * N * PSI, 2 * N * np.radians(20.0)
    expected = [
        (mean[0] - mean[1]) / 0.25,
        (split[0] * np.cos(phase) - split[1] * np.cos(measured)) / 0.5,
        (split[0] * np.sin(phase) - split[1] * np.sin(measured)) / 0.5,
        (100.0 - 101.0) / 0.1,
    ]
    np.testing.assert_allclose(found, expected, rtol=1e-9)
    np.testing.assert_allclose(values(pair_of_modes(), table((20.0 + 90.0 / N, np.nan, np.nan)), [PAIR]), expected[:3])
    blind = values(pair_of_modes(), table(np.nan), [SINGLE, PAIR])
    np.testing.assert_allclose(blind, [expected[3], expected[0], (split[0] - split[1]) / 0.5], rtol=1e-12)


def test_a_match_has_one_residual_or_two_or_three():
    half = replace(PAIR, rows=(2,), modes=(1,))
    odd = replace(PAIR, rows=(2, 0), modes=(1,))
    assert [is_doublet(match) for match in (SINGLE, half, odd, PAIR)] == [False, False, False, True]
    assert [residual_count(match, table()) for match in (SINGLE, half, odd, PAIR)] == [1, 1, 1, 3]
    assert [has_angle(PAIR, table(angle)) for angle in ((5.0, np.nan, np.nan), (np.nan, 5.0, np.nan))] == [True, False]
    assert residual_count(PAIR, table((np.nan, 5.0, np.nan))) == 2


@pytest.mark.parametrize("angles", [(np.nan, np.nan, 20.0), (np.nan, np.nan, np.nan)])
def test_slopes_are_those_of_residuals_whose_modes_change_as_the_rates_say(angles):
    """omega^2 by G_ii; the lower shape by its partner's share G_lh/(omega_l^2 - omega_h^2), and by that of others."""
    modes = pair_of_modes()
    G = np.random.default_rng(3).standard_normal((2, 3, 3)) * 4e4
    G = G + G.transpose(0, 2, 1)
    others = np.random.default_rng(4).standard_normal((2, 3, 2)) @ [0.02, 0.03j]  # (parameters, rings)
    low = amplitudes()[N, :, 0, 1]
    turning = -2.0 * np.imag((WEIGHTS * low * others).sum(axis=1) / (WEIGHTS * low**2).sum())
    matches = [PAIR, SINGLE]
    found = jacobian(modes, table(angles), matches, Rates(G, {(1, 2): turning} if np.isfinite(angles).any() else {}))
    squares = modes.omega**2
    for k in range(2):
        ends = []
        for step in (1e-5, -1e-5):
            content = amplitudes()
            share = G[k, 1, 2] / (squares[1] - squares[2])
            content[N, :, 0, 1] += step * (share * content[N, :, 0, 2] + others[k])
            freq = np.sqrt(squares + step * np.diag(G[k])) / (2.0 * np.pi)
            ends.append(values(pair_of_modes(freq, content), table(angles), matches))
        slope = (ends[0] - ends[1]) / 2e-5
        np.testing.assert_allclose(found[:, k], slope, rtol=1e-6, atol=1e-7 * np.abs(slope).max())


def test_the_phase_of_a_pair_is_that_of_its_lower_member():
    assert lower_phase(pair_of_modes(), 1, 2, N) == pytest.approx(2 * N * PSI, rel=1e-12)
    assert lower_phase(replace(pair_of_modes(), rings=None), 1, 2, N) == 0.0


@pytest.mark.parametrize("apart", [0.99e-7, 1.01e-7])
def test_a_perfect_pair_has_no_phase(apart):
    close = pair_of_modes((100.0, 300.0 * (1.0 - apart), 300.0))
    assert (lower_phase(close, 1, 2, N) == 0.0) == (apart < 1e-7)


def test_a_unit_of_the_partner_turns_the_phase_by_twice_its_part_in_quadrature():
    """Of equal shapes a quarter wave apart: the lower one plus p of its partner stands p/n further, 2 n psi by 2 p."""
    assert partner_turn(pair_of_modes(), 1, 2, N) == pytest.approx(2.0, rel=1e-12)
    content = amplitudes()
    content[N, :, 0, 2] *= [0.5, -2.0, 3.0]
    square = WEIGHTS * np.array([1.0, 0.36, 0.04])
    expected = 2.0 * (square @ [0.5, -2.0, 3.0]) / square.sum()
    assert partner_turn(pair_of_modes(content=content), 1, 2, N) == pytest.approx(expected, rel=1e-12)


def test_radial_amplitudes_are_weighted_by_their_rings():
    found = radial_amplitudes(pair_of_modes(), 2, N)
    expected = np.sqrt(WEIGHTS) * [1.0, 0.6, 0.2] * np.exp(-1j * (N * PSI + np.pi / 2))
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    with pytest.raises(ValueError, match="open shell has no doublets"):
        radial_amplitudes(replace(pair_of_modes(), rings=None), 1, N)


def test_the_models_own_error_is_added_to_each_sigma_in_squares():
    rows = table()
    np.testing.assert_allclose(
        with_model_error(rows, 1e-3).sigma_hz, np.hypot([0.3, 0.1, 0.4], [0.306, 0.101, 0.301]), rtol=1e-14
    )
    assert with_model_error(rows, 0.0) is rows
    words = r"0\.9999999, which makes sigma_hz 101 at the 101 Hz of row 2"
    with pytest.raises(cf.errors.InputError, match=words):
        with_model_error(replace(rows, freq_hz=np.array([3e6, 101.0, 3e6])), 0.9999999)
