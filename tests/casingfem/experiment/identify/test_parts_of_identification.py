"""The parts that an identification is put together from, each by itself."""

import numpy as np
import pytest

from casingfem.errors import InputError
from casingfem.experiment.circle.orientation import Circle
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.frf.sensor_grid import SensorGrid
from casingfem.experiment.identify import identification
from casingfem.experiment.identify.band_fits import (
    BandFits,
    _window,
)
from casingfem.experiment.identify.identification import (
    _columns,
    _fitted,
    _picked,
    _places,
    _workers,
    belonging,
    channel_notes,
    circle_notes,
    trusted_sensors,
)
from casingfem.experiment.identify.poles.bands import Band, line_noise
from casingfem.experiment.identify.poles.pole_fit import fit_poles
from tests.casingfem.experiment.identify.test_band_parts import LINES, NOISE, responses
from tests.casingfem.experiment.identify.test_found_modes import mode


def test_small_tests_are_worked_on_by_one_process(monkeypatch):
    for size, count in ((39_999, 1), (40_000, 3)):
        assert _workers(np.zeros(size), 3) == count
    monkeypatch.setattr(identification, "usable_cores", lambda: 5)
    for can_fork, count in ((True, 5), (False, 1)):
        monkeypatch.setattr(identification, "forks", lambda can_fork=can_fork: can_fork)
        assert _workers(np.zeros(40_000), None) == count


def test_picked_frequencies_lie_between_the_lines():
    assert _picked("file", [100.0, 95.0, 100.0], LINES).tolist() == [95.0, 100.0]
    wrong = (
        ([90.0], "found 90 Hz picked"),
        ([100.0, 111.75], "found 111.75 Hz"),
        ([], "no frequency picked"),
        ([np.nan], "nan Hz picked"),
    )
    for pick, words in wrong:
        with pytest.raises(InputError, match=f"{words}.*between 90 and 111.75 Hz"):
            _picked("file", pick, LINES)


def grid(count=4, references=1, directions=None, theta=None):
    channels = np.arange(count * references).reshape(references, count).T[:, ::-1]
    return SensorGrid(points=np.arange(count) + 1, directions=np.ones(count, int) if directions is None else directions,
                      theta=np.radians(np.linspace(0.0, 360.0, count, endpoint=False)) if theta is None else theta,
                      references=np.arange(2 * references).reshape(references, 2), channels=channels,
                      places=np.zeros((count, 3)))  # fmt: skip


def test_channels_stand_where_their_sensors_do():
    sensors = grid(3, 2, np.array([1, -1, 2]))
    found = _places(sensors, Circle(theta=sensors.theta, orders=(0, 2)))
    np.testing.assert_allclose(found.theta, np.radians([0.0, 120.0, 240.0] * 2))
    assert found.sign.tolist() == [1.0, -1.0, 1.0] * 2
    assert found.reference.tolist() == [1, 1, 1, 0, 0, 0]
    assert found.orders == (0, 2)


def test_sensors_are_trusted_where_most_of_their_references_belong():
    sensors = grid(2, 3)
    nothing = BandFits([], [], [], 0.0, 0.0)
    assert trusted_sensors(nothing, sensors) is None
    belongs = np.array([True, False, True, False, False, True])  # by reference, of sensor 1 and 2
    assert trusted_sensors(nothing._replace(belongs=belongs), sensors).tolist() == [True, False]
    two = np.array([True, True, False, True])  # half of them are not most
    assert trusted_sensors(nothing._replace(belongs=two), grid(2, 2)).tolist() == [False, True]


def test_a_test_with_shifts_or_leakage_says_so():
    said = identification.test_notes(BandFits([], [], [], 0.0123, 0.1))
    assert "which differ by 1.2 % (standard deviation)" in said[0]
    assert said[1].startswith("peaks are widened as by a Hann window")
    assert identification.test_notes(BandFits([], [], [], 0.0, 0.0)) == ()
    assert len(identification.test_notes(BandFits([], [], [], 0.0, 0.1))) == 1


def test_the_largest_n_is_noted_and_sensors_that_tell_none():
    sensors = grid(9, theta=np.radians([10.0, 20, 20, 30, 40, 50, 60, 70, 80]))
    circle = Circle(theta=sensors.theta, orders=(0, 1, 4))
    assert circle_notes([mode(100.0, n=4)], sensors, circle)[0].startswith("n = 4 is the largest looked for, at most")
    assert len(circle_notes([mode(100.0, n=1), mode(110.0, n=4)], sensors, circle)) == 1
    assert circle_notes([mode(100.0, n=1)], sensors, circle) == ()
    assert circle_notes([], sensors, circle) == ()
    assert circle_notes([mode(100.0)], sensors, None) == ()
    blind = Circle(theta=sensors.theta, orders=())
    assert "the 9 sensors stand at 8 angles from 10 to 80 deg" in circle_notes([mode(100.0)], sensors, blind)[0]


