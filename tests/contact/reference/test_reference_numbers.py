"""Numbers held: exact contacts of rods and bars, waves in time, bounces and driven impacts."""

import pytest

import contact as ct
from tests.probed import numbers_in

ROD = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, x=-1.0, velocity=1.0)


def test_numbers_of_exact_contacts(held):
    bar = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, x=5.0)
    held(
        pair=list(numbers_in(ct.reference.two_rods(ROD, gap=0.1, velocity=2.0))),
        wall=list(numbers_in(ct.reference.rod_on_wall(ROD, gap=0.1, velocity=2.0))),
        bar=list(numbers_in(ct.reference.bouncing_bar(4))),
        history=list(numbers_in(ct.reference.bar_by_characteristics(bar, gravity=10.0, t_end=3.0, cells=40))),
        orbit=list(
            numbers_in(ct.reference.driven_orbit(omega=1.0, drive=2.0, drive_omega=2.7, gap=0.2, restitution=0.8)),
        ),
        period=[ct.reference.stopped_period(3.0, gap, 0.2) for gap in (0.1, 0.0, -0.1)],
        step=[ct.reference.lcm_step(ROD, ct.Rod(length=1.5, area=1.0, E=4.0, rho=1.0), cells=12)],
    )


BODIES = {
    "mass": lambda: ct.PointMass(mass=0.7, x=-0.2, velocity=1.0),
    "rod": lambda: ROD,
}


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("fixed", ["none", "right"])
def test_numbers_of_waves(name, fixed, held):
    found = ct.reference.impact_by_characteristics(
        BODIES[name](), ct.Rod(length=2.0, area=1.0, E=1.0, rho=1.0, fixed=fixed), dt=0.01, t_end=3.0
    )
    held(force=found.step_force[::7], gap=found.gap[::7], all=list(numbers_in(found)))
