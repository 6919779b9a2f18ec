"""Poles of closed contact, maps of growth and the mean of split pairs, by small systems written out."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.model.gaps.permanent import ClosedContact, disk_contact, equal_modes, rub_contact, turning
from contact.stability.closed_contact import closed_poles, first_order, floor_of, growth, poles_each
from contact.stability.growth_map import scan
from contact.stability.split_casing import mean_contact
from contact.stability.waves import waves_of
from tests.contact.synthetic_rim import blade, ring

PAIR = ct.gaps.HandPair(
    casing=ct.gaps.ModalPair(n=3, freq_hz=310.0, modal_mass=1.7, zeta=3e-3),
    blade=ct.gaps.ModalPair(freq_hz=130.0, modal_mass=0.3, zeta=7e-3), compliance=9e-6, friction=0.4, lean_deg=35.0,
)  # fmt: skip
TURN = 2.0 * math.pi


def test_a_pair_by_hand_as_a_closed_contact():
    contact, slip = PAIR.contact(), 1.0 / math.tan(math.radians(35.0))
    x, y = 1.0 / math.sqrt(1.7), 1.0 / math.sqrt(0.3)
    assert PAIR.slip == pytest.approx(slip, rel=1e-14)
    assert PAIR.kappa == pytest.approx((1.0 - 0.4 * slip) / 0.3, rel=1e-14)
    assert replace(PAIR, lean_deg=0.0).slip == 0.0
    np.testing.assert_allclose(contact.omega, TURN * np.array([310.0, 310.0, 130.0]), rtol=1e-14)
    assert contact.zeta.tolist() == [3e-3, 3e-3, 7e-3]
    np.testing.assert_allclose(contact.Q, [[x, 0.0, -y]], rtol=1e-14)
    np.testing.assert_allclose(contact.T, [[0.0, x / 3.0, -y * slip]], rtol=1e-14)
    assert contact.G.tolist() == [[0, 3, 0], [-3, 0, 0], [0, 0, 0]]
    assert (contact.S_nn.tolist(), contact.S_nt.tolist()) == ([[9e-6]], [[0.0]])
    assert (contact.casing, contact.mu) == (2, 0.4)
    plain = ct.gaps.HandPair(
        casing=ct.gaps.ModalPair(n=1, freq_hz=1.0, modal_mass=1.0),
        blade=ct.gaps.ModalPair(freq_hz=1.0, modal_mass=1.0),
        compliance=1.0,
    )
    assert (plain.friction, plain.lean_deg, plain.kappa) == (0.0, 0.0, 1.0)
    for change in ({"compliance": 0.0}, {"friction": -0.1}, {"lean_deg": math.nan}):
        with pytest.raises(ct.InputError, match=f"{next(iter(change))}: found"):
            replace(PAIR, **change)


@pytest.mark.parametrize(
    ("change", "words"),
    [({"freq_hz": 0.0}, "freq_hz: found 0.0"), ({"modal_mass": -1.0}, "modal_mass: found"),
     ({"zeta": 1.0}, "zeta: found 1.0, expected 0 <= zeta < 1"), ({"zeta": -0.1}, "zeta: found -0.1")],
)  # fmt: skip
def test_pairs_that_cannot_be_are_refused(change, words):
    with pytest.raises(ct.InputError, match=words):
        ct.gaps.ModalPair(**{"freq_hz": 1.0, "modal_mass": 1.0} | change)
    assert (ct.gaps.ModalPair(freq_hz=1.0, modal_mass=1.0).n, ct.gaps.ModalPair(freq_hz=1.0, modal_mass=1.0).zeta) == (
        0,
        0.0,
    )


def test_a_disk_in_its_casing_as_two_contacts():
    casing = ct.gaps.ModalPair(n=2, freq_hz=300.0, modal_mass=4.0, zeta=0.01)
    disk = ct.gaps.ModalPair(n=2, freq_hz=120.0, modal_mass=0.25, zeta=0.03)
    found = disk_contact(casing, disk, stiffness=50.0, blades=5)
    np.testing.assert_allclose(found.omega, TURN * np.array([300.0, 300.0, 120.0, 120.0]), rtol=1e-14)
    assert found.zeta.tolist() == [0.01, 0.01, 0.03, 0.03]
    assert found.Q.tolist() == [[0.5, 0.0, -2.0, 0.0], [0.0, 0.5, 0.0, -2.0]]
    assert not found.T.any()
    np.testing.assert_allclose(found.S_nn, np.eye(2) / 125.0, rtol=1e-14)
    assert not found.S_nt.any()
    assert found.G.tolist() == [[0, 2, 0, 0], [-2, 0, 0, 0], [0] * 4, [0] * 4]
    assert (found.casing, found.mu) == (2, 0.0)
    assert turning([1, 4], 5).tolist() == [
        [0, 1, 0, 0, 0],
        [-1, 0, 0, 0, 0],
        [0, 0, 0, 4, 0],
        [0, 0, -4, 0, 0],
        [0] * 5,
    ]


def written_out(contact, hz):
    """Eigenvalues of (D + Omega G)^2 + 2 zeta omega (D + Omega G) + omega^2 + W^T S^-1 Q in first order of q, q'."""
    sense, spin, m = np.sign(hz), TURN * hz * contact.G, contact.omega.size
    W, S = contact.Q - contact.mu * sense * contact.T, contact.S_nn - contact.mu * sense * contact.S_nt
    lost = np.diag(2.0 * contact.zeta * contact.omega)
    K = spin @ spin + lost @ spin + np.diag(contact.omega**2) + W.T @ np.linalg.inv(S) @ contact.Q
    return np.linalg.eigvals(np.block([[np.zeros((m, m)), np.eye(m)], [-K, -(2.0 * spin + lost)]]))


