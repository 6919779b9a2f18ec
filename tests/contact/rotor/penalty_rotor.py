"""An explicit model of a Jeffcott rotor with rigid tips in a rigid casing on mounts: penalty contacts, small steps."""

import numpy as np
from numba import njit


@njit(cache=False)
def penalty_run(h, steps, every, rotor, casing, speed, clearance, moments, release, angles, k, mu):
    """Impulses of the tips (n,) and, every so many steps, positions of disk and casing (samples, 2), complex.

    `rotor` and `casing` (3,): mass, stiffness, damping. `moments` (2,) complex: unbalance until `release` and after it.
    """
    x, v, s, w = 0j, 0j, 0j, 0j
    impulse, places = np.zeros(angles.size), np.zeros((steps // every + 1, 2), dtype=np.complex128)
    for step in range(steps):
        t = step * h
        turned = np.exp(1j * speed * t)
        force = 0j
        for j in range(angles.size):
            e = np.exp(1j * angles[j]) * turned
            depth = ((x - s) * e.conjugate()).real - clearance
            if depth > 0.0:
                impulse[j] += h * k * depth
                force += k * depth * (1.0 + 1j * mu) * e
        if step % every == 0:
            places[step // every, 0], places[step // every, 1] = x, s
        pull = (moments[0] if t < release else moments[1]) * speed * speed * turned
        v += h * (pull - rotor[1] * x - rotor[2] * v - force) / rotor[0]
        w += h * (force - casing[1] * s - casing[2] * w) / casing[0]
        x, s = x + h * v, s + h * w
    return impulse, places
