"""How often modes are fitted again, searched and added to, by what the parts of a search say."""

from types import SimpleNamespace

import numpy as np
import pytest

from casingfem.experiment.identify.setups import shifted as shifting
from casingfem.experiment.identify.setups import wave_search
from casingfem.experiment.identify.setups.around import Around, Places
from casingfem.experiment.identify.setups.cluster_modes import ClusterModes, fit_again, improved
from casingfem.experiment.identify.setups.shifted import _polish, _polished, _Reading, _told
from casingfem.experiment.identify.setups.wave_fit import GAIN, WaveRead
from casingfem.experiment.identify.setups.wave_model import Shapes
from casingfem.experiment.identify.setups.wave_search import WaveModes, _resized, _settled, wave_modes
from tests.casingfem.experiment.identify.setups.test_shifted import SETUPS, cluster
from tests.casingfem.experiment.identify.setups.test_wave_likelihood import SETUPS as THREE
from tests.casingfem.experiment.identify.setups.test_wave_likelihood import SHIFT, ZETA, problem, waves

NEVER, ALWAYS, ONCE = (False,) * 9, (True,) * 9, (True, *[False] * 8)


def polished(monkeypatch, unsettled=NEVER, counts=(2,) * 9, places=None):
    """A polish whose fits leave modes settled or not, and find so many of them; what it was asked for."""
    c = cluster(((100.0, 100.2), (101.5, 101.3)), (0.004, 0.003))
    own = fit_again(c, SETUPS, c.modes.freq, c.modes.zeta)
    fits, asked, told = [], [], []

    def of_lines(whole, modes, setups, *more):
        asked.append((whole.leak, len(modes.zeta), *more))
        return [c]

    def each(function, items):
        name = function.func
        if name is _told:
            told.append(function.args)
            return [name(*function.args, item) for item in items]
        fits.append((name, function.args))
        some = np.arange(counts[len(fits) - 1]) % 2
        rows = {name: getattr(own, name)[some] for name in ("freq", "zeta", "residues", "variance", "zeta_variance")}
        return [ClusterModes(c, own._replace(**rows))]

    monkeypatch.setattr(shifting, "clusters", of_lines)
    monkeypatch.setattr(shifting, "_unsettled", lambda one: unsettled[len(fits) - 1])
    reading = _Reading(SETUPS, 2e-3, 0.3, 7.0, [])
    return _polish(c.window, c.modes, reading, places, 0.05, each), fits, asked, told, own


@pytest.mark.parametrize(
    ("unsettled", "counts", "looks"),
    [
        (NEVER, (2,) * 9, 2),
        (ALWAYS, (2,) * 9, 5),
        (ONCE, (2,) * 9, 2),
        ((False, True, *NEVER), (2,) * 9, 3),
        (NEVER, (2, 3, 3, *[3] * 6), 3),
        (NEVER, (2, 3, 2, 3, 2, 2, 2, 2, 2), 5),
    ],
)
def test_better_places_are_looked_for_twice_at_least_and_while_something_changes(monkeypatch, unsettled, counts, looks):
    """Then modes are fitted once more where they are: six fits at most."""
    result, fits, asked, _, _ = polished(monkeypatch, unsettled, counts)
    assert [function for function, _ in fits] == [improved] * looks + [_polished]
    assert fits[0][1] == (SETUPS, 0.05)
    assert fits[-1][1] == (SETUPS, 0.05, 2e-3, None)
    assert asked == [(0.3, k, 1000, (2e-3, 3.0), 2e-3) for k in (2, *counts[:looks])]
    assert (result.leak, result.shift, result.evidence) == (0.3, 2e-3, 7.0)


def test_the_last_fit_alone_knows_of_shapes_round_the_circle(monkeypatch):
    places = Places(np.linspace(0.0, 5.0, 6), np.ones(6), np.zeros(6, int), (0, 1, 2))
    made = []
    monkeypatch.setattr(shifting, "Around", SimpleNamespace(of=lambda *given: made.append(given) or "around"))
    monkeypatch.setattr(shifting, "matching_sigma", lambda own, setups, shift, around: np.zeros((2, 2)))
    _, fits, _, told, _ = polished(monkeypatch, places=places)
    assert Around is not shifting.Around
    assert len(made) == 1
    assert made[0][0] is places
    assert fits[-1][1] == (SETUPS, 0.05, 2e-3, "around")
    assert told == [(SETUPS, 2e-3, "around")]


def test_what_exchanges_would_change_adds_to_damping(monkeypatch):
    monkeypatch.setattr(shifting, "matching_sigma", lambda *_: np.array([[1e-4, 2e-4], [3e-2, 4e-2]]))
    result, _, _, _, own = polished(monkeypatch)
    assert result.sigma_matching.tolist() == [1e-4, 2e-4]
    np.testing.assert_allclose(
        result.sigma_zeta, np.sqrt(own.zeta_variance[:, 0] + np.array([3e-2, 4e-2]) ** 2), rtol=1e-12
    )
    np.testing.assert_array_equal(result.variance, own.variance)
    assert result.worth.shape == (2,)
    assert result.setups is SETUPS


