"""What a survey's points are asked before they are fitted: both sides of each bound."""

from contextlib import nullcontext

import numpy as np
import pytest

import casingfem as cf


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"theta": np.zeros(2)}, r"theta \(2,\), z \(3,\), value \(3,\); expected arrays of one equal length of"),
        ({"theta": np.zeros((3, 1)), "z": np.zeros((3, 1)), "value": np.ones((3, 1))}, "one equal length"),
        ({"theta": [], "z": [], "value": []}, "one equal length of"),
        ({"value": [1.0, 0.0, 2.0]}, "value = 0.0; expected finite numbers, thickness > 0"),
        ({"z": [0.0, np.inf, 0.0]}, "z = inf"),
        ({"theta": [0.0, 1.0, np.nan]}, "theta = nan"),
    ],
)
def test_points_that_are_none(changes, words):
    given = {"theta": [0.0, -1.0, 0.0], "z": [0.0, -1.0, 2.0], "value": [1.0, 2.0, 3.0]}
    with pytest.raises(cf.errors.InputError, match=words):
        cf.SurveyField.from_points(**given | changes, quantity="thickness")


def table(tmp_path, text):
    path = tmp_path / "rig.csv"
    path.write_text(text)
    return path


def lines(value="0.5", z="0.0", count=12, step=30.0):
    return "".join(f"{step * k},{z},{value}\n" for k in range(count))


@pytest.mark.parametrize(
    ("header", "value", "refused"),
    [
        ("radius_m", "0.005", False), ("radius_m", "0.00499", True), ("radius_m", "50", False),
        ("radius_m", "50.1", True), ("radius_mm", "5", False), ("radius_mm", "4.9", True),
        ("thickness_m", "1e-5", False), ("thickness_m", "0.99e-5", True), ("thickness_m", "0.5", False),
        ("thickness_m", "0.51", True), ("thickness_mm", "0.01", False), ("thickness_mm", "501", True),
    ],
)  # fmt: skip
def test_medians_that_hint_at_another_unit(tmp_path, header, value, refused):
    path = table(tmp_path, f"theta_deg,z_m,{header}\n{lines(value)}")
    if refused:
        stem, unit = header.split("_")
        other = f"{stem}_{'m' if unit == 'mm' else 'mm'}"
        with pytest.raises(cf.errors.InputError, match=f"line 1, column '{header}'.*is the column {other}"):
            cf.SurveyField.from_csv(path)
    else:
        field = cf.SurveyField.from_csv(path)
        assert field.quantity == header.split("_")[0]
        assert field.derivatives(np.zeros(1), 0.0).value == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "height", "what", "value", "refused"),
    [
        ("z_m", "24.9", "radius_m", "0.5", ""),  # fifty radii
        ("z_m", "25.1", "radius_m", "0.5", "0.0005 to 25 m; is the column z_mm"),
        ("z_mm", "0.51", "radius_m", "0.5", ""),
        ("z_mm", "0.49", "radius_m", "0.5", "0.0005 to 25 m; is the column z_m[?]"),
        ("z_mm", "0", "radius_m", "0.5", ""),
        ("z_m", "0.00049", "radius_m", "0.5", ""),
        ("z_m", "24.9", "thickness_m", "0.003", ""),  # of half a metre
        ("z_m", "25.1", "thickness_m", "0.003", "is the column z_mm"),
        ("z_mm", "0.49", "thickness_m", "0.003", "is the column z_m[?]"),
    ],
)
def test_heights_that_hint_at_another_unit(tmp_path, name, height, what, value, refused):
    path = table(tmp_path, f"theta_deg,{name},{what}\n" + lines(value, "0") + lines(value, height))
    if refused:
        with pytest.raises(cf.errors.InputError, match=refused):
            cf.SurveyField.from_csv(path)
    else:
        assert cf.SurveyField.from_csv(path).quantity == what.split("_")[0]


@pytest.mark.parametrize(("value", "refused"), [("499", False), ("501", True)])
def test_a_value_a_thousand_times_the_median_is_mistyped(tmp_path, value, refused):
    path = table(tmp_path, f"theta_deg,z_m,radius_m\n{lines()}360,0,{value}\n")
    if refused:
        with pytest.raises(
            cf.errors.InputError, match="line 14, column 'radius_m': found 501; expected a value like the others"
        ):
            cf.SurveyField.from_csv(path)
    else:
        with pytest.raises(cf.errors.InputError, match="found points with"):
            cf.SurveyField.from_csv(path)


@pytest.mark.parametrize(("turn", "refused"), [("12.56", False), ("-12.56", False), ("-12.57", True)])
def test_angles_beyond_two_turns_are_no_radians(tmp_path, turn, refused):
    path = table(tmp_path, f"theta_rad,z_m,radius_m\n0,0,0.5\n{turn},0,0.5\n")
    if refused:
        with pytest.raises(
            cf.errors.InputError, match=r"line 3, column 'theta_rad': found -12\.57 rad; expected at most"
        ):
            cf.SurveyField.from_csv(path)
    else:
        with pytest.raises(cf.errors.InputError, match=r"gap|points"):
            cf.SurveyField.from_csv(path)


