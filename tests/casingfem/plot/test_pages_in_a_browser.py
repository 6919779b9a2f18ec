"""The pages in a real browser, headless: they draw, move, turn, tell values, and never err, wide and narrow."""

from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.plot.body.turning import turning_shapes
from casingfem.plot.contact import rub_film
from casingfem.plot.modes import figure_frequencies
from casingfem.plot.page import Picture, Section, Table, Verdict, render_page
from tests.casingfem.plot.browser import Tab, browser, found_browser

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(found_browser() is None, reason="no browser: apt-get install chromium, or CASINGFEM_BROWSER"),
]


@pytest.fixture(scope="module")
def surveyed(frustum, coarse) -> cf.Modes:
    """A casing whose survey has one stray point, half a millimetre off."""
    theta, z = (part.ravel() for part in np.meshgrid(np.radians(np.arange(0.0, 360.0, 5.0)), [0.0, 0.1, 0.25]))
    noise = np.random.default_rng(771).normal(0.0, 1e-6, theta.size)
    radius = (0.5 - 0.2 * z) * (1.0 + 1e-3 * np.cos(3.0 * theta)) + noise
    radius[80] += 5e-4
    with pytest.warns(cf.errors.ModelWarning, match="survey-outliers"):
        field = cf.SurveyField.from_points(theta, z, radius, n_max=4, degree=1, robust=True)
    return cf.modes(frustum(thickness=20e-3, mesh=coarse, radius_defect=field), 4)


@pytest.fixture(scope="module")
def html(surveyed) -> str:
    t = np.linspace(0.0, 0.1, 200)
    wave = 1e-5 * np.cos(2.0 * np.pi * 300.0 * t)[:, None]
    gap = 2e-5 + wave
    film = SimpleNamespace(
        time=t, turned=20.0 * t, stretches=np.zeros(1, int), n=np.array([0, 3]), cos=np.hstack([0.1 * wave, wave]),
        sin=np.hstack([0.0 * wave, 0.5 * wave]), profile=1e-5 * np.cos(2.0 * np.radians(np.arange(360.0))),
        radius=0.5, left_out=0, angle=np.array([0.3]), gap=gap, force=np.maximum(0.0, 1e-5 - gap) * 1e7,
    )  # fmt: skip
    run = SimpleNamespace(time=t, gap=gap, windowed_force=lambda: film.force)
    rows = tuple((k, f"{1.0 / (k + 1):.4f}", "a column of words that is long enough to be wide") for k in range(3))
    figures = (
        turning_shapes(surveyed, [0, 2], "Two modes and the survey."),
        rub_film(film, run),
        Picture.of(figure_frequencies(surveyed), "Frequencies."),
    )
    tables = (Table("A table.", ("number", "value", "words", "again", "again", "and again"), rows and tuple(
        (*row, row[2], row[2], row[2]) for row in rows)),)  # fmt: skip
    verdict = Verdict(found="Four modes.", sure="As sure as a coarse mesh.", further="Refine it.")
    return render_page("A page", [Section("All of it", figures=figures, tables=tables)], verdict=verdict)


