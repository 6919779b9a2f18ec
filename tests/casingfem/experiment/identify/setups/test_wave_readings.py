"""Other readings of modes that are waves: where they are tried, on which lines, and how sure the likeliest is."""

import numpy as np
import pytest

from casingfem.experiment.identify.setups import wave_tries
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.wave_fit import WaveRead, wave_fit
from casingfem.experiment.identify.setups.wave_model import Shapes
from casingfem.experiment.identify.setups.wave_residues import unlikely_at
from casingfem.experiment.identify.setups.wave_search import _near_last, _Other, _told
from casingfem.experiment.identify.setups.wave_tries import (
    _along,
    _exchanged,
    _last,
    _lines_about,
    _moved,
    _partners,
    _starts,
    part_about,
    tries,
    weak,
)
from tests.casingfem.experiment.identify.setups.test_wave_likelihood import (
    FREQ,
    KIND,
    LINES,
    NOISE,
    SETUPS,
    SHIFT,
    SIZE,
    WEIGHT,
    ZETA,
    problem,
)


def reading(whole, freq=FREQ, kind=KIND, zeta=ZETA):
    shapes = Shapes(np.array(kind), SIZE)
    return WaveRead(shapes, wave_fit(whole, shapes, np.log(freq), np.log(zeta)))


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_a_peak_is_weak_where_it_is_known_to_three_hundredths_of_its_damping(factor):
    whole = problem()
    read = reading(whole)
    sigma = np.sqrt(np.diag(read.fit.covariance(1.0))[:6].reshape(2, 3)) / ZETA[:, None]
    limit = np.sort(sigma.ravel())[3]
    louder = whole._replace(cluster=whole.cluster._replace(noise=(factor * 0.03 / limit) ** 2))
    np.testing.assert_array_equal(weak(louder, read), sigma >= limit if factor > 1.0 else sigma > limit)


def test_two_modes_are_exchanged_in_a_set_up_or_both_put_where_the_others_have_them():
    p = np.array([[1.0, 2.0, 3.0], [10.0, 20.0, 30.0], [4.0, 5.0, 7.0]])
    exchanged, together = _exchanged(p, np.array([0, 2]), 1)
    assert exchanged.tolist() == [[1.0, 5.0, 3.0], [10.0, 20.0, 30.0], [4.0, 2.0, 7.0]]
    assert together.tolist() == [[1.0, 2.0, 3.0], [10.0, 20.0, 30.0], [4.0, 5.5, 7.0]]


def test_a_mode_is_tried_at_thirteen_places_four_shifts_about_where_the_others_have_it():
    whole = problem()
    read = reading(whole)
    starts, unlikely = _along(whole, read.shapes, read.fit, 1, 2)
    middle = np.log(FREQ[1, :2]).mean()
    np.testing.assert_allclose(starts[:, 1, 2], middle + 4.0 * SHIFT * np.arange(-6, 7) / 6.0, rtol=1e-12)
    rest = np.repeat(np.log(FREQ)[None], 13, axis=0)
    rest[:, 1, 2] = starts[:, 1, 2]
    np.testing.assert_array_equal(starts, rest)
    each = [unlikely_at(whole, read.shapes, whole.products(start, read.fit.q)) for start in starts]
    np.testing.assert_allclose(unlikely, each, rtol=1e-12)


@pytest.mark.parametrize(
    ("unlikely", "here", "there"),
    [
        ([5, 3, 5, 6, 1, 6, 4, 5], 4, 1),
        ([5, 3, 5, 6, 1, 6, 4, 5], 1, 4),
        ([5, 3, 5, 6, 1, 6, 4, 5], 4.7, 1),  # nearest to the valley at 4
        ([2, 3, 5, 6, 7, 6, 4, 3], 0, 7),  # ends are valleys, too
        ([2, 3, 5, 6, 7, 6, 4, 3], 7, 0),
        ([5, 3, 2, 3, 4, 5, 6, 7], 2, None),
    ],
)
def test_a_mode_moves_to_the_likeliest_valley_but_its_own(monkeypatch, unlikely, here, there):
    starts = np.arange(8.0)[:, None, None] + np.zeros((8, 2, 3))
    monkeypatch.setattr(wave_tries, "_along", lambda *_: (starts, np.array(unlikely, float)))
    whole = problem()
    read = reading(whole)
    at = read.fit.p.copy()
    at[1, 2] = here + 0.1
    found = list(_moved(whole, read._replace(fit=read.fit._replace(p=at)), 1, 2))
    assert [start[1, 2] for start in found] == ([] if there is None else [there])


