"""Correlation: MAC, planes of doublets, and pairings that are known beforehand."""

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import scipy.sparse as sp

import casingfem as cf

DATA = Path(__file__).resolve().parents[4] / "data"


@dataclass
class Computed:
    freq: np.ndarray
    nodal_diameters: np.ndarray
    doublets: tuple[tuple[int, int], ...] = ()


def frustum(scale=1.0, split=1e-3, count=40) -> Computed:
    """The reference frustum's branches as doublets, split and scaled."""
    table = pd.read_csv(DATA / "reference/reference_frustum.csv", comment="#")
    n, branches = table["n"].to_numpy(), [table[f"f{k}_3d"].to_numpy() for k in (1, 2, 3)]
    labels = np.concatenate([n, n, n])
    freq = scale * np.concatenate(branches)
    pairs = labels > 0
    all_freq = np.concatenate([freq * (1 - split / 2 * pairs), freq[pairs] * (1 + split / 2)])
    owner = np.concatenate([np.arange(freq.size), np.flatnonzero(pairs)])
    order = np.argsort(all_freq, kind="stable")[:count]
    places = {mode: np.flatnonzero(owner[order] == mode) for mode in range(freq.size)}
    doublets = tuple((int(p[0]), int(p[1])) for p in places.values() if p.size == 2)
    return Computed(all_freq[order], labels[owner[order]], doublets)


def blade(column="computed_love_ritz_hz") -> Computed:
    freq = pd.read_csv(DATA / "reference/olson_lindberg_fan_blade.csv", comment="#")[column].to_numpy()
    return Computed(freq, np.full(freq.size, -1))


def measured(modes: Computed, rows, labels=True, **more) -> cf.FrequencyTable:
    rows = list(rows)
    n = modes.nodal_diameters[rows] if labels else -1
    return cf.FrequencyTable.from_arrays(freq_hz=modes.freq[rows], n=n, sigma_hz=0.1, **more)


def as_dict(pairing):
    return {row: mode for match in pairing.matches for row, mode in zip(match.rows, match.modes, strict=True)}


def test_mac_of_known_vectors():
    rng = np.random.default_rng(17)
    A, B = rng.normal(size=(9, 3)), rng.normal(size=(9, 4)) + 1j * rng.normal(size=(9, 4))
    M = np.diag(rng.uniform(1, 2, 9))
    got = cf.correlation.mac(A, B, M)
    for i in range(3):
        for j in range(4):
            a, b = A[:, i], B[:, j]
            expected = abs(a @ M @ b) ** 2 / ((a @ M @ a) * (b.conj() @ M @ b).real)
            assert got[i, j] == pytest.approx(expected)
    np.testing.assert_allclose(cf.correlation.mac(A, B, sp.csr_array(M)), got)
    np.testing.assert_allclose(np.diag(cf.correlation.mac(B * (2 - 1j), B)), 1.0)
    np.testing.assert_allclose(cf.correlation.mac(np.eye(3)[:, :2], np.eye(3)), [[1, 0, 0], [0, 1, 0]])


@pytest.mark.parametrize("angle", [-4.0, 0.0, 0.3, 1.6])
def test_subspace_mac_does_not_see_a_rotation_in_the_plane(angle):
    rng = np.random.default_rng(5)
    plane, other = rng.normal(size=(2, 12, 2))
    M = np.diag(rng.uniform(0.5, 2, 12))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    assert cf.correlation.subspace_mac(plane, plane @ turn, M) == pytest.approx(1.0)
    assert cf.correlation.subspace_mac(plane, other @ turn) == pytest.approx(cf.correlation.subspace_mac(other, plane))
    assert cf.correlation.subspace_mac(plane[:, 0], plane) == pytest.approx(1.0)
    assert cf.correlation.subspace_mac(plane[:, :1], other[:, :1]) == pytest.approx(
        cf.correlation.mac(plane[:, 0], other[:, 0])[0, 0]
    )


