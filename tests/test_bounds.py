"""Other files agree with pyproject.toml: constraints-oldest.txt on the oldest versions, CITATION.cff on the release."""

import re
import tomllib
from pathlib import Path

from packaging.version import Version

ROOT = Path(__file__).parents[1]
TRANSITIVE = {"pyparsing"}  # newer ones warn of what matplotlib 3.9 calls
EXTRA = {"pypardiso", "numba-cuda", "sphinx", "furo", "sphinx-gallery", "myst-parser"}  # in no environment of the suite


def bounds() -> dict[str, Version]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    every = [*project["dependencies"], *(one for part in project["optional-dependencies"].values() for one in part)]
    found = (re.match(r"([\w-]+)(?:\[\w+\])?>=([\d.]+)", one) for one in every)
    return {one[1].lower(): Version(one[2]) for one in found if one and one[1] not in EXTRA}


def test_the_oldest_versions_pinned_are_the_bounds():
    lines = (ROOT / "constraints-oldest.txt").read_text(encoding="utf-8").split()
    pins = {name.lower(): Version(version) for name, version in (line.split("==") for line in lines)}
    assert TRANSITIVE <= pins.keys()
    assert {name: pin for name, pin in pins.items() if name not in TRANSITIVE} == bounds()


def test_the_citation_file_names_this_release():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    stated = dict(re.findall(r"^([\w-]+): (\S.*)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE))
    assert [stated[key] for key in ("cff-version", "title", "version", "license")] == [
        "1.2.0", project["name"], project["version"], project["license"]
    ]  # fmt: skip
