"""Choose between explanations by measured shapes if frequencies and orientations cannot decide.

A half turn does not change the table, but changes the shapes: a loose bolt mixes other n into a mode, and components
that differ by an odd number of nodal diameters change their sign with the half turn.
"""

from typing import NamedTuple

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.correlation.correlate import seen_mac
from casingfem.experiment.correlation.measured_shapes import MeasuredShapes
from casingfem.experiment.correlation.pairing import pair
from casingfem.experiment.correlation.sensors import sensors_on
from casingfem.io.arrays import FloatArray
from casingfem.locate.explanations import factors_of
from casingfem.locate.located import Explanation, Localisation
from casingfem.modal.affine import AffineModel
from casingfem.structure.mesh.kinematics import DOFS


class ShapeVerdict(NamedTuple):
    """An explanation and the mean of 1 - MAC of its modes with the measured shapes."""

    explanation: Explanation
    unlike: float


def checked_by_shapes(
    model: AffineModel, found: Localisation, shapes: MeasuredShapes, *, reach: float = 0.05
) -> list[ShapeVerdict]:
    """The explanations of loose bolts, sorted by how well they reproduce the measured shapes.

    Parameters
    ----------
    model
        First part of the result of `search_model`.
    shapes
        Shapes measured with the loose bolts: both members of split pairs, at sensors around the casing.
    reach
        Largest relative frequency error of a pair.

    Raises
    ------
    ModelError
        sensor-far, or locate-bolts for masses.
    InputError
        No shape pairs with a mode.
    """
    grid = model.system.grid
    sensors = sensors_on(model.system.shell, grid, shapes.points, shapes.directions, shapes.labels)
    nodes = grid.nodes.shape[1]
    rows = sensors.shapes(model.motions[: nodes * DOFS].reshape(nodes, DOFS, -1))
    judged = [ShapeVerdict(e, unlike(model, e, rows, shapes, reach)) for e in (found.best, *found.others)]
    return sorted(judged, key=lambda one: one.unlike)


def unlike(
    model: AffineModel, explanation: Explanation, rows: FloatArray, shapes: MeasuredShapes, reach: float
) -> float:
    """Mean of 1 - MAC over the shapes that pair; `rows` (channels, r) map the basis to the sensors."""
    factors = factors_of(model)
    x = np.zeros(len(factors))
    for one in explanation.found:
        x[one.place - 1] = one.value - factors[one.place - 1]
    modes = model.modes(x, min(len(shapes) + 6, len(model.nominal)))
    likeness = seen_mac(shapes.real, rows @ modes.coordinates)
    matches = pair(modes, shapes.table(), reach=reach, shape_mac=likeness).matches
    if not matches:
        near = f"one within {100.0 * reach:.2g} % of a mode's frequency, and similar to it"
        raise InputError(shapes.path, found="no shape that pairs with a mode", expected=near)
    macs = [likeness[row, mode] for match in matches for row, mode in zip(match.rows, match.modes, strict=True)]
    return float(1.0 - np.mean(macs))
