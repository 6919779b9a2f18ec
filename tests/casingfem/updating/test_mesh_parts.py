"""Numbers, derivatives and shares of mass of imported parts; modes followed through mixed shapes."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.correlation.matches import Match
from casingfem.updating.following import LostModeError, followed, moved, nodal_inertia, overlaps
from casingfem.updating.numbers import mesh_numbers
from casingfem.updating.sensitivity import product_derivatives
from tests.casingfem.updating.test_update_judged import blade

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
LEAD = cf.Material(E=16e9, nu=0.44, rho=11300.0)
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


def test_numbers_of_a_part_are_its_own():
    assert list(mesh_numbers(solid())) == ["material.E", "material.nu", "material.rho", "support.root.k_face"]
    assert list(mesh_numbers(skin())) == ["material.E", "material.nu", "material.rho", "shell.thickness"]
    assert cf.updating.get_value(solid(), "support.root.k_face") == 1e12
    assert cf.updating.with_value(skin(), "shell.thickness", 3e-3).thickness == 3e-3
    assert cf.updating.with_value(solid(), "material.nu", 0.25).material.nu == 0.25


def test_stiffness_is_linear_in_the_modulus_and_mass_in_the_density(found):
    """Of a solid on springs the springs' part of the stiffness does not change."""
    names = ("material.E", "material.rho")
    part = found.structure
    K, M = product_derivatives(found, [cf.Parameter(name=n, lower=1.0, upper=1e15) for n in names], found.fields)
    held = np.zeros((4, 4))
    if isinstance(part, cf.Solid):
        springs = cf.Parameter(name="support.root.k_face", lower=1.0, upper=1e15)
        held = product_derivatives(found, [springs], found.fields)[0][0] * 1e12
    size = found.omega[-1] ** 2
    np.testing.assert_allclose(K[0] * 210e9, np.diag(found.omega**2) - held, atol=1e-6 * size)
    np.testing.assert_allclose(M[1] * 7800.0, np.eye(4), atol=1e-6)
    np.testing.assert_allclose(K[1] * 7800.0, 0.0, atol=1e-6 * size)
    np.testing.assert_allclose(M[0] * 210e9, 0.0, atol=1e-6)


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


def test_the_mass_of_a_part_is_shared_among_the_nodes_of_each_cell(found):
    part = found.structure
    inertia = nodal_inertia(found)
    solid_part = isinstance(part, cf.Solid)
    cell = 0.3 * 0.05 / 2.0 * (0.02 if solid_part else 2e-3) * 7800.0
    corners = part.mesh.cells.shape[1]
    times = np.bincount(part.mesh.cells.ravel(), minlength=len(part.mesh.points))
    np.testing.assert_allclose(inertia, times * cell / corners, rtol=1e-9)


def test_overlaps_of_parts_go_by_their_displacements(found):
    """Whatever the scale, the sign, and the rotations of a shell."""
    fields = -3.0 * found.fields
    fields[:, 3:] += 1e3
    share = overlaps(found, replace(found, fields=fields))
    inertia = nodal_inertia(found)
    u = found.fields[:, :3]
    gram = np.einsum("nci,n,ncj->ij", u, inertia, u)
    norms = np.sqrt(np.diag(gram))
    np.testing.assert_allclose(share, (gram / np.outer(norms, norms)) ** 2, atol=1e-9)


def test_a_rotating_part_is_refused():
    turning = replace(skin(), rotation=cf.Rotation(omega=100.0))
    modes = replace(cf.modes(skin(), 1), structure=turning)
    with pytest.raises(cf.errors.ModelError, match=r"update: found a rotating part.*rotation-update"):
        cf.updating.eigen_derivatives(modes, [cf.Parameter(name="material.E", lower=1.0, upper=1e15)])


# --- followed through mixed shapes --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def plain():
    return cf.modes(blade(), 6)


def mixed(modes, shares):
    """New modes, the old first one spread over the first few of them by given shares."""
    first = np.sqrt(np.append(shares, 1.0 - sum(shares)))
    size = len(first)
    Q = np.linalg.qr(np.column_stack([first, np.eye(size)[:, 1:]]))[0]
    Q[:, 0] = first
    fields = modes.fields.copy()
    fields[:, :, :size] = np.einsum("nck,jk->ncj", modes.fields[:, :, :size], Q)
    return replace(modes, fields=fields)


def row_of(rows, modes):
    return Match(rows=rows, modes=modes, n=-1, confidence=1.0, measured_hz=(1.0,), computed_hz=(2.0,))


def table():
    return cf.FrequencyTable.from_arrays(freq_hz=[100.0, 200.0], sigma_hz=1.0)


@pytest.mark.parametrize(("largest", "lost"), [(0.334, False), (0.3327, True)])
def test_a_mode_is_lost_with_less_than_a_third_of_it(plain, largest, lost):
    """It goes to the new mode that has most of it, here the third."""
    new = mixed(plain, [0.2, 0.25, largest])
    pairing = cf.correlation.Pairing(matches=(row_of((1,), (0,)),), unpaired_rows=(0,), unpaired_modes=(1, 2, 3, 4, 5))
    if lost:
        with pytest.raises(LostModeError, match=r"rows \(1,\): only 0\.33 of their mode is found again") as caught:
            followed(pairing, plain, new, table())
        assert caught.value.rows == (1,)
        return
    after = followed(pairing, plain, new, table())
    assert after.matches[0].modes == (2,)
    assert after.matches[0].computed_hz == (new.freq[2],)
    assert after.unpaired_modes == (0, 1, 3, 4, 5)
    assert after.unpaired_rows == (0,)


def test_the_member_of_a_pair_that_a_row_stands_for_is_the_nearer(plain):
    """Of half a doublet as a plane; a mode without a partner stays."""
    new = replace(plain, doublets=((1, 2),), freq=np.array([90.0, 150.0, 190.0, 300.0, 400.0, 500.0]))
    assert moved(row_of((1,), (4,)), [1], True, new, table()).modes == (2,)
    assert moved(row_of((0,), (4,)), [2], True, new, table()).modes == (1,)
    assert moved(row_of((0,), (4,)), [2], False, new, table()).modes == (2,)
    assert moved(row_of((1,), (4,)), [3], True, new, table()).modes == (3,)
    assert moved(row_of((1,), (4,)), [3], True, new, table()).computed_hz == (300.0,)
