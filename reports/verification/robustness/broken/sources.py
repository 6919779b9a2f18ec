"""Whole studies and scenes of every kind, whose keys `keys.py` breaks one at a time; which keys may be left out."""

from typing import NamedTuple

from reports.tables import DATA
from reports.verification.robustness.diverging import DISK, PATCH, RIM, RUB

MATERIAL = "[material]\nE = 210e9\nnu = 0.3\nrho = 7800.0\n"
CLAMPED = '[support.root]\nkind = "clamped"\n'


class Source(NamedTuple):
    """A file: its reader and its text."""

    name: str
    reader: str
    text: str


def data(name: str) -> str:
    """A file of the project's own, without its comments."""
    lines = (DATA / name).read_text(encoding="utf-8").splitlines()
    return "\n".join(kept for line in lines if (kept := line.partition("#")[0].rstrip())) + "\n"


CASING = f"""{MATERIAL}[chart]
kind = "frustum"
r_base = 0.5
r_top = 0.45
height = 0.25
[shell]
thickness = 3e-3
[[strip]]
from = 0.2
to = 0.25
thickness = 6e-3
[[imperfection]]
of = "radius"
survey = "survey.csv"
n_max = 4
degree = 1
[support.base]
kind = "ring"
width = 0.04
depth = 0.04
offset = [0.0, -0.02]
[support.base.support]
kind = "bolts"
count = 24
k = 2e8
k_rot = 2e5
[modes]
count = 4
[mesh]
order = 6
around = 24
[update]
table = "table.csv"
[[update.parameter]]
name = "material.E"
lower = 1e11
upper = 3e11
[reduce]
interface = "top"
n_max = 4
modes = 8
zeta = 0.002
"""
RANDOM = f"""{MATERIAL}[chart]
kind = "cylinder"
radius = 0.5
height = 0.25
[shell]
thickness = 3e-3
[[imperfection]]
of = "radius"
random = "example"
seed = 7
scale = 0.3
p_max = 12
[support.base]
kind = "elastic"
k_face = 3e12
[[stiffener]]
at = 0.1
width = 0.01
depth = 0.02
offset = [0.01, 0.0]
[modes]
count = 4
"""
BLADE = data("studies/tapered_blade.toml")
TURNING = data("studies/rotating_blade.toml")
PANEL = f"""{MATERIAL}[chart]
kind = "panel"
radius = 0.5
length = 0.2
angle = 0.5
[shell]
thickness = 2e-3
{CLAMPED}[modes]
count = 4
"""
TWISTED = f"""{MATERIAL}[chart]
kind = "twisted-plate"
length = 0.2
width = 0.1
twist_deg = 30.0
[shell]
thickness = 2e-3
{CLAMPED}[modes]
count = 4
"""
WHEEL = f"""{MATERIAL}[solid]
mesh = "cyclic.inp"
[cyclic]
sectors = 12
faces = ["low", "high"]
mistuning = "blades.csv"
[modes]
count = 4
"""
RIG = (
    data("studies/rig_test.toml")
    .replace("../surveys/rig_casing.csv", "survey.csv")
    .replace("n_max = 26\ndegree = 2", "n_max = 4\ndegree = 1")
)
SWEEP = data("scenes/two_rods_sweep.toml")
SOURCES = (
    Source("casing", "study", CASING), Source("random casing", "study", RANDOM), Source("blade", "study", BLADE),
    Source("turning blade", "study", TURNING), Source("panel", "study", PANEL), Source("twisted", "study", TWISTED),
    Source("wheel", "study", WHEEL), Source("rig", "study", RIG),
    Source("rim", "scene", RIM), Source("rub", "scene", RUB), Source("disk", "scene", DISK),
    Source("patch", "scene", PATCH), Source("cantilever", "scene", data("scenes/cantilever_on_stop.toml")),
    Source("hinged beam", "scene", data("scenes/rotating_beam.toml")),
    Source("rods", "scene", data("scenes/unequal_rods.toml")),
    Source("ball", "scene", data("scenes/bouncing_ball.toml")),
    Source("pair", "stability", data("scenes/pair.toml")), Source("sweep", "sweep", SWEEP),
    Source("cycles", "cycles", data("scenes/cycles/rod_on_obstacle.toml")),
)  # fmt: skip
