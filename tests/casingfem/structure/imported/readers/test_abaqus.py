"""Masses, springs and connections of Abaqus input files: what each cell of a line is, and what is refused."""

import re

import numpy as np
import pytest

import casingfem as cf

PART = """*NODE
11, 0., 0., 0.
12, 1., 0., 0.
13, 0., 1., 0.
14, 0., 0., 1.
15, 3., 4., 13.
16, 3., 4., 1.
*ELEMENT, TYPE=C3D4, ELSET=E
1, 11, 12, 13, 14
*NSET, NSET=Two
13, 14
"""  # line 12 is the next
FACE = "*SURFACE, NAME=F\n1, S1\n"
NODES = "*SURFACE, NAME=N, TYPE=NODE\n14\nTwo\n"


def attached(folder, text):
    (folder / "a.inp").write_text(PART + text)
    return cf.read_mesh(folder / "a.inp").attachments


def points(kind, *elements, name="p"):
    """Elements of a kind, and the beginning of the card of their property."""
    return f"*ELEMENT, TYPE={kind}, ELSET={name}\n" + "".join(f"{element}\n" for element in elements)


@pytest.mark.parametrize(
    ("text", "terms", "stiffness", "where"),
    [
        (points("SPRING1", "9, 15") + "*SPRING, ELSET=p\n3\n7.,\n", [(4, 2, 1.0)], 7.0, "SPRING1 9 (line 14)"),
        (points("SPRING1", "9, 15") + "*SPRING, ELSET=p\n6,\n1.d1\n", [(4, 5, 1.0)], 10.0, "SPRING1 9 (line 14)"),
        (
            points("SPRING2", "9, 15, 12") + "*SPRING, ELSET=p\n3, 1\n7.\n",
            [(4, 2, 1.0), (1, 0, -1.0)], 7.0, "SPRING2 9 (line 14)",
        ),
        (
            points("SPRING2", "9, 15, 12") + "*SPRING, ELSET=p\n4, 6, 1\n7.\n",
            [(4, 3, 1.0), (1, 5, -1.0)], 7.0, "SPRING2 9 (line 14)",
        ),
        (  # along (3, 4, 12)/13, from the first to the second
            points("SPRINGA", "9, 14, 15") + "*SPRING, ELSET=p\n\n26.\n",
            [(3, c, k) for c, k in enumerate((3 / 13, 4 / 13, 12 / 13))]
            + [(4, c, -k) for c, k in enumerate((3 / 13, 4 / 13, 12 / 13))],
            26.0, "SPRINGA 9 (line 14)",
        ),
        (
            points("SPRINGA", "9, 12, 11") + "*SPRING, ELSET=p\n2.\n",
            [(1, 0, -1.0), (0, 0, 1.0)], 2.0, "SPRINGA 9 (line 14)",
        ),
        (
            points("SPRINGA", "9, 15, 16") + "*SPRING, ELSET=p\n2.\n",
            [(4, 2, -1.0), (5, 2, 1.0)], 2.0, "SPRINGA 9 (line 14)",
        ),
    ],
)  # fmt: skip
def test_springs_of_an_input_file(text, terms, stiffness, where, tmp_path):
    (spring,) = attached(tmp_path, text).springs
    assert [term[:2] for term in spring.terms] == [term[:2] for term in terms]
    np.testing.assert_allclose([term[2] for term in spring.terms], [term[2] for term in terms], rtol=1e-14)
    assert (spring.stiffness, spring.where) == (stiffness, where)


