"""One answer to "at which speed?": the table against formulas, poles against eigenvalues, a run beside it."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import linear_sum_assignment

import contact as ct
from contact.confirmed import confirming_run
from contact.growth.closed_contact import closed_poles, growth, poles, poles_each
from contact.growth.coincidence import loaded
from contact.growth.interaction_table import _above, _pressed, pulse_ratio
from contact.growth.split_casing import mean_contact, perfect_mean
from contact.growth.waves import waves_of
from contact.model.gaps.permanent import HandPair, ModalPair, rim_contact, rub_contact
from contact.scene.stability import load_interactions
from tests.contact.growth.test_turning_bodies import turning_ring
from tests.contact.synthetic_rim import blade, ring

B6 = HandPair(
    casing=ModalPair(n=8, freq_hz=300.0, modal_mass=1.5), blade=ModalPair(freq_hz=120.0, modal_mass=0.4),
    compliance=1e-4,
)  # fmt: skip


def rim(casing=None, **more):
    given = {"clearance": -1e-5, "speed_hz": 5.0, "lean_deg": 10.0} | more
    return ct.RotatingRim(casing or ring(), blade(), **given)


TWO_BLADES = ct.Rub(
    ring(), (blade(), blade(psi=0.8)),
    [ct.ContactPoint(blade=k, span="span", flap="flap", angle_deg=180.0 * k, lean_deg=10.0) for k in range(2)],
)  # fmt: skip


@pytest.mark.parametrize("mu", [0.0, 0.3])
@pytest.mark.parametrize("hz", [0.3, 5.0, 60.0, -20.0])
def test_the_characteristic_equation_has_the_eigenvalues(mu, hz):
    contact = rim_contact(rim(), mu=mu)
    sense = np.sign(hz)
    found = closed_poles(waves_of(contact), float(contact.compliance(sense)[0, 0]), 2.0 * np.pi * hz)
    every = poles(contact, np.array([hz]))[0]
    distance = np.abs(found[:, None] - every)
    assert distance[linear_sum_assignment(distance)].max() < 1e-9 * np.abs(every).max()


def test_many_modes_go_by_the_equation_and_few_or_many_contacts_by_eigenvalues(monkeypatch):
    contact, speeds = rim_contact(rim(), mu=0.3), np.array([5.0, 60.0])
    by_eigenvalues = growth(contact, speeds)
    monkeypatch.setattr("contact.growth.closed_contact.MANY", 1)
    assert growth(contact, speeds) == pytest.approx(by_eigenvalues, rel=1e-9)
    two = mean_contact(TWO_BLADES, mu=0.3)[0]
    assert growth(two, speeds) == pytest.approx([every.real.max() for every in poles(two, speeds)], rel=1e-12)
    monkeypatch.setattr("contact.growth.closed_contact.closed_poles", lambda *_: None)  # it did not settle
    assert growth(contact, speeds) == pytest.approx(by_eigenvalues, rel=1e-12)
    assert len(poles_each(contact, speeds)) == 2


def test_a_perfect_casing_is_its_own_mean_and_split_pairs_come_near_it():
    at = np.array([5.0, 20.0, 60.0])
    own = growth(rim_contact(rim(), mu=0.3), at)
    assert growth(rim_contact(rim(perfect_mean(ring())), mu=0.3), at) == pytest.approx(own, rel=1e-9)
    mean, averaged = mean_contact(rim(ring(imperfect=1e-3)), mu=0.3)
    assert averaged
    assert growth(mean, at) == pytest.approx([32.159, 27.929, 315.555], rel=0.02)  # Floquet's theory of the split one


def test_the_mean_of_split_pairs_is_that_over_all_angles_at_which_they_could_stand():
    """Compliances turned by hand through a turn; frequency and damping of a pair are the mean of its two."""
    casing, N, size = ring(imperfect=0.05), 6, 13
    mean, turned = perfect_mean(replace(casing, zeta=np.tile([0.01, 0.04], 5))), np.zeros((26, 26))
    for phi in 2.0 * np.pi * np.arange(16) / 16:
        R = np.eye(size)
        for n in range(1, N + 1):
            c, s = np.cos(n * phi), np.sin(n * phi)
            R[np.ix_([n, N + n], [n, N + n])] = [[c, s], [-s, c]]
        turned += np.kron(np.eye(2), R) @ casing.S @ np.kron(np.eye(2), R).T / 16
    assert np.abs(turned[1:7, 20:]).max() > 0.01 * np.abs(turned).max()  # radial cosines move tangential sines
    np.testing.assert_allclose(mean.S, turned, atol=1e-9 * np.abs(turned).max())
    assert mean.omega == pytest.approx(np.repeat(casing.omega.reshape(5, 2).mean(axis=1), 2), rel=1e-12)
    assert mean.zeta == pytest.approx([0.025] * 10, rel=1e-12)


def test_a_mode_without_partner_goes_into_the_compliance():
    cut = ring().truncated(ring().omega[-1] * 0.99)
    lone = replace(ring(), omega=ring().omega * np.r_[np.ones(9), 1.5]).truncated(ring().omega[-2] * 1.01)
    assert perfect_mean(lone).omega.size == 8
    size = 13  # radial compliance at one angle: what the mode of n = 6 gave there, averaged over the angle
    gone = lone.rows[:size, 8] @ lone.rows[:size, 8] / lone.omega[8] ** 2
    assert np.trace(perfect_mean(lone).S[:size, :size]) == pytest.approx(np.trace(lone.S[:size, :size]) + gone)
    assert cut.omega.size == 8


def test_the_hand_pairs_row_is_that_of_the_formulas():
    found = ct.growth.interactions(B6, np.linspace(20.0, 60.0, 161))
    (top, other), formula = found.rows, loaded(B6)
    assert (top.n, top.branch) == (8, "sum")
    assert (top.casing_hz, top.blade_hz, top.free_hz, top.wave_hz) == pytest.approx((300.0, 120.0, 52.5, 37.5))
    assert top.closed_hz == pytest.approx(formula.speed_hz, rel=1e-4)
    assert (top.growth, top.growth_hz) == pytest.approx((3.7883, 52.844), rel=1e-3)
    assert (top.from_hz, top.to_hz) == pytest.approx((52.693, 52.9945), rel=1e-5)
    assert top.turns == pytest.approx(52.844 * np.log(1000.0) / 3.7883, rel=1e-3)
    assert other.branch == "backward"
    assert np.isnan([other.from_hz, other.turns]).all()
    assert found.waves[0] == pytest.approx((8, 300.0, 37.5))
    for words in ("f_c/n, at 37.5 Hz (n = 8)", "52.6930-52.9945", "turns: turns in which"):
        assert words in repr(found)


def test_pulses_are_the_force_of_a_shape_that_passes_slowly_over_the_force_that_presses():
    """At a crawl a wave of p is a static load: the ratio is the shape over the overlap, by their compliances."""
    contact = rim_contact(rim())
    slow = pulse_ratio(contact, np.array([1e-6]), np.array([1e-5]), [(0, 1.0, 0.0), (3, 3e-6, 4e-6)])
    assert slow == pytest.approx([0.5], rel=1e-6)
    assert np.isinf(pulse_ratio(contact, np.array([1.0]), np.array([-1e-5]), [])).all()
    found = ct.growth.interactions(rim(out_of_roundness=[{"p": 2, "cos": 5e-5}]), np.linspace(1.0, 10.0, 10), mu=0.3)
    assert found.opens_hz == ((1.0, 10.0),)
    assert "Contact cannot stay closed at 1-10 Hz" in repr(found)


def test_a_wave_meets_tips_at_two_angles_one_after_the_other():
    """Step by step in the casing's frame, where the tips move: forces of a unit wave and of a unit overlap of both."""
    casing, at, p, hz, steps = ring(zeta=0.1, S=1e-5), np.radians([0.0, 50.0]), 3, 20.0, 1000
    tips = [ct.ContactPoint(blade=k, angle_deg=50.0 * k) for k in range(2)]
    contact = rub_contact(ct.Rub(casing, (blade(zeta=0.1), blade(zeta=0.1, psi=0.8)), tips, clearance=-1e-5))
    m, h = contact.omega.size, 1.0 / hz / steps
    lost = np.diag(2.0 * contact.zeta * contact.omega)
    drift = expm(h * np.block([[np.zeros((m, m)), np.eye(m)], [-np.diag(contact.omega**2), -lost]]))
    turn, give = expm(-2.0 * np.pi / steps * contact.G), np.linalg.inv(contact.S_nn)
    x, Q, force = np.zeros((2 * m, 2)), contact.Q, np.zeros((steps, 2, 2))
    for k in range(5 * steps):
        overlap = np.column_stack([np.cos(p * (at - 2.0 * np.pi * k / steps)), np.ones(2)])
        force[k % steps] = give @ (overlap - Q @ x[:m])
        x[m:] += h * (Q.T @ force[k % steps])
        x, Q = drift @ x, Q @ turn
    swing, still = np.ptp(force[..., 0], axis=0).max() / 2.0, force[-1, :, 1].min()
    found = pulse_ratio(contact, np.array([hz]), np.ones(2), [(p, 0.6, -0.8)], at)
    assert found == pytest.approx([swing / still], rel=0.005)


