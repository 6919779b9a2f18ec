"""Closed contact of bodies that turn: ring theory, the characteristic equation, a dense model in another frame."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from reports.verification.rubs.closed_run import confirming_run
from tests.contact.stability.rates import floquet_growth, growth
from tests.contact.synthetic_rim import blade, dense_rows, ring
from tests.contact.turning_ring import turning_ring as stiffer_ring

TURN = 2.0 * math.pi
ORDERS = np.repeat(np.arange(2, 7), 2)
SPEEDS = np.array([*np.linspace(0.7, 90.0, 16), -3.0, -11.0, -27.0, -61.0])


def turning_ring(**given):
    """The ring with its Coriolis forces, g = 4 n/(n^2 + 1) between cos and sin, and K2 = n^2 (n^2 - 1)^2/(n^2 + 1)^2.

    Bending of an inextensional ring (W. Soedel, Vibrations of Shells and Plates, 2004, 16.5): the waves have
    omega = sqrt(omega_0^2 + a^2 Omega^2) -+ b Omega in the ring's frame, b = 2 n/(n^2 + 1), a = n - b.
    """
    still, m = ring(**given), ORDERS.size
    G, spin = np.zeros((m, m)), np.zeros((m, m))
    for k in range(0, m, 2):
        n = float(ORDERS[k])
        b = 2.0 * n / (n * n + 1.0)
        G[k, k + 1], G[k + 1, k] = -2.0 * b, 2.0 * b
        spin[k, k] = spin[k + 1, k + 1] = (n - b) ** 2 - b * b
    return replace(still, gyroscopic=G, stiffness_by_speed=spin)


def rim(casing, hz=5.0):
    return ct.RotatingRim(casing, blade(), clearance=-1e-5, speed_hz=hz, lean_deg=10.0, turning="casing")


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_poles_are_zeros_of_the_receptances_of_whirling_waves(mu):
    """S + H_c + H_b = 0 with D(s) = 1/(omega^2 + K2 Omega^2 + s^2 + (2 zeta omega -+ i g Omega) s) of each sense."""
    casing, tip = turning_ring(), blade()
    contact = ct.gaps.rim_contact(rim(casing), mu=mu)
    a = math.radians(10.0)
    normal, tangent = (np.array(row) @ tip.rows for row in ((math.cos(a), math.sin(a)), (-math.sin(a), math.cos(a))))
    for hz in SPEEDS:
        omega, s = TURN * hz, ct.stability.poles(contact, np.array([hz]))[0]
        pull, H = mu * math.copysign(1.0, hz), np.full(s.size, 0.0j)
        for k in range(0, 10, 2):
            n, w = float(ORDERS[k]), casing.omega[k]
            b = 2.0 * n / (n * n + 1.0)
            for sign in (1.0, -1.0):
                at = s + 1j * sign * n * omega
                lost = 2.0 * casing.zeta[k] * w * at
                D = 1.0 / (w**2 + ((n - b) ** 2 - b * b) * omega**2 + at**2 + lost - 2j * sign * b * omega * at)
                H += 0.5 * (1.0 + 1j * sign * pull / n) / (1.0 + 1.0 / n**2) * D
        for k in range(2):
            w, pushed = tip.omega[k], normal[k] * (normal[k] - pull * tangent[k])
            H += pushed / (w**2 + s**2 + 2.0 * tip.zeta[k] * w * s)
        left = np.abs(contact.compliance(math.copysign(1.0, hz))[0, 0] + H)
        moved = np.abs(left / H)
        assert moved.max() < 1e-6


def turned_pairs(casing, angles):
    """The same perfect casing by other modes of each pair, turned by these angles [rad]; every other pair mirrored."""
    T = np.zeros((casing.omega.size,) * 2)
    for k, a in enumerate(angles):
        mirror = 1.0 if k % 2 else -1.0
        T[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = [
            [math.cos(a), mirror * math.sin(a)],
            [-math.sin(a), mirror * math.cos(a)],
        ]
    squares = {name: T.T @ getattr(casing, name) @ T for name in ("gyroscopic", "stiffness_by_speed")}
    return replace(casing, rows=casing.rows @ T, **squares)


def test_the_mean_of_turned_and_mirrored_pairs_is_the_perfect_casing():
    casing = turned_pairs(turning_ring(), [0.3, 1.1, -2.0, 0.0, 2.5])
    mean = ct.stability.perfect_mean(casing)
    for one in (casing, mean):
        assert growth(ct.gaps.rim_contact(rim(one), mu=0.3), SPEEDS) == pytest.approx(
            growth(ct.gaps.rim_contact(rim(turning_ring()), mu=0.3), SPEEDS), rel=1e-9, abs=1e-9
        )


def test_a_fourth_power_of_the_speed_is_at_one_speed_a_second_power():
    casing, hz = turning_ring(), 30.0
    fourth = 3e-5 * np.eye(casing.omega.size)
    higher = replace(casing, stiffness_higher=fourth[None])
    second = replace(casing, stiffness_by_speed=casing.stiffness_by_speed + (TURN * hz) ** 2 * fourth)
    of = [
        ct.stability.poles(ct.gaps.rim_contact(rim(one), mu=0.3), np.array([hz]))[0] for one in (higher, second, casing)
    ]
    found, same, without = (np.sort(np.abs(poles.imag)) for poles in of)
    np.testing.assert_allclose(found, same, rtol=1e-9)
    assert np.abs(found / without - 1.0).max() > 1e-3


def test_the_mean_of_split_pairs_has_the_mean_of_their_coriolis_forces():
    """Entries between different n, and what is not skew within a pair, are zero in the mean."""
    casing = turning_ring()
    G = casing.gyroscopic.copy()
    G[0, 2], G[2, 0] = 0.5, -0.5
    spin = casing.stiffness_by_speed + np.diag(np.tile([0.1, -0.1], 5))
    split = replace(casing, omega=casing.omega * np.tile([1.0, 1.001], 5), gyroscopic=G, stiffness_by_speed=spin)
    mean = ct.stability.perfect_mean(split)
    np.testing.assert_allclose(mean.gyroscopic, casing.gyroscopic, atol=1e-12)
    np.testing.assert_allclose(mean.stiffness_by_speed, casing.stiffness_by_speed, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("hz", [-27.0, 61.0])
def test_growth_of_a_split_casing_is_that_of_its_motion_integrated_over_a_turn(hz):
    """q'' + C q' + K q = -W Q q/S with phi = -Omega t, by an integrator of order eight."""
    from scipy.integrate import solve_ivp

    casing = turning_ring(imperfect=1e-2)
    G = casing.gyroscopic.copy()
    G[0, 2], G[2, 0] = 0.3, -0.3
    casing = replace(casing, gyroscopic=G)
    what, omega, mu = rim(casing, hz), TURN * hz, 0.3
    own, zeta = (np.concatenate([getattr(b, name) for b in (casing, what.blade)]) for name in ("omega", "zeta"))
    m = own.size
    C, K = np.diag(2.0 * zeta * own), np.diag(own**2)
    C[:10, :10] += omega * casing.gyroscopic
    K[:10, :10] += omega**2 * casing.stiffness_by_speed
    scale, pull = own.max(), math.copysign(mu, hz)

    def rate(t, x):
        q, v = x.reshape(2, m, -1)
        normal, tangent, S_nn, S_nt = dense_rows(what, -omega * t)
        S = S_nn - pull * S_nt
        force = -K @ q / scale - C @ v - np.outer(normal - pull * tangent, normal @ q) / S / scale
        return np.concatenate([scale * v, force]).ravel()

    turn = solve_ivp(rate, (0.0, 1.0 / abs(hz)), np.eye(2 * m).ravel(), method="DOP853", rtol=1e-8, atol=1e-11).y[:, -1]
    largest = np.abs(np.linalg.eigvals(turn.reshape(2 * m, 2 * m))).max()
    assert floquet_growth(what, hz, mu=mu) == pytest.approx(math.log(largest) * abs(hz), rel=1e-3)


