"""How channels become a grid of sensors and references, and what a unit says of the form of a response."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.frf.sensor_grid import angles_of, form_of, radial_signs, sensor_grid


def frfs(**changes):
    given = {"kind": "frf", "x": [10.0, 20.0, 40.0], "responses": [[1.0, 2.0, 3.0j]], "unit": "m/N"}
    return cf.frf.FrfSet.from_arrays(**given | changes)


def test_channels_are_sorted_by_sensor_and_reference():
    """Two sensors, one of them turned over, by two references; channels in any order."""
    given = frfs(
        responses=np.ones((4, 3)), response_point=[9, 3, 9, 3], response_direction=[1, -1, 1, -1],
        reference_point=[5, 5, 4, 4], reference_direction=[3, 3, 3, 3],
    )  # fmt: skip
    grid = sensor_grid(given, {3: 90.0, 9: 30.0}, {9: [1.0, 2.0, 3.0]})
    assert (grid.points.tolist(), grid.directions.tolist()) == ([3, 9], [-1, 1])
    assert grid.references.tolist() == [[4, 3], [5, 3]]
    assert grid.channels.tolist() == [[3, 1], [2, 0]]
    np.testing.assert_allclose(grid.theta, np.radians([90.0, 30.0]), rtol=1e-15)
    np.testing.assert_array_equal(grid.places, [[np.nan] * 3, [1.0, 2.0, 3.0]])
    assert radial_signs(grid).tolist() == [-1.0, 1.0]
    assert radial_signs(sensor_grid(frfs(), None)).tolist() == [1.0]
    assert not grid.channels.flags.writeable
    assert len(grid) == 2
    assert np.isnan(sensor_grid(given, None).theta).all()
    with pytest.raises(cf.errors.InputError, match="found no angle for point 9; expected an angle of every sensor"):
        sensor_grid(given, {3: 90.0})
    with pytest.raises(cf.errors.InputError, match="found no angle for point 3"):
        sensor_grid(given, {3: np.inf, 9: 30.0})
    with pytest.raises(
        cf.errors.InputError, match="found channels 2 and 4 from the same sensor to the same reference; expected ea"
    ):
        sensor_grid(replace(given, reference_point=[5, 5, 4, 5]), None)
    some = frfs(responses=np.ones((3, 3)), response_point=[9, 3, 9], reference_point=[5, 5, 4])
    with pytest.raises(
        cf.errors.InputError, match="found no channel from point 3 to reference 4; expected every sensor with every"
    ):
        sensor_grid(some, None)


FORMS = {
    "m/N": 0, "mm/kN": 0, "(um)/(N)": 0, "m/s/N": 1, "(m/sec)/N": 1, "(m/s^2)/N": 2, "g/N": 2, "G / lbf": 2,
    "m/s**2/mN": 2,
    "1/N*m/s2": 2, "m/s²/V": 2, "m/sec2/N": 2, "": None, "1": None, "none": None, "m": 0,
}  # fmt: skip


@pytest.mark.parametrize("unit", FORMS)
def test_a_unit_says_how_many_derivatives_a_response_is_above_a_receptance(unit):
    assert form_of(frfs(unit=unit), None) == FORMS[unit]


def test_a_form_that_is_said_counts_and_an_unknown_unit_is_refused():
    for form, power in (("receptance", 0), ("mobility", 1), ("accelerance", 2)):
        assert form_of(frfs(unit="Pa/N"), form) == power
    with pytest.raises(
        cf.errors.InputError, match=r"found unit 'Pa/N'; expected one such as \(m/s\^2\)/N, or form=receptance|mobi"
    ):
        form_of(frfs(unit="Pa/N"), None)
    with pytest.raises(
        cf.errors.InputError, match="found form 'compliance'; expected receptance or mobility or accelerance"
    ):
        form_of(frfs(unit="m/N"), "compliance")


def test_angles_of_places_are_about_z():
    found = angles_of({4: np.array([0.0, 2.0, 9.0]), 7: np.array([-1.0, 0.0, 1.0]), 8: np.array([1.0, -1.0, 0.0])})
    assert found == {4: pytest.approx(90.0), 7: pytest.approx(180.0), 8: pytest.approx(-45.0)}