def around(turned=(), count=12, doubt=""):
    """Eight modes of pure waves at sensors round a circle, some of which point inwards; some are turned over."""
    sensors = grid(count, directions=np.where(np.arange(count) % 3 == 1, -1, 1))
    sign = np.sign(sensors.directions)
    shapes = [np.cos(n * sensors.theta - 0.7 * k) * sign for k, n in enumerate((2, 2, 3, 3, 4, 4, 1, 1))]
    for shape in shapes:
        shape[list(turned)] *= -1.0
    return [mode(100.0 + k, shape=shape, doubt=doubt) for k, shape in enumerate(shapes)], sensors


def test_sensors_that_are_turned_over_are_named_and_left_out_of_labels():
    modes, sensors = around((4, 7))
    circle = Circle(theta=sensors.theta, orders=(0, 1, 2, 3, 4))
    assert [note.split(" looks")[0] for note in channel_notes(modes, sensors, circle, None)] == ["point 5", "point 8"]
    assert belonging(modes, sensors, circle, None).tolist() == [0, 1, 2, 3, 5, 6, 8, 9, 10, 11]
    assert channel_notes(modes, sensors, None, None) == ()
    assert belonging(modes, sensors, None, None).tolist() == list(range(12))
    unsure = [*around((4, 7), doubt="why")[0]]
    assert channel_notes(unsure, sensors, circle, None) == ()
    assert belonging(unsure, sensors, circle, None).tolist() == list(range(12))
    trusted = np.ones(12, bool)
    trusted[[4, 7, 9]] = False
    assert belonging(modes, sensors, circle, trusted).tolist() == [0, 1, 2, 3, 5, 6, 8, 10, 11]


@pytest.mark.parametrize(("many", "left"), [(6, 6), (7, 12)])
def test_labels_do_without_half_of_the_sensors_at_most(many, left):
    modes, sensors = around()
    circle = Circle(theta=sensors.theta, orders=(0, 1, 2, 3, 4))
    assert len(belonging(modes, sensors, circle, np.arange(12) >= many)) == left


def test_fits_stand_over_their_cores_in_the_units_of_the_responses():
    along = np.linspace(0.4, 1.0, len(LINES))
    along[30] = 0.0
    data = responses(along=along)
    band = Band((20, 75), (10, 75), 2)
    fit = fit_poles(_window(data, band), np.array([98.0, 103.0]), np.array([5e-3, 6e-3]), steps=0)
    whole = _fitted(BandFits([band], [fit], [], 0.0, 0.0), data.H)
    there = [k for k in range(20, 75) if k != 30]
    assert np.isnan(np.delete(whole, there, axis=1)).all()
    for k in there:
        want = data.H[:, k] - fit.spread[k - 10] * NOISE / along[k]
        np.testing.assert_allclose(whole[:, k], want, rtol=1e-12)


def test_columns_of_modes():
    sensors = grid(2, 2)
    none = np.zeros((2, 2))
    modes = [mode(100.0, n=0, residues=none), mode(101.0, angle=0.5, shape=np.array([0.6, 0.8]), residues=none),
             mode(102.0, residues=none), mode(103.0, sigma_angle=0.02, residues=none)]  # fmt: skip
    found = _columns(modes, ((1, 2),), sensors)
    assert found["freq"].tolist() == [100.0, 101.0, 102.0, 103.0]
    np.testing.assert_array_equal(found["split_bound"], [np.nan, np.nan, np.nan, 0.1])
    assert found["angle_deg"][1] == pytest.approx(np.degrees(0.5))
    assert found["sigma_angle"][3] == pytest.approx(np.degrees(0.02))
    assert found["shapes"][:, 1].tolist() == [0.6, 0.8]
    assert found["sigma_shapes"].shape == (2, 4)
    assert found["n"].tolist() == [0, 3, 3, 3]
    none = _columns([], (), sensors)
    assert (none["shapes"].shape, none["residues"].shape, none["split_bound"].shape) == ((2, 0), (2, 2, 0), (0,))


def test_residues_of_modes_stand_by_sensor_and_reference():
    one = np.array([[1.0, 2.0], [3.0, 4.0]])
    found = _columns([mode(100.0, residues=one), mode(101.0, residues=10j * one)], (), grid(2, 2))
    assert found["residues"][1, 0].tolist() == [3.0, 30j]
    assert found["residues"].shape == (2, 2, 2)


