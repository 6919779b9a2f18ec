"""`casingfem schema KEY`: one table on a screen; every key of every file says what it is, and its unit."""

import json

import pytest
from click.testing import CliRunner

from casingfem.cli import main


def asked(*args):
    return CliRunner().invoke(main, ["schema", *args])


@pytest.mark.parametrize(
    ("key", "lines"),
    [
        ("shell", ["thickness    nominal wall thickness [m]", "number > 0 <= 1000; must be given"]),
        ("chart", ["frustum", "a circular meridian"]),
        ("chart.frustum", ["r_base  mean radius at z = 0 [m]"]),
        ("support.base.elastic", ["k_face   foundation modulus of the end face [N/m^3]"]),
        ("update.parameter", ["lower bound [unit of the parameter]"]),
        ("rub.closing", ["time_constant  time constant of an exponential reduction [s]"]),
        (
            "coating",
            [
                "coating (rim, rub, disk, rotor, cycles-rim, cycles-rub, cycles-disk)",
                "whole number >= 1 <= 10000; 6 if left out",
            ],
        ),
        ("contact", ["differs between kinds of file", "rub.contact: clearance [m]"]),
        ("material.E", ["Young's modulus [Pa]"]),
        ("sweep.vary", ["log     whether values are evenly spaced", "false if left out"]),
        ("scene", ["rods: A scene of rods", "patch: A modal body"]),
    ],
)
def test_a_key_is_explained_on_a_screen(key, lines):
    result = asked(key)
    assert result.exit_code == 0, result.output
    assert all(line in result.stdout for line in lines), result.stdout
    assert "None" not in result.stdout
    assert len(result.stdout.splitlines()) < (40 if key != "scene" else 260)
    assert json.loads(asked(key, "--json").stdout)["tables"][0]["text"] in result.stdout


def test_a_mistyped_key_is_offered_the_three_names_most_like_it():
    """Five names are alike; the names of all kinds of files are compared, whatever they begin with."""
    assert asked("losing").stderr.rstrip().endswith("(did you mean closing or casing or coating?)")


@pytest.mark.parametrize(("key", "near"), [("shel", "shell"), ("coatng", "coating"), ("material.F", "material")])
def test_a_mistyped_key_is_offered(key, near):
    result = asked(key)
    assert result.exit_code == 2
    assert near in result.stderr.partition("did you mean")[2]
