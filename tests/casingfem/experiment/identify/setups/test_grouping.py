"""Which peaks belong together, by the formulas written out pair by pair; shapes round a circle as least squares."""

import numpy as np
import pytest

from casingfem.experiment.identify.setups.around import Around, Places
from casingfem.experiment.identify.setups.grouping import _mismatch, agreement, find_setups, matched, matching_sigma
from casingfem.experiment.identify.setups.own_shifts import OwnPeaks

SETUPS = [np.array([0, 3]), np.array([1, 2, 4]), np.array([5])]
SHIFT = 8e-4


def own_peaks(modes=3, count=3, channels=6, seed=3):
    rng = np.random.default_rng(seed)
    freq = 400.0 * np.exp(1e-3 * rng.standard_normal((modes, count)))
    zeta = 2e-3 * np.exp(0.05 * rng.standard_normal((modes, count)))
    variance, of_zeta = 1e-7 * rng.uniform(0.2, 2.0, (modes, count)), 4e-4 * rng.uniform(0.2, 2.0, (modes, count))
    residues = rng.standard_normal((modes, channels)) + 1j * rng.standard_normal((modes, channels))
    return OwnPeaks(freq, zeta, variance, of_zeta, residues, 1.0)


def test_channels_agree_in_a_share_of_the_modes_that_tell_them_apart():
    parts = [own_peaks(4, 5, 5, seed) for seed in (1, 2)]
    parts = [part._replace(variance=part.variance * np.array([0.01, 0.1, 0.3, 0.05, 0.02])) for part in parts]
    share, told = agreement(parts)
    for a in range(5):
        for b in range(5):
            tells, alike = 0, 0
            for part in parts:
                for k in range(4):
                    logs, model = np.log(part.freq[k]), 0.01 * np.median(part.zeta[k])
                    sigma = np.sqrt(part.variance[k, a] + part.variance[k, b] + 2.0 * model**2)
                    if sigma < 0.3 * 1.5 * np.median(np.abs(logs - np.median(logs))):
                        tells += 1
                        alike += abs(logs[a] - logs[b]) < 3.0 * sigma
            assert (told[a, b], share[a, b]) == (tells, pytest.approx(alike / max(tells, 1), rel=1e-12))
    assert 0 < told.min() < told.max()
    assert len(np.unique(share)) > 3


def agreeing(same, of=20, tells=20):
    """Four channels; the first two lie together in so many modes of those that tell, the others never."""
    logs = np.tile(np.array([[0.0, 1.0, 2.0, 3.0]]), (of, 1)) * 1e-3
    logs[:same, 1] = 0.0
    logs[tells:] = 0.0  # nothing is scattered there
    small = np.full(logs.shape, 1e-10)
    return OwnPeaks(300.0 * np.exp(logs), np.full(logs.shape, 2e-3), small, small, np.ones((of, 4)) + 0j, 1.0)


@pytest.mark.parametrize(("same", "groups"), [(8, [2, 1, 1]), (6, [1, 1, 1, 1])])
def test_channels_that_agree_in_more_than_a_third_of_the_modes_are_one_setup(same, groups):
    found = find_setups([agreeing(same)], np.ones(4, bool))
    assert sorted(map(len, found), reverse=True) == groups
    assert sorted(np.concatenate(found).tolist()) == [0, 1, 2, 3]
    if same == 8:
        assert [0, 1] in [group.tolist() for group in found]
        dead = find_setups([agreeing(same)], np.array([True, True, True, False]))
        assert sorted(group.tolist() for group in dead) == [[0, 1, 3], [2]]


@pytest.mark.parametrize(("tells", "groups"), [(3, 3), (2, 4)])
def test_three_modes_must_tell_channels_apart(tells, groups):
    assert len(find_setups([agreeing(tells, 10, tells)], np.ones(4, bool))) == groups


