"""Numbers held: derivatives by every kind of address, a fit with priors, its posterior and what it predicts."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BAR = cf.edge.Section.rectangle(width=0.02, depth=0.012)
SPRINGS = cf.ElasticEdge(k_r=3e8, k_theta=2e8, k_z=4e8, k_rot=1e5, around=cf.FourierField.of({2: (0.3, 0.1)}))


def casing():
    return cf.Shell(
        chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
        thickness=3e-3,
        material=STEEL,
        supports={"base": SPRINGS},
        radius_defect=cf.FourierField.of({2: 0.004, 3: (0.001, -0.002)}),
        thickness_defect=cf.FourierField.of({1: 0.1}),
        masses={"top": (cf.edge.EdgeMass(angle=0.3, mass=0.2),)},
        mesh=cf.ShellMesh(order=4, rows=1, around=9),
    )


def ringed():
    return cf.Shell(
        chart=cf.Cylinder(radius=0.3, height=0.25),
        thickness=3e-3,
        material=STEEL,
        supports={"base": cf.Ring(section=BAR, offset=(0.004, -0.01), support=cf.Bolts(count=6, k=1e8, k_rot=1e3))},
        stiffeners=(cf.edge.Stiffener(at=0.125, section=BAR, offset=(0.0075, 0.001)),),
        mesh=cf.ShellMesh(order=4, rows=2, around=6),
    )


def blade():
    return cf.Shell(
        chart=cf.Blade(length=0.2, chord=(0.06, 0.05), camber=0.3, twist=(0.1, 0.5)),
        thickness=3e-3,
        material=STEEL,
        supports={"root": cf.Clamped()},
        taper=cf.Taper(along=(1.0, 0.7)),
        mesh=cf.ShellMesh(order=5, rows=1, around=1),
    )


def solid():
    mesh = cf.imported.grid_mesh("hexahedron20", (3, 1, 1), lambda u: u * [0.2, 0.05, 0.02], groups={"root": (0, 0.0)})
    return cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.ElasticEdge(k_face=1e12)})


ADDRESSES = {
    casing: (
        "material.E",
        "material.nu",
        "material.rho",
        "shell.thickness",
        "support.base.k_r",
        "support.base.k_rot",
        "support.base.around.p2.cos",
        "mass.top.1.mass",
        "radius.p3.sin",
        "radius.p2.cos",
        "thickness.p1.cos",
    ),
    ringed: (
        "material.E",
        "material.rho",
        "shell.thickness",
        "chart.radius",
        "support.base.section.width",
        "support.base.k",
        "support.base.bolts.3.k",
        "chart.height",
    ),
    blade: ("material.E", "material.nu", "shell.thickness", "chart.length"),
    solid: ("material.E", "material.nu", "material.rho", "support.root.k_face"),
}


@pytest.mark.slow
@pytest.mark.parametrize("make", ADDRESSES, ids=lambda make: make.__name__)
def test_numbers_of_derivatives(make, held):
    part = make()
    found = cf.modes(part, 4) if make in (blade, solid) else cf.modes(part, 4, method="shell")
    at = [cf.updating.get_value(part, name) for name in ADDRESSES[make]]
    vary = [
        cf.Parameter(name=name, lower=value - abs(value) - 1e-3, upper=value + abs(value) + 1e-3)
        for name, value in zip(ADDRESSES[make], at, strict=True)
    ]
    moved = cf.updating.with_value(part, vary[0].name, 1.1 * at[0])
    held(
        1e-5,
        at=at,
        slopes=np.sort(cf.updating.eigen_derivatives(found, vary), axis=0),
        moved=[cf.updating.get_value(moved, vary[0].name)],
    )


@pytest.fixture(scope="module")
def fit():
    truth = replace(blade(), thickness=3.1e-3, material=replace(STEEL, E=205e9))
    freq = cf.modes(truth, 4).freq * (1.0 + 1e-3 * np.cos(np.arange(4) ** 2))
    table = cf.FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=1e-3 * freq)
    vary = [
        cf.Parameter(name="shell.thickness", lower=2e-3, upper=4e-3, sigma=1e-4),
        cf.Parameter(name="material.E", lower=150e9, upper=250e9, log=True),
        cf.Parameter(name="material.rho", lower=7e3, upper=9e3, sigma=50.0),
    ]
    return cf.update(blade(), table, vary)


@pytest.mark.slow
def test_numbers_of_a_fit(fit, held):
    held(
        1e-4,
        value=fit.value,
        sigma=fit.sigma,
        stated=fit.stated_sigma,
        correlation=fit.correlation,
        chi2=[fit.chi2, fit.inflation, fit.misfit, fit.free, fit.residuals, fit.model_floor],
        values=fit.values,
        singular=fit.identifiability.singular,
        history=fit.history[:3],
    )
