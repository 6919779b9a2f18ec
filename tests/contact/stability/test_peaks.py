"""Peaks of the growth of closed contact: where formulas put them, which motion grows, one peak for one motion."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import find_peaks

import contact as ct
from tests.contact.stability.rates import growth
from tests.contact.synthetic_rim import blade, ring

PAIR = ct.gaps.HandPair(
    casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4),
    compliance=1e-4,
)
RANGE = np.linspace(20.0, 60.0, 41)


def rim(casing=None, **more):
    return ct.RotatingRim(casing or ring(), blade(), **({"clearance": 0.0, "speed_hz": 5.0, "lean_deg": 10.0} | more))


@pytest.mark.parametrize(
    ("casing_hz", "blade_hz", "free_hz", "wave"), [(300.0, 120.0, 22.5, "with"), (120.0, 300.0, 22.5, "against")]
)
def test_a_blade_that_digs_in_grows_with_the_wave_of_the_difference_condition(casing_hz, blade_hz, free_hz, wave):
    """mu > tan(lean): f_b = f_c - n f by the wave ahead of the blade, f_b = f_c + n f by that against it."""
    casing, blade_ = replace(PAIR.casing, freq_hz=casing_hz), replace(PAIR.blade, freq_hz=blade_hz)
    pair = replace(PAIR, casing=casing, blade=blade_, friction=0.3, lean_deg=10.0)
    peak = max(ct.stability.peaks(pair, np.linspace(18.0, 27.0, 41)).rows, key=lambda row: row.growth)
    assert peak.speed_hz == pytest.approx(free_hz, rel=0.02)
    assert (peak.n, peak.wave) == (8, wave)


@pytest.mark.parametrize("hz", [22.84, 52.84])
def test_the_motion_of_a_peak_is_the_eigenvector_of_its_pole(hz):
    """Energy shares from dense eigenvectors in the frame of the casing's cosine and sine."""
    pair = replace(PAIR, friction=0.3 if hz < 40.0 else 0.0, lean_deg=10.0 if hz < 40.0 else 0.0)
    peak = min(ct.stability.peaks(pair, RANGE).rows, key=lambda row: abs(row.speed_hz - hz))
    contact = pair.contact()
    turn = 2.0 * np.pi * peak.speed_hz * contact.G
    W, S = contact.Q - contact.mu * contact.T, contact.S_nn
    D = np.block([[np.zeros((3, 3)), np.eye(3)], [-np.diag(contact.omega**2) - W.T @ contact.Q / S, np.zeros((3, 3))]])
    D[:3, :3] -= turn
    D[3:, 3:] -= turn
    values, vectors = np.linalg.eig(D)
    k = int(values.real.argmax())
    assert values[k].real == pytest.approx(peak.growth, rel=1e-4)
    q, v = vectors[:3, k], vectors[3:, k]
    energy = np.abs(contact.omega * q) ** 2 + np.abs(v) ** 2
    assert peak.casing_share == pytest.approx(energy[:2].sum() / energy.sum(), rel=1e-3)


@pytest.mark.slow
def test_peaks_are_the_local_maxima_of_the_growth_on_a_fine_grid():
    found = ct.stability.peaks(rim(), np.linspace(2.0, 60.0, 59), mu=0.3)
    fine = np.linspace(2.0, 60.0, 2001)
    values = growth(ct.gaps.rim_contact(rim(), mu=0.3), fine)
    padded = np.pad(values, 1)
    highest = (values > padded[:-2]) & (values > padded[2:]) & (values > 0.0)
    assert len(found.rows) >= 3
    for row in found.rows:
        assert abs(fine[highest] - row.speed_hz).min() < 0.05
        assert row.from_hz <= row.speed_hz <= row.to_hz
        near = np.abs(fine - row.speed_hz) < 0.03
        assert row.growth >= values[near].max() * (1.0 - 1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mu", "lean_deg", "start"),
    [(0.5, 45.0, 20.0), (0.3, -45.0, 20.0), (0.3, -45.0, 45.0), (0.0, -60.0, 20.0), (0.0, -60.0, 70.0),
     (0.2, 45.0, 20.0), (0.3, -20.0, 20.0), (0.3, -20.0, 45.0), (0.2, 60.0, 20.0), (0.3, 60.0, 20.0)],
)  # fmt: skip
def test_peaks_rise_by_a_tenth_above_what_separates_them_from_higher_ones(mu, lean_deg, start):
    """Prominence by scipy, of the growth at all examined speeds; here no two peaks are of one motion."""
    found = ct.stability.peaks(rim(lean_deg=lean_deg), np.linspace(start, 200.0, 91), mu=mu)
    speed, values = found.map.seen_hz, found.map.seen_growth
    padded = np.pad(values, 1, constant_values=min(values.min(), 0.0) - 1.0)
    places, known = find_peaks(padded, prominence=0.0)
    prominent = (padded[places] > 1e-6) & (known["prominences"] >= 0.1 * padded[places])
    k = places[prominent] - 1
    low, high = speed[np.maximum(k - 1, 0)], speed[np.minimum(k + 1, speed.size - 1)]
    assert len(found.rows) == k.size > 1
    for row, below, above in zip(found.rows, low, high, strict=True):
        assert below <= row.speed_hz <= above


