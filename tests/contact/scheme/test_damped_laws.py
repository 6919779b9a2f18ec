"""Laws with a dashpot at the tips of rims and rubs: they open while the rim still deflects, without a force."""

import math

import numpy as np
import pytest

import contact as ct

N, HZ, CLEARANCE, SPEED = 3, 180.0, 2e-5, 25.0
STIFFNESS, DAMPING, ROUGH = 2e5, 60.0, 6e-5
BLADE_HZ, MASS, BLADE_MASS = 420.0, 1.2, 0.5


def spring(depth, rate, values):
    k, c = values
    return k * depth + c * rate, k


def law(damping=DAMPING, mu=0.0):
    return ct.laws.ForceLaw(ct.laws.Response(spring, (STIFFNESS, damping)), mu=mu, words="damped spring")


def blade():
    return ct.ModalBody(
        omega=[2.0 * np.pi * BLADE_HZ], zeta=[2e-3], channels=("span", "flap"), rows=[[BLADE_MASS**-0.5], [0.0]],
        S=np.zeros((2, 2)),
    )  # fmt: skip


def casing():
    return ct.gaps.pair_rim(ct.gaps.ModalPair(n=N, freq_hz=HZ, modal_mass=MASS, zeta=1e-3), radius=0.4)


def plain(end, h):
    """Force of the same rim over time by the classical Runge-Kutta method in steps of `h`, and its largest value."""
    omega = 2.0 * np.pi * np.array([HZ, HZ, BLADE_HZ])
    damping = 2.0 * np.array([1e-3, 1e-3, 2e-3]) * omega
    turn = 2.0 * np.pi * SPEED

    def force(t, q, v):
        phi = -turn * t
        row = np.array([math.cos(N * phi), math.sin(N * phi), 0.0]) / math.sqrt(MASS)
        row[2] = -(BLADE_MASS**-0.5)
        moved = N * turn * np.array([math.sin(N * phi), -math.cos(N * phi), 0.0]) / math.sqrt(MASS)
        depth = -(CLEARANCE + ROUGH * math.cos(2.0 * phi) + row @ q)
        rate = -(2.0 * turn * ROUGH * math.sin(2.0 * phi) + row @ v + moved @ q)
        return (max(STIFFNESS * depth + DAMPING * rate, 0.0) if depth > 0.0 else 0.0), row

    def slope(t, y):
        found, row = force(t, y[:3], y[3:])
        return np.concatenate([y[3:], row * found - damping * y[3:] - omega**2 * y[:3]])

    y, history = np.zeros(6), []
    for k in range(round(end / h)):
        t = k * h
        history.append(force(t, y[:3], y[3:])[0])
        a = slope(t, y)
        b = slope(t + 0.5 * h, y + 0.5 * h * a)
        c = slope(t + 0.5 * h, y + 0.5 * h * b)
        d = slope(t + h, y + h * c)
        y = y + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return np.array(history)


@pytest.mark.slow
def test_a_damped_tip_of_a_rim_follows_a_plain_integration():
    rim = ct.RotatingRim(
        casing(), blade(), clearance=CLEARANCE, speed_hz=SPEED, out_of_roundness=[{"p": 2, "cos": ROUGH}]
    )
    result = ct.run(rim, law=law(), dt=2e-6, t_end=0.08)
    force = plain(0.08, 4e-6)
    assert result.peak_force[0] == pytest.approx(force.max(), rel=2e-3)
    assert result.impulse[0] == pytest.approx(force.sum() * 4e-6, rel=2e-3)
    assert result.contact_steps[0] * 2e-6 == pytest.approx(np.count_nonzero(force) * 4e-6, rel=1e-2)
    assert abs(result.energy.unaccounted) <= 1e-12 * result.energy.scale
    assert result.residual[0] < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_a_vanishing_dashpot_changes_nothing_at_the_tips_of_a_rub(mu):
    disk = ct.gaps.BladedDisk(blades=5, freq_hz=150.0, modal_mass=0.2, compliance=1e-7, lean_deg=20.0)
    rub = ct.Rub(
        casing(), (disk.body(),), disk.tips(), clearance=1e-6, speed=ct.Speed.constant(SPEED),
        profile=ct.gaps.RimProfile.fourier([{"p": 3, "cos": 4e-5}]),
    )  # fmt: skip
    kept, gone = (ct.run(rub, law=law(damping, mu), dt=1e-5, t_end=0.05) for damping in (0.0, 1e-6))
    assert np.all(kept.peak_force > 0.0)
    np.testing.assert_allclose(gone.impulse, kept.impulse, rtol=1e-6)
    np.testing.assert_allclose(gone.peak_force, kept.peak_force, rtol=1e-6)


@pytest.mark.slow
def test_a_dashpot_takes_energy_out_of_every_tip_that_it_opens():
    disk = ct.gaps.BladedDisk(blades=5, freq_hz=150.0, modal_mass=0.2, compliance=1e-7, lean_deg=20.0)
    rub = ct.Rub(
        casing(), (disk.body(),), disk.tips(), clearance=1e-6, speed=ct.Speed.constant(SPEED),
        profile=ct.gaps.RimProfile.fourier([{"p": 3, "cos": 4e-5}]),
    )  # fmt: skip
    result = ct.run(rub, law=law(mu=0.2), dt=1e-5, t_end=0.1)
    assert result.energy.lost_in_contact > 0.0
    assert abs(result.energy.unaccounted) <= 1e-12 * result.energy.scale
    assert np.all(result.contact_steps > 0)