@pytest.mark.slow
def test_a_weaker_mode_is_tried_as_the_partner_of_a_stronger_wave():
    whole = problem()
    read = reading(whole)
    loud = whole._replace(cluster=whole.cluster._replace(noise=1e9))
    ((shapes, p),) = _partners(loud, read, np.array([0, 1]))
    assert shapes.kind.tolist() == [1, 1]  # the second is the smaller one
    np.testing.assert_array_equal(p[0], read.fit.p[0])
    fit = read.fit
    for _ in range(2):
        for s in range(3):
            starts, unlikely = _along(loud, shapes, fit, 1, s)
            fit = fit._replace(p=starts[unlikely.argmin()])
    np.testing.assert_array_equal(p, fit.p)
    quiet = whole._replace(cluster=whole.cluster._replace(noise=1e-9))
    assert list(_partners(quiet, read, np.array([0, 1]))) == []  # neither is weak
    assert list(_partners(loud, reading(whole, kind=[1, 1]), np.array([0, 1]))) == []
    assert list(_partners(loud, reading(whole, kind=[2, 1]), np.array([0, 1]))) == []  # the stronger is no wave
    assert len(list(_partners(loud, reading(whole, kind=[1, 2]), np.array([0, 1])))) == 1


def test_a_mode_none_of_whose_peaks_is_weak_is_tried_nowhere_else():
    whole = problem()
    assert list(tries(whole, reading(whole), np.array([1]))) == []


def test_a_part_has_the_modes_near_and_the_lines_about_them_without_the_others():
    whole = problem()
    read = reading(whole)
    part = part_about(whole, read, (1,))
    assert part.some.tolist() == [0, 1]  # within a bandwidth and four shifts
    scale = LINES.mean()
    fine = whole._replace(shift=1e-6, weight=WEIGHT * scale)
    read = reading(fine, zeta=np.array([2e-3, 3e-3]))
    part = part_about(fine, read, (1,))
    assert part.some.tolist() == [1]
    data = whole.cluster.window
    assert len(part.problem.cluster.window.freq) == len(data.freq)  # fewer than forty
    other = Modes(FREQ[:1], np.array([2e-3]), read.fit.residues[:1] / WEIGHT / scale)
    left = data.as_complex - other.response(data, SETUPS)
    np.testing.assert_allclose(part.problem.cluster.window.as_complex, left, rtol=1e-9)
    np.testing.assert_allclose(part.problem.weight, WEIGHT * scale)
    assert (part.read.shapes.kind.tolist(), part.read.shapes.size.tolist()) == ([KIND[1]], [SIZE[1]])
    back = part.put_into(fine, read, part.read)
    assert back.shapes.kind.tolist() == KIND.tolist()
    np.testing.assert_array_equal(back.shapes.size, SIZE)


@pytest.mark.parametrize(
    ("freq", "zeta", "lines"),
    [
        ((100.0, 101.0), 0.01, None),
        ((90.1, 90.2), 1e-4, (0, 40)),
        ((149.9, 149.95), 1e-4, (360, 400)),
        ((100.0, 100.1), 1e-4, 40),
    ],
)
def test_lines_about_modes_are_eight_damping_ratios_and_four_shifts_beyond(freq, zeta, lines):
    """Forty at least."""
    whole = problem()
    long = np.arange(90.0, 150.0, 0.15)
    seen = whole._replace(cluster=whole.cluster._replace(window=type("Seen", (), {"freq": long})()))
    found = _lines_about(seen, Modes(np.array([freq, freq]), np.array([zeta, 0.5 * zeta]), np.ones((2, 7))))
    reach = 8.0 * zeta + 4.0 * SHIFT
    a, b = np.searchsorted(long, [freq[0] * (1.0 - reach), freq[1] * (1.0 + reach)])
    if lines is None:
        assert (found.start, found.stop) == (a, b)
    elif lines == 40:
        assert (found.start, found.stop - found.start) == (b - 40, 40)
    else:
        assert (max(found.start, 0), min(found.stop, 400)) == lines


