"""Pad arrays over modes, and sums of waves, to whole blocks of eight for the compiled loops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array, Indices, aligned

BLOCK = 8
FOUR = 4  # blocks that are summed together where they have nearly the same waves
MORE = 1.25  # times as many entries: no more take less time together
OF_MODES = ("q", "d", "old", "al", "be", "c", "kick", "weight")
State = TypeVar("State", bound=Any)


def whole(size: int) -> int:
    """The next multiple of eight.

    >>> whole(8), whole(9)
    (8, 16)
    """
    return -(-size // BLOCK) * BLOCK


def widened(state: State, size: int, names: Sequence[str] = OF_MODES) -> State:
    """The same tuple with its arrays over modes padded with zeros to this size, whole blocks."""
    found = dict(zip(names, aligned(len(names), size), strict=True))
    for name, values in found.items():
        values[: state.q.size] = getattr(state, name)
    return state._replace(**found)  # type: ignore[no-any-return]


def narrowed(state: State, modes: int, names: Sequence[str] = OF_MODES) -> State:
    """Views of the modes without padding."""
    return state._replace(**{name: getattr(state, name)[:modes] for name in names})  # type: ignore[no-any-return]


def rows_of_waves(harmonic: Indices, cos: Array, sin: Array, harmonics: int) -> Array:
    """Table (B, w, 2 harmonics) for `row_blocks`, from rows (B, k) that are sums of waves; w is k in whole blocks.

    `cos` and `sin` (B, P, k), of `harmonic` (P,).
    """
    B, _, k = cos.shape
    table = np.zeros((B, whole(k), 2 * harmonics))
    table[:, :k, 2 * harmonic] = cos.transpose(0, 2, 1)
    table[:, :k, 2 * harmonic + 1] = sin.transpose(0, 2, 1)
    return table


def row_blocks(table: Array) -> tuple[Indices, Indices, Array, Indices]:
    """Blocks of eight for `loop.modal.rows.RowBlocks`, from rows that are sums of waves (B, 8 blocks, waves).

    A block has an even number of entries; columns are cos 0, sin 0, cos 1, ..., but the waves found are numbered as
    cos 0, cos 1, ..., sin 0, sin 1, ...

    >>> table = np.zeros((1, 8, 8))
    >>> table[0, 0, 2], table[0, 1, [1, 7]] = 1.0, (2.0, 3.0)
    >>> start, wave, value, alike = row_blocks(table)
    >>> start.tolist(), wave.tolist(), value[:, :2].tolist()
    ([0, 4], [4, 1, 7, 0], [[0.0, 2.0], [1.0, 0.0], [0.0, 3.0], [0.0, 0.0]])
    """
    blocks = table.reshape(-1, BLOCK, table.shape[-1])
    used = blocks.any(axis=1)
    alike = _alike(used.reshape(len(table), table.shape[1] // BLOCK, table.shape[2]))
    owner, column = np.nonzero(used)
    count = np.bincount(owner, minlength=len(blocks))
    start = np.concatenate(([0], np.cumsum(count + count % 2)))
    place = np.arange(owner.size) + (start[:-1] - np.cumsum(count) + count)[owner]
    wave, value = np.zeros(start[-1], dtype=np.int64), aligned(int(start[-1]), BLOCK)
    wave[place] = column // 2 + column % 2 * (table.shape[-1] // 2)
    value[place] = blocks[owner, :, column]
    return start.astype(np.int64), wave, value, alike


def matrix_blocks(matrices: Array) -> tuple[tuple[Indices, Indices, Array, Indices], Array]:
    """Blocks of eight rows for `RowBlocks`, from matrices of one pattern (V, rows, columns), and all V values.

    The blocks have the values of the first matrix; values are (V, entries, 8). Columns are whole blocks.

    >>> (start, wave, value, _), values = matrix_blocks(np.array([np.diag([2.0, 3.0] + 6 * [0.0])]))
    >>> start.tolist(), wave.tolist(), value[:, :2].tolist(), values.shape
    ([0, 2], [0, 1], [[2.0, 0.0], [0.0, 3.0]], (1, 2, 8))
    """
    V, rows, columns = matrices.shape
    padded = np.zeros((V, whole(rows), columns))
    padded[:, :rows] = matrices
    used = padded.any(axis=0).reshape(-1, BLOCK, columns).any(axis=1).repeat(BLOCK, axis=0)
    number = np.where(used, 1.0 + np.arange(used.size, dtype=float).reshape(used.shape), 0.0)
    table = np.zeros((1, *used.shape))
    table[0, :, 0::2], table[0, :, 1::2] = number[:, : columns // 2], number[:, columns // 2 :]
    start, wave, value, alike = row_blocks(table)
    found = np.concatenate([np.zeros((V, 1)), padded.reshape(V, -1)], axis=1)[:, value.astype(np.int64)]
    value[...] = found[0]
    return (start, wave, value, alike), found


def _alike(used: NDArray[np.bool_]) -> Indices:
    """Find blocks (rows, blocks, waves) that begin four with nearly equal waves, and unite these in `used`."""
    rows, blocks, waves = used.shape
    found = np.zeros((rows, blocks), dtype=np.int64)
    whole_four = blocks - blocks % FOUR
    four = used[:, :whole_four].reshape(rows, whole_four // FOUR, FOUR, waves)
    union = four.any(axis=2, keepdims=True)
    same = FOUR * union.sum(axis=(2, 3)) <= MORE * four.sum(axis=(2, 3))
    used[:, :whole_four] = np.where(same[..., None, None], union, four).reshape(rows, whole_four, waves)
    found[:, :whole_four:FOUR] = same
    return found.ravel()
