"""When a contact closes and opens: a mass on a wall, pressed by cos(2 pi t), is pulled off at t = 1/4."""

import numpy as np
import pytest

import contact as ct
from contact.model.bodies.body import PointMass, Wall
from contact.scene.scheme import SCHEMES

pytestmark = pytest.mark.slow  # whichever comes first compiles the loop

OPENS = 0.25


@pytest.mark.parametrize(
    "name",
    ["forward-lagrange", "cd-lagrange", "paoli-schatzman", "moreau-jean", "stabilised-newmark", "projected-alpha"],
)
def test_a_contact_opens_within_half_a_step_neither_early_nor_late(name):
    late = []
    for part in np.linspace(0.03, 0.97, 12):  # where in a step the force ends
        scene = ct.Scene(
            what=[PointMass(mass=1.0, force=1.0, force_hz=1.0), Wall()], t_end=0.4, dt=OPENS / (40.0 + part),
            scheme=SCHEMES[name][0](),
        )  # fmt: skip
        result = ct.run(scene)
        begins, ends = np.array(result.intervals[0]).T
        assert begins[0] == 0.0
        late.append((ends[-1] - OPENS) / result.dt)
    assert np.abs(late).max() < 0.51
    assert abs(np.mean(late)) < 0.05
