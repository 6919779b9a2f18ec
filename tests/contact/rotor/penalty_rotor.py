"""An explicit model of a Jeffcott rotor with rigid tips in a rigid casing on mounts: penalty contacts, small steps."""

import numpy as np
from numba import njit


@njit(cache=False)
def penalty_run(h, steps, every, rotor, casing, speed, clearance, moments, release, angles, k, mu, radius, inertia):
    """Impulses of the tips (n,), speed at the end and, every so many steps, places of disk and casing (samples, 2).

    `rotor` and `casing` (3,): mass, stiffness, damping. `moments` (2,) complex: unbalance until `release` and after it.
    Places are complex. J theta'' = -Re[(i U e^(i theta))* x''] + torque of the tips: normal
    forces act through the centre of the casing. An infinite inertia keeps the speed.
    """
    x, v, s, w, theta, alpha = 0j, 0j, 0j, 0j, 0.0, 0.0
    impulse, places = np.zeros(angles.size), np.zeros((steps // every + 1, 2), dtype=np.complex128)
    for step in range(steps):
        turned = np.exp(1j * theta)
        force, torque = 0j, 0.0
        for j in range(angles.size):
            e = np.exp(1j * angles[j]) * turned
            depth = ((x - s) * e.conjugate()).real - clearance
            if depth > 0.0:
                impulse[j] += h * k * depth
                force += k * depth * (1.0 + 1j * mu) * e
                torque -= k * depth * (mu * radius + ((x - s) * e.conjugate()).imag)
        if step % every == 0:
            places[step // every, 0], places[step // every, 1] = x, s
        swing = (moments[0] if step * h < release else moments[1]) * turned
        a = (swing * (speed * speed - 1j * alpha) - rotor[1] * x - rotor[2] * v - force) / rotor[0]
        alpha = (torque - ((1j * swing).conjugate() * a).real) / inertia
        v, w = v + h * a, w + h * (force - casing[1] * s - casing[2] * w) / casing[0]
        speed += h * alpha
        x, s, theta = x + h * v, s + h * w, theta + h * speed
    return impulse, speed, places
