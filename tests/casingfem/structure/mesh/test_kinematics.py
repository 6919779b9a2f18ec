"""Shell strains: rigid motions give none, simple motions give the ones they must."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.mesh.kinematics import frame, strain_slots

STEP = 1e-30
A, B = (grid.ravel() for grid in np.meshgrid(np.linspace(0.01, 0.24, 5), np.linspace(-0.2, 0.2, 6)))
CHARTS = {
    "frustum": cf.Frustum(r_base=0.5, r_top=0.45, height=0.25),
    "cylinder": cf.Cylinder(radius=0.5, height=0.25),
    "panel": cf.Panel(radius=0.6, length=0.25, angle=0.5),
    "plate": cf.Plate(length=0.25, width=0.5),
}


class Dent:
    """f = .03 e^(3 z) sin(4 theta + 1), analytic, so that the complex step passes through the whole geometry."""

    def derivatives(self, z, theta):
        f = 0.03 * np.exp(3 * z) * np.sin(4 * theta + 1)
        f_t = 0.12 * np.exp(3 * z) * np.cos(4 * theta + 1)
        return cf.field.FieldValues(f, 3 * f, f_t, 9 * f, 3 * f_t, -16 * f)


def surface(chart, a, b, defect):
    return chart.surface(a, b, None if defect is None else defect.derivatives(a, b))


def strains(chart, motion, defect=None):
    """Strains (8, points) of a motion (surface, frame) -> (5, points), differentiated by the complex step."""

    def at(a, b):
        s = surface(chart, a, b, defect)
        return motion(s, frame(s))

    by_a, by_b = at(A + 1j * STEP, B + 0j).imag / STEP, at(A + 0j, B + 1j * STEP).imag / STEP
    jets = np.stack([at(A + 0j, B + 0j).real, by_a, by_b])
    L, _ = strain_slots(surface(chart, A, B, defect))
    return np.einsum("kscp,kcp->sp", L, jets)


def rigid(shift, turn):
    """u = shift + turn x X; the normal changes by turn x a3."""

    def motion(s, f):
        u = np.asarray(shift)[:, None] + np.cross(np.asarray(turn)[:, None], s.x, axis=0)
        change = np.cross(np.asarray(turn)[:, None], f.normal, axis=0)
        return np.concatenate([u, [np.sum(change * f.e1, axis=0), np.sum(change * f.e2, axis=0)]])

    return motion


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize(("name", "defect"), [*((n, None) for n in CHARTS), ("frustum", Dent()), ("panel", Dent())])
def test_rigid_motions_strain_nothing(name, defect, axis):
    motion = np.eye(6)[axis]
    found = strains(CHARTS[name], rigid(motion[:3], motion[3:]), defect)
    assert np.abs(found).max() < 2e-14


def test_a_motion_that_is_not_rigid_does_strain():
    found = strains(CHARTS["frustum"], lambda s, f: np.concatenate([s.x * 1e-3, 0 * s.x[:2]]), Dent())
    np.testing.assert_allclose(found[:2], 1e-3, rtol=1e-9)  # a dilation stretches all directions alike
    np.testing.assert_allclose(found[[2, 6, 7]], 0.0, atol=1e-15)


def test_breathing_cylinder_has_hoop_strain_and_curvature_change():
    """u = c a3: eps_22 = c/R, chi_22 = c/R^2, as D_2 a3 = e2/R and D_2 u = c e2/R (signs with the normal)."""
    found = strains(CHARTS["cylinder"], lambda s, f: np.concatenate([1e-3 * f.normal, 0 * f.normal[:2]]))
    outward = np.sign(frame(surface(CHARTS["cylinder"], A, B, None)).normal[0, 0])
    expected = np.zeros((8, A.size))
    expected[1], expected[4] = outward * 1e-3 / 0.5, 1e-3 / 0.5**2
    np.testing.assert_allclose(found, expected, atol=1e-16)


def test_stretched_plate():
    found = strains(CHARTS["plate"], lambda s, f: np.stack([s.x[0], -0.3 * s.x[1], 0 * s.x[0], *(0 * s.x[:2])]))
    np.testing.assert_allclose(found, np.outer([1, -0.3, 0, 0, 0, 0, 0, 0], np.ones(A.size)), atol=1e-15)


def test_sheared_plate():
    found = strains(CHARTS["plate"], lambda s, f: np.stack([s.x[1], 0 * s.x[1], 0 * s.x[1], *(0 * s.x[:2])]))
    np.testing.assert_allclose(found, np.outer([0, 0, 1, 0, 0, 0, 0, 0], np.ones(A.size)), atol=1e-15)


def test_bent_and_twisted_plate():
    """u_z = x^2/2 bends about y, u_z = x y twists; the normal follows, so there is no shear."""
    bent = strains(CHARTS["plate"], lambda s, f: np.stack([*(0 * s.x[:2]), s.x[0] ** 2 / 2, -s.x[0], 0 * s.x[0]]))
    twisted = strains(CHARTS["plate"], lambda s, f: np.stack([*(0 * s.x[:2]), s.x[0] * s.x[1], -s.x[1], -s.x[0]]))
    np.testing.assert_allclose(bent, np.outer([0, 0, 0, -1, 0, 0, 0, 0], np.ones(A.size)), atol=1e-15)
    np.testing.assert_allclose(twisted, np.outer([0, 0, 0, 0, 0, -2, 0, 0], np.ones(A.size)), atol=1e-15)


def test_a_normal_that_stays_behind_is_sheared():
    found = strains(CHARTS["plate"], lambda s, f: np.stack([*(0 * s.x[:2]), s.x[0] + 2 * s.x[1], *(0 * s.x[:2])]))
    np.testing.assert_allclose(found, np.outer([0, 0, 0, 0, 0, 0, 1, 2], np.ones(A.size)), atol=1e-15)


@pytest.mark.parametrize("defect", [None, Dent()])
def test_frame_is_orthonormal_and_measures_area(defect):
    s = surface(CHARTS["frustum"], A, B, defect)
    f = frame(s)
    e = np.stack([f.e1, f.e2, f.normal])
    np.testing.assert_allclose(np.einsum("aip,bip->pab", e, e), np.tile(np.eye(3), (A.size, 1, 1)), atol=1e-14)
    gram = np.sum(s.x1**2, 0) * np.sum(s.x2**2, 0) - np.sum(s.x1 * s.x2, 0) ** 2
    np.testing.assert_allclose(f.jacobian, np.sqrt(gram), rtol=1e-13)
