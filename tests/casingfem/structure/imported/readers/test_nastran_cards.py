"""Attachments of Nastran's cards, every field with a value of its own: what is which, and what is refused."""

import re

import numpy as np
import pytest

import casingfem as cf

FILE = """GRID,11,,1.,2.,3.
GRID,12,,2.,0.,0.
GRID,13,,0.,1.,0.
GRID,14,,0.,0.,1.,4
GRID,15,,4.,5.,6.
GRID,16,,.5,.25,2.
CORD2R,4,,0.,0.,0.,.6,0.,.8,+
+,.8,0.,-.6
CTETRA,1,1,11,12,13,14
{cards}
ENDDATA
"""
AXES = np.array([[0.8, 0.0, -0.6], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8]])  # of system 4


def attached(folder, cards):
    (folder / "a.bdf").write_text(FILE.format(cards=cards))
    return cf.read_mesh(folder / "a.bdf").attachments


def test_a_mass_has_its_inertia_in_the_order_of_the_guide(tmp_path):
    """I11, I21, I22, I31, I32, I33, products with a minus; offsets are lengths, which no factor changes."""
    cards = "CONM2,30,15,,8.,.1,.2,.3,,+\n+,9.,.5,11.,.25,.75,13."
    (mass,) = attached(tmp_path, cards).masses
    assert (mass.node, mass.mass, mass.offset, mass.where) == (4, 8.0, (0.1, 0.2, 0.3), "CONM2 30 (line 10)")
    wanted = np.array([[9.0, -0.5, -0.25], [-0.5, 11.0, -0.75], [-0.25, -0.75, 13.0]])
    np.testing.assert_array_equal(mass.inertia, wanted)
    (mass,) = attached(tmp_path, f"PARAM,POST,7.\nparam,wtmass,.25\n{cards}").masses
    assert (mass.mass, mass.offset) == (2.0, (0.1, 0.2, 0.3))
    np.testing.assert_array_equal(mass.inertia, 0.25 * wanted)


