"""Order-preserving alignment of measured groups with computed slots, by dynamic programming.

Both sides are sequences in ascending frequency: groups of one row or of a doublet's two,
slots of one mode or of a doublet's two.  A group goes to a slot, or is left out; the order
is kept.  It is the optimal assignment on a line, except that a doublet is one thing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

Indices: TypeAlias = tuple[int, ...]
Cost: TypeAlias = Callable[[Indices, Indices], float]


def align(
    groups: Sequence[Indices],
    slots: Sequence[Indices],
    cost: Cost,
    *,
    left_out: float,
    skipped: Sequence[float],
) -> list[tuple[Indices, Indices]]:
    """Return the cheapest list of (rows, modes).

    Parameters
    ----------
    groups, slots : row indices and mode indices, one or two each
    cost : of giving rows to modes, inf where forbidden; one row may be given to a slot of two
    left_out : cost of each row without a mode
    skipped : (slots,) cost of each slot left without rows below the last one that has some

    Moves beyond one to one: two single rows fill a doublet; a measured doublet takes two
    neighbouring single modes, or gives one row to one mode and leaves out the other.

    Examples
    --------
    >>> freq = {"rows": [100.0, 101.0, 300.0], "modes": [104.0, 104.0, 210.0, 290.0]}
    >>> def cost(rows, modes):
    ...     return abs(freq["rows"][rows[0]] - freq["modes"][modes[0]]) * len(rows)
    >>> align([(0, 1), (2,)], [(0, 1), (2,), (3,)], cost, left_out=50.0, skipped=[0.0] * 3)
    [((0, 1), (0, 1)), ((2,), (3,))]
    """
    inf = float("inf")
    best = [[inf] * (len(slots) + 1) for _ in range(len(groups) + 1)]
    came: dict[tuple[int, int], tuple[int, int, tuple[Indices, Indices] | None]] = {}
    best[0][0] = 0.0

    def offer(g: int, s: int, from_g: int, from_s: int, price: float, match: tuple[Indices, Indices] | None) -> None:
        total = best[from_g][from_s] + price
        if total < best[g][s]:
            best[g][s], came[g, s] = total, (from_g, from_s, match)

    for g in range(len(groups) + 1):
        for s in range(len(slots) + 1):
            if g and s:
                pair = groups[g - 1], slots[s - 1]
                if len(pair[0]) <= len(pair[1]):
                    offer(g, s, g - 1, s - 1, cost(*pair), pair)
                else:
                    for row in pair[0]:
                        alone = (row,), pair[1]
                        offer(g, s, g - 1, s - 1, cost(*alone) + left_out, alone)
            if g > 1 and s and len(slots[s - 1]) == 2 and len(groups[g - 1]) == len(groups[g - 2]) == 1:
                pair = groups[g - 2] + groups[g - 1], slots[s - 1]
                price = sum(cost((row,), (mode,)) for row, mode in zip(*pair, strict=True))
                offer(g, s, g - 2, s - 1, price, pair)
            if g and s > 1 and len(groups[g - 1]) == 2 and len(slots[s - 1]) == len(slots[s - 2]) == 1:
                pair = groups[g - 1], slots[s - 2] + slots[s - 1]
                offer(g, s, g - 1, s - 2, cost(*pair), pair)
            if s:
                offer(g, s, g, s - 1, skipped[s - 1], None)
            if g:
                offer(g, s, g - 1, s, left_out * len(groups[g - 1]), None)
    matches = []
    g, s = len(groups), min(range(len(slots) + 1), key=lambda k: best[len(groups)][k])
    while (g, s) != (0, 0):
        g, s, match = came[g, s]
        if match is not None:
            matches.append(match)
    return matches[::-1]
