"""Rotating imported parts: exact states, tangents, charts at the same speed, steady shapes, refusals."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
import contact as ct

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
ENDS = {"root": (0, 0.0), "tip": (0, 1.0)}
CLAMPED = {"root": cf.Clamped()}
LENGTH, WIDTH, THICK = 0.11, 0.04, 3e-3
AXES = {
    "flapping out of it": cf.Rotation(omega=0.0, axis=(0.0, 0.0, 1.0), centre=(-0.2, 0.0, 0.0)),
    "staggered, off the axis": cf.Rotation(omega=0.0, axis=(0.0, 1.0, 0.5), centre=(-0.2, 0.02, 0.01)),
}


def chart(rotation):
    return cf.Shell(
        chart=cf.Plate(length=LENGTH, width=WIDTH), thickness=THICK, material=STEEL, supports=CLAMPED,
        mesh=cf.ShellMesh(order=8, rows=2, around=2), rotation=rotation,
    )  # fmt: skip


def skin(rotation, counts=(12, 6), kind="quad9"):
    mesh = cf.imported.grid_mesh(
        kind, counts, lambda u: np.insert((u - [0.0, 0.5]) * [LENGTH, WIDTH], 2, 0.0, axis=1), groups=ENDS
    )
    return cf.MeshShell(mesh=mesh, thickness=THICK, material=STEEL, supports=CLAMPED, rotation=rotation)


def block(rotation, counts=(10, 4, 1)):
    mesh = cf.imported.grid_mesh(
        "hexahedron20", counts, lambda u: (u - [0.0, 0.5, 0.5]) * [LENGTH, WIDTH, THICK], groups=ENDS
    )
    return cf.Solid(mesh=mesh, material=STEEL, supports=CLAMPED, rotation=rotation)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "digits", "axis"), [(skin, 2e-3, "staggered, off the axis"), (block, 2e-2, "staggered, off the axis")]
)
def test_southwells_coefficients_are_those_of_the_chart(make, digits, axis):
    """d(omega^2)/d(Omega^2) of the first three modes: flap, torsion, second flap."""
    exact = cf.campbell(chart(AXES[axis]), [0.0], count=3)
    found = cf.campbell(make(AXES[axis]), [0.0], count=3)
    np.testing.assert_allclose(found.southwell, exact.southwell, rtol=digits, atol=digits)


@pytest.mark.slow
def test_a_spinning_casing_is_that_of_the_chart():
    rotation = cf.Rotation(omega=600.0)
    wall = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.01)
    mesh = cf.imported.grid_mesh(
        "quad9", (48, 6), lambda u: wall(np.insert(u, 0, 0.5, axis=1)), groups={"base": (1, 0.0)}, wrap=0
    )
    casing = cf.Shell(
        chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=0.01, material=STEEL,
        supports={"base": cf.Clamped()}, rotation=rotation, mesh=cf.ShellMesh(order=8, rows=1, around=11),
    )  # fmt: skip
    found = cf.modes(cf.MeshShell(
        mesh=mesh, thickness=0.01, material=STEEL, supports={"base": cf.Clamped()}, rotation=rotation
    ), 6)  # fmt: skip
    exact = cf.modes(casing, 6)
    rest = cf.modes(replace(casing, rotation=None), 6)
    assert np.abs(exact.freq / rest.freq - 1).min() > 0.1
    np.testing.assert_allclose(found.freq, exact.freq, rtol=2e-3)
    assert found.nodal_diameters.tolist() == exact.nodal_diameters.tolist()


@pytest.mark.slow
def test_linear_quadrilaterals_too():
    exact = cf.campbell(chart(AXES["flapping out of it"]), [0.0], count=1).southwell
    found = cf.campbell(skin(AXES["flapping out of it"], (24, 8), "quad"), [0.0], count=1).southwell
    np.testing.assert_allclose(found, exact, rtol=1e-2)


@pytest.mark.slow
def test_campbell_of_a_solid_follows_modes_and_equals_modes_at_speed():
    part = block(AXES["flapping out of it"])
    found = cf.campbell(part, [0.0, 500.0, 1000.0], count=3)
    at = cf.modes(replace(part, rotation=part.rotation.at(1000.0)), 6).freq
    for freq in found.freq[2]:
        assert np.abs(at / freq - 1.0).min() < 1e-9
    assert found.overlap.min() > 0.9
    assert np.all(np.diff(found.freq[:, 0]) > 0.0)


@pytest.mark.slow
def test_a_rotating_basis_knows_what_speed_adds():
    """stiffness_by_speed on its diagonal is Southwell's coefficient, but for Omega^4 and for what modes left out do."""
    part = skin(AXES["flapping out of it"].at(300.0))
    basis = cf.reduce(part, cf.Tip("tip"), modes=3)
    assert basis.spin == 300.0
    np.testing.assert_allclose(basis.freq, cf.modes(part, 3).freq, rtol=1e-10)
    rest = cf.campbell(part, [300.0], count=3)
    np.testing.assert_allclose(np.diag(basis.stiffness_by_speed), rest.southwell, rtol=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize("turn", [1.0, pytest.param(-1.0, marks=pytest.mark.campaign)])
def test_waves_of_a_spinning_drum_are_those_of_the_chart(turn):
    """Forward and backward waves apart by Coriolis forces: frequencies, nodal diameters, sense."""
    rotation = cf.Rotation(omega=turn * 600.0)
    wall = cf.imported.revolved((0.2, 0.2), (0.0, 0.1), 0.006)
    mesh = cf.imported.grid_mesh(
        "quad9", (44, 6), lambda u: wall(np.insert(u, 0, 0.5, axis=1)), groups={"base": (1, 0.0)}, wrap=0
    )
    given = {"thickness": 0.006, "material": STEEL, "supports": {"base": cf.Clamped()}, "rotation": rotation}
    coarse = cf.ShellMesh(order=8, rows=1, around=9)  # 3e-4 off the default one
    exact = cf.whirl_modes(cf.Shell(chart=cf.Cylinder(radius=0.2, height=0.1), mesh=coarse, **given), 6)
    found = cf.whirl_modes(cf.MeshShell(mesh=mesh, **given), 6)
    np.testing.assert_allclose(found.freq, exact.freq, rtol=3e-3)
    assert found.nodal_diameters.tolist() == exact.nodal_diameters.tolist()
    assert found.sense.tolist() == exact.sense.tolist()
    assert set(found.sense.tolist()) == {1, -1}
    splits = np.diff(found.freq)[::2], np.diff(exact.freq)[::2]
    np.testing.assert_allclose(*splits, rtol=2e-2)
    np.testing.assert_allclose(found.freq_fixed, exact.freq_fixed, rtol=3e-3)
    assert found.sturm_count >= 6


@pytest.mark.slow
def test_a_rigid_block_on_its_axis_on_round_springs_whirls_at_its_frequency_plus_and_minus_the_speed():
    """In the turning frame x'' - 2 Omega y' + (w^2 - Omega^2) x = 0, which gives w -+ Omega; along the axis w."""
    side, omega, speed = 0.1, 300.0, 90.0
    mesh = cf.imported.grid_mesh(
        "hexahedron20", (1, 1, 1), lambda u: (u - 0.5) * side, groups={"low": (2, 0.0), "high": (2, 1.0)}
    )
    k = 0.5 * omega**2 * STEEL.rho * side
    part = cf.Solid(
        mesh=mesh, material=STEEL, supports=dict.fromkeys(("low", "high"), cf.ElasticEdge(k_face=k)),
        rotation=cf.Rotation(omega=speed),
    )  # fmt: skip
    found = 2.0 * np.pi * cf.whirl_modes(part, 6).freq
    for exact in (omega - speed, omega, omega + speed):
        assert np.abs(found / exact - 1.0).min() < 1e-4


@pytest.mark.slow
def test_whirl_of_a_blade_has_no_waves():
    part = block(AXES["flapping out of it"].at(400.0), (6, 2, 1))
    found = cf.whirl_modes(part, 3)
    still = cf.modes(part, 3).freq
    assert found.nodal_diameters.tolist() == [-1] * 3
    assert 0.0 < np.abs(found.freq / still - 1.0).max() < 0.05
    with pytest.raises(cf.errors.ModelError, match="whirl_modes: found a structure without rotation"):
        cf.whirl_modes(block(None), 2)


@pytest.mark.slow
def test_softening_beyond_the_stiffness_is_refused():
    """Turning about its own span nothing stretches, and the softening wins beyond the first frequency."""
    about_span = cf.Rotation(omega=0.0, axis=(1.0, 0.0, 0.0))
    first = float(cf.modes(block(None), 1).omega[0])
    at_half = cf.modes(block(about_span.at(0.5 * first)), 1).omega[0]
    assert at_half == pytest.approx(first * np.sqrt(0.75), rel=2e-2)
    with pytest.raises(cf.errors.ModelError, match="rotation-unstable"):
        cf.modes(block(about_span.at(1.2 * first)), 1)


def test_parts_without_an_axis_or_without_support_are_named():
    with pytest.raises(cf.errors.ModelError, match="campbell: found a structure without rotation"):
        cf.campbell(block(None), [0.0])
    loose = replace(block(AXES["flapping out of it"].at(10.0)), supports={"root": cf.imported.Fixed(directions=("z",))})
    with pytest.raises(cf.errors.ModelError, match="static-loose"):
        cf.modes(loose, 3)


@pytest.mark.slow
def test_the_basis_of_a_blade_that_untwists_has_the_frequencies_near_its_speed():
    """Its steady shape follows the speed; its stiffness over speed is right to 0.25 % in the stated range."""
    axis = cf.Rotation(omega=0.0, axis=(0.0, 1.0, 1.0), centre=(-0.2, 0.05, 0.03))
    with pytest.warns(cf.errors.ModelWarning, match=r"from 223.1 to 253.4 Hz .*reduce-steady"):
        basis = cf.reduce(block(axis.at(1500.0)), cf.TipNodes("tip", 1), modes=6, zeta=0.0)
    body = ct.ModalBody.of(basis)
    found = np.sqrt(np.linalg.eigvalsh(body.matrices(1415.0)[1])[:3]) / (2.0 * np.pi)
    np.testing.assert_allclose(found, cf.modes(block(axis.at(1415.0)), 3).freq, rtol=2.5e-3)
    for omega in (0.0, 2.0 * np.pi * 222.0, 2.0 * np.pi * 254.0):
        with pytest.raises(ct.InputError, match=r"speed: found .* expected 223.1 to 253.4 Hz"):
            body.matrices(omega)
