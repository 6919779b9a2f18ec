"""Casings as three-dimensional solids on the chart and the fields of a shell: what shells are fixed against.

Spectral hexahedra between the faces X +- t/2 a3; the nodes of each are the points of its Lobatto rule, so that the mass
is diagonal. A casing whose fields have k equal parts around is one of them, with the wave's phase at its seam,

    u(theta + 2 pi/k) = Q e^(2 pi i c/k) u(theta),   c = 0 .. k/2,   Q the turn by 2 pi/k:

class c holds the nodal diameters c mod k and -c mod k. Classes other than 0 and k/2 are complex, and each of their
modes is a pair of equal frequency. (Bloch's theorem; D.L. Thomas, J. Sound Vib. 66, 1979, 585.)
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, block_diag, coo_array, csc_array, diags_array, hstack, vstack
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.structure.edge.support import Clamped, ElasticEdge
from casingfem.structure.mesh.element import lagrange, lobatto
from casingfem.structure.mesh.kinematics import frame
from casingfem.structure.shell.shell import Shell
from reports.verification.spectral_solid import Orders

SAMPLES = 512  # places around the rim at which shapes are read


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidMesh:
    """Orders along the axis, around and through the wall; rows along the axis, elements around one part."""

    orders: Orders
    rows: tuple[float, ...]
    around: int


@dataclass(frozen=True, slots=True, eq=False)
class SolidModes:
    """Frequencies [Hz], ascending, nodal diameters of the rim's radial motion, an antinode's angle [rad], unknowns.

    The angle lies in [0, pi/n); nan where n = 0 and in classes whose pairs are equal.
    """

    freq: FloatArray
    n: IntArray
    angle: FloatArray
    dofs: int


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """One of the k parts: K (3 nodes, 3 nodes), all u_x first, mass (nodes,), and what is known of its nodes.

    `motions` are what its support leaves free, (3 nodes, free), the nodes of the last line left out; `seam` pairs these
    with those of the first, (2, pairs); `rim` are nodes of one line around the top, (elements, order + 1).
    """

    K: csc_array
    mass: FloatArray
    motions: csc_array
    seam: IntArray
    rim: IntArray


def lattice(mesh: SolidMesh) -> tuple[IntArray, tuple[FloatArray, FloatArray]]:
    """Node numbers of each element (elements, nodes of one), and lines of nodes along the axis and around, 0 to 1."""
    p, q, r = mesh.orders
    counts = (len(mesh.rows) - 1) * p + 1, mesh.around * q + 1, r + 1
    number = np.arange(np.prod(counts)).reshape(counts)
    elements = [
        number[i * p : i * p + p + 1, j * q : j * q + q + 1].ravel()
        for i in range(len(mesh.rows) - 1)
        for j in range(mesh.around)
    ]
    cuts = np.asarray(mesh.rows), np.linspace(0.0, 1.0, mesh.around + 1)
    lines = tuple(
        np.append((c[:-1, None] + np.diff(c)[:, None] * lobatto(order)[0][:-1]).ravel(), 1.0)
        for c, order in zip(cuts, (p, q), strict=True)
    )
    return np.array(elements), lines  # type: ignore[return-value]


def element_slopes(orders: Orders) -> tuple[list[FloatArray], FloatArray]:
    """Derivatives along the three sides of the unit cube at its nodes, each (nodes, nodes), and the rule's weights."""
    rules = [lobatto(order) for order in orders]
    units = [np.eye(order + 1) for order in orders]
    slopes = [lagrange(order, rule[0])[1].T for order, rule in zip(orders, rules, strict=True)]
    sides = [[slopes[j] if j == k else units[j] for j in range(3)] for k in range(3)]
    return [np.kron(np.kron(a, b), c) for a, b, c in sides], np.einsum("i,j,k->ijk", *(w for _, w in rules)).ravel()


