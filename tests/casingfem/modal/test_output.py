"""Outputs of a reduced blade: displacement and strain at named places, right where the load is."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
import contact as ct
from reports.verification.rubs.harmonic_basis import harmonic_basis

LENGTH, WIDTH, THICKNESS = 0.11, 0.04, 5e-3


@pytest.fixture(scope="module")
def strip():
    steel = cf.Material(E=210e9, nu=0.0, rho=7800.0)
    return cf.Shell(
        chart=cf.Plate(length=LENGTH, width=WIDTH), thickness=THICKNESS, material=steel,
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=6, rows=2, around=1),
    )  # fmt: skip


OUTPUTS = (
    cf.modal.Strain(name="root strain", at=(0.02, 0.0)),
    cf.modal.Strain(name="below", at=(0.02, 0.0), side=-1.0),
    cf.modal.Displacement(name="middle", at=(0.5 * LENGTH, 0.01)),
    cf.modal.Displacement(name="tip x", at=(LENGTH, 0.0), direction="x"),
)


@pytest.mark.parametrize("method", ["free", "craig-bampton"])
def test_a_tip_load_strains_the_root_as_a_beam(strip, method):
    """eps = F (L - x) (t/2)/(E I) and the full model's deflection, with one mode kept and the residual."""
    basis = cf.reduce(strip, cf.TipNodes(count=4), modes=2, method=method, outputs=OUTPUTS)
    force = 40.0
    lam = np.zeros(12)
    lam[1::3] = force / 4.0  # each piece pushed along flap
    q = basis.rows.T @ lam / basis.omega**2
    root, below, middle, along = basis.output_rows @ q + basis.output_S @ lam
    bending = 210e9 * WIDTH * THICKNESS**3 / 12.0
    exact = force * (LENGTH - 0.02) * 0.5 * THICKNESS / bending
    sign = np.sign(middle)
    assert root == pytest.approx(-sign * exact, rel=2e-3)
    assert below == pytest.approx(-root, rel=1e-9)
    full = cf.shell.solve_static(strip, [cf.loads.EdgeLoad(edge="tip", force=(0.0, 0.0, sign * force / WIDTH))])
    assert middle == pytest.approx(full.at(0.5 * LENGTH, 0.01)[2], rel=1e-4)
    assert abs(along) < 1e-12


@pytest.mark.filterwarnings("ignore:.*(support-soft|shell-thick)")  # a ring, held by next to nothing
def test_hoop_strains_of_a_thick_ring_that_widens_are_inverse_to_the_radius():
    """Its strain is w/(R + z): on the faces of the wall, whose radii are R - t/2 and R + t/2."""
    R, t, height = 0.1, 0.015, 0.01
    ring = cf.Shell(
        chart=cf.Cylinder(radius=R, height=height), thickness=t, mesh=cf.ShellMesh(order=5, rows=1, around=5),
        material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.ElasticEdge(k_theta=1e3, k_z=1e3)},
    )  # fmt: skip
    faces = [cf.modal.Strain(name=f"{z:+d}", at=(0.5 * height, 0.3), component="22", side=z) for z in (1, -1)]
    basis = cf.reduce(ring, cf.Rim("top", n_max=2), modes=10, outputs=tuple(faces))
    k = basis.channels.index("radial.cos0")
    inner, outer = basis.output_rows @ (basis.rows[k] / basis.omega**2) + basis.output_S[:, k]
    assert inner / outer == pytest.approx((R + 0.5 * t) / (R - 0.5 * t), rel=1e-2)


def test_around_the_axis_there_is_no_direction_on_it(strip):
    """The z axis meets the plate in the middle of its root; beside it radial is along the plate, tangential across."""
    system = cf.shell.assemble(strip)

    def row(direction, x):
        return cf.modal.Displacement(name="u", at=(x, 0.0), direction=direction).row(system)

    for direction, cartesian in (("radial", "x"), ("tangential", "y")):
        np.testing.assert_allclose(row(direction, 1e-9), row(cartesian, 1e-9), atol=1e-12)
        with pytest.raises(cf.errors.ModelError, match=f"output 'u': found {direction} on the axis.*output-direction"):
            row(direction, 0.0)


