"""Someone's matrices piece by piece: units, dofs, rigid motions, loads, modes, damping, and what is told."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct

DOFS = [(1, "x"), (1, "z"), (2, 5), (7, "q")]
M4 = np.diag([2.0, 3.0, 0.5, 4.0])
K4 = np.array([[8.0, -1.0, 0.5, 0.0], [-1.0, 9.0, 0.0, 2.0], [0.5, 0.0, 6.0, 0.25], [0.0, 2.0, 0.25, 7.0]])


def made(M=M4, K=K4, C=None, dofs=DOFS, **more):
    return ct.bodies.Matrices.of(M, K, C, dofs=dofs, **more)


def test_matrices_in_millimetres_tonnes_and_seconds_are_in_si():
    """A rotation times a millimetre is a length: rows and columns of it count a thousandth of others each."""
    found = made(C=0.1 * K4, points={1: (1.0, 2.0, 3.0), 2: (4.0, 5.0, 6.0)}, units="mm-t-s")
    scale = np.outer(s := [1.0, 1.0, 1e-3, 1.0], s)
    np.testing.assert_allclose(found.M.toarray(), 1e3 * scale * M4, rtol=1e-12)
    np.testing.assert_allclose(found.K.toarray(), 1e3 * scale * K4, rtol=1e-12)
    np.testing.assert_allclose(found.C.toarray(), 1e2 * scale * K4, rtol=1e-12)
    assert found.dofs == ((1, "x"), (1, "z"), (2, "ry"), (7, "q"))
    np.testing.assert_allclose(found.points[2], [4e-3, 5e-3, 6e-3], rtol=1e-12)
    assert (found.size, found.skew, made().C) == (4, (0.0, 0.0), None)


def test_rigid_motions_of_dofs_with_and_without_a_place():
    motions = made(points={1: (2.0, 3.0, 5.0)}).rigid_motions()
    assert motions.tolist() == [
        [1, 0, 0, 0, 5, -3],  # w x (2, 3, 5) along x
        [0, 0, 1, 3, -2, 0],  # and along z
        [0, 0, 0, 0, 1, 0],
        [0, 0, 0, 0, 0, 0],
    ]
    assert made().rigid_motions()[:, 3:].tolist() == [[0] * 3, [0] * 3, [0, 1, 0], [0] * 3]


def test_unit_forces_on_nodes_dofs_and_channels_of_ones_own():
    names, P = made().loads([1])
    assert (names, P.tolist()) == (("1.x", "1.z"), np.eye(4)[:, :2].tolist())
    names, P = made().loads([(7, 0), (2, "ry")])
    assert (names, P.tolist()) == (("7.q", "2.ry"), np.eye(4)[:, [3, 2]].tolist())
    names, P = made().loads({"tip": [1.0, 0.0, 0.0, 2.0], "mean": [0.5, 0.5, 0.0, 0.0]})
    assert (names, P.T.tolist()) == (("tip", "mean"), [[1.0, 0.0, 0.0, 2.0], [0.5, 0.5, 0.0, 0.0]])
    for contact, words in (
        ([2], "found node 2"), ([(2, "x")], "found 2.x, which is not a dof"), ([], r"found \[\], expected"),
        ([(1, "x"), 1], "each once"), ({"tip": [1.0]}, "rows of 1 entries, expected 4, one for each dof"),
    ):  # fmt: skip
        with pytest.raises(ct.InputError, match=f"contact: .*{words}"):
            made().loads(contact)


@pytest.mark.parametrize("place", [(1.0, 2.0), (1.0, 2.0, math.nan)])
def test_places_of_nodes_are_three_finite_numbers(place):
    with pytest.raises(ct.InputError, match=r"points: found .* for node 1, expected finite x, y, z"):
        made(points={1: place})


def test_the_first_dof_without_mass_and_stiffness_is_named():
    gone = np.diag([1.0, 0.0, 1.0, 0.0])
    with pytest.raises(ct.InputError, match=r"neither mass nor stiffness at 1\.z, the first of 2 such dofs"):
        made(M=gone, K=gone)
    assert made(M=np.diag([1.0, 0.0, 0.0, 0.0]), K=np.diag([0.0, -1.0, 1.0, 1.0])).size == 4
    coupled = np.eye(4) + np.diag([0.0, 0.0, 0.0, 1.0])
    coupled[0, 3] = coupled[3, 0] = -1.0  # the first column sums to zero and is not empty
    assert made(M=coupled, K=np.diag([0.0, 1.0, 1.0, 1.0])).size == 4


def point_masses(**more):
    """2 kg at (1, 0, 0), 3 kg at (0, 2, 0), 5 kg at (0, 0, 4), each on springs along x, y and z."""
    places = {1: (1.0, 0.0, 0.0), 2: (0.0, 2.0, 0.0), 3: (0.0, 0.0, 4.0)}
    dofs = [(node, axis) for node in places for axis in "xyz"]
    mass = np.repeat([2.0, 3.0, 5.0], 3)
    return ct.bodies.Matrices.of(np.diag(mass), np.diag(mass * np.arange(1.0, 10.0)), dofs=dofs, points=places, **more)


def test_mass_centre_and_inertia_of_point_masses():
    _, facts = ct.bodies.body_of(point_masses(), [1])
    assert facts.mass == pytest.approx((10.0, 10.0, 10.0))
    centre = np.array([0.2, 0.6, 2.0])
    assert facts.centre == pytest.approx(centre)
    about = np.zeros((3, 3))
    for m, x in ((2.0, [1, 0, 0]), (3.0, [0, 2, 0]), (5.0, [0, 0, 4])):
        away = np.array(x) - centre
        about += m * (away @ away * np.eye(3) - np.outer(away, away))
    np.testing.assert_allclose(facts.inertia, about, atol=1e-12)
    assert (facts.massless, facts.rigid, facts.coupling) == (0, 0, None)
    assert (facts.gyroscopic, facts.cross) == (False, False)


def test_the_lines_that_are_reported_of_matrices():
    _, facts = ct.bodies.body_of(point_masses(), [1])
    changed = replace(
        facts, massless=2, rigid=1, skew=(1e-7, 2e-6), coupling=0.25, gyroscopic=True, cross=True, rigid_motion="",
        structural=(0.01, 0.02), structural_coupling=0.5,
    )  # fmt: skip
    text = str(changed).splitlines()
    assert text[0] == "9 unknowns, 2 of them without mass, 1 rigid modes"
    assert text[1] == "mass [kg]: 10 10 10 along x, y, z"
    assert text[2] == "centre [m]: 0.2 0.6 2"
    assert text[3].startswith("inertia about it [kg m^2]: ")
    assert text[4] == "asymmetry of M and K: 1.0e-07, 2.0e-06 of the other entries of their rows"
    assert text[5].startswith("lowest elastic frequencies [Hz]: 0.159155 0.225079 ")
    assert len(text[5].split()) == 4 + 6
    assert text[6] == "damping between modes: up to 0.25 of the damping of these modes, kept in the basis"
    assert text[7] == "gyroscopic matrix: kept in the basis, for each rad/s of the speed"
    assert text[8].startswith("nonsymmetric stiffness: its skew part couples the modes")
    assert text[9].startswith("structural damping: loss factors g from 0.01 to 0.02, ")
    assert text[10] == "structural damping between modes: up to 0.5 of the damping of these modes, neglected"
    assert text[11].startswith("residual compliance: none")
    plain = str(replace(facts, centre=None, residual=0.125)).splitlines()
    assert plain[2] == "inertia: unknown, since positions of nodes are missing or the masses along x, y and z differ"
    assert plain[-1].startswith(
        "residual compliance: included, 12.5 % of the static compliance at the contact; without"
    )
    assert "9 modes" in plain[-1]
    assert not any("damping" in line for line in plain)


def test_outputs_are_truncated_with_the_modes():
    body = ct.ModalBody(
        omega=[2.0, 5.0], zeta=[0.0, 0.0], channels=("x",), rows=[[1.0, 3.0]], S=[[0.5]], outputs=("u", "v"),
        output_rows=[[1.0, 2.0], [0.0, -4.0]], recovery=[[7.0, 5.0]],
    )  # fmt: skip
    short = body.truncated(2.0)
    assert short.output_rows.tolist() == [[1.0], [0.0]]
    np.testing.assert_allclose(short.output_S, [[6.0 / 25.0], [-12.0 / 25.0]], rtol=1e-14)
    assert short.recovery.tolist() == [[7.0]]
    np.testing.assert_allclose(short.recovery_S, [[15.0 / 25.0]], rtol=1e-14)
    again = replace(body, output_S=[[1.0], [2.0]], recovery_S=[[3.0]]).truncated(2.0)
    np.testing.assert_allclose(again.output_S, [[1.0 + 6.0 / 25.0], [2.0 - 12.0 / 25.0]], rtol=1e-14)
    np.testing.assert_allclose(again.recovery_S, [[3.6]], rtol=1e-14)


@pytest.mark.parametrize("clamp", [1e9, 1e13])
def test_a_mode_is_elastic_however_stiff_the_clamp_beside_it_is(clamp):
    spring = (2.0 * np.pi * 27.0) ** 2  # of 1 kg
    K = [[clamp + spring, -spring], [-spring, spring]]
    body = ct.ModalBody.from_matrices(np.eye(2), K, dofs=[(1, "x"), (2, "x")], contact=[(2, "x")])
    np.testing.assert_allclose(body.omega[0], 2.0 * np.pi * 27.0, rtol=1e-4)
    free = [[spring, -spring], [-spring, spring]]
    loose = ct.ModalBody.from_matrices(np.eye(2), free, dofs=[(1, "x"), (2, "x")], contact=[(2, "x")])
    assert loose.omega[0] == 0.0


THREE = {"dofs": [(1, "x"), (2, "x"), (3, "x")], "contact": [(1, "x")]}


def test_damping_of_a_mode_is_its_ratio_below_critical_and_a_matrix_from_there_on():
    """Unit masses on springs of 1, 4 and 9 N/m: critical damping is 2, 4 and 6 N s/m."""
    K, C = np.diag([1.0, 4.0, 9.0]), np.array([[0.02, 0.01, 0.0], [0.01, 3.9, 0.0], [0.0, 0.0, 7.0]])
    body = ct.ModalBody.from_matrices(np.eye(3), K, C, **THREE)
    np.testing.assert_allclose(body.zeta, [0.01, 0.975, 0.0], rtol=1e-12)
    np.testing.assert_allclose(np.abs(body.damping), [[0.0, 0.01, 0.0], [0.01, 0.0, 0.0], [0.0, 0.0, 7.0]], rtol=1e-9)
    critical = ct.ModalBody.from_matrices(np.eye(3), K, np.diag([0.2, 4.0, 0.6]), **THREE)
    np.testing.assert_allclose(critical.zeta, [0.1, 0.0, 0.1], rtol=1e-12)
    np.testing.assert_allclose(critical.damping, np.diag([0.0, 4.0, 0.0]), atol=1e-12)
    plain = ct.ModalBody.from_matrices(np.eye(3), K, np.diag([0.2, 0.4, 0.6]), **THREE)
    assert plain.damping is None
    structural = ct.ModalBody.from_matrices(np.eye(3), K, K4=np.diag([0.02, 0.08, 0.36]), **THREE)
    np.testing.assert_allclose(structural.zeta, [0.01, 0.01, 0.02], rtol=1e-12)
    assert ct.ModalBody.from_matrices(np.eye(3), K, zeta=0.03, **THREE).zeta.tolist() == [0.03] * 3


@pytest.mark.parametrize("name", ["C", "K4"])
def test_damping_below_zero_by_round_off_of_the_largest_is_none_and_more_is_refused(name):
    K = np.diag([1.0, 4.0, 9.0])
    for least, taken in ((-0.9e-6, True), (-1.1e-6, False), (-0.5, False)):
        given = {name: np.diag([0.1, least, 1.0])}
        if taken:
            assert abs(ct.ModalBody.from_matrices(np.eye(3), K, **given, **THREE).zeta[1]) < 1e-6
        else:
            with pytest.raises(ct.InputError, match=f"{name}: found negative damping in mode 2, expected damping that"):
                ct.ModalBody.from_matrices(np.eye(3), K, **given, **THREE)
    none = ct.ModalBody.from_matrices(np.eye(3), K, **{name: np.zeros((3, 3))}, **THREE)
    assert none.zeta.tolist() == [0.0] * 3


def chain(count):
    """Unit masses in a row between springs of 1 N/m, the first on a support."""
    K = 2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    K[-1, -1] = 1.0
    return {"M": np.eye(count), "K": K, "dofs": [(k + 1, "x") for k in range(count)], "contact": [(count, "x")]}


def test_twenty_modes_are_kept_or_all_if_there_are_fewer():
    assert [ct.ModalBody.from_matrices(**chain(count)).omega.size for count in (19, 20, 21, 40)] == [19, 20, 20, 20]
    exact = 2.0 * np.sin((2.0 * np.arange(1, 21) - 1.0) * np.pi / (2.0 * (2 * 40 + 1)))
    np.testing.assert_allclose(ct.ModalBody.from_matrices(**chain(40)).omega, exact, rtol=1e-9)


@pytest.mark.parametrize(("modes", "words"), [(0, "found 0, expected 1 to 3"), (4, "found 4, expected 1 to 3")])
def test_there_are_no_more_modes_than_unknowns(modes, words):
    with pytest.raises(ct.InputError, match=f"modes: {words}, the number of unknowns"):
        ct.ModalBody.from_matrices(**chain(3), modes=modes)


def test_modes_left_out_are_in_the_residual_compliance():
    """Of a chain of springs in series at its end: n/k, in whatever number of modes."""
    for modes in (1, 3, 5):
        body = ct.ModalBody.from_matrices(**chain(5), modes=modes)
        np.testing.assert_allclose((body.rows**2 / body.omega**2).sum() + body.S.item(), 5.0, rtol=1e-12)
        assert (body.S.item() == 0.0) == (modes == 5)


def test_a_free_chain_deflects_relative_to_the_motion_of_its_mass():
    """Inertia relief: u = A^T K^-1 A p with A = I - M r r^T/m, here by the pseudo-inverse of unit masses."""
    given = chain(5)
    K = given["K"].copy()
    K[0, 0] = 1.0
    for modes in (1, 3):
        body = ct.ModalBody.from_matrices(given["M"], K, dofs=given["dofs"], contact=given["contact"], modes=modes)
        assert body.omega[0] == 0.0
        elastic = (body.rows[0, 1:] ** 2 / body.omega[1:] ** 2).sum()
        np.testing.assert_allclose(elastic + body.S.item(), np.linalg.pinv(K)[-1, -1], rtol=1e-9)
        np.testing.assert_allclose(body.rows[0, 0] ** 2, 0.2, rtol=1e-9)


@pytest.mark.parametrize(("part", "taken"), [(0.9e-4, True), (1.1e-4, False), (-1.1e-4, False)])
def test_a_gyroscopic_matrix_is_skew_within_a_ten_thousandth_of_its_largest_entry(part, taken):
    G = np.array([[0.0, 2.0, 0.0], [-2.0 + 2.0 * part, 0.0, 1e-3], [0.0, -1e-3, 0.0]])
    if taken:
        body = ct.ModalBody.from_matrices(**chain(3), G=G)
        np.testing.assert_allclose(body.gyroscopic, -body.gyroscopic.T)
        assert np.abs(body.gyroscopic).max() == pytest.approx(np.linalg.norm(G, 2), rel=0.3)
        return
    with pytest.raises(ct.InputError, match=r"G: found .* at \([01], [01]\) and .* expected a skew-symmetric matrix"):
        ct.ModalBody.from_matrices(**chain(3), G=G)


def test_the_largest_impossible_mass_and_a_repeated_dof_are_named():
    given = chain(4)
    M = np.eye(4)
    M[0, 1] = M[1, 0] = 1.1
    M[2, 3] = M[3, 2] = 1.5
    with pytest.raises(ct.InputError, match=r"M: found 1\.5 between [34]\.x and [34]\.x, more than the diagonal"):
        ct.ModalBody.from_matrices(**{**given, "M": M})
    with pytest.raises(ct.InputError, match=r"M: found -2 on the diagonal at 3\.x, expected a mass matrix without neg"):
        ct.ModalBody.from_matrices(**{**given, "M": np.diag([1.0, -1.0, -2.0, 1.0])})
    with pytest.raises(ct.InputError, match=r"dofs: found 4\.x twice, expected each dof once"):
        ct.ModalBody.from_matrices(**{**given, "dofs": [(1, "x"), (4, "x"), (3, "x"), (4, 1)]})


def test_stiffness_is_symmetric_within_a_ten_thousandth_of_the_largest_entries_of_its_rows():
    """An entry of -1 that differs from its mirror image by a part is off by half of that part of the diagonal's 2."""
    given, K = chain(3), chain(3)["K"]
    K[0, 1] *= 1.0 + 1.9e-4
    report = ct.bodies.body_of(ct.bodies.Matrices.of(M=np.eye(3), K=K, dofs=given["dofs"]), given["contact"])[1]
    assert report.skew == pytest.approx((0.0, 0.95e-4))
    K[0, 1] = -(1.0 + 2.1e-4)
    with pytest.raises(
        ct.InputError, match=r"K: found asymmetry of 1\.05e-04 of its entries, expected a symmetric matrix"
    ):
        ct.ModalBody.from_matrices(**{**given, "K": K})
    assert ct.ModalBody.from_matrices(**{**given, "K": K}, nonsymmetric=True).omega.size == 3
