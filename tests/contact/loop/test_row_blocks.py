"""Rows and products of eight modes at a time against numpy's."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.contact.plain import names

ROWS = names("loop.modal.rows")


def waves_of(phi, count=8):
    n = np.arange(count)
    return np.stack([np.cos(n * phi), np.sin(n * phi)])


@pytest.mark.parametrize("count", [8, 16, 24])
@pytest.mark.parametrize("phi", [0.3, -2.7])
def test_multiples_of_an_angle(count, phi):
    waves = np.zeros((2, count))
    ROWS.rotate(waves, phi)
    np.testing.assert_allclose(waves, waves_of(phi, count), atol=1e-14)


def blocks(alike, lengths, seed=2):
    """Sums of waves in blocks, and the whole matrix (sums, waves)."""
    rng, start, wave, value, whole = np.random.default_rng(seed), [0], [], [], []
    for b, length in enumerate(lengths):
        own = rng.choice(16, length, replace=False) if not (alike[b] == 0 and b and any(alike)) else wave[-length:]
        coefficients = rng.standard_normal((length, 8))
        matrix = np.zeros((8, 16))
        for w, row in zip(own, coefficients, strict=True):
            matrix[:, w] += row
        start.append(start[-1] + length)
        wave += list(own)
        value.append(coefficients)
        whole.append(matrix)
    rows = ROWS.RowBlocks(np.array(start), np.array(wave), np.concatenate(value), np.array(alike))
    return rows, np.concatenate(whole)


@pytest.mark.parametrize("lengths", [[2, 4, 6], [8, 2, 10], [0, 6, 2]])
def test_sums_of_waves_in_blocks_of_their_own(lengths):
    rows, whole = blocks([0, 0, 0], lengths)
    waves, row = waves_of(0.7), np.full(16, 9.0)
    ROWS.fill_some(rows, waves, 1, row)
    np.testing.assert_allclose(row, whole[8:] @ waves.ravel(), atol=1e-14)


def test_four_blocks_with_the_same_waves_are_summed_together():
    rows, whole = blocks([1, 0, 0, 0, 0], [6, 6, 6, 6, 4])
    waves, row = waves_of(-1.1), np.full(40, 9.0)
    ROWS.fill_some(rows, waves, 0, row)
    np.testing.assert_allclose(row, whole @ waves.ravel(), atol=1e-14)


def test_products_over_whole_blocks():
    a, b, c = np.random.default_rng(3).standard_normal((3, 24))
    assert ROWS.product(a, b) == pytest.approx(a @ b, rel=1e-13)
    assert ROWS.product_of_sum(a, b, c) == pytest.approx(a @ (b + c), rel=1e-13)
    assert ROWS.weighted(a, b, c) == pytest.approx(np.sum(a * b * c), rel=1e-13)
    assert ROWS.bound(a, b, c) == pytest.approx(a @ np.abs(b + c), rel=1e-13)
    s = SimpleNamespace(q=np.ones(24), weight=c)
    assert ROWS.move(s, a, b) == pytest.approx(-np.sum(c * a * (a + b)), rel=1e-13)
    np.testing.assert_array_equal(s.q, 1.0 + b)
