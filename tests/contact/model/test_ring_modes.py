"""A thin ring: closed form against the strain energy by quadrature, and elements against the closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct

GIVEN = {"radius": 0.3, "width": 0.02, "height": 0.006, "E": 70e9, "rho": 2700.0}
HELD = ct.bodies.ThinRing(**GIVEN, k_r=3e6, k_t=8e5, zeta=0.01)
FREE = ct.bodies.ThinRing(**GIVEN)


def energies(ring, w, v, n):
    """2 U and 2 T/omega^2 of w = W cos n theta, v = V sin n theta around the ring, by its strains."""
    R, theta = ring.radius, 2.0 * np.pi * (np.arange(64) + 0.5) / 64
    c, s = np.cos(n * theta), np.sin(n * theta)
    eps, kappa = (n * v * c + w * c) / R, (n * v * c + n * n * w * c) / R**2
    A = ring.width * ring.height
    density = ring.E * A * eps**2 + ring.E * ring.width * ring.height**3 / 12.0 * kappa**2
    density = density + ring.k_r * (w * c) ** 2 + ring.k_t * (v * s) ** 2
    ds = 2.0 * np.pi * R / 64
    return ds * density.sum(), ds * ring.rho * A * ((w * c) ** 2 + (v * s) ** 2).sum()


@pytest.mark.parametrize("n", [1, 2, 3])
def test_stiffness_is_that_of_the_strain_energy(n):
    K, half = HELD.stiffness(n), np.pi * HELD.radius
    for w, v in ((1.0, 0.0), (0.0, 1.0), (0.7, -0.4)):
        stored, _ = energies(HELD, w, v, n)
        assert half * np.array([w, v]) @ K @ [w, v] == pytest.approx(stored, rel=1e-12)
    assert HELD.frequencies(n) == pytest.approx(
        np.sqrt(np.linalg.eigvalsh(K) / (2700.0 * 0.02 * 0.006)) / (2.0 * np.pi), rel=1e-12
    )


def test_modes_in_closed_form_are_mass_normalised_and_turn_into_each_other():
    body, size = ct.bodies.ring_modes(HELD, 3), 7
    assert body.omega.size == 2 + 3 * 4
    assert np.all(np.diff(body.omega) >= 0.0)
    assert (body.kind, body.n_max, body.radius, body.zeta.tolist()) == ("rim", 3, 0.3, [0.01] * 14)
    assert not body.S.any()
    for i in range(14):
        radial, hoop = body.rows[:size, i], body.rows[size:, i]
        n = int(np.flatnonzero(np.abs(radial) + np.abs(hoop) > 0.0)[0]) % 4
        if radial[4:].any() or hoop[1:4].any():  # w = W sin, v = -V cos: the other turned by a quarter wave
            (n,) = np.flatnonzero(np.abs(radial[4:]) + np.abs(hoop[1:4]) > 0.0) + 1
            w, v = radial[3 + n], -hoop[n]
        else:
            w, v = radial[n], (hoop[3 + n] if n else 0.0)
        if n == 0:
            line = 2.0 * np.pi * 0.3 * 2700.0 * 0.02 * 0.006
            assert line * (radial[0] ** 2 + hoop[0] ** 2) == pytest.approx(1.0, rel=1e-12)
            continue
        stored, moved = energies(HELD, w, v, n)
        assert moved == pytest.approx(1.0, rel=1e-12)
        assert stored == pytest.approx(body.omega[i] ** 2, rel=1e-9)


def test_breathing_and_turning_of_the_whole_ring():
    """EA/R^2 + k_r and k_t, over the line mass."""
    line = 2700.0 * 0.02 * 0.006
    breathing = math.sqrt((70e9 * 0.02 * 0.006 / 0.09 + 3e6) / line)
    assert ct.bodies.ring_modes(HELD, 0).omega == pytest.approx([math.sqrt(8e5 / line), breathing], rel=1e-12)


@pytest.mark.parametrize("ring", [HELD, FREE])
def test_elements_see_pairs_of_waves_as_the_closed_form_does(ring):
    """Sum over a pair of rows^T rows: free of the pair's orientation, with every sign and scale."""
    whole, parts = ct.bodies.ring_modes(ring, 3), ct.bodies.ring_elements(ring, 40, 3)
    assert parts.omega.size == 160
    assert parts.zeta.tolist() == [ring.zeta] * 160
    assert parts.omega[:7] == pytest.approx(whole.omega[:7], rel=2e-3, abs=2.0)
    for group in ([0], [1, 2], [3, 4], [5, 6]):
        seen, expected = (body.rows[:, group] @ body.rows[:, group].T for body in (parts, whole))
        if ring is FREE and group[0] < 3:  # three rigid motions, in no order
            seen, expected = (body.rows[:, :3] @ body.rows[:, :3].T for body in (parts, whole))
        np.testing.assert_allclose(seen, expected, atol=2e-3 * np.abs(expected).max())


