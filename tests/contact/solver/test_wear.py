"""Abradable coatings: the bars' law, what they lose, and when the contact stays closed."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import N_MAX, SIZE, blade, harmonics, ring

TERMS = [{"p": 2, "cos": 4e-5}]
SOFT = {"E": 1e9, "yield_stress": 2e4, "hardening": 1e6, "thickness": 1e-3, "width": 0.02, "tip": 6e-3}

pytestmark = pytest.mark.slow  # they compile loops for seconds


def coating(**changes):
    return ct.Abradable(**{**SOFT, "bars": 2, **changes})


def rim(*, clearance=-2e-5, zeta=0.01, speed_hz=5.0, terms=TERMS, **options):
    return ct.RotatingRim(
        ring(zeta=zeta),
        blade(zeta=zeta),
        clearance=clearance,
        speed_hz=speed_hz,
        lean_deg=20.0,
        out_of_roundness=terms,
        **options,
    )


def test_at_rest_the_force_is_what_the_worn_bar_leaves():
    """Omega = 0: force = -(g_0 + w)/(static compliance + thickness/(E area)), below the stress at which it flows."""
    law = coating(hardening=0.0)
    scene = rim(clearance=-1e-4, zeta=0.9, speed_hz=0.0, terms=[])
    result = ct.run(scene, law=law, t_end=0.4, dt=2e-5)
    lean, waves = np.radians(scene.lean_deg), harmonics(N_MAX, 0.0)
    along = np.array([np.cos(lean), np.sin(lean)])
    compliance = waves @ scene.casing.S[:SIZE, :SIZE] @ waves + along @ scene.blade.S @ along
    for body, row in ((scene.casing, waves @ scene.casing.rows[:SIZE]), (scene.blade, along @ scene.blade.rows)):
        compliance += np.sum(row**2 / body.omega**2)
    area = law.width * 2.0 * np.pi * 0.45 * 2 / 942  # two bars
    worn = result.wear.worn.max()
    assert worn > 1e-5
    force = (1e-4 - worn) / (compliance + law.thickness / (law.E * area))
    assert result.force[-1, 0] == pytest.approx(force, rel=1e-9)
    assert force <= law.yield_stress * area * (1.0 + 1e-9)


@pytest.mark.parametrize("hardening", [0.0, 1e8])
def test_the_worn_volume_is_the_energy_dissipated(hardening):
    law = coating(hardening=hardening, mu=0.1)
    result = ct.run(rim(), law=law, t_end=0.3, dt=1e-5)
    wear = result.wear
    assert wear.volume > 1e-9
    assert abs(wear.residual) <= 1e-12
    assert wear.worn.size == 942  # bars of 3 mm around a radius of .45 m
    bar = law.width * 2.0 * np.pi * 0.45 / 942
    assert wear.volume == pytest.approx(bar * wear.worn.sum(), rel=1e-12)
    assert wear.stated == pytest.approx(bar * sum(law.dissipated(w) for w in wear.worn), rel=1e-12)
    assert (wear.stated == pytest.approx(law.yield_stress * wear.volume, rel=1e-12)) == (hardening == 0.0)
    assert abs(result.energy.unaccounted) <= 1e-11 * result.energy.scale
    assert result.residual[0] <= 1e-12 * law.thickness
    assert np.all(np.diff(wear.map, axis=0) >= 0.0)
    assert np.array_equal(wear.map[-1], wear.worn)
    assert np.all(np.diff(wear.map_time) > 0.0)


def test_a_hard_stiff_coating_is_a_bare_rim():
    hard = ct.run(rim(), law=coating(E=1e18, yield_stress=1e12, mu=0.1), t_end=0.1, dt=1e-5)
    bare = ct.run(rim(), law=ct.Coulomb(mu=0.1), t_end=0.1, dt=1e-5)
    assert np.allclose(hard.force, bare.force, rtol=0.0, atol=1e-6 * bare.force.max())
    assert hard.wear.volume == 0.0
    assert bare.wear is None


def test_machining_to_a_circle_closes_the_contact_for_good():
    """The blade is advanced as far past the first touch before and after."""
    law = coating(yield_stress=1e12)
    before = ct.run(rim(clearance=3e-5, zeta=0.1), law=law, t_end=0.6, dt=1e-5)
    round_law = coating(yield_stress=1e12, machined=8e-5)
    after = ct.run(rim(clearance=3e-5 - 8e-5, zeta=0.1), law=round_law, t_end=0.6, dt=1e-5)
    assert before.contact_steps[0] < 0.4 * before.steps
    late = after.time > 0.3
    assert np.all(after.force[late] > 0.0)
    assert np.ptp(after.wear.before) <= 1e-15
    assert np.ptp(after.wear.made) == pytest.approx(8e-5, rel=1e-3)


def test_half_a_cut_leaves_the_valleys():
    wear = ct.run(rim(), law=coating(machined=3e-5), t_end=1e-3, dt=1e-5).wear
    assert wear.before.min() == pytest.approx(-1e-5, abs=2e-9)
    deep = wear.cut == 0.0
    assert np.array_equal(deep, wear.made > wear.made.min() + 3e-5)
    assert 0.2 < deep.mean() < 0.8
    np.testing.assert_allclose(wear.after - wear.before, wear.worn, rtol=0.0, atol=1e-18)


def test_wear_stops_at_the_bare_casing():
    result = ct.run(rim(clearance=-5e-5), law=coating(thickness=2e-5, hardening=0.0), t_end=0.3, dt=1e-5)
    assert result.wear.worn.max() == 2e-5
    assert result.wear.bare > 10
    assert result.force.max() > 2.0 * 2e4 * 0.02 * 6e-3


def test_a_coating_may_bring_the_energy_of_the_drive():
    """Lobes pass near the blade's frequency: contact adds four times what else there is, and yet nothing diverges."""
    law = coating(E=2e7, hardening=1e5)
    what = replace(rim(speed_hz=62.0), lean_deg=-10.0)
    result = ct.run(what, law=law, t_end=3.2, dt=4e-5, record=ct.Record(every=10))
    assert result.divergence is None
    assert result.wear.dissipated > 10.0 * result.energy.others  # the drive pays, what else there is could not
    stress = law.yield_stress + law.hardening * result.wear.worn.max() / law.thickness
    assert result.peak_force[0] == pytest.approx(stress * law.width * law.tip, rel=1e-2)
    assert result.force[result.time > 3.0].max() == 0.0  # worn free


