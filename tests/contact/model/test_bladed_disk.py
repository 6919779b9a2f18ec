"""Disks of blades: cyclic symmetry, the two-dimensional model, and runs against poles."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import contact as ct
from contact.model.gaps.bladed_disk import pair_rim, two_dimensional
from contact.model.gaps.permanent import SplitError, disk_contact, rub_contact
from contact.stability.closed_contact import growth
from tests.contact.synthetic_rim import ring

SCENE = Path(__file__).parents[3] / "data" / "scenes" / "bladed_disk.toml"


def disk(blades=12, **changes):
    return ct.BladedDisk(**{"blades": blades, "freq_hz": 100.0, "modal_mass": 0.4, "coupling": 0.05, **changes})


@pytest.mark.parametrize("blades", [2, 5, 12, 13])
def test_tuned_modes_are_waves_of_nodal_diameters(blades):
    """omega_n^2 = omega_b^2 + 4 k_c/m sin^2(pi n/N): n = 0 and N/2 once, all others twice."""
    tuned = disk(blades)
    n = np.arange(blades)
    folded = np.minimum(n, blades - n)
    assert np.sort(tuned.body().omega) == pytest.approx(np.sort(2.0 * np.pi * tuned.tuned_hz()[folded]), rel=1e-12)
    assert len(tuned.tuned_hz()) == blades // 2 + 1


def test_mistuned_blades_without_coupling_keep_their_own_frequencies():
    deviation = np.linspace(-0.02, 0.03, 6)
    body = disk(6, coupling=0.0, mistuning=deviation).body()
    assert body.omega / (2.0 * np.pi) == pytest.approx(100.0 * (1.0 + deviation), rel=1e-12)
    assert np.abs(body.rows[1::2]).max(axis=0) == pytest.approx(0.4**-0.5)


def test_mistuning_splits_the_pairs_by_its_harmonic_2n():
    """To first order n splits by the 2n-th harmonic of the blades' squared frequencies, and only by that."""
    theta = 2.0 * np.pi * np.arange(12) / 12
    omega = disk(mistuning=1e-4 * np.cos(4 * theta)).body().omega
    pairs = np.diff(omega)[[1, 3, 5, 7, 9]] / omega[[1, 3, 5, 7, 9]]  # n = 1 .. 5
    split = 1e-4 * (100.0 / disk().tuned_hz()[2]) ** 2
    assert pairs[1] == pytest.approx(split, rel=1e-3)
    assert pairs[3] == pytest.approx(1e-4 * (100.0 / disk().tuned_hz()[4]) ** 2, rel=1e-3)  # 2 * 4 = 12 - 4
    assert np.abs(pairs[[0, 2, 4]]).max() <= 1e-7


def pairs(n=5):
    return ct.gaps.ModalPair(n=n, freq_hz=300.0, modal_mass=2.0), ct.gaps.ModalPair(n=n, freq_hz=120.0, modal_mass=1.0)


def test_tips_in_a_row_are_the_closed_form_of_the_disk_in_its_casing():
    """Two ways to the same poles: 22 tips one by one, and the sum over them in closed form."""
    speed = np.linspace(80.0, 90.0, 21)
    rub = two_dimensional(*pairs(), blades=22, stiffness=1e4, press=1e-3, speed_hz=84.0)
    expected = growth(disk_contact(*pairs(), stiffness=1e4, blades=22), speed)
    assert expected.max() > 25.0
    assert growth(rub_contact(rub), speed) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_one_tip_is_the_blade_before_a_rim(mu):
    blade = disk(2, coupling=0.0, compliance=1e-6).body()
    casing = ring()
    one = ct.Rub(casing, (blade,), (ct.ContactPoint(span="span0", flap="flap0", lean_deg=20.0),))
    point = replace(blade, channels=("span", "flap", "span1", "flap1"))
    rim = ct.RotatingRim(casing, point, clearance=0.0, speed_hz=5.0, lean_deg=20.0)
    speed = np.linspace(1.0, 60.0, 31)
    assert growth(rub_contact(one, mu=mu), speed) == pytest.approx(
        growth(ct.gaps.rim_contact(rim, mu=mu), speed), abs=1e-9
    )
    with pytest.raises(SplitError, match="expected a perfect casing"):
        rub_contact(replace(one, casing=ring(imperfect=0.05)))


@pytest.mark.parametrize("part", [1e-4, 0.05])
def test_residual_compliance_may_vary_around_the_rim_by_a_thousandth(part):
    """As a mesh makes it: taken in the mean; beyond, the casing is not perfect."""
    blade, casing = disk(2, coupling=0.0).body(), ring()
    S = casing.S.copy()
    S[1, 1] += part * np.abs(S).max()  # of cos theta alone, not of sin theta
    rub = ct.Rub(casing, (blade,), (ct.ContactPoint(span="span0", flap="flap0", lean_deg=20.0),))
    varied, speed = replace(rub, casing=replace(casing, S=S)), np.linspace(1.0, 60.0, 31)
    if part > 1e-3:
        with pytest.raises(SplitError, match="S that depends on the angle"):
            rub_contact(varied)
    else:
        assert growth(rub_contact(varied), speed) == pytest.approx(growth(rub_contact(rub), speed), abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("speed_hz", "grows"), [(86.65, True), (84.0, False)])
