"""The references checked against each other."""

import numpy as np
import pytest

import contact as ct
from contact.exact import bar_by_characteristics, bouncing_bar, rod_on_wall, two_rods

BAR = {"length": 10.0, "area": 1.0, "E": 900.0, "rho": 1.0, "x": 5.0}


def test_two_rods_published_values():
    exact = two_rods(ct.Rod(length=10.0, area=1.0, E=30e6, rho=7.34e-4), gap=0.01, velocity=202.2)
    assert exact.intervals[0, 0] == pytest.approx(4.9456e-5, rel=1e-5)
    assert exact.intervals[0, 1] - exact.intervals[0, 0] == pytest.approx(9.8928e-5, rel=1e-5)
    assert exact.force[0, 0] == pytest.approx(15002.0, rel=1e-4)


def test_characteristics_give_the_closed_forms():
    drop = bar_by_characteristics(ct.Rod(**BAR), gravity=10.0, t_end=160.0 / 3.0, cells=30)
    middle = 0.5 * (drop.time[1:] + drop.time[:-1])
    assert np.abs(drop.force - bouncing_bar(20)(middle)).max() <= 1e-9 * 500.0
    assert drop.gap[-1] == pytest.approx(5.0, abs=1e-9)
    shot = ct.Rod(**BAR, velocity=-10.0)
    history = bar_by_characteristics(shot, gravity=0.0, t_end=2.0, cells=60)
    middle = 0.5 * (history.time[1:] + history.time[:-1])
    assert np.abs(history.force - rod_on_wall(shot, gap=5.0, velocity=10.0)(middle)).max() <= 1e-9
