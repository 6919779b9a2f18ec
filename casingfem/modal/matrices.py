"""A structure or a basis as matrices M, K, C, G with the meaning of their rows, for other programs."""

import numpy as np
from scipy.linalg import cho_factor, cho_solve, null_space, pinv
from scipy.sparse import bsr_array, csc_array

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray, IntArray
from casingfem.modal.basis import ModalBasis
from casingfem.structure.imported.assembly import MeshStructure, require_structure
from casingfem.structure.imported.matrix.matrix_set import MatrixSet
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.shell import Shell

SOUND = 1e-9  # least over largest eigenvalue of S, and of rows, below which they cannot be inverted


def structure_matrices(structure: Shell | MeshStructure) -> MatrixSet:
    """K and M of a structure on its free dofs [SI], nodes by their numbers.

    Shells have two rotations about local tangents at each node, labelled 4 and 5, and a third, labelled 6, where walls
    meet; other programs cannot use them outside the matrices. Nodes of a chart are counted from 1.

    Raises
    ------
    ModelError
        `matrix-size` for a shell whose edges have additional dofs, or fixed directions that are not Cartesian.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=6, rows=2, around=1))
    >>> found = structure_matrices(plate)
    >>> found.K.shape, bool(abs(found.K - found.K.T).max() < 1e-3)
    ((420, 420), True)
    """
    if isinstance(structure, Shell):
        system = assemble(structure)
        parts = slice(0, 3), slice(3, system.dofs)
        straight = all(np.all(system.frames[:, part, part] == np.eye(part.stop - part.start)) for part in parts)
        if system.own or system.change is not None or not straight:
            found = "found rings, masses or an edge that is fixed along its own directions"
            raise ModelError("matrix-size", f"matrices: {found}, expected dofs along x, y, z alone")
        numbers = np.arange(1, len(system.points) + 1)
        nodes = np.arange(len(numbers) + 1)
        back = bsr_array((np.linalg.inv(system.frames), nodes[:-1], nodes)).tocsc()[system.free][:, system.free]
        K, M = (csc_array(back.T @ A @ back) for A in (system.K, system.M))
        return of_system(K, M, system.free, system.dofs, numbers, system.points)
    require_structure(structure, "matrices")
    assembled = structure.assembled()
    mesh = structure.mesh
    if assembled.lift is not None:
        raise ModelError("matrix-size", f"matrices: found connections between nodes in {mesh.source}, expected none")
    return of_system(assembled.K, assembled.M, assembled.free, assembled.dofs, mesh.labels, mesh.points)


def of_system(
    K: csc_array, M: csc_array, free: IntArray, width: int, numbers: IntArray, points: FloatArray
) -> MatrixSet:
    """Matrices on the free dofs, labelled."""
    dofs = np.stack([numbers[free // width], free % width + 1], axis=1)
    used = np.unique(free // width)
    places = dict(zip(numbers[used].tolist(), points[used], strict=True))
    return MatrixSet(K=K, M=M, dofs=dofs, points=places)


def basis_matrices(basis: ModalBasis) -> MatrixSet:
    """A basis as matrices on its channels u and scalars q: exactly the same body, static and dynamic.

    With residual compliance lam = S^-1 (u - rows q), and the channels have no mass:

        K = [[S^-1, -S^-1 rows], [-rows^T S^-1, omega^2 + rows^T S^-1 rows]],   M = [[0, 0], [0, 1]]

    Without it (Craig-Bampton) the modes are rotated so that the channels come first: q = rows^+ u + Z z, rows Z = 0.
    C and G are those of q in the same coordinates; K is that at the speed of the basis. Channels such as 6.x keep node
    and direction; others are scalars 1, 2, ... in the basis's order, and so are q.

    Raises
    ------
    ModelError
        `matrix-size` if channels are dependent: S is singular and not zero, or rows have less rank than channels.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=6, rows=2, around=1))
    >>> basis = cf.reduce(plate, cf.Tip(), modes=4)
    >>> basis_matrices(basis).K.shape  # two channels and four modes
    (6, 6)
    """
    k, m = basis.rows.shape
    stiff, damp = np.diag(basis.omega**2), np.diag(2.0 * basis.zeta * basis.omega)
    stiff = stiff + basis.stiffness if basis.stiffness.size else stiff
    damp = damp + basis.damping if basis.damping.size else damp
    turn = basis.gyroscopic if basis.gyroscopic.size else np.zeros((m, m))
    if basis.S.any():
        sizes = np.linalg.eigvalsh(basis.S)
        if sizes[0] <= SOUND * sizes[-1]:
            raise ModelError("matrix-size", f"basis: found a singular S, eigenvalues {sizes[0]:.1e} to {sizes[-1]:.1e}")
        factor = cho_factor(basis.S)
        R, inverse = cho_solve(factor, basis.rows), cho_solve(factor, np.eye(k))
        K = np.block([[inverse, -R], [-R.T, stiff + basis.rows.T @ R]])
        M = np.diag(np.concatenate([np.zeros(k), np.ones(m)]))
        C, G = (np.pad(part, ((k, 0), (k, 0))) for part in (damp, turn))
    else:
        sizes = np.linalg.svd(basis.rows, compute_uv=False)
        if k > m or sizes[-1] <= SOUND * sizes[0]:
            found = f"found {k} channels whose motions in {m} modes are not independent"
            raise ModelError("matrix-size", f"basis: {found}, expected more modes or fewer channels")
        T = np.hstack([pinv(basis.rows), null_space(basis.rows)])
        K, M, C, G = T.T @ (stiff @ T), T.T @ T, T.T @ (damp @ T), T.T @ (turn @ T)
    damping, gyroscopic = (csc_array(part) if part.any() else None for part in (C, 0.5 * (G - G.T)))
    dofs = channel_dofs(basis, len(K) - k)
    return MatrixSet(K=csc_array(K), M=csc_array(M), C=damping, G=gyroscopic, dofs=dofs)


def channel_dofs(basis: ModalBasis, scalars: int) -> IntArray:
    """Node and direction of the channels, then the scalars."""
    labels = [name.rpartition(".") for name in basis.channels]
    plain = all(node.isdecimal() and axis in ("x", "y", "z") for node, _, axis in labels)
    if plain:
        dofs = [(int(node), 1 + "xyz".index(axis)) for node, _, axis in labels]
    else:
        dofs = [(number, 0) for number in range(1, len(labels) + 1)]
    top = max(node for node, _ in dofs)
    return np.array([*dofs, *((top + 1 + i, 0) for i in range(scalars))])
