"""Small valid files with the tables of study.toml and scene.toml, each with the command that runs it."""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from click.testing import CliRunner

from casingfem.cli import main as casingfem
from reports.verification.robustness.diverging import COATING, bodies
from reports.verification.robustness.mesh_samples import write_meshes
from reports.verification.robustness.sample_files import write_tests

__all__ = ["BASES", "Base", "write_companions"]

HEAD = "[material]\nE = 2e11\nnu = 0.3\nrho = 7800.0\n[modes]\ncount = 3\n"
COARSE = "[mesh]\norder = 4\nrows = 1\naround = 9\n"
OPEN = '[mesh]\norder = 4\nrows = 1\n[shell]\nthickness = 2e-3\n[support.root]\nkind = "clamped"\n'
WALL = "[shell]\nthickness = 2e-3\n"
CYLINDER = WALL + '[chart]\nkind = "cylinder"\nradius = 0.2\nheight = 0.2\n'
HELD = '[support.base]\nkind = "clamped"\n'
CASING = HEAD + COARSE + CYLINDER
PLATE = '[chart]\nkind = "plate"\nlength = 0.11\nwidth = 0.04\n'
BRICKS = HEAD + '[solid]\nmesh = "mesh.inp"\nscale = 1.0\n'
RIM_RUN = 'kind = "rim"\nt_end = 2e-3\n'
SPEED = '[speed]\nturning = "blades"\nhz = 20.0\nscan = {from_hz = 5.0, to_hz = 40.0, steps = 8}\n'
STEP = '[scheme]\nkind = "exact-modal"\ndt = 2e-5\n'
TURNING = '[speed]\nturning = "blades"\nfrom_hz = 18.0\nto_hz = 19.0\n'
TURNING += "[continuation]\nlongest_step = 0.5\nmost_points = 2\nlooks = 8\n"
ONE_BLADE = '[casing]\nbasis = "casing.npz"\n[blade]\nbasis = "blade.npz"\nlean_deg = 10.0\n'
BLADES = ONE_BLADE.replace("[blade]", "thickness = 4e-3\n[[blade]]")
REDUCED = BLADES.replace("casing.npz", "reduced casing.npz").replace("blade.npz", "reduced blade.npz")
GAP = "[contact]\nclearance = 1e-4\nfriction = 0.1\n"
ROUGH = (
    "out_of_roundness = [{p = 2, cos = 2e-4}]\n"
    "random_out_of_roundness = {seed = 1, spectrum = [{p = 3, median = 1e-6, high = 2e-6}]}\n"
)
OVAL = "out_of_roundness = [{p = 2, cos = 5e-5}]\n"
DISK = """[casing.pair]
n = 3
freq_hz = 290.0
modal_mass = 2.0
radius = 0.5
kick = 1e-4
[disk]
blades = 6
freq_hz = 115.0
modal_mass = 0.1
compliance = 5e-5
lean_deg = 20.0
"""
BEAM = "length = 0.5\nwidth = 0.02\nheight = 0.005\nE = 210e9\nrho = 7800.0\n"
RODS = """[scene]
kind = "rods"
t_end = 1e-4
[[rod]]
length = 0.1
area = 1e-4
E = 2e11
rho = 7800.0
elements = 4
velocity = 1.0
[[mass]]
mass = 1.0
x = 0.11
velocity = -1.0
stiffness = 1e4
[wall]
x = 0.2
[scheme]
kind = "forward-lagrange"
dt = 1e-6
[record]
every = 10
"""
PATCH = """[body]
omega = [40.0, 60.0]
zeta = [0.01, 0.01]
channels = ["x", "y"]
rows = [[1.0, 0.0], [0.0, 1.0]]
load = {y = -1.0}
[[contact]]
normal = "y"
[ground]
friction = 0.3
"""
RIG = """[rig]
seed = 1
zeta = 0.01
[[rig.drive]]
height = 0.1
[[rig.sensor]]
height = 0.1
count = 8
[rig.test]
kind = "exact"
band_hz = [500.0, 700.0]
resolution_hz = 2.0
snr_db = 60.0
troubles = {colour = 0.0}
"""
SCAN = "[rig.scan]\nheight = 0.1\ntones_hz = [300.0]\nmirror_hz = 4.0\nseconds = 0.5\nfs = 2000.0\norders = 3\n"
UPDATE = """[update]
table = "cylinder/modes.csv"
[[update.parameter]]
name = "material.E"
lower = 1e11
upper = 3e11
"""
SWEEP = '[sweep]\nkind = "grid"\n[[sweep.vary]]\nkey = "mass[1].velocity"\nvalues = [-0.5, -1.0]\n'


