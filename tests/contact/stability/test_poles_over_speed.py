"""Poles of closed contact, maps of growth and the mean of split pairs, by small systems written out."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct

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


def test_modes_belong_to_the_waves_they_have_most_of_and_are_by_frequency():
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