class Steps:
    """An identification whose bands, modes and sensors that belong are given; what each step was asked for."""

    def __init__(self, monkeypatch, belong=None):
        self.asked, self.looked, rows = [], [], np.arange(5) if belong is None else np.array(belong)
        band = Band((20, 75), (10, 75), 2)

        def fitted(data, bands, *options):
            self.asked.append((data, bands, *options))
            fit = fit_poles(_window(data, band), np.array([98.0, 103.0]), np.array([5e-3, 6e-3]), steps=0)
            return BandFits([band], [fit], ["diagram"], 0.02, 0.1)

        def looked(fits, cores, sensors, signs, circle, keep, *some):
            self.looked.append((cores, signs.tolist(), circle, keep, *some))
            no = np.zeros((5, 1))
            shape = np.ones(5) / np.sqrt(5.0)
            found = [mode(98.0, n=2, shape=shape, sigma_shape=shape, residues=no, doubt=doubt) for doubt in ("", "why")]
            return [*found, mode(103.0, n=-1, shape=shape, sigma_shape=shape, residues=no, unresolved=True)], ("left",)

        for name, fake in (("fit_bands", fitted), ("found_modes", looked), ("join", lambda *parts: parts),
                           ("belonging", lambda *_: rows), ("suspected", lambda *_: ("suspect",))):  # fmt: skip
            monkeypatch.setattr(identification, name, fake)

    def run(self, **options):
        rng = np.random.default_rng(2)
        H = rng.standard_normal((5, len(LINES))) + 1j * rng.standard_normal((5, len(LINES)))
        H[3] = 3.0 - 4.0j
        places = {"response_point": range(1, 6), "response_direction": [1, -1, 1, 1, -1], "card": ("about",)}
        frfs = FrfSet.from_arrays(kind="frf", x=LINES, responses=H, unit="", **places)
        return H, identification.identify(frfs, **options)


ROUND = {k + 1: angle for k, angle in enumerate((0.0, 60.0, 130.0, 200.0, 290.0))}


def test_an_identification_hands_on_what_its_options_say(monkeypatch):
    steps, said = Steps(monkeypatch), []
    H, found = steps.run(angles=ROUND, n_max=1, order=9, say=said.append, band=(91.0, 110.0))
    ((data, _, order, picked, say, each),) = steps.asked
    assert (order, picked, each) == (9, None, map)
    say("here")
    assert said == ["here"]
    np.testing.assert_array_equal(data.freq, LINES[4:81])
    np.testing.assert_array_equal(data.H, H[:, 4:81])
    assert data.power == 2
    np.testing.assert_allclose(np.delete(data.noise, 3), line_noise(np.delete(H[:, 4:81], 3, 0)), rtol=1e-12)
    assert data.noise[3] == pytest.approx(5e-9, rel=1e-12)  # a billionth of its rms
    assert data.places.orders == (0, 1)
    ((cores, signs, circle, keep),) = steps.looked
    assert (cores, signs, keep) == ([(96.0, 109.75)], [1.0, -1.0, 1.0, 1.0, -1.0], False)
    assert circle.orders == (0, 1)
    assert found.diagram == (["diagram"], cores)
    assert (found.unresolved, found.doubts, found.shift, found.card) == ((2,), ("", "why", ""), 0.02, ("about",))
    assert 0.0 < found.seconds < 100.0
    beginnings = ("the responses have no unit", "peaks lie at", "peaks are widened", "suspect", "n = 2 at", "n = 2 at",
                  "pair at", "left")  # fmt: skip
    assert len(found.notes) == len(beginnings)
    assert all(note.startswith(start) for note, start in zip(found.notes, beginnings, strict=True))


def test_sensors_that_do_not_belong_are_left_out_of_the_circle(monkeypatch):
    steps = Steps(monkeypatch, [0, 2, 4])
    steps.run(angles=ROUND)
    _, (_, _, circle, keep, belong) = steps.looked
    assert (circle.orders, keep, belong.tolist()) == (steps.looked[0][2].orders, False, [0, 2, 4])
    np.testing.assert_allclose(np.degrees(circle.theta), [0.0, 130.0, 290.0])


def test_picked_frequencies_keep_all_modes_and_no_angles_make_no_circle(monkeypatch):
    steps = Steps(monkeypatch)
    _, found = steps.run(pick=[103.0, 98.0], exponential=2.0)
    ((data, bands, order, picked, *_),) = steps.asked
    assert (data.places, order, picked.tolist()) == (None, None, [98.0, 103.0])
    assert sum(band.peaks for band in bands) == 2
    assert steps.looked == [(steps.looked[0][0], [1.0, -1.0, 1.0, 1.0, -1.0], None, True)]
    assert found.notes[0].startswith("damping is without the 1/(tau omega) of an exponential window, tau = 2 s")
    np.testing.assert_allclose(found.zeta, 0.01 - 0.5 / (2.0 * np.pi * found.freq), rtol=1e-5)
