"""Reports on the eigen solvers run small, and their faults show."""

import time

import numpy as np
import pandas as pd
import pytest

import casingfem as cf
import contact as ct
from reports.benchmarks import child, modal, solid_solvers
from reports.verification import locking as verify_locking
from reports.verification.cylinder import REFERENCE, cylinder
from reports.verification.modes import imported_relations, locking, sturm

LOW = cf.ShellMesh(order=3, rows=2, around=1)


@pytest.mark.campaign
def test_every_random_structure_shows_as_many_modes_as_are_counted(tmp_path, capsys):
    rows = sturm.main(tmp_path, quick=True)
    assert sum(row["drawn"] for row in rows) == 30
    assert sum(row["faults"] for row in rows) == 0
    assert sum(row["free"] for row in rows) >= 5
    assert sum(row["doublets"] for row in rows) >= 10
    assert "30 structures, 0 faults" in capsys.readouterr().out
    assert len(pd.read_csv(tmp_path / "sturm.csv")) == len(rows)


def test_a_mode_lost_among_random_structures_is_a_fault(monkeypatch, capsys):
    def losing(shell, count=None, **given):
        return cf.modes(shell, None if count is None else count - 1, **given)

    assert not sturm.outcome(3).fault
    monkeypatch.setattr(sturm, "modes", losing)
    assert "10 modes, 11 asked for" in sturm.outcome(3).fault
    assert "structure 3" in capsys.readouterr().out


@pytest.mark.campaign
def test_multigrid_serves_a_thick_block_and_states_that_it_fails_on_a_thin_plate(tmp_path):
    rows = solid_solvers.main(tmp_path, quick=True)
    direct, multigrid, _, thin = rows
    assert [row["ended"] for row in rows[:3]] == ["done"] * 3
    assert multigrid["difference"] < 1e-9
    assert direct["missed"] == 0
    assert "modes converged, the largest residual" in thin["ended"]
    assert len(pd.read_csv(tmp_path / "solid_solvers.csv")) == 4


@pytest.mark.campaign
def test_a_child_that_is_stopped_shows_what_it_reached():
    def slow():
        yield {"first": 1}
        time.sleep(60.0)

    def large():
        yield {"first": 2}
        bytearray(2**34)

    outcome = child.in_child(slow, child.Limits(seconds=2.0))
    assert (outcome.numbers, outcome.ended) == ({"first": 1}, "not done after 2 s")
    assert outcome.peak is None or outcome.peak > 10.0  # where the system tells
    outcome = child.in_child(large, child.Limits())
    assert (outcome.numbers, outcome.ended) == ({"first": 2}, "more than 14 GB")
    assert outcome.peak > 10.0


@pytest.mark.campaign
def test_modal_speed_names_its_parts_and_the_harmonics_are_right(tmp_path):
    rows = modal.main(tmp_path, quick=True)
    assert [row["sturm"] for row in rows] == [40, 40, None]
    assert rows[-1]["worst error"] < 5e-4
    parts = pd.read_csv(tmp_path / "modal_parts.csv").set_index("part")
    assert parts.loc["whole", "of the whole"] == 1.0
    assert {"element matrices", "factor", "block Lanczos", "Sturm count", "instead: ARPACK"} <= set(parts.index)


@pytest.mark.campaign
def test_default_mesh_does_not_lock(tmp_path):
    rows = locking.main(tmp_path, quick=True)
    default = {row["R/t"]: row["harmonics"] for row in rows if row["mesh"] == "default"}
    assert default[100] < 1e-4
    assert default[1000] < 1e-4
    low = {row["R/t"]: row["harmonics"] for row in rows if row["order"] == 3}
    assert low[1000] > 1e-2  # what locking resembles
    assert max(row["reference moves"] for row in rows) < 1e-7


def test_closed_form_of_thin_cylinders_is_the_one_of_the_reference_table():
    table = pd.read_csv(REFERENCE, comment="#")
    found = [verify_locking.fluegge(row.h_over_R, row.L_over_R, row.n, row.m)[0] for row in table.itertuples()]
    np.testing.assert_allclose(found, table.omega_fluegge, rtol=0, atol=6e-10)  # nine digits are printed
    assert verify_locking.valley(1e-4, 0.5) == 33


@pytest.mark.slow
def test_thin_cylinders_do_not_lock_where_low_orders_do(monkeypatch):
    verdicts = {row["verdict"] for row in verify_locking.rows(quick=True)}
    assert verdicts == {"pass"}
    monkeypatch.setattr(verify_locking, "cylinder", lambda h, length: cylinder(h, length, LOW))
    rows = verify_locking.rows(quick=True)
    assert {row["verdict"] for row in rows} == {"FAIL"}
    assert min(row["error %"] for row in rows if "h/R 0.0001" in row["case"]) > 5.0  # too stiff


@pytest.mark.campaign
def test_imported_parts_follow_changes_whose_effect_is_exact(tmp_path, capsys):
    rows = imported_relations.main(tmp_path, quick=True)
    assert "12 parts, 0 faults" in capsys.readouterr().out
    assert min(row["parts"] for row in rows) >= 3
    assert max(row["worst"] for row in rows) < 1e-7


@pytest.mark.slow
def test_a_part_taken_with_wrong_axes_is_a_fault(monkeypatch):
    """The draws have free parts, and one that is not refused counts."""
    strict = imported_relations.basis

    def taking(given, units="m-kg-s"):
        try:
            return strict(given, units)
        except ct.InputError:
            return np.zeros(0), np.zeros((0, 0))

    monkeypatch.setattr(imported_relations, "basis", taking)
    errors = imported_relations.matrix_errors(0) | imported_relations.matrix_errors(1)
    assert errors["matrices: free, axes left out: refused"] == 1.0
    assert errors["matrices: own axes of nodes"] < 1e-7
