"""The comparison of two checkouts: it runs each one's own packages, and sees what differs."""

import math

import pytest

from reports.tools.frozen import Case, apart, flat, numbers_of, row_of


def test_each_checkout_runs_its_own_packages(tmp_path):
    for name, force in (("now", 1.0), ("before", 2.0)):
        package = tmp_path / name / "casingfem"
        package.mkdir(parents=True)
        (package / "__init__.py").write_text("")
        (package / "__main__.py").write_text(f'print(\'{{"force": [0.0, {force}], "seconds": {force}}}\')')
    case = Case("any", ("casingfem contact rods.toml --json",), (("rods.toml", "[scene]\n"),))
    now, before = (numbers_of(case, tmp_path / name, tmp_path / "runs" / name) for name in ("now", "before"))
    assert (now["force"], before["force"]) == ([0.0, 1.0], [0.0, 2.0])
    assert (tmp_path / "runs" / "now" / "rods.toml").read_text() == "[scene]\n"
    assert row_of("any", now, before) | {"numbers": 2} == {
        "case": "any", "numbers": 2, "verdict": "changed", "apart": 0.5, "where": ".force", "only in one": "",
    }  # fmt: skip


@pytest.mark.slow
def test_a_command_that_fails_states_so_and_is_not_equal(tmp_path):
    found = numbers_of(Case("any", ("casingfem nonsense",)), tmp_path, tmp_path / "runs")
    assert row_of("any", found, found)["verdict"] == "changed"
    assert found["exit code"] != 0
    assert found["said"]


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        ([1.0, 4.0], [1.0, 4.0], 0.0), ([1.0, 4.0], [1.0, 5.0], 0.2), ([1.0], [1.0, 2.0], math.inf),
        ("scheme", "scheme", 0.0), ("scheme", "other", math.inf), (None, 1.0, math.inf), (math.nan, math.nan, 0.0),
        ([math.inf, 1.0], [math.inf, 2.0], math.inf), ([0.0, 0.0], [0.0, -0.0], 0.0),
    ],
)  # fmt: skip
def test_how_far_apart(one, other, expected):
    assert apart(one, other) == expected


def test_what_is_compared():
    document = {"contacts": [{"force": [1.0, None], "seconds": 3.0}], "source": {"numpy": "2"}, "steps": 4, "flags": []}
    assert dict(flat(document)) == {".contacts[0].force": [1.0, None], ".steps": 4, ".flags": []}


def test_what_is_left_of_an_energy_balance_is_compared_with_its_largest_term():
    now, before = ({"energy": {"external": 2.0, "unaccounted": rest}} for rest in (1e-16, -3e-16))
    assert dict(flat(now)) == {".energy": [2.0, 1e-16]}
    assert row_of("any", now, before)["verdict"] == "equal to 1e-13"


@pytest.mark.parametrize(
    ("before", "verdict", "only"),
    [({"a": 1.0}, "equal to the bit", ""), ({"a": 1.0 + 1e-15}, "equal to 1e-13", ""), ({"a": 1.1}, "changed", ""),
     ({"a": 1.0, "b": 2.0}, "changed", ".b"), ({}, "changed", ".a")],
)  # fmt: skip
def test_verdicts(before, verdict, only):
    row = row_of("any", {"a": 1.0}, before)
    assert (row["verdict"], row["only in one"]) == (verdict, only)
