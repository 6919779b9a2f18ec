from .pair import split_pair
from .record import ScanRecord, from_tacho, turning
from .scan import CircleScan, demodulate

__all__ = [
    "CircleScan",
    "ScanRecord",
    "demodulate",
    "from_tacho",
    "split_pair",
    "turning",
]
