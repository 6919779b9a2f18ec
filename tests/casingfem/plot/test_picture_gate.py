"""The picture gate: no data cut off, no legend over data, no names that overlap, no missing unit; no cut page."""

import re
from functools import partial
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from casingfem.plot.cycles import figure_cycles, figure_multipliers, figure_orbits
from casingfem.plot.history import Panel, figure_history
from casingfem.plot.interaction import figure_map, figure_speeds
from casingfem.plot.motion import figure_energy, figure_orbit, figure_spectrum
from casingfem.plot.page import Picture, Section, Verdict, render_page
from casingfem.plot.pages.scene import CAPTIONS, scene_page
from casingfem.plot.sweep import figure_sweep
from casingfem.plot.waves import Mark, figure_force_map, figure_section, figure_waves
from tests.casingfem.plot.browser import browser, found_browser
from tests.casingfem.plot.page_samples import cycles_sample, ran_sample, rim_sample, run_rows, trace_samples

COUNTED = ("nodal diameters n", "mode")
A4 = 794  # pixels across, 96 an inch
REPR = re.compile(r"\b[A-Z]\w+\([a-z_]+=|\barray\(|<[\w.]+ object at|\bnan\b|Warning\b|\d[eE][+-]\d")


def faults_of(figure: Figure) -> list[str]:
    """What the gate refuses in a figure."""
    figure.draw_without_rendering()
    found = []
    for axes in figure.axes:
        if axes.get_label() == "<colorbar>":
            found += [] if "[" in axes.get_ylabel() else [f"no unit: {axes.get_ylabel()!r}"]
            continue
        box, shared = axes.bbox, axes.get_shared_x_axes().get_siblings(axes)
        x = next((other.get_xlabel() for other in shared if other.get_xlabel()), "")
        found += [] if "[" in x or x in COUNTED else [f"no unit: {x!r}"]
        low, high = axes.get_ylim()
        for line in axes.lines:
            y = np.asarray(line.get_ydata(), float)
            inside = y[np.isfinite(y)]
            if line.get_transform() == axes.transData and inside.size and axes.get_yscale() == "linear":
                slack = 1e-9 * (high - low)
                cut = inside.max() > high + slack or inside.min() < low - slack
                found += [f"data cut off in {axes.get_ylabel()!r}"] if cut and line.get_linestyle() != ":" else []
        legend = axes.get_legend()
        if legend is not None and legend.get_window_extent().overlaps(box):
            shares = legend.get_window_extent()
            found += ["legend over data"] if shares.y0 < box.y1 - 1.0 and shares.x0 < box.x1 - 1.0 else []
        names = [text for text in axes.texts if text.get_text()]
        ticks = [tick for tick in axes.get_xticklabels() if tick.get_text() and tick.get_visible()]
        for group in (names, ticks):
            boxes = [(text.get_text(), text.get_window_extent()) for text in group]
            found += [f"{a!r} over {b!r}" for (a, one), (b, other) in combinations(boxes, 2) if one.overlaps(other)]
    whole = figure.get_tightbbox()
    size = figure.get_size_inches()
    beyond = min(whole.x0, whole.y0) < -0.02 or np.any(size + 0.02 < [whole.x1, whole.y1])
    return found + (["a label is cut off"] if beyond else [])


TIME = np.linspace(0.0, 1.0, 8001)
WAVE = np.sin(2.0 * np.pi * 300.0 * TIME) * np.exp(-TIME)
FORCE = SimpleNamespace(time=np.array([0.0, 0.2, 0.4]), angle_deg=np.array([0.0, 180.0, 360.0]), force=np.eye(2))
CROWD = [Mark(300.0 + 3.0 * k, str(k), "f_c") for k in range(30)] + [Mark(310.0, "f_b", "f_b")]
TIP = SimpleNamespace(time=TIME, tip=1e-5 * np.stack([WAVE, np.cos(900.0 * TIME)], axis=1),
                      rim=1e-8 * np.stack([1e3 * WAVE, WAVE**2], axis=1))  # fmt: skip
