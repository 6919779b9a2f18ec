"""Skips over contact-free time: the same end as without, to the round-off of the steps."""

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.contact.turning_ring import turning_ring

pytestmark = pytest.mark.slow  # whichever comes first compiles the loop

DT = 2e-5
SPARSE = ct.Record(every=500, state_every=1000)


def lobed(*, clearance=2e-4, zeta=0.01, imperfect=0.0, speed_hz=20.0, made=ring, **more):
    """Two lobes reach .05 mm into the blade's circle, twice a turn."""
    return ct.RotatingRim(
        made(S=4e-7, zeta=zeta, imperfect=imperfect), blade(S=1e-6, zeta=zeta), clearance=clearance, speed_hz=speed_hz,
        lean_deg=25.0, out_of_roundness=[{"p": 2, "cos": 2.5e-4}], angle_deg=45.0, **more,
    )  # fmt: skip


def pair(scene, t_end=0.2, **settings):
    return [
        ct.run(scene, t_end=t_end, dt=DT, scheme=ct.ExactModal(skip=skip), record=SPARSE, **settings)
        for skip in (True, False)
    ]


@pytest.mark.parametrize(
    ("imperfect", "mu", "more"),
    [(0.0, 0.0, {}), (0.05, 0.2, {}), (0.05, 0.2, {"made": turning_ring, "turning": "casing"})],
    ids=["perfect", "imperfect", "gyroscopic"],
)
def test_the_same_run_with_and_without_skips(imperfect, mu, more):
    scene = lobed(imperfect=imperfect, **more)
    leaping, plain = pair(scene, law=ct.Coulomb(mu=mu) if mu else ct.Unilateral())
    assert not np.array_equal(leaping.state, plain.state)  # it skips
    assert 0.02 < plain.contact_steps[0] / plain.steps < 0.5
    assert len(plain.merged_intervals()[0]) >= 7
    scale, digits = np.abs(plain.state).max(), 1e-10 if more else 1e-11  # the eigenvectors of coupled modes lose one
    assert np.abs(leaping.state - plain.state).max() <= digits * scale
    assert np.allclose(leaping.gap, plain.gap, rtol=0.0, atol=digits * np.abs(plain.gap).max())
    assert np.array_equal(leaping.time, plain.time)
    assert np.array_equal(leaping.contact_steps, plain.contact_steps)
    assert leaping.impulse[0] == pytest.approx(plain.impulse[0], rel=digits)
    assert np.allclose(leaping.intervals[0], plain.intervals[0], rtol=0.0, atol=1e-10 * DT * plain.steps)
    for name in ("contact", "rotation", "friction", "damping", "algorithmic"):
        assert getattr(leaping.energy, name) == pytest.approx(getattr(plain.energy, name), rel=1e-9, abs=1e-15)
    assert abs(leaping.energy.unaccounted) <= 1e-11 * leaping.energy.scale


def test_a_blade_out_of_reach_skips_all_the_way():
    far = lobed(clearance=0.03, zeta=0.0, blade_velocity=[0.3, -0.2], casing_velocity=np.linspace(0.1, 1.0, 10))
    leaping, plain = pair(far, t_end=1.0)
    assert np.abs(leaping.state - plain.state).max() <= 1e-10 * np.abs(plain.state).max()
    assert leaping.energy.end.total == pytest.approx(leaping.energy.start.total, rel=1e-9)
    assert leaping.steps == 50_000


def test_undamped_coupled_modes_out_of_reach_keep_their_energy():
    far = lobed(
        clearance=0.03, zeta=0.0, made=turning_ring, turning="casing", imperfect=0.02,
        casing_velocity=np.linspace(0.1, 1.0, 10),
    )  # fmt: skip
    leaping, plain = pair(far, t_end=1.0)
    assert np.abs(leaping.state - plain.state).max() <= 1e-9 * np.abs(plain.state).max()
    assert abs(leaping.energy.unaccounted) <= 1e-9 * leaping.energy.scale
    assert abs(leaping.energy.damping) <= 1e-10 * leaping.energy.scale
    assert abs(leaping.energy.algorithmic - plain.energy.algorithmic) <= 1e-10 * leaping.energy.scale
