"""Rotation: quadratic strains, invariance, published beams, critical speed, refusals, reduction."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from reports.verification.rotation import FACTORS, rotating_beam, strip, strip_factors

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BLADE = cf.Plate(length=0.2, width=0.04)
SMALL = cf.ShellMesh(order=6, rows=2, around=1)


def blade(**changes):
    rotation = cf.Rotation.of_blade(BLADE, omega=800.0, hub_radius=0.3, stagger=0.6)
    parts = {"thickness": 3e-3, "material": STEEL, "supports": {"root": cf.Clamped()}, "mesh": SMALL}
    return cf.Shell(**({"chart": BLADE, "rotation": rotation} | parts | changes))


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
    with pytest.raises(ValueError, match="axisymmetric casing at rest"):
        cf.modes(casing, 2, method="fourier")
