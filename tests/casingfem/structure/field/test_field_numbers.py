"""Numbers held: series, splines, spectra, random fields, surveys with noise, stray points, an axis that is off."""

import numpy as np
import pytest

import casingfem as cf

Z, THETA = (x.ravel() for x in np.meshgrid(np.linspace(0.0, 0.25, 5), np.linspace(0.0, 6.0, 7)))
DEFECT = cf.FourierField(
    p=np.array([2, 8, 20]),
    cos=np.array([[1e-3, 2e-4], [4e-3, 0.0], [3e-3, -1e-4]]),
    sin=np.array([[5e-4, 0.0], [0.0, 3e-4], [0.0, 0.0]]),
    z_mid=0.125,
    z_half=0.125,
)


def jets(field):
    """Values and derivatives on a lattice."""
    return {name: part for name, part in zip("vztpqr", field.derivatives(Z, THETA), strict=False)}


def test_numbers_of_series(held):
    spline = cf.field.Spline(z_low=0.0, z_high=0.25, intervals=3)
    rng = np.random.default_rng(2)
    shape = (2, 6)
    splined = cf.FourierField(
        p=np.array([3, 5]), cos=1e-3 * rng.standard_normal(shape), sin=1e-3 * rng.standard_normal(shape), spline=spline
    )
    held(1e-8, **{f"a{k}": v for k, v in jets(DEFECT).items()}, **{f"b{k}": v for k, v in jets(splined).items()})


def test_numbers_of_random_fields(held):
    spectrum = cf.field.Spectrum.between({2: 0.01, 8: 0.003}, {2: 0.02, 8: 0.006})
    drawn = [cf.field.RandomField(spectrum=spectrum, seed=5, draw=draw) for draw in (0, 1)]
    example = cf.field.RandomField.example(thickness=3e-3, radius=0.475, seed=7, p_max=12)
    fits = [*drawn, example]
    held(
        1e-8,
        median=spectrum.median,
        high=spectrum.high,
        **{f"{k}{name}": v for k, f in enumerate(fits) for name, v in jets(f).items()},
    )


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
@pytest.mark.parametrize("trouble", ["noise", "stray", "off its axis"])
def test_numbers_of_surveys(trouble, held):
    theta, z = np.radians(np.arange(72) * 5.0), np.array([0.0, 0.0625, 0.125, 0.25])
    z, theta = (x.ravel() for x in np.meshgrid(z, theta, indexing="ij"))
    radius = (0.5 - 0.2 * z) * (1.0 + DEFECT.derivatives(z, theta).value)
    rng = np.random.default_rng(8)
    radius = radius + 2e-5 * rng.standard_normal(radius.size)
    if trouble == "stray":
        radius[[17, 118]] += 5e-3
    if trouble == "off its axis":
        radius = radius + 1e-3 * np.cos(theta - 0.4)
    survey = cf.SurveyField.from_points(theta, z, radius)
    held(
        1e-5,
        **jets(survey),
        mean=survey.mean,
        rms=[survey.residual_rms, survey.coverage_deg, survey.n_resolved, survey.max_harmonic],
        range=survey.z_range,
    )
