"""What of a set of responses is used: both sides of each limit, what is said of what is not."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.identify.usable import _coherent, _ends_cut, _filled, _same_places, usable

X = 100.0 + 0.1 * np.arange(60)


def frfs(responses=None, x=X, channels=3, **changes):
    rng = np.random.default_rng(3)
    data = rng.standard_normal((channels, len(x))) + 1j * rng.standard_normal((channels, len(x)))
    given = {"kind": "frf", "x": x, "responses": data if responses is None else responses, "unit": "m/N",
             "response_point": np.arange(channels) + 11}  # fmt: skip
    return cf.frf.FrfSet.from_arrays(**given | changes)


def test_lines_of_a_band_are_used_with_both_ends():
    whole = frfs()
    found = usable(whole, (100.5, 104.0), None, None)
    np.testing.assert_allclose(found.freq, X[5:41], rtol=1e-12)
    np.testing.assert_array_equal(found.H, whole.responses[:, 5:41])
    assert found.along.tolist() == [1.0] * 36
    assert (found.power, found.notes) == (0, ())
    assert usable(whole, None, "mobility", None).power == 1
    faint = usable(frfs(1e-12 * whole.responses), None, None, None)
    np.testing.assert_array_equal(faint.H, 1e-12 * whole.responses)
    at_rest = frfs(x=np.arange(60.0))
    assert usable(at_rest, None, None, None).freq[0] == 1.0  # nothing is measured at 0 Hz


@pytest.mark.parametrize(("band", "words"), [((-1.0, 9.0), "band -1 to 9 Hz"), ((5.0, 5.0), "from < to")])
def test_bands_ascend_from_zero(band, words):
    with pytest.raises(cf.errors.InputError, match=words):
        usable(frfs(), band, None, None)
    assert len(usable(frfs(), (0.0, 1e9), None, None).freq) == 60


def test_other_functions_than_frequency_responses_are_refused():
    with pytest.raises(cf.errors.InputError, match="found kind 'spectrum'; expected frequency responses"):
        usable(frfs(kind="spectrum"), None, None, None)


def test_thirty_lines_are_enough():
    assert len(usable(frfs(), (100.0, 102.91), None, None).freq) == 30
    with pytest.raises(cf.errors.InputError, match="found 29 lines in the band; expected at least 30"):
        usable(frfs(), (100.0, 102.85), None, None)


@pytest.mark.parametrize(("off", "even"), [(0.049, True), (0.051, False), (-0.049, True), (-0.051, False)])
def test_lines_are_even_within_a_twentieth_of_a_step(off, even):
    x = X.copy()
    x[20] += 0.1 * off
    if even:
        np.testing.assert_allclose(usable(frfs(x=x), None, None, None).freq, X, rtol=1e-12)
    else:
        with pytest.raises(cf.errors.InputError, match=r"found steps from .* expected even steps"):
            usable(frfs(x=x), None, None, None)


def test_a_channel_that_lacks_a_fifth_of_the_lines_is_left_out():
    for count, sensors in ((12, [11, 12, 13]), (13, [11, 13])):
        data = frfs().responses.copy()
        data[1, 4 : 4 + count] = np.nan
        found = usable(frfs(data), None, None, None)
        assert found.frfs.response_point.tolist() == sensors
        if count == 12:
            assert found.notes == ("nan in channel 2: 12 of 60 lines left out, from 100.4 to 101.5 Hz",)
            assert found.along.tolist() == [1.0] * 4 + [0.0] * 12 + [1.0] * 44
            between = data[1, 3] + (data[1, 16] - data[1, 3]) * np.arange(1, 13) / 13
            np.testing.assert_allclose(found.H[1, 4:16], between, rtol=1e-12)
            np.testing.assert_array_equal(found.H[[0, 2]], data[[0, 2]])
        else:
            assert found.notes == ("nan on more than 20 % of the lines: channel 2; left out: point 12",)
            assert found.along.tolist() == [1.0] * 60


def test_a_sensor_with_one_silent_channel_goes_with_all_its_channels():
    data = frfs(channels=4).responses.copy()
    data[2] = 0.0
    points = {"response_point": [11, 12, 11, 12], "reference_point": [1, 1, 2, 2]}
    found = usable(frfs(data, channels=4, **points), None, None, None)
    assert found.frfs.response_point.tolist() == [12, 12]
    assert found.frfs.reference_point.tolist() == [1, 2]
    np.testing.assert_array_equal(found.H, data[[1, 3]])
    assert found.notes == ("zero on every line: channel 3; left out: point 11",)
    data[1, 7] = np.nan
    single = usable(frfs(data[[1, 3]], channels=2), None, None, None)
    assert single.notes == ("nan in channel 1: 1 of 60 lines left out, at 100.7 Hz",)
    data[:3, 20:40], data[3] = np.nan, 0.0
    with pytest.raises(
        cf.errors.InputError, match="zero on every line: channel 4; left out: point 14; nan on more than 20 %"
    ):
        usable(frfs(data, channels=4), None, None, None)


def test_lines_at_the_ends_without_any_number_are_no_lines():
    H = np.ones((2, 6), complex)
    H[:, [0, 3, 5]], H[0, 1] = np.nan, np.nan
    kept = np.array([True, True, True, True, True, True])
    assert _ends_cut(kept, H).tolist() == [False, True, True, True, True, False]
    kept[1] = False
    assert _ends_cut(kept, H).tolist() == [False, False, True, True, True, False]
    assert not _ends_cut(kept, np.full((2, 6), np.nan)).any()


def test_what_is_missing_is_filled_by_a_straight_line_of_both_parts():
    H = np.array([[1.0 + 2.0j, np.nan, np.nan, 4.0 - 1.0j], [np.nan, 5.0j, 6.0, 7.0]])
    np.testing.assert_allclose(_filled(H), [[1 + 2j, 2 + 1j, 3, 4 - 1j], [5j, 5j, 6.0, 7.0]])


def test_a_line_weighs_less_where_the_coherence_is_low():
    """By |H|^2 (1 - g)/g over its median, of running medians over 21 lines, between a tenth and one."""
    rng = np.random.default_rng(8)
    H = np.exp(0.3 * rng.standard_normal((3, 60))) * np.exp(1j * rng.uniform(0.0, 6.0, (3, 60)))
    g = np.clip(0.9 + 0.08 * rng.standard_normal((3, 60)), 0.1, 0.9999)
    g[:, 42:] = 0.0
    g[2, :25] = 1.0
    data, told = frfs(H), frfs(g + 0j, kind="spectrum", unit="")
    kept = np.arange(60) % 60 >= 5

    def running(rows):
        padded = np.pad(rows, [(0, 0), (10, 10)], mode="edge")
        return np.array([np.median(padded[:, k : k + 21], axis=1) for k in range(rows.shape[1])]).T

    share = np.clip(running(g[:, kept]), 1e-3, 1.0 - 1e-6)
    variance = running(np.abs(H[:, kept]) ** 2 * (1.0 - share) / share)
    noise = np.sqrt(np.median(variance / np.median(variance, axis=1, keepdims=True), axis=0))
    want = np.clip(1.0 / noise, 0.1, 1.0)
    np.testing.assert_allclose(_coherent(data, told, kept), want, rtol=1e-9)
    assert len(np.unique(want)) >= 10
    assert (want.min(), want.max()) == (0.1, 1.0)
    np.testing.assert_allclose(
        usable(data, None, None, told).along, _coherent(data, told, np.ones(60, bool)), rtol=1e-12
    )


@pytest.mark.parametrize(("level", "share"), [(1e-4, 1e-3), (0.5, 0.5), (1.0, 1.0 - 1e-6)])
def test_coherence_is_taken_for_a_thousandth_at_least_and_hardly_less_than_one(level, share):
    """A first half of known coherence beside another of 0.9, responses of one size."""
    g = np.where(np.arange(60) < 30, level, 0.9)[None] * np.ones((1, 1))
    data, told = frfs(np.ones((1, 60)) + 0j, channels=1), frfs(g + 0j, channels=1, kind="spectrum", unit="")
    first, second = (1.0 - share) / share, 0.1 / 0.9
    found = _coherent(data, told, np.ones(60, bool))
    middle = np.median(np.r_[[first] * 30, [second] * 30])
    np.testing.assert_allclose(
        found[[0, -1]], np.clip(np.sqrt(middle / np.array([first, second])), 0.1, 1.0), rtol=1e-6
    )


def test_channels_of_a_coherence_are_found_by_their_places():
    """From the same sensor to the same reference; a sensor's only one is that with all references."""
    places = {
        "response_point": [1, 1, 2, 2, 3],
        "response_direction": [1, 1, 1, 1, 2],
        "reference_point": [7, 8, 7, 8, 7],
    }
    theirs = {"response_point": [2, 1, 1, 3], "response_direction": [1, 1, 1, 1], "reference_point": [9, 8, 7, 7]}
    mine, other = frfs(channels=5, **places), frfs(channels=4, **theirs)
    found = _same_places(mine, other)
    assert found[0].tolist() == [0, 1, 2, 3]
    assert found[1].tolist() == [2, 1, 0, 0]
