"""Coatings at several tips: against one tip's run, the laws by definition, tracks that tips share, what is refused."""

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips

WAVES = [{"p": 2, "cos": 4e-5}]
SOFT = {"E": 1e9, "yield_stress": 2e4, "hardening": 1e6, "thickness": 1e-3, "width": 0.02, "tip": 6e-3, "bars": 2}


def coating(**changes):
    return ct.Abradable(**{**SOFT, **changes})


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
    along = np.array([np.cos(np.radians(20.0)), np.sin(np.radians(20.0))])
    S, area = along @ blade(psi=0.0).S @ along, law.width * 2.0 * np.pi * 0.45 / 942
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
        profile=ct.gaps.RimProfile.fourier(WAVES),
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
    disk = ct.gaps.BladedDisk(blades=6, freq_hz=100.0, modal_mass=0.4, coupling=0.05, compliance=1e-7, lean_deg=20.0)
    rub = ct.Rub(ring(), [disk.body()], disk.tips(), clearance=-3e-5, speed=ct.Speed.constant(5.0))
    result = ct.run(rub, law=coating(), t_end=0.02, dt=2e-5)
    assert [track.tips for track in result.tracks] == [(0, 1, 2, 3, 4, 5)]
    assert abs(result.wear.residual) <= 1e-12
    sixth = result.wear.worn.reshape(6, -1)
    assert sixth.max(axis=1) == pytest.approx(sixth.max(), rel=0.5)  # each tip cuts its own sixth in the first turn


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([{}, {"track": 0, "angle_deg": 10.5}], r"tips\[1\].track: found 0.00349 m to tips\[0\] on the same track 0"),
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
    with pytest.raises(ct.InputError, match="tip: found 1 m, expected at most a quarter of the circumference"):
        ct.run(rub, law=coating(tip=1.0), t_end=0.01, dt=4e-5)
