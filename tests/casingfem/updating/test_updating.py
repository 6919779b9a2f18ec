"""Updating: twins with and without noise, bounds, priors, what the data do not determine, refusals."""

import json
from itertools import product

import numpy as np
import pytest

import casingfem as cf

MESH = cf.ShellMesh(order=4, rows=1, around=14)
ROWS = 20
VARY = [
    cf.Parameter(name="material.E", lower=150e9, upper=250e9),
    cf.Parameter(name="shell.thickness", lower=2e-3, upper=4e-3),
    cf.Parameter(name="support.base.k_face", lower=1e11, upper=1e15, log=True),
    cf.Parameter(name="radius.p8.cos", lower=-0.01, upper=0.01),
    cf.Parameter(name="radius.p8.sin", lower=-0.01, upper=0.01),
    cf.Parameter(name="radius.p16.cos", lower=-0.01, upper=0.01),
    cf.Parameter(name="support.base.k_face.p4.cos", lower=-0.9, upper=0.9),
]


def casing(frustum, E=210e9, t=3e-3, k=5e12, c8=0.0005, s8=0.0003, c16=0.0, k4=0.2, mesh=MESH):
    edge = cf.ElasticEdge(k_face=k, around=cf.FourierField.of({4: (k4, 0.0)}))
    return frustum(
        thickness=t,
        material=cf.Material(E=E, nu=0.3, rho=7800.0),
        supports={"base": edge},
        radius_defect=cf.FourierField.of({8: (c8, s8), 16: c16, 3: (0.0005, 0.0003)}),
        mesh=mesh,
    )


def truth(frustum, mesh=MESH):
    return casing(frustum, E=205e9, t=3.05e-3, k=3e12, c8=0.0007, s8=-0.0002, c16=0.0004, k4=0.3, mesh=mesh)


@pytest.fixture(scope="module")
def measured(frustum):
    return cf.modes(truth(frustum), ROWS + 4)


def table_of(found, noise=None, rows=ROWS):
    f = found.freq[:rows]
    return cf.FrequencyTable.from_arrays(
        freq_hz=f if noise is None else f * (1 + 1e-3 * noise[:rows]),
        sigma_hz=1e-3 * f,
        n=found.nodal_diameters[:rows],
        angle_deg=found.angle_deg[:rows],
    )


@pytest.fixture(scope="module")
def exact_fit(frustum, measured):
    seen = []
    fit = cf.update(casing(frustum), table_of(measured), VARY, progress=lambda k, rms: seen.append((k, rms)))
    return fit, seen


def true_values(frustum):
    return np.array([cf.updating.get_value(truth(frustum), p.name) for p in VARY])


# --- twins ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_without_noise_every_parameter_is_recovered_to_1e_5(frustum, exact_fit):
    fit, _ = exact_fit
    np.testing.assert_allclose(fit.value, true_values(frustum), rtol=1e-5)
    assert fit.chi2 < 1e-8
    assert len(fit.history) - 1 <= 12  # steps from the start
    assert not any(fit.at_bound)
    assert fit.rms_after < 1e-7 < 1e-2 < fit.rms_before
    printed = [line.split() for line in repr(fit).partition("confidence\n")[2].splitlines()[:ROWS]]
    told = [[row["mode"], row["n"], row["measured_hz"], row["before_hz"], row["after_hz"]] for row in fit.pairs()]
    np.testing.assert_allclose([[float(cell) for cell in line[:5]] for line in printed], told, atol=6e-4)


@pytest.mark.campaign
def test_without_noise_on_the_default_mesh(frustum):
    known, p = truth(frustum, mesh=None), VARY[4]
    fit = cf.update(cf.updating.with_value(known, p.name, -0.00015), table_of(cf.modes(known, 8), rows=6), [p])
    assert fit.value[0] == pytest.approx(cf.updating.get_value(known, p.name), rel=1e-5)


@pytest.mark.slow
def test_a_fine_mesh_is_fitted_exactly_although_a_coarse_one_was_fitted_first(frustum):
    fine = cf.ShellMesh(order=8, rows=(0.0, 0.03, 0.97, 1.0), around=11)
    table = table_of(cf.modes(truth(frustum, mesh=fine), 4), rows=4)
    known = [(p, cf.updating.get_value(truth(frustum), p.name)) for p in (VARY[0], VARY[6])]
    start = truth(frustum, mesh=fine)
    for p, value in known:
        start = cf.updating.with_value(start, p.name, 1.03 * value)
    fit = cf.update(start, table, [p for p, _ in known])
    np.testing.assert_allclose(fit.value, [value for _, value in known], rtol=1e-6)
    assert fit.seconds["coarse"] > 0.0
    assert fit.structure.mesh == fine