HEIGHTS = np.array([0.1, 0.2])


def partial(outside):
    """Harmonic 3 that grows from 0.001 to 0.003 between two heights."""
    z = np.repeat(HEIGHTS, 36)
    theta = np.tile(2.0 * np.pi * np.arange(36) / 36, 2)
    radius = 0.5 * (1.0 + (0.001 + 0.02 * (z - 0.1)) * np.cos(3.0 * theta))
    return cf.SurveyField.from_points(theta, z, radius, n_max=6).bounded(outside)


@pytest.mark.parametrize(
    ("outside", "below", "above"),
    [("fit", -0.001, 0.005), ("nearest", 0.001, 0.003), ("zero", 0.0, 0.0)],
)
def test_outside_the_heights_of_a_survey_its_rule_counts(outside, below, above):
    """At 0.1 m beyond either end; "zero" is half way down at an eighth of the heights."""
    field = partial(outside)
    values = field.derivatives(np.array([0.0, 0.1, 0.15, 0.2, 0.3]), 0.0).value
    np.testing.assert_allclose(values, [below, 0.001, 0.002, 0.003, above], atol=1e-9)
    if outside == "zero":
        half = field.derivatives(np.array([0.1 - 0.0125, 0.2 + 0.0125]), 0.0).value
        np.testing.assert_allclose(half, [0.0005, 0.0015], atol=1e-9)


@pytest.mark.parametrize("outside", ["fit", "nearest", "zero"])
def test_derivatives_of_a_field_with_a_rule_are_those_of_its_value(outside):
    field, z, h = partial(outside).with_harmonic(2, cos=1e-3), np.array([0.07, 0.09, 0.12, 0.21, 0.215, 0.3]), 1e-6
    at, low, high = (field.derivatives(z + step, 0.3) for step in (0.0, -h, h))
    np.testing.assert_allclose(at.d_z, (high.value - low.value) / (2.0 * h), atol=1e-8)
    np.testing.assert_allclose(at.d_zz, (high.d_z - low.d_z) / (2.0 * h), atol=1e-5)
    step = field.derivatives(z + 1e-30j, 0.3).value.imag / 1e-30
    np.testing.assert_allclose(at.d_z, step, atol=1e-12)


STUDY = """
[material]
E = 210e9
nu = 0.3
rho = 7800.0
[chart]
kind = "cylinder"
radius = 0.5
height = 0.5
[shell]
thickness = 3e-3
[support.base]
kind = "clamped"
[[imperfection]]
of = "radius"
survey = "rig.csv"
"""


@pytest.mark.parametrize(
    ("heights", "rule", "words", "outside"),
    [
        ((100, 300), "", r"points at z from 0.1 to 0.3 m, 40% of the shell's 0 to 0.5 m; beyond them, the shape of",
         "nearest"),
        ((100, 300), 'outside = "zero"', r"beyond them, the shape goes down to zero over .*\[survey-part\]", "zero"),
        ((50, 400), "", "", "fit"),
        ((50, 400), 'outside = "nearest"', "", "nearest"),
        ((20, 480), 'outside = "refuse"', "", "fit"),
        ((50, 400), 'outside = "refuse"', r"refused.*70% of the shell's 0 to 0.5 m, expected at least 90%", ""),
        ((600, 700), "", r"refused.*0% of the shell's 0 to 0.5 m, expected points on the shell.*survey-other", ""),
    ],
)  # fmt: skip
def test_a_survey_of_a_part_of_the_height_states_what_applies_outside(heights, rule, words, outside, tmp_path):
    rows = [
        f"{angle};{z};{500 + 0.5 * np.cos(np.radians(3 * angle)):.4f}" for z in heights for angle in range(0, 360, 10)
    ]
    table(tmp_path, "\n".join(["theta_deg;z_mm;radius_mm", *rows, ""]).replace(".", ","))
    (tmp_path / "study.toml").write_text(STUDY + rule + "\n")
    if words.startswith("refused"):
        with pytest.raises(ValueError, match=words.removeprefix("refused")):
            cf.load_study(tmp_path / "study.toml")
        return
    with pytest.warns(cf.errors.ModelWarning, match=words) if words else nullcontext():
        study = cf.load_study(tmp_path / "study.toml")
    assert study.shell.radius_defect.outside == outside


def test_heights_on_a_meridian_are_axial_and_not_arc_lengths(tmp_path):
    """A flange of 0.3 m along the radius adds to the arc, not to the height: the survey covers 60 % of it."""
    corner = "fillet = 4e-3\n[[chart.piece]]\nto = [0.5, 0.5]\n[[chart.piece]]\nto = [0.8, 0.5]\n"
    chart = 'kind = "meridian"\nstart = [0.5, 0.0]\n' + corner
    text = STUDY.replace('kind = "cylinder"\nradius = 0.5\nheight = 0.5\n', chart)
    rows = [
        f"{angle},{z},{0.5 + 1e-4 * np.cos(np.radians(3 * angle))}" for z in (0.1, 0.4) for angle in range(0, 360, 10)
    ]
    table(tmp_path, "\n".join(["theta_deg,z_m,radius_m", *rows, ""]))
    (tmp_path / "study.toml").write_text(text)
    assert cf.load_study(tmp_path / "study.toml").shell.radius_defect.outside == "fit"


