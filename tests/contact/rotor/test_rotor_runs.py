"""Runs of rotors through `ct.run`: resonance, release, run-up, damping that turns, energy and momentum."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contact as ct

R = ct.rotor
M, K, ZETA, MOMENT = 10.0, 4e6, 0.02, 1e-3
OMEGA = np.sqrt(K / M)
STATES = ct.Record(every=10, state_every=10)
pytestmark = pytest.mark.slow  # compiles its loop


def jeffcott(hz, *, zeta=ZETA, inner=0.0, **more):
    unbalance = more.pop("unbalance", R.Unbalance(moment=MOMENT))
    return R.Rotor.of(R.Jeffcott(mass=M, stiffness=K, zeta=zeta, zeta_internal=inner), hz, unbalance=unbalance, **more)


def orbit_of(rotor, result):
    return result.state @ (rotor.plane[0] + 1j * rotor.plane[1])


@pytest.mark.parametrize("ratio", [0.3, 0.9, 1.0, 1.1, 2.5])
def test_amplitude_and_phase_through_resonance_are_those_of_the_jeffcott_rotor(ratio):
    found = ct.run(jeffcott(ratio * OMEGA / (2.0 * np.pi)), t_end=1.5, dt=1e-4).notes.orbit
    exact = MOMENT / M * ratio**2 / (1.0 - ratio**2 + 2j * ZETA * ratio)
    assert found.turns == 10
    assert found.radius_end == pytest.approx(abs(exact), rel=1e-6)
    assert found.phase_deg_end == pytest.approx(np.degrees(-np.angle(exact)), rel=1e-5)


def test_a_rotor_that_turns_the_other_sense_lags_by_the_same_angle():
    ahead, mirrored = (ct.run(jeffcott(hz), t_end=1.5, dt=1e-4).notes.orbit for hz in (90.0, -90.0))
    assert mirrored.radius_end == pytest.approx(ahead.radius_end, rel=1e-12)
    assert mirrored.phase_deg_end == pytest.approx(ahead.phase_deg_end, rel=1e-9)


def test_release_between_two_steps_adds_the_transient_of_the_closed_form():
    hz, when, h = 80.0, 0.30003719, 1e-4
    release = R.Release(time=when, moment=5e-2, angle_deg=90.0)
    rotor = jeffcott(hz, unbalance=R.Unbalance(moment=MOMENT, angle_deg=-30.0, release=release))
    result = ct.run(rotor, t_end=0.5, dt=h, record=STATES)
    t, W = result.state_time, 2.0 * np.pi * hz
    damped = OMEGA * np.sqrt(1.0 - ZETA**2)

    def answered(U, since):
        """From rest under U W^2 e^(i W t) from `since` on."""
        steady = U * W**2 / M / (OMEGA**2 - W**2 + 2j * ZETA * OMEGA * W) * np.exp(1j * W * t)
        at = steady[0] * np.exp(1j * W * (since - t[0]))
        tau = np.maximum(t - since, 0.0)
        slope = -(1j * W + ZETA * OMEGA) * at
        free = np.exp(-ZETA * OMEGA * tau) * (-at * np.cos(damped * tau) + slope / damped * np.sin(damped * tau))
        return np.where(t >= since, steady + free, 0.0)

    exact = answered(MOMENT * np.exp(-1j * np.pi / 6.0), 0.0) + answered(5e-2j, when)
    assert np.abs(orbit_of(rotor, result) - exact).max() < 1e-10 * np.abs(exact).max()


def run_up_error(h):
    speed = ct.Speed(time=[0.0, 1.0], hz=[60.0, 140.0])
    shaft = R.Jeffcott(mass=M, stiffness=K, zeta=0.01, zeta_internal=0.01)
    rotor = R.Rotor.of(shaft, speed, unbalance=R.Unbalance(moment=MOMENT))
    result = ct.run(rotor, t_end=1.0, dt=h, record=ct.Record(every=1, state_every=max(1, round(1e-3 / h))))
    c, rate = 0.02 * OMEGA, 2.0 * np.pi * 80.0

    def slopes(t, x):
        r, v = x
        W, angle = 2.0 * np.pi * 60.0 + rate * t, 2.0 * np.pi * (60.0 * t + 40.0 * t * t)
        force = MOMENT / M * (W**2 - 1j * rate) * np.exp(1j * angle)
        return [v, force - c * v - c * (v - 1j * W * r) - OMEGA**2 * r]

    fine = solve_ivp(
        slopes, (0.0, 1.0), np.zeros(2, dtype=complex), method="DOP853", rtol=1e-11, atol=1e-16,
        t_eval=result.state_time,
    )  # fmt: skip
    assert np.abs(fine.y[0]).max() > 10.0 * MOMENT / M  # it passes the critical speed
    return np.abs(orbit_of(rotor, result) - fine.y[0]).max() / np.abs(fine.y[0]).max(), result


def test_run_up_through_the_critical_speed_converges_to_a_fine_integration():
    (coarse, _), (fine, result) = run_up_error(2e-4), run_up_error(1e-4)
    assert fine < 2e-5
    assert coarse / fine == pytest.approx(4.0, rel=0.1)
    assert abs(result.energy.unaccounted) < 1e-8 * result.energy.scale
    assert result.energy.rotation > 0.0  # internal damping draws from what turns the shaft


@pytest.mark.parametrize(("factor", "grows"), [(0.99, False), (1.01, True)])
def test_motion_grows_above_the_threshold_of_internal_damping_alone(factor, grows):
    hz = factor * OMEGA * (1.0 + 0.02 / 0.01) / (2.0 * np.pi)
    rotor = jeffcott(hz, zeta=0.02, inner=0.01, unbalance=None, displacement=[1e-3, 0.0])
    result = ct.run(rotor, t_end=3.0, dt=1e-4, record=STATES)
    size = np.abs(orbit_of(rotor, result))
    assert (size[-1] > size[len(size) // 2]) == grows


def shaft(**bearing):
    given = {"kxx": 2e7, "kyy": 3e7, "kxy": 4e6, "kyx": -4e6, "cxx": 2e3, "cxy": 3e2, "cyx": -1e2} | bearing
    return R.Shaft(
        pieces=[R.Piece(length=0.5, diameter=0.05, elements=4, loss_time=1e-6)],
        disks=[R.Disk(at=0.3, mass=12.0, polar=0.2, diametral=0.11)],
        bearings=[R.Bearing(at=0.0, **given), R.Bearing(at=0.5, kxx=5e7, cxx=1e3)],
    )


def test_energy_of_a_shaft_on_cross_coupled_bearings_is_accounted_to_round_off():
    release = R.Release(time=0.05, moment=2e-2, angle_deg=45.0)
    rotor = R.Rotor.of(
        shaft(), 60.0, unbalance=R.Unbalance(moment=1e-3, release=release), modes=12, gravity=9.80665, settled=False
    )  # fmt: skip
    energy = ct.run(rotor, t_end=0.2, dt=2e-5).energy
    assert abs(energy.unaccounted) < 1e-10 * energy.scale
    assert energy.damping < 0.0 < energy.external
    assert abs(energy.rotation) > 1e-6 * energy.scale


def test_momentum_of_a_free_disk_is_the_impulse_of_its_unbalance():
    rotor = R.Rotor.of(
        ct.ModalBody(omega=[0.0, 0.0], zeta=[0.0, 0.0], channels=("d.x", "d.y"), rows=np.eye(2) / np.sqrt(M),
                     S=np.zeros((2, 2))), 50.0, unbalance=R.Unbalance(moment=MOMENT),
    )  # fmt: skip
    result = ct.run(rotor, t_end=0.1, dt=1e-4, record=ct.Record(every=1, state_every=1))
    W, t = 2.0 * np.pi * 50.0, result.state_time
    exact = MOMENT / M * (1.0 + 1j * W * t - np.exp(1j * W * t))  # m r'' = U W^2 e^(i W t) from rest
    assert np.abs(orbit_of(rotor, result) - exact).max() < 1e-12 * np.abs(exact).max()


def test_a_settled_rotor_without_unbalance_rests_under_its_weight():
    rotor = R.Rotor.of(shaft(kxy=0.0, kyx=0.0), 60.0, modes=12, gravity=9.80665)
    result = ct.run(rotor, t_end=0.1, dt=1e-4, record=STATES)
    assert np.ptp(result.state, axis=0).max() < 1e-10 * np.abs(result.state).max()
    assert np.isnan(result.notes.orbit.phase_deg_end)


def test_a_saved_run_keeps_its_orbit(tmp_path):
    result = ct.run(jeffcott(80.0), t_end=0.2, dt=1e-4)
    again = ct.Result.load(result.save(tmp_path / "run.npz"))
    assert again.notes.orbit == result.notes.orbit
    assert again.to_dict()["rotor"]["radius_end"] == result.notes.orbit.radius_end
    assert "degrees behind the unbalance" in repr(again)


def test_a_law_of_contact_is_refused_for_a_rotor_alone():
    with pytest.raises(ct.InputError, match="rotor without contact"):
        ct.run(jeffcott(80.0), law=ct.Coulomb(mu=0.1), t_end=0.1, dt=1e-4)


def test_a_step_of_three_to_a_turn_is_refused():
    with pytest.raises(ct.LimitError, match="speed = 80 Hz has 3 steps a period"):
        ct.run(jeffcott(80.0), t_end=0.1, dt=1.0 / 240.0)


@pytest.mark.parametrize(("factor", "stops"), [(0.95, False), (1.05, True)])
def test_a_rotor_whose_motion_grows_stops_at_its_limit_with_its_growth_and_whirl(factor, stops):
    hz = factor * OMEGA * (1.0 + ZETA / 0.03) / (2.0 * np.pi)  # 160 and 176 Hz, the threshold is 168 Hz
    rotor = jeffcott(hz, inner=0.03, unbalance=None, displacement=[1e-3, 0.0], limit=5e-3)
    asked = {"t_end": 6.0, "dt": 1e-4, "record": STATES}
    if not stops:
        assert ct.run(rotor, **asked).divergence is None
        return
    with pytest.raises(ct.NumericsError, match=r"expected at most 0\.005 m.*forward whirl at") as caught:
        ct.run(rotor, **asked)
    result = caught.value.result
    c, inner = 2.0 * (ZETA + 0.03) * OMEGA, 2.0 * 0.03 * OMEGA
    rate = np.roots([1.0, c, OMEGA**2 - 1j * inner * 2.0 * np.pi * hz]).real.max()
    assert result.growth.state == "grows"
    assert result.growth.rate == pytest.approx(rate, rel=0.02)
    assert result.divergence.theory == pytest.approx(rate, rel=1e-9)
    assert np.abs(orbit_of(rotor, result)).max() <= 5e-3 < result.divergence.reached < 5.1e-3
    kept = ct.run(rotor, **asked, on_limit="flag")
    assert [flag.code for flag in kept.flags] == ["motion-rotor"]
    assert not kept.flags[0].failed


def test_a_shaft_may_move_by_a_tenth_of_its_length_at_any_node():
    rotor = R.Rotor.of(shaft(), 60.0, modes=12, unbalance=R.Unbalance(moment=10.0))
    assert rotor.limit == pytest.approx(0.05)
    with pytest.raises(ct.NumericsError, match=r"the load drives it\. Check unbalance") as caught:
        ct.run(rotor, t_end=0.2, dt=2e-5)
    assert caught.value.result.divergence.reached > 0.05
    assert ct.run(replace(rotor, unbalance=R.Unbalance(moment=1e-3)), t_end=0.05, dt=2e-5).divergence is None
    with pytest.raises(ct.InputError, match=r"limit: found 0\.0, expected a positive length"):
        replace(rotor, limit=0.0)


@pytest.mark.parametrize("hz", [[10.0, 300.0], [-300.0, 10.0], [300.0, 300.0]])
def test_a_step_is_compared_with_the_fastest_of_the_speeds(hz):
    rotor = R.Rotor.of(R.Jeffcott(mass=M, stiffness=K, zeta=ZETA), ct.Speed(time=[0.0, 1.0], hz=hz))
    with pytest.raises(ct.LimitError, match=r"speed = 300 Hz has 3\.33 steps a period"):
        ct.run(rotor, t_end=1.0, dt=1e-3)
