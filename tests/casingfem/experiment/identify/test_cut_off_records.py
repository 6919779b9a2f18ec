"""Records that end while the structure still rings: every mode once, with the pole's frequency and damping."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.identify.held_modes import numbers_of_modes

FS = 4096.0
BEAM = (142.2, 278.7, 460.3, 687.2, 958.5)
RING = ((142.2, 2, 0.1), (143.0, 2, 0.1 + np.pi / 4), (278.7, 3, 0.3), (279.1, 3, 0.3 + np.pi / 6),
        (460.3, 4, 0.2), (463.0, 4, 0.2 + np.pi / 8))  # fmt: skip


def accelerances(freqs, sizes, zeta, *, seconds, before, noise=1e-3, band=(20.0, 1000.0)):
    """Hammer responses (channels, lines) by transforms of records cut off at their end; `before` is the pre-trigger."""
    count = int(FS * seconds)
    t, rng = np.arange(count) / FS - before, np.random.default_rng(3)
    pulse = np.where(np.abs(t) < 0.4e-3, np.cos(np.pi * t / 0.8e-3) ** 2, 0.0)
    after = np.arange(2 * count) / FS
    records = np.zeros((len(sizes), count))
    for freq, size in zip(freqs, np.transpose(sizes), strict=True):
        omega = 2.0 * np.pi * freq
        pole = omega * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
        response = np.convolve(pulse, np.imag(pole**2 * np.exp(pole * after)) / omega)[:count] / FS + pulse
        records += np.outer(size, response)
    H = np.fft.rfft(records) / np.fft.rfft(pulse)
    x = np.fft.rfftfreq(count, 1.0 / FS)
    H = H + noise * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape))
    kept = (x >= band[0]) & (x <= band[1])
    return cf.frf.FrfSet.from_arrays(
        kind="frf", x=x[kept], responses=H[:, kept], unit="(m/s^2)/N", response_point=np.arange(len(sizes))
    )


BEAM_SIZES = np.transpose([(1, 0.4, -0.7), (1, -0.3, -0.9), (1, -0.9, 0.3), (1, 0.7, 0.9), (1, -0.85, -1.4)])


@pytest.mark.slow
@pytest.mark.parametrize("before", [0.0, 0.02, 0.1])
def test_five_modes_of_a_beam_whose_records_end_while_it_rings(before, held):
    """At zeta = 3e-4 the ringing of the first mode has fallen to 77 % after 1 s; lines are 12 bandwidths apart."""
    found = cf.identify(accelerances(BEAM, BEAM_SIZES, 3e-4, seconds=1.0, before=before))
    assert found.freq == pytest.approx(BEAM, abs=2e-3)
    assert found.zeta == pytest.approx(np.full(5, 3e-4), rel=0.05)
    assert found.sure.all()
    held(1e-4, **numbers_of_modes(found))


@pytest.mark.slow
@pytest.mark.parametrize(("zeta", "before", "seconds"), [(1e-3, 0.05, 1.0), (3e-4, 0.05, 1.0), (1e-3, 0.05, 2.0)])
def test_three_pairs_of_a_ring_whose_records_end_while_it_rings(zeta, before, seconds, held):
    theta = 2.0 * np.pi * np.arange(24) / 24
    sizes = np.array([np.cos(n * (theta - a)) * np.cos(n * (0.05 - a)) for _, n, a in RING]).T
    freqs = [freq for freq, _, _ in RING]
    frfs = accelerances(freqs, sizes, zeta, seconds=seconds, before=before, band=(20.0, 600.0))
    found = cf.identify(frfs, angles=dict(enumerate(np.degrees(theta))))
    assert found.freq == pytest.approx(freqs, abs=2e-3)
    assert found.n.tolist() == [2, 2, 3, 3, 4, 4]
    assert found.doublets == ((0, 1), (2, 3), (4, 5))
    assert found.zeta == pytest.approx(np.full(6, zeta), rel=0.02)
    assert found.sure.all()
    held(1e-4, **numbers_of_modes(found))


@pytest.mark.slow
@pytest.mark.parametrize("before", [0.0, 0.05, 0.1])
def test_the_rig_s_records_that_are_cut_off_are_identified_too(before):
    """The same beam by `[rig.test.troubles]`: the truth names the ringing left, and every mode is found."""
    rig = cf.rig.Rig.of(omega=2.0 * np.pi * np.array(BEAM), zeta=3e-4, rows=np.vstack([BEAM_SIZES, BEAM_SIZES[:1]]))
    what = cf.rig.Troubles(snr_db=60.0, cut_off=True, pre_trigger=before)
    test = cf.rig.troubled_frfs(rig, np.arange(20.0, 1001.0), what, sensors=[0, 1, 2], drives=[3], seed=3)
    assert test.truth.left[0] == pytest.approx(np.exp(-3e-4 * rig.omega[0] * (1.0 - before)))
    found = cf.identify(test.frfs)
    assert found.freq == pytest.approx(BEAM, abs=2e-3)
    assert found.zeta == pytest.approx(np.full(5, 3e-4), rel=0.05)
    assert found.sure.all()