def test_one_card_gives_all_elements_of_its_set_what_they_have(tmp_path):
    text = points("SPRING1", "9, 15", "8, 12") + "*SPRING, ELSET=p\n1\n7.\n" + points("MASS", "20, 11", name="m")
    text += "*MASS, ELSET=m\n.5\n" + points("ROTARYI", "21, 11", name="r")
    found = attached(tmp_path, f"{text}*ROTARY INERTIA, ELSET=r\n1., 2., 3., 0., 0., 0.\n")
    assert [spring.terms[0] for spring in found.springs] == [cf.imported.Term(4, 0, 1.0), cf.imported.Term(1, 0, 1.0)]
    mass, turning = found.masses
    assert (mass.node, mass.mass, mass.inertia.any(), mass.where) == (0, 0.5, False, "MASS 20 (line 20)")
    assert (turning.node, turning.mass, turning.where) == (0, 0.0, "ROTARYI 21 (line 24)")
    np.testing.assert_array_equal(turning.inertia, np.diag([1.0, 2.0, 3.0]))


@pytest.mark.parametrize(
    ("text", "reference", "nodes", "components", "where"),
    [
        (
            f"{FACE}*COUPLING, REF NODE=15, SURFACE=f\n*KINEMATIC\n2, 3\n5\n",
            4,
            [0, 1, 2],
            (1, 2, 4),
            "*COUPLING (line 14)",
        ),
        (f"{NODES}*COUPLING, REF NODE=14, SURFACE=n\n*KINEMATIC\n", 3, [2], (0, 1, 2, 3, 4, 5), "*COUPLING (line 15)"),
        ("*KINEMATIC COUPLING, REF NODE=15\ntwo\n", 4, [2, 3], (0, 1, 2, 3, 4, 5), "*KINEMATIC COUPLING (line 12)"),
        ("*KINEMATIC COUPLING, REF NODE=15\n12, 2, 4\n", 4, [1], (1, 2, 3), "*KINEMATIC COUPLING (line 12)"),
        ("*KINEMATIC COUPLING, REF NODE=14\ntwo, 5\n", 3, [2], (4,), "*KINEMATIC COUPLING (line 12)"),
        ("*RIGID BODY, REF NODE=15, NSET=two\n", 4, [2, 3], (0, 1, 2, 3, 4, 5), "*RIGID BODY (line 12)"),
        ("*RIGID BODY, REF NODE=15, TIE NSET=two\n", 4, [2, 3], (0, 1, 2, 3, 4, 5), "*RIGID BODY (line 12)"),
        ("*MPC\nbeam, 12, 15\n", 4, [1], (0, 1, 2, 3, 4, 5), "*MPC BEAM (line 13)"),
    ],
)
def test_rigid_connections_of_an_input_file(text, reference, nodes, components, where, tmp_path):
    (rigid,) = attached(tmp_path, text).rigids
    assert (rigid.reference, rigid.nodes.tolist(), rigid.components) == (reference, nodes, components)
    assert rigid.where == where


def test_pins_join_displacements_alone_and_sets_follow_node_by_node_or_one_node(tmp_path):
    text = "*NSET, NSET=other\n12, 15\n*MPC\nPIN, two, other\nBEAM, two, 16\n"
    found = attached(tmp_path, text)
    # other is in the order of the file
    wanted = [(cf.imported.Term(2, c, 1.0), cf.imported.Term(1, c, -1.0)) for c in range(3)]
    wanted += [(cf.imported.Term(3, c, 1.0), cf.imported.Term(4, c, -1.0)) for c in range(3)]
    assert [equation.terms for equation in found.equations] == wanted
    assert {equation.where for equation in found.equations} == {"*MPC PIN (line 15)"}
    assert [(rigid.reference, rigid.nodes.tolist()) for rigid in found.rigids] == [(5, [2]), (5, [3])]


def test_equations_go_over_lines_and_several_are_in_one_card(tmp_path):
    text = "*EQUATION\n2\n12, 1, 2.,\n13, 6, -3.\n3.\n14, 2, 1., 15, 3, 4.\n16, 4, .5d1\n"
    found = attached(tmp_path, text).equations
    assert [equation.terms for equation in found] == [
        (cf.imported.Term(1, 0, 2.0), cf.imported.Term(2, 5, -3.0)),
        (cf.imported.Term(3, 1, 1.0), cf.imported.Term(4, 2, 4.0), cf.imported.Term(5, 3, 5.0)),
    ]
    assert [equation.where for equation in found] == ["*EQUATION (line 13)", "*EQUATION (line 16)"]


