"""Numbers held: surfaces with their derivatives, directions along which springs act, laws along and across."""

import numpy as np

import casingfem as cf
from tests.probed import numbers_in

PIECES = cf.geometry.PiecewiseMeridian(
    start=(0.3, 0.0),
    fillet=0.01,
    pieces=(
        cf.geometry.Piece(to=(0.3, 0.1)),
        cf.geometry.Piece(to=(0.25, 0.2)),
        cf.geometry.Piece(to=(0.28, 0.3), radius=0.2),
    ),
)
WHOLE = cf.Blade(
    length=0.2, chord=(0.12, 0.1, 0.09), camber=(0.6, -0.1), twist=(0.1, 0.6), sweep=(0.0, 0.0, 0.02), lean=(0.0, 0.01)
)
CHARTS = {
    "cylinder": cf.Cylinder(radius=0.3, height=0.2),
    "frustum": cf.Frustum(r_base=0.5, r_top=0.45, height=0.25),
    "panel": cf.Panel(radius=0.3, length=0.2, angle=0.5),
    "plate": cf.Plate(length=0.2, width=0.1),
    "twisted": cf.geometry.TwistedPlate(length=0.2, width=0.1, twist=0.8),
    "blade": WHOLE,
    "arc": cf.Revolved(profile=cf.geometry.Arc(radius=0.3, start=-0.4, end=1.1, r0=0.05, z0=0.1)),
    "pieces": cf.Revolved(profile=PIECES),
    "part": cf.geometry.RevolvedPanel(profile=PIECES, angle=0.7),
}


def test_numbers_of_laws(held):
    plate = CHARTS["plate"]
    turning = cf.Rotation.of_blade(WHOLE, omega=300.0, hub_radius=0.2, stagger=0.4)
    taper = cf.Taper(along=(1.0, 0.8, 0.7), across=(0.9, 1.0, 0.6))
    a, b = np.linspace(0.0, 0.2, 9), np.linspace(-0.05, 0.05, 9)
    held(1e-8, factor=taper.factor(plate.bounds, a, b), lowest=[taper.lowest], turning=list(numbers_in(turning)))
