"""The rotating rim against one blade, on made-up bases: against dense references and closed forms."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contact as ct
from tests.contact.synthetic_rim import N_MAX, SIZE, blade, dense_rows, flap_blade, harmonics, ring

ROUND = [{"p": 2, "cos": 2e-5}, {"p": 3, "sin": 1e-5}]

pytestmark = pytest.mark.slow  # they compile loops for seconds


def rim(*, imperfect=0.0, S=1e-8, zeta=0.002, clearance=-1e-5, speed_hz=5.0, lean_deg=25.0, waves=ROUND, **more):
    return ct.RotatingRim(
        ring(S=S, zeta=zeta, imperfect=imperfect), blade(zeta=zeta), clearance=clearance, speed_hz=speed_hz,
        lean_deg=lean_deg, out_of_roundness=waves, **more,
    )  # fmt: skip


def law(mu):
    return ct.Coulomb(mu=mu) if mu else ct.Unilateral()


def modes_of(scene):
    """Frequencies [rad/s] and damping ratios of casing and blade."""
    return (np.concatenate([getattr(b, name) for b in (scene.casing, scene.blade)]) for name in ("omega", "zeta"))


def rigid_gap(phi):
    """Gap of the bodies at rest with 10 um of interference and the waves ROUND."""
    return -1e-5 + 2e-5 * np.cos(2.0 * phi) + 1e-5 * np.sin(3.0 * phi)


@pytest.mark.parametrize("imperfect", [0.0, 0.05])
@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_against_an_integration_at_tiny_steps(imperfect, mu):
    """S > 0 makes the law a spring: lam = <-g_e>/S(phi); order two in the step, impulse to 1e-3."""
    scene = rim(imperfect=imperfect, S=4e-7)
    omega, zeta = modes_of(scene)
    m, t_end = omega.size, 0.02

    def rate(t, y):
        phi = -scene.speed * t
        Q, T, S_nn, S_nt = dense_rows(scene, phi)
        elastic = rigid_gap(phi) + Q @ y[:m]
        force = max(-elastic, 0.0) / (S_nn - mu * S_nt)
        acceleration = (Q - mu * T) * force - 2 * zeta * omega * y[m:-1] - omega**2 * y[:m]
        return np.concatenate([y[m:-1], acceleration, [force]])

    reference = solve_ivp(rate, (0.0, t_end), np.zeros(2 * m + 1), rtol=1e-8, atol=1e-14, max_step=2e-5)
    errors = []
    for dt in (2e-5, 1e-5):
        result = ct.run(scene, law=law(mu), t_end=t_end, dt=dt, record=ct.Record(state_every=1))
        last = round(t_end / dt) - 1
        state = np.array([np.interp(result.state_time[last], reference.t, row) for row in reference.y[:m]])
        errors.append(np.abs(result.state[last, :m] - state).max() / np.abs(state).max())
        assert result.impulse[0] == pytest.approx(reference.y[-1, -1], rel=2e-3)
        assert "averaged" in result.scheme
    assert errors[1] <= 2e-3


@pytest.mark.parametrize("mu", [0.0, 0.2])
@pytest.mark.parametrize("imperfect", [0.0, 0.05])
def test_energy_closes_with_rotation(imperfect, mu):
    results = [ct.run(rim(imperfect=imperfect), law=law(mu), t_end=0.2, dt=dt) for dt in (1e-5, 5e-6)]
    for result in results:
        energy = result.energy
        assert abs(energy.unaccounted) <= 1e-11 * energy.scale
        assert abs(energy.rotation) > 100.0 * abs(energy.lost_in_contact)
        assert abs(energy.lost_in_contact) <= 1e-3 * abs(energy.rotation)
        assert (energy.friction != 0.0) == (mu > 0.0)
        assert energy.damping < 0.0
        assert result.residual[0] <= 1e-18
        assert len(result.intervals[0]) > 3


@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_intervals_keep_all_forces_and_end_within_a_step_of_them(mu):
    result = ct.run(rim(), law=law(mu), t_end=0.1, dt=1e-5)
    pressed, h = np.flatnonzero(result.force[:, 0] > 0.0), result.dt
    runs = np.split(result.time[pressed], np.flatnonzero(np.diff(pressed) > 1) + 1)
    assert len(result.intervals[0]) == len(runs) > 3
    for (closes, opens), times in zip(result.intervals[0], runs, strict=True):
        assert times[0] - h <= closes <= times[0]
        assert times[-1] <= opens <= times[-1] + h


def test_static_push_at_standstill():
    """Omega = 0, heavy damping: force = -g_0/(sum Q^2/omega^2 + S)."""
    scene = rim(imperfect=0.05, zeta=0.9, speed_hz=0.0, angle_deg=33.0, waves=[])
    phi = np.radians(33.0)
    omega, _ = modes_of(scene)
    Q, _, S_nn, _ = dense_rows(scene, phi)
    result = ct.run(scene, t_end=0.4, dt=2e-5)
    compliance = np.sum(Q**2 / omega**2) + S_nn
    assert result.force[-1, 0] == pytest.approx(1e-5 / compliance, rel=1e-10)


def test_rotating_the_whole_scene_changes_nothing():
    """A perfect casing cannot know where its angles start."""
    start = ct.run(rim(waves=[]), law=ct.Coulomb(mu=0.2), t_end=0.1, dt=1e-5)
    other = ct.run(rim(waves=[], angle_deg=77.0), law=ct.Coulomb(mu=0.2), t_end=0.1, dt=1e-5)
    assert other.impulse[0] == pytest.approx(start.impulse[0], rel=1e-9)
    assert np.allclose(other.force, start.force, rtol=0.0, atol=1e-6 * start.force.max())


def test_without_contact_the_motion_is_free_and_exact():
    scene = rim(clearance=0.04, zeta=0.01, casing_velocity=np.linspace(0.1, 1.0, 10), blade_velocity=[0.3, -0.2])
    result = ct.run(scene, law=ct.Coulomb(mu=0.3), t_end=0.05, dt=5e-5, record=ct.Record(state_every=1))
    omega = np.concatenate([scene.casing.omega, scene.blade.omega])
    v = np.concatenate([scene.casing_velocity, scene.blade_velocity])
    damped = omega * np.sqrt(1.0 - 0.01**2)
    t = result.state_time[:, None]
    exact = v / damped * np.exp(-0.01 * omega * t) * np.sin(damped * t)
    assert np.abs(result.state[:, : omega.size] - exact).max() <= 1e-11 * np.abs(exact).max()
    assert result.impulse[0] == 0.0
    assert result.intervals == ((),)


def test_friction_drags_the_blade_along():
    """The casing turns along +theta, so friction pushes a radial blade's flap that way (positive)."""
    scene = ct.RotatingRim(ring(), flap_blade(), clearance=-1e-5, speed_hz=5.0)
    result = ct.run(scene, law=ct.Coulomb(mu=0.3), t_end=0.01, dt=1e-5, record=ct.Record(state_every=1))
    back = ct.RotatingRim(ring(), flap_blade(), clearance=-1e-5, speed_hz=-5.0)
    other = ct.run(back, law=ct.Coulomb(mu=0.3), t_end=0.01, dt=1e-5, record=ct.Record(state_every=1))
    assert result.state_of("blade")[:, -1].mean() > 0.0 > other.state_of("blade")[:, -1].mean()
    assert result.reversals[0] == 0


