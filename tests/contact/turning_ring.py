"""A made-up ring that turns: gyroscopic coupling of its pairs, stiffening by speed."""

from dataclasses import replace

import numpy as np

from tests.contact.synthetic_rim import ring


def turning_ring(*, share=1.0, imperfect=0.0, **given):
    """The ring of `synthetic_rim`; g = 4 n/(n^2 + 1) couples each pair, as of a ring's in-plane bending.

    `imperfect` also mixes all modes; `share` times what rotation does.
    """
    casing = ring(imperfect=imperfect, **given)
    m = casing.omega.size
    G, K = np.zeros((m, m)), np.zeros((m, m))
    for k, n in enumerate(range(2, 2 + m // 2)):
        i = 2 * k
        G[i + 1, i] = 4.0 * n / (n * n + 1.0)
        G[i, i + 1] = -G[i + 1, i]
        K[i, i] = K[i + 1, i + 1] = 0.4 * n * n - 1.0
    if imperfect:
        mixed = np.random.default_rng(3).standard_normal((m, m))
        G, K = G + imperfect * (mixed - mixed.T), K + imperfect * (mixed + mixed.T)
    return replace(casing, gyroscopic=share * G, stiffness_by_speed=share * K)
