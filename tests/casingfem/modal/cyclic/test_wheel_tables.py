"""Waves of a wheel by their complex shapes, mixtures of them, and what tables say of modes, by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.modal.cyclic.mistuned import checked_deviations, mixed, richer
from casingfem.modal.cyclic.modes import checked_diameters, wheel_shapes
from casingfem.modal.cyclic.waves import Waves
from casingfem.modal.harmonics import Rings
from casingfem.modal.whirl import expand_complex, freq_at_rest, wave_sense

N = 5
RNG = np.random.default_rng(14)
# of each diameter: complex shapes at two channels, and at three dofs of the blade
PLACES = {0: RNG.standard_normal((2, 1)), 1: RNG.standard_normal((2, 2)) + 1j * RNG.standard_normal((2, 2))}
SHAPES = {0: RNG.standard_normal((3, 1)), 1: RNG.standard_normal((3, 2)) + 1j * RNG.standard_normal((3, 2))}
STIFF = np.array([[3.0, -1.0, 0.0], [-1.0, 2.0, 0.5], [0.0, 0.5, 1.0]])
SINGLE, COSINES, SINES = slice(0, 1), slice(1, 3), slice(3, 5)


def in_sector(parts, j):
    """Real motions in sector j of the coordinates: Re(z e^(i n alpha j) (c - i s))."""
    wave = parts[1] * np.exp(2j * np.pi * j / N)
    return np.concatenate([parts[0], wave.real, wave.imag], axis=1)


def waves(omega=(4.0, 3.0, 6.0, 3.0, 6.0), modes=(True,) * 5):
    return Waves(
        sectors=N, n=np.array([0, 1, 1, 1, 1]), omega=np.array(omega), modes=np.array(modes),
        partner=np.array([0, 3, 4, 1, 2]), sign=np.array([-1.0, -1.0, -1.0, 1.0, 1.0]), places=in_sector(PLACES, 0),
        blade=in_sector(SHAPES, 0).T @ STIFF @ in_sector(SHAPES, 0), added=np.zeros((0, 0)),
        gyroscopic=np.zeros((0, 0)),
    )  # fmt: skip


def test_channels_of_every_sector_move_as_their_waves_pass():
    np.testing.assert_allclose(waves().rows(), np.concatenate([in_sector(PLACES, j) for j in range(N)]), atol=1e-14)


@pytest.mark.parametrize("j", [0, 1, 3])
def test_the_energy_of_a_blade_is_that_of_its_own_motions(j):
    own = in_sector(SHAPES, j)
    np.testing.assert_allclose(waves().blade_energy(j), own.T @ STIFF @ own, atol=1e-13)


def test_a_tuned_wheel_has_its_modes_first_each_kind_ascending():
    omega, turn = mixed(waves((4.0, 3.0, 6.0, 3.5, 2.0), (True, True, False, True, False)), None)
    assert omega.tolist() == [3.0, 3.5, 4.0, 2.0, 6.0]
    assert np.array_equal(turn, np.eye(5)[:, [1, 3, 0, 4, 2]])


def test_a_mistuned_wheel_has_blades_of_other_stiffness():
    deviations = np.array([0.1, 0.0, -0.05, 0.0, 0.2])
    omega, turn = mixed(waves(), deviations)
    K = np.diag(np.array([4.0, 3.0, 6.0, 3.0, 6.0]) ** 2)
    for j, deviation in enumerate(deviations):
        own = in_sector(SHAPES, j)
        K = K + ((1.0 + deviation) ** 2 - 1.0) * own.T @ STIFF @ own
    np.testing.assert_allclose(omega**2, np.linalg.eigvalsh(K), rtol=1e-10)
    np.testing.assert_allclose(turn.T @ K @ turn, np.diag(omega**2), atol=1e-10)


@pytest.mark.parametrize(
    ("values", "found"),
    [
        ([0.1, 0.2], "2 values"),
        ([[0.1], [0.2], [0.3]], "3 values"),
        ([0.1, -1.0, 0.2], "-1"),
        ([np.nan, 0.0, 0.0], "nan"),
    ],
)
def test_deviations_are_one_a_sector_above_minus_one(values, found):
    with pytest.raises(
        cf.errors.ModelError, match=rf"found {found}, expected 3, each above -1 .*|found {found}, expected 3"
    ):
        checked_deviations(values, 3)
    assert checked_deviations([-0.999, 0.0, 5.0], 3).tolist() == [-0.999, 0.0, 5.0]
    assert [richer(count) for count in (1, 6)] == [4, 14]


def test_a_mistuned_mode_is_told_by_its_diameter_and_its_blade():
    modes = cf.modal.MistunedModes(
        freq=np.array([100.0, 210.5]), content=np.array([[0.2, 0.5, 0.3], [0.9, 0.1, 0.0]]),
        energy=np.array([[0.1, 0.2, 0.6, 0.1], [0.4, 0.3, 0.2, 0.1]]),
    )  # fmt: skip
    assert len(modes) == 2
    assert modes.nodal_diameters.tolist() == [1, 0]
    np.testing.assert_allclose(modes.localisation, [2.4, 1.6])
    assert modes.records() == [
        {"mode": 1, "freq_hz": 100.0, "n": 1, "n_share": 0.5, "blade": 3, "localisation": pytest.approx(2.4)},
        {"mode": 2, "freq_hz": 210.5, "n": 0, "n_share": 0.9, "blade": 1, "localisation": pytest.approx(1.6)},
    ]
    assert repr(modes).splitlines()[1].split() == ["1", "100.000", "1", "0.50", "3", "2.40"]


def sector(count=4):
    """A wheel of so many sectors: single for 0 and half of them, pairs between."""
    return SimpleNamespace(
        sectors=count, diameters=tuple(range(count // 2 + 1)), count=lambda n: 1 if n in (0, count / 2) else 2
    )


@pytest.mark.parametrize(("asked", "chosen"), [(None, (0, 1, 2)), ([2, 0, 2], (0, 2)), ((1,), (1,))])
def test_diameters_are_taken_once_and_ascending(asked, chosen):
    assert checked_diameters(sector(), asked) == chosen


@pytest.mark.parametrize("asked", [[], [3], [-1, 0]])
def test_diameters_that_a_wheel_does_not_have_are_refused(asked):
    with pytest.raises(cf.errors.ModelError, match=r"expected some of 0 to 2"):
        checked_diameters(sector(), asked)


def cyclic(counts):
    return cf.modal.CyclicModes(
        sector=sector(), freq=np.array([10.0, 20.0, 11.0, 30.0]), nodal_diameters=np.array([0, 1, 1, 2]),
        rank=np.array([1, 1, 2, 1]), fields=np.zeros((0, 3, 4)), rigid=np.array([True, False, False, False]),
        sturm_counts=counts, unknowns=99, seconds={"assemble": 0.25, "solve": 1.0},
    )  # fmt: skip


def test_a_pair_of_a_wheel_is_two_modes_with_one_number():
    rows = cyclic({0: 1}).records()
    assert [row["mode"] for row in rows] == [1, 2, 3, 4, 5, 6]
    assert [row["doublet"] for row in rows] == [None, 1, 1, 2, 2, None]
    assert [row["split_rel"] for row in rows] == [None, 0.0, 0.0, 0.0, 0.0, None]
    assert [(row["freq_hz"], row["n"], row["m"]) for row in rows[2:5]] == [(20.0, 1, 1), (11.0, 1, 2), (11.0, 1, 2)]
    assert [row["rigid"] for row in rows] == [True] + [False] * 5
    assert {row["n_purity"] for row in rows} == {1.0}
    assert {row["angle_deg"] for row in rows} == {None}


@pytest.mark.parametrize(("counts", "said"), [({0: 1, 1: 2}, "counted (Sturm)"), ({0: 1, 1: None}, "not all counted")])
def test_a_wheel_lists_its_frequencies_by_diameter(counts, said):
    head, *rows, last = repr(cyclic(counts)).splitlines()
    assert head.split() == ["n", "freq", "[Hz]"]
    assert [row.split() for row in rows] == [
        ["0", "single", "10.000"], ["1", "pairs", "20.000", "11.000"], ["2", "single", "30.000"]
    ]  # fmt: skip
    assert last == f"4 sectors, 99 unknowns of a sector, {said}, 1.25 s"


def test_a_long_line_of_frequencies_goes_on_below():
    found = cyclic({0: 1})
    many = cf.modal.CyclicModes(
        sector=found.sector, freq=np.arange(1.0, 12.0), nodal_diameters=np.ones(11, dtype=int), rank=np.arange(1, 12),
        fields=np.zeros((0, 3, 11)), rigid=np.zeros(11, dtype=bool), sturm_counts={1: 11}, unknowns=1, seconds={},
    )  # fmt: skip
    _, first, second, _ = repr(many).splitlines()
    assert first.split()[:3] == ["1", "pairs", "1.000"]
    assert [*first.split()[2:], *second.split()] == [f"{k}.000" for k in range(1, 12)]
    assert max(len(first), len(second)) <= 80


@pytest.mark.parametrize(("n", "share"), [(0, 1 / 4), (1, 2 / 4), (2, 1 / 4)])
def test_shapes_of_a_sector_are_normalised_over_the_wheel_and_real_at_their_peak(n, share):
    vectors = np.array([[1.0 + 1j, 0.5], [3j, 0.0], [0.1, -4.0], [0.0, 9.0]])
    system = SimpleNamespace(
        sector=sector(), system=SimpleNamespace(expand=lambda x: np.concatenate([x, 7.0 * x[3:]])[None])
    )  # the last two are rotations, however large
    found = wheel_shapes(system, n, vectors)
    expected = np.sqrt(share) * np.concatenate([vectors, 7.0 * vectors[3:]])
    np.testing.assert_allclose(found[0], expected * [-1j, -1.0], atol=1e-14)


def test_complex_shapes_have_their_largest_displacement_one():
    system = SimpleNamespace(expand=lambda x: x.reshape(2, 4, -1))
    vectors = np.arange(16.0).reshape(8, 2) * np.array([1.0, 1j]) + np.array([0.0, 2.0])
    found = expand_complex(system, vectors)
    np.testing.assert_allclose(found, vectors.reshape(2, 4, 2) / vectors[6], rtol=1e-14)


def test_an_observer_at_rest_sees_waves_by_their_sense():
    turning = cf.Rotation(omega=-2.0 * np.pi * 30.0)
    found = freq_at_rest(np.array([100.0, 100.0, 50.0, 20.0]), np.array([2, -2, 0, -1]), turning)
    np.testing.assert_allclose(found, [160.0, 40.0, 50.0, 10.0], rtol=1e-14)
    assert freq_at_rest(np.array([100.0]), np.array([3]), None).tolist() == [100.0]


def test_a_whirl_names_its_waves():
    found = cf.modal.CyclicWhirl(
        sector=SimpleNamespace(structure=SimpleNamespace(rotation=cf.Rotation(omega=2.0 * np.pi * 7.0))),
        freq=np.array([50.0, 60.0, 5.0]), nodal_diameters=np.array([1, 3, 0]), sense=np.array([-1, 1, 0]),
        fields=np.zeros((0, 3, 3)),
    )  # fmt: skip
    assert len(found) == 3
    np.testing.assert_allclose(found.freq_fixed, [43.0, 81.0, 5.0], rtol=1e-14)
    assert found.records()[1] == {"n": 3, "sense": 1, "freq_hz": 60.0, "freq_fixed_hz": pytest.approx(81.0)}
    assert [line.split()[:2] for line in repr(found).splitlines()[1:]] == [
        ["1", "backward"], ["3", "forward"], ["0", "single"]
    ]  # fmt: skip


@pytest.mark.parametrize("turning", [1.0, -1.0])
def test_the_sense_of_a_wave_is_that_of_the_larger_part_at_its_own_diameters(turning):
    """Two rings of uneven weight, 2.25 against 2.71; those of n = 0 have none."""
    forward, backward = np.zeros((2, 4, 2, 3, 4))
    forward[2, :, :, 0], backward[2, :, :, 0] = [[3.0], [0.0]], [[0.0], [1.9]]
    forward[3, 0, 1, 1], backward[1, 0, 1, 1] = 1.0, 1.1
    forward[0, :, 2, 2], backward[0, :, 2, 2] = 1.0, 0.5
    forward[1, 1, 0, 3], backward[1, 1, 0, 3] = 0.4, 0.5
    weights = np.array([0.25, 0.75])
    n, sense = wave_sense([Rings(part, weights) for part in (forward, backward)], turning)
    assert n.tolist() == [2, 1, 0, 1]
    assert sense.tolist() == [-turning, -turning, 0, -turning]
