"""Reports on contact run small, and find what they say."""

import pandas as pd
import pytest

from reports.benchmarks import physics, work_precision, work_precision_cycles
from reports.verification import contact as verify_contact
from reports.verification.schemes import cycles, random_orbits, rod_wall, rods, sparse_body, stability
from reports.verification.schemes.targets import rods as contact_targets_rods
from reports.verification.schemes.targets import study
from reports.verification.schemes.targets import table as contact_targets

pytestmark = pytest.mark.slow  # they compile loops for seconds


def test_two_rods_by_lagrange_and_penalty(tmp_path, capsys):
    rows = {row["method"]: row for row in rods.main(tmp_path, quick=True)}
    assert (tmp_path / "rods.png").stat().st_size > 10_000
    assert rows["forward Lagrange"]["force L1"] < 0.05 < 0.1 < rows["penalty 2e+09"]["force L1"]
    assert rows["massless boundary"]["peak/exact"] < 1.35
    assert abs(rows["massless boundary"]["energy"]) < 1e-3
    assert all(row["unaccounted"] < 1e-12 for row in rows.values())


def test_newmark_pairs_on_a_wall(tmp_path, capsys):
    rows = {row["method"]: row for row in rod_wall.main(tmp_path, quick=True)}
    assert rows["Newmark (0.25, 0.55)"]["rate"] < 0.1
    assert rows["Newmark (0.5, 0.55)"]["rate"] > 0.7
    assert rows["forward Lagrange"]["rate"] > 0.7
    assert len(pd.read_csv(tmp_path / "rod_wall.csv")) == len(rows)


@pytest.mark.campaign
def test_work_precision_of_orbits_has_references_that_an_integration_confirms(tmp_path, capsys):
    rows = work_precision_cycles.main(tmp_path, quick=True)
    printed = capsys.readouterr().out
    assert "by integration" in printed
    for modes in (2, 20):
        assert work_precision_cycles.reference(modes)[1]["returns"] < 1e-10
        by = {name: [abs(row["error"]) for row in rows if (row["modes"], row["method"]) == (modes, name)]
              for name in ("shooting", "harmonic balance")}  # fmt: skip
        assert by["shooting"][-1] < 1e-12 < 1e-6 < by["shooting"][0]
        assert by["harmonic balance"][-1] < 1e-3 < by["harmonic balance"][0]
    assert (tmp_path / "work_precision_cycles.png").stat().st_size > 10_000
    assert len(pd.read_csv(tmp_path / "work_precision_cycles.csv")) == len(rows)


@pytest.mark.campaign
def test_work_precision_measures_every_scheme(tmp_path, capsys):
    rows = work_precision.main(tmp_path, quick=True)
    assert len({row["method"] for row in rows}) == 24  # 15 on elements, 4 of modes, 4 of the rub, 1 of the ball
    ran = [row for row in rows if row["seconds"]]
    assert {row["note"][:4] for row in rows if not row["seconds"]} == {"law:"}  # the averaged law needs small steps
    assert all(row["unaccounted"] < 1e-10 and row["seconds"] > 0.0 for row in ran)
    assert len(list(tmp_path.glob("work_precision_*.png"))) == 5
    won = pd.read_csv(tmp_path / "work_precision_winners.csv")
    assert set(won["scene"]) == {
        "two rods",
        "rod on wall",
        "rub of rotor 37",
        "bouncing ball, restitution 0.8",
        "beam on a stop, 5 modes",
    }


def test_the_quickest_method_within_an_error_is_that_of_its_best_run():
    runs = [("a", 1.0, 0.02), ("a", 9.0, 0.001), ("b", 2.0, 0.009), ("c", 5.0, None)]
    rows = [
        {"scene": "s", "method": name, "elements": 1, "courant": 0.5, "seconds": time, "impulse": error}
        for name, time, error in runs
    ]
    found = {row["within %"]: (row["quickest"], row["ms"], row["next"]) for row in work_precision.winners(rows)}
    assert found == {3.0: ("a", 1e3, "b"), 1.0: ("b", 2e3, "a"), 0.3: ("a", 9e3, None)}


