"""What a rub or a patch lacks, for its loop: parts without entries, so that one loop is compiled for all runs."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from contact.base.arrays import aligned


class Absent(NamedTuple):
    """No coating, no force-depth law, no coupled modes, no steady contacts, as arguments of the loop."""

    coats: Any
    law: Any
    blocks: Any
    steady: Any


@cache
def absent() -> Absent:
    """The parts, made once."""
    from contact.jit.bundle import bundled
    from contact.loop.modal.rows import RowBlocks
    from contact.loop.rub.state import ModalBlocks
    from contact.loop.rub.steady import AtOnce, Steady
    from contact.loop.tally import Sticking
    from contact.solver.abradable.tips import no_coats
    from contact.solver.unilateral.active_set import active_space
    from contact.solver.unilateral.springs import spring_space
    from contact.solver.yielding.yields import no_law

    none, plane, whole = np.zeros(0), np.zeros((0, 0)), np.zeros(0, dtype=np.int64)
    rows = RowBlocks(whole, whole, aligned(0, 8), whole)
    steady = Steady(
        rows=plane, roots=plane, springs=none, at_once=AtOnce(used=False), active=active_space(0, 0),
        soft=spring_space(0, 0),
        past=Sticking(plane, none, none, none), slip=none, strain=none,
    )  # fmt: skip
    parts = no_coats(), no_law(), ModalBlocks(*(rows,) * len(ModalBlocks._fields)), steady
    return Absent(*map(bundled, parts))