@pytest.mark.slow
def test_growth_of_a_casing_that_turns_and_is_split_by_a_millionth_is_that_of_the_poles_of_the_perfect_one():
    casing, hz = turning_ring(), float(SPEEDS[3])
    split = rim(replace(casing, omega=casing.omega * np.tile([1.0, 1.0 + 1e-6], 5)))
    expected = growth(ct.gaps.rim_contact(rim(casing), mu=0.3), hz)[0]
    assert floquet_growth(split, hz, mu=0.3) == pytest.approx(expected, rel=1e-3)


def test_stiffening_of_blades_that_do_not_turn_is_refused():
    stiff = ct.gaps.Stiffening(blade=0, stiffness_by_speed=np.eye(2))
    given = {"clearance": 1e-5, "speed": ct.Speed.constant(5.0), "stiffening": [stiff]}
    with pytest.raises(ct.InputError, match=r"blade\.stiffening: found stiffening by the speed with turning"):
        ct.Rub(ring(), (blade(),), turning="casing", **given)
    assert ct.Rub(ring(), (blade(),), turning="blades", **given).stiffening == (stiff,)


@pytest.mark.slow
def test_noise_of_a_mesh_between_modes_does_not_change_a_run():
    """Couplings below 1e-10 of a frequency are left out: what stays falls apart into pairs, as without them."""
    casing = turning_ring()
    rng = np.random.default_rng(4)
    m = casing.omega.size
    noise = np.triu(rng.uniform(3e-10, 6e-10, (m, m)), 1)
    noise[ORDERS[:, None] == ORDERS] = 0.0
    noisy = replace(
        casing, gyroscopic=casing.gyroscopic + noise - noise.T,
        stiffness_by_speed=casing.stiffness_by_speed + 1e-3 * (noise + noise.T),
    )  # fmt: skip
    clean, other = (
        ct.run(rim(body), law=ct.Coulomb(mu=0.1), t_end=0.02, dt=1e-5, record=ct.Record(every=10, state_every=10))
        for body in (casing, noisy)
    )
    assert clean.contact_steps[0] > 0
    np.testing.assert_array_equal(other.state, clean.state)


