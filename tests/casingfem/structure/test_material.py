"""Isotropic material: plane stress, shear modulus, refusals."""

import numpy as np
import pytest

import casingfem as cf


def solid_stiffness(E, nu):
    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    C = np.zeros((6, 6))
    C[:3, :3] = lam + 2 * mu * np.eye(3)
    C[3:, 3:] = mu * np.eye(3)
    return C


@pytest.mark.parametrize("E", [1e6, 210e9, 1e12])
@pytest.mark.parametrize("nu", [-0.9, -0.2, 0.0, 0.3, 0.45])
def test_plane_stress_is_the_solid_with_the_normal_stress_condensed_out(E, nu):
    C = solid_stiffness(E, nu)
    kept, out = [0, 1, 5], [2]
    condensed = C[np.ix_(kept, kept)] - C[np.ix_(kept, out)] @ C[np.ix_(out, kept)] / C[2, 2]
    plane = cf.Material(E=E, nu=nu, rho=1.0).plane_stress()
    np.testing.assert_allclose(plane, condensed, rtol=1e-9, atol=1e-9 * E)
    assert np.linalg.eigvalsh(plane).min() > 0.0


def test_tension_in_one_direction_is_young():
    strain = np.linalg.solve(cf.Material(E=70e9, nu=0.33, rho=1.0).plane_stress(), [1.0, 0.0, 0.0])
    np.testing.assert_allclose(strain, [1 / 70e9, -0.33 / 70e9, 0.0], rtol=1e-12)


def test_shear_modulus_is_the_last_plane_stress_entry(steel):
    assert steel.plane_stress()[2, 2] == pytest.approx(steel.shear_modulus, rel=1e-14)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *(("E", v) for v in (0.0, -1.0, np.nan, np.inf)),
        *(("rho", v) for v in (0.0, -7800.0, np.nan, np.inf)),
        *(("nu", v) for v in (0.5, 0.7, -1.0, np.nan, np.inf)),
    ],
)
def test_refuses_what_no_material_is(name, value):
    with pytest.raises(ValueError, match=rf"material\.{name} must"):
        cf.Material(**({"E": 210e9, "nu": 0.3, "rho": 7800.0} | {name: value}))


def test_complex_values_pass_for_the_complex_step():
    E = cf.Material(E=210e9 + 1e-20j, nu=0.3, rho=7800.0)
    np.testing.assert_allclose(E.plane_stress().imag / 1e-20, E.plane_stress().real / 210e9, rtol=1e-14)
