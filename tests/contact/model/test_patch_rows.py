"""Rows, compliances and gaps of a patch, contact by contact."""

import numpy as np
import pytest

import contact as ct


def test_rows_and_compliance_of_a_patch_are_contact_by_contact():
    rng = np.random.default_rng(2)
    mixing = rng.standard_normal((5, 5))
    body = ct.ModalBody(omega=[1.0, 2.0], zeta=[0.0] * 2, channels=("a", "b", "c", "d", "e"),
                        rows=rng.standard_normal((5, 2)), S=mixing @ mixing.T)  # fmt: skip
    patch = ct.Patch(body=body, normal=("d", "b"), tangent=(("a",), ("e",)), clearance=[0.5, 0.25], slide=3.0,
                     pressed=[-0.75, 0.125], displacement=[1e-9, 0.0])  # fmt: skip
    assert (patch.contacts, patch.dimensions, patch.channels()) == (2, 2, [3, 0, 1, 4])
    np.testing.assert_array_equal(patch.rows(), body.rows[[3, 0, 1, 4]])
    np.testing.assert_array_equal(patch.compliance(), body.S[np.ix_([3, 0, 1, 4], [3, 0, 1, 4])])
    assert patch.opening.tolist() == [-0.25, 0.375]
    assert patch.slide.tolist() == [[3.0], [3.0]]
    plain = ct.Patch(body=body, normal=("d", "b"))
    assert (plain.dimensions, plain.slide.shape, plain.opening.tolist()) == (1, (2, 1), [0.0, 0.0])
    assert [part.tolist() for part in (plain.displacement, plain.velocity, plain.load)] == [[0.0, 0.0]] * 3
    wide = ct.Patch(body=body, normal=("d",), tangent=(("a", "c"),), slide=[[1.0, 2.0]])
    assert (wide.dimensions, wide.channels(), wide.slide.tolist()) == (3, [3, 0, 2], [[1.0, 2.0]])


def test_a_patch_may_begin_closed_by_round_off():
    body = ct.ModalBody(omega=[1.0], zeta=[0.0], channels=("n", "m"), rows=[[1.0], [-1.0]], S=np.zeros((2, 2)))
    ct.Patch(body=body, normal=("n",), displacement=[-0.9e-12])
    ct.Patch(body=body, normal=("n",), clearance=1e3, displacement=[-1e3 - 0.5e-9])
    for clearance, displacement, words in (
        ([0.0, 0.0], 1.1e-12, r"contact 2 penetrates by 1\.1e-12 m"),
        ([1.0, 3.0], -1.5, r"contact 1 penetrates by 0\.5"),
    ):
        with pytest.raises(ct.InputError, match=f"clearance: {words}"):
            ct.Patch(body=body, normal=("n", "m"), clearance=clearance, displacement=[displacement])
