"""Surveys: the fit gives back what was measured, and says no to what it cannot use."""

import re
import warnings

import numpy as np
import pytest

import casingfem as cf

DEFECT = cf.FourierField(
    p=np.array([2, 8, 20]),
    cos=np.array([[1e-3, 2e-4], [4e-3, 0.0], [3e-3, -1e-4]]),
    sin=np.array([[5e-4, 0.0], [0.0, 3e-4], [0.0, 0.0]]),
    z_mid=0.125,
    z_half=0.125,
)


def rings(heights=(0.0, 0.125, 0.25), points=72, first_deg=0.0):
    theta = np.radians(first_deg + np.arange(points) * 360.0 / points)
    z, theta = np.meshgrid(heights, theta, indexing="ij")
    return theta.ravel(), z.ravel()


def casing(theta, z, defect: cf.field.Field = DEFECT):
    return (0.5 - 0.2 * z) * (1 + defect.derivatives(z, theta).value)


def write(path, theta, z, radius, header="theta_deg,z_m,radius_m", card="# lathe, dial gauge\n"):
    rows = zip(np.degrees(theta), z, radius, strict=True)
    path.write_text(f"{card}{header}\n" + "".join(f"{t!r},{h!r},{r!r}\n" for t, h, r in map(floats, rows)))
    return path


def floats(row):
    return tuple(float(x) for x in row)


def test_rings_give_back_the_cone_and_the_defect():
    theta, z = rings()
    survey = cf.SurveyField.from_points(theta, z, casing(theta, z))
    assert survey.mean == pytest.approx((0.5, -0.2), rel=1e-12)
    np.testing.assert_allclose(survey.mean_radius([0.0, 0.25]), [0.5, 0.45], rtol=1e-12)
    assert survey.residual_rms < 1e-14
    assert (survey.coverage_deg, survey.n_resolved, survey.max_harmonic) == (pytest.approx(5.0), 35, 28)
    assert survey.z_range == (0.0, 0.25)
    points = np.array([[0.03], [0.2]]), np.linspace(0, 6, 9)
    for got, exact in zip(survey.derivatives(*points), DEFECT.derivatives(*points), strict=True):
        np.testing.assert_allclose(got, exact, atol=1e-9)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*survey-eccentric")  # where p = 1 is more than all others together
@pytest.mark.parametrize(("seed", "degree"), [(4626, 1), (1, 0), (2, 1), (3, 2), (4, 2)])
def test_scattered_points_with_repeats_give_back_their_own_field(seed, degree):
    rng = np.random.default_rng(seed)
    theta, z = rng.uniform(0, 2 * np.pi, 600), rng.uniform(0.0, 0.25, 600)
    theta, z = np.append(theta, theta[:50]), np.append(z, z[:50])
    cos, sin = rng.normal(scale=1e-3, size=(2, 8, degree + 1))
    made = cf.FourierField(p=np.arange(1, 9), cos=cos, sin=sin, z_mid=z.mean(), z_half=0.2)
    survey = cf.SurveyField.from_points(theta, z, casing(theta, z, made), n_max=10, degree=degree)
    got, exact = survey.derivatives(z, theta), made.derivatives(z, theta)
    np.testing.assert_allclose(got.value, exact.value, atol=1e-11)
    assert survey.mean == pytest.approx((0.5, -0.2), rel=1e-9)


@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e4])
def test_a_cone_of_any_size_gives_back_its_field(scale):
    """Points at random, so that the mean feels the waves, which are counted in it."""
    rng = np.random.default_rng(7)
    theta, z = rng.uniform(0, 2 * np.pi, 300), rng.uniform(0.0, 0.25, 300)
    cos, sin = np.array([[0.05, 0.02], [0.03, 0.0]]), np.array([[0.01, 0.0], [0.0, 0.02]])
    made = cf.FourierField(p=np.array([2, 5]), cos=cos, sin=sin, z_mid=0.125, z_half=0.125)
    survey = cf.SurveyField.from_points(theta, z, scale * casing(theta, z, made), n_max=5, degree=1)
    np.testing.assert_allclose(survey.derivatives(z, theta).value, made.derivatives(z, theta).value, atol=1e-13)
    assert survey.mean == pytest.approx((0.5 * scale, -0.2 * scale), rel=1e-13)


