"""What a result says beside its table: what never touched, what did not settle, what is stored, tracks and flags."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct

STILL = ct.record.Stored(kinetic=2.0, strain=0.0, potential=0.0, residual=0.0, discrete=2.0)
ENERGY = ct.record.EnergyBudget(start=STILL, end=STILL, contact=0.0, rotation=0.0, friction=0.0, damping=0.0)
GAP = np.array([[0.5, 0.75], [0.25, 0.125], [0.375, 0.5]])
CALM = ct.Result(
    time=np.array([0.0, 0.25, 0.5]), force=np.zeros((3, 2)), gap=GAP, impulse_history=np.zeros((3, 2)),
    impulse=np.zeros(2), peak_force=np.zeros(2), max_penetration=np.zeros(2), residual=np.zeros(2),
    contact_steps=np.zeros(2), reversals=np.zeros(2), state_time=np.array([0.25]), state=np.array([[1.0, 2.0, 3.0]]),
    intervals=((), ()), energy=ENERGY, motions=(), blocks=(("casing", 0, 2), ("blade", 2, 3)), steps=3, dt=0.25,
    window=0.5, seconds=0.3, scheme="some scheme", source={}, channels=np.zeros((0, 3)),
)  # fmt: skip


def test_a_calm_result_states_no_more_than_its_table():
    lines = repr(CALM).splitlines()
    assert len(lines) == 6
    assert lines[4] == "no contact closed: the smallest gap was 0.125 m, at contact 2 and 0.25 s"
    assert lines[5].startswith("energy [J]: start 2, end 2")
    assert len(repr(replace(CALM, intervals=((), ((0.0, 0.25),)))).splitlines()) == 5
    assert (
        len(repr(replace(CALM, time=CALM.time[:0], gap=GAP[:0], force=GAP[:0], impulse_history=GAP[:0])).splitlines())
        == 5
    )


def test_the_least_gap_and_columns_of_a_body():
    assert CALM.least_gap.tolist() == [0.25, 0.125]
    assert np.isnan(replace(CALM, gap=GAP[:0]).least_gap).tolist() == [True, True]
    assert CALM.state_of("casing").tolist() == [[1.0, 2.0]]
    assert CALM.state_of("blade").tolist() == [[3.0]]
    with pytest.raises(
        ct.InputError, match=r"name: found 'blad', expected one of casing, blade \(did you mean blade\?\)"
    ):
        CALM.state_of("blad")
    with pytest.raises(ct.InputError, match="state: found 2 channels of all bodies, expected a record without"):
        replace(CALM, channels=np.ones((2, 3))).state_of("casing")


def test_what_is_stored_is_reported_unless_it_is_every_step():
    assert "stored" not in repr(CALM)
    assert "stored: 3 samples, one of every 4 steps (at most 1,000,000 samples unless" in repr(replace(CALM, every=4))
    assert "stored: 3 samples, at the steps nearest to the instants; sums" in repr(replace(CALM, every=0))


def test_the_energy_of_an_impact_is_a_quarter_of_impulse_times_speed():
    """Of each contact by its closings, at the greatest rate at which its gap ever changed."""
    hit = replace(CALM, impulse=np.array([8.0, 3.0]), intervals=(((0.0, 0.25), (0.25, 0.5)), ()))
    assert hit.impact_energy == 0.25 * max(8.0 / 2.0 * 1.0, 3.0 / 1.0 * 2.5)
    assert replace(hit, impulse=np.array([80.0, 3.0])).impact_energy == 0.25 * 40.0 * 1.0
    assert replace(hit, time=hit.time[:1], gap=GAP[:1]).impact_energy == 0.0
    assert replace(hit, time=hit.time[:2], gap=GAP[:2]).impact_energy == 0.25 * 3.0 * 2.5