def test_a_jamming_blade_is_refused():
    stiff = ct.RotatingRim(ring(S=0.0), flap_blade(S=0.0), clearance=-1e-5, speed_hz=5.0, lean_deg=45.0)
    with pytest.raises(ct.LimitError, match=r"H_d \+ S = -.* mu = 20, expected > 0: the blade jams"):
        ct.run(stiff, law=ct.Coulomb(mu=20.0), t_end=0.01, dt=1e-5)


def test_rim_limits():
    for speed in (200.0, -200.0):
        with pytest.raises(ct.LimitError, match=r"n_max Omega dt = 0.377 rad with n_max = 6"):
            ct.run(rim(speed_hz=speed), t_end=0.1, dt=5e-5)
    with pytest.raises(ct.InputError, match="kind 'point', expected 'rim'"):
        ct.RotatingRim(blade(), blade(), clearance=0.0, speed_hz=1.0)
    with pytest.raises(ct.InputError, match="blade: found a basis of kind 'rim', expected 'point'"):
        ct.RotatingRim(ring(), ring(), clearance=0.0, speed_hz=1.0)
    other = ct.ModalBody(omega=[9.0], zeta=[0.0], channels=("6.x", "6.y"), rows=[[1.0], [1.0]], S=np.eye(2))
    with pytest.raises(ct.InputError, match=r"blade: found the channels 6.x, 6.y, expected span and flap"):
        ct.RotatingRim(ring(), other, clearance=0.0, speed_hz=1.0)
    with pytest.raises(ct.InputError, match="'energy' on a rotating rim"):
        ct.run(rim(), t_end=0.1, dt=1e-5, scheme=ct.ExactModal(law="energy"))
    with pytest.raises(ct.InputError, match="out_of_roundness"):
        rim(waves=[{"p": 2, "cosine": 1.0}])


