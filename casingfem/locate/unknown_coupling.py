"""What a baseline leaves unknown: the couplings that manufacture makes between pairs of different n.

A baseline shows what manufacture does within each pair, its split 2 c f. What it does between pairs is as large, but
only their distance D shows it, by c^2 f^2/D. A change mixes the pairs, and then it shows to first order: let mode i
after the change have the shares p_iP in the pairs P of the casing before, and let the unknown couplings be random, of
the size of those within pairs. Of omega_i^2 = sum a_ki a_li (Lambda + W)_kl the part over different pairs has

    (sigma_f/f)_i = c sqrt((sum_P p_iP)^2 - sum_P p_iP^2),   p_iP = sum_(k in P) a_ki^2,   a = Y0^T M Y,

c the rms of half the relative splits that it makes. A mode that stays in its pair keeps its sigma.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from casingfem.experiment.correlation.matches import Match
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.modal.affine import AffineModel, AffineModes
from casingfem.updating.calibration import correction, paired_by_shares
from casingfem.updating.targets import HERTZ2


def half_split(found: AffineModes, baseline: FrequencyTable, matches: Sequence[Match]) -> float:
    """Rms of half the relative splits that manufacture makes in the pairs of a baseline, 0 without pairs.

    A pair that bolts, say, split as designed has that split in the model, the modes `found`: what is left counts, with
    its orientation where that was measured.
    """
    halves = []
    for match in matches:
        modes, added = correction(found, baseline, match)
        if len(modes) == len(match.rows) == 2:
            measured = HERTZ2 * baseline.freq_hz[list(match.rows)] ** 2
            if not np.ptp(np.linalg.eigvalsh(added)):  # no orientation
                added = np.diag(measured - found.omega[modes] ** 2)
            halves.append(0.25 * np.ptp(np.linalg.eigvalsh(added)) / measured.mean())
    return float(np.sqrt(np.mean(np.square(halves)))) if halves else 0.0


def mixing(model: AffineModel, tight: AffineModes, found: AffineModes) -> FloatArray:
    """sqrt((sum p)^2 - sum p^2) of every mode found, (modes,): 0 in one pair, near 1 in many.

    Both sets of modes belong to the model.
    """
    square = (tight.coordinates.T @ model.M @ found.coordinates) ** 2
    partner = np.arange(len(square))
    for low, high in tight.doublets:
        partner[high] = low
    shares = np.zeros_like(square)
    np.add.at(shares, partner, square)
    return np.asarray(np.sqrt(np.maximum(shares.sum(axis=0) ** 2 - np.sum(shares**2, axis=0), 0.0)))


def widened(
    table: FrequencyTable, model: AffineModel, tight: AffineModes, found: AffineModes, c: float, reach: float
) -> FrequencyTable:
    """The table with the sigma that unknown couplings give its rows after a change, `found` the modes with it."""
    matches, _ = paired_by_shares(found, table, reach)
    share = np.zeros(len(table))
    mixed = mixing(model, tight, found)
    for match in matches:
        share[list(match.rows)] = mixed[list(match.modes)]
    return replace(table, sigma_hz=np.hypot(table.sigma_hz, c * share * table.freq_hz))
