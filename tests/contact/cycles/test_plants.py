"""What a motion consists of, by hand: plants and drives of driven bodies, forcings, phases of closed contacts."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct

OMEGA, ZETA = np.array([2.0, 5.0]), np.array([0.01, 0.03])
ROWS = np.array([[1.0, 0.5], [0.3, -0.7], [-0.2, 0.9], [0.4, 0.6]])
COUPLED = np.array([[0.5, 0.1, 0.0, 0.2], [0.1, 0.4, 0.05, 0.0], [0.0, 0.05, 0.3, 0.1], [0.2, 0.0, 0.1, 0.6]])


def body(omega=OMEGA, S=COUPLED):
    return ct.ModalBody(omega=omega, zeta=ZETA, channels=("d", "n1", "t1", "n2"), rows=ROWS, S=S)


def driven(mu=0.0, slide=-3.0, S=COUPLED, **more):
    """One contact with friction, or two without."""
    given = {"normal": ("n1",), "tangent": (("t1",),), "slide": slide} if mu else {"normal": ("n1", "n2")}
    patch = ct.Patch(body=body(S=S), clearance=0.25, load=[0.7, -0.4], pressed=0.125, **given)
    return ct.cycles.DrivenBody(
        patch=patch, channel="d", amplitude=3.0, mu=mu, **{"stiffness": 8.0, "shown": ("d",)} | more
    )


def test_the_drive_of_a_driven_body_is_its_force_and_load():
    family = driven().over("freq_hz", freq_hz=1.5)
    motion, period = family.at(2.0)
    drive = motion.drive
    assert (period, drive.w, drive.harmonics.tolist()) == (0.5, pytest.approx(4.0 * math.pi), [1.0])
    np.testing.assert_allclose(drive.b.rest, [0.0, 0.0, 0.35, -0.08], rtol=1e-14)
    np.testing.assert_allclose(drive.b.wave[:, 0], [0.0, 0.0, 1.5, 0.3], rtol=1e-14)
    np.testing.assert_allclose(drive.c.rest, [0.375, 0.375], rtol=1e-14)
    np.testing.assert_allclose(drive.c.wave[:, 0], [0.3, 0.6], rtol=1e-14)
    np.testing.assert_allclose(drive.d.wave[:, 0], [1.5], rtol=1e-14)
    assert drive.d.rest.tolist() == [0.0]


@pytest.mark.parametrize(("name", "value"), [("freq_hz", 2.0), ("amplitude", 7.0), ("clearance", 0.5)])
def test_one_parameter_varies_and_the_others_stay(name, value):
    family = driven().over(name, freq_hz=1.5)
    motion, period = family.at(value)
    assert period == pytest.approx(1.0 / (value if name == "freq_hz" else 1.5))
    assert motion.drive.b.wave[2, 0] == pytest.approx((value if name == "amplitude" else 3.0) / 2.0)
    assert motion.drive.c.rest[0] == pytest.approx((value if name == "clearance" else 0.25) + 0.125)
    assert (family.name, family.channels) == (name, ("d",))


def test_frequencies_of_a_drive_are_above_zero():
    for freq_hz in (0.0, -1.0):
        with pytest.raises(ct.InputError, match="freq_hz: found"):
            driven().over("amplitude", freq_hz=freq_hz)
        with pytest.raises(ct.InputError, match="freq_hz: found"):
            driven().over("freq_hz", freq_hz=1.0).at(freq_hz)
    for name in ("amplitude", "mu"):
        with pytest.raises(ct.InputError, match=f"{name}: found -0.5"):
            replace(driven(), **{name: -0.5})


def test_a_rigid_mode_has_a_frequency_too_low_to_be_felt_and_no_damping():
    patch = ct.Patch(body=body(omega=np.array([0.0, 0.5])), normal=("n1",))
    family = ct.cycles.DrivenBody(patch=patch, channel="d", amplitude=1.0, stiffness=8.0).over("freq_hz", freq_hz=1.5)
    scale, slow = 3.0 * math.pi, 1e-6 * 3.0 * math.pi
    np.testing.assert_allclose(family.scale, [scale, 0.5], rtol=1e-14)
    np.testing.assert_allclose(np.diag(family.plant.A[2:, :2]), [-(slow**2) / scale, -0.5], rtol=1e-12)
    np.testing.assert_allclose(np.diag(family.plant.A[2:, 2:]), [0.0, -0.03], rtol=1e-12)
    assert family.state([1.0, 2.0], [3.0, 4.0]).tolist() == pytest.approx([1.0, 2.0, 3.0 / scale, 8.0])
    assert family.channels == ("d", "n1", "t1", "n2")


def test_runs_begin_where_the_patch_does():
    patch = ct.Patch(body=body(), normal=("n1",), clearance=9.0, displacement=[1.0, -2.0], velocity=[4.0, 10.0])
    family = ct.cycles.DrivenBody(patch=patch, channel="d", amplitude=1.0, stiffness=8.0).over("freq_hz", freq_hz=1.5)
    assert family.begin.tolist() == [1.0, -2.0, 2.0, 2.0]


def test_rigid_contacts_that_follow_from_each_other_are_refused():
    patch = ct.Patch(body=body(S=np.zeros((4, 4))), normal=("n1", "n1"), clearance=1.0)
    with pytest.raises(ct.InputError, match="normal: found linearly dependent rows"):
        ct.cycles.DrivenBody(patch=patch, channel="d", amplitude=1.0)
    ct.cycles.DrivenBody(patch=patch, channel="d", amplitude=1.0, stiffness=[8.0, math.inf])
    for name in ("channel", "shown"):
        with pytest.raises(ct.InputError, match="channel: found 'z'"):
            ct.cycles.DrivenBody(
                patch=patch, **{"channel": "d", "amplitude": 1.0} | {name: ("z",) if name == "shown" else "z"}
            )
