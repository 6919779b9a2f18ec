"""Every option of a rub's compiled loop against the same steps of whole matrices (`plain_step`)."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.plain_step import PlainRub
from tests.contact.synthetic_rub import nodes, rim3, round_rim, tips

H = 2e-5
# tips on the first blade, three directions, friction, law, what couples modes or that the casing is round
CASES = {
    "one tip": (1, False, 0.0, "forward", None),
    "one tip, averaged, friction": (1, False, 0.3, "averaged", None),
    "three tips, friction": (2, False, 0.3, "forward", None),
    "three tips in three directions": (2, True, 0.2, "averaged", None),
    "casing turns, one tip": (1, False, 0.3, "averaged", "casing"),
    "casing turns, without friction": (2, True, 0.0, "forward", "casing"),
    "casing turns, three tips, friction": (2, False, 0.3, "forward", "casing"),
    "casing turns, three directions": (2, True, 0.2, "averaged", "casing"),
    "blades turn, three tips": (2, False, 0.3, "averaged", "blades"),
    "round casing, three tips": (2, False, 0.0, "averaged", "round"),
    "round casing, three tips, friction": (2, False, 0.3, "forward", "round"),
    "round casing, three directions": (2, True, 0.2, "averaged", "round"),
    "cross-coupled casing, one tip": (1, False, 0.3, "forward", "cross"),
    "cross-coupled casing, three tips": (2, True, 0.2, "forward", "cross"),
}


def coupled(body, seed, *, cross=False):
    """The body with full matrices of rotation, or with full damping and a nonsymmetric stiffness."""
    mixed, other = np.random.default_rng(seed).standard_normal((2, body.omega.size, body.omega.size))
    if cross:
        return replace(body, damping=5.0 * mixed @ mixed.T, stiffness=3e3 * other)
    return replace(body, gyroscopic=mixed - mixed.T, stiffness_by_speed=other + other.T)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_tips_press_as_steps_of_whole_matrices_say(name):
    count, axial, mu, law, couples = CASES[name]
    steps = 500 if count == 1 else 120  # one tip is thrown off, and comes back
    casing, blades = round_rim() if couples == "round" else rim3(), [nodes(2), nodes(1, seed=6)]
    if couples == "blades":
        blades = [coupled(body, 3 + k) for k, body in enumerate(blades)]
    elif couples in ("casing", "cross"):
        casing = coupled(casing, 2, cross=couples == "cross")
    points = [*tips(count, axial=axial), *tips(1, blade=1, angle=190.0, axial=axial)][: 1 if count == 1 else 3]
    rub = ct.Rub(
        casing, blades, points, clearance=-2e-4, speed=ct.Speed.constant(25.0),
        profile=ct.RimProfile.fourier([{"p": 2, "cos": 2e-5}, {"p": 3, "sin": 1e-5}]),
        turning="blades" if couples == "blades" else "casing",
    )  # fmt: skip
    friction = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    found = ct.run(
        rub, law=friction, scheme=ct.ExactModal(law=law), dt=H, t_end=(steps - 0.5) * H, on_limit="flag",
        record=ct.Record(every=1, state_every=1),
    )  # fmt: skip
    wanted = PlainRub(rub, mu=mu, h=H, averaged=law == "averaged").forces(steps)
    assert (wanted[:, :: rub.dimensions if mu else 1] > 0.0).sum() > 10
    np.testing.assert_allclose(found.tip_force.reshape(wanted.shape), wanted, rtol=0.0, atol=1e-7 * wanted.max())


def rub_of(casing):
    """Two blades with three tips in all."""
    points = [*tips(2, axial=False), *tips(1, blade=1, angle=190.0, axial=False)]
    return ct.Rub(
        casing, [nodes(2), nodes(1, seed=6)], points, clearance=-2e-4, speed=ct.Speed.constant(25.0), turning="casing"
    )


def test_the_matrix_of_the_contacts_is_kept_for_a_casing_that_is_round_and_for_no_other():
    round_ = round_rim()
    split = replace(round_, omega=round_.omega * np.where(np.arange(10) == 3, 1.0 + 1e-6, 1.0))
    sizes = []
    for casing in (round_, split, rim3()):
        run = ct.ExactModal().prepare(rub_of(casing), ct.Coulomb(mu=0.2), dt=H, courant=None)
        sizes.append(run.arrays.rows.W.shape)
    assert sizes == [(6, 6), (0, 0), (0, 0)]