def test_runs_grow_as_the_poles_say(speed_hz, grows):
    rub = two_dimensional(*pairs(), blades=22, stiffness=1e4, press=1e-3, speed_hz=speed_hz, velocity=1e-6)
    result = ct.run(rub, t_end=0.3, dt=5e-5, record=ct.Record(every=2, state_every=2))
    assert np.all(result.contact_steps == result.steps)
    q = np.hstack([result.state_of("casing"), result.state_of("blade")])
    level = [np.linalg.norm(q[i : i + 300]) for i in range(1000, len(q) - 300, 100)]
    rate = np.polyfit(0.01 * np.arange(len(level)), np.log(level), 1)[0]
    pole = float(growth(rub_contact(rub), np.array([speed_hz]))[0])
    if grows:
        assert rate == pytest.approx(pole, rel=0.02)
    else:
        assert abs(pole) < 1e-9
        assert abs(rate) < 1.0


@pytest.mark.slow
def test_the_mistuned_scene_opens_its_tips():
    scene = ct.load_scene(SCENE)
    result = ct.run(scene, t_end=0.5)
    assert result.impulse.size == 12
    assert all(len(intervals) > 3 for intervals in result.intervals)
    assert abs(result.energy.unaccounted) <= 1e-11 * result.energy.scale
    first, last = (np.abs(result.force[part]).max() for part in (slice(0, 200), slice(-200, None)))
    assert last > 2.0 * first


@pytest.mark.slow
def test_a_split_casing_from_a_file_is_taken(tmp_path):
    """As an updated casing has its doublets apart."""
    ring(imperfect=0.05).save(tmp_path / "casing.npz")
    text = SCENE.read_text(encoding="utf-8")
    pair = text[text.index("[casing.pair]") : text.index("[disk]")]
    file = tmp_path / "scene.toml"
    file.write_text(text.replace(pair, '[casing]\nbasis = "casing.npz"\n'))
    scene = ct.load_scene(file)
    assert scene.source["sha256"] != ct.load_scene(SCENE).source["sha256"]
    result = ct.run(scene, t_end=0.02, dt=1e-5)
    assert result.blocks[0][:3] == ("casing", 0, 10)
    assert result.impulse.min() > 0.0
    assert abs(result.energy.unaccounted) <= 1e-11 * result.energy.scale


def test_bad_disks(tmp_path):
    with pytest.raises(ct.InputError, match="blades: found 1, expected"):
        disk(1)
    with pytest.raises(ct.InputError, match=r"mistuning: found shape \(3,\), expected \(12,\)"):
        disk(mistuning=[0.0, 0.0, 0.0])
    with pytest.raises(ct.InputError, match="mistuning: found -1, expected every one above -1"):
        disk(2, mistuning=[0.0, -1.0])
    with pytest.raises(ct.InputError, match="n: found casing 5, disk 5, 10 blades"):
        two_dimensional(*pairs(), blades=10, stiffness=1e4, press=1e-3, speed_hz=1.0)
    text = SCENE.read_text(encoding="utf-8")
    file = tmp_path / "scene.toml"
    for old, new, words in (
        ("[casing.pair]", "[casing]\nbasis = 'a'\n[casing.pair]", r"casing: basis and pair found, expected one"),
        ("n = 4\n", "", r"casing.pair.n: missing"),
        ("blades = 12", "blades = 11", r"mistuning: found shape \(12,\), expected \(11,\)"),
        ("clearance = -1e-3", "clearance = -1.0", r"clearance: found -1 m at tip 0"),
    ):
        file.write_text(text.replace(old, new))
        with pytest.raises(ct.scene.SceneError, match=words):
            ct.load_scene(file)


def test_a_pair_as_a_rim_moves_inextensionally():
    rim = pair_rim(ct.gaps.ModalPair(n=3, freq_hz=100.0, modal_mass=4.0), radius=0.3)
    radial, tangential = rim.rows[:7], rim.rows[7:]
    assert radial[3, 0] == radial[6, 1] == 0.5
    theta = 0.4
    u = radial[3] * np.cos(3 * theta) + radial[6] * np.sin(3 * theta)
    slope = 3.0 * (-tangential[3] * np.sin(3 * theta) + tangential[6] * np.cos(3 * theta))
    assert u + slope == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("n", [0, 1001, 10**25])
def test_a_rim_has_from_one_to_a_thousand_diameters(n):
    with pytest.raises(ct.InputError, match=r"^n: found .*, expected 1 to 1000 nodal diameters of a rim$"):
        pair_rim(ct.gaps.ModalPair(n=n, freq_hz=100.0, modal_mass=4.0), radius=0.3)


def test_diameters_may_be_a_whole_float():
    assert pair_rim(ct.gaps.ModalPair(n=3.0, freq_hz=100.0, modal_mass=4.0), radius=0.3).n_max == 3