def reading(unlikely, count=2):
    fit = SimpleNamespace(unlikely=unlikely, q=np.zeros(count), p=np.zeros((count, 3)))
    return WaveRead(Shapes(np.zeros(count, int), np.ones(count)), fit)


@pytest.mark.parametrize(("moves", "rounds"), [([set()], 1), ([{1}, set()], 2), ([{1}, {0}, {1}, {0}], 3)])
def test_modes_that_moved_are_searched_again_three_times_at_most(monkeypatch, moves, rounds):
    among = []

    def searched(whole, read, which):
        among.append(which)
        n = len(among)
        return reading(10.0 - n), {(0,): [f"round {n}"], (n, n): ["new"]}, moves[n - 1]

    monkeypatch.setattr(wave_search, "_searched", searched)
    monkeypatch.setattr(wave_search, "_resized", lambda whole, read, size: read)
    read, tried = _settled(None, reading(10.0), np.ones(2), {0, 1})
    assert among == [{0, 1}, *moves][:rounds]
    assert read.fit.unlikely == 10.0 - rounds
    assert tried[0,] == [f"round {rounds}"]  # the last counts
    assert len(tried) == 1 + rounds


@pytest.mark.parametrize(
    ("falls", "times"),
    [([1.99 * GAIN, 0.99 * GAIN, 9.0], 2), ([0.99 * GAIN, 9.0, 9.0], 1), ([-0.99 * GAIN], 1), ([9.0] * 9, 3),
     ([-9.0, 0.0], 2)],
)  # fmt: skip
def test_sizes_are_found_anew_while_that_makes_a_difference(monkeypatch, falls, times):
    asked = []

    def sized(whole, read, first):
        asked.append(first)
        return reading(read.fit.unlikely - falls[len(asked) - 1])

    monkeypatch.setattr(wave_search, "sized", sized)
    found = _resized(None, reading(100.0), "first")
    assert asked == ["first"] * times
    assert found.fit.unlikely == pytest.approx(100.0 - sum(falls[:times]))


@pytest.mark.parametrize(("offered", "searches"), [(0, 1), (1, 3), (2, 4), (5, 4)])
def test_two_more_modes_at_most_are_looked_for_and_weak_ones_are_searched_again_then(monkeypatch, offered, searches):
    whole, asked, told, offers = problem(), [], [], []

    def settled(problem, read, size, among):
        asked.append((problem, size.tolist(), among))
        return read, {(len(asked),): [f"search {len(asked)}"]}

    def one_more(problem, read):
        offers.append(problem)
        n = len(offers)
        if n > offered:
            return None
        more = reading(5.0, 2 + n)
        more = more._replace(shapes=more.shapes._replace(size=10.0 * n + np.arange(2.0 + n)))
        return SimpleNamespace(problem=f"problem {n}", read=more, worth=1.0 + n)

    def tell(problem, read, others):
        told.append((problem, len(read.fit.q), others))
        return WaveModes(*[np.zeros(0)] * 10)

    monkeypatch.setattr(wave_search, "_settled", settled)
    monkeypatch.setattr(wave_search, "one_more", one_more)
    monkeypatch.setattr(wave_search, "_told", tell)
    monkeypatch.setattr(wave_search, "_near_last", lambda problem, read: {f"near {len(read.fit.q)}"})
    monkeypatch.setattr(wave_search, "weak", lambda problem, read: np.eye(3)[[0, 0, 1]][:, [0, 1]] * [0.0, 1.0] > 0.0)
    found = wave_modes(THREE, waves(), SHIFT, whole.cluster)
    size = np.sqrt(np.mean(np.abs(whole.cluster.modes.residues) ** 2, axis=1))
    added = min(offered, 2)
    assert len(asked) == searches
    np.testing.assert_allclose(asked[0][1], size, rtol=1e-12)
    assert asked[0][2] == {0, 1}
    assert len(ZETA) == 2
    for n in range(1, added + 1):
        _, sizes, among = asked[n]
        assert (asked[n][0], among) == (f"problem {n}", {f"near {2 + n}"})
        np.testing.assert_allclose(sizes, [*size, *[10.0 * k + 1.0 + k for k in range(1, n + 1)]], rtol=1e-12)
    if added:
        assert asked[-1][2] == {2}  # weak in some set-up
        assert asked[-1][1] == asked[-2][1]
    assert found.worth.tolist() == [2.0, 3.0][:added]
    assert told[0][1:] == (2 + added, [f"search {n}" for n in range(1, searches + 1)])
    assert len(offers) == min(offered + 1, 2)
