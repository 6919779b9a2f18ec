"""Speeds at which waves meet modes, and the width of what they disturb, against the formula written out."""

import math

import numpy as np
import pytest

import contact as ct
from contact.model.gaps.permanent import ClosedContact, disk_contact, turning
from contact.stability.coincidence import Coincidence, close_speeds, coincidences, loaded

TURN = 2.0 * math.pi
BOTH = np.array([-150.0, 150.0])  # senses of rotation
PAIR = ct.gaps.HandPair(
    casing=ct.gaps.ModalPair(n=3, freq_hz=310.0, modal_mass=1.7, zeta=3e-3),
    blade=ct.gaps.ModalPair(freq_hz=130.0, modal_mass=0.3, zeta=7e-3), compliance=9e-6, friction=0.4, lean_deg=35.0,
)  # fmt: skip


def meeting(hz, half):
    return Coincidence(n=8, branch="sum", casing_hz=300.0, blade_hz=120.0, free_hz=hz, speed_hz=hz, half_hz=half)


def test_the_loaded_frequencies_and_growth_of_a_pair():
    """sqrt(w^2 + k/m) of the blade, k/(2 m) of a wave; growth as the larger root of x^2 + (a + b) x + a b - s^2."""
    found, k = loaded(PAIR), 1.0 / 9e-6
    w_c, w_b = math.sqrt((TURN * 310.0) ** 2 + k / 3.4), math.sqrt((TURN * 130.0) ** 2 + k / 0.3)
    assert found[:3] == pytest.approx((w_c / TURN, w_b / TURN, (w_c + w_b) / TURN / 3.0), rel=1e-12)
    a, b = 7e-3 * TURN * 130.0, 3e-3 * TURN * 310.0
    assert found.growth == pytest.approx(max(np.roots([1.0, a + b, a * b - k * k / (8.0 * 0.51 * w_b * w_c)])))


@pytest.mark.parametrize("branch", ["sum", "backward"])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_meeting_is_the_quadratic_of_one_wave_and_one_mode(branch, sense):
    """(s - s_c + a/S)(s - s_b + b/S) = a b/S^2, at the speed where the frequencies of s_c - a/S and s_b - b/S agree."""
    met = [c for c in coincidences(PAIR.contact(), BOTH) if c.branch == branch and c.speed_hz * sense > 0.0]
    sign, w_c, w_b = -1.0 if branch == "sum" else 1.0, TURN * 310.0, TURN * 130.0
    n = 3.0 * sense * sign  # +-w_c - n Omega = w_b
    free = (sign * w_c - w_b) / n
    casing = (1.0 + 1j * 0.4 * sense * np.sign(n) / 3.0) / (2.0 * 1.7)
    blade = (1.0 - 0.4 * sense / math.tan(math.radians(35.0))) / 0.3

    def halves(w, zeta, product):
        """Poles with their residues: product/(s^2 + 2 zeta w s + w^2)."""
        damped = w * math.sqrt(1.0 - zeta**2)
        return [(-zeta * w + 1j * own * damped, product / (2j * own * damped)) for own in (sign, -sign)]

    (_, a), (other_c, rest_c) = halves(w_c, 3e-3, casing)
    (_, b), (other_b, rest_b) = ((s, r) for s, r in sorted(halves(w_b, 7e-3, blade), key=lambda part: -part[0].imag))
    own = w_b + free * n  # the frequency of the blade's mode in the casing's frame
    back = 1j * (w_b - free * n)
    S = 9e-6 + (casing.conjugate() / (w_c**2 + 2.0 * 3e-3 * w_c * back + back**2)).real  # the wave the other way round
    S += (rest_c / (1j * own - other_c)).real + (rest_b / (1j * w_b - other_b)).real
    centre = free + (b - a).imag / S / n
    (found,) = met
    assert (found.n, found.casing_hz, found.blade_hz) == (3, pytest.approx(310.0), pytest.approx(130.0))
    assert found.free_hz == pytest.approx(free / TURN, rel=1e-12)
    assert found.speed_hz == pytest.approx(centre / TURN, rel=1e-7)
    assert found.half_hz == pytest.approx(2.0 * math.sqrt(abs(a * b)) / S / 3.0 / TURN, rel=1e-7)


