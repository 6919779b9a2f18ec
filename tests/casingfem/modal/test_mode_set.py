"""Labels of modes, their signs, ranks, turns and table, on shapes that are given."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.modal.harmonics import Rings
from casingfem.modal.mode_set import (
    ModeSet,
    double_turns,
    first_modes,
    make_labels,
    peak_signs,
    ranks,
    turned,
)
from casingfem.modal.modes import finest_shares, split_by_mesh
from casingfem.structure.mesh.shell_mesh import make_grid

NAN = np.nan
PSI = 0.2
WEIGHTS = np.array([0.25, 0.75])


def mode_set(**changes):
    """A rigid motion, a pair and a single of n = 4."""
    given = {
        "freq": np.array([1e-3, 100.0, 103.0, 150.0]), "fields": np.zeros((0, 5, 4)),
        "nodal_diameters": np.array([-1, 4, 4, 0]), "purity": np.array([NAN, 0.9, 0.8, 1.0]),
        "meridional": np.array([1, 1, 1, 2]), "doublets": ((1, 2),), "angle_deg": np.array([NAN, 12.5, 35.0, NAN]),
        "rigid": 1, "sturm_count": 4, "dofs": 77, "seconds": {"a": 0.25, "b": 0.5},
    }  # fmt: skip
    return ModeSet(**(given | changes))


def test_splits_are_relative_to_the_mean_and_pairs_are_numbered():
    two = mode_set(doublets=((1, 3), (0, 2)))
    np.testing.assert_allclose(two.splits, [50.0 / 125.0, (103.0 - 1e-3) / (0.5 * (103.0 + 1e-3))], rtol=1e-12)
    assert [two.doublet_of(mode) for mode in range(5)] == [1, 0, 1, 0, -1]
    assert mode_set(doublets=()).splits.shape == (0,)
    np.testing.assert_allclose(two.omega, 2.0 * np.pi * two.freq, rtol=1e-15)


def test_records_have_none_where_a_mode_has_no_such_value():
    expected = [
        {"mode": 1, "freq_hz": 1e-3, "n": None, "n_purity": None, "m": 1, "doublet": None, "split_rel": None,
         "angle_deg": None, "rigid": True},
        {"mode": 3, "freq_hz": 103.0, "n": 4, "n_purity": 0.8, "m": 1, "doublet": 1,
         "split_rel": pytest.approx(3.0 / 101.5), "angle_deg": 35.0, "rigid": False},
        {"mode": 4, "n": 0, "m": 2, "doublet": None, "rigid": False},
    ]  # fmt: skip
    rows = mode_set().records()
    assert [{name: rows[k][name] for name in row} for k, row in zip((0, 2, 3), expected, strict=True)] == expected


def printed(found):
    """Cells of a printed table by their headers, and its last line."""
    head, *rows, last = (re.split(r"  +", line.strip()) for line in repr(found).splitlines())
    return [dict(zip(head, row, strict=False)) for row in rows], last


def test_the_printed_table_has_the_records_in_its_units_and_marks_rigid_motions():
    rows, last = printed(mode_set())
    assert [row["freq [Hz]"] for row in rows] == ["0.001", "100.000", "103.000", "150.000"]
    assert [row["n"] for row in rows] == ["-", "4", "4", "0"]
    assert [row["split [%]"] for row in rows] == ["-", "2.9557", "2.9557", "-"]
    assert [row["angle [deg]"] for row in rows] == ["-", "12.50", "35.00", "-"]
    assert [row.get("motion") for row in rows] == ["rigid", None, None, None]
    assert last == ["4 modes, 77 dofs, Sturm count 4, 0.75 s"]
    assert "4 modes, 77 dofs, not counted, 0.75 s" in repr(mode_set(sturm_count=None))
    assert "motion" not in repr(mode_set(rigid=0))


def test_ranks_count_a_doublet_once_and_each_n_by_itself():
    n = np.array([3, 2, 3, 3, 2, 3, -1, -1])
    assert ranks(n, [(0, 3), (2, 5)]).tolist() == [1, 1, 2, 1, 2, 2, 1, 2]


def test_the_first_of_the_largest_displacements_is_positive():
    """Rotations do not count; of equal peaks, to a millionth, the first along x decides."""
    fields = np.zeros((3, 5, 4))
    fields[0, 0], fields[2, 1] = [1.0, -2.0, -1.0 + 0.9e-6, -1.0 + 1.1e-6], [0.5, -1.0, 1.0, 1.0]
    fields[1, 4] = -9.0
    assert peak_signs(fields).tolist() == [1.0, -1.0, -1.0, 1.0]


def test_pairs_alone_are_turned():
    T = np.array([[0.6, -0.8], [0.8, 0.6]])
    columns = np.random.default_rng(3).standard_normal((2, 3, 4))
    expected = columns.copy()
    expected[..., 3], expected[..., 1] = (
        columns[..., 3] * 0.6 + columns[..., 1] * 0.8, columns[..., 3] * -0.8 + columns[..., 1] * 0.6,
    )  # fmt: skip
    np.testing.assert_allclose(turned(columns, [(3, 1, T)]), expected, atol=1e-14)
    assert turned(np.zeros((0, 5, 3)), []).shape == (0, 5, 3)


def content(*modes):
    """Radial content n -> (amplitude, antinode) of modes on two rings."""
    found = np.zeros((6, 2, 3, len(modes)), dtype=complex)
    for mode, parts in enumerate(modes):
        for n, (size, psi) in parts.items():
            found[n, :, 0, mode] = size * np.array([1.0, -0.5]) * np.exp(-1j * n * psi)
    return Rings(found, WEIGHTS)


QUARTER = PSI + np.pi / 6
RINGS = content({1: (1.0, 0.0)}, {3: (1.0, PSI)}, {3: (2.0, QUARTER)}, {5: (1.0, 0.3), 2: (0.5, 0.1)}, {0: (1.0, 0.0)})
FIELDS = np.zeros((2, 3, 5))
FIELDS[0, 0] = [-1.0, 1.0, 1.0, -1.0, 1.0]
FREQ = np.array([0.0, 100.0, 101.0, 120.0, 130.0])


def test_labels_are_those_of_the_largest_content_but_for_rigid_motions():
    found = make_labels(RINGS, FREQ, FIELDS, 1)
    assert found.n.tolist() == [-1, 3, 3, 5, 0]
    np.testing.assert_allclose(found.purity, [NAN, 1.0, 1.0, 0.8, 1.0], rtol=1e-12)
    assert found.pairs == [(1, 2)]
    np.testing.assert_allclose(found.angle, [NAN, PSI, QUARTER, 0.3, NAN], rtol=1e-9)
    np.testing.assert_array_equal(found.fields[0, 0], np.ones(5))
    signs = [-1.0, 1.0, 1.0, -1.0, 1.0]
    np.testing.assert_allclose(found.rings.amplitudes, RINGS.amplitudes * signs, atol=1e-14)


@pytest.mark.parametrize("apart", [0.99e-7, 1.01e-7])
def test_a_perfect_pair_is_made_cosine_and_sine_and_has_no_angle(apart):
    freq = np.array([0.0, 100.0 * (1.0 - apart), 100.0, 120.0, 130.0])
    pair = replace(RINGS, amplitudes=RINGS.amplitudes / [1.0, 1.0, 2.0, 1.0, 1.0])
    found = make_labels(pair, freq, FIELDS, 1)
    perfect = apart < 1e-7
    assert len(double_turns(pair, found.n, freq, found.pairs)) == perfect
    assert np.isnan(found.angle[[1, 2]]).all() == perfect
    waves = found.rings.amplitudes[3, 0, 0, [1, 2]]
    assert (abs(waves[0].imag) < 1e-9 and abs(waves[1].real) < 1e-9) == perfect


def test_modes_without_rings_have_no_labels():
    found = make_labels(None, FREQ, FIELDS, 1)
    assert found.n.tolist() == [-1] * 5
    assert np.isnan(found.purity).all()
    assert np.isnan(found.angle).all()
    assert found.pairs == []
    assert found.rings is None
    np.testing.assert_array_equal(found.fields[0, 0], np.ones(5))


@pytest.mark.parametrize(("kept", "pairs"), [(2, ()), (3, ((1, 2),)), (5, ((1, 2),))])
def test_the_first_modes_keep_pairs_that_are_whole(kept, pairs):
    found = first_modes(FREQ, make_labels(RINGS, FREQ, FIELDS, 1), kept)
    assert found["doublets"] == pairs
    assert found["freq"].tolist() == FREQ[:kept].tolist()
    assert found["fields"].shape == (2, 3, kept)
    assert found["meridional"].tolist() == [1, 1, 1, 1, 1][:kept]
    np.testing.assert_allclose(found["angle_deg"][:2], np.degrees([NAN, PSI]), rtol=1e-9)


def test_the_share_of_the_finest_polynomials_is_that_of_legendre():
    """On one element of order 3: P_3 along the span, P_3 across; their mean squares are 1/7."""
    chart, mesh = cf.Plate(length=2.0, width=2.0), cf.ShellMesh(order=3, rows=1, around=1)
    grid = make_grid(chart, mesh)
    a, b = grid.nodes
    s, t = a - 1.0, b - b.mean()
    third = (5.0 * s**3 - 3.0 * s) / 2.0, (5.0 * t**3 - 3.0 * t) / 2.0
    fields = np.zeros((len(s), 5, 2))
    fields[:, 0, 0], fields[:, 2, 0] = 3.0 * third[0], 2.0
    fields[:, 1, 1], fields[:, 2, 1] = third[1] * s, 1.0
    fields[:, 4] = 100.0 * third[0][:, None]  # rotations do not count
    found = finest_shares(SimpleNamespace(grid=grid, fields=fields))
    along = np.sqrt((9.0 / 7.0) / (9.0 / 7.0 + 4.0))
    across = np.sqrt((1.0 / 21.0) / (1.0 / 21.0 + 1.0))
    np.testing.assert_allclose(found, [[along, 0.0], [0.0, across]], atol=1e-9)


@pytest.mark.parametrize("round_", [True, False])
def test_equal_elements_split_the_pairs_whose_waves_they_divide(round_):
    modes = SimpleNamespace(
        nodal_diameters=np.array([-1, 0, 3, 4, 6, 9, 12]), grid=SimpleNamespace(mesh=SimpleNamespace(around=12)),
        shell=SimpleNamespace(chart=SimpleNamespace(axisymmetric=round_)),
    )  # fmt: skip
    assert split_by_mesh(modes).tolist() == [False, False, False, False, round_, False, round_]
