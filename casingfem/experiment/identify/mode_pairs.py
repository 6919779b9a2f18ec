"""Which identified modes are partners, and what is said of those that have none."""

from __future__ import annotations

from dataclasses import replace

from casingfem.experiment.circle.orientation import quadrature
from casingfem.experiment.identify.found_modes import FoundMode, without_antinode

PAIR_SPAN = 0.3  # relative split beyond which two modes of one n are no pair
APART = 0.7  # least quadrature of partners


def paired(modes: list[FoundMode]) -> tuple[tuple[int, int], ...]:
    """Doublets (lower, upper): neighbours of the same n a quarter wave apart."""
    pairs, taken = [], set[int]()
    for k, mode in enumerate(modes):
        if k in taken or mode.n < 1 or mode.unresolved:
            continue
        others = (
            m for m in range(k + 1, len(modes)) if modes[m].n == mode.n and m not in taken and not modes[m].unresolved
        )
        partner = next(others, None)
        if partner is None or modes[partner].freq - mode.freq > PAIR_SPAN * mode.freq:
            continue
        if quadrature(mode.angle, modes[partner].angle, mode.n) > APART:
            pairs.append((k, partner))
            taken |= {k, partner}
    return tuple(pairs)


def settled(modes: list[FoundMode], doublets: tuple[tuple[int, int], ...]) -> list[FoundMode]:
    """The modes, where those that hold two shapes and have no partner stand for a pair.

    A mode of n >= 1 without partner may be a pair that the references drive in one plane only: it has the antinode
    of the drive then, so none is given, and its frequency is uncertain by half the split that would be hidden.
    """
    members = {k for pair in doublets for k in pair}
    alone = [k not in members and mode.n > 0 and not mode.unresolved for k, mode in enumerate(modes)]
    return [
        replace(without_antinode(mode), unresolved=mode.double) if single else mode
        for mode, single in zip(modes, alone, strict=True)
    ]


def notes_of(modes: list[FoundMode], doublets: tuple[tuple[int, int], ...]) -> tuple[str, ...]:
    """What cannot be told apart, in words."""
    members = {k for pair in doublets for k in pair}
    notes = []
    for k, mode in enumerate(modes):
        share = mode.split_bound / (2.0 * mode.zeta)
        if mode.unresolved:
            notes.append(
                f"pair at {mode.freq:.2f} Hz: split below {share:.2g} of its bandwidth ({mode.split_bound:.1e}"
                " relative), given as one frequency"
            )
        elif mode.n > 0 and k not in members:
            notes.append(
                f"n = {mode.n} at {mode.freq:.2f} Hz has no partner: the references do not drive it, or the split is"
                f" below {share:.2g} of its bandwidth ({mode.split_bound:.1e} relative); no orientation is given"
            )
    return tuple(notes)
