"""Closed contact: B6 and its neighbours by eigenvalues, by formula and by time; friction; split casings by Floquet."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.linalg import expm

import contact as ct
from casingfem.cli import main
from tests.contact.stability.rates import floquet_growth, growth
from tests.contact.synthetic_rim import blade, ring
from tests.probed import finite, numbers_of_notes, numbers_of_result

SCENE = Path(__file__).parents[3] / "data" / "scenes" / "pair.toml"
B6 = ct.gaps.HandPair(
    casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4,
)  # fmt: skip


def damped(pair, casing=1e-3, zeta=1e-3):
    return replace(pair, casing=replace(pair.casing, zeta=casing), blade=replace(pair.blade, zeta=zeta))


def stationary(pair, speed_hz):
    """The 6-state matrix of the stationary frame, x, y of the rim and the blade, written out anew by hand."""
    c, b, k, spin = pair.casing, pair.blade, 1.0 / pair.compliance, pair.casing.n * 2.0 * np.pi * speed_hz
    d, e, drag = 2.0 * c.zeta * c.omega, k / c.modal_mass, pair.friction / c.n
    push = pair.kappa * k
    A = np.zeros((6, 6))
    A[:3, 3:] = np.eye(3)
    A[3] = [spin**2 - c.omega**2 - e, -d * spin, e, -d, -2.0 * spin, 0.0]
    A[4] = [d * spin + drag * e, spin**2 - c.omega**2, -drag * e, 2.0 * spin, -d, 0.0]
    A[5] = [push, 0.0, -(b.omega**2) - push, 0.0, 0.0, -2.0 * b.zeta * b.omega]
    return A


def moved(A, start, times):
    """States (size, times) of x' = A x at even times, step by step."""
    step, states = expm(A * (times[1] - times[0])), [np.asarray(start)]
    for _ in times[1:]:
        states.append(step @ states[-1])
    return np.array(states).T


def marched(pair, speed_hz, rate):
    """Growth [1/s] seen in time over the last 4 of 12 times 1/rate."""
    A = stationary(pair, speed_hz)
    times = np.linspace(0.0, 12.0 / rate, 6000)
    start = [1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]
    level = np.abs(moved(A, start, times)[2]).reshape(60, -1).max(axis=1)
    return np.polyfit(times.reshape(60, -1).mean(axis=1)[40:], np.log(level[40:]), 1)[0]


def test_b6_from_its_scene_file(held):
    result = CliRunner().invoke(main, ["stability", str(SCENE), "--json"])
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    held(1e-5, document=finite(document), words=numbers_of_notes(document["words"]))
    assert document.keys() >= {"speed_hz", "growth", "peak", "bands_hz", "words"}
    assert len(document["speed_hz"]) == len(document["growth"]) == 401
    assert document["peak"]["growth"] == pytest.approx(3.7883, abs=5e-5)
    assert document["peak"]["speed_hz"] == pytest.approx(52.844, abs=5e-4)
    assert np.round(document["bands_hz"], 3) == pytest.approx(np.array([[52.693, 52.994]]), abs=1e-9)
    assert "n = 8 grows by 3.788 1/s at 52.844 Hz (3,170.6 rpm) and travels with the direction" in document["words"]
    assert "f_c + f_b = n f. The blade overtakes the wave, n f = 422.7 Hz > f_c." in document["words"]


def test_b6_is_stable_at_the_difference_and_at_the_unloaded_sum():
    assert np.all(growth(B6.contact(), np.array([22.5, 22.192, 52.5])) < 1e-5)


def test_bands_narrower_than_the_grid_are_found(held):
    """The sum condition, and above 300/8 turns/s the wave that the blade pushes before itself."""
    found = ct.stability.of_contact(B6.contact(), np.linspace(0.0, 100.0, 11))
    held(1e-5, **numbers_of_result(found), words=numbers_of_notes(found.words))
    assert found.peak_growth == pytest.approx(3.7883, abs=1e-4)
    assert np.allclose(found.bands_hz, [[37.5, 37.5337], [52.693, 52.9945]], atol=2e-4)


