"""The whole chain, small; and the generator of its synthetic records."""

import re

import numpy as np
import pytest

import casingfem as cf
import contact as ct
from reports.studies.rig import chain as rig
from reports.studies.rig import rub, tuning
from reports.studies.rig import synthetic as rig_synthetic
from reports.tables import DATA
from reports.verification.rubs import bases


@pytest.fixture(scope="module")
def chain(tmp_path_factory):
    out = tmp_path_factory.mktemp("rig")
    return out, rig.main(out, quick=True)


@pytest.mark.campaign
def test_the_chain_ends_in_a_report_that_is_alone(chain):
    out, _ = chain
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "SYNTHETIC" in page
    page = re.sub(r"base64,[A-Za-z0-9+/=]+", "", page)  # pictures, in which any word may be
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


def test_band_in_which_n_leads_is_that_of_a_weak_coincidence():
    """Two poles that meet over a stiff contact: half width 2 sqrt(a b)/S of `contact.stability.coincidence`."""
    n, still, speed, S = 4, 300.0, 5.0, 3e-6
    casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=n, freq_hz=still, modal_mass=2.0, zeta=1e-3), radius=0.45)
    blade = ct.ModalBody(
        omega=2 * np.pi * np.array([280.0]), zeta=np.full(1, 1e-3), channels=("span", "flap"),
        rows=np.array([[0.0], [2.0]]), S=S * np.eye(2),
    )  # fmt: skip
    plan = tuning.RubPlan(
        n=n, speed_hz=speed, into_band=0.2, t_end=1.0, dt=1e-5, friction=0.3, lean_deg=10.0, advance=1e-5
    )  # fmt: skip
    low, high = tuning.band_of_n(casing, blade, plan, still - n * speed)
    turn = 2 * np.pi
    press, push = (np.sin(np.radians(10.0)) * 2.0, (np.sin(np.radians(10.0)) - 0.3 * np.cos(np.radians(10.0))) * 2.0)
    a = 1.0 / (2.0 * 2.0 * 2.0 * turn * still)  # of the wave: 1/(4 m w)
    b = -press * push / (2.0 * turn * 280.0)
    assert high - low == pytest.approx(4.0 * np.sqrt(a * b) / S / turn, rel=0.07)  # damping narrows it
    inside, outside = (
        tuning.leading(casing, blade, plan, 0.5 * (low + high)),
        tuning.leading(casing, blade, plan, high + 0.1),
    )
    assert inside.of_n
    assert not outside.of_n


def test_tuning_is_refused_where_friction_lets_nothing_grow():
    casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=4, freq_hz=300.0, modal_mass=2.0, zeta=1e-3), radius=0.45)
    blade = ct.ModalBody(
        omega=np.array([1760.0]), zeta=np.full(1, 1e-3), channels=("span", "flap"), rows=np.array([[0.0], [2.0]]),
        S=3e-6 * np.eye(2),
    )  # fmt: skip
    plan = tuning.RubPlan(
        n=4, speed_hz=5.0, into_band=0.2, t_end=1.0, dt=1e-5, friction=0.1, lean_deg=10.0, advance=1e-5
    )  # fmt: skip
    with pytest.raises(ValueError, match="found no blade frequency"):
        tuning.band_of_n(casing, blade, plan, 280.0)


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
    terms = cf.modal.out_of_roundness(casing, cf.Rim("top", n_max=8))
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
