"""Coatings at several tips: against one tip's run, the laws by definition, tracks that tips share, what is refused."""

import numpy as np
import pytest

import contact as ct
from contact.model.gaps.rub_system import rub_system
from contact.scheme.modal.wear_track import track_tips
from contact.solver.abradable.tips import Coats, borne, coating_of
from contact.solver.friction.all_sliding import AllSliding
from contact.solver.friction.coulomb import solver_room
from contact.solver.yielding.several import yielding_forces
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips

GLIDE = AllSliding(used=True)
WAVES = [{"p": 2, "cos": 4e-5}]
SOFT = {"E": 1e9, "yield_stress": 2e4, "hardening": 1e6, "thickness": 1e-3, "width": 0.02, "tip": 6e-3, "bars": 2}


def coating(**changes):
    return ct.Abradable(**{**SOFT, **changes})


def one_blade(*angles, S=1e-8, speed_hz=5.0, **options):
    """Blades of one tip each on a ring with two lobes, at these angles."""
    bodies = [blade(S=2.0 * S, zeta=0.01) for _ in angles]
    stand = [ct.ContactPoint(blade=b, lean_deg=20.0, angle_deg=angle) for b, angle in enumerate(angles)]
    given = {"clearance": -2e-5, "profile": ct.RimProfile.fourier(WAVES), **options}
    return ct.Rub(ring(S=S, zeta=0.01), bodies, stand, speed=ct.Speed.constant(speed_hz), **given)


def coupled(rng):
    """A Delassus matrix of up to six tips, bars in every state under each, free gaps and slips."""
    K, dim = int(rng.integers(1, 7)), int(rng.integers(1, 4))
    n, size, under = K * dim, 10.0 ** rng.uniform(-8, -6), int(rng.integers(1, 8))
    A = rng.standard_normal((n, n + 3))
    W = size * (A @ A.T / n + 10.0 ** rng.uniform(-4, 0) * np.eye(n))
    cells = under * (K + 2)
    coats = Coats(
        worn=rng.uniform(0.0, 1e-4, cells) * rng.choice([0.0, 0.1, 1.0]), start=np.array([0, cells]),
        track=np.zeros(K, dtype=np.int64), round=np.array([-np.inf]), mean=np.zeros(1),
        thickness=rng.uniform(1e-4, 3e-4), stiffness=10.0 ** rng.uniform(4, 9, 1),
        yield_force=10.0 ** rng.uniform(-1, 3, 1), hardening=np.array([rng.choice([0.0, 1e4, 1e7])]), under=under,
        memory=np.zeros((K, 3)), first=under * np.arange(K), cut=rng.uniform(0.0, 5e-5, K) * rng.choice([0, 1]),
    )  # fmt: skip
    b = np.zeros((K, dim))
    b[:, 0] = -rng.uniform(-1e-5, 2e-4, K)
    b[:, 1:2] = 10.0 ** rng.uniform(-7, -3) * rng.choice([-1.0, 1.0])
    return coats, W, b.ravel(), rng.choice([0.0, 0.1, 0.3]) * np.ones(K), dim


@pytest.mark.slow
def test_forces_and_depths_of_coupled_tips_obey_both_laws():
    """Depth = -gap, force = what the bars bear there, friction in its cone and against the slip."""
    rng, met = np.random.default_rng(17), set()
    for _ in range(200):
        coats, W, b, mu, dim = coupled(rng)
        K, force = mu.size, np.zeros(b.size)
        depth = np.zeros(K)
        assert yielding_forces(coats, None, np.arange(K), W, b, mu, dim, K, force, depth, GLIDE, solver_room(K, dim))
        u, lam = (W @ force + b).reshape(K, dim), force.reshape(K, dim)
        near = 1e-9 * np.abs(b[::dim]).max()
        for a in range(K):
            bears, slope = borne(coating_of.py_func(coats, a), coats.first[a], coats.cut[a], depth[a])
            assert abs(bears - lam[a, 0]) <= near * (slope + 1.0 / W[a * dim, a * dim])
            assert abs(u[a, 0] + depth[a]) <= near if lam[a, 0] > 0.0 else u[a, 0] + depth[a] >= -near
            pull, slip = lam[a, 1:], u[a, 1:]
            assert np.linalg.norm(pull) <= mu[a] * lam[a, 0] * (1.0 + 1e-9)
            if dim > 1 and np.linalg.norm(slip) > 1e-6 * np.abs(b).max():
                assert pull == pytest.approx(
                    -mu[a] * lam[a, 0] * slip / np.linalg.norm(slip), abs=1e-6 * max(lam[:, 0].max(), 1e-12)
                )
            met.add((lam[a, 0] > 0.0, bool(slope > 0.0)))
    assert met >= {(True, True), (False, False)}