@pytest.mark.parametrize("ends", [(52.8, 52.85), (52.8, 53.5), (52.0, 52.85)])
def test_bands_end_where_the_range_does(ends):
    """Between 52.693 and 52.994 Hz the pair grows, at all speeds of the first range and at one end of the others."""
    found = ct.stability.of_contact(B6.contact(), np.linspace(*ends, 21))
    ((low, high),) = found.bands_hz
    assert low == ends[0] if ends[0] > 52.693 else ends[0] < low < ends[1]
    assert high == ends[1] if ends[1] < 52.994 else ends[0] < high < ends[1]


@pytest.mark.slow
def test_digging_blade_grows_in_time_as_its_pole(held):
    pair = damped(replace(B6, friction=0.3, lean_deg=10.0))
    found = ct.stability.of_contact(pair.contact(), np.linspace(22.0, 23.5, 61))
    assert found.peak_growth > 1.5
    held(1e-5, **numbers_of_result(found), words=numbers_of_notes(found.words))
    assert marched(pair, found.peak_speed_hz, found.peak_growth) == pytest.approx(found.peak_growth, rel=0.02)
    assert "f_b = f_c - n f, n f = 182 Hz. Without friction nothing grows in this range." in found.words


def of(words, pattern):
    """The numbers that a pattern with # for each finds in words."""
    found = re.search(re.escape(pattern).replace(r"\#", r"([-\d.,]+)"), words)
    assert found, words
    return [float(number.replace(",", "")) for number in found.groups()]


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_words_name_the_motion_at_each_peak_the_highest_first(sense, held):
    """A digging blade at the difference, a trailing one at the sum: n f is that of the two frequencies."""
    digs = replace(B6, friction=0.3, lean_deg=10.0 * sense)
    words = ct.stability.of_contact(digs.contact(), sense * 41.0 + np.linspace(-21.0, 21.0, 81)).words
    first, second = words.index("f_b = f_c - n f"), words.index("f_c + f_b = n f")
    assert first < second
    frames = "f_c = # Hz in the casing's frame and f_b = # Hz in the blade's: "
    held(1e-4, words=numbers_of_notes(words))
    casing, blade, turned = of(words, f"{frames}f_b = f_c - n f, n f = # Hz.")
    assert blade == pytest.approx(casing - turned, abs=0.2)
    casing, blade, turned = of(words, f"{frames}f_c + f_b = n f. The blade overtakes the wave, n f = # Hz > f_c.")
    assert casing + blade == pytest.approx(turned, abs=0.2)
    growth_, speed, rpm = of(words, "Without friction the highest growth is # 1/s at # Hz (# rpm).")
    assert (growth_, speed, rpm) == pytest.approx((3.788, sense * 52.844, sense * 3170.6), rel=1e-4)


def test_a_pattern_that_stays_before_the_blade_travels_with_it_around_the_casing():
    """Above the critical speed f_c = n f a real pole grows: a pattern fixed to the blade, seen from the casing n f."""
    soft = ct.RotatingRim(ring(), blade(), clearance=-1e-4, speed_hz=20.0, lean_deg=10.0)
    words = ct.stability.of_rim(soft, np.linspace(35.0, 45.0, 11)).words
    assert "at 40.348 Hz (2,420.9 rpm) and travels with the direction of the blade." in words
    assert "It is at rest in the blade's frame, f_c = n f = 80.7 Hz." in words
    assert "stands" not in words


def test_words_of_a_stable_range_name_no_motion_and_no_speed_outside():
    """Below 300/8 turns/s the blade overtakes nothing; from 37.54 to the band at 52.7 it does, and nothing grows."""
    slow = ct.stability.of_contact(B6.contact(), np.linspace(8.0, 12.0, 41))
    assert slow.words == (
        "Closed contact is stable from 8 to 12 Hz (480 to 720 rpm): nothing grows. The blade overtakes no wave of the "
        "casing in this range: n f = 96 Hz < f_c = 300 Hz. f_c + f_b = n f cannot be met."
    )
    assert repr(slow).splitlines()[1] == "no growth from 8 to 12 Hz"
    fast = ct.stability.of_contact(B6.contact(), np.linspace(38.0, 50.0, 41))
    assert fast.words == "Closed contact is stable from 38 to 50 Hz (2,280 to 3,000 rpm): nothing grows."


