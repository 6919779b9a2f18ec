"""Lanes of unlike rims against runs alone; as plain Python."""

import numpy as np
import pytest

from tests.contact.plain import plain


def turning(module, *, imperfect=0.05, clearance=-1e-5, speed=20.0, lean=25.0):
    ct, made = module("contact"), module("tests.contact.synthetic_rim")
    return ct.RotatingRim(
        made.ring(S=4e-7, imperfect=imperfect), made.blade(S=1e-6), clearance=clearance, speed_hz=speed, lean_deg=lean,
        out_of_roundness=[{"p": 2, "cos": 2e-5}, {"p": 5, "sin": 1e-5}], angle_deg=13.0,
    )  # fmt: skip


@pytest.mark.slow
def test_lanes_of_unlike_rims_are_as_if_each_ran_alone():
    with plain() as module:
        ct = module("contact")
        scenes = [
            ct.Scene(
                what=turning(module, clearance=clearance, speed=speed, lean=lean), scheme=ct.ExactModal(law=law),
                law=ct.Coulomb(mu=mu) if mu else ct.Unilateral(), dt=dt, t_end=140 * dt,
                record=ct.Record(every=every, state_every=2 * every),
            )
            for clearance, speed, lean, mu, dt, law, every in (
                (-2e-5, 20.0, 25.0, 0.3, 2e-5, "averaged", 3), (-3e-5, -7.0, 10.0, 0.0, 1.8e-5, "forward", 5),
                (-2.9e-5, -2e-3, 35.0, 0.9, 2e-5, "forward", 1),
            )
        ]  # fmt: skip
        many, alone = ct.run_many(scenes), [ct.run(scene) for scene in scenes]
    assert sum(len(sticks) for one in alone for sticks in one.sticking) > 0
    for one, other in zip(alone, many, strict=True):
        assert one.contact_steps[0] > 5
        for name in ("time", "state_time", "contact_steps", "reversals"):
            np.testing.assert_array_equal(getattr(other, name), getattr(one, name))
        for name in ("force", "gap", "state", "impulse", "peak_force", "impulse_history"):
            exact = getattr(one, name)
            np.testing.assert_allclose(getattr(other, name), exact, rtol=0.0, atol=1e-9 * np.abs(exact).max() + 1e-18)
        np.testing.assert_allclose(other.intervals[0], one.intervals[0], rtol=0.0, atol=1e-10)
        for sticks, exact in zip(other.sticking, one.sticking, strict=True):
            np.testing.assert_allclose(sticks, exact, rtol=0.0, atol=1e-10)
        for name in ("contact", "rotation", "friction", "damping"):
            exact = getattr(one.energy, name)
            assert getattr(other.energy, name) == pytest.approx(exact, rel=1e-8, abs=1e-12 * one.energy.scale)
        assert abs(other.energy.unaccounted) <= 1e-11 * other.energy.scale
        for name in ("heat", "drive"):
            assert getattr(other.notes, name) == pytest.approx(getattr(one.notes, name), rel=1e-8, abs=1e-13)
        np.testing.assert_allclose(other.max_penetration, one.max_penetration, rtol=1e-7, atol=1e-15)
        assert np.max(other.residual) <= 1e-14