@pytest.mark.slow
@pytest.mark.parametrize("deeper", [5e-6, -5e-6])
def test_two_blades_wear_one_track_and_the_second_cuts_what_the_first_left(deeper):
    """Nothing but S yields: a tip of n bars at their yield force leaves w = -g - S n Y - Y/k, exactly."""
    law, body = coating(hardening=0.0), ring()
    still = ct.ModalBody(
        omega=[1e4], zeta=[0.5], channels=body.channels, rows=np.zeros((len(body.channels), 1)), S=0.0 * body.S,
        kind="rim", n_max=body.n_max, radius=0.45,
    )  # fmt: skip
    stand = [ct.ContactPoint(lean_deg=20.0), ct.ContactPoint(blade=1, lean_deg=20.0, angle_deg=90.0, clearance=-deeper)]
    rub = ct.Rub(still, [blade(psi=0.0)] * 2, stand, clearance=-3e-5, speed=ct.Speed.constant(5.0))
    (track,) = ct.run(rub, law=law, scheme=ct.ExactModal(law="forward"), t_end=0.1, dt=5e-5).tracks
    S, area = rub_system(rub, 1).compliance(0.0)[0, 0], law.width * 2.0 * np.pi * 0.45 / 942
    cut = 3e-5 - law.yield_stress * (2.0 * area * S + law.thickness / law.E)
    assert cut > 1e-5
    degrees = np.degrees(track.angle)

    def between(low, high):
        return (degrees > low + 1.0) & (degrees < high - 1.0)

    quarter = track.map[np.searchsorted(track.map_time, 0.05)]
    assert quarter[between(270.0, 360.0)] == pytest.approx(cut, rel=1e-12)  # the first blade's
    assert quarter[between(0.0, 90.0)] == pytest.approx(cut + deeper, rel=1e-12)  # the second's
    assert track.worn[between(270.0, 360.0)] == pytest.approx(cut + max(deeper, 0.0), rel=1e-12)  # both
    assert track.worn[between(180.0, 270.0)] == pytest.approx(cut, rel=1e-12)
    assert np.all(track.worn[between(90.0, 180.0)] == 0.0)
    assert track.tips == (0, 1)
    assert abs(track.residual) <= 1e-12


@pytest.mark.slow
def test_each_place_along_the_tip_wears_its_own_track():
    """Two blades with three places each: the k-th of both share the k-th track; the sums close for each."""
    rub = ct.Rub(
        rim3(), [nodes(3), nodes(3, seed=6)], [*tips(3), *tips(3, blade=1, angle=50.0)], clearance=-3e-5,
        closing=ct.gaps.Closing([0.0, 0.01], [0.0, 3e-4]), speed=ct.Speed.constant(7.0),
        profile=ct.RimProfile.fourier(WAVES),
    )  # fmt: skip
    law = coating(mu=0.2)
    result = ct.run(rub, law=law, t_end=0.04, dt=4e-5)
    assert [track.tips for track in result.tracks] == [(0, 3), (1, 4), (2, 5)]
    bar = law.width * 2.0 * np.pi * 0.4 / 838
    for track in result.tracks:
        assert track.worn.size == 838
        assert track.volume == pytest.approx(bar * track.worn.sum(), rel=1e-12)
        assert track.stated == pytest.approx(bar * np.sum(law.dissipated(track.worn)), rel=1e-12)
        assert track.volume > 1e-8
        assert abs(track.residual) <= 1e-12
        assert np.array_equal(track.map[-1], track.worn)
    wear = result.wear
    assert wear.volume == pytest.approx(sum(track.volume for track in result.tracks), rel=1e-15)
    assert wear.worn.size == 3 * 838
    assert abs(result.energy.unaccounted) <= 1e-11 * result.energy.scale
    assert result.residual.max() <= 1e-15
    assert "track 2 (tips 2, 5): worn" in repr(result)
    assert result.to_dict()["coating"][1]["contacts"] == [2, 5]


