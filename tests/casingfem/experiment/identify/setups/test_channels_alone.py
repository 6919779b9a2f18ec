"""Whether peaks are shifted and windows leak, by readings of clusters; what a test of several set-ups holds."""

from dataclasses import replace

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.as_waves import as_waves
from casingfem.experiment.identify.setups.channels_alone import (
    _gain,
    _tells,
    channels_alone,
    evidence_of,
    leak_of_common,
    leak_of_own,
    leaks,
    scatter,
)
from casingfem.experiment.identify.setups.cluster_modes import ClusterModes
from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.own_shifts import Modes, OwnPeaks, linked
from casingfem.experiment.identify.setups.shifted import Shifted, _as_good, _spread, _unsettled, _unshifted

LINES = np.arange(95.0, 106.0, 0.1)
SETUPS = [np.array([0, 2]), np.array([1, 3])]


def window(modes, setups, leak=0.0, sigma=1e-3):
    rng = np.random.default_rng(4)
    empty = Window(freq=LINES, Y=np.zeros((2 * len(LINES), 4)), power=0, residues="real", weight=np.arange(1.0, 5.0),
                   floor=0.0, along=np.ones(len(LINES)), leak=leak)  # fmt: skip
    H = modes.response(empty, setups)
    H = H + sigma * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    return replace(empty, Y=np.vstack([H.real, H.imag]), leak=0.0)


SHAPE = np.array([[0.5, -0.3, 0.4, 0.2]]) + 0j


def cluster(freq=((100.0, 100.0),), zeta=(0.004,), setups=SETUPS, leak=0.0, common=True):
    own = Modes(np.array(freq), np.array(zeta), SHAPE)
    data = window(own, setups, leak)
    told = own._replace(freq=own.freq.mean(axis=1, keepdims=True)) if common else own
    return Cluster(told, data, (97.0, 103.0), 1e-6)


def peaks(freq, squares=1.0, on_peaks=0.0):
    freq = np.array(freq, float)
    tiny = np.full(freq.shape, 1e-9)
    return OwnPeaks(freq, 0.004 * np.ones(freq.shape), tiny, tiny, np.ones((len(freq), 4)) + 0j, squares, on_peaks)


def test_one_cluster_votes_for_leakage_by_thirty_at_most():
    assert leaks([0.1])
    assert not leaks([0.0])
    assert not leaks([])
    assert not leaks([-29.0, 28.0])
    assert leaks([-1000.0, 28.0, 3.0])
    assert not leaks([1000.0, -28.0, -3.0])


@pytest.mark.parametrize(("bandwidth", "told"), [(29.9, True), (30.1, False)])
def test_peaks_narrower_than_thirty_lines_tell_leakage(bandwidth, told):
    c = cluster(zeta=(bandwidth * 0.1 / 200.0,))
    assert _tells(c, 0.1) is told
    two = Modes(np.array([[100.0, 99.0], [100.0, 100.0]]), np.array([bandwidth * 0.1 / 198.0, 0.2]), np.ones((2, 4)))
    assert _tells(c._replace(modes=two), 0.1) is told  # by the lowest of its set-ups


def test_twice_the_ln_of_the_odds_is_the_fall_of_ln_squares_times_the_numbers():
    c = cluster()
    found = _gain(c, peaks([[100.0]], squares=3.0), peaks([[100.0]], squares=2.0))
    assert found == pytest.approx(2 * 4 * len(LINES) * np.log(1.5), rel=1e-12)


@pytest.mark.parametrize(("leak", "zeta", "found"), [(0.1, 0.004, 0.1), (0.0, 0.004, 0.0), (0.1, 0.02, 0.0)])
def test_leakage_over_a_step_of_the_lines_is_found_by_common_and_by_own_frequencies(leak, zeta, found):
    """Where a peak has 40 lines nothing is asked."""
    step = float(LINES[1] - LINES[0])
    assert leak_of_common([cluster(zeta=(zeta,), leak=leak)], step) == pytest.approx(found)
    own = cluster(((100.0, 100.3),), (zeta,), leak=leak, common=False)
    assert leak_of_own([own], SETUPS, step) == pytest.approx(found)
    nothing = _unshifted([cluster(zeta=(zeta,), leak=leak)], cluster().modes, step, -3.0, map)
    assert nothing.leak == pytest.approx(found)
    assert (nothing.shift, nothing.evidence, nothing.several) == (0.0, -3.0, False)
    assert [channels.tolist() for channels in nothing.setups] == [[0, 1, 2, 3]]
    assert nothing.variance.tolist() == [[0.0]]


def test_the_evidence_for_own_frequencies_weighs_squares_against_numbers():
    """Lines that are alike count as one; against shifts no more speaks than the price of their frequencies."""
    c = cluster(((100.0, 100.4),))
    own = linked(c.window, SETUPS, np.array([[100.0, 100.4]]), np.array([0.004]), c.noise, c.span)
    shared = linked(c.window, [np.arange(4)], c.modes.freq, c.modes.zeta, c.noise, c.span).squares
    price = np.log(8 * len(LINES))
    lines = 8 * len(LINES)
    assert shared / c.noise > lines
    numbers = (4 + 3) - (4 + 2)
    assert evidence_of(c, own, 2) == pytest.approx(lines * np.log(shared / own.squares) - price * numbers, rel=1e-9)
    alike = c._replace(noise=shared / 50.0)
    assert evidence_of(alike, own, 2) == pytest.approx(50.0 * np.log(shared / own.squares) - price * numbers, rel=1e-4)
    poor = own._replace(squares=1e6 * shared)
    assert evidence_of(c, poor, 4) == pytest.approx(-price * 1 * 3, rel=1e-12)
    two = peaks([[100.0, 100.4], [101.0, 101.0]], squares=own.squares)
    numbers = 2 * (4 + 3) - (4 + 2)
    assert evidence_of(c, two, 2) == pytest.approx(lines * np.log(shared / own.squares) - price * numbers, rel=1e-9)


