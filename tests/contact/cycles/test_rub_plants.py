"""Plants and drives of rubs that slide at all times, by hand."""

import math

import numpy as np
import pytest

import contact as ct
from contact.cycles.rubbing import _drive, _plant
from contact.model.gaps.permanent import rub_contact
from tests.contact.synthetic_rim import blade, ring


def two_blades(**given):
    tips = (
        ct.ContactPoint(angle_deg=20.0, lean_deg=10.0, clearance=1e-6),
        ct.ContactPoint(blade=1, angle_deg=150.0, lean_deg=-5.0),
    )
    usual = {"tips": tips, "clearance": 2e-6, "speed": ct.Speed.constant(5.0)}
    return ct.Rub(ring(), (blade(), blade(psi=0.9)), **usual | given)


@pytest.mark.parametrize("speed", [31.0, -31.0])
@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_the_plant_of_a_rub_is_its_closed_contact_in_the_blades_frame(speed, mu):
    rub = two_blades()
    contact, sense = rub_contact(rub, mu=mu), math.copysign(1.0, speed)
    found, m = _plant(rub, contact, speed, 5e6), contact.omega.size
    w, q, v = contact.omega, np.random.default_rng(1).standard_normal(m), np.random.default_rng(2).standard_normal(m)
    turn = -speed * contact.G
    rate = found.A @ np.concatenate([q, v / w])  # v = (D + Omega G) q
    np.testing.assert_allclose(rate[:m], v + turn @ q, rtol=1e-10, atol=1e-8)
    np.testing.assert_allclose(w * rate[m:], turn @ v - 2.0 * contact.zeta * w * v - w**2 * q, rtol=1e-9, atol=1e-5)
    W = contact.Q - mu * sense * contact.T
    np.testing.assert_allclose(found.B, np.vstack([np.zeros((m, 2)), W.T / w[:, None]]), rtol=1e-12)
    np.testing.assert_allclose(found.C, np.hstack([contact.Q, np.zeros((2, m))]), rtol=1e-12)
    S = contact.S_nn - mu * sense * contact.S_nt + np.eye(2) / 5e6
    np.testing.assert_allclose(found.S, S, rtol=1e-12)
    slip = found.D[6:] @ np.concatenate([q, v / w])
    np.testing.assert_allclose(slip, sense * contact.T @ v, rtol=1e-9, atol=1e-9)
    assert not found.E[6:].any()
    assert found.slips == (((0, 6), (1, 7)) if mu else ())
    assert found.hidden == 2
    assert not found.restitution.any()
    held = w.max() ** 2 + np.linalg.norm(W.T @ np.linalg.solve(S, contact.Q), 2)
    lost = (2.0 * contact.zeta * w).max()
    assert found.rate == pytest.approx(math.sqrt(held) + lost + np.abs(turn).sum(axis=1).max(), rel=1e-12)


def test_what_a_rub_shows_are_casing_span_and_flap_at_each_tip():
    rub = two_blades()
    contact = rub_contact(rub, mu=0.3)
    found, m = _plant(rub, contact, 31.0, math.inf), contact.omega.size
    for j in (0, 1):
        np.testing.assert_allclose(found.D[3 * j, :10], contact.Q[j, :10], rtol=1e-12)
        assert not found.D[3 * j, 10:].any()
        expected = np.zeros((2, 2 * m))
        expected[:, 10 + 2 * j : 12 + 2 * j] = rub.blades[j].rows
        np.testing.assert_allclose(found.D[3 * j + 1 : 3 * j + 3], expected, rtol=1e-12)
    assert ct.cycles.RimFamily(rim=rub).channels == ("casing_1", "span_1", "flap_1", "casing_2", "span_2", "flap_2")
    one = ct.RotatingRim(ring(), blade(), clearance=1e-5, speed_hz=5.0)
    assert ct.cycles.RimFamily(rim=one).channels == ("casing", "span", "flap")
    S = contact.S_nn - 0.3 * contact.S_nt  # the casing's own share: all of it less the blade's
    for j, lean in enumerate(np.radians([10.0, -5.0])):
        n, t = np.array([math.cos(lean), math.sin(lean)]), np.array([-math.sin(lean), math.cos(lean)])
        own = n @ rub.blades[j].S @ (n - 0.3 * t)
        assert found.E[3 * j, j] == pytest.approx(S[j, j] - own, rel=1e-9)
        assert found.E[3 * j, 1 - j] == pytest.approx(S[j, 1 - j], rel=1e-9)


