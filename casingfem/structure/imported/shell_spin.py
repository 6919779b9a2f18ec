"""Rotation of imported shells: prestress and spin terms in the stiffness of the degenerated shell with tied strains.

With directors n + w - |w|^2 n/2, whose length is constant to second order, the covariant strains are those of
`tying.py` plus, to second order in the motion,

    e_ab: u,a.u,b/2    chi_ab: sym(u,a.w,b) - |w|^2 (x,a.n,b)/2    gamma_a: u,a.w - |w|^2 (x,a.n)/2

Each is sampled at the tying points of the linear strain. Their bilinear parts about u1 are the linear table with u1
instead of x and w1 instead of n.
"""

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.cells.mapped import put
from casingfem.structure.imported.cells.shell import (
    DOFS,
    ShellCells,
    chunks,
    directors,
    five_dofs,
    mass_moments,
    tangent_frames,
    wall_stiffness,
)
from casingfem.structure.imported.cells.tying import local_frame, tied_covariant, tied_strains, to_local, tying
from casingfem.structure.imported.mesh.cell_kind import rule, shape_functions
from casingfem.structure.imported.spin import Inertia, Stiffening

PAIRS = ((0, 0), (1, 1), (0, 1))  # directions r, s of e_rr, e_ss, 2 e_rs


def shell_inertia(shell: ShellCells, rotation: Rotation) -> Inertia:
    """Inertia of the cells about an axis, including the inertia of the directors.

    The motion u + z d with directors d = w - |w|^2 n/2 and the moments m_p of the wall's mass: at 1 rad/s the
    centrifugal force on d is g = m1 P(x - c) + m2 P n, and each node adds -(n.g) |w|^2 to the softening.
    """
    mesh = shell.apart.mesh
    normals = directors(mesh)
    moments = mass_moments(shell, normals)
    n, e = normals[mesh.cells], tangent_frames(normals)[mesh.cells]
    P = rotation.plane
    x = (mesh.points - np.asarray(rotation.centre))[mesh.cells] @ P
    on_u, on_d = moments[0] @ x + moments[1] @ (n @ P), moments[1] @ x + moments[2] @ (n @ P)
    force = np.concatenate([on_u, np.einsum("ekac,ekc->eka", e, on_d)], axis=2)
    soft = five_dofs(moments, e, P)
    held = np.arange(soft.shape[1]).reshape(-1, DOFS)[:, 3:]
    soft[:, held, held] -= np.einsum("ekc,ekc->ek", n, on_d)[:, :, None]
    coriolis = five_dofs(2.0 * moments, e, np.cross(rotation.direction, np.eye(3)).T)
    return Inertia(soft, coriolis, force.reshape(len(force), -1))


def shell_stiffening(shell: ShellCells, fields: FloatArray) -> Stiffening:
    """Geometric stiffness of the cells in a static state (nodes, 5)."""
    mesh = shell.apart.mesh
    normals = directors(mesh)
    frames = tangent_frames(normals)
    u, w = fields[:, :3], np.einsum("na,nac->nc", fields[:, 3:], frames)
    whole = DOFS * mesh.cell_kind.nodes
    first, second = np.zeros((2, len(mesh.cells), whole, whole))
    bowed = strained = 0.0
    for kind, part, slots in chunks(mesh, np.arange(len(mesh.cells))):
        cells, slopes = mesh.cells[part][:, slots], rule(kind)[3]
        x, n, e = mesh.points[cells], normals[cells], frames[cells]
        x_r, x_s = np.einsum("dkq,ekc->deqc", slopes, x, optimize=True)
        local = to_local(local_frame(x_r, x_s, shell.fibres)[1])
        L, measure, b = tied_strains(kind, x, n, e, shell.fibres)
        D = wall_stiffness(shell, part, b)
        quadratic = local @ tied_covariant(kind, u[cells], w[cells], e)
        moved = fields[cells].reshape(len(cells), 1, -1, 1)
        strain, bow = (L @ moved)[..., 0], 0.5 * (quadratic @ moved)[..., 0]
        stress = (strain[..., None, :] @ D)[..., 0, :] * measure[:, :, None]
        pulled = (D @ quadratic) * measure[:, :, None, None]
        cross = flat(L).transpose(0, 2, 1) @ flat(pulled)
        pull = np.einsum("eqij,eqi->eqj", local, stress)  # on the covariant strains
        put(first, part, slots, cross + cross.transpose(0, 2, 1) + geometric(kind, pull, x, n, e), DOFS)
        put(second, part, slots, flat(quadratic).transpose(0, 2, 1) @ flat(pulled), DOFS)
        strained += float((stress * strain).sum())
        bowed += float(((bow[..., None, :] @ D)[..., 0, :] * bow * measure[:, :, None]).sum())
    return Stiffening(first, second, float(np.sqrt(bowed / strained)) if strained > 0.0 else 0.0)