def test_turning_the_survey_turns_the_fit():
    theta, z = rings()
    turned = cf.SurveyField.from_points(theta + 0.7, z, casing(theta, z))
    still = cf.SurveyField.from_points(theta, z, casing(theta, z)).rotated(0.7)
    for a, b in zip(turned.derivatives(z, theta), still.derivatives(z, theta), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-9)


def test_residual_is_the_noise_that_was_put_in():
    theta, z = rings(points=180)
    noise = np.random.default_rng(31).normal(scale=2e-5, size=z.size)
    survey = cf.SurveyField.from_points(theta, z, casing(theta, z) + noise, n_max=30, degree=1)
    free = 1 - 122 / z.size
    assert survey.residual_rms_m == pytest.approx(2e-5 * np.sqrt(free), rel=0.1)
    left = (casing(theta, z) + noise) / survey.mean_radius(z) - 1.0 - survey.derivatives(z, theta).value
    assert survey.residual_rms == pytest.approx(np.sqrt(np.mean(left**2)), rel=1e-9)
    assert survey.residual_max == pytest.approx(np.abs(left).max(), rel=1e-9)
    assert survey.fit.amplitude(8) == pytest.approx(4e-3, abs=2e-5)


def test_csv_units_card_and_repr(tmp_path):
    theta, z = rings()
    radius = casing(theta, z)
    plain = cf.SurveyField.from_csv(write(tmp_path / "a.csv", theta, z, radius))
    milli = cf.SurveyField.from_csv(write(tmp_path / "b.csv", theta, 1e3 * z, 1e3 * radius, "theta_deg,z_mm,radius_mm"))
    radian = cf.SurveyField.from_csv(write(tmp_path / "c.csv", np.radians(theta), z, radius, "theta_rad,z_m,radius_m"))
    for other in (milli, radian):
        np.testing.assert_allclose(other.fit.cos, plain.fit.cos, atol=1e-13)
        assert other.mean == pytest.approx(plain.mean)
    assert plain.card == ("lathe, dial gauge",)
    text = repr(plain)
    assert "216 points, 3 heights" in text
    assert "residual  rms" in text
    assert "resolves harmonic 35" in text
    assert isinstance(plain, cf.field.Field)


def test_thickness_survey_keeps_its_taper_in_the_field(tmp_path):
    theta, z = rings(heights=(0.0, 0.1, 0.2))
    zeta = (z - 0.1) / 0.1
    thickness = 3e-3 * (1 + 0.02 * zeta + 0.01 * np.cos(2 * theta))
    path = write(tmp_path / "t.csv", theta, z, 1e3 * thickness, "theta_deg,z_m,thickness_mm")
    survey = cf.SurveyField.from_csv(path)
    assert survey.quantity == "thickness"
    assert survey.mean_thickness == pytest.approx(3e-3, rel=1e-12)
    np.testing.assert_allclose(survey.derivatives(z, theta).value, thickness / 3e-3 - 1, atol=1e-12)
    with pytest.raises(ValueError, match="no mean radius"):
        survey.mean_radius(0.0)


def test_one_height_has_no_slope_even_when_the_probe_wobbles():
    theta, z = rings(heights=(0.2,))
    z = z + 1e-5 * np.sin(9 * theta)
    survey = cf.SurveyField.from_points(theta, z, casing(theta, z, cf.FourierField.of({8: 4e-3})))
    assert (survey.heights, survey.mean[1], survey.fit.cos.shape[1]) == (1, 0.0, 1)
    assert survey.fit.amplitude(8) == pytest.approx(4e-3, rel=1e-4)


