"""Pairs of one draw and of the mean casing, from modes with given numbers."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.modal.mistuning import Pair, pairs_of, perfect_pairs

MODES = SimpleNamespace(
    doublets=((1, 2), (3, 5)), splits=np.array([0.02, 0.4]), freq=np.array([80.0, 99.0, 101.0, 120.0, 150.0, 180.0]),
    nodal_diameters=np.array([0, 4, 4, 7, 2, 7]), meridional=np.array([1, 1, 1, 2, 3, 2]),
    angle_deg=np.array([np.nan, 12.0, 34.5, 3.0, 1.0, 15.0]),
)  # fmt: skip


def test_a_pair_has_its_mean_frequency_its_split_and_the_angle_of_its_lower_member():
    assert pairs_of(MODES, 3) == [Pair(3, 4, 1, 100.0, 0.02, 12.0), Pair(3, 7, 2, 150.0, 0.4, 3.0)]


@pytest.mark.parametrize(("count", "kept"), [(2, 0), (3, 1), (5, 1), (6, 2), (9, 2)])
def test_a_pair_of_the_mean_casing_counts_where_both_are_among_the_modes_asked_for(count, kept):
    assert perfect_pairs(MODES, count) == pairs_of(MODES, -1)[:kept]


def test_draws_are_those_that_have_a_pair_and_are_listed_row_by_row():
    found = cf.modal.Mistuning.of([*pairs_of(MODES, 0), *pairs_of(MODES, 4)], perfect_pairs(MODES, 6))
    assert found.draws == 2
    assert found.perfect == {(4, 1): 100.0, (7, 2): 150.0}
    columns = {name: list(values) for name, values in found.columns().items()}
    assert columns == {
        "draw": [0, 0, 4, 4], "n": [4, 7] * 2, "m": [1, 2] * 2, "freq_hz": [100.0, 150.0] * 2,
        "split_rel": [0.02, 0.4] * 2, "angle_deg": [12.0, 3.0] * 2,
    }  # fmt: skip
    assert found.records() == found.summary()
    assert cf.modal.Mistuning.of([], []).draws == 0
