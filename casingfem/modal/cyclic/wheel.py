"""Modes of a wheel on the mesh of the whole wheel: for pictures, files, and comparison with a test."""

import numpy as np

from casingfem.io.arrays import frozen
from casingfem.modal.cyclic.modes import CyclicModes
from casingfem.modal.mesh_modes import MeshModes
from casingfem.modal.mode_set import ranks
from casingfem.structure.imported.cyclic.wheel import wheel_fields, wheel_structure


def wheel_modes(found: CyclicModes) -> MeshModes:
    """The modes of all sectors, ascending, pairs as cos and sin.

    Of `count` modes of each diameter the wheel's list is complete up to the least of their highest frequencies.
    """
    whole = wheel_structure(found.sector)
    c, s = wheel_fields(found.sector, found.fields, found.nodal_diameters, whole.mesh)
    double = np.array([found.sector.count(n) == 2 for n in found.nodal_diameters.tolist()], dtype=bool)
    freq = np.concatenate([found.freq, found.freq[double]])
    order = np.argsort(freq, kind="stable")
    n = np.concatenate([found.nodal_diameters, found.nodal_diameters[double]])[order]
    place = np.argsort(order)
    pairs = sorted((int(place[k]), int(place[len(found) + i])) for i, k in enumerate(np.flatnonzero(double)))
    return MeshModes(
        structure=whole,
        freq=frozen(freq[order]),
        fields=frozen(np.concatenate([c, s[:, :, double]], axis=2)[:, :, order]),
        nodal_diameters=frozen(n),
        purity=frozen(np.ones(len(n))),
        meridional=frozen(ranks(n, pairs)),
        doublets=tuple(pairs),
        angle_deg=frozen(np.full(len(n), np.nan)),
        rigid=int(np.count_nonzero(found.rigid) + np.count_nonzero(found.rigid & double)),
        sturm_count=None,
        dofs=found.unknowns,
        seconds=found.seconds,
    )