@pytest.mark.parametrize("make", [PAIR.contact, lambda: rub_contact(two_blades(), mu=0.3)], ids=["pair", "rub"])
def test_poles_are_eigenvalues_at_either_sense(make):
    contact = replace(make(), S_nt=0.3 * make().S_nn)
    speeds = np.array([-80.0, 0.0, 60.0])
    found = ct.stability.poles(contact, speeds)
    for hz, every in zip(speeds, found, strict=True):
        expected = written_out(contact, hz)
        size = np.abs(expected).max()
        distance = np.abs(every[:, None] - expected)
        assert max(distance.min(axis=0).max(), distance.min(axis=1).max()) < 1e-7 * size
        assert growth(contact, hz) == pytest.approx([expected.real.max()], abs=1e-9 * size)
        closed = first_order(contact, TURN * hz).closed()
        assert np.sort(np.linalg.eigvals(closed).imag) == pytest.approx(np.sort(expected.imag), abs=1e-7 * size)
    assert floor_of(contact) == pytest.approx(1e-8 * contact.omega.max(), rel=1e-14)


def test_poles_of_many_speeds_come_in_batches(monkeypatch):
    speeds = np.linspace(-50.0, 90.0, 7)
    whole = ct.stability.poles(PAIR.contact(), speeds)
    monkeypatch.setattr("contact.stability.closed_contact.BATCH", 2 * 36)
    np.testing.assert_array_equal(ct.stability.poles(PAIR.contact(), speeds), whole)
    monkeypatch.setattr("contact.stability.closed_contact.BATCH", 1)
    np.testing.assert_array_equal(ct.stability.poles(PAIR.contact(), speeds), whole)


def two_blades():
    tips = [ct.ContactPoint(blade=k, angle_deg=180.0 * k, lean_deg=10.0) for k in range(2)]
    return ct.Rub(ring(), (blade(), blade(psi=0.8)), tips, clearance=-1e-5)


def test_thirty_modes_or_more_of_one_contact_go_by_the_equation(monkeypatch):
    used = []
    monkeypatch.setattr("contact.stability.closed_contact.closed_poles", lambda *_: used.append(1))
    for m, often in ((29, 0), (30, 1)):
        contact = ClosedContact(omega=np.arange(1.0, m + 1.0), zeta=np.zeros(m), G=np.zeros((m, m)), Q=np.ones((1, m)),
                                T=np.zeros((1, m)), S_nn=[[1.0]], S_nt=[[0.0]], casing=0)  # fmt: skip
        used.clear()
        assert len(poles_each(contact, np.array([5.0]))) == 1
        assert len(used) == often


def alone(omega, rows, zeta=0.0):
    """A pair of n = 2 and modes that stand, each seen by its entry in `rows`."""
    m = len(omega)
    return ClosedContact(omega=omega, zeta=np.full(m, zeta), G=turning([2], m), Q=[rows], T=np.zeros((1, m)),
                         S_nn=[[0.25]], S_nt=[[0.0]], casing=2)  # fmt: skip


def test_a_rigid_mode_has_two_poles_that_are_one_and_goes_by_eigenvalues():
    contact = alone([3.0, 3.0, 0.0], [1.0, 0.0, 1.0])
    assert closed_poles(waves_of(contact), 0.25, 1.0) is None
    assert closed_poles(waves_of(replace(contact, omega=[3.0, 3.0, 1.0])), 0.25, 1.0) is not None


