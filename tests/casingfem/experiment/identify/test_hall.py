"""What tests in a hall have: a window that damps, dead, turned, exchanged channels, no unit, noise like the signal."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.identify.held_modes import numbers_of_modes

X = np.arange(90.0, 130.0, 0.1)
TAU = 1.5


@pytest.fixture(scope="module")
def windowed():
    """Four sensors, one mode at 110 Hz of 0.3 % and what an exponential window adds, 0.1 %."""
    rig = cf.rig.Rig.of(
        omega=2 * np.pi * np.array([110.0]), zeta=3e-3, rows=np.array([[1.0], [0.7], [-0.6], [0.4], [1]])
    )
    what = cf.rig.Troubles(snr_db=50.0, exponential=TAU)
    return cf.rig.troubled_frfs(rig, X, what, sensors=range(4), drives=[4], seed=41).frfs


@pytest.fixture(scope="module")
def plain(windowed):
    """What is found of them where nothing is stated of the window."""
    return cf.identify(windowed)


@pytest.mark.slow
def test_damping_of_an_exponential_window_is_taken_off_where_it_is_known(windowed, plain, held):
    added = 1.0 / (TAU * 2 * np.pi * 110.0)
    assert plain.zeta[0] == pytest.approx(3e-3 + added, rel=5e-3)
    told = cf.identify(windowed, exponential=TAU)
    read = cf.identify(replace(windowed, card=("exponential_window_s: 1.5",)))
    for found in (told, read):
        assert found.zeta[0] == pytest.approx(3e-3, abs=4 * found.sigma_zeta[0])
        assert found.sigma_zeta[0] == plain.sigma_zeta[0]
        assert found.freq[0] == pytest.approx(110.0, rel=5e-6)
        assert found.sure.all()
        assert any("exponential window" in note for note in found.notes)
    wrong = cf.identify(windowed, exponential=0.3)  # would add more than there is
    assert wrong.zeta[0] == 0.0
    assert "0.48 % that the exponential window adds" in wrong.reasons[0]
    held(1e-4, **numbers_of_modes(wrong))


@pytest.mark.parametrize(("value", "card"), [(0.0, ()), (-1.0, ()), (None, ("exponential_window_s: two",))])
def test_a_window_without_a_time_constant_is_refused(windowed, value, card):
    with pytest.raises(cf.errors.InputError, match="exponential_window_s"):
        cf.identify(replace(windowed, card=card), exponential=value)


@pytest.mark.slow
def test_a_dead_channel_is_left_out_and_a_missing_unit_is_reported(windowed, held):
    rng = np.random.default_rng(42)
    H = np.array([[1.0], [0.0], [-0.6], [0.4]]) * X**2 / (110.0**2 - X**2 + 2j * 3e-3 * 110.0 * X)
    H = H * (1.0 + 1e-3 * rng.standard_normal(H.shape))
    found = cf.identify(replace(windowed, responses=H, unit=""))
    assert found.freq[found.sure] == pytest.approx([110.0], rel=1e-5)
    assert found.sensors.points.tolist() == [1, 3, 4]
    held(1e-4, **numbers_of_modes(found))
    assert found.notes[0].startswith("the responses have no unit: taken for accelerance")
    assert found.notes[1] == "zero on every line: channel 2; left out: point 2"
    known = cf.identify(replace(windowed, responses=H, unit="(1/N)*(m/s²)"))
    assert known.notes == found.notes[1:]
    np.testing.assert_array_equal(known.freq, found.freq)


@pytest.mark.slow
def test_lines_without_a_number_are_left_out_and_a_channel_that_has_few(windowed, plain, held):
    H = windowed.responses.copy()
    H[:, :3], H[1, [195, 196, 201, 202]], H[3, 100:200] = np.nan, np.nan, np.nan  # the peak is at line 200
    found = cf.identify(replace(windowed, responses=H))
    assert found.notes[:2] == (
        "nan on more than 20 % of the lines: channel 4; left out: point 4",
        "nan in channel 2: 4 of 397 lines left out, from 109.5 to 110.2 Hz",
    )
    assert found.lines[0] == pytest.approx(90.3)
    assert found.sensors.points.tolist() == [1, 2, 3]
    held(1e-4, **numbers_of_modes(found))
    assert found.freq == pytest.approx(plain.freq, abs=3 * found.sigma_freq[0])
    assert found.zeta == pytest.approx(plain.zeta, abs=3 * found.sigma_zeta[0])
    lines = np.abs(found.lines[:, None] - X[[195, 196, 201, 202]]).min(axis=1) < 0.01
    assert np.isnan(found.fitted[0][lines]).all()
    assert np.isfinite(found.fitted[0][np.abs(found.lines - 110.5) < 0.15]).all()
    H[:, 100:200] = np.nan
    with pytest.raises(cf.errors.InputError, match=r"nan on more than 20 %.* expected a signal"):
        cf.identify(replace(windowed, responses=H))


@pytest.mark.slow
def test_lines_that_are_not_coherent_weigh_less(windowed, plain, held):
    """Every other stretch of 21 lines is noise like the signal, and the coherence states it."""
    rng = np.random.default_rng(59)
    spoilt, clean = (np.arange(X.size) // 21) % 2 == 0, windowed.responses
    noise = 0.05 * np.abs(clean).max() * rng.standard_normal((2, *clean.shape))
    frfs = replace(windowed, responses=clean + spoilt * (noise[0] + 1j * noise[1]))
    told = np.where(spoilt, 0.5, 0.9999) * np.ones((4, 1))
    gamma2 = replace(frfs, kind="spectrum", responses=told, unit="")
    errors = [abs(cf.identify(frfs, coherence=each).zeta[0] / plain.zeta[0] - 1.0) for each in (None, gamma2)]
    assert errors[1] < 0.5 * errors[0]
    held(1e-4, **numbers_of_modes(cf.identify(frfs, coherence=gamma2)))
    other = replace(gamma2, reference_point=np.full(4, 99))  # the only one of each sensor applies to all references
    assert abs(cf.identify(frfs, coherence=other).zeta[0] / plain.zeta[0] - 1.0) == errors[1]
    with pytest.raises(cf.errors.InputError, match="the lines of the responses"):
        cf.identify(frfs, coherence=replace(gamma2, x=X + 0.05))
    with pytest.raises(cf.errors.InputError, match="coherence of other channels"):
        cf.identify(frfs, coherence=replace(gamma2, response_point=np.arange(4) + 50))
