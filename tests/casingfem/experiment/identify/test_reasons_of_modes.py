"""Why a mode is doubtful: each reason on both sides of its limit, with the number that it states."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.identify.test_completeness import receptances

LINES = np.arange(80.0, 120.0, 0.1)
EVEN = np.ones(16)


def reason(residues, *, x=LINES, zeta=0.004, noise=1e-2, tone=0.0):
    """The reason of the mode at 100 Hz."""
    frfs = receptances(x, [(100.0, zeta, residues)], noise=noise)
    H = np.array(frfs.responses)
    H[:, np.abs(x - 93.0).argmin()] += 1j * tone * residues
    found = cf.identify(
        cf.frf.FrfSet.from_arrays(
            kind="frf", x=x, responses=H, unit="m/N", response_point=np.arange(len(H))
        )
    )  # fmt: skip
    assert found.sure.tolist() == [not why for why in found.reasons]
    return dict(zip(found.freq.round(0).tolist(), found.reasons, strict=True))


def test_a_mode_without_a_fault_is_sure():
    assert reason(EVEN) == {100.0: ""}


@pytest.mark.parametrize(
    ("zeta", "why"), [(0.098, ""), (0.102, "its damping of 10 % is that of a residual, or of several modes")]
)
def test_a_damping_ratio_above_a_tenth_is_doubtful(zeta, why):
    assert reason(EVEN, x=np.arange(40.0, 160.0, 0.2), zeta=zeta, noise=1e-3) == {100.0: why}


@pytest.mark.parametrize(
    ("phase", "why"),
    [(1.35, ""), (1.39, "only 59 % of its shape is in phase: two modes, or a phase error of a sensor?"),
     (np.pi / 2.0, "only 50 % of its shape is in phase: two modes, or a phase error of a sensor?")],
)  # fmt: skip
def test_a_shape_in_phase_to_less_than_six_tenths_is_doubtful(phase, why):
    """Of two halves with this phase between them, (1 + cos)/2 is in phase."""
    assert reason(EVEN * np.exp(1j * phase * (np.arange(16) % 2))) == {100.0: why}


@pytest.mark.parametrize(("loud", "of"), [(1, 24), (2, 24), (3, 24), (1, 9), (1, 8)])
def test_a_mode_that_less_than_an_eighth_of_the_channels_show_is_local(loud, of):
    why = f"only {loud} of {of} channels show it: a local mode, of a fixture or a sensor's mount?"
    assert reason(np.r_[np.ones(loud), np.full(of - loud, 1e-3)]) == {100.0: why if loud / of < 0.12 else ""}


@pytest.mark.parametrize(("channels", "noise"), [(1, 3.0), (1, 5.0), (2, 5.0)])
def test_few_channels_need_a_clearer_peak(channels, noise):
    (why,) = reason(np.ones(channels), noise=noise).values()
    weak = (channels, noise) == (1, 5.0)
    assert why == (
        "its peak is 14 times the residual there in 1 channel, expected 18 or more: use more sensors" if weak else ""
    )


def test_a_line_without_flanks_is_a_tone():
    found = reason(EVEN, tone=400.0)
    assert found[93.0].startswith("its peak is one line without flanks: mains hum or another tone?")
    assert found[100.0] == ""