@pytest.fixture(scope="module")
def file(html, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("page") / "page.html"
    path.write_text(html, encoding="utf-8")
    return path


SHAPES, RIM, TRACES = '[data-live="shapes"] canvas', ".films div:first-child canvas", ".films div:last-child canvas"


@pytest.mark.campaign
@pytest.mark.parametrize("width", [360])
def test_what_is_drawn_moves_and_turns(tab, file, width):
    tab.open(file, width)
    assert tab.run("innerWidth") == width
    assert tab.run("document.documentElement.scrollWidth") <= width  # nothing sticks out at the side
    tab.place(SHAPES, 0.5, 0.5)
    first = tab.look(SHAPES)
    assert tab.look(SHAPES) != first
    press(tab, "shapes", "pause")
    still = tab.look(SHAPES)
    assert tab.look(SHAPES) == still
    tab.drag(SHAPES, (40.0, 25.0))
    turned = tab.look(SHAPES)
    assert turned != still
    x, y = tab.place(SHAPES, 0.5, 0.5)
    tab.mouse("mouseWheel", x, y, deltaX=0.0, deltaY=-200.0)
    zoomed = tab.look(SHAPES)
    assert zoomed != turned
    press(tab, "shapes", "radius as surveyed")
    assert tab.look(SHAPES) != zoomed
    assert tab.run("[...document.querySelectorAll('.tag')].map((tag) => tag.textContent)") == ["40°, z 0.1 m: +500 µm"]
    assert "1 stray points of the survey" in tab.run("document.querySelector('[data-live=shapes]').textContent")
    assert tab.heard == []


@pytest.mark.campaign
@pytest.mark.parametrize("width", [1200])
def test_a_rub_plays_and_can_be_stopped_at_an_instant(tab, file, width):
    tab.open(file, width)
    tab.place(RIM, 0.5, 0.5)
    first = tab.look(RIM), tab.look(TRACES)
    assert tab.look(RIM) != first[0]
    assert tab.look(TRACES) != first[1]
    x, y = tab.place(TRACES, 0.75, 0.5)
    tab.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
    tab.mouse("mouseReleased", x, y, button="left", clickCount=1)
    chosen = tab.look(RIM)
    assert tab.look(RIM) == chosen
    told = "document.querySelector('[data-live=film] .bar span').textContent"
    assert 0.05 < float(tab.run(told).split("t = ")[1].split(" s")[0]) < 0.09
    tab.run("{ const s = document.querySelector('input.long'); s.value = 0; s.dispatchEvent(new Event('input')); }")
    assert tab.look(RIM) != chosen
    assert "t = 0.00000 s, force 0.00 N, gap 0.0300 mm" in tab.run(told)
    assert tab.heard == []


@pytest.mark.parametrize("width", [360])
def test_a_value_shows_under_the_pointer(tab, file, width, surveyed):
    tab.open(file, width)
    row = tab.run("JSON.parse(document.querySelector('[data-live=hover] script').textContent)[0].rows[0]")
    point = partial(tab.point, '[data-live="hover"] img', row[0], row[1])
    # as a hand does: on a busy machine the page may still grow above the picture when the pointer is there
    tab.wait("!document.querySelector('.tip').hidden", point)
    x, y = point()
    words = tab.run("document.querySelector('.tip').innerText")
    assert f"frequency [Hz]: {surveyed.freq[0]:.6g}" in words
    assert f"nodal diameters n: {surveyed.nodal_diameters[0]}" in words
    tab.wait("document.querySelector('.tip').hidden", lambda: tab.mouse("mouseMoved", x, y - 40.0))
    assert tab.heard == []


def test_on_paper_are_the_still_pictures(tab, file):
    tab.open(file, 1200)
    tab.send("Emulation.setEmulatedMedia", media="print")
    shown = "getComputedStyle(document.querySelector('%s')).display"
    assert tab.run(shown % '[data-live="shapes"] > canvas') == "none"
    assert tab.run(shown % '[data-live="shapes"] > .still') == "block"
    assert tab.run(shown % ".verdict") == "grid"
    tab.send("Emulation.setEmulatedMedia", media="screen")
    assert tab.run(shown % '[data-live="shapes"] > .still') == "none"


def test_without_webgl_the_moving_pictures_stay(html, tmp_path):
    (tmp_path / "page.html").write_text(html, encoding="utf-8")
    with browser(tmp_path / "user", webgl=False) as tab:
        tab.open(tmp_path / "page.html", 1200)
        assert tab.run("document.querySelectorAll('[data-live=shapes] canvas').length") == 0
        assert tab.run("document.querySelector('[data-live=shapes] details img').offsetWidth") > 400
        assert tab.heard == []


def press(tab: Tab, live: str, words: str) -> None:
    """Press a button of a moving picture by what is on it."""
    buttons = f"[...document.querySelectorAll('[data-live={live}] button')]"
    tab.run(f"{buttons}.find((button) => button.textContent === '{words}').click()")
