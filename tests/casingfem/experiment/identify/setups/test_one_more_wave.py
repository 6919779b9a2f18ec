"""One more mode in a small cluster of waves, and what the whole search makes of it."""

import numpy as np
import pytest

from casingfem.experiment.identify.setups.wave_fit import WaveRead, fitted, rms, wave_fit
from casingfem.experiment.identify.setups.wave_model import Shapes
from casingfem.experiment.identify.setups.wave_residues import unlikely_at
from casingfem.experiment.identify.setups.wave_search import GAIN, _resized, _searched, wave_modes
from casingfem.experiment.identify.setups.wave_tries import _kinds, one_more
from tests.casingfem.experiment.identify.setups.test_wave_likelihood import (
    FREQ,
    KIND,
    LINES,
    SETUPS,
    SHIFT,
    SIZE,
    ZETA,
    problem,
    waves,
)


def one_known(whole):
    """The cluster as if one of its modes alone were known."""
    few = whole._replace(cluster=whole.cluster._replace(modes=whole.cluster.modes.some(np.array([0]))))
    shapes = Shapes(KIND[:1], SIZE[:1])
    return few, WaveRead(shapes, fitted(few, shapes, np.log(FREQ[:1]), np.log(ZETA[:1])))


@pytest.mark.slow
def test_a_mode_that_nobody_knew_of_is_found_as_the_wave_that_it_is():
    whole, read = one_known(problem())
    more = one_more(whole, read)
    assert more.read.shapes.kind.tolist() == KIND.tolist()
    np.testing.assert_allclose(np.exp(more.read.fit.p), FREQ, atol=0.1)
    price = (3 + 1) * np.log(2 * len(LINES) * 7) + 2.0 * 7 * np.log(2.0)
    assert more.worth == pytest.approx((read.fit.unlikely - more.read.fit.unlikely) / price, rel=1e-9)
    assert more.worth > 1.0


@pytest.mark.slow
def test_no_mode_is_found_beyond_five_times_the_usual_damping():
    whole, read = one_known(problem())
    for usual, found in ((0.02 / 4.5, True), (0.02 / 5.5, False)):
        modes = whole.cluster.modes._replace(zeta=np.array([usual]))
        more = one_more(whole._replace(cluster=whole.cluster._replace(modes=modes)), read)
        assert bool(more is not None and more.read.fit.q[-1] > np.log(0.0183)) is found


def test_the_last_mode_is_tried_as_the_likeliest_wave_and_as_a_local_one():
    whole, read = one_known(problem())
    (_, wave), (trying, local) = _kinds(whole, read, np.log(FREQ), np.log(ZETA))
    assert wave.kind.tolist() == KIND.tolist()
    assert local.kind.tolist() == [KIND[0], 3]
    assert trying.waves.columns.shape[0] == 4
    p, q = np.log(FREQ), np.log(ZETA)
    strongest = np.argsort(-np.abs(wave_fit(whole, Shapes(np.array([1, 2]), SIZE[[0, 0]]), p, q).residues[1]))
    each = [whole._replace(waves=waves().seen_by(strongest[:count])) for count in (1, 2, 3)]  # half of seven at most
    unlikely = [unlikely_at(one, local, one.products(p, q)) for one in each]
    count = 1 + int(np.argmin(unlikely))
    assert set(np.flatnonzero(trying.waves.off[3] == 3.0)) == set(strongest[:count])
    assert set(np.unique(trying.waves.off[3])) == {0.03, 3.0}
    assert wave.size[0] == SIZE[0]
    assert wave.size[1] == local.size[1]


@pytest.mark.slow
def test_a_likelier_reading_is_kept_and_what_else_was_tried_is_told():
    whole = problem()
    swapped = FREQ.copy()
    swapped[:, 1] = FREQ[::-1, 1]
    shapes = Shapes(KIND, SIZE)
    read = WaveRead(shapes, fitted(whole, shapes, np.log(swapped), np.log(ZETA), 0))
    best, tried, moved = _searched(whole, read, {0, 1})
    assert best.fit.unlikely < read.fit.unlikely - GAIN
    assert moved == {0, 1}
    assert (0, 1) in tried
    assert all(other.some.tolist() == [0, 1] for other in tried[0, 1])
    assert len(tried[0, 1]) > 3
    assert min(other.rise for other in tried[0, 1]) >= 0.0
    nothing, none, still = _searched(whole, read, set())
    assert nothing is read
    assert (none, still) == ({}, set())


def test_sizes_are_those_that_lead_to_each_other():
    whole = problem()
    shapes = Shapes(KIND, SIZE * np.array([3.0, 0.2]))
    read = WaveRead(shapes, fitted(whole, shapes, np.log(FREQ), np.log(ZETA)))
    found = _resized(whole, read, shapes.size)
    means = [waves().columns[kind] @ x for kind, x in zip(KIND, found.fit.x, strict=True)]
    np.testing.assert_allclose(found.shapes.size, rms(np.array(means)), rtol=0.05)
    assert found.fit.unlikely < read.fit.unlikely - GAIN


@pytest.mark.slow
def test_a_whole_search_tells_modes_that_were_exchanged():
    c = problem().cluster
    start = np.column_stack([FREQ[:, 0], FREQ[::-1, 1], FREQ[:, 2]])
    found = wave_modes(SETUPS, waves(), SHIFT, c._replace(modes=c.modes._replace(freq=start)))
    order = np.argsort(found.freq.mean(axis=1))
    assert np.all(np.abs(np.log(found.freq[order] / FREQ)) < 4.0 * np.sqrt(found.variance[order]))
    np.testing.assert_allclose(found.zeta[order], ZETA, rtol=0.1)
    size = rms(found.residues[order]) / c.window.freq.mean()
    np.testing.assert_allclose(size, rms(c.modes.residues * c.window.weight), rtol=0.1)
    assert found.worth.size == 0
