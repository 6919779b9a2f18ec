"""Disks of blades: cyclic symmetry, the two-dimensional model, and runs against poles."""

from pathlib import Path

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import ring

SCENE = Path(__file__).parents[3] / "data" / "scenes" / "bladed_disk.toml"


def disk(blades=12, **changes):
    return ct.gaps.BladedDisk(**{"blades": blades, "freq_hz": 100.0, "modal_mass": 0.4, "coupling": 0.05, **changes})


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


def test_a_pair_as_a_rim_moves_inextensionally():
    rim = ct.gaps.pair_rim(ct.gaps.ModalPair(n=3, freq_hz=100.0, modal_mass=4.0), radius=0.3)
    radial, tangential = rim.rows[:7], rim.rows[7:]
    assert radial[3, 0] == radial[6, 1] == 0.5
    theta = 0.4
    u = radial[3] * np.cos(3 * theta) + radial[6] * np.sin(3 * theta)
    slope = 3.0 * (-tangential[3] * np.sin(3 * theta) + tangential[6] * np.cos(3 * theta))
    assert u + slope == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("n", [0, 1001, 10**25])
def test_a_rim_has_from_one_to_a_thousand_diameters(n):
    with pytest.raises(ct.InputError, match=r"^n: found .*, expected 1 to 1000 nodal diameters of a rim$"):
        ct.gaps.pair_rim(ct.gaps.ModalPair(n=n, freq_hz=100.0, modal_mass=4.0), radius=0.3)


def test_diameters_may_be_a_whole_float():
    assert ct.gaps.pair_rim(ct.gaps.ModalPair(n=3.0, freq_hz=100.0, modal_mass=4.0), radius=0.3).n_max == 3