def mismatch_of(own, s, row, column):
    """Squared differences from the mean of the other set-ups, over what both leave uncertain."""
    others = [k for k in range(3) if k != s]
    sizes = [np.linalg.norm(own.residues[:, c], axis=1) / np.sqrt(len(c)) for c in SETUPS]
    counts = [len(c) for c in SETUPS]
    total = 0.0
    for value, spread in (
        (lambda k, m: np.log(own.freq[m, k]), lambda k, m: SHIFT**2 + own.variance[m, k]),
        (lambda k, m: np.log(own.zeta[m, k]), lambda k, m: 0.02**2 + own.zeta_variance[m, k]),
        (lambda k, m: np.log(sizes[k][m]), lambda k, m: 1.2**2 / counts[k]),
    ):
        weights = [1.0 / spread(k, row) for k in others]
        mean = sum(w * value(k, row) for w, k in zip(weights, others, strict=True)) / sum(weights)
        total += (mean - value(s, column)) ** 2 / (1.0 / sum(weights) + spread(s, column))
    return total


def test_the_mismatch_of_a_mode_with_those_of_the_other_set_ups():
    own = own_peaks()
    found = _mismatch(own, SETUPS, SHIFT, [2, 0], None)
    want = [[[mismatch_of(own, s, i, j) for j in range(3)] for i in range(3)] for s in (2, 0)]
    np.testing.assert_allclose(found, want, rtol=1e-9)


def test_shapes_count_where_a_mode_is_told_from_the_others_of_its_set_up():
    own = own_peaks()
    Q = np.linalg.qr(np.random.default_rng(13).standard_normal((6, 2)))[0]
    around = Around([Q], np.linspace(0.5, 2.0, 6), 2.0)
    told = np.zeros(3)
    for k in range(3):
        gaps = [np.log(own.freq[k, 1] / own.freq[m, 1]) ** 2 for m in range(3) if m != k]
        both = [own.variance[k, 1] + own.variance[m, 1] for m in range(3) if m != k]
        told[k] = 1.0 / (1.0 + np.max(np.array(both) / gaps) / 0.1**2)
    plain, whole = (_mismatch(own, SETUPS, SHIFT, [1], each)[0] for each in (None, around))
    np.testing.assert_allclose(whole, plain + told * around.mismatch(own.residues, SETUPS[1]), rtol=1e-9)


def test_what_exchanged_modes_would_change():
    own = own_peaks()
    found = matching_sigma(own, SETUPS, SHIFT)
    cost = _mismatch(own, SETUPS, SHIFT, range(3), None)
    f, z = np.log(own.freq), np.log(own.zeta)
    known = 1.0 / (own.zeta_variance + 0.02**2)
    want = np.zeros((2, 3))
    for i in range(3):
        for s in range(3):
            moves = []
            for j in {0, 1, 2} - {i}:
                rise = cost[s, i, j] + cost[s, j, i] - cost[s, i, i] - cost[s, j, j]
                odds = 1.0 / (1.0 + np.exp(np.clip(rise / 2.0, 0.0, 50.0)))
                apart = max((f[i, s] - f[j, s]) ** 2 - own.variance[i, s] - own.variance[j, s], 0.0)
                v = own.zeta_variance
                damped = max(np.median([(z[i, k] - z[j, k]) ** 2 - v[i, k] - v[j, k] for k in range(3)]), 0.0)
                weight = known[j, s] / (known[i].sum() - known[i, s])
                moves.append([odds * apart / 9.0, odds * damped * (weight / (1.0 + weight)) ** 2])
            want[:, i] += np.max(moves, axis=0)
    np.testing.assert_allclose(found, np.sqrt(want), rtol=1e-9)
    assert found.min() > 0.0
    alone = OwnPeaks(*(part[:1] for part in own[:5]), 1.0)
    assert matching_sigma(alone, SETUPS, SHIFT).tolist() == [[0.0], [0.0]]
    once = OwnPeaks(*(part[:, :1] for part in own[:4]), own.residues, 1.0)
    assert not matching_sigma(once, [np.arange(6)], SHIFT).any()


