"""Superelements of Nastran on the command line: OP4 beside bulk data, own axes of nodes, damping, rigid motion.

The part is a free beam of steel, 1 m, 20 x 20 mm, of two nodes, as its exact K and M of cubic shapes.
"""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
import contact as ct
from casingfem.cli import main

MASS = 7800.0 * 4e-4
FREQ = np.sqrt(720.0 * 210e9 * 0.02**4 / 12.0 / MASS) / (2.0 * np.pi)  # symmetric bending of one element, 127.935 Hz


def beam(length=1.0, E=210e9, side=0.02, rho=7800.0):
    """K and M of a beam along x; each node moves along x, y, z and turns about them."""
    A, J, L = side**2, side**4 / 12.0, length
    K, M = np.zeros((12, 12)), np.zeros((12, 12))
    bar, lumped = np.array([[1.0, -1.0], [-1.0, 1.0]]), np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
    K[np.ix_([0, 6], [0, 6])], M[np.ix_([0, 6], [0, 6])] = E * A / L * bar, rho * A * L * lumped
    K[np.ix_([3, 9], [3, 9])], M[np.ix_([3, 9], [3, 9])] = E * J / L * bar, 2.0 * rho * J * L * lumped
    bend = np.array([[12, 6 * L, -12, 6 * L], [6 * L, 4 * L**2, -6 * L, 2 * L**2],
                     [-12, -6 * L, 12, -6 * L], [6 * L, 2 * L**2, -6 * L, 4 * L**2]])  # fmt: skip
    inert = np.array([[156, 22 * L, 54, -13 * L], [22 * L, 4 * L**2, 13 * L, -3 * L**2],
                      [54, 13 * L, 156, -22 * L], [-13 * L, -3 * L**2, -22 * L, 4 * L**2]])  # fmt: skip
    for rows, sign in (([1, 5, 7, 11], 1.0), ([2, 4, 8, 10], -1.0)):
        flip = np.diag([1.0, sign, 1.0, sign])
        K[np.ix_(rows, rows)] = E * J / L**3 * flip @ bend @ flip
        M[np.ix_(rows, rows)] = rho * A * L / 420.0 * flip @ inert @ flip
    return K, M


K, M = beam()
OWN = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # of node 2: x along y, y along z


def turned(A, axes=OWN, node=1):
    """A matrix with the dofs of one node along its own axes."""
    T = np.eye(A.shape[0])
    for k in (6 * node, 6 * node + 3):
        T[k : k + 3, k : k + 3] = axes
    return T @ A @ T.T


def op4(folder, matrices, *, word=4, order="<", name="part.op4"):
    """Dense columns in binary records, of words of four or eight bytes; null matrices are 1 x 1."""

    def record(*parts):
        data = b"".join(parts)
        size = np.array([len(data)], f"{order}i4").tobytes()
        return size + data + size

    def ints(*numbers):
        return np.array(numbers, f"{order}i{word}").tobytes()

    out = b""
    for title, A in matrices.items():
        n = len(A)
        each = 8 // word
        out += record(ints(n, n, 6, 2), title.ljust(2 * word).encode())
        for column in range(n):
            if A[:, column].any():
                out += record(ints(column + 1, 1, each * n), A[:, column].astype(f"{order}f8").tobytes())
        out += record(ints(n + 1, 1, each), np.ones(1, f"{order}f8").tobytes())
    (folder / name).write_bytes(out)


TABLES = {
    "dofs.csv": "node,direction\n" + "".join(f"{n},{c}\n" for n in (1, 2) for c in range(1, 7)),
    "nodes.csv": "node,x,y,z\n1,0,0,0\n2,1,0,0\n",
}
BULK = """$ a superelement
BEGIN SUPER      102
{cord}
EXTRN          1  123456       2  123456
GRID*                  1               0 0.000000000E+00 0.000000000E+00
*        0.000000000E+00               0
GRID           2{cp:>8}{place}{cd:>8}
ASET           1  123456       2  123456
DTI     TUG1    0       36      32      32767   0       7       0
"""
BASIC = f"{'1.0':>8}{'0.0':>8}{'0.0':>8}"
SYSTEM = "CORD2R  10      0       0.0     0.0     0.0     1.0     0.0     0.0\n        0.0     1.0     0.0"
GRIDS = "GRID,5,,0.,0.,0.\nGRID,6,,1.,0.,0.\nGRID,7,,0.,1.,0.\nCORD1R,10,5,6,7"


