"""What channels are off the waves of most modes: the least where these are pure, and which belong elsewhere."""

import numpy as np
import pytest

from casingfem.experiment.identify.setups.around import Places
from casingfem.experiment.identify.setups.wave_model import belonging, waves_of


def places(count=9, reference=0):
    theta = np.radians(np.array([3.0, 47.0, 85.0, 124.0, 161.0, 203.0, 240.0, 284.0, 325.0])[:count])
    return Places(theta, np.where(np.arange(count) == 2, -1.0, 1.0), np.full(count, reference), (0, 1, 2))


def shapes_at(where, orders, lag=0.0):
    rng = np.random.default_rng(5)
    pure = where.sign * np.cos(np.outer(orders, where.theta) - rng.uniform(0.0, 6.0, (len(orders), 1)))
    return pure * rng.uniform(0.3, 4.0, (len(orders), 1)) * (1.0 + 1j * lag)


def test_pure_waves_are_off_by_the_least_and_a_channel_that_is_silent_belongs_elsewhere():
    where = places()
    found = waves_of(where, shapes_at(where, [1, 2, 1, 2, 2]))
    np.testing.assert_allclose(found.off, [[1.3 * 0.03] * 9] * 2 + [[3.0] * 9], rtol=1e-6)
    np.testing.assert_allclose(found.lag, [[1.3 * 0.03] * 9] * 2 + [[3.0] * 9], rtol=1e-6)
    np.testing.assert_allclose(found.columns[:2], [where.waves(1), where.waves(2)])
    assert not found.columns[2].any()
    assert belonging(found).all()
    residues = shapes_at(where, [1, 2, 1, 2, 2, 1, 2])
    residues[:, 6] = 0.0
    assert belonging(waves_of(where, residues)).tolist() == [k != 6 for k in range(9)]
    limit = found._replace(off=found.off * 0.0 + np.array([0.3899, 0.3901, *[0.1] * 7]))
    assert belonging(limit).tolist() == [True, False, *[True] * 7]


def test_few_modes_or_channels_tell_no_waves():
    where = places()
    assert waves_of(where, shapes_at(where, [1, 2, 1, 2])) is None
    assert waves_of(where._replace(orders=(0,)), shapes_at(where, [1, 2, 1, 2, 1])) is None
    eight, seven = places(8), places(7)
    assert waves_of(eight, shapes_at(eight, [1, 2, 1, 2, 1])) is not None
    assert waves_of(seven, shapes_at(seven, [1, 2, 1, 2, 1])) is None
    rng = np.random.default_rng(2)
    noise = rng.standard_normal((9, 9)) + 0j
    assert waves_of(where, noise) is None  # hardly a channel belongs


def test_a_channel_lags_by_what_its_imaginary_parts_are_in_most_modes():
    where = places()
    residues = shapes_at(where, [1, 2, 1, 2, 2])
    residues[:, 3] += 0.2j * np.sqrt(np.mean(np.abs(residues) ** 2, axis=1))
    found = waves_of(where, residues)
    scale = np.sqrt(np.mean(np.abs(residues) ** 2, axis=1))
    want = np.hypot(1.4826 * np.median(residues.imag[:, 3] / scale), 0.03)
    assert found.lag[0, 3] == pytest.approx(1.3 * want, rel=1e-9)
    np.testing.assert_allclose(np.delete(found.lag[0], 3), 1.3 * 0.03, rtol=1e-9)