ROTOR = '[scene]\nkind = "rotor"\nt_end = 0.02\n'
JEFFCOTT = ROTOR + "[rotor]\nmass = 10.0\nstiffness = 4e6\nzeta = 0.02\nzeta_internal = 0.01\n"
SHAFT = (
    ROTOR
    + "[rotor]\nmodes = 6\n[[shaft]]\nlength = 0.5\ndiameter = 0.02\ninner_diameter = 0.005\nE = 210e9\nrho = 7800.0\n"
    + "nu = 0.3\nelements = 4\n[[disk]]\nat = 0.25\nmass = 2.0\npolar = 4e-3\ndiametral = 2e-3\n"
    + "[[bearing]]\nat = 0.0\nkxx = 1e7\nkyy = 2e7\nkxy = 1e5\nkyx = -1e5\ncxx = 100.0\ncyy = 100.0\ncxy = 1.0\n"
    + "cyx = -1.0\nk_tilt = 1e3\n[[bearing]]\nat = 0.5\nkxx = 1e7\nkyy = 2e7\n[gravity]\nsettled = true\n"
)
TURNS = (
    "[unbalance]\nmoment = 1e-3\nrelease = {time = 0.01, moment = 5e-3, angle_deg = 90.0}\n[speed]\nhz = 80.0\n"
    + '[scheme]\nkind = "exact-modal"\ndt = 1e-4\n'
)


@dataclass(frozen=True, slots=True)
class Base:
    """A file, the command that runs it, and the name of its model as `casingfem schema` takes it."""

    name: str
    command: str
    root: str
    text: str

    @property
    def data(self) -> dict[str, Any]:
        """The tables of the file."""
        return tomllib.loads(self.text)


