"""The wall between its faces: strains at depth, section stiffness and inertia against their definitions."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.material import plane_stress
from casingfem.structure.mesh.kinematics import dot, frame, strain_slots
from casingfem.structure.shell import wall

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
DENTED = cf.Shell(
    chart=cf.Frustum(r_base=0.5, r_top=0.4, height=0.3), thickness=0.02, material=STEEL,
    radius_defect=cf.FourierField.of({5: 0.02, 3: (0.01, 0.02)}),
)  # fmt: skip
A, B, STEP = np.array([0.05, 0.11, 0.2]), np.array([0.3, 1.7, 4.0]), 1e-20
GRADIENT = np.array([[0.3, -0.2, 0.5], [0.1, 0.4, -0.6], [-0.7, 0.2, 0.1]])
BEND = np.random.default_rng(2).normal(size=(3, 3, 3))


def motion(a, b):
    """Position, normal, u and w of a field u = G X + X.B.X whose director stays normal: w_i = -a3 . D_i u."""
    surface = DENTED.geometry(a, b).surface
    basis, x = frame(surface), surface.x
    gradient = GRADIENT[:, :, None] + np.einsum("cij,jp->cip", BEND + BEND.transpose(0, 2, 1), x)
    u = GRADIENT @ x + np.einsum("cij,ip,jp->cp", BEND, x, x)
    e = (basis.e1, basis.e2)
    turned = [-np.einsum("cp,cip,ip->p", basis.normal, gradient, direction) for direction in e]
    return x, basis.normal, u, turned[0] * e[0] + turned[1] * e[1], np.stack(turned)


def rates(values):
    """Derivatives by both parameters (2, ...) of one of the outputs of `motion`, by the complex step."""
    return np.stack([values(A + 1j * STEP, B + 0j).imag, values(A + 0j, B + 1j * STEP).imag]) / STEP


@pytest.mark.parametrize("z", [-0.01, 0.004, 0.01])
def test_strains_at_depth_are_those_of_the_deformed_solid(z):
    """e_ab = sym(g_a . (u + z w),b) with g_a = X,a + z a3,a, in the frame of the surface."""
    surface = DENTED.geometry(A, B).surface
    L, at = strain_slots(surface)
    jets = [
        np.concatenate([values[2], values[4]]) for values in (motion(A, B),)
    ] + list(rates(lambda a, b: np.concatenate([motion(a, b)[2], motion(a, b)[4]])))  # fmt: skip
    mid = np.einsum("kscp,kcp->sp", L, np.stack(jets))
    assert np.abs(mid[6:]).max() < 1e-13 * np.abs(mid).max()
    found = np.einsum("prs,sp->rp", wall.strain_rows(wall.curvature(at), np.full(3, z)), mid[:6])

    g = rates(lambda a, b: motion(a, b)[0] + z * motion(a, b)[1])
    moved = rates(lambda a, b: motion(a, b)[2] + z * motion(a, b)[3])
    covariant = np.array([[dot(g[i], moved[j]) for j in range(2)] for i in range(2)])
    covariant = 0.5 * (covariant + covariant.swapaxes(0, 1)).transpose(2, 0, 1)
    G = np.array([[dot(g[i], e) for e in (at.basis.e1, at.basis.e2)] for i in range(2)]).transpose(2, 0, 1)
    exact = np.linalg.inv(G) @ covariant @ np.linalg.inv(G).transpose(0, 2, 1)
    np.testing.assert_allclose(found, [exact[:, 0, 0], exact[:, 1, 1], 2.0 * exact[:, 0, 1]], rtol=1e-11)


def section(b, t=0.02, nu=0.3):
    size = np.asarray(b).shape[1:]
    return wall.curved_wall(np.full(size, 1.0), np.full(size, nu), np.full(size, 0.3), np.full(size, t), np.asarray(b))


def test_a_flat_wall_is_plane_stress():
    flat = section(np.zeros((3, 1)))[..., 0]
    linear = wall.linear_wall(plane_stress(np.ones(1), np.full(1, 0.3)), np.full(1, 0.3), np.full(1, 0.02))[..., 0]
    np.testing.assert_allclose(flat, linear, atol=1e-16)


def test_a_turned_frame_turns_the_stiffness():
    """Isotropy: strains have the energy that they have in a frame turned by an angle, with the curvature turned too."""
    c, s = np.cos(0.7), np.sin(0.7)
    Q = np.array([[c, s], [-s, c]])

    def turned(m):
        full = Q @ np.array([[m[0], 0.5 * m[2]], [0.5 * m[2], m[1]]]) @ Q.T
        return np.array([full[0, 0], full[1, 1], 2.0 * full[0, 1]])

    b = np.array([4.0, -9.0, 3.0])
    strain = np.random.default_rng(1).normal(size=8)
    other = np.concatenate([turned(strain[:3]), turned(strain[3:6]), Q @ strain[6:]])
    around = turned([b[0], b[1], 2.0 * b[2]]) * [1.0, 1.0, 0.5]
    one, two = (v @ section(k[:, None])[..., 0] @ v for v, k in ((strain, b), (other, around)))
    assert one == pytest.approx(two, rel=1e-12)


def test_three_points_through_the_wall_leave_fourth_order(monkeypatch):
    """At a wall of a tenth of its radius 1e-6 of the bending stiffness, a sixteenth of it at half the wall."""
    three = [section([[0.0], [-5.0], [1.0]], t=t)[3:6, 3:6, 0] for t in (0.02, 0.01)]
    x, w = np.polynomial.legendre.leggauss(8)
    monkeypatch.setattr(wall, "depths", lambda: (0.5 * x, 0.5 * w))
    left = [
        np.abs(D - section([[0.0], [-5.0], [1.0]], t=t)[3:6, 3:6, 0]).max() / D.max()
        for D, t in zip(three, (0.02, 0.01), strict=True)
    ]
    assert left[0] < 2e-6
    assert left[0] / left[1] == pytest.approx(16.0, rel=0.1)


def test_complex_steps_pass():
    """Derivative of the stiffness by thickness and curvature against central differences."""
    b, h = np.array([[2.0], [-6.0], [1.5]]), 1e-6
    by_step = section(b + 1j * STEP, t=0.02 + 1j * STEP).imag / STEP
    by_difference = (section(b + h, t=0.02 + h) - section(b - h, t=0.02 - h)) / (2.0 * h)
    np.testing.assert_allclose(by_step, by_difference, atol=1e-8 * np.abs(by_step).max())
