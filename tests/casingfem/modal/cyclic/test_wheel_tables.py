"""Waves of a wheel by their complex shapes, mixtures of them, and what tables say of modes, by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf


def test_a_mistuned_mode_is_reported_by_its_diameter_and_its_blade():
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
