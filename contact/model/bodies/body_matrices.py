"""C and K of several modal bodies at a speed, one after the other: coupling within a body, and rotation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.base.arrays import Array
from contact.model.bodies.modal_body import ModalBody


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class BodyMatrices:
    """Bodies of a scene and the sense in which each turns: 1 or -1 with the speed, 0 for a body at rest.

    A body at rest has the stiffness of its basis at rest and the coupling of its modes, at any speed.
    """

    bodies: tuple[ModalBody, ...]
    senses: tuple[int, ...]

    @staticmethod
    def of_one(body: ModalBody) -> BodyMatrices:
        """One body in a scene without a speed: it keeps the stiffness of its basis, whatever the speed of that basis.

        >>> pair = ModalBody(omega=[3.0], zeta=[0.0], channels=("x",), rows=[[1.0]], S=[[0.0]], spin=2.0,
        ...                  stiffness_by_speed=[[0.5]])
        >>> BodyMatrices.of_one(pair).at(0.0)[1].tolist()
        [[9.0]]
        """
        return BodyMatrices(bodies=(body.without_rotation(),), senses=(0,))

    @property
    def vary(self) -> bool:
        """Whether any matrix depends on the speed."""
        return any(sense != 0 and body.varies for body, sense in zip(self.bodies, self.senses, strict=True))

    @property
    def coupled(self) -> bool:
        """Whether any body has more than the frequencies and damping of its uncoupled modes."""
        return self.vary or any(
            body.damping is not None or body.stiffness is not None or (body.spin != 0.0 and body.varies)
            for body in self.bodies
        )

    def at(self, omega: float) -> tuple[Array, Array]:
        """C [1/s] and K [1/s^2] of all modes at a speed [rad/s], (m, m) each.

        >>> pair = ModalBody(omega=[3.0, 3.0], zeta=[0.0, 0.0], channels=("x", "y"), rows=np.eye(2),
        ...                  S=np.zeros((2, 2)), gyroscopic=[[0.0, -2.0], [2.0, 0.0]])
        >>> BodyMatrices(bodies=(pair, pair), senses=(0, -1)).at(0.5)[0][2:].tolist()
        [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, -1.0, 0.0]]
        """
        from scipy.linalg import block_diag

        parts = [body.matrices(sense * omega) for body, sense in zip(self.bodies, self.senses, strict=True)]
        C, K = (block_diag(*[part[k] for part in parts]) for k in (0, 1))
        return np.asarray(C), np.asarray(K)
