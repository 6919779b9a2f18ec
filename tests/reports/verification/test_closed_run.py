"""How a confirming run starts, steps and is read: equilibrium and leading motion by matrices of the test's own."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import contact as ct
from reports.verification.rubs.closed_run import ConfirmingRun, _start, _step, closed_rub, confirming_run, exponent
from tests.contact.stability.test_closed_poles import TWO_BLADES, rim
from tests.contact.stability.test_turning_bodies import turning_ring
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips

PAIR = ct.gaps.HandPair(
    casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5, zeta=1e-3),
    blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4, zeta=0.02), compliance=1e-8, friction=0.2, lean_deg=30.0,
)  # fmt: skip
UNDAMPED = ct.gaps.HandPair(
    casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4),
    compliance=1e-4,
)


@pytest.mark.parametrize(("hz", "sign"), [(20.0, 1.0), (-20.0, 1.0), (38.0, -1.0)])
def test_a_confirming_run_starts_at_rest_plus_its_leading_motion(hz, sign):
    """Faster than its waves (37.5 turns/s) the rim gives way outwards, and a gap makes contacts press."""
    contact, press, dt = PAIR.contact(), 1e-5, 2e-5
    leading = max(ct.stability.poles(contact, np.array([hz]))[0], key=lambda s: (s.real, s.imag))
    found, q, v = _start(contact, hz, leading, press, dt)
    turn, damping, stiffness = 2.0 * np.pi * hz * contact.G, 2.0 * contact.zeta * contact.omega, contact.omega**2
    s = math.copysign(1.0, hz)
    W, S = contact.Q - contact.mu * s * contact.T, contact.S_nn - contact.mu * s * contact.S_nt
    assert found == sign * press

    def left(rate, x):
        """What the modes need beside the contact's forces, moving like e^(rate t) in the frame of the contact."""
        D = rate * np.eye(3) + turn
        return D @ D @ x + damping * (D @ x) + stiffness * x

    free = np.column_stack([left(0.0, unit) for unit in np.eye(3)])
    rest = np.linalg.solve(free + W.T @ contact.Q / S, (W.T @ [found]) / S[0, 0])
    force = (found - contact.Q @ rest) / S[0, 0]
    assert force[0] > 0.0
    np.testing.assert_allclose(left(0.0, rest), W.T @ force, rtol=1e-9)
    dynamic = np.column_stack([left(leading, unit) for unit in np.eye(3)]) + W.T @ contact.Q / S
    shape = np.linalg.svd(dynamic)[2][-1].conj()
    assert np.abs(dynamic @ shape).max() < 1e-8 * np.abs(dynamic).max()
    parts = np.column_stack([shape.real, -shape.imag])
    (a, b), *_ = np.linalg.lstsq(parts, q - rest, rcond=None)
    np.testing.assert_allclose(q - rest, parts @ [a, b], rtol=1e-6, atol=1e-9 * np.abs(q - rest).max())
    moved = complex(a, b) * shape
    assert abs((contact.Q @ moved)[0] / S[0, 0]) == pytest.approx(1e-3 * force[0], rel=1e-6)
    before = turn @ rest + ((leading * np.eye(3) + turn) @ moved).real
    pushed = W.T @ ((found - contact.Q @ q) / S[0])
    back = expm(-dt * np.block([[np.zeros((3, 3)), np.eye(3)], [-np.diag(stiffness), -np.diag(damping)]]))
    still = np.concatenate([pushed / stiffness, np.zeros(3)])
    earlier = still + back @ (np.concatenate([q, before]) - still)
    np.testing.assert_allclose((back @ np.concatenate([q, v]))[:3], earlier[:3], rtol=1e-12)
    velocity = np.linalg.solve(back[:3, 3:], earlier[:3] - back[:3, :3] @ q)
    np.testing.assert_allclose(v, velocity, rtol=1e-6, atol=1e-9 * np.abs(velocity).max())


def test_the_step_resolves_the_fastest_mode_the_motion_and_the_turning():
    """Radians a step: 0.4 of the fastest mode, 0.02 of the leading motion, 0.1 of the highest harmonic."""
    rub = ct.Rub(ring(), [blade()], speed=ct.Speed.constant(-5.0))
    fastest = max(ring().omega.max(), blade().omega.max())
    assert _step(rub, fastest, 1.0 + 2.0j) == pytest.approx(0.4 / fastest, rel=1e-14)
    assert _step(rub, fastest, 3e3 - 4e3j) == pytest.approx(0.02 / 5e3, rel=1e-14)
    quick = replace(rub, speed=ct.Speed.constant(-2e4))
    assert _step(quick, fastest, 1.0 + 0.0j) == pytest.approx(0.1 / (6 * 2.0 * math.pi * 2e4), rel=1e-14)
    still = replace(rub, speed=ct.Speed.constant(0.0))
    assert _step(still, fastest, 1.0 + 0.0j) == pytest.approx(0.4 / fastest, rel=1e-14)


