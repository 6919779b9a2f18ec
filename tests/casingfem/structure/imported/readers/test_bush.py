"""Springs of CBUSH cards: which motions of both grids stretch them, from arms, directions and systems."""

import numpy as np
import pytest

import casingfem as cf

A, B = np.array([1.0, 1.0, 1.0]), np.array([1.5, 1.2, 0.9])
FILE = """GRID,5,,1.,1.,1.
GRID,6,,1.5,1.2,.9
GRID,7,,1.3,.8,1.4
GRID,8,,1.,1.,1.,4
GRID,9,,0.,0.,0.
CORD2R,4,,0.,0.,0.,.6,0.,.8,+
+,.8,0.,-.6
CTETRA,1,1,5,6,7,9
{cards}
ENDDATA
"""
AXES = np.array([[0.8, 0.0, -0.6], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8]])  # of system 4
X = (B - A) / np.linalg.norm(B - A)
ALL = "PBUSH,3,K,1.,2.,3.,4.,5.,6."


def springs(folder, cards):
    (folder / "a.bdf").write_text(FILE.format(cards=cards))
    return cf.read_mesh(folder / "a.bdf").attachments.springs


def across(x, v):
    """x, y, z with z along x times v."""
    z = np.cross(x, v)
    z = z / np.linalg.norm(z)
    return np.array([x, np.cross(z, x), z])


def stretched(spring):
    """Coefficients of the six motions of each node, by the node's index."""
    rows = {}
    for node, component, coefficient in spring.terms:
        row = rows.setdefault(node, np.zeros(6))
        assert row[component] == 0.0
        row[component] = coefficient
    return rows


def expected(axes, c, at, ends):
    """a.(u_A + theta_A x r_A) - a.(u_B + theta_B x r_B), or a.(theta_A - theta_B)."""
    rows = {}
    for (node, x), sign in zip(ends, (1.0, -1.0), strict=False):
        a = axes[c % 3]
        rows[node] = sign * (np.concatenate([np.zeros(3), a]) if c > 2 else np.concatenate([a, np.cross(at - x, a)]))
    return rows


