"""Rows of the table of interactions from maps and coincidences made by hand, and how they are told."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.growth.closed_contact import floor_of, growth, poles
from contact.growth.coincidence import Coincidence
from contact.growth.growth_map import StabilityMap
from contact.growth.interaction_table import (
    COLUMNS,
    Interaction,
    Interactions,
    _band_row,
    _pressed,
    _row,
    pulse_ratio,
    turns,
)
from contact.model.gaps.permanent import HandPair, ModalPair, disk_contact, rub_contact
from tests.contact.synthetic_rim import blade, ring

PAIR = HandPair(
    casing=ModalPair(n=8, freq_hz=300.0, modal_mass=1.5), blade=ModalPair(freq_hz=120.0, modal_mass=0.4),
    compliance=1e-4,
)  # fmt: skip
MET = Coincidence(n=4, branch="sum", casing_hz=300.0, blade_hz=120.0, free_hz=104.0, speed_hz=105.0, half_hz=0.5,
                  growth=1.0, drives=True)  # fmt: skip
SEEN = (100.0, 102.0, 103.0, 104.0, 106.0, 108.0)


def mapped(rates, bands=(), seen=SEEN, grid=(100.0, 102.0, 104.0)):
    seen, rates = np.array(seen), np.array(rates, dtype=float)
    return StabilityMap(speed_hz=np.array(grid), growth=np.zeros(3), peak_speed_hz=106.0, peak_growth=3.0,
                        bands_hz=tuple(bands), seen_hz=seen, seen_growth=rates)  # fmt: skip


def test_turns_grow_a_thousandfold_where_growth_is_above_the_floor():
    assert turns(50.0, 4.0) == pytest.approx(50.0 * math.log(1000.0) / 4.0, rel=1e-14)
    assert turns(50.0, 0.5, 0.25) == pytest.approx(100.0 * math.log(1000.0), rel=1e-14)
    for rate, floor in ((0.0, 0.0), (-1.0, 0.0), (0.25, 0.25)):
        assert math.isnan(turns(50.0, rate, floor))


def test_a_row_has_the_fastest_growth_within_a_step_of_the_grid_or_its_band():
    contact = PAIR.contact()
    row = _row(MET, mapped([9.0, 9.0, 1.0, 2.0, 3.0, 9.0], [(105.5, 106.0)]), contact, 0.7)
    assert (row.growth_hz, row.growth, row.from_hz, row.to_hz, row.pulses) == (106.0, 3.0, 105.5, 106.0, 0.7)
    assert (row.n, row.branch, row.casing_hz, row.blade_hz, row.free_hz) == (4, "sum", 300.0, 120.0, 104.0)
    assert (row.closed_hz, row.wave_hz) == (105.0, 75.0)
    assert row.turns == pytest.approx(106.0 * math.log(1000.0) / 3.0, rel=1e-14)
    narrow = replace(MET, half_hz=1.0)
    assert _row(narrow, mapped([9.0, 9.0, 1.0, 7.0, 3.0, 9.0]), contact, 0.7).growth_hz == 104.0
    at_bound = mapped([9.0, 9.0, 8.0, 2.0, 3.0, 9.0], [(103.0, 104.0)])
    assert _row(MET, at_bound, contact, 0.7).growth_hz == 103.0  # two away, as far as the grid steps
    assert _row(MET, at_bound, contact, 0.7).from_hz == 103.0
    wide = _row(replace(MET, half_hz=3.0), mapped([9.0, 9.5, 8.0, 2.0, 3.0, 9.0]), contact, 0.7)
    assert wide.growth_hz == 102.0
    assert np.isnan([wide.from_hz, wide.to_hz]).all()


def test_a_row_below_the_floor_has_no_turns_and_several_contacts_no_closed_speed():
    floor = floor_of(PAIR.contact())
    still = mapped([0.0, 0.0, 0.0, 0.0, 0.9 * floor, 0.0])
    assert math.isnan(_row(MET, still, PAIR.contact(), 0.0).turns)
    pair = ModalPair(n=5, freq_hz=300.0, modal_mass=2.0)
    two = disk_contact(pair, replace(pair, freq_hz=120.0), stiffness=1e3, blades=22)
    assert math.isnan(_row(MET, still, two, 0.0).closed_hz)


def test_a_band_without_a_coincidence_has_the_fastest_growth_inside_it():
    found, contact = mapped([9.0, 5.0, 1.0, 2.0, 6.0, 9.0]), replace(PAIR.contact(), mu=0.2)
    row = _band_row((102.0, 106.0), found, contact, 0.3)
    assert (row.n, row.branch, row.growth, row.growth_hz) == (0, "friction", 6.0, 106.0)
    assert (row.from_hz, row.to_hz, row.pulses) == (102.0, 106.0, 0.3)
    assert row.turns == pytest.approx(106.0 * math.log(1000.0) / 6.0, rel=1e-14)
    assert np.isnan([row.casing_hz, row.blade_hz, row.free_hz, row.closed_hz, row.wave_hz]).all()
    lower = _band_row((102.0, 104.0), found, PAIR.contact(), 0.3)
    assert (lower.growth_hz, lower.branch) == (102.0, "several at once")
    slow = mapped([0.0, 0.0, 0.0, 0.0, 0.9 * floor_of(contact), 0.0])
    assert math.isnan(_band_row((102.0, 106.0), slow, contact, 0.3).turns)


ROW = Interaction(
    n=8, branch="sum", casing_hz=300.0, blade_hz=120.25, free_hz=52.5, closed_hz=52.84375, wave_hz=37.5,
    from_hz=52.6875, to_hz=52.9375, growth=3.75, growth_hz=52.84375, turns=97.5, pulses=0.25,
)  # fmt: skip
FEEDS = replace(
    ROW, n=0, branch="friction", casing_hz=math.nan, blade_hz=math.nan, free_hz=math.nan, closed_hz=math.nan,
    wave_hz=math.nan, from_hz=math.nan, turns=math.nan,
)  # fmt: skip


def test_the_lines_of_the_table():
    assert ROW.words.split() == (
        "8 f_c + f_b = n f 300.00 120.25 52.5000 52.8438 37.500 52.6875-52.9375 3.75 52.8438 97.5 0.25".split()
    )
    assert replace(ROW, branch="forward").words.split()[1:8] == "f_b = f_c + n f 300.00".split()
    assert FEEDS.words.split() == "0 friction - - - - - - 3.75 52.8438 - 0.25".split()
    assert len(FEEDS.words) == len(ROW.words)


def table(**changes):
    none = np.zeros((0, 0))
    # fmt: off
    given = {"rows": (ROW,), "map": mapped(np.zeros(6)), "waves": ((8, 300.0, 37.5),), "opens_hz": (),
             "averaged": False, "blade_hz": (120.0,), "pole_speed_hz": none, "pole_hz": none, "pole_growth": none,
                 "seen_hz": none}
    # fmt: on
    return Interactions(**given | changes)


def test_what_is_told_below_the_table():
    head, first, *rest = repr(table()).splitlines()
    assert head.split() == ["n", "condition", *list(COLUMNS)[2:]]
    assert first == ROW.words
    assert "The blade runs as fast as a wave, f_c/n, at no speed of this range." in rest
    assert "Contact stays closed in all of this range until a vibration opens it." in rest
    assert not any("split" in line for line in rest)
    assert f"{'growth':>9}: {COLUMNS['growth']}" in rest
    edges = repr(
        table(waves=((8, 800.0, 100.0), (9, 900.0, 104.0), (7, 1.0, 104.5)), opens_hz=((1.0, 2.5), (4.0, 5.0)))
    )
    assert "f_c/n, at 100 Hz (n = 8), 104 Hz (n = 9)." in edges
    assert "Contact cannot stay closed at 1-2.5 Hz, 4-5 Hz: pulses there" in edges
    assert "The casing's pairs are split: this is their mean;" in repr(table(averaged=True))


def test_the_document_of_the_table():
    found = table(rows=(FEEDS,), opens_hz=((1.0, 2.0),), averaged=True).to_dict()
    assert found["interactions"][0]["growth"] == 3.75
    assert found["interactions"][0]["casing_hz"] is None
    assert found["waves"] == [{"n": 8, "casing_hz": 300.0, "wave_hz": 37.5}]
    assert (found["opens_hz"], found["averaged"], found["columns"]) == ([[1.0, 2.0]], True, COLUMNS)
    assert table().to_dict()["averaged"] is False
    assert table().records()[0]["n"] == 8
    assert table().worst_hz == 106.0


def test_rows_stand_by_growth_and_speeds_of_a_coincidence_may_be_the_ends_of_the_range():
    free = ct.growth.interactions(PAIR, np.linspace(20.0, 60.0, 9)).rows
    assert [row.branch for row in free] == ["sum", "backward"]
    low, high = sorted(row.closed_hz for row in free)
    assert len(ct.growth.interactions(PAIR, [low, high]).rows) == 2
    assert len(ct.growth.interactions(PAIR, [low * (1.0 + 1e-12), high * (1.0 - 1e-12)]).rows) == 1  # of the band alone


def test_poles_that_the_blade_sees_are_those_of_positive_frequency():
    found, contact = ct.growth.interactions(PAIR, [20.0, 60.0]), PAIR.contact()
    assert found.pole_speed_hz.tolist() == pytest.approx(np.linspace(20.0, 60.0, 161).tolist(), rel=1e-14)
    every = poles(contact, found.pole_speed_hz[[7]])[0]
    upper = np.sort(every[every.imag > 0.0].imag) / (2.0 * np.pi)
    assert found.pole_hz[7] == pytest.approx(upper, rel=1e-9)
    assert found.pole_growth.max() == pytest.approx(growth(contact, found.pole_speed_hz).max(), rel=1e-9)
    assert found.blade_hz == (pytest.approx(120.0),)
    assert found.opens_hz == ()


def tips(apart=50.0):
    each = [ct.ContactPoint(blade=k, angle_deg=apart * k) for k in range(2)]
    return ct.Rub(ring(zeta=0.1, S=1e-5), (blade(zeta=0.1), blade(zeta=0.1, psi=0.8)), each, clearance=-1e-5)


def stiffness(contact, hz, freq_hz):
    """(S + Q ((s + Omega G)^2 + ...)^-1 Q^T)^-1 by its states, s = i 2 pi freq_hz."""
    m, spin = contact.omega.size, 2.0 * np.pi * hz * contact.G
    A = np.block(
        [[-spin, np.eye(m)], [-np.diag(contact.omega**2), -spin - np.diag(2.0 * contact.zeta * contact.omega)]]
    )
    given = np.vstack([np.zeros((m, len(contact.Q))), contact.pushes(np.sign(hz)).T])
    q = np.linalg.solve(2j * np.pi * freq_hz * np.eye(2 * m) - A, given)[:m]
    return np.linalg.inv(contact.compliance(np.sign(hz)) + contact.Q @ q)


@pytest.mark.parametrize("hz", [20.0, -11.0])
def test_pulses_of_several_waves_are_the_sum_of_their_forces_over_the_least_at_rest(hz):
    contact = rub_contact(tips(), mu=0.2)
    press, at = np.array([1e-5, 3e-5]), np.radians([0.0, 50.0])
    terms = [(0, 5e-5, 0.0), (2, 3e-6, -4e-6), (4, 0.0, 0.0), (3, 0.0, 2e-6)]
    sizes = [np.abs(stiffness(contact, hz, p * hz) @ np.exp(-1j * p * at)).max() for p in (2, 3)]
    still = (stiffness(contact, hz, 0.0) @ press).real.min()
    found = pulse_ratio(contact, np.array([hz]), press, terms, at)
    assert found == pytest.approx([(5e-6 * sizes[0] + 2e-6 * sizes[1]) / still], rel=1e-9)


def test_a_contact_that_does_not_press_has_infinite_pulses():
    contact = rub_contact(tips())
    for press in ([1e-5, 0.0], [1e-5, -1e-9]):
        assert np.isinf(pulse_ratio(contact, np.array([20.0, 30.0]), np.array(press), [])).all()
    side_by_side = rub_contact(tips(5.0))  # the one that presses harder lifts the rim off the other
    assert np.isinf(pulse_ratio(side_by_side, np.array([20.0]), np.array([2e-5, 1e-5]), [], np.radians([0.0, 5.0])))
    assert pulse_ratio(contact, np.array([20.0]), np.array([1e-5, 1e-5]), []).tolist() == [0.0]


def test_what_presses_of_a_pair_is_one_and_of_a_rim_its_overlap():
    press, angle, terms = _pressed(PAIR)
    assert (press.tolist(), angle.tolist(), terms) == ([1.0], [0.0], [])
    rim = ct.RotatingRim(ring(), blade(), clearance=-3e-5, speed_hz=5.0, angle_deg=30.0,
                         out_of_roundness=[{"p": 0, "cos": 1e-5}])  # fmt: skip
    press, angle, _ = _pressed(rim)
    assert (press.tolist(), angle.tolist()) == (pytest.approx([2e-5]), pytest.approx([np.pi / 6.0]))
