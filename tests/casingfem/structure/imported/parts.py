"""Imported parts that several tests of this folder hang something on."""

from dataclasses import replace

import numpy as np

import casingfem as cf
from casingfem.structure.imported.mesh.attachments import Attachments
from casingfem.structure.imported.solid import Solid

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)


def added_nodes(mesh, *places):
    """A mesh with nodes of no cell, and their indices."""
    count = len(mesh.points)
    points = np.vstack([mesh.points, *(np.array([place]) for place in places)])
    return replace(mesh, points=points, node_numbers=np.arange(1, len(points) + 1)), range(count, len(points))


def hung(mesh, **items):
    """A mesh with attachments."""
    return replace(mesh, attachments=Attachments(**items))


def supported(mesh, *names, **options):
    """A steel solid clamped on groups, "root" if none is named."""
    held = {name: cf.Clamped() for name in names or ("root",)}
    return Solid(mesh=mesh, material=STEEL, supports=held, **options)
