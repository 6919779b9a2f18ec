"""A tip in a coating: the loop of one rim against that of rubs, which share no step; uncompiled."""

import numpy as np
import pytest

from tests.contact.plain import plain

H = 2e-5
SOFT = {"E": 1e9, "yield_stress": 1e3, "hardening": 1e6, "thickness": 1e-3, "width": 0.02, "tip": 6e-3, "bars": 3}
WAVES = [{"p": 2, "cos": 2e-5}, {"p": 5, "sin": 1e-5}]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mu", "machined", "law"),
    [(0.1, 0.0, "averaged"), (0.1, 1.5e-5, "forward"), (0.0, 1.5e-5, "averaged"), (0.4, None, "forward")],
)
def test_one_tip_wears_and_rubs_as_the_rim_does(mu, machined, law):
    with plain() as module:
        ct, made = module("contact"), module("tests.contact.synthetic_rim")
        friction = ct.Coulomb(mu=mu) if machined is None else ct.Abradable(**SOFT, mu=mu, machined=machined)
        clearance, body = -2e-5 - 0.5 * (machined or 0.0), {"S": 4e-7, "zeta": 0.01}
        blade = made.blade(S=1e-6, zeta=0.01)
        rim = ct.RotatingRim(
            made.ring(**body), blade, clearance=clearance, speed_hz=15.0, lean_deg=20.0, out_of_roundness=WAVES,
            angle_deg=13.0,
        )  # fmt: skip
        rub = ct.Rub(
            made.ring(**body), [blade], [ct.ContactPoint(blade=0, lean_deg=20.0, angle_deg=13.0)], clearance=clearance,
            profile=ct.RimProfile.fourier(WAVES), speed=ct.Speed.constant(15.0),
        )  # fmt: skip
        record = ct.Record(every=1, state_every=5)
        one, other = (
            ct.run(what, law=friction, scheme=ct.ExactModal(law=law), t_end=190 * H, dt=H, record=record)
            for what in (rim, rub)
        )
    assert one.contact_steps[0] == other.contact_steps[0] > 10
    for name in ("force", "gap", "state", "impulse", "peak_force", "impulse_history", "time", "state_time"):
        exact = getattr(one, name)
        np.testing.assert_allclose(getattr(other, name), exact, rtol=0.0, atol=1e-9 * np.abs(exact).max() + 1e-16)
    np.testing.assert_allclose(other.intervals[0], one.intervals[0], rtol=0.0, atol=1e-10)
    for name in ("contact", "rotation", "friction", "damping"):
        exact = getattr(one.energy, name)
        assert getattr(other.energy, name) == pytest.approx(exact, rel=1e-7, abs=1e-11 * one.energy.scale)
    for budget in (one.energy, other.energy):
        assert abs(budget.unaccounted) <= 1e-10 * budget.scale
    assert other.energy.end.residual == pytest.approx(one.energy.end.residual, rel=1e-7, abs=1e-15)
    for name in ("heat", "drive") if mu else ():
        assert getattr(other.notes, name) == pytest.approx(getattr(one.notes, name), rel=1e-7, abs=1e-13)
    if machined is not None:
        scale = one.wear.worn.max()
        assert scale > 1e-8
        np.testing.assert_allclose(other.wear.worn, one.wear.worn, rtol=0.0, atol=1e-9 * scale)
        np.testing.assert_allclose(other.wear.cut, one.wear.cut, rtol=0.0, atol=1e-18)
        assert (one.wear.cut.max() > 0.0) == (machined > 0.0)
        for wear in (one.wear, other.wear):
            assert wear.dissipated == pytest.approx(wear.stated, rel=1e-10)
