"""Gravity and whirl on the bodies of a rub: exact motions, statics, energy, and who turns."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contact as ct
from tests.contact.synthetic_rub import N_MAX, SIZE

G = 9.80665
SHARE = np.array([[0.3, 0.8], [1.1, -0.4], [0.2, 0.5]])  # sqrt(kg)


def casing(zeta=0.02):
    """Modes that move along x, y and the axis, far from the blade."""
    channels = ct.bodies.rim_channels(N_MAX, 3)
    rows = np.random.default_rng(19).standard_normal((len(channels), 3))
    return ct.ModalBody(
        omega=[400.0, 500.0, 650.0], zeta=[zeta] * 3, channels=channels, rows=rows, S=1e-8 * np.eye(3 * SIZE),
        kind="rim", n_max=N_MAX, radius=0.4, participation=[[1.2, 0.1, 0.0], [0.0, 0.9, 0.2], [0.0, 0.1, 0.7]],
    )  # fmt: skip


def blade(zeta=0.02):
    return ct.ModalBody(
        omega=[300.0, 900.0], zeta=[zeta] * 2, channels=("span", "flap"), rows=[[0.1, 0.3], [1.0, 0.4]],
        S=1e-8 * np.eye(2), participation=SHARE,
    )  # fmt: skip


def rub(forces, *, zeta=0.02, hz=7.0, speed=None, lean=20.0, angle=35.0, clearance=0.03, **more):
    return ct.Rub(
        casing(zeta), [blade(zeta)], [ct.ContactPoint(angle_deg=angle, lean_deg=lean)], clearance=clearance,
        speed=speed or ct.Speed.constant(hz), forces=forces,
        turning="casing" if any(force.casing_turns for force in forces) else "blades", **more,
    )  # fmt: skip


def ran(scene, t_end, h=5e-5, every=10):
    return ct.run(scene, t_end=t_end, dt=h, record=ct.Record(every=every, state_every=every))


def answer(body, load, t):
    """Motion from rest at zero under load(t) (m,), by a fine integration."""
    w, z, m = body.omega, body.zeta, body.omega.size

    def rate(at, y):
        return np.concatenate([y[m:], load(at) - 2.0 * z * w * y[m:] - w**2 * y[:m]])

    return solve_ivp(rate, (0.0, t[-1]), np.zeros(2 * m), t_eval=t, rtol=1e-5, atol=1e-9, method="DOP853").y[:m].T


@pytest.mark.slow
@pytest.mark.parametrize("turning", ["blades", "casing"])
def test_gravity_on_what_turns_is_a_steady_oscillation_of_the_exact_amplitude(turning):
    """Whoever turns sees gravity go round: q = Re F e^(i W t)/(w^2 - W^2 + 2 i z w W); the other sags and stays."""
    result = ran(rub([ct.gaps.BodyForce.gravity(turning=turning, down_deg=-90.0)], zeta=0.06), 1.2)
    omega, late = 2.0 * np.pi * 7.0, result.state_time > 0.9
    t, phi, a = result.state_time[late], np.radians(35.0), np.radians(20.0)
    down = np.radians(-90.0)
    # as a phasor: the direction of gravity in the casing is e^(i (down - W t)) where the casing turns
    for name, body in (("casing", casing(0.06)), ("blade", blade(0.06))):
        turns = (name == "casing") == (turning == "casing")
        way = (-1.0 if name == "casing" else 1.0) if turns else 0.0  # of gravity in the body's own axes
        if name == "casing":
            x, y = np.exp(1j * down), np.exp(1j * (down - np.pi / 2.0))
            force = G * (body.participation[0] * x + body.participation[1] * y)
        else:
            radial, around = np.exp(1j * (down - phi)), np.exp(1j * (down - phi - np.pi / 2.0))
            force = G * (body.participation[0] * (np.cos(a) * radial - np.sin(a) * around))
            force = force + G * body.participation[1] * (np.sin(a) * radial + np.cos(a) * around)
        if way < 0.0:
            force = np.conj(force)
        rate = omega if turns else 0.0
        gain = 1.0 / (body.omega**2 - rate**2 + 2j * body.zeta * body.omega * rate)
        exact = (force * gain * np.exp(1j * np.outer(t, rate * np.ones(len(body.omega))))).real
        assert np.abs(result.state_of(name)[late] - exact).max() <= 2e-5 * np.abs(exact).max()
    assert result.impulse[0] == 0.0
    assert abs(result.energy.unaccounted) <= 1e-11 * result.energy.scale


@pytest.mark.slow
def test_a_settled_rub_stays_where_gravity_keeps_it():
    """Speed 0: q = P^T a/w^2 from the first step to the last; from zero it gets there by its damping."""
    still = rub([ct.gaps.BodyForce.gravity(turning="blades", axial=-3.0)], hz=0.0, angle=0.0, lean=0.0)
    exact = np.concatenate([
        (casing().participation.T @ [0.0, -G, -3.0]) / casing().omega**2,
        (blade().participation.T @ [0.0, -G, -3.0]) / blade().omega**2,
    ])  # fmt: skip
    rest = ran(ct.gaps.settled(still), 0.1).state[:, :5]
    assert np.abs(rest - exact).max() <= 1e-13 * np.abs(exact).max()
    later = ran(still, 2.0).state[-1, :5]
    assert np.abs(later - exact).max() <= 1e-4 * np.abs(exact).max()


@pytest.mark.slow
@pytest.mark.parametrize(("on", "turning"), [("casing", "blades"), ("blades", "casing"), ("blades", "blades")])
def test_an_unbalance_that_runs_up_is_the_acceleration_of_its_frame(on, turning):
    """The second derivative of where the frame's origin is, by differences: w^2 r, w' r and who turns."""
    speed = ct.Speed(time=[0.0, 0.05, 0.2], hz=[20.0, 20.0, 45.0])
    whirl = ct.gaps.Whirl(amplitude=2e-3, per_rev=0.7, hz=-3.0, phase_deg=50.0)
    scene = rub([ct.gaps.BodyForce.of_whirl(whirl, on, turning=turning)], zeta=0.05, speed=speed)
    result = ran(scene, 0.12, h=2e-5, every=25)
    body, other = (casing(0.05), "blade") if on == "casing" else (blade(0.05), "casing")

    def origin(t):  # in space, as a complex number; the blades are on the other side
        turned = speed.angle(t)
        beta = np.radians(50.0) + 0.7 * turned - 6.0 * np.pi * t + (turned if turning == "casing" else 0.0)
        return (1.0 if on == "casing" else -1.0) * 2e-3 * np.exp(1j * beta)

    def load(t):
        e = 5e-5
        felt = -(origin(t + e) - 2.0 * origin(t) + origin(t - e)) / e**2
        turned = speed.angle(t)
        axes = (turned if turning == "casing" else 0.0) if on == "casing" else (0.0 if turning == "casing" else -turned)
        felt = felt * np.exp(-1j * axes)
        if on == "casing":
            return body.participation[:2].T @ [felt.real, felt.imag]
        felt = felt * np.exp(-1j * np.radians(35.0 - 20.0))  # span is there, flap a right angle on
        return body.participation[:2].T @ [felt.real, felt.imag]

    exact = answer(body, load, result.state_time)
    name = "casing" if on == "casing" else "blade"
    assert np.abs(result.state_of(name) - exact).max() <= 2e-3 * np.abs(exact).max()
    assert np.abs(result.state_of(other)).max() == 0.0


@pytest.mark.slow
def test_energy_of_gravity_has_its_own_entry_and_the_ledger_closes_with_contact():
    """In a rub too; a settled undamped body that nothing touches gets as much as it stores, half of it at rest."""
    pressed = rub(
        [
            ct.gaps.BodyForce.gravity(turning="casing"),
            ct.gaps.BodyForce.of_whirl(ct.gaps.Whirl(amplitude=1e-4, hz=30.0), "blades", turning="casing"),
        ],
        clearance=-2e-5, whirl=[ct.gaps.Whirl(amplitude=1e-4, hz=30.0)],
    )  # fmt: skip
    energy = ct.run(pressed, law=ct.Coulomb(mu=0.1), t_end=0.1, dt=2e-5).energy
    assert energy.body_force != 0.0
    assert energy.external == 0.0
    assert energy.contact != 0.0
    assert abs(energy.unaccounted) <= 1e-11 * energy.scale
    still = rub([ct.gaps.BodyForce.gravity(turning="blades")], hz=0.0, zeta=0.0)
    energy = ct.run(still, t_end=0.01, dt=2e-5).energy
    assert energy.body_force == pytest.approx(energy.end.total - energy.start.total, rel=1e-3)
    assert "gravity and whirl" in repr(ran(pressed, 0.01))


def test_forces_that_make_no_sense_are_refused():
    with pytest.raises(ct.InputError, match="found 'rotor', expected one of casing, blades, both"):
        ct.gaps.BodyForce(on="rotor")
    with pytest.raises(ct.InputError, match="turning: found 'rim', expected casing or blades"):
        ct.gaps.BodyForce.gravity(turning="rim")
    with pytest.raises(ct.InputError, match="on: found 'both', expected casing or blades, the side that whirls"):
        ct.gaps.BodyForce.of_whirl(ct.gaps.Whirl(amplitude=1e-3), "both")
    bare = ct.ModalBody(omega=[1.0], zeta=[0.0], channels=("span", "flap"), rows=[[0.1], [1.0]], S=np.zeros((2, 2)))
    with pytest.raises(ct.InputError, match="blade: found a basis without participation"):
        ct.Rub(casing(), [bare], forces=[ct.gaps.BodyForce.gravity()])
    ct.Rub(casing(), [bare], forces=[ct.gaps.BodyForce(on="casing", acceleration=1.0)])
    apart = [ct.ContactPoint(angle_deg=0.0), ct.ContactPoint(angle_deg=90.0)]
    with pytest.raises(ct.InputError, match="tips of blade 1 over 90 degrees"):
        ct.run(
            ct.Rub(casing(), [blade()], apart, clearance=0.01, forces=[ct.gaps.BodyForce.gravity()]), t_end=0.1, dt=1e-4
        )
    idle = ct.Rub(casing(), [blade(), blade()], [ct.ContactPoint()], forces=[ct.gaps.BodyForce.gravity()])
    with pytest.raises(
        ct.InputError, match="forces: found no tip of blade 2, expected at least one to give the blade's angle"
    ):
        ct.gaps.settled(idle)
    pulled = ct.Rub(
        casing(), [blade()], apart, clearance=0.01, forces=[ct.gaps.BodyForce(on="casing", acceleration=1.0)]
    )
    ct.gaps.settled(pulled)  # a blade that no force pulls may have its tips anywhere
    with pytest.raises(ct.InputError, match=r"participation: found shape \(2, 2\), expected \(3, 2\)"):
        ct.ModalBody(
            omega=[1.0, 2.0], zeta=[0.0] * 2, channels=("span",), rows=[[0.1, 0.1]], S=[[0.0]],
            participation=[[1.0, 0.0], [0.0, 1.0]],
        )  # fmt: skip
    floating = ct.ModalBody(
        omega=[0.0], zeta=[0.0], channels=("span", "flap"), rows=[[0.1], [1.0]], S=1e-8 * np.eye(2),
        participation=[[1.0], [0.0], [0.0]],
    )  # fmt: skip
    with pytest.raises(ct.InputError, match="blade: found rigid modes"):
        ct.gaps.settled(ct.Rub(casing(), [floating], forces=[ct.gaps.BodyForce.gravity()]))


@pytest.mark.parametrize("angles", [(359.0, 3.0), (3.0, 359.0), (357.0, 0.0, 6.0)])
def test_gravity_pulls_a_blade_of_several_tips_at_their_mean_angle(angles):
    """Across 360 degrees too: the tips are at 1 degree in the mean."""

    def sag(places):
        tips = [ct.ContactPoint(angle_deg=angle, lean_deg=20.0) for angle in places]
        scene = ct.Rub(casing(), [blade()], tips, clearance=0.03, forces=[ct.gaps.BodyForce.gravity()])
        return ct.gaps.settled(scene).blade_starts[0].displacement

    np.testing.assert_allclose(sag(angles), sag((1.0,)), rtol=1e-12)
    assert np.abs(sag((1.0,)) / sag((2.0,)) - 1.0).min() > 1e-3


@pytest.mark.parametrize(
    ("term", "words"),
    [
        ({"p": -1, "cos": 1e-5}, "found p = -1, expected a whole number >= 0"),
        ({"p": 2.5, "cos": 1e-5}, "found p = 2.5, expected a whole number >= 0"),
        ({"p": 2, "tan": 1e-5}, r"found keys \['p', 'tan'\], expected p and cos and/or sin"),
        ({"cos": 1e-5}, r"found keys \['cos'\], expected p and cos and/or sin"),
        ({"p": 2, "sin": float("nan")}, "out_of_roundness.sin: found nan"),
    ],
)
def test_terms_of_a_profile_are_whole_waves_with_finite_parts(term, words):
    with pytest.raises(ct.InputError, match=words):
        ct.gaps.RimProfile.fourier([term])
