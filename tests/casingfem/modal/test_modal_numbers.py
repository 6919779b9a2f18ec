"""Numbers held: modes, bases, speeds, mistuning and changes of small structures.

Of mode shapes only what neither signs nor a turn within a perfect pair changes.
"""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.probed import numbers_of_result, probed

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
MESH = cf.ShellMesh(order=5, rows=1, around=9)
WAVES = cf.FourierField.of({4: 0.004, 6: (0.002, 0.001), 8: 0.002})
PLATE = cf.Plate(length=0.2, width=0.05)


def casing(**parts):
    own = {
        "chart": cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
        "thickness": 3e-3,
        "material": STEEL,
        "supports": {"base": cf.Clamped()},
        "mesh": MESH,
    }
    return cf.Shell(**{**own, **parts})


def blade(**parts):
    own = {
        "chart": PLATE,
        "thickness": 3e-3,
        "material": STEEL,
        "supports": {"root": cf.Clamped()},
        "mesh": cf.ShellMesh(order=5, rows=2, around=1),
    }
    return cf.Shell(**{**own, **parts})


def solid(**parts):
    mesh = cf.imported.grid_mesh(
        "hexahedron20",
        (4, 1, 1),
        lambda u: (u - [0.0, 0.5, 0.5]) * [0.2, 0.05, 0.01],
        groups={"root": (0, 0.0), "tip": (0, 1.0)},
    )
    return cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.Clamped()}, **parts)


def turning(part):
    return replace(part, rotation=cf.Rotation.of_blade(PLATE, omega=200.0, hub_radius=0.3, stagger=0.4))


@pytest.mark.slow
def test_numbers_of_a_rim(held):
    casings = {"free": casing(radius_defect=WAVES), "craig-bampton": casing(radius_defect=WAVES)}
    found = {}
    for method, shell in casings.items():
        made = cf.reduce(shell, cf.Rim("top", n_max=5), modes=7, method=method, zeta=0.003, recovery=True)
        found |= {
            f"omega {method}": made.omega,
            f"zeta {method}": made.zeta,
            f"compliance {method}": probed(made.compliance),
            f"squares {method}": np.sum(made.rows**2, axis=0),
            f"S {method}": probed(made.S),
            f"recovered {method}": np.sum(made.recovery**2, axis=0),
            f"crossed {method}": probed((made.recovery / made.omega**2) @ made.rows.T),
        }
    shape = cf.modal.out_of_roundness(casings["free"], cf.Rim("top", n_max=8))
    held(**found, shape=[value for term in shape for value in term.values()])


@pytest.mark.parametrize("name", ["tip", "nodes", "turning", "solid", "solid turning"])
def test_numbers_of_a_blade(name, held):
    part = solid() if "solid" in name else blade()
    part = turning(part) if "turning" in name else part
    outputs = (
        ()
        if "solid" in name
        else (
            cf.modal.Displacement(at=(0.1, 0.01), direction="z", name="u"),
            cf.modal.Strain(at=(0.02, 0.0), component="11", name="e"),
        )
    )
    interface = cf.Tip() if name == "tip" else cf.modal.AtNodes((20, 40)) if name == "solid" else cf.TipNodes("tip", 3)
    made = cf.reduce(part, interface, modes=4, outputs=outputs)
    more = {}
    if made.output_rows is not None and made.output_rows.size:
        more["outputs"] = np.sum(made.output_rows**2, axis=-1)
        more["seen"] = (made.output_rows / made.omega**2) @ made.rows.T
    if made.participation is not None:
        more["participation"] = np.abs(made.participation)
        more["pulled"] = (made.participation / made.omega**2) @ made.rows.T
    more |= numbers_of_result(made)
    held(1e-5, omega=made.omega, compliance=made.compliance, squares=np.sum(made.rows**2, axis=0), S=made.S, **more)


@pytest.mark.slow
@pytest.mark.parametrize("make", [blade, solid])
def test_numbers_of_a_blade_at_speed(make, held):
    found, waves = cf.campbell(turning(make()), [0.0, 100.0, 300.0], count=3), cf.whirl_modes(turning(make()), 3)
    held(
        freq=found.freq,
        southwell=found.southwell,
        overlap=found.overlap,
        whirl=waves.freq,
        fixed=waves.freq_fixed,
        sense=waves.sense,
        **numbers_of_result(found, "campbell "),
        **numbers_of_result(waves, "whirl "),
    )


def test_numbers_of_meetings(held):
    rings = {n: [300.0 + 10.0 * (n - 6) ** 2] for n in range(3, 10)}
    disk = cf.modal.DiskFrequencies(blades=12, freq={3: (110.0,), 4: (140.0,)})
    found = [
        cf.interactions(rings, at, speed_hz=(0.0, 200.0), turning=who)
        for at in ([120.0, 500.0], disk)
        for who in ("blade", "casing")
    ]
    held(
        **{
            f"{what} {k}": [getattr(c, what) for c in one.meetings]
            for k, one in enumerate(found)
            for what in ("n", "speed_hz", "casing_hz", "blade_hz")
        },
        **{key: column for k, one in enumerate(found) for key, column in numbers_of_result(one, f"{k} ").items()},
    )


@pytest.mark.slow
def test_numbers_of_draws(held):
    random = cf.field.RandomField.example(thickness=3e-3, radius=0.475, seed=7, p_max=12)
    found = cf.modal.mistune(casing(radius_defect=random), 2, count=6)
    held(1e-5, **{f"{k}": column for k, column in found.columns().items() if np.asarray(column).dtype.kind in "if"})
