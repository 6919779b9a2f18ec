"""The mass of imported shells with bent walls is that of the solid between the faces, in modes, gravity and spin."""

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=200e9, nu=0.3, rho=7800.0)
RADIUS, LENGTH = 0.1, 0.4


def tube(u):
    angle = 2.0 * np.pi * u[:, 0]
    return np.stack([RADIUS * np.cos(angle), RADIUS * np.sin(angle), LENGTH * u[:, 1]], axis=1)


def shell(place, wall, kind="quad9", cells=(32, 8), **given):
    ends = {"base": (1, 0.0), "top": (1, 1.0)}
    mesh = cf.imported.grid_mesh(kind, cells, place, groups=ends, wrap=0)
    return cf.MeshShell(mesh=mesh, thickness=wall, material=STEEL, **given)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")  # a wall of 0.2 R is thick for a shell
@pytest.mark.parametrize(("kind", "cells", "off"), [("quad9", (24, 8), 3e-5), ("quad", (64, 12), 4e-3)])
def test_torsion_of_a_tube_does_not_depend_on_its_wall(kind, cells, off):
    """sqrt(G/rho)/(2 L) exactly; without the coupling of u and w (t/R)^2/12 above it: 3.3e-3 at t/R = 0.2."""
    exact = np.sqrt(STEEL.shear_modulus / STEEL.rho) / (2.0 * LENGTH)
    held = {"base": cf.Clamped(), "top": cf.Clamped()}
    found = cf.modes(shell(tube, 0.02, kind, cells, supports=held), band=(0.99 * exact, 1.01 * exact))
    np.testing.assert_allclose(found.freq[found.nodal_diameters == 0], [exact], rtol=off)
