"""What runs of a hinged beam in a circle share, whatever their scheme."""

from __future__ import annotations

from dataclasses import dataclass

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.model.bodies.beam import BeamInCircle
from contact.model.law import Law, kind
from contact.record.record import Tally
from contact.scheme.protocol import Block, Motion


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class BeamRun:
    """The scene, its sums and step; contacts are the nodes 1, 2, ... from the hinge outwards."""

    problem: BeamInCircle
    sums: Tally
    dt: float
    window: float
    label: str

    @property
    def size(self) -> int:
        """Number of coordinates of the beam: x, y, theta of each node."""
        return 3 * (self.problem.beam.elements + 1)

    @property
    def blocks(self) -> tuple[Block, ...]:
        """The beam alone."""
        return (("beam 1", 0, self.size),)

    def motion(self, velocity: Array) -> tuple[Motion, ...]:
        """Momentum along x of nodes that move at `velocity` (nodes, 3)."""
        mass = self.problem.beam.lumped()[:, 0]
        momentum = float(mass @ velocity[:, 0])
        return (Motion(kind="beam", number=0, mean_velocity=momentum / float(mass.sum()), momentum=momentum),)

    def spin(self, x: Array, velocity: Array) -> float:
        """Angular momentum about the hinge [kg m^2/s]."""
        mass = self.problem.beam.lumped()
        orbit = mass[:, 0] * (x[:, 0] * velocity[:, 1] - x[:, 1] * velocity[:, 0])
        return float((orbit + mass[:, 2] * velocity[:, 2]).sum())


def require_rigid(law: Law) -> None:
    """Raise InputError for any law but that of rigid contact without friction."""
    if kind(law) != "Unilateral":
        raise InputError(f"law: found {law!r}, expected Unilateral() for a beam in a circle")