def test_friction_along_the_casing_feeds_a_wave_that_damping_stops():
    """r = (1 - i mu/n)/(2 m): |Im r|/(2 w S) = .0332 1/s with mu = .3, that of the poles far from any coincidence."""
    pair, speeds = replace(B6, friction=0.3, lean_deg=10.0), np.linspace(29.0, 31.0, 5)
    found = ct.stability.of_contact(pair.contact(), speeds)
    rate = 0.3 / 8.0 / (2.0 * 1.5) / (2.0 * B6.casing.omega * 1e-4)
    assert found.peak_growth == pytest.approx(rate, rel=0.15)
    assert "travels against the direction of the blade. The casing has 100 % of the energy." in found.words
    assert "f_b = f_c + n f, n f = 248 Hz. Without friction nothing grows in this range." in found.words
    assert not ct.stability.of_contact(
        damped(pair, casing=1.2 * found.peak_growth / B6.casing.omega).contact(), speeds
    ).diverges
    assert repr(found).splitlines()[1] == "diverges from 29 to 31 Hz"


def test_what_a_map_prints():
    first, second, *words = repr(ct.stability.of_contact(B6.contact(), np.linspace(52.0, 54.0, 21))).splitlines()
    assert first == "largest growth 3.7883 1/s at 52.844 Hz"
    assert second == "diverges from 52.693 to 52.9945 Hz"
    assert words[0].startswith(
        "Closed contact is unstable from 52.693 to 52.994 Hz (3,161.6 to 3,179.7 rpm). n = 8 grows"
    )


def test_poles_come_in_conjugates_and_sum_to_the_damping():
    found = ct.stability.poles(damped(B6).contact(), np.array([10.0, 52.844]))
    assert found.shape == (2, 6)
    lost = 1e-3 * (2 * B6.casing.omega + B6.blade.omega)
    assert np.allclose(found.sum(axis=1), -2.0 * lost, atol=1e-8)


def rim(speed_hz=20.0, **of_ring):
    return ct.RotatingRim(ring(**of_ring), blade(), clearance=-1e-4, speed_hz=speed_hz, lean_deg=10.0)


@pytest.mark.slow
@pytest.mark.parametrize("hz", [5.0, -20.0])
def test_growth_of_pairs_split_by_a_millionth_is_that_of_the_poles_of_the_perfect_rim(hz):
    """A split casing goes through Floquet's theory, a perfect one through eigenvalues."""
    casing = ring()
    split = replace(rim(), casing=replace(casing, omega=casing.omega * np.tile([1.0, 1.0 + 1e-6], 5)))
    exact = growth(ct.gaps.rim_contact(rim(), mu=0.3), hz)[0]
    assert floquet_growth(split, hz, mu=0.3) == pytest.approx(exact, rel=1e-4)


def test_a_rim_that_turns_is_the_same_wherever_it_starts():
    turned = replace(rim(), angle_deg=37.0)
    speeds = np.array([12.0])
    assert growth(ct.gaps.rim_contact(turned, mu=0.2), speeds) == pytest.approx(
        growth(ct.gaps.rim_contact(rim(), mu=0.2), speeds)
    )


def test_the_map_of_a_split_casing_is_that_of_the_poles_of_the_table():
    split, speeds = rim(imperfect=1e-2), np.array([18.0, 20.0, 22.0])
    with pytest.raises(ct.InputError, match="expected a perfect casing"):
        ct.gaps.rim_contact(split)
    found, table = ct.stability.of_rim(split, speeds, mu=0.3), ct.stability.peaks(split, speeds, mu=0.3)
    assert table.averaged
    assert np.array_equal(found.growth, table.map.growth)
    assert found.bands_hz == table.map.bands_hz
    assert found.diverges
    assert "the poles use the mean of each pair. `casingfem interactions` runs the scene" in found.words


