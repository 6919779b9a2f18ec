"""Which poles are left out and where more are tried: both sides of each limit."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_fit import fit_poles
from casingfem.experiment.identify.poles.pole_selection import (
    _gain,
    _only_one,
    _places,
    _repeats,
    principal,
    pruned,
    reach,
    select_poles,
)
from casingfem.experiment.identify.poles.pole_window import Window

LINES = np.arange(95.0, 106.0, 0.1)


def window(freq, zeta, shapes, sigma=0.0, lines=LINES, residues="real", floor=0.0):
    """Responses of modes with these shapes (modes, channels), and white noise."""
    shapes = np.atleast_2d(shapes)
    empty = Window(freq=lines, Y=np.zeros((2 * len(lines), shapes.shape[1])), power=0, residues=residues,
                   weight=np.ones(shapes.shape[1]), floor=floor, along=np.ones(len(lines)))  # fmt: skip
    H = empty.values(np.array(freq, float), np.array(zeta, float)) @ shapes
    noise = np.random.default_rng(44).standard_normal((2 * len(lines), shapes.shape[1]))
    return Window(freq=lines, Y=np.vstack([H.real, H.imag]) + sigma * noise, power=0, residues=residues,
                  weight=empty.weight, floor=floor, along=empty.along)  # fmt: skip


@pytest.mark.parametrize(("count", "kept"), [(1000, 1000), (1001, 501), (2001, 667)])
def test_the_search_sees_a_thousand_lines_at_most(count, kept):
    seen = window([100.0], [0.01], [1.0, 2.0], lines=np.linspace(95.0, 105.0, count))
    few = principal(seen)
    assert len(few.freq) == kept
    assert few.freq[1] == seen.freq[-(-count // 1000)]
    assert few.Y.shape == (2 * kept, 2)


def test_of_more_than_sixty_channels_the_search_sees_the_thirty_strongest_combinations():
    rng = np.random.default_rng(1)
    lines = np.linspace(95.0, 105.0, 50)
    sixty, more = (window([100.0], [0.01], rng.standard_normal(count), 0.1, lines) for count in (60, 61))
    assert principal(sixty) is sixty
    few = principal(more)
    sizes = np.linalg.svd(more.Y, compute_uv=False)
    np.testing.assert_allclose(np.linalg.svd(few.Y, compute_uv=False), sizes[:30], rtol=1e-9)
    np.testing.assert_array_equal(few.weight, np.ones(30))


def test_poles_lie_within_three_hundredths_beyond_the_lines():
    seen = window([100.0], [0.01], [1.0])
    assert reach(seen) == pytest.approx((95.0 * 0.97, LINES[-1] * 1.03), rel=1e-12)


def poles(freq, zeta, A, step=0.01):
    """A made-up fit; residues A (poles, columns, channels)."""
    A = np.array(A)
    seen = SimpleNamespace(freq=np.array([90.0, 90.0 + step]), Y=np.zeros((4, A.shape[2])))
    return SimpleNamespace(freq=np.array(freq), zeta=np.array(zeta), A=A, window=seen)


@pytest.mark.parametrize(("gap", "same"), [(5.99, [(0, 1)]), (6.01, [])])
def test_poles_within_three_bandwidths_of_the_wider_and_of_one_shape_repeat_each_other(gap, same):
    for zeta in ([0.01, 0.002], [0.002, 0.01]):  # bandwidths of 2 and 0.4 Hz, about
        shape = np.arange(1.0, 7.0)
        freq = 100.0 * np.array([1.0, 1.0 + 1e-9]) + [0.0, gap * (1.0 if zeta[0] > zeta[1] else 1.0 / (1.0 - 0.06))]
        assert _repeats(poles(freq, zeta, [[shape], [-2.0 * shape]])) == same


@pytest.mark.parametrize(("mac", "same"), [(0.91, [(1, 2)]), (0.89, [])])
@pytest.mark.parametrize("both", [True, False])
def test_shapes_of_repeated_poles_are_alike(mac, same, both):
    first, other = np.eye(6)[:2]
    second = 3.0 * (np.sqrt(mac) * first + np.sqrt(1.0 - mac) * other)
    if both:  # turned by a phase, real over imaginary parts
        A = [
            np.array([other, 0 * other]),
            np.array([0.6 * first, 0.8 * first]),
            np.array([-0.8 * second, 0.6 * second]),
        ]
    else:
        A = [[other], [first], [second]]
    assert _repeats(poles([99.0, 100.0, 101.0], [0.01] * 3, A)) == same


@pytest.mark.parametrize(
    ("gap", "low", "same"),
    [
        (0.99, 0.9, True),  # half of 2 Hz
        (1.01, 0.9, False),
        (1.99, 0.24, True),  # a quarter of the other's peak, within its bandwidth
        (1.99, 0.26, False),
        (2.01, 0.24, False),
    ],
)
@pytest.mark.parametrize("order", [1, -1])
def test_where_channels_are_few_a_low_peak_beside_a_high_one_repeats_it(gap, low, same, order):
    """Peaks are residues over bandwidths in units of the frequency: both have the bandwidth of 2 Hz here."""
    freq = np.array([100.0, 100.0 + gap])
    zeta = 1.0 / freq
    sizes = np.array([1.0, low])[::order]
    A = (sizes / freq)[:, None, None] * np.array([[0.6, 0.0, 0.8, 0.0, 0.0]])
    assert _repeats(poles(freq, zeta, A)) == ([(0, 1)] if same else [])
    many = np.concatenate([A, np.zeros((2, 1, 1))], axis=2)
    many[1] = np.roll(many[1], 1)
    assert _repeats(poles(freq, zeta, many)) == []  # six channels tell their shapes apart


def test_where_channels_are_few_the_lines_next_to_a_narrow_peak_are_its_own():
    """Within half of three lines two are one, however high."""
    for gap, same in ((0.149, [(0, 1)]), (0.151, [])):
        assert _repeats(poles([100.0, 100.0 + gap], [1e-5, 1e-5], np.ones((2, 1, 5)), step=0.1)) == same
    for gap, same in ((0.299, [(0, 1)]), (0.301, [])):  # with six, three lines
        assert _repeats(poles([100.0, 100.0 + gap], [1e-5, 1e-5], np.ones((2, 1, 6)), step=0.1)) == same


@pytest.mark.parametrize("residues", ["real", "complex"])
def test_one_more_resonance_gains_what_the_squares_fall(residues):
    rng = np.random.default_rng(7)
    seen = window([100.0], [0.01], [[1.0, -2.0, 0.5]], 1.0, residues=residues)
    fit = fit_poles(seen, np.array([100.0]), np.array([0.01]), steps=0)
    Q = np.linalg.qr(np.hstack([seen.resonances(fit.freq, fit.zeta), seen.residuals()]))[0]
    left = seen.Y - Q @ (Q.T @ seen.Y)
    places, zeta = np.array([97.0, 100.3]), rng.uniform(0.005, 0.02, 2)
    found = _gain(seen.resonances(places, zeta), Q, left, seen.columns)
    for k in range(2):
        column = seen.resonances(places[k : k + 1], zeta[k : k + 1])[:, :1]
        more = np.hstack([Q, column])
        fall = np.sum(left**2) - np.sum((left - more @ np.linalg.lstsq(more, left, rcond=None)[0]) ** 2)
        assert found[k] == pytest.approx(fall, rel=1e-8)


GRID = np.linspace(95.0 * 0.97, LINES[-1] * 1.03, 2 * len(LINES))


@pytest.mark.parametrize("usual", [2e-3, 6e-3])
@pytest.mark.parametrize("wider", [1.0, 3.0])
def test_the_best_place_is_that_of_the_grid_with_the_usual_damping_or_three_times_that(usual, wider):
    """The usual one is that of the known poles, 0.2 % where none is known; other places are a bandwidth off."""
    known = [98.0] if usual != 2e-3 else []
    shapes = np.array([[1.0, 0.5, 0.0, 0.2], [0.3, -2.0, 1.0, 0.5]])[: 1 + len(known)]
    seen = window([GRID[120], *known], [wider * usual, *[usual] * len(known)], shapes, 1e-6)
    fit = fit_poles(seen, np.array(known), np.full(len(known), usual), steps=0)
    found = _places(fit)
    assert found[0] == pytest.approx((GRID[120], wider * usual), rel=1e-12)
    assert all(zeta in (usual, 3.0 * usual) for _, zeta in found)
    assert all(abs(f - GRID[120]) >= 2.0 * usual * GRID[120] for f, _ in found[1:])


@pytest.mark.parametrize(("share", "count"), [(1.01, 1), (0.99, 0)])
def test_a_place_is_tried_where_it_gains_a_quarter_of_its_price(share, count):
    """The squares of one mode that stands on the grid, in units of a floor that is the noise."""
    shape = [1.0, 0.5, -0.3, 0.2]
    plain = window([GRID[120]], [2e-3], shape)
    rest = plain.Y - plain.residuals() @ np.linalg.lstsq(plain.residuals(), plain.Y, rcond=None)[0]
    price = (4 + 2) * np.log(2 * 4 * len(LINES))
    floor = np.sqrt(np.sum(rest**2) / (0.25 * price * share))
    fit = fit_poles(window([GRID[120]], [2e-3], shape, floor=floor), np.zeros(0), np.zeros(0))
    assert len(_places(fit)) == count


def test_three_places_are_tried():
    seen = window(GRID[[60, 110, 160, 210]], [2e-3] * 4, np.eye(4))
    found = _places(fit_poles(seen, np.zeros(0), np.zeros(0)))
    assert len(found) == 3
    assert {round(f, 6) for f, _ in found} < {round(f, 6) for f in GRID[[60, 110, 160, 210]]}


TWO = window([98.0, 102.0], [0.004, 0.006], [[1.0, -0.5, 0.8, 0.3, 0.6, 0.2], [0.4, 0.9, -0.7, 0.5, 0.1, -0.3]], 0.3)


@pytest.mark.parametrize(
    ("extra", "zeta"),
    [((91.0,), 0.004), ((110.0,), 0.004), ((100.0,), 0.2), ((104.5,), 0.003), ((98.02,), 0.004), ((), 0.1)],
)
def test_poles_outside_too_damped_in_noise_or_twice_are_left_out(extra, zeta):
    start = np.array([98.0, *extra, 102.0])
    damping = np.array([0.004, *[zeta] * len(extra), 0.006])
    fit = pruned(fit_poles(TWO, start, damping, steps=0))
    np.testing.assert_allclose(fit.freq, [98.0, 102.0], atol=0.02)


def test_a_lone_peak_is_kept_where_it_explains_half_of_what_there_is():
    """The noise of its lines denies it; the verdict says why."""
    rng = np.random.default_rng(3)
    for share, count in ((0.4, 1), (3.0, 0)):
        seen = window([100.0], [0.004], [[1.0]])
        scatter = rng.standard_normal((2, LINES.size, 1))
        H = seen.as_complex * (1.0 + share * (scatter[0] + 1j * scatter[1]))
        noisy = replace(seen, Y=np.vstack([H.real, H.imag]))
        none = fit_poles(noisy, np.zeros(0), np.zeros(0))
        one = _only_one(none)
        assert len(one.freq) == count
        if count:
            assert one.squares < 0.5 * none.squares
            assert one.freq[0] == pytest.approx(100.0, abs=0.2)


@pytest.mark.parametrize(("count", "channels"), [(2, 6), (3, 6)])
def test_without_a_search_the_poles_are_those_of_the_start(count, channels):
    start = np.array([[98.1, 0.005], [102.1, 0.005], [104.0, 0.02]])[:count]
    fit = select_poles(TWO, start, search=False)
    assert len(fit.freq) == count
    np.testing.assert_allclose(fit.freq[:2], [98.0, 102.0], atol=0.05)
    searched = select_poles(TWO, start)
    np.testing.assert_allclose(searched.freq, [98.0, 102.0], atol=0.02)
    assert searched.window.residues == "real"


def test_what_a_search_on_combinations_found_is_fitted_to_every_channel_and_line():
    shape = np.random.default_rng(7).standard_normal(61)
    seen = window([100.0], [0.01], shape, 0.01, np.linspace(95.0, 105.0, 1001))
    fit = select_poles(seen, np.array([[100.3, 0.015]]))
    assert fit.window.Y.shape == seen.Y.shape
    assert fit.freq == pytest.approx([100.0], abs=1e-3)
    assert fit.A.shape[-1] == 61


def test_complex_residues_must_earn_themselves():
    """They are tried where real ones leave more than the noise, of variance 1."""
    shape = np.array([[1.0, -0.5, 0.8, 0.3, 0.6, 0.2]])
    fit = select_poles(window([100.0], [0.004], shape, 1.3), np.array([[100.0, 0.004]]))
    assert fit.window.residues == "real"
    assert fit.freq == pytest.approx([100.0], abs=0.02)
