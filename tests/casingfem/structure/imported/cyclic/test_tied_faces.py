"""Motions that a diameter admits: every pair of nodes, those on the axis, what a support holds."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.cells.shell import tangent_frames
from casingfem.structure.imported.cyclic.sector import assemble_cyclic
from tests.casingfem.structure.imported.parts import STEEL, flat

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-linear-cells")
R = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
FOOT = {"foot": (2, 0.0)}


def quarter(shell):
    """Two by two cells with corners on the axis; a solid stands on rollers."""
    if shell:
        mesh = cf.imported.grid_mesh("quad", (2, 2), lambda u: flat(u * [0.2, 0.2]))
        return cf.imported.CyclicSector(structure=cf.MeshShell(mesh=mesh, thickness=0.01, material=STEEL), sectors=4)
    mesh = cf.imported.grid_mesh("hexahedron", (2, 2, 2), lambda u: u * [0.2, 0.2, 0.3], groups=FOOT)
    rollers = {"foot": cf.imported.Fixed(directions=("z",))}
    return cf.imported.CyclicSector(structure=cf.Solid(mesh=mesh, material=STEEL, supports=rollers), sectors=4)


@pytest.mark.parametrize(("shell", "n", "within", "axis"), [
    (False, 0, 54 - 6, 0 + 1 + 1), (False, 1, 54 - 6, 3), (False, 2, 54 - 6, 0),
    (True, 0, 30, 1), (True, 1, 30, 2), (True, 2, 30, 0),
])  # fmt: skip
def test_high_faces_move_as_low_ones_turned_on_with_the_phase(shell, n, within, axis):
    """Unknowns: dofs of the six inner and low nodes of a layer, then what each node on the axis may do.

    Along the axis at n = 0, but where a roller holds it; across it at 1, directors too; nothing at 2.
    """
    sector = quarter(shell)
    made = assemble_cyclic(sector)
    system, T, (low, high) = made.system, made.tie(n), sector.pairs
    assert T.shape == (system.size, within + axis)
    assert T.dtype == (complex if n == 1 else float)
    rng = np.random.default_rng(7)
    q = rng.standard_normal(within + axis) + 1j * rng.standard_normal(within + axis) * (n == 1)
    fields = system.expand((T @ q)[:, None])[:, :, 0]
    phase = np.exp(0.5j * np.pi * n)
    np.testing.assert_allclose(fields[high, :3], phase * fields[low, :3] @ R.T, atol=1e-12)
    if shell:
        frames = tangent_frames(np.tile([0.0, 0.0, 1.0], (9, 1)))
        leaning = np.einsum("na,nac->nc", fields[:, 3:], frames)
        np.testing.assert_allclose(leaning[high], phase * leaning[low] @ R.T, atol=1e-12)
    others = np.setdiff1d(np.arange(len(fields)), high)
    inner = np.zeros(fields.shape, dtype=bool)
    inner.ravel()[system.free] = True
    inner[high] = False
    np.testing.assert_array_equal(fields[inner], q[:within])
    assert len(others) == (6 if shell else 18)
    on_axis = low[low == high]
    assert len(on_axis) == (1 if shell else 3)
    assert fields[on_axis].any() == bool(axis)
    alone = T[:, within:].toarray()
    np.testing.assert_allclose(alone.conj().T @ alone, np.eye(axis), atol=1e-12)