@pytest.mark.slow
def test_a_confirming_run_resolves_the_modes_at_its_speed():
    """A blade that the speed stiffens from 120 to 215 Hz, by a matrix of the rub's own."""
    stiff = ct.gaps.Stiffening(blade=0, stiffness_by_speed=np.diag([20.0, 15.0]))
    what = ct.Rub(
        turning_ring(), (blade(),), (ct.gaps.ContactPoint(lean_deg=10.0),), clearance=-1e-5,
        speed=ct.Speed.constant(40.0), stiffening=[stiff],
    )  # fmt: skip
    run = confirming_run(what, 40.0, mu=0.2)
    assert run.run == pytest.approx(run.poles, rel=0.005)


@pytest.mark.parametrize("imperfect", [0.0, 0.05])
def test_growth_at_a_speed_at_which_a_basis_is_not_known_is_refused(imperfect):
    casing = replace(turning_ring(imperfect=imperfect), spin=5.0 * TURN, known_speeds=[4.0 * TURN, 6.0 * TURN])
    assert np.isfinite(ct.stability.of_rim(rim(casing), np.array([4.0, 6.0])).growth).all()
    with pytest.raises(ct.InputError, match=r"speed: found 7 to 9 Hz \(420 to 540 rpm\).*expected 4 to 6 Hz"):
        ct.stability.of_rim(rim(casing), np.array([5.0, 7.0, 9.0]))


def test_a_band_is_found_if_its_coincidence_without_contact_is_at_a_speed_at_which_a_basis_is_not_known():
    """Wave 5 meets the blade at 95.25 Hz; the contact moves the band to 95.50 Hz, into the known speeds."""
    casing, tip = replace(stiffer_ring(zeta=1e-5), spin=5.0 * TURN), blade(S=2e-5, zeta=1e-5)
    known = replace(casing, known_speeds=[95.37 * TURN, 118.0 * TURN])
    speeds = np.linspace(95.37, 118.0, 5)
    found, whole = (ct.stability.of_rim(replace(rim(one, 100.0), blade=tip), speeds) for one in (known, casing))
    assert 95.4 < found.bands_hz[0][0] < 95.6
    np.testing.assert_allclose(found.bands_hz, whole.bands_hz, rtol=1e-6)