@pytest.mark.parametrize("speed", [31.0, -31.0])
def test_the_drive_of_a_rub_is_what_passes_its_tips(speed):
    rub, waves = two_blades(), {0: np.array([1e-6, 2e-6]), 4: np.array([3e-6, 1j * 1e-6]), 6: np.array([0.0, 5e-6])}
    contact = rub_contact(rub)
    found = _drive(rub, contact, speed, waves, 2)
    assert (found.w, found.harmonics.tolist()) == (62.0, [2.0, 3.0])
    np.testing.assert_allclose(found.c.rest, [4e-6, 4e-6], rtol=1e-12)
    np.testing.assert_array_equal(found.c.wave, [[3e-6, 0.0], [1e-6j, 5e-6]])
    assert found.d.rest.tolist() == [0.0] * 6 + [31.0 * 0.45] * 2
    assert not any(part.any() for part in (found.b.rest, found.b.wave, found.d.wave))
    round_rim = _drive(rub, contact, speed, {}, 3)
    assert (round_rim.w, round_rim.harmonics.tolist(), round_rim.c.wave.tolist()) == (93.0, [1.0], [[0j], [0j]])
    np.testing.assert_allclose(round_rim.c.rest, [3e-6, 2e-6], rtol=1e-12)


def test_a_rub_varies_over_speed_clearance_or_friction():
    start = {"casing_start": ct.gaps.Start(displacement=np.arange(10.0)),
             "blade_starts": [ct.gaps.Start(velocity=[3.0, 5.0]), ct.gaps.Start()]}  # fmt: skip
    rub = two_blades(**start, profile=ct.RimProfile.fourier([{"p": 4, "cos": 1e-6}, {"p": 6, "sin": 2e-6}]))
    motion, period = ct.cycles.RimFamily(rim=rub, mu=0.2).at(-3.0)
    assert period == pytest.approx(1.0 / 6.0)  # half a turn
    assert motion.drive.w == pytest.approx(12.0 * math.pi)
    np.testing.assert_allclose(motion.plant.S, rub_contact(rub, mu=0.2).compliance(-1.0), rtol=1e-12)
    wide, period = ct.cycles.RimFamily(rim=rub, name="clearance").at(9e-6)
    np.testing.assert_allclose(wide.drive.c.rest, [1e-5, 9e-6], rtol=1e-12)
    assert period == pytest.approx(0.1)
    rough, _ = ct.cycles.RimFamily(rim=rub, name="friction").at(0.4)
    np.testing.assert_allclose(rough.plant.S, rub_contact(rub, mu=0.4).compliance(1.0), rtol=1e-12)
    assert len(rough.plant.slips) == 2
    begin = ct.cycles.RimFamily(rim=rub).begin
    assert begin[:14].tolist() == [*np.arange(10.0), 0.0, 0.0, 0.0, 0.0]
    assert begin[24:26] == pytest.approx([3.0 / (240.0 * math.pi), 5.0 / (1800.0 * math.pi)])
    assert not begin[[*range(14, 24), 26, 27]].any()
    assert period / ct.cycles.RimFamily(rim=rub, looks=20).at(5.0)[0].step == pytest.approx(20.0)
    with pytest.raises(ct.InputError, match="speed_hz: found 0, expected a rim that turns"):
        ct.cycles.RimFamily(rim=rub).at(0.0)
    with pytest.raises(ct.InputError, match=r"friction: found -0\.1"):
        ct.cycles.RimFamily(rim=rub, mu=-0.1)
    with pytest.raises(ct.InputError, match="looks: found 7"):
        ct.cycles.RimFamily(rim=rub, looks=7)
    assert ct.cycles.RimFamily(rim=rub).stiffness == math.inf