def run(folder, *arguments, code=0):
    ran = CliRunner().invoke(main, ["import", *(str(folder / a) if "." in a else a for a in arguments), "--json"])
    assert ran.exit_code == code, ran.stderr
    return json.loads(ran.stdout) if code == 0 else ran.stderr


@pytest.fixture
def folder(tmp_path):
    for name, text in TABLES.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def by_hand(folder, *more):
    return run(folder, "part.op4", "--dofs", "dofs.csv", "--nodes", "nodes.csv", *more)


def whole(document):
    """The beam's mass three times, its inertia and its frequency."""
    facts = document["matrices"]
    np.testing.assert_allclose(facts["mass"], MASS, rtol=1e-9)
    np.testing.assert_allclose(np.diag(facts["inertia"]), [2.08e-4, 0.26, 0.26], rtol=1e-8)
    assert facts["rigid"] == 6
    np.testing.assert_allclose(facts["freq_hz"][:2], FREQ, rtol=1e-7)
    return facts


@pytest.mark.parametrize(("word", "order"), [(4, "<"), (8, "<"), (8, ">")])
def test_a_null_damping_of_one_row_is_none_in_files_of_32_and_64_bit_integers(word, order, folder):
    op4(folder, {"KAA": K, "MAA": M, "BAA": np.zeros((1, 1)), "VAX": M[:3, :3]}, word=word, order=order)
    document = by_hand(folder)
    assert "damping" not in str(whole(document)["rigid_motion"])
    assert document["zeta"] == [0.0] * 12
    assert document["left_out"] == ["VAX"]


@pytest.mark.parametrize("matrices", ["KXX1", "K4XX1"])
def test_structural_damping_is_half_its_loss_factor_at_each_mode(matrices, folder):
    op4(folder, {"KXX1": K, "MXX1": M, **({"K4XX1": 0.02 * K} if matrices == "K4XX1" else {})})
    if matrices == "KXX1":  # from the deck
        (folder / "deck.bdf").write_text("PARAM,G,0.02\n")
        document = run(folder, "deck.bdf", "part.op4", "--dofs", "dofs.csv", "--nodes", "nodes.csv")
    else:
        document = by_hand(folder)
    np.testing.assert_allclose(document["zeta"], [0.0] * 6 + [0.01] * 6, rtol=1e-9)
    np.testing.assert_allclose(document["matrices"]["structural"], 0.02, rtol=1e-9)
    np.savez(
        folder / "a.npz",
        K=K,
        M=M,
        K4=0.02 * K,
        dofs=cf.imported.read_matrices(folder / "part.op4", dofs=folder / "dofs.csv").dofs,
    )
    np.testing.assert_allclose(run(folder, "a.npz", "--contact", "1")["zeta"][6:], 0.01, rtol=1e-9)


@pytest.mark.parametrize(
    ("cord", "cp", "place"),
    [
        (SYSTEM, "", BASIC),
        ("CORD2R,10,0,0.,0.,0.,1.,0.,0.\n,0.,1.,0.", "", BASIC),
        (GRIDS, "", BASIC),
        (SYSTEM, "10", f"{'0.0':>8}{'0.0':>8}{'1.0':>8}"),
        (SYSTEM + "\nGRDSET,,,,,,10", "", BASIC),
    ],
)  # fmt: skip
@pytest.mark.parametrize("files", [("part.op4", "part.pch"), ("part.pch", "part.op4")])
def test_rows_nodes_and_their_axes_are_those_of_the_punch_file(cord, cp, place, files, folder):
    """System 10: z along x, x along y, y along z."""
    cd = "" if "GRDSET" in cord else "10"
    own = OWN
    A, B = (
        (turned(K, own), turned(M, own))
        if "GRDSET" not in cord
        else (turned(turned(K), node=0), turned(turned(M), node=0))
    )
    text = BULK.format(cord=cord, cp=cp, place=place, cd=cd)
    if "GRDSET" in cord:
        text = text.replace("*        0.000000000E+00               0", "*        0.000000000E+00")
    (folder / "part.pch").write_text(text)
    op4(folder, {"KAA": A, "MAA": B})
    document = run(folder, *files)
    whole(document)
    assert document["channels"] == ["1.x", "1.y", "1.z", "2.x", "2.y", "2.z"]


