"""Coefficients of coupled modes for a rub's loop: rows by blocks of eight, at one or several speeds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact.base.arrays import Array
from contact.scheme.modal.at_speeds import AtSpeeds
from contact.scheme.modal.blocks import matrix_blocks, whole
from contact.scheme.modal.coupled import Coupled

if TYPE_CHECKING:
    from contact.loop.rub.state import ModalBlocks


def modal_blocks(speeds: AtSpeeds, modes: int, casing: int) -> tuple[ModalBlocks | None, tuple[Array, ...]]:
    """Blocks with the values at the first node, in a pattern for all nodes, and the values at each node.

    None without coupled modes. `modes` is the number of all modes, of which the first `casing` are the casing's. Values
    are (nodes, entries, 8) for each part of the blocks.
    """
    from contact.loop.modal.rows import RowBlocks
    from contact.loop.rub.state import ModalBlocks

    found = [part.coupled for part in speeds.parts if part.coupled is not None]
    if not found:
        return None, ()
    parts = [matrix_blocks(np.array(same)) for same in zip(*[_matrices(p, modes, casing) for p in found], strict=True)]
    return ModalBlocks(*[RowBlocks(*blocks) for blocks, _ in parts]), tuple(values for _, values in parts)


def _matrices(part: Coupled, modes: int, casing: int) -> tuple[Array, ...]:
    """Matrices in the order of `ModalBlocks`, with columns in whole blocks."""

    def of_all(values: Array) -> Array:
        found = np.zeros((modes, whole(modes)))
        found[np.ix_(part.modes, part.modes)] = values
        return found

    def of_casing(values: Array) -> Array:
        found = np.zeros((casing, whole(casing)))
        found[:, :casing] = values[:casing, :casing]
        return found

    c = of_all(part.c)
    others = c.copy()
    others[:casing, :casing] = 0.0
    free = np.concatenate([of_all(part.alpha), -of_all(part.beta)], axis=1)
    return (
        free, c, of_casing(c), others, of_casing(c[:, :modes].T),
        of_all(part.lost), of_all(part.false), of_all(part.odd),
    )  # fmt: skip


def fill_blocks(blocks: ModalBlocks, weights: Array, values: tuple[Array, ...]) -> None:
    """Fill blocks with values interpolated between nodes, with these weights of the nodes."""
    for part, at_nodes in zip(blocks, values, strict=True):
        part.value[...] = np.tensordot(weights, at_nodes, axes=1)