def test_what_set_ups_differ_by_is_the_median_of_standard_deviations():
    each = [[100.0, 100.1, 100.4], [101.0, 101.0, 101.1], [102.0, 103.0, 102.0]]
    want = np.median([np.std(np.log(row), ddof=1) for row in each])
    assert scatter([peaks(each[:1]), peaks(each[1:])]) == pytest.approx(want, rel=1e-12)
    assert scatter([peaks([[100.0]])]) == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("leak", [0.0, 0.1])
def test_channels_are_read_alone_and_leakage_with_them(leak):
    c = cluster(((100.0, 100.4),), leak=leak)
    found = channels_alone([c], np.array([3, 1, 0]), 0.05, float(LINES[1] - LINES[0]))
    assert found.leak == pytest.approx(leak)
    assert found.clusters[0].window.leak == pytest.approx(leak)
    assert found.clusters[0].window.Y.shape[1] == 3
    best = found.peaks[0].freq[np.linalg.norm(found.peaks[0].residues, axis=1).argmax()]
    np.testing.assert_allclose(best, [100.4, 100.4, 100.0], atol=0.01)
    assert found.evidence == [evidence_of(of_channels(c, [3, 1, 0]), found.peaks[0], 3)]
    nothing = c._replace(modes=c.modes._replace(zeta=np.array([1e-3])), span=(101.0, 102.0))
    assert channels_alone([nothing], np.arange(4), 1e-4, 0.1).peaks == []


def of_channels(c, some):
    """The cluster in some of its channels."""
    data = replace(c.window, Y=c.window.Y[:, some], weight=c.window.weight[some])
    return c._replace(window=data, modes=c.modes._replace(residues=c.modes.residues[:, some]))


def test_indices_are_evenly_spread():
    assert _spread(5, 8).tolist() == [0, 1, 2, 3, 4]
    assert _spread(9, 3).tolist() == [0, 4, 8]
    assert _spread(10, 4).tolist() == [0, 3, 6, 9]
    assert _spread(0, 4).tolist() == []


@pytest.mark.parametrize(
    ("on_peaks", "noise", "unsettled"), [(2.01, 1.0, True), (1.99, 1.0, False), (1.0, 9.9, False), (1.0, 10.1, True)]
)
def test_a_cluster_is_unsettled_where_it_leaves_twice_the_noise_or_a_tenth(on_peaks, noise, unsettled):
    c = cluster()._replace(noise=noise)
    assert _unsettled(ClusterModes(c, peaks([[100.0]], on_peaks=on_peaks))) is unsettled


def test_clusters_that_are_no_longer_there_have_no_vote():
    c = cluster()
    few, many = (ClusterModes(c, peaks([[100.0]], squares=squares, on_peaks=1e-6)) for squares in (1.0, 1e-3))
    assert not _as_good([few], SETUPS, [many], [np.arange(2)] * 4)
    other = ClusterModes(c._replace(span=(1.0, 2.0)), many.own)
    assert _as_good([few], SETUPS, [other], [np.arange(2)] * 4)
    same = ClusterModes(c, few.own)
    assert _as_good([same], SETUPS, [same], SETUPS)  # not worse
    price = np.log(8 * len(LINES))
    for gain, good in ((0.99, True), (1.01, False)):  # two more set-ups cost two frequencies a mode
        more = ClusterModes(c, peaks([[100.0]], squares=1.0 - gain * 2.0 * price * 1e-6, on_peaks=1e-6))
        assert _as_good([few], SETUPS, [more], [*SETUPS, *SETUPS]) is good


def shifted(**changes):
    modes = Modes(np.array([[100.0, 100.4], [102.0, 101.7]]), np.array([0.004, 0.006]),
                  np.array([[0.5, -0.3, 0.4, 0.2], [0.1, 0.3, -0.6, 0.2]]) + 0j)  # fmt: skip
    nothing = np.zeros(2)
    given = {"modes": modes, "variance": np.full((2, 2), 1e-8), "sigma_zeta": nothing, "sigma_matching": nothing,
             "worth": nothing, "setups": SETUPS, "leak": 0.1, "shift": 2e-3, "evidence": 5.0}  # fmt: skip
    return Shifted(**given | changes)


def test_a_test_has_several_set_ups_where_the_odds_say_so():
    assert shifted().several
    assert not shifted(evidence=0.0).several
    assert not shifted(setups=[np.arange(4)]).several


def test_aligned_data_have_the_mean_frequencies_in_every_set_up():
    found = shifted()
    data = window(found.modes, SETUPS, leak=0.1, sigma=0.0)
    straight = found.aligned(data)
    assert straight.leak == 0.1
    together = found.modes._replace(freq=np.repeat(found.mean()[0][:, None], 2, axis=1))
    want = window(together, SETUPS, leak=0.1, sigma=0.0)
    np.testing.assert_allclose(straight.Y, want.Y, atol=1e-9)


def test_the_mean_of_waves_is_the_one_that_is_given():
    freq, sigma = shifted(mean_freq=np.array([1.0, 2.0]), sigma_mean=np.array([3.0, 4.0])).mean()
    assert (freq.tolist(), sigma.tolist()) == ([1.0, 2.0], [3.0, 4.0])


def test_where_the_channels_tell_no_waves_what_was_found_stays():
    found = shifted()
    assert as_waves(found, window(found.modes, SETUPS), None) is found
