"""Compiled: the bars of a coating under the tips of a rub."""

from __future__ import annotations

import math

from contact.jit.compiled import jit
from contact.loop.modal.rows import rotate
from contact.loop.rub.rows import RubLaws, RubRows, hermite, polynomial
from contact.loop.rub.state import RubState, Work
from contact.solver.abradable.one_tip import first_bar, machined, surface, wear
from contact.solver.abradable.tips import Coats, coating_of


@jit
def stand(s: RubState, laws: RubLaws, rows: RubRows, w: Work, coats: Coats, dim: int, angle: float) -> int:
    """Bars under the tips that are near; their gaps become those of the surface. How many no longer close."""
    apart = 0
    for j in range(s.mu.size):
        coats.memory[j, 1] = 0.0
        if s.inside[j] == 0:
            continue
        tip, phi, cut = coating_of(coats, j), rows.angle[j] - angle, 0.0
        if tip.round > -math.inf:
            rotate(w.turn, phi)
            cut = machined(tip, polynomial(laws.terms, w.turn) + hermite(laws.table, phi))
        coats.first[j], coats.cut[j] = first_bar(tip, phi / (2.0 * math.pi)), cut
        s.skin[j] = surface(tip, coats.first[j], cut)
        s.test[j] += s.skin[j]
        s.motion[j * dim] = s.test[j]
        if s.inside[j] == 2 and s.test[j] >= 0.0 and not s.lam[j * dim] > 0.0:
            s.inside[j] = 1
            apart += 1
    return apart


@jit
def flow(s: RubState, w: Work, coats: Coats, count: int, dim: int) -> None:
    """Let the bars under the chosen tips flow, each to the depth that was found."""
    for a in range(count):
        j = w.chosen[a]
        if s.lam[j * dim] > 0.0:
            wear(coating_of(coats, j), coats.first[j], coats.cut[j], coats.memory[j, 2])
