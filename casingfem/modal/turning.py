"""The matrices of rotation between the modes of a reduced structure.

    q'' + [2 zeta omega + Omega G(x)] q' + [omega^2 + x E(x)] q = rows^T lam,   x = Omega^2 - spin^2

in the frame of the body, which turns at Omega. G and E are polynomials of degree 2 (`turning_series`), of matrices of
the whole structure (`structure/shell/prestress`, `structure/imported/spin`); those of fixed-interface modes are their
projections, of degree 0.

A positive Omega rotates a rim about its axis from cos 1 to sin 1, and a tip from span to flap, as in contact: span
along the radius, flap along growing angles. For nodes it is the direction of the study's rotation.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.linalg.factor import balanced, solve_held
from casingfem.modal.interface.kinds import Interface, Rim, Tip, TipNodes
from casingfem.modal.turning_series import Kept, series, small_model
from casingfem.structure.geometry.rotation import Rotation
from casingfem.structure.imported.assembly import MeshStructure, MeshSystem
from casingfem.structure.imported.spin import MeshTurning
from casingfem.structure.imported.turning_structure import TurningStructure, rotation_of
from casingfem.structure.shell.assembly import assemble, turning
from casingfem.structure.shell.prestress import Turning
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.system import System

ALONG = 1e-6  # sine of an angle between axes, or distance between them over the radius, that is none


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ModalTurning:
    """A structure to be reduced and the axis about which it may rotate.

    Attributes
    ----------
    part
        Centrifugal load of the structure at rest, and what rotation adds to modes.
    sense
        1 if a positive speed rotates about the axis of `part`, -1 if in the opposite sense.
    spin
        Speed of the modes [rad/s], with the sign of `sense`.
    """

    part: Turning | MeshTurning
    sense: float
    spin: float

    @property
    def load(self) -> FloatArray:
        """Columns to solve for in addition to the unit interface forces, (free, 1); none at speed, (free, 0).

        The static state is that of the structure at rest, whose stiffness differs from that at speed.
        """
        load = self.part.load[:, None]
        return load if self.spin == 0.0 else load[:, :0]

    def arrays(self, static: FloatArray, modes: Kept) -> dict[str, Any]:
        """Fields of the basis, from the static response (free, 1) to `load` (none at speed) and the kept modes.

        Raises
        ------
        ModelError
            `static-loose` if the centrifugal force drives a rigid motion that is not restrained.
        """
        system, load = self.part.system, self.part.load
        K = system.stiffness if isinstance(system, System) else system.K
        u = balanced(K, static[:, 0], load) if static.shape[1] else solve_held(K, load)
        times, speeds = self.part.products(u)
        if modes.solve is None:
            G, added, _ = (modes.vectors.T @ part for part in times(modes.vectors))
            found = {"gyroscopic": 0.5 * (G - G.T), "stiffness_by_speed": 0.5 * (added + added.T)}
        else:
            found = series(small_model(modes, times, self.spin))
        turned = {name: self.sense * part if name.startswith("gyroscopic") else part for name, part in found.items()}
        return {**turned, "spin": self.spin, "known_speeds": np.array(speeds)}


def modal_turning(
    structure: Shell | MeshStructure, system: System | MeshSystem, interface: Interface, axes: FloatArray, radius: float
) -> ModalTurning | None:
    """Rotation of a structure, else that of its rim; None if no axis is known or rotation is not modelled.

    Parameters
    ----------
    system
        The assembled structure, at its own speed.
    axes, radius
        Data of the interface, as in `View`.

    Raises
    ------
    ModelError
        `reduce-axis` if the axis of rotation of the structure differs from that of its rim.
    """
    owner: Any = structure
    rotation = rotation_of(structure)
    about = rim_axis(structure, interface) if isinstance(interface, Rim) else None
    if rotation is None and about is None:
        return None
    if rotation is not None and rotation.omega != 0.0:
        still = replace(owner, rotation=None)
        system = assemble(still) if isinstance(structure, Shell) else still.assembled()
    turns = rotation or about
    assert turns is not None
    if rotation is None and not modelled(structure, system):
        return None
    part = turning(system, turns) if isinstance(system, System) else mesh_turning(structure, system, turns)
    if rotation is not None and about is not None:
        require_axis(rotation, about, radius)
    sense = 1.0
    if about is not None:
        sense = float(np.sign(turns.direction @ about.direction))
    elif isinstance(interface, Tip | TipNodes):
        sense = 1.0 if turns.direction @ np.cross(axes[0], axes[1]) > -ALONG else -1.0
    return ModalTurning(part=part, sense=sense, spin=0.0 if rotation is None else sense * rotation.omega + 0.0)


def rim_axis(structure: Shell | MeshStructure, rim: Rim) -> Rotation:
    """The axis of a rim; z for a chart."""
    if isinstance(structure, Shell):
        return Rotation(omega=0.0)
    return Rotation(omega=0.0, axis=rim.axis, centre=rim.point)


def modelled(structure: Shell | MeshStructure, system: System | MeshSystem) -> bool:
    """Whether the structure provides the terms of rotation; a structure of your own need not."""
    return isinstance(system, System) or isinstance(structure, TurningStructure)


def mesh_turning(structure: Shell | MeshStructure, system: MeshSystem, turns: Rotation) -> MeshTurning:
    """Rotation of a mesh for which `modelled` is true."""
    assert isinstance(structure, TurningStructure)
    return structure.turning(system, turns)


def require_axis(rotation: Rotation, rim: Rotation, radius: float) -> None:
    """Refuse an axis of rotation that differs from that of the rim."""
    apart = np.asarray(rotation.centre) - np.asarray(rim.centre)
    aside = np.linalg.norm(np.cross(rim.direction, apart))
    tilted = np.linalg.norm(np.cross(rim.direction, rotation.direction))
    if tilted > ALONG or aside > ALONG * radius:
        found = f"found the axis {rotation.axis!r} through {rotation.centre!r}"
        expected = f"expected that of the rim, {rim.axis!r} through {rim.centre!r}"
        raise ModelError("reduce-axis", f"rotation: {found}, {expected}")
