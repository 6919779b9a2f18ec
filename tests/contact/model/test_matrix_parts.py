"""Someone's matrices piece by piece: units, dofs, rigid motions, loads, modes, damping, and what is told."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csc_array, diags_array

import contact as ct
from contact.model.bodies.matrices import asymmetry, checked_dof, report_of, symmetric_part
from contact.model.bodies.matrix_modes import (
    elastic_compliance,
    lowest_elastic,
    lowest_modes,
    median_rate,
    modal_damping,
    reduced,
)

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
        ([2], "found node 2"), ([(2, "x")], "found 2.x, which is no dof"), ([], r"found \[\], expected"),
        ([(1, "x"), 1], "each once"), ({"tip": [1.0]}, "rows of 1 entries, expected 4, one a dof"),
    ):  # fmt: skip
        with pytest.raises(ct.InputError, match=f"contact: .*{words}"):
            made().loads(contact)


def test_directions_by_name_and_number():
    assert [checked_dof((3, k)) for k in range(7)] == [(3, d) for d in ("q", "x", "y", "z", "rx", "ry", "rz")]
    for direction in (7, -1, "u"):
        with pytest.raises(ct.InputError, match=f"dofs: found direction {direction!r} at node 3, expected q, x, y"):
            checked_dof((3, direction))
    with pytest.raises(ct.InputError, match=r"dofs: found 1\.z twice, expected each once"):
        made(dofs=[(1, "x"), (1, "z"), (1, 3), (7, "q")])


@pytest.mark.parametrize("place", [(1.0, 2.0), (1.0, 2.0, math.nan)])
def test_places_of_nodes_are_three_finite_numbers(place):
    with pytest.raises(ct.InputError, match=r"points: found .* for node 1, expected x, y, z"):
        made(points={1: place})


def test_the_first_dof_without_mass_and_stiffness_is_named():
    gone = np.diag([1.0, 0.0, 1.0, 0.0])
    with pytest.raises(ct.InputError, match=r"neither mass nor stiffness at 1\.z, the first of 2 such dofs"):
        made(M=gone, K=gone)
    assert made(M=np.diag([1.0, 0.0, 0.0, 0.0]), K=np.diag([0.0, -1.0, 1.0, 1.0])).size == 4


def test_asymmetry_counts_by_the_entries_of_both_rows():
    """|a - b| over the mean of the largest entries of the rows, none below the median of all."""
    A = np.array([[4.0, 1.0, 0.0], [0.5, 9.0, 0.0], [0.0, 0.0, 100.0]])
    assert asymmetry(A) == pytest.approx(0.5 / 9.0, rel=1e-14)  # 4 counts as the median, 9
    assert asymmetry(np.diag([1.0, 2.0, 3.0])) == 0.0
    assert symmetric_part("K", np.array([[1.0, 0.9e-4], [0.0, 1.0]]), 2)[1] == pytest.approx(0.9e-4)
    part, _ = symmetric_part("K", np.array([[1.0, 0.9e-4], [0.0, 1.0]]), 2)
    np.testing.assert_allclose(part.toarray(), [[1.0, 0.45e-4], [0.45e-4, 1.0]], rtol=1e-14)
    with pytest.raises(ct.InputError, match=r"K: found asymmetry of 1\.10e-04 of its entries"):
        symmetric_part("K", np.array([[1.0, 1.1e-4], [0.0, 1.0]]), 2)
    none, skew = symmetric_part("C", np.zeros((2, 2)), 2)
    assert (none.nnz, skew) == (0, 0.0)
    with pytest.raises(ct.InputError, match=r"C: found shape \(2, 2\), expected \(3, 3\), a row for each dof"):
        symmetric_part("C", np.zeros((2, 2)), 3)


def test_the_median_rate_is_that_of_what_has_mass_and_springs():
    matrices = made(M=np.diag([2.0, 0.0, 4.0, 5.0]), K=np.diag([8.0, 99.0, 0.0, 35.0]))
    assert median_rate(matrices) == 5.5  # of 4 and 7


def test_the_lowest_elastic_mode_from_the_seventh_on():
    rigid = np.zeros(6)
    assert lowest_elastic(np.r_[rigid, 3.0, 4.0], 100.0) == 3.0
    assert lowest_elastic(np.r_[rigid, 1e-13, 4.0], 20.0) == 4.0
    assert lowest_elastic(np.r_[rigid, 0.0, 0.0], 20.0) == 0.0
    assert lowest_elastic(np.array([1.0, 2.0, 3.0]), 20.0) == 3.0
    assert lowest_elastic(np.r_[np.arange(6.0), 50.0], 20.0) == 20.0


@pytest.mark.parametrize("dense", [True, False])
def test_modes_are_mass_normalised_and_ascending(dense, monkeypatch):
    n = 30
    K = diags_array([np.full(n - 1, -1.0), np.full(n, 2.0), np.full(n - 1, -1.0)], offsets=[-1, 0, 1])
    mass = 1.0 + 0.1 * np.arange(n)
    matrices = ct.bodies.Matrices.of(np.diag(mass), K, dofs=[(k, "x") for k in range(n)])
    if not dense:
        monkeypatch.setattr("contact.model.bodies.matrix_modes.DENSE", 29)
    lam, phi, rigid = lowest_modes(matrices, 5)
    exact, _ = np.linalg.eigh(K.toarray() / np.sqrt(np.outer(mass, mass)))
    np.testing.assert_allclose(lam, exact[:5], rtol=1e-8)
    np.testing.assert_allclose(phi.T @ np.diag(mass) @ phi, np.eye(5), atol=1e-8)
    np.testing.assert_allclose(phi.T @ K.toarray() @ phi, np.diag(lam), atol=1e-8)
    assert rigid == 0


def test_compliance_of_a_free_body_is_that_of_its_elastic_modes():
    mass = np.array([1.0, 2.0, 4.0])
    K = np.array([[3.0, -3.0, 0.0], [-3.0, 8.0, -5.0], [0.0, -5.0, 5.0]])
    matrices, P = ct.bodies.Matrices.of(np.diag(mass), K, dofs=[(k, "x") for k in range(3)]), np.eye(3)[:, [0, 2]]
    R = np.full((3, 1), 1.0 / math.sqrt(7.0))
    root = np.sqrt(mass)
    lam, X = np.linalg.eigh(K / np.outer(root, root))
    phi = (X / root[:, None])[:, 1:]
    np.testing.assert_allclose(elastic_compliance(matrices, P, R), (phi / lam[1:]) @ phi.T @ P, atol=1e-12)


def damping(C, omega=(0.0, 2.0, 4.0), phi=None):
    matrices = replace(made(), C=None if C is None else csc_array(np.asarray(C)))
    return modal_damping(matrices, np.eye(len(omega)) if phi is None else phi, np.array(omega), 0.05)


def test_ratios_couplings_and_rigid_modes_of_a_damping_matrix():
    ratio, rest, coupling = damping([[0.3, 0.0, 0.0], [0.0, 0.8, 0.2], [0.0, 0.2, 1.6]])
    np.testing.assert_allclose(ratio, [0.0, 0.2, 0.2], rtol=1e-14)
    assert coupling == pytest.approx(0.2 / math.sqrt(0.8 * 1.6), rel=1e-14)
    assert rest.tolist() == [[0.3, 0.0, 0.0], [0.0, 0.0, 0.2], [0.0, 0.2, 0.0]]
    assert damping(None)[0].tolist() == [0.05] * 3
    assert damping(None)[1:] == (None, None)
    _, rest, coupling = damping([[0.0, 0.5, 0.0], [0.5, 0.8, 0.0], [0.0, 0.0, 1.6]])
    assert coupling == 0.0  # what is coupled to nothing of its own has no measure
    assert rest[0].tolist() == [0.0, 0.5, 0.0]
    assert damping([[1e-10, 0.0, 0.0], [0.0, 0.8, 1e-10], [0.0, 0.0, 1.6]])[1] is None  # round-off


def test_damping_that_drives_is_refused_and_more_than_critical_is_kept_as_a_matrix():
    damping(np.diag([0.0, -0.9e-6, 1.0]))
    with pytest.raises(ct.InputError, match="C: found negative damping in mode 2, expected one that takes energy"):
        damping(np.diag([0.0, -1.1e-6, 1.0]))
    assert damping(np.diag([0.0, 3.99, 1.0]))[0][1] == pytest.approx(0.9975)
    ratio, rest, _ = damping(np.diag([0.0, 4.0, 1.0]))
    assert (ratio[1], rest[1, 1], rest[2, 2]) == (0.0, 4.0, 0.0)


def test_a_body_of_all_its_modes_or_of_twenty():
    body, facts = reduced(made(), [1])
    assert body["omega"].size == facts.kept == facts.size == 4
    assert not body["S"].any()
    assert facts.residual == 0.0
    n = 24
    many = ct.bodies.Matrices.of(np.eye(n), np.diag(np.arange(1.0, n + 1)), dofs=[(k, "x") for k in range(n)])
    given = {f"u{k}": np.eye(n)[k] for k in (0, 21)}
    body, facts = reduced(many, given)
    assert body["omega"].size == 20
    np.testing.assert_allclose(body["S"], np.diag([0.0, 1.0 / 22.0]), atol=1e-12)
    assert facts.residual == pytest.approx((1.0 / 22.0) / (1.0 + 1.0 / 22.0))
    assert body["zeta"].tolist() == [0.0] * 20
    np.testing.assert_allclose(facts.freq_hz, np.sqrt(np.arange(1.0, 7.0)) / (2.0 * math.pi), rtol=1e-9)
    assert reduced(many, given, modes=1)[0]["omega"].size == 1
    for modes in (0, 25):
        with pytest.raises(ct.InputError, match=f"modes: found {modes}, expected 1 to the 24 unknowns"):
            reduced(many, given, modes=modes)


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


def test_the_lines_that_are_told_of_matrices():
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
    assert text[4] == "asymmetry of M and K: 1.0e-07, 2.0e-06 of the entries in the same rows"
    assert text[5].startswith("lowest elastic frequencies [Hz]: 0.159155 0.225079 ")
    assert len(text[5].split()) == 4 + 6
    assert text[6] == "damping between modes: up to 0.25 of their own, kept in the basis"
    assert text[7] == "gyroscopic matrix: kept between the modes, by the speed"
    assert text[8].startswith("nonsymmetric stiffness: its skew part is kept between the modes, not in the residual")
    assert text[9].startswith("structural damping: g from 0.01 to 0.02, ")
    assert text[10] == "structural damping between modes: up to 0.5 of their own, left out"
    assert text[11].startswith("residual compliance: none")
    plain = str(replace(facts, centre=None, residual=0.125)).splitlines()
    assert plain[2] == "inertia: not known without the positions of the nodes, or with masses that differ"
    assert plain[-1].startswith("residual compliance: present, 12.5 % of the static compliance at the contact; without")
    assert "the 9 modes" in plain[-1]
    assert not any("damping" in line for line in plain)


def test_inertia_is_not_known_without_every_place_or_a_mass_along_every_axis():
    some = ct.bodies.Matrices.of(np.eye(2), np.eye(2), dofs=[(1, "x"), (2, "x")], points={1: (0.0, 0.0, 0.0)})
    assert report_of(some, np.ones(2), 0, 2, 0.0, None).centre is None
    along = ct.bodies.Matrices.of(np.eye(1), np.eye(1), dofs=[(1, "x")], points={1: (0.0, 0.0, 0.0)})
    assert report_of(along, np.ones(1), 0, 1, 0.0, None).inertia is None


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
