"""Motions for ParaView: how far points are moved, and what is true at them."""

import numpy as np
import pytest

from casingfem.export.meshes import frames, motion_files, point_files
from contact.io.outfiles import write_files
from tests.casingfem.export.played import steps_of

BOX = np.array([3.0, 4.0, 12.0]) * [
    [0, 0, 0],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
]
HEXAHEDRON = np.array([[12, *range(8)]])


@pytest.mark.parametrize("place", [0.0, 100.0])
def test_the_largest_displacement_is_drawn_as_a_twentieth_of_the_diagonal(place, tmp_path):
    """Of a box of 3 x 4 x 12, whose diagonal is 13, wherever it stands."""
    moved = np.zeros((2, 8, 3))
    moved[0, 2], moved[1, 6] = [1e-6, 0.0, 0.0], [0.0, 1.2e-6, -1.6e-6]
    write_files(tmp_path, motion_files("box", BOX + place, HEXAHEDRON, [0.0, 0.5], moved))
    assert [path.name for path in tmp_path.iterdir()] == ["box.vtkhdf"]
    for k, found in enumerate(steps_of(tmp_path / "box.vtkhdf")):
        np.testing.assert_allclose(found.points - BOX - place, 0.05 * 13.0 / 2e-6 * moved[k], atol=2e-5)
        np.testing.assert_allclose(found.point_data["displacement"], moved[k], rtol=1e-6)
        np.testing.assert_allclose(found.field_data["exaggeration"], 0.05 * 13.0 / 2e-6)
        assert (found.cells, found.kinds.tolist(), found.time) == ([list(range(8))], [12], 0.5 * k)


def test_what_does_not_move_is_drawn_where_it_is(tmp_path):
    write_files(tmp_path, motion_files("box", BOX, HEXAHEDRON, [0.0], np.zeros((1, 8, 3))))
    (found,) = steps_of(tmp_path / "box.vtkhdf")
    assert np.array_equal(found.points, BOX)
    assert found.field_data["exaggeration"] == 1.0


def test_points_have_their_own_places_instants_and_data(tmp_path):
    """Three instants of two points, all numbers different."""
    time, places = [0.25, 0.5, 2.0], np.arange(18.0).reshape(3, 2, 3)
    force = 100.0 + np.arange(6.0).reshape(3, 2)
    moved = np.arange(72.0).reshape(3, 8, 3)
    write_files(tmp_path, point_files("tips", time, places, {"force_N": force}))
    write_files(tmp_path, motion_files("box", BOX, HEXAHEDRON, time, moved))
    for k, found in enumerate(steps_of(tmp_path / "tips.vtkhdf")):
        assert found.time == time[k]
        assert np.array_equal(found.points, places[k])
        assert (found.cells, found.kinds.tolist()) == ([[0], [1]], [1, 1])
        assert found.point_data["force_N"].tolist() == force[k].tolist()
    assert [found.time for found in steps_of(tmp_path / "box.vtkhdf")] == time


def test_the_instants_shown_are_spread_evenly_from_the_first_to_the_last():
    for count, most in ((100, 100), (101, 100), (199, 100), (5000, 7), (1, 4)):
        shown = frames(count, most)
        assert (shown[0], shown[-1], len(shown)) == (0, count - 1, min(count, most))
        assert len(shown) == 1 or np.ptp(np.diff(shown)) <= 1
