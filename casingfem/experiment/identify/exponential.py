"""Correct the damping that an exponential window added to the responses.

An exponential window exp(-t/tau) changes a pole p of the response to p - 1/tau. The measured damping ratio is therefore
too high by nearly 1/(tau omega). Residues do not change.
"""

from dataclasses import replace

import numpy as np

from casingfem.errors import InputError
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.identify.mode import Mode
from casingfem.experiment.identify.thresholds import USUAL, Thresholds

ENTRY = "exponential_window_s"  # of a card


def window_time(frfs: FrfSet, given: float | None) -> float | None:
    """Time constant [s] of the exponential window: the given one, or that of the card `exponential_window_s.

    2.0`, or None.

    >>> card = ["exponential_window_s: 2.0"]
    >>> window_time(FrfSet.from_arrays(kind="frf", x=[1.0], responses=[[1j]], unit="m/N", card=card), None)
    2.0
    """
    entries = [value.strip() for key, _, value in (line.partition(":") for line in frfs.card) if key.strip() == ENTRY]
    if given is None and not entries:
        return None
    word = repr(given) if given is not None else entries[-1]
    try:
        tau = float(word)
    except ValueError:
        tau = np.nan
    if not (np.isfinite(tau) and tau > 0.0):
        raise InputError(frfs.path, found=f"{ENTRY} {word}", expected="the window's time constant [s], above 0")
    return tau


def without_window(modes: list[Mode], tau: float, rules: Thresholds = USUAL) -> list[Mode]:
    """Modes of the corrected poles p + 1/tau.

    A mode whose corrected damping is not significantly above zero is doubtful. Negative damping is replaced by zero.
    """
    return [_without(mode, tau, rules) for mode in modes]


def _without(mode: Mode, tau: float, rules: Thresholds) -> Mode:
    omega = 2.0 * np.pi * mode.freq
    decay, damped = mode.zeta * omega - 1.0 / tau, omega * np.sqrt(1.0 - mode.zeta**2)
    own = float(np.hypot(decay, damped))
    added = f"its damping does not exceed the {100.0 / (tau * omega):.2g} % that the exponential window adds: check tau"
    unclear = decay / omega < rules.above_zero * mode.sigma_zeta
    reason = "; ".join(part for part in (mode.reason, added if unclear else "") if part)
    return replace(mode, freq=own / (2.0 * np.pi), zeta=max(decay, 0.0) / own, reason=reason)


def window_note(tau: float) -> str:
    """Note that the damping was corrected for the exponential window."""
    return f"damping is given without the 1/(tau omega) of an exponential window, tau = {tau:g} s"
