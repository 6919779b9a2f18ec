"""Stiffness and mass of a casing at single points, as functions of the imperfections there.

Strains, wall and springs depend only on the value and derivatives of a field at the point. So energies of an imperfect
casing are sums over the points of the perfect meridian and over angles,

    2 energy = sum_q J_q^T H(f_q, f'_q, f''_q) J_q,   J = (U, d_1 U, d_2 U),   ' = d/dtheta,

all in the cylindrical axes of the point theta = 0.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from casingfem.io.arrays import Array, FloatArray
from casingfem.structure.edge.support import Clamped, ElasticEdge
from casingfem.structure.field.field import FieldValues
from casingfem.structure.mesh.edge_form import single_place, spring_form
from casingfem.structure.mesh.element import gauss
from casingfem.structure.mesh.jet_form import JET
from casingfem.structure.mesh.kinematics import DOFS, frame
from casingfem.structure.shell.assembly import wall_form
from casingfem.structure.shell.edges import line_frame
from casingfem.structure.shell.nodal_mass import NodalMass
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.wall import inertia

ORDERS = {"radius": 3, "thickness": 1, "modulus": 1, "density": 1}  # f, f', f'' act on strains; of others f alone
WIDE = 1e-4  # the same for second differences: errors of 1e-7
STEP = 1e-5  # of relative fields and their derivatives, for central differences of complex steps: errors of 1e-10
TINY = 1e-30  # a complex step


class Places(NamedTuple):
    """Points of a meridian: of the wall z, the middle of its element and length, (q,); then edges with springs.

    An edge has its name, its z, and the index of its end of the meridian, 0 or -1.
    """

    z: FloatArray
    middle: FloatArray
    measure: FloatArray
    edges: tuple[tuple[str, float, int], ...]


class Forms(NamedTuple):
    """Stiffness on the jets at the points (..., points, 15, 15), mass on the motions (..., points, 5, 5)."""

    stiffness: Array
    mass: Array


class Slot(NamedTuple):
    """A field by its quantity, and the order of its derivative around: 0, 1 or 2."""

    quantity: str
    order: int


class Given:
    """A field with given values and derivatives around, at every place; constant along the axis."""

    def __init__(self, value: ArrayLike, slope: ArrayLike = 0.0, bend: ArrayLike = 0.0) -> None:
        self.parts = (value, 0.0, slope, 0.0, 0.0, bend)

    def derivatives(self, z: ArrayLike, theta: ArrayLike) -> FieldValues:
        """The given numbers at all places."""
        at = np.broadcast_shapes(np.shape(z), np.shape(theta), *(np.shape(part) for part in self.parts))
        return FieldValues(*(np.broadcast_to(np.asarray(part), at) for part in self.parts))

    def rotated(self, angle: float) -> "Given":
        """The same field, since it does not depend on the place."""
        return self


def known_supports(shell: ShellParts) -> bool:
    """Whether the forms cover all supports of the casing: clamps and elastic embedding."""
    return all(isinstance(support, Clamped | ElasticEdge) for support in shell.supports.values()) and not shell.rings


def places_of(shell: ShellParts) -> Places:
    """The integration points of a perfect casing's meridian."""
    (z0, z1), _ = shell.chart.bounds
    lines = z0 + (z1 - z0) * shell.mesh.breaks
    size, (x, w) = np.diff(lines)[:, None], gauss(shell.mesh.order + 1)
    middle = np.broadcast_to(lines[:-1, None] + 0.5 * size, (len(size), len(x)))
    sprung = [name for name, support in shell.supports.items() if isinstance(support, ElasticEdge)]
    edges = tuple((name, float(shell.line_at(name)), -shell.chart.edges[name][1]) for name in sprung)
    return Places((lines[:-1, None] + size * x).ravel(), middle.ravel(), (size * w).ravel(), edges)


