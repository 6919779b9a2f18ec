"""The disc on the ground: Hertz's pressure from arrays that contact did not assemble."""

import pytest

from reports.verification.schemes import hertz


@pytest.mark.slow
def test_nodal_forces_follow_the_half_ellipse(tmp_path):
    (row,) = hertz.main(tmp_path, quick=True)
    assert row["pressure L2 %"] < 4.0
    assert row["sum of forces/P"] == pytest.approx(1.0, abs=1e-6)
    assert row["penetration/a"] < 1e-12
    assert 5 < row["touching"] < row["candidates"]
    assert (tmp_path / "hertz.png").stat().st_size > 10_000


def test_half_width_and_pressure_balance_the_load():
    a, peak = hertz.hertz(1e6)
    assert 0.5 * hertz.np.pi * a * peak == pytest.approx(1e6)
