"""Orthogonality of measured shapes through the model's mass, reduced to the sensors.

Guyan (AIAA J. 3, 1965, 380): M_s = G^T M G, G the static shapes of unit motions at the channels, good below the first
mode that the sensors do not see. SEREP (O'Callahan, Avitabile and Riemer, IMAC 1989): M_s = (Phi_s^+)^T Phi_s^+, exact
for the modes kept. Normalised cross-orthogonality:

    NCO_ij = |a_i^T M_s b_j|^2/((a_i^T M_s a_i) (b_j^T M_s b_j)).
"""

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from casingfem.errors import ModelError
from casingfem.experiment.correlation.mac import mac
from casingfem.experiment.correlation.sensors import Sensors
from casingfem.io.arrays import FloatArray
from casingfem.linalg.factor import factorise
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.shell.system import System

CHANNELS = 1e-10  # least ratio of the static compliance's eigenvalues: channels that are no repetition of others


def guyan_mass(system: System | MeshSystem, sensors: Sensors) -> FloatArray:
    """M_s (channels, channels) by static condensation to the channels.

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

    >>> shapes = np.array([[1.0, 0.5], [0.2, 1.0], [0.3, -0.4]])
    >>> (shapes.T @ serep_mass(shapes) @ shapes).round(12).tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    inverse = np.linalg.pinv(at_sensors)
    return np.asarray(inverse.T @ inverse)


def cross_orthogonality(measured: FloatArray, computed: FloatArray, mass: FloatArray) -> FloatArray:
    """NCO of every measured with every computed shape at the channels, (measured, computed).

    Raises
    ------
    ValueError
        Shapes of different channels, or without mass.
    """
    return mac(measured, computed, mass)
