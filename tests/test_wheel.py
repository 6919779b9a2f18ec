"""The wheel holds the packages and the examples, and works where the repository is not."""

import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = ("casingfem", "contact", "data")
IN_PLACE = """
import sys
sys.path.insert(0, sys.argv[1])
import casingfem.cli
assert casingfem.__file__.startswith(sys.argv[1]), casingfem.__file__
for command in sys.argv[2:]:
    casingfem.cli.main(command.split(), standalone_mode=False)
"""


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    """The wheel of a copy of the sources, unpacked."""
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"
    for name in FOLDERS:
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "setup.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    build = "import sys; from setuptools.build_meta import build_wheel; build_wheel(sys.argv[1])"  # as pip does
    subprocess.run([sys.executable, "-c", build, str(folder)], cwd=source, capture_output=True, check=True)
    (wheel,) = folder.glob("*.whl")
    zipfile.ZipFile(wheel).extractall(folder / "site")
    return folder / "site"


def files(folder: Path) -> set[str]:
    """All files below a folder, but what Python and numba keep of them."""
    paths = (path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {path.relative_to(folder).as_posix() for path in paths}


@pytest.mark.slow
def test_it_keeps_both_packages_and_the_examples_and_nothing_else(unpacked):
    held = {name for name in files(unpacked) if not name.partition("/")[0].endswith(".dist-info")}
    wanted = {f"{package}/{name}" for package in ("casingfem", "contact") for name in files(ROOT / package)}
    wanted |= {f"casingfem/data/{name}" for name in files(ROOT / "data") if not name.startswith("reference/")}
    assert held == wanted


@pytest.mark.slow
def test_an_example_is_written_and_run_where_the_repository_is_not(unpacked, tmp_path):
    commands = ["example pair", "stability data/scenes/pair.toml"]
    words = [sys.executable, "-P", "-c", IN_PLACE, str(unpacked), *commands]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=True)
    said = done.stdout.splitlines()
    assert said[:3] == ["wrote data/scenes/pair.toml", "next:", f"  casingfem {commands[1]}"]
    assert "n = 8 grows by 3.788 1/s at 52.844 Hz" in " ".join(" ".join(said[3:]).split())