@pytest.mark.slow
def test_a_split_casing_at_rest_has_no_turn():
    with pytest.raises(ct.InputError, match="found 0 Hz with a split casing"):
        ct.stability.floquet_growth(rim(imperfect=1e-2), np.array([0.0]), mu=0.3)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("stiffness = 1e4", "", "contact: neither stiffness nor compliance given"),
        ("stiffness = 1e4", "stiffness = 1e4\ncompliance = 1e-4", "stiffness and compliance both given"),
        ("n = 8", "n = 0", "casing.n: found 0"),
        ("stiffness = 1e4", "stiffness = 1e-309", "contact.stiffness: found 1e-309, expected at least 1e-25"),
        ("steps = 401", "steps = 1", "speed.steps: found 1"),
        ("from_hz = 52.0", "from_hz = 55.0", "speed: from_hz = 55.0 and to_hz = 54.0"),
        ("lean_deg = 0.0", "lean_deg = 95.0", "contact.lean_deg: found 95.0"),
        ("freq_hz = 120.0", "freq = 120.0", "blade.freq: unknown key"),
    ],
)
def test_a_broken_pair_is_refused_with_file_and_key(tmp_path, old, new, words):
    file = tmp_path / "pair.toml"
    file.write_text(SCENE.read_text(encoding="utf-8").replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ct.scene.SceneError) as refused:
        ct.scene.load_stability(file)
    assert any(str(file) in line and words in line for line in refused.value.problems)


RIM_SCENE = """
[scene]
kind = "rim"
t_end = 0.1
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 10.0
[contact]
clearance = 1e-4
friction = 0.3
[speed]
hz = 20.0
scan = {from_hz = 10.0, to_hz = 30.0, steps = 21}
[scheme]
kind = "exact-modal"
dt = 1e-5
"""


def test_a_rim_scene_is_scanned_with_its_friction_and_runs_too(tmp_path):
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    file = tmp_path / "rim.toml"
    file.write_text(RIM_SCENE, encoding="utf-8")
    found = ct.scene.load_stability(file).solve()
    exact = growth(ct.gaps.rim_contact(rim(), mu=0.3), np.linspace(10.0, 30.0, 21))
    assert found.growth == pytest.approx(exact)
    assert ct.load_scene(file).what.speed_hz == 20.0
    file.write_text(RIM_SCENE.replace("scan = ", "# "), encoding="utf-8")
    with pytest.raises(ct.scene.SceneError, match=r"speed\.scan: missing"):
        ct.scene.load_stability(file)


def test_a_pair_does_not_run_and_rods_have_no_poles():
    with pytest.raises(
        ct.scene.SceneError, match="found 'pair', expected a scene with a time simulation: use casingfem"
    ):
        ct.load_scene(SCENE)
    with pytest.raises(ct.scene.SceneError, match="found 'rods', expected 'pair', 'rim' or 'rotor'"):
        ct.scene.load_stability(SCENE.with_name("two_rods.toml"))
    with pytest.raises(ct.scene.SceneError, match=r"found 'disk', .* 'rim' or 'rotor': use casingfem interactions"):
        ct.scene.load_stability(SCENE.with_name("bladed_disk.toml"))


@pytest.mark.parametrize("speeds", [[[50.0, 51.0]], [50.0, math.nan], math.inf, -math.inf])
def test_speeds_of_poles_are_finite_and_in_one_row(speeds):
    with pytest.raises(ct.InputError, match="speed_hz: found speeds that are not finite, or not in one row, expected"):
        ct.stability.poles(B6.contact(), speeds)
    assert np.array_equal(ct.stability.poles(B6.contact(), 50.0), ct.stability.poles(B6.contact(), [50.0]))


@pytest.mark.parametrize("speeds", [50.0, [50.0], [51.0, 50.0], [50.0, 51.0, 51.0], [50.0, math.nan], [[50.0, 51.0]]])
def test_a_map_of_growth_takes_two_or_more_ascending_speeds(speeds):
    assert ct.stability.of_contact(B6.contact(), [50.0, 51.0]).growth.shape == (2,)
    with pytest.raises(
        ct.InputError, match="speed_hz: found numbers that do not ascend, expected at least two ascending speeds"
    ):
        ct.stability.of_contact(B6.contact(), speeds)
