"""Random fields: the spectrum is met, draws do not depend on each other, same seed same bits."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.field.random import EXAMPLE, EXAMPLE_HIGH, is_random, redrawn

CASING = {"thickness": 3e-3, "radius": 0.475}


@pytest.mark.slow
def test_draws_have_the_published_median_and_90th_percentile():
    """2,500 draws: the median of a lognormal of s = .97 scatters by 1.25 s/sqrt(2500) = 2.4 %."""
    field = cf.field.RandomField.example(**CASING, seed=71, p_max=12)
    series = [field.redrawn(k).fit for k in range(2500)]
    draws = np.array([np.hypot(fit.cos, fit.sin)[np.array([*EXAMPLE]) - 2, 0] for fit in series]) * 0.475 / 3e-3
    np.testing.assert_allclose(np.median(draws, axis=0), list(EXAMPLE.values()), rtol=0.06)
    columns = [list(EXAMPLE).index(p) for p in EXAMPLE_HIGH]
    np.testing.assert_allclose(np.quantile(draws[:, columns], 0.9, axis=0), list(EXAMPLE_HIGH.values()), rtol=0.08)


@pytest.mark.slow
def test_phases_are_uniform():
    field = cf.field.RandomField.example(**CASING, seed=5)
    waves = [complex(*field.redrawn(k).fit.coefficients(3)) for k in range(800)]
    turned = np.array([w / abs(w) for w in waves])
    for k in (1, 2, 3):  # the mean of 800 unit vectors of random angle is .035 long
        assert abs(np.mean(turned**k)) < 0.1


def test_the_spectrum_is_met_where_given_and_goes_on_as_it_ended():
    spectrum = cf.field.Spectrum.between(EXAMPLE, EXAMPLE_HIGH, p_max=24)
    at = dict(zip(spectrum.p.tolist(), zip(spectrum.median, spectrum.high, strict=True), strict=True))
    for p, median in EXAMPLE.items():
        assert at[p][0] == pytest.approx(median, rel=1e-12)
    for p, high in EXAMPLE_HIGH.items():
        assert at[p][1] == pytest.approx(high, rel=1e-12)
    assert at[9][0] == pytest.approx(np.exp(np.interp(np.log(9), np.log([8, 10]), np.log([0.057, 0.031]))))
    assert at[24][0] / at[12][0] == pytest.approx((0.019 / 0.031) ** (np.log(2) / np.log(1.2)), rel=1e-12)
    assert at[24][1] / at[24][0] == pytest.approx(0.19 / 0.057, rel=1e-12)


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


def test_only_the_random_part_of_a_sum_is_drawn_anew():
    random, given = cf.field.RandomField.example(**CASING, seed=3), cf.FourierField.of({4: 0.001})
    for total in (given + random, random + given):
        assert isinstance(total, cf.field.SumField)
        assert is_random(total)
        new = redrawn(total, 5)
        expected = given.derivatives(0.0, 0.3).value + random.redrawn(5).derivatives(0.0, 0.3).value
        assert new.derivatives(0.0, 0.3).value == pytest.approx(expected, rel=1e-14)
    assert redrawn(given, 5) is given
    assert not is_random(given)
    assert isinstance(random, cf.field.Field)
    assert "seed 3, draw 0" in repr(random)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"p": [2, 2]}, r"ascend from 1 or more, found \[2, 2\]"),
        ({"p": [0, 1]}, "ascend from 1"),
        ({"median": [0.1]}, "must be lists alike"),
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
