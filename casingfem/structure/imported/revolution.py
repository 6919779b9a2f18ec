"""Whether an imported mesh is a body of revolution about z: the normals of its surface must have no hoop component."""

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.structure.imported.cells.mapped import mapped, mapped_parts
from casingfem.structure.imported.mesh.mesh_data import MeshData

LEAN = 0.1  # rms hoop component of the normals of a round body: waves of the radius are small slopes
FLAT = 0.3  # facets above this are corners, cuts or holes; they may have half the area of a meridional section


def hoop_component(x: FloatArray, normals: FloatArray) -> FloatArray:
    """N . e_theta at points (m, 3), relative to |n|."""
    radius = np.maximum(np.linalg.norm(x[:, :2], axis=1), np.finfo(float).tiny)
    hoop = (normals[:, 1] * x[:, 0] - normals[:, 0] * x[:, 1]) / radius
    return np.asarray(hoop / np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny))


def facet_normals(mesh: MeshData) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Centres, normals and sizes of the surfaces that bound a body: facets of solids; cells and edges of shells."""
    facets = mesh.boundary
    on = mapped(mesh.cell_kind.facet, mesh.points, mesh.facet_nodes(facets))
    size = on.measure.sum(axis=1)
    x = np.einsum("eqc,eq->ec", on.x, on.measure) / size[:, None]
    if mesh.cell_kind.dim == 3:
        return x, np.cross(on.tangents[:, :, 0], on.tangents[:, :, 1]).mean(axis=1), size
    faces = np.zeros((len(mesh.cells), 3))
    for rows, _, cells in mapped_parts(mesh):
        faces[rows] = np.cross(cells.tangents[:, :, 0], cells.tangents[:, :, 1]).mean(axis=1)
    return x, np.cross(on.tangents[:, :, 0].mean(axis=1), faces[facets[:, 0]]), size


def round_about_z(mesh: MeshData) -> bool:
    """Whether a mesh is a closed body of revolution about z, up to small waves and holes.

    The mean hoop component may be up to `LEAN`. Facets with more than `FLAT` may have the area of half a meridional
    section; the two cuts of a sector would have four times that.

    >>> from casingfem.structure.imported.grid import grid_mesh, revolved
    >>> ring = revolved((0.5, 0.45), (0.0, 0.25), 0.01)
    >>> round_about_z(grid_mesh("hexahedron20", (1, 20, 2), ring, wrap=1))
    True
    >>> round_about_z(grid_mesh("hexahedron20", (1, 20, 2), lambda u: ring(u * [1.0, 0.9, 1.0])))
    False
    """
    x, normals, size = facet_normals(mesh)
    hoop = np.abs(hoop_component(x, normals))
    parts = [on for _, _, on in mapped_parts(mesh)]
    if mesh.cell_kind.dim == 2:
        faces = np.concatenate([np.cross(on.tangents[:, :, 0], on.tangents[:, :, 1]).mean(axis=1) for on in parts])
        lean = hoop_component(np.concatenate([on.x.mean(axis=1) for on in parts]), faces)
        if np.average(lean**2, weights=np.concatenate([on.measure.sum(axis=1) for on in parts])) > LEAN**2:
            return False
    elif np.average(hoop**2, weights=size) > LEAN**2:
        return False
    measure = np.concatenate([on.measure.ravel() for on in parts])
    radius = np.concatenate([np.linalg.norm(on.x[..., :2], axis=-1).ravel() for on in parts])
    path = 2.0 * np.pi * np.average(radius, weights=measure)
    section = measure.sum() / path if path > 0.0 else 0.0
    return bool(size[hoop > FLAT].sum() < 0.5 * section)


def elements_around(mesh: MeshData) -> int:
    """Number of cells around the axis, from the width of the widest ones."""
    theta = np.arctan2(mesh.points[mesh.cells, 1], mesh.points[mesh.cells, 0])
    span = np.ptp((theta - theta[:, :1] + np.pi) % (2.0 * np.pi), axis=1)
    off_axis = np.linalg.norm(mesh.points[mesh.cells, :2], axis=2).min(axis=1) > 1e-6 * mesh.size
    widest = span[off_axis].max(initial=0.0)  # 0 in a plane through the axis
    return int(np.floor(2.0 * np.pi / widest + 1e-6)) if widest > 1e-6 else 0