def test_few_points_lower_the_default_fit_instead_of_overfitting():
    theta, z = rings(heights=(0.0, 0.1, 0.2, 0.3), points=12)
    survey = cf.SurveyField.from_points(theta, z, 0.5 + 0.0 * z)
    unknowns = 2 + 2 * survey.max_harmonic * survey.fit.cos.shape[1]
    assert unknowns <= 0.8 * 48
    assert survey.max_harmonic == 4
    staggered = np.arange(28) * 2 * np.pi / 28
    survey = cf.SurveyField.from_points(staggered, 0.1 * (np.arange(28) % 4), np.full(28, 0.5))
    assert (survey.n_resolved, survey.max_harmonic, survey.fit.cos.shape[1]) == (13, 10, 1)


def test_one_bad_ring_decides_the_coverage():
    theta, z = rings()
    hole = (z == 0.125) & (theta > 1.0) & (theta < 2.0)
    survey = cf.SurveyField.from_points(theta[~hole], z[~hole], casing(theta, z)[~hole], n_max=3, degree=0)
    assert survey.coverage_deg == pytest.approx(60.0)
    with pytest.raises(cf.errors.InputError, match="gap of 60 deg"):
        cf.SurveyField.from_points(theta[~hole], z[~hole], casing(theta, z)[~hole], n_max=4)


# --- outliers, repeats, resolution ----------------------------------------------------------------------------


def noisy(points=120, sigma=2e-5, seed=17):
    theta, z = rings(points=points)
    return theta, z, casing(theta, z) + np.random.default_rng(seed).normal(scale=sigma, size=z.size)


def test_a_robust_fit_sets_stray_points_aside_and_names_them():
    """Nine chips of .5 mm in noise of 20 um: the fit is as good as without them; plain least squares is not."""
    theta, z, radius = noisy()
    stray = np.random.default_rng(3).choice(z.size, 9, replace=False)
    chipped = radius.copy()
    chipped[stray] -= 5e-4
    clean = cf.SurveyField.from_points(theta, z, radius, n_max=24, degree=1)
    with pytest.warns(cf.errors.ModelWarning, match=r"survey: 9 of 360 points are outliers .*survey-stray"):
        plain = cf.SurveyField.from_points(theta, z, chipped, n_max=24, degree=1)
    assert {round(theta, 6) for theta, _, _ in plain.doubted} == {round(float(np.degrees(theta[k])), 6) for k in stray}
    assert np.abs(plain.without.cos - clean.fit.cos).max() < np.abs(plain.fit.cos - clean.fit.cos).max() / 4
    assert "outliers  9 of 360 points included in the fit (theta" in repr(plain)
    assert clean.doubted == ()
    assert clean.without is None
    with pytest.warns(
        cf.errors.ModelWarning, match=r"of 360 points left out .* m: -0\.\d+ %.*survey-outliers"
    ) as caught:
        robust = cf.SurveyField.from_points(theta, z, chipped, n_max=24, degree=1, robust=True)
    assert caught[0].filename == __file__
    named = {round(theta, 6) for theta, _, r in robust.set_aside if r < -5e-4}
    assert named == {round(float(np.degrees(theta[k])), 6) for k in stray}
    assert len(robust.set_aside) <= 9 + 5
    off = [np.abs(fit.fit.cos - clean.fit.cos).max() for fit in (plain, robust)]
    assert off[0] > 4 * off[1]
    assert robust.residual_rms < 1.2 * clean.residual_rms < plain.residual_rms / 2
    assert "points left out (theta" in repr(robust)


def test_a_robust_fit_of_clean_points_is_the_plain_one():
    theta, z = rings()
    robust = cf.SurveyField.from_points(theta, z, casing(theta, z), robust=True)
    assert robust.set_aside == ()
    np.testing.assert_allclose(
        robust.fit.cos, cf.SurveyField.from_points(theta, z, casing(theta, z)).fit.cos, atol=1e-12
    )


