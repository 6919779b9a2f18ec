"""One problem per harmonic: against exact solutions, and against the two-dimensional shell."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.modal.fourier import lowest
from casingfem.structure.shell.axisymmetric import harmonic_matrices

LINE = cf.ShellMesh(order=8, rows=2, around=1)


def cylinder(steel, thickness=5e-3, **changes):
    return cf.Shell(
        **{
            "chart": cf.Cylinder(radius=0.5, height=0.6),
            "thickness": thickness,
            "material": steel,
            "mesh": LINE,
            **changes,
        }
    )


def test_torsion_of_a_free_tube(steel):
    """u_theta = cos(m pi z/L): omega = m pi sqrt(G/rho)/L, up to the wall's own inertia of order (t/R)^2/12."""
    values, _ = lowest(harmonic_matrices(cylinder(steel), 0), 60, 1e4)
    omega = np.sqrt(np.maximum(values, 0.0))
    exact = np.pi * np.sqrt(steel.shear_modulus / steel.rho) / 0.6
    assert np.abs(omega / exact - 1).min() < 2e-5


def test_rigid_motions_of_a_free_casing_stand_at_n_0_and_1(steel, frustum):
    for shell in (cylinder(steel), frustum(supports={}, mesh=LINE)):
        rigid = [np.count_nonzero(lowest(harmonic_matrices(shell, n), 12, 1e4)[0] < (2 * np.pi) ** 2) for n in range(4)]
        assert rigid == [2, 2, 0, 0]  # along and about the axis; across and tilting, each twice in space


@pytest.mark.parametrize(
    "supports",
    [
        {"base": cf.Clamped()},
        {"base": cf.ShearDiaphragm(), "top": cf.ShearDiaphragm()},
        {"base": cf.ElasticEdge(k_face=1e12), "top": cf.ElasticEdge(k_r=1e7, k_theta=2e7, k_z=1e6, k_rot=1e4)},
    ],
    ids=["clamped", "diaphragms", "elastic"],
)
@pytest.mark.parametrize("n", [0, 1, 3, 6])
def test_stiffness_is_symmetric_and_positive(frustum, supports, n):
    meridian = harmonic_matrices(frustum(supports=supports, mesh=LINE), n)
    assert np.abs(meridian.K - meridian.K.T).max() < 1e-13 * np.abs(meridian.K).max()
    sliding = n == 0 and isinstance(supports["base"], cf.ShearDiaphragm)
    values, _ = lowest(meridian, 3, 1e4)
    assert values[0] > (0.0 if not sliding else -1e-2)
    assert meridian.mass.min() > 0.0


def test_vectors_are_mass_normalised_modes(frustum):
    meridian = harmonic_matrices(frustum(mesh=LINE), 5)
    values, vectors = lowest(meridian, 6, 1e4)
    np.testing.assert_allclose(vectors.T @ (meridian.mass[:, None] * vectors), np.eye(6), atol=1e-11)
    np.testing.assert_allclose(vectors.T @ meridian.K @ vectors, np.diag(values), atol=1e-9 * values[-1])


def test_meridian_converges_spectrally(frustum):
    """Error at n = 8 falls by more than a decade from order 4 to 6 to 8, down to the free edge's shear layer."""

    def f(order):
        mesh = cf.ShellMesh(order=order, rows=(0.0, 0.97, 1.0), around=1)
        return np.sqrt(lowest(harmonic_matrices(frustum(mesh=mesh), 8), 1, 1e4)[0][0])

    errors = np.array([abs(f(order) / f(14) - 1) for order in (4, 6, 8)])
    assert np.all(errors[1:] < 0.1 * errors[:-1])
    assert errors[-1] < 1e-5


@pytest.mark.parametrize(
    "changes",
    [
        {"radius_defect": cf.FourierField.of({3: 0.001})},
        {"thickness_defect": cf.FourierField.of({3: 0.001})},
    ],
)
def test_refuses_what_varies_around(frustum, changes):
    with pytest.raises(ValueError, match="nothing varies around"):
        harmonic_matrices(frustum(**changes), 2)
