"""Sums of element matrices and of what stands on edges: in place, and by a pattern that is kept."""

import numpy as np
import pytest
from scipy.sparse import csc_array, random_array

from casingfem.structure.mesh import scatter
from casingfem.structure.mesh.scatter import added
from casingfem.structure.shell.assembly import assemble


def test_entries_within_the_pattern_are_added_in_place_others_make_a_new_matrix():
    rng = np.random.default_rng(3)
    K = csc_array(random_array((40, 40), density=0.2, rng=rng) + 3.0 * np.eye(40)).sorted_indices()
    few = csc_array(np.diag(np.where(np.arange(40) % 7 == 0, 2.0, 0.0)))
    whole, memory = K.toarray() + few.toarray(), K.data
    total = added(K, few)
    assert total.data is memory
    np.testing.assert_array_equal(total.toarray(), whole)
    outside = csc_array((np.ones(1), ([0], [int(np.flatnonzero(whole[0] == 0.0)[0])])), shape=K.shape)
    np.testing.assert_array_equal(added(total, outside).toarray(), whole + outside.toarray())
    assert added(total, csc_array((40, 40))).nnz == total.nnz


@pytest.mark.parametrize("kept", [scatter.KEPT, 0])
def test_a_pattern_serves_the_mesh_it_was_made_for(frustum, coarse, monkeypatch, kept):
    monkeypatch.setattr(scatter, "KEPT", kept)
    monkeypatch.setattr(scatter.Recent, "pattern", None)
    held, free, again = (assemble(frustum(mesh=coarse, **parts)).K for parts in ({}, {"supports": {}}, {}))
    assert held.shape[0] < free.shape[0]
    np.testing.assert_array_equal(held.toarray(), again.toarray())
    again.data[:] = again.indices[:] = 0  # a matrix of one's own: the next is none the worse
    assert (assemble(frustum(mesh=coarse)).K != held).nnz == 0
    assert (scatter.Recent.pattern is None) is (kept == 0)