@pytest.mark.campaign
def test_nothing_ends_in_nan_and_what_is_recommended_survives(tmp_path, capsys):
    rows = stability.main(tmp_path, quick=True)
    found = {word for row in rows for name, word in row.items() if name != "scene"}
    assert all(", law violated by" in word or word[10:].startswith("gains") or word[10:].startswith("law violated")
               for word in found if word.startswith("degraded: "))  # fmt: skip
    words = {word.partition(":")[0] for word in found}
    assert words == {"survived", "refused", "degraded", "stopped"}
    for row in rows:  # at Courant 30 the rods approach by 0.6 of their length in a step
        expected = "stopped: penetration" if row["scene"] == "Courant 30" else "survived"
        assert row["Moreau-Jean, theta = 1/2"] == expected
        assert row["forward Lagrange"] in ("survived", "refused")
        assert row["massless boundary"] in ("survived", "refused")
        assert row["event-driven"] in ("survived", "refused")
    beyond = next(row for row in rows if row["scene"] == "Courant 1.01")
    assert beyond["forward Lagrange"] == "refused"


@pytest.mark.campaign
def test_contact_targets_quick(tmp_path, capsys):
    rows = contact_targets.main(tmp_path, quick=True)
    verdicts = [row["verdict"] for row in rows]
    assert "NOT confirmed" not in verdicts
    assert "MISSED" not in verdicts
    assert verdicts.count("confirmed") == 14
    assert len(pd.read_csv(tmp_path / "contact_targets.csv")) == len(rows)


def test_a_target_can_be_missed_and_a_statement_refuted():
    assert contact_targets_rods.target("x", 1.0, 1.1)["verdict"] == "MISSED"
    assert contact_targets_rods.target("x", 1.0, 1.1, at_least=True)["verdict"] == "pass"
    assert study.statement("x", 1.0, float("nan"))["verdict"] == "NOT confirmed"


def test_published_values_of_contact():
    rows = verify_contact.rows(quick=True)
    assert len(rows) == 14
    assert [row["verdict"] for row in rows] == ["pass"] * 14


def test_entries_give_what_bands_give(tmp_path, capsys):
    rows = sparse_body.main(tmp_path, quick=True)
    assert len(rows) == 6
    for row in rows:
        assert row["difference"] < 1e-12
        assert row["unaccounted"] < 1e-11
        assert row["factor fill"] < row["band fill"]
    assert len(pd.read_csv(tmp_path / "sparse_body.csv")) == 6


@pytest.mark.campaign
def test_periodic_motions_are_the_published_ones_and_agree_with_runs(tmp_path, capsys):
    rows = cycles.main(tmp_path, quick=True)
    assert [row["verdict"] for row in rows] == ["pass"] * 21
    lost = pd.read_csv(tmp_path / "cycles_unstable.csv")
    assert (lost["|multiplier|"] > 1.0).all()
    assert lost["error"].abs().max() < 1e-3
    assert (tmp_path / "rod_4.png").stat().st_size > 10_000


@pytest.mark.campaign
def test_runs_settle_on_what_is_called_stable_and_leave_the_rest(tmp_path, capsys):
    rows = random_orbits.main(tmp_path, quick=True)
    assert sum(row["failed"] for row in rows) == 0
    assert sum(row["runs that settle"] for row in rows) > 8
    assert sum(row["beyond 1.02"] for row in rows) > 10
    assert len(pd.read_csv(tmp_path / "random_orbits.csv")) == 12


@pytest.mark.campaign
def test_physics_left_out_costs_nothing(tmp_path, capsys):
    rows = physics.main(tmp_path, quick=True)
    assert all(row["explicit, steps/s"] > 2e4 for row in rows)
    assert capsys.readouterr().out.count("none") == 1  # import contact loads nothing heavy
    assert "skfem" not in physics.loaded(physics.RUN)
    assert "matplotlib" not in physics.loaded(physics.RUN)
