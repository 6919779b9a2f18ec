"""Imported parts that several tests of this folder hang something on."""

from dataclasses import replace

import numpy as np

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)


def added_nodes(mesh, *places):
    """A mesh with nodes of no cell, and their indices."""
    count = len(mesh.points)
    points = np.vstack([mesh.points, *(np.array([place]) for place in places)])
    return replace(mesh, points=points, node_numbers=np.arange(1, len(points) + 1)), range(count, len(points))


def hung(mesh, **items):
    """A mesh with attachments."""
    return replace(mesh, attachments=cf.imported.Attachments(**items))


def supported(mesh, *names, **options):
    """A steel solid clamped on groups, "root" if none is named."""
    held = {name: cf.Clamped() for name in names or ("root",)}
    return cf.Solid(mesh=mesh, material=STEEL, supports=held, **options)


def flat(u):
    return np.insert(u, 2, 0.0, axis=1)


def squares(points, cells, kind="quad", **given):
    return cf.imported.MeshData(kind=kind, points=flat(np.array(points, dtype=float)), cells=np.array(cells), **given)


def box(*sides, kind="hexahedron", counts=(1, 1, 1)):
    return cf.imported.grid_mesh(kind, counts, lambda u: u * sides)


def tapered(top, kind="quad"):
    """A square of which the upper side is shorter: the area per r and s is 1 - s (1 - top)."""
    return cf.imported.grid_mesh(
        kind, (1, 1), lambda u: flat(np.stack([u[:, 0] * (1 - u[:, 1] * (1 - top)), u[:, 1]], axis=1))
    )


def moved(mesh, node, shift):
    points = mesh.points.copy()
    points[mesh.cells[0, node]] += shift
    return cf.imported.MeshData(kind=mesh.kind, points=points, cells=mesh.cells)


def link(*nodes):
    return cf.imported.Spring(terms=tuple(cf.imported.Term(node, 0, 1.0) for node in nodes), stiffness=1.0)