def test_a_free_ring_has_rigid_motions_exactly():
    body = ct.bodies.ring_modes(FREE, 3)
    assert body.omega[:3].tolist() == [0.0] * 3
    assert body.omega[3] > 100.0
    assert ct.bodies.ring_elements(FREE, 12, 3).omega[0] == 0.0
    assert FREE.frequencies(1)[0] < 1e-3 * FREE.frequencies(2)[0]


def test_twenty_waves_are_kept_where_nothing_is_stated():
    assert ct.bodies.ring_modes(FREE).n_max == 20
    assert ct.bodies.ring_elements(FREE, 20).n_max == 20
    assert ct.bodies.ring_elements(FREE, 3, 3).omega.size == 12


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"radius": 0.0}, "radius: found"), ({"width": -1.0}, "width: found"), ({"height": 0.0}, "height: found 0.0"),
        ({"E": 0.0}, "E: found"), ({"rho": math.nan}, "rho: found"), ({"k_r": -1.0}, "k_r: found"),
        ({"k_t": -1.0}, "k_t: found"), ({"zeta": -0.1}, "zeta: found"),
        ({"height": 0.3}, "height: found 0.3 m, expected less than the radius 0.3 m"),
    ],
)  # fmt: skip
def test_rings_that_cannot_be_are_refused(change, words):
    with pytest.raises(ct.InputError, match=words):
        ct.bodies.ThinRing(**GIVEN | change)
    assert ct.bodies.ThinRing(**GIVEN | {"height": 0.299}).line_mass == pytest.approx(2700.0 * 0.02 * 0.299)


@pytest.mark.parametrize(
    "make", [lambda ring: ct.bodies.ring_modes(ring, 5), lambda ring: ct.bodies.ring_elements(ring, 40, 5)]
)
def test_a_free_ring_that_turns_has_the_waves_of_ring_theory(make):
    """omega = sqrt(omega_0^2 + a^2 Omega^2) -+ b Omega, b = 2 n/(n^2 + 1), a = n - b, but for its stretch.

    A rigid motion is at rest in space: seen from the ring n = 1 has Omega for both senses, and n = 0 turns freely.
    """
    omega, body = 60.0, make(FREE)
    found = body.poles(omega)
    rigid = np.sort(np.abs(found))[:6]
    np.testing.assert_allclose(rigid, [0.0, 0.0, omega, omega, omega, omega], atol=1e-2)
    for n in (2, 3):
        b = 2.0 * n / (n * n + 1.0)
        still = float(body.omega[np.abs(body.omega - 2.0 * math.pi * FREE.frequencies(n)[0]).argmin()])
        middle = math.hypot(still, (n - b) * omega)
        for exact in (middle - b * omega, middle + b * omega):
            assert np.abs(found.imag / exact - 1.0).min() < 2e-4
        assert abs(middle / still - 1.0) > 0.01


def test_waves_of_a_ring_on_springs_that_turns_are_those_of_its_elements():
    wave, element = (
        replace(body, zeta=np.zeros_like(body.zeta)).poles(400.0).imag
        for body in (ct.bodies.ring_modes(HELD, 3), ct.bodies.ring_elements(HELD, 40, 3))
    )
    for one in wave[(wave > 0.0) & (wave < 4e4)]:
        assert np.abs(element / one - 1.0).min() < 1e-4
    still = ct.bodies.ring_modes(HELD, 3).omega
    assert max(np.abs(still / one - 1.0).min() for one in wave[wave > 0.0]) > 0.02
