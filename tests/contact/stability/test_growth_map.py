"""Maps of growth over speed from growth in closed form: peaks, ends of bands, narrow bands, and speeds that ascend."""

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

import contact as ct

GRID = np.linspace(10.0, 50.0, 41)


def bell(*bells, damping=1.0):
    """Growth of Gaussian bells (height, middle, width) less damping [1/s]."""
    return lambda v: sum(a * np.exp(-(((v - m) / w) ** 2)) for a, m, w in bells) - damping


def ends(a, m, w, damping=1.0):
    return m - w * np.sqrt(np.log(a / damping)), m + w * np.sqrt(np.log(a / damping))


def test_a_band_ends_where_growth_is_zero_and_its_peak_is_refined():
    found = ct.stability.scan(bell((5.0, 30.3, 4.0)), GRID, floor=1e-6)
    assert found.peak_speed_hz == pytest.approx(30.3, abs=1e-4)
    assert found.peak_growth == pytest.approx(4.0, rel=1e-9)
    assert found.bands_hz == (pytest.approx(ends(5.0, 30.3, 4.0), abs=3e-6),)
    assert found.diverges
    np.testing.assert_array_equal(found.speed_hz, GRID)
    np.testing.assert_allclose(found.growth, bell((5.0, 30.3, 4.0))(GRID), rtol=1e-14)
    assert repr(found).splitlines() == [
        f"largest growth 4 1/s at {found.peak_speed_hz:.5g} Hz",
        "diverges from {:.6g} to {:.6g} Hz".format(*found.bands_hz[0]),
    ]


def test_two_bands_and_the_larger_peak():
    bells = (3.0, 18.2, 2.0), (6.0, 40.7, 3.0)
    found = ct.stability.scan(bell(*bells), GRID, floor=1e-6)
    assert found.peak_speed_hz == pytest.approx(40.7, abs=1e-4)
    assert [band == pytest.approx(ends(*one), abs=1e-5) for band, one in zip(found.bands_hz, bells, strict=True)] == [
        True, True
    ]  # fmt: skip


@pytest.mark.parametrize(("middle", "cut"), [(10.5, 0), (49.5, 1)])
def test_a_band_that_the_range_cuts_ends_with_the_range(middle, cut):
    found = ct.stability.scan(bell((5.0, middle, 4.0)), GRID, floor=1e-6)
    (band,) = found.bands_hz
    exact = list(ends(5.0, middle, 4.0))
    exact[cut] = GRID[[0, -1]][cut]
    assert band == pytest.approx(exact, abs=1e-5)
    assert band[cut] == exact[cut]


def test_growth_everywhere_is_one_band_and_nowhere_none():
    whole = ct.stability.scan(lambda v: 2.0 + 0.01 * v, GRID, floor=1e-6)
    assert whole.bands_hz == ((10.0, 50.0),)
    assert (whole.peak_speed_hz, whole.peak_growth) == pytest.approx((50.0, 2.5), rel=1e-6)
    none = ct.stability.scan(bell((0.9, 30.3, 4.0)), GRID, floor=1e-6)
    assert (none.bands_hz, none.diverges) == ((), False)
    assert none.peak_growth == pytest.approx(-0.1, abs=0.01)
    assert repr(none).splitlines()[1] == "no growth from 10 to 50 Hz"


def test_a_band_between_two_speeds_is_found_at_a_seed_within_the_range():
    rate = bell((5.0, 30.47, 0.05))
    assert not ct.stability.scan(rate, GRID, floor=1e-6).diverges
    found = ct.stability.scan(rate, GRID, floor=1e-6, seeds=np.array([5.0, 30.47, 60.0]))
    assert found.bands_hz == (pytest.approx(ends(5.0, 30.47, 0.05), abs=1e-6),)
    assert set(found.seen_hz.tolist()) > set(GRID.tolist())
    assert (found.seen_hz.min(), found.seen_hz.max()) == (10.0, 50.0)
    assert found.seen_growth.max() == pytest.approx(4.0, rel=1e-6)
    assert len(found.growth) == len(GRID)


def test_growth_below_the_floor_counts_as_none():
    rate = bell((1.3, 30.0, 4.0))
    assert not ct.stability.scan(rate, GRID, floor=0.31).diverges
    (band,) = ct.stability.scan(rate, GRID, floor=0.2).bands_hz
    assert band == pytest.approx(ends(1.3, 30.0, 4.0, 1.2), abs=0.05)


def test_a_document_has_speeds_growth_peak_and_bands():
    found = ct.stability.scan(bell((5.0, 30.3, 4.0)), GRID, floor=1e-6)
    document = found.to_dict()
    assert document["speed_hz"] == GRID.tolist()
    assert document["growth"] == found.growth.tolist()
    assert document["peak"] == {"speed_hz": found.peak_speed_hz, "growth": found.peak_growth}
    assert document["bands_hz"] == [list(band) for band in found.bands_hz]


