"""Whether a mesh carries the modes computed on it: how much of a shape lies in the finest polynomials.

A shape is expanded in Legendre polynomials of each element; where it is resolved the coefficients fall off. On frusta,
cylinders and plates from order 2 to 8, every mesh whose frequencies were more than 2.5 % off had a share above FINEST.
"""

import numpy as np
from numpy.polynomial import legendre

from casingfem.errors import warn
from casingfem.io.arrays import BoolArray, FloatArray
from casingfem.modal.mode_set import Modes
from casingfem.structure.mesh.element import ElementQuadLobatto, lobatto
from casingfem.structure.shell.variation import outer_supports

FINEST = 0.015
SPLITTING = 0.0015  # where it splits pairs: share 0.0016 split n = 9 by 0.2 %, 0.007 by 3 %, 0.0003 by 0.006 %


def finest_shares(modes: Modes) -> FloatArray:
    """Amplitude in the highest polynomials over the whole, along both parameters, (2, modes)."""
    order = modes.grid.mesh.order
    i, j = ElementQuadLobatto(order).pairs.T
    to_legendre = np.linalg.inv(legendre.legvander(2.0 * lobatto(order)[0] - 1.0, order))
    u = modes.fields[modes.grid.elements][:, :, :3]
    lattice = np.empty((order + 1, order + 1, u.shape[0], 3, u.shape[3]))
    lattice[i, j] = np.moveaxis(u, 1, 0)
    coefficients = np.einsum("ai,bj,ijeck->abeck", to_legendre, to_legendre, lattice, optimize=True)
    norms = 1.0 / (2.0 * np.arange(order + 1) + 1.0)  # mean squares of Legendre polynomials
    energy = np.einsum("abeck,a,b->abk", coefficients**2, norms, norms, optimize=True)
    finest = np.stack([energy[-1].sum(axis=0), energy[:, -1].sum(axis=0)])
    return np.asarray(np.sqrt(finest / energy.sum(axis=(0, 1))))


def split_by_mesh(modes: Modes) -> BoolArray:
    """Modes of a closed casing whose pairs equal elements split: their number divides 2n, (modes,)."""
    n = np.asarray(modes.nodal_diameters)
    return np.asarray((n > 0) & (2 * n % modes.grid.mesh.around == 0) & modes.shell.chart.periodic)


def warn_of_coarse_mesh(modes: Modes, *, around: bool = True) -> None:
    """Warn of shapes the mesh does not carry; `around` False looks along the meridian only."""
    shares = finest_shares(modes)
    worst = shares.max(axis=0) if around else shares[0]
    split = split_by_mesh(modes) & around
    poor = np.flatnonzero((worst > FINEST) | (split & (shares[1] > SPLITTING)))
    if len(poor):
        which = f"mode {poor[0] + 1}" if len(poor) == 1 else f"{len(poor)} modes from mode {poor[0] + 1} on"
        mesh, share = modes.grid.mesh, worst[poor].max()
        warn(
            "mesh-coarse",
            f"{which}: up to {share:.1%} of the shape in the finest polynomials of {len(mesh.breaks) - 1} x "
            f"{mesh.around} elements of order {mesh.order}"
            + ("; the mesh itself splits pairs whose 2n it divides" if split[poor].any() else ""),
            stacklevel=5,
        )


def checked_resolution(modes: Modes, *, around: bool = True) -> Modes:
    """The same modes, with a warning where they show a coarse mesh, or supports that leave motions free."""
    warn_of_coarse_mesh(modes, around=around)
    held = ", ".join(edge for edge, holding in outer_supports(modes.shell).items() if holding is not None)
    if modes.rigid and held:
        warn("support-incomplete", f"{modes.rigid} rigid motions beside supports at {held}", stacklevel=4)
    return modes
