"""Imported parts against themselves: 200 random parts under changes whose effect on frequencies is exact.

Matrices: nodes of six dofs, joined by random springs, free or on supports. Meshes: small solids and shells in Abaqus
and Nastran files. Units, numbers, axes of nodes, rotation and reflection leave frequencies as they are. Twice the
stiffness raises them by the root of two. A free part whose axes are left out must be refused.
"""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy.linalg import eigh

import casingfem as cf
from casingfem.io.arrays import FloatArray
from casingfem.structure.imported.grid import grid_mesh
from contact.base.errors import InputError
from contact.model.bodies.from_matrices import body_of
from contact.model.bodies.matrices import Matrices
from reports.tables import Row, command_line, show, write
from reports.verification.modes.mesh_files import write_bdf, write_inp

SEED = 20611
BOUND = 2e-8  # of a frequency and of a compliance: round-off beside the shift of 1e-6 in the modes
MESH_BOUND = 1e-8  # of a frequency: thin cells beside the digits of their files
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
Part = dict[str, Any]


def rotation(rng: np.random.Generator, *, mirrored: bool = False) -> FloatArray:
    """A random rotation, or a reflection."""
    Q = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    return np.asarray(Q * (np.linalg.det(Q) * (-1.0 if mirrored else 1.0)))


def six(Q: FloatArray) -> FloatArray:
    """What a rotation or reflection does to a displacement and a rotation."""
    T = np.zeros((6, 6))
    T[:3, :3], T[3:, 3:] = Q, np.linalg.det(Q) * Q
    return T


def part(rng: np.random.Generator) -> Part:
    """Nodes, K and M by blocks of six dofs; free in two of three draws."""
    n = int(rng.integers(3, 8))
    x = rng.uniform(-1.0, 1.0, (n, 3)) + rng.uniform(-5.0, 5.0, 3)
    K, M = np.zeros((6 * n, 6 * n)), np.zeros((6 * n, 6 * n))
    for i in range(n):
        own = slice(6 * i, 6 * i + 6)
        M[own, own] = np.diag([rng.uniform(0.5, 2.0)] * 3 + rng.uniform(0.02, 0.1, 3).tolist())
    pairs = [*pairwise(range(n)), *(tuple(rng.choice(n, 2, replace=False)) for _ in range(n))]
    for i, j in pairs:
        arm = np.eye(6)
        arm[:3, 3:] = -np.cross(np.eye(3), x[j] - x[i])
        B = np.zeros((6, 6 * n))
        B[:, 6 * i : 6 * i + 6], B[:, 6 * j : 6 * j + 6] = -arm, np.eye(6)
        shape = rng.standard_normal((6, 6))
        K += 10.0 ** rng.uniform(5, 7) * B.T @ (shape @ shape.T + np.eye(6)) @ B
    free = bool(rng.random() < 2 / 3)
    if not free:
        K[:6, :6] += 1e6 * np.eye(6)
    return {"K": K, "M": M, "x": x, "numbers": np.arange(1, n + 1), "free": free, "axes": None, "rows": None}


def basis(given: Part, units: str = "m-kg-s") -> tuple[FloatArray, FloatArray]:
    """Circular frequencies, and compliance at the first and last node, of all modes but five."""
    n = len(given["x"])
    dofs = [(int(node), c) for node in given["numbers"] for c in range(1, 7)]
    K, M = given["K"], given["M"]
    if given["rows"] is not None:
        dofs, K, M = [dofs[k] for k in given["rows"]], *(A[np.ix_(given["rows"], given["rows"])] for A in (K, M))
    points = dict(zip(given["numbers"].tolist(), given["x"].tolist(), strict=True))
    axes = None if given["axes"] is None else dict(zip(given["numbers"].tolist(), given["axes"], strict=True))
    matrices = Matrices.of(M, K, dofs=dofs, points=points, units=units, axes=axes)
    body, _ = body_of(matrices, [int(given["numbers"][k]) for k in (0, -1)], modes=6 * n - 5)
    elastic = body.omega > 0.0
    rows = body.rows[:, elastic] / body.omega[elastic]
    return body.omega, rows @ rows.T + body.S


