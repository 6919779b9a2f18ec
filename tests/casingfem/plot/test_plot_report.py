"""The report: one page, nothing outside it, the same figures from pieces that others compose."""

import base64
import datetime
import io
import json
import os
import re
import sys
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure
from PIL import Image

import casingfem as cf
from casingfem.cli import main
from casingfem.plot.contact import figure_contact
from casingfem.plot.hover import hover_values
from casingfem.plot.page import Section, Table, render_page
from casingfem.plot.pages.sections import mesh_rows, structure_rows
from casingfem.plot.style import embed, know_in_notebook, new_figure, png
from contact.io.outfiles import json_text, write_atomic, write_files
from tests.casingfem.plot.browser import found_browser
from tests.casingfem.plot.page_gate import faults_of, page_faults
from tests.casingfem.study.study_texts import STEEL_PLATE, THICK

UPDATE = """
[update]
table = "table.csv"
[[update.parameter]]
name = "material.E"
lower = 150e9
upper = 250e9
[[update.parameter]]
name = "radius.p8.cos"
lower = 0.0
upper = 0.01
"""
STUDY = THICK.replace("p = 6", "p = 8") + UPDATE


def run(command: str, *arguments: object) -> dict[str, Any]:
    """The document of a command."""
    result = CliRunner().invoke(main, [command, *map(str, arguments), "--json"])
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)


