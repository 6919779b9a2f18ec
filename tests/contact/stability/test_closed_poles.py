"""Poles of closed contact by their equation and by eigenvalues, the mean of split pairs, scenes over speeds."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring


def rim(casing=None, **more):
    given = {"clearance": -1e-5, "speed_hz": 5.0, "lean_deg": 10.0} | more
    return ct.RotatingRim(casing or ring(), blade(), **given)


TWO_BLADES = ct.Rub(
    ring(), (blade(), blade(psi=0.8)),
    [ct.ContactPoint(blade=k, span="span", flap="flap", angle_deg=180.0 * k, lean_deg=10.0) for k in range(2)],
)  # fmt: skip


def test_the_mean_of_split_pairs_is_that_over_all_angles_at_which_they_could_are():
    """Compliances turned by hand through a turn; frequency and damping of a pair are the mean of its two."""
    casing, N, size = ring(imperfect=0.05), 6, 13
    mean, turned = ct.stability.perfect_mean(replace(casing, zeta=np.tile([0.01, 0.04], 5))), np.zeros((26, 26))
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
    assert ct.stability.perfect_mean(lone).omega.size == 8
    size = 13  # radial compliance at one angle: what the mode of n = 6 gave there, averaged over the angle
    gone = lone.rows[:size, 8] @ lone.rows[:size, 8] / lone.omega[8] ** 2
    assert np.trace(ct.stability.perfect_mean(lone).S[:size, :size]) == pytest.approx(
        np.trace(lone.S[:size, :size]) + gone
    )
    assert cut.omega.size == 8


def test_scenes_of_four_kinds_have_speeds_and_others_are_refused(tmp_path):
    file = tmp_path / "pair.toml"
    pair = (
        '[scene]\nkind = "pair"\n[casing]\nn = 8\nfreq_hz = 300.0\nmodal_mass = 1.5\n[blade]\nfreq_hz = 120.0\n'
        "modal_mass = 0.4\n[contact]\ncompliance = 1e-4\n[speed]\nfrom_hz = 52.0\nto_hz = 54.0\nsteps = 5\n"
    )
    file.write_text(pair)
    assert ct.scene.load_interactions(file).speed_hz.tolist() == [52.0, 52.5, 53.0, 53.5, 54.0]
    disk = (
        '[scene]\nkind = "disk"\nt_end = 1.0\n[casing.pair]\nn = 3\nfreq_hz = 290.0\nmodal_mass = 2.0\nradius = 0.5\n'
        "[disk]\nblades = 9\nfreq_hz = 115.0\nmodal_mass = 0.1\n[contact]\nclearance = 0.0\nfriction = 0.1\n[speed]\n"
        'hz = {}\n[scheme]\nkind = "exact-modal"\ndt = 5e-5\n'
    )
    file.write_text(disk.format("10.0"))
    scene = ct.scene.load_interactions(file)
    assert (scene.scene.law.mu, scene.speed_hz[-1], scene.speed_hz.size) == (0.1, 20.0, 200)
    file.write_text(disk.format("0.0"))
    with pytest.raises(ct.scene.SceneError, match=r"speed.scan: missing"):
        ct.scene.load_interactions(file)
    file.write_text('[scene]\nkind = "rods"\nt_end = 1.0\n[scheme]\nkind = "penalty"\ncourant = 0.5\nstiffness = 1.0\n')
    with pytest.raises(ct.scene.SceneError, match=r"found 'rods', expected 'pair', 'rim', 'rub', 'disk' or 'rotor'"):
        ct.scene.load_interactions(file)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_growth_of_many_modes_is_that_of_the_eigenvalues(sense):
    """With more than thirty modes the roots of one scalar equation replace the eigenvalues of all."""
    thin = ct.bodies.ThinRing(
        radius=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, k_r=1e6, k_t=1e5, zeta=0.002
    )  # fmt: skip
    rim = ct.RotatingRim(
        ct.bodies.ring_modes(thin, 9), blade(S=2e-8), clearance=-1e-5, speed_hz=5.0 * sense, lean_deg=10.0
    )
    contact, speeds = ct.gaps.rim_contact(rim, mu=0.2), sense * np.linspace(3.0, 60.0, 7)[:: int(sense)]
    found = ct.stability.of_contact(contact, speeds)
    np.testing.assert_allclose(found.growth, ct.stability.poles(contact, speeds).real.max(axis=1), atol=1e-8)
    assert np.ptp(found.growth) > 10.0


def test_speeds_known_for_all_bodies_are_those_that_each_knows():
    def body(*speeds):
        return ct.ModalBody(
            omega=[1.0], zeta=[0.0], channels=("x",), rows=[[1.0]], S=[[1.0]], stiffness_by_speed=[[0.5]],
            known_speeds=speeds,
        )  # fmt: skip

    contact = ct.gaps.rim_contact(rim(), mu=0.1)
    for speeds, both in (
        (((3.0, 20.0), (5.0, 30.0)), (5.0, 20.0)),
        (((3.0, 40.0), (2.0, 30.0)), (3.0, 30.0)),
        ((), (0.0, np.inf)),
    ):
        assert replace(contact, known=tuple(body(*one) for one in speeds)).known_speeds == both
