"""Sectors of bladed disks from sections: the whole wheel's modes, faces that follow the camber, invalid disks."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main as casingfem
from casingfem.errors import ModelError

SCENES = Path(__file__).parents[4] / "data" / "scenes"
STEEL = cf.Material(E=180e9, nu=0.3, rho=8000.0)
RING = cf.imported.DiskRing(bore=0.12, front=4e-3, rear=4e-3, cells_around=2, cells_radial=1)
BLADES = 36


def sections(rotor="rotor37"):
    return cf.imported.BladeSections.from_csv(SCENES / rotor / "sections.csv")


def wheel(mesh, sectors=BLADES):
    part = cf.Solid(mesh=mesh, material=STEEL, supports={"bore": cf.Clamped()})
    return cf.imported.CyclicSector(structure=part, sectors=sectors, faces=("low", "high"))


@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
def test_modes_by_diameters_are_those_of_the_whole_wheel():
    blades, ring = 22, replace(RING, bore=0.06)
    sector = wheel(sections("rotor67").sector(blades, ring, cells=(3, 1, 1)), blades)
    waves = cf.modal.cyclic_modes(sector, 1)
    single = np.sort(np.repeat(waves.freq, [sector.count(n) for n in waves.nodal_diameters.tolist()]))
    whole = cf.modes(cf.modal.wheel_modes(waves).structure, blades)
    assert len(single) == blades
    assert np.ptp(single) > 1e-3 * single[0]  # the disk couples the blades
    assert whole.freq == pytest.approx(single, rel=1e-7)


def test_root_wider_than_the_pitch_lies_between_the_faces_of_its_sector():
    mesh = sections().sector(BLADES, RING, cells=(8, 2, 1))
    angle = np.degrees(np.arctan2(mesh.points[:, 1], mesh.points[:, 0]))
    root = mesh.groups["blade"].nodes
    root = root[np.hypot(*mesh.points[root, :2].T) < 0.19]
    pitch = 360.0 / BLADES
    assert np.ptp(angle[root]) > pitch
    low, high = (mesh.groups[name].nodes for name in ("low", "high"))
    assert np.ptp(angle[low]) > 0.8 * pitch  # the faces follow the camber
    z = mesh.points[:, 2]
    for at in root:
        nearest = low[np.abs(z[low] - z[at]).argmin()], high[np.abs(z[high] - z[at]).argmin()]
        assert angle[nearest[0]] < angle[at] < angle[nearest[1]]


@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
@pytest.mark.parametrize("rotor", ["rotor37", "rotor67"])
def test_blade_on_a_stiff_disk_has_the_frequencies_of_the_clamped_blade(rotor):
    blades, bore = (36, 0.12) if rotor == "rotor37" else (22, 0.06)
    blade = sections(rotor)
    mesh = blade.sector(blades, replace(RING, bore=bore), cells=(6, 4, 1))
    own = np.setdiff1d(np.arange(len(mesh.cells)), mesh.groups["blade"].cells)
    ring = cf.imported.Group(nodes=np.unique(mesh.cells[own]), cells=own)
    mesh = replace(mesh, groups={**mesh.groups, "ring": ring})
    stiff = cf.Material(E=1e5 * STEEL.E, nu=0.3, rho=1.0)
    part = cf.Solid(mesh=mesh, material=STEEL, materials={"ring": stiff}, supports={"bore": cf.Clamped()})
    sector = cf.imported.CyclicSector(structure=part, sectors=blades, faces=("low", "high"))
    held = cf.Solid(mesh=blade.mesh(cells=(6, 4, 1)), material=STEEL, supports={"root": cf.Clamped()})
    assert cf.modal.cyclic_modes(sector, 3, diameters=[3]).freq == pytest.approx(cf.modes(held, 3).freq, rel=1e-4)


@pytest.mark.parametrize(
    ("change", "sectors", "words"),
    [
        ({"bore": 0.19}, 36, "disk.bore: found 0.19 m, expected less than the hub's 0.1779 m"),
        ({"front": 0.0}, 36, "disk.front: found 0.0 m, expected a length above 0"),
        ({"cells_around": 1}, 36, "disk.cells_around: found 1, expected a whole number of 2"),
        ({}, 400, "a root that is .* degrees thick around, expected less than the pitch, 0.9"),
    ],
)
def test_disk_that_does_not_fit_is_refused(change, sectors, words):
    with pytest.raises(ModelError, match=words):
        sections().sector(sectors, replace(RING, **change), cells=(4, 2, 1))


def test_study_of_a_disk_without_a_wheel_is_refused(tmp_path):
    text = (SCENES / "rotor37" / "wheel.toml").read_text()
    (tmp_path / "sections.csv").write_bytes((SCENES / "rotor37" / "sections.csv").read_bytes())
    file = tmp_path / "wheel.toml"
    file.write_text(text[: text.index("[cyclic]")] + text[text.index("[modes]") :])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = CliRunner().invoke(casingfem, ["modes", str(file)])
    assert result.exit_code != 0
    assert "solid.disk: found a disk without [cyclic], expected [cyclic] with sectors" in result.output
