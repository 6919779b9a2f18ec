"""What a sweep plans and tells, part by part: places of keys, kinds of numbers, levels, growth, flags, cells."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import contact as ct
from contact.sweep import sweep
from contact.sweep.columns import COLUMNS
from contact.sweep.plan import (
    SweepPlan,
    SweepRun,
    _as_in_scene,
    _combinations,
    _definition,
    _drawn,
    _place,
    _table,
    _values,
    _whole,
    _words,
    changed,
)
from contact.sweep.row import _flags, _levels, row_of, sweep_record
from contact.sweep.tables import SweepTable, VaryTable
from tests.contact.synthetic_rim import blade, ring

FILE = Path("scene.toml")
BASE = {
    "speed": {"hz": 5.0},
    "rod": [{"x": 0.0, "elements": 20}, {"x": 1.0}],
    "deep": {"in": [[{"k": 1}]], "n": {"a": 2}},
}


def test_other_values_stand_in_copies_of_the_tables_that_hold_them():
    found = changed(BASE, ["rod[2].x", "deep.n.a", "speed.new"], [7.0, 9, "text"])
    assert found["rod"] == [{"x": 0.0, "elements": 20}, {"x": 7.0}]
    assert (found["deep"]["n"], found["speed"]) == ({"a": 9}, {"hz": 5.0, "new": "text"})
    assert (BASE["rod"][1]["x"], BASE["deep"]["n"]["a"], BASE["speed"]) == (1.0, 2, {"hz": 5.0})
    assert changed(BASE, ["rod[1].x"], [3.0])["speed"] is BASE["speed"]


@pytest.mark.parametrize(
    "key", ["rod[0].x", "rod[3].x", "rod.x", "none.x", "speed.hz.x", "deep.in[1].k", "a b.x", "[1].x"]
)
def test_a_place_that_is_not_there_is_refused_with_its_part(key):
    part = key.split(".")[-2]
    words = f"scene.toml: sweep.vary.key: found {key!r}, but the scene has no {part!r} there"
    with pytest.raises(ct.scene.SceneError, match=re.escape(words)):
        _place(BASE, key, FILE)


@pytest.mark.parametrize("key", ["hz", "speed.h z", "speed.", "speed.hz[1]"])
def test_a_key_that_names_no_entry_of_a_table_is_refused(key):
    with pytest.raises(
        ct.scene.SceneError, match=re.escape(f"sweep: sweep.vary.key: found {key!r}, expected table.key of the")
    ):
        _place(BASE, key, None)


def test_counts_stay_whole_numbers():
    assert [_whole(BASE, key, FILE) for key in ("rod[1].elements", "rod[2].elements", "deep.n.a", "rod[1].x")] == [
        True, True, True, False,
    ]  # fmt: skip
    given = [(50.0, True), (50.5, True), (50.0, False), (3, False), ("x", True)]
    assert [_as_in_scene(*each) for each in given] == [50, 50.5, 50.0, 3, "x"]
    assert [type(_as_in_scene(*each)) for each in given] == [int, float, float, int, str]


def vary(**given):
    return VaryTable.model_validate(given)


def test_values_are_listed_or_evenly_spaced():
    assert _values(vary(key="a.b", values=[3.0, 1.0, "x"])) == [3.0, 1.0, "x"]
    assert _values(vary(**{"key": "a.b", "from": 1.0, "to": 4.0, "steps": 4})) == [1.0, 2.0, 3.0, 4.0]
    assert _values(vary(**{"key": "a.b", "from": 1.0, "to": 4.0, "steps": 1})) == [1.0]
    spaced = _values(vary(**{"key": "a.b", "from": 1.0, "to": 8.0, "steps": 4, "log": True}))
    assert spaced == pytest.approx([1.0, 2.0, 4.0, 8.0], rel=1e-14)
    assert {type(value) for value in spaced} == {float}


def test_a_draw_of_a_range_lies_in_it_and_whole_numbers_have_both_ends():
    rng = np.random.default_rng(2)
    whole = [_drawn(vary(**{"key": "casing.seed", "from": 3, "to": 5}), rng) for _ in range(60)]
    assert sorted(set(whole)) == [3, 4, 5]
    even = [_drawn(vary(**{"key": "a.b", "from": 10.0, "to": 1000.0}), rng) for _ in range(200)]
    logs = [_drawn(vary(**{"key": "a.b", "from": 10.0, "to": 1000.0, "log": True}), rng) for _ in range(200)]
    assert np.median(even) == pytest.approx(505.0, abs=120.0)
    assert np.median(np.log10(logs)) == pytest.approx(2.0, abs=0.25)
    for drawn in (even, logs):
        assert 10.0 <= min(drawn) < max(drawn) <= 1000.0
    assert {_drawn(vary(key="a.b", values=[1.0, 2.0]), rng) for _ in range(30)} == {1.0, 2.0}


def test_runs_are_the_product_or_the_rows_of_the_lists():
    two = [{"key": "a.b", "values": [1.0, 2.0]}, {"key": "a.c", "values": [3.0, 4.0]}]
    grid = SweepTable.model_validate({"vary": two})
    assert list(_combinations(grid, FILE)) == [(1.0, 3.0), (1.0, 4.0), (2.0, 3.0), (2.0, 4.0)]
    rows = SweepTable.model_validate({"kind": "list", "vary": two})
    assert list(_combinations(rows, FILE)) == [(1.0, 3.0), (2.0, 4.0)]
    many = [{"key": f"a.{name}", "from": 1, "to": 2, "steps": 1000} for name in "bc"]
    assert next(_combinations(SweepTable.model_validate({"vary": many}), FILE)) == (1.0, 1.0)
    with pytest.raises(
        ct.scene.SceneError, match=r"scene\.toml: sweep\.vary: found 2000000 combinations, expected at most 1000000"
    ):
        next(_combinations(SweepTable.model_validate({"vary": [*many, {"key": "a.d", "values": [1.0, 2.0]}]}), FILE))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"vary": [{"key": "a.b", "values": []}]}, "values: found none, expected at least one"),
        ({"vary": [{"key": "a.b", "from": 1.0, "steps": 2}]}, "found neither values nor both from and to"),
        ({"vary": [{"key": "a.b", "to": 1.0, "steps": 2}]}, "found neither values nor both from and to"),
        ({"vary": [{"key": "a.b", "from": 1.0, "to": 0.0, "steps": 2, "log": True}]}, "log found with from or to <= 0"),
        ({"vary": [{"key": "a.b", "from": 1.0, "to": 2.0}]}, "a.b: steps missing, expected how many from .. to"),
        ({"kind": "random", "draws": 2, "vary": [{"key": "a.b", "values": [1.0]}]}, "draws and seed belong to"),
        ({"kind": "random", "seed": 2, "vary": [{"key": "a.b", "values": [1.0]}]}, "draws and seed belong to"),
        ({"seed": 2, "vary": [{"key": "a.b", "values": [1.0]}]}, "draws and seed belong to"),
        ({"draws": 2, "vary": [{"key": "a.b", "values": [1.0]}]}, "draws and seed belong to"),
        ({"kind": "random", "draws": 2, "seed": 0, "vary": [{"key": "a.b", "from": 1.0, "to": 2.0, "steps": 3}]},
         "a.b: steps found with kind = 'random'"),
        ({"vary": [{"key": "a.b", "values": [1.0]}] * 2}, "vary: found a key twice, expected each once"),
        ({"vary": [{"key": "", "values": [1.0]}]}, "vary[1].key"), ({"vary": []}, "sweep.vary"),
        ({"kind": "random", "draws": 0, "seed": 0, "vary": [{"key": "a.b", "values": [1.0]}]}, "sweep.draws"),
        ({"kind": "random", "draws": 1, "seed": -1, "vary": [{"key": "a.b", "values": [1.0]}]}, "sweep.seed"),
        ({"vary": [{"key": "a.b", "from": 1.0, "to": 2.0, "steps": 0}]}, "steps"),
        ({"vary": [{"key": "a.b", "from": 1.0, "to": 2.0, "steps": 1_000_001}]}, "steps"),
        ([], "sweep: missing, expected [sweep] with [[sweep.vary]]"),
    ],
)  # fmt: skip
def test_tables_that_plan_nothing_are_refused(given, words):
    with pytest.raises(ct.scene.SceneError, match=re.escape(words)):
        _table(given, FILE)


def test_a_table_at_its_smallest_bounds_is_read():
    for given in (
        {"kind": "random", "draws": 1, "seed": 0, "vary": [{"key": "x", "values": [1.0]}]},
        {"vary": [{"key": "a.b", "from": 1.0, "to": 2.0, "steps": 1_000_000}]},
    ):
        assert _table(given, FILE).kind == given.get("kind", "grid")


def test_a_run_is_defined_by_its_tables_its_files_and_versions(tmp_path):
    (tmp_path / "casing.npz").write_bytes(b"abc")
    data = {"casing": {"basis": "casing.npz"}, "terms": [{"name": "none.npz"}, 3.0, ["deep"]]}
    assert sorted(_words(data)) == ["casing.npz", "deep", "none.npz"]
    contents = {}
    found = _definition(data, tmp_path / "scene.toml", {"numpy": "2"}, contents)
    assert found["scene"] is data
    sha = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert (found["files"], found["versions"]) == ({"casing.npz": sha}, {"numpy": "2"})
    assert contents == {tmp_path / "casing.npz": sha, tmp_path / "none.npz": "none", tmp_path / "deep": "none"}


@pytest.mark.parametrize(
    ("steps", "every"),
    [(0, 1), (511, 1), (512, 2), (256 * 3, 3), (256 * 4, 3), (256 * 9, 7), (256 * 25, 23), (256 * 49, 47)],
)
def test_states_are_stored_at_a_prime_stride(steps, every):
    record = sweep_record(steps)
    assert (record.every, record.state_every) == (every, every)


def test_levels_are_the_rms_around_the_rim_by_nodal_diameters():
    """Of a cos n theta + b sin n theta the mean square around is (a^2 + b^2)/2, of n = 0 its square."""
    radial = np.array([[1.0, 2.0, 0.0, 5.0, 6.0], [3.0, 8.0, 4.0, 5.0, -2.0]])
    expected = [1.0, math.sqrt(0.5 * (9.0 + 0.0)), math.sqrt(0.5 * (4.0 + 16.0))]
    np.testing.assert_allclose(_levels(radial, 2), expected, rtol=1e-14)


BUDGET = ct.record.EnergyBudget(
    start=ct.record.Stored(kinetic=2.0, strain=0.0, potential=0.0, residual=0.0, discrete=2.0),
    end=ct.record.Stored(kinetic=2.0, strain=0.0, potential=0.0, residual=0.0, discrete=2.0),
    contact=0.0, rotation=0.0, friction=0.0, damping=0.0,
)  # fmt: skip
EMPTY = ct.Result(
    time=np.zeros(0), force=np.zeros((0, 1)), gap=np.zeros((0, 1)), impulse_history=np.zeros((0, 1)),
    impulse=np.array([0.0]), peak_force=np.array([0.0]), max_penetration=np.array([0.0]), residual=np.array([0.0]),
    contact_steps=np.array([0]), reversals=np.array([0]), state_time=np.zeros(0), state=np.zeros((0, 12)),
    intervals=((),), energy=BUDGET, motions=(), blocks=(), steps=0, dt=0.1, window=0.2, seconds=0.3, scheme="some",
    source={}, channels=np.zeros((0, 12)),
)  # fmt: skip


def test_flags_begin_a_little_beyond_what_is_calm():
    """Motion beyond a tenth of the radius to either side."""
    rim = ct.RotatingRim(ring(), blade(), clearance=0.0, speed_hz=5.0)
    far = "the rim moved by more than a tenth of its radius [motion-radius]"
    for size, told in ((0.0449, []), (0.0451, [far]), (-0.0449, []), (-0.0451, [far])):
        assert _flags(EMPTY, rim, np.array([[0.001, size, -0.001]])) == told
        assert _flags(EMPTY, None, np.array([[size]])) == []


def test_a_run_without_steps_or_energy_has_zeros_in_its_row():
    row = row_of(None, EMPTY)
    assert (row["status"], row["contact_fraction"], row["unaccounted_rel"], row["amplitude_m"]) == (
        "done",
        0.0,
        0.0,
        None,
    )
    still = replace(
        BUDGET, start=replace(BUDGET.start, kinetic=0.0), end=replace(BUDGET.end, kinetic=0.0, discrete=3.0)
    )
    assert row_of(None, replace(EMPTY, energy=still))["unaccounted_rel"] == 0.0
    failed = ct.NumericsError("step 7")
    assert row_of(None, failed) == dict.fromkeys(COLUMNS) | {"status": "failed", "flags": "", "why": "step 7"}
    failed.result = replace(EMPTY, steps=4, contact_steps=np.array([1]))
    row = row_of(None, failed)
    assert (row["status"], row["steps"], row["contact_fraction"], row["why"]) == ("failed", 4, 0.25, "step 7")


def test_a_table_has_units_empty_cells_and_quotes():
    runs = tuple(SweepRun(values=(value, "a"), digest=str(value)) for value in (1.5, 2.5))
    plan = SweepPlan(file=FILE, base={}, keys=("contact.clearance", "casing.basis"), runs=runs,
                     source={"scene": "scene.toml", "sha256": "ab", "numpy": "2"})  # fmt: skip
    rows = tuple(
        dict.fromkeys(COLUMNS) | {"status": "done", "steps": k, "why": why} for k, why in ((3, ""), (4, 'a, "b"\nc'))
    )
    lines = sweep.table(sweep.SweepResult(plan=plan, rows=rows, resumed=0)).splitlines()
    assert lines[:4] == ["# COMPUTED: sweep of scene.toml, 2 runs", "# numpy: 2", "# scene: scene.toml", "# sha256: ab"]
    assert lines[4] == ",".join(["run", "contact.clearance_m", "casing.basis", *COLUMNS])
    assert lines[5] == "1,1.5,a,done,3" + "," * 28
    assert lines[6] == "2,2.5,a,done,4" + "," * 28 + '"a, ""b"" c"'
