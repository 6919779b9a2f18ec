from .files import read_coherence, read_frfs, read_picks, read_places
from .frf_set import FrfSet
from .records.estimate import estimate
from .records.estimated import Estimate
from .records.read import read_records, read_responses
from .records.take import Take

__all__ = [
    "Estimate",
    "FrfSet",
    "Take",
    "estimate",
    "read_coherence",
    "read_frfs",
    "read_picks",
    "read_places",
    "read_records",
    "read_responses",
]