MERIDIAN = 'kind = "meridian"\nstart = [0.5, 0.0]\nfillet = 4e-3\n' + "".join(
    f"[[chart.piece]]\nto = {to}\n" for to in ([0.5, 0.5], [0.8, 0.5], [0.8, 0.3])
)


@pytest.mark.parametrize(
    ("header", "of", "points", "words"),
    [
        ("radius_m", "radius", [(0.1, 0.5), (0.5, 0.65)],
         r"rig.csv: found 36 points on a radial part of the meridian, first at theta 0 deg, z 0.5 m; expected points"),
        ("thickness_m", "thickness", [(0.1, 3e-3), (0.4, 3e-3)],
         "rig.csv: found thicknesses at heights z, and a meridian that has a height more than once; expected a"),
    ],
)  # fmt: skip
def test_points_without_a_place_on_a_meridian_are_refused(header, of, points, words, tmp_path):
    text = STUDY.replace('kind = "cylinder"\nradius = 0.5\nheight = 0.5\n', MERIDIAN).replace('"radius"', f'"{of}"')
    rows = [
        f"{angle},{z},{value * (1.0 + 1e-4 * np.cos(np.radians(3 * angle)))}"
        for z, value in points for angle in range(0, 360, 10)
    ]  # fmt: skip
    table(tmp_path, "\n".join([f"theta_deg,z_m,{header}", *rows, ""]))
    (tmp_path / "study.toml").write_text(text)
    with pytest.raises(cf.errors.InputError, match=words):
        cf.load_study(tmp_path / "study.toml")


@pytest.mark.parametrize("falls", [False, True])
def test_thicknesses_on_a_meridian_that_rises_or_falls_have_their_heights(falls, tmp_path):
    """A cone of 45 degrees: a height z is an arc length of z times the root of two from its lower end."""
    ends = [[0.5, 0.0], [0.4, 0.1]][:: -1 if falls else 1]
    chart = f'kind = "meridian"\nstart = {ends[0]}\n[[chart.piece]]\nto = {ends[1]}\n'
    text = STUDY.replace('kind = "cylinder"\nradius = 0.5\nheight = 0.5\n', chart).replace('"radius"', '"thickness"')
    rows = [
        f"{angle},{z},{3e-3 * (1.0 + (0.01 + 0.2 * z) * np.cos(np.radians(3 * angle)))}"
        for z in (0.02, 0.06, 0.09) for angle in range(0, 360, 10)
    ]  # fmt: skip
    table(tmp_path, "\n".join(["theta_deg,z_m,thickness_m", *rows, ""]))
    (tmp_path / "study.toml").write_text(text)
    field, z = cf.load_study(tmp_path / "study.toml").structure.thickness_defect, np.array([0.03, 0.08])
    s = np.sqrt(2.0) * (0.1 - z if falls else z)
    np.testing.assert_allclose(field.derivatives(s, 0.0).value, 0.01 + 0.2 * z, rtol=1e-6)


def test_a_survey_of_a_laboratory_is_read_with_its_comments_and_units(tmp_path):
    """Degrees, millimetres, centimetres with decimal commas, and a column that nobody uses: cos 3 theta of 1 mm."""
    theta, heights = np.arange(0, 360, 10), (20, 40)
    rows = [f"{a};{z};{50.0 + 0.1 * np.cos(np.radians(3 * a)):.9f};a".replace(".", ",") for z in heights for a in theta]
    text = "\n".join(["# scan 1", "Theta [deg];Z (mm);Radius [cm];Remark", *rows, "# scan 2", ""])
    with pytest.warns(cf.errors.ModelWarning, match="found columns that are not read: Remark; .*survey-columns"):
        field = cf.SurveyField.from_csv(table(tmp_path, text))
    at = field.derivatives(np.array([0.02, 0.03, 0.04]), np.radians(20.0)).value
    np.testing.assert_allclose(at, 0.5 * 1e-3 / 0.5, rtol=1e-5)


def test_all_bad_cells_and_columns_of_a_survey_are_named_at_once(tmp_path):
    with pytest.raises(cf.errors.InputError) as caught:
        cf.SurveyField.from_csv(table(tmp_path, "theta_deg,z_m,radius_m\n0,x,0.5\n1,0,y\n2,0,z\n"))
    lines = [line.partition("rig.csv, ")[2].partition(":")[0] for line in str(caught.value).splitlines()]
    assert sorted(lines) == ["line 2, column 'z_m'", "line 3, column 'radius_m'", "line 4, column 'radius_m'"]
    with pytest.raises(cf.errors.InputError, match=r"(?s)line 2: found 2 cells.*line 4: found 1 cells"):
        cf.SurveyField.from_csv(table(tmp_path, "theta_deg,z_m,radius_m\n0,0\n1,0,0.5\n2\n"))