def several(casing_hz, rows):
    """One pair of n = 1, and blade modes of 90, 95, ... Hz seen by these rows, (contacts, modes)."""
    rows = np.atleast_2d(rows)
    m = 2 + rows.shape[1]
    omega = TURN * np.array([casing_hz, casing_hz, *(90.0 + 5.0 * np.arange(m - 2))])
    seen = np.hstack([np.eye(2)[: len(rows)], rows])
    r = len(rows)
    return ClosedContact(omega=omega, zeta=np.zeros(m), G=turning([1], m), Q=seen, T=np.zeros((r, m)),
                         S_nn=1e-4 * np.eye(r), S_nt=np.zeros((r, r)), casing=2)  # fmt: skip


def test_modes_of_a_billionth_of_the_largest_product_are_not_met():
    met = coincidences(several(300.0, [[1.0, 1e-4, 1e-5]]), BOTH)
    assert sorted({round(c.blade_hz, 9) for c in met}) == [90.0, 95.0]
    assert [(c.n, c.branch, round(c.free_hz, 9)) for c in met if c.blade_hz < 91.0] == [
        (1, "sum", -390.0), (1, "backward", -210.0), (1, "backward", 210.0), (1, "sum", 390.0),
    ]  # fmt: skip


def test_equal_frequencies_meet_at_rest_which_is_no_speed():
    for contact in (several(90.0, [[1.0]]), several(90.0, [[1.0], [0.5]])):
        met = coincidences(contact, BOTH)
        assert [(c.branch, round(c.free_hz, 9)) for c in met] == [("sum", -180.0), ("sum", 180.0)]


def test_a_wave_just_above_or_below_the_blade_is_met_at_a_slow_speed():
    for casing_hz, branch in ((90.05, "backward"), (89.95, "forward")):
        for contact in (several(casing_hz, [[1.0]]), several(casing_hz, [[1.0], [0.5]])):
            met = coincidences(contact, BOTH)
            slow = sorted((c.branch, c.free_hz) for c in met if abs(c.free_hz) < 1.0)
            assert slow == [(branch, pytest.approx(-0.05)), (branch, pytest.approx(0.05))]


def test_several_contacts_meet_what_they_see_alike_by_a_twentieth():
    """Waves are seen as (1, +-i)/sqrt 2; a mode seen as (a, i b) could be, a real one is by half of its square."""
    contact = several(300.0, [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]])
    met = coincidences(contact, BOTH)
    assert {round(c.blade_hz, 9) for c in met} == {90.0, 95.0}
    assert [round(c.speed_hz, 9) for c in met if c.blade_hz > 91.0] == [-395.0, -205.0, 205.0, 395.0]
    first = next(c for c in met if c.blade_hz < 91.0 and c.free_hz > 300.0)
    assert (first.n, first.branch, first.casing_hz, first.half_hz) == (1, "sum", pytest.approx(300.0), 0.0)


def test_modes_of_one_frequency_count_once_and_the_disk_only_its_own_diameters():
    casing, disk = (ct.gaps.ModalPair(n=5, freq_hz=hz, modal_mass=2.0) for hz in (300.0, 120.0))
    met = coincidences(disk_contact(casing, disk, stiffness=1e3, blades=22), BOTH)
    assert [(c.branch, round(c.free_hz, 9)) for c in met] == [
        ("sum", -84.0), ("backward", -36.0), ("backward", 36.0), ("sum", 84.0),
    ]  # fmt: skip


def test_a_mode_that_two_contacts_see_unlike_a_wave_is_not_met():
    """A third contact, at which the pair does not move, takes all but 0.04 or 0.06 of a mode's motion."""
    for share, often in ((0.04, 0), (0.06, 4)):
        rows = np.zeros((3, 3))
        rows[0, 0] = rows[1, 1] = 1.0
        rows[:, 2] = [share * math.sqrt(2.0), 0.0, math.sqrt(1.0 - 2.0 * share**2)]
        contact = ClosedContact(
            omega=TURN * np.array([300.0, 300.0, 90.0]), zeta=np.zeros(3), G=turning([2], 3), Q=rows,
            T=np.zeros((3, 3)), S_nn=1e-4 * np.eye(3), S_nt=np.zeros((3, 3)), casing=2,
        )  # fmt: skip
        assert len(coincidences(contact, BOTH)) == often


def test_speeds_close_to_coincidences_are_an_eighth_of_their_band_apart():
    assert close_speeds(()).size == 0
    found = close_speeds((meeting(52.0, 0.5), meeting(60.0, 1.0)))
    assert found.tolist() == [*(51.0 + 0.125 * np.arange(17)), *(58.0 + 0.25 * np.arange(17))]