def test_modes_are_matched_by_frequency_alone_where_the_shift_is_not_known():
    own = own_peaks()
    for setups, shift, some in ((SETUPS, 0.0, own), ([np.arange(6)], 1e-3, OwnPeaks(
        *(part[:, :1] for part in own[:4]), own.residues, 1.0
    ))):  # fmt: skip
        found = matched(some, setups, shift)
        np.testing.assert_array_equal(found.freq, np.sort(some.freq, axis=0))


@pytest.mark.parametrize("rows", [[0, 1, 2], [2, 0, 1]])
def test_modes_that_lie_together_are_matched_by_damping_and_by_size(rows):
    """Two of one frequency but of other damping, two of one damping but of other size."""
    near = np.array([[0.0, 2e-4, -1e-4], [1e-4, -1e-4, 1e-4], [8e-3, 8.2e-3, 7.9e-3]])
    zeta = np.array([[2e-3] * 3, [3e-3] * 3, [2e-3] * 3])
    tiny = np.full((3, 3), 1e-10)
    residues = np.outer([1.0, 1.0, 1.0], np.ones(6)) + 0j
    own = OwnPeaks(400.0 * np.exp(near), zeta, tiny, tiny, residues, 1.0)
    mixed = own.ordered([np.arange(3), np.array(rows), np.argsort(rows)], SETUPS)
    found = matched(mixed, SETUPS, SHIFT)
    order = np.lexsort([found.zeta[:, 0], np.round(found.freq[:, 0] / 400.0, 3)])
    np.testing.assert_allclose(found.freq[order], own.freq, rtol=1e-12)


THETA = np.radians([3.0, 40.0, 95.0, 133.0, 180.0, 222.0, 281.0, 330.0])
SIGN = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0])


def test_waves_of_each_reference_are_columns_of_their_own():
    places = Places(THETA, SIGN, np.array([7, 7, 9, 9, 7, 9, 7, 9]), (0, 2, 3))
    found = places.waves(3)
    first = np.array([1, 1, 0, 0, 1, 0, 1, 0])
    for k, (which, wave) in enumerate([(first, np.cos), (first, np.sin), (1 - first, np.cos), (1 - first, np.sin)]):
        np.testing.assert_allclose(found[:, k], which * SIGN * wave(3 * THETA), atol=1e-15)
    assert places.waves(0).tolist() == np.column_stack([first * SIGN, (1 - first) * SIGN]).tolist()


def residues_of(orders, seed=8):
    """Pure waves of these n, sizes and turns of their own, in phase but for a factor."""
    rng = np.random.default_rng(seed)
    turns = rng.uniform(0.0, 6.0, len(orders))
    waves = SIGN * np.cos(np.outer(orders, THETA) - turns[:, None])
    return waves * rng.uniform(0.5, 3.0, (len(orders), 1)) * np.exp(0.4j)


def test_what_channels_are_off_pure_waves_is_the_least_and_few_modes_or_channels_tell_nothing():
    places = Places(THETA, SIGN, np.zeros(8, int), (1, 2, 3))
    weight = np.arange(1.0, 9.0)
    around = Around.of(places, residues_of([1, 2, 3, 1, 2]), weight)
    np.testing.assert_allclose(around.scale, 1.0 / 0.03 / weight, rtol=1e-9)
    assert around.telling == pytest.approx(8.0 - 2.0, rel=1e-9)
    for k, n in enumerate((1, 2, 3)):
        Q = around.waves[k]
        np.testing.assert_allclose(Q.T @ Q, np.eye(2), atol=1e-12)
        assert np.linalg.norm(places.waves(n) - Q @ (Q.T @ places.waves(n))) < 1e-12
    assert Around.of(places, residues_of([1, 2, 3, 1]), weight) is None
    assert Around.of(places._replace(orders=()), residues_of([1, 2, 3, 1, 2]), weight) is None
    for count in (6, 5):
        few = Places(THETA[:count], SIGN[:count], np.zeros(count, int), (1,))
        told = Around.of(few, residues_of([1] * 5)[:, :count], weight[:count])
        assert (told is None) == (count == 5)