def studies() -> list[Base]:
    """Charts, walls, supports, imperfections and tasks."""
    loose = "count = 6\nk = 1e7\nwidth_deg = 10.0\nloose = [{bolt = 1, factor = 0.5}]\n"
    around = "k_r = 1e8\nk_theta = 1e8\nk_z = 1e8\n"
    ring = '[support.base]\nkind = "ring"\nwidth = 0.01\ndepth = 0.01\noffset = [0.0, -0.005]\n[support.base.support]\n'
    plies = (
        'wall = "linear"\nplies = [{thickness = 2e-3, angle_deg = 30.0, lamina = "tape"}]\n'
        "lamina = {tape = {E1 = 1e11, E2 = 1e10, nu12 = 0.3, G12 = 5e9, G13 = 5e9, G23 = 4e9, rho = 1600.0}}\n"
    )
    texts = {
        "cylinder": CASING + HELD + "[checks]\nallow = []\n",
        "frustum": HEAD
        + COARSE.replace("rows = 1", "rows = [0.0, 0.25, 0.5, 1.0]")
        + WALL
        + '[chart]\nkind = "frustum"\nr_base = 0.2\nr_top = 0.18\nheight = 0.2\n'
        + HELD
        + "[taper]\nalong = [1.0, 1.1]\n[[strip]]\nfrom = 0.05\nto = 0.1\nthickness = 3e-3\n",
        "dome": HEAD + COARSE + WALL + '[chart]\nkind = "dome"\nradius = 0.3\nstart_deg = 0.0\nend_deg = 30.0\n' + HELD,
        "meridian": HEAD + "[mesh]\norder = 4\naround = 9\n" + WALL + HELD + '[chart]\nkind = "meridian"\n'
        "start = [0.2, 0.0]\npiece = [{to = [0.2, 0.1]}, {to = [0.15, 0.2], thickness = 2.5e-3, fillet = 0.01}]\n",
        "panel": HEAD + OPEN + '[chart]\nkind = "panel"\nradius = 0.2\nlength = 0.2\nangle = 1.0\n',
        "plate": HEAD + OPEN + PLATE + "[rotation]\nspeed_hz = 20.0\nhub_radius = 0.1\n[taper]\nacross = [1.0, 1.1]\n",
        "twisted": HEAD + OPEN + '[chart]\nkind = "twisted-plate"\nlength = 0.11\nwidth = 0.04\ntwist_deg = 20.0\n',
        "blade": HEAD + OPEN + '[chart]\nkind = "blade"\nlength = 0.11\nchord = [0.04, 0.03]\n',
        "plies": HEAD + (OPEN + PLATE).replace("thickness = 2e-3\n", "thickness = 2e-3\n" + plies),
        "elastic": CASING + '[support.base]\nkind = "elastic"\n' + around + "around = [{p = 2, cos = 0.1}]\n",
        "elastic by spring": CASING
        + '[support.base]\nkind = "elastic"\n'
        + around
        + "around = {k_r = [{p = 2, cos = 0.1}]}\n",
        "bolts": CASING + '[support.base]\nkind = "bolts"\n' + loose,
        "ring": CASING + ring + 'kind = "bolts"\n' + loose + '[[mass]]\nedge = "top"\nangle_deg = 10.0\nmass = 0.1\n',
        "ring on springs": CASING + ring + 'kind = "elastic"\n' + around,
        "diaphragm": CASING + '[support.base]\nkind = "shear-diaphragm"\n[support.top]\nkind = "symmetry"\n',
        "stiffener": CASING.replace("rows = 1", "rows = 2")
        + HELD
        + "[[stiffener]]\nat = 0.1\nwidth = 5e-3\ndepth = 5e-3\noffset = [4e-3, 0.0]\n",
        "harmonics": CASING + HELD + '[[imperfection]]\nof = "radius"\nharmonics = [{p = 4, cos = 1e-3}]\n',
        "random field": CASING
        + HELD
        + '[[imperfection]]\nof = "thickness"\nrandom = [{p = 2, median = 0.01, high = 0.02}]\nseed = 1\n',
        "survey": HEAD
        + COARSE
        + WALL.replace("2e-3", "2e-2")
        + '[chart]\nkind = "frustum"\nr_base = 0.5\nr_top = 0.46\nheight = 0.2\n'
        + HELD
        + '[[imperfection]]\nof = "radius"\nsurvey = "survey.csv"\nn_max = 4\ndegree = 1\n',
        "tied bricks": HEAD
        + '[solid]\nmesh = "untied.inp"\nscale = 1.0\n[[solid.tie]]\nfollower = "floor"\nmaster = "roof"\n',
        "bricks": BRICKS + '[support.root]\nkind = "fixed"\ndirections = ["x", "y", "z"]\n',
        "sector": HEAD + '[solid]\nmesh = "cyclic.inp"\n[cyclic]\nsectors = 12\nfaces = ["low", "high"]\n',
        "imported shell": HEAD + '[shell]\nmesh = "sector.inp"\nthickness = 2e-3\n',
    }
    reduced = '[reduce]\ninterface = "tip"\nmodes = 3\nzeta = 0.01\n'
    output = 'output = [{name = "u", at = [0.05, 0.0], direction = "normal"}]\n'
    return [
        *(Base(name, "modes", "study", text) for name, text in texts.items()),
        Base("reduce a blade", "reduce", "study", HEAD + OPEN + PLATE + reduced + output),
        Base(
            "reduce a casing", "reduce", "study", CASING + HELD + '[reduce]\ninterface = "top"\nn_max = 4\nmodes = 4\n'
        ),
        Base("update", "update", "study", CASING + HELD + UPDATE),
        Base("rig", "rig", "study", CASING + HELD + RIG),
        Base("rig with a scan", "rig", "study", CASING + HELD + RIG + SCAN),
    ]