@pytest.mark.campaign
def test_with_noise_every_parameter_is_within_3_sigma(frustum, measured, held):
    noise = np.random.default_rng(101).standard_normal(ROWS)
    fit = cf.update(casing(frustum), table_of(measured, noise), VARY)
    found, true = (
        np.array([p.to_internal(value) for p, value in zip(VARY, values, strict=True)])
        for values in (fit.value, true_values(frustum))
    )
    assert np.abs((found - true) / fit.sigma).max() < 3.0
    assert 0.3 < fit.misfit < 2.0
    held(
        1e-4, small=1.0, value=fit.value, sigma=fit.sigma, stated=fit.stated_sigma, correlation=fit.correlation,
        values=fit.values,
        chi2=[fit.chi2, fit.inflation, fit.misfit, fit.free, fit.residuals, fit.model_floor],
        rms=[fit.rms_before, fit.rms_after],
        singular=fit.identifiability.singular, before=fit.before.freq[:12], after=fit.after.freq[:12],
        jacobian=np.linalg.norm(fit.jacobian, axis=0),
    )  # fmt: skip


@pytest.mark.campaign
def test_start_does_not_matter(frustum, measured, exact_fit):
    other = casing(frustum, E=215e9, t=2.95e-3, k=2e12, c8=0.0008, s8=0.0, c16=0.0002, k4=0.4)
    fit = cf.update(other, table_of(measured), VARY)
    np.testing.assert_allclose(fit.value, exact_fit[0].value, rtol=1e-5)


@pytest.mark.campaign
def test_a_far_start_reaches_the_same_point(frustum, measured, exact_fit):
    """On the way n = 4 and n = 12 mix half and half and a label flips; the mode is followed all the same."""
    other = casing(frustum, E=190e9, t=3.2e-3, k=2e13, c8=0.001, s8=0.0, c16=0.0001, k4=0.1)
    fit = cf.update(other, table_of(measured), VARY)
    np.testing.assert_allclose(fit.value, exact_fit[0].value, rtol=1e-5)


@pytest.mark.slow
def test_a_perfect_start_finds_the_harmonics_of_the_splits(frustum):
    """At zero split f1 and f2 have a cone; mean and split vector do not."""
    mesh = cf.ShellMesh(order=6, rows=1, around=17)
    found = cf.modes(frustum(mesh=mesh, radius_defect=cf.FourierField.of({8: (0.0006, -0.0003)})), 24)
    vary = [cf.Parameter(name=f"radius.p8.{part}", lower=-0.01, upper=0.01) for part in ("cos", "sin")]
    fit = cf.update(frustum(mesh=mesh), table_of(found), vary)
    np.testing.assert_allclose(fit.value, [0.0006, -0.0003], rtol=1e-5)


@pytest.mark.slow
def test_two_updates_agree_bit_by_bit(frustum, measured):
    start = cf.updating.with_value(truth(frustum, mesh=cf.ShellMesh(order=3, rows=1, around=14)), "material.E", 207e9)
    fits = [cf.update(start, table_of(measured, rows=6), [VARY[0], VARY[3]], outliers="keep") for _ in range(2)]
    assert fits[0].value == fits[1].value
    assert fits[0].covariance.tobytes() == fits[1].covariance.tobytes()


# --- bounds and priors ----------------------------------------------------------------------------------------


def blade(E=206.85e9, t=3e-3):
    return cf.Shell(
        chart=cf.Panel(radius=0.6, length=0.3, angle=0.5), thickness=t, material=cf.Material(E=E, nu=0.3, rho=7857.0),
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=6, rows=1, around=1),
    )  # fmt: skip


def blade_table(E=200e9, t=3e-3, rows=5, sigma=1e-3):
    f = cf.modes(blade(E, t), rows).freq
    return cf.FrequencyTable.from_arrays(freq_hz=f, sigma_hz=sigma * f)


@pytest.mark.slow
def test_an_open_shell_updates_by_order(frustum):
    fit = cf.update(blade(), blade_table(), [cf.Parameter(name="material.E", lower=150e9, upper=250e9)])
    assert fit.value[0] == pytest.approx(200e9, rel=1e-8)
    # f^2 ~ E: five rows of 0.1 % give sigma_E = 2 E 1e-3/sqrt(5)
    assert fit.sigma[0] == pytest.approx(2 * 200e9 * 1e-3 / np.sqrt(5), rel=1e-6)