def test_what_most_modes_say_a_channel_is_off():
    """One channel turned over in all modes is off by twice its part there, as a median over the modes."""
    places = Places(THETA, SIGN, np.zeros(8, int), (1, 2))
    residues = residues_of([1, 2, 1, 2, 1, 2, 2])
    residues[:, 4] *= -1.0
    around = Around.of(places, residues, np.ones(8))
    shapes = residues / np.sqrt(np.mean(np.abs(residues) ** 2, axis=1, keepdims=True))
    want = np.hypot(np.median(2.0 * np.abs(shapes[:, 4])), 0.03)
    assert 1.0 / around.scale[4] == pytest.approx(want, rel=0.03)  # it still pulls at the waves a little
    rest = np.delete(around.scale, 4)
    assert around.telling == pytest.approx(np.sum((np.r_[rest, around.scale[4]] / rest.max()) ** 2) - 2.0, rel=1e-9)


def test_what_channels_are_off_the_best_wave_of_each_mode_is_a_median():
    """Found four times anew, each time with what it was as a weight."""
    rng = np.random.default_rng(21)
    places, weight = Places(THETA, SIGN, np.zeros(8, int), (1, 2)), rng.uniform(0.5, 2.0, 8)
    residues = residues_of([1, 2, 1, 2, 1, 2])
    residues = residues * np.exp(0.7j * rng.standard_normal(residues.shape)) * (1.0 + 0.3 * rng.standard_normal((6, 8)))
    shapes = residues / np.sqrt(np.mean(np.abs(residues) ** 2, axis=1, keepdims=True))
    off = np.ones(8)
    for _ in range(4):
        rest = np.zeros((6, 8))
        for k, shape in enumerate(shapes):
            left = []
            for n in (1, 2):
                columns = places.waves(n) / off[:, None]
                left.append(shape / off - columns @ np.linalg.lstsq(columns + 0j, shape / off, rcond=None)[0])
            rest[k] = np.abs(min(left, key=np.linalg.norm)) * off
        off = np.hypot(np.median(rest, axis=0), 0.03)
    around = Around.of(places, residues, weight)
    np.testing.assert_allclose(around.scale, 1.0 / off / weight, rtol=1e-8)
    assert around.telling == pytest.approx(max(np.sum((off.min() / off) ** 2) - 2.0, 0.0), rel=1e-8)
    for n, Q in zip((1, 2), around.waves, strict=True):
        columns = places.waves(n) / off[:, None]
        np.testing.assert_allclose(Q @ (Q.T @ columns), columns, rtol=1e-8, atol=1e-12)


def test_shapes_of_some_channels_beside_those_of_the_others():
    """-2 ln of the likelihood: twice the telling channels times ln of what the best wave leaves and a little."""
    rng = np.random.default_rng(9)
    residues, channels = rng.standard_normal((3, 8)) + 1j * rng.standard_normal((3, 8)), np.array([1, 2, 6])
    places, scale = Places(THETA, SIGN, np.zeros(8, int), (1, 3)), rng.uniform(0.5, 2.0, 8)
    waves = [np.linalg.qr(places.waves(n) * scale[:, None])[0] for n in (1, 3)]
    found = Around(waves, scale, 3.5).mismatch(residues, channels)
    want = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            both = residues[i].copy()
            both[channels] = residues[j, channels]
            both *= scale
            left = [np.linalg.norm(both - Q @ np.linalg.lstsq(Q, both, rcond=None)[0]) ** 2 for Q in waves]
            want[i, j] = 2.0 * 3.5 * np.log(min(left) + 0.03**2 * np.linalg.norm(both) ** 2)
    np.testing.assert_allclose(found, want - want.min(axis=0), atol=1e-9)
