"""Stiffness and mass: symmetry, definiteness, exact mass, patch tests, rigid bodies."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import dblquad

import casingfem as cf
from casingfem.linalg.eigen import sturm_count
from casingfem.linalg.factor import factorise
from casingfem.structure.mesh.kinematics import frame
from casingfem.structure.mesh.shell_mesh import make_grid
from casingfem.structure.shell.assembly import element_matrices
from casingfem.structure.shell.nodal_mass import nodal_mass

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


def test_supported_shell_is_positive_definite(frustum, coarse):
    system = cf.shell.assemble(imperfect(frustum, coarse))
    assert sturm_count(system.K, system.mass, 1.0) == 0
    assert system.mass.min() > 0.0


def test_free_imperfect_shell_has_exactly_six_rigid_modes(frustum, coarse):
    """Six eigenvalues below (1 Hz)^2; the elastic ones start at 8.5 Hz, as a free ring's n = 2 pair does."""
    system = cf.shell.assemble(imperfect(frustum, coarse, supports={}))
    assert sturm_count(system.K, system.mass, (2 * np.pi * 1.0) ** 2) == 6
    assert sturm_count(system.K, system.mass, (2 * np.pi * 6.0) ** 2) == 6
    assert sturm_count(system.K, system.mass, (2 * np.pi * 12.0) ** 2) == 8


def test_translations_of_a_free_imperfect_shell_cost_no_energy(frustum, coarse):
    system = cf.shell.assemble(imperfect(frustum, coarse, supports={}))
    fields = np.zeros((len(system.frames), 5, 3))
    fields[:, [0, 1, 2], [0, 1, 2]] = 1.0
    u = vectors_of(system, fields)
    assert np.abs(system.K @ u).max() < 1e-12 * abs(system.K).max()


@pytest.mark.slow
def test_rotations_of_a_free_imperfect_shell_cost_less_the_finer_the_mesh(frustum):
    """X itself is interpolated: the energy of a rotation falls with the order, spectrally."""
    energies = []
    for order in (4, 6, 8):
        shell = imperfect(frustum, cf.ShellMesh(order=order, rows=1, around=9), supports={})
        system = cf.shell.assemble(shell)
        f = frame(shell.geometry(*system.grid.nodes).surface)
        turn = np.array([[1.0], [0.5], [0.3]])
        u = np.cross(turn, system.points.T, axis=0)
        change = np.cross(turn, f.normal, axis=0)
        fields = np.concatenate([u, [np.sum(change * f.e1, 0), np.sum(change * f.e2, 0)]]).T[:, :, None]
        v = vectors_of(system, fields)[:, 0]
        energies.append(float(v @ (system.K @ v)) / (v @ (system.K.diagonal() * v)))
    assert energies[1] < 1e-2 * energies[0]
    assert energies[2] < 1e-2 * energies[1]
    assert energies[2] < 1e-11


def translational_mass(system):
    full = np.zeros(len(system.frames) * 5)
    full[system.free] = system.mass
    return full.reshape(-1, 5).sum(axis=0)


def test_mass_of_a_frustum_is_rho_t_area(frustum, coarse):
    area = np.pi * (0.5 + 0.45) * np.hypot(0.25, 0.05)
    system = cf.shell.assemble(frustum(supports={}, mesh=coarse))
    np.testing.assert_allclose(translational_mass(system)[:3], 7800.0 * 3e-3 * area, rtol=1e-13)
    moments = nodal_mass(system.shell, system.grid).moments.sum(axis=0)
    np.testing.assert_allclose(moments[[0, 2]], 7800.0 * area * np.array([3e-3, (3e-3) ** 3 / 12]), rtol=1e-13)


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


@pytest.mark.slow
def test_mass_of_an_imperfect_frustum_is_the_integral_of_its_own_area(frustum):
    shell = imperfect(frustum, cf.ShellMesh(order=8, rows=1, around=9), supports={})

    def density(theta, z):
        geometry = shell.geometry(np.array([z]), np.array([theta]))
        return float((geometry.thickness * frame(geometry.surface).jacobian)[0])

    exact, _ = dblquad(density, 0.0, 0.25, 0.0, 2 * np.pi, epsabs=0, epsrel=1e-6)
    assert translational_mass(cf.shell.assemble(shell))[0] == pytest.approx(7800.0 * exact, rel=1e-6)


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


def test_static_tip_deflection_of_a_slender_cantilever(steel):
    """nu = 0: the plate strip is Timoshenko's beam, F L^3/(3 E I) + F L/(5/6 G A), exactly at order >= 3."""
    material = cf.Material(E=210e9, nu=0.0, rho=7800.0)
    shell = cf.Shell(
        chart=cf.Plate(length=1.0, width=0.1),
        thickness=0.02,
        material=material,
        supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=3, rows=2, around=1),
    )
    system = cf.shell.assemble(shell)
    edge = system.grid.edges["tip"]
    loads = np.zeros((len(system.frames), 5, 1))
    loads[edge.nodes, 2, 0] = edge.weights / edge.weights.sum()
    tip = system.expand(factorise(system.K).solve(system.restrict(loads)))[edge.nodes, 2, 0]
    exact = 1 / (3 * 210e9 * 0.1 * 0.02**3 / 12) + 1 / (5 / 6 * 105e9 * 0.1 * 0.02)
    np.testing.assert_allclose(tip, exact, rtol=1e-8)


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**31))
def test_restrict_is_the_transpose_of_expand(seed):
    rng = np.random.default_rng(seed)
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


def test_element_matrices_do_not_depend_on_how_they_are_chunked(frustum, coarse, monkeypatch):
    shell = imperfect(frustum, coarse)
    grid = make_grid(shell.chart, shell.mesh)
    whole = element_matrices(shell, grid)
    monkeypatch.setattr("casingfem.structure.mesh.jet_form.CHUNK", 1)
    np.testing.assert_allclose(element_matrices(shell, grid), whole, rtol=1e-12, atol=1e-12 * np.abs(whole).max())
