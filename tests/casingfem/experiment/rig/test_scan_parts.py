"""Parts of a scan on the rig against sums written out: harmonics of a circle, waves, forces in space, the record."""

import numpy as np
import pytest

import casingfem as cf

SEED = 5120
OMEGA, ZETA = 2.0 * np.pi * np.array([90.0, 104.0]), np.array([0.01, 0.03])
CIRCLE, DRIVE = [1, 2, 3, 4, 5], 0
THETA = 0.3 + 2.0 * np.pi * np.arange(5) / 5
WRAPPED = np.mod(THETA + np.pi, 2.0 * np.pi) - np.pi
ORDERS = np.arange(-2, 3)


def ring(angles=WRAPPED):
    """A probe inside a ring of five, two modes of no symmetry, and what they leave out."""
    rng = np.random.default_rng(SEED)
    half = rng.normal(size=(6, 6))
    probes = [cf.rig.Probe(k + 1, 1, (0.0, 0.0, 0.0), float(a)) for k, a in enumerate(np.r_[0.0, angles])]
    return cf.rig.Rig.of(omega=OMEGA, zeta=ZETA, rows=rng.normal(size=(6, 2)), S=1e-6 * half @ half.T, probes=probes)


def waves(rig, freq, forces):
    """V_n = i omega/P sum_p e^(-i n theta_p) u_p under complex forces at probes, (orders,)."""
    omega = 2.0 * np.pi * freq
    H = (rig.rows / (OMEGA**2 - omega**2 + 2j * ZETA * OMEGA * omega)) @ rig.rows.T + rig.S
    moved = H[CIRCLE] @ forces
    return np.array([1j * omega * np.mean(np.exp(-1j * n * THETA) * moved) for n in ORDERS])


def at(probes, forces):
    """Forces at some probes, none elsewhere."""
    whole = np.zeros(6, complex)
    whole[probes] = forces
    return whole


def test_a_scan_is_what_a_spot_sees_of_the_waves_of_its_shaker():
    """Two tones, given from above; without a word there is neither noise nor wander, and 1 N in phase."""
    rig, turn = ring(), cf.rig.Turning(mirror=2.5, casing=0.7)
    found = cf.rig.scan(
        rig,
        turn,
        [cf.rig.Tone(101.0, 3.0, 0.4), cf.rig.Tone(95.0)],
        circle=CIRCLE,
        drive=DRIVE,
        fs=500.0,
        seconds=0.3,
        seed=SEED,
    )
    V = np.array([waves(rig, 95.0, at(0, 1.0)), waves(rig, 101.0, at(0, 3.0 * np.exp(0.4j)))])
    assert found.n.tolist() == ORDERS.tolist()
    assert found.record.tones == (95.0, 101.0)
    np.testing.assert_allclose(found.V, V, rtol=1e-10)
    t = np.arange(150) / 500.0
    theta = 2.0 * np.pi * 1.8 * t
    seen = sum(
        np.real(v * np.exp(1j * (2.0 * np.pi * f * t + n * theta)))
        for f, row in zip((95.0, 101.0), V, strict=True) for v, n in zip(row, ORDERS, strict=True)
    )  # fmt: skip
    np.testing.assert_allclose(found.record.velocity, seen, rtol=1e-9, atol=1e-12 * np.abs(seen).max())
    np.testing.assert_allclose(found.record.angle, theta, rtol=1e-12)
    assert found.record.card[0].startswith("SYNTHETIC")
    assert "1.12 Hz" in found.record.card[-1]  # 1.6 x .7


def test_noise_of_a_scan_is_as_far_below_its_rms_as_is_reported():
    asked = {"circle": CIRCLE, "drive": DRIVE, "fs": 4000.0, "seconds": 2.0, "seed": SEED}
    quiet, loud = (
        cf.rig.scan(ring(), cf.rig.Turning(mirror=2.5), [cf.rig.Tone(95.0)], snr_db=snr, **asked).record
        for snr in (None, 26.0)
    )
    added = loud.velocity - quiet.velocity
    assert np.std(added) / np.std(quiet.velocity) == pytest.approx(10.0 ** (-26.0 / 20.0), rel=0.03)
    assert loud.card[-1] == "noise: 26 dB below the rms"
    assert "noise" not in quiet.card[-1]


def test_run_out_adds_to_what_the_spot_sees():
    asked = {"circle": CIRCLE, "drive": DRIVE, "fs": 400.0, "seconds": 0.5, "seed": SEED}
    still, out = (
        cf.rig.scan(
            ring(), cf.rig.Turning(mirror=2.5, first_angle=0.4, runout=runout), [cf.rig.Tone(95.0)], **asked
        ).record
        for runout in ((), ((0.1, -0.3), (0.0, 0.2)))
    )
    theta = 0.4 + 2.0 * np.pi * 2.5 * np.arange(200) / 400.0
    added = 0.1 * np.cos(theta) - 0.3 * np.sin(theta) + 0.2 * np.sin(2.0 * theta)
    np.testing.assert_allclose(out.velocity - still.velocity, added, atol=1e-12)


@pytest.mark.parametrize(
    ("fs", "seconds", "taken"), [(4.0, 0.5, True), (4.0, 0.3, False), (0.0, 9.0, False), (-4.0, -9.0, False)]
)
def test_a_record_has_two_samples_at_least(fs, seconds, taken):
    asked = {"circle": CIRCLE, "drive": DRIVE, "fs": fs, "seconds": seconds, "seed": SEED}
    if taken:
        assert len(cf.rig.scan(ring(), cf.rig.Turning(mirror=1.0), [cf.rig.Tone(95.0)], **asked).record.velocity) == 2
        return
    with pytest.raises(cf.errors.InputError, match="expected a record of two samples or more"):
        cf.rig.scan(ring(), cf.rig.Turning(mirror=1.0), [cf.rig.Tone(95.0)], **asked)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "at least one of them to turn"), ({"mirror": 0.5, "casing": 0.5}, "at least one of them to turn"),
        ({"mirror": 1.0, "first_angle": np.nan}, "expected at least one of them to turn"),
        ({"mirror": 1.0, "speckle": np.inf}, "expected at least one of them to turn"),
        ({"mirror": 1.0, "casing": 0.5, "wander": 0.01}, "0 where the casing turns"),
    ],
)  # fmt: skip
def test_a_spot_that_does_not_move_or_wanders_on_a_lathe_is_refused(given, words):
    with pytest.raises(cf.errors.InputError, match=words):
        cf.rig.Turning(**given)


def test_a_spot_runs_at_the_difference_of_mirror_and_casing():
    assert cf.rig.Turning(mirror=2.5, casing=0.5).spot == 2.0
    assert cf.rig.Turning(casing=1.5).spot == -1.5
