"""Accelerometers weigh: the modes of the structure that carries them, from the modes of the bare one.

The displacements where masses m sit are u = R q + B z, B B^T = S there: the modes and what they leave out, which the
masses excite too. With T = (|q'|^2 + u'^T m u')/2 and V = (q^T Omega^2 q + z^T z)/2 this is an eigenproblem as small
as the basis; its static answers are those of the bare structure, as they must be.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import eigh

from casingfem.errors import InputError
from casingfem.experiment.rig.rig import Rig
from casingfem.io.arrays import FloatArray

RANK = 1e-12  # of the largest residual compliance: below it there is none


def loaded(rig: Rig, probes: Sequence[int], mass: ArrayLike) -> Rig:
    """The rig with masses [kg] at probes, each in the probe's direction: a sensor weighs in all three.

    M = I + R^T m R (modes and residuals), solved again; as many modes as before, the rest goes into S. Damping keeps
    its diagonal: members of a close pair with different damping would become complex modes, which this leaves out.

    Raises
    ------
    InputError
        A probe that is not there, a mass that is negative or not finite.

    Examples
    --------
    >>> bare = Rig.of(omega=[100.0], zeta=[0.01], rows=[[1.0]])  # 1 kg
    >>> loaded(bare, [0], [3.0]).omega.round(9).tolist()
    [50.0]
    """
    at = rig.checked(probes)
    m = np.broadcast_to(np.asarray(mass, np.float64), (len(at),))
    if not (np.isfinite(m).all() and m.min() >= 0.0):
        raise InputError(f"mass: found {m.min()!r}, expected masses of 0 kg or more")
    beyond = residual_shapes(rig.S, at)
    rows = np.hstack([rig.rows, beyond])
    added = rows[at].T @ (m[:, None] * rows[at])
    own = np.r_[np.ones(len(rig)), np.zeros(beyond.shape[1])]
    stiff = np.r_[rig.omega, np.ones(beyond.shape[1])]
    turned = (np.diag(own) + added) / np.outer(stiff, stiff)
    inverse, x = eigh(turned, subset_by_index=(len(stiff) - len(rig), len(stiff) - 1))
    omega = 1.0 / np.sqrt(inverse[::-1])
    shapes = x[:, ::-1] / stiff[:, None] * omega  # phi^T M phi = 1
    damping = shapes[: len(rig)].T ** 2 @ (2.0 * rig.zeta * rig.omega)
    now = rows @ shapes
    S = (rig.rows / rig.omega**2) @ rig.rows.T + rig.S - (now / omega**2) @ now.T
    return Rig(omega=omega, zeta=damping / (2.0 * omega), rows=now, S=0.5 * (S + S.T), probes=rig.probes)


def residual_shapes(S: FloatArray, at: Sequence[int]) -> FloatArray:
    """Displacements of all probes in the residual coordinates of some, (probes, coordinates): B where they sit."""
    values, vectors = np.linalg.eigh(S[np.ix_(at, at)])
    kept = values > RANK * max(float(values.max()), np.finfo(float).tiny)
    return np.asarray(S[:, at] @ vectors[:, kept] / np.sqrt(values[kept]))
