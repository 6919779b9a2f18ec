"""Compiled: response of coupled modes with and without forces, and the work of the coupling."""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit, jit_apart
from contact.jit.vector import WIDTH, load, put
from contact.loop.modal.rows import RowBlocks, fill_some, product_of_sum
from contact.loop.rub.state import ModalBlocks, RubState, Work
from contact.record.record import Tally


@jit_apart
def fly_coupled(s: RubState, blocks: ModalBlocks, w: Work) -> None:
    """Add to the increments `d` the motion of coupled modes without contact, from the last increments `old`."""
    n = s.q.size
    for i in range(0, n, WIDTH):
        put(w.both, i, load(s.old, i))
        put(w.both, n + i, load(s.q, i))
    fill_some(blocks.free, w.both, 0, w.moved_by)
    for i in range(0, n, WIDTH):
        put(s.d, i, load(s.d, i) + load(w.moved_by, i))
    if s.stiff.shape[0] > 0 or s.body.size > 0:
        for i in range(s.push.size):
            w.both[i] = s.push[i]
        for i in range(s.body.size):
            w.both[i] += s.body[i]
        answer(s, blocks, w, w.both)


@jit
def answer(s: RubState, blocks: ModalBlocks, w: Work, forces: Array) -> None:
    """Add the response of coupled modes to forces on all modes to the increments."""
    answer_of(s, blocks.yields, w, forces)


@jit
def answer_of(s: RubState, some: RowBlocks, w: Work, forces: Array) -> None:
    """Add the response of some bodies to forces on all modes to the increments."""
    fill_some(some, forces, 0, w.moved_by)
    for i in range(0, s.d.size, WIDTH):
        put(s.d, i, load(s.d, i) + load(w.moved_by, i))


@jit
def respond(s: RubState, blocks: ModalBlocks, w: Work) -> None:
    """Add the response of coupled modes to the forces of the tips to the increments; that of the casing is known."""
    for i in range(0, w.response.size, WIDTH):
        put(s.d, i, load(s.d, i) + load(w.response, i))
    answer_of(s, blocks.others, w, s.contact)


@jit_apart
def works_of_coupling(s: RubState, blocks: ModalBlocks, w: Work, sums: Tally) -> None:
    """Work of damping and of a skew stiffness on coupled modes, and the error of their discrete energy.

    Call it while q is at t_n.
    """
    fill_some(blocks.lost, s.old, 0, w.moved_by)
    sums.damping[0] -= 0.5 * product_of_sum(w.moved_by, s.old, s.d)
    fill_some(blocks.false, s.old, 0, w.moved_by)
    sums.algorithmic[0] -= 0.5 * product_of_sum(w.moved_by, s.old, s.d)
    fill_some(blocks.odd, s.q, 0, w.moved_by)
    sums.external[0] -= 0.5 * product_of_sum(w.moved_by, s.old, s.d)