@pytest.mark.slow
def test_at_rest_what_the_contact_takes_is_what_the_bars_took():
    """Omega = 0: work along the gap = energy dissipated by the bars + elastic energy, exactly as the step falls."""
    left = []
    for dt in (2e-5, 1e-5):
        rub = ct.Rub(
            rim3(S=2e-7), [nodes(3, S=1e-7)], tips(3, axial=False), clearance=1e-6,
            closing=ct.gaps.Closing([0.0, 0.02], [0.0, 4e-4]),
        )  # fmt: skip
        result = ct.run(rub, law=coating(hardening=1e6), scheme=ct.ExactModal(law="forward"), t_end=0.03, dt=dt)
        assert result.wear.dissipated > 1e-5
        left.append(abs(result.energy.lost_in_contact / result.wear.dissipated - 1.0))
    assert left[1] <= 0.6 * left[0] <= 0.006


@pytest.mark.slow
def test_a_saved_result_keeps_its_tracks(tmp_path):
    rub = ct.Rub(rim3(), [nodes(2)], tips(2), clearance=-3e-5, speed=ct.Speed.constant(7.0))
    result = ct.run(rub, law=coating(), t_end=0.01, dt=4e-5)
    result.save(tmp_path / "run.npz")
    again = ct.Result.load(tmp_path / "run.npz")
    assert [track.tips for track in again.tracks] == [(0,), (1,)]
    assert np.array_equal(again.tracks[1].map, result.tracks[1].map)
    assert again.wear.volume == result.wear.volume


@pytest.mark.slow
def test_a_disk_wears_one_track_with_all_its_tips():
    disk = ct.BladedDisk(blades=6, freq_hz=100.0, modal_mass=0.4, coupling=0.05, compliance=1e-7, lean_deg=20.0)
    rub = ct.Rub(ring(), [disk.body()], disk.tips(), clearance=-3e-5, speed=ct.Speed.constant(5.0))
    assert track_tips(rub, 6e-3) == [[0, 1, 2, 3, 4, 5]]
    result = ct.run(rub, law=coating(), t_end=0.02, dt=2e-5)
    assert len(result.tracks) == 1
    assert abs(result.wear.residual) <= 1e-12
    sixth = result.wear.worn.reshape(6, -1)
    assert sixth.max(axis=1) == pytest.approx(sixth.max(), rel=0.5)  # each tip cuts its own sixth in the first turn


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([{}, {"track": 0, "angle_deg": 10.5}], r"tips\[1\].track: found 0.00349 m to tips\[0\] on one track 0"),
        ([{"angle_deg": 359.9}, {"track": 0, "angle_deg": 0.1}], r"expected at least the tip's length of 0.006 m"),
    ],
)  # fmt: skip
def test_tips_that_cannot_share_a_track(changes, words):
    base = {"span": "node0.span", "flap": "node0.flap", "angle_deg": 10.0}
    rub = ct.Rub(rim3(), [nodes(1)], [ct.ContactPoint(**{**base, **change}) for change in changes])
    with pytest.raises(ct.InputError, match=words):
        ct.run(rub, law=coating(), t_end=0.01, dt=4e-5)


def test_bad_tracks():
    for track in (-1, 0.5):
        with pytest.raises(ct.InputError, match=f"track: found {track}, expected a whole number >= 0"):
            ct.ContactPoint(track=track)
    rub = ct.Rub(rim3(), [nodes(1)], tips(1))
    with pytest.raises(ct.InputError, match="tip: found 1 m, expected at most a quarter of the rim"):
        ct.run(rub, law=coating(tip=1.0), t_end=0.01, dt=4e-5)
