"""The two modes of a pair in parts: waves, their slopes, the best linear part, the sigma of what is told."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.circle.test_circle_scan import SEED, close_pair, scan_of_a_pair


@pytest.mark.slow
def test_a_misfit_above_one_raises_the_sigma_and_one_below_does_not_lower_them():
    """With the noise said to be a sixteenth of that the misfit is 16 times as large, for the same deviations."""
    seen = close_pair(np.random.default_rng(SEED))
    low, high = (cf.circle.split_pair(replace(seen, sigma=factor * seen.sigma), 8) for factor in (0.25, 4.0))
    assert high.misfit < 1.0 < low.misfit == pytest.approx(16.0 * high.misfit, rel=1e-6)
    np.testing.assert_allclose(high.freq_sigma / low.freq_sigma, 16.0 / low.misfit, rtol=1e-4)


@pytest.mark.slow
def test_six_tones_show_a_pair_and_five_do_not():
    seen = scan_of_a_pair([369.0, 371.0])
    assert cf.circle.split_pair(seen, 8).split == pytest.approx(2.0, rel=1e-6)
    fewer = replace(seen, tones=seen.tones[:5], V=seen.V[:5], sigma=seen.sigma[:5], floor=seen.floor[:5])
    with pytest.raises(cf.errors.InputError, match="the pair n = 8: found 5 tones, expected 6 or more across it"):
        cf.circle.split_pair(fewer, 8)
    for n in (0, 7, -8):
        with pytest.raises(cf.errors.InputError, match=f"order n = {n}: expected one of the fitted orders, 1 or more"):
            cf.circle.split_pair(seen, n)