def test_mac_refuses_what_has_no_meaning():
    with pytest.raises(ValueError, match="same dofs, not 3 and 2"):
        cf.correlation.mac(np.eye(3), np.eye(2))
    with pytest.raises(ValueError, match="found a shape that is zero"):
        cf.correlation.mac(np.eye(3), np.zeros(3))
    with pytest.raises(ValueError, match="finite numbers"):
        cf.correlation.mac([np.nan, 1.0], [1.0, 1.0])
    with pytest.raises(ValueError, match="linearly independent"):
        cf.correlation.subspace_mac(np.ones((3, 2)), np.eye(3))


@pytest.mark.parametrize("scale", [1.0, 0.87, 1.15, 1.4])
def test_labelled_doublets_find_their_own_however_far_the_model(scale):
    modes = frustum()
    pairing = cf.correlation.pair(frustum(scale), measured(modes, range(40)))
    assert as_dict(pairing) == {k: k for k in range(40)}
    assert all(len(match.rows) == 2 for match in pairing.matches)
    assert pairing.rms == pytest.approx(abs(scale - 1), abs=1e-6)
    assert pairing.unpaired_rows == ()


def test_an_order_of_the_modes_that_differs_from_the_tests_is_no_obstacle():
    model = Computed(np.array([100.0, 100.1, 104.0, 104.2]), np.array([5, 5, 6, 6]), ((0, 1), (2, 3)))
    table = cf.FrequencyTable.from_arrays(n=[6, 6, 5, 5], freq_hz=[101, 101.3, 103, 103.4], sigma_hz=0.1)
    assert as_dict(cf.correlation.pair(model, table)) == {0: 2, 1: 3, 2: 0, 3: 1}


def test_a_doublet_is_never_shared_out():
    """Frequencies alone would give the rows to the upper member of one pair and the lower of the next."""
    model = Computed(np.array([100.0, 108.0, 112.0, 120.0]), np.array([4, 4, 4, 4]), ((0, 1), (2, 3)))
    table = cf.FrequencyTable.from_arrays(n=4, freq_hz=[108.5, 109.5], sigma_hz=0.1)
    (match,) = cf.correlation.pair(model, table).matches
    assert match.modes in ((0, 1), (2, 3))
    assert match.confidence < 0.5


def test_widely_split_rows_fill_one_doublet():
    model = Computed(np.array([560.0, 720.0, 1400.0, 1410.0]), np.array([4] * 4), ((0, 1), (2, 3)))
    table = cf.FrequencyTable.from_arrays(n=4, freq_hz=[540.0, 735.0], sigma_hz=0.1)
    assert [group.rows for group in table.groups()] == [(0,), (1,)]
    (match,) = cf.correlation.pair(model, table).matches
    assert (match.rows, match.modes, match.n) == ((0, 1), (0, 1), 4)


def test_a_lone_row_takes_the_nearer_member():
    model = Computed(np.array([100.0, 103.0, 150.0]), np.array([4, 4, 0]), ((0, 1),))
    table = cf.FrequencyTable.from_arrays(n=[4, 0], freq_hz=[102.5, 140.0], sigma_hz=0.1)
    pairing = cf.correlation.pair(model, table)
    assert as_dict(pairing) == {0: 1, 1: 2}
    assert pairing.unpaired_modes == (0,)


def test_a_doublet_cut_by_the_models_count_keeps_one_row():
    model = Computed(np.array([90.0, 100.0]), np.array([3, 4]))
    table = cf.FrequencyTable.from_arrays(n=[4, 4, 3], freq_hz=[100.1, 101.0, 91.0], sigma_hz=0.1)
    pairing = cf.correlation.pair(model, table)
    assert as_dict(pairing) == {0: 1, 2: 0}
    assert pairing.unpaired_rows == (1,)


