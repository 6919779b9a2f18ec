"""A run that was stopped goes on from its file to the same bits, for every scheme and every kind of contact."""

import json
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips
from tests.contact.turning_ring import turning_ring

ROD = ct.Rod(length=1.0, area=1e-4, E=7e10, rho=2700.0, elements=3, x=0.0397, velocity=-2.0)  # in contact at 20 ms
HINGED = ct.bodies.HingedBeam(
    length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, elements=4, torque=3.0, spin=30.0, angle_deg=106.0
)
BEAM = ct.bodies.BeamInCircle(HINGED, radius=0.502, offset=0.006)
COATING = ct.Abradable(E=4e7, yield_stress=2e3, hardening=4e4, thickness=5e-3, width=0.02, tip=0.03)
RIM = ct.RotatingRim(ring(), blade(), clearance=-2e-6, speed_hz=5.0, lean_deg=10.0)
LOBED = ct.RotatingRim(  # open half of the time, which it skips
    turning_ring(S=4e-7, zeta=0.01, imperfect=0.05), blade(S=1e-6, zeta=0.01), clearance=2e-4, speed_hz=20.0,
    lean_deg=25.0, out_of_roundness=[{"p": 2, "cos": 2.5e-4}], angle_deg=45.0, turning="casing",
)  # fmt: skip
SKEW = np.triu(np.random.default_rng(3).standard_normal((10, 10)), 1)
WHIRLING = replace(rim3(), gyroscopic=SKEW - SKEW.T, stiffness_by_speed=SKEW + SKEW.T + 4.0 * np.eye(10))
RAMP = ct.Rub(
    WHIRLING, (nodes(2),), tips(2), clearance=-3e-6, speed=ct.Speed(time=[0.0, 0.03], hz=[4.0, 30.0]), turning="casing"
)  # fmt: skip
RUB = ct.Rub(rim3(), (nodes(3),), tips(3), clearance=-3e-6, speed=ct.Speed.constant(6.0))
BODY = ct.ModalBody(
    omega=[300.0, 800.0], zeta=[0.01, 0.01], channels=("n1", "n2", "t1", "t2"), S=np.eye(4) * 1e-8,
    rows=[[1.0, 0.3], [0.4, -1.0], [0.2, 0.5], [0.7, 0.1]],
)  # fmt: skip
PATCH = ct.Patch(
    body=BODY, normal=("n1", "n2"), tangent=(("t1",), ("t2",)), clearance=1e-4, velocity=[-1.0, 0.2], load=[-40.0, 0.0]
)
TURNING = ct.ModalBody(
    omega=[500.0, 500.0, 900.0], zeta=[0.02] * 3, channels=("d.x", "d.y"), rows=[[0.2, 0.0, 0.1], [0.0, 0.2, 0.1]],
    S=np.zeros((2, 2)), gyroscopic=[[0.0, 0.1, 0.2], [-0.1, 0.0, 0.1], [-0.2, -0.1, 0.0]],
)  # fmt: skip
SLOWS = ct.rotor.rotor_rub(
    ct.rotor.Rotor.of(TURNING, 40.0, unbalance=ct.rotor.Unbalance(moment=0.05)),
    ct.rotor.rigid_casing(radius=0.45, mass=20.0, stiffness=2e7, zeta=0.05), [blade()] * 3,
    [ct.ContactPoint(blade=j, angle_deg=120.0 * j) for j in range(3)], clearance=1e-4,
    spin=ct.rotor.Spin(inertia=0.2),
)  # fmt: skip
LONG = {"dt": 1e-6, "t_end": 0.026}  # one call of a loop takes 20,000 steps at most
LINEAR = {
    name: ([ROD, ct.Wall(x=0.0)], {"scheme": getattr(ct.scheme, name)(), "t_end": 0.03, "dt": 1e-6})
    for name in (
        "CentralDifference", "CDLagrange", "MasslessBoundary", "PaoliSchatzman", "Newmark", "HHT", "StabilisedNewmark",
        "MoreauJean", "NonsmoothAlpha", "ProjectedAlpha",
    )
}  # fmt: skip
RUNS = {
    **LINEAR,
    "penalty": ([ROD, ct.Wall(x=0.0)], {"law": ct.Penalty(stiffness=1e7), **LONG}),
    "rim": (RIM, {"law": ct.Unilateral(), **LONG}),
    "rim with friction": (RIM, {"law": ct.Coulomb(mu=0.1), **LONG}),
    "rim with coupled modes that skips open time": (LOBED, {"law": ct.Coulomb(mu=0.2), **LONG}),
    "rim with a coating": (RIM, {"law": COATING, **LONG}),
    "rub with friction": (RUB, {"law": ct.Coulomb(mu=0.1), **LONG}),
    "rub with coupled modes over a ramp": (RAMP, {"law": ct.Coulomb(mu=0.1), **LONG}),
    "rub with a coating": (RUB, {"law": replace(COATING, tip=0.004), **LONG}),
    "rotor that slows": (SLOWS, {"law": ct.Coulomb(mu=0.1), **LONG}),
    "patch": (PATCH, {"law": ct.Unilateral(), **LONG}),
    "patch with friction": (PATCH, {"law": ct.Coulomb(mu=0.3), **LONG}),
    "beam": (BEAM, LONG),
    "beam by Newmark": (BEAM, {"scheme": ct.scheme.Newmark(beta=0.25, gamma=0.5), "dt": 1e-6, "t_end": 0.025}),
}  # fmt: skip