def test_how_sure_modes_are_is_the_covariance_of_the_fit():
    whole = problem()
    read = reading(whole)
    found = _told(whole, read, [])
    covariance = read.fit.covariance(NOISE)
    np.testing.assert_allclose(found.variance.ravel(), np.diag(covariance)[:6], rtol=1e-9)
    want = [np.sqrt(covariance[3 * k : 3 * k + 3, 3 * k : 3 * k + 3].sum()) / 3.0 for k in range(2)]
    np.testing.assert_allclose(found.sigma_freq, want, rtol=1e-9)
    np.testing.assert_allclose(found.sigma_zeta, np.sqrt(np.diag(covariance)[6:]), rtol=1e-9)
    np.testing.assert_allclose(found.mean_freq, np.exp(np.log(FREQ).mean(axis=1)), rtol=1e-12)
    np.testing.assert_allclose(found.freq, FREQ, rtol=1e-12)
    np.testing.assert_allclose(found.zeta, ZETA, rtol=1e-12)
    np.testing.assert_array_equal(found.residues, read.fit.residues)
    assert not np.r_[found.sigma_matching, found.rival, found.worth].any()
    other = _Other(0.0, np.array([1]), np.array([4e-4]))
    off = _told(whole, read, [other])
    np.testing.assert_allclose(off.mean_freq / found.mean_freq, [1.0, np.exp(2e-4)], rtol=1e-12)
    np.testing.assert_allclose(off.sigma_matching, [0.0, 2e-4], atol=1e-12)


def test_another_reading_is_told_by_its_rise_and_its_mean_frequencies():
    whole = problem()
    best, read = reading(whole), reading(whole, FREQ * np.array([[1.0 + 3e-4], [1.0]]))
    other = _Other.of(read, best, np.array([0, 1]))
    assert other.rise == pytest.approx(read.fit.unlikely - best.fit.unlikely, rel=1e-12)
    np.testing.assert_allclose(other.moved, [np.log(1.0 + 3e-4), 0.0], atol=1e-12)
    assert _near_last(whole, best) == {0, 1}
    assert _near_last(whole._replace(shift=1e-6), reading(whole, zeta=np.array([2e-3, 3e-3]))) == {1}


def test_one_more_mode_starts_where_squares_fall_most_and_beside_lone_waves():
    whole = problem()
    read = reading(whole)
    usual = 0.016  # median of both
    starts = list(_starts(whole, read, usual))
    p, q = read.fit.p, read.fit.q
    np.testing.assert_allclose([start[1][-1] for start in starts[:2]], np.log([usual, 3.0 * usual]), rtol=1e-12)
    for start, _ in starts[:2]:
        assert np.ptp(start[-1]) == 0.0
        np.testing.assert_array_equal(start[:2], p)
    beside = [(p[k] + side * 0.5 * ZETA[k], q[k]) for k in range(2) for side in (-1, 1)]
    assert len(starts) == 6  # of n = 2 and 1: both lack a partner
    for (start, damping), (at, zeta) in zip(starts[2:], beside, strict=True):
        np.testing.assert_allclose(start[-1], at, rtol=1e-12)
        assert damping[-1] == zeta
    assert len(list(_starts(whole, reading(whole, kind=[1, 1]), usual))) == 2
    assert len(list(_starts(whole, reading(whole, kind=[1, 2]), usual))) == 4  # what is no wave has no partner
    assert _last(Shapes(np.array([4, 5, 6]), SIZE), 9).kind.tolist() == [4, 5, 9]
