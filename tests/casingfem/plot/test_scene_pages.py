"""The page of a scene: its verdict by what the run did, figures by the arrays of a run whose answer is known."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import contact as ct
from casingfem.cli.pictures import marks_of
from casingfem.plot.history import Panel, figure_history
from casingfem.plot.interaction import figure_map
from casingfem.plot.motion import figure_spectrum
from casingfem.plot.pages.scene import scene_page, scene_verdict
from casingfem.plot.pages.speeds import safe_ranges, speed_strip, speed_words, strip_parts
from casingfem.plot.pages.sweep import sweep_verdict
from casingfem.plot.waves import Mark, figure_force_map, figure_section, figure_waves, full_spectrum
from contact.io.trust import Flag
from contact.model.gaps.bladed_disk import pair_rim
from contact.recovery.around_rim import force_over_angle, once_a_turn, rim_motion
from tests.casingfem.plot.page_samples import growth_sample, ran_sample, rim_sample, speeds_sample

N, HZ, SPEED = 4, 100.0, 5.0
FAILED = Flag("the motion is not finite", "motion-overflow", failed=True)


@pytest.fixture(scope="module")
def free():
    """A free rim pair started in one travelling wave, n = 4 at 100 Hz without damping, and a blade far away."""
    pair = ct.gaps.ModalPair(n=N, freq_hz=HZ, modal_mass=1.5, zeta=0.0)
    blade = ct.ModalBody(omega=[900.0], zeta=[0.01], channels=("span", "flap"), rows=[[0.0], [1.0]], S=np.eye(2))
    omega = 2.0 * np.pi * HZ
    rim = ct.RotatingRim(
        pair_rim(pair, radius=0.5), blade, clearance=1e-2, speed_hz=SPEED,
        casing_displacement=[1e-5, 0.0], casing_velocity=[0.0, 1e-5 * omega],
    )  # fmt: skip
    return rim, ct.run(rim, t_end=2.0, dt=5e-4, record=ct.Record(state_every=1))


@pytest.mark.slow
def test_a_travelling_wave_is_in_the_full_spectrum_at_its_diameters_and_sign_alone(free):
    """q = (cos wt, sin wt) runs towards +theta; with a positive speed the blades run towards -theta on the casing."""
    motion = rim_motion(*free)
    freq, amplitude = full_spectrum(motion)
    size = np.hypot(*free[0].casing.rows[[N, 2 * N], [0, 1]]) / np.sqrt(2.0) * 1e-5
    n, line = np.unravel_index(amplitude.argmax(), amplitude.shape)
    assert (n, round(freq[line])) == (N, -HZ)
    assert amplitude.max() == pytest.approx(size, rel=0.02)
    assert amplitude[:, freq > 10.0].max() < 1e-3 * size
    np.testing.assert_allclose(motion.deflection, size, rtol=0.03)
    figure = figure_waves(motion, [(N, HZ)])
    bars = {patch.get_y() + 0.5 * patch.get_height(): patch.get_width() for patch in figure.axes[1].patches}
    assert max(bars, key=bars.get) == pytest.approx(N - 0.2)  # against the blades
    places = figure.axes[0].lines[0].get_xdata(), figure.axes[0].lines[1].get_xdata()
    assert (list(places[0]), list(places[1])) == ([HZ], [-HZ])


@pytest.fixture(scope="module")
def oval():
    """A blade that presses at 90 and 270 degrees of an oval rim."""
    pair = ct.gaps.ModalPair(n=2, freq_hz=HZ, modal_mass=1.5, zeta=0.05)
    blade = ct.ModalBody(omega=[600.0], zeta=[0.05], channels=("span", "flap"), rows=[[0.0], [1.0]], S=1e-7 * np.eye(2))
    rim = ct.RotatingRim(
        pair_rim(pair, radius=0.5), blade, clearance=1e-5, speed_hz=SPEED, lean_deg=10.0,
        out_of_roundness=[{"p": 2, "cos": 2e-5}],
    )  # fmt: skip
    return rim, ct.run(rim, t_end=4.1, dt=2e-4, record=ct.Record(state_every=1))


@pytest.mark.slow
def test_forces_are_drawn_where_the_rim_comes_near(oval):
    found = force_over_angle(*oval)
    assert found.force.shape == (20, 180)  # a row each turn
    np.testing.assert_allclose(np.diff(found.time)[:-1], 1.0 / SPEED, atol=1e-3)
    largest = np.nanmax(found.force, axis=0)
    middle = 0.5 * (found.angle_deg[1:] + found.angle_deg[:-1])
    pressed = middle[largest > 0.0]
    assert np.abs(np.mod(pressed, 180.0) - 90.0).max() < 45.0
    assert np.nanmax(found.force) == oval[1].windowed_force().max()
    (mesh,) = figure_force_map(found).axes[0].collections
    assert np.array_equal(mesh.get_array().filled(np.nan), found.force, equal_nan=True)


@pytest.mark.slow
def test_a_motion_with_the_period_of_a_turn_is_one_point_of_its_section(oval):
    found = once_a_turn(*oval)
    assert len(found.time) == 10  # turns 11 to 20
    assert np.allclose(np.diff(found.time), 1.0 / SPEED)
    reach = np.ptp(oval[1].state_of("blade"))
    assert np.ptp(found.displacement) < 1e-3 * reach
    (dots,) = figure_section(found).axes[0].collections
    np.testing.assert_allclose(dots.get_offsets(), np.stack([1e6 * found.displacement, 1e3 * found.velocity], axis=1))


def test_a_band_spans_the_lowest_and_highest_value_and_the_closeup_shows_each():
    time = np.linspace(0.0, 1.0, 50_001)
    values = np.sin(2.0 * np.pi * 700.0 * time)
    figure = figure_history([Panel(label="gap [mm]", time=time, curves=[("", values, "k")])], (0.5, 0.51))
    whole, closeup = figure.axes
    low, high = (np.asarray(line.get_ydata()) for line in whole.lines)
    assert low.size == high.size == 600
    assert (low.min(), high.max()) == (values.min(), values.max())
    inside = (time >= 0.5) & (time <= 0.51)
    assert np.array_equal(closeup.lines[0].get_ydata(), values[inside])


def test_marks_of_a_spectrum_are_at_their_frequencies_and_names_keep_apart():
    time = 1e-3 * np.arange(4000)
    marks = [Mark(40.0, "8", "f_c"), Mark(40.4, "7", "f_c"), Mark(60.0, "f_b", "f_b"), Mark(499.0, "2", "f_c")]
    values = np.sin(2.0 * np.pi * 50.0 * time)
    figure = figure_spectrum(time, values, label="force", unit="N", marks=marks, turn_hz=5.0)
    axes = figure.axes[0]
    upright = sorted(float(line[0, 0]) for one in axes.collections for line in one.get_segments())
    assert upright == [40.0, 40.4, 60.0]  # 499 Hz lies beyond what is heard
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in axes.texts]
    assert [text.get_text() for text in axes.texts] == ["8", "7", "f_b"]
    assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])
    labels = [label.get_text() for label in axes.get_xticklabels()]
    assert all(float(f) == pytest.approx(5.0 * float(n), rel=1e-3) for f, n in (label.split("\n") for label in labels))


def test_a_spectrum_of_a_rub_has_marks_at_each_frequency_of_the_blade_and_each_pair_of_the_casing():
    casing = pair_rim(ct.gaps.ModalPair(n=N, freq_hz=HZ, modal_mass=1.5, zeta=0.05), radius=0.5)
    channels, zeta = ("span", "flap"), [0.01, 0.01]
    blade = ct.ModalBody(omega=[600.0, 900.0], zeta=zeta, channels=channels, rows=np.eye(2), S=np.zeros((2, 2)))
    marks = marks_of(ct.RotatingRim(casing, blade, clearance=1e-3, speed_hz=SPEED))
    assert [(mark.name, mark.kind) for mark in marks] == [("f_b", "f_b"), ("f_b2", "f_b"), (f"{N}", "f_c")]
    np.testing.assert_allclose([mark.freq_hz for mark in marks], [*np.array([600.0, 900.0]) / (2.0 * np.pi), HZ])


def test_an_interaction_map_shows_which_blades_the_casing_meets():
    pairs = [(2, 900.0), (3, 300.0)]
    figure = figure_map(pairs, [150.0, 5000.0], 150.0)
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    flutter, resonance = lines["n f - f_c: flutter if f_b"], lines["f_c - n f: resonance if f_b"]
    assert (flutter.get_xdata().tolist(), flutter.get_ydata().tolist()) == ([3], [150.0])
    assert (resonance.get_xdata().tolist(), resonance.get_ydata().tolist()) == ([2], [600.0])
    assert lines["blade alone, f_b"].get_ydata()[0] == 150.0


STATES = {
    "fails": ({"flags": (FAILED,)}, "bad", "Not usable at 300 rpm (5 Hz)"),
    "diverges": ({"divergence": SimpleNamespace(time=0.25)}, "bad", "Unsafe at 300 rpm (5 Hz): the motion passed"),
    "grows": ({"growth": growth_sample("grows", 8.0)}, "bad", "Unsafe at 300 rpm (5 Hz): the motion grows"),
    "deflects": ({"rim": rim_sample(largest=2e-3)}, "bad", "Outside the linear model at 300 rpm"),
    "too short": ({"growth": growth_sample("undecided")}, "open", "Not decided at 300 rpm"),
    "is bounded": ({}, "good", "Bounded at 300 rpm (5 Hz): the contact is closed 20 % of the time"),
    "never touches": (
        {"closings": 0, "least_gap": 2e-4},
        "good",
        "Nothing touches at 300 rpm (5 Hz): the least gap",
    ),
}


@pytest.mark.parametrize("name", STATES)
def test_the_first_sentence_states_whether_the_speed_is_safe(name):
    given, state, words = STATES[name]
    verdict = scene_verdict(ran_sample(**given))
    assert (verdict.state, verdict.found[: len(words)]) == (state, words)


CONSTANT = {  # motion of the run, what the run at its constant speed says
    "bounded later": ("undecided", {"verdict": "safe"}, "good",
                      "Safe at 300 rpm (5 Hz): the motion does not grow in a run of 1.6 s at this constant speed"),
    "grows later": ("undecided", {"verdict": "unstable"}, "bad", "Unsafe at 300 rpm (5 Hz): the motion grows in a run"),
    "grows slowly": ("bounded", {"verdict": "unstable", "slow": True, "why": "the contact stays closed"}, "bad",
                     "Unsafe at 300 rpm (5 Hz): the contact stays closed."),
    "slows down": ("grows", {"verdict": "safe"}, "open",
                   "The motion grows in this run at 300 rpm (5 Hz). It does not grow in a run of 1.6 s"),
    "agrees": ("grows", {"verdict": "unstable"}, "bad", "Unsafe at 300 rpm (5 Hz): the motion grows."),
    "does not decide": ("undecided", {"verdict": "not decided"}, "open", "Not decided at 300 rpm"),
}  # fmt: skip


@pytest.mark.parametrize("name", CONSTANT)
def test_the_first_sentence_agrees_with_the_table_of_speeds(name):
    motion, given, state, words = CONSTANT[name]
    found = speeds_sample()
    found.runs = (*found.runs, replace(found.runs[0], speed_hz=5.0, seconds=1.6, **given))
    verdict = scene_verdict(ran_sample(growth=growth_sample(motion, 8.0)), found)
    assert (verdict.state, verdict.found[: len(words)]) == (state, words)


def test_the_verdict_has_force_deflection_against_its_limit_and_wear():
    worn = SimpleNamespace(worn=np.array([0.0, 2e-5]), volume=3e-9, bare=0)
    facts = dict(scene_verdict(ran_sample(tracks=(worn,))).facts)
    assert "At most 45.5 N, averaged over 0.089 ms" in facts["Force"]
    assert "0.045 mm at most, 1.5 % of its wall. The limit is 1.5 mm (50 %)" in facts["Deflection"]
    assert facts["Wear"] == "At most 20 µm deep, 3 mm³ in all."
    unknown = dict(scene_verdict(ran_sample(rim=rim_sample(wall=np.inf))).facts)
    assert "give the wall thickness in [casing]" in unknown["Deflection"]


def table(**ranges):
    """A table of dangerous speeds from 1 to 10 Hz, ranges by verdict."""
    rows = [
        SimpleNamespace(
            from_hz=low,
            to_hz=high,
            at=SimpleNamespace(verdict=verdict.replace("_", " "), why=f"it ends at {high:g} Hz"),
        )
        for verdict, parts in ranges.items()
        for low, high in parts
    ]
    peaks = SimpleNamespace(map=SimpleNamespace(speed_hz=np.array([1.0, 5.0, 10.0])), rotor=False)
    return SimpleNamespace(rows=rows, runs=(), peaks=peaks, records=list, words="60 runs of the scene.", COLUMNS=())


def test_safe_speeds_are_those_between_the_dangerous_ones():
    found = table(
        unstable=[(8.0, 10.0), (3.0, 4.0)], not_decided=[(1.0, 2.0)], resonance=[(3.5, 5.0)], safe=[(6.0, 6.5)]
    )
    assert safe_ranges(found) == [(2.0, 3.0), (5.0, 8.0)]
    unstable, open_, resonance, safe = speed_words(found)
    assert unstable == "Unstable: 180 to 240 rpm (3 to 4 Hz); 480 to 600 rpm (8 to 10 Hz)."
    assert open_ == "Not decided: 60 to 120 rpm (1 to 2 Hz). It ends at 2 Hz."
    several = table(not_decided=[(1.0, 2.0), (3.0, 6.0)])
    assert speed_words(several)[0].endswith("It ends at 6 Hz.")  # the reason in the widest range
    assert resonance == "Resonance: 210 to 300 rpm (3.5 to 5 Hz)."
    assert safe == "Safe: 120 to 180 rpm (2 to 3 Hz); 300 to 480 rpm (5 to 8 Hz)."
    assert speed_words(table()) == ("Safe: 60 to 600 rpm (1 to 10 Hz).",)
    assert speed_words(table(unstable=[(1.0, 10.0)]))[-1] == "No speed of the range is safe."
    assert speed_words(None, "speed: found 0") == ("There is no table of dangerous speeds: speed: found 0",)


def test_the_strip_has_the_worst_verdict_of_each_speed_without_a_gap():
    found = table(
        unstable=[(2.8, 3.7)], resonance=[(2.8, 5.5), (5.5, 10.0)], not_decided=[(1.0, 1.0)], safe=[(1.5, 2.0)]
    )
    parts = [(round(start, 2), verdict) for start, verdict in strip_parts(found)]
    assert parts == [(0.0, "not decided"), (0.6, "safe"), (20.0, "unstable"), (30.0, "resonance")]
    html = str(speed_strip(found))
    assert html.count("<i ") == len(parts) + 4  # and the key
    assert "left:30.00%" in html
    assert strip_parts(table(resonance=[(10.0, 10.0)])) == [(0.0, "safe"), (99.4, "resonance")]


def test_a_page_has_no_repr_and_every_number_its_unit():
    html = scene_page(
        "rub", "[scene]", ran_sample(), (), found=table(), source={"scene": "a.toml", "sha256": "0" * 64}
    ).html()
    text = re.sub(r"<[^>]+>", " ", html.partition("<main>")[2])
    assert not re.search(r"\w+\(\w+=|\bnan\b|\binf\b|\d[eE][+-]\d", text)
    heads = re.findall(r'<th scope="col" class="number">([^<]+)</th>', html)
    assert [head for head in heads if "[" not in head and head not in ("contact", "closings")] == []


def test_a_sweep_calls_no_run_safe_whose_rim_deflects_by_more_than_half_of_its_wall():
    keys, state = ["speed.hz"], {"status": "done", "peak_force_N": 50.0, "amplitude_m": 1e-5, "unaccounted_rel": 1e-13}
    flags = {1.0: "", 2.0: "wall-deflection; slip-reverses", 3.0: "wall-deflection", 4.0: ""}
    motion = {1.0: "bounded", 2.0: "bounded", 3.0: "undecided", 4.0: "decays"}
    rows = [{"speed.hz": hz, **state, "motion": motion[hz], "flags": flags[hz]} for hz in flags]
    found = sweep_verdict(["speed.hz [Hz]"], keys, rows)
    words = "Unsafe: the rim deflects by more than half of its wall in 2 of 4 runs. 1 of 4 runs is too short"
    assert (found.state, found.found[: len(words)]) == ("bad", words)
    facts = dict(found.facts)
    assert facts["Beyond half the wall"] == "The runs at 120 to 180 rpm (2 to 3 Hz)."
    assert facts["Safe"] == "The runs at 60 rpm (1 Hz); 240 rpm (4 Hz)."
