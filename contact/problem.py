"""Convert a problem to the form that schemes take, and choose its default scheme."""

from __future__ import annotations

from collections.abc import Sequence

from contact.base.errors import InputError
from contact.model.bodies.beam import BeamInCircle
from contact.model.bodies.body import Body
from contact.model.bodies.chain import assemble
from contact.model.law import Law, kind
from contact.scheme.linear.central_difference import CentralDifference
from contact.scheme.linear.penalty_difference import PenaltyDifference
from contact.scheme.modal.exact_modal import ExactModal
from contact.scheme.protocol import Problem, Scheme

What = Sequence[Body] | Problem


def problem_of(what: What, gravity: float) -> Problem:
    """The scene or problem in the form that schemes take."""
    if isinstance(what, Sequence):
        for body in what:
            if not hasattr(body, "crossing_time"):
                raise InputError(f"bodies: found {type(body).__name__}, expected Rod, PointMass or Wall")
        return assemble(what, gravity=gravity)
    if gravity:
        expected = "none" if isinstance(what, BeamInCircle) else "gravity as a load of the bodies"
        raise InputError(f"gravity: found {gravity:g} m/s^2 with {type(what).__name__}, expected {expected}")
    return what


def default_scheme(problem: Problem, law: Law) -> Scheme:
    """Exact modal steps; for a problem given by M, C, K, central differences, or the scheme of a penalty."""
    if isinstance(problem, BeamInCircle):
        return CentralDifference()
    if not hasattr(problem, "linear_form"):
        return ExactModal()
    return PenaltyDifference() if kind(law) == "Penalty" else CentralDifference()
