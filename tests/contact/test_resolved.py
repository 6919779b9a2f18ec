"""Time resolution: every rate, load and change of a run is compared with its step and its end before it begins."""

import re
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import contact as ct
from casingfem.cli import main
from tests.contact.synthetic_rim import blade, ring

WALL = ct.Wall(x=0.05)
CARPENTER = {"length": 0.254, "area": 6.4516e-4, "E": 206.8427e9, "rho": 7844.181}
ROD = ct.Rod(**CARPENTER, elements=100, x=-0.254254, velocity=5.13588)


def driven(hz, dt=1e-3, **more):
    """A driven oscillator of a natural frequency of 0.16 Hz before a stop."""
    mass = ct.PointMass(mass=1.0, x=0.05, anchor=0.0, stiffness=1.0, force=1.0, force_hz=hz, velocity=-1.0)
    return ct.Scene(**{"what": [mass, WALL], "scheme": ct.scheme.CDLagrange(), "t_end": 0.1, "dt": dt} | more)


def codes(scene):
    """Codes of the warnings about the resolution in time."""
    flags = ct.run(scene).flags
    return [flag.code for flag in flags if flag.code in ("step-too-long", "never-begins")]


def test_a_force_is_refused_below_four_steps_a_period_and_flagged_below_ten():
    dt = 1e-3
    for hz, found in ((1.0, []), (99.0, []), (101.0, ["step-too-long"]), (249.0, ["step-too-long"])):
        assert codes(driven(hz)) == found
    words = r"mass\[1\]\.force_hz = 1000\.32 Hz has 1 steps a period and would appear at 0\.318 Hz, expected at least 4"
    with pytest.raises(ct.LimitError, match=words) as caught:
        ct.run(driven(1000.318309886184))
    longest = float(re.search(r"use dt <= (\S+) s", str(caught.value))[1])
    assert longest == pytest.approx(1.0 / (4.0 * 1000.3183), rel=1e-3)
    ct.run(driven(1000.318309886184, dt=longest))
    with pytest.raises(ct.LimitError, match=r"has 3\.98 steps a period, expected"):
        ct.run(driven(251.0, dt))
    with pytest.raises(ct.LimitError, match=r"force_hz = 64 Hz has 2 steps a period, expected at least 4"):
        ct.run(driven(64.0, 1.0 / 128.0))  # at half of the rate of the steps it still appears at its own frequency


def test_a_period_longer_than_the_run_is_no_fault():
    assert codes(driven(0.01)) == []


def test_a_step_longer_than_the_run_is_refused():
    with pytest.raises(ct.LimitError, match=r"dt: found 0\.2 s, expected at most t_end = 0\.1 s"):
        ct.run(driven(0.0, dt=0.2))
    scheme = ct.scheme.NonsmoothAlpha(rho_inf=0.8)
    bodies = [ct.PointMass(mass=0.5, velocity=1.0), ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=100)]
    with pytest.raises(ct.LimitError, match=r"found 100000 s \(courant = 1e\+07\), expected at most t_end = 5 s"):
        ct.run(ct.Scene(what=bodies, scheme=scheme, t_end=5.0, courant=1e7))


def test_a_step_longer_than_the_passage_of_a_wave_is_flagged():
    rod = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=10, x=0.1, velocity=-1.0)
    scene = ct.Scene(what=[rod, ct.Wall()], scheme=ct.MoreauJean(), t_end=20.0, dt=0.99, on_limit="flag")
    assert codes(scene) == []
    (flag,) = (flag for flag in ct.run(replace(scene, dt=1.01)).flags if flag.code == "step-too-long")
    assert "longer than a wave through rod[1], 1 s: use dt <= 0.999 s" in flag


@pytest.mark.parametrize(("damping", "found"), [(1e5, []), (2e6, ["step-too-long"])])
def test_damping_of_a_rod_is_compared_with_the_step(damping, found):
    scene = ct.Scene(what=[replace(ROD, damping=damping), replace(ROD, x=0.0, velocity=0.0)], t_end=2.5e-4, courant=0.9)
    assert codes(scene) == found


def test_damping_that_ends_within_a_step_is_refused():
    scene = ct.Scene(what=[replace(ROD, damping=1e7), replace(ROD, x=0.0, velocity=0.0)], t_end=2.5e-4, courant=0.9)
    with pytest.raises(ct.LimitError, match=r"rod\[1\]\.damping = 1e\+07 1/s makes a step 4\.45 time constants long"):
        ct.run(scene)


def rub(**more):
    return ct.Scene(
        what=ct.Rub(ring(), [blade()], [ct.ContactPoint()], clearance=1e-3, **more), t_end=0.2, dt=2e-5
    )  # fmt: skip


