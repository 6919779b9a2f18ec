"""The mass of imported shells with bent walls is that of the solid between the faces, in modes, gravity and spin."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.cells.mapped import cell_dofs, scatter, scatter_forces
from casingfem.structure.imported.cells.shell import directors, tangent_frames
from casingfem.structure.imported.loads import nodal_loads
from casingfem.structure.imported.shell_spin import shell_inertia

STEEL = cf.Material(E=200e9, nu=0.3, rho=7800.0)
RADIUS, LENGTH = 0.1, 0.4


def tube(u):
    angle = 2.0 * np.pi * u[:, 0]
    return np.stack([RADIUS * np.cos(angle), RADIUS * np.sin(angle), LENGTH * u[:, 1]], axis=1)


def band(u):
    """Of a sphere between heights -0.06 and 0.06."""
    angle, z = 2.0 * np.pi * u[:, 0], 0.12 * u[:, 1] - 0.06
    rho = np.sqrt(RADIUS**2 - z**2)
    return np.stack([rho * np.cos(angle), rho * np.sin(angle), z], axis=1)


def shell(place, wall, kind="quad9", cells=(32, 8), **given):
    ends = {"base": (1, 0.0), "top": (1, 1.0)}
    mesh = cf.imported.grid_mesh(kind, cells, place, groups=ends, wrap=0)
    return cf.MeshShell(mesh=mesh, thickness=wall, material=STEEL, **given)


def fall(acceleration):
    return cf.loads.Gravity(acceleration=tuple(acceleration))


def turned(mesh, W, centre):
    """W (x - centre) of the nodes and W n of their directors, (5 nodes,)."""
    n = directors(mesh)
    lean = np.einsum("nac,nc->na", tangent_frames(n), n @ W.T)
    return np.concatenate([(mesh.points - centre) @ W.T, lean], axis=1).ravel()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")  # a wall of 0.2 R is thick for a shell
@pytest.mark.parametrize(("kind", "cells", "off"), [("quad9", (24, 8), 3e-5), ("quad", (64, 12), 4e-3)])
@pytest.mark.parametrize("wall", [0.005, 0.02])
def test_torsion_of_a_tube_does_not_depend_on_its_wall(kind, cells, off, wall):
    """sqrt(G/rho)/(2 L) exactly; without the coupling of u and w (t/R)^2/12 above it: 3.3e-3 at t/R = 0.2."""
    exact = np.sqrt(STEEL.shear_modulus / STEEL.rho) / (2.0 * LENGTH)
    held = {"base": cf.Clamped(), "top": cf.Clamped()}
    found = cf.modes(shell(tube, wall, kind, cells, supports=held), band=(0.99 * exact, 1.01 * exact))
    np.testing.assert_allclose(found.freq[found.nodal_diameters == 0], [exact], rtol=off)


@pytest.mark.parametrize("wall", [0.001, 0.02])
def test_rigid_motions_have_the_inertia_of_the_solid_body(wall):
    """Of the tube m, m (R^2 + t^2/4) about its axis; of the band of a sphere the volume of all its shells r^2 dr."""
    part = shell(tube, wall, cells=(20, 2))
    M = part.assembled().M
    m = STEEL.rho * 2.0 * np.pi * RADIUS * wall * LENGTH
    about = m * (RADIUS**2 + wall**2 / 4.0)
    middle, across = np.array([0.0, 0.0, LENGTH / 2.0]), about / 2.0 + m * LENGTH**2 / 12.0
    turns = [turned(part.mesh, np.cross(axis, np.eye(3)).T, middle) for axis in np.eye(3)]
    np.testing.assert_allclose([x @ (M @ x) for x in turns], [across, across, about], rtol=5e-5)
    outer, inner = RADIUS + wall / 2.0, RADIUS - wall / 2.0
    volume = 2.0 * np.pi * (outer**3 - inner**3) / 3.0 * 0.12 / RADIUS
    ball = shell(band, wall, cells=(20, 4))
    for axis, weight in enumerate(nodal_loads(part, fall(np.eye(3)[axis])) for axis in range(3)):
        assert weight[:, axis].sum() == pytest.approx(m, rel=5e-5)
    assert nodal_loads(ball, fall([0.0, 0.0, 1.0]))[:, 2].sum() == pytest.approx(STEEL.rho * volume, rel=1.5e-4)
    area = 2.0 * np.pi * RADIUS * 0.12
    assert ball.density().mean() == pytest.approx(STEEL.rho * volume / area, rel=2e-4)  # its cells are unlike


def test_gravity_acts_on_the_middle_of_the_mass():
    """A director that leans feels the moment of the wall's outer side: forces are the mass times the fall."""
    part = shell(tube, 0.02, cells=(12, 2))
    nodes, acceleration = len(part.mesh.points), np.array([1.0, -2.0, 3.0])
    felt = nodal_loads(part, fall(acceleration))
    expected = (part.assembled().M @ np.tile(np.append(acceleration, [0.0, 0.0]), nodes)).reshape(nodes, 5)
    np.testing.assert_allclose(felt, expected, atol=1e-12 * np.abs(expected).max())
    assert np.abs(felt[:, 3:]).max() > 1e-3 * RADIUS * np.abs(felt[:, :3]).max()


@pytest.mark.parametrize("place", [tube, band])
def test_centrifugal_energy_does_not_change_with_a_turn_about_the_axis(place):
    """The energy's second order of a rigid turn W about the axis of rotation, v.S v + f.(W^2 x, W^2 n), is zero."""
    rotation = cf.Rotation(omega=1.0, axis=(2.0, -1.0, 2.0), centre=(0.3, 0.1, -0.2))
    part = shell(place, 0.02, cells=(12, 3))
    mesh = part.mesh
    of, rows, size = shell_inertia(part, rotation), cell_dofs(mesh.cells, 5), 5 * len(mesh.points)
    softening = scatter(of.softening, rows, size)
    force = scatter_forces(of.force, rows, size)
    W = np.cross(rotation.direction, np.eye(3)).T
    v, second = (turned(mesh, turn, rotation.centre) for turn in (W, W @ W))
    assert v @ (softening @ v) == pytest.approx(-(force @ second), rel=1e-12)
