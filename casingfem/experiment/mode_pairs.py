"""Which identified modes are partners, and what is said of those that have none."""

from __future__ import annotations

from casingfem.experiment.circle import quadrature
from casingfem.experiment.found_modes import FoundMode, not_told_apart

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
    """The modes, where those that hold two shapes and have no partner stand for a pair."""
    members = {k for pair in doublets for k in pair}
    return [
        not_told_apart(mode) if mode.double and k not in members and not mode.unresolved else mode
        for k, mode in enumerate(modes)
    ]


def notes_of(modes: list[FoundMode], doublets: tuple[tuple[int, int], ...]) -> tuple[str, ...]:
    """What cannot be told apart, in words."""
    members = {k for pair in doublets for k in pair}
    said = []
    for k, mode in enumerate(modes):
        share = mode.split_bound / (2.0 * mode.zeta)
        if mode.unresolved:
            said.append(
                f"pair at {mode.freq:.2f} Hz: split below {share:.2g} of its bandwidth ({mode.split_bound:.1e}"
                " relative), given as one frequency"
            )
        elif mode.n > 0 and k not in members:
            said.append(
                f"n = {mode.n} at {mode.freq:.2f} Hz has no partner: the references do not drive it, or the split is"
                f" below {share:.2g} of its bandwidth ({mode.split_bound:.1e} relative)"
            )
    return tuple(said)
