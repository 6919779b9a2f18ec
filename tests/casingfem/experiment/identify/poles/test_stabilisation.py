"""Which poles are alike from order to order, both sides of each limit; what is put together over the bands."""

import numpy as np
import pytest

from casingfem.experiment.identify.poles.stabilisation import (
    Stabilisation,
    _alike,
    _collect,
    join,
    residues,
    stabilise,
)

SHAPE = np.array([[1.0, 2.0j, -1.0]])


def pole(freq, zeta):
    return np.array([[freq, zeta]])


@pytest.mark.parametrize(
    ("freq", "zeta", "same"),
    [
        (100.299, 0.005, True),  # 0.3 of 1 Hz
        (100.301, 0.005, False),
        (99.701, 0.005, True),
        (99.699, 0.005, False),
        (100.0, 0.00649, True),
        (100.0, 0.00651, False),
        (100.0, 0.00351, True),
        (100.0, 0.00349, False),
    ],
)
def test_poles_are_alike_in_frequency_and_damping(freq, zeta, same):
    """By the bandwidth and damping of the first."""
    assert _alike(pole(100.0, 0.005), SHAPE, pole(freq, zeta), SHAPE).tolist() == [[same]]


def test_bandwidth_and_damping_are_those_of_the_first():
    wide, thin = pole(100.0, 0.005), pole(100.25, 0.0037)
    assert _alike(wide, SHAPE, thin, SHAPE).item()  # 0.25 of 1 Hz, 0.26 of 0.005
    assert not _alike(thin, SHAPE, wide, SHAPE).item()


@pytest.mark.parametrize(("mac", "same"), [(0.91, True), (0.89, False)])
def test_poles_are_alike_in_shape(mac, same):
    other = np.sqrt(mac) * np.array([3.0, 0.0]) + np.sqrt(1.0 - mac) * np.array([0.0, 3.0j])
    first = np.array([[2.0j, 0.0]])
    at = pole(100.0, 0.005)
    assert _alike(at, first, at, other[None]).item() is same
    both = np.vstack([pole(100.0, 0.005), pole(120.0, 0.005)])
    found = _alike(both, np.vstack([first, first]), at, first)
    assert found.tolist() == [[True], [False]]


def test_poles_join_the_cluster_whose_last_member_they_are_like():
    clusters = [[(90.0, 0.004), (100.0, 0.005)], [(110.0, 0.005)]]
    shapes = [SHAPE[0], SHAPE[0]]
    found = np.array([[110.1, 0.005], [100.1, 0.0055], [100.15, 0.005], [130.0, 0.004]])
    new = np.vstack([SHAPE, 2.0 * SHAPE, 3.0 * SHAPE, 4.0 * SHAPE])
    _collect(clusters, shapes, found, new)
    assert clusters == [
        [(90.0, 0.004), (100.0, 0.005), (100.1, 0.0055)], [(110.0, 0.005), (110.1, 0.005)], [(100.15, 0.005)],
        [(130.0, 0.004)],
    ]  # fmt: skip
    assert [shape[0] for shape in shapes] == [2.0, 1.0, 3.0, 4.0]


def test_bands_join_with_the_poles_of_their_cores():
    first = np.array([99.0, 100.0, 110.0]), np.array([0.01, 0.02, 0.03]), np.arange(1, 4), np.array([True, False, True])
    then = np.array([109.0, 110.0, 120.0]), np.array([0.04, 0.05, 0.06]), np.arange(4, 7), np.array([False, True, True])
    names = "freq", "zeta", "order", "stable"
    parts = [Stabilisation(**dict(zip(names, each, strict=True))) for each in (first, then)]
    whole = join(parts, [(100.0, 110.0), (110.0, 120.0)])
    assert whole.freq.tolist() == [100.0, 110.0]
    assert whole.zeta.tolist() == [0.02, 0.05]
    assert whole.order.tolist() == [2, 5]
    assert whole.stable.tolist() == [False, True]
    assert (whole.order.dtype.kind, whole.stable.dtype.kind) == ("i", "b")
    assert len(join([], []).freq) == 0


def test_residues_are_those_of_poles_beside_a_constant_and_a_slope():
    freq = np.arange(95.0, 105.0, 0.25)
    poles = 2.0 * np.pi * np.array([98.0 * (-0.01 + 1j), 102.0 * (-0.02 + 1j)])
    s = 2j * np.pi * freq
    want = np.array([[1.0, -2.0j], [0.5 + 1j, 3.0]])
    H = sum(abs(p.real) * a[:, None] / (s - p) for p, a in zip(poles, want, strict=True))
    H = H + np.array([[0.3], [0.1j]]) + np.array([[2.0], [1j]]) * (freq - 97.0)
    np.testing.assert_allclose(residues(poles, freq, H), want, rtol=1e-9)


def swept(places, zeta=0.005):
    """One pole for each order at these frequencies [Hz]."""
    return [2.0 * np.pi * f * np.array([-zeta + 1j * np.sqrt(1.0 - zeta**2)]) for f in places]


@pytest.mark.parametrize(("stays", "count"), [(2, 1), (1, 0)])
def test_poles_that_stay_in_four_tenths_of_the_upper_orders_are_starts(stays, count):
    """Of ten orders the last five count: two of them are enough, though the lower ones all stay."""
    freq = np.arange(95.0, 125.0, 0.25)
    H = (1.0 / (2j * np.pi * freq - swept([100.0])[0][0]))[None]
    places = [100.0] * (5 + stays) + [104.0 + 3.0 * k for k in range(5 - stays)]
    diagram, starts = stabilise(swept(places), freq, H)
    assert diagram.order.tolist() == list(range(1, 11))
    assert diagram.stable.tolist() == [False] + [True] * (4 + stays) + [False] * (5 - stays)
    np.testing.assert_allclose(diagram.freq, places, rtol=1e-12)
    np.testing.assert_allclose(diagram.zeta, 0.005, rtol=1e-12)
    assert len(starts) == count
    if count:
        np.testing.assert_allclose(starts, [[100.0, 0.005]], rtol=1e-12)


def test_poles_of_a_tenth_of_damping_are_none_and_starts_ascend():
    freq = np.arange(90.0, 125.0, 0.25)
    two = [np.concatenate(pair) for pair in zip(swept([112.0] * 4), swept([100.0] * 4), strict=True)]
    H = sum(1.0 / (2j * np.pi * freq - at) for at in two[0])[None]
    damped = [
        np.append(each, swept([105.0], zeta)[0]) for each, zeta in zip(two, (0.099, 0.101, 0.2, 0.3), strict=True)
    ]
    diagram, starts = stabilise(damped, freq, H)
    assert len(diagram.freq) == 9
    np.testing.assert_allclose(starts[:, 0], [100.0, 112.0], rtol=1e-12)
