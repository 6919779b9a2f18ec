"""A whole test of a few channels read as one of several set-ups; each choice on the way by itself."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.around import Places
from casingfem.experiment.identify.setups.as_waves import as_waves
from casingfem.experiment.identify.setups.channels_alone import Alone
from casingfem.experiment.identify.setups.cluster_modes import ClusterModes, fit_again, held, read
from casingfem.experiment.identify.setups.clusters import Cluster, clusters
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.shifted import Shifted, _found, _grouped, _polished, _Reading, shifted

LINES = np.arange(90.0, 150.0, 0.2)
SETUPS = [np.array([0, 2, 3]), np.array([1, 4, 5])]
FREQ = np.array([[100.0, 100.2], [110.1, 109.9], [121.0, 121.25], [133.0, 132.8]])
ZETA = np.array([0.004, 0.005, 0.004, 0.003])


def window(freq=FREQ, zeta=ZETA, setups=SETUPS, sigma=1.0, channels=6, sizes=None, lines=LINES):
    """Modes of these frequencies in each set-up, with noise of one or so."""
    rng = np.random.default_rng(17)
    empty = Window(freq=lines, Y=np.zeros((2 * len(lines), channels)), power=0, residues="real",
                   weight=np.ones(channels), floor=0.0, along=np.ones(len(lines)))  # fmt: skip
    residues = rng.uniform(0.5, 1.5, (len(zeta), channels)) * rng.choice([-1.0, 1.0], (len(zeta), channels))
    modes = Modes(np.array(freq), np.array(zeta), residues * (1.0 if sizes is None else np.array(sizes)) + 0j)
    H = modes.response(empty, setups)
    H = H + sigma * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    return modes, replace(empty, Y=np.vstack([H.real, H.imag]))


@pytest.fixture(scope="module")
def found():
    modes, data = window()
    common = modes._replace(freq=FREQ.mean(axis=1, keepdims=True))
    return modes, shifted(data, common)


@pytest.mark.slow
def test_set_ups_are_found_with_their_frequencies(found):
    modes, result = found
    assert sorted(channels.tolist() for channels in result.setups) == [[0, 2, 3], [1, 4, 5]]
    order = np.argsort([channels[0] for channels in result.setups])
    assert result.several
    np.testing.assert_allclose(result.modes.freq[:, order], FREQ, atol=0.02)
    assert np.all(np.abs(np.log(result.modes.freq[:, order] / FREQ)) < 4.0 * np.sqrt(result.variance[:, order]))
    np.testing.assert_allclose(result.modes.zeta, ZETA, rtol=0.03)
    np.testing.assert_allclose(result.modes.residues.real, modes.residues.real, atol=0.05)
    assert (result.leak, result.sigma_zeta.shape) == (0.0, (4,))


@pytest.mark.slow
def test_what_set_ups_differ_by_is_the_median_over_the_modes(found):
    each = np.std(np.log(FREQ), axis=1, ddof=1)
    assert found[1].shift == pytest.approx(np.median(each), rel=0.05)
    assert found[1].worth.min() > 3.0
    assert found[1].sigma_matching.max() < 1e-9  # no two are near


@pytest.mark.slow
def test_a_test_whose_peaks_do_not_shift_stays_one_set_up():
    same = np.repeat(FREQ.mean(axis=1, keepdims=True), 2, axis=1)
    modes, data = window(same)
    result = shifted(data, modes._replace(freq=same[:, :1]))
    assert not result.several
    assert result.evidence < 0.0
    assert result.modes.freq.tolist() == same[:, :1].tolist()


@pytest.mark.parametrize(("rms", "told"), [(1.99, False), (2.01, True)])
def test_of_two_channels_both_must_be_twice_as_loud_as_their_noise(rms, told):
    lines = np.arange(95.0, 106.0, 0.1)
    modes, data = window([[100.0]], [0.005], [np.arange(2)], channels=2, lines=lines)
    factor = np.array([1.0, rms / np.sqrt(np.mean(data.Y[:, 1] ** 2))])
    result = shifted(replace(data, Y=data.Y * factor), modes)
    assert not result.several
    assert (result.evidence != 0.0) is told


def cluster(freq=((100.0, 100.2),), zeta=(0.004,), sigma=0.3, sizes=None, common=False):
    lines = np.arange(95.0, 106.0, 0.1)
    modes, data = window(freq, zeta, sigma=sigma, sizes=sizes, lines=lines)
    if common:
        modes = modes._replace(freq=modes.freq.mean(axis=1, keepdims=True))
    return Cluster(modes, data, (97.5, 104.0), sigma**2, 0.01)


@pytest.mark.slow
def test_as_many_modes_are_read_as_the_data_prefer_and_damping_is_common_where_it_is():
    found = read(cluster(common=True), SETUPS, 0.05, 1e-3)
    np.testing.assert_allclose(found.freq, [[100.0, 100.2]], atol=0.01)
    assert np.ptp(found.zeta, axis=1).tolist() == [0.0]
    two = read(cluster(((100.0, 100.2), (101.5, 101.3)), (0.004, 0.003), common=True), SETUPS, 0.05, 1e-3)
    np.testing.assert_allclose(two.freq, [[100.0, 100.2], [101.5, 101.3]], atol=0.02)
    once = cluster(((100.0, 100.2), (101.5, 101.3)), (0.004, 0.003))
    again = read(once._replace(modes=once.modes), SETUPS, 0.05, 1e-3)
    np.testing.assert_allclose(again.freq, two.freq, atol=0.02)


def test_damping_of_each_set_up_is_its_own_where_that_is_clearly_better():
    first, second = cluster(zeta=(0.003,), common=True), cluster(zeta=(0.008,), common=True)
    both = np.where(np.isin(np.arange(6), SETUPS[0]), first.window.Y, second.window.Y)
    mixed = first._replace(window=replace(first.window, Y=both))
    found = read(mixed, SETUPS, 0.05, 1e-3)
    np.testing.assert_allclose(found.zeta, [[0.003, 0.008]], rtol=0.02)


def test_modes_keep_to_their_size_where_they_are_polished():
    c = cluster(((100.0, 100.2), (101.5, 101.3)), (0.004, 0.003))
    c = c._replace(modes=c.modes._replace(residues=3e-3 * c.modes.residues))  # held to small ones
    own = _polished(SETUPS, 0.05, 1e-3, None, c).own
    want = fit_again(c, SETUPS, c.modes.freq, c.modes.zeta, held(c, SETUPS))
    np.testing.assert_array_equal(own.freq, want.freq)
    free = fit_again(c, SETUPS, c.modes.freq, c.modes.zeta)
    assert np.abs(own.residues / free.residues).max() < 0.999


def test_modes_that_shapes_say_were_exchanged_are_fitted_once_more_that_way(monkeypatch):
    c = cluster(((100.0, 100.2), (101.5, 101.3)), (0.004, 0.003))
    straight, asked = _polished(SETUPS, 0.05, 1e-3, None, c).own, []

    def exchanged(one, *given):
        asked.append(given)
        return np.column_stack([one.own.freq[:, 0], one.own.freq[::-1, 1]])

    monkeypatch.setattr("casingfem.experiment.identify.setups.shifted.rematched", exchanged)
    own = _polished(SETUPS, 0.05, 1e-3, "around", c).own
    assert asked == [(SETUPS, 1e-3, "around")]
    want = fit_again(c, SETUPS, exchanged(SimpleNamespace(own=straight)), straight.zeta[:, 0], held(c, SETUPS))
    np.testing.assert_allclose(own.freq, want.freq, rtol=1e-6)
    assert np.abs(own.freq - straight.freq).max() > 0.1


def test_channels_stay_alone_where_groups_do_not_read_them_as_well():
    c = cluster(common=True)
    single = [np.array([k]) for k in range(6)]
    many = fit_again(c, single, np.array([[100.0, 100.2, 100.0, 100.0, 100.2, 100.2]]), c.modes.zeta)
    alone = Alone([c], [many], 0.0, [7.0])
    good = _grouped(alone, SETUPS, 0.05, map)
    assert good.setups is SETUPS
    assert good.evidence >= 7.0
    assert [type(one) for one in good.grouped] == [ClusterModes]
    poor = _grouped(alone, [np.array([0, 1, 2]), np.array([3, 4, 5])], 0.05, map)
    assert [channels.tolist() for channels in poor.setups] == [[0], [1], [2], [3], [4], [5]]
    assert (poor.evidence, poor.grouped) == (7.0, [])
    assert poor.shift == good.shift == pytest.approx(np.std(np.log(many.freq), ddof=1), rel=1e-9)


@pytest.mark.slow
def test_set_ups_with_the_same_frequencies_become_one():
    modes, data = window()
    four = [np.array([0]), np.array([2, 3]), np.array([1]), np.array([4, 5])]
    common = modes._replace(freq=FREQ.mean(axis=1, keepdims=True))
    near = list(clusters(data, common, [np.arange(6)]))
    found, reading = _found(data, common, near, _Reading(four, 1e-3, 0.0, 8.0, []), 0.05, map)
    assert sorted(channels.tolist() for channels in reading.setups) == [[0, 2, 3], [1, 4, 5]]
    assert found.freq.shape == FREQ.shape
    np.testing.assert_allclose(np.sort(found.freq, axis=1), np.sort(FREQ, axis=1), atol=0.02)
    assert reading.shift == pytest.approx(np.median(np.std(np.log(FREQ), axis=1, ddof=1)), rel=0.05)
    assert (reading.evidence, reading.leak, reading.grouped) == (8.0, 0.0, [])


COARSE = LINES[::2]
THETA = np.radians([3.0, 47.0, 85.0, 124.0, 161.0, 203.0, 240.0, 284.0, 325.0])


@pytest.fixture(scope="module")
def around():
    """Six modes of waves far from each other, the last given first, in two set-ups of nine channels."""
    setups = [np.array([0, 2, 4, 6, 8]), np.array([1, 3, 5, 7])]
    freq = np.array([[145.0, 145.1], [100.0, 100.2], [110.0, 109.9], [119.0, 119.1], [128.0, 128.1], [136.0, 135.9]])
    zeta = np.array([0.003, 0.004, 0.003, 0.004, 0.003, 0.004])
    rng = np.random.default_rng(2)
    waves = np.cos(np.outer([2, 1, 2, 1, 2, 1], THETA) - rng.uniform(0.0, 6.0, (6, 1)))
    empty = Window(freq=COARSE, Y=np.zeros((2 * len(COARSE), 9)), power=1, residues="real", weight=np.full(9, 0.5),
                   floor=0.0, along=np.ones(len(COARSE)))  # fmt: skip
    modes = Modes(freq, zeta, waves + 0j)
    H = modes.response(empty, setups)
    H = H + rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape)
    data = replace(empty, Y=np.vstack([H.real, H.imag]))
    nothing = np.zeros(6)
    worth = np.arange(10.0, 16.0)
    found = Shifted(modes, np.full((6, 2), 1e-9), nothing, nothing, worth, setups, 0.0, 1e-3, 9.0)
    return found, data, Places(THETA, np.ones(9), np.zeros(9, int), (0, 1, 2))


@pytest.mark.slow
def test_waves_are_fitted_cluster_by_cluster_in_the_order_of_their_frequencies(around):
    found, data, places = around
    result = as_waves(found, data, places)
    order = np.argsort(found.modes.freq[:, 0])
    np.testing.assert_allclose(result.modes.freq, found.modes.freq[order], rtol=1e-4)
    np.testing.assert_allclose(result.modes.zeta, found.modes.zeta[order], rtol=0.03)
    np.testing.assert_allclose(result.modes.residues.real, found.modes.residues.real[order], atol=0.02)
    assert result.worth.tolist() == found.worth[order].tolist()
    assert result.belongs.all()
    np.testing.assert_allclose(result.mean_freq, np.exp(np.log(result.modes.freq).mean(axis=1)), rtol=1e-6)
    assert result.rival.max() < 1e-5
    np.testing.assert_allclose(result.sigma_mean, np.sqrt(result.variance.sum(axis=1)) / 2.0, rtol=0.05)
    for name in ("sigma_zeta", "sigma_matching", "rival", "sigma_mean", "mean_freq"):
        assert getattr(result, name).shape == (6,)


def test_of_more_than_six_set_ups_waves_are_not_tried(around):
    found, data, places = around
    seven = found._replace(setups=[*found.setups, *found.setups, *found.setups, found.setups[0]])
    assert as_waves(seven, data, places) is seven
    few = found._replace(modes=found.modes.some(np.arange(4)))
    assert as_waves(few, data, places) is few
