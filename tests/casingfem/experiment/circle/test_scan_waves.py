"""Waves from their two lines by hand: size, phase, antinode, what travels, from when on they are seen."""

import numpy as np
import pytest

import casingfem as cf


def test_a_record_without_motion_has_no_waves():
    silent = cf.circle.ScanRecord(
        fs=500.0, velocity=np.zeros(1000), angle=cf.circle.turning(2.0, 500.0, 1000), tones=(50.0,)
    )
    found = cf.circle.demodulate(silent, 2)
    assert [(wave.amplitude, wave.travelling, wave.travelling_sigma, wave.seen) for wave in found.waves()] == [
        (0.0, 0.0, 0.0, False)
    ] * 3
    assert "0 waves above 4 sigma of 3" in repr(found)


@pytest.mark.parametrize(("asked", "n"), [(2, range(-2, 3)), ([3, 1], [-3, -1, 1, 3]), ([0, 2], [-2, 0, 2]), (0, [0])])
def test_orders_are_all_up_to_one_or_those_named_both_ways_round(asked, n):
    record = cf.circle.ScanRecord(
        fs=500.0, velocity=np.ones(1000), angle=cf.circle.turning(2.0, 500.0, 1000), tones=(50.0,)
    )
    assert cf.circle.demodulate(record, asked).n.tolist() == list(n)
    for wrong in ([2, -1], -1, []):
        with pytest.raises(cf.errors.InputError, match="expected numbers of nodal diameters, 0 or more"):
            cf.circle.demodulate(record, wrong)


@pytest.mark.parametrize("harmonics", [1, 3])
def test_what_repeats_every_turn_is_fitted_beside_the_waves(harmonics):
    """A mean and so many harmonics of it leave nothing; one more leaks."""
    theta = cf.circle.turning(2.1, 500.0, 1000, first_angle=0.3)
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


def test_the_shape_is_the_sum_of_the_lines_that_are_seen():
    theta = np.array([0.0, 0.4, 2.0])
    exact = np.exp(-2j * theta) + 2.0 + 3.0j * np.exp(2j * theta)
    np.testing.assert_allclose(scan().shape(0, theta), exact, rtol=1e-12)
    np.testing.assert_allclose(scan().shape(1, theta), 4.0 * np.exp(-2j * theta) + 6.0 * np.exp(2j * theta), rtol=1e-12)


@pytest.mark.parametrize(
    ("left", "floor", "said"), [(1.51, 0.01, True), (1.49, 0.01, False), (9.0, 6.1e-9, True), (9.0, 5.9e-9, False)]
)
def test_a_table_states_what_the_lines_leave_where_that_is_more_than_noise_and_round_off(left, floor, said):
    """A half more than the noise, of which there is more than a billionth of the largest line, 6."""
    text = repr(scan(left=left, floor=np.full((2, 3), floor)))
    assert ("orders or tones that were not fitted" in text) == said
    assert "3 waves above 4 sigma of 4, 1.5 turns/s" in text