def test_means_have_the_weights_of_their_lines(tmp_path):
    text = points("DCOUP3D", "9, 15") + "*DISTRIBUTING COUPLING, ELSET=p\ntwo, 2.5\n12\n"
    (mean,) = attached(tmp_path, text).means
    assert dict(zip(mean.nodes.tolist(), mean.weights.tolist(), strict=True)) == {2: 2.5, 3: 2.5, 1: 1.0}
    assert (mean.reference, mean.where) == (4, "DCOUP3D 9 (line 14)")
    (mean,) = attached(
        tmp_path, f"{NODES}*COUPLING, REF NODE=15, SURFACE=n\n*DISTRIBUTING, WEIGHTING METHOD=uniform\n"
    ).means
    assert (mean.nodes.tolist(), mean.weights.tolist()) == ([2, 3], [1.0, 1.0])
    assert (mean.reference, mean.where) == (4, "*COUPLING (line 15)")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (f"{FACE}*KINEMATIC\n", r"line 14: found \*KINEMATIC without \*COUPLING, expected \*COUPLING before it"),
        (
            f"{FACE}*COUPLING, REF NODE=15, SURFACE=F\n*KINEMATIC\n*KINEMATIC\n",
            r"line 16: found \*KINEMATIC without \*COUPLING, expected \*COUPLING before it",
        ),
        (
            f"{NODES}*COUPLING, REF NODE=15, SURFACE=N\n*DISTRIBUTING\n*DISTRIBUTING\n",
            r"line 17: found \*DISTRIBUTING without \*COUPLING, expected \*COUPLING before it",
        ),
        ("*COUPLING, REF NODE=15, SURFACE=F\n*KINEMATIC\n", "line 12: found no surface 'F'"),
        (f"{FACE}*COUPLING, REF NODE=two, SURFACE=F\n*KINEMATIC\n", r"line 14: \*COUPLING: found 2 nodes as REF NODE"),
        ("*KINEMATIC COUPLING\n12\n", "line 12: found no set '' above this line"),
        ("*RIGID BODY, REF NODE=15\n", "line 12: found no set '' above this line"),
        ("*RIGID BODY, REF NODE=15, ELSET=E\n", r"line 12: \*RIGID BODY: found ELSET, which this program"),
        ("*RIGID BODY, REF NODE=15, PIN NSET=two\n", r"line 12: \*RIGID BODY: found PIN NSET, which"),
        ("*KINEMATIC COUPLING, REF NODE=15, ORIENTATION=o\n12\n", "line 12: .*found ORIENTATION, which"),
        ("*KINEMATIC COUPLING, REF NODE=15\n12, 0\n", "line 13: found '0', expected a degree of freedom 1 to 6"),
        ("*MPC\nBEAM, 12\n", r"line 13: \*MPC: found BEAM, 12, expected a kind \(BEAM, PIN\) and two nodes"),
        ("*MPC\nTIE, 12, 15\n", r"line 13: \*MPC: found TIE, 12, 15, expected a kind \(BEAM, PIN\) and two nodes"),
        ("*MPC\nPIN, 12, 15, 16\n", r"line 13: \*MPC: found PIN, 12, 15, 16, expected a kind"),
        ("*EQUATION\n1\n12, 1, 2.\n", r"line 13: \*EQUATION: found 3 cells, expected 3 for each of 1 terms"),
        ("*EQUATION\n2\n12, 1, 2., 13, 1\n", r"line 13: \*EQUATION: found 5 cells, expected 3 for each of 2 terms"),
        ("*EQUATION\n2\n12, 1, 2., 13, 1, 1., 4\n", r"line 13: \*EQUATION: found 7 cells, expected 3 for each of 2"),
        ("*EQUATION\n2\n12, 1, 2., two, 1, 1.\n", r"line 13: \*EQUATION: found 2 nodes in 'two', expected one"),
        ("*EQUATION\n2\n12, 7, 2., 13, 1, 1.\n", "line 13: found '7', expected a degree of freedom 1 to 6"),
        (points("DCOUP3D", "9, 15") + "*DISTRIBUTING COUPLING, ELSET=p\n12, 0.\n",
         r"line 15: \*DISTRIBUTING COUPLING: found the weight 0, expected one above 0"),
        (points("DCOUP3D", "9, 15") + "*DISTRIBUTING COUPLING, ELSET=p\n", "line 14: .*found no nodes"),
        (points("MASS", "9, 15") + "*MASS, ELSET=p, TYPE=ANISOTROPIC\n1.\n", r"line 15: \*MASS: found 1., expected"),
        (points("MASS", "9, 15") + "*MASS, ELSET=p\n", r"line 14: \*MASS: found , expected numbers of 0 or more"),
        (points("ROTARYI", "9, 15") + "*ROTARY INERTIA, ELSET=p\n1., 2., -3.\n", "line 15: .*numbers of 0 or more"),
        (points("ROTARYI", "9, 15") + "*ROTARY INERTIA, ELSET=p\n1., 2.\n", "line 15: .*I11, I22, I33 alone"),
        (points("ROTARYI", "9, 15") + "*ROTARY INERTIA, ELSET=p\n1., 2., 3., 0., .1\n", "line 15: .*I33 alone"),
        (points("MASS", "9, 15", "8, 12"), r"line 12: found element 8 of type MASS without a property"),
        (points("SPRINGA", "9, 15, 16"), r"line 12: found element 9 of type SPRINGA without a prop"),
        (points("DCOUP3D", "9, 15"), r"line 12: found element 9 of type DCOUP3D.*\*DISTRIBUTING COUPLING"),
        (points("MASS", "9, 15") + "*ROTARY INERTIA, ELSET=p\n1., 2., 3.\n",
         r"line 14: \*ROTARY INERTIA: found element 9 of another type, expected ROTARYI"),
        (points("MASS", "9, 15") + "*SPRING, ELSET=p\n1\n3.\n",
         r"line 14: \*SPRING: found element 9 of another type, expected SPRING1 or SPRING2 or SPRINGA"),
        (points("MASS", "9, 15") + "*MASS, ELSET=q\n1.\n", "line 14: found no set 'q' above"),
        (points("SPRING1", "9, 15") + "*SPRING, ELSET=p\n3\n-7.\n", r"line 16: \*SPRING: found the stiffness -7"),
        (points("SPRING1", "9, 15") + "*SPRING, ELSET=p\n3\n7.\n8.\n",
         r"line 14: \*SPRING: found 3 data lines, expected 2 \(degrees of freedom, then the stiffness\)"),
        (points("SPRINGA", "9, 15, 16") + "*SPRING, ELSET=p\n3\n7.\n",
         r"line 14: \*SPRING: found 2 data lines, expected 1 \(the stiffness\)"),
        (points("SPRING2", "9, 15, 16") + "*SPRING, ELSET=p\n3\n7.\n", r"line 15: \*SPRING: found the degrees"),
        (points("SPRING2", "9, 15, 16") + "*SPRING, ELSET=p\n3, 4\n7.\n", r"line 15: \*SPRING: found the degrees"),
        (points("SPRINGA", "9, 15, 15") + "*SPRING, ELSET=p\n7.\n",
         "line 14: SPRINGA 9: found two nodes at one place, expected a distance between them"),
        (points("SPRING1", "9, 15") + "*SPRING, ELSET=p\n3\n1e999\n", "line 16: found '1e999', expected a number"),
        (points("SPRING1", "9, 15, 16"), "line 13: found '9, 15, 16', expected an element number and 1 nodes"),
        (points("SPRING2", "9, 15"), "line 13: found '9, 15', expected an element number and 2 nodes"),
    ],
)  # fmt: skip
def test_words_that_are_not_understood_are_refused(text, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"a\.inp: {told}"):
        attached(tmp_path, text)


