"""Stiffness and mass: symmetry, definiteness, exact mass, patch tests, rigid bodies."""

import numpy as np
import pytest

import casingfem as cf

UNEVEN = cf.ShellMesh(order=3, rows=(0.0, 0.2, 0.7, 1.0), around=2)


def imperfect(frustum, mesh, **changes):
    return frustum(
        radius_defect=cf.FourierField.of({3: 0.01, 5: (0.0, 0.004)}),
        thickness_defect=cf.FourierField.of({2: 0.1}),
        mesh=mesh,
        **changes,
    )


def vectors_of(system, fields):
    """Nodal fields (nodes, 5, k) as free-dof vectors (frames are rotations: u and f turn alike)."""
    return system.collect(fields, np.zeros((system.own, fields.shape[2])))


@pytest.mark.parametrize(
    "supports",
    [
        {},
        {"base": cf.Clamped()},
        {"base": cf.ShearDiaphragm(), "top": cf.ElasticEdge(k_r=1e8, k_rot=1e4)},
    ],
    ids=["free", "clamped", "diaphragm and springs"],
)
def test_stiffness_is_symmetric(frustum, coarse, supports):
    K = cf.shell.assemble(imperfect(frustum, coarse, supports=supports)).K
    assert abs(K - K.T).max() < 1e-13 * abs(K).max()


def test_translations_of_a_free_imperfect_shell_cost_no_energy(frustum, coarse):
    system = cf.shell.assemble(imperfect(frustum, coarse, supports={}))
    fields = np.zeros((len(system.frames), 5, 3))
    fields[:, [0, 1, 2], [0, 1, 2]] = 1.0
    u = vectors_of(system, fields)
    assert np.abs(system.K @ u).max() < 1e-12 * abs(system.K).max()


def translational_mass(system):
    full = np.zeros(len(system.frames) * 5)
    full[system.free] = system.mass
    return full.reshape(-1, 5).sum(axis=0)


@pytest.mark.parametrize(
    ("chart", "area"),
    [
        (cf.Cylinder(radius=0.3, height=0.7), 2 * np.pi * 0.3 * 0.7),
        (cf.Panel(radius=0.6, length=0.3, angle=0.5), 0.6 * 0.5 * 0.3),
        (cf.Plate(length=0.4, width=0.3), 0.12),
    ],
    ids=["cylinder", "panel", "plate"],
)
def test_mass_of_other_charts(steel, chart, area):
    system = cf.shell.assemble(cf.Shell(chart=chart, thickness=2e-3, material=steel, mesh=UNEVEN))
    np.testing.assert_allclose(translational_mass(system)[:3], 7800.0 * 2e-3 * area, rtol=1e-13)


def plate_energy(steel, motion):
    """Energy of a nodal motion (x, y) -> 5 fields of a free 1.0 x 0.5 x .01 plate on an uneven mesh."""
    shell = cf.Shell(chart=cf.Plate(length=1.0, width=0.5), thickness=0.01, material=steel, mesh=UNEVEN)
    system = cf.shell.assemble(shell)
    fields = np.stack(np.broadcast_arrays(*motion(*system.points.T[:2])), axis=1)[:, :, None]
    v = vectors_of(system, fields)[:, 0]
    return 0.5 * float(v @ (system.K @ v))


def test_patch_of_constant_stretch(steel):
    """u_x = e x, u_y = -nu e y: uniaxial tension, energy E e^2 t A/2."""
    energy = plate_energy(steel, lambda x, y: (1e-3 * x, -0.3e-3 * y, 0, 0, 0))
    assert energy == pytest.approx(0.5 * 210e9 * 1e-6 * 0.01 * 0.5, rel=1e-11)


def test_patch_of_constant_curvature(steel):
    """Pure bending without anticlastic restraint: E t^3/12 kappa^2 A/2."""
    energy = plate_energy(steel, lambda x, y: (0, 0, 0.5 * 0.01 * (x**2 - 0.3 * y**2), -0.01 * x, 0.3 * 0.01 * y))
    assert energy == pytest.approx(0.5 * 210e9 * 0.01**3 / 12 * 1e-4 * 0.5, rel=1e-10)


def test_patch_of_constant_twist(steel):
    """u_z = tau x y: G t^3/12 (2 tau)^2 A/2."""
    energy = plate_energy(steel, lambda x, y: (0, 0, 0.01 * x * y, -0.01 * y, -0.01 * x))
    assert energy == pytest.approx(0.5 * steel.shear_modulus * 0.01**3 / 12 * 4e-4 * 0.5, rel=1e-10)


def test_patch_of_constant_shear_through_the_thickness(steel):
    energy = plate_energy(steel, lambda x, y: (0, 0, 1e-3 * x, 0, 0))
    assert energy == pytest.approx(0.5 * 5 / 5.7 * steel.shear_modulus * 0.01 * 1e-6 * 0.5, rel=1e-11)


def test_breathing_energy_of_a_linear_wall(steel):
    """u_r = c: E/(1 - nu^2) [t (c/R)^2 + t^3/12 (c/R^2)^2] A/2, on a mesh that carries cos theta well."""
    R, t, c = 0.5, 0.01, 1e-4
    shell = cf.Shell(
        chart=cf.Cylinder(radius=R, height=0.3),
        thickness=t,
        material=steel,
        wall="linear",
        mesh=cf.ShellMesh(order=8, rows=1, around=9),
    )
    system = cf.shell.assemble(shell)
    fields = np.zeros((len(system.frames), 5, 1))
    fields[:, :2, 0] = c * system.points[:, :2] / R
    v = vectors_of(system, fields)[:, 0]
    plane = 210e9 / (1 - 0.3**2)
    exact = 0.5 * plane * (t * (c / R) ** 2 + t**3 / 12 * (c / R**2) ** 2) * 2 * np.pi * R * 0.3
    assert 0.5 * float(v @ (system.K @ v)) == pytest.approx(exact, rel=1e-9)


def test_restrict_is_the_transpose_of_expand():
    rng = np.random.default_rng(3)
    shell = cf.Shell(
        chart=cf.Cylinder(radius=0.5, height=0.4),
        thickness=5e-3,
        material=cf.Material(E=1.0, nu=0.3, rho=1.0),
        supports={"base": cf.ShearDiaphragm(), "top": cf.ShearDiaphragm()},
        mesh=cf.ShellMesh(order=3, rows=1, around=3),
    )
    system = cf.shell.assemble(shell)
    q, f = rng.normal(size=(system.size, 2)), rng.normal(size=(len(system.frames), 5, 2))
    work = np.einsum("ndk,ndk->k", system.expand(q), f)
    np.testing.assert_allclose(np.sum(q * system.restrict(f), axis=0), work, rtol=1e-9, atol=1e-12)
