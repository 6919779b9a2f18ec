"""What a shell is made of: what varies around, where rings stand, geometry at points; bolts it does not follow."""

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)


def test_bolts_along_a_side_lie_on_its_length():
    def plate(first):
        bolts = cf.Bolts(count=2, k=1e6, spacing=0.2, first_angle=first, width=0.08)
        cf.Shell(chart=cf.Plate(length=0.3, width=0.1), thickness=2e-3, material=STEEL, supports={"left": bolts})

    plate(0.04)
    plate(0.06)
    for first in (0.039, 0.061):
        with pytest.raises(
            ValueError,
            match=r"support\.left: found patches from .* expected them on the edge, from 0 to 0\.3",
        ):
            plate(first)


def test_a_plain_fit_is_what_a_survey_is_given(tmp_path):
    """A stray point is told and not set aside; a part beside its axis is told and not moved."""
    theta = np.arange(0.0, 360.0, 5.0)
    value = 0.5 + 1e-3 * np.cos(np.radians(theta)) + 1e-6 * np.cos(np.radians(17.0 * theta**2))
    path = tmp_path / "rig.csv"
    path.write_text(
        "theta_deg,z_m,radius_m\n" + "".join(f"{t},0,{v!r}\n" for t, v in zip(theta, value.tolist(), strict=True))
    )
    for read in (
        lambda: cf.SurveyField.from_csv(path, n_max=4),
        lambda: cf.SurveyField.from_points(np.radians(theta), 0.0 * theta, value, n_max=4),
    ):
        with pytest.warns(cf.errors.ModelWarning, match="found a part 1 mm off the axis towards 0 deg"):
            survey = read()
        assert survey.axis is None
        assert survey.set_aside == ()
        assert survey.fit.amplitude(1) == pytest.approx(2e-3, rel=1e-3)
    value[10] += 1e-3
    with pytest.warns(cf.errors.ModelWarning) as told:
        doubted = cf.SurveyField.from_points(np.radians(theta), 0.0 * theta, value, n_max=4)
    assert [str(w.message).rsplit("[", 1)[1] for w in told] == ["survey-stray]", "survey-eccentric]"]
    assert [round(theta) for theta, _, _ in doubted.doubted] == [50]
    assert doubted.set_aside == ()
    lines = [f"{t},0,{v!r}\n" for t, v in zip(theta, value.tolist(), strict=True)]
    path.write_text("theta_deg,z_m,radius_m\n" + "".join(lines))
    with pytest.warns(cf.errors.ModelWarning):
        assert cf.SurveyField.from_csv(path, n_max=4).doubted == doubted.doubted
