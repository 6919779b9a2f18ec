"""Rotation: quadratic strains, invariance, published beams, critical speed, refusals, reduction."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.mesh.jet_form import point_jets, scatter_blocks
from casingfem.structure.mesh.kinematics import frame, strain_slots
from casingfem.structure.shell.assembly import spin
from casingfem.structure.shell.nodal_mass import NodalMass, nodal_mass
from casingfem.structure.shell.prestress import centrifugal, gradients, gyroscopic, quadratic_strains, softening
from casingfem.structure.shell.wall import constitutive, curvature
from reports.verification.rotation import FACTORS, rotating_beam, strip, strip_factors

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BLADE = cf.Plate(length=0.2, width=0.04)
CONE, TWISTED = cf.Frustum(r_base=0.5, r_top=0.35, height=0.25), cf.TwistedPlate(length=0.3, width=0.1, twist=1.1)
SMALL = cf.ShellMesh(order=6, rows=2, around=1)


def blade(**changes):
    rotation = cf.Rotation.of_blade(BLADE, omega=800.0, hub_radius=0.3, stagger=0.6)
    parts = {"thickness": 3e-3, "material": STEEL, "supports": {"root": cf.Clamped()}, "mesh": SMALL}
    return cf.Shell(**({"chart": BLADE, "rotation": rotation} | parts | changes))


def exact_strains(surface, rates, jets):
    """Strain measures of the deformed surface with director a3 + w - |w|^2 a3/2, less those of the shell as it is."""
    basis = rates.basis
    e = (basis.e1, basis.e2)
    g = np.einsum("pcsd,sd->pc", gradients(rates), jets.reshape(3, 5))
    a = [e[i] + g[i] for i in range(2)]
    w = g[4]
    square = [2.0 * (w @ g[2 + i]) for i in range(2)]  # D_i |w|^2
    d = basis.normal + w - 0.5 * (w @ w) * basis.normal
    slope = [rates.normal[i] * (1.0 - 0.5 * (w @ w)) + g[2 + i] - 0.5 * square[i] * basis.normal for i in range(2)]
    pairs = ((0, 0), (1, 1), (0, 1))
    stretch = [0.5 * (a[i] @ a[j] - e[i] @ e[j]) * (1.0 if i == j else 2.0) for i, j in pairs]
    bend = [
        (0.5 if i == j else 1.0) * (a[i] @ slope[j] + a[j] @ slope[i] - e[i] @ rates.normal[j] - e[j] @ rates.normal[i])
        for i, j in pairs
    ]
    return np.array([*stretch, *bend, a[0] @ d, a[1] @ d])


@pytest.mark.parametrize("chart", [CONE, TWISTED], ids=["cone", "twisted"])
def test_quadratic_strains_are_the_second_order_of_the_deformed_surface(chart):
    """Linear part from the strain slots, quadratic part here; what is left falls with the third power."""
    surface = cf.geometry.Surface(*(part[:, 0] for part in chart.surface(np.array([0.1]), np.array([0.8]), None)))
    L, rates = strain_slots(surface)
    jets = np.random.default_rng(5).normal(size=15)
    g = np.einsum("pcsd,sd->pc", gradients(rates), jets.reshape(3, 5))
    linear = np.einsum("ksd,sd->k", np.moveaxis(L, 0, 1), jets.reshape(3, 5))
    quadratic = 0.5 * np.einsum("kpq,pc,qc->k", quadratic_strains(rates), g, g)
    left = []
    for size in (1e-2, 5e-3):
        difference = exact_strains(surface, rates, size * jets) - size * linear - size**2 * quadratic
        left.append(np.abs(difference).max())
    assert left[0] < 2e-4 * np.abs(quadratic).max()
    assert left[0] / left[1] == pytest.approx(8.0, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    "chart",
    [cf.Frustum(r_base=0.5, r_top=0.45, height=0.25), cf.Cylinder(radius=0.4, height=0.1)],
    ids=["cone", "tube"],
)
@pytest.mark.parametrize("turn", [(0.0, 0.0, 1.0), (1.0, 0.3, 0.1)], ids=["about the axis", "askew"])
def test_a_rigid_rotation_of_the_spinning_shell_costs_what_its_springs_cost(chart, turn):
    """The internal energy is unchanged to second order: r K_sigma r = -2 f_internal . r2, r2 = turn x (turn x x)/2."""
    springs = {"base": cf.ElasticEdge(k_r=1e6, k_theta=2e6, k_z=3e6)}
    shell = cf.Shell(chart=chart, thickness=5e-3, material=STEEL, supports=springs,
                     mesh=cf.ShellMesh(order=7, rows=1, around=7))  # fmt: skip
    system, free = cf.shell.assemble(shell), cf.shell.assemble(replace(shell, supports={}))
    rotation = cf.Rotation(omega=1.0)
    added = spin(system, rotation)
    basis = frame(shell.geometry(*system.grid.nodes).surface)
    axis = np.array(turn)

    def motion(u, d):
        field = np.concatenate([u, [np.sum(d * basis.e1, axis=0), np.sum(d * basis.e2, axis=0)]]).T
        return system.collect(field[:, :, None], np.zeros((0, 1)))[:, 0]

    u, d = np.cross(axis, system.points.T, axis=0), np.cross(axis, basis.normal, axis=0)
    first, second = motion(u, d), motion(np.cross(axis, u, axis=0) / 2.0, np.cross(axis, d, axis=0) / 2.0)
    blocks = softening(rotation, nodal_mass(shell, system.grid), system.points @ rotation.plane, basis.normal.T)
    sigma = first @ (added.K1 @ first) + first @ (scatter_blocks(blocks, system.frames, system.free) @ first)
    inner = free.K @ system.collect(added.fields[:, :, None], np.zeros((0, 1)))[:, 0]
    assert sigma == pytest.approx(-2.0 * inner @ second, rel=1e-8)
    assert abs(sigma) > 0.1


def test_nodal_blocks_are_the_derivatives_of_the_kinetic_energy():
    """T = [m0 |v|^2 + 2 m1 v.y + m2 |y|^2]/2 with v = u' + a x (x + u), y = d' + a x d, d = n + w - |w|^2 n/2."""
    rng = np.random.default_rng(11)
    tangents, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    n = tangents[:, 2]
    rotation = cf.Rotation(omega=1.0, axis=tuple(rng.normal(size=3)), centre=(0.1, 0.2, -0.3))
    x, (m0, m1, m2) = rng.normal(size=3), (2.0, 0.4, 0.7)

    def kinetic(state):
        (u, w), (v, rate) = ((part[:3], part[3:]) for part in state.reshape(2, 5))
        d = n + tangents[:, :2] @ w - 0.5 * (w @ w) * n
        turning = tangents[:, :2] @ rate - (w @ rate) * n
        moving = v + np.cross(rotation.direction, x + u - rotation.centre)
        turning = turning + np.cross(rotation.direction, d)
        return 0.5 * (m0 * moving @ moving + 2.0 * m1 * moving @ turning + m2 * turning @ turning)

    h, steps = 1e-3, 1e-3 * np.eye(10)
    slope = np.array([kinetic(step) - kinetic(-step) for step in steps]) / (2.0 * h)
    curve = np.array([
        [kinetic(p + q) - kinetic(p - q) - kinetic(q - p) + kinetic(-p - q) for q in steps] for p in steps
    ]) / (4.0 * h**2)  # fmt: skip
    mass = NodalMass(np.array([[m0, m1, m2]]), tangents[None, :, :2])
    away = (x - np.asarray(rotation.centre))[None] @ rotation.plane
    np.testing.assert_allclose(mass.blocks[0], curve[5:, 5:], atol=1e-6)
    np.testing.assert_allclose(centrifugal(rotation, mass, away, n[None])[0], slope[:5], atol=1e-6)
    np.testing.assert_allclose(softening(rotation, mass, away, n[None])[0], curve[:5, :5], atol=1e-6)
    np.testing.assert_allclose(gyroscopic(rotation, mass)[0], curve[5:, :5] - curve[:5, 5:], atol=1e-6)


def test_added_matrices_are_symmetric_and_skew():
    added = spin(cf.shell.assemble(blade(rotation=None)), blade().rotation)
    assert abs(added.K1 - added.K1.T).max() < 1e-12 * abs(added.K1).max()
    assert abs(added.G + added.G.T).max() < 1e-15 * abs(added.G).max()


def test_static_state_is_that_of_a_rotating_bar():
    """nu = 0: the tip of a clamped bar moves by rho Omega^2/E (hub L^2/2 + L^3/3)."""
    soft = cf.Material(E=210e9, nu=0.0, rho=7800.0)
    rotation = cf.Rotation.of_blade(BLADE, omega=1.0, hub_radius=0.3)
    shell = blade(material=soft, rotation=None)
    system = cf.shell.assemble(shell)
    moved = spin(system, rotation).fields[system.grid.edges["tip"].nodes, 0]
    exact = 7800.0 / 210e9 * (0.3 * 0.2**2 / 2 + 0.2**3 / 3)
    np.testing.assert_allclose(moved, exact, rtol=1e-3)  # the clamped root and the force across the chord


@pytest.mark.parametrize("eta", [1, 3, 6, 12])
def test_beam_theory_gives_the_published_factors(eta):
    np.testing.assert_allclose(rotating_beam(eta), FACTORS[eta], atol=1.1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(("stagger", "across"), [(np.pi / 2, True), (0.0, False)], ids=["flap", "lead-lag"])
def test_strip_follows_the_beam(stagger, across):
    """Out of the plane of rotation the published factors; in it sqrt(factor^2 - eta^2)."""
    found = strip_factors(strip(stagger), [2.0, 12.0], count=3)
    for row, eta in zip(found, (2, 12), strict=True):
        exact = np.sqrt(np.square(FACTORS[eta]) - (0.0 if across else eta**2))
        np.testing.assert_allclose(row, exact, rtol=5e-5)


@pytest.mark.slow
def test_hub_radius_stiffens():
    found = strip_factors(strip(np.pi / 2, hub=1.5), [6.0], count=3)[0]
    np.testing.assert_allclose(found, rotating_beam(6.0, hub=1.5), rtol=5e-5)
    assert found[0] > 1.4 * FACTORS[6][0]


@pytest.mark.slow
def test_a_strip_on_its_own_axis_loses_its_stiffness_at_its_frequency():
    """Without tension omega^2 = omega_0^2 - Omega^2: the critical speed, and what is refused beyond it."""
    shell = blade(rotation=None)
    low = cf.modes(shell, 1).omega[0]
    along = cf.Rotation(omega=0.8 * low, axis=(1.0, 0.0, 0.0))
    assert len(cf.modes(replace(shell, rotation=along), band=(0.01 * low, 0.02 * low))) == 0
    assert cf.modes(replace(shell, rotation=along), 1).omega[0] == pytest.approx(0.6 * low, rel=2e-3)
    for broken in (cf.modes, cf.whirl_modes):
        with pytest.raises(cf.errors.ModelError, match="rotation-unstable"):
            broken(replace(shell, rotation=along.at(1.05 * low)), 1)


@pytest.mark.slow
def test_campbell_equals_the_modes_of_each_speed():
    data = cf.campbell(blade(), [0.0, 400.0, 800.0], count=3)
    fast = cf.modes(blade(), 6)
    near = np.abs(data.freq[2][:, None] / fast.freq - 1.0).min(axis=1)
    assert near.max() < 1e-9
    slope = np.diff((2 * np.pi * data.freq[:2]) ** 2, axis=0)[0] / 400.0**2
    np.testing.assert_allclose(slope, data.southwell, rtol=0.05)
    assert data.overlap.min() > 0.98


@pytest.mark.slow
def test_reduced_rotating_blade_answers_a_push_with_its_stiffened_compliance():
    shell = blade()
    basis = cf.reduce(shell, cf.Tip(), modes=4)
    push = [cf.loads.EdgeLoad(edge="tip", force=(0.0, 0.0, 1.0 / 0.04))]
    moved = cf.solve_static(shell, push).fields
    system = cf.shell.assemble(shell)
    edge = system.grid.edges["tip"]
    mean = edge.weights @ moved[edge.nodes, 2] / edge.weights.sum()
    flap = basis.channels.index("flap")
    assert basis.compliance[flap, flap] == pytest.approx(mean, rel=1e-7)
    resting = cf.reduce(replace(shell, rotation=None), cf.Tip(), modes=4)
    assert basis.compliance[flap, flap] < 0.7 * resting.compliance[flap, flap]


def test_axes_of_a_blade():
    panel = cf.Panel(radius=0.5, length=0.3, angle=0.4)
    still, turned = (cf.Rotation.of_blade(panel, omega=1.0, hub_radius=0.2, stagger=s) for s in (0.0, np.pi / 2))
    np.testing.assert_allclose(still.centre, [0.5, 0.0, -0.2], atol=1e-15)
    np.testing.assert_allclose(still.axis, [0.0, 1.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(np.abs(turned.axis), [1.0, 0.0, 0.0], atol=1e-15)


def test_a_blade_that_the_speed_untwists_is_doubted():
    with pytest.warns(cf.errors.ModelWarning, match="rotation-large"):
        cf.modes(blade(rotation=blade().rotation.at(1500.0)), 1)


def test_matrices_are_the_derivatives_of_the_strain_energy():
    """v (K1 + S) v = int [E(u1) D E2(v, v) + 2 E(v) D E2(u1, v)], v K2 v = int E2(u1, v) D E2(u1, v)."""
    chart = cf.Frustum(r_base=0.5, r_top=0.4, height=0.2)
    shell = cf.Shell(chart=chart, thickness=0.02, material=STEEL, supports={"base": cf.Clamped()},
                     mesh=cf.ShellMesh(order=4, rows=(0.0, 0.3, 1.0), around=3))  # fmt: skip
    system, rotation = cf.shell.assemble(shell), cf.Rotation(omega=1.0, axis=(0.3, 0.1, 1.0))
    grid, added = system.grid, spin(system, rotation)
    v = np.random.default_rng(3).normal(size=(system.size, 1))
    geometry = shell.geometry(*grid.parameters, grid.middle)
    L, rates = strain_slots(geometry.surface)
    D = constitutive(shell, geometry, curvature(rates)) * rates.basis.jacobian * grid.measure
    fields = np.concatenate([added.fields[:, :, None], system.expand(v)], axis=2)
    u1, moved = np.moveaxis(point_jets(grid, fields).reshape(*D.shape[2:], 3, 5, 2), -1, 0)

    def linear(z):
        return np.einsum("sktel,elst->kel", L, z)

    def quadratic(z):
        g = np.einsum("pcstel,elst->pcel", gradients(rates), z)
        return 0.5 * np.einsum("kpqel,pcel,qcel->kel", quadratic_strains(rates), g, g, optimize=True)

    def energy(one, other):
        return np.einsum("kel,kjel,jel->", one, D, other, optimize=True)

    size = np.abs(moved).max() / np.abs(u1).max()
    mixed = (quadratic(moved + size * u1) - quadratic(moved - size * u1)) / (2.0 * size)
    basis = frame(shell.geometry(*grid.nodes).surface)
    away = (system.points - np.asarray(rotation.centre)) @ rotation.plane
    blocks = softening(rotation, nodal_mass(shell, grid), away, basis.normal.T)
    found = v[:, 0] @ (added.K1 @ v[:, 0]) + v[:, 0] @ (scatter_blocks(blocks, system.frames, system.free) @ v[:, 0])
    exact = 2.0 * energy(linear(u1), quadratic(moved)) + 2.0 * energy(linear(moved), mixed)
    assert found == pytest.approx(exact, rel=1e-10)
    assert v[:, 0] @ (added.K2 @ v[:, 0]) == pytest.approx(energy(mixed, mixed), rel=1e-10)
    assert added.nonlinear**2 == pytest.approx(energy(quadratic(u1), quadratic(u1)) / energy(linear(u1), linear(u1)))


@pytest.mark.parametrize("length", [1e-170, 1e-320, 2.0, 1e200])
def test_an_axis_of_any_length_has_a_direction(length):
    assert cf.Rotation(omega=1.0, axis=(0.0, -length, 0.0)).direction.tolist() == [0.0, -1.0, 0.0]


@pytest.mark.parametrize(
    ("make", "code"),
    [
        (lambda: cf.Rotation(omega=np.nan), "rotation-speed"),
        (lambda: cf.Rotation(omega=1.0, axis=(0.0, 0.0, 0.0)), "rotation-axis"),
        (lambda: cf.Rotation.of_blade(BLADE, omega=1.0, hub_radius=-0.1), "rotation-blade"),
        (
            lambda: cf.Rotation.of_blade(cf.Cylinder(radius=1.0, height=1.0), omega=1.0, hub_radius=0.1),
            "rotation-blade",
        ),
        (lambda: cf.campbell(blade(rotation=None), [1.0]), "rotation-none"),
        (lambda: cf.whirl_modes(blade(rotation=None)), "rotation-none"),
        (lambda: cf.modes(blade(supports={}), 1), "static-loose"),
        (lambda: cf.updating.eigen_derivatives(cf.modes(blade(), 1), []), "rotation-update"),
    ],
)
def test_refused(make, code):
    with pytest.raises(cf.errors.ModelError) as caught:
        make()
    assert caught.value.code == code


def test_a_rotating_casing_is_not_solved_by_harmonics():
    casing = cf.Shell(chart=cf.Cylinder(radius=0.2, height=0.1), thickness=2e-3, material=STEEL,
                      supports={"base": cf.Clamped()}, rotation=cf.Rotation(omega=100.0))  # fmt: skip
    with pytest.raises(ValueError, match="nothing varies"):
        cf.modes(casing, 2, method="fourier")
