"""Compiled: formulas of one exact-modal step and its ledger, of numbers or of eight runs at once.

Written once for rubs, rims, patches, fixed points and runs in slots. Where eight numbers stand for one, constants are
given by the caller as eight numbers, too.
"""

from __future__ import annotations

from contact.jit.compiled import jit_inside


@jit_inside
def free_step(al: float, be: float, last: float, q: float) -> float:
    """Increment of a mode without forces."""
    return al * last - be * q


@jit_inside
def damped(weight: float, before: float, step: float) -> float:
    """Energy that modal damping dissipates over a step, (1 - al) D_n (D_n + D_{n+1})/(2 c)."""
    return weight * before * (before + step)


@jit_inside
def mean_gap(quarter: float, free: float, now: float, last: float) -> float:
    """Gap of the averaged law, (g_{n+1} + 2 g_n + g_{n-1})/4."""
    return quarter * (free + (now + now) + last)


@jit_inside
def turned_work(press: float, drag: float, nn: float, nt: float, tt: float) -> float:
    """Twice the energy that a change of the residual compliance stores under the forces of one contact."""
    return press * (nn * press + nt * drag) + drag * (nt * press + tt * drag)


@jit_inside
def works(half: float, opened: float, turned: float, across: float, along: float,
          soft: float) -> tuple[float, float, float]:  # fmt: skip
    """Work of one contact, of its point that moves over the rim, and of friction.

    Forces times what they move: `opened` the gap of the modes over two steps, `across` the normal rows and `along` the
    tangential ones over D_n + D_{n+1}, `soft` the tangential strain of S over this step, all times their force;
    `turned` as of `turned_work`.
    """
    work = half * (opened + turned)
    return work - soft, half * across - work, half * along + soft
