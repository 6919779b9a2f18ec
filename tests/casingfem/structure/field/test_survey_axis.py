"""Surveys of parts that were beside the axis they were turned about, or leaned."""

import warnings

import numpy as np
import pytest

import casingfem as cf

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
    words = f", leaning by {1e3 * abs(lean):.3g} mm/m" if lean else ""
    assert f"2.24 mm off the axis towards 27 deg at z = 0.12 m{words}" in repr(survey)


def test_noise_and_a_stray_point_leave_the_axis_where_it_is():
    theta, z, radius = turned_about(MIDDLE, LEAN, noise=8e-6)
    radius[40] += 4e-3
    with pytest.warns(cf.errors.ModelWarning, match="survey-outliers"):
        survey = cf.SurveyField.from_points(theta, z, radius, n_max=12, degree=1, robust=True, centred=True)
    assert abs(survey.axis.offset - MIDDLE) < 3e-6  # 8 um over the root of 270 points, twice, five times over
    assert survey.fit.amplitude(2) == pytest.approx(6e-4, abs=6e-6)


def test_a_plain_fit_states_that_the_part_was_beside_the_axis(tmp_path):
    theta, z, radius = turned_about(MIDDLE, 0.0)
    with pytest.warns(cf.errors.ModelWarning, match=r"survey: found a part 2.24 mm off the axis towards 27 deg"):
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
    with pytest.raises(cf.errors.InputError, match="which has no axis"):
        cf.SurveyField.from_points(theta, z, 0.0 * z + 3e-3, quantity="thickness", n_max=4, centred=True)


def measured_by_machine(path, place, z, unit="mm", scale=1e3):
    cells = zip(scale * place.real, scale * place.imag, scale * z, strict=True)
    rows = [f"P{k},{x:.9g},{y:.9g},{h:.9g},0.01" for k, (x, y, h) in enumerate(cells)]
    path.write_text(f"# SYNTHETIC\npoint,x_{unit},y_{unit},z_{unit},deviation\n" + "\n".join(rows) + "\n")
    return path


@pytest.mark.parametrize(("unit", "scale"), [("mm", 1e3), ("m", 1.0)])
def test_points_in_x_y_z_are_those_in_theta_z_radius(tmp_path, unit, scale):
    theta, z, radius = turned_about(0.0, 0.0)
    path = measured_by_machine(tmp_path / "machine.csv", radius * np.exp(1j * theta), z, unit, scale)
    with pytest.warns(
        cf.errors.ModelWarning,
        match=r"machine.csv: found columns that are not read: point, deviation; .*survey-columns",
    ):
        found = cf.SurveyField.from_csv(path, n_max=12, degree=1)
    expected = cf.SurveyField.from_points(theta, z, radius, n_max=12, degree=1)
    np.testing.assert_allclose(found.fit.cos, expected.fit.cos, atol=1e-8)
    np.testing.assert_allclose(found.fit.sin, expected.fit.sin, atol=1e-8)


def test_a_wall_measured_at_x_y_z_has_its_thickness(tmp_path):
    theta, z, radius = turned_about(0.0, 0.0)
    thickness = 3e-3 * (1.0 + 0.02 * np.cos(3.0 * theta))
    cells = np.column_stack([radius * np.cos(theta), radius * np.sin(theta), z, thickness])
    np.savetxt(tmp_path / "wall.csv", cells, delimiter=",", header="x_m,y_m,z_m,thickness_m", comments="")
    survey = cf.SurveyField.from_csv(tmp_path / "wall.csv", n_max=6)
    assert survey.quantity == "thickness"
    assert survey.fit.amplitude(3) == pytest.approx(0.02, abs=1e-6)


@pytest.mark.filterwarnings("ignore:.*survey-columns")
@pytest.mark.parametrize("corner", [0.3 - 0.1j, 1.8 + 0.7j])
def test_a_machine_s_origin_may_lie_anywhere(tmp_path, corner):
    theta, z, radius = turned_about(corner, LEAN)
    path = measured_by_machine(tmp_path / "machine.csv", radius * np.exp(1j * theta), z, "m", 1.0)
    with pytest.raises(cf.errors.InputError, match=r"points with.* mm off the axis .* or centred = true"):
        cf.SurveyField.from_csv(path)
    survey = cf.SurveyField.from_csv(path, n_max=12, degree=1, centred=True)
    assert abs(survey.axis.offset - corner) < 1e-8
    assert abs(survey.axis.tilt - LEAN) < 1e-7
    assert survey.fit.amplitude(2) == pytest.approx(6e-4, abs=2e-8)
    assert survey.fit.amplitude(8) == pytest.approx(2e-4, abs=2e-8)


@pytest.mark.slow
def test_stray_points_of_a_scan_are_named():
    """20,000 points: a search for one stray point after the other did not end."""
    rng = np.random.default_rng(11)
    theta, z = rng.uniform(0.0, 2.0 * np.pi, 20_000), rng.uniform(0.0, 0.25, 20_000)
    radius = 0.5 - 0.2 * z + 2e-4 * np.cos(6.0 * theta) + rng.normal(0.0, 5e-6, z.size)
    off = rng.choice(z.size, 300, replace=False)
    radius[off] += rng.choice([-1.0, 1.0], off.size) * rng.uniform(6e-5, 2e-3, off.size)
    with pytest.warns(cf.errors.ModelWarning, match="survey-stray"):
        survey = cf.SurveyField.from_points(theta, z, radius, n_max=8, degree=1)
    assert {round(at, 9) for at, _, _ in survey.doubted} == {round(at, 9) for at in np.degrees(theta[off])}
    assert survey.without.amplitude(6) == pytest.approx(2e-4 / 0.475, rel=1e-2)