@pytest.mark.parametrize("method", ["LINEAR", "CUBIC"])
def test_other_weights_of_a_distributing_coupling_are_refused(method, tmp_path):
    text = f"{NODES}*COUPLING, REF NODE=15, SURFACE=N\n*DISTRIBUTING, WEIGHTING METHOD={method}\n"
    told = "*DISTRIBUTING: found a weighting method or degrees of freedom, expected neither"
    with pytest.raises(cf.errors.ModelError, match=f"line 16: {re.escape(told)}"):
        attached(tmp_path, text)


def test_a_distributing_coupling_on_faces_is_left_out(tmp_path):
    with pytest.warns(
        cf.errors.ModelWarning, match=r"a\.inp: \*DISTRIBUTING on a surface of elements \(line 15\); .*mesh-left-out"
    ):
        assert not attached(tmp_path, f"{FACE}*COUPLING, REF NODE=15, SURFACE=F\n*DISTRIBUTING\n").means


@pytest.mark.parametrize(
    "card", ["*EQUATION\n2\n12, 1, 2., 13, 1, 1.\n", points("SPRING1", "9, 15") + "*SPRING, ELSET=p\n3\n7.\n"]
)
def test_single_directions_beside_turned_nodes_are_refused(card, tmp_path):
    with pytest.raises(
        cf.errors.ModelError,
        match=r"line 12: found \*TRANSFORM and springs or equations, expected their directions along the global",
    ):
        attached(tmp_path, f"*TRANSFORM, NSET=two\n1., 0., 0., 0., 1., 0.\n{card}")


