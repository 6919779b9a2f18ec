"""Compiled formulas of one exact-modal step and its energies, for scalars or for eight runs at once.

Rubs, rims, patches, fixed points and batches of runs use the same formulas. For eight runs, the caller also passes
constants as eight numbers.
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
    """Work of one contact, of the motion of its point over the rim, and of friction.

    Force times displacement: `opened` is the modal gap over two steps, `across` the normal and `along` the tangential
    rows over D_n + D_{n+1}, `soft` the tangential deflection by S over this step, each times its force. `turned` is
    that of `turned_work`.
    """
    work = half * (opened + turned)
    return work - soft, half * across - work, half * along + soft
