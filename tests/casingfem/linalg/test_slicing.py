"""Bands: every mode and no other, ends on modes, doubles across ends, many modes in slices, other factorisations."""

import numpy as np
import pytest
from scipy.sparse import csc_array

import casingfem as cf
from casingfem.linalg import memory, slicing
from casingfem.linalg.eigen import solve_band, solve_modes
from casingfem.linalg.factor import factorise
from casingfem.linalg.krylov import ConvergenceError, nearest
from casingfem.linalg.pencil import make_pencil


def with_spectrum(values, seed=3, sparse_mass=False):
    """K and M of a given spectrum, in a random basis."""
    rng = np.random.default_rng(seed)
    Q, _ = np.linalg.qr(rng.standard_normal((len(values), len(values))))
    K = (Q * values) @ Q.T
    if not sparse_mass:
        return csc_array(0.5 * (K + K.T)), np.ones(len(values))
    L = np.eye(len(values)) + 0.1 * np.tril(rng.standard_normal(Q.shape), -1) / np.sqrt(len(values))
    K = L @ K @ L.T
    return csc_array(0.5 * (K + K.T)), csc_array(L @ L.T)


def inside(values, low, high):
    return np.sort(values[(values >= low * (1 - 1e-7)) & (values <= high * (1 + 1e-7))])


@pytest.mark.slow
@pytest.mark.parametrize("sparse_mass", [False, True])
@pytest.mark.parametrize(
    ("seed", "size", "most"), [(0, 20, 1), (1, 30, 2), (2, 60, 7), (3, 90, 1), (4, 45, 4), (5, 25, 7), (6, 80, 3)]
)
def test_a_band_contains_every_mode_and_no_other(seed, size, most, sparse_mass):
    """Random spectra with clusters of up to seven equal values; ends now and then on a mode."""
    rng = np.random.default_rng(seed)
    base = np.cumsum(rng.uniform(0.01, 1.0, size))
    values = np.repeat(base, rng.integers(1, most + 1, size))[:size] + 0.5
    ends = np.sort(rng.choice(base, 2, replace=False)) + 0.5
    low, high = ends + rng.choice([0.0, 1e-3], 2) * [-1, 1]
    K, M = with_spectrum(values, seed, sparse_mass)
    found = solve_band(K, M, (low, high), shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, inside(values, low, high), rtol=1e-9)
    assert found.sturm_count == len(found.eigenvalues)


def test_an_end_between_the_members_of_a_double_keeps_both():
    values = np.r_[np.arange(1.0, 30.0), 10.0 * (1 + 1e-9), 20.0 * (1 + 1e-9)]
    K, M = with_spectrum(values)
    found = solve_band(K, M, (10.0 * (1 + 5e-10), 20.0 * (1 + 5e-10)), shift=-0.01)
    assert len(found.eigenvalues) == 13
    assert found.eigenvalues[[0, -1]] == pytest.approx([10.0, 20.0], rel=1e-8)


def searches(monkeypatch):
    """What each search finds from now on."""
    calls = []

    def spying(*arguments):
        calls.append(nearest(*arguments))
        return calls[-1]

    monkeypatch.setattr(slicing, "nearest", spying)
    return calls


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("other", [0.0, 2.5])
def test_an_end_beside_a_cluster_moves_past_all_of_it(monkeypatch, way, other):
    """Nine equal values are where round-off cannot tell them from the one on the end."""
    calls = searches(monkeypatch)
    values = np.r_[np.arange(1.0, 30.0), np.full(9, 10.0 * (1 + way * 1.5e-7))]
    band = (other, 10.0) if way > 0 else (10.0, 22.3 - other)
    found = solve_band(*with_spectrum(values), band, shift=-0.01)
    expected = np.sort(values[(values > band[0] - 2e-6) & (values < band[1] + 2e-6)])
    np.testing.assert_allclose(found.eigenvalues, expected, rtol=1e-10)
    assert found.sturm_count == len(expected)
    assert len(calls) > 1
    assert found.products == sum(call.products for call in calls)


def counter_of(*values, floor=0.01):
    return slicing.Counter(make_pencil(csc_array(np.diag(values)), np.ones(len(values))), floor, "superlu")


@pytest.mark.parametrize(
    ("place", "values", "outside", "below"),
    [
        (2.0, [1.0, 2.0 + 3e-7, 3.0], 2.0, 1),  # clear
        (2.0, [1.0, 2.0, 2.0 + 1.5e-7, 2.0 + 3e-7, 3.0], 2.0 + 3e-7 + 1e-6, 4),  # a chain, and a wide gap
        (2.0, [1.0, 2.0, 2.0 + 1.5e-7, 2.0 + 3e-7], 2.0 + 3e-7 + 1e-6, 4),  # nothing is known beyond
        (2.0, [1.0, 2.0, 2.0 + 5e-7], 2.0 + 2.5e-7, 2),  # a narrow gap
        (1e-10, [5e-10, 1.0], 5e-10 + 5e-9, 1),  # zero but for round-off
    ],
)
def test_an_end_on_an_eigenvalue_moves_into_the_first_clear_gap(place, values, outside, below):
    counter, values = counter_of(*values), np.array(values)
    end = slicing.End(place, int(np.count_nonzero(values < place)))
    moved = counter.moved(end, values, 1.0, slicing.CLEAR)
    assert moved.place == pytest.approx(outside, rel=1e-12)
    assert (moved.below, moved.settled) == (below, True)
    settled = slicing.End(place, end.below, settled=True)
    assert counter.moved(settled, values, 1.0, slicing.CLEAR) == settled


