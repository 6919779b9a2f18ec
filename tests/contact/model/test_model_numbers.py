"""Numbers held: rubs at rest under gravity and whirl, tables of rims and tips, bodies from rods, rings and matrices."""

import numpy as np
import pytest

import contact as ct
from tests.contact.model.test_body_matrices import compliance, rod
from tests.probed import probed


def test_numbers_of_bodies(held):
    thin = ct.bodies.ThinRing(radius=0.502, width=0.02, height=0.005, E=210e9, rho=7800.0, k_r=1e6, k_t=1e5, zeta=0.01)
    disk = ct.gaps.BladedDisk(
        blades=7, freq_hz=100.0, modal_mass=0.4, coupling=0.05, mistuning=np.linspace(-0.02, 0.03, 7)
    )
    pair = ct.gaps.pair_rim(ct.gaps.ModalPair(n=3, freq_hz=290.0, modal_mass=2.0), radius=0.5)
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
            f"crossed {name}": probed((body.rows / (1.0 + body.omega**2)) @ body.rows.T),
        }
    held(1e-5, **columns, tuned=disk.tuned_hz())


@pytest.mark.parametrize("fixed", [{1}, set()], ids=["held", "free"])
def test_numbers_of_matrices(fixed, held):
    M, K, dofs, points = rod(12, fixed)
    body = ct.ModalBody.from_matrices(M, K, dofs=dofs, points=points, contact=[5, 13], modes=4)
    held(omega=body.omega, S=body.S, squares=np.sum(body.rows**2, axis=0), compliance=compliance(body))
