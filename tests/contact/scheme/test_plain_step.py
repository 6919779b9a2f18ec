"""Every option of a rub's compiled loop against the same steps of whole matrices (`plain_step`)."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.plain_step import PlainPatch, PlainRub
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, round_rim, tips

H = 2e-5
# tips on the first blade, or on both, three directions, friction, law, what couples modes or that the casing is round
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
    "twelve tips in three directions": (6, True, 0.2, "averaged", None),
    "eighteen tips, slowly": (9, False, 0.3, "averaged", "slow"),
    "eighteen tips, casing turns slowly": (9, False, 0.3, "forward", "slow casing"),
}


def coupled(body, seed, *, cross=False):
    """The body with full matrices of rotation, or with full damping and a nonsymmetric stiffness."""
    mixed, other = np.random.default_rng(seed).standard_normal((2, body.omega.size, body.omega.size))
    if cross:
        return replace(body, damping=5.0 * mixed @ mixed.T, stiffness=3e3 * other)
    return replace(body, gyroscopic=mixed - mixed.T, stiffness_by_speed=other + other.T)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_tips_press_as_steps_of_whole_matrices_state(name):
    count, axial, mu, law, couples = CASES[name]
    steps = {1: 300, 2: 50, 6: 12, 9: 6}[count]  # one tip is thrown off, and comes back
    other = count if count > 2 else 1
    casing, blades = round_rim() if couples == "round" else rim3(), [nodes(max(count, 2)), nodes(other, seed=6)]
    if couples == "blades":
        blades = [coupled(body, 3 + k) for k, body in enumerate(blades)]
    elif couples in ("casing", "cross", "slow casing"):
        casing = coupled(casing, 2, cross=couples == "cross")
    slow = couples in ("slow", "slow casing")  # so that the contacts' matrix is interpolated over the angle
    points = tips(count, axial=axial)
    if count > 1:
        points += tips(other, blade=1, angle=190.0, axial=axial)
    rub = ct.Rub(
        casing, blades, points, clearance=-2e-4, speed=ct.Speed.constant(1.0 if slow else 25.0),
        profile=ct.gaps.RimProfile.fourier([{"p": 2, "cos": 2e-5}, {"p": 3, "sin": 1e-5}]),
        turning="blades" if couples == "blades" else "casing",
    )  # fmt: skip
    friction = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    found = ct.run(
        rub, law=friction, scheme=ct.ExactModal(law=law), dt=H, t_end=(steps - 0.5) * H, on_limit="flag",
        record=ct.Record(every=1, state_every=1),
    )  # fmt: skip
    wanted = PlainRub(rub, law=friction, h=H, averaged=law == "averaged").forces(steps)
    assert (wanted[:, :: rub.dimensions if mu else 1] > 0.0).sum() > 10
    np.testing.assert_allclose(found.tip_force.reshape(wanted.shape), wanted, rtol=0.0, atol=1e-7 * wanted.max())


@pytest.mark.slow
@pytest.mark.parametrize("count", [6, 10])  # 24 directions have rows of their own at a speed that varies, 40 do not
def test_interpolating_the_matrix_of_many_contacts_over_the_angle_changes_forces_by_round_off(count):
    """At a speed that varies, by 1e-13 here, the matrix is made of products in each step."""
    points = [*tips(count, axial=False), *tips(count, blade=1, angle=190.0, axial=False)]
    steps, found = 200, []
    for hz in ([1.0, 1.0], [1.0, 1.0 + 1e-13]):
        rub = ct.Rub(
            rim3(), [nodes(count), nodes(count, seed=6)], points, clearance=-2e-4,
            speed=ct.Speed(time=[0.0, 1.0], hz=hz),
            turning="blades",
        )  # fmt: skip
        scene = ct.Scene(what=rub, law=ct.Coulomb(mu=0.3), dt=H, t_end=steps * H, on_limit="flag")
        found.append(ct.run(replace(scene, record=ct.Record(every=1))).force)
    assert (found[0] > 0.0).sum() > 100
    np.testing.assert_allclose(found[0], found[1], rtol=0.0, atol=1e-9 * found[0].max())


def rough_rim(n_max=16, size=22):
    """A casing with every harmonic in every mode, smaller the higher it is."""
    rng = np.random.default_rng(4)
    order = np.abs(np.tile([*range(n_max + 1), *range(1, n_max + 1)], 2))
    rows = rng.standard_normal((order.size, size)) / (1.0 + order[:, None])
    return ct.ModalBody(
        omega=np.linspace(300.0, 9000.0, size), zeta=[0.003] * size, channels=ct.bodies.rim_channels(n_max), rows=rows,
        S=2e-8 * np.eye(order.size), kind="rim", n_max=n_max, radius=0.4,
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("law", [ct.Unilateral(), ct.Coulomb(mu=0.3), ct.laws.Hertz(k=3e9, mu=0.3)])
def test_series_of_the_rows_of_one_tip_over_the_angle_change_forces_by_round_off(law):
    """Where the speed rises after the end of the run, the rows are sums of waves in each step."""
    steps, found = 4000, []
    for speed in (ct.Speed.constant(-2.0), ct.Speed(time=[0.0, 1.0, 1.1], hz=[-2.0, -2.0, -140.0])):
        rub = ct.Rub(
            rough_rim(), [blade()], [ct.ContactPoint(lean_deg=10.0)], clearance=-2e-4, speed=speed, turning="blades"
        )
        scene = ct.Scene(what=rub, law=law, dt=H, t_end=steps * H, on_limit="flag", record=ct.Record(every=1))
        found.append(ct.run(scene).force)
    assert 0.2 * steps < (found[0] > 0.0).sum() < steps
    assert not np.array_equal(found[0], found[1])  # two ways of computing
    np.testing.assert_allclose(found[0], found[1], rtol=0.0, atol=1e-10 * found[0].max())


def three_tips(casing, **more):
    """Two blades with three tips in all."""
    points = [*tips(2, axial=False), *tips(1, blade=1, angle=190.0, axial=False)]
    given = {"clearance": -2e-4, "speed": ct.Speed.constant(25.0), "turning": "casing"}
    return ct.Rub(casing, [nodes(2), nodes(1, seed=6)], points, **given | more)


def compare(found, plain, steps):
    """Normal forces of a run are those of steps of whole matrices; some contacts press, not always all."""
    wanted = plain.forces(steps)[:, :: plain.d]
    assert (wanted > 0.0).sum() > 10
    np.testing.assert_allclose(found.force[:steps], wanted, rtol=0.0, atol=1e-7 * wanted.max())


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.3])
@pytest.mark.parametrize("law", ["rigid", "Hertz"])
def test_tips_with_a_law_on_a_rim_that_whirls_closes_and_changes_speed(law, mu):
    steps = 60
    rub = three_tips(
        rim3(), speed=ct.Speed(time=[0.0, steps * H], hz=[20.0, 26.0]), turning="blades",
        whirl=[ct.gaps.Whirl(amplitude=3e-5, per_rev=1.0), ct.gaps.Whirl(amplitude=2e-5, hz=40.0, phase_deg=30.0)],
        closing=ct.gaps.Closing(time=[0.0, steps * H], by=[0.0, 1e-5]),
    )  # fmt: skip
    rigid = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    contact = rigid if law == "rigid" else ct.laws.Hertz(k=3e9, mu=mu)
    found = ct.run(
        rub, law=contact, scheme=ct.ExactModal(law="averaged"), dt=H, t_end=(steps - 0.5) * H, on_limit="flag",
        record=ct.Record(every=1),
    )  # fmt: skip
    compare(found, PlainRub(rub, law=contact, h=H, averaged=True), steps)


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.3])
@pytest.mark.parametrize("machined", [0.0, 3e-5])
def test_tips_in_a_coating_press_and_wear_it_as_steps_of_whole_matrices_state(machined, mu):
    steps = 40
    coating = ct.Abradable(
        E=1e9, yield_stress=2e5, hardening=1e8, thickness=2e-3, width=0.04, tip=0.02, machined=machined, mu=mu
    )
    rub = three_tips(rim3(), profile=ct.gaps.RimProfile.fourier([{"p": 2, "cos": 2e-5}, {"p": 3, "sin": 1e-5}]))
    found = ct.run(
        rub, law=coating, scheme=ct.ExactModal(law="averaged"), dt=H, t_end=(steps - 0.5) * H, on_limit="flag",
        record=ct.Record(every=1),
    )  # fmt: skip
    plain = PlainRub(rub, law=coating, h=H, averaged=True)
    compare(found, plain, steps)
    worn, wanted = (
        np.concatenate(parts) for parts in ([track.worn for track in found.tracks], list(plain.worn.values()))
    )
    assert (wanted > 0.0).sum() > 10
    np.testing.assert_allclose(worn, wanted, rtol=0.0, atol=1e-7 * wanted.max())


@pytest.mark.slow
@pytest.mark.parametrize("tangents", [0, 1, 2])
@pytest.mark.parametrize("law", ["rigid", "Hertz"])
def test_contacts_of_a_patch_press_as_steps_of_whole_matrices_state(law, tangents):
    rng, h, steps = np.random.default_rng(8), 0.01, 50
    names = tuple(f"{way}{k}" for k in range(3) for way in "nst")
    body = ct.ModalBody(
        omega=[5.0, 9.0, 14.0, 20.0], zeta=[0.02, 0.01, 0.03, 0.01], channels=names,
        rows=rng.standard_normal((9, 4)), S=2e-3 * np.eye(9),
    )  # fmt: skip
    slip = {"tangent": [names[3 * k + 1 : 3 * k + 1 + tangents] for k in range(3)], "slide": [0.3, -0.1][:tangents]}
    patch = ct.Patch(
        body=body, normal=names[::3], load=-8.0 * body.rows[0] - 5.0 * body.rows[3], clearance=[0.1, 0.12, 0.15],
        velocity=[0.4, -0.5, 0.6, 0.3], **slip if tangents else {},
    )  # fmt: skip
    mu = 0.3 if tangents else 0.0
    rigid = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    contact = rigid if law == "rigid" else ct.laws.Hertz(k=300.0, mu=mu)
    found = ct.run(patch, law=contact, dt=h, t_end=(steps - 0.5) * h, record=ct.Record(every=1), on_limit="flag")
    compare(found, PlainPatch(patch, law=contact, h=h, averaged=law == "Hertz"), steps)


@pytest.mark.slow
def test_rims_in_batches_press_as_steps_of_whole_matrices_state():
    steps = 200
    scenes = [
        ct.Scene(
            what=ct.RotatingRim(ring(imperfect=0.05), blade(), clearance=-2e-4, speed_hz=hz, lean_deg=10.0),
            law=ct.Coulomb(mu=0.2), scheme=ct.ExactModal(law=law), dt=H, t_end=(steps - 0.5) * H, on_limit="flag",
            record=ct.Record(every=1),
        )
        for hz, law in ((25.0, "forward"), (-10.0, "averaged"), (5.0, "averaged"))
    ]  # fmt: skip
    for scene, found in zip(scenes, ct.run_many(scenes), strict=True):
        rim = scene.what
        rub = ct.Rub(
            rim.casing, [rim.blade], [ct.ContactPoint(lean_deg=rim.lean_deg)], clearance=rim.clearance,
            speed=ct.Speed.constant(rim.speed_hz),
        )  # fmt: skip
        compare(found, PlainRub(rub, law=scene.law, h=H, averaged=scene.scheme.law == "averaged"), steps)
