"""What reading adds to a file's arrays: units, blocks, copies, flags, numbers that are too large."""

from pathlib import Path

import numpy as np
import pytest

import casingfem as cf

FILE = Path("part.msh")


@pytest.mark.parametrize(("given", "told"), [
    ({"scale": 0.0}, "scale must be above 0, found 0.0"), ({"scale": -1.0}, "scale must be"),
    ({"scale": np.inf}, "scale must be above 0, found inf"), ({"join": -1e-9}, "join must be 0 or a distance"),
    ({"join": np.inf}, "join must be 0 or a distance, found inf"),
])  # fmt: skip
def test_scale_and_join_are_finite_numbers(given, told):
    with pytest.raises(cf.errors.ModelError, match=f"part.msh: {told}"):
        cf.read_mesh(FILE, **given)


def test_endings_that_no_reader_has_are_refused():
    with pytest.raises(cf.errors.ModelError, match=r"part\.stp: found the ending '\.stp'"):
        cf.read_mesh("part.stp")


@pytest.mark.parametrize("directions", [(), ("x", "x"), ("x", "w"), ("r",)])
def test_directions_are_some_of_the_axes_each_once(directions):
    with pytest.raises(ValueError, match=r"directions must name some of x, y, z, each once, found \("):
        cf.imported.Fixed(directions=directions)
    assert cf.imported.Fixed(directions=["z", "y"]).directions == ("z", "y")
    assert cf.imported.Fixed(directions=("z", "y")).held == (2, 1)