@pytest.mark.parametrize("blades", [2, 3])
@pytest.mark.slow
def test_a_peak_of_several_contacts_is_found_between_the_speeds_of_a_coarse_grid(blades):
    """Speeds 24 turns/s apart, a peak of 0.2 or 0.3 1/s; without contact f_c + f_b = f at 154.8 or 153.6 turns/s.

    Two blades push the wave before themselves at 100 turns/s and above, in line; three of equal distance do not.
    """
    disk = ct.gaps.BladedDisk(
        blades=blades, freq_hz=50.0, modal_mass=0.4, coupling=0.05, compliance=3e-3, lean_deg=30.0
    )  # fmt: skip
    casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=1, freq_hz=100.0, modal_mass=1.5, zeta=1e-5), radius=0.5)
    what = ct.Rub(casing, (disk.body(),), disk.tips(), clearance=0.0, speed=ct.Speed.constant(30.0))
    (*pushed, coarse), (fine,) = (
        ct.stability.peaks(what, speeds).rows for speeds in (np.linspace(5.0, 170.0, 8), np.linspace(153.0, 156.0, 81))
    )
    assert len(pushed) == (blades == 2)
    for row in pushed:
        (near,) = ct.stability.peaks(what, np.linspace(99.9, row.to_hz + 1.0, 401)).rows
        assert (row.growth, row.from_hz, row.to_hz) == pytest.approx((near.growth, near.from_hz, near.to_hz), rel=1e-6)
        assert row.freq_hz == pytest.approx(0.0, abs=1e-6)
    assert coarse.speed_hz == pytest.approx(fine.speed_hz, abs=0.02)
    assert coarse.growth == pytest.approx(fine.growth, rel=1e-4)


@pytest.mark.parametrize("zeta", [0.0, 2e-4])
def test_a_blade_that_is_faster_than_a_wave_pushes_it_before_itself(zeta):
    """Half a wave 1/(4 m w_c) on the compliance of all else, S: growth |a|/S less its damping, above f_c/n."""
    casing = ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5, zeta=zeta)
    blade = ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4)
    w, m = casing.omega, casing.modal_mass
    S = 1e-4 + 1.0 / (blade.modal_mass * blade.omega**2) + 1.0 / (4.0 * m * w**2)
    pushed = 1.0 / (4.0 * m * w) / S
    growth = pushed - zeta * w
    half = np.sqrt(pushed**2 - (zeta * w) ** 2) / (2.0 * np.pi * 8)
    (row,) = ct.stability.peaks(
        ct.gaps.HandPair(casing=casing, blade=blade, compliance=1e-4), np.linspace(20.0, 40.0, 3)
    ).rows
    assert row.growth == pytest.approx(growth, rel=1e-4)
    assert row.freq_hz == pytest.approx(0.0, abs=1e-6)
    assert row.to_hz - row.from_hz == pytest.approx(2.0 * half, rel=1e-3)
    assert 0.5 * (row.from_hz + row.to_hz) == pytest.approx(37.5 + pushed / (2.0 * np.pi * 8), abs=1e-5)


def test_a_split_pair_of_one_n_gives_one_peak():
    split = ring(imperfect=1e-3)
    found = ct.stability.peaks(rim(split), np.linspace(50.0, 70.0, 81), mu=0.0)
    perfect = ct.stability.peaks(rim(), np.linspace(50.0, 70.0, 81), mu=0.0)
    assert found.averaged
    assert not perfect.averaged
    assert [row.n for row in found.rows] == [row.n for row in perfect.rows]


def test_two_maxima_of_one_motion_in_one_band_are_one_peak():
    """With friction the backward wave of n = 2 grows from 2 to 30 turns/s, most at 28, and again at 11."""
    what = ct.RotatingRim(
        ring(zeta=5e-4), blade(psi=0.5, S=2e-5, zeta=5e-4), clearance=0.0, speed_hz=5.0, lean_deg=10.0
    )  # fmt: skip
    found = ct.stability.peaks(what, np.linspace(2.0, 40.0, 77), mu=0.3)
    (one,) = (row for row in found.rows if (row.n, row.wave) == (2, "against"))
    inside = (found.map.speed_hz > 9.0) & (found.map.speed_hz < 14.0)
    growth = found.map.growth[inside]
    assert growth.argmax() not in (0, len(growth) - 1)  # the other maximum
    assert (one.speed_hz, one.growth) == (pytest.approx(27.88, abs=0.01), pytest.approx(4.133, abs=1e-3))


def test_nothing_grows_where_no_condition_is_met():
    found = ct.stability.peaks(PAIR, np.linspace(20.0, 30.0, 11))
    assert found.rows == ()
    assert not found.map.diverges


def test_speeds_ascend_from_above_zero():
    for speeds in ([0.0, 1.0], [2.0, 1.0], [1.0]):
        with pytest.raises(ct.InputError, match="expected two or more ascending speeds above 0 Hz"):
            ct.stability.peaks(PAIR, speeds)
