"""Runs that outgrow their model: stopped at the step that passed a limit, everything kept, the cause in words."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring

DIGS = ct.Coulomb(mu=0.3)  # above tan(10 deg)


def rim(speed_hz=60.0, thickness=1e-3, **more):
    """At 60 Hz the closed contact diverges by 320 1/s, at 20 Hz by 30 1/s, at 5 Hz it does not grow far in a second."""
    given = {"clearance": -1e-5, "speed_hz": speed_hz, "lean_deg": 10.0} | more
    return ct.RotatingRim(replace(ring(), thickness=thickness), blade(), **given)


def diverging(what, **more):
    with pytest.raises(ct.NumericsError) as caught:
        ct.run(what, **({"law": DIGS, "t_end": 1.0, "dt": 2e-5} | more))
    return caught.value


@pytest.mark.slow
def test_a_rim_stops_at_half_its_wall_and_keeps_all_up_to_there():
    error = diverging(rim())
    result, found = error.result, error.result.divergence
    assert found.limit == "wall"
    assert 5e-4 < found.reached < 1.5e-3  # examined every 64 steps
    assert found.step == result.steps == result.time.size
    assert found.time == pytest.approx(result.steps * 2e-5)
    assert np.isfinite(result.force).all()
    assert result.energy.unaccounted < 1e-9 * result.energy.scale
    assert str(error).startswith(f"step {found.step} (t = {found.time:.6g} s): diverged: the rim deflected by")
    for words in (
        "With the contact always closed, the motion grows at 60 Hz",
        "The energy came from",
        "Add a [coating]",
    ):
        assert words in str(error)
    energy = result.energy
    parts = {
        "friction": energy.friction,
        "the turning rim": energy.rotation,
        "the contact law": -energy.lost_in_contact,
    }
    given = sorted(((joules, part) for part, joules in parts.items() if joules > 0.0), reverse=True)
    fed = ", ".join(f"{part} ({joules:.3g} J)" for joules, part in given if joules > 0.01 * given[0][0])
    assert f"The energy came from {fed}." in str(error)
    whole = ct.run(rim(), law=DIGS, t_end=result.steps * 2e-5 - 1e-6, dt=2e-5, on_limit="flag")
    assert np.array_equal(whole.force, result.force)  # the same run, to the bit


@pytest.mark.slow
def test_flags_run_on_to_a_tenth_of_the_radius_and_growth_is_theorys():
    result = ct.run(rim(), law=DIGS, t_end=1.0, dt=2e-5, on_limit="flag")
    found = result.divergence
    assert found.limit == "radius"
    assert 0.045 <= found.reached < 0.045 * np.exp(330.0 * 64 * 2e-5)  # examined every 64 steps
    assert found.theory == pytest.approx(320.0, rel=0.01)
    assert found.growth == pytest.approx(found.theory, rel=0.15)
    assert result.growth.low < found.theory < result.growth.high
    assert result.growth.converged
    assert (result.growth.body, result.growth.nodal_diameters) == ("casing", 3)
    assert [flag[:13] for flag in result.flags] == ["the rim defle", "a tip moved 0", "diverged: rim"]
    assert result.to_dict()["divergence"]["limit"] == "radius"


@pytest.mark.slow
def test_without_a_thickness_a_tenth_of_the_radius_is_the_bound_and_calm_runs_are_not_touched():
    assert diverging(rim(thickness=0.0)).result.divergence.limit == "radius"
    calm = ct.run(rim(5.0), law=DIGS, t_end=0.2, dt=2e-5)
    assert (calm.divergence, calm.flags) == (None, ())


@pytest.mark.slow
def test_batches_stop_where_a_run_alone_does():
    scenes = [
        ct.Scene(what=rim(speed), law=DIGS, t_end=0.4, dt=2e-5, on_limit=on_limit)
        for speed, on_limit in ((60.0, "stop"), (5.0, "stop"), (20.0, "stop"), (60.0, "flag"))
    ]
    far, calm, slow, flagged = ct.run_many(scenes)
    assert isinstance(calm, ct.Result)
    for outcome, scene in ((far, scenes[0]), (slow, scenes[2])):
        alone = diverging(scene)
        assert type(outcome) is type(alone)
        assert outcome.result.steps == alone.result.steps
        np.testing.assert_allclose(outcome.result.force, alone.result.force, rtol=1e-6, atol=1e-9)
        assert outcome.result.divergence.limit == alone.result.divergence.limit == "wall"
    assert flagged.divergence.limit == "radius"


@pytest.mark.slow
def test_many_tips_stop_too_and_a_saved_result_states_why(tmp_path):
    tips = tuple(ct.ContactPoint(angle_deg=angle, lean_deg=10.0) for angle in (0.0, 180.0))
    rub = ct.Rub(rim().casing, [blade()], tips, clearance=-1e-5, speed=ct.Speed.constant(60.0))
    error = diverging(rub)
    assert error.result.divergence.limit == "wall"
    error.result.save(tmp_path / "rub.npz")
    kept = ct.Result.load(tmp_path / "rub.npz").divergence.to_dict()
    assert kept == error.result.divergence.to_dict()
    assert diverging(replace(rub, thickness=0.03)).result.divergence.allowed == 0.015  # the rub's own goes before


def test_a_patch_whose_motion_feeds_itself_stops_at_a_million_times_what_its_start_can_cause():
    start = {"displacement": [0.0, 1e-3], "velocity": [0.0, 1e-3]}
    patch = ct.Patch(body=block([0.0, -40.0]), normal=("y",), tangent=(("x",),), **start)
    scene = ct.Scene(what=patch, law=ct.Coulomb(mu=0.1), t_end=1.0, dt=1e-3)
    with pytest.raises(ct.NumericsError, match=r"a million times what initial state and load can cause") as caught:
        ct.run(scene)
    s, allowed = np.roots([1.0, -40.0, 1.0]), 1e6 * (1e-3 + 1e-3 * 1e6 * 1e-3)  # it moves for at most a million steps
    grown = 1e-3 * (1.0 - s[1]) / (s[0] - s[1])  # of exp(s t)
    assert abs(caught.value.result.steps * 1e-3 - np.log(allowed / grown) / s[0]) <= 1e-3
    assert caught.value.result.steps == caught.value.result.time.size
    assert "In a machine" not in str(caught.value)  # causes in a machine are named for rims alone
    assert ct.run(replace(scene, what=replace(patch, body=block([0.0, 0.0])))).divergence is None


def block(damping):
    """A body with two modes of 1 rad/s, along x and y, and this damping [1/s]."""
    return ct.ModalBody(omega=[1.0, 1.0], zeta=[0.0, 0.0], channels=("x", "y"), rows=np.eye(2), S=np.zeros((2, 2)),
                        damping=np.diag(damping))  # fmt: skip


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({"out_of_roundness": [{"p": 2, "cos": 0.3}]}, "found 0.3 m on a radius of .* 0.3 mm are 0.0003"),
        ({"clearance": 0.2}, "clearance: found 0.2 m"),
    ],
)  # fmt: skip
def test_mistyped_lengths_of_a_rim_are_refused(given, match):
    with pytest.raises(ct.InputError, match=match):
        rim(**given)


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({"closing": ct.gaps.Closing.exponential(0.1, 0.1)}, "closing: found 0.0999"),
        ({"whirl": (ct.gaps.Whirl(amplitude=0.06),)}, "whirl: found 0.06 m"),
        (
            {"profile": ct.gaps.RimProfile(theta=[0.0, 2.0, 4.0], depth=[0.0, 0.3, 0.0])},
            "out_of_roundness: found 0.3 m",
        ),
    ],
)
def test_mistyped_lengths_of_a_rub_are_refused(given, match):
    with pytest.raises(ct.InputError, match=match):
        ct.Rub(ring(), [blade()], [ct.ContactPoint()], **given)


def test_what_to_do_at_a_limit_is_one_of_two():
    with pytest.raises(ct.InputError, match="on_limit: found 'go', expected 'stop' or 'flag'"):
        ct.run(rim(), t_end=1e-3, dt=2e-5, on_limit="go")


@pytest.mark.slow
def test_a_run_that_ends_early_is_checked_from_its_start():
    """The step changes the motion before the last stretch: 13.9, 8.2, 12.5 and 12.6 1/s at 20, 10, 5 and 2.5 us."""
    result = diverging(rim(20.0)).result
    assert result.growth.check == "depends on the step"
    assert result.growth.half_step == pytest.approx(8.4, rel=0.1)
    assert result.growth.check_share == 2.0 + 3.0  # the whole run at half the step, and three times at the same step
    assert [flag.code for flag in result.flags] == ["wall-deflection", "growth-numerical"]


@pytest.mark.slow
def test_growth_by_impacts_where_closed_contact_decays_is_called_that():
    """A blade with the tip of NASA rotor 37's before a 4 mm ring: closed contact decays, the run grows."""
    thin = ct.bodies.ThinRing(
        radius=0.25, width=0.05, height=4e-3, E=210e9, rho=7800.0, k_r=8.4815e7, k_t=2e6, zeta=2e-3
    )
    casing = replace(ct.bodies.ring_modes(thin, 8).truncated(2.5e4), thickness=4e-3)
    tip = ct.ModalBody(
        omega=[2121.4, 6152.1], zeta=[1e-3, 1e-3], channels=("span", "flap"), rows=[[2.0, -0.75], [9.5, -1.3]],
        S=[[2e-8, 0.0], [0.0, 6e-8]],
    )  # fmt: skip
    what = ct.RotatingRim(
        casing, tip, clearance=2e-5, speed_hz=261.607, lean_deg=8.29, out_of_roundness=[{"p": 4, "cos": 5e-5}]
    )
    given = {"law": ct.Unilateral(), "t_end": 0.3}
    for step in (1e-5, 1e-6):
        error = diverging(what, dt=step, **given)
        grown = error.result.growth
        assert error.result.divergence.theory < -1.0
        assert grown.low > 10.0
        assert grown.converged
        assert (grown.body, grown.nodal_diameters, grown.cause.source) == ("casing", 8, "the turning rim")
        assert "Opening and closing of the contact supplies energy" in str(error)
        assert "converged" in str(error)
