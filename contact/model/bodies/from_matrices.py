"""A modal body from given matrices, and a report on them."""

from __future__ import annotations

from contact.model.bodies.matrices import Contact, Matrices
from contact.model.bodies.matrix_modes import reduced
from contact.model.bodies.matrix_report import MatrixReport
from contact.model.bodies.modal_body import ModalBody


def body_of(
    matrices: Matrices, contact: Contact, *, modes: int | None = None, zeta: float = 0.0
) -> tuple[ModalBody, MatrixReport]:
    """Reduce matrices to a modal body with its contact channels, and report on them.

    20 modes, or all if there are fewer.

    Raises InputError for indefinite matrices, unknown dofs, or more modes than the matrices have.

    >>> import numpy as np
    >>> K = 1e6 * np.array([[2.0, -1.0], [-1.0, 1.0]])
    >>> chain = Matrices.of(K=K, M=np.eye(2), dofs=[(1, "x"), (2, "x")])
    >>> body, report = body_of(chain, [(2, "x")], modes=1)
    >>> (body.omega / (2.0 * np.pi)).round(2).tolist(), report.kept, report.size
    ([98.36], 1, 2)
    """
    fields, facts = reduced(matrices, contact, modes=modes, zeta=zeta)
    return ModalBody(**fields), facts
