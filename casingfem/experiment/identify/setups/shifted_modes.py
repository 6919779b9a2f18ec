"""What a test of several set-ups with shifted peaks was found to hold."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.own_shifts import Modes, Setups
from casingfem.io.arrays import BoolArray, FloatArray, IntArray


class Shifted(NamedTuple):
    """Modes with own frequencies, the variance of ln f (modes, setups), the channels of each set-up.

    `sigma_zeta` (modes,) is the standard deviation of ln zeta, `sigma_matching` (modes,) that of the mean of ln f from
    not knowing which mode is which in a set-up; `worth` (modes,) what each takes from the squares over what it must.

    `leak` is the distance of lines [Hz] over which a Hann window leaks, or 0; `shift` what set-ups differ by in ln f,
    usually; `evidence` twice the ln of the odds against common frequencies. Where the last fit was one of waves round
    the circle, `mean_freq` [Hz] (modes,) is the mean over the set-ups, `sigma_mean` (modes,) the standard deviation of
    its ln, `rival` (modes,) how far ln f is off that by another reading that may well be, `belongs` (channels,) says
    which move as they should where they stand; None elsewhere.
    """

    modes: Modes
    variance: FloatArray
    sigma_zeta: FloatArray
    sigma_matching: FloatArray
    worth: FloatArray
    setups: Setups
    leak: float
    shift: float
    evidence: float
    mean_freq: FloatArray | None = None
    sigma_mean: FloatArray | None = None
    rival: FloatArray | None = None
    belongs: BoolArray | None = None

    @property
    def several(self) -> bool:
        """Whether peaks are shifted at all."""
        return self.evidence > 0.0 and len(self.setups) > 1

    def mean(self) -> tuple[FloatArray, FloatArray]:
        """Mean frequency [Hz] of each mode over the set-ups, and the standard deviation of its ln, (modes,).

        A set-up that does not see a mode has, as far as one can tell, what the others have, within `shift`.
        """
        if self.mean_freq is not None and self.sigma_mean is not None:
            return self.mean_freq, self.sigma_mean
        logs = np.log(self.modes.freq)
        weight = 1.0 / (self.variance + self.shift**2 + 1e-300)
        centre = (weight * logs).sum(axis=1, keepdims=True) / weight.sum(axis=1, keepdims=True)
        each = centre + self.shift**2 * weight * (logs - centre)
        left = self.variance * self.shift**2 * weight
        return np.exp(each).mean(axis=1), np.sqrt(left.mean(axis=1) / logs.shape[1])

    def seen(self) -> FloatArray:
        """Share of the set-ups that have each mode's energy, (modes,): 1 where all have as much of it."""
        energy = np.abs(self.modes.residues / np.linalg.norm(self.modes.residues, axis=1, keepdims=True)) ** 2
        each = np.array([energy[:, channels].sum(axis=1) for channels in self.setups]).T
        return np.asarray(each.sum(axis=1) ** 2 / np.sum(each**2, axis=1) / len(self.setups))

    def apart(self, one: IntArray, other: IntArray) -> FloatArray:
        """Chi-squared of two modes having the same frequency in every set-up of several channels, (pairs,).

        One channel alone does not tell two modes from one: no other confirms what it shows.
        """
        several = [len(channels) > 1 for channels in self.setups]
        gap = np.log(self.modes.freq[one] / self.modes.freq[other])
        squares = gap**2 / (self.variance[one] + self.variance[other] + 1e-300)
        return np.asarray(squares[:, several].sum(axis=1))

    def aligned(self, whole: Window) -> Window:
        """The data as they would be if every set-up had the mean frequencies."""
        whole = replace(whole, leak=self.leak)
        together = self.modes._replace(freq=self.mean()[0][:, None])
        change = together.response(whole, [np.arange(whole.Y.shape[1])]) - self.modes.response(whole, self.setups)
        return replace(whole, Y=whole.Y + np.concatenate([change.real, change.imag]))
