"""Sensitivities: the complex step against central differences of frequencies, parameter by parameter."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.slopes import assert_slopes

COUNT = 10
NAMES = [
    "material.E",
    "material.nu",
    "material.rho",
    "shell.thickness",
    "chart.r_top",
    "chart.r_base",
    "chart.height",
    "radius.p8.cos",
    "radius.p3.sin",
    "thickness.p4.cos",
    "modulus.p4.cos",
    "density.p2.sin",
    "support.base.k_face",
    "support.base.around.p4.cos",
    "support.base.k_face.p4.sin",
    "support.base.k_r",
    "support.base.k_theta",
    "support.base.k_z",
    "support.base.k_rot",
]


@pytest.fixture(scope="module")
def casing(frustum):
    """Nothing symmetric, so that no derivative vanishes."""
    edge = cf.ElasticEdge(
        k_face=5e11, k_r=1e9, k_theta=2e9, k_z=1e9, k_rot=1e5, around=cf.FourierField.of({4: (0.3, 0.2)})
    )
    return frustum(
        supports={"base": edge},
        radius_defect=cf.FourierField.of({8: (0.002, 0.001), 3: (0.001, 0.001)}),
        thickness_defect=cf.FourierField.of({4: 0.05}),
        modulus_defect=cf.FourierField.of({4: (0.03, 0.02)}),
        density_defect=cf.FourierField.of({2: (0.01, 0.04)}),
        mesh=cf.ShellMesh(order=5, rows=1, around=9),
    )


@pytest.fixture(scope="module")
def solved(casing):
    return cf.modes(casing, COUNT)


def parameter(name):
    return cf.Parameter(name=name, lower=1e-3, upper=1e15, log=name == "support.base.k_face")


def pair_means(found, values):
    return np.array([values[list(pair)].mean() for pair in found.doublets])


def beside(shell, p, part=2e-4):
    """Modes at two values of a parameter, and how far apart they are."""
    x = p.to_internal(cf.updating.get_value(shell, p.name))
    h = part * abs(x)
    plus, minus = (cf.modes(cf.updating.with_value(shell, p.name, p.from_internal(v)), COUNT) for v in (x + h, x - h))
    return plus, minus, 2 * h


def central_difference(shell, p, quantity, part=2e-4):
    plus, minus, distance = beside(shell, p, part)
    return (quantity(plus) - quantity(minus)) / distance


@pytest.mark.slow
def test_derivatives_equal_central_differences(casing, solved):
    """Of the means of all pairs, and of each member where a pair is apart."""

    def means_and_members(values):
        return np.concatenate([pair_means(solved, values), values[apart(solved)]])

    vary = [parameter(name) for name in NAMES]
    assert_slopes(casing, solved, vary, part=5e-5, within=1e-7, of=means_and_members)


def apart(found):
    return np.array([k for pair, s in zip(found.doublets, found.splits, strict=True) if s > 1e-3 for k in pair])


def test_scaling_laws_keep_to_round_off(casing, frustum):
    """omega^2 goes with E (clamped), with 1/rho, and is untouched by E and rho together."""
    found = cf.modes(frustum(mesh=casing.mesh, radius_defect=casing.radius_defect), 6)
    G = cf.updating.eigen_derivatives(found, [parameter("material.E"), parameter("material.rho")])
    np.testing.assert_allclose(np.diag(G[0]), found.omega**2 / 210e9, rtol=1e-9)
    np.testing.assert_allclose(np.diag(G[1]), -(found.omega**2) / 7800.0, rtol=1e-9)


@pytest.mark.slow
def test_a_perfect_double_has_derivatives_that_split_it(frustum):
    """cos 8 theta splits n = 4 at first order, and no other pair; its sine turns it by 45 degrees / 4."""
    found = cf.modes(frustum(mesh=cf.ShellMesh(order=6, rows=1, around=17)), 24)
    cos, sin = cf.updating.eigen_derivatives(found, [parameter("radius.p8.cos"), parameter("radius.p8.sin")])
    for low, high in found.doublets:
        block = np.ix_([low, high], [low, high])
        scale = found.omega[low] ** 2
        if found.nodal_diameters[low] == 4:
            assert abs(cos[low, low] - cos[high, high]) > 10 * scale
            np.testing.assert_allclose(np.linalg.eigvalsh(sin[block]), np.linalg.eigvalsh(cos[block]), rtol=1e-3)
            assert abs(sin[low, low]) < 1e-3 * abs(sin[low, high])
        elif found.nodal_diameters[low] <= 10:
            assert np.abs(cos[block]).max() < 1e-2 * scale
    first = [k for k, n in enumerate(found.nodal_diameters) if n == 4][:2]
    measured = cf.modes(frustum(mesh=found.grid.mesh, radius_defect=cf.FourierField.of({8: 1e-6})), 24)
    split = np.ptp(measured.omega[measured.nodal_diameters == 4][:2] ** 2) / 1e-6
    assert split == pytest.approx(abs(cos[first[0], first[0]] - cos[first[1], first[1]]), rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("support", [cf.Clamped(), cf.ElasticEdge(k_face=1e12)], ids=["clamped", "elastic"])
def test_open_panels_have_derivatives_too(steel, support):
    panel = cf.Shell(
        chart=cf.Panel(radius=0.6, length=0.3, angle=0.5), thickness=3e-3, material=steel, supports={"root": support},
        mesh=cf.ShellMesh(order=6, rows=1, around=1),
    )  # fmt: skip
    found = cf.modes(panel, 5)
    for name in ("chart.radius", "chart.length", "chart.angle", "shell.thickness", "material.nu"):
        exact = np.diag(cf.updating.eigen_derivatives(found, [parameter(name)])[0])
        x = cf.updating.get_value(panel, name)
        plus, minus = (cf.modes(cf.updating.with_value(panel, name, x * (1 + s)), 5).omega ** 2 for s in (1e-4, -1e-4))
        numeric = (plus - minus) / (2e-4 * x)
        assert np.abs(exact - numeric).max() < 1e-5 * np.abs(numeric).max()


@pytest.mark.slow
def test_edges_fixed_in_their_own_frame(frustum, coarse):
    shell = frustum(supports={"base": cf.ShearDiaphragm(), "top": cf.Clamped()}, mesh=coarse)
    found = cf.modes(shell, 4, method="shell")
    exact = np.diag(cf.updating.eigen_derivatives(found, [parameter("shell.thickness")])[0])
    plus, minus = (
        cf.modes(replace(shell, thickness=3e-3 * (1 + s)), 4, method="shell").omega ** 2 for s in (1e-4, -1e-4)
    )
    np.testing.assert_allclose(exact, (plus - minus) / (2e-4 * 3e-3), rtol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["chart.r_top", "radius.p8.cos", "chart.angle", "radius.p12.cos"])
def test_fixed_directions_turn_with_the_surface(frustum, steel, name):
    """A diaphragm on a cone, and a panel whose corners lie on a diaphragm and on clamped or symmetric edges."""
    waves = cf.FourierField.of({8: (0.004, 0.001), 12: 0.003})
    coarse = cf.ShellMesh(order=5, rows=1, around=9)
    casing = frustum(supports={"base": cf.ShearDiaphragm()}, radius_defect=waves, mesh=coarse)
    panel = cf.Shell(
        chart=cf.Panel(radius=0.6, length=0.3, angle=0.5),
        thickness=3e-3,
        material=steel,
        supports={"root": cf.Clamped(), "left": cf.ShearDiaphragm(), "tip": cf.edge.Symmetry()},
        radius_defect=waves,
        mesh=cf.ShellMesh(order=5, rows=1, around=2),
    )
    shell, p = panel if name in ("chart.angle", "radius.p12.cos") else casing, parameter(name)
    found = cf.modes(shell, 6)
    exact = np.diag(cf.updating.eigen_derivatives(found, [p])[0])
    numeric = central_difference(shell, p, lambda moved: moved.omega[:6] ** 2, part=1e-5)
    np.testing.assert_allclose(exact, numeric, rtol=1e-5, atol=1e-6 * np.abs(exact).max())
