"""Steps and numbers that schemes on linear bodies take and refuse, and what a run of them reads and says."""

import numpy as np
import pytest

import contact as ct

BOUNDS = [
    (ct.scheme.Newmark, "beta", [1.0, 1e-9], [0.0, 1.0000001]),
    (ct.scheme.Newmark, "gamma", [0.5, 1.0], [0.4999999, 1.0000001]),
    (ct.scheme.HHT, "alpha", [-1.0 / 3.0, 0.0], [-0.3333334, 1e-9]),
    (ct.MoreauJean, "theta", [0.5, 1.0], [0.4999999, 1.0000001]),
    *((scheme, "restitution", [0.0, 1.0], [-1e-9, 1.0000001])
      for scheme in (ct.MoreauJean, ct.scheme.CDLagrange, ct.scheme.PaoliSchatzman, ct.scheme.NonsmoothAlpha)),
    (ct.scheme.NonsmoothAlpha, "rho_inf", [0.0, 1.0], [-1e-9, 1.0000001]),
]  # fmt: skip


@pytest.mark.parametrize(("scheme", "name", "good", "bad"), BOUNDS)
def test_numbers_of_schemes_are_taken_up_to_their_bounds(scheme, name, good, bad):
    for value in good:
        assert getattr(scheme(**{name: value}), name) == value
    for value in bad:
        with pytest.raises(ct.InputError, match=f"^{name}: found"):
            scheme(**{name: value})


def test_schemes_have_these_numbers_where_none_are_given():
    assert (ct.scheme.Newmark().beta, ct.scheme.Newmark().gamma, ct.scheme.HHT().alpha) == (0.25, 0.5, -0.1)
    assert (ct.MoreauJean().theta, ct.MoreauJean().restitution) == (0.5, 0.0)
    assert (ct.scheme.NonsmoothAlpha().rho_inf, ct.scheme.NonsmoothAlpha().restitution) == (0.8, 0.0)
    assert ct.scheme.CDLagrange().restitution == ct.scheme.PaoliSchatzman().restitution == 0.0


def test_explicit_steps_take_a_consistent_mass_of_two_hundred_coordinates_at_most():
    for size, fine in ((200, True), (201, False)):
        mass = np.eye(size) + np.diag(np.full(size - 1, 0.1), 1) + np.diag(np.full(size - 1, 0.1), -1)
        wide = ct.LinearBody(M=mass, K=np.eye(size), Q=np.eye(size)[:1], gap0=np.ones(1))
        if fine:
            assert ct.CentralDifference().prepare(wide, ct.Unilateral(), dt=0.1, courant=None).size == 200
            continue
        with pytest.raises(ct.InputError, match="found a consistent mass matrix, expected a lumped one"):
            ct.CentralDifference().prepare(wide, ct.Unilateral(), dt=0.1, courant=None)


def frame(amplitude=lambda t: 0.0 * t):
    """Three coordinates whose band order is not their own."""
    K = np.array([[30.0, 0.0, -10.0], [0.0, 20.0, -20.0], [-10.0, -20.0, 35.0]])
    forcing = (
        ct.bodies.Forcing(shape=np.array([0.0, 0.0, 1.0]), amplitude=lambda t: 0.0 * t),
        ct.bodies.Forcing(shape=np.array([0.0, 3.0, 0.0]), amplitude=amplitude),
    )
    return ct.LinearBody(M=np.array([1.0, 2.0, 0.5]), K=K, Q=np.eye(3)[:1], gap0=np.ones(1), forcing=forcing)


def test_a_failed_step_is_explained_by_the_motion_or_the_contacts():
    run = ct.scheme.Newmark().prepare(frame(), ct.Unilateral(), dt=0.1, courant=None)
    assert run.why() == (
        "no contact forces satisfy all contacts: the search cycles, or a gap is not finite. Reduce dt [unconverged]"
    )
    for part in (run.state.u, run.state.v):
        part[1] = np.nan
        assert run.why() == "the motion is not finite [motion-overflow]"
        part[1] = 0.0
