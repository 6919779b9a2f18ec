"""What a step notes of a lane of a batch; as plain Python."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.contact.plain import names

N = names("loop.batch.batch", "loop.batch.waves")


def noted(*, force=2.0, mu=0.3, pull=0.1, surface=15.0):
    """How often a lane reversed, stuck and touched after one step with this force."""
    work = np.zeros((15, 1))
    work[N.FORCE], work[N.PULL], work[N.GAP] = force, pull, 1e-3
    state = SimpleNamespace(
        work=work,
        h=np.array([1e-3]),
        step=np.array([4]),
        mu=np.array([mu]),
        surface=np.array([surface]),
        casing=np.array([1]),
        q=np.array([[9.0], [2e-4]]),
        T=np.array([[9.0], [-0.5]]),
        peaks=np.array([0.5e-4]),
    )
    sums = SimpleNamespace(
        contact_steps=np.zeros(1, int), reversals=np.zeros(1, int), closed=np.array([1]), stuck=np.array([0]),
        filled=np.zeros(4, int),
    )  # fmt: skip
    out = SimpleNamespace(event_contact=np.zeros(8, int), event_kind=np.zeros(8, int), event_time=np.zeros(8))
    kept = SimpleNamespace(due=np.array([[9]]))
    N.note_lane(state, sums, out, kept, 1e-4, 0)
    assert state.peaks[0] == pytest.approx(1e-4 if mu else 0.5e-4, rel=1e-12)
    return sums.reversals[0], sums.stuck[0], sums.contact_steps[0], out.event_kind[: sums.filled[2]].tolist()


@pytest.mark.parametrize("turns", [1.0, -1.0])
def test_a_tip_that_overtakes_the_rim_reverses_its_friction(turns):
    surface, cone = 15.0 * turns, 0.3 * turns
    assert noted(surface=surface, pull=cone) == (0, 0, 1, [])
    assert noted(surface=surface, pull=-cone) == (1, 0, 1, [])
    assert noted(surface=surface, pull=-0.2 * turns) == (0, 1, 1, [3])
    assert noted(surface=surface, pull=-cone, mu=0.0) == (0, 0, 1, [])
    assert noted(surface=surface, pull=-cone, force=0.0) == (0, 0, 0, [0])


def test_inside_the_cone_is_by_more_than_round_off():
    assert noted(pull=math.nextafter(0.3, 0.0))[:2] == (0, 0)
    assert noted(pull=0.3 * (1.0 - 2.0 * N.INSIDE))[:2] == (0, 1)