def test_without_residual_compliance_the_forward_law_runs():
    """Craig-Bampton bases have S = 0."""
    scene = ct.RotatingRim(ring(S=0.0), blade(S=0.0), clearance=-1e-5, speed_hz=5.0, lean_deg=25.0)
    result = ct.run(scene, t_end=0.05, dt=1e-5)
    assert "forward law" in result.scheme
    assert result.max_penetration[0] <= 1e-17
    assert abs(result.energy.unaccounted) <= 1e-11 * result.energy.scale


@pytest.mark.parametrize("mu", [0.0, 0.4])
def test_the_stored_gap_is_the_gap_of_the_bodies(mu):
    """Forward law, S = 0: clearance + Q q one step later, from the definition, is the gap stored."""
    scene = ct.RotatingRim(
        ring(S=0.0, imperfect=0.05),
        blade(S=0.0),
        clearance=-1e-5,
        speed_hz=5.0,
        lean_deg=25.0,
        out_of_roundness=ROUND,
    )
    result = ct.run(scene, law=law(mu), t_end=0.02, dt=1e-5, record=ct.Record(state_every=1))
    for n in range(1, result.steps):
        phi = -scene.speed * n * result.dt
        gap = rigid_gap(phi) + dense_rows(scene, phi)[0] @ result.state[n, :12]
        assert gap == pytest.approx(result.gap[n - 1, 0], abs=1e-17)
    assert result.contact_steps[0] > 100