def test_labels_that_do_not_agree_are_never_paired():
    modes = frustum()
    table = cf.FrequencyTable.from_arrays(n=[30, 8], freq_hz=[modes.freq[0], 3000.0], sigma_hz=0.1)
    pairing = cf.correlation.pair(modes, table)
    assert pairing.matches == ()
    assert pairing.unpaired_rows == (0, 1)
    assert np.isnan(pairing.rms)


def test_rows_without_labels_take_the_modes_that_are_left():
    modes = frustum()
    n = np.where(np.arange(40) % 4 < 2, modes.nodal_diameters, -1)
    table = cf.FrequencyTable.from_arrays(freq_hz=modes.freq * 1.002, n=n, sigma_hz=0.1)
    assert as_dict(cf.correlation.pair(modes, table)) == {k: k for k in range(40)}
    pairing = cf.correlation.pair(modes, measured(modes, range(0, 40), labels=False))
    assert as_dict(pairing) == {k: k for k in range(40)}
    assert {match.n for match in pairing.matches} == set(modes.nodal_diameters.tolist())


def test_the_measured_blade_meets_its_converged_modes():
    table = cf.FrequencyTable.from_csv(DATA / "experiments/olson_lindberg.csv")
    pairing = cf.correlation.pair(blade(), table)
    assert as_dict(pairing) == {k: k for k in range(7)}
    assert pairing.unpaired_modes == (7, 8, 9, 10, 11)
    assert pairing.rms == pytest.approx(0.0243, abs=1e-3)
    confidence = [match.confidence for match in pairing.matches]
    assert confidence[6] < 0.1 < 0.7 < min(confidence[:6])  # modes 7 and 8 are 2 Hz apart
    fewer = cf.correlation.pair(blade(), table.without(4))
    assert as_dict(fewer) == {0: 0, 1: 1, 2: 2, 3: 4, 4: 5, 5: 6}


def test_shapes_decide_where_frequencies_mislead():
    model = blade()
    table = cf.FrequencyTable.from_csv(DATA / "experiments/olson_lindberg.csv")
    shape_mac = np.eye(7, 12)
    shape_mac[6, [6, 7]] = 0.05, 0.95
    shape_mac[[1, 2]] = shape_mac[[2, 1]]
    got = as_dict(cf.correlation.pair(model, table, shape_mac=shape_mac, reach=1.0))
    assert got == {0: 0, 1: 2, 2: 1, 3: 3, 4: 4, 5: 5, 6: 7}


@pytest.mark.slow
def test_rotated_doublet_bases_and_noise_pair_without_labels():
    """24 sensors on a circle, 5 % noise, doublets turned in their planes: all right, every time."""
    theta = np.arange(24) * 2 * np.pi / 24
    n = np.repeat(np.arange(2, 12), 2)
    freq = 300 + 20.0 * np.abs(n - 6.2) + np.tile([0.0, 0.3], 10)
    order = np.argsort(freq)
    n, freq = n[order], freq[order]
    doublets = tuple((2 * k, 2 * k + 1) for k in range(10))
    model = Computed(freq, n, doublets)
    shapes = np.where(np.arange(20) % 2, np.sin(np.outer(theta, n)), np.cos(np.outer(theta, n)))
    worst = 1.0
    for draw in range(25):
        rng = np.random.default_rng(100 + draw)
        turned = np.empty_like(shapes)
        for a, b in doublets:
            c, s = np.cos(angle := rng.uniform(0, 2 * np.pi)), np.sin(angle)
            turned[:, [a, b]] = shapes[:, [a, b]] @ np.array([[c, -s], [s, c]])
        turned += 0.05 * rng.normal(size=turned.shape)
        table = cf.FrequencyTable.from_arrays(freq_hz=freq * rng.normal(1.03, 0.01, 20), sigma_hz=0.1)
        pairing = cf.correlation.pair(model, table, shape_mac=cf.correlation.mac(turned, shapes))
        planes = {match.modes: match.rows for match in pairing.matches}
        assert {modes: tuple(sorted(rows)) for modes, rows in planes.items()} == {d: d for d in doublets}
        worst = min(worst, *(cf.correlation.subspace_mac(turned[:, [a, b]], shapes[:, [a, b]]) for a, b in doublets))
    assert worst > 0.98


