"""Pieces of a tip with the directions of the machine: radial, tangential, axial at each piece."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main as casingfem
from casingfem.errors import ModelError

DATA = Path(__file__).parents[3] / "data"
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
Z = (0.0, 0.0, 1.0)


def solid(mesh):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.Clamped()})


def rotor37(cells=(6, 4, 1)):
    return cf.imported.BladeSections.from_csv(DATA / "scenes" / "rotor37" / "sections.csv").mesh(cells)


def test_directions_turn_with_the_blade_and_places_say_where_the_pieces_are():
    mesh = rotor37()
    c, s = np.cos(0.7), np.sin(0.7)
    turned = replace(mesh, points=mesh.points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]))
    tip = cf.TipNodes("tip", 3, axis=Z)
    one, other = (cf.reduce(solid(m), tip, modes=4) for m in (mesh, turned))
    assert other.compliance == pytest.approx(one.compliance, rel=1e-7, abs=1e-7 * np.abs(one.compliance).max())
    places = np.array(one.provenance["places"])
    assert np.array(other.provenance["places"]) == pytest.approx(places, abs=1e-9)
    assert (np.diff(places[:, 0]) > 0.0).all()  # along the axis
    assert (np.diff(places[:, 1]) < 0.0).all()  # the tip is a cone
    assert places[:, 1].max() == pytest.approx(0.25045, abs=1e-4)
    assert abs(places[1, 2]) < 1.0 < places[2, 2]


def test_on_a_straight_tip_they_are_those_of_the_tip_itself():
    r = np.array([[0.20], [0.21], [0.24]])
    z, r = np.linspace(0.0, 0.03, 7) + 0.0 * r, r + np.zeros(7)
    mesh = cf.imported.BladeSections.cylindrical(z, r, 0.0 * z - 0.005, 0.0 * z + 0.005).mesh((4, 3, 1))
    own, machine = (cf.reduce(solid(mesh), cf.TipNodes("tip", 2, axis=axis), modes=3) for axis in (None, Z))
    assert np.abs(machine.compliance) == pytest.approx(
        np.abs(own.compliance), rel=1e-6, abs=1e-6 * own.compliance.max()
    )
    directions = machine.provenance["directions"]
    assert [directions[name] for name in ("span", "flap", "chord")] == [
        pytest.approx(unit, abs=1e-12) for unit in np.eye(3).tolist()
    ]


def test_a_tip_on_the_axis_and_one_on_a_chart_are_refused():
    with pytest.raises(ModelError, match="interface-axis"):
        cf.reduce(cf.Shell(chart=cf.Plate(length=0.1, width=0.04), thickness=4e-3, material=STEEL,
                           supports={"root": cf.Clamped()}), cf.TipNodes("tip", 2, axis=Z), modes=2)  # fmt: skip
    r = np.array([[0.20], [0.24]]) + np.zeros(7)
    z = np.linspace(0.0, 0.03, 7) + 0.0 * r
    mesh = cf.imported.BladeSections.cylindrical(z, r, 0.0 * z - 0.005, 0.0 * z + 0.005).mesh((2, 2, 1))
    with pytest.raises(ModelError, match="interface-axis"):
        cf.reduce(solid(mesh), cf.TipNodes("tip", 1, axis=(1.0, 0.0, 0.0), point=(0.0, 0.0, 0.015)), modes=2)


@pytest.mark.parametrize(
    ("key", "message"), [("n_max = 4", "reduce.n_max"), ("point = [0.0, 0.0, 0.0]", "reduce.point")]
)
def test_keys_of_a_rim_beside_pieces_are_refused(tmp_path, key, message):
    (tmp_path / "sections.csv").write_bytes((DATA / "scenes" / "rotor37" / "sections.csv").read_bytes())
    (tmp_path / "blade.toml").write_text(
        '[material]\nE = 180e9\nnu = 0.3\nrho = 8000.0\n[solid]\nsections = "sections.csv"\ncells = [4, 3, 1]\n'
        f'[support.root]\nkind = "clamped"\n[reduce]\ninterface = "tip"\nnodes = 3\nmodes = 2\n{key}\n'
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        ran = CliRunner().invoke(casingfem, ["reduce", str(tmp_path / "blade.toml")])
    assert ran.exit_code == 2
    assert message in ran.output