def point_forms(shell: ShellParts, imperfection: Mapping[str, tuple[Array, ...]], places: Places) -> Forms:
    """The forms at all points, for imperfections at T angles.

    Parameters
    ----------
    shell
        The perfect casing.
    imperfection
        For each quantity (f, f', f'') or (f,) of the relative field, each (T,).
    places
        Points of the meridian.

    Returns
    -------
    Forms
        (T, points, 15, 15) and (T, points, 5, 5), per angle, for the wall and the springs.
    """
    angles = len(next(iter(imperfection.values()))[0])
    wide = varied(shell, {name: [part[:, None] for part in parts] for name, parts in imperfection.items()})
    z = np.broadcast_to(places.z, (angles, len(places.z)))
    geometry = wide.geometry(z, np.zeros_like(z), np.broadcast_to(places.middle, z.shape))
    wall = wall_form(wide, geometry, places.measure)
    basis = frame(geometry.surface)
    moments = np.moveaxis(inertia(wide, geometry) * (basis.jacobian * places.measure), 0, -1)
    tangents = np.moveaxis(np.stack([basis.e1, basis.e2], axis=-1), 0, -2)
    blocks = NodalMass(moments.reshape(-1, 3), tangents.reshape(-1, 3, 2)).blocks
    kind, points = np.result_type(wall, blocks), len(places.z) + len(places.edges)
    stiffness = np.zeros((angles, points, JET, JET), dtype=kind)
    mass = np.zeros((angles, points, DOFS, DOFS), dtype=kind)
    stiffness[:, : len(places.z)] = wall
    mass[:, : len(places.z)] = blocks.reshape(angles, -1, DOFS, DOFS)
    narrow = varied(shell, imperfection)
    for k, (name, at, _) in enumerate(places.edges, len(places.z)):
        stiffness[:, k, :DOFS, :DOFS] = spring_blocks(narrow, name, np.full(angles, at))
    return Forms(stiffness, mass)


def varied(shell: ShellParts, imperfection: Mapping[str, "tuple[Array, ...] | list[Array]"]) -> ShellParts:
    """The casing whose fields have these values at every place."""
    fields: dict[str, Any] = {f"{name}_defect": Given(*parts) for name, parts in imperfection.items()}
    return replace(shell, **fields)


def spring_blocks(shell: ShellParts, name: str, z: FloatArray) -> Array:
    """Springs of an edge per angle, on the five dofs of its node, (T, 5, 5)."""
    support = shell.supports[name]
    assert isinstance(support, ElasticEdge)
    angles = len(z)
    line = single_place(line_frame(shell, 1, z, np.zeros(angles)))
    line = line._replace(nodes=np.zeros(angles, dtype=np.int64), weights=np.ones(angles))
    return spring_form(support.springs(line)).D


def slots_of(quantities: tuple[str, ...]) -> tuple[Slot, ...]:
    """All quantities on which the forms depend, in order."""
    return tuple(Slot(name, order) for name in quantities for order in range(ORDERS[name]))


def forms_at(shell: ShellParts, quantities: tuple[str, ...], values: Array, places: Places) -> Forms:
    """The forms at several angles, for values of the slots (angles, slots): (angles, points, ...)."""
    imperfection = {
        name: tuple(values[:, k] for k, slot in enumerate(slots_of(quantities)) if slot.quantity == name)
        for name in quantities
    }
    return point_forms(shell, imperfection, places)


def first_derivatives(shell: ShellParts, quantities: tuple[str, ...], places: Places, about: FloatArray) -> list[Forms]:
    """Derivatives of the forms with respect to each slot at values of the slots, by complex steps.

    Parameters
    ----------
    shell, quantities, places
        The perfect casing, its random quantities, and the points of its meridian.
    about
        Values of the slots, (..., slots).

    Returns
    -------
    list of Forms
        One for each slot, each (..., points, 15, 15) and (..., points, 5, 5).
    """
    stepped = about[..., None, :] + 1j * TINY * np.eye(about.shape[-1])
    forms = forms_at(shell, quantities, stepped.reshape(-1, about.shape[-1]), places)
    by_slot = [np.moveaxis(part.reshape(*stepped.shape[:-1], *part.shape[1:]), about.ndim - 1, 0) for part in forms]
    return [Forms(stiffness.imag / TINY, mass.imag / TINY) for stiffness, mass in zip(*by_slot, strict=True)]


def second_derivatives(shell: ShellParts, quantities: tuple[str, ...], places: Places) -> dict[tuple[int, int], Forms]:
    """Second derivatives of the forms of a perfect casing: (slot, slot) -> forms."""
    steps = STEP * np.eye(len(slots_of(quantities)))
    slopes = first_derivatives(shell, quantities, places, np.stack([steps, -steps]))
    return {
        (m, k): Forms(*((above - below) / (2.0 * STEP) for above, below in (part[:, k] for part in slope)))
        for k in range(len(steps))
        for m, slope in enumerate(slopes)
    }


def third_derivatives(
    shell: ShellParts, quantities: tuple[str, ...], places: Places
) -> dict[tuple[int, int, int], Forms]:
    """Third derivatives of the forms of a perfect casing: (slot, slot, slot) -> forms, for every order of the slots."""
    steps = WIDE * np.eye(len(slots_of(quantities)))
    signs = np.array([(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)])
    third = {}
    for k, one in enumerate(steps):
        for m, other in enumerate(steps[: k + 1]):
            corners = first_derivatives(shell, quantities, places, signs @ np.stack([one, other]))
            for j, corner in enumerate(corners):
                third[j, m, k] = third[j, k, m] = Forms(*((a - b - c + d) / (4.0 * WIDE**2) for a, b, c, d in corner))
    return third