def flat(table: FloatArray) -> FloatArray:
    """Reshape an array so that points and strains are one axis, (cells, q 8, m)."""
    return table.reshape(len(table), -1, table.shape[-1])


def geometric(kind: str, pull: FloatArray, x: FloatArray, n: FloatArray, e: FloatArray) -> FloatArray:
    """Second derivatives of the covariant strains times the stresses `pull` (cells, q, 8), (cells, 5 k, 5 k)."""
    cells, k = x.shape[:2]
    uu, uw = np.zeros((2, cells, k, k))
    ww = np.zeros((cells, k))
    for made, of, places, weights in tying(kind):
        N, (r, s) = shape_functions(kind, places)
        rates = (r, s)
        tangents = np.einsum("dkt,ekc->detc", np.stack(rates), x, optimize=True)
        ends = np.einsum("detc,ejc->detj", tangents, n, optimize=True)  # x,a . n_j
        for to, row in zip(made, of, strict=True):
            force = np.einsum("qt,eq->et", weights, pull[:, :, to], optimize=True)
            if row < 6:
                a, b = PAIRS[row % 3]
                outer = sym(rates[a], rates[b], twice=a != b)
                target = uu if row < 3 else uw
                target += np.einsum("et,tij->eij", force, outer, optimize=True)
                if row >= 3:
                    bent = np.einsum("et,jt,etj->ej", force, rates[b], ends[a], optimize=True)
                    if a != b:
                        bent = bent + np.einsum("et,jt,etj->ej", force, rates[a], ends[b], optimize=True)
                    ww -= bent
            else:
                a = row - 6
                uw += np.einsum("et,it,jt->eij", force, rates[a], N, optimize=True)
                ww -= np.einsum("et,jt,etj->ej", force, N, ends[a], optimize=True)
    return placed(uu, uw, ww, e)


def sym(one: FloatArray, other: FloatArray, *, twice: bool) -> FloatArray:
    """Products N,a N,b at each point, (places, k, k); if a and b differ, plus the transpose."""
    outer = np.einsum("it,jt->tij", one, other)
    return np.asarray(outer + outer.transpose(0, 2, 1) if twice else outer)


def placed(uu: FloatArray, uw: FloatArray, ww: FloatArray, e: FloatArray) -> FloatArray:
    """Scalar matrices of u.u, u.w (cells, k, k) and of a node's w.w (cells, k), expanded to the dofs."""
    cells, k = ww.shape
    matrices = np.zeros((cells, k, DOFS, k, DOFS))
    for i in range(3):
        matrices[:, :, i, :, i] = uu
    mixed = np.einsum("eij,ejac->eicja", uw, e, optimize=True)
    matrices[:, :, :3, :, 3:] = mixed
    matrices[:, :, 3:, :, :3] = mixed.transpose(0, 3, 4, 1, 2)
    for a in (3, 4):
        matrices[:, range(k), a, range(k), a] += ww
    return matrices.reshape(cells, DOFS * k, DOFS * k)