class StoppedError(Exception):
    """What represents Ctrl-C."""


HOURS = [0.0]  # the clock of `at_once` [s]


def stop(done: float) -> None:
    HOURS[0] += 3600.0
    if done > 0.8:
        raise StoppedError


@pytest.fixture
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock by which a call of a loop takes an hour and a writing nothing: each call is followed by a writing."""
    monkeypatch.setattr(time, "monotonic", lambda: HOURS[0])


def words(result: ct.Result) -> str:
    """All that a result has but the seconds, exactly."""
    arrays = [getattr(result, name).tobytes().hex() for name in ("time", "force", "gap", "impulse_history", "state")]
    worn = [wear.worn.tobytes().hex() + wear.map.tobytes().hex() for wear in result.tracks]
    return json.dumps({**result.to_dict(), "seconds": 0.0, "arrays": arrays, "worn": worn})


@pytest.mark.slow
@pytest.mark.usefixtures("at_once")
@pytest.mark.parametrize("name", RUNS)
def test_a_stopped_run_goes_on_to_the_same_bits(name: str, tmp_path: Path) -> None:
    what, how = RUNS[name]
    file, record = tmp_path / "part.npz", ct.Record(every=50, state_every=500)
    with pytest.raises(StoppedError):
        ct.run(what, **how, record=record, on_limit="flag", checkpoint=file, progress=stop)
    seen: list[float] = []
    again = ct.run(what, **how, record=record, on_limit="flag", checkpoint=file, progress=seen.append)
    assert 0.3 < seen[0] < 0.9  # it did not begin anew
    whole = ct.run(what, **how, record=record, on_limit="flag")
    assert whole.contact_steps.sum() > 0
    assert all(wear.worn.max() > 0.0 for wear in whole.tracks)
    assert words(again) == words(whole)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rotor that slows", "rub with a coating", "patch with friction"])
def test_a_longer_run_begins_with_the_shorter_one(name: str) -> None:
    """Both call the compiled loop at other steps, also within steps that share the coefficients of one speed."""
    what, how = RUNS[name]
    record = ct.Record(every=50, state_every=50)
    long, short = (
        ct.run(what, law=how["law"], dt=2e-6, t_end=end, record=record, on_limit="flag") for end in (0.012, 0.0101)
    )
    count, largest = len(short.state), np.abs(short.state).max(axis=0)
    assert short.contact_steps.sum() > 300
    assert np.all(np.abs(long.state[:count] - short.state) <= 1e-9 * largest)


@pytest.mark.usefixtures("at_once")
def test_a_file_of_another_run_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "part.npz"
    with pytest.raises(StoppedError):
        ct.run([ROD, ct.Wall(x=0.0)], **LONG, checkpoint=file, progress=stop)
    for other in (replace(ROD, velocity=-2.5), replace(ROD, E=7.1e10)):
        with pytest.raises(ct.InputError, match="found a checkpoint of another computation"):
            ct.run([other, ct.Wall(x=0.0)], **LONG, checkpoint=file)
    file.write_bytes(file.read_bytes()[:1000])
    with pytest.raises(ct.InputError, match="delete"):
        ct.run([ROD, ct.Wall(x=0.0)], **LONG, checkpoint=file)


def test_a_short_run_writes_no_file(tmp_path: Path) -> None:
    ct.run([ROD, ct.Wall(x=0.0)], t_end=1e-3, dt=1e-6, checkpoint=tmp_path / "part.npz")
    assert not list(tmp_path.iterdir())
