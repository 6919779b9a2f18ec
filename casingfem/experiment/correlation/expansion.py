"""Measured shapes expanded to the whole model, predictions at left-out sensors, and the mass at the sensors.

SEREP (O'Callahan, Avitabile and Riemer, IMAC 1989): with the model's shapes at the channels Phi_s (channels, modes)

    q = Phi_s^+ psi,   u = Phi q,   smoothed psi = Phi_s q.

Noise in psi grows at most by the condition number of Phi_s. The part outside the modes is left out and its size is
stated. The error at an omitted sensor follows without another fit, e = (I - H)^-1 r over its channels, H = Phi_s
Phi_s^+.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from casingfem.errors import ModelError
from casingfem.experiment.correlation.sensors import Sensors
from casingfem.io.arrays import FloatArray, IntArray, freeze
from casingfem.linalg.factor import factorise
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.shell.system import System

WORST = 100.0  # condition number above which modes are left out, unless the caller named the modes
CHANNELS = 1e-10  # least ratio of the static compliance's eigenvalues: channels that are no repetition of others


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Expansion:
    """Measured shapes in the model's modes.

    Attributes
    ----------
    modes
        Indices of the modes used, (k,).
    coordinates
        q, (k, measured).
    smoothed
        Projections of the measured shapes on the modes at the channels, (channels, measured).
    condition
        Condition number of the modes at the channels.
    outside
        Relative length of the part of each measured shape outside the modes, (measured,).
    left_out
        Error at each sensor when predicted from all others, over the rms of the shape, (sensors, measured).

    Examples
    --------
    >>> shapes = np.array([[1.0, 0.0], [0.6, 0.8], [0.0, 1.0], [-0.6, 0.8]])
    >>> expand(shapes @ [[2.0], [1.0]], shapes, np.arange(4), modes=[0, 1]).smoothed.ravel().round(12).tolist()
    [2.0, 2.0, 1.0, -0.4]
    """

    modes: IntArray
    coordinates: FloatArray
    smoothed: FloatArray
    condition: float
    outside: FloatArray
    left_out: FloatArray

    def __post_init__(self) -> None:
        freeze(self, "modes", "coordinates", "smoothed", "outside", "left_out")

    def fields(self, nodal: FloatArray) -> FloatArray:
        """The expanded shapes: nodal fields of all modes (nodes, 5, modes) -> (nodes, 5, measured)."""
        return np.asarray(nodal[:, :, self.modes] @ self.coordinates)

    def __repr__(self) -> str:
        return (
            f"Expansion({self.smoothed.shape[1]} shapes on {len(self.modes)} modes, condition {self.condition:.3g}, "
            f"left outside {self.outside.max():.2g}, predicted sensors within "
            f"{np.sqrt(np.mean(self.left_out**2)):.2g} rms)"
        )


def expand(
    measured: FloatArray, at_sensors: FloatArray, labels: IntArray, modes: Sequence[int] | None = None
) -> Expansion:
    """Express measured shapes in the modes of a model, by least squares at the sensors (SEREP).

    With the model's shapes at the channels Phi_s: q = Phi_s^+ psi (O'Callahan, Avitabile and Riemer, IMAC 1989).

    Parameters
    ----------
    measured
        Measured shapes psi, (channels, measured).
    at_sensors
        The model's mode shapes at the same channels, (channels, modes).
    labels
        Sensor number of each channel, (channels,); the channels of a sensor are left out together.
    modes
        Modes to use; by default as many of the lowest as keep the condition number below 100, at most two thirds of the
        number of channels.

    Raises
    ------
    ModelError
        expansion-modes: no modes, more than channels, or modes that the sensors cannot distinguish.

    Examples
    --------
    >>> shapes = np.array([[1.0, 0.0], [0.6, 0.8], [0.0, 1.0], [-0.6, 0.8]])
    >>> found = expand(shapes @ [[2.0], [1.0]], shapes, np.arange(4), modes=[0, 1])
    >>> found.coordinates.ravel().round(12).tolist(), bool(found.left_out.max() < 1e-12)
    ([2.0, 1.0], True)
    """
    chosen = well_conditioned(at_sensors) if modes is None else list(modes)
    channels = len(at_sensors)
    if not 1 <= len(chosen) <= channels:
        raise ModelError("expansion-modes", f"expand: {len(chosen)} modes on {channels} channels")
    basis = at_sensors[:, chosen]
    U, sizes, turn = np.linalg.svd(basis, full_matrices=False)
    if sizes[-1] < 1e-8 * sizes[0]:
        raise ModelError(
            "expansion-modes", f"expand: {len(chosen)} modes cannot be distinguished on {channels} channels"
        )
    smoothed = U @ (U.T @ measured)
    lengths = np.linalg.norm(measured, axis=0)
    return Expansion(
        modes=np.array(chosen),
        coordinates=turn.T @ ((U.T @ measured) / sizes[:, None]),
        smoothed=smoothed,
        condition=float(sizes[0] / sizes[-1]),
        outside=np.linalg.norm(measured - smoothed, axis=0) / lengths,
        left_out=left_out_errors(U, measured, labels),
    )


def well_conditioned(at_sensors: FloatArray, worst: float = WORST) -> list[int]:
    """The lowest modes in order, without those that would worsen the condition of the shapes at the channels."""
    chosen: list[int] = []
    most = max(1, 2 * len(at_sensors) // 3)
    for mode in range(at_sensors.shape[1]):
        if len(chosen) == most:
            break
        columns = at_sensors[:, [*chosen, mode]]
        sizes = np.linalg.svd(columns / np.linalg.norm(columns, axis=0).clip(1e-300), compute_uv=False)
        if np.any(columns[:, -1]) and sizes[0] < worst * sizes[-1]:
            chosen.append(mode)
    return chosen


def left_out_errors(U: FloatArray, measured: FloatArray, labels: IntArray) -> FloatArray:
    """Prediction error of every sensor from the others, over the rms of each shape, (sensors, measured).

    nan if the others do not determine the modes.
    """
    residual = measured - U @ (U.T @ measured)
    rms = np.sqrt(np.mean(measured**2, axis=0))
    errors = []
    for label in np.unique(labels):
        on = labels == label
        kept = np.eye(int(np.count_nonzero(on))) - U[on] @ U[on].T
        blind = np.linalg.eigvalsh(kept)[0] < 1e-10
        error = np.nan if blind else np.sqrt(np.mean(np.linalg.solve(kept, residual[on]) ** 2, axis=0))
        errors.append(error / rms)
    return np.array(errors)


def guyan_mass(system: System | MeshSystem, sensors: Sensors) -> FloatArray:
    """M_s (channels, channels) by static condensation to the channels.

    M_s = G^T M G (Guyan, AIAA J. 3, 1965, 380), accurate below the first mode without motion at the sensors.
    G = K^-1 P (P^T K^-1 P)^-1: the shape of least strain energy for given motions u = P^T x at the channels.

    Raises
    ------
    ModelError
        sensor-twice, where channels measure the same motion.
    """
    P = sensors.loads(system)
    attachment = factorise(system.K).solve(P)
    compliance = P.T @ attachment
    compliance = 0.5 * (compliance + compliance.T)
    scale = 1.0 / np.sqrt(np.diag(compliance))
    values = np.linalg.eigvalsh(compliance * np.outer(scale, scale))
    if values[0] < CHANNELS * values[-1]:
        raise ModelError("sensor-twice", f"{len(sensors)} channels of which some measure the same motion")
    G = cho_solve(cho_factor(compliance), attachment.T).T
    return np.asarray(G.T @ (system.M @ G))


def serep_mass(at_sensors: FloatArray) -> FloatArray:
    """M_s (channels, channels) from mass-normalised shapes at the channels (channels, modes), at most as many modes.

    M_s = (Phi_s^+)^T Phi_s^+ (SEREP), exact for the modes kept.

    >>> shapes = np.array([[1.0, 0.5], [0.2, 1.0], [0.3, -0.4]])
    >>> (shapes.T @ serep_mass(shapes) @ shapes).round(12).tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    inverse = np.linalg.pinv(at_sensors)
    return np.asarray(inverse.T @ inverse)
