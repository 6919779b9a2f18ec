"""Dangerous speeds of rotors: resonance, internal damping, constant speeds; a rub on a rotor that diverges."""

import numpy as np
import pytest
from scipy.optimize import brentq

import contact as ct
from tests.probed import numbers_of_notes, numbers_of_result

R = ct.rotor
OMEGA = np.sqrt(4e6 / 10.0)
pytestmark = pytest.mark.slow


def rotor(hz, inner=0.0, **more):
    release = R.Release(time=0.05, moment=2.5e-2)
    disk = R.Jeffcott(mass=10.0, stiffness=4e6, zeta=0.02, zeta_internal=inner)
    return R.Rotor.of(disk, hz, unbalance=R.Unbalance(moment=1e-3, release=release), **more)


def whirl(speed):
    """Amplitude [m] at a speed over the critical one: the moment after the loss over the mass, times the response."""
    return 2.6e-3 * speed**2 / np.hypot(1.0 - speed**2, 0.04 * speed)


def test_a_rotor_alone_is_in_resonance_around_its_critical_speed_and_safe_elsewhere(held):
    scene = ct.Scene(what=rotor(80.0), t_end=1.0, dt=1e-4)
    found = ct.interactions(scene, np.linspace(20.0, 180.0, 41), runs=9)
    (row,) = found.rows
    critical = OMEGA / (2.0 * np.pi)
    assert (row.at.verdict, row.wave, row.body) == ("resonance", "forward", "rotor")
    assert row.from_hz < critical < row.to_hz
    assert row.at.speed_hz == pytest.approx(critical, rel=1e-9)
    speed, motion = np.array([(run.speed_hz / critical, run.amplitude_m) for run in found.runs]).T
    np.testing.assert_allclose(motion, whirl(speed), rtol=1e-2)
    even = np.linspace(20.0, 180.0, 9)
    large = 3.0 * np.median(whirl(even / critical))
    below, above = (brentq(lambda r: whirl(r) - large, *ends) * critical for ends in ((0.1, 1.0), (1.0, 3.0)))
    np.testing.assert_allclose([row.from_hz, row.to_hz], [below, above], rtol=0.0, atol=20.0 / 16.0)
    assert set(even) < {run.speed_hz for run in found.runs}
    assert {run.verdict for run in found.runs if not below - 10.0 < run.speed_hz < above + 10.0} == {"safe"}
    held(1e-4, **numbers_of_result(found), words=numbers_of_notes(found.words))


def test_a_rotor_with_internal_damping_is_unstable_above_its_threshold(held):
    scene = ct.Scene(what=rotor(80.0, inner=0.02), t_end=1.0, dt=1e-4)
    found = ct.interactions(scene, np.linspace(150.0, 250.0, 21), runs=5)
    (row,) = found.of("unstable")
    assert 2.0 * OMEGA / (2.0 * np.pi) == pytest.approx(row.peak.from_hz, rel=1e-6)
    assert (row.peak.wave, row.wave, row.n) == ("forward", "forward", 1)
    assert row.at.low < row.at.closed < row.at.high
    assert {run.verdict for run in found.runs if run.speed_hz < 200.0} == {"safe"}
    held(1e-4, **numbers_of_result(found), words=numbers_of_notes(found.words))


def test_a_rub_on_a_rotor_is_run_at_constant_speeds_of_its_rotor(held):
    casing = R.rigid_casing(radius=0.25, mass=20.0, stiffness=2e7, zeta=0.1)
    tips = [ct.ContactPoint(blade=j, angle_deg=60.0 * j) for j in range(6)]
    rub = R.rotor_rub(rotor(60.0), casing, [R.rigid_tip()] * 6, tips, clearance=5e-3, spin=R.Spin(inertia=0.3))
    found = ct.interactions(ct.Scene(what=rub, t_end=0.5, dt=1e-4), [20.0, 60.0], runs=2)
    assert [run.speed_hz for run in found.runs][:: len(found.runs) - 1] == [20.0, 60.0]
    held(1e-4, **numbers_of_result(found), words=numbers_of_notes(found.words))
    alone = ct.interactions(ct.Scene(what=rotor(60.0), t_end=0.5, dt=1e-4), [20.0, 60.0], runs=2)
    for free, one in zip(alone.runs, found.runs, strict=True):  # nothing touches within 5 mm
        assert one.amplitude_m == pytest.approx(free.amplitude_m, rel=1e-2)


def test_a_rub_that_diverges_names_the_speed_and_the_growth_of_the_free_rotor():
    casing = R.rigid_casing(radius=0.25, mass=20.0, stiffness=2e7, zeta=0.1)
    tips = [ct.ContactPoint(blade=j, angle_deg=30.0 * j) for j in range(12)]
    disk = rotor(100.0, velocity=np.sqrt(10.0) * np.array([0.0, 200.0]))
    rub = R.rotor_rub(disk, casing, [R.rigid_tip()] * 12, tips, clearance=5e-4)
    with pytest.raises(ct.NumericsError, match=r"the rotor's motion does not grow at 100 Hz \(-12\.6 1/s\)"):
        ct.run(rub, law=ct.Coulomb(mu=0.3), t_end=0.5, dt=2e-5)