class Page(HTMLParser):
    """Tags, images and text of a page."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.open: list[str] = []
        self.figures: list[Figure] = []
        self.images: list[dict[str, str | None]] = []
        self.links: list[str] = []
        self.text, self.html = "", html
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.tags.append(tag)
        if tag not in ("meta", "img", "link"):
            self.open.append(tag)
        if tag == "img":
            self.images.append(values)
        self.links += [str(values[key]) for key in ("href", "src") if key in values]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not self.open or self.open[-1] not in ("script", "style"):
            self.text += data


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Page:
    folder = tmp_path_factory.mktemp("report")
    study = folder / "casing.toml"
    study.write_text(STUDY)
    shell = cf.Shell(
        chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
        thickness=20e-3,
        material=cf.Material(E=205e9, nu=0.3, rho=7800.0),
        supports={"base": cf.ElasticEdge(k_face=1e12)},
        radius_defect=cf.FourierField.of({8: 0.005}),
        mesh=cf.ShellMesh(order=5, rows=1, around=9),
    )
    truth = cf.modes(shell, 6)
    cf.FrequencyTable.from_arrays(
        freq_hz=truth.freq, sigma_hz=0.5, n=truth.nodal_diameters, angle_deg=truth.angle_deg, synthetic=True
    ).to_csv(folder / "table.csv")
    figures: list[Figure] = []

    def kept(figure: Figure, alt: str, *, kind: str = "svg") -> str:
        figures.append(figure)
        return embed(figure, alt, kind=kind)

    with pytest.MonkeyPatch.context() as patch:
        for module in ("page", "body.shapes"):
            patch.setattr(f"casingfem.plot.{module}.embed", kept)
        result = CliRunner().invoke(main, ["report", str(study), "--out", str(folder / "out"), "--json"])
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["report"] == str(folder / "out" / "report.html")
    assert [path.name for path in (folder / "out").iterdir()] == ["report.html"]
    found = Page((folder / "out" / "report.html").read_text(encoding="utf-8"))
    found.figures = figures
    return found


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="cores of a process are set on Linux only")
def test_a_page_made_by_two_processes_is_that_of_one(tmp_path):
    """Over 10,000 unknowns another process computes and draws what the update does not need."""
    text = STUDY.replace("order = 5", "order = 10").replace("around = 9", "around = 21")
    study = tmp_path / "casing.toml"
    study.write_text(text[: text.index("[reduce]")])
    measured = [1.001 * row["freq_hz"] for row in run("modes", study)["modes"]]
    cf.FrequencyTable.from_arrays(freq_hz=measured, sigma_hz=0.5).to_csv(tmp_path / "table.csv")
    study.write_text(study.read_text() + UPDATE)
    cores, pages = os.sched_getaffinity(0), []
    for some in ({min(cores)}, cores):
        os.sched_setaffinity(0, some)
        try:
            run("report", study, "--out", tmp_path)
        finally:
            os.sched_setaffinity(0, cores)
        page = (tmp_path / "report.html").read_text(encoding="utf-8")
        pages.append(Page(page[: page.index("<h2>Provenance")]).text)  # times are below
    assert "radius.p8.cos" in pages[0]
    assert pages[0] == pages[1]


@pytest.mark.slow
def test_the_page_is_well_formed_and_is_alone(page):
    assert page.open == []
    outside = [link for link in page.links if not link.startswith(("data:image/", "#"))]
    assert outside == []
    assert not {"link", "iframe"} & set(page.tags)
    assert page.tags.count("script") == 4 + 3  # data of three pictures and the shapes; what draws them


@pytest.mark.slow
def test_every_figure_is_there_and_has_words_for_those_who_cannot_see_it(page):
    assert len(page.images) == 7  # frequencies, shapes moving and still, rims, comparison, errors, correlation
    for image in page.images:
        assert len(str(image["alt"])) > 40
        kind, data = re.fullmatch(r"data:image/(png|svg\+xml);base64,(.*)", str(image["src"])).groups()
        raw = base64.b64decode(data)
        assert raw.startswith(b"\x89PNG" if kind == "png" else b"<?xml")


@pytest.mark.slow
def test_the_pictures_of_a_study_pass_the_gate(page):
    assert len(page.figures) == 6
    assert [fault for figure in page.figures for fault in faults_of(figure)] == []


@pytest.mark.slow
@pytest.mark.skipif(found_browser() is None, reason="no browser: apt-get install chromium, or CASINGFEM_BROWSER")
def test_the_page_of_a_study_passes_the_gate(page, tab, tmp_path):
    (tmp_path / "page.html").write_text(page.html, encoding="utf-8")
    assert page_faults(tab, tmp_path / "page.html") == []


@pytest.mark.slow
def test_a_synthetic_table_is_called_so_above_all_else(page):
    assert page.text.index("SYNTHETIC") < page.text.index("Inputs")
    assert "nobody measured it" in page.text


@pytest.mark.slow
def test_the_page_has_the_parts_of_the_study(page):
    for words in (
        "Inputs", "Modes", "Update", "Reduction", "Provenance", "sha256", "numpy", "Run times",
        "material.E", "radius.p8.cos", "RMS relative frequency error", "residual compliance", "Sturm count",
    ):  # fmt: skip
        assert words in page.text, words


def test_a_table_cell_cannot_break_out_of_the_page():
    table = Table("<b>caption</b>", ("a",), (("<script>alert(1)</script>",), (None,), (1.23456789,)))
    html = render_page("A & B", [Section("S", ("x < y",), tables=(table,), preformatted="</pre>")])
    assert "<script>" not in html
    assert "alert(1)" in Page(html).text
    page = Page(html)
    assert page.open == []
    assert "1.2346" in page.text
    assert "–" in page.text


@pytest.mark.slow
def test_the_verdict_is_above_all_and_the_source_is_named(page):
    at = [page.text.index(words) for words in ("Found", "How sure", "Next", "sha256", "Inputs")]
    assert at == sorted(at)
    assert "RMS frequency error" in page.text[at[0] : at[1]]
    assert f"casingfem {cf.__version__}" in page.text[at[3] - 40 : at[4]]
    assert f"{datetime.date.today().year}" in page.text[at[3] : at[4]]


@pytest.mark.slow
def test_numbers_have_digits_that_mean_something(page):
    """No repr in a table, no per cent with six decimals, no bare power of ten."""
    assert not re.search(r"\d\.\d{5,} ?%", page.text)
    assert not re.search(r"\d[eE][+-]\d", page.text)
    for words in ("FourierField(", "SurveyField(", "ElasticEdge("):
        assert words not in page.text


@pytest.mark.slow
def test_values_are_where_they_are_drawn():
    """The marker's colour is in the picture where the page says that its value is; a value outside is not told."""
    figure = new_figure(4.0, 3.0)
    axes = figure.add_subplot()
    axes.plot([1.0, 2.0, 9.0], [10.0, 40.0, 20.0], "s", color="#ff0000", markersize=9, label="dots")
    axes.set(xlim=(0.0, 3.0), ylim=(1.0, 100.0), yscale="log", xlabel="n", ylabel="f [Hz]")
    picture = np.asarray(Image.open(io.BytesIO(png(figure))).convert("RGB"))
    (series,) = hover_values(figure)
    assert (series["name"], series["axes"]) == ("dots", ["n", "f [Hz]"])
    assert [row[2:] for row in series["rows"]] == [[1, 10], [2, 40]]
    for x, y, *_ in series["rows"]:
        assert picture[round(y * picture.shape[0]), round(x * picture.shape[1])].tolist() == [255, 0, 0]


