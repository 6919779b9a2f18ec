"""Each figure of a result, once: what is printed, tabled and written against sums by hand, all values different."""

import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import contact as ct
from casingfem.cli.pictures import force_files, ledger
from contact.io.trust import Flag
from contact.record.energy import Divergence
from contact.record.growth import Cause, RunGrowth
from contact.record.record import BUFFER, MOST_SAMPLES, sparse
from contact.scheme.protocol import Notes
from contact.sweep.row import row_of

START = ct.record.Stored(kinetic=2.0, strain=3.0, potential=5.0, residual=7.0, discrete=11.0)
END = ct.record.Stored(kinetic=13.0, strain=17.0, potential=19.0, residual=23.0, discrete=29.0)
BUDGET = ct.record.EnergyBudget(
    start=START, end=END, contact=-31.0, rotation=37.0, friction=-41.0, damping=-43.0, external=47.0, body_force=53.0,
    algorithmic=59.0, load_step=61.0, overlap=67.0,
)  # fmt: skip
FORCE = np.array([[0.0, 1.0], [2.0, 0.0], [4.0, 0.0], [0.0, 0.0], [3.0, 7.0]])
MADE = ct.Result(
    time=0.1 * np.arange(5), force=FORCE,
    gap=np.array([[0.3, -0.1], [-0.2, 0.4], [-0.7, 0.6], [0.5, 0.8], [-0.05, -0.9]]),
    impulse_history=0.1 * np.cumsum(FORCE, axis=0), impulse=0.1 * FORCE.sum(axis=0), peak_force=np.array([6.0, 9.0]),
    max_penetration=np.array([0.75, 0.95]), residual=np.array([0.011, 0.007]), contact_steps=np.array([3, 2]),
    reversals=np.array([4, 5]), state_time=np.array([0.1, 0.3]), state=np.array([[1.0, -8.0], [2.0, 3.0]]),
    intervals=(((0.05, 0.25), (0.35, 0.45)), ((0.0, 0.05),)), energy=BUDGET,
    motions=(ct.scheme.Motion(kind="rod", number=1, mean_velocity=1.5, momentum=2.5),), blocks=(("body 1", 0, 2),),
    steps=5, dt=0.1, window=0.2, seconds=0.3, scheme="some scheme", source={}, channels=np.zeros((0, 2)),
    notes=Notes(heat=np.array([1.25, 2.25]), drive=np.array([-3.0, 8.0])),
)  # fmt: skip
WINDOWED = np.array([[0.5, 0.5], [2.0, 0.25], [2.5, 0.0], [1.75, 1.75], [1.5, 3.5]])


def test_the_budget_is_summed_by_hand():
    assert (START.total, END.total) == (17.0, 72.0)
    assert BUDGET.lost_in_contact == 31.0 - (23.0 - 7.0)
    assert BUDGET.explained == 61.0 + 67.0
    assert BUDGET.numerical == 59.0 + (49.0 - 10.0) - (29.0 - 11.0)
    assert BUDGET.unaccounted == (29.0 - 11.0) - (-31.0 + 37.0 - 41.0 - 43.0 + 47.0 + 53.0 + 59.0)
    assert BUDGET.others == 2.0 + 3.0 + 7.0 + 14.0 + 37.0 + 41.0 + 47.0 + 53.0 + 61.0
    for name, size in {
        "contact": -71.0,
        "rotation": -73.0,
        "friction": 79.0,
        "external": -83.0,
        "body_force": 89.0,
    }.items():
        assert replace(BUDGET, **{name: size}).scale == abs(size)
    for name in ("kinetic", "strain", "potential"):
        assert replace(BUDGET, start=replace(START, **{name: -97.0})).scale == 97.0
        assert replace(BUDGET, end=replace(END, **{name: 101.0})).scale == 101.0
    assert replace(BUDGET, damping=-1e3, algorithmic=1e3, load_step=1e3, overlap=1e3).scale == 53.0
    since = BUDGET.since(ct.record.EnergyBudget(
        start=END, end=START, contact=1.0, rotation=2.0, friction=3.0, damping=4.0, external=5.0, body_force=6.0,
        algorithmic=7.0,
    ))  # fmt: skip
    works = since.contact, since.rotation, since.friction, since.damping, since.external, since.body_force
    assert (since.start, since.end) == (START, END)
    assert (*works, since.algorithmic) == (-32.0, 35.0, -44.0, -47.0, 42.0, 47.0, 52.0)