def test_the_rub_of_a_confirming_run_is_round_closed_and_alone():
    one, other = tips(2)
    rub = ct.Rub(
        rim3(), [nodes(2)], [one, other], clearance=3e-4, speed=ct.Speed.constant(3.0), thickness=3e-3,
        profile=ct.gaps.RimProfile.fourier([{"p": 2, "cos": 1e-4}]), closing=ct.gaps.Closing.exponential(1e-4, 0.1),
        whirl=(ct.gaps.Whirl(amplitude=1e-5),),
        casing_start=ct.gaps.Start(velocity=np.ones(10)), blade_starts=(ct.gaps.Start(velocity=np.ones(3)),),
    )  # fmt: skip
    found, mu = closed_rub(rub, 11.0, 0.25)
    assert mu == 0.25
    assert found.clearance == pytest.approx(-1e-5 * 0.4, rel=1e-14)
    assert (found.speed.omega(0.3), found.thickness) == (2.0 * math.pi * 11.0, math.inf)
    assert (found.profile.farthest, float(np.abs(found.closing.by).max()), found.whirl) == (0.0, 0.0, ())
    assert (found.casing_start.velocity, found.blade_starts[0].velocity) == (None, None)
    assert [(tip.clearance, tip.axial, tip.angle_deg, tip.lean_deg) for tip in found.tips] == [
        (0.0, None, 10.0, 15.0), (0.0, None, 10.5, 15.0),
    ]  # fmt: skip
    rim = ct.RotatingRim(ring(), blade(), clearance=1e-4, speed_hz=5.0, lean_deg=20.0, angle_deg=30.0)
    found, mu = closed_rub(rim, -6.0, 0.1)
    assert (found.tips[0].lean_deg, found.tips[0].angle_deg, mu) == (20.0, 30.0, 0.1)
    assert found.clearance == pytest.approx(-1e-5 * 0.45, rel=1e-14)
    with pytest.raises(ct.InputError, match="what: found list, expected a RotatingRim, a Rub or a HandPair"):
        closed_rub([], 1.0, 0.0)


@pytest.mark.parametrize("lean", [30.0, -20.0, 0.0])
def test_a_pair_by_hand_becomes_a_rub_with_its_own_friction(lean):
    """Unit motion along the normal has the modal mass that is given."""
    found, mu = closed_rub(replace(PAIR, lean_deg=lean), 7.0, 0.9)
    assert mu == 0.2
    body, tip = found.blades[0], found.tips[0]
    normal, _ = tip.directions(body) @ body.rows
    assert normal[0] == pytest.approx(0.4**-0.5, rel=1e-12)
    assert (body.omega[0], body.zeta[0]) == (2.0 * math.pi * 120.0, 0.02)
    assert body.rows[0, 0] == (0.0 if lean else pytest.approx(0.4**-0.5, rel=1e-14))
    np.testing.assert_allclose(body.S, 1e-8 * np.eye(2), rtol=1e-14)
    assert found.casing.radius == 0.5
    np.testing.assert_array_equal(found.casing.rows, ct.gaps.pair_rim(PAIR.casing, radius=0.5).rows)


def test_growth_is_read_beside_a_drift_and_without_an_oscillation():
    t = 2e-3 * np.arange(600)
    drifting = 3.0 - 2.0 * t + 5.0 * t**2 + 0.01 * np.exp(-0.8 * t) * np.cos(150.0 * t)
    assert exponent(drifting, 2e-3, 150.5 / (2.0 * math.pi)) == pytest.approx(-0.8, rel=1e-4)
    for rate in (2.5, -4.0):
        assert exponent(7.0 + 0.3 * np.exp(rate * t), 2e-3, 0.0) == pytest.approx(rate, rel=1e-5)
        assert exponent(7.0 + 0.3 * np.exp(rate * t[:8]), 2e-3, 0.0) == pytest.approx(rate, rel=1e-4)
    assert math.isnan(exponent(np.exp(t[:7]), 2e-3, 0.0))


def test_a_confirming_run_compares_growths():
    run = ConfirmingRun(speed_hz=5.0, poles=4.0, run=4.5, seconds=0.25)
    assert run.off == 0.125
    assert run.to_dict() == {
        "speed_hz": 5.0, "growth_poles_1_s": 4.0, "growth_run_1_s": 4.5, "off_rel": 0.125, "seconds": 0.25,
    }  # fmt: skip
    assert math.isnan(replace(run, poles=0.0).off)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "mu", "hz"),
    [
        (UNDAMPED, 0.0, 52.844),
        (rim(), 0.3, 60.0),
        (rim(ring(imperfect=1e-3)), 0.3, 20.0),
        (TWO_BLADES, 0.3, 20.0),
        (rim(turning_ring()), 0.3, 60.0),
        (rim(turning_ring(), turning="blades"), 0.3, 20.0),
        (replace(TWO_BLADES, casing=turning_ring()), 0.3, 20.0),
    ],
)
def test_a_run_at_one_speed_confirms_the_poles(what, mu, hz):
    run = confirming_run(what, hz, mu=mu)
    assert run.run == pytest.approx(run.poles, rel=0.02)
    assert run.poles > 1.0


@pytest.mark.parametrize("hz", [5.0, 90.0, 400.0])
def test_a_run_is_refused_where_one_of_two_tips_side_by_side_lifts_off(hz):
    """The stiffer blade's tip presses the rim away from the other's, five degrees further."""
    tips = [replace(tip, angle_deg=5.0 * k) for k, tip in enumerate(TWO_BLADES.tips)]
    words = rf"^contact: found forces at rest from (\S+) to (\S+) N at {hz:g} Hz, expected all above 0: not every"
    with pytest.raises(ct.InputError, match=words) as caught:
        confirming_run(replace(TWO_BLADES, tips=tips), hz, mu=0.3)
    low, high = (float(force) for force in re.match(words, str(caught.value)).groups())
    assert low < 0.0 < high


def test_only_what_turns_is_run_closed():
    with pytest.raises(ct.InputError, match="what: found list, expected a RotatingRim, a Rub or a HandPair"):
        confirming_run([PAIR], 5.0)
