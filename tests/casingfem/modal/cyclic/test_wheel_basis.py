"""A wheel as a basis: directions at its nodes, and what is stated of it."""

import numpy as np
import pytest

import casingfem as cf


@pytest.fixture(scope="module")
def quarter():
    """A quarter of a square block about z."""
    steel, groups = cf.Material(E=210e9, nu=0.3, rho=7800.0), {"low": (1, 0.0), "high": (0, 0.0), "held": (2, 0.0)}
    mesh = cf.imported.grid_mesh("hexahedron20", (2, 2, 1), lambda u: u * [0.1, 0.1, 0.05], groups=groups)
    return cf.imported.CyclicSector(
        structure=cf.Solid(mesh=mesh, material=steel, supports={"held": cf.Clamped()}), sectors=4
    )


def node(sector, place):
    mesh = sector.structure.mesh
    return int(mesh.node_numbers[np.linalg.norm(mesh.points - place, axis=1).argmin()])


@pytest.mark.slow
def test_a_wheel_shows_its_damping_its_sectors_and_its_mistuning(quarter):
    at = cf.modal.AtNodes((node(quarter, [0.1, 0.1, 0.05]),))
    tuned = cf.modal.cyclic_reduce(quarter, at, modes=1)
    equal = cf.modal.cyclic_reduce(quarter, at, modes=1, zeta=0.02, deviations=[0.0] * 4)
    np.testing.assert_array_equal(tuned.zeta, np.zeros(4))
    np.testing.assert_array_equal(equal.zeta, np.full(4, 0.02))
    np.testing.assert_array_equal(equal.omega, tuned.omega)
    assert (tuned.provenance["sectors"], tuned.provenance["mistuning"]) == (4, None)
    assert equal.provenance["mistuning"] == [0.0] * 4
    assert (tuned.kind, tuned.sectors, tuned.spin, tuned.stiffness_by_speed.shape) == ("point", 4, 0.0, (0, 0))
    one = cf.modal.cyclic_reduce(quarter, at, modes=1, deviations=[0.1, 0.0, 0.0, 0.0])
    assert one.provenance["mistuning"] == [0.1, 0.0, 0.0, 0.0]
    rise = one.omega / np.sort(tuned.omega)  # of a stiffer sector, 1.1 in its own frequency
    assert np.all((rise > 1.0 - 1e-9) & (rise < 1.1))
    assert rise.max() > 1.01


def test_six_modes_of_each_diameter_are_kept_if_nothing_is_stated(quarter):
    at = cf.modal.AtNodes((node(quarter, [0.1, 0.1, 0.05]),))
    assert len(cf.modal.cyclic_reduce(quarter, at)) == 4 * 6
    with pytest.raises(cf.errors.ModelError, match=r"zeta must lie in \[0, 1\), found -0\.001"):
        cf.modal.cyclic_reduce(quarter, at, zeta=-0.001)
