"""Extras: the table is that of pyproject.toml, and what is told to install one can be typed."""

import json
import re
import shlex
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.sparse import csc_array

import casingfem as cf
from casingfem import extras
from casingfem.cli import main
from casingfem.extras import EXTRAS, remedy
from casingfem.linalg.factor import PardisoFactor

ROOT = Path(__file__).parents[2]


def packages(lines: list[str], table: dict[str, list[str]]) -> set[str]:
    """Names of the packages that requirements mean, the extras of casingfem itself put in."""
    names = set()
    for line in lines:
        name, own = re.match(r"([\w-]+)(?:\[([^]]+)\])?", line).groups()
        names |= (
            packages([r for extra in own.split(",") for r in table[extra]], table) if name == "casingfem" else {name}
        )
    return names


def test_the_table_is_that_of_the_project():
    table = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    assert {name: set(extra.packages) for name, extra in EXTRAS.items()} == {
        name: packages(lines, table) for name, lines in table.items()
    }


def test_in_a_checkout_the_folder_is_installed_and_elsewhere_the_package(monkeypatch, tmp_path):
    assert shlex.split(remedy("sampling")) == [sys.executable, "-m", "pip", "install", "-e", f"{ROOT}[sampling]"]
    monkeypatch.setattr(extras, "ROOT", tmp_path)
    assert shlex.split(remedy("sampling")) == [sys.executable, "-m", "pip", "install", "casingfem[sampling]"]


@pytest.mark.slow
def test_doctor_says_which_are_there_and_what_installs_the_others(monkeypatch):
    monkeypatch.setattr(
        sys.modules["casingfem.cli.doctor"], "installed", lambda name: None if name == "emcee" else "1.0"
    )
    found = json.loads(CliRunner().invoke(main, ["doctor", "--json"]).stdout)["extras"]
    assert list(found) == list(EXTRAS)
    assert {name for name, extra in found.items() if not extra["installed"]} == {"sampling", "dev"}
    assert found["sampling"]["missing"] == ["emcee"]
    assert found["sampling"]["install"] == remedy("sampling")
    assert found["cluster"]["install"] is None
    lines = CliRunner().invoke(main, ["doctor"]).stdout.splitlines()
    (place,) = (k for k, line in enumerate(lines) if line.startswith("extra sampling"))
    assert "not installed (emcee): a sampled posterior" in lines[place]
    assert lines[place + 1].strip() == remedy("sampling")


def test_a_missing_solver_is_named_with_what_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "pypardiso", None)
    with pytest.raises(cf.errors.NumericsError) as refused:
        PardisoFactor(csc_array(np.eye(2)))
    assert str(refused.value).endswith(remedy("direct"))
