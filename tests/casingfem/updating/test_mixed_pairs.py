"""Rows paired by the shares of their n, and a casing brought to its baseline: on modes whose content is given."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.correlation.matches import Match
from casingfem.modal.affine import AffineModes
from casingfem.modal.harmonics import Rings
from casingfem.updating.calibration import correction, paired_by_shares

N = 8  # the highest n that labels know


def waves(*modes):
    """Radial content of modes, each n -> (amplitude, antinode), on one ring: (N + 1, 1, 3, modes)."""
    found = np.zeros((N + 1, 1, 3, len(modes)), dtype=complex)
    for mode, content in enumerate(modes):
        for n, (size, psi) in content.items():
            found[n, 0, 0, mode] = size * np.exp(-1j * n * psi)
    return found


def found_modes(freq, *modes, doublets=(), rigid=0):
    count = len(modes)
    return AffineModes(
        freq=np.array(freq, dtype=float), fields=np.zeros((0, 5, count)), purity=np.ones(count), doublets=doublets,
        nodal_diameters=np.array([max(mode) for mode in modes]), meridional=np.ones(count, dtype=int),
        angle_deg=np.full(count, np.nan), rigid=rigid, sturm_count=None, dofs=count,
        rings=Rings(waves(*modes), np.ones(1)), coordinates=np.eye(count),
    )  # fmt: skip


def paired(found, freq, n, reach=0.3, angle=np.nan):
    table = cf.FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=0.1, n=n, angle_deg=angle)
    matches, lost = paired_by_shares(found, table, reach)
    return [(match.rows, match.modes) for match in matches], lost


@pytest.mark.parametrize("by", [1.0 - 1e-6, 1.0 + 1e-6])
def test_a_row_goes_to_the_mode_of_least_distance_and_wrong_share(by):
    """Energies of n = 5 of .6 and .45: a row between both is as near to either where its distances differ so much."""
    found = found_modes(
        [100.0, 103.0],
        {5: (np.sqrt(0.6), 0.1), 8: (np.sqrt(0.4), 0.2)},
        {5: (np.sqrt(0.45), 0.3), 3: (np.sqrt(0.55), 0.4)},
    )
    even = np.sqrt(100.0 * 103.0 * np.exp(0.05 * 0.15))
    assert paired(found, [by * even], [5]) == ([((0,), (0 if by < 1.0 else 1,))], [])


@pytest.mark.parametrize(("n", "mode"), [(0, 0), (N, 1), (-1, 2), (N + 1, 2)])
def test_a_row_whose_n_is_not_known_goes_to_the_nearest(n, mode):
    """A row at 102 between modes of n = 0, n = N and another one, which is nearest."""
    found = found_modes([101.0, 103.0, 102.1], {0: (1.0, 0.0)}, {N: (1.0, 0.0)}, {4: (1.0, 0.0)})
    assert paired(found, [102.0], [n]) == ([((0,), (mode,))], [])


@pytest.mark.parametrize("by", [1.0 - 1e-9, 1.0 + 1e-9])
@pytest.mark.parametrize("up", [True, False])
def test_a_row_beyond_reach_stands_for_nothing(by, up):
    factor = 1.0 + 0.3 * by
    freq = 100.0 * factor if up else 100.0 / factor
    expected = ([((1,), (0,))], [0]) if by < 1.0 else ([], [0, 1])
    assert paired(found_modes([100.0], {5: (1.0, 0.0)}), [900.0, freq], [3, 5]) == expected


def test_rigid_motions_stand_for_no_row():
    found = found_modes([100.0, 110.0, 120.0], *({5: (1.0, 0.0)} for _ in range(3)), rigid=2)
    assert paired(found, [100.0], [5]) == ([((0,), (2,))], [])


@pytest.mark.parametrize(("apart", "pairs"), [(0.501, [((0, 1), (0, 1))]), (0.499, [((0,), (0,)), ((1,), (1,))])])
def test_two_rows_of_a_pair_are_a_pair_where_their_modes_stand_a_quarter_wave_apart(apart, pairs):
    """By more than half: the sine of their phase."""
    found = found_modes([100.0, 101.0], {5: (1.0, 0.1)}, {5: (1.0, 0.1 + np.arcsin(apart) / 5)})
    assert paired(found, [100.2, 100.9], [5, 5]) == (pairs, [])


def test_a_match_of_shares_tells_its_rows_ascending_with_their_modes():
    found = found_modes([100.0, 102.0, 300.0], {5: (1.0, 0.1)}, {5: (1.0, 0.1 + np.pi / 10)}, {7: (1.0, 0.0)})
    table = cf.FrequencyTable.from_arrays(freq_hz=[100.5, 101.0, 310.0], sigma_hz=0.1, n=[5, 5, 7])
    pair, single = paired_by_shares(found, table, 0.3)[0]
    assert (pair.rows, pair.modes, pair.n) == ((0, 1), (0, 1), 5)
    assert (pair.measured_hz, pair.computed_hz) == ((100.5, 101.0), (100.0, 102.0))
    assert (single.rows, single.modes, single.n, single.measured_hz) == ((2,), (2,), 7, (310.0,))


PAIR = found_modes(
    [100.0, 101.0, 150.0], {5: (1.0, 0.1)}, {5: (0.7, 0.1 + np.pi / 10)}, {7: (1.0, 0.0)}, doublets=((0, 1),)
)
MATCH = Match(rows=(0, 1), modes=(0, 1), n=5, confidence=1.0, measured_hz=(), computed_hz=())


def baseline(angle):
    return cf.FrequencyTable.from_arrays(freq_hz=[98.0, 103.0, 160.0], sigma_hz=0.1, n=[5, 5, 7], angle_deg=angle)


@pytest.mark.parametrize("angle", [(12.0, np.nan, np.nan), (np.nan, 30.0, np.nan)])
def test_a_measured_pair_takes_the_place_of_the_computed_one(angle):
    """Squares of the measured frequencies, the lower one with its antinode at 12 deg; members of uneven size."""
    modes, added = correction(PAIR, baseline(angle), MATCH)
    assert modes == [0, 1]
    values, vectors = np.linalg.eigh(np.diag((2.0 * np.pi * np.array([100.0, 101.0])) ** 2) + added)
    np.testing.assert_allclose(np.sqrt(values) / (2.0 * np.pi), [98.0, 103.0], rtol=1e-12)
    low = vectors[:, 0] @ [np.exp(-0.5j), 0.7 * np.exp(-0.5j) * -1j]
    assert np.degrees(-np.angle(low**2) / 10.0) % 36.0 == pytest.approx(12.0, abs=1e-9)


def test_a_pair_without_orientation_and_a_single_row_move_the_mean():
    square = (2.0 * np.pi) ** 2
    modes, added = correction(PAIR, baseline(np.nan), MATCH)
    assert modes == [0, 1]
    np.testing.assert_allclose(added, square * 0.5 * (98.0**2 + 103.0**2 - 100.0**2 - 101.0**2) * np.eye(2), rtol=1e-9)
    half = replace(MATCH, rows=(1,), modes=(1,))
    modes, added = correction(PAIR, baseline(np.nan), half)
    assert modes == [0, 1]  # the partner goes along
    np.testing.assert_allclose(added, square * (103.0**2 - 101.0**2) * np.eye(2), rtol=1e-9)
    modes, added = correction(PAIR, baseline(np.nan), replace(MATCH, rows=(2,), modes=(2,), n=7))
    assert modes == [2]
    np.testing.assert_allclose(added, [[square * (160.0**2 - 150.0**2)]], rtol=1e-9)
