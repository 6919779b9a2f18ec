"""Bodies that turn, in their own frame by the scene and at rest in space by Runge-Kutta steps: the same forces."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contact as ct
from tests.contact.synthetic_rim import N_MAX, SIZE, ring

LEAN, MU, PRESS, STEPS, H = math.radians(12.0), 0.25, 6e-5, 1500, 1e-6
CLOSED = 780  # steps, of the rigid rim
FREE = {"gyroscopic": [[0.0, -2.0], [2.0, 0.0]], "stiffness_by_speed": [[-1.0, 0.0], [0.0, -1.0]]}
NORMAL, TANGENT = (np.array(row) for row in ((math.cos(LEAN), math.sin(LEAN)), (-math.sin(LEAN), math.cos(LEAN))))


def mass_on_springs(S=6e-8):
    """A mass of 1/4 kg in equal springs: at rest in space its motion knows nothing of a frame that turns."""
    return ct.ModalBody(
        omega=[900.0, 900.0], zeta=[0.0, 0.0], channels=("span", "flap"), rows=2.0 * np.eye(2), S=S * np.eye(2)
    )


def rigid_rim(S=3e-8):
    """A rim that moves as a whole, x and y, in equal springs."""
    rows = np.zeros((6, 2))
    rows[1, 0] = rows[2, 1] = 1.5  # x cos + y sin along the radius
    rows[5, 0], rows[4, 1] = -1.5, 1.5  # y cos - x sin around
    return ct.ModalBody(
        omega=[700.0, 700.0],
        zeta=[0.0, 0.0],
        channels=ct.bodies.rim_channels(1),
        rows=rows,
        S=np.diag([S] * 3 + [0.5 * S] * 3),
        kind="rim",
        n_max=1,
        radius=0.4,
    )


def waves(angle, n_max):
    n = np.arange(n_max + 1)
    return np.concatenate([np.cos(n * angle), np.sin(n[1:] * angle)])


def in_space(omega2, zeta, rows, soft, hz):
    """Normal forces of a closed contact that slides, of bodies at rest in space; rows(t): normal and tangential."""
    pull = math.copysign(MU, hz)

    def force(t, q):
        Q, T = rows(t)
        return (PRESS * (1.0 - math.cos(4.0 * np.pi * hz * t)) - Q @ q) / soft, Q - pull * T

    def rate(t, z):
        q, v = np.split(z, 2)
        pressed, pushed = force(t, q)
        return np.concatenate([v, pushed * pressed - 2.0 * zeta * np.sqrt(omega2) * v - omega2 * q])

    t = H * np.arange(STEPS)
    found = solve_ivp(rate, (0.0, t[-1]), np.zeros(2 * len(omega2)), t_eval=t, method="DOP853", rtol=1e-9, atol=1e-13)
    return np.array([force(at, q)[0] for at, q in zip(t, found.y[: len(omega2)].T, strict=True)])


def in_the_turning_frame(casing, blade, hz, turning):
    rim = ct.RotatingRim(
        casing,
        blade,
        clearance=-PRESS,
        speed_hz=hz,
        lean_deg=math.degrees(LEAN),
        turning=turning,
        out_of_roundness=[{"p": 2, "cos": PRESS}],
    )
    scheme = ct.ExactModal(law="averaged")
    return ct.run(rim, law=ct.Coulomb(mu=MU), scheme=scheme, dt=H, t_end=(STEPS - 0.5) * H).force[:, 0]


@pytest.mark.slow
@pytest.mark.parametrize("hz", [110.0, -110.0])
def test_blade_that_turns_before_a_casing_at_rest_is_a_mass_in_space(hz):
    """It runs towards smaller angles at a positive speed, and rotation is from span to flap."""
    casing, blade = ring(S=3e-8), mass_on_springs(S=1e-6)

    def rows(t):
        angle = -2.0 * np.pi * hz * t
        at, turn = (
            waves(angle, N_MAX),
            np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]]),
        )
        normal = np.concatenate([at @ casing.rows[:SIZE], -2.0 * NORMAL @ turn])  # x and y in space -> span and flap
        return normal, np.concatenate([at @ casing.rows[SIZE:], -2.0 * TANGENT @ turn])

    soft = 3e-8 * (N_MAX + 1) + 1e-6
    omega2 = np.concatenate([casing.omega**2, [900.0**2] * 2])
    wanted = in_space(omega2, np.concatenate([casing.zeta, np.zeros(2)]), rows, soft, hz)
    assert wanted[10:].min() > 0.0
    found = in_the_turning_frame(casing, replace(blade, **FREE), hz, "blades")
    np.testing.assert_allclose(found, wanted, rtol=0.0, atol=2e-4 * wanted.max())
    plain = in_the_turning_frame(casing, blade, hz, "blades")
    assert np.abs(plain - wanted).max() > 0.01 * wanted.max()


@pytest.mark.slow
@pytest.mark.parametrize("hz", [90.0, -90.0])
def test_casing_that_turns_before_a_blade_at_rest_is_a_rim_in_space(hz):
    """A rigid rim in equal springs: its turning shows in the slip alone. Up to where the contact would open."""
    casing, blade = rigid_rim(), mass_on_springs()
    at = waves(0.0, 1)

    def rows(_):
        normal = np.concatenate([at @ casing.rows[:3], -2.0 * NORMAL])
        return normal, np.concatenate([at @ casing.rows[3:], -2.0 * TANGENT])

    wanted = in_space(np.array([700.0**2] * 2 + [900.0**2] * 2), np.zeros(4), rows, 3e-8 * 2 + 6e-8, hz)[:CLOSED]
    assert wanted[10:].min() > 0.0
    found = in_the_turning_frame(replace(casing, **FREE), blade, hz, "casing")[:CLOSED]
    np.testing.assert_allclose(found, wanted, rtol=0.0, atol=2e-4 * wanted.max())
    plain = in_the_turning_frame(casing, blade, hz, "casing")[:CLOSED]
    assert np.abs(plain - wanted).max() > 0.01 * wanted.max()
