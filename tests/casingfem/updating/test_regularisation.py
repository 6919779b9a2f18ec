"""How strongly parameters are held: who is, where an L-curve turns, which weight noise allows."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.updating.identifiability import Identifiability, identifiability, widths
from casingfem.updating.regularisation import WEIGHTS, chosen_weight, corner, is_harmonic, trade_off
from casingfem.updating.updating import MOST_MODES, mode_count, require_few
from tests.casingfem.updating.test_update_judged import blade, table, vary

VARY = [
    cf.Parameter(name="material.E", lower=1e9, upper=3e9),
    cf.Parameter(name="radius.p8.cos", lower=-0.1, upper=0.5),
    cf.Parameter(name="support.base.k_face", lower=1e3, upper=1e9, log=True),
    cf.Parameter(name="support.base.around.p12.sin", lower=-1.0, upper=1.0, sigma=0.25),
]


def test_a_width_is_the_prior_or_that_of_anywhere_between_the_bounds():
    """A number anywhere on a length L has the standard deviation L/sqrt 12; of a log parameter in decades."""
    root = np.sqrt(12.0)
    np.testing.assert_allclose(widths(VARY), [2e9 / root, 0.6 / root, 6.0 / root, 0.25], rtol=1e-12)


def test_harmonics_are_held_unless_others_are_named():
    root = np.sqrt(12.0)
    np.testing.assert_allclose(cf.updating.Regularisation().among(VARY), [0.0, root / 0.6, 0.0, 4.0], rtol=1e-12)
    named = cf.updating.Regularisation(names=("material.E", "support.base.k_face"))
    np.testing.assert_allclose(named.among(VARY), [root / 2e9, 0.0, root / 6.0, 0.0], rtol=1e-12)
    assert [is_harmonic(name) for name in ("radius.p8.cos", "pitch.E", "chart.p8x", "chart.xp8")] == [True] + [
        False
    ] * 3


@pytest.mark.parametrize("at", [60, 160, 250])
def test_an_l_curve_turns_where_residuals_begin_to_grow_and_the_solution_to_shrink(at):
    """log |r| = log(1 + w/w0), log |x| = log(1 + w0/w): a mirror image of itself about w0."""
    w0 = WEIGHTS[at]
    curve = np.column_stack([WEIGHTS, 3.0 * (1.0 + WEIGHTS / w0), 0.01 * (1.0 + w0 / WEIGHTS)])
    assert corner(curve) == w0
    assert chosen_weight("l-curve", curve, 4) == (w0, "l-curve", "")


def test_the_largest_weight_that_noise_allows_is_taken():
    """|r|^2 = m counts as noise. Where |r| falls again further on, what lies between does not matter."""
    curve = np.column_stack([[0.1, 1.0, 2.0, 3.0, 4.0, 5.0], [1.0, 2.0, 2.1, 3.0, 1.9, 4.0], np.ones(6)])
    assert chosen_weight("discrepancy", curve, 4) == (4.0, "discrepancy", "")
    assert chosen_weight("discrepancy", curve[:4], 4) == (1.0, "discrepancy", "")
    assert chosen_weight("discrepancy", curve[:1], 1) == (0.1, "discrepancy", "")


def test_weights_are_forty_a_decade():
    assert WEIGHTS[0] == pytest.approx(1e-4)
    assert WEIGHTS[-1] == pytest.approx(1e4)
    np.testing.assert_allclose(np.diff(np.log10(WEIGHTS)), 1.0 / 40.0, rtol=1e-9)


def test_a_trade_off_leaves_a_parameter_that_nothing_feels():
    """Neither the data nor a prior, nor the regularisation."""
    J = np.array([[1.0, 0.0], [2.0, 0.0]])
    curve = trade_off(J, np.array([1.0, 1.0]), np.array([0.5, 3.0]), np.zeros(2), np.array([2.0, 0.0]))
    w = WEIGHTS[100]
    d = (5.0 * 0.5 - 3.0) / (5.0 + (2.0 * w) ** 2)
    np.testing.assert_allclose(curve[100], [w, np.hypot(0.5 + d, 2.0 * d), abs(2.0 * d)], rtol=1e-9)


def seen(singular, left, directions=((1.0, 0.0), (0.0, 1.0))):
    names = ("material.E", "material.nu")
    return Identifiability(
        names=names, singular=np.array(singular), directions=np.array(directions), left=np.array(left)
    )


def test_directions_above_one_are_determined_and_parameters_above_nine_tenths_are_not_seen():
    found = seen([1.0 + 1e-9, 1.0], [0.9, 0.9 + 1e-9])
    assert found.rank == 1
    assert found.unseen == ("material.nu",)
    assert found.to_json() == {
        "rank": 1, "singular": [1.0 + 1e-9, 1.0], "left": [0.9, 0.9 + 1e-9], "unseen": ["material.nu"],
        "directions": ["+1.00 material.E", "+1.00 material.nu"],
    }  # fmt: skip
    assert found.records() == [
        {"singular": 1.0 + 1e-9, "left_rel": pytest.approx(0.5**0.5), "direction": "+1.00 material.E"},
        {"singular": 1.0, "left_rel": pytest.approx(0.5**0.5), "direction": "+1.00 material.nu"},
    ]


def test_a_direction_names_its_main_parameters_the_largest_first_and_positive():
    """A share of .3 is not named."""
    found = seen([2.0, 1.0], [0.1, 0.1], [[-0.4, 0.3], [0.8, -0.9]])
    assert found.words(0) == "+0.80 material.nu -0.40 material.E"
    assert found.words(1) == "+0.90 material.nu"


def test_fewer_residuals_than_parameters_leave_directions_unseen():
    found = identifiability(VARY[:2], np.array([[3e-9, 4.0]]))
    scaled = np.array([3e-9 * 2e9, 4.0 * 0.6]) / np.sqrt(12.0)
    np.testing.assert_allclose(found.singular, [np.linalg.norm(scaled), 0.0], atol=1e-12)
    square = scaled**2 / np.sum(scaled**2)
    np.testing.assert_allclose(found.left**2, 1.0 - square + square / (1.0 + np.sum(scaled**2)), rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("rule", ["discrepancy", "l-curve"])
def test_a_regularised_update_is_stationary_at_the_weight_that_its_rule_chooses_there(rule):
    """J^T r + w^2 D^-2 (x - x0) = 0 for the one held, which its prior does not hold as well; the other is free."""
    width = 0.5e-3
    free = [
        cf.Parameter(name="material.E", lower=100e9, upper=300e9),
        cf.Parameter(name="shell.thickness", lower=2e-3, upper=4e-3, sigma=width),
    ]
    fit = cf.update(
        blade(),
        table(1e-3),
        free,
        regularise=cf.updating.Regularisation(rule=rule, names=("shell.thickness",)),
        outliers="keep",
    )
    told = fit.regularised
    assert told.names == ("shell.thickness",)
    w = told.weight
    away = fit.x - [206.85e9, 3e-3]
    np.testing.assert_allclose(fit.given.prior, [0.0, w / width], rtol=1e-12)
    pull = np.array([0.0, w**2 / width**2 * away[1]])
    scale = np.linalg.norm(fit.jacobian, axis=0) * np.linalg.norm(fit.values)
    np.testing.assert_allclose((fit.jacobian.T @ fit.values + pull) / scale, 0.0, atol=3e-3)
    curve = trade_off(fit.jacobian, fit.values, away, np.zeros(2), np.array([0.0, 1.0 / width]))
    np.testing.assert_allclose(told.curve, curve, rtol=1e-6)
    chosen, by, note = chosen_weight(rule, curve, 8)
    assert abs(np.log(chosen / w)) < 0.06
    assert (told.rule, told.note) == (by, note)


def test_modes_are_computed_to_15_per_cent_past_the_table_and_four_more():
    """At least as many as there are rows."""
    freq = cf.modes(blade(), 12).freq
    for highest in (freq[3] / 1.1501, freq[3] / 1.1499, 0.5 * freq[0]):
        rows = cf.FrequencyTable.from_arrays(freq_hz=[0.4 * freq[0], 0.45 * freq[0], highest], sigma_hz=1.0)
        below = int(np.count_nonzero(freq < 1.15 * highest))
        assert mode_count(rows, blade(), None) == max(below, 3) + 4


def test_a_row_with_digits_too_many_is_refused_before_the_modes_below_it_are_computed():
    rows = cf.FrequencyTable.from_arrays(freq_hz=[310.0, 350000.0, 320.0], sigma_hz=1.0, mode=[4, 5, 7], path="t.csv")
    words = r"t\.csv, column 'freq_hz', mode 5: found 350000 Hz, the next row 320 Hz: some 501 modes to compute for 3 "
    with pytest.raises(cf.errors.InputError, match=words + "rows; expected rows that at most 500 modes reach"):
        require_few(rows, MOST_MODES + 1)
    require_few(rows, MOST_MODES)
    with pytest.raises(cf.errors.InputError, match=r"found 310 Hz: some 501 modes to compute for 1 rows"):
        require_few(rows.without(5, 7), MOST_MODES + 1)


def test_an_update_asks_for_few_modes_where_their_number_is_not_given(monkeypatch):
    rows = table(rows=3)
    far = rows.freq_hz.copy()
    far[1] *= 30.0
    wrong = cf.FrequencyTable.from_arrays(freq_hz=far, sigma_hz=1.0)
    monkeypatch.setattr("casingfem.updating.updating.MOST_MODES", 20)
    with pytest.raises(cf.errors.InputError, match=r"mode 2: found .* some [0-9]+ modes to compute for 3 rows"):
        cf.update(blade(), wrong, vary("material.E"))
    monkeypatch.setattr("casingfem.updating.updating.FAR", 100)  # as many as so many rows would reach
    monkeypatch.setattr("casingfem.updating.updating.fitted", lambda problem, *_, **__: problem.count)
    assert cf.update(blade(), wrong, vary("material.E"), outliers="keep") > 20


def test_what_an_update_is_not_asked_for_rightly_is_refused_first():
    for more, words in (
        ({"outliers": "drop"}, 'outliers: found \'drop\', expected "set-aside" or "keep"'),
        ({"model_error": 1.0}, r"model_error must lie in \[0, 1\), found 1.0"),
        ({"model_error": -0.1}, r"model_error must lie in \[0, 1\), found -0.1"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            cf.update(blade(), table(rows=3), vary("material.E"), count=7, **more)
    with pytest.raises(cf.errors.InputError, match="vary: name at least one parameter"):
        cf.update(blade(), table(rows=3), [])