def in_millimetres(given: Part, rng: np.random.Generator) -> Part:
    """The same part in mm, t, s."""
    T = np.diag(([1.0] * 3 + [1e3] * 3) * len(given["x"]))
    scaled = {name: 1e-3 * T @ given[name] @ T for name in "KM"}
    return {**given, **scaled, "x": 1e3 * given["x"]}


def renumbered(given: Part, rng: np.random.Generator) -> Part:
    """Other numbers of nodes, rows in another order."""
    n = len(given["x"])
    return {**given, "numbers": rng.choice(10**6, n, replace=False), "rows": rng.permutation(6 * n).tolist()}


def by_blocks(given: Part, blocks: list[FloatArray]) -> Part:
    """K and M in the axes that the blocks lead to."""
    n = len(given["x"])
    T = np.zeros((6 * n, 6 * n))
    for k, block in enumerate(blocks):
        T[6 * k : 6 * k + 6, 6 * k : 6 * k + 6] = block
    return {**given, "K": T @ given["K"] @ T.T, "M": T @ given["M"] @ T.T}


def own_axes(given: Part, rng: np.random.Generator) -> Part:
    """Every node with axes of its own."""
    axes = [rotation(rng) for _ in given["x"]]
    return {**by_blocks(given, [six(Q) for Q in axes]), "axes": axes}


def moved(given: Part, Q: FloatArray) -> Part:
    """A part turned or reflected as a whole."""
    return {**by_blocks(given, [six(Q)] * len(given["x"])), "x": given["x"] @ Q.T}


def condensed(given: Part) -> tuple[FloatArray, FloatArray]:
    """Frequencies of a part after a Craig-Bampton transformation with all its inner modes, and after none."""
    n = len(given["x"])
    outer, inner = list(range(12)), list(range(12, 6 * n))
    K, M = given["K"], given["M"]
    T = np.eye(6 * n)
    T[12:, :12] = -np.linalg.solve(K[np.ix_(inner, inner)], K[np.ix_(inner, outer)])
    T[12:, 12:] = eigh(K[12:, 12:], M[12:, 12:])[1]
    dofs = [(node, c) for node in (1, 2) for c in range(1, 7)] + [(100 + k, 0) for k in range(len(inner))]
    points = {k + 1: given["x"][k].tolist() for k in range(2)}
    reduced = Matrices.of(T.T @ M @ T, T.T @ K @ T, dofs=dofs, points=points)
    return body_of(reduced, [1], modes=6 * n - 5)[0].omega, basis(given)[0]


def matrix_errors(k: int) -> dict[str, float]:
    """Relative errors of frequencies and compliances of one part, by relation."""
    rng = np.random.default_rng((SEED, k))
    given = part(rng)
    omega, G = basis(given)

    def beside(other: Part, factor: float = 1.0, Q: FloatArray | None = None, units: str = "m-kg-s") -> float:
        found, H = basis(other, units)
        want = G / factor if Q is None else np.kron(np.eye(2), Q) @ G @ np.kron(np.eye(2), Q).T
        elastic = omega > 0.0
        of_omega = (np.abs(found - np.sqrt(factor) * omega)[elastic] / omega[elastic]).max() + (found[~elastic]).sum()
        return float(max(of_omega, np.abs(H - want).max() / np.abs(want).max()))

    turn, mirror = rotation(rng), rotation(rng, mirrored=True)
    whole, cut = condensed(given)[::-1]
    errors = {
        "matrices: mm, t, s": beside(in_millimetres(given, rng), units="mm-t-s"),
        "matrices: numbers and order of rows": beside(renumbered(given, rng)),
        "matrices: own axes of nodes": beside(own_axes(given, rng)),
        "matrices: rotated": beside(moved(given, turn), Q=turn),
        "matrices: reflected": beside(moved(given, mirror), Q=mirror),
        "matrices: twice the stiffness": beside({**given, "K": 2.0 * given["K"]}, 2.0),
        "matrices: Craig-Bampton set": float(np.abs(cut - whole).max() / whole.max()),
    }
    if given["free"]:
        errors["matrices: free, axes left out: refused"] = refusal({**own_axes(given, rng), "axes": None})
    return errors


