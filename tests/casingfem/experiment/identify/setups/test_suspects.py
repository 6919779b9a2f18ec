"""Which sensors are suspected, both sides of each limit, and what most sensors say of each."""

import numpy as np
import pytest

from casingfem.experiment.identify.setups.around import _words, most_say, suspect_sensors, suspected

POINTS = np.array([11, 12, 13, 14])


def said(along=None, size=None):
    """Of four sensors, by their correlation with what is said of each place; nothing is wrong without changes."""
    matrix, sizes = np.eye(4), np.ones(4)
    for (row, column), value in (along or {}).items():
        matrix[row, column] = value
    for k, value in (size or {}).items():
        sizes[k] = value
    return list(_words(matrix, sizes, POINTS, 6))


@pytest.mark.parametrize(
    ("own", "words"),
    [
        (-0.61, "point 13 looks turned over: in 6 modes it moves against what the others say"),
        (-0.59, "point 13 does not move as the others say, in 6 modes: dead, loose, or not at its angle?"),
        (0.39, "point 13 does not move as the others say, in 6 modes: dead, loose, or not at its angle?"),
        (0.41, None),
    ],
)
def test_a_sensor_that_opposes_or_is_silent_is_named(own, words):
    assert said({(2, 2): own}) == ([((2,), words)] if words else [])


@pytest.mark.parametrize(("size", "words"), [(2.01, "2"), (1.99, None), (0.51, None), (0.49, "0.49"), (0.05, "0.05")])
def test_a_sensor_of_another_size_is_named(size, words):
    """Twice what the others say, or half of it."""
    want = f"point 12 moves {words} times as much as the others say, in 6 modes: its sensitivity or unit?"
    assert said(size={1: size}) == ([((1,), want)] if words else [])


EXCHANGED = {(1, 1): 0.5, (3, 3): 0.55, (1, 3): 0.7, (3, 1): 0.75}


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({}, True),
        ({(1, 3): 0.601}, True),
        ({(1, 3): 0.599}, False),
        ({(3, 1): 0.599, (3, 3): 0.45}, False),
        ({(1, 1): 0.599}, True),
        ({(1, 1): 0.601}, False),  # not better by a tenth than in its own place
        ({(3, 3): 0.649}, True),
        ({(3, 3): 0.651}, False),
        ({(1, 1): 0.89, (1, 3): 1.0}, True),
        ({(1, 1): 0.901, (1, 3): 1.1}, False),
        ({(3, 3): 0.89, (3, 1): 1.0}, True),
        ({(3, 3): 0.901, (3, 1): 1.1}, False),
    ],
)
def test_two_sensors_that_move_as_each_other_should_are_exchanged(changes, named):
    words = "points 12 and 14 look exchanged: in 6 modes each moves as the other should"
    assert said(EXCHANGED | changes) == ([((1, 3), words)] if named else [])


def test_a_sensor_is_exchanged_with_one_other_and_then_nothing_else_is_said_of_it():
    third = {(0, 1): 0.9, (1, 0): 0.9, (0, 0): -0.9}
    assert [sensors for sensors, _ in said(EXCHANGED | third)] == [(0, 1)]
    assert [sensors for sensors, _ in said({**EXCHANGED, (1, 1): -0.9, (0, 0): -0.9})] == [(1, 3), (0,)]


THETA = np.radians([0.0, 35.0, 85.0, 120.0, 170.0, 215.0, 250.0, 290.0, 330.0])


def waves(orders, count=9):
    turns = 0.7 * np.arange(len(orders))
    return np.cos(THETA[:count, None] * np.array(orders) - turns) * np.linspace(0.5, 3.0, len(orders))


def test_most_sensors_say_what_a_wave_is_though_one_is_off():
    pure = waves([2, 2, 1, 3, 0])
    off = pure.copy()
    off[4] *= -3.0
    said_of, misfit = most_say(off, 3, THETA)
    np.testing.assert_allclose(said_of, pure, atol=0.01)
    heard = np.abs(off - said_of).sum(axis=0) / np.abs(off).sum(axis=0)
    np.testing.assert_allclose(misfit, heard, rtol=1e-12)
    assert np.median(misfit) > 0.3
    clean = most_say(pure, 3, THETA)
    np.testing.assert_allclose(clean[0], pure, atol=1e-6)
    assert clean[1].max() < 1e-6
    assert most_say(pure, 2, THETA)[1][3] > 0.1  # n = 3 is more than is asked for
    assert most_say(pure, 2, THETA)[1][4] < 1e-6


def test_those_that_are_trusted_say_alone():
    pure = waves([2, 2, 1])
    off = pure.copy()
    off[[0, 3, 5, 8]] = [[4.0], [-3.0], [5.0], [2.0]]
    trusted = ~np.isin(np.arange(9), [0, 3, 5, 8])
    said_of, misfit = most_say(off, 2, THETA, trusted)
    np.testing.assert_allclose(said_of, pure, atol=1e-5)
    assert misfit.max() < 1e-5


def test_eight_sensors_and_five_modes_tell_something():
    turned = waves([2, 2, 1, 3, 1])
    turned[2] *= -1.0
    assert suspect_sensors(turned, 3, THETA, np.arange(9)).tolist() == [2]
    assert suspect_sensors(turned[:8], 3, THETA[:8], np.arange(8)).tolist() == [2]
    assert suspect_sensors(turned[:7], 3, THETA[:7], np.arange(7)).tolist() == []
    assert suspect_sensors(turned[:, :4], 3, THETA, np.arange(9)).tolist() == []


def test_modes_that_fit_no_wave_tell_nothing():
    """Beyond 1.2 of the median misfit: three of nine, in which a sensor is turned over."""
    rng = np.random.default_rng(3)
    shapes = waves([2, 2, 1, 3, 1, 2, 1, 3, 2])
    shapes = shapes + 0.05 * rng.standard_normal(shapes.shape)
    shapes[:, 6:] = rng.standard_normal((9, 3))
    assert suspected(shapes, 3, THETA, np.arange(9)) == ()
    shapes[3, :6] *= -1.0
    (words,) = suspected(shapes, 3, THETA, np.arange(9))
    assert words.startswith("point 3 looks turned over: in ")
    assert int(words.split(" in ")[1].split()[0]) < 9
