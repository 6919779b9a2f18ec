"""One entry of the catalogue of faults."""

from typing import NamedTuple


class Fault(NamedTuple):
    """Why a model is refused or doubted, and what helps."""

    cause: str
    remedy: str
