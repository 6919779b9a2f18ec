"""What a mesh does to bolts: elements around that do not follow them see some bolts stiffer than others.

Equal bolts at N places split n nodal diameters only if N divides 2n. On another number of elements each bolt lies
elsewhere in its element and is resolved differently well, and pairs split that symmetry keeps whole.
"""

import numpy as np
from scipy.linalg import eigh

from casingfem.io.arrays import FloatArray
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.mesh.element import gauss, lagrange
from casingfem.structure.mesh.shell_mesh import ShellMesh

SEEN = 1e-7  # estimated splits below this are not worth a warning
# a short wave of the edge takes some PULL E t, a tilt TILT D: fitted to reports.modes.loose_bolts
PULL, TILT = 0.05, 0.5
MOST = 96  # elements around up to which the default mesh follows every bolt


def following(least: int, count: int) -> int:
    """Elements around, at least so many, that follow `count` bolts: a multiple of them, of an equal share if too many.

    >>> following(21, 24), following(21, 16), following(21, 4), following(21, 200)
    (24, 32, 24, 50)
    """
    shares = [count // part for part in range(1, 5) if count % part == 0]
    wanted = [share * -(-least // share) for share in shares]
    return next((around for around in wanted if around <= MOST), wanted[0])


def springs_per_wave(bolts: Bolts, E: float, nu: float, thickness: float) -> float:
    """Stiffness of a bolt over what the shell's edge opposes to a short wave of it, the larger of pull and tilt."""
    rigidity = E * thickness**3 / (12.0 * (1.0 - nu**2))
    pull = np.max(np.real(bolts.stiffness)) / (PULL * E * thickness)
    return float(max(pull, np.real(bolts.k_rot) / (TILT * rigidity)))


def spurious_split(bolts: Bolts, mesh: ShellMesh, ratio: float, n_max: int = 12) -> float:
    """Order of magnitude of the largest relative split that the mesh alone gives pairs which equal bolts keep whole.

    A model of the edge alone: waves e^(i m theta) oppose with |m| (the shell's answer to short waves), bolts add
    `ratio` times their patches, both on the edge's own spectral elements; half the relative distance of its pairs.

    >>> follows, misses = (spurious_split(Bolts(count=24, k=1e8), ShellMesh(around=n, order=7), 3.0) for n in (24, 21))
    >>> bool(follows < 1e-10 < 1e-5 < misses)
    True
    """
    K, M, values, weights = edge_model(bolts, mesh)
    squares, waves = eigh(K, M)
    order = np.sqrt(np.maximum(squares, 0.0))
    at_points = values @ waves
    lam, shapes = eigh(np.diag(order) + ratio * at_points.T @ (weights[:, None] * at_points))
    splits = [0.0]
    for n in range(1, n_max + 1):
        own = np.round(order) == n
        if 2 * n % bolts.count and own.sum() == 2:  # else the mesh does not carry these waves
            pair = np.argsort(-(shapes[own] ** 2).sum(axis=0), kind="stable")[:2]
            splits.append(0.5 * float(np.ptp(lam[pair]) / lam[pair].mean()))
    return max(splits)


def edge_model(bolts: Bolts, mesh: ShellMesh) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Slope and mass matrices of a closed line of spectral elements, values at the patches' points and weights."""
    p, size = mesh.order, 2.0 * np.pi / mesh.around
    nodes = (np.arange(mesh.around)[:, None] * p + np.arange(p + 1)) % (mesh.around * p)
    x, w = gauss(p + 1)
    shape, slope = lagrange(p, x)
    K, M = np.zeros((2, mesh.around * p, mesh.around * p))
    np.add.at(K, (nodes[:, :, None], nodes[:, None, :]), (slope * w) @ slope.T / size)
    np.add.at(M, (nodes[:, :, None], nodes[:, None, :]), (shape * w) @ shape.T * size)
    places, weights, _ = bolts.points(size * np.arange(mesh.around + 1), True, p + 4)
    along = np.mod(places, 2.0 * np.pi) / size
    cell = np.minimum(along.astype(int), mesh.around - 1)
    values = np.zeros((len(places), len(K)))
    np.add.at(values, (np.arange(len(places))[:, None], nodes[cell]), lagrange(p, along - cell)[0].T)
    return K, M, values, weights