CAMPBELL = SimpleNamespace(speed_hz=np.linspace(0.0, 50.0, 6), crossings=lambda order: [],
                           freq=np.array([[90.0 + k, 91.0 + k, 180.0 - k] for k in range(6)]))  # fmt: skip
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
    "spectrum": lambda: figure_spectrum(TIME, WAVE, label="force", unit="N", marks=CROWD, turn_hz=5.0),
    "waves": lambda: figure_waves(rim_sample(), [(3, 50.0), (4, 300.0)]),
    "angle": lambda: figure_force_map(FORCE),
    "orbit": lambda: figure_orbit(TIP),
    "section": lambda: figure_section(SimpleNamespace(time=TIME[:9], displacement=WAVE[:9], velocity=WAVE[1:10])),
    "map": lambda: figure_map([(2, 900.0), (3, 300.0), (4, 310.0)], [150.0], 150.0),
    "energy": lambda: figure_energy({"contact": 2e-5, "friction": -1e-5}, TIME, {"casing": WAVE**2}),
    "speeds": lambda: figure_speeds(CAMPBELL),
    **{f"sweep, {status}, {motion}": partial(swept, status, motion)
       for status, motion in (("done", "grows"), ("diverged", "grows"), ("refused", ""))},
    "sweep of two keys": lambda: figure_sweep(["a [m]", "b [s]"], PLACES, [*run_rows(), *run_rows("diverged")]),
    "cycles": lambda: figure_cycles(cycles_sample().records(), cycles_sample().marks()),
    "multipliers": lambda: figure_multipliers(cycles_sample()),
    "orbits": lambda: figure_orbits(trace_samples()),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", FIGURES)
def test_a_picture_passes_the_gate(name):
    assert faults_of(FIGURES[name]()) == []


def test_the_gate_finds_each_fault():
    figure = Figure(figsize=(4.0, 3.0))
    axes = figure.add_subplot()
    axes.plot([0.0, 1.0], [0.0, 2.0], label="a line")
    axes.set(xlabel="time", ylim=(0.0, 1.0))
    axes.legend()
    axes.text(0.5, 0.5, "one name")
    axes.text(0.51, 0.5, "another")
    axes.annotate("far out", (0.5, 1.6), xycoords="axes fraction", annotation_clip=False)
    assert faults_of(figure) == [
        "no unit: 'time'", "data cut off in ''", "legend over data", "'one name' over 'another'", "a label is cut off"
    ]  # fmt: skip


@pytest.mark.slow
@pytest.mark.skipif(found_browser() is None, reason="no browser: apt-get install chromium, or CASINGFEM_BROWSER")
def test_a_page_is_whole_on_paper_and_on_a_phone_and_has_no_repr(tmp_path):
    figures = {name: draw() for name, draw in FIGURES.items() if name in CAPTIONS}
    html = scene_page("rub", "[scene]", ran_sample(), figures, source={"scene": "rub.toml", "sha256": "01" * 32})
    (tmp_path / "scene.html").write_text(html, encoding="utf-8")
    wide = Picture.of(swept("diverged", "grows"), "A sweep.")
    verdict = Verdict(found="Four runs.", sure="Sure.", further="None.")
    (tmp_path / "sweep.html").write_text(render_page("S", [Section("A", figures=(wide,))], verdict=verdict))
    with browser(tmp_path / "user") as tab:
        for name in ("scene", "sweep"):
            for width, media in ((A4, "print"), (360, "screen")):
                tab.open(tmp_path / f"{name}.html", width)
                tab.send("Emulation.setEmulatedMedia", media=media)
                assert tab.run("document.documentElement.scrollWidth") <= width, (name, width)
                over = (
                    "[...document.querySelectorAll('img')].filter((e) => e.getBoundingClientRect().right > innerWidth)"
                )
                assert media == "screen" or tab.run(f"{over}.length") == 0, name
            assert REPR.search(tab.run("document.body.innerText")) is None
            assert tab.heard == []
