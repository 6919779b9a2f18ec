"""Random fields: the spectrum is met, draws do not depend on each other, same seed same bits."""

import numpy as np
import pytest

import casingfem as cf

CASING = {"thickness": 3e-3, "radius": 0.475}


@pytest.mark.slow
def test_phases_are_uniform():
    field = cf.field.RandomField.example(**CASING, seed=5)
    waves = [complex(*field.redrawn(k).fit.coefficients(3)) for k in range(800)]
    turned = np.array([w / abs(w) for w in waves])
    for k in (1, 2, 3):  # the mean of 800 unit vectors of random angle is .035 long
        assert abs(np.mean(turned**k)) < 0.1


def test_same_seed_same_bits_whatever_came_before():
    one = cf.field.RandomField.example(**CASING, seed=7)
    later = cf.field.RandomField.example(**CASING, seed=7).redrawn(12).redrawn(3)
    assert one.redrawn(3).fit.cos.tobytes() == later.fit.cos.tobytes()
    others = [
        one,
        one.redrawn(1),
        cf.field.RandomField.example(**CASING, seed=8),
        cf.field.RandomField.example(**CASING, seed=7, stream=1),
    ]
    assert len({other.fit.cos.tobytes() for other in others}) == 4


def test_more_harmonics_leave_the_first_ones_alone():
    short, long = (cf.field.RandomField.example(**CASING, seed=7, p_max=p) for p in (12, 30))
    np.testing.assert_array_equal(long.fit.sin[:11], short.fit.sin)
    assert (short.max_harmonic, long.max_harmonic) == (12, 30)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"p": [2, 2]}, r"ascend from 1 or more, found \[2, 2\]"),
        ({"p": [0, 1]}, "ascend from 1"),
        ({"median": [0.1]}, "three lists of"),
        ({"median": [0.1, 0.0]}, "0 < median <= high"),
        ({"high": [0.2, 0.05]}, "0 < median <= high"),
        ({"high": [0.2, np.inf]}, "0 < median <= high < inf"),
    ],
)
def test_a_spectrum_that_is_none_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        cf.field.Spectrum(**({"p": [2, 3], "median": [0.1, 0.1], "high": [0.2, 0.2]} | arguments))


def test_a_negative_seed_is_refused():
    with pytest.raises(ValueError, match="found seed -1"):
        cf.field.RandomField.example(**CASING, seed=-1)
