"""What charts, strips, stations, tapers and axes are asked, at their bounds; rigid motions of any body."""

import numpy as np
import pytest

import casingfem as cf


def test_a_taper_is_the_product_of_its_laws():
    taper = cf.Taper(along=(1.0, 0.5), across=(0.4, 1.0))
    found = taper.factor(((1.0, 3.0), (-1.0, 4.0)), np.array([1.5]), np.array([1.0]))
    assert found.tolist() == pytest.approx([0.875 * 0.64], rel=1e-14)
    assert taper.lowest == pytest.approx(0.2, rel=1e-14)
    assert (taper.even, cf.Taper(along=(1.0, 0.5)).even, cf.Taper(across=(1.0,)).even) == (False, True, True)
    with pytest.raises(ValueError, match=r"taper\.across falls to 0"):
        cf.Taper(across=(1.0, 0.0))
