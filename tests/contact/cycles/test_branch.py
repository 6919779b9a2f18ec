"""Branches, folds and stability against published orbits and runs in time."""

import math
import time
from pathlib import Path

import numpy as np
import pytest

import contact as ct
from reports.verification.schemes.cycles import mass_on_stop, rod
from tests.probed import finite

pytestmark = pytest.mark.slow
TURN = 2.0 * math.pi
SCENES = Path(__file__).parents[3] / "data" / "scenes" / "cycles"


def hours_pass(monkeypatch):
    """A clock that stops but when it is asked to go on by an hour: files that are written from time to time are due."""
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])

    def pass_on():
        now[0] += 3600.0

    return pass_on


def crossings(branch, value):
    """Points of a branch next to where it passes a value."""
    at = branch.value
    return [branch.points[k] for k in np.flatnonzero((at[:-1] - value) * (at[1:] - value) <= 0.0)]


def test_the_rod_on_a_soft_obstacle_has_the_published_orbits_and_fold(held):
    """E1, r = .4: Vadcard, Batailly, Thouverez, J. Sound Vib. 531 (2022) 116950."""
    family = rod(0.4).over("freq_hz", freq_hz=10e3)
    found = ct.cycles.follow(family, (9500.0, 10600.0), longest=0.06).branches[0]
    for omega, amplitude in ((60179.5, 1.0199e-4), (62708.1, 2.7032e-4), (63354.7, 3.3620e-4), (64594.8, 4.9436e-4)):
        near = crossings(found, omega / TURN)[0]
        orbit = ct.cycles.orbit(family, omega / TURN, guess=near.x)
        assert orbit.amplitude["x"] == pytest.approx(amplitude, rel=1e-4)
        assert orbit.stable
    upper, lower = found.of("fold")
    assert TURN * upper.orbit.value == pytest.approx(64892.9, abs=0.06)
    assert upper.orbit.multiplier == pytest.approx(1.0, abs=0.05)
    assert TURN * lower.orbit.value == pytest.approx(63848.2, abs=1.0)
    assert [kept for kept, _, _ in found.stretches] == [True, False, True]
    assert [special.kind for special in found.specials] == ["grazing", "fold", "fold", "grazing"]
    special = [[s.orbit.value, s.orbit.force, list(s.orbit.amplitude.values())] for s in found.specials]
    held(1e-4, special=finite(special), stretches=finite(found.stretches))


def test_the_rod_on_a_stiff_obstacle_is_not_kept_over_a_stretch_that_runs_leave():
    family = rod(4.0).over("freq_hz", freq_hz=10e3)
    found = ct.cycles.follow(family, (9500.0, 11300.0), longest=0.04).branches[0]
    for omega, amplitude in ((61817.6, 2.0560e-4), (62718.4, 2.1736e-4), (63325.7, 2.2768e-4), (65774.4, 2.9874e-4),
                             (68397.7, 3.8436e-4)):  # fmt: skip
        near = crossings(found, omega / TURN)[0]
        orbit = ct.cycles.orbit(family, omega / TURN, guess=near.x)
        assert orbit.amplitude["x"] == pytest.approx(amplitude, rel=1e-3)
    start, stop = found.of("Neimark-Sacker")
    assert (TURN * start.orbit.value / 62711.9764, TURN * stop.orbit.value / 62711.9764) == pytest.approx(
        (1.0263, 1.0464), abs=1e-4
    )
    inside = [point for point in found.points if start.orbit.value < point.value < stop.orbit.value][3]
    assert not inside.stable


@pytest.mark.parametrize(
    ("stiffness", "expected"),
    [(100.0, (0.11401, 0.13720, 0.17463, 0.23460, 0.29163)), (1e5, (0.10577, 0.12159, 0.14646, 0.18296, 0.21462))],
)
def test_a_mass_on_a_stop_has_its_published_orbits(stiffness, expected):
    family = mass_on_stop(stiffness).over("freq_hz", freq_hz=0.2)
    found = ct.cycles.follow(family, (0.15, 0.26), longest=0.06).branches[0]
    for omega, amplitude in zip((1.07511, 1.19425, 1.31283, 1.42899, 1.50085), expected, strict=True):
        near = crossings(found, omega / TURN)[0]
        orbit = ct.cycles.orbit(family, omega / TURN, guess=near.x)
        assert orbit.amplitude["x"] == pytest.approx(amplitude, rel=2e-3)
    if stiffness == 100.0:
        assert TURN * found.of("fold")[0].orbit.value == pytest.approx(1.5579, rel=3e-3)


def test_without_damping_rounding_makes_no_special_points_and_no_orbit_is_stable():
    """A multiplier of 1 in size lies on either side of 1 by rounding: the flips are those of hardly any damping."""
    found = []
    for zeta in (0.0, 1e-5):
        body = ct.ModalBody(
            omega=[40.0, 60.0], zeta=[zeta] * 2, channels=("x", "y"), rows=np.eye(2), S=np.zeros((2, 2))
        )
        patch = ct.Patch(body=body, normal=("y",), tangent=(("x",),), slide=[[1.0]], clearance=1e-3)
        driven = ct.cycles.DrivenBody(patch=patch, channel="y", amplitude=10.0, stiffness=1e4, mu=0.3)
        family = driven.over("freq_hz", freq_hz=5.2)
        found.append(ct.cycles.follow(family, (5.0, 5.15), longest=0.5).branches[0])
    undamped, damped = found
    assert [special.kind for special in undamped.specials] == ["flip"] == [special.kind for special in damped.specials]
    assert undamped.of("flip")[0].orbit.value == pytest.approx(damped.of("flip")[0].orbit.value, rel=1e-9)
    assert not undamped.stable.any()
    assert damped.points[-1].stable
    assert undamped.points[-1].multiplier == pytest.approx(1.0, abs=1e-9)


