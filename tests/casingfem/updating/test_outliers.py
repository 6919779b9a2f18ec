"""Wrong rows of a table: named with what is wrong with them, set aside, and the fit as without them."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.correlation.pairing import member_of
from casingfem.plot.pages.fit import update_verdict, update_words
from casingfem.updating import updating
from casingfem.updating.outliers import Outlier, Shift, named, outlying, shifts_of, strongest
from casingfem.updating.problem import Problem
from casingfem.updating.targets import values
from reports.verification.updating import wrong_rows
from reports.verification.updating.twin import measured
from tests.casingfem.updating.test_update_judged import blade, table, vary

COLUMNS = np.column_stack([np.ones(24), np.linspace(-1.0, 1.0, 24)])


def shifts():
    """A frequency of its own for each of 24 residuals."""
    return [Shift("frequency", (k,), -np.eye(24)[k]) for k in range(24)]


@pytest.mark.parametrize("wrong", [{}, {3: 8.0}, {3: 8.0, 4: 7.0}, {0: 15.0, 1: 15.0, 23: -15.0}])
def test_shifts_of_a_straight_line_are_found_with_their_sizes(wrong):
    """Also where they mask each other: two at one end, one at the other."""
    residual = np.random.default_rng(3).standard_normal(24)
    for k, size in wrong.items():
        residual[k] -= size  # measured too high
    found = outlying(shifts(), residual, COLUMNS, 24)
    assert [one.rows[0] for one in found] == sorted(wrong)
    for one in found:
        assert one.shift == pytest.approx(wrong[one.rows[0]], abs=3.5)
        assert one.deviation > 4.0


@pytest.mark.campaign
@pytest.mark.slow
def test_clean_tables_give_few_alarms():
    """One in a hundred by LEVEL; of 400 lines, fewer than 5 %, whatever the scatter is called."""
    rng = np.random.default_rng(5)
    for scale in (0.2, 1.0, 6.0):
        alarms = [bool(outlying(shifts(), scale * rng.standard_normal(24), COLUMNS, 24)) for _ in range(400)]
        assert np.mean(alarms) <= 0.05, scale


def test_the_worst_is_what_a_change_alone_explains_not_the_largest_residual():
    """A point at the end bends the line: its own residual is smaller than what it is off by."""
    residual = np.zeros(24)
    residual[0] = -10.0
    fitted = residual - COLUMNS @ np.linalg.lstsq(COLUMNS, residual, rcond=None)[0]
    assert strongest(shifts(), fitted, COLUMNS).rows == (0,)


def test_changes_that_the_residuals_do_not_feel_make_no_wrong_row_less_significant():
    residual = np.zeros(24)
    residual[12] = -5.0
    found = outlying(shifts(), residual, COLUMNS, 24)
    unfelt = [Shift("orientation", (k,), np.zeros(24)) for k in range(1000)]
    assert [one.rows for one in found] == [(12,)]
    assert outlying([*shifts(), *unfelt], residual, COLUMNS, 24) == found


def test_a_shift_is_what_was_added_to_the_table_and_named_in_its_own_unit():
    """A single row by +2 Hz, a split by -0.4 Hz, an orientation by +3 deg, each alone; without rings a phase is 0."""
    modes = SimpleNamespace(freq=np.array([100.0, 300.0, 302.0]), rings=None)
    matches = [SimpleNamespace(rows=(0,), modes=(0,), n=-1), SimpleNamespace(rows=(1, 2), modes=(1, 2), n=4)]
    for kind, by, angle, relative in (
        ("frequency", [2.0, 0.0, 0.0], 0.0, 2.0 / 102.0),
        ("split", [0.0, 0.2, -0.2], 0.0, -0.4 / 300.2),
        ("orientation", [0.0, 0.0, 0.0], 0.3, 0.3),
    ):
        table = cf.FrequencyTable.from_arrays(
            mode=[5, 6, 9], freq_hz=modes.freq + by, sigma_hz=0.1, n=[-1, 4, 4], angle_deg=[np.nan, angle, np.nan]
        )
        shifts = shifts_of(modes, table, matches)
        assert [one.kind for one in shifts] == ["frequency", "frequency", "frequency", "split", "orientation"]
        (told,) = named([strongest(shifts, values(modes, table, matches), np.zeros((4, 1)))], table)
        assert (told.kind, told.modes) == (kind, (5,) if kind == "frequency" else (6, 9))
        assert told.shift == pytest.approx(relative, rel=2e-3)


def test_an_outlier_is_one_sentence():
    one = Outlier(modes=(5,), n=0, kind="frequency", shift=-0.0412, deviation=23.46)
    assert repr(one) == "row 5, n = 0: 4.1 % from what the other rows predict (23.5 sigma)"
    split = Outlier(modes=(3, 4), n=-1, kind="split", shift=0.0023, deviation=5.0)
    assert repr(split) == "rows 3 and 4: 0.23 % in split from what the other rows predict (5.0 sigma)"
    turned = replace(split, n=8, kind="orientation", shift=-3.21)
    assert repr(turned) == "rows 3 and 4, n = 8: 3.21 deg in orientation from what the other rows predict (5.0 sigma)"


@pytest.fixture(scope="module")
def spoilt():
    """A table whose fifth row is 4 % off, and its fit."""
    right = table(1e-4)
    freq = right.freq_hz.copy()
    freq[4] *= 1.04
    return right, cf.update(blade(), replace(right, freq_hz=freq), vary("material.E"))


@pytest.mark.slow
def test_a_wrong_row_is_named_and_set_aside(spoilt):
    right, fit = spoilt
    reference = cf.update(blade(), right, vary("material.E"), outliers="keep")
    (row,) = fit.outliers
    assert (row.modes, row.kind) == ((5,), "frequency")
    assert row.shift == pytest.approx(0.04, abs=0.002)
    assert abs(fit.x - reference.x)[0] < 3.0 * reference.stated_sigma[0]
    assert abs(fit.plain.x - reference.x)[0] > 3.0 * reference.stated_sigma[0]
    text = repr(fit)
    assert "set aside: row 5" in text
    assert "% from what the other rows predict" in text
    assert f"without: material.E = {fit.value[0]:.5g} (with it {fit.plain.value[0]:.5g})" in text
    document = json.loads(json.dumps(fit.to_json()))
    assert document["outliers"][0]["modes"] == [5]
    assert document["with_outliers"] == list(fit.plain.value)


@pytest.mark.slow
def test_the_page_counts_rows_of_the_measured_table_and_names_the_row_that_was_set_aside(spoilt):
    _, fit = spoilt
    whole = len(fit.plain.table)
    counted = f"{whole - 1} of {whole} measured rows (1 set aside)"
    assert counted in update_words(fit)[0]
    verdict = update_verdict(fit)
    assert counted in verdict.found
    assert "Check mode 5 of the table: set aside" in verdict.further
    assert f"{whole} of {whole} measured rows, with" in update_words(fit.plain)[0]


@pytest.mark.slow
def test_a_step_without_a_wrong_row_to_where_there_is_no_structure_is_shortened(spoilt, monkeypatch):
    """Springs that two harmonics make negative together, say, each within its bounds; here E above 230 GPa."""
    structure, refused = Problem.structure, []

    def stiff(problem, x):
        if x[0] > 230e9:
            refused.append(x[0])
            raise cf.errors.ModelError("springs-negative", f"E = {x[0]:.4g}")
        return structure(problem, x)

    monkeypatch.setattr(Problem, "structure", stiff)
    monkeypatch.setattr(updating, "step_without", lambda *_: np.array([1e12]))
    fit = cf.update(blade(), spoilt[1].plain.table, vary("material.E"))
    assert refused[0] == 250e9
    assert [one.modes for one in fit.outliers] == [(5,)]
    assert fit.value == pytest.approx(spoilt[1].value, rel=1e-6)


@pytest.mark.slow
def test_all_rows_are_kept_where_that_is_asked(spoilt):
    right, fit = spoilt
    kept = cf.update(blade(), fit.plain.table, vary("material.E"), outliers="keep")
    assert kept.outliers == ()
    assert len(kept.table) == len(right)
    assert kept.worst()[0] == 5
    assert "worst is row 5" in repr(kept)
    with pytest.raises(cf.errors.InputError, match="outliers: found 'drop'"):
        cf.update(blade(), right, vary("material.E"), outliers="drop")


@pytest.mark.slow
def test_sigma_grows_with_a_misfit_and_a_misfit_too_small_is_called_so():
    loose = cf.update(blade(), table(0.01), vary("material.E"))
    assert loose.inflation == loose.misfit > 1.5
    assert loose.sigma[0] == pytest.approx(loose.misfit * loose.stated_sigma[0])
    assert "times what the stated ones give" in repr(loose)
    exact = cf.update(blade(), table(), vary("material.E", "material.nu", "shell.thickness"))
    assert exact.inflation == 1.0
    assert exact.overstated
    assert "agree far better than their stated sigma" in repr(exact)


@pytest.mark.campaign
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
def test_a_wrong_row_that_stands_for_another_mode_nearby_is_named():
    """Row 3, n = 7, 2.6 % high lies beside the pair n = 8: paired anew it contradicts nobody, as it was fitted all."""
    draw = wrong_rows.drawn(measured(wrong_rows.ROWS, wrong_rows.MESH), 42, 1)
    assert (draw.wrong, draw.found, draw.alarms) == (1, 1, 0)
    assert draw.distance < 3.0


@pytest.mark.campaign
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
def test_a_wrong_row_that_lies_at_the_other_member_of_its_pair_is_named():
    """Row 4, n = 8, 2.7 % low lies at the other member of its pair, whose angle is not its own."""
    draw = wrong_rows.drawn(measured(wrong_rows.ROWS, wrong_rows.MESH), 180, 1)
    assert (draw.wrong, draw.found, draw.alarms) == (1, 1, 0)
    assert draw.distance_clean < 3.0


@pytest.mark.parametrize(
    ("angle", "split", "member"),
    [(2.0, 8.0, 1), (20.0, 8.0, 1), (12.0, 8.0, 0), (np.nan, 8.0, 0), (2.0, 0.5, 0), (6.0, 8.0, 0)],
)
def test_the_member_that_a_single_row_stands_for(angle, split, member):
    """n = 8, members at 11.25 and 22.5 = 0 deg; by frequency the lower, its angle decides if split and angle allow."""
    modes = SimpleNamespace(
        freq=np.array([320.0, 320.0 + split]), angle_deg=np.array([11.25, 0.0]),
        nodal_diameters=np.array([8, 8]), doublets=((0, 1),),
    )  # fmt: skip
    row = cf.FrequencyTable.from_arrays(n=[8], freq_hz=[319.9], sigma_hz=0.1, angle_deg=[angle])
    assert member_of((0, 1), modes, row, 0) == member
    assert cf.correlation.pair(modes, row).matches[0].modes == (member,)
