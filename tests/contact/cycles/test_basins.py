"""What runs from random starts reach are the stable orbits of the branch, and nothing else."""

import math

import numpy as np
import pytest

import contact as ct
from reports.verification.schemes.cycles import mass_on_stop, rod
from tests.contact.cycles.test_closed_forms import ball

pytestmark = pytest.mark.slow


def test_between_the_folds_some_starts_stay_small_and_others_touch():
    family = mass_on_stop(100.0).over("freq_hz", freq_hz=0.2)
    found = ct.cycles.follow(family, (0.15, 0.26), longest=0.1).branches[0]
    value = 0.23
    at = found.value
    met = [found.points[k] for k in np.flatnonzero((at[:-1] - value) * (at[1:] - value) <= 0.0)]
    orbits = [ct.cycles.orbit(family, value, guess=np.array(point.x)) for point in met]
    stable = sorted(one.amplitude["x"] for one in orbits if one.stable)
    assert [one.stable for one in orbits] == [True, False, True]
    reached = ct.cycles.basins(family, value, np.array([0.3, 0.3]), starts=8, seed=9, settle=150)
    assert sorted(one.amplitude["x"] for one in reached.attractors) == pytest.approx(stable, rel=1e-6)
    assert sum(one.share for one in reached.attractors) == pytest.approx(1.0)
    assert reached.attractors[0].share >= reached.attractors[1].share > 0.0
    for number, one in enumerate(reached.attractors):
        assert reached.reached.count(number) == pytest.approx(8 * one.share)
    assert "8 starts at freq_hz 0.23" in repr(reached)


def test_a_ball_beyond_its_flip_bounces_high_and_low_in_turn():
    family = ball(15.5, height=0.1).over("amplitude", freq_hz=20.0 / (2.0 * math.pi))
    reached = ct.cycles.basins(family, 15.5, np.array([0.1, 0.1]), starts=6, seed=4, settle=80)
    two = next(one for one in reached.attractors if one.periods == 2)
    orbit = ct.cycles.orbit(family, 15.5, guess=two.states[0], start=0.0, periods=2)
    assert orbit.stable
    assert two.amplitude["y"] == pytest.approx(orbit.amplitude["y"], rel=1e-6)
    assert (reached.starts[:, 0] >= -1e-12).all()  # none begins below the table


def test_what_does_not_close_is_not_called_periodic():
    """The rod before a stiff obstacle where its large orbit is left: runs stay near it, and are quasi-periodic."""
    family = rod(4.0).over("freq_hz", freq_hz=10e3)
    found = ct.cycles.follow(family, (10.2e3, 10.35e3), longest=0.2).branches[0]
    large = found.points[-1]
    assert not large.stable
    reached = ct.cycles.basins(family, 10.35e3, 3.0 * np.array(large.x), starts=3, seed=2, settle=200)
    assert -1 in reached.reached
    assert all(one.amplitude["x"] < 0.9 * large.amplitude["x"] for one in reached.attractors)