def test_figures_are_the_same_bits_twice():
    first, second = (embed(new_figure(2.0, 1.0), "empty") for _ in range(2))
    assert first == second


def test_embed_escapes_and_refuses():
    assert 'alt="a &quot;b&quot; &lt; c"' in embed(new_figure(1.0, 1.0), 'a "b" < c')
    with pytest.raises(ValueError, match="svg"):
        embed(new_figure(1.0, 1.0), "x", kind="gif")


def test_contact_figure_shows_force_gap_and_the_largest_coordinates():
    time = np.linspace(0.0, 1.0, 20_001)
    force = np.where(np.abs(time - 0.4567) < 1e-4, 300.0, 0.0)[:, None]
    state = np.outer(np.sin(20 * time), [0.1, 3.0, 1.0, 2.0, 0.2, 0.3])
    result = SimpleNamespace(
        time=time, gap=1e-3 - 1e-6 * force, state_time=time, state=state, windowed_force=lambda: force, window=1e-4,
        scheme="exact modal", blocks=(("casing", 0, 4), ("blade", 4, 6)),
    )  # fmt: skip
    axes = figure_contact(result).axes
    assert len(axes) == 6  # the whole run, then the close-up
    highest = axes[0].lines[-1]
    assert len(highest.get_xdata()) <= 600
    assert highest.get_ydata().max() == 300.0
    low, high = axes[3].get_xlim()
    assert low < 0.4567 < high < low + 0.1
    assert axes[3].lines[0].get_ydata().max() == 300.0
    names = [line.get_label() for line in axes[2].lines if not line.get_label().startswith("_")]
    assert names == ["casing, mode 2", "casing, mode 4", "casing, mode 3", "blade, mode 2"]
    still = SimpleNamespace(**{**vars(result), "state_time": time[:0], "state": state[:0]})
    assert len(figure_contact(still).axes) == 4


def test_files_appear_together_or_not_at_all(tmp_path: Path):
    (tmp_path / "a.txt").write_text("old")

    def fails(path: Path) -> None:
        path.write_text("half")
        raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        write_files(tmp_path, {"a.txt": "new", "b.txt": fails})
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("a.txt", "old")]
    assert write_atomic(tmp_path / "deep" / "c.txt", "é").read_text(encoding="utf-8") == "é"


def test_json_has_no_nan():
    assert json.loads(json_text({"a": [float("nan"), float("inf"), 1.5], "b": {"c": (2,)}})) == {
        "a": [None, None, 1.5], "b": {"c": [2]},
    }  # fmt: skip


def test_a_notebook_shows_a_figure_in_its_own_style(monkeypatch):
    """It shows the figures of pyplot, of itself; a stand-in for IPython, whose formatter keeps types with functions."""
    known = {}
    formatter = SimpleNamespace(type_printers=known, for_type=known.__setitem__)
    shell = SimpleNamespace(display_formatter=SimpleNamespace(formatters={"image/png": formatter}))
    with monkeypatch.context() as notebook:
        notebook.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
        know_in_notebook()
        first = known[Figure]
        know_in_notebook()
    assert known == {Figure: first}
    assert first(new_figure(1.0, 1.0)).startswith(b"\x89PNG")