def test_force_is_averaged_over_a_window_about_each_sample():
    np.testing.assert_allclose(MADE.windowed_force(), WINDOWED, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(MADE.windowed_force(0.001), FORCE, rtol=1e-9, atol=1e-15)  # never narrower than a step


def test_records_columns_and_document_state_the_same():
    first, other = MADE.records()
    assert first == pytest.approx({
        "contact": 1, "closings": 2, "closed_s": 0.3, "impulse_N_s": 0.9, "peak_force_N": 6.0,
        "windowed_force_N": 2.5, "max_penetration_m": 0.75, "residual_m": 0.011,
    }, rel=1e-12)  # fmt: skip
    assert (other["contact"], other["closings"], other["peak_force_N"]) == (2, 1, 9.0)
    assert other["windowed_force_N"] == pytest.approx(3.5, rel=1e-12)
    columns = MADE.columns()
    assert list(columns)[:5] == ["time_s", "force1_N", "windowed_force1_N", "gap1_m", "impulse1_N_s"]
    document = MADE.to_dict()
    for k, contact in enumerate(document["contacts"], 1):
        assert contact["time"] == columns["time_s"].tolist() == MADE.time.tolist()
        for name, column in {
            "force": f"force{k}_N", "windowed_force": f"windowed_force{k}_N", "gap": f"gap{k}_m",
        }.items():  # fmt: skip
            assert contact[name] == columns[column].tolist()
        row = MADE.records()[k - 1]
        assert contact["impulse"] == row["impulse_N_s"] == columns[f"impulse{k}_N_s"][-1]
        assert (contact["peak_force"], contact["max_penetration"]) == (row["peak_force_N"], row["max_penetration_m"])
        assert (contact["residual"], contact["reversals"]) == (row["residual_m"], 3 + k)
        assert contact["intervals"] == [list(pair) for pair in MADE.intervals[k - 1]]
    assert document["bodies"] == [{"kind": "rod", "number": 1, "mean_velocity": 1.5, "momentum": 2.5}]
    energy = dict(document["energy"])
    assert (energy.pop("start"), energy.pop("end")) == (17.0, 72.0)
    parts = energy.pop("parts")
    assert (parts["start"]["potential"], parts["end"]["strain"]) == (5.0, 17.0)
    assert energy == {name: getattr(BUDGET, name) for name in energy}
    assert [document[name] for name in ("steps", "dt", "window", "every", "seconds")] == [5, 0.1, 0.2, 1, 0.3]


def test_what_is_printed_is_the_table():
    text = repr(MADE)
    lines = [[float(word) for word in line.split()] for line in text.splitlines()[2:4]]
    for line, row in zip(lines, MADE.records(), strict=True):
        names = (
            "contact",
            "closings",
            "closed_s",
            "impulse_N_s",
            "peak_force_N",
            "windowed_force_N",
            "max_penetration_m",
        )
        np.testing.assert_allclose(line, [*(row[name] for name in names), row["residual_m"]], rtol=1e-3)
    said = {name: float(value) for name, value in re.findall(r"(\w[\w ]*) (-?[\d.]+(?:e[+-]\d+)?)(?=,| of)", text)}
    assert {name: said[name] for name in ("end", "lost in contact", "rotation", "friction", "gravity and whirl")} == {
        "end": 72.0, "lost in contact": 15.0, "rotation": 37.0, "friction": -41.0, "gravity and whirl": 53.0,
    }  # fmt: skip
    assert (said["damping"], said["numerical"]) == (-43.0, 80.0)
    assert said["unaccounted"] == pytest.approx(-63.0 / 53.0, rel=0.05)
    assert "friction [J]: 3.5 dissipated, 5 supplied by the drive of the rim" in text


def test_the_row_of_a_sweep():
    row = row_of(None, MADE)
    wanted = {
        "steps": 5, "closings": 3, "contact_fraction": 0.6, "impulse_N_s": 1.7, "peak_force_N": 9.0,
        "max_penetration_m": 0.95, "residual_m": 0.011, "lost_in_contact_J": 15.0, "friction_J": -41.0,
        "damping_J": -43.0, "rotation_J": 37.0, "unaccounted_rel": -63.0 / 53.0,
    }  # fmt: skip
    assert {name: row[name] for name in wanted} == pytest.approx(wanted, rel=1e-12)
    assert (row["status"], row["flags"], row["why"]) == ("done", "", "")


def test_what_came_from_each_source_is_what_the_bodies_gained():
    """The bars of the energy's picture: all sources are the last one, but for what nobody accounts for."""
    found = ledger(MADE)
    stored = found.pop("stored at the end")
    assert stored == BUDGET.end.total - BUDGET.start.total
    assert sum(found.values()) + BUDGET.unaccounted == pytest.approx(stored, rel=1e-12)
    for bar, work in {
        "contact": "contact", "turning rim": "rotation", "friction": "friction", "damping": "damping",
        "loads": "external", "gravity, whirl": "body_force", "numerical": "algorithmic",
    }.items():  # fmt: skip
        more = ledger(replace(MADE, energy=replace(BUDGET, **{work: getattr(BUDGET, work) + 8.0})))
        assert {name: more[name] - found[name] for name in found if more[name] != found[name]} == {bar: 8.0}


def test_the_table_of_forces_is_read_back_column_by_column(tmp_path):
    force_files(MADE, "rub")["rub_forces.csv"](tmp_path / "forces.csv")
    table = pd.read_csv(tmp_path / "forces.csv", comment="#")
    np.testing.assert_allclose(table["time_s"], MADE.time, rtol=1e-8)
    for k in (0, 1):
        for name, values in (
            ("force{}_mean_N", MADE.force),
            ("force{}_peak_N", MADE.force),
            ("gap{}_least_m", MADE.gap),
        ):
            np.testing.assert_allclose(table[name.format(k + 1)], values[:, k], rtol=1e-8, atol=1e-12)
    assert len(table.columns) == 7


def test_a_run_that_diverged_states_when_and_how_fast_in_its_row_and_its_document():
    """Growth is what the run had, theory's is beside it; what is unknown is none."""
    end = Divergence(limit="wall", step=4, time=0.375, reached=3.0, allowed=2.0, growth=12.5, theory=99.0, words="far")
    far = replace(MADE.notes, flags=(Flag("far", "wall-deflection", failed=True),))
    grown = RunGrowth(
        rate=12.5, low=12.0, high=13.0, state="grows", amplitude=1.0, steady=1.0, since=0.1, time_to_half_wall=0.375,
        cause=Cause(body="casing", n=3, share=0.9, travel=1.0, source="friction", work=1.0, closed=0.2),
    )  # fmt: skip
    row = row_of(None, replace(MADE, divergence=end, notes=far, growth=grown))
    found = row["status"], row["diverged_at_s"], row["growth_1_s"], row["why"], row["peak_force_N"]
    assert found == ("diverged", 0.375, 12.5, "far [wall-deflection]", 9.0)
    motion = (
        row["motion"],
        row["growth_low_1_s"],
        row["growth_high_1_s"],
        row["half_wall_at_s"],
        row["n"],
        row["source"],
    )
    assert motion == ("grows", 12.0, 13.0, 0.375, 3, "friction")
    assert row["flags"] == "wall-deflection"
    assert end.to_dict() == {
        "limit": "wall", "step": 4, "time": 0.375, "reached": 3.0, "allowed": 2.0, "growth_1_s": 12.5,
        "theory_1_s": 99.0, "words": "far",
    }  # fmt: skip
    unknown = replace(end, growth=np.nan, theory=np.nan, reached=np.inf)
    assert {name for name, value in unknown.to_dict().items() if value is None} == {
        "growth_1_s", "theory_1_s", "reached"
    }  # fmt: skip
    assert row_of(None, replace(MADE, divergence=unknown))["growth_1_s"] is None
    assert row_of(None, replace(MADE, growth=replace(grown, rate=np.nan)))["growth_1_s"] is None


def test_intervals_are_joined_across_pauses_shorter_than_the_window():
    assert MADE.merged_intervals(0.1 + 1e-9) == (((0.05, 0.45),), ((0.0, 0.05),))
    assert MADE.merged_intervals(0.1 - 1e-9) == MADE.intervals
    assert MADE.merged_intervals() == MADE.merged_intervals(0.2)


def test_a_chunk_is_as_long_as_its_buffers_allow():
    """Numbers a step: 6 for events of each contact; 1 + 3 a contact every 5 steps, 1 + coordinates every 20."""
    for record, width in (
        (ct.Record(every=5, state_every=20), 18.0 + 10.0 / 5.0 + 41.0 / 20.0),
        (ct.Record(every=5), 18.0 + 10.0 / 5.0),
        (ct.Record(at=[0.1]), 18.0 + 10.0 + 41.0),
        (ct.Record(every=1, state_every=1, channels=np.ones((7, 40))), 18.0 + 10.0 + 8.0),
    ):
        assert record.chunk(3, 40) == int(BUFFER / width)
    assert ct.Record(state_every=1).chunk(3, 10 * BUFFER) == 1
    assert (sparse(MOST_SAMPLES).every, sparse(MOST_SAMPLES + 1).every, sparse(0).every) == (1, 2, 1)


def test_instants_are_the_nearest_steps_of_the_run():
    record = ct.Record(at=[0.0, 0.149, 0.151, 0.5])
    assert record.steps(dt=0.1, count=5).tolist() == [0, 1, 2, 4]  # the end of the run is its last step
    with pytest.raises(ct.InputError, match=r"at: found 0\.5 s, expected at most 0\.499 s"):
        record.steps(dt=0.0998, count=5)
    for inside, outside in (
        ({"every": 1}, {"every": 0}), ({"state_every": 0}, {"state_every": -2}),
        ({"every": 2, "state_every": 4}, {"every": 2, "state_every": 3}),
        ({"at": [0.0]}, {"at": [-1e-9]}), ({"at": [0.1]}, {"at": [0.1], "state_every": 1}),
        ({"state_every": 1, "channels": [[0.0]]}, {"state_every": 1, "channels": np.zeros((0, 2))}),
    ):  # fmt: skip
        ct.Record(**inside)
        with pytest.raises(ct.InputError, match="found"):
            ct.Record(**outside)


@pytest.mark.parametrize(
    ("closed", "words"),
    [(1.0, "all the time"), (0.995, "all the time"), (0.984, "98 % of the time"), (0.2, "20 % of the time")],
)
def test_the_cause_of_a_growing_motion_states_its_source_and_how_long_contact_is_closed(closed, words):
    cause = Cause(body="casing", n=3, share=0.9, travel=1.0, source="friction", work=1.25, closed=closed)
    growth = RunGrowth(
        rate=12.5, low=12.0, high=13.0, state="grows", amplitude=1.0, steady=1.0, since=0.1, time_to_half_wall=0.375,
        cause=cause,
    )  # fmt: skip
    assert f"Its energy comes from friction (1.25 J). The contact is closed {words}." in growth.words
    assert "energy comes" not in replace(growth, cause=replace(cause, source="")).words
    assert "energy comes" not in replace(growth, state="bounded").words
