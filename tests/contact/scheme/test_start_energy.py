"""The energy a run starts with is that of the given state, whatever the scheme, its step, damping or load."""

import numpy as np
import pytest

import contact as ct

SCHEMES = {
    "central": ct.CentralDifference(), "impact": ct.scheme.CDLagrange(restitution=0.5),
    "averaged": ct.scheme.PaoliSchatzman(restitution=0.5), "massless": ct.scheme.MasslessBoundary(),
    "newmark": ct.scheme.Newmark(beta=0.5, gamma=0.55), "hht": ct.scheme.HHT(), "moreau": ct.MoreauJean(),
    "stabilised": ct.scheme.StabilisedNewmark(), "alpha": ct.scheme.NonsmoothAlpha(rho_inf=0.8),
    "projected": ct.scheme.ProjectedAlpha(rho_inf=0.8),
}  # fmt: skip
SPEED = 3.0


@pytest.mark.slow  # loads a loop for each scheme
@pytest.mark.parametrize("name", SCHEMES)
@pytest.mark.parametrize("damping", [0.0, 400.0])
def test_a_thrown_damped_rod_starts_with_half_its_mass_times_speed_squared(name, damping):
    rod = ct.Rod(length=2.0, area=1.0, E=900.0, rho=1.0, elements=10, x=1.0, velocity=-SPEED, damping=damping)
    result = ct.run([rod, ct.Wall(x=0.0)], scheme=SCHEMES[name], t_end=0.02, dt=0.002, gravity=9.81)
    energy = result.energy
    assert energy.start.kinetic == pytest.approx(0.5 * rod.mass * SPEED**2, rel=1e-12)
    assert energy.start.potential == pytest.approx(rod.mass * 9.81 * 2.0, rel=1e-12)
    assert energy.start.strain == 0.0
    assert abs(energy.unaccounted) < 1e-9 * energy.scale
    assert energy.end.total < energy.start.total + 1e-9


@pytest.mark.slow
def test_a_force_at_the_start_does_not_enter_the_starting_energy():
    """m v' = F: the work of the force is F times the way from t = 0 to the last half step."""
    mass = ct.PointMass(mass=2.0, x=0.0, velocity=SPEED, force=50.0)
    energy = ct.run([mass, ct.Wall(x=9.0)], scheme=ct.CentralDifference(), t_end=0.5, dt=0.01).energy
    assert energy.start.total == pytest.approx(9.0, rel=1e-12)
    end = 0.5 - 0.005
    assert energy.external == pytest.approx(50.0 * (SPEED * end + 0.5 * 25.0 * end**2), rel=1e-3)
    assert energy.numerical == pytest.approx(0.01**2 * 50.0**2 / 2.0 / 8.0, rel=1e-6)  # h^2 F^2/(8 m)


def test_damped_modes_and_a_spinning_beam_start_with_the_given_speed():
    body = ct.ModalBody(
        omega=[0.0, 80.0], zeta=[0.0, 0.9], channels=("y",), rows=[[1.0, 1.0]], S=np.zeros((1, 1)), participation=None
    )
    patch = ct.Patch(body=body, normal=("y",), clearance=1.0, velocity=[-1.0, 2.0])
    started = ct.ExactModal().prepare(patch, ct.Unilateral(), dt=0.02, courant=None).stored()
    assert started.kinetic == pytest.approx(2.5, rel=1e-9)
    beam = ct.bodies.HingedBeam(length=1.0, width=0.02, height=0.01, E=2e9, rho=1e3, elements=40, spin=30.0,
                                torque=2.0, angle_deg=90.0)  # fmt: skip
    start = (
        ct.CentralDifference()
        .prepare(ct.bodies.BeamInCircle(beam, radius=1.2), ct.Unilateral(), dt=None, courant=0.9)
        .start
    )
    assert start.kinetic == pytest.approx(0.5 * beam.inertia * 30.0**2, rel=1e-3)
    assert start.potential == pytest.approx(-np.pi, rel=1e-12)