def test_a_saved_result_keeps_its_wear(tmp_path):
    result = ct.run(rim(), law=coating(), t_end=0.05, dt=1e-5)
    result.save(tmp_path / "run.npz")
    again = ct.Result.load(tmp_path / "run.npz")
    assert np.array_equal(again.wear.map, result.wear.map)
    assert again.wear.dissipated == result.wear.dissipated
    assert "coating: worn" in repr(again)


def test_bad_coatings():
    with pytest.raises(ct.InputError, match="bars: found 0, expected"):
        coating(bars=0)
    with pytest.raises(ct.InputError, match="hardening: found -1"):
        coating(hardening=-1.0)
    with pytest.raises(ct.InputError, match=r"machined: found 0\.00107 m, expected at most"):
        coating(machined=1.07e-3)
    with pytest.raises(ct.InputError, match="tip: found 1 m, expected at most a quarter of the circumference"):
        ct.run(rim(), law=coating(tip=1.0), t_end=0.01, dt=1e-5)
    with pytest.raises(ct.InputError, match=r"tip: found 1e-30 m with .*, expected at most 1000000: use"):
        ct.run(rim(), law=coating(tip=1e-30), t_end=0.01, dt=1e-5)
    body = ct.ModalBody(omega=[10.0], zeta=[0.0], channels=("x",), rows=[[1.0]], S=[[1e-6]])
    point = ct.PointGap(sides=(ct.gaps.Side(body=body, channel="x", sign=1),))
    with pytest.raises(ct.InputError, match="Abradable on PointGap, expected a RotatingRim"):
        ct.run(point, law=coating(), t_end=0.1, dt=1e-3)
    with pytest.raises(ct.InputError, match="Abradable"):
        ct.run([ct.PointMass(mass=1.0), ct.Wall(x=1.0)], law=coating(), t_end=0.1, dt=1e-3)