@pytest.mark.slow
def test_whirl_and_what_closes_the_gap_are_compared_with_step_and_end():
    speed, closing = ct.Speed.constant(5.0), ct.gaps.Closing
    assert codes(rub(speed=speed, whirl=[ct.gaps.Whirl(amplitude=1e-5, per_rev=1.0)])) == []
    with pytest.raises(ct.LimitError, match=r"whirl\[1\] = 20005 Hz has 2\.5 steps a period"):
        ct.run(rub(speed=speed, whirl=[ct.gaps.Whirl(amplitude=1e-5, per_rev=1.0, hz=20000.0)]))
    steady = rub(speed=speed)
    steady = replace(steady, what=replace(steady.what, casing=replace(ring(), participation=np.ones((3, 10)))))
    for per_rev, hz in ((-1.0, -20000.0), (1.0, 20000.0)):
        shaken = ct.gaps.BodyForce(on="casing", acceleration=1.0, per_rev=per_rev, hz=hz)
        with pytest.raises(ct.LimitError, match=r"a force on casing = 20005 Hz has 2\.5 steps a period"):
            ct.run(replace(steady, what=replace(steady.what, forces=[shaken])))
    assert codes(rub(speed=speed, closing=closing.exponential(1e-4, 0.05))) == []
    with pytest.raises(ct.LimitError, match=r"closing = a change of 0\.0001 m within .* makes a step 2 time constants"):
        ct.run(rub(speed=speed, closing=closing.exponential(1e-4, 1e-5)))
    assert codes(rub(speed=speed, closing=closing([0.3, 0.4], [0.0, 1e-4]))) == ["never-begins"]
    assert codes(rub(speed=ct.Speed(time=[0.2, 0.4], hz=[5.0, 6.0]))) == ["never-begins"]
    assert codes(rub(speed=ct.Speed(time=[0.1, 9.0], hz=[5.0, 6.0]))) == []


@pytest.mark.slow
@pytest.mark.parametrize(("points", "found"), [(9_000, []), (11_000, ["step-too-long"])])
def test_a_measured_profile_is_compared_with_the_step(points, found):
    """A turn of 0.2 s has 10,000 steps."""
    theta = np.linspace(0.0, 2.0 * np.pi, points, endpoint=False)
    profile = ct.gaps.RimProfile(theta=theta, depth=1e-5 * np.cos(2.0 * theta))
    assert codes(replace(rub(speed=ct.Speed.constant(5.0), profile=profile), t_end=0.01)) == found


def test_a_load_given_as_a_function_is_checked_between_the_steps():
    def scene(hz):
        wave = ct.bodies.Forcing(shape=np.array([1.0]), amplitude=lambda t: np.sin(2.0 * np.pi * hz * t))
        body = ct.LinearBody(M=np.array([1.0]), K=np.zeros((1, 1)), Q=np.ones((1, 1)), gap0=np.array([1.0]),
                             forcing=(wave,))  # fmt: skip
        return ct.Scene(what=body, t_end=2.0, dt=0.01)

    for hz in (3.0, 9.0):
        assert codes(scene(hz)) == []
    for hz in (11.0, 15.0, 24.0):
        assert codes(scene(hz)) == ["step-too-long"]
    for hz in (26.0, 30.0, 98.0):  # 100 steps a second: from 25 Hz on, less than four a period
        with pytest.raises(ct.LimitError, match="forcing 1 varies within a step"):
            ct.run(scene(hz))


def test_more_steps_than_are_asked_for_are_refused_with_an_estimate():
    rod = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1e-12, x=5.0, velocity=-10.0)
    scene = ct.Scene(what=[rod, ct.Wall()], t_end=2.0, courant=0.9)
    with pytest.raises(
        ct.InputError, match=r"6\.667e\+08 steps or about 14 minutes of computing time, expected at most 1e\+08"
    ):
        ct.run(scene)
    slow = replace(scene, what=[replace(rod, rho=1.0), ct.Wall()])
    steps = ct.run(slow).steps
    assert ct.run(replace(slow, most_steps=steps)).steps == steps
    with pytest.raises(ct.InputError, match=f"expected at most {steps - 1}"):
        ct.run(replace(slow, most_steps=steps - 1))
    with pytest.raises(ct.InputError, match=r"most_steps: found 0\.5, expected a whole number >= 1"):
        ct.run(replace(scene, most_steps=0.5))


def test_a_scene_file_asks_for_more_steps_and_batches_refuse_what_runs_refuse(tmp_path):
    text = '[scene]\nkind = "rods"\nt_end = 1.0\n[[mass]]\nmass = 1.0\nx = 1.0\n{}\n[wall]\n[scheme]\n'
    text += 'kind = "moreau-jean"\n'
    (tmp_path / "scene.toml").write_text(text.format("force = 1.0\nforce_hz = 60.0") + "dt = 0.01\n")
    ran = CliRunner().invoke(main, ["contact", str(tmp_path / "scene.toml")])
    assert ran.exit_code == 2
    assert "mass[1].force_hz = 60 Hz has 1.67 steps a period and would appear at 40 Hz" in ran.stderr
    (outcome,) = ct.run_many([ct.load_scene(tmp_path / "scene.toml")])
    assert isinstance(outcome, ct.LimitError)
    assert str(outcome) in ran.stderr
    (tmp_path / "scene.toml").write_text(text.format("") + "dt = 0.01\nmost_steps = 99\n")
    ran = CliRunner().invoke(main, ["contact", str(tmp_path / "scene.toml")])
    assert (ran.exit_code, "100 steps or" in ran.stderr) == (2, True)