def test_confidence_falls_as_an_alternative_comes_near():
    table = cf.FrequencyTable.from_arrays(freq_hz=[100.0], n=[4], sigma_hz=0.1)
    seen = [
        cf.correlation.pair(Computed(np.array([99.0, other]), np.array([4, 4])), table).matches[0].confidence
        for other in (101.2, 105.0, 140.0)
    ]
    assert seen == sorted(seen)
    assert seen[0] < 0.2
    assert seen[2] > 0.95


def test_rigid_modes_and_empty_sides_are_survived():
    model = Computed(np.array([0.0, 0.0, 100.0]), np.full(3, -1))
    table = cf.FrequencyTable.from_arrays(freq_hz=[101.0], sigma_hz=0.1)
    assert as_dict(cf.correlation.pair(model, table)) == {0: 2}
    nothing = Computed(np.array([]), np.array([], dtype=int))
    assert cf.correlation.pair(nothing, table).unpaired_rows == (0,)
    assert cf.correlation.pair(nothing, table, shape_mac=np.zeros((1, 0))).unpaired_rows == (0,)


def test_what_cannot_be_paired_is_refused():
    table = cf.FrequencyTable.from_arrays(freq_hz=[101.0], sigma_hz=0.1)
    with pytest.raises(ValueError, match="ascending"):
        cf.correlation.pair(Computed(np.array([2.0, 1.0]), np.array([-1, -1])), table)
    with pytest.raises(ValueError, match="reach must be > 0"):
        cf.correlation.pair(blade(), table, reach=0.0)
    with pytest.raises(ValueError, match=r"must be the MAC matrix \(1, 12\), not \(1, 7\)"):
        cf.correlation.pair(blade(), table, shape_mac=np.ones((1, 7)))


def test_repr_is_the_table_an_engineer_reads():
    modes = frustum()
    text = repr(cf.correlation.pair(modes, measured(modes, [0, 1, 3])))
    assert text.splitlines()[0] == "Pairing(2 matches, rms 0.00 %, unpaired: 0 rows, 37 modes)"
    assert len(text.splitlines()) == 5


def test_a_measured_doublet_goes_to_the_plane_that_both_its_shapes_are_like():
    """Two pairs n = 3, 1 % below and 3 % above; the nearer has .6 of each shape, the other .9."""
    found = SimpleNamespace(
        freq=np.array([100.0, 100.0, 104.0, 104.0]), nodal_diameters=np.full(4, 3), doublets=((0, 1), (2, 3))
    )
    rows = cf.FrequencyTable.from_arrays(freq_hz=[101.0, 101.0], sigma_hz=0.1, n=[3, 3])
    likeness = np.array([[0.5, 0.1, 0.0, 0.9], [0.3, 0.3, 0.6, 0.3]])
    (match,) = cf.correlation.pair(found, rows, reach=0.2, shape_mac=likeness).matches
    assert match.rows == (0, 1)
    assert match.modes == (2, 3)


def test_a_pairing_in_numbers_counts_from_1():
    modes = Computed(np.array([101.0, 150.0, 196.0]), np.array([3, 7, 5]))
    table = cf.FrequencyTable.from_arrays(freq_hz=[100.0, 200.0], n=[3, 5], sigma_hz=0.1)
    found = cf.correlation.pair(modes, table)
    assert found.rms == pytest.approx(np.sqrt((0.01**2 + 0.02**2) / 2.0), rel=1e-12)
    assert (len(found), found.unpaired_rows, found.unpaired_modes) == (2, (), (1,))
    told = [(r["row"], r["mode"], r["n"], r["measured_hz"], r["computed_hz"]) for r in found.records()]
    assert told == [(1, 1, 3, 100.0, 101.0), (2, 3, 5, 200.0, 196.0)]
