"""Scenes whose tables contradict each other: the message has the file, the key and what was found and expected."""

from pathlib import Path

import pytest
from click.testing import CliRunner

import contact as ct
from casingfem.cli import main

SCENES = Path(__file__).parents[3] / "data" / "scenes"
RIGID = "blade_off/rigid.toml"
CASING = (
    "[casing]\nradius = 0.25\nmass = 20.0\nstiffness = 2e7\nzeta = 0.1\n[tips]\ncount = 12\n[contact]\n"
    "clearance = 5e-4\nfriction = 0.1\nlost = [0]\n"
)
LAW = '[law]\nkind = "hertz"\nk = 2e7\nexponent = 1.0\n'
REFUSED = {
    "tips of both kinds": (
        RIGID, [("[contact]\n", '[[blade]]\nbasis = "b.npz"\n[contact]\n')],
        "[tips] found with [[blade]], expected one of them",
    ),
    "a law without a casing": (RIGID, [(CASING, "")], "[law] found without [casing], expected both"),
    "a spin without a casing": (RIGID, [(CASING, ""), (LAW, "")], "[spin] found without [casing], expected both"),
    "blades that move along the axis": (
        RIGID, [("[tips]\ncount = 12\n", '[[blade]]\nbasis = "b.npz"\naxial = true\n')],
        "blade.axial = true found on a rotor, expected false: the disk does not move along the axis",
    ),
    "no blade left": (
        RIGID, [("count = 12", "count = 2"), ("lost = [0]", "lost = [0, 1]")],
        "contact.lost: found all 2 blades, expected one or more left",
    ),
    "a blade that is not there": (
        RIGID, [("count = 12", "count = 2"), ("lost = [0]", "lost = [2]")],
        "contact.lost: found blade 2, expected 0 to 1",
    ),
    "two limits of a motion": (
        RIGID, [("zeta = 0.05\n", "zeta = 0.05\nlimit = 1e-3\n")],
        "rotor.limit found with [casing], expected none: the radius of the casing limits the motion",
    ),
    "tangents of some contacts": (
        "coulomb_oscillator.toml", [("[ground]", '[[contact]]\nnormal = "y"\ntangent = []\n[ground]')],
        "contacts with different numbers of tangents found, expected 0, 1 or 2 in all",
    ),
    "a scheme of steps for modes": (
        "cantilever_on_stop.toml", [('kind = "exact-modal"\nlaw = "forward"\nmodes = 20', 'kind = "newmark"')],
        "scheme.kind 'newmark' found, expected one of 'exact-modal'",
    ),
}  # fmt: skip
COMMANDS = {
    "an empty list of values": (
        "sweep", "two_rods_sweep.toml", [("values = [50, 100, 200]", "values = []")],
        "sweep.vary[2]: values: found none, expected at least one",
    ),
    "steps of random values": (
        "sweep", "two_rods_sweep.toml", [('kind = "grid"', 'kind = "random"\ndraws = 3\nseed = 1')],
        "sweep: rod[1].velocity: steps found with kind = 'random', expected only from and to",
    ),
    "tangents of some contacts": (
        "cycles", "cycles/bouncing_ball.toml",
        [("[drive] ", '[[contact]]\nnormal = "y"\ntangent = "y"\nrestitution = 0.5\n[drive] ')],
        "contacts with and without tangent found, expected a tangent in all or none",
    ),
    "a range of speeds from rest": (
        "stability", RIGID, [("rpm = 4200.0", "rpm = 4200.0\nscan = {from_hz = 0.0, to_hz = 10.0, steps = 5}")],
        "speed.scan.from_hz: found 0 Hz, expected a speed above 0",
    ),
    "a blade that lies flat": (
        "stability", "pair.toml", [("lean_deg = 0.0", "lean_deg = 95.0")],
        "contact.lean_deg: found 95.0, expected less than 90 (lean of the blade",
    ),
    "a pair of no nodal diameter": (
        "stability", "pair.toml", [("n = 8", "n = 0")],
        "casing.n: found 0, expected greater than or equal to 1 (number of nodal diameters)",
    ),
}  # fmt: skip


def changed(name, pairs, folder):
    """A shipped scene with some lines replaced."""
    text = (SCENES / name).read_text(encoding="utf-8")
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("what", REFUSED)
def test_scenes_that_contradict_themselves_are_refused(what, tmp_path):
    name, pairs, words = REFUSED[what]
    path = changed(name, pairs, tmp_path)
    with pytest.raises(ct.scene.SceneError) as caught:
        ct.load_scene(path)
    assert f"{path}: {words}" in str(caught.value)


@pytest.mark.parametrize("what", COMMANDS)
def test_commands_refuse_scenes_that_contradict_themselves(what, tmp_path):
    verb, name, pairs, words = COMMANDS[what]
    path = changed(name, pairs, tmp_path)
    answer = CliRunner().invoke(main, [verb, str(path)])
    assert answer.exit_code == 2
    assert f"{path}: {words}" in answer.output
