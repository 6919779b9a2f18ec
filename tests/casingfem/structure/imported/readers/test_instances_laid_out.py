"""Instances of parts laid out: numbers, names and places of each card, by the words of the file alone."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.imported.readers.inp_cards import Card, cards, laid_out, largest, motion, split_parts

PART = """*PART, NAME=p
*NODE
 7, 0., 0., 0.
 12, 1., 0., 0.
*ELEMENT, TYPE=T3D2
 340, 7, 12
*END PART
"""


def numbered(text):
    return [(str(k), line) for k, line in enumerate(text.splitlines(), 1)]


def fault(line, message):
    return cf.errors.ModelError("mesh-file", f"line {line}: {message}")


def laid(text):
    return list(laid_out(cards(numbered(text)), fault))


def facts(text):
    return [(card.keyword, frame.offset, frame.prefix, frame.owns) for card, frame in laid(text)]


def test_cards_have_parameters_and_lines_without_comments():
    text = "left out\n*Node ,  nset = A=b , Input\n** a comment\n 1, 2\n\n*end  part\n   *ELEMENT,,type=X,\n3,\n"
    assert [(card.line, card.keyword, card.parameters, card.data) for card in cards(numbered(text))] == [
        ("2", "NODE", {"NSET": "A=b", "INPUT": ""}, [("4", "1, 2")]),
        ("6", "END PART", {}, []),
        ("7", "ELEMENT", {"TYPE": "X"}, [("8", "3,")]),
    ]
    assert list(cards(numbered("none\n**\n"))) == []


def test_without_instances_all_cards_stand_as_they_are():
    """One part, whose own words are kept."""
    found = facts(PART)
    assert found == [(name, 0, "", True) for name in ("PART", "NODE", "ELEMENT", "END PART")]
    _, frame = laid(PART)[1]
    np.testing.assert_array_equal(frame.moved(np.array([[1.0, 2.0, 3.0]])), [[1.0, 2.0, 3.0]])
    with pytest.raises(cf.errors.ModelError, match=r"line 9: \*PART: several parts and no \*INSTANCE that places them"):
        laid(PART + "*MATERIAL\n*PART, NAME=q\n*END PART\n*PART, NAME=r\n")


def test_one_instance_keeps_the_numbers_and_names_of_its_part():
    text = PART + "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=i, PART=P\n1., 2., 3.\n*NSET, NSET=in\n7\n*END INSTANCE\n"
    text += "*NSET, NSET=out\n7\n*NSET, NSET=named, INSTANCE=I\n7\n"
    assert facts(text) == [
        ("ASSEMBLY", 0, "", False), ("NODE", 0, "", True), ("ELEMENT", 0, "", True), ("NSET", 0, "", True),
        ("NSET", 0, "", False), ("NSET", 0, "", False),
    ]  # fmt: skip
    moved = [frame.moved(np.zeros((1, 3)))[0].tolist() for _, frame in laid(text)]
    assert moved == [[0, 0, 0], [1, 2, 3], [1, 2, 3], [1, 2, 3], [0, 0, 0], [1, 2, 3]]


def test_several_instances_have_numbers_beyond_all_numbers_of_the_parts():
    """340 is the largest: the second's begin at 1000, the third's at 2000; names have theirs before a point."""
    text = PART + "*PART, NAME=q\n*NODE\n 99, 0., 0., 0.\n*END PART\n*ASSEMBLY, NAME=A\n"
    for name, part in (("One", "p"), ("Two", "Q"), ("Three", "P")):
        text += f"*INSTANCE, NAME={name}, PART={part}\n*END INSTANCE\n"
    text += "*NSET, NSET=out, INSTANCE=two\n99\n*NSET, NSET=all\n"
    assert facts(text) == [
        ("ASSEMBLY", 0, "", False),
        ("NODE", 0, "One.", True), ("ELEMENT", 0, "One.", True), ("NODE", 1000, "Two.", True),
        ("NODE", 2000, "Three.", True), ("ELEMENT", 2000, "Three.", True),
        ("NSET", 1000, "Two.", False), ("NSET", 0, "", False),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("assembly", "told"),
    [
        ("*INSTANCE, PART=P\n", r"line 8: \*INSTANCE: found the name '', expected each instance's own"),
        ("*INSTANCE, NAME=a, PART=p\n*END INSTANCE\n*INSTANCE, NAME=A, PART=p\n", "line 10: .*found the name 'A'"),
        ("*INSTANCE, NAME=a, PART=q\n", r"line 8: \*INSTANCE of part 'Q', which is not given up to here"),
        (
            "*NSET, NSET=s, INSTANCE=a\n*INSTANCE, NAME=a, PART=p\n",
            r"line 8: \*NSET, INSTANCE=A: no such instance up to here",
        ),
    ],
)
def test_instances_that_cannot_be_laid_out_are_refused(assembly, told):
    with pytest.raises(cf.errors.ModelError, match=told):
        laid(PART + assembly)


def test_cards_between_the_words_of_a_part_are_its_own_until_it_goes_on():
    """A part may be written in two pieces."""
    own, rest = split_parts(
        list(cards(numbered("*A\n*PART, NAME=x\n*B\n*END PART\n*C\n*PART, NAME=X\n*D\n*END PART\n*E\n")))
    )
    assert {name: [card.keyword for card in part] for name, part in own.items()} == {"X": ["B", "D"]}
    assert [card.keyword for card in rest] == ["A", "C", "E"]


@pytest.mark.parametrize(
    ("keyword", "rows", "number"),
    [
        ("NODE", ["7, 99.", " 12 , 3"], 12),
        ("ELEMENT", ["7, 99", "x, 3", "1.5"], 7),
        ("ELEMENT", ["9" * 15 + ", 1", "9" * 16], 10**15 - 1),
        ("NSET", ["7, 99"], 0),
        ("NODE", [], 0),
    ],
)
def test_the_largest_number_of_a_card(keyword, rows, number):
    assert largest(Card("1", keyword, {}, [("2", row) for row in rows])) == number


def moved(*rows, x=(0.0, 0.0, 0.0)):
    turn, shift = motion(Card("3", "INSTANCE", {}, [(str(4 + k), row) for k, row in enumerate(rows)]), fault)
    return (turn @ np.array(x) + shift).tolist()


def test_an_instance_is_shifted_and_then_turned_about_its_axis():
    """By 90 degrees about the axis from (1, 2, 3) along z; by 180 about one along (1, 1, 0); by -90 about y."""
    assert moved(x=(1.0, 2.0, 3.0)) == [1.0, 2.0, 3.0]
    assert moved("5., 6., 7.", x=(1.0, 2.0, 3.0)) == [6.0, 8.0, 10.0]
    x = (0.5, 0.25, 2.0)  # shifted: (1.5, 2.25, 5), from the axis (0.5, 0.25)
    assert moved("1., 2., 3.", "1., 2., 3., 1., 2., 7., 90.,", x=x) == pytest.approx([0.75, 2.5, 5.0], rel=1e-13)
    assert moved("0., 0., 0.", "0,0,1,2,2,1,180", x=(1.0, 0.0, 3.0)) == pytest.approx([0.0, 1.0, -1.0], abs=1e-13)
    assert moved("0,0,0", "0,0,0,0,2,0,-90", x=(0.0, 3.0, 1.0)) == pytest.approx([-1.0, 3.0, 0.0], abs=1e-13)


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        (["1., 2."], r"line 3: \*INSTANCE: expected a line dx, dy, dz, then one ax, ay, az, bx, by, bz, angle"),
        (["1., 2., 3., 4."], r"line 3: \*INSTANCE: expected a line dx"),
        (["1., 2., 3.", "1,1,1,2,2,2"], r"line 3: \*INSTANCE: expected a line dx"),
        (["1., 2., 3.", "1,1,1,2,2,2,3,4"], r"line 3: \*INSTANCE: expected a line dx"),
        (["1., 2., 3.", "1,1,1,2,2,2,90", "1,2,3"], r"line 3: \*INSTANCE: expected a line dx"),
        (["1., 2., 3.", "1,1,1,2,2,x,90"], "line 5: found '1,1,1,2,2,x,90', expected numbers"),
        (["1., 2., 1e15"], r"line 4: found '1\., 2\., 1e15', expected numbers below 1e\+15"),
        (["1., 2., -1e15"], r"line 4: found '1\., 2\., -1e15', expected numbers below 1e\+15"),
        (["0,0,0", "1,1,1,1,1,1,90"], r"line 5: \*INSTANCE: found an axis between two points at one place"),
    ],
)
def test_motions_that_are_not_given_whole_are_refused(rows, told):
    with pytest.raises(cf.errors.ModelError, match=told):
        moved(*rows)


def test_motions_may_be_large():
    assert moved("1., 2., 9.99e14") == [1.0, 2.0, 9.99e14]
    assert moved("1., 2., -9.99e14") == [1.0, 2.0, -9.99e14]
