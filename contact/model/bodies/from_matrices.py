"""A modal body of someone's matrices, and what they are."""

from __future__ import annotations

from contact.model.bodies.matrices import Contact, Matrices, MatrixReport
from contact.model.bodies.matrix_modes import reduced
from contact.model.bodies.modal_body import ModalBody


def body_of(
    matrices: Matrices, contact: Contact, *, modes: int | None = None, zeta: float = 0.0
) -> tuple[ModalBody, MatrixReport]:
    """Reduce matrices to a modal body seen at its contact, and say what they are; 20 modes, or all if they are fewer.

    Raises InputError for indefinite matrices, dofs that are not there, or more modes than there are.
    """
    fields, facts = reduced(matrices, contact, modes=modes, zeta=zeta)
    return ModalBody(**fields), facts