def test_modes_that_contact_does_not_see_keep_their_poles():
    """s = -zeta omega -+ i n Omega +- i omega sqrt(1 - zeta^2); two others by the polynomial of the equation."""
    contact = alone([3.0, 3.0, 7.0], [0.0, 0.0, math.sqrt(1.5)], zeta=0.1)
    found = closed_poles(waves_of(contact), 0.25, 0.5)
    free = [-0.3 + 1j * (turn + sign * 3.0 * math.sqrt(0.99)) for turn in (1.0, -1.0) for sign in (1.0, -1.0)]
    assert np.sort_complex(found[2:].round(9)) == pytest.approx(np.sort_complex(np.round(free, 9)), rel=1e-8)
    met = np.roots([0.25, 0.25 * 1.4, 0.25 * 49.0 + 1.5])  # S (s^2 + 2 zeta w s + w^2) + r
    assert np.sort_complex(found[:2]) == pytest.approx(np.sort_complex(met), rel=1e-12)


def peak(at):
    return 4.0 - (at - 3.2) ** 2


def test_a_map_refines_its_peak_and_the_edges_of_its_band():
    found = scan(peak, np.arange(0.0, 8.0), floor=3.0)
    assert (found.peak_speed_hz, found.peak_growth) == pytest.approx((3.2, 4.0), abs=1e-7)
    assert np.array(found.bands_hz) == pytest.approx(np.array([[2.2, 4.2]]), abs=1e-9)
    assert found.diverges
    np.testing.assert_array_equal(found.growth, peak(np.arange(8.0)))
    assert found.speed_hz.tolist() == list(range(8))
    assert found.seen_hz.size == 9
    np.testing.assert_allclose(found.seen_growth, peak(found.seen_hz), rtol=1e-12)
    assert np.all(np.diff(found.seen_hz) > 0.0)


def test_a_map_that_stays_at_its_floor_is_not_refined():
    found = scan(peak, np.arange(0.0, 8.0), floor=peak(3.0))
    assert (found.peak_speed_hz, found.peak_growth, found.bands_hz) == (3.0, peak(3.0), ())
    assert found.seen_hz.size == 8
    assert not found.diverges


def test_bands_that_reach_the_ends_of_a_range_are_cut_there():
    for speed, bands in (
        ([3.0, 3.5, 6.0], [(3.0, 4.2)]), ([0.0, 3.0, 4.0], [(2.2, 4.0)]), ([3.0, 4.0], [(3.0, 4.0)]), ([0.0, 1.0], []),
    ):  # fmt: skip
        found = scan(peak, np.array(speed), floor=3.0)
        assert [tuple(band) for band in found.bands_hz] == [pytest.approx(band, abs=1e-9) for band in bands]
    first, last = scan(peak, np.array([3.5, 6.0, 7.0]), floor=-99.0), scan(peak, np.array([0.0, 1.0, 3.0]), floor=-99.0)
    assert (first.peak_speed_hz, first.peak_growth) == (3.5, peak(3.5))  # of the range: it falls from there
    assert (last.peak_speed_hz, last.peak_growth) == (3.0, peak(3.0))


def test_speeds_to_look_at_count_inside_the_range_alone():
    found = scan(peak, np.array([0.0, 1.0]), floor=9.0, seeds=np.array([-1.0, 0.0, 0.5, 1.0, 2.0]))
    assert found.seen_hz.tolist() == [0.0, 0.5, 1.0]
    assert found.growth.tolist() == [peak(0.0), peak(1.0)]


def test_a_map_as_a_table_a_document_and_words():
    found = ct.stability.StabilityMap(speed_hz=np.array([1.0, 2.0]), growth=np.array([0.5, -1.0]), peak_speed_hz=1.5,
                         peak_growth=0.75, bands_hz=((1.0, 1.75),))  # fmt: skip
    assert found.columns() == {
        "speed_hz": [1.0, 2.0], "growth_1_s": [0.5, -1.0],
    }  # fmt: skip
    assert found.to_dict() == {
        "speed_hz": [1.0, 2.0], "growth": [0.5, -1.0], "peak": {"speed_hz": 1.5, "growth": 0.75},
        "bands_hz": [[1.0, 1.75]], "words": "",
    }  # fmt: skip
    assert repr(found) == "largest growth 0.75 1/s at 1.5 Hz\ndiverges from 1 to 1.75 Hz"
    still = replace(found, bands_hz=(), words="So.")
    assert repr(still) == "largest growth 0.75 1/s at 1.5 Hz\nno growth from 1 to 2 Hz\nSo."
    assert (found.seen_hz.size, found.seen_growth.size) == (0, 0)


