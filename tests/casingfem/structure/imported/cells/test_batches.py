"""Cells taken some at a time, so that their strains fit into memory: the matrices of all of them at once."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported import solid_spin
from casingfem.structure.imported.cells import shell as shell_cells
from casingfem.structure.imported.cells import solid as solid_cells
from tests.casingfem.structure.imported.parts import STEEL, flat

BRASS = cf.Material(E=100e9, nu=0.35, rho=8500.0)


def part(kind):
    """Five cells of lengths and materials of their own."""
    shell = kind == "quad9"

    def place(u):
        x = np.stack([u[:, 0] ** 2 + 0.1 * u[:, 0], 0.3 * u[:, 1]], axis=1)
        return flat(x) if shell else np.column_stack([x, 0.2 * u[:, 2]])

    mesh = cf.imported.grid_mesh(kind, (5, 1) if shell else (5, 1, 1), place)
    mesh = replace(mesh, groups={"soft": cf.imported.Group(nodes=mesh.cells[[1, 4]].ravel(), cells=[1, 4])})
    given = {"mesh": mesh, "material": STEEL, "materials": {"soft": BRASS}}
    return cf.MeshShell(thickness=0.02, **given) if shell else cf.Solid(**given)


@pytest.mark.filterwarnings("ignore:.*mesh-linear-cells")
@pytest.mark.parametrize("at_a_time", [1, 2])
def test_matrices_of_cells_do_not_depend_on_how_many_are_taken_at_a_time(at_a_time, monkeypatch):
    shell, solid = part("quad9"), part("hexahedron")
    normals = shell_cells.directors(shell.mesh)
    frames = shell_cells.tangent_frames(normals)
    u = 1e-3 * np.random.default_rng(2).standard_normal(solid.mesh.points.shape)

    def made():
        some = np.array([4, 0, 2])
        bent = solid_spin.solid_stiffening(solid, u)
        return (
            shell_cells.stiffness(shell, normals, frames), shell_cells.stiffness(shell, normals, frames, some),
            solid_cells.cell_stiffness("hexahedron", solid.mesh.points, solid.mesh.cells, solid.constants()),
            bent.first, bent.second, np.array(bent.ratio),
        )  # fmt: skip

    once = made()
    np.testing.assert_allclose(once[1], once[0][[4, 0, 2]], rtol=1e-12, atol=1e-12 * np.abs(once[0]).max())
    monkeypatch.setattr(shell_cells, "CHUNK", at_a_time * 20 * 8 * 5 * 9)
    monkeypatch.setattr(solid_cells, "CHUNK", at_a_time * 8 * 6 * 8 * 3)
    monkeypatch.setattr(solid_spin, "CHUNK", at_a_time * 8 * 6 * 8 * 3)
    for found, expected in zip(made(), once, strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())