def test_what_presses_is_clearance_of_rub_and_tip_the_mean_of_the_profile_and_how_far_the_rim_closed():
    rub = replace(
        TWO_BLADES, tips=[replace(tip, clearance=1e-5 * k) for k, tip in enumerate(TWO_BLADES.tips)], clearance=-2e-5,
        profile=ct.gaps.RimProfile.fourier([{"p": 0, "cos": 3e-6}, {"p": 2, "cos": 1e-6, "sin": 2e-6}]),
        closing=ct.gaps.Closing(time=[0.0, 1.0], by=[0.0, 7e-6]),
    )  # fmt: skip
    press, angle, terms = _pressed(rub)
    assert press == pytest.approx([2e-5 - 3e-6 + 7e-6, 1e-5 - 3e-6 + 7e-6], rel=1e-12)
    assert angle == pytest.approx([0.0, np.pi], rel=1e-12)
    assert (2, 1e-6, 2e-6) in terms


def test_bands_that_open_begin_and_end_where_the_ratio_is_one():
    at = np.array([1.0, 2.0, 4.0, 6.0, 7.0, 9.0])
    for ratio, bands in (
        ([0.0, 0.5, 2.5, 0.25, 0.75, 1.25], [(2.5, 4.0 + 2.0 / 1.5), (8.0, 9.0)]),
        ([3.0, 0.0, 0.5, np.inf, 1.5, 0.5], [(1.0, 1.0 + 2.0 / 3.0), (5.0, 8.0)]),
    ):
        np.testing.assert_allclose(_above(at, np.array(ratio)), bands, rtol=1e-12)
    assert _above(at, np.full(6, 0.999)) == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "mu", "hz"),
    [
        (B6, 0.0, 52.844),
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


@pytest.mark.slow
def test_the_worst_speed_is_run_where_something_diverges_and_a_disk_has_its_row():
    found = ct.interactions(B6, np.linspace(52.0, 54.0, 21))
    assert abs(found.run.off) < 0.01
    assert found.to_dict()["run"]["growth_run_1_s"] == found.run.run
    assert ct.interactions(B6, np.linspace(20.0, 24.0, 21)).run is None
    disk = ct.BladedDisk(blades=9, freq_hz=115.0, modal_mass=0.1, compliance=5e-5, lean_deg=45.0)
    casing = ct.model.gaps.bladed_disk.pair_rim(ModalPair(n=3, freq_hz=290.0, modal_mass=2.0), radius=0.5)
    rub = ct.Rub(casing, (disk.body(),), disk.tips(), clearance=-1e-4)
    several = ct.interactions(rub, np.linspace(130.0, 142.0, 61))
    top = several.found.rows[0]
    assert (top.n, top.branch, top.free_hz) == (3, "sum", pytest.approx(135.0))
    assert np.isnan(top.closed_hz)
    assert several.run.run == pytest.approx(several.run.poles, rel=0.05)


def test_scenes_of_four_kinds_have_speeds_and_others_are_refused(tmp_path):
    file = tmp_path / "pair.toml"
    pair = (
        '[scene]\nkind = "pair"\n[casing]\nn = 8\nfreq_hz = 300.0\nmodal_mass = 1.5\n[blade]\nfreq_hz = 120.0\n'
        "modal_mass = 0.4\n[contact]\ncompliance = 1e-4\n[speed]\nfrom_hz = 52.0\nto_hz = 54.0\nsteps = 5\n"
    )
    file.write_text(pair)
    assert load_interactions(file).speed_hz.tolist() == [52.0, 52.5, 53.0, 53.5, 54.0]
    disk = (
        '[scene]\nkind = "disk"\nt_end = 1.0\n[casing.pair]\nn = 3\nfreq_hz = 290.0\nmodal_mass = 2.0\nradius = 0.5\n'
        "[disk]\nblades = 9\nfreq_hz = 115.0\nmodal_mass = 0.1\n[contact]\nclearance = 0.0\nfriction = 0.1\n[speed]\n"
        'hz = {}\n[scheme]\nkind = "exact-modal"\ndt = 5e-5\n'
    )
    file.write_text(disk.format("10.0"))
    scene = load_interactions(file)
    assert (scene.mu, scene.speed_hz[-1], scene.speed_hz.size) == (0.1, 20.0, 200)
    file.write_text(disk.format("0.0"))
    with pytest.raises(ct.scene.SceneError, match=r"speed.scan: missing"):
        load_interactions(file)
    file.write_text('[scene]\nkind = "rods"\nt_end = 1.0\n[scheme]\nkind = "penalty"\ncourant = 0.5\nstiffness = 1.0\n')
    with pytest.raises(ct.scene.SceneError, match=r"found 'rods', expected 'pair', 'rim', 'rub' or 'disk'"):
        load_interactions(file)


def test_speeds_ascend_from_above_zero():
    for speeds in ([0.0, 1.0], [2.0, 1.0], [1.0]):
        with pytest.raises(ct.InputError, match="speed_hz: found speeds that do not ascend"):
            ct.growth.interactions(B6, speeds)
