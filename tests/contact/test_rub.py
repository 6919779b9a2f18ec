"""Several tips before one turning rim: against the one-contact run, closed forms and the laws themselves."""

import numpy as np
import pytest
from synthetic_rim import blade, ring

import contact as ct

WAVES = [{"p": 2, "cos": 2e-5}, {"p": 3, "sin": 1e-5}]


def law(mu):
    return ct.Coulomb(mu=mu) if mu else ct.Unilateral()


def one_tip(*, S=1e-8, imperfect=0.0, speed_hz=5.0):
    """The same scene twice: as a RotatingRim and as a Rub with one tip."""
    bodies = ring(S=S, imperfect=imperfect), blade(S=2.0 * S)
    rim = ct.RotatingRim(
        *bodies, clearance=-1e-5, speed_hz=speed_hz, lean_deg=25.0, out_of_roundness=WAVES, angle_deg=13.0
    )
    rub = ct.Rub(
        bodies[0], bodies[1:], [ct.Tip(lean_deg=25.0, angle_deg=13.0)], clearance=-1e-5,
        speed=ct.Speed.constant(speed_hz), profile=ct.Profile.fourier(WAVES),
    )  # fmt: skip
    return rim, rub


@pytest.mark.parametrize("S", [0.0, 1e-8])
@pytest.mark.parametrize("imperfect", [0.0, 0.05])
@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_one_sliding_tip_is_the_rotating_rim(S, imperfect, mu):
    record = ct.Record(state_every=1)
    rim, rub = (
        ct.run(scene, law=law(mu), t_end=0.05, dt=1e-5, record=record) for scene in one_tip(S=S, imperfect=imperfect)
    )
    assert ("averaged" in rim.scheme) == ("averaged" in rub.scheme) == (S > 0.0)
    assert np.abs(rub.force - rim.force).max() <= 1e-10 * rim.force.max()
    assert np.abs(rub.state - rim.state).max() <= 1e-12 * np.abs(rim.state).max()
    assert np.abs(rub.gap - rim.gap).max() <= 1e-16
    assert len(rub.intervals[0]) == len(rim.intervals[0])
    assert rub.energy.rotation == pytest.approx(rim.energy.rotation, rel=2e-2)
    assert abs(rub.energy.unaccounted) <= 1e-11 * rub.energy.scale
