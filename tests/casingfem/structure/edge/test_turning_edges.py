"""Rings and masses on the edges of a shell that turns: rigid motions, ring theory, reduced bodies."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
import contact as ct
from reports.verification.rotation import ring_waves

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
SECTION = cf.edge.Section.rectangle(width=0.02, depth=0.03)
SPRINGS = {"base": cf.ElasticEdge(k_r=1e6, k_theta=2e6, k_z=3e6)}
MASSES = (cf.edge.EdgeMass(angle=0.3, mass=2.0), cf.edge.EdgeMass(angle=2.0, mass=0.7))


def casing(offset=None, masses=()):
    """A cone on springs with a ring on its top, or without one."""
    ring = {} if offset is None else {"top": cf.Ring(section=SECTION, offset=offset)}
    return cf.Shell(
        chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=5e-3, material=STEEL,
        supports=SPRINGS | ring, masses={"top": masses} if masses else {}, mesh=cf.ShellMesh(order=7, rows=1, around=7),
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("omega", [60.0, 240.0])
def test_a_ring_on_a_shell_of_no_weight_has_the_waves_of_ring_theory(omega):
    """What is left is the ring's stretch, of the order of its strain rho Omega^2 R^2/E."""
    R, section = 0.5, cf.edge.Section.rectangle(width=0.002, depth=0.004)
    heavy, light = (cf.Material(E=f * 210e9, nu=0.0, rho=f * 7800.0) for f in (1.0, 1e-6))
    k = 1.5 * omega**2
    held = cf.ElasticEdge(**dict.fromkeys(("k_r", "k_theta", "k_z"), k * heavy.rho * section.area))
    slight = cf.ElasticEdge(k_r=0.1, k_theta=0.1, k_z=0.1)
    shell = cf.Shell(
        chart=cf.Cylinder(radius=R, height=0.02), thickness=1e-4, material=light, rotation=cf.Rotation(omega=omega),
        supports={"top": cf.Ring(section=section, material=heavy, offset=(0.0, 0.0), support=held), "base": slight},
        mesh=cf.ShellMesh(order=7, rows=1, around=7),
    )  # fmt: skip
    found, strain = cf.whirl_modes(shell, 30), 7800.0 * omega**2 * R**2 / 210e9
    for n in (2, 3):
        still = n * (n * n - 1) / np.sqrt(n * n + 1) * np.sqrt(210e9 * 0.002**2 / 12 / 7800.0) / R**2
        for sense, exact in zip((1, -1), ring_waves(n, omega, still=still, springs=k), strict=True):
            waves = 2.0 * np.pi * found.freq[(found.nodal_diameters == n) & (found.sense == sense)]
            assert np.abs(waves / exact - 1.0).min() < 4.0 * strain


@pytest.mark.slow
def test_a_ringed_casing_with_masses_reduced_at_rest_whirls_as_its_full_model():
    """Masses couple all diameters: 12 modes leave 2e-6, and the projections alone 4e-5."""
    shell = casing((0.012, 0.008), MASSES)
    omega, shell = 150.0, replace(shell, supports=shell.supports | {"base": cf.Clamped()})
    body = ct.ModalBody.of(cf.reduce(shell, cf.Rim("top", n_max=4), modes=40))
    exact = cf.whirl_modes(replace(shell, rotation=cf.Rotation(omega=omega)), 6).freq
    found = body.poles(omega).imag
    np.testing.assert_allclose(found[found > 0.0][:6] / (2.0 * np.pi), exact, rtol=1e-6)
    assert np.abs(exact / (body.omega[:6] / (2.0 * np.pi)) - 1.0).max() > 0.01