def test_eigenvalues_just_as_far_as_still_counts_are_on_an_end():
    """One a width above the end, one more a width above that, both to the bit."""
    width = 2.0**-19
    values = np.array([1.0, 2.0 + width, 2.0 + 2.0 * width, 3.0])
    moved = counter_of(*values).moved(slicing.End(2.0, 1), values, 1.0, clear=0.5 * width)
    assert moved == slicing.End(2.0 + 7.0 * width, 3, settled=True)


def test_a_lower_end_moves_down():
    values = np.array([1.0, 2.0 - 1.5e-7, 2.0, 3.0])
    moved = counter_of(*values).moved(slicing.End(2.0, 2), -values[::-1], -1.0, slicing.CLEAR)
    assert moved.place == pytest.approx(2.0 - 1.5e-7 - 1e-6, rel=1e-12)
    assert moved.below == 1


def test_a_count_that_meets_an_eigenvalue_steps_once_more_and_no_further():
    end = counter_of(1.0, 2.0 + 2e-7, 3.0).counted(2.0, 1.0)
    assert end == slicing.End(2.0 + 4e-7, 2)
    with pytest.raises(cf.errors.NumericsError, match="no Sturm count at shift 2"):
        counter_of(1.0, 2.0 + 2e-7, 2.0 + 4e-7).counted(2.0, 1.0)


def test_slices_are_halved_by_frequency_and_join(monkeypatch):
    """Frequencies 1, 2, ..., 32: four slices of eight, the second from where the first ended."""
    monkeypatch.setattr(slicing, "MANY", 8)
    pencil = make_pencil(*with_spectrum(np.arange(1.0, 41.0) ** 2))
    parts = list(slicing.slices(pencil, 0.0, 32.6**2, -0.01, "superlu"))
    assert [len(part.values) for part in parts] == [8, 8, 8, 8]
    assert [part.below for part in parts] == [8, 16, 24, 32]
    assert [part.low for part in parts[1:]] == [part.high for part in parts[:-1]]


def test_a_mode_near_the_joint_of_two_slices_is_found_once(monkeypatch):
    """One is on the joint, the next so near that the joint moves to where both are within reach of it."""
    monkeypatch.setattr(slicing, "MANY", 8)
    joint = 10.0 * (1 + 2e-7)
    values = np.r_[np.arange(1.0, 10.0), joint, joint + 1.2e-6, np.arange(11.0, 50.0)]
    found = solve_band(*with_spectrum(values), (0.0, 40.0), shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, values[:41], rtol=1e-10)


def test_too_many_modes_of_a_band_are_refused_and_those_below_it_are_not_counted(monkeypatch):
    monkeypatch.setattr(memory, "MOST", 1.0)
    monkeypatch.setattr(memory, "MODES", 3.0)
    K, M = with_spectrum(np.arange(1.0, 40.0))
    assert solve_band(K, M, (9.5, 12.5), shift=-0.01).sturm_count == 3
    with pytest.raises(cf.errors.ModelError, match=r"some 4 of 39 unknowns, .* expected at most 3 at once"):
        solve_band(K, M, (9.5, 13.5), shift=-0.01)


@pytest.mark.parametrize("off", [0.0, 1e-13])
def test_a_shift_on_an_eigenvalue_is_put_elsewhere(off, monkeypatch):
    """What is in the middle of the band, to the last bit or nearly so, would drown the others."""
    calls = searches(monkeypatch)
    low, high = 3.5 * (1 - 1e-7), 9.25 * (1 + 1e-7)
    values = np.r_[np.arange(1.0, 40.0), (low + 0.5 * (high - low)) * (1 + off)]
    found = solve_band(csc_array(np.diag(values)), np.ones(40), (3.5, 9.25), shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, np.sort(values[(values > 3.5) & (values < 9.25)]), rtol=1e-13)
    assert len(calls) == (1 if off == 0.0 else 2)  # where it is exact, nothing can be factorised
    assert found.products == sum(call.products for call in calls)


def failing(times):
    """A search that does not converge in its first calls."""
    calls = []

    def search(*arguments):
        calls.append(arguments[2])
        if len(calls) <= times:
            raise ConvergenceError("0 of 9 modes converged")
        return nearest(*arguments)

    return search, calls