def test_a_rim_without_friction_is_a_perfect_contact_where_nothing_is_said():
    rim = ct.RotatingRim(ring(), blade(), clearance=-1e-5, speed_hz=5.0, lean_deg=10.0)
    speeds = np.array([5.0, 60.0])
    np.testing.assert_array_equal(ct.stability.of_rim(rim, speeds).growth, growth(rub_contact(rim, mu=0.0), speeds))
    assert mean_contact(rim)[0].mu == 0.0
    assert not mean_contact(rim)[1]


@pytest.mark.parametrize("blade_hz", [100.0, 1500.0])
def test_a_band_of_a_split_casing_begins_at_1e_8_of_the_highest_frequency_of_both(blade_hz, monkeypatch):
    monkeypatch.setattr(
        "contact.stability.split_casing.floquet_growth", lambda _, speed, mu: 1e-5 * mu * (speed - 50.0)
    )
    casing, tip = ring(imperfect=0.01), blade()
    tip = replace(tip, omega=[TURN * 0.5 * blade_hz, TURN * blade_hz])
    rim = ct.RotatingRim(casing, tip, clearance=-1e-5, speed_hz=5.0)
    found = ct.stability.of_rim(rim, [0.0, 100.0], mu=0.5)
    floor = 1e-8 * max(casing.omega.max(), TURN * blade_hz)
    assert np.array(found.bands_hz) == pytest.approx(np.array([[50.0 + floor / 0.5e-5, 100.0]]), abs=1e-6)
    assert found.words.startswith(f"Closed contact is unstable from {found.bands_hz[0][0]:.5g} to 100 Hz")
    assert "by Floquet's theory" in found.words


def test_groups_of_equal_modes_stand_by_frequency():
    groups = equal_modes(np.array([5.0, 1.0, 5.0, 3.0, 1.0]), np.zeros(5))
    assert [group.tolist() for group in groups] == [[1, 4], [3], [0, 2]]
    assert equal_modes(np.zeros(0), np.zeros(0)) == []


def split(pairs, n_max):
    """A rim of modes given by their radial and tangential waves: (omega, zeta, {row: value})."""
    size = 2 * n_max + 1
    rows = np.zeros((2 * size, len(pairs)))
    for i, (_, _, entries) in enumerate(pairs):
        for row, value in entries.items():
            rows[row, i] = value
    return ct.ModalBody(
        omega=[p[0] for p in pairs], zeta=[p[1] for p in pairs], channels=ct.bodies.rim_channels(n_max), rows=rows,
        S=np.zeros((2 * size, 2 * size)), kind="rim", n_max=n_max, radius=1.0,
    )  # fmt: skip


def test_the_mean_of_a_pair_moves_by_the_mean_of_both_amplitudes():
    """n = 2 of 2: radial cos 4, tangential sin 1 of one; radial sin 2, tangential cos -2 of the other."""
    body = split([(3.0, 0.1, {2: 4.0, 9: 1.0}), (5.0, 0.3, {4: 2.0, 7: -2.0})], 2)
    mean = ct.stability.perfect_mean(body)
    assert (mean.omega.tolist(), mean.zeta.tolist()) == ([4.0, 4.0], [0.2, 0.2])
    expected = np.zeros((10, 2))
    expected[[2, 9], 0], expected[[4, 7], 1] = [3.0, 1.5], [3.0, -1.5]
    np.testing.assert_allclose(mean.rows, expected, atol=1e-14)


def test_modes_belong_to_the_waves_they_have_most_of_and_stand_by_frequency():
    """Breathing of 7 rad/s keeps its own wave alone; of three modes of n = 1 the last is left to the compliance."""
    body = split([
        (7.0, 0.1, {0: 3.0, 1: 0.5, 3: 0.25}), (2.0, 0.0, {1: 2.0, 0: 0.5}), (4.0, 0.0, {2: 2.0}), (9.0, 0.0, {1: 6.0}),
    ], 1)  # fmt: skip
    mean = ct.stability.perfect_mean(body)
    assert mean.omega.tolist() == [3.0, 3.0, 7.0]
    assert mean.zeta.tolist() == [0.0, 0.0, 0.1]
    np.testing.assert_allclose(mean.rows[:, 2], [3.0, 0, 0, 0.25, 0, 0], atol=1e-14)
    np.testing.assert_allclose(mean.rows[:3, :2], [[0, 0], [2, 0], [0, 2]], atol=1e-14)
    gone = 36.0 / 81.0 / 2.0  # of cos theta, shared with sin theta by turning
    np.testing.assert_allclose(mean.S[:3, :3], np.diag([0.0, gone, gone]), atol=1e-14)
    assert not mean.S[3:].any()
