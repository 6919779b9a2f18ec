"""Corrections of gaps and of rates by turns in projected steps, and what is noted of them; uncompiled."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.contact.plain import names

N = names("loop.linear.moreau", "record.record", "solver.unilateral.complementarity")
RIGID = N.LawNumbers(0.0, 0, 0.0, N.Several(used=True))


def solved(free, rate, gap_nu, gap_impulse, rate_nu, rate_impulse, *, damped=True):
    k = len(free)
    vector = {name: np.zeros(k) for name in ("nu", "given", "last")}
    c = N.Corrections(
        jump=np.zeros((k, 1)), of_nu=np.zeros((k, 1)), of_impulse=np.zeros((k, 1)), gap_nu=np.array(gap_nu),
        gap_impulse=np.array(gap_impulse), rate_nu=np.array(rate_nu), rate_impulse=np.array(rate_impulse),
        impulse=np.full(k, 7.0), rate=np.array(rate), **vector,
    )  # fmt: skip
    s = SimpleNamespace(free=np.array(free), closed=np.zeros(k), square=np.zeros((k, k)), shifted=np.zeros(k))
    return N.corrected(s, c, RIGID, damped), c.nu, c.impulse


@pytest.mark.parametrize("damped", [True, False])
def test_gaps_and_rates_are_complementary_to_their_corrections(damped):
    """Rates only of contacts whose gaps are corrected; without damping impulses leave gaps as they are."""
    rng, seen = np.random.default_rng(3), np.zeros(2)
    gap_nu, rate_impulse = np.array([[2.0, 0.5], [0.5, 1.5]]), np.array([[1.5, 0.3], [0.3, 1.0]])
    across, rates = 0.02 * rng.standard_normal((2, 2)) * damped, rng.standard_normal((2, 2))
    for _ in range(20):
        free, rate = rng.standard_normal((2, 2)) - 0.4
        found, nu, impulse = solved(free, rate, gap_nu, across, rates, rate_impulse, damped=damped)
        assert found
        gap, speed = free + gap_nu @ nu + across @ impulse, rate + rates @ nu + rate_impulse @ impulse
        assert min(nu.min(), impulse.min(), gap.min()) >= -1e-12
        np.testing.assert_allclose(nu * gap, 0.0, atol=1e-12)
        assert not impulse[nu == 0.0].any()
        assert (speed[nu > 0.0] >= -1e-12).all()
        np.testing.assert_allclose(impulse * speed, 0.0, atol=1e-12)
        seen += [(nu > 0.0).all(), (impulse > 0.0).any() and not (impulse > 0.0).all()]
    assert (seen > 1).all()


def test_levels_without_a_common_answer_are_told():
    """The impulse opens the gap, without which there is none."""
    assert not solved([-1.0], [-1.0], [[1.0]], [[2.0]], [[0.0]], [[1.0]])[0]
    assert solved([-1.0], [-1.0], [[1.0]], [[0.0]], [[0.0]], [[1.0]])[0]
    assert not solved([math.nan], [-1.0], [[1.0]], [[0.0]], [[0.0]], [[1.0]])[0]
    assert not solved([-1.0], [math.nan], [[1.0]], [[0.0]], [[0.0]], [[1.0]])[0]


@pytest.mark.parametrize(
    ("nu", "impulse", "violated"),
    [(0.2, 0.6, 0.5 * 0.9), (0.2, 0.1, 0.27), (0.0, 0.0, 0.0), (0.05, 0.01, 0.1)],
)
def test_both_levels_are_noted(nu, impulse, violated):
    """A gap of .3 + 1 - .5 * 2 = .3 that falls by .03; the rate after is 1.5 * (-2) + 5 = 2, over h = 1/2."""
    h, begin = 0.5, 3.0
    p = SimpleNamespace(columns=np.array([[0, 1]]), value=np.array([[1.0, -0.5]]), gap0=np.array([0.3]))
    s = SimpleNamespace(u=np.array([1.0, 2.0]), v=np.array([-1.5, 1.0]), force=np.zeros(1), gap=np.zeros(1))
    c = SimpleNamespace(nu=np.array([nu]), impulse=np.array([impulse]), gap_nu=[[2.0]], rate_impulse=[[1.5]])
    c.gap_nu, c.rate_impulse = np.array(c.gap_nu), np.array(c.rate_impulse)
    sums, out = N.tally(1), N.samples(N.Record(), 3, 1, 1)
    N.note_contacts(p, s, c, 0.5, np.array([-0.13, -0.2]), np.array([4.5, -1.0]), sums, out, begin, h)
    assert s.gap[0] == pytest.approx(0.27, rel=1e-12)
    assert s.force[0] == impulse / h
    assert sums.residual[0] == pytest.approx(violated, rel=1e-12)
    assert sums.work[0] == pytest.approx(-0.03 * impulse / h, rel=1e-12)
    assert sums.algorithmic[0] == pytest.approx(-5.0 * (nu - 0.5 * h * impulse) / h, rel=1e-12)
    assert sums.impulse[0] == pytest.approx(impulse, rel=1e-15)
    assert out.event_time[: sums.filled[2]].tolist() == ([pytest.approx(begin + 0.3 / 1.0 * h)] if impulse else [])
