"""Rings and masses on the edges of a shell that turns: rigid motions, ring theory, reduced bodies."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
import contact as ct
from casingfem.linalg.factor import solve_held
from casingfem.structure.mesh.edge_form import EdgeForm
from casingfem.structure.mesh.kinematics import frame
from casingfem.structure.shell.assembly import turning
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


def rigid(system, axis):
    """A turn of the body to first and to second order on the unknowns."""
    x, normal = system.points.T, frame(system.shell.geometry(*system.grid.nodes).surface)
    axis, n = np.asarray(axis), normal.normal

    def motion(u, d, own):
        field = np.concatenate([u, [np.sum(d * normal.e1, axis=0), np.sum(d * normal.e2, axis=0)]]).T
        return system.collect(field[:, :, None], own[:, None])[:, 0]

    own = (axis @ n)[system.grid.edges["top"].nodes] if system.own else np.zeros(0)
    u, d = np.cross(axis, x, axis=0), np.cross(axis, n, axis=0)
    return motion(u, d, own), motion(0.5 * np.cross(axis, u, axis=0), 0.5 * np.cross(axis, d, axis=0), 0.0 * own)


CASES = {"ring": ((0.0, 0.0), ()), "eccentric ring": ((0.012, 0.008), ()), "masses on it": ((0.012, 0.008), MASSES)}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (1.0, 0.3, 0.1)])
def test_a_rigid_turn_of_a_ringed_shell_costs_what_its_springs_cost(name, axis):
    """The inner energy is unchanged to second order: v K_sigma v = -2 f_inner.v2, without what the loads do."""
    shell = casing(*CASES[name])
    system, free = cf.shell.assemble(shell), cf.shell.assemble(replace(shell, supports={"top": shell.supports["top"]}))
    part = turning(system, cf.Rotation(omega=1.0))
    u = solve_held(system.stiffness, part.load)
    v, second = rigid(system, axis)
    edges = part.edges
    soft = part.scattered(part.blocks[0]) + edges.on_unknowns(edges.inertia[0])
    (ring,) = edges.rings
    load = ring.load.copy()
    for mass in edges.masses:
        ring.add_pull(load, mass, edges.away("top"))
    of_loads = EdgeForm(ring.dofs, np.tile(np.eye(6), (len(load), 1, 1)), ring.by_force(load))
    sigma = v @ ((part.spin(u).K1 + soft - edges.on_unknowns([of_loads])) @ v)
    assert sigma == pytest.approx(-2.0 * (free.K @ u) @ second, rel=1e-8)
    assert abs(sigma) > 0.1


@pytest.mark.parametrize("name", [*CASES, "masses on the edge"])
def test_inertia_of_rotation_is_that_of_the_mass(name):
    """Of translations across the axis S = M and G = 2 M a x; the turn about it feels S = M of edges, and the load."""
    offset, masses = CASES.get(name, (None, MASSES))
    system = cf.shell.assemble(casing(offset, masses))
    part = turning(system, cf.Rotation(omega=1.0))
    soft, coriolis = part.edges.inertia
    assert part.edges.rings or part.edges.masses
    S = part.scattered(part.blocks[0]) + part.edges.on_unknowns(soft)
    G = part.scattered(part.blocks[1]) + part.edges.on_unknowns(coriolis)
    x, y = system.translations(np.eye(3)[:2]).T
    mass = x @ (system.M @ x)
    assert [x @ (S @ x), y @ (S @ y), y @ (G @ x), -(x @ (G @ y))] == pytest.approx([mass, mass, 2 * mass, 2 * mass])
    v, _ = rigid(system, (0.0, 0.0, 1.0))
    plain = cf.shell.assemble(casing())
    still, _ = rigid(plain, (0.0, 0.0, 1.0))
    of_edges = v @ (system.M @ v) - still @ (plain.M @ still)
    assert v @ (part.edges.on_unknowns(soft) @ v) == pytest.approx(of_edges, rel=1e-9)
    assert part.load @ x == pytest.approx(y @ (system.M @ v), abs=1e-9 * mass)


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
