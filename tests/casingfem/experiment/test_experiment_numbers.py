"""Numbers held: the virtual rig, its troubles, identification, circle scans, correlation, universal files."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.identify.test_identification import THETA, ring_rig
from tests.probed import probed

PAIRS = [(6, 330.0, 0.004, 11.0), (7, 345.0, 0.01, 3.0)]
SMALL = cf.rig.Rig.of(
    omega=2.0 * np.pi * np.array([151.3, 153.0, 402.7]),
    zeta=[0.004, 0.006, 0.01],
    rows=[[1.0, 0.2, 0.7], [-0.4, 0.9, 0.5], [0.3, 0.3, -1.1]],
    S=1e-7 * np.array([[4.0, 1.0, 0.0], [1.0, 3.0, 0.5], [0.0, 0.5, 2.0]]),
)


@pytest.fixture(scope="module")
def rig():
    return ring_rig(PAIRS, theta=THETA, drives=[0.3])


def test_numbers_of_troubles(rig, held):
    what = cf.rig.Troubles(
        snr_db=45.0,
        colour=0.5,
        coherent=0.2,
        setups=3,
        shift=2e-3,
        half_rim=True,
        dead=1,
        noisy=1,
        swapped=1,
        flipped=1,
        double_hit=0.1,
        exponential=0.1,
        leakage=True,
        fixture=1,
        phase_deg=3.0,
    )
    test = cf.rig.troubled_frfs(
        rig, np.arange(322.0, 354.0, 0.5), what, sensors=range(len(THETA)), drives=[len(THETA)], seed=29
    )
    truth = test.truth
    held(
        H=probed(np.stack([test.frfs.responses[k] for k in range(3)])),
        coherence=probed(np.stack([test.coherence.responses[k] for k in range(3)])),
        freq=truth.freq,
        zeta=truth.zeta,
        fixture=truth.fixture_hz,
        setup=truth.setup,
        where=[*truth.dead, *truth.noisy, *np.ravel(truth.swapped), *truth.flipped],
    )


@pytest.mark.parametrize(
    "excitation",
    [
        cf.rig.Random(rms=1.0, band=(60.0, 700.0)),
        cf.rig.BurstRandom(rms=1.0, band=(60.0, 700.0), part=0.25),
        cf.rig.Impact(peak=10.0, width=4e-3),
    ],
    ids=lambda e: type(e).__name__,
)
@pytest.mark.parametrize("quantity", ["receptance", "accelerance"])
def test_numbers_of_records(excitation, quantity, held):
    test = cf.rig.record(
        SMALL, [excitation], drives=[0], sensors=[0, 1], fs=2048.0, block=1024, blocks=3, seed=5, quantity=quantity
    )
    noisy_test = cf.rig.measured(test, snr_db=40.0, seed=6)
    found = cf.rig.estimate(noisy_test, band=(80.0, 600.0))
    H, coherence = (np.stack([part.responses[k] for k in range(2)]) for part in (found.frfs, found.coherence))
    held(1e-5, H=H[:, ::23], coherence=coherence[:, ::23], averages=[found.averages])


def test_numbers_of_circle_scans(held):
    fs, count = 2000.0, 8000
    theta, t = cf.circle.turning(2.3, fs, count, first_angle=0.3), np.arange(count) / fs
    noise = 0.01 * np.random.default_rng(4).standard_normal(count)
    seen = np.cos(8 * (theta - 0.11)) * np.cos(2.0 * np.pi * 371.3 * t + 0.4) + 0.2 * np.cos(
        2.0 * np.pi * 371.3 * t + 5 * theta
    )
    found = cf.circle.demodulate(cf.circle.ScanRecord(fs=fs, velocity=seen + noise, angle=theta, tones=(371.3,)), 10)
    waves = found.waves()
    held(
        1e-5,
        V=found.V,
        lines=found.lines,
        n=[w.n for w in waves],
        amplitude=[w.amplitude for w in waves],
        travelling=[w.travelling for w in waves],
        angle=[w.angle_deg for w in waves],
    )
