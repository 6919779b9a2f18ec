"""Modes of a test in several set-ups, fitted last as the waves that they are round a circle."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from casingfem.experiment.identify.poles.pole_window import Window
from casingfem.experiment.identify.setups.around import Places
from casingfem.experiment.identify.setups.channel_offs import belonging, waves_of
from casingfem.experiment.identify.setups.clusters import clusters
from casingfem.experiment.identify.setups.common_noise import without_common_noise
from casingfem.experiment.identify.setups.own_shifts import Modes
from casingfem.experiment.identify.setups.shifted import MOST_LINES, TOGETHER
from casingfem.experiment.identify.setups.shifted_modes import Shifted
from casingfem.experiment.identify.setups.wave_search import wave_modes
from casingfem.io.side_by_side import Each, largest_first

MOST_SETUPS = 6  # of which each pair is tried exchanged in each


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
    residues = [
        part.residues / c.window.weight / c.window.scale**c.window.power for part, c in zip(parts, near, strict=True)
    ]
    own = np.split(found.worth[order], np.cumsum([len(c.modes.zeta) for c in near])[:-1])
    return found._replace(
        modes=Modes(
            np.concatenate([part.freq for part in parts]),
            np.concatenate([part.zeta for part in parts]),
            np.concatenate(residues),
        ),
        variance=np.concatenate([part.variance for part in parts]),
        belongs=belonging(waves),
        mean_freq=np.concatenate([part.mean_freq for part in parts]),
        sigma_mean=np.concatenate([part.sigma_freq for part in parts]),
        rival=np.concatenate([part.rival for part in parts]),
        sigma_zeta=np.concatenate([part.sigma_zeta for part in parts]),
        sigma_matching=np.concatenate([part.sigma_matching for part in parts]),
        worth=np.concatenate([np.r_[old, part.worth] for old, part in zip(own, parts, strict=True)]),
    )
