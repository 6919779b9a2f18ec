"""Tensor meshes over charts: numbering, seam, edges, interpolation along a rim."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

GRADED = (0.0, 0.03, 0.5, 0.9, 1.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"order": 1}, r"mesh\.order"),
        ({"around": 0}, r"mesh\.around"),
        ({"rows": 0}, r"mesh\.rows"),
        ({"rows": (0.0,)}, r"mesh\.rows"),
        ({"rows": (0.0, 0.5)}, r"mesh\.rows"),
        ({"rows": (0.1, 1.0)}, r"mesh\.rows"),
        ({"rows": (0.0, 0.6, 0.5, 1.0)}, r"mesh\.rows"),
        ({"rows": (0.0, 0.5, 0.5, 1.0)}, r"mesh\.rows"),
        ({"rows": (0.0, float("nan"), 1.0)}, r"mesh\.rows"),
    ],
)
def test_refuses_a_mesh_that_is_none(changes, message):
    with pytest.raises(ValueError, match=message):
        cf.ShellMesh(**changes)


def test_columns_of_unequal_width_give_the_same_modes_of_a_smooth_plate(steel):
    """Held on all sides it has no shear layers: order 8 resolves it on both."""
    plate = cf.Shell(chart=cf.Plate(length=0.3, width=0.2), thickness=5e-3, material=steel,
                     supports=dict.fromkeys(("root", "tip", "left", "right"), cf.Clamped()))  # fmt: skip
    even, graded = (replace(plate, mesh=cf.ShellMesh(rows=4, around=around))
                    for around in (4, (0.0, 0.07, 0.4, 0.93, 1.0)))  # fmt: skip
    assert graded.mesh.columns == 4
    np.testing.assert_allclose(cf.modes(graded, 6).freq, cf.modes(even, 6).freq, rtol=1e-4)


def test_columns_of_unequal_width_are_refused_around_a_casing(steel):
    with pytest.raises(cf.errors.ModelError, match=r"mesh\.around: found break points on a closed chart.*mesh-around"):
        cf.Shell(chart=cf.Cylinder(radius=0.3, height=0.2), thickness=3e-3, material=steel,
                 mesh=cf.ShellMesh(around=(0.0, 0.4, 1.0)))  # fmt: skip


def test_defaults_and_breaks_of_a_mesh():
    assert cf.ShellMesh() == cf.ShellMesh(order=8, rows=1, around=21)
    assert cf.ShellMesh(rows=4).breaks.tolist() == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert cf.ShellMesh(rows=GRADED).breaks.tolist() == list(GRADED)


@pytest.mark.parametrize("changes", [{"order": 2}, {"order": 20}, {"around": 1}, {"rows": 1}, {"rows": (0.0, 1.0)},
                                     {"order": np.int64(3), "rows": np.int64(2), "around": np.int64(5)}])  # fmt: skip
def test_the_ends_of_what_a_mesh_may_be_are_taken(changes):
    assert cf.ShellMesh(**changes).breaks[-1] == 1.0


@pytest.mark.parametrize(("changes", "message"), [
    ({"order": 21}, r"mesh\.order must be a whole number from 2 to 20, found 21"),
    ({"order": 4.0}, r"mesh\.order .*found 4\.0"),
    ({"around": 2.5}, r"mesh\.around must be a whole number of at least 1, or break points from 0 to 1, found 2\.5"),
])  # fmt: skip
def test_refuses_numbers_beyond_the_ends(changes, message):
    with pytest.raises(ValueError, match=message):
        cf.ShellMesh(**changes)


def test_a_mesh_of_more_unknowns_than_memory_has_is_refused():
    """5 x 20^2 x 10 x 100 = 2 000 000 unknowns are taken."""
    assert cf.ShellMesh(order=20, rows=10, around=100).around == 100
    with pytest.raises(ValueError, match=r"mesh: some 2e\+06 unknowns"):
        cf.ShellMesh(order=20, rows=10, around=101)
    with pytest.raises(ValueError, match="unknowns"):
        cf.ShellMesh(order=20, rows=tuple(np.linspace(0.0, 1.0, 12)), around=100)