@pytest.mark.campaign
def test_covariance_shows_the_scatter_of_many_fits():
    """Thirty draws: 60 deviations with unit variance. Those of doublets are in the twin's report."""
    f, random = cf.modes(blade(200e9, 3.02e-3), 6).freq, np.random.default_rng(401)
    vary = [
        cf.Parameter(name="material.E", lower=150e9, upper=250e9),
        cf.Parameter(name="material.nu", lower=0.2, upper=0.4),
    ]
    z = []
    for _ in range(30):
        noise = random.standard_normal(f.size)
        table = cf.FrequencyTable.from_arrays(freq_hz=np.sort(f * (1.0 + 1e-3 * noise)), sigma_hz=1e-3 * f)
        fit = cf.update(blade(t=3.02e-3), table, vary)
        z.append((np.array(fit.value) - [200e9, 0.3]) / fit.sigma)
    assert 0.7 < np.sqrt(np.mean(np.square(z))) < 1.3  # chi^2 with 60: .999 of all lie within
    assert np.abs(z).max() < 3.5


@pytest.mark.slow
def test_a_bound_in_the_way_is_met_and_reported():
    fit = cf.update(blade(), blade_table(), [cf.Parameter(name="material.E", lower=204e9, upper=250e9)])
    assert fit.value[0] == pytest.approx(204e9, rel=1e-6)
    assert fit.at_bound == (True,)
    assert "AT BOUND" in repr(fit)


@pytest.mark.slow
def test_a_prior_and_the_data_share_by_their_weights():
    """Linear in E to first order: the fit lies where both pulls balance."""
    sigma_data = 2 * 200e9 * 1e-3 / np.sqrt(5)
    vary = [cf.Parameter(name="material.E", lower=150e9, upper=250e9, sigma=sigma_data)]
    start = 200e9 * 1.004
    fit = cf.update(blade(E=start), blade_table(), vary)
    assert fit.value[0] == pytest.approx(0.5 * (start + 200e9), rel=1e-5)
    assert fit.sigma[0] == pytest.approx(sigma_data / np.sqrt(2), rel=1e-2)
    assert fit.prior_only == (False,)


@pytest.mark.slow
def test_a_prior_that_knows_more_than_the_data_is_named():
    vary = [cf.Parameter(name="material.E", lower=150e9, upper=250e9, sigma=1e5)]
    fit = cf.update(blade(), blade_table(), vary)
    assert fit.value[0] == pytest.approx(206.85e9, rel=1e-5)
    assert fit.prior_only == (True,)
    assert "only its prior determines it" in repr(fit)


@pytest.mark.slow
def test_parameters_that_do_the_same_are_named():
    """E and 1/rho: only their ratio matters."""
    vary = [
        cf.Parameter(name="material.E", lower=150e9, upper=250e9, sigma=10e9),
        cf.Parameter(name="material.rho", lower=7000.0, upper=9000.0, sigma=300.0),
    ]
    fit = cf.update(blade(), blade_table(), vary)
    assert [(a, b) for a, b, _ in fit.indistinct()] == [("material.rho", "material.E")]
    assert fit.correlation[0, 1] > 0.95
    assert "cannot separate" in repr(fit)
    assert fit.value[0] / fit.value[1] == pytest.approx(200e9 / 7857.0, rel=1e-4)


# --- what a result tells --------------------------------------------------------------------------------------


@pytest.mark.slow
def test_result_shows_before_after_and_how(exact_fit):
    fit, seen = exact_fit
    assert [k for k, _ in seen] == list(range(1, len(fit.history) + 1))
    assert tuple(rms for _, rms in seen) == fit.history
    data = json.loads(json.dumps(fit.to_json()))
    assert [p["name"] for p in data["parameters"]] == [p.name for p in VARY]
    assert len(data["pairs"]) == ROWS
    assert data["pairs"][0].keys() == {
        "mode", "n", "measured_hz", "sigma_hz", "confidence",
        "before_hz", "after_hz", "error_before_rel", "error_after_rel",
    }  # fmt: skip
    for pair, side in product(data["pairs"], ("before", "after")):
        assert pair[f"error_{side}_rel"] == pytest.approx(pair[f"{side}_hz"] / pair["measured_hz"] - 1.0, abs=1e-15)
    assert data["iterations"] == len(fit.history)
    text = repr(fit).splitlines()
    assert text[0].split() == ["parameter", "unit", "start", "value", "sigma", "sigma", "in"]
    assert len([line for line in text if line.lstrip()[:1].isdigit()]) == ROWS
    assert any("cannot separate" in line for line in text)  # E and thickness
    np.testing.assert_allclose(np.diag(fit.correlation), 1.0, rtol=1e-12)


@pytest.mark.slow
def test_rows_that_pair_with_nothing_are_named(frustum, measured):
    absurd = cf.FrequencyTable.from_arrays(
        freq_hz=[*measured.freq[:6], 10.0], sigma_hz=0.3, n=[*measured.nodal_diameters[:6], 7]
    )
    fit = cf.update(truth(frustum), absurd, VARY[:2])
    assert fit.unpaired == (7,)
    assert "no mode pairs with table modes 7" in repr(fit)
    assert fit.to_json()["unpaired"] == [7]


