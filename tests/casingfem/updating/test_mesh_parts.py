"""Numbers, derivatives and shares of mass of imported parts; modes followed through mixed shapes."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.updating.test_update_judged import blade

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
GROUPS = {"root": (0, 0.0), "tip": (0, 1.0)}


def solid():
    mesh = cf.imported.grid_mesh("hexahedron20", (2, 1, 1), lambda u: u * [0.3, 0.05, 0.02], groups=GROUPS)
    return cf.Solid(mesh=mesh, material=STEEL, supports={"root": cf.ElasticEdge(k_face=1e12)})


def skin():
    mesh = cf.imported.grid_mesh(
        "quad9", (2, 1), lambda u: np.column_stack([u * [0.3, 0.05], 0.0 * u[:, 0]]), groups=GROUPS
    )
    return cf.MeshShell(mesh=mesh, thickness=2e-3, material=STEEL, supports={"root": cf.Clamped()})


@pytest.fixture(scope="module", params=[solid, skin], ids=["solid", "skin"])
def found(request):
    return cf.modes(request.param(), 4)


def test_a_log_parameter_is_varied_in_decades(found):
    plain, log = (cf.Parameter(name="material.E", lower=1.0, upper=1e15, log=log) for log in (False, True))
    one, other = (cf.updating.eigen_derivatives(found, [p])[0] for p in (plain, log))
    np.testing.assert_allclose(other, np.log(10.0) * 210e9 * one, rtol=1e-9, atol=1e-6 * found.omega[0] ** 2)


def test_the_derivative_by_a_thickness_is_that_of_membrane_bending_and_mass():
    """omega^2 of a plate in bending goes as its thickness squared, but for shear."""
    modes = cf.modes(skin(), 1)
    slope = cf.updating.eigen_derivatives(modes, [cf.Parameter(name="shell.thickness", lower=1e-3, upper=1e-2)])[
        0, 0, 0
    ]
    assert slope * 2e-3 / modes.omega[0] ** 2 == pytest.approx(2.0, abs=1e-3)


def test_a_rotating_part_is_refused():
    turning = replace(skin(), rotation=cf.Rotation(omega=100.0))
    modes = replace(cf.modes(skin(), 1), structure=turning)
    with pytest.raises(cf.errors.ModelError, match=r"update: found a rotating part.*rotation-update"):
        cf.updating.eigen_derivatives(modes, [cf.Parameter(name="material.E", lower=1.0, upper=1e15)])


# --- followed through mixed shapes --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def plain():
    return cf.modes(blade(), 6)
