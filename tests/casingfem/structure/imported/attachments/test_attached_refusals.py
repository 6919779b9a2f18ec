"""What cannot be attached is refused or doubted: springs that hold nothing, held followers, loose turns."""

import warnings

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.structure.imported.attachments.system import refuse_held, refuse_loose, warn_floating
from casingfem.structure.imported.attachments.ties import Rows, motions_of, tied_rows
from tests.casingfem.structure.imported.parts import link

X = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 3, 5], [7, 1, 1], [4, 4, 4.0]])
NONE = np.zeros(0, dtype=np.int64)
GROUND = cf.imported.Spring(terms=(cf.imported.Term(4, 0, 1.0),), stiffness=1.0)


def hung(**items):
    """A tetrahedron of nodes 11 to 14 with 15, 16 and 17 beside it."""
    return cf.imported.MeshData(kind="tetra", points=X, cells=np.array([[0, 1, 2, 3]]), node_numbers=np.arange(11, 18),
                    source="part.bdf", attachments=cf.imported.Attachments(**items))  # fmt: skip


@pytest.mark.parametrize(
    ("items", "held", "told"),
    [
        ({"springs": (link(4, 1),)}, [], "1 node (15)"),
        ({"springs": (link(4, 1), link(1, 4))}, [], "1 node (15)"),
        ({"springs": (link(4, 1), link(5, 6))}, [], "3 nodes (15, 16, 17)"),
        ({"springs": (link(4, 1), link(4, 5))}, [], "1 node (16)"),
        ({"springs": (link(4, 1), GROUND)}, [], None),
        ({"springs": (GROUND,)}, [], None),
        ({"springs": (link(4, 1),)}, [4], None),
        ({"springs": (link(4, 1),), "masses": (cf.imported.PointMass(node=4, mass=1.0),)}, [], None),
        ({"springs": (link(4, 1),), "rigids": (cf.imported.Rigid(reference=5, nodes=np.array([4])),)}, [], None),
        (
            {
                "springs": (link(4, 1),),
                "equations": (cf.imported.Equation(terms=(cf.imported.Term(4, 1, 1.0), cf.imported.Term(0, 1, 1.0))),),
            },
            [],
            None,
        ),
        ({"springs": (link(1, 2),)}, [], None),
    ],
)
def test_nodes_that_hang_on_one_other_node_alone_float(items, held, told):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        warn_floating(hung(**items), np.array(held, dtype=np.int64))
    assert [w.message.code for w in caught] == ["mesh-floating-spring"] * (told is not None)
    if told is not None:
        assert f"part.bdf: found {told} at the end of springs" in str(caught[0].message)
        assert isinstance(caught[0].message, cf.errors.ModelWarning)


def test_what_follows_cannot_be_held_but_for_the_turns_of_its_own_node():
    at = motions_of(hung(rigids=(cf.imported.Rigid(reference=4, nodes=np.array([1, 5]), where="RBE2 3"),)), 3)
    rows = tied_rows(at, NONE)
    refuse_held(at, rows, np.array([0, 12, 13]))
    with pytest.raises(
        cf.errors.ModelError, match=r"RBE2 3: node 16: found a support on it, expected one on the node that"
    ):
        refuse_held(at, rows, np.array([0, 16]))
    own = Rows(at)
    own.add(16, 5, {0: 1.0}, "RBE2 3")
    own.own.add(16)
    refuse_held(at, own, np.array([16]))


@pytest.mark.parametrize(("stiff", "heavy", "loose"), [
    ([1, 1, 1, 1, 1, 1], [0, 0, 0, 0, 0, 0], False), ([1, 1, 1, 0, 0, 0], [0, 0, 0, 1, 1, 1], False),
    ([1e9, 1e9, 1e9, 1, 1, 1e-6], [0, 0, 0, 0, 0, 0], False), ([1, 1, 1, 1, 1, 0], [1, 1, 1, 1, 1, 0], True),
    ([0, 1, 1, 1, 1, 1], [0, 1, 1, 1, 1, 1], True),
])  # fmt: skip
def test_each_of_the_six_motions_of_a_node_has_stiffness_or_mass(stiff, heavy, loose):
    """Mixed by a turn of the six, so that no entry is zero; of a node that is held or follows nothing is asked."""
    at = motions_of(
        hung(means=(cf.imported.Mean(reference=4, nodes=np.arange(4), weights=np.ones(4), components=(0, 1, 2)),)), 3
    )
    mixed = np.linalg.qr(np.random.default_rng(1).standard_normal((6, 6)))[0] if loose else np.eye(6)
    unknowns = np.array([0, 12, 13, 14, at.turn(4), at.turn(4) + 1, at.turn(4) + 2])
    K, M = np.zeros((2, 7, 7))
    K[1:, 1:], M[1:, 1:] = (mixed @ np.diag(np.array(part, dtype=float)) @ mixed.T for part in (stiff, heavy))
    if loose:
        told = r"connections: node 15: found a motion with neither stiffness nor mass"
        with pytest.raises(cf.errors.ModelError, match=told):
            refuse_loose(at, csc_array(K), csc_array(M), unknowns)
    else:
        refuse_loose(at, csc_array(K), csc_array(M), unknowns)
    refuse_loose(at, csc_array((1, 1)), csc_array((1, 1)), np.array([0]))


def test_each_node_with_turns_is_looked_at_alone():
    """A spring between the turns of two nodes leaves them free together, which no one of them tells."""
    means = tuple(
        cf.imported.Mean(reference=k, nodes=np.arange(4), weights=np.ones(4), components=(0, 1, 2)) for k in (4, 5)
    )
    at = motions_of(hung(means=means), 3)
    unknowns = np.arange(at.turn(4), at.turn(4) + 6)
    K = np.eye(6)
    K[2, 3] = K[3, 2] = -1.0
    assert at.turn(5) == at.turn(4) + 3
    refuse_loose(at, csc_array(K), csc_array((6, 6)), unknowns)
    K[3, 4] = K[4, 3] = -1.0
    with pytest.raises(
        cf.errors.ModelError, match="connections: node 16: found a motion with neither stiffness nor mass"
    ):
        refuse_loose(at, csc_array(K), csc_array((6, 6)), unknowns)