@pytest.mark.parametrize("speeds", [[1.0], [2.0, 1.0], [1.0, 1.0], [[1.0, 2.0]], []])
def test_speeds_that_do_not_ascend_are_refused(speeds):
    with pytest.raises(ct.InputError, match="found numbers that do not ascend, expected at least two ascending speeds"):
        ct.stability.scan(bell((5.0, 30.0, 4.0)), np.array(speeds), floor=1e-6)


CELLS = 40
SHIFT = np.random.default_rng(5).uniform(0.1, 0.9, CELLS)
POWER = np.random.default_rng(6).integers(2, 7, CELLS)


def crossing(v):
    """Straight, cubic, steep and flat functions of which each changes its sign once between two whole speeds."""
    cell = np.clip(np.floor(v).astype(int), 0, CELLS - 1)
    u = v - cell - SHIFT[cell]
    flat = np.sign(u) * np.abs(u) ** (0.5 * POWER[cell]) + 0.3 * u
    return (-1.0) ** cell * np.where(cell % 3, np.sinh(8.0 * u), flat)


def test_ends_of_many_bands_are_found_together_and_as_exactly_as_each_alone():
    calls, floor = [], 1e-9

    def counted(v):
        calls.append(v.size)
        return crossing(v) + floor

    found = ct.stability.scan(counted, np.arange(CELLS + 1.0), floor=floor)
    edges = np.array(found.bands_hz).ravel()
    exact = [brentq(lambda v: float(crossing(np.array([v]))[0]), k, k + 0.9999999, xtol=1e-14) for k in range(CELLS)]
    np.testing.assert_allclose(edges, exact, atol=1e-7)
    assert np.abs(crossing(edges)).max() <= 0.1 * floor
    first = calls.index(CELLS)
    assert sorted(calls[first:], reverse=True) == calls[first:]  # all at once, and fewer once some are found
    assert sum(calls[first:]) < CELLS * 20


@pytest.mark.parametrize("floor", [0.1, 1e-5])
def test_a_band_ends_where_growth_is_the_floor_within_a_tenth(floor):
    calls = []

    def cube(v):
        calls.append(v)
        return v**3 - 0.2

    ((end, _),) = ct.stability.scan(cube, np.array([0.0, 1.0]), floor=floor).bands_hz
    before, last = (abs(float(v[0]) ** 3 - 0.2 - floor) for v in calls[-2:])
    assert end == calls[-1][0]
    assert last <= 0.1 * floor < before


@pytest.mark.parametrize("middle", np.linspace(0.32, 0.68, 6))
@pytest.mark.parametrize("width", [0.2, 0.5, 0.8])
def test_the_peak_is_the_maximum_between_three_speeds(middle, width):

    def bell_with_slope(v):
        return 1.0 / (1.0 + ((v - middle) / width) ** 2) + 0.05 * v

    found = ct.stability.scan(bell_with_slope, middle + np.array([-0.15, 0.05, 0.2]), floor=1e-6)
    exact = minimize_scalar(
        lambda v: -bell_with_slope(v), bounds=(0.0, 1.0), method="bounded", options={"xatol": 1e-12}
    ).x
    assert bell_with_slope(exact) - found.peak_growth < 1e-5
    assert found.peak_speed_hz == pytest.approx(exact, abs=0.02)
    assert found.peak_growth == pytest.approx(bell_with_slope(found.peak_speed_hz), rel=1e-15)


@pytest.mark.parametrize("inner", [0.2, 0.8])
def test_a_peak_is_at_least_the_largest_growth_given(inner):
    """A kink, which no parabola has, and a value at an end."""
    speeds = np.array([0.0, inner, 1.0])
    found = ct.stability.scan(lambda v: 2.0 - np.abs(v - 0.6), speeds, floor=1e-6)
    assert found.peak_growth >= 2.0 - np.abs(speeds - 0.6).min()
    assert found.peak_speed_hz == pytest.approx(0.6, abs=0.05)
    assert ct.stability.scan(lambda v: 1.0 + v, speeds, floor=1e-6).peak_speed_hz == 1.0


def test_an_end_beside_which_growth_is_no_number_is_none_and_the_others_are_found():
    def partly(v):
        return np.where(np.abs(v - 2.5) < 0.4, np.nan, np.cos(np.pi * v))

    (_, first), (second, third) = ct.stability.scan(partly, np.arange(4.0), floor=1e-9).bands_hz
    assert (first, second) == pytest.approx((0.5, 1.5), abs=1e-9)
    assert np.isnan(third)
