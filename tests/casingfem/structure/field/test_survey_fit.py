"""What fit a survey's points are given, about which axis, and what is said of it."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.field.survey.axis import Axis, axis_of, eccentric, refuse_outside, rough_axis
from casingfem.structure.field.survey.fit import _Problem, fit_points, resolved_harmonic
from casingfem.structure.field.survey.points import SurveyPoints
from casingfem.structure.field.survey.survey import largest_change, stray_words


def measured(theta, z, value, **changes):
    theta, z, value = (np.array(part, float) for part in np.broadcast_arrays(theta, z, value))
    return SurveyPoints(theta=theta.ravel(), z=z.ravel(), value=value.ravel(), **changes)


def rings(heights, points=36, value=0.5, **changes):
    theta = 2.0 * np.pi * np.arange(points) / points
    return measured(theta, np.array(heights)[:, None], value, **changes)


@pytest.mark.parametrize(("gap", "highest"), [(5.0, 35), (180.0, 0), (179.0, 1), (90.0, 1), (60.0, 2), (360.0, 0)])
def test_more_than_two_points_a_wave(gap, highest):
    assert resolved_harmonic(gap) == highest


@pytest.mark.parametrize(
    ("heights", "points", "harmonics", "degree"),
    [
        ([0.0], 36, 13, 0),  # 0.8 * 18 = 14.4, but 29 unknowns are more than 0.8 * 36
        ([0.0, 0.1], 36, 14, 0),  # 58 unknowns are more than 0.8 * 72
        ([0.0, 0.1, 0.2], 36, 14, 1),
        ([0.0, 0.1, 0.2, 0.3], 36, 14, 2),
        ([0.0], 200, 40, 0),  # 80 of which 40 are taken
        ([0.0, 0.1, 0.2], 4, 1, 1),
        ([0.0, 0.1], 4, 1, 1),
    ],
)
def test_the_fit_that_points_are_given(heights, points, harmonics, degree):
    fit = fit_points(rings(heights, points), None, None, search=False)
    assert (fit.field.max_harmonic, fit.field.cos.shape[1] - 1) == (harmonics, degree)


def test_one_height_is_its_own_place_along():
    fit = fit_points(rings([0.3]), 4, None)
    assert (fit.field.z_mid, fit.field.z_half, fit.mean[1], fit.gap_deg) == (0.3, 1.0, 0.0, pytest.approx(10.0))
    with pytest.raises(cf.errors.InputError, match=r"expected at most 9 deg for n_max = 20 .*resolve harmonic 17"):
        fit_points(rings([0.3]), 20, None)


@pytest.mark.parametrize(
    ("n_max", "degree", "words"), [(0, 0, "n_max must be a whole number >= 1"), (1, -1, "degree must")]
)
def test_one_harmonic_and_degree_zero_are_the_least(n_max, degree, words):
    assert fit_points(rings([0.3]), 1, 0).field.cos.shape == (1, 1)
    with pytest.raises(ValueError, match=words):
        fit_points(rings([0.3]), n_max, degree)


def test_too_many_numbers_are_refused_before_they_are_laid_out(monkeypatch):
    """36 points for 9 unknowns are 324."""
    monkeypatch.setattr("casingfem.structure.field.survey.fit._MOST_NUMBERS", 324)
    fit_points(rings([0.0]), 4, 0)
    monkeypatch.setattr("casingfem.structure.field.survey.fit._MOST_NUMBERS", 323)
    words = "found 36 points for 9 unknowns; expected 36 at most: keep one line in 2"
    with pytest.raises(cf.errors.InputError, match=words):
        fit_points(rings([0.0]), 4, 0)


def test_as_many_unknowns_as_points_are_a_fit_only_when_asked_for():
    points = measured(2.0 * np.pi * np.arange(9) / 9, 0.0, 0.5)
    problem = _Problem(points, 1, 4, 0)
    assert problem.determined(margin=False)
    assert not problem.determined(margin=True)
    assert not _Problem(points, 1, 5, 0).determined(margin=False)
    assert _Problem(points, 1, 5, 0).weakness() == "9 points for 11 unknowns"
    same = measured(np.tile([0.0, 1.0, 2.5], 4), 0.0, 0.5)
    assert not _Problem(same, 1, 2, 0).determined(margin=False)
    assert _Problem(same, 1, 2, 0).weakness() == "12 points so placed that they do not tell 5 unknowns apart"


@pytest.mark.parametrize(("turned", "enough"), [(0.0033, False), (0.0034, True)])
def test_noise_may_be_amplified_a_hundredfold(turned, enough):
    """Twelve angles twice, the second time turned a little: sin(6 theta) is seen by the turn alone."""
    at = np.tile(2.0 * np.pi * np.arange(12) / 12, 2) + np.repeat([0.0, turned], 12)
    angle = at[:, None] * np.arange(1, 7)
    values = np.linalg.svd(np.column_stack([np.ones(24), np.cos(angle), np.sin(angle)]))[1]
    assert bool(values[0] / values[-1] < 100.0) is enough
    assert _Problem(measured(at, 0.0, 1.0), 1, 6, 0).determined(margin=False) is enough


def test_a_cone_and_its_defect_come_back_where_z_begins_elsewhere():
    """r = (0.5 - 0.2 z)(1 + f) between z = 0.3 and 0.7, f linear along."""
    points = rings([0.3, 0.4, 0.7], 24)
    zeta = (points.z - 0.5) / 0.2
    f = (0.01 + 0.003 * zeta) * np.cos(2 * points.theta) + (0.002 - 0.004 * zeta) * np.sin(5 * points.theta)
    points = measured(points.theta, points.z, (0.5 - 0.2 * points.z) * (1.0 + f))
    fit = fit_points(points, 6, 1)
    assert fit.mean == pytest.approx((0.5, -0.2), rel=1e-11)
    assert (fit.field.z_mid, fit.field.z_half, fit.heights) == (pytest.approx(0.5), pytest.approx(0.2), 3)
    np.testing.assert_allclose(fit.field.cos[1], [0.01, 0.003], rtol=1e-10)
    np.testing.assert_allclose(fit.field.sin[4], [0.002, -0.004], rtol=1e-10)
    assert np.abs(fit.residual).max() < 1e-13


def test_a_thickness_has_one_mean_and_a_taper_in_its_field():
    """t = 3 mm (1 + 0.1 zeta + 0.05 cos 2 theta) between z = 0.3 and 0.7."""
    points = rings([0.3, 0.4, 0.7], 24)
    zeta = (points.z - 0.5) / 0.2
    value = 3e-3 * (1.0 + 0.1 * zeta + 0.05 * np.cos(2 * points.theta))
    fit = fit_points(measured(points.theta, points.z, value, quantity="thickness"), 4, 1)
    assert fit.mean == (pytest.approx(3e-3, rel=1e-12), 0.0)
    assert fit.field.harmonics == (0, 1, 2, 3, 4)
    np.testing.assert_allclose(fit.field.cos[[0, 2]], [[0.0, 0.1], [0.05, 0.0]], atol=1e-14)


def test_a_residual_is_relative_to_the_cone():
    points = rings([0.0, 0.2], 24)
    noise = 1e-4 * np.random.default_rng(0).normal(size=48)
    value = (0.5 - 0.5 * points.z) * (1.0 + noise)
    fit = fit_points(measured(points.theta, points.z, value), 2, 0)
    design = np.column_stack([np.ones(48), points.z])
    waves = np.column_stack([f(p * points.theta) for f in (np.cos, np.sin) for p in (1, 2)])
    cone = fit.mean[0] + fit.mean[1] * points.z
    whole = np.hstack([design, cone[:, None] * waves])
    exact = (value - whole @ np.linalg.lstsq(whole, value, rcond=None)[0]) / cone
    np.testing.assert_allclose(fit.residual, exact, atol=1e-13)


def test_axes_add_up_and_are_told():
    axis = Axis(3e-3 - 4e-3j, 2e-3j, 0.1) + Axis(1e-3j, 1e-3, 0.7)
    assert (axis.offset, axis.tilt, axis.z_mid) == (pytest.approx(3e-3 - 3e-3j), pytest.approx(1e-3 + 2e-3j), 0.1)
    assert str(axis) == "4.24 mm off the axis towards 315 deg at z = 0.1 m, leaning by 2.24 mm/m"


def leaning(offset, tilt, heights=(0.1, 0.2, 0.4), radius=0.5):
    """Circles about a leaning axis through the middle of their heights."""
    phi = np.radians(np.arange(0.0, 360.0, 10.0))
    z = np.array(heights)[:, None] + 0.0 * phi
    place = offset + tilt * (z - 0.5 * (min(heights) + max(heights))) + radius * np.exp(1j * phi)
    return measured(np.angle(place), z, np.abs(place))


def test_circles_about_a_leaning_axis_give_it_back_at_once():
    found = rough_axis(leaning(0.02 - 0.03j, 0.05 + 0.01j))
    assert (found.offset, found.tilt) == (
        pytest.approx(0.02 - 0.03j, rel=1e-11),
        pytest.approx(0.05 + 0.01j, rel=1e-11),
    )
    assert found.z_mid == pytest.approx(0.25)
    one = rough_axis(leaning(0.02 - 0.03j, 0.0, heights=(0.3,)))
    assert (one.offset, one.tilt, one.z_mid) == (pytest.approx(0.02 - 0.03j, rel=1e-11), 0.0, pytest.approx(0.3))
    about = found.seen_from(leaning(0.02 - 0.03j, 0.05 + 0.01j))
    np.testing.assert_allclose(about.value, 0.5, rtol=1e-12)


def test_the_axis_of_a_fit_is_its_first_harmonic_in_metres():
    points = leaning(2e-6 - 3e-6j, 1e-5 + 4e-5j)
    found = axis_of(fit_points(points, 3, 1), points.z)
    assert found.offset == pytest.approx(2e-6 - 3e-6j, rel=1e-4)
    assert found.tilt == pytest.approx(1e-5 + 4e-5j, rel=1e-4)


@pytest.mark.parametrize(("offset", "refused"), [(0.249, False), (0.251, True)])
def test_a_part_beside_half_its_radius_is_not_about_the_axis(offset, refused):
    points = leaning(offset * np.exp(1j), 0.0)
    if refused:
        with pytest.raises(
            cf.errors.InputError, match=r"points whose middle lies 251 mm off the axis towards 57 deg.*being 0.5 m"
        ):
            refuse_outside(points)
    else:
        refuse_outside(points)


@pytest.mark.parametrize(("part", "told"), [(0.95, False), (1.05, True)])
def test_a_part_is_beside_its_axis_where_that_is_more_than_it_is_out_of_round(part, told):
    """Waves of 3 and 4 thousandths are 5 together; or noise of 1e-4, of which three times count."""
    points = rings([0.0], 36)
    for shape, level in (
        (3e-3 * np.cos(2 * points.theta) + 4e-3 * np.sin(3 * points.theta), 5e-3),
        (1e-4 * np.where(np.arange(36) % 2, 1.0, -1.0), 3e-4),
        (0.0 * points.theta, 1e-5),
    ):
        value = 0.5 * (1.0 + shape + part * level * np.cos(points.theta - 2.0))
        given = measured(points.theta, points.z, value)
        axis = eccentric(fit_points(given, 4, 0), given)
        assert (axis is not None) is told
        wall = measured(points.theta, points.z, value, quantity="thickness")
        assert eccentric(fit_points(wall, 4, 0), wall) is None


def test_the_reach_of_a_lean_counts():
    points = leaning(0.0, 0.01)  # 1.5 mm at either end
    wavy = measured(points.theta, points.z, points.value + 1.4e-3 * np.cos(3 * points.theta))
    assert eccentric(fit_points(wavy, 4, 1), wavy) is not None
    wavy = measured(points.theta, points.z, points.value + 1.6e-3 * np.cos(3 * points.theta))
    assert eccentric(fit_points(wavy, 4, 1), wavy) is None


def test_what_is_said_of_stray_points():
    stray = [(10.0 * k, 0.1, (-1.0) ** k * 1e-3 * k) for k in range(1, 8)]
    said = stray_words(stray, 90)
    assert said.startswith(
        "7 of 90 points set aside (theta 70 deg, z 0.1 m: -7.00e-03; theta 60 deg, z 0.1 m: +6.00e-03; "
    )
    assert said.endswith("theta 30 deg, z 0.1 m: -3.00e-03; and 2 more)")
    assert stray_words(stray[:5], 90, "off").count("theta") == 5
    assert "more" not in stray_words(stray[:5], 90)
    plain, without = cf.FourierField.of({2: 0.3, 5: 0.1}), cf.FourierField.of({2: 0.29, 5: 0.2})
    assert largest_change(plain, without) == "harmonic 5 is 0.1 with them, 0.2 without"


def test_a_survey_keeps_its_mean_and_residual():
    points = rings([0.1, 0.3], 24)
    noise = 1e-4 * np.random.default_rng(2).normal(size=48)
    survey = cf.SurveyField.from_points(
        points.theta, points.z, (0.5 - 0.4 * points.z) * (1.0 + noise), n_max=3, degree=0
    )
    fit = fit_points(measured(points.theta, points.z, (0.5 - 0.4 * points.z) * (1.0 + noise)), 3, 0)
    assert survey.residual_rms == pytest.approx(np.sqrt(np.mean(fit.residual**2)), rel=1e-12)
    assert survey.residual_max == pytest.approx(np.abs(fit.residual).max(), rel=1e-12)
    assert survey.residual_rms_m == pytest.approx(survey.residual_rms * (fit.mean[0] + 0.2 * fit.mean[1]), rel=1e-12)
    assert survey.mean_radius(0.2) == pytest.approx(fit.mean[0] + 0.2 * fit.mean[1], rel=1e-14)
    with pytest.raises(ValueError, match="a radius survey has no mean thickness"):
        _ = survey.mean_thickness
    wall = cf.SurveyField.from_points(points.theta, points.z, 3e-3 + 0 * noise, quantity="thickness", n_max=3)
    assert wall.mean_thickness == pytest.approx(3e-3, rel=1e-14)
    with pytest.raises(ValueError, match="a thickness survey has no mean radius"):
        wall.mean_radius(0.0)


def test_a_stray_point_is_told_where_the_others_are_enough_without_a_margin():
    points = rings([0.3], 36)
    value = points.value.copy()
    value[5] += 2e-3
    fit = fit_points(rings([0.3], 36, value), 14, 0)  # 29 unknowns: more than 0.8 of the 35 other points
    assert np.flatnonzero(fit.stray).tolist() == [5]
