"""The whole chain, small; and the generator of its synthetic records."""

import re

import numpy as np
import pytest

import casingfem as cf
import contact as ct
from reports.rig import chain as rig
from reports.rig import rub
from reports.rig import synthetic as rig_synthetic
from reports.rub import bases
from reports.tables import DATA


@pytest.fixture(scope="module")
def chain(tmp_path_factory):
    out = tmp_path_factory.mktemp("rig")
    return out, rig.main(out, quick=True)


@pytest.mark.campaign
def test_the_chain_ends_in_a_report_that_stands_alone(chain):
    out, _ = chain
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "SYNTHETIC" in page
    page = re.sub(r"base64,[A-Za-z0-9+/=]+", "", page)  # pictures, in which any word may stand
    assert "http" not in page.replace("http://www.w3.org", "").replace("https://www.w3.org", "").replace(
        "http://purl.org", ""
    ).replace("http://creativecommons.org", "")
    for title in ("The measured blade", "The casing", "Reduction", "Rub, as built", "Rub, defect machined away"):
        assert title in page


@pytest.mark.campaign
def test_the_rubs_are_scenes_that_the_command_line_runs(chain):
    out, _ = chain
    scene = ct.load_scene(out / "rub_as_built.toml")
    result = ct.run(scene)
    assert len(result.intervals[0]) >= 1
    assert result.residual[0] < 1e-15
    assert len(scene.what.out_of_roundness) == 26


@pytest.mark.campaign
def test_updating_closes_most_of_the_gap_that_it_can(chain):
    _, figures = chain
    assert figures["blade_rms_before"] == pytest.approx(0.0253, abs=0.0005)
    assert figures["blade_rms_after"] < 0.02
    assert figures["casing_rms_before"] > 0.008
    assert figures["casing_rms_after"] < 0.001


def test_the_survey_in_the_repository_is_the_one_the_generator_makes():
    rng = np.random.default_rng(rig_synthetic.SEED)
    lines = rig_synthetic.survey_lines(rig_synthetic.true_radius(rng), rng)
    assert (DATA / "surveys" / "rig_casing.csv").read_text(encoding="utf-8").splitlines() == lines
    assert lines[0].startswith("# SYNTHETIC")


def test_the_survey_stays_below_one_per_cent():
    field = cf.SurveyField.from_csv(DATA / "surveys" / "rig_casing.csv", n_max=26, degree=2)
    z, theta = np.linspace(0.0, 0.25, 5)[:, None], np.linspace(0.0, 6.28, 400)[None, :]
    assert np.abs(field.derivatives(z, theta).value).max() < 0.01


def test_noise_on_a_doublet_has_the_stated_spread():
    rng = np.random.default_rng(515)
    f = np.array([400.0, 402.0])
    drawn = [rig_synthetic.measured_pair(f, 8, 5.0, rng) for _ in range(4000)]
    means = np.array([pair.mean() for pair, _ in drawn])
    sigma = rig_synthetic.FREQ_SIGMA * 401.0
    assert means.std() == pytest.approx(sigma / np.sqrt(2.0), rel=0.05)
    low = np.array([angle[0] for _, angle in drawn])
    assert np.median(low) == pytest.approx(5.0, abs=0.1)


def test_out_of_roundness_is_the_radius_field_at_the_rim():
    field = cf.FourierField.of({2: (4e-4, 1e-4), 5: -1e-4})
    steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    casing = cf.Shell(chart=rig_synthetic.CHART, thickness=3e-3, material=steel, radius_defect=field)
    terms = cf.out_of_roundness(casing, cf.Rim("top", n_max=8))
    theta = np.linspace(0.0, 6.0, 50)
    np.testing.assert_allclose(rub.deviation(terms, theta), 0.45 * field.derivatives(0.25, theta).value, atol=1e-15)


@pytest.mark.campaign
def test_a_basis_without_residual_compliance_is_the_wrong_one(tmp_path):
    rows = {str(row["basis"]): row for row in bases.main(tmp_path, quick=True)}
    poor = rows["free, n <= 20, 1 order, without S"]
    good = rows["free, n <= 20, 1 order, with S"]
    assert float(str(poor["impulse error"])) > 0.5
    assert float(str(good["impulse error"])) < 2e-3
    assert float(str(good["tip error"])) < 0.02
