"""Spectra that are fitted to surveys: the law of the casings they came from, and refusals."""

import numpy as np
import pytest

import casingfem as cf

STUDY = """
[material]
E = 210e9
nu = 0.3
rho = 7800.0
[chart]
kind = "cylinder"
radius = 0.5
height = 0.2
[shell]
thickness = 0.01
[support.base]
kind = "clamped"
[[imperfection]]
of = "radius"
random = ["one.csv", "two.csv"]
seed = 4
p_max = 12
"""
LAW = cf.field.Spectrum.between({2: 4e-3, 16: 1e-4}, {2: 8e-3, 16: 2e-4})


def test_a_spectrum_of_many_casings_is_the_law_they_were_drawn_by():
    drawn = [cf.field.RandomField(spectrum=LAW, seed=1, draw=k).fit for k in range(200)]
    found = cf.field.Spectrum.of_surveys(drawn)
    np.testing.assert_array_equal(found.p, LAW.p)
    np.testing.assert_allclose(found.median, LAW.median, rtol=0.08)
    np.testing.assert_allclose(found.high / found.median, 2.0, rtol=0.05)


def survey(path, draw, quantity="radius_mm"):
    """Radii on three rings of a casing of the law."""
    theta, z = np.meshgrid(np.linspace(0.0, 360.0, 72, endpoint=False), [10.0, 100.0, 190.0])
    shape = cf.field.RandomField(spectrum=LAW, seed=1, draw=draw).fit
    radius = 500.0 * (1.0 + np.asarray(shape.derivatives(np.zeros(theta.shape), np.radians(theta))[0]))
    radius += 2e-3 * np.random.default_rng(draw).standard_normal(radius.shape)
    rows = np.column_stack([theta.ravel(), z.ravel(), radius.ravel()])
    np.savetxt(path, rows, delimiter=",", header=f"theta_deg,z_mm,{quantity}", comments="", fmt="%.6f")


def test_a_study_takes_the_spectrum_from_surveys_and_names_a_file_that_is_not_there(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    survey(tmp_path / "one.csv", 0)
    with pytest.raises(cf.errors.InputError, match=r"two\.csv"):
        cf.load_study(path)
    survey(tmp_path / "two.csv", 1)
    study = cf.load_study(path)
    field = study.structure.radius_defect
    fits = [cf.field.RandomField(spectrum=LAW, seed=1, draw=k).fit for k in (0, 1)]
    expected = cf.field.Spectrum.of_surveys(fits, p_max=12)
    np.testing.assert_allclose(field.spectrum.median, expected.median, rtol=0.02)
    np.testing.assert_allclose(field.spectrum.high, expected.high, rtol=0.05)
    before = study.source["sha256"]
    survey(tmp_path / "two.csv", 2)
    assert cf.load_study(path).source["sha256"] != before


def test_too_few_amplitudes_are_refused():
    with pytest.raises(cf.errors.ModelError, match="found 2 amplitudes above zero"):
        cf.field.Spectrum.of_surveys([cf.FourierField.of({1: 0.1, 2: 0.01, 3: 0.005})])
