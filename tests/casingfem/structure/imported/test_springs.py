"""Nodes without mass between springs, bushes with arms, and single components in coordinate systems of the file."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.structure.imported.parts import added_nodes, hung, supported

QUIET = ("mesh-aspect", "mesh-orphan-nodes", "mesh-linear-cells")
pytestmark = [pytest.mark.filterwarnings(f"ignore:.*{code}") for code in QUIET]
END, MIDDLE = (0.6, 0.0, 0.0), (0.8, 0.0, 0.0)


@pytest.fixture(scope="module")
def bar():
    """A clamped bar along x with two nodes of no cell beyond its tip, and their indices."""
    mesh = cf.imported.grid_mesh(
        "hexahedron20",
        (4, 1, 1),
        lambda u: (u - [0.0, 0.5, 0.5]) * [0.5, 0.04, 0.05],
        groups={"root": (0, 0.0), "tip": (0, 1.0)},
    )
    return added_nodes(mesh, END, MIDDLE)


def spring(first, other, axis, k):
    ends = [(first, 1.0), *([(other, -1.0)] if other is not None else [])]
    return cf.imported.Spring(terms=tuple(cf.imported.Term(node, axis, sign) for node, sign in ends), stiffness=k)


def on_tip(mesh, node, **items):
    tip = mesh.groups["tip"].nodes
    return supported(
        hung(mesh, means=(cf.imported.Mean(reference=node, nodes=tip, weights=np.ones(len(tip))),), **items)
    )


@pytest.mark.slow
def test_a_node_between_two_springs_makes_one_of_them_in_series(bar):
    """Modes as with k1 k2/(k1 + k2), all counted; under a force the node moves by f/(k2 + k1 kb/(k1 + kb))."""
    mesh, (end, middle) = bar
    k1, k2, axes = 3e6, 5e6, range(3)
    chain = [s for c in axes for s in (spring(end, middle, c, k1), spring(middle, None, c, k2))]
    series = [spring(end, None, c, k1 * k2 / (k1 + k2)) for c in axes]
    one, two = (on_tip(mesh, end, springs=tuple(springs)) for springs in (chain, series))
    found, exact = cf.modes(one, 6), cf.modes(two, 6)
    np.testing.assert_allclose(found.freq, exact.freq, rtol=1e-8)
    assert found.sturm_count == exact.sturm_count
    number = int(mesh.node_numbers[middle])
    free = np.diagonal(compliance(on_tip(mesh, end), int(mesh.node_numbers[end])))
    moved = compliance(one, number)
    np.testing.assert_allclose(np.diagonal(moved), 1.0 / (k2 + 1.0 / (1.0 / k1 + free)), rtol=1e-7)
    basis = cf.reduce(one, interface=cf.modal.AtNodes((number,)), modes=5)
    np.testing.assert_allclose(basis.rows / basis.omega**2 @ basis.rows.T + basis.S, moved, atol=1e-9 * moved.max())


def compliance(part, node):
    """Displacements of a node under unit forces on it, (3, 3)."""
    return np.stack(
        [cf.solve_static(part, [cf.imported.NodeLoad(node=node, force=tuple(e))]).at(node) for e in np.eye(3)], axis=1
    )


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*mesh-floating-spring")
def test_a_slanted_spring_fixes_one_direction_and_forces_across_it_are_refused(bar):
    mesh, (end, middle) = bar
    along = np.array([0.6, 0.0, 0.8])
    terms = tuple(
        cf.imported.Term(node, c, sign * along[c]) for node, sign in ((end, 1.0), (middle, -1.0)) for c in (0, 2)
    )
    part = on_tip(mesh, end, springs=(cf.imported.Spring(terms=terms, stiffness=2e5),))
    bare = on_tip(mesh, end)
    end, middle = (int(mesh.node_numbers[k]) for k in (end, middle))
    with pytest.warns(
        cf.errors.ModelWarning, match=rf"found 1 node \({middle}\) with springs to one other.*mesh-floating-spring"
    ):
        found = cf.modes(part, 4).freq
    np.testing.assert_allclose(found, cf.modes(bare, 4).freq, rtol=1e-8)
    moved, alone = (
        cf.solve_static(s, [cf.imported.NodeLoad(node=n, force=tuple(10.0 * along))])
        for s, n in ((part, middle), (bare, end))
    )
    stretch = (moved.at(middle) - moved.at(end)) @ along
    np.testing.assert_allclose(stretch, 10.0 / 2e5, rtol=1e-8)
    np.testing.assert_allclose(moved.at(end), alone.at(end), rtol=1e-8, atol=1e-15)
    for refused in ((0.0, 1.0, 0.0), (0.6, 0.0, -0.8)):
        with pytest.raises(cf.errors.ModelError, match=rf"a force on node {middle} along [xyz].*load-idle"):
            cf.solve_static(part, [cf.imported.NodeLoad(node=middle, force=refused)])
    with pytest.raises(cf.errors.ModelError, match=rf"node {middle} along .*load-idle"):
        cf.reduce(part, interface=cf.modal.AtNodes((middle,)), modes=3)


FILE = """BEGIN BULK
CORD2C,5,,0.1,0.,0.,0.1,0.,1.,+
+,1.,0.,0.
GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,0.,1.,0.
GRID,4,,0.,0.,1.
GRID,5,,1.,1.,1.
GRID,6,,1.5,1.2,1.,5
GRID,7,,1.3,.8,1.4
CTETRA,1,7,1,2,3,4
RBE2,20,5,123456,2,3,4
CONM2,21,6,,2.,,,,,+
+,.1,,.2,,,.3
CONM2,22,7,,2.,,,,,+
+,.1,,.2,,,.3
SPC1,3,123,1
SPC1,4,12,6
SPC1,4,123,5
{cards}
ENDDATA
"""


def read(path, cards):
    path.write_text(FILE.format(cards=cards))
    return cf.read_mesh(path)


def test_a_bush_with_arms_is_one_of_coincident_grids_on_rigid_bars(tmp_path):
    """Springs at a third of the way from 5 to 6, x along the line, z square to it and the vector (0, 1, 2)."""
    five, six = np.array([1.0, 1.0, 1.0]), np.array([1.5, 1.2, 1.0])
    at = five + (six - five) / 3.0
    x = (six - five) / np.linalg.norm(six - five)
    z = np.cross(x, [0.0, 1.0, 2.0])
    z /= np.linalg.norm(z)
    properties = "PBUSH,3,K,1.+5,2.+5,3.+5,4.+3,5.+3,6.+3"
    bush, bars = (tmp_path / name for name in ("a.bdf", "b.bdf"))
    read(bush, f"CBUSH,30,3,5,6,0.,1.,2.,,+\n+,{1 / 3!r}\n{properties}")
    point = ",".join(map(repr, at.tolist()))
    vectors = ",".join(map(repr, (at + z).tolist())), ",".join(map(repr, (at + x).tolist()))
    read(
        bars,
        f"GRID,8,,{point}\nGRID,9,,{point}\nRBAR,31,5,8,123456\nRBAR,32,6,9,123456\nCBUSH,30,3,8,9,,,,7\n"
        f"{properties}\nCORD2R,7,,{point},{vectors[0]},+\n+,{vectors[1]}",
    )
    for options in ({}, {"units": "mm-t-s"}):
        parts = [supported(cf.read_mesh(mesh_file, **options), "SPC 3") for mesh_file in (bush, bars)]
        K, other = (part.assembled().K.toarray() for part in parts)
        np.testing.assert_allclose(K, other, atol=1e-11 * np.abs(K).max())


def test_springs_masses_and_equations_follow_the_systems_that_cards_name(tmp_path):
    """Grid 6 moves along radial, tangential and axial directions of system 5; so does a bush, and a mass there."""
    mesh = read(
        tmp_path / "a.bdf",
        "CELAS2,30,7.,6,1\nCELAS2,31,7.,6,5\nCBUSH,32,3,6,,,,,5\nPBUSH,3,K,,9.\nMPC,1,6,2,3.,7,1,1.\n"
        "CONM2,33,6,5,2.,.5,,,,+\n+,1.,,2.,,,3.\nCONM2,34,6,-1,2.,1.5,1.2,1.7",
    )
    away = np.array([1.4, 1.2, 0.0])
    radial = away / np.linalg.norm(away)
    around = np.array([-radial[1], radial[0], 0.0])
    felt = np.zeros((3, 6))
    for row, s in zip(felt, mesh.attachments.springs, strict=True):
        for node, component, coefficient in s.terms:
            assert node == 5
            row[component] += coefficient
    np.testing.assert_allclose(felt, [[*radial, 0, 0, 0], [0, 0, 0, *around], [*around, 0, 0, 0]], atol=1e-12)
    (equation,) = mesh.attachments.equations
    wanted = {
        cf.imported.Term(5, 0, 3.0 * around[0]),
        cf.imported.Term(5, 1, 3.0 * around[1]),
        cf.imported.Term(6, 0, 1.0),
    }
    assert {t._replace(coefficient=round(t.coefficient, 12)) for t in equation.terms} == {
        t._replace(coefficient=round(t.coefficient, 12)) for t in wanted
    }
    assert abs(equation.terms[0].coefficient) == max(abs(t.coefficient) for t in equation.terms[:2])
    turned, direct = mesh.attachments.masses[-2:]
    np.testing.assert_allclose(turned.offset, 0.5 * radial)
    axes = np.array([radial, around, [0, 0, 1]])
    np.testing.assert_allclose(turned.inertia, axes.T @ np.diag([1.0, 2.0, 3.0]) @ axes, atol=1e-12)
    np.testing.assert_allclose(direct.offset, [0.0, 0.0, 0.7], atol=1e-12)
    assert {"SPC 4", "SPC 4 12 CD 5", "SPC 4 123"} <= set(mesh.groups)
    assert "SPC 4 12" not in mesh.groups


def test_sums_of_constraint_sets_are_groups(tmp_path):
    """SPCADD 9 of sets 3 and 4, and of one that the file does not give."""
    groups = read(tmp_path / "a.bdf", "SPCADD,9,3,4,77").groups
    both = np.union1d(groups["SPC 3"].nodes, groups["SPC 4"].nodes)
    np.testing.assert_array_equal(groups["SPC 9"].nodes, both)
    np.testing.assert_array_equal(groups["SPC 9 123"].nodes, [0, 4])
    np.testing.assert_array_equal(groups["SPC 9 12 CD 5"].nodes, groups["SPC 4 12 CD 5"].nodes)


@pytest.mark.parametrize("kind", ["R", "C", "S"])
def test_systems_by_grids_are_systems_by_their_places(kind, tmp_path):
    """Grids 8 is in system 9 by grids, one of which is in a system by points."""
    grids = "GRID,11,5,.9,90.,0.\nGRID,12,,.1,.9,1.\nGRID,13,,1.1,.9,0.\nGRID,8,9,1.,40.,50.\nSPC1,6,1,8"
    same = f"CORD2{kind},9,,.1,.9,0.,.1,.9,1.,+\n+,1.1,.9,0."
    places = []
    for system in (f"CORD1{kind},9,11,12,13", same):
        mesh = read(tmp_path / "a.bdf", f"{grids}\n{system}")
        places.append(mesh.points[mesh.node_numbers == 8][0])
    np.testing.assert_allclose(places[0], places[1], atol=1e-12)


@pytest.mark.parametrize(
    ("cards", "told"),
    [
        ("CORD1R,9,8,11,12\nGRID,8,9,1.,0.,0.\nGRID,11,,1.,0.,1.\nGRID,12,,1.,1.,0.", "systems whose grids lie"),
        (
            "CORD2R,8,7,0.,0.,0.,0.,0.,1.,+\n+,1.,0.,0.\nCORD2R,7,8,0.,0.,0.,0.,0.,1.,+\n+,1.,0.,0.\n"
            "CORD2R,9,7,0.,0.,0.,0.,0.,1.,+\n+,1.,0.,0.\nGRID,8,9,1.,0.,0.",
            "system 7 that refers to itself",
        ),
        ("CORD1R,9,1,2,77", "CORD1R: found grid 77, which the file does not define"),
        ("CORD1R,9,1,2", "CORD1R: found the grids 1, 2, expected three"),
        ("CORD1R,5,1,2,3", "found coordinate system 5 again"),
        ("CBUSH,30,3,5,6\nPBUSH,3,K,1.,1.", "stiffness across the line between its grids"),
        ("CBUSH,30,3,5,6,.5,.2,0.\nPBUSH,3,K,1.,1.", "an orientation along the line"),
        ("CBUSH,30,3,5\nPBUSH,3,K,1.,1.", "coincident grids, or one grid"),
        ("CBUSH,30,3,5,6,,,,0,+\n+,.5,7\nPBUSH,3,K,1.,1.", r"offset in system 7 \(OCID\)"),
        ("CBUSH,30,2,5,6,1.,2.,0.\nPBUSH,3,K,1.,1.", "CBUSH: found the property 2 without a PBUSH"),
        ("CBUSH,30,3,5,6,,,,8\nPBUSH,3,K,1.,1.", "coordinate system 8: found no system 8"),
        ("GRID,8,,.1,0.,3.,5\nCELAS2,30,7.,8,1", "a point on the axis of system 5"),
    ],
)
def test_systems_and_bushes_that_are_not_given_whole_are_refused_by_line(cards, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=rf"line \d+: .*{told}"):
        read(tmp_path / "a.bdf", cards)


def test_forces_on_reference_nodes_without_mass_or_springs_reach_the_part(bar):
    """A rigid arm carries a force; its reference has neither mass nor stiffness of its own."""
    mesh, (end, middle) = bar
    tip = mesh.groups["tip"].nodes
    arm = (cf.imported.Rigid(reference=end, nodes=tip), cf.imported.Rigid(reference=middle, nodes=np.array([end])))
    part = supported(hung(mesh, rigids=arm))
    number = int(mesh.node_numbers[middle])
    moved = compliance(part, number)
    np.testing.assert_allclose(moved, moved.T, atol=1e-9 * moved.max())
    assert isinstance(part.mesh, cf.imported.MeshData)
    heavy = supported(hung(mesh, rigids=arm, masses=(cf.imported.PointMass(node=middle, mass=3.0),)))
    np.testing.assert_allclose(compliance(heavy, number), moved, rtol=1e-9)
