"""Waves from their two lines by hand: size, phase, antinode, what travels, from when on they are seen."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.circle.record import turning
from casingfem.experiment.circle.scan import one_wave


def test_a_wave_of_n_0_has_a_size_and_a_phase_alone():
    found = one_wave(50.0, 0, 2.0 * np.exp(0.3j) * np.ones(2), np.array([0.1, 0.1]))
    assert found[:4] == (50.0, 0, pytest.approx(2.0), 0.1)
    assert found.phase_deg == pytest.approx(np.degrees(0.3))
    assert np.isnan([found.angle_deg, found.angle_sigma_deg]).all()
    assert found[7:] == (0.0, 0.0, True)


def test_a_wave_of_two_lines_is_their_sum_at_the_antinode_and_travels_by_their_difference():
    """Lines of 3 and 1: 4 where they agree; (1 - 3)/4 of it runs against larger angles."""
    n, psi, phase = 4, 0.3, -0.9
    V = np.array([3.0 * np.exp(1j * (phase - n * psi)), np.exp(1j * (phase + n * psi))])
    found = one_wave(50.0, n, V, np.array([0.03, 0.04]))
    assert found[:4] == (50.0, 4, pytest.approx(4.0), pytest.approx(0.05))
    assert found.phase_deg == pytest.approx(np.degrees(phase))
    assert found.angle_deg == pytest.approx(np.degrees(psi))
    assert found.angle_sigma_deg == pytest.approx(np.degrees(np.hypot(0.03 / 3.0, 0.04) / 8.0))
    assert found.travelling == pytest.approx(-0.5)
    assert found.travelling_sigma == pytest.approx(2.0 * np.hypot(1.0 * 0.03, 3.0 * 0.04) / 16.0)
    theta = np.linspace(0.0, 2.0 * np.pi, 7201)
    assert np.abs(V[0] * np.exp(1j * n * theta) + V[1] * np.exp(-1j * n * theta)).max() == pytest.approx(4.0, rel=1e-6)


@pytest.mark.parametrize(("size", "seen"), [(4.01, True), (3.99, False)])
@pytest.mark.parametrize("n", [0, 2])
def test_a_wave_is_seen_where_a_line_is_above_four_sigma(size, seen, n):
    V = np.array([0.1, 0.1 * size]) if n else np.array([0.1 * size, 0.1 * size])
    assert one_wave(1.0, n, V, np.array([0.1, 0.1])).seen == seen
    found = scan(V=np.array([[0.1 * size, 0.0, 0.1]]), n=np.array([-2, 0, 2]))
    assert (np.abs(found.shape(0, [0.0]))[0] > 0.0) == seen


def test_a_wave_that_is_not_there_has_no_side_and_any_angle():
    found = one_wave(1.0, 3, np.zeros(2, complex), np.array([0.1, 0.1]))
    assert (found.amplitude, found.travelling, found.travelling_sigma, found.seen) == (0.0, 0.0, 0.0, False)
    assert found.angle_sigma_deg == 60.0


def test_a_record_without_motion_has_no_waves():
    silent = cf.circle.ScanRecord(fs=500.0, velocity=np.zeros(1000), angle=turning(2.0, 500.0, 1000), tones=(50.0,))
    found = cf.circle.demodulate(silent, 2)
    assert [(wave.amplitude, wave.travelling, wave.travelling_sigma, wave.seen) for wave in found.waves()] == [
        (0.0, 0.0, 0.0, False)
    ] * 3
    assert "0 waves above 4 sigma of 3" in repr(found)


@pytest.mark.parametrize(("asked", "n"), [(2, range(-2, 3)), ([3, 1], [-3, -1, 1, 3]), ([0, 2], [-2, 0, 2]), (0, [0])])
def test_orders_are_all_up_to_one_or_those_named_both_ways_round(asked, n):
    record = cf.circle.ScanRecord(fs=500.0, velocity=np.ones(1000), angle=turning(2.0, 500.0, 1000), tones=(50.0,))
    assert cf.circle.demodulate(record, asked).n.tolist() == list(n)
    for wrong in ([2, -1], -1, []):
        with pytest.raises(cf.errors.InputError, match="expected numbers of nodal diameters, 0 or more"):
            cf.circle.demodulate(record, wrong)


@pytest.mark.parametrize("harmonics", [1, 3])
def test_what_repeats_every_turn_is_fitted_beside_the_waves(harmonics):
    """A mean and so many harmonics of it leave nothing; one more leaks."""
    theta = turning(2.1, 500.0, 1000, first_angle=0.3)
    tone = np.cos(2.0 * np.pi * 50.3 * np.arange(1000) / 500.0)
    out = 0.7 + sum(np.cos(k * theta - 0.2 * k) for k in range(1, harmonics + 1))
    record = cf.circle.ScanRecord(fs=500.0, velocity=tone + out, angle=theta, tones=(50.3,))
    for fitted, exact in ((harmonics, True), (harmonics - 1, False)):
        V = cf.circle.demodulate(record, 1, runout=fitted).V[0]
        assert np.allclose(V, [0.0, 1.0, 0.0], rtol=0.0, atol=1e-9) == exact


def scan(**changes):
    """A tone, or two, at the orders 0 and 2, with sigma .1."""
    V = np.asarray(changes.pop("V", [[1.0, 2.0, 3.0j], [4.0, 0.05, 6.0]]), complex)
    given = {
        "tones": 50.0 + 10.0 * np.arange(len(V)),
        "n": np.array([-2, 0, 2]),
        "V": V,
        "sigma": np.full(V.shape, 0.1),
    }
    given |= {"floor": np.full(V.shape, 0.01), "rate": 1.5, "left": 1.0}
    return cf.circle.CircleScan(**given | changes)


def test_a_scan_lists_its_lines_and_its_waves_tone_by_tone():
    found = scan()
    assert found.lines.tolist() == [[47.0, 50.0, 53.0], [57.0, 60.0, 63.0]]
    assert [(wave.tone, wave.n) for wave in found.waves()] == [(50.0, 0), (50.0, 2), (60.0, 0), (60.0, 2)]
    assert [record["seen"] for record in found.records()] == [True, True, False, True]
    assert found.wave(0, 2) == one_wave(50.0, 2, np.array([3.0j, 1.0]), np.array([0.1, 0.1]))
    assert not found.V.flags.writeable
    for n in (1, -2):
        with pytest.raises(cf.errors.InputError, match=rf"order n = {n}: expected one of \[0, 2\]"):
            found.wave(0, n)


def test_the_shape_is_the_sum_of_the_lines_that_are_seen():
    theta = np.array([0.0, 0.4, 2.0])
    exact = np.exp(-2j * theta) + 2.0 + 3.0j * np.exp(2j * theta)
    np.testing.assert_allclose(scan().shape(0, theta), exact, rtol=1e-12)
    np.testing.assert_allclose(scan().shape(1, theta), 4.0 * np.exp(-2j * theta) + 6.0 * np.exp(2j * theta), rtol=1e-12)


@pytest.mark.parametrize(
    ("left", "floor", "said"), [(1.51, 0.01, True), (1.49, 0.01, False), (9.0, 6.1e-9, True), (9.0, 5.9e-9, False)]
)
def test_a_table_says_what_the_lines_leave_where_that_is_more_than_noise_and_round_off(left, floor, said):
    """A half more than the noise, of which there is more than a billionth of the largest line, 6."""
    text = repr(scan(left=left, floor=np.full((2, 3), floor)))
    assert ("orders or tones that were not fitted" in text) == said
    assert "3 waves above 4 sigma of 4, 1.5 turns/s" in text