def test_outputs_survive_the_file_and_the_modes_cut_off(strip, tmp_path):
    basis = cf.reduce(strip, cf.TipNodes(count=2), modes=8, outputs=OUTPUTS)
    body = ct.ModalBody.load(basis.save(tmp_path / "blade.npz"))
    assert body.outputs == ("root strain", "below", "middle", "tip x")
    few = body.truncated(float(body.omega[2]) * 1.01)
    lam = np.array([[1.0, 2.0, -0.5, 0.3, -1.0, 2.0]])
    values = [(lam @ b.rows / b.omega**2) @ b.output_rows.T + lam @ b.output_S.T for b in (body, few)]
    assert few.omega.size == 3
    np.testing.assert_allclose(values[1], values[0], rtol=1e-9, atol=1e-18)
    few.save(tmp_path / "few.npz")
    again = ct.ModalBody.load(tmp_path / "few.npz")
    assert again.outputs == few.outputs
    assert np.array_equal(again.output_S, few.output_S)


def turning_frequencies(basis, omega):
    """Frequencies [Hz] of a reduced body that turns at omega [rad/s], in its own frame."""
    C, K = ct.ModalBody.of(basis).matrices(omega)
    m = len(C)
    values = np.linalg.eigvals(np.block([[np.zeros((m, m)), np.eye(m)], [-K, -C]]))
    return np.sort(values.imag[values.imag > 0.0]) / (2.0 * np.pi)


@pytest.mark.slow
def test_a_rotating_blade_brings_its_stiffening(strip):
    rotation = cf.Rotation.of_blade(strip.chart, omega=0.0, hub_radius=0.3)
    basis = cf.reduce(replace(strip, rotation=rotation), cf.Tip(), modes=4)
    exact = cf.whirl_modes(replace(strip, rotation=rotation.at(300.0)), 4).freq
    np.testing.assert_allclose(turning_frequencies(basis, -300.0), exact, rtol=1e-8)
    found = cf.campbell(replace(strip, rotation=rotation), [0.0, 300.0], count=3)
    turning = cf.reduce(replace(strip, rotation=rotation.at(300.0)), cf.Tip(), modes=3)
    assert turning.spin == -300.0  # about the chord, from flap to span
    np.testing.assert_allclose(turning.freq, found.freq[1], rtol=1e-9)


@pytest.mark.slow
def test_the_axial_channels_of_a_perfect_casing_agree_with_the_shell(frustum):
    rim = cf.Rim("top", n_max=6, axial=True)
    shell = frustum(mesh=cf.ShellMesh(order=6, rows=2, around=9))
    harmonic = harmonic_basis(shell, rim, orders=2)
    full = cf.reduce(shell, rim, modes=20)
    assert harmonic.channels == full.channels
    scale = np.abs(full.compliance).max()
    np.testing.assert_allclose(harmonic.compliance, full.compliance, atol=2e-3 * scale)
    assert np.abs(full.compliance[26:, :26]).max() > 1e-2 * scale  # radial pushes move the rim along the axis


def test_bad_outputs_are_refused(strip):
    for output, match in (
        (cf.modal.Displacement(name="a", at=(0.0, 0.0), direction="up"), "found direction 'up'"),
        (cf.modal.Strain(name="a", at=(0.0, 0.0), component="33"), "component '33'"),
        (cf.modal.Strain(name="a", at=(0.0, 0.0), side=2.0), r"side 2\.0"),
        (cf.modal.Displacement(name="a", at=(0.2, 0.0)), "outside the surface"),
    ):
        with pytest.raises(ValueError, match=match):
            cf.reduce(strip, cf.Tip(), modes=2, outputs=[output])
    with pytest.raises(ValueError, match="expected each once"):
        cf.reduce(strip, cf.Tip(), modes=2, outputs=[OUTPUTS[0], OUTPUTS[0]])
