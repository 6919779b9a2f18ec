"""Growth of closed contact of many cases at once: that of each case by itself."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.loop.poles import Varied, Work, largest_growths
from tests.contact.synthetic_rim import blade, ring

SPEEDS = np.array([6.0, 20.0, 31.0])


def cases(count, modes, seed=3):
    rng = np.random.default_rng(seed)
    return ct.stability.Cases(
        casing=np.repeat(1.0 + 0.02 * rng.standard_normal((count, modes // 2)), 2, axis=1),
        blade=1.0 + 0.05 * rng.standard_normal(count), mu=0.4 * rng.random(count),
    )  # fmt: skip


def alone(rim, varied, k):
    """One case as bodies of their own."""
    own = rim.blade.retuned(float(varied.blade[k]) * float(rim.blade.omega[0]) / (2.0 * np.pi))
    casing = replace(rim.casing, omega=rim.casing.omega * varied.casing[k])
    return ct.stability.of_rim(replace(rim, casing=casing, blade=own), SPEEDS, mu=float(varied.mu[k])).growth


@pytest.mark.slow
@pytest.mark.parametrize("turning", ["blades", "casing"])
def test_growth_of_a_case_is_that_of_its_own_bodies(turning):
    rim = ct.RotatingRim(ring(), blade(), clearance=0.0, speed_hz=5.0, lean_deg=10.0, turning=turning)
    varied = cases(4, rim.casing.omega.size)
    found = ct.stability.growth_of_cases(rim, SPEEDS, varied)
    expected = np.array([alone(rim, varied, k) for k in range(4)])
    assert expected.max() > 1.0
    assert np.allclose(found, expected, rtol=1e-7, atol=1e-7)


@pytest.mark.slow
def test_roots_of_each_case_are_eigenvalues_and_every_case_converges():
    """The roots of S + sum a/(s - p) are the eigenvalues of diag(p) - a 1^T/S.

    A case that does not converge is solved by itself: its growth is right, and it takes a hundred times as long.
    """
    rng, N, count, bodies = np.random.default_rng(11), 12, 40, 4
    p, turned = -rng.uniform(0.5, 4.0, N) + 1j * rng.uniform(-900.0, 900.0, N), 35.0 * rng.integers(-6, 7, N)
    a, b = (size * (rng.standard_normal(N) + 1j * rng.standard_normal(N)) for size in (0.5, 0.2))
    body, scale = rng.integers(0, bodies, N), 1.0 + 0.05 * rng.standard_normal((count, bodies))
    mu, S = rng.uniform(0.0, 0.4, count), rng.uniform(0.1, 0.4, count)
    given = [np.ascontiguousarray(part) for part in (p.real, p.imag, turned, a.real, a.imag, b.real, b.imag)]
    growth = np.empty(count)
    work = Work(np.zeros((8, N)), np.zeros(N, dtype=np.int64))
    largest_growths(Varied(*given, body=body, scale=scale, mu=mu, S=S), work, growth, 60, 1e-12)
    ratio = scale[:, body]
    poles, residues = ratio * p - 1j * turned, (a + mu[:, None] * b) / ratio
    whole = poles[:, :, None] * np.eye(N) - residues[:, :, None] / S[:, None, None]
    np.testing.assert_allclose(growth, np.linalg.eigvals(whole).real.max(axis=1), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("what", "speeds", "varied", "words"),
    [
        ({}, [0.0, 5.0], {}, "above 0"),
        ({}, [5.0], {"casing": np.ones((2, 3))}, "3 modes, expected 10"),
        ({}, [5.0], {"mu": np.array([0.1, -0.1])}, "friction < 0"),
        ({}, [5.0], {"blade": np.array([1.0, 0.0])}, "ratios <= 0"),
        ({}, [5.0], {"casing": np.linspace(1.0, 1.1, 20).reshape(2, 10)}, "different frequency ratios of casing modes"),
        ({}, [5.0], {"mu": np.zeros(3)}, "expected \\(cases, modes\\)"),
    ],
)
def test_cases_that_cannot_be_are_refused(what, speeds, varied, words):
    rim = ct.RotatingRim(ring(), blade(), clearance=0.0, speed_hz=5.0, **what)
    given = {"casing": np.ones((2, 10)), "blade": np.ones(2), "mu": np.zeros(2)} | varied
    with pytest.raises(ct.InputError, match=words):
        ct.stability.growth_of_cases(rim, np.array(speeds), ct.stability.Cases(**given))