def test_a_robust_fit_does_not_believe_a_minority():
    theta, z, radius = noisy()
    radius[np.random.default_rng(5).random(z.size) < 0.34] += 0.02
    with pytest.raises(cf.errors.InputError, match=r"points far from the smooth surface.*expected at least 70% of the"):
        cf.SurveyField.from_points(theta, z, radius, n_max=20, degree=0, robust=True)


@pytest.mark.parametrize("between", [0, 1, 2])
def test_a_robust_fit_states_when_what_it_keeps_is_too_little(between):
    """A ring of four points off their own plane tells the slope of three columns, and so do three points between."""
    theta, z = rings(heights=(0.0,), points=36)
    theta = np.concatenate([theta, np.radians([0.0, 90.0, 180.0, 270.0]), np.radians([45.0, 165.0, 285.0])])
    z = np.concatenate([z, np.full(4, 0.2), np.full(3, 0.1)])
    radius = 0.5 + 1e-6 * np.random.default_rng(1).normal(size=z.size)
    radius[36:40] += [1e-3, -1e-3, 1e-3, -1e-3]
    with pytest.warns(cf.errors.ModelWarning, match=r"survey: 4 of 43 points left out .*survey-outliers"):
        assert len(cf.SurveyField.from_points(theta, z, radius, n_max=1, degree=1, robust=True).set_aside) == 4
    given = slice(40 + between)
    found = "found 4 outliers, and too few other points near them for n_max = 1, degree"
    with pytest.raises(cf.errors.InputError, match=found):
        cf.SurveyField.from_points(theta[given], z[given], radius[given], n_max=1, degree=1, robust=True)


def one_height_and_four_points():
    """Four of 36 points are on a height of their own, which counts beside a ring of 32, and lie off."""
    theta, z = rings(heights=(0.0,), points=32)
    theta, z = np.append(theta, np.radians([0.0, 90.0, 180.0, 270.0])), np.append(z, np.full(4, 0.2))
    radius = 0.5 + 1e-6 * np.random.default_rng(1).normal(size=z.size)
    radius[32:] += [1e-3, -1e-3, 1e-3, -1e-3]
    return theta, z, radius


@pytest.mark.parametrize("spread", [0.0, 1e-4])
def test_a_robust_fit_that_keeps_one_of_two_heights_is_refused(spread):
    theta, z, radius = one_height_and_four_points()
    z[:32:2] += spread
    found = "found 4 outliers, and too few other points near them for n_max = 1, degree"
    with pytest.raises(cf.errors.InputError, match=found):
        cf.SurveyField.from_points(theta, z, radius, n_max=1, degree=1, robust=True)


def test_a_plain_fit_whose_stray_points_are_a_height_has_no_fit_without_them():
    survey = cf.SurveyField.from_points(*one_height_and_four_points(), n_max=1, degree=1)
    assert (survey.heights, survey.without, survey.doubted) == (2, None, ())


@pytest.mark.parametrize(
    ("second", "words"),
    [
        (lambda random, theta: 5e-6 * random.standard_normal(theta.size), None),
        (lambda random, theta: 8e-6 + 5e-6 * random.standard_normal(theta.size), r"by \+[78](\.\d+)? um on average"),
        (lambda random, theta: -8e-6 + 5e-6 * random.standard_normal(theta.size), r"by -[78](\.\d+)? um on average"),
        (lambda random, theta: 2e-5 * np.cos(3 * theta), r"by 14\.\d um \(rms\), and not at random"),
    ],
)
def test_a_second_measurement_that_differs_by_more_than_its_scatter_is_reported(second, words):
    theta, z = (part.ravel() for part in np.meshgrid(2 * np.pi * np.arange(36) / 36, [0.0, 0.1], indexing="ij"))
    random = np.random.default_rng(4)
    first = 0.5 + 1e-3 * np.cos(2 * theta)
    both = np.r_[first, first + second(random, theta)]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        cf.SurveyField.from_points(np.tile(theta, 2), np.tile(z, 2), both, n_max=4)
    told = [str(one.message) for one in caught if "survey-passes" in str(one.message)]
    assert len(told) == (words is not None)
    if words:
        assert "72 places were measured twice; the second measurements differ from the first" in told[0]
        assert re.search(words, told[0])