def make_part(shell: Shell, mesh: SolidMesh, parts: int, *, breathes: bool = False) -> Part:
    """Stiffness and mass of the first of `parts` parts of a casing between its faces, springs on its base included.

    A clamp fixes the whole face of the base; if the wall `breathes` there, its motion along the normal is fixed in the
    mean over the thickness alone, as a shell's clamp holds it.
    """
    elements, (along, around) = lattice(mesh)
    (z0, z1), _ = shell.chart.bounds
    through = lobatto(mesh.orders[2])[0]
    z, theta, w = (
        x.ravel()
        for x in np.meshgrid(z0 + (z1 - z0) * along, 2.0 * np.pi / parts * around, through - 0.5, indexing="ij")
    )
    at = shell.geometry(z, theta)
    place = at.surface.x + frame(at.surface).normal * (at.thickness * w)
    slopes, weights = element_slopes(mesh.orders)
    size = 3 * elements.shape[1]
    matrices, mass = np.empty((len(elements), size, size)), np.zeros(len(z))
    for e, nodes in enumerate(elements):
        matrices[e], own = stiffness_of(place[:, nodes], slopes, weights, at.E[nodes], at.nu[nodes])
        np.add.at(mass, nodes, at.rho[nodes] * own)
    dofs = (elements[:, None, :] + len(z) * np.arange(3)[:, None]).reshape(len(elements), -1)
    i, j = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
    K = coo_array((matrices.ravel(), (i.ravel(), j.ravel())), shape=(3 * len(z), 3 * len(z))).tocsc()
    number = np.arange(len(z)).reshape(len(along), len(around), len(through))
    base = number[0].ravel()
    support = shell.supports["base"]
    if isinstance(support, ElasticEdge):
        area = np.zeros(len(z))
        area[base] = face_area(place[:, base].reshape(3, len(around), -1), mesh)
        K = K + diags_array(np.tile(support.k_face * area * support.factor("k_face", z, theta), 3))
    middle = mesh.orders[2] // 2
    rim, last = number[-1, :, middle], number[:, -1].ravel()
    free = np.ones(len(z), dtype=bool)
    free[last] = False
    lines = np.zeros((0, len(through)), dtype=int)
    if isinstance(support, Clamped):
        free[base] = False
        lines = number[0, :-1] if breathes else lines
    normals = frame(at.surface).normal[:, lines[:, 0]]
    return Part(
        K=csc_array(K),
        mass=mass,
        motions=motions_of(np.flatnonzero(free), lines, normals, lobatto(mesh.orders[2])[1], len(z)),
        seam=np.stack([last, number[:, 0].ravel()]),
        rim=rim[np.arange(mesh.around)[:, None] * mesh.orders[1] + np.arange(mesh.orders[1] + 1)],
    )


def motions_of(free: IntArray, lines: IntArray, normals: FloatArray, weights: FloatArray, nodes: int) -> csc_array:
    """Columns (3 nodes, motions): three for each free node, and those along the normals of lines through the wall.

    Nodes of a line (lines, through) move along its normal (3, lines) with mean 0, by the rule's weights (through,).
    """
    units = coo_array((np.ones(len(free)), (free, np.arange(len(free)))), shape=(nodes, len(free)))
    stretches = np.vstack([np.eye(len(weights) - 1), -weights[:-1] / weights[-1]])  # the last node balances the others
    i, j, k = np.indices((len(lines), *stretches.shape))
    along = [
        coo_array(
            ((normal[:, None, None] * stretches).ravel(), (lines[i, j].ravel(), (i * stretches.shape[1] + k).ravel())),
            shape=(nodes, len(lines) * stretches.shape[1]),
        )
        for normal in normals
    ]
    return csc_array(hstack([block_diag([units] * 3), vstack(along)]))


