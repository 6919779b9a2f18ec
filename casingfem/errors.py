"""What can be wrong with a model: every refusal and warning has a code, a cause and a remedy, and they stand here.

A message says what was found where; the remedy and the code come from the catalogue, so that a user can look a code
up and a program can react to it.
"""

import warnings
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple


class Fault(NamedTuple):
    """One entry of the catalogue: why a model is refused or doubted, and what helps."""

    cause: str
    remedy: str


CATALOGUE: Mapping[str, Fault] = MappingProxyType(
    {
        "bolt-count": Fault("there is no such number of bolts", "give the number of bolts, 1 to 1000"),
        "bolt-mesh": Fault(
            "elements around that do not follow the bolts see some bolts stiffer than others and split perfect pairs",
            "leave mesh.around out, or make it a multiple of the number of bolts",
        ),
        "bolt-number": Fault("a loose bolt is named that does not exist", "number the bolts from 1 to their count"),
        "bolt-off-edge": Fault(
            "a bolt, with the patch it acts on, does not lie on the edge",
            "change first_angle, spacing or width, or take fewer bolts",
        ),
        "bolt-overlap": Fault(
            "neighbouring bolts act on the same part of the edge", "give a smaller width, or a larger spacing"
        ),
        "bolt-stiffness": Fault(
            "a bolt without stiffness, or with an impossible one, holds nothing",
            "give k in N/m, one number or [k_r, k_theta, k_z], and factors of 0 or more",
        ),
        "shell-thickness": Fault(
            "the wall thickness is not a positive finite number", "give the thickness in metres, 3 mm as 3e-3"
        ),
        "springs-negative": Fault(
            "the pattern of an elastic edge falls below -1 somewhere: a spring would push",
            "reduce the harmonics of its pattern until their sum stays above -1",
        ),
        "strip-extent": Fault(
            "the ends of a strip are not finite numbers in order", "give start below end, in metres along the axis"
        ),
        "strip-off-line": Fault(
            "a strip ends inside an element, where its jump of thickness or material would be smeared",
            "leave the mesh's rows to the program, or put a break of mesh.rows at each end of the strip",
        ),
        "strip-outside": Fault(
            "a strip reaches beyond the ends of the shell", "give start and end in metres within the chart's bounds"
        ),
        "strip-overlap": Fault("two strips claim the same part of the wall", "let one strip end where the next begins"),
    }
)


class ModelError(ValueError):
    """A model that is refused: `code` names the fault in the catalogue, the message ends with remedy and code.

    >>> str(ModelError("shell-thickness", "shell.thickness must be above 0, found -3.0"))
    'shell.thickness must be above 0, found -3.0: give the thickness in metres, 3 mm as 3e-3 [shell-thickness]'
    """

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(sentence(code, message))


class ModelWarning(UserWarning):
    """A model that is computed although its result may mislead; same form as `ModelError`."""

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(sentence(code, message))


def doubt(code: str, message: str, *, stacklevel: int = 3) -> None:
    """Warn of a catalogued fault that does not stop the computation."""
    warnings.warn(ModelWarning(code, message), stacklevel=stacklevel)


def sentence(code: str, message: str) -> str:
    """What was found, what helps, and the code."""
    return f"{message}: {CATALOGUE[code].remedy} [{code}]"