def test_whole_motions_beside_turned_nodes_are_taken(tmp_path):
    text = f"{points('MASS', '9, 15')}*MASS, ELSET=p\n1.\n*RIGID BODY, REF NODE=15, NSET=two\n"
    with pytest.warns(cf.errors.ModelWarning, match=r"\*TRANSFORM \(line 12\)"):
        assert len(attached(tmp_path, f"*TRANSFORM, NSET=two\n1., 0., 0., 0., 1., 0.\n{text}").rigids) == 1


def test_all_nodes_of_the_faces_of_quadratic_cells_are_coupled(tmp_path):
    """With the middles of their edges: those of two faces of a tetrahedron with ten nodes."""
    places = [
        (0, 0, 0),
        (2, 0, 0),
        (0, 2, 0),
        (0, 0, 2),
        (1, 0, 0),
        (1, 1, 0),
        (0, 1, 0),
        (0, 0, 1),
        (1, 0, 1),
        (0, 1, 1),
    ]
    grid = "*NODE\n" + "".join(f"{k}, {x}., {y}., {z}.\n" for k, (x, y, z) in enumerate([*places, (9, 9, 9)], 1))
    solid = grid + "*ELEMENT, TYPE=C3D10, ELSET=E\n1, " + ", ".join(map(str, range(1, 11))) + "\n"
    for face, nodes in (("S1", [1, 2, 3, 5, 6, 7]), ("S3", [2, 3, 4, 6, 9, 10])):
        (tmp_path / "a.inp").write_text(
            f"{solid}*SURFACE, NAME=F\nE, {face}\n*COUPLING, REF NODE=11, SURFACE=F\n*KINEMATIC\n"
        )
        assert cf.read_mesh(tmp_path / "a.inp").attachments.rigids[0].nodes.tolist() == [n - 1 for n in nodes]
    wedge = grid + "*ELEMENT, TYPE=C3D6, ELSET=E\n1, 1, 2, 3, 4, 9, 10\n2, 1, 2, 3, 5, 6, 7\n"
    (tmp_path / "a.inp").write_text(f"{wedge}*SURFACE, NAME=F\n1, S2\n*COUPLING, REF NODE=11, SURFACE=F\n*KINEMATIC\n")
    assert cf.read_mesh(tmp_path / "a.inp").attachments.rigids[0].nodes.tolist() == [3, 8, 9]