@pytest.mark.parametrize(("speed_hz", "velocity"), [(5.0, 0.0), (-5.0, 0.0), (0.1, 1.0)])
def test_energies_and_reversals_are_those_of_the_recorded_motion(speed_hz, velocity):
    """Works by the trapezoidal rule along the motion, energies from its differences, signs included; S = 0."""
    scene = ct.RotatingRim(
        ring(S=0.0, imperfect=0.05, zeta=0.01), blade(S=0.0, zeta=0.01), clearance=-1e-5, speed_hz=speed_hz,
        lean_deg=25.0, out_of_roundness=ROUND, blade_velocity=[velocity, 0.0],
    )  # fmt: skip
    mu, h, steps = 0.2, 1e-5, 2000
    energy = ct.run(scene, law=law(mu), t_end=steps * h, dt=h).energy
    longer = ct.run(scene, law=law(mu), t_end=(steps + 2) * h, dt=h, record=ct.Record(state_every=1))
    (omega, zeta), force = modes_of(scene), longer.force[:steps, 0]
    q, lam = longer.state, longer.tip_force
    phi = -scene.speed * h * np.arange(steps + 1)
    Q, T = (np.array(rows) for rows in zip(*(dense_rows(scene, x)[:2] for x in phi), strict=True))
    gap = rigid_gap(phi) + np.sum(Q * q[: steps + 1], axis=1)
    before = np.vstack([2.0 * q[0] - q[1], q[:steps]])[:-1]  # at t = -h, and so on; no force at t = 0 moved it
    mean = 0.5 * (q[1 : steps + 1] - before)
    drag = lam[:steps, -1]
    slides = np.abs(drag) > mu * force * (1.0 - 1e-9)
    slip = scene.casing.radius * scene.speed * h + np.sum(T[:-1] * (q[1 : steps + 1] - q[:steps]), axis=1)
    assert np.all(slip[slides] * drag[slides] <= 0.0)
    assert np.abs(slip[~slides & (force > 0.0)]).max(initial=0.0) <= 1e-9 * np.abs(slip).max()
    contact = np.sum(0.5 * force[1:] * (gap[2:] - gap[:-2])) + 0.5 * force[0] * (gap[1] - gap[0])
    assert energy.contact == pytest.approx(contact, rel=1e-9)
    friction = np.sum(drag * np.sum(T[:-1] * mean, axis=1))
    assert energy.friction == pytest.approx(friction, rel=1e-9)
    rotation = np.sum(force * np.sum(Q[:-1] * mean, axis=1)) - contact
    assert energy.rotation == pytest.approx(rotation, rel=1e-9)
    rates = mean / h
    assert energy.damping == pytest.approx(-np.sum(2.0 * zeta * omega * rates**2) * h, rel=2e-2)
    reversed_ = np.count_nonzero((force > 0.0) & slides & (drag * scene.speed > 0.0))
    assert longer.reversals[0] >= reversed_ >= longer.reversals[0] - 2  # two steps more
    assert (reversed_ > 100) == (speed_hz == 0.1)
    v = (q[steps + 1] - q[steps - 1]) / (2.0 * h)
    assert energy.end.kinetic == pytest.approx(0.5 * v @ v, rel=1e-3)
    assert energy.end.strain == pytest.approx(0.5 * np.sum((omega * q[steps, : omega.size]) ** 2), rel=1e-9)


@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_recovered_surfaces_touch_where_the_contact_is_closed(mu):
    """clearance + u_r(phi) - n.u_tip = 0 with the residual term."""
    scene = rim(imperfect=0.05, S=4e-7)
    record = ct.Record(every=2, state_every=4)
    result = ct.run(scene, law=law(mu), t_end=0.05, dt=5e-6, record=record)
    (_, casing_force), (_, blade_force) = (ct.recovery.rub_forces(scene, result, name) for name in ("casing", "blade"))
    casing = ct.recovery.at_channels(scene.casing, result.state_of("casing"), casing_force)
    tip = ct.recovery.at_channels(scene.blade, result.state_of("blade"), blade_force)
    a, gap = np.radians(scene.lean_deg), []
    for t, u, (span, flap) in zip(result.state_time, casing, tip, strict=True):
        phi = -scene.speed * t
        radial = harmonics(N_MAX, phi) @ u[:SIZE]
        gap.append(rigid_gap(phi) + radial - np.cos(a) * span - np.sin(a) * flap)
    assert result.state.shape[1] == scene.casing.omega.size + scene.blade.omega.size
    closed = result.tip_force[:, 0] > 0.2 * result.force.max()
    assert closed.sum() > 100
    assert np.abs(np.array(gap)[closed]).max() <= 1e-3 * np.abs(tip).max()
    with pytest.raises(ct.InputError, match="recovery: found none"):
        ct.recovery.at_points(scene.blade, result.state_of("blade"), blade_force)
    with pytest.raises(ct.InputError, match=r"expected one of casing, blade \("):
        result.state_of("ring")
    bare = ct.run(scene, law=law(mu), t_end=1e-4, dt=5e-6, record=ct.Record(every=2))
    with pytest.raises(
        ct.InputError, match="state: found none in the result, expected a record with state_every or at"
    ):
        ct.recovery.rub_forces(scene, bare, "blade")