def test_channels_are_along_the_axes_of_the_points(folder):
    """A basis of turned nodes is that of the same part with plain axes, and 2.x is along the beam."""
    dofs = [(n, c) for n in (1, 2) for c in range(1, 7)]
    points = {1: (0.0, 0.0, 0.0), 2: (1.0, 0.0, 0.0)}
    plain = ct.ModalBody.from_matrices(M, K, dofs=dofs, points=points, contact=[2], modes=9)
    own = ct.ModalBody.from_matrices(
        turned(M), turned(K), dofs=dofs, points=points, contact=[2], modes=9, axes={2: OWN}
    )
    np.testing.assert_allclose(own.omega, plain.omega, rtol=1e-7)
    np.testing.assert_allclose(own.S, plain.S, atol=1e-8 * np.abs(plain.S).max())
    for a, b in ((own, plain), (plain, own)):
        elastic = a.rows[:, 6:] / a.omega[6:], b.rows[:, 6:] / b.omega[6:]
        np.testing.assert_allclose(elastic[0] @ elastic[0].T, elastic[1] @ elastic[1].T, rtol=1e-6, atol=1e-15)


def test_axes_that_are_not_given_are_noticed_and_by_hand_they_are_a_table(folder):
    op4(folder, {"KAA": turned(K), "MAA": turned(M)})
    told = run(folder, "part.op4", "--dofs", "dofs.csv", "--nodes", "nodes.csv", code=2)
    assert "K: found 6 rigid modes, but a translation of all nodes causes" in told
    assert "the axes of nodes do not fit K; give the axes of the nodes (a .pch with GRID and CORD cards" in told
    (folder / "nodes.csv").write_text("node,x,y,z,xx,xy,xz,yx,yy,yz\n1,0,0,0,,,,,,\n2,1,0,0,0,1,0,0,0,1\n")
    whole(by_hand(folder))
    (folder / "nodes.csv").write_text("node,x,y,z,xx,xy,xz,yx,yy,yz\n1,0,0,0,,,,,,\n2,1,0,0,0,1,0,0,0.1,1\n")
    told = run(folder, "part.op4", "--dofs", "dofs.csv", "--nodes", "nodes.csv", code=2)
    assert "nodes.csv, line 3: found x along [0.0, 1.0, 0.0] and y along [0.0, 0.1, 1.0]" in told


@pytest.mark.parametrize(("length", "angle", "refused"), [(1.0, 0.0, False), (1e3, 0.0, True), (1.01, 0.0, True),
                                                         (1.0005, 0.0, False), (1.0, 0.02, True)])  # fmt: skip
@pytest.mark.parametrize("scale", ["m-kg-s", "mm-t-s"])
def test_positions_in_another_unit_and_axes_a_degree_off_leave_rigid_motion(length, angle, refused, scale):
    dofs = [(n, c) for n in (1, 2) for c in range(1, 7)]
    unit = 1e3 if scale == "mm-t-s" else 1.0
    T = np.diag(([1.0] * 3 + [unit] * 3) * 2)
    given = {name: T @ A @ T / 1e3 if unit > 1 else A for name, A in (("M", M), ("K", K))}
    c, s = np.cos(angle), np.sin(angle)
    axes = {2: [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]}
    points = {1: (0.0, 0.0, 0.0), 2: (unit * length, 0.0, 0.0)}

    def made():
        return ct.ModalBody.from_matrices(**given, dofs=dofs, points=points, contact=[2], units=scale, axes=axes)

    if refused:
        with pytest.raises(ct.InputError, match="K: found 6 rigid modes, but a"):
            made()
        return
    assert made().omega[6] == pytest.approx(2 * np.pi * 127.935, rel=1e-4)


