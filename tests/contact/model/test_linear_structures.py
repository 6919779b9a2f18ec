"""Linear structures as plain arrays: what is left out, and what cannot be."""

import math

import numpy as np
import pytest
from scipy.sparse import coo_array, csr_array, diags_array

import contact as ct


def structure(**more):
    return ct.LinearBody(**{"M": np.ones(2), "K": 2.0 * np.eye(2), "Q": np.array([[1.0, 0.0]]), "gap0": [0.1]} | more)


def test_defaults_of_a_linear_structure():
    body = structure()
    assert (body.size, body.contacts, body.potential, body.crossing_time) == (2, 1, 0.0, math.inf)
    assert [part.tolist() for part in (body.load, body.displacement, body.velocity)] == [[0.0, 0.0]] * 3
    assert [(p.name, p.start, p.end, p.number, p.rigid) for p in body.parts] == [("body 1", 0, 2, 0, False)]
    assert (body.C.shape, body.C.nnz) == ((2, 2), 0)
    assert not body.in_order


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"K": np.eye(3)}, r"K: found shape \(3, 3\), expected \(2, 2\), or \(2,\) of a diagonal matrix"),
        ({"M": np.array([1.0, 0.0])}, "M: found 0 kg at coordinate 2, expected a mass > 0"),
        ({"K": np.array([[1.0, math.nan], [0.0, 1.0]])}, "K: found entries that are NaN or infinite"),
        ({"K": csr_array([[1.0, math.inf], [0.0, 1.0]])}, "K: found entries that are NaN or infinite"),
        ({"K": csr_array([[1.0, 0.5], [0.0, 2.0]])}, r"K: found an asymmetry of 0\.25 of the largest entry"),
        ({"Q": np.array([[1.0, 0.0], [0.0, 1.0]])}, r"Q: found shape \(2, 2\), expected \(1, 2\), a row for each of"),
        ({"Q": np.zeros((0, 2)), "gap0": []}, "Q: found no rows, expected one for each contact"),
        ({"Q": np.array([[1.0, 0.0], [0.0, 0.0]]), "gap0": [0.1, 0.1]}, "Q: row 2 is zero: contact 2 touches nothing"),
        ({"displacement": [-0.3, 0.0]}, r"gap0: contact 1 penetrates by 0\.2 m at t = 0"),
        ({"load": [1.0]}, r"load: found shape \(1,\)"),
        ({"velocity": [1.0]}, r"velocity: found shape \(1,\)"),
    ],
)
def test_linear_structures_that_cannot_be_are_refused(change, words):
    with pytest.raises(ct.InputError, match=words):
        structure(**change)


def test_a_gap_may_be_passed_by_round_off_of_its_own_size():
    structure(gap0=[0.0, 1e3], Q=np.eye(2), displacement=[-0.9e-9, 0.0])
    structure(displacement=[1e4, -1e4], gap0=[-1e4])
    with pytest.raises(ct.InputError, match=r"contact 1 penetrates by 1\.1e-09 m"):
        structure(gap0=[0.0, 1e3], Q=np.eye(2), displacement=[-1.1e-9, 0.0])
    with pytest.raises(ct.InputError, match="contact 2 penetrates by"):
        structure(gap0=[0.0, 0.0], Q=np.eye(2), displacement=[0.0, -1.1e-12])


@pytest.mark.parametrize("made", [np.array, csr_array], ids=["dense", "sparse"])
def test_asymmetry_counts_by_the_largest_entry_of_either_sign(made):
    structure(K=made([[1.0, -100.0], [-100.0 - 0.9e-7, 1.0]]))
    with pytest.raises(ct.InputError, match=r"K: found an asymmetry of 1\.1e-09 of the largest entry"):
        structure(K=made([[1.0, -100.0], [-100.0 - 1.1e-7, 1.0]]))


def net(size):
    """A chain of springs with as many springs across it at random: its band is wide, and stored by its entries."""
    rng = np.random.default_rng(4)
    chain = np.column_stack([np.arange(size - 1), np.arange(1, size)])
    one, two = np.vstack([chain, np.unique(np.sort(rng.integers(0, size, (size, 2)), axis=1), axis=0)]).T
    K = coo_array((np.full(len(one), -400.0), (one, two)), shape=(size, size))
    K = csr_array(K + K.T)
    return csr_array(K - diags_array(K.sum(axis=1) - 100.0))


@pytest.mark.slow
@pytest.mark.parametrize("scheme", [ct.CentralDifference(), ct.scheme.HHT(alpha=-0.1)], ids=["explicit", "implicit"])
def test_free_motion_of_a_net_of_springs_is_that_of_its_modes(scheme):
    """Both err in phase by less than (omega h)^2/12 of the angle, 1e-4 here."""
    K, rng = net(200), np.random.default_rng(9)
    size = K.shape[0]
    omega2, shapes = np.linalg.eigh(K.toarray())
    slow = shapes[:, :12] @ rng.standard_normal(12)  # of slow modes, which both schemes follow
    body = ct.LinearBody(
        M=np.ones(size), K=K, Q=csr_array(([1.0], ([0], [0])), shape=(1, size)), gap0=np.array([1e3]), velocity=slow,
    )  # fmt: skip
    found = ct.run(body, scheme=scheme, t_end=0.5, dt=1e-3, record=ct.Record(every=100, state_every=100))
    omega, t = np.sqrt(omega2), found.state_time[-1]
    exact = shapes @ ((shapes.T @ slow) * np.sin(omega * t) / omega)
    assert np.abs(found.state[-1] - exact).max() < 1e-3 * np.abs(exact).max()
