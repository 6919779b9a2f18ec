"""Rigid motions, axes of rotation, bends of a meridian and places of a survey on it, by written-out numbers."""

import numpy as np
import pytest

import casingfem as cf


def test_an_axis_and_its_plane():
    rotation = cf.Rotation(omega=3.0, axis=(1.0, -2.0, 2.0), centre=(4.0, 5.0, 6.0))
    np.testing.assert_allclose(rotation.direction, [1 / 3, -2 / 3, 2 / 3], rtol=1e-15)
    np.testing.assert_allclose(rotation.plane, np.array([[8, 2, -2], [2, 5, 4], [-2, 4, 5]]) / 9.0, rtol=1e-14)
    assert rotation.at(5.0) == cf.Rotation(omega=5.0, axis=(1.0, -2.0, 2.0), centre=(4.0, 5.0, 6.0))
    assert cf.Rotation(omega=1.0).centre == (0.0, 0.0, 0.0)
    for given, words in (
        ({"omega": np.inf}, "rotation.omega: found inf"),
        ({"axis": (0.0, 0.0, 0.0)}, "found axis"),
        ({"centre": (0.0, np.nan, 0.0)}, "through"),
        ({"axis": (np.inf, 0.0, 1.0)}, "found axis"),
    ):
        with pytest.raises(ValueError, match=words):
            cf.Rotation(**{"omega": 1.0} | given)


@pytest.mark.parametrize(("fillet", "words"), [(0.0, "found 0 m at a corner"), (0.101, r"found 0\.101 m, expected")])
def test_fillets_that_do_not_fit(fillet, words):
    pieces = [cf.geometry.Piece(to=(0.3, 0.1)), cf.geometry.Piece(to=(0.4, 0.1), fillet=0.099)]
    assert cf.geometry.PiecewiseMeridian(start=(0.3, 0.0), pieces=pieces, fillet=fillet).bends[
        1
    ].kappa == pytest.approx(-1 / 0.099)
    with pytest.raises(ValueError, match=words):
        cf.geometry.PiecewiseMeridian(
            start=(0.3, 0.0), pieces=[pieces[0], cf.geometry.Piece(to=(0.4, 0.1))], fillet=fillet
        )
    with pytest.raises(ValueError, match="found none, expected one or more"):
        cf.geometry.PiecewiseMeridian(start=(0.3, 0.0), pieces=())
