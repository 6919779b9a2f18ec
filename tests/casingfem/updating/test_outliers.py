"""Wrong rows of a table: named with what is wrong with them, set aside, and the fit as without them."""

import json
from dataclasses import replace

import pytest

import casingfem as cf
from reports.verification.updating import wrong_rows
from reports.verification.updating.twin import measured
from tests.casingfem.updating.test_update_judged import blade, table, vary
from tests.probed import numbers_of_result


@pytest.fixture(scope="module")
def spoilt():
    """A table whose fifth row is 4 % off, and its fit."""
    right = table(1e-4)
    freq = right.freq_hz.copy()
    freq[4] *= 1.04
    return right, cf.update(blade(), replace(right, freq_hz=freq), vary("material.E"))


@pytest.mark.slow
def test_a_wrong_row_is_named_and_set_aside(spoilt, held):
    right, fit = spoilt
    reference = cf.update(blade(), right, vary("material.E"), outliers="keep")
    (row,) = fit.outliers
    assert (row.modes, row.kind) == ((5,), "frequency")
    assert row.shift == pytest.approx(0.04, abs=0.002)
    assert abs(fit.x - reference.x)[0] < 3.0 * reference.stated_sigma[0]
    assert abs(fit.plain.x - reference.x)[0] > 3.0 * reference.stated_sigma[0]
    text = repr(fit)
    assert "outlier, excluded: row 5" in text
    assert "% from what the other rows predict" in text
    assert f"without outliers: material.E = {fit.value[0]:.5g} (with it {fit.plain.value[0]:.5g})" in text
    document = json.loads(json.dumps(fit.to_json()))
    assert document["outliers"][0]["modes"] == [5]
    assert document["with_outliers"] == list(fit.plain.value)
    held(1e-4, **numbers_of_result(fit))


@pytest.mark.slow
def test_all_rows_are_kept_where_that_is_asked(spoilt):
    right, fit = spoilt
    kept = cf.update(blade(), fit.plain.table, vary("material.E"), outliers="keep")
    assert kept.outliers == ()
    assert len(kept.table) == len(right)
    assert kept.worst()[0] == 5
    assert "largest: row 5" in repr(kept)
    with pytest.raises(cf.errors.InputError, match="outliers: found 'drop'"):
        cf.update(blade(), right, vary("material.E"), outliers="drop")


@pytest.mark.slow
def test_sigma_grows_with_a_misfit_and_a_misfit_too_small_is_called_so():
    loose = cf.update(blade(), table(0.01), vary("material.E"))
    assert loose.inflation == loose.misfit > 1.5
    assert loose.sigma[0] == pytest.approx(loose.misfit * loose.stated_sigma[0])
    assert "times what the stated sigma explain" in repr(loose)
    assert loose.outliers == ()  # rows that all scatter by more than they state contain no wrong one
    exact = cf.update(blade(), table(), vary("material.E", "material.nu", "shell.thickness"))
    assert exact.inflation == 1.0
    assert exact.overstated
    assert "much smaller than the stated sigma" in repr(exact)


@pytest.mark.campaign
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
def test_a_wrong_row_that_represents_another_mode_nearby_is_named():
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
