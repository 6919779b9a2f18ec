"""Pictures of the pages: `.venv/bin/python -m docs.screenshots [NAME ...]` runs the examples and writes docs/screens/.

It needs a Chromium, as the tests of pages do. Every picture is the first screen of a page, 1200 pixels wide, in 128
colours. `--made DIR` takes pages that are there already, as DIR/NAME.html.
"""

import argparse
import base64
import io
import shutil
import sys
import tempfile
from pathlib import Path

from click.testing import CliRunner
from PIL import Image

from casingfem.cli import main as casingfem
from casingfem.examples import DATA
from reports.studies.rig import chain
from reports.verification.rubs import beside
from tests.casingfem.plot.browser import Tab, browser

HERE = Path(__file__).parent / "screens"
WIDTH, HEIGHT = 1200, 900
PAGES = {
    "study": (("study", ""), "report.html"),
    "update": (("update", "studies/rig_casing.toml"), "update.html"),
    "scene_disk": (("report", "scenes/bladed_disk.toml"), "report.html"),
    "scene_rods": (("report", "scenes/two_rods.toml"), "report.html"),
    "interactions": (("interactions", "scenes/bladed_disk.toml"), "interactions.html"),
    "sweep": (("sweep", "scenes/two_rods_sweep.toml", "--jobs", "1"), "sweep.html"),
    "cycles": (("cycles", "scenes/cycles/bouncing_ball.toml"), "cycles.html"),
    "identification": (("identify", "test/frfs.uff"), "identified.html"),
    "chance": (("chance", "scenes/chance/scene.toml"), "chance.html"),
    "speeds_tutorial": (("beside", ""), "tutorial.html"),
    "speeds_rotor37": (("beside", ""), "rotor_37.html"),
    "speeds_titanium": (("beside", ""), "track_inside.html"),
}
FIRST = {
    "identification": (("rig", "studies/rig_test.toml", "test"),),
    "chance": tuple(("reduce", f"scenes/chance/{part}.toml", "scenes/chance") for part in ("casing", "blade")),
}
COLOURS = 128  # of a picture: files of some ten kilobytes


def page_of(name: str, data: Path, out: Path) -> Path:
    """Run the command of a page on a copy of the examples; studies of several files have commands of their own."""
    (verb, file, *more), page = PAGES[name]
    if verb == "study":
        chain.main(out)
        return out / page
    if verb == "beside":
        out = out.parent / "beside"
        if not out.exists():
            beside.main(out)
        return out / page
    run(verb, str(data / file), *more, "--out", str(out))
    return out / page


def run(*words: str) -> None:
    """Run a command of casingfem; end where it fails."""
    found = CliRunner().invoke(casingfem, list(words))
    if found.exit_code:
        sys.exit(f"casingfem {' '.join(words)}: exit code {found.exit_code}\n{found.output}")


def first_screen(tab: Tab, page: Path) -> bytes:
    """The first screen of a page as a PNG."""
    tab.send("Emulation.setScrollbarsHidden", hidden=True)  # before the page is laid out
    tab.open(page, WIDTH, HEIGHT)
    frames = "for (let k = 0; k < 6; k++) await new Promise(requestAnimationFrame);"
    tab.run(f"(async () => {{ {frames} }})()")
    area = {"x": 0, "y": 0, "width": WIDTH, "height": HEIGHT, "scale": 1}
    return few_colours(base64.b64decode(tab.send("Page.captureScreenshot", clip=area)["data"]))


def few_colours(png: bytes) -> bytes:
    """A picture with a palette of its most important colours."""
    with Image.open(io.BytesIO(png)) as picture:
        small = picture.convert("RGB").quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    packed = io.BytesIO()
    small.save(packed, "PNG", optimize=True)
    return packed.getvalue()


def main() -> None:
    """Write the pictures of these pages, of all if none is named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", choices=[[], *PAGES])
    parser.add_argument("--made", type=Path, help="folder of pages that are there already")
    given = parser.parse_args()
    names, made = given.names or list(PAGES), given.made
    HERE.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        data = Path(shutil.copytree(DATA, Path(folder) / "data"))
        for verb, file, out in dict.fromkeys(one for name in names for one in FIRST.get(name, ()) if made is None):
            run(verb, str(data / file), "--out", str(data / out))
        with browser(Path(folder) / "user") as tab:
            for name in names:
                page = page_of(name, data, Path(folder) / name) if made is None else made / f"{name}.html"
                picture = first_screen(tab, page.resolve())
                (HERE / f"{name}.png").write_bytes(picture)
                print(f"{name}: {len(picture) / 1e3:.0f} kB", flush=True)


if __name__ == "__main__":
    main()