def refusal(given: Part) -> float:
    """0 if a part is refused for its rigid motions, 1 if it is accepted."""
    try:
        basis(given)
    except InputError as error:
        return 0.0 if "rigid modes, but" in str(error) else 1.0
    return 1.0


def mesh_errors(k: int, folder: Path) -> dict[str, float]:
    """Relative errors of the frequencies of one mesh, by relation."""
    rng = np.random.default_rng((SEED, 1000 + k))
    kind = str(rng.choice(["hexahedron20", "tetra10", "quad"]))
    size = rng.uniform([0.08, 0.02, 0.004], [0.2, 0.06, 0.02])
    wave = rng.uniform(0.0, 0.2)

    def place(u: FloatArray) -> FloatArray:
        x = np.zeros((len(u), 3))
        x[:, : u.shape[1]] = u * size[: u.shape[1]]
        x[:, 2] += wave * size[1] * np.sin(2.0 * u[:, 0])
        return x

    mesh = grid_mesh(kind, (3, 2) if kind == "quad" else (3, 1, 1), place, groups={"root": (0, 0.0)})
    form = str(rng.choice(["inp", "bdf"]))

    def freq(points: FloatArray, order: Any = None, E: float = 1.0, scale: float = 1.0) -> FloatArray:
        own = replace(mesh, points=points)
        if order is not None:
            back = np.argsort(order)
            groups = {name: replace(group, nodes=back[group.nodes]) for name, group in mesh.groups.items()}
            cells = back[mesh.cells][rng.permutation(len(mesh.cells))]
            own = replace(mesh, points=points[order], cells=cells, groups=groups)
        path = folder / f"part.{form}"
        (write_inp if form == "inp" else write_bdf)(own, path)
        read = cf.imported.read_mesh(path, scale=scale)
        name = next(name for name in read.groups if name in ("root", "SPC 1"))
        material = cf.Material(E=E * STEEL.E, nu=STEEL.nu, rho=STEEL.rho)
        held: Any = {name: cf.Clamped()}
        if kind == "quad":
            shell = cf.imported.MeshShell(mesh=read, material=material, thickness=float(size[2]), supports=held)
            return np.asarray(cf.modes(shell, 6).freq)
        return np.asarray(cf.modes(cf.Solid(mesh=read, material=material, supports=held), 6).freq)

    first = freq(mesh.points)

    def beside(found: FloatArray, factor: float = 1.0) -> float:
        return float(np.abs(found / (factor * first) - 1.0).max())

    errors = {
        "meshes: millimetres": beside(freq(1e3 * mesh.points, scale=1e-3)),
        "meshes: numbers of nodes and elements": beside(freq(mesh.points, order=rng.permutation(len(mesh.points)))),
        "meshes: rotated": beside(freq(mesh.points @ rotation(rng).T)),
        "meshes: twice the stiffness": beside(freq(mesh.points, E=2.0), float(np.sqrt(2.0))),
    }
    if form == "bdf" or kind == "quad":
        errors["meshes: reflected"] = beside(freq(mesh.points * [1.0, -1.0, 1.0]))
    return errors


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table and write it."""
    count = 6 if quick else 100
    every = [matrix_errors(k) for k in range(count)]
    with TemporaryDirectory() as name:
        every += [mesh_errors(k, Path(name)) for k in range(count)]
    rows: list[Row] = []
    for relation in dict.fromkeys(name for one in every for name in one):
        found = [one[relation] for one in every if relation in one]
        bound = BOUND if relation.startswith("matrices") else MESH_BOUND
        faults = sum(error > bound for error in found)
        rows.append({"relation": relation, "parts": len(found), "worst": max(found), "bound": bound, "faults": faults})
    show("Imported parts under changes whose effect is exact", rows)
    print(f"{2 * count} parts, {sum(int(str(row['faults'])) for row in rows)} faults")
    write(out / "imported_relations.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
