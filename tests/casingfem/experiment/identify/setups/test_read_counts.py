"""How many modes a cluster is read as, of readings whose squares are given: which are tried, which is kept."""

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups import cluster_modes
from casingfem.experiment.identify.setups.cluster_modes import read, read_all
from casingfem.experiment.identify.setups.clusters import Cluster
from casingfem.experiment.identify.setups.own_shifts import Modes, OwnPeaks

SETUPS = [np.array([0, 2]), np.array([1]), np.array([3, 4])]
LINES = np.arange(90.0, 130.0, 0.5)
PRICE = np.log(2 * len(LINES) * 5)  # of a number
BAD = 1e6  # squares that nothing is worth


def cluster(count, setups=1, noise=0.5, zeta=None):
    """Modes at 100, 101, ... Hz; 1e-3, 2e-3, ... their damping."""
    freq = np.repeat(100.0 + np.arange(count)[:, None], setups, axis=1)
    zeta = 1e-3 * (1.0 + np.arange(count)) if zeta is None else np.array(zeta)
    window = Window(freq=LINES, Y=np.zeros((2 * len(LINES), 5)), power=0, residues="real", weight=np.ones(5), floor=0.0,
                    along=np.ones(len(LINES)))  # fmt: skip
    return Cluster(Modes(freq, zeta, np.ones((count, 5)) + 0j), window, (95.0, 125.0), noise)


def peaks(freq, zeta, squares, on_peaks=0.0):
    freq = np.array(freq, float)
    zeta = np.broadcast_to(np.array(zeta, float)[:, None], freq.shape)
    tiny = np.full(freq.shape, 1e-9)
    return OwnPeaks(freq, zeta, tiny, tiny, np.ones((len(freq), 5)) + 0j, squares, on_peaks)


class Fits:
    """Fits with given squares, by the number of modes: of set-ups apart, put together, and as they were known."""

    def __init__(self, monkeypatch, apart, linked=(), known=(), on_peaks=(0.0, 0.0, 0.0)):
        self.asked, self.starts, self.only, self.outside = [], [], [], {}

        def places(window, setups, freq, zeta, most, span):
            self.asked.append((freq.tolist(), zeta.tolist(), most, span))
            return [100.1 + np.arange(m)[:, None] + np.zeros(len(setups)) for m in range(1, most + 1)]

        def fit_apart(c, setups, freq, zeta):
            self.starts.append((len(freq), zeta.tolist()))
            own = peaks(freq, 0.9 * zeta, apart[len(freq) - 1], on_peaks[0])
            return own._replace(freq=self.outside.get(len(freq), own.freq))

        def put_together(c, setups, own, shift):
            squares = linked[len(own.freq) - 1] if len(linked) else BAD
            return peaks(own.freq, own.zeta[:, 0], squares, on_peaks[1])

        def fit_again(c, setups, freq, zeta):
            return peaks(freq, zeta, known[len(freq) - 1] if len(known) else BAD, on_peaks[2])

        def only_peaks(c, setups, own, damped):
            self.only.append(damped)
            kept = own.freq[:, 0] > 95.0
            return peaks(own.freq[kept], own.zeta[kept, 0], own.squares)

        for name, fake in (("places", places), ("fit_apart", fit_apart), ("_linked", put_together),
                           ("fit_again", fit_again), ("only_peaks", only_peaks)):  # fmt: skip
            monkeypatch.setattr(cluster_modes, name, fake)

    @property
    def tried(self):
        return [count for count, _ in self.starts]


def falling(*over):
    """Squares of 1, 2, ... modes, of which each takes its price of 9 numbers, times the noise of .5, times that."""
    return 1000.0 - 0.5 * 9.0 * PRICE * np.cumsum([0.0, *over])


@pytest.mark.parametrize(
    ("gains", "tried", "kept"),
    [
        ((0.9, 0.9, 5.0, 5.0), [1, 2, 3], 1),
        ((1.1, 0.9, 0.9, 5.0), [1, 2, 3, 4], 2),
        ((0.9, 1.2, 0.9, 1.2, 0.9), [1, 2, 3, 4, 5, 6], 5),
        ((1.1, 1.1, 1.1, 1.1, 1.1), [1, 2, 3, 4, 5, 6], 6),
    ],
)
def test_counts_rise_until_two_in_turn_are_worse_and_to_one_more_than_there_are_poles(monkeypatch, gains, tried, kept):
    """Of poles of one set-up; 5 residues and 4 numbers of poles a mode, put together."""
    gains = (*gains, *[0.0] * (5 - len(gains)))
    fits = Fits(monkeypatch, [BAD] * 6, falling(*gains))
    found = read(cluster(5), SETUPS, 0.05, 1e-3)
    assert fits.tried == tried
    assert len(found.freq) == kept
    assert fits.asked == [([100.0, 101.0, 102.0, 103.0, 104.0], [1e-3, 2e-3, 3e-3, 4e-3, 5e-3], 6, (95.0, 125.0))]
    for count, zeta in fits.starts:  # the nearest pole's
        assert zeta == [1e-3 * min(k + 1, 5) for k in range(count)]


