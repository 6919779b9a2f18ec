"""Several tips before one turning rim: against the one-contact run, closed forms and the laws themselves."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, harmonics, ring
from tests.contact.synthetic_rub import N_MAX, SIZE, nodes, rim3, tips

WAVES = [{"p": 2, "cos": 2e-5}, {"p": 3, "sin": 1e-5}]


def law(mu):
    return ct.Coulomb(mu=mu) if mu else ct.Unilateral()


def one_tip(*, S=1e-8, imperfect=0.0, speed_hz=5.0, clearance=-1e-5):
    """The same scene twice: as a RotatingRim and as a Rub with one tip."""
    bodies = ring(S=S, imperfect=imperfect), blade(S=2.0 * S)
    rim = ct.RotatingRim(
        *bodies, clearance=clearance, speed_hz=speed_hz, lean_deg=25.0, out_of_roundness=WAVES, angle_deg=13.0
    )
    rub = ct.Rub(
        bodies[0], bodies[1:], [ct.ContactPoint(lean_deg=25.0, angle_deg=13.0)], clearance=clearance,
        speed=ct.Speed.constant(speed_hz), profile=ct.gaps.RimProfile.fourier(WAVES),
    )  # fmt: skip
    return rim, rub


@pytest.mark.slow
@pytest.mark.parametrize("S", [0.0, 1e-8])
@pytest.mark.parametrize("imperfect", [0.0, 0.05])
@pytest.mark.parametrize(("mu", "speed_hz"), [(0.0, 5.0), (0.2, 5.0), (0.4, -0.05)])
def test_one_tip_is_the_rotating_rim(S, imperfect, mu, speed_hz):
    """Fast, the tip slides all the time; slowly, it sticks and slips."""
    record = ct.Record(state_every=1)
    rim, rub = (
        ct.run(scene, law=law(mu), t_end=0.05, dt=1e-5, record=record)
        for scene in one_tip(S=S, imperfect=imperfect, speed_hz=speed_hz, clearance=-1e-5 if speed_hz > 0.0 else -1e-4)
    )
    assert ("averaged" in rim.scheme) == ("averaged" in rub.scheme) == (S > 0.0)
    assert np.abs(rub.force - rim.force).max() <= 1e-9 * rim.force.max()
    assert rub.blocks == rim.blocks
    assert np.abs(rub.tip_force - rim.tip_force).max() <= 1e-9 * rim.force.max()
    for name in ("casing", "blade"):
        assert np.abs(rub.state_of(name) - rim.state_of(name)).max() <= 1e-9 * np.abs(rim.state_of(name)).max()
    assert np.abs(rub.gap - rim.gap).max() <= 1e-9 * np.abs(rim.gap).max()
    assert len(rub.intervals[0]) == len(rim.intervals[0])
    assert [len(times) for times in rub.sticking] == [len(times) for times in rim.sticking]
    assert bool(rim.sticking) == (speed_hz == -0.05)
    for name in ("contact", "friction", "rotation", "damping"):
        value = getattr(rim.energy, name)
        assert getattr(rub.energy, name) == pytest.approx(value, rel=1e-7, abs=1e-10 * rim.energy.scale), name
    for name in ("impulse", "peak_force", "contact_steps"):
        assert getattr(rub, name) == pytest.approx(getattr(rim, name), rel=1e-9)
    if mu > 0.0:
        assert rub.notes.heat == pytest.approx(rim.notes.heat, rel=1e-7)
        assert rub.notes.drive == pytest.approx(rim.notes.drive, rel=1e-7)
    assert abs(rub.energy.unaccounted) <= 1e-11 * rub.energy.scale
    assert abs(rim.energy.unaccounted) <= 1e-11 * rim.energy.scale


def rows_at(rub, t, dim):
    """Rows and compliances of all tips in `dim` directions, from their definitions."""
    first = np.cumsum([0, *(b.omega.size for b in rub.bodies)])
    rows, at_rim, at_blades = [], [], []
    for tip in rub.tips:
        wave = harmonics(rub.casing.n_max, np.radians(tip.angle_deg) - rub.speed.angle(t))
        weights, blade = tip.directions(rub.blades[tip.blade]), rub.blades[tip.blade]
        for i in range(dim):
            row, on_rim = np.zeros(first[-1]), np.zeros(len(rub.casing.channels))
            begin = (tip.line * rub.casing.directions + i) * wave.size
            on_rim[begin : begin + wave.size] = wave
            row[: first[1]] = on_rim @ rub.casing.rows
            row[first[tip.blade + 1] : first[tip.blade + 2]] = -weights[i] @ blade.rows
            rows.append(row)
            at_rim.append(on_rim)
            at_blades.append((tip.blade, weights[i]))
    S = np.array(at_rim) @ rub.casing.S @ np.array(at_rim).T
    for a, (blade, left) in enumerate(at_blades):
        for b, (other, right) in enumerate(at_blades):
            if blade == other:
                S[a, b] += left @ rub.blades[blade].S @ right
    return np.array(rows), S


def rigid_gaps(rub, t):
    """Gaps of all tips before bodies at rest."""
    phi = [np.radians(tip.angle_deg) - rub.speed.angle(t) for tip in rub.tips]
    rigid = [rub.clearance + tip.clearance + rub.profile(p) for tip, p in zip(rub.tips, phi, strict=True)]
    return np.array(rigid) - rub.closing.at(t)


@pytest.mark.slow
@pytest.mark.parametrize("speed_hz", [5.0, -0.05])
def test_the_only_one_of_many_tips_that_rubs_moves_as_it_does_alone(speed_hz):
    """Fast, the tip slides; slowly, it also sticks. Seventeen tips are solved by waves, one by a table."""
    bodies, mu, h, steps = (ring(imperfect=0.05), blade()), 0.4, 2e-5, 500
    first = ct.ContactPoint(lean_deg=25.0, angle_deg=13.0)
    far = [replace(first, angle_deg=20.0 * k, clearance=1e-3) for k in range(1, 17)]
    alone, many = (
        ct.run(
            ct.Rub(
                bodies[0], bodies[1:], points, clearance=-1e-4, speed=ct.Speed.constant(speed_hz),
                profile=ct.gaps.RimProfile.fourier(WAVES),
            ),
            law=law(mu), scheme=ct.ExactModal(law="averaged"), t_end=steps * h, dt=h, record=ct.Record(state_every=1),
        )
        for points in ([first], [first, *far])
    )  # fmt: skip
    np.testing.assert_allclose(many.tip_force[:, :2], alone.tip_force, rtol=0.0, atol=1e-9 * alone.force.max())
    assert not many.tip_force[:, 2:].any()
    assert 50 < many.contact_steps[0] < steps
    assert bool(many.sticking) == (speed_hz == -0.05)


@pytest.mark.slow
def test_a_tip_sticks_until_the_cone_is_full_and_then_slides():
    """Drag R Omega t of a blade of tangential stiffness k pressed on with N: force k R Omega t up to mu N."""
    flap, span, delta, mu, R = 2.0 * np.pi * 400.0, 2.0 * np.pi * 3000.0, 2e-6, 0.2, 0.45
    S = 1e-9
    tooth = ct.ModalBody(
        omega=[span, flap], zeta=[0.7, 0.7], channels=("span", "flap"), rows=[[1.0, 0.0], [0.0, 2.0]],
        S=[[S, 0.0], [0.0, S]],
    )  # fmt: skip
    casing = ring(S=0.0)
    casing = ct.ModalBody(
        omega=[1e4], zeta=[0.5], channels=casing.channels, rows=np.zeros((len(casing.channels), 1)), S=casing.S,
        kind="rim", n_max=casing.n_max, radius=R,
    )  # fmt: skip
    N = delta / (1.0 / span**2 + S)
    rub = ct.Rub(
        casing, [tooth], clearance=-delta, speed=ct.Speed.constant(2e-5),
        blade_starts=[ct.gaps.Start(displacement=[-N / span**2, 0.0])],
    )  # fmt: skip
    drag = R * rub.speed.omega(0.0)
    slips = mu * N * (4.0 / flap**2 + S) / drag  # compliance of the flap mode and S: when the cone is full
    h = 2e-5
    result = ct.run(rub, law=ct.Coulomb(mu=mu), t_end=2.0 * slips, dt=h, record=ct.Record(state_every=1))
    force = result.tip_force
    assert force[len(force) // 20 :, 0] == pytest.approx(N, rel=1e-6)
    until = force[: int(0.9 * slips / h), 1]
    t = result.state_time[: until.size]
    late = t > 0.2 * slips
    slope = np.polyfit(t[late], until[late], 1)
    assert -slope[0] == pytest.approx(drag / (4.0 / flap**2 + S), rel=1e-4)
    assert force[-1, 1] == pytest.approx(-mu * N, rel=1e-6)
    (start, end) = result.sticking[0][0]
    assert start <= 2.0 * h
    assert end == pytest.approx(slips, rel=2e-2)
    assert result.notes.heat[0] == pytest.approx(mu * N * drag * (2.0 * slips - end), rel=2e-2)


@pytest.mark.slow
@pytest.mark.parametrize(
    "closes",
    [
        {"clearance": -1e-6},
        {"closing": ct.gaps.Closing([0.0, 0.02], [0.0, 1.01e-4])},
        {"whirl": [ct.gaps.Whirl(amplitude=1.01e-4, per_rev=-1.0, phase_deg=190.0)]},
        {"profile": ct.gaps.RimProfile.fourier([{"p": 3, "cos": -1.01e-4}])},
        {"profile": ct.gaps.RimProfile(theta=[0.0, 2.0, 4.0], depth=[1e-4, -1.01e-4, 1e-4])},
        {"casing_start": ct.gaps.Start(displacement=2.3e-3 * np.eye(10)[2])},
        {"blade_starts": [ct.gaps.Start(displacement=1.2e-4 * np.eye(3)[0])]},
    ],
    ids=lambda closes: next(iter(closes)),
)
def test_a_tip_that_barely_touches_does_so_whether_its_gap_is_stored_or_not(closes):
    """Gaps between stored steps are computed only where bounds let a tip touch: of each part that can close it."""
    casing = replace(rim3(), rows=0.02 * rim3().rows)
    given = {"clearance": 1e-4, "speed": ct.Speed.constant(50.0), **closes}
    rub = ct.Rub(casing, [nodes(1)], tips(1, angle=10.0), **given)
    every, few = (
        ct.run(rub, law=law(0.2), t_end=0.02, dt=1e-5, record=record) for record in (ct.Record(), ct.Record(every=500))
    )
    assert 0 < every.contact_steps[0] < 1000
    assert few.contact_steps[0] == every.contact_steps[0]
    assert few.impulse == pytest.approx(every.impulse, rel=1e-9)
    for name in ("contact", "rotation", "friction", "damping"):
        found, exact = (getattr(one.energy, name) for one in (few, every))
        assert found == pytest.approx(exact, abs=1e-9 * every.energy.scale)


@pytest.mark.slow
def test_a_whirl_of_some_hertz_is_one_of_as_many_a_turn():
    """From the first step on, in which the averaged law takes the gap of a step before the start."""
    forces, turning = [], ct.Speed.constant(40.0)
    for given in ({"per_rev": 3.0}, {"hz": 120.0}):
        whirl = ct.gaps.Whirl(amplitude=1e-4, phase_deg=70.0, **given)
        rub = ct.Rub(rim3(), [nodes(2)], tips(2), clearance=-5e-5, speed=turning, whirl=[whirl])
        forces.append(ct.run(rub, law=law(0.2), scheme=ct.ExactModal(law="averaged"), t_end=2e-3, dt=1e-5).force)
    assert forces[0][0].max() > 0.0
    np.testing.assert_allclose(forces[1], forces[0], atol=1e-9 * forces[0].max())


@pytest.mark.slow
@pytest.mark.parametrize("speed_hz", [5.0, -5.0])
def test_works_heat_and_drive_are_those_of_the_recorded_motion(speed_hz):
    """Each entry of the ledger and every tip's heat and drive, signed, from rows by their definitions; S = 0."""
    rub = ct.Rub(
        rim3(S=0.0), [nodes(2, S=0.0)], tips(2), clearance=5e-5, closing=ct.gaps.Closing([0.0, 0.01], [0.0, 4e-4]),
        speed=ct.Speed.constant(speed_hz), profile=ct.gaps.RimProfile.fourier(WAVES),
    )  # fmt: skip
    mu, h, steps = 0.2, 2e-5, 400
    result = ct.run(rub, law=law(mu), t_end=steps * h, dt=h)
    longer = ct.run(rub, law=law(mu), t_end=(steps + 2) * h, dt=h, record=ct.Record(state_every=1))
    q, forces = longer.state, longer.tip_force[:steps]
    contact, normal, friction, damping, heat, drive = 0.0, 0.0, 0.0, 0.0, np.zeros(2), np.zeros(2)
    omega, zeta = (np.concatenate([getattr(b, name) for b in rub.bodies]) for name in ("omega", "zeta"))
    slid = rub.casing.radius * rub.speed.omega(0.0) * h
    rows = [rows_at(rub, n * h, 3)[0] for n in range(steps + 1)]
    gap = [rigid_gaps(rub, n * h) + rows[n][::3] @ q[n] for n in range(steps + 1)]
    for n in range(1, steps):
        work = forces[n] * (rows[n] @ (0.5 * (q[n + 1] - q[n - 1])))
        contact += 0.5 * forces[n, ::3] @ (gap[n + 1] - gap[n - 1])
        normal, friction = normal + work[::3].sum(), friction + work[1::3].sum() + work[2::3].sum()
        damping -= np.sum(2.0 * zeta * omega * (0.5 * (q[n + 1] - q[n - 1])) ** 2) / h
        slip = (rows[n] @ (q[n + 1] - q[n])).reshape(2, 3)
        slip[:, 1] += slid
        pull = forces[n].reshape(2, 3)
        heat -= np.sum(pull[:, 1:] * slip[:, 1:], axis=1)
        drive -= pull[:, 1] * slid
    energy, notes = result.energy, result.notes
    assert energy.contact == pytest.approx(contact, rel=1e-9)
    assert energy.rotation == pytest.approx(normal - contact, rel=1e-9)
    assert energy.friction == pytest.approx(friction, rel=1e-9)
    assert energy.damping == pytest.approx(damping, rel=2e-2)
    assert notes.heat == pytest.approx(heat, rel=1e-9)
    assert notes.drive == pytest.approx(drive, rel=1e-9)
    assert min(heat) > 0.0
    assert min(drive) > 0.0
    assert np.array_equal(result.peak_force, result.force.max(axis=0))
    assert np.array_equal(result.contact_steps, np.count_nonzero(result.force > 0.0, axis=0))
    assert result.impulse == pytest.approx(result.force.sum(axis=0) * h, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_the_energy_identity_of_the_moving_contact_closes_with_the_step(mu):
    """With S > 0 no impact loses energy: what remains of the gap's work falls with the step."""
    left, slip = [], []
    for dt in (2e-5, 1e-5):
        rub = ct.Rub(
            rim3(S=2e-7), [nodes(3, S=1e-7)], tips(3), clearance=-2e-5, speed=ct.Speed.constant(5.0),
            profile=ct.gaps.RimProfile.fourier(WAVES),
        )  # fmt: skip
        result = ct.run(rub, law=law(mu), scheme=ct.ExactModal(law="forward"), t_end=0.1, dt=dt)
        energy = result.energy
        assert abs(energy.unaccounted) <= 1e-11 * energy.scale
        left.append(energy.lost_in_contact / abs(energy.rotation))
        if mu:
            heat, drive = result.notes.heat.sum(), result.notes.drive.sum()
            assert heat > 0.0
            slip.append(abs(energy.friction - (drive - heat)) / drive)
    assert 0.0 < left[1] <= 0.6 * left[0]
    if mu:
        assert slip[1] <= 0.6 * slip[0]


@pytest.mark.slow
def test_the_rigid_gap_follows_its_laws():
    """No contact: clearance, profile, closing, whirl and a ramp of the speed, from their definitions."""
    theta = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    rub = ct.Rub(
        rim3(), [nodes(3)], tips(3), clearance=3e-3,
        speed=ct.Speed(time=[0.002, 0.01], hz=[1.0, 9.0]), closing=ct.gaps.Closing.exponential(4e-4, 0.01),
        profile=ct.gaps.RimProfile(((3, 1e-4, -5e-5),), theta=theta, depth=1e-4 * np.cos(2.0 * theta)),
        whirl=[ct.gaps.Whirl(amplitude=2e-4, per_rev=-1.0, phase_deg=20.0), ct.gaps.Whirl(amplitude=1e-4, hz=60.0)],
    )  # fmt: skip
    h, table = 1e-5, ct.gaps.RimProfile(theta=theta, depth=1e-4 * np.cos(2.0 * theta))
    result = ct.run(
        rub, scheme=ct.ExactModal(law="forward"), law=ct.Coulomb(mu=0.2), t_end=0.02, dt=h, record=ct.Record(every=20)
    )
    many = rub.speed.angles(result.time + h)
    for n, t in enumerate(result.time + h):
        turned = 2.0 * np.pi * (t + 0.5 * 8.0 / 0.008 * np.clip(t - 0.002, 0.0, 0.008) ** 2 + 8.0 * max(t - 0.01, 0.0))
        assert rub.speed.angle(t) == many[n] == pytest.approx(turned, rel=1e-12)
        for j, tip in enumerate(rub.tips):
            phi = np.radians(tip.angle_deg) - turned
            exact = 3e-3 + tip.clearance + 1e-4 * np.cos(3.0 * phi) - 5e-5 * np.sin(3.0 * phi) + table(phi)
            exact -= 4e-4 * (1.0 - np.exp(-t / 0.01))
            exact += 2e-4 * np.cos(np.radians(tip.angle_deg) - np.radians(20.0)) + 1e-4 * np.cos(
                phi - 120.0 * np.pi * t
            )
            assert result.gap[n, j] == pytest.approx(exact, abs=5e-8)
    assert result.impulse.max() == 0.0


@pytest.mark.slow
def test_a_profile_of_more_waves_than_the_rim_has_is_followed():
    profile = ct.gaps.RimProfile.fourier([{"p": 20, "cos": 1e-4}, {"p": 1, "sin": 3e-5}])
    rub = ct.Rub(rim3(), [nodes(3)], tips(3), clearance=1e-3, speed=ct.Speed.constant(5.0), profile=profile)
    result = ct.run(rub, scheme=ct.ExactModal(law="forward"), t_end=0.01, dt=1e-5, record=ct.Record(every=50))
    phi = np.radians([tip.angle_deg for tip in rub.tips]) - 10.0 * np.pi * (result.time[:, None] + 1e-5)
    own = np.array([tip.clearance for tip in rub.tips])
    exact = 1e-3 + own + 1e-4 * np.cos(20.0 * phi) + 3e-5 * np.sin(phi)
    np.testing.assert_allclose(result.gap, exact, atol=1e-14)


@pytest.mark.slow
def test_a_table_profile_is_smooth_and_stays_between_its_points():
    theta = np.array([0.1, 0.5, 1.4, 3.0, 4.4, 5.9])
    depth = np.array([0.0, 2e-4, 2e-4, -1e-4, 0.0, 1e-4])
    profile = ct.gaps.RimProfile(theta=theta, depth=depth)
    assert [profile(x) for x in theta] == pytest.approx(depth.tolist(), abs=1e-18)
    phi = np.linspace(-7.0, 9.0, 4001)
    values = np.array([profile(x) for x in phi])
    assert values.min() >= depth.min()
    assert values.max() <= depth.max() * (1.0 + 1e-14)
    slope = np.diff(values) / np.diff(phi)
    assert np.abs(np.diff(slope)).max() <= 0.05 * np.abs(slope).max()  # no kink: a polygon's would jump by all of it
    assert profile(0.7 + 2.0 * np.pi) == pytest.approx(profile(0.7), abs=1e-17)


@pytest.mark.slow
@pytest.mark.parametrize("at_hz", [0.0, 60.0])
def test_a_turning_blade_is_stiffer(at_hz):
    """Free modes of diag(omega^2) + (Omega^2 - at^2) stiffness_by_speed, coupled ones too."""
    added = np.array([[1.7, 0.4, 0.0], [0.4, 6.0, 0.2], [0.0, 0.2, 9.0]])
    rub = ct.Rub(
        rim3(), [nodes(1)], tips(1, axial=False), clearance=0.03, speed=ct.Speed.constant(80.0),
        stiffening=[ct.gaps.Stiffening(stiffness_by_speed=added, at_hz=at_hz)],
        blade_starts=[ct.gaps.Start(velocity=[1.0, 0.0, 0.0])],
    )  # fmt: skip
    errors = []
    for h in (1e-5, 5e-6):
        result = ct.run(rub, t_end=0.02, dt=h, record=ct.Record(every=100, state_every=100))
        omega2, V = np.linalg.eigh(np.diag(rub.blades[0].omega ** 2) + 4.0 * np.pi**2 * (80.0**2 - at_hz**2) * added)
        omega, t = np.sqrt(omega2), result.state_time
        exact = (np.sin(np.outer(t, omega)) / omega * V[0]) @ V.T
        undamped = np.abs(result.state_of("blade")[:, 0] - exact[:, 0]).max() / np.abs(exact[:, 0]).max()
        errors.append(undamped)
        assert abs(result.energy.unaccounted) <= 1e-11 * result.energy.scale
        assert result.energy.external != 0.0
    assert max(errors) <= 0.05  # damping of 0.2 % over 14 ms


@pytest.mark.slow
def test_deflection_beyond_linear_theory_is_flagged():
    rub = ct.Rub(rim3(), [nodes(2)], tips(2), clearance=-5e-5, speed=ct.Speed.constant(5.0), thickness=1e-5)
    result = ct.run(rub, law=ct.Coulomb(mu=0.2), t_end=0.01, dt=2e-5, on_limit="flag")
    assert (result.flags[0].code, result.flags[0].failed) == ("wall-deflection", False)
    assert "FLAG: the rim deflected by" in repr(result)
    thick = ct.run(ct.Rub(rim3(), [nodes(2)], tips(2), clearance=-5e-5, thickness=1e-2), t_end=0.01, dt=2e-5)
    assert thick.flags == ()


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_recovered_surfaces_touch(mu):
    """Clearance + profile + u_r(phi) - n.u_tip = 0 at closed tips, with the residual term of every force."""
    rub = ct.Rub(
        rim3(S=2e-7), [nodes(3, S=1e-7)], tips(3), clearance=-2e-5, speed=ct.Speed.constant(5.0),
        profile=ct.gaps.RimProfile.fourier(WAVES),
    )  # fmt: skip
    result = ct.run(rub, law=law(mu), t_end=0.02, dt=5e-6, record=ct.Record(every=4, state_every=4))
    t, on_casing = ct.recovery.rub_forces(rub, result, "casing")
    _, on_blade = ct.recovery.rub_forces(rub, result, "blade")
    casing = ct.recovery.at_channels(rub.casing, result.state_of("casing"), on_casing)
    blade = ct.recovery.at_channels(rub.blades[0], result.state_of("blade"), on_blade)
    d = 3 if mu else 1
    for j, tip in enumerate(rub.tips):
        begin, gaps = tip.line * 3 * SIZE, []
        for n in np.flatnonzero(result.tip_force[:, j * d] > 0.2 * result.peak_force[j]):
            phi = np.radians(tip.angle_deg) - rub.speed.angle(t[n])
            radial = harmonics(N_MAX, phi) @ casing[n, begin : begin + SIZE]
            share = tip.directions(rub.blades[0])[0] @ blade[n]
            gaps.append(rub.clearance + tip.clearance + rub.profile(phi) + radial - share)
        assert len(gaps) > 20
        assert np.abs(gaps).max() <= 5e-3 * np.abs(blade).max()
    with pytest.raises(ct.InputError, match="expected one of casing, blade"):
        ct.recovery.rub_forces(rub, result, "blade 2")


def test_bad_rubs_are_refused():
    def rub(**more):
        return ct.Rub(more.pop("casing", rim3()), more.pop("blades", [nodes(2)]), more.pop("tips", tips(2)), **more)

    for bad, match in (
        ({"tips": [ct.ContactPoint(span="node9.span", flap="node0.flap")]}, r"tips\[0\]: channel: found 'node9.span'"),
        (
            {"tips": [ct.ContactPoint(line=2, span="node0.span", flap="node0.flap")]},
            r"tips\[0\].line: found 2, expected 0 .. 1",
        ),
        ({"tips": [ct.ContactPoint(blade=1)]}, r"tips\[0\].blade: found 1"),
        ({"tips": [ct.ContactPoint(blade=0.5)]}, r"tips\[0\].blade: found 0.5, expected 0 .. 0"),
        ({"tips": [ct.ContactPoint(line=0.5)]}, r"tips\[0\].line: found 0.5, expected 0 .. 1"),
        ({"tips": [*tips(1), *tips(1, axial=False)]}, "axial: found"),
        ({"casing": ring(), "tips": tips(1)}, "without axial channels"),
        ({"clearance": 0.05}, "at most a tenth"),
        (
            {"stiffening": [ct.gaps.Stiffening(stiffness_by_speed=np.eye(2))]},
            r"stiffness_by_speed: found shape \(2, 2\), expected \(3, 3\)",
        ),
        ({"blade_starts": [ct.gaps.Start(velocity=[1.0])]}, r"blade.velocity: found shape \(1,\), expected \(3,\)"),
        ({"thickness": 0.0}, "thickness: found 0.0"),
        ({"casing": nodes(2)}, "casing: found a basis of kind 'point', expected 'rim'"),
        ({"blades": [nodes(2), rim3()]}, r"blades\[1\]: found a basis of kind 'rim', expected 'point'"),
        ({"blade_starts": [ct.gaps.Start()] * 2}, "blade_starts: found 2, expected one for each blade or none"),
        (
            {"blades": [nodes(2)] * 3, "blade_starts": [ct.gaps.Start()] * 2},
            "blade_starts: found 2, expected one for each blade or none",
        ),
        (
            {"stiffening": [ct.gaps.Stiffening(blade=0.5, stiffness_by_speed=np.eye(3))]},
            r"stiffening: found blade 0\.5, expected 0 \.\. 0$",
        ),
        (
            {"stiffening": [ct.gaps.Stiffening(blade=1, stiffness_by_speed=np.eye(3))]},
            r"stiffening: found blade 1, expected 0 \.\. 0$",
        ),
        (
            {"blades": [nodes(2)] * 2, "stiffening": [ct.gaps.Stiffening(blade=-1, stiffness_by_speed=np.eye(3))]},
            r"stiffening: found blade -1, expected 0 \.\. 1$",
        ),
    ):
        with pytest.raises(ct.InputError, match=match):
            rub(**bad)
    every = [ct.gaps.Stiffening(blade=b, stiffness_by_speed=np.eye(3)) for b in (0, 1)]
    taken = rub(blades=[nodes(2)] * 2, blade_starts=[ct.gaps.Start()] * 2, stiffening=every)
    assert [stiff.blade for stiff in taken.stiffening] == [0, 1]
    assert len(rub(blades=[nodes(2)] * 2).blade_starts) == 2
    with pytest.raises(ct.InputError, match=r"found 2 rim lines in 3 directions, expected one .*line"):
        ct.RotatingRim(rim3(), blade(), clearance=0.0, speed_hz=1.0)
    with pytest.raises(ct.InputError, match="found 1 after 2, expected ascending"):
        ct.Speed(time=[0.0, 2.0, 1.0], hz=[1.0, 1.0, 1.0])
    with pytest.raises(ct.InputError, match="expected three or more within less than 2 pi rad"):
        ct.gaps.RimProfile(theta=[0.0, 3.0, 6.3], depth=[0.0, 1.0, 0.0])
    with pytest.raises(ct.LimitError, match=r"n_max Omega dt = 0.3142 rad with n_max = 5"):
        ct.run(rub(speed=ct.Speed([0.0, 1.0], [0.0, 1000.0])), t_end=0.1, dt=1e-5)
    with pytest.raises(ct.LimitError, match="the blade jams"):
        ct.run(rub(speed=ct.Speed.constant(1.0)), law=ct.Coulomb(mu=50.0), t_end=0.1, dt=1e-5)
    with pytest.raises(ct.LimitError, match=r"omega_max dt = 4\.5"):
        ct.run(rub(), t_end=0.1, dt=5e-4)
