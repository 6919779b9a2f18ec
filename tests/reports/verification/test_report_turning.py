"""Bodies that turn against plain NumPy: every row passes, and the rows can fail."""

from dataclasses import replace

import pytest

from reports.verification.rubs import turning


@pytest.mark.slow
def test_growth_is_that_of_a_dense_model_and_needs_the_matrices_of_rotation(tmp_path):
    casing, blade = turning.bodies()
    rows = turning.growths(casing, blade, turning.SPEEDS[::4], tmp_path)
    assert {row["verdict"] for row in rows} == {"pass"}
    assert all(row["off at most"] < 1e-9 for row in rows)
    assert (tmp_path / "rub_turning_growth.csv").read_text().count("\n") == 1 + 4 * len(turning.SPEEDS[::4])
    plain = replace(casing, gyroscopic_higher=None, stiffness_higher=None)
    near, far = (turning.dense_growth(one, blade, 41.0, 0.3, "casing") for one in (plain, casing.without_rotation()))
    exact = turning.dense_growth(casing, blade, 41.0, 0.3, "casing")
    assert 1e-6 < abs(near / exact - 1.0) < 1e-2 < abs(far / exact - 1.0)


@pytest.mark.campaign
def test_runs_have_the_impulse_of_runge_kutta_and_a_closed_ledger(tmp_path):
    rows = turning.main(tmp_path, quick=True)
    assert {row["verdict"] for row in rows} == {"pass"}


@pytest.mark.campaign
def test_impulse_comes_to_that_of_runge_kutta_with_the_square_of_the_step():
    casing, blade = turning.bodies()
    whole = turning.runs(casing, blade, 400)
    half = turning.runs(casing, blade, 800, 0.5 * turning.STEP)
    for row, finer in zip(whole, half, strict=True):
        assert row["off"] / finer["off"] == pytest.approx(4.0, rel=0.02)
