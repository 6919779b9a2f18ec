"""Extras: `casingfem doctor` lists those of pyproject.toml, and what is told to install one can be typed."""

import json
import re
import shlex
import sys
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main

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


@pytest.mark.slow
def test_doctor_states_which_are_there_and_what_installs_the_others():
    table = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    found = json.loads(CliRunner().invoke(main, ["doctor", "--json"]).stdout)["extras"]
    assert set(found) == set(table)
    for name, extra in found.items():
        assert set(extra["missing"]) <= packages(table[name], table)
        assert extra["installed"] == (not extra["missing"])
        if not extra["installed"]:
            here = [sys.executable, "-m", "pip", "install", "-e", f"{ROOT}[{name}]"]
            assert shlex.split(extra["install"]) == here


def test_a_missing_solver_is_named_with_what_installs_it(monkeypatch, frustum, coarse):
    monkeypatch.setitem(sys.modules, "pypardiso", None)
    with pytest.raises(cf.errors.NumericsError, match=r"pip install .*\[direct\]"):
        cf.modes(frustum(mesh=coarse), 4, method="shell", direct="pardiso")
