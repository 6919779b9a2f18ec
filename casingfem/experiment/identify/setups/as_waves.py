"""Modes of a test in several set-ups, fitted last as the waves that they are round a circle.

Before that noise that channels have in common, as that of a shaker or of an exciting force, is taken off as far as
others tell it. Noise n = l g + e of a line, g common to the channels, e of each channel with variances D (factor
analysis with one factor, by principal axes), is guessed for channel c from what a fit leaves of the others, r,

    guess_c = sum_{j != c} K_cj r_j / (1 - K_cc),   K = l l^H (l l^H + D)^-1,

the best linear one: what is left of n_c has the variance 1/(R^-1)_cc. K is the same on all lines, so whatever the fit
has missed of a peak, or of modes outside, keeps its poles.
"""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.around import Places
from casingfem.experiment.identify.setups.clusters import clusters
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.shifted import MOST_LINES, TOGETHER, Shifted
from casingfem.experiment.identify.setups.wave_model import belonging, waves_of
from casingfem.experiment.identify.setups.wave_search import WaveModes, wave_modes
from casingfem.io.arrays import Array, FloatArray
from casingfem.io.side_by_side import Each, largest_first

MOST_SETUPS = 6  # of which each pair is tried exchanged in each
LEAST_LINES = 20  # for each channel, that tell a correlation
QUIET = 4.0  # times the median of the lines, beyond which what is left of one is no noise
STEPS = 50  # of the principal axes
MOST = 0.95  # share of a channel's noise that may be common


def as_waves(found: Shifted, whole: Window, places: Places | None, each: Each = map) -> Shifted:
    """What was found, fitted again with shapes that are waves: as it is where channels are too few to tell any.

    Clusters are worked on `each` by itself.
    """
    waves = None if places is None else waves_of(places, found.modes.residues)
    if waves is None or len(found.setups) > MOST_SETUPS:
        return found
    whole = without_common_noise(found, whole)
    order = np.argsort(found.modes.freq.min(axis=1))  # as `clusters` has them
    near = list(clusters(replace(whole, leak=found.leak), found.modes, found.setups, MOST_LINES, TOGETHER, found.shift))
    fit = partial(wave_modes, found.setups, waves, found.shift)
    done = dict(largest_first(each, fit, near, lambda c: c.window.Y.size * len(c.modes.zeta)))
    parts = [done[k] for k in range(len(near))]
    windows = [c.window for c in near]
    residues = [part.residues / w.weight / w.scale**w.power for part, w in zip(parts, windows, strict=True)]
    own = np.split(found.worth[order], np.cumsum([len(c.modes.zeta) for c in near])[:-1])
    joined: dict[str, Any] = {k: np.concatenate([getattr(part, k) for part in parts]) for k in WaveModes._fields}
    return found._replace(
        modes=Modes(joined["freq"], joined["zeta"], np.concatenate(residues)),
        belongs=belonging(waves),
        sigma_mean=joined["sigma_freq"],
        worth=np.concatenate([np.r_[old, part.worth] for old, part in zip(own, parts, strict=True)]),
        **{name: joined[name] for name in ("variance", "mean_freq", "rival", "sigma_zeta", "sigma_matching")},
    )


def without_common_noise(found: Shifted, whole: Window) -> Window:
    """The data without the part of what modes leave that is guessed to be common to the channels."""
    left = whole.as_complex - found.modes.response(replace(whole, leak=found.leak), found.setups)
    guess = left @ common_share(left[whole.along > 0.0]).T
    data = whole.as_complex - np.where(whole.along[:, None] > 0.0, guess, 0.0)
    return replace(whole, Y=np.concatenate([data.real, data.imag]))


def common_share(left: Array) -> Array:
    """What guesses (channels, channels) from what is left on even lines (lines, channels); zeros where these are few.

    From second differences along the lines, which know nothing of what is smooth.
    """
    many = left.shape[1]
    rough = left[1:-1] - 0.5 * (left[2:] + left[:-2])
    size = np.sqrt(np.median(np.abs(rough) ** 2, axis=0)) if len(rough) else np.zeros(many)
    if many < 3 or len(rough) < LEAST_LINES * many or not size.all():
        return np.zeros((many, many), complex)
    scaled = rough / size
    energy = np.mean(np.abs(scaled) ** 2, axis=1)
    scaled = scaled[energy < QUIET * np.median(energy)]
    size = size * np.sqrt(np.mean(np.abs(scaled) ** 2, axis=0))
    scaled = scaled / np.sqrt(np.mean(np.abs(scaled) ** 2, axis=0))
    load = _one_factor(scaled.T @ scaled.conj() / len(scaled))
    both = np.outer(load, load.conj())
    K = both @ np.linalg.inv(both + np.diag(1.0 - np.abs(load) ** 2))
    others = K / (1.0 - np.diag(K))[:, None]
    np.fill_diagonal(others, 0.0)
    return np.asarray(size[:, None] * others / size)


def _one_factor(R: Array) -> Array:
    """Loads of the one factor of a correlation matrix, (channels,)."""
    shared: FloatArray = np.full(len(R), 0.5)
    load = np.zeros(len(R), complex)
    for _ in range(STEPS):
        values, vectors = np.linalg.eigh(R - np.diag(1.0 - shared))
        load = np.sqrt(max(float(values[-1]), 0.0)) * vectors[:, -1]
        load *= np.minimum(1.0, np.sqrt(MOST) / np.maximum(np.abs(load), 1e-300))
        shared = np.abs(load) ** 2
    return load