def test_repeats_give_the_noise_whatever_the_fit():
    """200 repeats of 20 um: the estimate scatters by 1/sqrt(2 * 200) = 5 %; the fit misses harmonic 20."""
    theta, z = rings(points=180)
    again = np.random.default_rng(8).choice(z.size, 200, replace=False)
    theta, z = np.append(theta, theta[again] + 2 * np.pi), np.append(z, z[again])
    radius = casing(theta, z) + np.random.default_rng(31).normal(scale=2e-5, size=z.size)
    survey = cf.SurveyField.from_points(theta, z, radius, n_max=12)
    assert survey.repeats == 200
    assert survey.pure_error == pytest.approx(2e-5, rel=0.15)
    assert survey.residual_rms_m > 20 * survey.pure_error
    assert "repeats   200, pure error" in repr(survey)
    assert cf.SurveyField.from_points(*rings(), 0.5 + 0 * rings()[0]).pure_error is None


@pytest.mark.slow
def test_modes_beyond_the_surveys_resolution_are_doubted(frustum):
    mesh = cf.ShellMesh(order=6, rows=1, around=13)  # of which no 2n below 26 is a multiple
    theta, z = rings(points=24)  # every 15 degrees: resolves harmonic 11, splits to n = 5
    survey = cf.SurveyField.from_points(theta, z, (0.5 - 0.2 * z) * (1 + 1e-3 * np.cos(4 * theta)))
    assert survey.n_resolved == 11
    for field in (survey, survey.fit + RandomlyNothing() + survey):
        with pytest.warns(
            cf.errors.ModelWarning, match=r"pairs up to n = .* resolves harmonics up to 11.*field-resolution"
        ) as caught:
            cf.modes(frustum(mesh=mesh, radius_defect=field), 6)
        assert len(caught) == 1
    cf.modes(frustum(mesh=mesh, radius_defect=survey.fit), 6)  # given by hand: exact, nothing to say
    theta, z = rings(points=72)
    cf.modes(frustum(mesh=mesh, radius_defect=cf.SurveyField.from_points(theta, z, 0.5 - 0.2 * z, n_max=20)), 6)


def test_a_casing_refuses_the_survey_of_another_one_alone_or_in_a_sum(frustum, coarse):
    theta, z = rings()
    other = cf.SurveyField.from_points(theta, z, 1.3 * (0.5 - 0.2 * z), n_max=8)
    wall = cf.SurveyField.from_points(theta, z, np.full(len(z), 3e-3), quantity="thickness", n_max=8)
    for field in (other, DEFECT + other):
        with pytest.raises(
            cf.errors.ModelError, match=r"found a mean radius of 0\.6175 m, expected about 0\.475 m.*survey-other"
        ):
            frustum(mesh=coarse, radius_defect=field)
    for field in (wall, DEFECT + wall):
        with pytest.raises(
            cf.errors.ModelError, match=r"found a survey of thickness, expected one of radius.*survey-quantity"
        ):
            frustum(mesh=coarse, radius_defect=field)
    frustum(mesh=coarse, thickness_defect=wall)
    with pytest.raises(
        cf.errors.ModelError, match=r"a mean thickness of 0\.003 m, expected about 0\.002 m.*survey-other"
    ):
        frustum(mesh=coarse, thickness=2e-3, thickness_defect=wall)


class RandomlyNothing:
    def derivatives(self, z, theta):
        zero = np.zeros(np.broadcast(z, theta).shape)
        return cf.field.FieldValues(*[zero] * 6)

    def rotated(self, angle):
        return self


def csv_rows(count=36, value="0.5"):
    return "".join(f"{10 * k},0.0,{value}\n" for k in range(count))