def scenes() -> list[Base]:
    """Scenes of runs and of the other commands."""
    patched = '[scene]\nkind = "patch"\nt_end = 0.05\n' + PATCH.replace(
        '"y"\n', '"y"\ntangent = ["x"]\nslide = [1.0]\n'
    )
    rubbed = "[[whirl]]\namplitude = 1e-5\nper_rev = -1.0\n[closing]\nby = 1e-5\ntime_constant = 0.1\n[gravity]\n"
    node = 'node = [{span = "span", flap = "flap"}]\n'
    beam = (
        '[scene]\nkind = "beam"\nt_end = 1e-4\n[beam]\n'
        + BEAM
        + "elements = 4\ntorque = 1.0\n[circle]\nradius = 0.502\n"
    )
    euler = '[scheme]\nkind = "forward-lagrange"\ncourant = 0.5\n'
    rim = '[scene]\nkind = "rim"\n'
    driven = 'channel = "y"\namplitude = 10.0\nfrom_hz = 5.0\nto_hz = 5.5\n'
    basins = "[basins]\nat = 5.2\nstarts = 2\nseed = 1\nsettle = 3\n"
    disk = '[scene]\nkind = "disk"\nt_end = 2e-3\n'
    return [
        Base("rods", "contact", "rods", RODS + "[checks]\nallow = []\n"),
        Base(
            "rim", "rub", "rim", "[scene]\n" + RIM_RUN + ONE_BLADE + GAP + ROUGH + SPEED + STEP + COATING + "[record]\n"
        ),
        Base("rub", "rub", "rub", "[scene]\n" + RIM_RUN.replace("rim", "rub") + BLADES + node + GAP + SPEED + STEP),
        Base(
            "whirling rub",
            "rub",
            "rub",
            "[scene]\n" + RIM_RUN.replace("rim", "rub") + REDUCED + GAP + SPEED + STEP + rubbed,
        ),
        Base("disk", "rub", "disk", disk + DISK + GAP + SPEED + STEP),
        Base("rotor", "rub", "rotor", JEFFCOTT + TURNS),
        Base("rotor on bearings", "rub", "rotor", SHAFT + TURNS),
        Base("beam", "contact", "beam", beam + "offset = 0.001\n" + euler),
        Base(
            "beam in a ring",
            "contact",
            "beam",
            beam + euler + "[ring]\nwidth = 0.02\nheight = 0.005\nE = 210e9\nrho = 7800.0\nk_r = 1e7\nn_max = 2\n",
        ),
        Base(
            "cantilever",
            "contact",
            "cantilever",
            '[scene]\nkind = "cantilever"\nt_end = 1e-3\n[beam]\n' + BEAM + "zeta = 0.02\nload = 10.0\n[stop]\n"
            'clearance = 1e-3\n[scheme]\nkind = "exact-modal"\nlaw = "forward"\nmodes = 4\ndt = 2e-5\n',
        ),
        Base("patch", "contact", "patch", patched + '[scheme]\nkind = "exact-modal"\ndt = 1e-3\n'),
        Base(
            "pair",
            "stability",
            "pair",
            '[scene]\nkind = "pair"\n[casing]\nn = 8\nfreq_hz = 300.0\nmodal_mass = 1.5\n[blade]\nfreq_hz = 120.0\n'
            "modal_mass = 0.4\n[contact]\nstiffness = 1e4\n[speed]\nfrom_hz = 52.0\nto_hz = 54.0\nsteps = 8\n",
        ),
        Base("interactions", "interactions", "rim", "[scene]\n" + RIM_RUN + ONE_BLADE + GAP + SPEED + STEP),
        Base(
            "cycles",
            "cycles",
            "cycles",
            '[scene]\nkind = "patch"\n'
            + PATCH.replace("load = {y = -1.0}\n", "").replace(
                'normal = "y"', 'normal = "y"\ntangent = "x"\nslide = 1.0\nclearance = 1e-3\nstiffness = 1e4'
            )
            + "[drive]\n"
            + driven
            + basins
            + "[continuation]\nlongest_step = 0.5\nmost_points = 4\n",
        ),
        Base("cycles of a rim", "cycles", "cycles-rim", rim + ONE_BLADE + GAP + OVAL + TURNING),
        Base(
            "cycles over clearance",
            "cycles",
            "cycles-rim",
            rim
            + ONE_BLADE
            + GAP
            + OVAL
            + TURNING.replace("from_hz = 18.0\nto_hz = 19.0", "hz = 18.0")
            + "[vary]\nclearance = [1e-4, 1.1e-4]\n",
        ),
        Base("cycles of a rub", "cycles", "cycles-rub", rim.replace('"rim"', '"rub"') + BLADES + GAP + OVAL + TURNING),
        Base("cycles of a disk", "cycles", "cycles-disk", rim.replace('"rim"', '"disk"') + DISK + GAP + OVAL + TURNING),
        Base("sweep", "sweep", "sweep", RODS + SWEEP),
    ]


def write_companions(folder: Path) -> None:
    """Files that the studies and scenes name: bases, tables, meshes."""
    write_meshes(folder)
    write_tests(folder)
    bodies(folder)
    for base in BASES:
        if base.command == "reduce" or base.name == "cylinder":
            file = folder / f"{base.name.replace('reduce a', 'reduced')}.toml"
            file.write_text(base.text, encoding="utf-8")
            place = folder if base.command == "reduce" else folder / base.name
            CliRunner().invoke(casingfem, [base.command, str(file), "--out", str(place)], catch_exceptions=False)


BASES = (*studies(), *scenes())