def test_parts_that_supports_keep_are_not_tested_and_hinges_are(folder):
    """A clamped beam, one on a hinge about z, and one whose hinge is along axes that are not given."""
    dofs = [(n, c) for n in (1, 2) for c in range(1, 7)]
    points = {1: (0.0, 0.0, 0.0), 2: (1.0, 0.0, 0.0)}

    def found(rows, A=K, B=M):
        given = A[np.ix_(rows, rows)], B[np.ix_(rows, rows)]
        own = [dofs[k] for k in rows]
        _, facts = ct.bodies.body_of(ct.bodies.Matrices.of(given[1], given[0], dofs=own, points=points), [2])
        return facts

    clamped = found(list(range(6, 12)))
    assert (clamped.rigid, clamped.rigid_motion) == (
        0,
        "rigid-body motion: tested in part, since the part has supports",
    )
    hinged = found([5, *range(6, 12)])
    assert (hinged.rigid, hinged.rigid_motion) == (1, clamped.rigid_motion)
    wrong = found([5, *range(6, 12)], turned(K), turned(M))
    assert (wrong.rigid, "mechanism, or its axes or units are wrong" in wrong.rigid_motion) == (1, True)


def test_a_mass_in_another_order_of_rows_is_refused():
    dofs = [(n, c) for n in (1, 2) for c in range(1, 7)]
    order = [1, 2, 0, *range(3, 12)]
    with pytest.raises(
        ct.InputError, match=r"M: found the masses .* kg along x, y, z of a free part, expected equal masses"
    ):
        ct.ModalBody.from_matrices(
            M[np.ix_(order, order)], K, dofs=dofs, points={1: (0, 0, 0), 2: (1, 0, 0)}, contact=[2]
        )


def test_what_does_not_fit_in_the_files_is_named(folder):
    op4(folder, {"KAA": K, "MAA": M})
    bulk = BULK.format(cord="", cp="", place=BASIC, cd="")
    for old, new, told in (
        ("2  123456", "2     123", "found K of 12 x 12, M of 12 x 12, and 9 dofs"),
        ("2  123456", "2    1237", "EXTRN: found grid 2 with components '1237', expected such as 123456, or 0"),
        (f"{BASIC}        ", f"{BASIC}      12", "coordinate system 12: found no system 12"),
        ("ASET  ", "GRID,2,,3.,0.,0.\nASET  ", "found grid 2 at two places, expected it once"),
    ):
        assert old in bulk
        (folder / "part.pch").write_text(bulk.replace(old, new))
        assert told in run(folder, "part.op4", "part.pch", code=2)
    (folder / "part.pch").write_text(bulk)
    op4(folder, {"BAA": M, "KAA": K}, name="more.op4")
    assert "more.op4: found the matrix KAA, which another of the files contains too" in run(
        folder, "part.op4", "more.op4", "part.pch", code=2
    )
    assert whole(run(folder, "part.op4", "part.pch"))["size"] == 12


def test_scalar_points_in_the_list_of_rows_are_amplitudes(folder):
    rows = "EXTRN,1,123456,2,123456,901,THRU,902,0\n"
    big = np.zeros((14, 14))
    big[:12, :12], big[12:, 12:] = K, np.diag([1e8, 2e8])
    mass = np.eye(14)
    mass[:12, :12] = M
    (folder / "part.pch").write_text(rows + "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nSPOINT,901,902\n")
    op4(folder, {"KAA": big, "MAA": mass})
    assert whole(run(folder, "part.op4", "part.pch"))["size"] == 14
    assert cf.imported.read_matrices([folder / "part.pch", folder / "part.op4"]).dofs[12:].tolist() == [
        [901, 0],
        [902, 0],
    ]
