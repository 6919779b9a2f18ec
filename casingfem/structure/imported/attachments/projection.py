"""Places on facets: where the points nearest to given ones lie, in which facet and with which shape functions."""

from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import FloatArray, IntArray
from casingfem.structure.imported.mesh.cell_kind import KINDS, shape_functions

NEAR, STEPS = 12, 15  # facets looked at for each point, nearest centres first; Gauss-Newton steps on each
SETTLED = 1e-14  # of the reference facet: a step that changes nothing


class Places(NamedTuple):
    """Of each point: facet, shape functions (points, nodes of a facet), place (points, 3), distance, facet's size."""

    facet: IntArray
    weights: FloatArray
    x: FloatArray
    distance: FloatArray
    size: FloatArray


def nearest_places(kind: str, nodes: FloatArray, points: FloatArray) -> Places:
    """The nearest places to points (p, 3) on facets of a kind with nodes (m, nodes, 3), lines or surfaces."""
    from scipy.spatial import cKDTree  # loaded where parts are glued, not by every study

    size = np.linalg.norm(np.ptp(nodes, axis=1), axis=1)
    count = min(NEAR, len(nodes))
    near = cKDTree(nodes.mean(axis=1)).query(points, count)[1].reshape(len(points), count)
    x = np.repeat(points, count, axis=0)
    local, found = projected(kind, nodes[near.ravel()], x)
    distance = np.linalg.norm(found - x, axis=1).reshape(len(points), count)
    best = distance.argmin(axis=1)
    place = np.arange(len(points)) * count + best
    facet = near[np.arange(len(points)), best]
    weights = shape_functions(kind, local[place].T)[0].T
    return Places(facet, weights, found[place], distance[np.arange(len(points)), best], size[facet])


def projected(kind: str, nodes: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Local coordinates (p, dim) and places (p, 3) nearest to points x (p, 3), each on its own facet (p, nodes, 3).

    Gauss-Newton steps on |x - X(r)|^2, kept inside the facet.
    """
    dim = KINDS[kind].dim
    local = np.tile(np.array(KINDS[kind].corners, dtype=float).mean(axis=0), (len(x), 1))
    for _ in range(STEPS):
        values, slopes = shape_functions(kind, np.ascontiguousarray(local.T))
        away = x - np.einsum("kp,pkc->pc", values, nodes)
        tangents = np.einsum("dkp,pkc->pdc", slopes, nodes)
        gram = tangents @ tangents.swapaxes(1, 2)
        rise = np.einsum("pdc,pc->pd", tangents, away)
        moved = inside(kind, local + np.linalg.solve(gram + tiny(gram), rise[:, :, None])[:, :, 0])
        step, local = np.abs(moved - local).max(initial=0.0), moved
        if step < SETTLED:
            break
    values, _ = shape_functions(kind, np.ascontiguousarray(local.T))
    assert local.shape[1] == dim
    return local, np.einsum("kp,pkc->pc", values, nodes)


def tiny(gram: FloatArray) -> FloatArray:
    """What keeps a flat facet's matrix regular, far below its round-off."""
    trace = np.einsum("pdd->p", gram)[:, None, None]
    return np.asarray(np.eye(gram.shape[1]) * np.maximum(1e-15 * trace, np.finfo(float).tiny))


def inside(kind: str, local: FloatArray) -> FloatArray:
    """Local coordinates moved into the reference facet: a line, a triangle or a square."""
    local = np.clip(local, 0.0, 1.0)
    if len(KINDS[kind].corners) != 3:
        return local
    beyond = np.maximum(local.sum(axis=1) - 1.0, 0.0)
    return np.asarray(np.clip(local - 0.5 * beyond[:, None], 0.0, 1.0))
