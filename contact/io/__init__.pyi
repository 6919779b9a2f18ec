from .brief import brief
from .columns import Column, records_of, table_lines
from .reported import Reported

__all__ = [
    "Column",
    "Reported",
    "brief",
    "records_of",
    "table_lines",
]
