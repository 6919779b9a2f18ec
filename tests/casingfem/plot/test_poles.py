"""The page on an identification: every channel, the diagram to pick from, MAC; picks made in a browser are read."""

import base64
import json
import re

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from casingfem.plot.identify import figure_fit, figure_responses, figure_stabilisation
from casingfem.plot.page import SIXTEEN
from casingfem.plot.pages.identification import identification_page
from casingfem.plot.poles import MOST_LINES, drawn_lines, logarithm
from casingfem.plot.style import Drawn
from tests.casingfem.plot.browser import browser, found_browser
from tests.casingfem.plot.page_gate import faults_of, page_faults

pytestmark = pytest.mark.slow
THETA = np.radians(np.arange(8) * 45.0 + 7.0)
PLACE = '[data-live="poles"]'


@pytest.fixture(scope="module")
def frfs():
    rows = np.column_stack([np.cos(2 * (np.r_[THETA, 0.4] - 0.1)), np.ones(9), np.cos(np.r_[THETA, 0.4])])
    rig = cf.rig.Rig.of(omega=2 * np.pi * np.array([200.0, 230.0, 260.0]), zeta=0.004, rows=rows)
    return cf.rig.noisy(rig.frfs(np.arange(180.0, 280.0, 0.2), sensors=range(8), drives=[8]), 50.0, seed=6)


@pytest.fixture(scope="module")
def found(frfs) -> cf.Identified:
    return cf.identify(frfs, angles=dict(enumerate(np.degrees(THETA), start=1)))


@pytest.fixture(scope="module")
def html(found) -> str:
    drawn = {
        "fit": figure_fit(found),
        "responses": figure_responses(found),
        "stabilisation": figure_stabilisation(found),
    }
    return identification_page("test.npz", found, {"file": "test.npz"}, {k: Drawn(f) for k, f in drawn.items()})


def island_of(html: str) -> dict:
    return json.loads(re.search(r'data-live="poles"><script type="application/json">(.*?)</script>', html)[1])


def numbers(part, kind="<i2"):
    return np.frombuffer(base64.b64decode(part["data"] if isinstance(part, dict) else part), kind)


@pytest.mark.slow
def test_the_pictures_of_an_identification_pass_the_gate(found):
    drawn = (figure_fit(found), figure_responses(found), figure_stabilisation(found))
    assert [fault for figure in drawn for fault in faults_of(figure)] == []


@pytest.mark.slow
@pytest.mark.skipif(found_browser() is None, reason="no browser: apt-get install chromium, or CASINGFEM_BROWSER")
def test_the_page_of_an_identification_passes_the_gate(html, tmp_path):
    (tmp_path / "page.html").write_text(html, encoding="utf-8")
    with browser(tmp_path / "user") as tab:
        assert page_faults(tab, tmp_path / "page.html") == []


def test_the_page_has_all_channels_poles_and_modes(html, found, frfs):
    data = island_of(html)
    assert len(data["channels"]) == 8
    assert [mode["freq"] for mode in data["modes"]] == pytest.approx(found.freq.tolist(), rel=1e-7)
    np.testing.assert_allclose(numbers(data["lines"], "<f4"), frfs.x, rtol=1e-6)
    np.testing.assert_allclose(numbers(data["freq"], "<f4"), found.diagram.freq, rtol=1e-6)
    assert (numbers(data["stable"], "u1") == found.diagram.stable).all()
    size = data["channels"][2]["size"]
    np.testing.assert_allclose(
        numbers(size) / SIXTEEN * size["most"], np.log10(np.abs(frfs.responses[2])), atol=2e-3 * size["most"]
    )


def test_the_page_has_the_mac_of_the_modes_found(html, found):
    values = cf.correlation.mac(found.shapes, found.shapes)
    section = html.partition("Similarity of the shapes</h2>")[2].partition("</table>")[0]
    cells = re.findall(r'<td class="number">([\d.]+)</td>', section)
    expected = [str(cell) for k, row in enumerate(values) for cell in (k + 1, *(f"{v:.2f}" for v in row))]
    assert cells == expected


def test_of_many_lines_the_peaks_are_drawn():
    curve = np.ones(50_000)
    curve[[7, 30_011]] = 9.0
    at = drawn_lines(curve)
    assert len(at) <= MOST_LINES + 2
    assert {0, 7, 30_011, 49_999} <= set(at.tolist())
    assert np.isfinite(logarithm(np.array([0.0, 1.0, 10.0]))).all()


@pytest.mark.skipif(found_browser() is None, reason="no browser: apt-get install chromium, or CASINGFEM_BROWSER")
def test_poles_clicked_in_a_browser_are_those_that_identify_takes(html, found, frfs, tmp_path):
    (tmp_path / "page.html").write_text(html, encoding="utf-8")
    data = island_of(html)
    freq, order = numbers(data["freq"], "<f4"), numbers(data["order"], "u1")
    top = max(int(order.max()), 1) + 1
    with browser(tmp_path / "user", webgl=False) as tab:
        tab.open(tmp_path / "page.html", 1000)
        canvas, low, high = f"{PLACE} canvas", float(frfs.x[0]), float(frfs.x[-1])
        empty = tab.look(canvas)
        for wanted in found.freq[[0, 2]].tolist():
            k = int(np.argmin(np.abs(freq - wanted)))
            x, y = tab.place(canvas, (float(freq[k]) - low) / (high - low), 1.0 - int(order[k]) / top)
            for kind in ("mousePressed", "mouseReleased"):
                tab.mouse(kind, x, y, button="left", clickCount=1)
        assert "2 picked" in tab.run(f"document.querySelector('{PLACE} span').textContent")
        assert tab.look(canvas) != empty
        tab.run(f"[...document.querySelectorAll('{PLACE} button')].at(-1).click()")
        (tmp_path / "picks.csv").write_text(tab.run(f"document.querySelector('{PLACE}').saved"))
        tab.run(f"(() => {{ const s = document.querySelector('{PLACE} select'); s.value = 3;"
                "s.dispatchEvent(new Event('change')); })()")  # fmt: skip
        tab.look(canvas)
        assert tab.run("document.documentElement.scrollWidth") <= 1000
        assert tab.heard == []
    assert cf.frf.read_picks(tmp_path / "picks.csv") == pytest.approx(found.freq[[0, 2]], abs=0.5)
    result = CliRunner().invoke(
        main, ["identify", str(frfs.save(tmp_path / "f.npz")), "--pick", str(tmp_path / "picks.csv"), "--json"]
    )
    assert result.exit_code == 0, result.output
    picked = [mode["freq_hz"] for mode in json.loads(result.stdout)["modes"]]
    assert picked == pytest.approx(found.freq[[0, 2]].tolist(), rel=1e-4)
