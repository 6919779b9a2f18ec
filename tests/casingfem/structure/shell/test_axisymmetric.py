"""One problem per harmonic: against exact solutions, and how its error falls with the order."""

import numpy as np
import pytest

import casingfem as cf

LINE = cf.ShellMesh(order=8, rows=2, around=1)
TUBE = cf.Cylinder(radius=0.5, height=0.6)


def lowest(shell, n, count=40):
    """The lowest frequency of n nodal diameters [Hz]."""
    found = cf.modes(shell, count, method="fourier")
    return found.freq[found.nodal_diameters == n][0]


def test_torsion_of_a_free_tube(steel):
    """u_theta = cos(m pi z/L): omega = m pi sqrt(G/rho)/L, up to the wall's own inertia of order (t/R)^2/12."""
    tube = cf.Shell(chart=TUBE, thickness=5e-3, material=steel, mesh=LINE)
    exact = np.sqrt(steel.shear_modulus / steel.rho) / 0.6 / 2.0
    found = cf.modes(tube, band=(0.99 * exact, 1.01 * exact), method="fourier")
    assert np.abs(found.freq / exact - 1).min() < 2e-5


def test_rigid_motions_of_a_free_casing_are_at_n_0_and_1(steel, frustum):
    """Along and about the axis; across and tilting, each twice in space: six, and none at other n."""
    for shell in (cf.Shell(chart=TUBE, thickness=5e-3, material=steel, mesh=LINE), frustum(supports={}, mesh=LINE)):
        found = cf.modes(shell, 20, method="fourier")
        assert np.sum(found.freq < 1.0) == 6
        assert set(found.nodal_diameters[6:].tolist()) >= {2, 3}


def test_meridian_converges_spectrally(frustum):
    """Error at n = 8 falls by more than a decade from order 4 to 6 to 8, down to the free edge's shear layer."""

    def f(order):
        return lowest(frustum(mesh=cf.ShellMesh(order=order, rows=(0.0, 0.97, 1.0), around=1)), 8)

    errors = np.array([abs(f(order) / f(14) - 1) for order in (4, 6, 8)])
    assert np.all(errors[1:] < 0.1 * errors[:-1])
    assert errors[-1] < 1e-5


@pytest.mark.parametrize("name", ["radius_defect", "thickness_defect"])
def test_what_varies_around_has_no_harmonics_of_its_own(frustum, name):
    shell = frustum(**{name: cf.FourierField.of({3: 0.001})})
    with pytest.raises(cf.errors.ModelError, match=r"axisymmetric casing at rest.*modes-method"):
        cf.modes(shell, 4, method="fourier")


BAR = cf.edge.Section.rectangle(width=0.05, depth=0.04)
SPRINGS = cf.ElasticEdge(k_r=3e9, k_theta=2e9, k_z=4e9, k_rot=1e6)
THICK = {
    "clamped": {"supports": {"base": cf.Clamped()}},
    "on diaphragms, oblique to the axis": {"supports": {"base": cf.ShearDiaphragm(), "top": cf.ShearDiaphragm()}},
    "on springs": {"supports": {"base": SPRINGS, "top": cf.ElasticEdge(k_r=1e9)}},
    "with a ring": {"supports": {"base": cf.Clamped(), "top": cf.Ring(section=BAR, offset=(0.02, 0.01))}},
    "of two walls": {
        "supports": {"top": cf.Clamped()}, "strips": (cf.Strip(start=0.1, end=0.2, thickness=0.05),),
        "mesh": cf.ShellMesh(order=9, rows=(0.0, 0.5, 1.0), around=5),
    },
}  # fmt: skip


@pytest.mark.filterwarnings("ignore:.*shell-thick")
@pytest.mark.parametrize("name", THICK)
def test_a_thick_cone_has_the_modes_of_its_harmonics_to_round_off(steel, name):
    """The wall is half of the radius, so that its centre of mass is far from the middle: with 1e-3 of effect."""
    parts = {"mesh": cf.ShellMesh(order=9, rows=1, around=5)} | THICK[name]
    cone = cf.Shell(chart=cf.Frustum(r_base=0.3, r_top=0.2, height=0.2), thickness=0.15, material=steel, **parts)
    exact, found = (cf.modes(cone, 6, method=method).freq[:6] for method in ("fourier", "shell"))
    np.testing.assert_allclose(found, exact, rtol=2e-8)
