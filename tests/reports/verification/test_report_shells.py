"""Reports on casings, cones, plates and rings run small, and find the numbers the README quotes."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from reports.verification import cone, cylinder, splitting, twisted_plate, wall
from reports.verification.modes import frustum as frustum_convergence
from reports.verification.modes import steel_ring
from reports.verification.solid_casing import SolidMesh, class_modes, make_part


@pytest.mark.campaign
def test_frustum_convergence_marks_the_default_mesh_and_finds_it_good(tmp_path, capsys):
    rows = frustum_convergence.main(tmp_path, quick=True)
    table = pd.read_csv(tmp_path / "frustum_convergence.csv")
    assert len(table) == len(rows) >= 4
    default = [row for row in rows if row[""]]
    assert {row["method"] for row in default} == {"shell", "fourier"}
    assert all(row["worst error"] < 2.4e-4 and row["sturm"] == 40 and row["doublet gap"] < 1e-10 for row in default)
    assert "<- default" in capsys.readouterr().out
    assert frustum_convergence.exact_frequencies()[[0, -1]].tolist() == [367.9087, 980.6034]


@pytest.mark.campaign
def test_cylinder_counts_rows_within_a_thousandth(tmp_path, capsys):
    rows = cylinder.main(tmp_path, quick=True)
    assert [row["within 0.1 %"] for row in rows[:3]] == [40, 40, 40]
    assert rows[2]["worst %"] < 0.004 < 0.18 < rows[2]["linear worst %"]
    assert len(pd.read_csv(tmp_path / "cylinder.csv")) == 200
    assert "120 of 120 rows within 0.1 %" in capsys.readouterr().out


@pytest.mark.campaign
def test_quick_tables_of_cones_and_twisted_plates(tmp_path, capsys):
    assert len(cone.main(tmp_path, quick=True)) == 20
    assert len(pd.read_csv(tmp_path / "cone.csv")) == 240
    assert len(twisted_plate.main(tmp_path, quick=True)) == 10
    printed = capsys.readouterr().out
    assert "without shear and rotary inertia 240" in printed
    assert "76 of 80 rows within 0.5 %" in printed


@pytest.mark.slow
def test_a_split_that_the_rule_forbids_is_seen():
    """The same frustum, judged by a wrong p: what must part does."""
    name, parts = next(iter(splitting.fields().items()))
    shell = frustum_convergence.reference_frustum(splitting.ODD)
    row = splitting.stays_double(name, replace(shell, **parts), 5, "a wrong rule")
    assert row["verdict"] == "FAIL"


@pytest.mark.campaign
def test_a_ring_as_strip_and_as_beam_agree(tmp_path):
    rows = steel_ring.main(tmp_path, quick=True)
    gaps = [abs(row["beam/strip - 1 %"]) for row in rows]
    assert max(gaps) < 1.0
    assert max(abs(row["strip Hz"] / row["no ring Hz"] - 1.0) for row in rows) > 0.08  # the ring matters more
    assert len(pd.read_csv(tmp_path / "steel_ring_bolts.csv")) == 6


@pytest.mark.slow
def test_the_solid_is_the_3d_column_of_the_reference_frustum():
    """n = 7, one part of 40: to 5e-5 on a coarse mesh; a wall that breathes at the clamp is 2.4e-4 lower."""
    shell, mesh = frustum_convergence.reference_frustum(), SolidMesh(
        orders=(6, 5, 4), rows=(0.0, 0.005, 0.02, 0.1, 0.5, 0.97, 1.0), around=1
    )  # fmt: skip
    held, breathing = (
        np.sqrt(class_modes(make_part(shell, mesh, 40, breathes=breathes), 40, 7, 3)[0]) / (2.0 * np.pi)
        for breathes in (False, True)
    )
    np.testing.assert_allclose(held, [382.8744, 1060.2719, 1643.5737], rtol=5e-5)
    assert breathing[0] / held[0] - 1.0 == pytest.approx(-2.4e-4, abs=1e-5)


@pytest.mark.campaign
def test_an_imperfect_thick_casing_is_its_solid(tmp_path):
    row = wall.main(tmp_path, quick=True)[0]
    assert row["solids differ"] < wall.AGREE
    assert row["verdict"] == "pass"
    assert row["linear worst"] > 1.5 * row["worst"]


def test_a_row_fails_by_frequency_split_angle_and_by_solids_that_differ():
    good = {"worst": 2e-4, "split": 1e-3, "angle": 0.1}
    assert wall.verdict(1e-5, good, 0.0) == "pass"
    assert wall.verdict(1e-5, good | {"worst": 5e-4}, 3e-4).startswith("a shell's clamp")
    for bad in ({"worst": 8e-4}, {"split": 0.02}, {"angle": 0.6}):
        assert wall.verdict(1e-5, good | bad, 3e-4) == "FAIL"
    assert wall.verdict(2e-4, good, 0.0).startswith("FAIL")