def test_a_mass_in_a_system_has_its_offset_and_inertia_turned(tmp_path):
    cards = "CONM2,30,15,4,8.,.1,.2,.3,,+\n+,9.,.5,11.,.25,.75,13.\nCONM2,31,15,0,8.,.1,.2,.3\n"
    cards += "CONM2,32,15,-1,8.,4.5,5.25,6."
    turned, plain, direct = attached(tmp_path, cards).masses
    own = np.array([[9.0, -0.5, -0.25], [-0.5, 11.0, -0.75], [-0.25, -0.75, 13.0]])
    np.testing.assert_allclose(turned.inertia, AXES.T @ own @ AXES, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(turned.offset, 0.1 * AXES[0] + 0.2 * AXES[1] + 0.3 * AXES[2], rtol=1e-13)
    assert plain.offset == (0.1, 0.2, 0.3)
    assert direct.offset == (0.5, 0.25, 0.0)


def test_a_mass_without_offset_and_inertia_needs_no_system(tmp_path):
    """System 9 is not there; what has no direction asks for none."""
    assert attached(tmp_path, "CONM2,30,15,9,8.").masses[0].mass == 8.0
    for more in ("CONM2,30,15,9,8.,,,.1", "CONM2,30,15,9,8.,,,,,+\n+,,,,,,1."):
        with pytest.raises(cf.errors.ModelError, match="coordinate system 9: found no system 9"):
            attached(tmp_path, more)


@pytest.mark.parametrize(("least", "told"), [(-2e-9, True), (-0.5e-9, False)])
def test_inertia_below_zero_is_refused_beyond_round_off(least, told, tmp_path):
    card = f"CONM2,30,15,,8.,,,,,+\n+,1.,,1.,,,{least!r}"
    if told:
        with pytest.raises(cf.errors.ModelError, match="line 10: CONM2: found moments of inertia with"):
            attached(tmp_path, card)
        return
    assert attached(tmp_path, card).masses[0].inertia[2, 2] == least


@pytest.mark.parametrize(
    ("cards", "stiffness", "terms"),
    [
        ("CELAS2,30,7.,15,3", 7.0, (cf.imported.Term(4, 2, 1.0),)),
        ("CELAS2,30,7.,15,3,16,2", 7.0, (cf.imported.Term(4, 2, 1.0), cf.imported.Term(5, 1, -1.0))),
        ("CELAS2,30,7.,,,16,2", 7.0, (cf.imported.Term(5, 1, 1.0),)),
        ("CELAS2,30,7.,0,,16,2", 7.0, (cf.imported.Term(5, 1, 1.0),)),
        ("CELAS2,30,7.,15,4,16,6", 7.0, (cf.imported.Term(4, 3, 1.0), cf.imported.Term(5, 5, -1.0))),
        ("PELAS,8,9.,,,5,6.\nCELAS1,30,5,15,1", 6.0, (cf.imported.Term(4, 0, 1.0),)),
        ("PELAS,8,9.,,,5,6.\nCELAS1,30,8,15,1", 9.0, (cf.imported.Term(4, 0, 1.0),)),
        ("PELAS,30,9.\nCELAS1,30,,15,1", 9.0, (cf.imported.Term(4, 0, 1.0),)),
        ("CELAS2,30,7.,14,2", 7.0, (cf.imported.Term(3, 1, 1.0),)),
        ("CELAS2,30,7.,14,1", 7.0, (cf.imported.Term(3, 0, 0.8), cf.imported.Term(3, 2, -0.6))),
        ("CELAS2,30,7.,14,3", 7.0, (cf.imported.Term(3, 2, 0.8), cf.imported.Term(3, 0, 0.6))),  # the largest first
        (
            "CELAS2,30,7.,15,1,14,3",
            7.0,
            (cf.imported.Term(4, 0, 1.0), cf.imported.Term(3, 2, -0.8), cf.imported.Term(3, 0, -0.6)),
        ),
        ("CELAS2,30,7.,14,6", 7.0, (cf.imported.Term(3, 5, 0.8), cf.imported.Term(3, 3, 0.6))),
        ("CELAS2,30,7.,14,4", 7.0, (cf.imported.Term(3, 3, 0.8), cf.imported.Term(3, 5, -0.6))),
    ],
)
def test_springs_of_cards(cards, stiffness, terms, tmp_path):
    (spring,) = attached(tmp_path, cards).springs
    assert spring.stiffness == stiffness
    assert [term[:2] for term in spring.terms] == [term[:2] for term in terms]
    np.testing.assert_allclose([term[2] for term in spring.terms], [term[2] for term in terms], rtol=1e-13)
    assert spring.where == f"{cards.splitlines()[-1][:6]} 30 (line {9 + len(cards.splitlines())})"


@pytest.mark.parametrize(("slant", "components"), [(0.5e-12, [0]), (1.5e-12, [0, 1])])
def test_components_of_axes_that_are_round_off_are_none(slant, components, tmp_path):
    system = f"CORD2R,6,,0.,0.,0.,0.,0.,1.,+\n+,1.,{slant!r},0.\nGRID,17,,0.,0.,0.,6\nCELAS2,30,7.,17,1"
    assert [term.component for term in attached(tmp_path, system).springs[0].terms] == components


@pytest.mark.parametrize(
    "card", ["CELAS2,30,7.,15,0", "CELAS2,30,7.,15", "CELAS2,30,7.,15,1,16", "CELAS1,30,5,16,,15,1"]
)
def test_springs_at_scalar_points_are_left_out(card, tmp_path):
    with pytest.warns(
        cf.errors.ModelWarning, match=rf"a.bdf: 1 {card[:6]} at scalar points \(from line 10\); .*mesh-left-out"
    ):
        assert attached(tmp_path, card).springs == ()


@pytest.mark.parametrize(
    ("card", "reference", "nodes", "components"),
    [
        ("RBE2,30,15,613,16,11", 4, [0, 5], (0, 2, 5)),
        ("RBE2,30,15,123456,16,11,1.5-5", 4, [0, 5], (0, 1, 2, 3, 4, 5)),
        ("RBE2,30,15,123,16,,11", 4, [0, 5], (0, 1, 2)),
        ("RBE2,30,15,123,14", 4, [3], (0, 1, 2)),
        ("RBAR,30,15,16,123456", 4, [5], (0, 1, 2, 3, 4, 5)),
        ("RBAR,30,15,16,123456,,,246", 4, [5], (1, 3, 5)),
        ("RBAR,30,15,16,,123456,135", 5, [4], (0, 2, 4)),
        ("RBAR,30,15,16,,123456", 5, [4], (0, 1, 2, 3, 4, 5)),
        ("RBAR,30,15,16,,123456,135,246", 5, [4], (0, 2, 4)),
    ],
)
def test_rigid_cards(card, reference, nodes, components, tmp_path):
    (rigid,) = attached(tmp_path, card).rigids
    assert (rigid.reference, rigid.nodes.tolist(), rigid.components) == (reference, nodes, components)
    assert rigid.where == f"{card[:4]} 30 (line 10)"


@pytest.mark.parametrize(
    ("card", "reference", "components", "weighted"),
    [
        ("RBE3,30,,15,123456,2.,123,16,11", 4, (0, 1, 2, 3, 4, 5), {5: 2.0, 0: 2.0}),
        ("RBE3,30,,15,135,2.,123,16,3.,+\n+,123,11,12,5.,123,13", 4, (0, 2, 4), {5: 2.0, 0: 3.0, 1: 3.0, 2: 5.0}),
        ("RBE3,30,,15,123,2.,123,16,,+\n+,11,ALPHA,9.", 4, (0, 1, 2), {5: 2.0, 0: 2.0}),
        ("RBE3,30,,14,123,2.,123,16", 3, (0, 1, 2), {5: 2.0}),
    ],
)
def test_mean_cards(card, reference, components, weighted, tmp_path):
    (mean,) = attached(tmp_path, card).means
    assert (mean.reference, mean.components) == (reference, components)
    assert dict(zip(mean.nodes.tolist(), mean.weights.tolist(), strict=True)) == weighted
    assert mean.where == "RBE3 30 (line 10)"


def test_equations_have_two_terms_on_each_line(tmp_path):
    cards = "MPC,5,11,1,2.,12,2,-3.,,+\n+,,13,3,4.,15,6,.5\nMPC,5,16,1,1.,14,3,2."
    found = attached(tmp_path, cards).equations
    assert found[0].terms == (
        cf.imported.Term(0, 0, 2.0),
        cf.imported.Term(1, 1, -3.0),
        cf.imported.Term(2, 2, 4.0),
        cf.imported.Term(4, 5, 0.5),
    )
    assert [term[:2] for term in found[1].terms] == [(5, 0), (3, 2), (3, 0)]
    np.testing.assert_allclose([term[2] for term in found[1].terms], [1.0, 1.6, 1.2], rtol=1e-13)
    assert [equation.where for equation in found] == ["MPC 5 (line 10)", "MPC 5 (line 12)"]


@pytest.mark.parametrize(
    ("card", "told"),
    [
        ("RBE2,30,15,12,14", "found single components of grid 14, which has its own displacement system (CD)"),
        ("RBE3,30,,14,12,2.,123,16", "found single components of grid 14, which has its own displacement system"),
        ("RBAR,30,15,14,123456,,,12", "found single components of grid 14"),
        ("RBE2,30,15,11,16", "found the components '11', expected some of 123456"),
        ("RBE2,30,15,,16", "found the components '', expected some of 123456"),
        ("RBE2,30,15,0,16", "found the components '0', expected some of 123456"),
        ("RBE2,30,15,123,1.5,16", "found 1.5, expected the numbers of all grids"),
        ("RBAR,30,15,16,123456,123456", "found independent components at both ends, expected 123456 at one"),
        ("RBAR,30,15,16", "found independent components at both ends, expected 123456 at one"),
        ("RBE3,30,,15,123,16,11", "found 16, expected a weight such as 1.0"),
        ("RBE3,30,,15,123,1.,12,16", "found the components 12, expected 123"),
        ("RBE3,30,,15,123,-1.,123,16", "found the stiffness -1, expected one above 0"),
        ("RBE3,30,,15,123,1.,123,UM,16", "found UM, expected weights, components and grids"),
        ("RBE3,30,,15,123,1.,123,ALPHA,9.", "found no grid with a weight"),
        ("MPC,5,11,1,2.", "found 1 terms, expected two or more"),
        ("MPC,5,11,12,2.,12,2,-3.", "found the components 12, expected one"),
        ("CELAS2,30,7.,15,3,16,4", "found a spring between a displacement and a rotation"),
        ("CELAS2,30,7.,15,4,16,3", "found a spring between a displacement and a rotation"),
        ("CELAS1,30,,15,3", "found the property 30 without a PELAS card"),
        ("CELAS2,30,0.,15,3", "found the stiffness 0, expected one above 0"),
        ("CONM2,30,15,,-1.-9", "found the mass -1e-09, expected 0 or more"),
    ],
)
def test_cards_that_are_not_understood_are_refused(card, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.bdf: line 10: {card.partition(',')[0]}: {re.escape(told)}"):
        attached(tmp_path, card)


def test_a_second_set_of_equations_is_refused(tmp_path):
    with pytest.raises(cf.errors.ModelError, match="line 11: MPC: found MPC cards of a second set, expected one"):
        attached(tmp_path, "MPC,5,11,1,2.,12,1,1.\nMPC,6,11,2,2.,12,2,1.")