def test_fourteen_modes_are_tried_at_most_and_damping_no_larger_than_that_of_peaks(monkeypatch):
    fits = Fits(monkeypatch, [BAD] * 15, falling(*[1.1] * 13))
    found = read(cluster(20, zeta=[0.002, 0.3, *[1e-3] * 18]), SETUPS, 1e-4, 1e-3)
    assert fits.asked[0][2] == len(found.freq) == 14
    assert max(fits.asked[0][1]) == 0.002  # twice that of the highest peak


@pytest.mark.parametrize(("count", "first"), [(3, 1), (4, 2), (6, 4)])
def test_of_modes_known_in_each_set_up_no_more_than_two_fewer_are_tried(monkeypatch, count, first):
    fits = Fits(monkeypatch, [BAD] * 7, falling(*[1.1] * 6))
    assert len(read(cluster(count, 3), SETUPS, 0.05, 1e-3).freq) == count + 1
    assert fits.tried == list(range(first, count + 2))


@pytest.mark.parametrize("margin", [0.99, 1.01])
@pytest.mark.parametrize("which", ["linked", "known"])
def test_a_mode_costs_six_numbers_apart_and_four_put_together(monkeypatch, which, margin):
    """Two modes in three set-ups; the cost of squares is that over the least noise that any of the fits leaves."""
    more = 2.0 * 2 * 2 * PRICE * margin  # noise of 2 on the peaks, two modes, two numbers each
    squares = {"apart": [BAD, 100.0 - more, BAD], "linked": [BAD, 100.0, BAD], "known": [BAD, 101.0, BAD]}
    if which == "known":
        squares["linked"], squares["known"] = squares["known"], squares["linked"]
    on_peaks = {"apart": 3.0, "linked": 2.0, "known": 9.0}
    fits = Fits(monkeypatch, *squares.values(), on_peaks=tuple(on_peaks.values()))
    found = read(cluster(2, 3), SETUPS, 0.05, 1e-3)
    assert found.on_peaks == on_peaks["apart" if margin > 1.0 else which]
    assert fits.tried == [1, 2, 3]


def test_a_reading_is_taken_without_modes_that_are_no_peaks(monkeypatch):
    """One of two modes stands out of the span in most set-ups: it is fitted again without that one."""
    fits = Fits(monkeypatch, [BAD, 100.0, BAD], [BAD, BAD, BAD])
    fits.outside[2] = np.array([[100.0, 100.0, 100.0], [90.0, 90.0, 101.0]])
    found = read(cluster(2), SETUPS, 0.05, 1e-3)
    assert found.freq.tolist() == [[100.0] * 3]
    assert fits.only == [0.05]


def test_what_is_left_without_modes_that_are_no_peaks_costs_what_modes_put_together_do(monkeypatch):
    """Half a square more than a mode put together leaves, for the same numbers, is not preferred."""
    for least in (99.5, 100.5):
        fits = Fits(monkeypatch, [BAD, 100.0, BAD], [least, BAD, BAD])
        fits.outside[2] = np.array([[100.0, 100.0, 100.0], [90.0, 90.0, 101.0]])
        assert read(cluster(2), SETUPS, 0.05, 1e-3).squares == min(least, 100.0)


def test_where_no_reading_holds_peaks_alone_there_is_none(monkeypatch):
    fits = Fits(monkeypatch, [100.0] * 3, [200.0] * 3)
    for count in (1, 2, 3):
        fits.outside[count] = np.full((count, 3), 94.9)
    monkeypatch.setattr(cluster_modes, "only_peaks", lambda c, setups, own, damped: own)
    assert read(cluster(2), SETUPS, 0.05, 1e-3) is None
    assert fits.tried == [1, 2, 3]  # nothing ends the search
    assert read_all([cluster(2)], SETUPS, 0.05, 1e-3) == []


def test_clusters_that_were_read_before_are_not_read_again(monkeypatch):
    Fits(monkeypatch, [BAD] * 3, falling(1.1, 1.1))
    first, second = cluster(2), cluster(2)._replace(span=(96.0, 125.0))
    asked = []

    def one_by_one(function, items):
        for item in (items := list(items)):
            asked.append(item.span)
        return iter([f"read {item.span[0]}" for item in items])

    known = [cluster_modes.ClusterModes(first, peaks([[100.0] * 3], [1e-3], 1.0))]
    assert read_all([second, first], SETUPS, 0.05, 1e-3, known, one_by_one) == ["read 96.0", known[0]]
    assert asked == [(96.0, 125.0)]
