"""The wall's mass: torsion of tubes of any wall, agreement of both paths, pairs that stay whole."""

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=200e9, nu=0.3, rho=7800.0)
BOTH = {"base": cf.Clamped(), "top": cf.Clamped()}
TORSION = np.sqrt(STEEL.shear_modulus / STEEL.rho) / (2.0 * 0.4)  # 3925.46 Hz, whatever the wall


@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")  # a wall of 0.2 R is thick for a shell
@pytest.mark.parametrize(("wall", "off"), [(0.002, 1e-9), (0.005, 1e-8), (0.01, 1e-7), (0.02, 1e-6)])
def test_torsion_of_a_tube_does_not_depend_on_its_wall(wall, off):
    """sqrt(G/rho)/(2 L) exactly. Without the coupling of u and w it is (t/R)^2/12 high: 8.3e-4 at t/R = 0.1."""
    tube = cf.Shell(chart=cf.Cylinder(radius=0.1, height=0.4), thickness=wall, material=STEEL, supports=BOTH)
    found = cf.modes(tube, band=(0.999 * TORSION, 1.001 * TORSION))
    torsion = found.freq[found.nodal_diameters == 0]
    np.testing.assert_allclose(torsion, [TORSION], rtol=off)


@pytest.mark.slow
@pytest.mark.parametrize("base", [cf.Clamped(), cf.ShearDiaphragm(), cf.ElasticEdge(k_r=1e9, k_z=1e9)])
def test_harmonics_and_the_whole_shell_agree_on_a_thick_cone(base):
    """On a diaphragm some displacements of a node are fixed and others take part in its rotations."""
    cone = cf.Shell(
        chart=cf.Frustum(r_base=0.1, r_top=0.07, height=0.2), thickness=0.01, material=STEEL,
        supports={"base": base, "top": cf.ElasticEdge(k_r=1e9, k_theta=1e9)},
        mesh=cf.ShellMesh(order=7, rows=2, around=9),
    )  # fmt: skip
    whole = cf.modes(cone, 6, method="shell")
    np.testing.assert_allclose(whole.freq, cf.modes(cone, 6).freq, rtol=2e-8)
    np.testing.assert_allclose(whole.splits, 0.0, atol=1e-10)
