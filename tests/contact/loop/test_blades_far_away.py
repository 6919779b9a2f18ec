"""A blade that never touches changes nothing: the steps of a single tip against those of several."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring

H = 2e-5
SOFT = {"E": 1e9, "yield_stress": 1e3, "hardening": 1e6, "thickness": 1e-3, "width": 0.02, "tip": 6e-3, "bars": 3}
WAVES = [{"p": 2, "cos": 2e-5}, {"p": 5, "sin": 1e-5}]


@pytest.mark.slow  # it compiles the loop of a coating
@pytest.mark.parametrize(
    ("mu", "machined", "law"),
    [
        (0.1, 0.0, "averaged"), (0.1, 1.5e-5, "forward"), (0.0, 1.5e-5, "averaged"), (0.4, None, "forward"),
        (0.2, None, "averaged"), (0.0, None, "averaged"),
    ],
)  # fmt: skip
def test_a_tip_presses_rubs_and_wears_as_if_a_far_blade_were_not_there(mu, machined, law):
    clearance, body = -2e-5 - 0.5 * (machined or 0.0), {"S": 4e-7, "zeta": 0.01, "imperfect": 0.05}
    friction = ct.Coulomb(mu=mu) if machined is None else ct.Abradable(**SOFT, mu=mu, machined=machined)
    rim = ct.RotatingRim(
        ring(**body), blade(S=1e-6, zeta=0.01), clearance=clearance, speed_hz=15.0, lean_deg=20.0,
        out_of_roundness=WAVES, angle_deg=13.0,
    )  # fmt: skip
    tips = [ct.ContactPoint(blade=0, lean_deg=20.0, angle_deg=13.0), ct.ContactPoint(blade=1, clearance=0.02)]
    rub = ct.Rub(
        rim.casing, [rim.blade, rim.blade], tips, clearance=clearance, profile=ct.gaps.RimProfile.fourier(WAVES),
        speed=ct.Speed.constant(15.0),
    )  # fmt: skip
    record, scheme = ct.Record(every=1, state_every=5), ct.ExactModal(law=law)
    one, other = (ct.run(what, law=friction, scheme=scheme, t_end=600 * H, dt=H, record=record) for what in (rim, rub))
    m = rim.casing.omega.size + rim.blade.omega.size
    assert one.contact_steps[0] == other.contact_steps[0] > 50
    assert other.contact_steps[1] == 0
    for name in ("force", "gap", "impulse", "peak_force", "impulse_history"):
        exact, found = getattr(one, name), getattr(other, name)[..., :1]
        least = 1e-11 * abs(clearance) if name == "gap" else 0.0  # a closed gap is round-off
        np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-11 * np.abs(exact).max() + least)
    np.testing.assert_allclose(other.state[:, :m], one.state[:, :m], rtol=0.0, atol=1e-12 * np.abs(one.state).max())
    assert len(one.intervals[0]) == len(other.intervals[0])
    for name in ("contact", "rotation", "friction", "damping"):
        assert getattr(other.energy, name) == pytest.approx(getattr(one.energy, name), rel=1e-9, abs=1e-12), name
    for budget in (one.energy, other.energy):
        assert abs(budget.unaccounted) <= 1e-10 * budget.scale
    assert other.energy.end.residual == pytest.approx(one.energy.end.residual, rel=1e-9, abs=1e-18)
    for name in ("heat", "drive") if mu else ():
        assert getattr(other.notes, name)[0] == pytest.approx(getattr(one.notes, name)[0], rel=1e-9)
    if machined is not None:
        wear, worn = other.wear, one.wear.worn
        assert worn.max() > 1e-8
        np.testing.assert_allclose(wear.worn, worn, rtol=0.0, atol=1e-10 * worn.max())
        assert wear.dissipated == pytest.approx(one.wear.dissipated, rel=1e-9)


@pytest.mark.slow  # it compiles the loop of many tips
def test_forty_tips_press_an_odd_number_of_modes_as_if_one_more_were_not_seen():
    even = ring(S=4e-7, zeta=0.01, imperfect=0.05)
    odd = replace(even, omega=even.omega[:-1], zeta=even.zeta[:-1], rows=even.rows[:, :-1])
    unseen = replace(even, rows=np.where(np.arange(even.omega.size) == even.omega.size - 1, 0.0, even.rows))
    tips = [ct.ContactPoint(blade=j, lean_deg=20.0, angle_deg=9.0 * j) for j in range(40)]
    found = [
        ct.run(
            ct.Rub(casing, [blade(S=1e-6, zeta=0.01)] * 40, tips, clearance=-1e-5, speed=ct.Speed.constant(15.0)),
            law=ct.Coulomb(mu=0.1), scheme=ct.ExactModal(), t_end=200 * H, dt=H, record=ct.Record(every=1),
        )
        for casing in (odd, unseen)
    ]  # fmt: skip
    assert found[0].peak_force.min() > 0.0
    np.testing.assert_allclose(found[0].force, found[1].force, rtol=0.0, atol=1e-9 * found[0].peak_force.max())
