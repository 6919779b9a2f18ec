"""Abradable coatings: the bars' law, what they lose, and when the contact stays closed."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import contact as ct
from contact.solver.abradable.tips import Coating, borne, first_bar, machined, settled, surface, wear
from tests.contact.synthetic_rim import blade, ring

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


def random_bars(rng):
    cells = int(rng.integers(8, 30))
    return Coating(
        worn=rng.uniform(0.0, 1e-4, cells), round=rng.uniform(-5e-5, 5e-5), mean=0.0, thickness=rng.uniform(2e-4, 3e-4),
        stiffness=10.0 ** rng.uniform(4, 8), yield_force=10.0 ** rng.uniform(-1, 3),
        hardening=rng.choice([0.0, 1e4, 1e7]), under=int(rng.integers(1, 8)), memory=np.zeros(3),
    )  # fmt: skip


def test_the_force_of_bars_is_the_root_of_their_law():
    """Each bar for itself: elastic, flowing or bare, whichever its depth says."""
    rng = np.random.default_rng(3)
    met = set()
    for _ in range(300):
        c, D, gap = random_bars(rng), 10.0 ** rng.uniform(-8, -5), -rng.uniform(2e-5, 6e-4)
        first = int(rng.integers(c.worn.size))
        under = (first + np.arange(c.under)) % c.worn.size
        clearance = rng.uniform(-5e-5, 5e-5)
        worn, cut = c.worn[under].copy(), machined(c, clearance)
        assert cut == max(c.round - clearance, 0.0)

        def bars(depth, worn=worn, cut=cut, left=c.thickness - cut, c=c):
            elastic = c.stiffness * np.maximum(depth - cut - worn, 0.0)
            flows = elastic > c.yield_force + c.hardening * worn
            deeper = (c.stiffness * (depth - cut) - c.yield_force) / (c.stiffness + c.hardening)
            after = np.where(flows, np.minimum(deeper, left), worn)
            met.update({"elastic" if not flows.any() else "flow", *(["bare"] if np.any(after == left) else [])})
            return c.stiffness * np.maximum(depth - cut - after, 0.0), after

        if -gap < surface(c, first, cut):
            continue
        depth = brentq(lambda d, D=D, gap=gap, bars=bars: d + D * bars(d)[0].sum() + gap, 0.0, -gap, xtol=1e-18)
        found = settled(c, first, cut, D, gap)
        wear(c, first, cut, found)
        force = -(gap + found) / D
        expected, after = bars(depth)
        assert force == pytest.approx(expected.sum(), rel=1e-9, abs=1e-9 * abs(gap) / D)
        assert np.allclose(c.worn[under], after, rtol=0.0, atol=1e-13)
    assert met == {"elastic", "flow", "bare"}


@pytest.mark.parametrize(
    ("depth", "force", "slope"), [(0.5, 0.0, 0.0), (0.75, 1.0, 4.0), (1.0, 2.0, 4.0), (1.5, 6.0, 8.0)]
)
def test_a_bar_stiffens_the_tip_only_once_it_is_pressed_not_where_it_is_just_reached(depth, force, slope):
    """Two bars of 4 N/m, worn by 1/4 and 3/4 below a cut of 1/4."""
    two = Coating(np.array([0.25, 0.75]), 0.0, 0.0, 9.0, 4.0, 100.0, 0.0, 2, np.zeros(3))
    assert borne(two, 0, 0.25, depth) == (force, slope)


def test_the_tip_covers_the_bars_about_its_middle():
    three = Coating(np.zeros(10), 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 3, np.zeros(3))
    assert [first_bar(three, turns) for turns in (0.25, 0.05, 0.0, -0.05, 1.25, -2.95)] == [1, 9, 9, 8, 1, 9]


def test_at_rest_the_force_is_what_the_worn_bar_leaves():
    """Omega = 0: force = -(g_0 + w)/(static compliance + thickness/(E area)), below the stress at which it flows."""
    from contact.model.gaps.modal_system import rim_system

    law = coating(hardening=0.0)
    scene = rim(clearance=-1e-4, zeta=0.9, speed_hz=0.0, terms=[])
    result = ct.run(scene, law=law, t_end=0.4, dt=2e-5)
    system = rim_system(scene)
    normal, _ = system.table.rows(0.0)
    compliance = np.sum(normal**2 / system.omega**2) + system.S_nn(0.0)
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


def test_long_runs_keep_every_second_map(monkeypatch):
    from contact.scheme.modal import wear_track

    monkeypatch.setattr(wear_track, "MOST_MAPS", 8)
    wear = ct.run(rim(), law=coating(), t_end=0.05, dt=1e-5).wear
    assert 4 <= len(wear.map) <= 8
    assert np.allclose(np.diff(wear.map_time), wear.map_time[0])


def test_bad_coatings():
    with pytest.raises(ct.InputError, match="bars: found 0, expected"):
        coating(bars=0)
    with pytest.raises(ct.InputError, match="hardening: found -1"):
        coating(hardening=-1.0)
    with pytest.raises(ct.InputError, match=r"machined: found 0\.00107 m, expected at most"):
        coating(machined=1.07e-3)
    with pytest.raises(ct.InputError, match="tip: found 1 m, expected at most a quarter of the rim"):
        ct.run(rim(), law=coating(tip=1.0), t_end=0.01, dt=1e-5)
    with pytest.raises(ct.InputError, match=r"tip: found 1e-30 m with .*, expected at most 1000000: take"):
        ct.run(rim(), law=coating(tip=1e-30), t_end=0.01, dt=1e-5)
    body = ct.ModalBody(omega=[10.0], zeta=[0.0], channels=("x",), rows=[[1.0]], S=[[1e-6]])
    point = ct.PointGap(sides=(ct.gaps.Side(body=body, channel="x", sign=1),))
    with pytest.raises(ct.InputError, match="Abradable on PointGap, expected a RotatingRim"):
        ct.run(point, law=coating(), t_end=0.1, dt=1e-3)
    with pytest.raises(ct.InputError, match="Abradable"):
        ct.run([ct.PointMass(mass=1.0), ct.Wall(x=1.0)], law=coating(), t_end=0.1, dt=1e-3)
