"""Faults of contact runs: the table of `contact.trust`, which judges them."""

from contact.trust import TROUBLES

RUNS = {code: (f"{one.meaning}: {one.threshold}", one.remedy) for code, one in TROUBLES.items()}