def check(found, axes, at, ends, stiffness):
    assert [spring.stiffness for spring in found] == [k for k in stiffness if k]
    for spring, c in zip(found, np.flatnonzero(stiffness).tolist(), strict=True):
        rows, wanted = stretched(spring), expected(axes, c, at, ends)
        assert list(rows) == list(wanted)
        for node, row in wanted.items():
            np.testing.assert_allclose(rows[node], row, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("card", "axes", "part"),
    [
        ("CBUSH,30,3,5,6,0.,1.,2.", across(X, [0.0, 1.0, 2.0]), 0.5),
        ("CBUSH,30,3,5,6,3.", across(X, [3.0, 0.0, 0.0]), 0.5),
        ("CBUSH,30,3,5,6,7", across(X, [0.3, -0.2, 0.4]), 0.5),  # towards grid 7
        ("CBUSH,30,3,5,6,3,1.", across(X, [3.0, 1.0, 0.0]), 0.5),  # no grid, as there is a second component
        ("CBUSH,30,3,5,6,3,,2.", across(X, [3.0, 0.0, 2.0]), 0.5),
        ("CBUSH,30,3,8,6,0.,1.,2.", across(X, [0.0, 1.0, 2.0] @ AXES), 0.5),  # in the system of A's displacements
        ("CBUSH,30,3,5,6,,,,4", AXES, 0.5),
        ("CBUSH,30,3,5,6,,,,0", np.eye(3), 0.5),
        ("CBUSH,30,3,5,6,,,,4,+\n+,.2,-1", AXES, 0.2),
        ("CBUSH,30,3,5,6,7,,,,+\n+,0.", across(X, [0.3, -0.2, 0.4]), 0.0),
    ],
)
def test_a_bush_between_two_grids(card, axes, part, tmp_path):
    found = springs(tmp_path, f"{card}\n{ALL}")
    first = 3 if ",8,6," in card else 0
    check(found, axes, A + part * (B - A), [(first, A), (1, B)], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert {spring.where for spring in found} == {"CBUSH 30 (line 9)"}


def test_a_bush_of_one_grid_keeps_it_on_the_ground(tmp_path):
    check(
        springs(tmp_path, f"CBUSH,30,3,7,,,,,4\n{ALL}"),
        AXES,
        np.zeros(3),
        [(2, np.zeros(3))],
        [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
    )


@pytest.mark.parametrize(
    ("property_card", "stiffness"),
    [
        ("PBUSH,3,K,1.,,3.,,5.", (1.0, 0.0, 3.0, 0.0, 5.0, 0.0)),
        ("PBUSH,3,k,1.,0.,3.", (1.0, 0.0, 3.0, 0.0, 0.0, 0.0)),
        ("PBUSH,3,B,9.,9.,9.,9.,9.,9.,+\n+,K,1.,,,,,6.,+\n+,GE,8.", (1.0, 0.0, 0.0, 0.0, 0.0, 6.0)),
        ("PBUSH,3,B,9.", (0.0,) * 6),
        ("PBUSH,2,K,9.\nPBUSH,3,K,,,,4.", (0.0, 0.0, 0.0, 4.0, 0.0, 0.0)),
    ],
)
def test_stiffness_is_behind_its_letter(property_card, stiffness, tmp_path):
    found = springs(tmp_path, f"{property_card}\nCBUSH,30,3,5,6,,,,4")
    check(found, AXES, (A + B) / 2.0, [(0, A), (1, B)], stiffness)


@pytest.mark.parametrize("c", [1, 2, 4, 5])
def test_stiffness_across_its_line_needs_an_orientation(c, tmp_path):
    with pytest.raises(cf.errors.ModelError, match="stiffness across the line between its grids"):
        springs(tmp_path, f"CBUSH,30,3,5,6\nPBUSH,3,K,{',' * c}7.")


def test_stiffness_along_its_line_alone_needs_no_orientation(tmp_path):
    check(springs(tmp_path, "CBUSH,30,3,5,6\nPBUSH,3,K,7.,,,8."), np.array([X] * 3), (A + B) / 2.0, [(0, A), (1, B)],
          (7.0, 0.0, 0.0, 8.0, 0.0, 0.0))  # fmt: skip


@pytest.mark.parametrize(
    ("cards", "told"),
    [
        ("CBUSH,30,3,5,6,7\nPBUSH,3,K,1.,-2.", "line 10: PBUSH: found the stiffness -2, expected one above 0"),
        ("CBUSH,30,3,5,8,7\nPBUSH,3,K,1.", "line 9: CBUSH: found coincident grids, or one grid"),
        (
            "CBUSH,30,3,5,6,7,,,,+\n+,,4\nPBUSH,3,K,1.",
            r"line 9: CBUSH: found an offset in system 4 \(OCID\), expected none",
        ),
        ("CBUSH,30,3,5,6,.5,.2,-.1\nPBUSH,3,K,1.,1.", "found an orientation along the line of its grids"),
        ("CBUSH,30,2,5,6\nPBUSH,3,K,1.", "line 9: CBUSH: found the property 2 without a PBUSH"),
    ],
)
def test_bushes_that_are_not_understood_are_refused(cards, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=told):
        springs(tmp_path, cards)


@pytest.mark.parametrize(("away", "stands"), [(0.5e-12, False), (1.5e-12, True)])
def test_an_orientation_along_the_line_is_reported_to_round_off(away, stands, tmp_path):
    grids = "GRID,11,,0.,0.,0.\nGRID,12,,2.,0.,0.\n"
    card = f"{grids}CBUSH,30,3,11,12,4.,{4.0 * away!r},0.\nPBUSH,3,K,1.,1."
    if stands:
        check(springs(tmp_path, card), np.eye(3), np.array([1.0, 0, 0]),
              [(5, np.zeros(3)), (6, np.array([2.0, 0, 0]))], (1.0, 1.0, 0, 0, 0, 0))  # fmt: skip
        return
    with pytest.raises(cf.errors.ModelError, match="found an orientation along the line"):
        springs(tmp_path, card)


@pytest.mark.parametrize(("slant", "components"), [(0.5e-12, {0}), (1.5e-12, {0, 1})])
@pytest.mark.parametrize("turning", [False, True])
def test_components_of_a_direction_that_are_round_off_are_none(slant, components, turning, tmp_path):
    grids = f"GRID,11,,0.,0.,0.\nGRID,12,,1.,{slant!r},0.\n"
    (spring,) = springs(tmp_path, f"{grids}CBUSH,30,3,11,12\nPBUSH,3,K,{',,,' if turning else ''}1.")
    assert {term.component for term in spring.terms} == {3 * turning + c for c in components}


@pytest.mark.parametrize(("height", "turns"), [(0.5e-12, False), (1.5e-12, True)])
@pytest.mark.parametrize("size", [1.0, 1e3])
def test_turns_through_arms_that_are_round_off_of_the_arm_are_none(height, turns, size, tmp_path):
    """A bush along y, from a grid as far away in x as in a part of it in z."""
    grids = f"GRID,11,,0.,0.,0.\nGRID,12,,{2 * size!r},0.,{2 * size * height!r}\n"
    (spring,) = springs(tmp_path, f"{grids}CBUSH,30,3,11,12,,,,0\nPBUSH,3,K,,1.")
    found = {(term.node, term.component) for term in spring.terms}
    assert found == {(5, 1), (5, 5), (6, 1), (6, 5)} | ({(5, 3), (6, 3)} if turns else set())
