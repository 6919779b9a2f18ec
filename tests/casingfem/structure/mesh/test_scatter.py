"""Element matrices and what stands on edges as one sum, against the energies of motions."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.linalg.element_sum import ElementSum
from casingfem.structure.mesh.edge_form import EdgeForm
from casingfem.structure.mesh.jet_form import element_sum, scatter_blocks
from casingfem.structure.mesh.shell_mesh import make_grid
from casingfem.structure.shell.energies import modal_products, point_fields


@pytest.mark.parametrize(
    "supports",
    [
        {
            "base": cf.ElasticEdge(k_r=3e8, k_z=2e7, k_face=1e11, around=cf.FourierField.of({2: 0.3})),
            "top": cf.ShearDiaphragm(),
        },
        {"base": cf.ShearDiaphragm(), "top": cf.Ring(section=cf.edge.Section.rectangle(width=0.02, depth=0.01))},
    ],
)
def test_the_sum_of_elements_has_the_energy_of_motions(frustum, coarse, supports):
    """Springs that vary around, directions held in an edge's frame, a ring with turns of its own."""
    system = cf.shell.assemble(frustum(mesh=coarse, supports=supports))
    assert isinstance(system.stiffness, ElementSum)
    V = np.random.default_rng(4).standard_normal((system.size, 3))
    energies = modal_products(
        system.shell, point_fields(system.shell, system.grid, system.expand(V), system.expand_own(V))
    ).K
    np.testing.assert_allclose(V.T @ (system.stiffness @ V), energies, rtol=1e-10)
    np.testing.assert_allclose(V.T @ (system.K @ V), energies, rtol=1e-10)


GRID = make_grid(cf.Plate(length=2.0, width=3.0), cf.ShellMesh(order=2, rows=2, around=1))
SIZE = 5 * GRID.nodes.shape[1]


def symmetric(rng, *shape):
    one = rng.standard_normal(shape)
    return one + one.swapaxes(-1, -2)


def turned_frames():
    """Frames of nodes 1 and 4 that mix all five dofs; the others have none."""
    frames = np.tile(np.eye(5), (GRID.nodes.shape[1], 1, 1))
    rng = np.random.default_rng(6)
    frames[1], frames[4] = (np.linalg.qr(rng.standard_normal((5, 5)))[0] for _ in range(2))
    return frames


def block_diagonal(frames, size=SIZE):
    """x = F y, of dofs behind those of the nodes as they are."""
    whole = np.eye(size)
    for k, frame in enumerate(frames):
        whole[5 * k : 5 * k + 5, 5 * k : 5 * k + 5] = frame
    return whole


@pytest.mark.parametrize("frames", [np.tile(np.eye(5), (GRID.nodes.shape[1], 1, 1)), turned_frames()])
def test_elements_and_forms_are_summed_in_the_frames_of_nodes_on_the_free_dofs(frames):
    """A form with a dof of its own behind those of the nodes; two of its points have the same dofs."""
    rng = np.random.default_rng(5)
    size = SIZE + 2
    matrices = symmetric(rng, len(GRID.elements), 45, 45)
    dofs = np.array([[*range(5, 10), SIZE + 1, 17], [*range(5, 10), SIZE + 1, 17], [*range(20, 25), SIZE, 3]])
    form = EdgeForm(dofs=dofs, B=rng.standard_normal((3, 2, 7)), D=symmetric(rng, 3, 2, 2))
    free = np.setdiff1d(np.arange(size), [0, 7, 21, 40])
    dense = np.zeros((size, size))
    for element, matrix in zip(GRID.elements, matrices, strict=True):
        own = (5 * element[:, None] + np.arange(5)).ravel()
        dense[np.ix_(own, own)] += matrix
    dense += form.matrix(size).toarray()
    turn = block_diagonal(frames, size)
    found = element_sum(matrices.copy(), GRID, frames, free, [form])
    assert found.size == len(free)
    expected = (turn.T @ dense @ turn)[np.ix_(free, free)]
    np.testing.assert_allclose(found @ np.eye(len(free)), expected, rtol=1e-11, atol=1e-11)


def test_blocks_of_nodes_turn_with_their_frames():
    blocks, frames = symmetric(np.random.default_rng(8), GRID.nodes.shape[1], 5, 5), turned_frames()
    free = np.setdiff1d(np.arange(SIZE), [2, 24])
    turn = block_diagonal(frames)
    expected = (turn.T @ block_diagonal(blocks) @ turn)[np.ix_(free, free)]
    np.testing.assert_allclose(scatter_blocks(blocks, frames, free).toarray(), expected, rtol=1e-12, atol=1e-13)
