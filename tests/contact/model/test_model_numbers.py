"""Numbers held: rubs at rest under gravity and whirl, tables of rims and tips, bodies from rods, rings and matrices."""

import numpy as np
import pytest

import contact as ct
from contact.model.gaps.bladed_disk import pair_rim
from contact.model.gaps.modal_system import rim_system
from contact.model.gaps.rub_system import axial_load, force_at_start, plane_participation, rub_system
from tests.contact.model.test_body_matrices import compliance, rod
from tests.contact.model.test_rub_forces import rub as turning
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips
from tests.probed import probed

PULLS = (
    ct.gaps.BodyForce.gravity(turning="casing", down_deg=30.0, axial=0.5),
    ct.gaps.BodyForce.of_whirl(ct.gaps.Whirl(amplitude=1e-5, per_rev=1.0, phase_deg=20.0), "blades", turning="casing"),
)


def numbers_of(value):
    """Arrays of a table, whatever it calls them."""
    found = {name: getattr(value, name) for name in value.__dataclass_fields__}
    return {name: a for name, a in found.items() if isinstance(a, np.ndarray) and a.size and a.dtype.kind in "fi"}


def test_numbers_of_rubs_at_rest(held):
    scene = turning(PULLS)
    rest = ct.gaps.settled(scene)
    held(
        load=force_at_start(scene),
        axial=axial_load(scene),
        plane=plane_participation(scene),
        casing=rest.casing_start.displacement,
        blade=rest.blade_starts[0].displacement,
    )


def test_numbers_of_rub_tables(held):
    scene = ct.Rub(
        rim3(),
        (nodes(2), nodes(1, seed=6)),
        [*tips(2), *tips(1, blade=1, angle=190.0)],
        clearance=-3e-5,
        speed=ct.Speed(time=[0.0, 0.1], hz=[3.0, 5.0]),
        profile=ct.RimProfile.fourier([{"p": 2, "cos": 2e-5}]),
    )
    found = {}
    for d in (1, 2, 3):
        system = rub_system(scene, d)
        tables = {name: np.ravel(np.asarray(numbers)) for name, numbers in numbers_of(system).items()}
        found |= {f"{name} {d}": table[:: 1 + table.size // 200] for name, table in tables.items()}
    held(**found)


def test_numbers_of_rim_tables(held):
    rim = ct.RotatingRim(
        ring(imperfect=0.05),
        blade(),
        clearance=-1e-5,
        speed_hz=5.0,
        lean_deg=25.0,
        angle_deg=13.0,
        out_of_roundness=[{"p": 2, "cos": 2e-5}, {"p": 3, "sin": 1e-5}],
    )
    system = rim_system(rim)
    held(**numbers_of(system), **{f"table {name}": a for name, a in numbers_of(system.table).items()})


def test_numbers_of_bodies(held):
    thin = ct.bodies.ThinRing(radius=0.502, width=0.02, height=0.005, E=210e9, rho=7800.0, k_r=1e6, k_t=1e5, zeta=0.01)
    disk = ct.BladedDisk(blades=7, freq_hz=100.0, modal_mass=0.4, coupling=0.05, mistuning=np.linspace(-0.02, 0.03, 7))
    pair = pair_rim(ct.gaps.ModalPair(n=3, freq_hz=290.0, modal_mass=2.0), radius=0.5)
    bars = [
        ct.gaps.rod_modes(ct.Rod(length=2.0, area=0.7, E=1.5, rho=1.2, fixed=fixed, end_mass=mass), modes=6, end="left")
        for fixed, mass in (("none", 0.0), ("right", 0.0))
    ]
    found = {
        "ring": ct.bodies.ring_modes(thin, 6),
        "elements": ct.bodies.ring_elements(thin, 12, 4),
        "disk": disk.body(),
        "pair": pair,
    }
    found |= {f"bar {k}": bar for k, bar in enumerate(bars)}
    columns = {}
    for name, body in found.items():
        columns |= {
            f"omega {name}": body.omega,
            f"zeta {name}": body.zeta,
            f"S {name}": probed(body.S),
            f"size {name}": np.sort(np.sum(body.rows**2, axis=0)),
        }
    held(1e-5, **columns, tuned=disk.tuned_hz())


@pytest.mark.parametrize("fixed", [{1}, set()], ids=["held", "free"])
def test_numbers_of_matrices(fixed, held):
    M, K, dofs, points = rod(12, fixed)
    body = ct.ModalBody.from_matrices(M, K, dofs=dofs, points=points, contact=[5, 13], modes=4)
    held(omega=body.omega, S=body.S, squares=np.sum(body.rows**2, axis=0), compliance=compliance(body))