def test_a_search_that_does_not_converge_is_begun_from_another_shift(monkeypatch):
    search, shifts = failing(3)
    monkeypatch.setattr(slicing, "nearest", search)
    found = solve_band(*with_spectrum(np.arange(1.0, 40.0)), (3.3, 8.3), shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, np.arange(4.0, 9.0), rtol=1e-10)
    np.testing.assert_allclose(shifts, [5.8, 5.65, 5.95, 5.5], atol=1e-6)


def test_a_search_that_converges_from_nowhere_is_an_error(monkeypatch):
    monkeypatch.setattr(slicing, "nearest", failing(99)[0])
    with pytest.raises(cf.errors.NumericsError, match=r"no shift between 3\.3 and 8\.3 rad\^2/s\^2 that is far enough"):
        solve_band(*with_spectrum(np.arange(1.0, 40.0)), (3.3, 8.3), shift=-0.01)


def test_a_band_of_all_modes_contains_all():
    values = np.arange(1.0, 21.0)
    found = solve_band(*with_spectrum(values), (0.5, 30.0), shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, values, rtol=1e-10)


@pytest.mark.slow
def test_many_modes_are_found_in_slices(monkeypatch):
    monkeypatch.setattr(slicing, "MANY", 8)
    values = np.r_[np.arange(1.0, 101.0), np.full(12, 50.0), np.arange(1.0, 30.0) + 1e-12]
    K, M = with_spectrum(values)
    found = solve_band(K, M, (0.0, 80.5), shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, inside(values, 0.0, 80.5), rtol=1e-9)
    np.testing.assert_allclose(found.vectors.T @ found.vectors, np.eye(len(found.eigenvalues)), atol=1e-8)


def test_an_empty_band_is_empty():
    found = solve_band(*with_spectrum(np.arange(1.0, 40.0)), (3.2, 3.7), shift=-0.01)
    assert found.eigenvalues.shape == (0,)
    assert found.vectors.shape == (39, 0)


def test_a_band_from_zero_contains_the_rigid_motions():
    values = np.r_[np.zeros(6), np.arange(1.0, 40.0)]
    found = solve_band(*with_spectrum(values), (0.0, 2.5), shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, [0, 0, 0, 0, 0, 0, 1, 2], atol=1e-12)


@pytest.mark.parametrize("band", [(-1.0, 2.0), (3.0, 3.0), (4.0, 2.0), (0.0, np.inf), (np.nan, 2.0)])
def test_refuses_a_band_that_is_none(band):
    with pytest.raises(cf.errors.NumericsError, match=r"band: found .*, expected 0 <= from < to"):
        solve_band(*with_spectrum(np.arange(1.0, 40.0)), band, shift=-0.01)


@pytest.mark.parametrize(
    ("low", "said"),
    [
        (3.3, r"5 modes lie in 0\.289119 to 0\.458521 Hz, 4 were found"),
        (0.0, r"8 modes lie in 0 to 0\.458521 Hz, 7 were"),
    ],
)
def test_a_mode_lost_in_a_slice_is_an_error(monkeypatch, low, said):
    def losing(*arguments):
        found = nearest(*arguments)
        return type(found)(values=found.values[1:], vectors=found.vectors[:, 1:], products=found.products)

    monkeypatch.setattr(slicing, "nearest", losing)
    with pytest.raises(cf.errors.NumericsError, match=said):
        solve_band(*with_spectrum(np.arange(1.0, 40.0)), (low, 8.3), shift=-0.01)


@pytest.mark.slow
def test_a_slice_with_a_mode_wherever_a_shift_may_are_is_an_error():
    """With one place free the band is whole."""
    low, high = 10.0 * (1.0 - 1e-7), 20.0 * (1.0 + 1e-7)  # as an end moves to meet a mode on it
    taken = [low + place * (high - low) for place in slicing.PLACES]
    for modes in (taken[:-1], taken):
        spectrum = np.r_[np.arange(1.0, 10.0), 10.5, 19.5, np.arange(21.0, 50.0), modes]
        if modes == taken:
            with pytest.raises(cf.errors.NumericsError, match=r"no shift between 10 and 20 .* that is far enough"):
                solve_band(*with_spectrum(spectrum), (10.0, 20.0), shift=-0.01)
        else:
            found = solve_band(*with_spectrum(spectrum), (10.0, 20.0), shift=-0.01)
            np.testing.assert_allclose(found.eigenvalues, inside(spectrum, 10.0, 20.0), rtol=1e-10)


def test_a_cluster_larger_than_the_block_is_found_whole():
    values = np.r_[np.full(21, 2.0), np.arange(3.0, 60.0)]
    K, M = with_spectrum(values)
    found = solve_modes(K, M, 23, shift=-0.01)
    np.testing.assert_allclose(found.eigenvalues, np.sort(values)[:23], rtol=1e-10)


def test_refuses_a_factorisation_it_does_not_know():
    with pytest.raises(
        cf.errors.NumericsError, match="direct must be one of multifrontal, superlu, pardiso, found 'cholmod'"
    ):
        factorise(csc_array(np.eye(3)), "cholmod")