def test_an_orbit_is_found_from_chaos():
    """A run that does not settle passes near the unstable orbit: where it does, not where it ends, is the guess."""
    family = mass_on_stop(1e5).over("freq_hz", freq_hz=0.2)
    for hz in (0.148, 0.1481, 0.14841, 0.15067, 0.15077, 0.15169, 0.1519):
        found = ct.cycles.orbit(family, hz)
        assert not found.stable


def test_a_branch_that_ends_at_grazing_goes_on_from_a_run(tmp_path, monkeypatch):
    """A rigid stop: the branch without contact ends where the mass grazes it, and another begins with touches.

    Stopped on that one, it is not searched for again.
    """
    said = []
    family = mass_on_stop().over("freq_hz", freq_hz=0.15)
    found = ct.cycles.follow(family, (0.13, 0.16), longest=0.05, progress=lambda *told: said.append(told))
    first, second = found.branches[:2]
    assert "graz" in first.end
    assert first.points[-1].closings == (0,)
    assert first.points[-1].amplitude["x"] == pytest.approx(0.1, rel=1e-3)
    assert sum(second.points[0].closings) > 0
    assert any(orbits == 0 for _, _, orbits in said)
    file, again = tmp_path / "part.npz", []

    clock = hours_pass(monkeypatch)

    def stopped(number, _value, orbits):
        clock()
        if (number, orbits) == (2, 5):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ct.cycles.follow(family, (0.13, 0.16), longest=0.05, checkpoint=file, progress=stopped)
    monkeypatch.undo()
    other = ct.cycles.follow(
        family,
        (0.13, 0.16),
        longest=0.05,
        checkpoint=file,
        progress=lambda number, _value, orbits: again.append((number, orbits)),
    )
    assert other.records() == found.records()
    rows, points = found.records(), [point for branch in found.branches for point in branch.points]
    assert [row["force"] for row in rows] == [max(point.force, default=0.0) for point in points]
    assert [row["gap"] for row in rows] == [min(point.gap, default=np.inf) for point in points]
    assert again[0][0] == 2
    assert again[0][1] > 0


def test_a_range_of_nothing_is_refused():
    with pytest.raises(ct.InputError, match="expected two different ends"):
        ct.cycles.follow(mass_on_stop(100.0).over("freq_hz", freq_hz=0.2), (0.2, 0.2))


@pytest.mark.campaign
def test_a_search_that_was_stopped_goes_on_to_the_same_bits(tmp_path, monkeypatch):
    """Stopped within its second branch, of doubled period."""
    clock = hours_pass(monkeypatch)
    file, said = tmp_path / "part.npz", []
    scene = ct.scene.load_cycles(SCENES / "bouncing_ball.toml")

    def until(branch, count):
        def progress(number, _value, points):
            clock()
            said.append(number)
            if (number, points) == (branch, count):
                raise KeyboardInterrupt

        return progress

    whole = scene.solve()
    with pytest.raises(KeyboardInterrupt):
        scene.solve(until(2, 4), file)
    said.clear()
    monkeypatch.undo()
    again = scene.solve(until(9, 0), file)
    assert 1 not in said
    assert len(said) < sum(len(branch.points) for branch in again.branches[1:])
    for one, other in zip(again.branches, whole.branches, strict=True):
        assert np.array_equal([p.x for p in one.points], [p.x for p in other.points])
        assert np.array_equal([p.multipliers for p in one.points], [p.multipliers for p in other.points])
        assert [(s.kind, s.orbit.value) for s in one.specials] == [(s.kind, s.orbit.value) for s in other.specials]
    assert again.records() == whole.records()
    with pytest.raises(ct.InputError, match="found a checkpoint of another computation"):
        ct.cycles.follow(scene.family, scene.between, longest=0.05, checkpoint=file)
    file.write_bytes(b"not a file of numbers")
    with pytest.raises(ct.InputError, match="delete"):
        scene.solve(checkpoint=file)


@pytest.mark.parametrize(("name", "between"), [("freq_hz", (0.15, 0.2)), ("amplitude", (0.02, 0.06))])
def test_the_slope_of_an_orbit_and_its_monodromy_give_the_difference_of_its_neighbours(name, between):
    """x = map(x, p) along the branch, so that (1 - M) dx/dp is the derivative of the map by p alone."""
    family = mass_on_stop(100.0).over(name, freq_hz=0.17)
    (branch,) = ct.cycles.follow(family, between, longest=0.3, most=12).branches[:1]
    points = [at for at in branch.points if sum(at.closings) and at.slope is not None]
    assert len(points) > 2
    for at in points[1:]:
        step = 1e-5 * at.value
        ahead, back = (ct.cycles.orbit(family, at.value + sense * step, guess=at.x) for sense in (1.0, -1.0))
        expected = (np.eye(at.x.size) - at.M) @ (ahead.x - back.x) / (2.0 * step)
        assert at.slope == pytest.approx(expected, abs=2e-5 * np.abs(expected).max())
