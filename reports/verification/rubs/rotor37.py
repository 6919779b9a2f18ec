"""NASA rotor 37 in a steel cylinder of 4 mm: a blade of published geometry, its basis and its scene.

`reports.verification.rubs.beside` runs the scene: the tip 20 um from a steel cylinder that is 50 um out of round with
four lobes. The blade's frequencies are compared in `reports.verification.modes.nasa_rotors`.
"""

import math

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.modal.interface.mesh_rows import facets_of, tip_frame
from reports.verification.modes import nasa_rotors

NAME = "rotor37"
DESIGN = nasa_rotors.RPM[NAME] / 60.0  # turns/s
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
CELLS, COARSE = nasa_rotors.CELLS, nasa_rotors.COARSE
WALL, HEIGHT = 4e-3, 0.12  # m


def lean_deg(part: cf.Solid) -> float:
    """Angle of the radius at the tip from the tip's span towards its flap [deg]."""
    system = part.assembled()
    facets = facets_of(system, "tip")
    span, flap, _ = tip_frame(system, facets, "tip")
    middle = np.average(facets.x, axis=0, weights=facets.weight) * [1.0, 1.0, 0.0]
    return math.degrees(math.atan2(flap @ middle, span @ middle))


def scene(cells: tuple[int, int, int] = CELLS, speed_hz: float = 298.0) -> ct.Scene:
    """Scene of the tip and the cylinder, without friction."""
    part = nasa_rotors.blade(NAME, cells, 60.0 * DESIGN)
    tip_nodes = part.mesh.points[part.mesh.groups["tip"].nodes]
    radius = float(np.hypot(*tip_nodes[:, :2].T).mean())
    cylinder = cf.Shell(
        chart=cf.Cylinder(radius=radius, height=HEIGHT), thickness=WALL, material=STEEL,
        supports={"base": cf.Clamped()}, mesh=cf.ShellMesh(order=6, rows=2, around=24),
    )  # fmt: skip
    tip = cf.reduce(part, cf.Tip("tip"), modes=4, zeta=1e-3)
    rim = cf.reduce(cylinder, cf.Rim("top", n_max=12), modes=26, zeta=2e-3)
    rub = ct.RotatingRim(
        ct.ModalBody.of(rim), ct.ModalBody.of(tip), clearance=2e-5, speed_hz=speed_hz, lean_deg=lean_deg(part),
        out_of_roundness=[{"p": 4, "cos": 5e-5}],
    )  # fmt: skip
    return ct.Scene(what=rub, law=ct.Unilateral(), t_end=0.2, dt=1e-5)
