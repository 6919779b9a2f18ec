"""The picture gate: no data cut off, no legend over data, no names that overlap, no missing unit; no cut page."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

import casingfem as cf
from casingfem.plot.chance import figure_importance, figure_probability, figure_splits_of
from casingfem.plot.cycles import figure_cycles, figure_multipliers, figure_orbits
from casingfem.plot.experiment import figure_responses
from casingfem.plot.history import Panel, figure_history
from casingfem.plot.interaction import figure_map, figure_speeds
from casingfem.plot.motion import figure_energy, figure_orbit, figure_spectrum
from casingfem.plot.pages.cycles import cycles_page
from casingfem.plot.pages.interactions import interactions_page
from casingfem.plot.pages.scene import motion_pictures, scene_page
from casingfem.plot.pages.sweep import sweep_page
from casingfem.plot.rotor import figure_rotor_run
from casingfem.plot.style import Drawn
from casingfem.plot.sweep import figure_sweep
from casingfem.plot.waves import Mark, figure_force_map, figure_section, figure_waves
from contact.sweep.columns import MEASURED
from tests.casingfem.plot.browser import found_browser
from tests.casingfem.plot.page_gate import faults_of, page_faults
from tests.casingfem.plot.page_samples import (
    cycles_sample,
    ran_sample,
    rim_sample,
    rotor_sample,
    run_rows,
    speeds_sample,
    trace_samples,
)

TIME = np.linspace(0.0, 1.0, 8001)
WAVE = np.sin(2.0 * np.pi * 300.0 * TIME) * np.exp(-TIME)
FORCE = SimpleNamespace(time=np.array([0.0, 0.2, 0.4]), angle_deg=np.array([0.0, 180.0, 360.0]), force=np.eye(2))
CROWD = [Mark(300.0 + 3.0 * k, str(k), "f_c") for k in range(30)] + [Mark(310.0, "f_b", "f_b")]
TIP = SimpleNamespace(time=TIME, tip=1e-5 * np.stack([WAVE, np.cos(900.0 * TIME)], axis=1),
                      rim=1e-8 * np.stack([1e3 * WAVE, WAVE**2], axis=1))  # fmt: skip
CAMPBELL = SimpleNamespace(speed_hz=np.linspace(0.0, 50.0, 6), crossings=lambda order: [],
                           freq=np.array([[90.0 + k, 91.0 + k, 180.0 - k] for k in range(6)]))  # fmt: skip
SOBOL = ("total", "total_low", "total_high", "first", "first_low", "first_high")
PLACES = np.array([[x, y] for x in (1.0, 2.0) for y in (1.0, 2.0, 3.0, 4.0)])


def swept(status: str, motion: str) -> Figure:
    """A sweep over the speed."""
    rows = run_rows(status, motion)
    return figure_sweep(["speed.hz [turns/s]"], np.array([[row["speed.hz"]] for row in rows]), rows)


FIGURES = {
    "run": lambda: figure_history(
        [Panel(label="gap [mm]", time=TIME, curves=[("tip", WAVE, "k"), ("rim", -WAVE, "b")], level=(1.0, "top"))] * 3,
        (0.1, 0.15),
    ),
    "run of rods": lambda: figure_history(
        [Panel(label="displacement [mm]", time=2e-4 * TIME,
               curves=[(f"rod {k}, {side} end", 1e-5 * WAVE, "k") for k in (1, 2) for side in ("left", "right")])] * 3,
        (2e-5, 3e-5),
    ),
    "spectrum": lambda: figure_spectrum(TIME, WAVE, label="force", unit="N", marks=CROWD, turn_hz=5.0),
    "waves": lambda: figure_waves(rim_sample(), [(3, 50.0), (4, 300.0)]),
    "angle": lambda: figure_force_map(FORCE),
    "orbit": lambda: figure_orbit(TIP),
    "section": lambda: figure_section(SimpleNamespace(time=TIME[:9], displacement=WAVE[:9], velocity=WAVE[1:10])),
    "map": lambda: figure_map([(2, 900.0), (3, 300.0), (4, 310.0)], [150.0], 150.0),
    "energy": lambda: figure_energy({"contact": 2e-5, "friction": -1e-5}, TIME, {"casing": WAVE**2}),
    "speeds": lambda: figure_speeds(CAMPBELL),
    **{f"sweep, {status}, {motion}": partial(swept, status, motion)
       for status, motion in (("diverged", "grows"), ("refused", ""))},
    "sweep of two keys": lambda: figure_sweep(["a [m]", "b [s]"], PLACES, [*run_rows(), *run_rows("diverged")]),
    "cycles": lambda: figure_cycles(cycles_sample().records(), cycles_sample().marks()),
    "multipliers": lambda: figure_multipliers(cycles_sample()),
    "spectrum of rods": lambda: figure_spectrum(2e-4 * TIME, 1e5 * WAVE, label="force", unit="N"),
    "run of a large force": lambda: figure_history(
        [Panel(label="force, averaged [N]", time=TIME, curves=[("", 1e5 * WAVE, "k")])] * 2, (0.1, 0.15)
    ),
    "rotor": lambda: figure_rotor_run(rotor_sample()),
    "rotor in a casing": lambda: figure_rotor_run(rotor_sample(cased=True), 1e-3),
    "responses": lambda: figure_responses(
        cf.frf.FrfSet.from_arrays(kind="frf", x=2e4 * TIME, responses=1.0 / (1e4 - 2e4 * TIME[None] + 30j), unit="m/N")
    ),
    "chance": lambda: figure_probability(
        [{"speed_hz": float(k), "probability": 0.01, "low": 0.0, "high": 0.02} for k in range(9)]
    ),
    "splits by chance": lambda: figure_splits_of(np.abs(WAVE[1:4001].reshape(4, -1)), ["n = 8, m = 1"] * 4),
    "importance": lambda: figure_importance(
        [{"result": result, "group": group} | dict.fromkeys(SOBOL, 0.5)
         for result in ("growth", "gap") for group in ("casing", "blade")]
    ),
    "orbits": lambda: figure_orbits(trace_samples()),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", FIGURES)
def test_a_picture_passes_the_gate(name):
    assert faults_of(FIGURES[name]()) == []


def test_the_gate_finds_each_fault_of_a_figure():
    figure = Figure(figsize=(4.0, 3.0))
    axes = figure.add_subplot()
    axes.plot([0.0, 1.0], [0.0, 2.0], label="a line")
    axes.set(xlabel="time", ylabel="gap [mm]", ylim=(0.0, 1.0))
    axes.legend(loc="upper left")
    axes.text(0.5, 0.5, "one name")
    axes.text(0.51, 0.5, "another")
    axes.annotate("far out", (0.5, 1.6), xycoords="axes fraction", annotation_clip=False)
    assert faults_of(figure) == [
        "data cut off in 'gap [mm]'", "no unit: 'time'",
        "legend over data", "'one name' over 'another'",
        "a label is cut off",
    ]  # fmt: skip
    large = Figure()
    large.add_subplot().set(ylim=(0.0, 2e4), xlabel="mode", ylabel="force [N]")
    assert faults_of(large) == ["ten thousand N and more: 'force [N]'"]


PAGES = {
    "rub": lambda figures: scene_page(
        "rub", "[scene]", ran_sample(), motion_pictures(figures, rubs=True), speeds=figures, source=SOURCE,
        found=speeds_sample(),
    ).html(),
    "rods": lambda figures: scene_page(
        "rods", "[scene]", ran_sample(rubs=False, growth=None, rim=None, speed_hz=0.0), (), source=SOURCE
    ).html(),
    "rotor": lambda figures: scene_page(
        "rotor", "[scene]", ran_sample(rubs=False, growth=None, rim=None, contacts=(), closings=0, least_gap=np.nan,
                                       rotor=rotor_sample()), (), source=SOURCE,
    ).html(),
    "sweep": lambda figures: sweep_page(
        "rub", ["speed.hz [turns/s]"], ["speed.hz"], run_rows("diverged", "grows"), SOURCE,
        Drawn(swept("diverged", "grows")), MEASURED,
    ),
    "cycles": lambda figures: cycles_page("rod", cycles_sample(), SOURCE, trace_samples()),
    "interactions": lambda figures: interactions_page("rub", speeds_sample(), {}, SOURCE),
}  # fmt: skip
SOURCE = {"scene": "a_name_without_a_place_to_break_it_" * 3 + ".toml", "sha256": "0123" * 16, "numpy": "2.0"}
BROKEN = {
    "the page is wider than the window": '<div style="width: 1500px">x</div>',
    "cut at the right: table": f"<table><tr>{'<td>cell</td>' * 200}</tr></table>",
    "ends of a strip of speeds on two lines": "<div class='speeds'><div class='ends'><p>1</p><p>2</p></div></div>",
    "a word over two lines: 312.3011": '<table><tr><td class="number" style="width: 2em; overflow-wrap: anywhere">'
    "312.3011</td></tr></table>",
    "cut at the right: img": '<img width="900" style="max-width: none" alt="">',
    "no unit: impulse": '<table><tr><th class="number">impulse</th></tr></table>',
    "no unit: sigma": '<table><tr><th class="number">sigma</th><th>unit</th></tr><tr><td>1</td><td>–</td></tr></table>',
    "raw repr": "<p>Modes(freq=array([1, 2]))</p>",
    "text of a warning": "<p>RuntimeWarning: overflow</p>",
}


@pytest.mark.slow
@pytest.mark.skipif(found_browser() is None, reason="no browser: apt-get install chromium, or CASINGFEM_BROWSER")
@pytest.mark.parametrize("kind", PAGES)
def test_a_page_passes_the_gate_on_a_desk_on_a_phone_and_on_paper(kind, tab, tmp_path):
    figures = {name: FIGURES[name]() for name in ("run", "section") if kind == "rub"}
    (tmp_path / "page.html").write_text(PAGES[kind](figures), encoding="utf-8")
    assert page_faults(tab, tmp_path / "page.html") == []
    assert tab.run("document.querySelectorAll('.verdict dd').length") >= {"rods": 4, "rotor": 3}.get(kind, 6)
    assert tab.run("document.querySelectorAll('pre').length") == (kind in ("rub", "rods", "rotor"))


@pytest.mark.slow
@pytest.mark.skipif(found_browser() is None, reason="no browser: apt-get install chromium, or CASINGFEM_BROWSER")
@pytest.mark.parametrize("fault", BROKEN)
def test_the_gate_finds_each_fault_of_a_page(fault, tab, tmp_path):
    (tmp_path / "page.html").write_text(f"<body><main>{BROKEN[fault]}</main></body>", encoding="utf-8")
    assert any(fault in found for found in page_faults(tab, tmp_path / "page.html"))
