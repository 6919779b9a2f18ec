"""Crossings, pairs and blades of a Campbell diagram, by hand."""

import json

import numpy as np
import pytest

import casingfem as cf

DATA = cf.modal.Campbell(
    omega=2.0 * np.pi * np.array([0.0, 20.0, 60.0]), freq=np.array([[100.0, 300.0], [120.0, 290.0], [150.0, 280.0]]),
    southwell=np.array([1.5, -0.25]), overlap=np.array([[1.0, 1.0], [0.9, 0.8], [0.99, 0.7]]),
)  # fmt: skip


def test_engine_orders_are_met_linearly_between_speeds():
    """100 + Omega and 300 - Omega/2 to 20 turns a second, then 120 + 3/4 (Omega - 20) and 290 - 1/4 (Omega - 20)."""
    assert dict(DATA.crossings(5)) == {0: pytest.approx(105.0 / 4.25), 1: pytest.approx(295.0 / 5.25)}
    assert DATA.crossings(2) == []
    assert dict(DATA.crossings(15)) == {0: pytest.approx(100.0 / 14.0), 1: pytest.approx(300.0 / 15.5)}
    np.testing.assert_allclose(DATA.speed_hz, [0.0, 20.0, 60.0], rtol=1e-14)


def test_a_diagram_is_reported_as_plain_data_and_as_a_table():
    told = json.loads(json.dumps(DATA.to_json(orders=5)))
    assert told["crossings"] == [
        {"order": 3, "mode": 1, "speed_hz": pytest.approx(105.0 / 2.25)},
        {"order": 4, "mode": 1, "speed_hz": pytest.approx(105.0 / 3.25)},
        {"order": 5, "mode": 1, "speed_hz": pytest.approx(105.0 / 4.25)},
        {"order": 5, "mode": 2, "speed_hz": pytest.approx(295.0 / 5.25)},
    ]
    assert told["southwell"] == [1.5, -0.25]
    assert told["freq_hz"] == DATA.freq.tolist()
    assert told["overlap"] == DATA.overlap.tolist()
    speeds, head, first, second, _, met, none = DATA.table(orders=4).splitlines()
    assert speeds == "speeds 0 to 60 Hz"
    assert head == "mode  at first speed [Hz]  at last speed [Hz]  Southwell"
    assert first.split() == ["1", "100.000", "150.000", "1.5000"]
    assert second.split() == ["2", "300.000", "280.000", "-0.2500"]
    assert met.split() == ["1", *"3 at 46.67 Hz, 4 at 32.31 Hz".split()]
    assert none.split() == ["2", "-"]
    assert [list(row) for row in DATA.records()] == [["speed_hz", "mode1_hz", "mode2_hz"]] * 3
    assert "8 at" in repr(DATA)
    assert "9 at" not in repr(DATA)


def test_a_diagram_is_a_table_of_speeds():
    comment, head, *rows = DATA.to_csv().splitlines()
    assert comment == "# COMPUTED: frequencies in the rotating frame"
    assert head == "speed_hz,mode1_hz,mode2_hz"
    np.testing.assert_allclose([[float(cell) for cell in row.split(",")] for row in rows],
                               [[0.0, 100.0, 300.0], [20.0, 120.0, 290.0], [60.0, 150.0, 280.0]])  # fmt: skip


@pytest.mark.parametrize(("n", "folded"), [(0, 0), (3, 3), (4, 3), (6, 1), (7, 0), (9, 2), (18, 3)])
def test_diameters_fold_at_half_the_number_of_blades(n, folded):
    assert cf.modal.DiskFrequencies(blades=7, freq={}).folded(n) == folded
    assert cf.modal.DiskFrequencies(blades=7, freq={folded: (5.0,)}).of(n) == (5.0,)


@pytest.mark.parametrize(
    ("blades", "n", "said"), [(7, 4, "7 blades and nodal diameters [4]"), (0, 0, "0 blades"), (7, -1, "[-1]")]
)
def test_a_disk_that_is_none_is_refused(blades, n, said):
    with pytest.raises(cf.errors.ModelError) as caught:
        cf.modal.DiskFrequencies(blades=blades, freq={n: (1.0,)})
    assert said in str(caught.value)
    assert cf.modal.DiskFrequencies(blades=7, freq={3: (1.0,), 0: (2.0,)}).of(4) == (1.0,)
    assert cf.modal.DiskFrequencies(blades=1, freq={0: (2.0,)}).of(5) == (2.0,)


def test_meetings_of_one_pair_have_all_three_conditions():
    """n = 4 at 100 Hz, blade at 60 and 260 Hz: 4 f = 160, 360, 40, 160; the blade's modes are counted from 1."""
    found = cf.interactions({4: [100.0], 2: [30.0]}, [60.0, 260.0], speed_hz=(0.0, 90.0))
    told = [(c.speed_hz, c.n, c.m, c.blade, c.branch, c.casing_hz, c.blade_hz) for c in found.meetings]
    expected = [
        (10.0, 4, 1, 1, "backward", 100.0, 60.0), (15.0, 2, 1, 1, "forward", 30.0, 60.0),
        (40.0, 4, 1, 1, "sum", 100.0, 60.0), (40.0, 4, 1, 2, "forward", 100.0, 260.0),
        (45.0, 2, 1, 1, "sum", 30.0, 60.0), (90.0, 4, 1, 2, "sum", 100.0, 260.0),
    ]  # fmt: skip
    assert told == [
        tuple(pytest.approx(value) if isinstance(value, float) else value for value in row) for row in expected
    ]
    assert [row["effect"] for row in found.records()][:3] == [
        "resonance; flutter if mu > tan(lean)", "resonance; flutter if mu > tan(lean)", "flutter, even without friction"
    ]  # fmt: skip
    assert [c.wave for c in found.meetings][:3] == ["forward", "backward", "forward, overtaken"]
    assert "6 coincidences from 0 to 90 Hz, the blade turns" in repr(found)


@pytest.mark.parametrize(("high", "said"), [(24.9, True), (25.1, False)])
def test_a_sum_out_of_reach_is_reported_by_the_pair_that_comes_nearest(high, said):
    """n f of 100 Hz for n = 4; n = 2 of 60 Hz is farther."""
    text = repr(cf.interactions({4: [100.0], 2: [60.0]}, [20.0], speed_hz=(0.0, high)))
    assert (f"n f = {4 * high:.4g} Hz < f_c = 100 Hz" in text) == said


def test_speeds_that_are_no_range_are_refused():
    for speeds in ((5.0, 5.0), (-1.0, 5.0), (0.0, np.inf)):
        with pytest.raises(cf.errors.ModelError, match="found speeds from"):
            cf.interactions({4: [100.0]}, [20.0], speed_hz=speeds)