def stiffness_of(
    place: FloatArray, slopes: list[FloatArray], weights: FloatArray, E: FloatArray, nu: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Stiffness of one element with nodes at `place` (3, nodes), all u_x first, and the volume of each node."""
    jacobian = np.array([[slope @ place[i] for slope in slopes] for i in range(3)]).transpose(2, 0, 1)
    volume, inverse = weights * np.abs(np.linalg.det(jacobian)), np.linalg.inv(jacobian)
    by = [sum(inverse[:, j, i, None] * slopes[j] for j in range(3)) for i in range(3)]
    lame, G = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * E / (1.0 + nu)
    sheared = [(volume * G)[:, None] * part for part in by]
    pulled = [(volume * lame)[:, None] * part for part in by]
    laplace = sum(by[i].T @ sheared[i] for i in range(3))
    blocks = [
        [by[i].T @ pulled[j] + by[j].T @ sheared[i] + (laplace if i == j else 0.0) for j in range(3)] for i in range(3)
    ]
    return np.block(blocks), volume


def face_area(face: FloatArray, mesh: SolidMesh) -> FloatArray:
    """Area of each node of an end face with nodes at (3, around, through)."""
    q, r = mesh.orders[1:]
    (x, wx), (y, wy) = lobatto(q), lobatto(r)
    area = np.zeros(face.shape[1:])
    for j in range(mesh.around):
        own = face[:, j * q : j * q + q + 1]
        a, b = np.einsum("kq,cqr->ckr", lagrange(q, x)[1].T, own), np.einsum("kr,cqr->cqk", lagrange(r, y)[1].T, own)
        area[j * q : j * q + q + 1] += np.outer(wx, wy) * np.linalg.norm(np.cross(a, b, axis=0), axis=0)
    return area.ravel()


def class_modes(part: Part, parts: int, c: int, count: int) -> tuple[FloatArray, Array]:
    """The lowest eigenvalues of one class of a held casing, and shapes on all dofs of the part (3 nodes, modes)."""
    T = tying(part, parts, c)
    K = csc_array(T.conj().T @ part.K @ T)
    mass = (abs(T).T ** 2 @ np.tile(part.mass, 3)).real
    root = diags_array(1.0 / np.sqrt(mass))
    A = csc_array(root @ K @ root)
    A = csc_array(0.5 * (A + A.conj().T))
    factor = splu(A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    inverse = LinearOperator(A.shape, matvec=factor.solve, dtype=A.dtype)
    start = np.random.default_rng(0).normal(size=A.shape[0]).astype(A.dtype)
    found, vectors = eigsh(inverse, k=count, v0=start, which="LM", tol=1e-12)
    order = np.argsort(-found)
    return 1.0 / found[order], np.asarray(T @ (root @ vectors[:, order]))


def tying(part: Part, parts: int, c: int) -> csc_array:
    """Free motions of one class -> all dofs of the part: the seam's last line follows the first, turned, in phase."""
    nodes, turn = len(part.mass), 2.0 * np.pi / parts
    phase = np.exp(1j * c * turn)
    phase = phase.real if 2 * c % parts == 0 else phase
    C, S = phase * np.cos(turn), phase * np.sin(turn)
    last, first = part.seam
    follow = coo_array((np.ones(len(last)), (last, first)), shape=(nodes, nodes))
    return csc_array(part.motions + block_array([[C * follow, -S * follow, None], [S * follow, C * follow, None],
                                                 [None, None, phase * follow]]) @ part.motions)  # fmt: skip


def rim_lines(part: Part, parts: int, c: int, shapes: Array, mesh: SolidMesh) -> Array:
    """Radial motion of the rim's line at `SAMPLES` equal angles of the whole turn, (samples, modes)."""
    per_part = 2.0 * np.pi / parts
    theta = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    turn = np.floor(theta / per_part + 1e-12).astype(int)
    local = (theta / per_part - turn) * mesh.around
    cell = np.clip(np.floor(local + 1e-12).astype(int), 0, mesh.around - 1)
    values = lagrange(mesh.orders[1], np.clip(local - cell, 0.0, 1.0))[0].T
    nodes, count = part.rim[cell], len(part.mass)
    own = theta - turn * per_part  # within the part: radial motion turns with it
    u, v = (np.einsum("sq,sqm->sm", values, shapes[nodes + k * count]) for k in range(2))
    return (u * np.cos(own)[:, None] + v * np.sin(own)[:, None]) * np.exp(2j * np.pi * c * turn / parts)[:, None]


def solid_casing(shell: Shell, mesh: SolidMesh, parts: int, count: int, *, breathes: bool = False) -> SolidModes:
    """The lowest modes of a casing of `parts` equal parts around as a solid, pairs of equal frequency twice.

    Its clamp is that of `make_part`.
    """
    part = make_part(shell, mesh, parts, breathes=breathes)
    rows: list[tuple[float, int, float]] = []
    dofs = 0
    for c in range(parts // 2 + 1):
        single = 2 * c % parts == 0
        values, shapes = class_modes(part, parts, c, count if single else (count + 1) // 2)
        dofs += part.motions.shape[1]
        lines = rim_lines(part, parts, c, shapes, mesh)
        waves = np.fft.fft(lines, axis=0) / SAMPLES
        for value, wave in zip(values, waves.T, strict=True):
            energy = np.abs(wave) ** 2
            energy = energy + np.roll(energy[::-1], 1)  # of n and -n
            n = int(energy[: SAMPLES // 2].argmax())
            frequency = float(np.sqrt(max(value, 0.0)) / (2.0 * np.pi))
            angle = float(np.mod(-np.angle(wave[n]) / n, np.pi / n)) if single and n else float("nan")
            rows += [(frequency, n, angle)] * (1 if single else 2)
    rows.sort(key=lambda row: row[0])
    freq, n, angle = zip(*rows[:count], strict=True)
    return SolidModes(freq=np.array(freq), n=np.array(n), angle=np.array(angle), dofs=dofs)