@pytest.mark.slow
def test_rows_that_begin_to_pair_do_not_stop_the_solver(frustum, measured):
    """The start lies so far off that some rows are out of reach; they come within it on the way."""
    labels = measured.nodal_diameters[:6]
    table = cf.FrequencyTable.from_arrays(freq_hz=measured.freq[:6], sigma_hz=0.3, n=labels)
    start = cf.updating.with_value(truth(frustum), "material.E", 150e9)
    vary = [cf.Parameter(name="material.E", lower=100e9, upper=300e9)]
    off = 1.0 - np.sqrt(150.0 / 205.0)
    fit = cf.update(start, table, vary, reach=off + 0.02)
    np.testing.assert_allclose(fit.value, [205e9], rtol=1e-6)
    assert fit.unpaired == ()


def test_one_number_by_two_names_is_refused(frustum, measured):
    vary = [cf.Parameter(name=f"support.base.{k}.p4.cos", lower=-0.5, upper=0.5) for k in ("k_face", "around")]
    with pytest.raises(cf.errors.InputError, match=r"support\.base\.k_face\.p4\.cos, which changes the same number"):
        cf.update(truth(frustum), table_of(measured), vary)


def test_bounds_that_reach_an_impossible_structure_are_refused(frustum, measured):
    with pytest.raises(cf.errors.InputError, match=r"material\.nu: upper = 0\.7 is not possible"):
        cf.update(truth(frustum), table_of(measured), [cf.Parameter(name="material.nu", lower=0.1, upper=0.7)])


@pytest.mark.slow
def test_a_table_without_labels_still_pairs(frustum, measured):
    bare = cf.FrequencyTable.from_arrays(freq_hz=measured.freq[:ROWS], sigma_hz=1e-3 * measured.freq[:ROWS])
    fit = cf.update(truth(frustum), bare, VARY[:2])
    np.testing.assert_allclose(fit.value, [205e9, 3.05e-3], rtol=1e-6)


# --- refusals -------------------------------------------------------------------------------------------------


def test_refuses_a_table_that_nothing_pairs_with():
    far = cf.FrequencyTable.from_arrays(freq_hz=[1e5, 1.1e5], sigma_hz=10.0)
    with pytest.raises(cf.errors.InputError, match="no row of table pairs with a computed mode within 50%"):
        cf.update(blade(), far, VARY[:1], count=4)


def test_refuses_fewer_residuals_than_parameters():
    bounds = {"material.E": (1e9, 1e12), "shell.thickness": (1e-4, 1e-2), "material.rho": (1e2, 1e5)}
    vary = [cf.Parameter(name=name, lower=low, upper=high) for name, (low, high) in bounds.items()]
    with pytest.raises(cf.errors.InputError, match="2 residuals for 3 parameters"):
        cf.update(blade(), blade_table(rows=2), vary)


@pytest.mark.slow
def test_refuses_a_structure_that_floats(frustum):
    table = cf.FrequencyTable.from_arrays(freq_hz=[8.0, 22.0], sigma_hz=0.1, n=[2, 3])
    with pytest.raises(cf.errors.InputError, match="6 rigid-body"):
        cf.update(frustum(supports={}, mesh=MESH), table, VARY[:1])


def test_refuses_nothing_to_vary():
    with pytest.raises(cf.errors.InputError, match="at least one"):
        cf.update(blade(), blade_table(), [])


@pytest.mark.parametrize("part", [-1e-9, 1.0, float("nan")])
def test_refuses_a_model_error_that_is_no_part(part):
    with pytest.raises(cf.errors.InputError, match=rf"model_error must lie in \[0, 1\), found {part!r}"):
        cf.update(blade(), blade_table(), VARY[:1], model_error=part)


def test_a_model_error_as_large_as_a_frequency_is_named():
    words = r"model_error: found 0.9999999999999999, with which sigma_hz of row 1 becomes [\d.]+ Hz, at "
    with pytest.raises(cf.errors.InputError, match=words):
        cf.update(blade(), blade_table(), VARY[:1], model_error=0.9999999999999999)


def test_refuses_a_parameter_named_twice():
    with pytest.raises(cf.errors.InputError, match=r"material\.E: found this parameter a second time"):
        cf.update(blade(), blade_table(), [VARY[0], VARY[1], VARY[0]])


def test_refuses_a_start_outside_its_bounds():
    with pytest.raises(
        cf.errors.InputError, match=r"material\.E: found the value 2\.0685e\+11 .* bounds, 2\.2e\+11 to 2\.5e\+11"
    ):
        cf.update(blade(), blade_table(), [cf.Parameter(name="material.E", lower=220e9, upper=250e9)])


def test_refuses_a_parameter_the_structure_does_not_have():
    with pytest.raises(cf.errors.InputError, match="found Clamped"):
        cf.update(blade(), blade_table(), [cf.Parameter(name="support.root.k_face", lower=1.0, upper=2.0)])
