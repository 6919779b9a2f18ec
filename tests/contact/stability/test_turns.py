"""Growth per turn of a split casing: bounds of its steps, and what a turn without contact does to every state."""

import math

import numpy as np
import pytest

import contact as ct
from contact.model.gaps.modal_system import rim_system
from contact.model.gaps.rub import rub_of
from contact.model.gaps.rub_system import matrices_of
from contact.stability import split_casing as floquet
from contact.stability.split_casing import fastest, floquet_growth
from tests.contact.synthetic_rim import blade, ring


def rim(**more):
    given = {"clearance": -1e-5, "speed_hz": 5.0, "lean_deg": 10.0} | more
    return ct.RotatingRim(ring(imperfect=0.05), blade(), **given)


def test_the_fastest_vibration_is_bounded_by_the_stiffest_of_sixty_four_angles():
    system, mu = rim_system(rim()), 0.3
    stiffest = 0.0
    for phi in 2.0 * np.pi * np.arange(64) / 64:
        Q, T = system.table.rows_at(np.array([phi]))
        S = system.S_nn(phi) - mu * system.S_nt(phi)
        stiffest = max(stiffest, np.linalg.norm(Q) * np.linalg.norm(Q - mu * T) / S)
    C, K = matrices_of(rub_of(rim())).at(system.speed)
    assert fastest(system, C, K, mu) == pytest.approx(math.sqrt(system.omega.max() ** 2 + stiffest), rel=1e-12)
    pair = np.zeros_like(C)
    pair[0, 1], pair[1, 0] = 800.0, -800.0  # its waves are 400 rad/s slower and faster than their mean
    found = 400.0 + math.sqrt(400.0**2 + system.omega.max() ** 2 + stiffest)
    assert fastest(system, C + pair, K, mu) == pytest.approx(found, rel=1e-12)


@pytest.mark.parametrize(("hz", "sense"), [(5.0, 1.0), (-5.0, -1.0)])
def test_growth_is_that_of_the_largest_multiplier_over_a_turn(hz, sense, monkeypatch):
    """A turn that makes two states three times as large, in a fifth of a second; friction has the sign of the speed."""
    asked = []

    def turn(system, C, K, mu, phase):
        asked.append((system.speed, mu, phase))
        return np.diag([0.5, -3.0, 1.0])

    monkeypatch.setattr(floquet, "monodromy", turn)
    assert floquet_growth(rim(), hz, mu=0.2) == pytest.approx([5.0 * math.log(3.0)], rel=1e-12)
    assert asked == [(pytest.approx(2.0 * math.pi * hz), 0.2 * sense, 0.4)]
    assert floquet_growth(rim(), [hz, 2.0 * hz], phase=0.1) == pytest.approx(
        [5.0 * math.log(3.0), 10.0 * math.log(3.0)]
    )
    assert asked[1:] == [(pytest.approx(2.0 * math.pi * f), 0.0, 0.1) for f in (hz, 2.0 * hz)]


def test_kicks_of_a_step_make_it_of_order_four():
    """Five steps of order two of parts p: their sum is 1, that of their cubes none (Suzuki, 1990)."""
    assert floquet.KICKS.sum() == pytest.approx(1.0, rel=1e-14)
    assert np.sum(floquet.KICKS**3) == pytest.approx(0.0, abs=1e-14)
    assert floquet.KICKS.size == 5
