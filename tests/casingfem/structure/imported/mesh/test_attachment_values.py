"""Attachments as values: matrices, names, other numbers of nodes, other units."""

import numpy as np
import pytest

import casingfem as cf

J = np.array([[0.3, 0.02, 0.01], [0.02, 0.4, 0.05], [0.01, 0.05, 0.5]])
MASS = cf.imported.PointMass(node=4, mass=7.0, inertia=J, offset=(0.1, -0.2, 0.3))
SPRING = cf.imported.Spring(terms=(cf.imported.Term(2, 0, 1.0), cf.imported.Term(6, 0, -1.0)), stiffness=5.0)
EQUATION = cf.imported.Equation(terms=(cf.imported.Term(1, 0, 2.0), cf.imported.Term(3, 4, 0.5)))
RIGID = cf.imported.Rigid(reference=9, nodes=np.array([5, 8]))
MEAN = cf.imported.Mean(reference=0, nodes=np.array([3, 5, 8]), weights=np.array([1.0, 2.0, 4.0]))
TIE = cf.imported.Tie(
    nodes=np.array([7, 2]), others=np.array([[1, 3], [3, 5]]), weights=np.array([[0.25, 0.75], [1.0, 0.0]])
)
ALL = cf.imported.Attachments(
    masses=(MASS,), springs=(SPRING, SPRING), rigids=(RIGID,), means=(MEAN,), equations=(EQUATION,), glued=(TIE,)
)


@pytest.mark.parametrize(
    ("mass", "turns"),
    [
        (MASS, True),
        (cf.imported.PointMass(node=0, mass=1.0), False),
        (cf.imported.PointMass(node=0, mass=1.0, offset=(0.0, 0.0, 0.1)), True),
        (cf.imported.PointMass(node=0, mass=1.0, inertia=np.diag([0.0, 0.0, 1.0])), True),
    ],
)
def test_a_mass_turns_with_an_arm_or_an_inertia(mass, turns):
    assert mass.turns is turns


def test_names_and_nodes_of_all_that_hangs_on_a_mesh():
    assert repr(ALL) == "1 point mass, 2 springs, 1 rigid connection, 1 mean connection, 1 equation, 1 tie"
    assert repr(cf.imported.Attachments(masses=(MASS, MASS))) == "2 point masses"
    assert repr(cf.imported.Attachments()) == "nothing"
    assert ALL.nodes.tolist() == [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]
    assert cf.imported.Attachments(masses=(MASS,)).nodes.tolist() == [4]
    assert ALL.ties == (RIGID, MEAN, EQUATION, TIE)
    assert ALL.pairs == [(2, 6), (2, 6), (1, 3)]
    assert [nodes.tolist() for nodes in ALL.bodies] == [[5, 8, 9], [3, 5, 8, 0], [7, 2, 1, 3, 3, 5]]


def test_links_join_two_nodes_or_more():
    ground = cf.imported.Spring(terms=(cf.imported.Term(2, 0, 1.0), cf.imported.Term(2, 1, 1.0)), stiffness=1.0)
    held = cf.imported.Attachments(springs=(ground, SPRING), rigids=(RIGID,))
    assert [nodes.tolist() for nodes in held.links] == [[2, 6], [5, 8, 9]]


@pytest.mark.parametrize(("given", "any_", "weighed"), [
    ({}, False, False), ({"masses": (MASS,)}, True, True), ({"springs": (SPRING,)}, True, True),
    ({"rigids": (RIGID,)}, True, False), ({"means": (MEAN,)}, True, False), ({"equations": (EQUATION,)}, True, False),
    ({"glued": (TIE,)}, True, False),
])  # fmt: skip
def test_masses_and_springs_are_in_units_of_the_file(given, any_, weighed):
    assert (bool(cf.imported.Attachments(**given)), cf.imported.Attachments(**given).weighed) == (any_, weighed)


def test_nodes_take_other_numbers_and_may_become_one():
    """Node k becomes 20 - k, node 5 becomes node 8's number: their weights add up, the tie on node 3 goes."""
    number = np.array([20, 19, 17, 17, 16, 12, 14, 13, 12, 11])
    new = ALL.renumbered(lambda nodes: number[nodes])
    assert (new.masses[0].node, new.masses[0].mass) == (16, 7.0)
    assert new.springs[1].terms == (cf.imported.Term(17, 0, 1.0), cf.imported.Term(14, 0, -1.0))
    assert new.equations[0].terms == (cf.imported.Term(19, 0, 2.0), cf.imported.Term(17, 4, 0.5))
    assert (new.rigids[0].reference, new.rigids[0].nodes.tolist()) == (11, [12])
    mean, tie = new.means[0], new.glued[0]
    assert (mean.reference, mean.nodes.tolist(), mean.weights.tolist()) == (20, [12, 17], [6.0, 1.0])
    assert (tie.nodes.tolist(), tie.others.tolist(), tie.weights.tolist()) == ([13], [[19, 17]], [[0.25, 0.75]])


def test_a_tie_stays_on_a_node_of_weight_zero():
    tie = cf.imported.Tie(nodes=np.array([2]), others=np.array([[3, 2]]), weights=np.array([[1.0, 0.0]]))
    assert len(tie.renumbered(lambda nodes: nodes).nodes) == 1


def test_units_of_length_mass_and_time():
    """In units of 2 m, 3 kg and 5 s: the energies are those of the motions in SI."""
    length, mass, time = 2.0, 3.0, 5.0
    turning = cf.imported.Spring(terms=(cf.imported.Term(0, 3, 1.0), cf.imported.Term(1, 5, -1.0)), stiffness=7.0)
    arms = cf.imported.Spring(
        terms=(cf.imported.Term(0, 2, 1.0), cf.imported.Term(0, 3, 0.5), cf.imported.Term(1, 2, -1.0)), stiffness=11.0
    )
    found = cf.imported.Attachments(
        masses=(MASS,), springs=(SPRING, turning, arms), equations=(EQUATION,), rigids=(RIGID,)
    ).in_si(length, mass, time)
    assert found.rigids == (RIGID,)
    heavy = found.masses[0]
    assert heavy.mass == pytest.approx(21.0, rel=1e-14)
    np.testing.assert_allclose(heavy.inertia, 12.0 * J, rtol=1e-14)
    np.testing.assert_allclose(heavy.offset, [0.2, -0.4, 0.6], rtol=1e-14)
    stiffness = [spring.stiffness for spring in found.springs]
    np.testing.assert_allclose(stiffness, [5.0 * 3 / 25, 7.0 * 3 * 4 / 25, 11.0 * 3 / 25], rtol=1e-14)
    assert found.springs[0].terms == SPRING.terms
    assert found.springs[1].terms == turning.terms
    assert found.springs[2].terms == (
        cf.imported.Term(0, 2, 1.0),
        cf.imported.Term(0, 3, 1.0),
        cf.imported.Term(1, 2, -1.0),
    )
    assert found.equations[0].terms == (cf.imported.Term(1, 0, 1.0), cf.imported.Term(3, 4, 0.5))


def test_connections_take_all_components_if_none_are_named():
    assert RIGID.components == MEAN.components == (0, 1, 2, 3, 4, 5)
    assert [one.where for one in (cf.imported.PointMass(node=0, mass=1.0), SPRING, RIGID, MEAN, EQUATION, TIE)] == [
        "mass", "spring", "rigid connection", "mean connection", "equation", "tie",
    ]  # fmt: skip
    assert SPRING.nodes == (2, 6)
    assert EQUATION.nodes == (1, 3)
