from .record import ScanRecord
from .scan import CircleScan, demodulate

__all__ = [
    "CircleScan",
    "ScanRecord",
    "demodulate",
]