GOOD = "theta_deg,z_m,radius_m\n"
BAD = {
    "empty file": (b"", "no header row"),
    "only a card": (b"# survey\n", "no header row"),
    "no rows": (GOOD.encode(), "line 1: found no rows"),
    "not UTF-8": (b"# r\xe9seau\n" + GOOD.encode(), "line 1: found byte 0xe9"),
    "UTF-16 cut": (("\ufeff" + GOOD).encode("utf-16-le")[:-1], "not UTF-16"),
    "workbook": (b"PK\x03\x04\x14\x00", "found no readable workbook .* saved as CSV"),
    "binary": (b"theta_deg,z_m,\x00radius_m\n", "line 1: found a zero byte"),
    "no unit": (b"theta_deg,z_m,radius\n0,0,1\n", "column 'radius': found a column without a unit in its"),
    "feet": (b"theta_deg,z_m,radius_ft\n1,2,3\n", "expected one column radius_m or radius_mm"),
    "theta missing": (b"z_m,radius_m\n0,1\n", "expected one column theta_deg or theta_rad"),
    "two radii": (b"theta_deg,z_m,radius_m,radius_mm\n1,0,1,1\n", "found both radius_m and radius_mm"),
    "twice": (b"theta_deg,z_m,z_m,radius_m\n", "line 1, column 'z_m': found this column twice"),
    "x alone": (
        b"x_mm,z_m,point\n500,0,1\n",
        "line 1: found no such column among x_mm,z_m,point; expected one column y_m",
    ),
    "y without unit": (b"x_mm,Y,z_m\n500,0,0\n", "column 'Y': found a column without a unit in its name"),
    "x in mm": (b"x_m,y_m,z_m\n500,0,0\n-500,0,0\n0,500,0\n", "median radius of 500 m.* is the column x_mm"),
    "on the axis": (b"x_m,y_m,z_m\n0.5,0,0\n0,0,0\n", "line 3, column 'x_m': found 0; expected a value > 0"),
    "no name": (b"theta_deg,z_m,radius_m,\n1,0,1,2\n", "no name for column 4"),
    "no header": (csv_rows().encode(), "found numbers"),
    "semicolons": (b"theta_deg;z_m;radius_m\n0;0,0;1,0\n1;0.0;1.0\n", "line 3: found '0.0' below .* decimal comma"),
    "ragged": ((GOOD + csv_rows(3) + "30,0.0\n").encode(), "line 5: found 2 cells"),
    "decimal comma": ((GOOD + "0,0.0,0,5\n").encode(), "line 2: found 4 cells .* decimal point"),
    "NaN": ((GOOD + csv_rows(3) + "30,0.0,nan\n").encode(), "line 5, column 'radius_m': found 'nan'"),
    "infinite": ((GOOD + "30,0.0,1e999\n").encode(), "line 2, column 'radius_m': found '1e999'"),
    "blank": (("# c\n\n" + GOOD + "0,,0.5\n").encode(), "line 4, column 'z_m': found an empty cell"),
    "text": ((GOOD + "0,0.0,0.5 mm\n").encode(), "line 2, column 'radius_m': found '0.5 mm'"),
    "underscore": ((GOOD + "0,0.0,0_5\n").encode(), "found '0_5'"),
    "open quote": ((GOOD + '0,0.0,"0.5\n').encode(), "line 2: found quotes"),
    "radius 0": ((GOOD + csv_rows(2) + "20,0.0,0\n").encode(), "line 4, column 'radius_m': found 0"),
    "negative": ((GOOD + "20,0.0,-0.5\n").encode(), "found -0.5; expected a value > 0"),
    "mm as m": ((GOOD + csv_rows(value="500")).encode(), "median radius of 500 m.* radius_mm"),
    "m as mm": (("theta_deg,z_m,radius_mm\n" + csv_rows()).encode(), "median radius of 0.0005 m.* radius_m"),
    "z in mm": ((GOOD + csv_rows() + csv_rows().replace(",0.0,", ",250,")).encode(), "z_mm"),
    "z in m": (
        ("theta_deg,z_mm,radius_m\n" + csv_rows() + csv_rows().replace(",0.0,", ",0.25,")).encode(),
        "column 'z_mm': found heights over 0.00025 m",
    ),
    "degrees as radians": (
        ("theta_rad,z_m,radius_m\n" + csv_rows()).encode(),
        "degrees in a column theta_deg",
    ),
    "radians as degrees": ((GOOD + "0,0,1\n3,0,1\n6.2,0,1\n").encode(), "are these radians"),
    "half a circle": ((GOOD + csv_rows(19)).encode(), "gap of 180 deg"),
    "thickness in mm": (
        ("theta_deg,z_m,thickness_m\n" + csv_rows(value="3.0")).encode(),
        "median thickness of 3 m",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_surveys_are_refused_with_their_place(tmp_path, name):
    content, message = BAD[name]
    path = tmp_path / "bad.csv"
    path.write_bytes(content)
    with pytest.raises(cf.errors.InputError, match=message) as caught:
        cf.SurveyField.from_csv(path)
    assert "bad.csv" in str(caught.value)


def test_fits_beyond_the_points_are_refused():
    theta, z = rings(heights=(0.0,), points=24)
    cf.SurveyField.from_points(theta, z, 0.5 + 0 * z, n_max=11)
    with pytest.raises(cf.errors.InputError, match="24 points for 25 unknowns"):
        cf.SurveyField.from_points(theta, z, 0.5 + 0 * z, n_max=12)
    with pytest.raises(cf.errors.InputError, match="gap of 15 deg"):
        cf.SurveyField.from_points(theta, z, 0.5 + 0 * z, n_max=13)
    with pytest.raises(cf.errors.InputError, match="24 points for 45 unknowns"):
        cf.SurveyField.from_points(theta, z, 0.5 + 0 * z, n_max=11, degree=1)
    with pytest.raises(ValueError, match="n_max must be a whole number >= 1"):
        cf.SurveyField.from_points(theta, z, 0.5 + 0 * z, n_max=0)
    with pytest.raises(cf.errors.InputError, match="one equal length"):
        cf.SurveyField.from_points(theta, z[:-1], z)
    with pytest.raises(cf.errors.InputError, match="value = nan"):
        cf.SurveyField.from_points(theta, z, np.where(theta > 3, np.nan, 0.5))


@pytest.mark.parametrize(("part", "refused"), [(1.6, True), (0.42, True), (1.05, False)])
def test_a_point_that_no_imperfection_explains_is_an_error_with_its_line_unless_the_fit_is_robust(
    part, refused, tmp_path
):
    """A radius of 0.5 m in noise of 20 um; one point is off by more than a tenth of it, or by less."""
    rng = np.random.default_rng(11)
    theta, z = np.tile(np.arange(0.0, 360.0, 5.0), 3), np.repeat([0.02, 0.12, 0.22], 72)
    radius = 0.5 + rng.normal(0.0, 2e-5, theta.size)
    radius[100] *= part
    path = tmp_path / "stray.csv"
    rows = (f"{a},{b},{c!r}\n" for a, b, c in zip(theta, z, radius.tolist(), strict=True))
    path.write_text("# a survey\ntheta_deg,z_m,radius_m\n" + "".join(rows), encoding="utf-8")
    if refused:
        found = rf"line 103: found a radius of {radius[100]:.4g} m at theta 140 deg.* {100 * (part - 1):+.3g} % from"
        with pytest.raises(cf.errors.InputError, match=found.replace("+", r"\+")):
            cf.SurveyField.from_csv(path, n_max=8)
    else:
        with pytest.warns(cf.errors.ModelWarning, match="survey-stray"):
            cf.SurveyField.from_csv(path, n_max=8)
    with pytest.warns(cf.errors.ModelWarning, match="survey-outliers"):
        assert cf.SurveyField.from_csv(path, n_max=8, robust=True).residual_max < 2e-4
