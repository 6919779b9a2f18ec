"""Faults concerning contact runs: the table of `contact.io.trust`, which judges them."""

from contact.io.trust import TROUBLES

RUNS = {code: (f"{one.meaning}: {one.threshold}", one.remedy) for code, one in TROUBLES.items()}