def test_inputs_name_every_ply_and_what_is_attached():
    carbon = cf.shell.Lamina(E1=140e9, E2=10e9, nu12=0.3, G12=5e9, G13=5e9, G23=3.8e9, rho=1600.0)
    layers = (cf.shell.Ply(thickness=1.0), cf.shell.Ply(thickness=2.0, angle_deg=45.0, lamina=carbon))
    steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=3e-3, material=steel, wall="linear", plies=layers)
    rows = dict(structure_rows(plate))
    assert rows["ply 1"] == "1 mm of the material"
    assert rows["ply 2"] == "2 mm at 45°: E1 140, E2 10, G12 5, G13 5, G23 3.8 GPa, nu12 0.3, rho 1600 kg/m³"
    block = cf.imported.grid_mesh("hexahedron20", (1, 1, 1), lambda u: u)
    hung = cf.imported.Attachments(masses=(cf.imported.PointMass(node=3, mass=2.0),))
    solid = cf.Solid(mesh=replace(block, attachments=hung), material=steel)
    assert dict(mesh_rows(solid))["attached"] == "1 point mass"


MERIDIAN = """
[material]
E = 114e9
nu = 0.34
rho = 4430.0
[chart]
kind = "meridian"
start = [0.60, 0.0]
fillet = 4e-3
[[chart.piece]]
to = [0.60, 0.30]
[[chart.piece]]
to = [0.52, 0.45]
radius = 2.0
thickness = 4e-3
[shell]
thickness = 3.5e-3
[support.base]
kind = "ring"
width = 20e-3
depth = 6e-3
offset = [0.0, -3e-3]
[support.base.support]
kind = "bolts"
count = 12
k = 1e8
k_rot = 1e4
first_angle_deg = 15.0
loose = [{bolt = 3, factor = 0.5}]
[support.top]
kind = "elastic"
k_z = 1e7
k_rot = 2e4
k_face = 1e9
[mesh]
order = 3
around = 9
[modes]
count = 2
"""


@pytest.mark.slow
def test_the_page_shows_the_pieces_of_a_meridian_and_each_number_in_the_unit_of_its_key(tmp_path):
    (tmp_path / "study.toml").write_text(MERIDIAN)
    result = CliRunner().invoke(main, ["report", str(tmp_path / "study.toml"), "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    text = Page((tmp_path / "report.html").read_text(encoding="utf-8")).text
    for words in (
        "Meridian of 2 pieces from r 0.6 m, z 0 m on",
        "to r 0.52 m, z 0.45 m, arc of radius 2 m; s from",
        "ring 20 x 6 mm, offset (0, -0.003) m",
        "bolts count 12, k 10⁸ N/m, k_rot 10000 N m/rad, first_angle 15 °, loose: bolt 3 times 0.5",
        "elastic edge k_z 10⁷ N/m per m, k_rot 20000 N m/rad per m, k_face 10⁹ N/m³",
    ):
        assert words in text, words
    assert "Revolved" not in text


@pytest.mark.slow
def test_several_files_have_one_page_and_a_turning_part_its_campbell_diagram(tmp_path):
    turning = STEEL_PLATE + "[rotation]\nspeed_hz = 50.0\nhub_radius = 0.3\n[modes]\ncount = 2\n"
    for name, text in (("turning", turning), ("still", STEEL_PLATE + "[modes]\ncount = 2\n")):
        (tmp_path / f"{name}.toml").write_text(text)
    files = [str(tmp_path / "turning.toml"), str(tmp_path / "still.toml")]
    result = CliRunner().invoke(main, ["report", *files, "--out", str(tmp_path), "--json"])
    assert result.exit_code == 0, result.output
    assert [part["source"]["study"] for part in json.loads(result.stdout)["parts"]] == ["turning.toml", "still.toml"]
    page = Page((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert page.open == []
    assert [page.tags.count(head) for head in ("h1", "h2")] == [1, 2]
    inside = re.findall(r'href="#(\w+)">([^<]+)', page.html)
    assert [words for _, words in inside if "Campbell" in words] == ["Study turning: Campbell diagram"]
    assert all(re.search(rf'<(section|h2) id="{mark}">', page.html) for mark, _ in inside)
    assert [words for _, words in inside][:2] == ["Study turning", "Study still"]  # their verdicts, before the contents
    assert "engine orders met" in page.text
