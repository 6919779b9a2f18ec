"""When a contact closes and opens: a mass on a wall, pressed by cos(2 pi t), is pulled off at t = 1/4; first forces."""

import numpy as np
import pytest

import contact as ct

pytestmark = pytest.mark.slow  # whichever comes first compiles the loop

OPENS = 0.25
SCHEMES = {
    "forward-lagrange": ct.CentralDifference(),
    "cd-lagrange": ct.scheme.CDLagrange(),
    "paoli-schatzman": ct.scheme.PaoliSchatzman(),
    "massless-boundary": ct.scheme.MasslessBoundary(),
    "newmark": ct.scheme.Newmark(),
    "stabilised-newmark": ct.scheme.StabilisedNewmark(),
    "hht": ct.scheme.HHT(),
    "moreau-jean": ct.MoreauJean(),
    "nonsmooth-alpha": ct.scheme.NonsmoothAlpha(),
    "projected-alpha": ct.scheme.ProjectedAlpha(),
}


@pytest.mark.parametrize(
    "name",
    ["forward-lagrange", "cd-lagrange", "paoli-schatzman", "moreau-jean", "stabilised-newmark", "projected-alpha"],
)
def test_a_contact_opens_within_half_a_step_neither_early_nor_late(name):
    late = []
    for part in np.linspace(0.03, 0.97, 12):  # where in a step the force ends
        scene = ct.Scene(
            what=[ct.PointMass(mass=1.0, force=1.0, force_hz=1.0), ct.Wall()], t_end=0.4, dt=OPENS / (40.0 + part),
            scheme=SCHEMES[name],
        )  # fmt: skip
        result = ct.run(scene)
        begins, ends = np.array(result.intervals[0]).T
        assert begins[0] == 0.0
        late.append((ends[-1] - OPENS) / result.dt)
    assert np.abs(late).max() < 0.51
    assert abs(np.mean(late)) < 0.05


@pytest.mark.parametrize("name", SCHEMES)
@pytest.mark.parametrize("speed", [-0.3, -0.02, 0.0])
def test_a_contact_closes_in_the_step_that_has_its_first_force(name, speed):
    """A mass above its wall, carried across the gap within one step by its weight rather than its speed."""
    if name == "massless-boundary":
        ball = ct.Rod(length=0.1, area=1.0, E=1e3, rho=20.0, elements=2, x=0.01, velocity=speed)
    else:
        ball = ct.PointMass(mass=2.0, x=0.01, velocity=speed)
    dt = 0.1 if name != "massless-boundary" else 0.005
    result = ct.run([ct.Wall(), ball], scheme=SCHEMES[name], t_end=0.3, dt=dt, gravity=10.0)
    ((begin, _), *_) = result.intervals[0]
    first = result.time[result.force[:, 0] > 0.0][0]
    assert abs(begin - first) <= 1.5 * dt
    assert abs(begin - (speed + np.sqrt(speed**2 + 0.2)) / 10.0) <= 1.01 * dt
    assert all(begin < end for begin, end in result.intervals[0])


@pytest.mark.parametrize("name", SCHEMES)
@pytest.mark.parametrize(("speed", "gravity"), [(-1.0, 0.0), (0.0, 10.0)], ids=["struck", "pressed"])
def test_a_contact_that_is_closed_from_the_start_closes_at_zero(name, speed, gravity):
    bar = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=10, velocity=speed)
    result = ct.run([ct.Wall(), bar], scheme=SCHEMES[name], t_end=0.5, dt=0.01, gravity=gravity,
                    on_limit="flag")  # fmt: skip
    assert result.intervals[0][0][0] == pytest.approx(0.0, abs=1e-12)
    assert all(begin < end for begin, end in result.intervals[0])


def test_an_implicit_beam_closes_in_the_step_before_its_first_force():
    """Forces of Newmark are at the end of their step; the closing is known to a part of it, whatever the step."""
    beam = ct.bodies.HingedBeam(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, torque=1.0, elements=6)
    circle = ct.bodies.BeamInCircle(beam, radius=0.502, offset=6e-3)
    begins = []
    for dt in (1e-4, 1.03e-4):
        run = ct.run(
            circle, scheme=ct.scheme.Newmark(beta=0.5, gamma=0.55), t_end=1.02 * circle.first_contact_time, dt=dt
        )
        begins.append(run.intervals[-1][0][0])
        first = run.time[run.force[:, -1] > 0.0][0]
        assert first - dt < begins[-1] < first
    assert begins[0] == pytest.approx(begins[1], abs=1e-5)
