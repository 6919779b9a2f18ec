"""Surveys of parts that stood beside the axis they were turned about, or leaned."""

import warnings

import numpy as np
import pytest

import casingfem as cf
from casingfem.errors import InputError, ModelWarning

MIDDLE, LEAN = 2e-3 + 1e-3j, 1e-3j  # m and m/m, the latter about mid height
Z = np.array([0.02, 0.12, 0.22])


def turned_about(middle, lean, noise=0.0):
    """Points of r = 0.5 + 0.3 mm cos 2 theta + 0.1 mm sin 8 theta, seen from an axis beside its own."""
    angle, z = np.tile(np.radians(np.arange(0.0, 360.0, 4.0)), 3), np.repeat(Z, 90)
    radius = 0.5 + 3e-4 * np.cos(2.0 * angle) + 1e-4 * np.sin(8.0 * angle)
    place = radius * np.exp(1j * angle) + middle + lean * (z - 0.12)
    found = np.abs(place) + noise * np.random.default_rng(3).normal(size=z.size)
    return np.angle(place), z, found


@pytest.mark.parametrize("lean", [0.0, LEAN])
def test_the_shape_about_its_own_axis_comes_back(lean):
    survey = cf.SurveyField.from_points(*turned_about(MIDDLE, lean), n_max=12, degree=1, centred=True)
    assert abs(survey.axis.offset - MIDDLE) < 1e-9
    assert abs(survey.axis.tilt - lean) < 2e-8
    assert survey.mean[0] == pytest.approx(0.5, rel=1e-8)
    found = {p: survey.fit.coefficients(p) for p in survey.fit.harmonics}
    expected = {2: (6e-4, 0.0), 8: (0.0, 2e-4)}
    for p, pair in found.items():
        assert pair == pytest.approx(expected.get(p, (0.0, 0.0)), abs=2e-9), p
    assert "2.24 mm off the axis towards 27 deg at z = 0.12 m" in repr(survey)


def test_noise_and_a_stray_point_leave_the_axis_where_it_is():
    theta, z, radius = turned_about(MIDDLE, LEAN, noise=8e-6)
    radius[40] += 4e-3
    with pytest.warns(ModelWarning, match="survey-outliers"):
        survey = cf.SurveyField.from_points(theta, z, radius, n_max=12, degree=1, robust=True, centred=True)
    assert abs(survey.axis.offset - MIDDLE) < 3e-6  # 8 um over the root of 270 points, twice, five times over
    assert survey.fit.amplitude(2) == pytest.approx(6e-4, abs=6e-6)


def test_a_plain_fit_says_that_the_part_stood_beside_the_axis(tmp_path):
    theta, z, radius = turned_about(MIDDLE, 0.0)
    with pytest.warns(ModelWarning, match=r"survey: the part stood 2.24 mm off the axis towards 27 deg"):
        cf.SurveyField.from_points(theta, z, radius, n_max=12, degree=1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a run-out below the shape is none of this
        cf.SurveyField.from_points(*turned_about(1e-4, 0.0), n_max=12, degree=1)
    path = tmp_path / "survey.csv"
    rows = "".join(f"{t},{h},{r}\n" for t, h, r in zip(theta, z, radius, strict=True))
    path.write_text("theta_rad,z_m,radius_m\n" + rows)
    assert abs(cf.SurveyField.from_csv(path, 12, 1, centred=True).axis.offset - MIDDLE) < 1e-9


def test_one_ring_has_an_offset_and_no_lean():
    theta, z, radius = turned_about(MIDDLE, 0.0)
    ring = cf.SurveyField.from_points(theta[:90], z[:90], radius[:90], n_max=12, centred=True)
    assert ring.axis.tilt == 0.0
    assert abs(ring.axis.offset - MIDDLE) < 1e-9


def test_a_thickness_has_no_axis():
    theta, z, _ = turned_about(0.0, 0.0)
    with pytest.raises(InputError, match="a wall has no axis"):
        cf.SurveyField.from_points(theta, z, 0.0 * z + 3e-3, quantity="thickness", n_max=4, centred=True)
