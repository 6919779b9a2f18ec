"""Difference of a changed casing from a frequency table, with derivatives by every possible change.

Residuals are those of an update (`targets.py`): means and split vectors. The uncertainty of a measured orientation
widens the split vector d in the transverse direction t: its covariance is sigma^2 I + (2 n |d| sigma_psi)^2 t t^T.

A baseline measures the effect of manufacturing within each pair, its split 2 c f. Manufacturing also couples pairs of
different n, by the same amount. The baseline hardly shows these couplings: they change a frequency by c^2 f^2/D, with D
the distance of the pairs. A change mixes the pairs, and then the couplings have an effect of first order. Let mode i
after the change have the shares p_iP in the pairs P of the casing before, and let the unknown couplings be random, of
the size of those within pairs. In omega_i^2 = sum a_ki a_li (Lambda + W)_kl the part from different pairs has

    (sigma_f/f)_i = c sqrt((sum_P p_iP)^2 - sum_P p_iP^2),   p_iP = sum_(k in P) a_ki^2,   a = Y0^T M Y,

with c the rms of half the relative splits that it makes. The sigma of a mode within its pair does not change.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from casingfem.experiment.correlation.matches import Match
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.modal.affine import AffineModel, AffineModes
from casingfem.updating.calibration import correction, paired_by_shares
from casingfem.updating.targets import (
    HERTZ2,
    Rates,
    has_angle,
    is_doublet,
    jacobian,
    lower_angle,
    pair_state,
    split_vector,
    values,
    with_model_error,
)

PERFECT = 1e-6  # relative split below which a pair has none, but for the mesh and round-off
LOST = 0.1  # a row that pairs with nothing costs as much as one this far off, relative


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """One evaluated set of changes: weighted residuals (rows,), their derivatives (rows, changes), and chi^2.

    Rows of the table without a mode, `lost`, count only in chi^2.
    """

    x: FloatArray
    modes: AffineModes
    values: FloatArray
    jacobian: FloatArray
    chi2: float
    lost: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Misfit:
    """Difference between a table and a model.

    Parameters
    ----------
    model, table
        A casing with its changes, and the measured table.
    count
        Number of computed modes.
    reach
        Largest relative frequency error of a pair.
    angle_sigma
        Standard deviation of a measured orientation times n [rad]: of the phase n psi.
    model_error
        Relative error of the model.
    """

    model: AffineModel
    table: FrequencyTable
    count: int
    reach: float = 0.3
    angle_sigma: float = 0.0
    model_error: float = 0.0

    def at(self, x: FloatArray) -> Point:
        """Evaluate a set of changes (changes,)."""
        found = self.model.modes(x, self.count)
        matches, lost = paired_by_shares(found, self.table, self.reach)
        cost = float(np.sum((LOST * self.table.freq_hz[lost] / self.table.sigma_hz[lost]) ** 2))
        if not matches:
            return Point(x, found, np.zeros(0), np.zeros((0, len(x))), cost, tuple(lost))
        G = self.model.derivatives(found)
        turned = [match for match in matches if has_angle(match, self.table)]
        aimless = set(found.doublets) - {match.modes for match in turned}
        turns = {match.modes: turning(found, match, G) for match in turned}
        at = Rates(G=widest(found, sorted(aimless), G), turning=turns)
        table = with_model_error(self.table, self.model_error)
        residuals = values(found, table, matches)
        slopes = jacobian(found, table, matches, at)
        if self.angle_sigma:
            W = self.whitening(table, matches, len(residuals))
            residuals, slopes = W @ residuals, W @ slopes
        return Point(x, found, residuals, slopes, cost + float(residuals @ residuals), tuple(lost))

    def whitening(self, table: FrequencyTable, matches: Sequence[Match], rows: int) -> FloatArray:
        """Matrix (rows, rows) that weights the residuals by the uncertainty of orientations."""
        W, row = np.eye(rows), 0
        for match in matches:
            if has_angle(match, table):
                on = list(match.rows)
                split = pair_state(*table.freq_hz[on])[1]
                phase = 2.0 * match.n * np.radians(lower_angle(table.angle_deg[on], match.n))
                across = split_vector(1.0, phase)[::-1] * [-1.0, 1.0]
                wider = np.hypot(1.0, 2.0 * split * self.angle_sigma / float(np.hypot(*table.sigma_hz[on])))
                W[row + 1 : row + 3, row + 1 : row + 3] += (1.0 / wider - 1.0) * np.outer(across, across)
            row += 1 if not is_doublet(match) else 3 if has_angle(match, table) else 2
        return W


def widest(found: AffineModes, pairs: Sequence[tuple[int, ...]], G: FloatArray) -> FloatArray:
    """The derivatives (changes, modes, modes) with each perfect pair along the axes of each change alone.

    Without an orientation only the length of the split is known, which is a cone at zero. In the axes of an eigenvalue
    solver, the effect of a change on a perfect pair depends on its place. In the change's own axes, all equal changes
    have equal effects. The same holds for a single member. Lost stiffness and added mass lower frequencies, so the
    lower member gets the larger part.
    """
    G = G.copy()
    for low, high in pairs:
        if found.freq[high] - found.freq[low] < PERFECT * found.freq[low]:
            mean = 0.5 * (G[:, low, low] + G[:, high, high])
            half = np.copysign(np.hypot(0.5 * (G[:, low, low] - G[:, high, high]), G[:, low, high]), mean)
            G[:, low, low], G[:, high, high] = mean + half, mean - half
            G[:, low, high] = G[:, high, low] = 0.0
    return G


def turning(found: AffineModes, match: Match, G: FloatArray) -> FloatArray:
    """Rotation of the phase 2 n psi of a doublet's lower member by all modes except its partner, (changes,).

    Its shape changes by sum_j phi_j G_1j/(omega_1^2 - omega_j^2). A mode of the same frequency is left out, since the
    orientation of the two is arbitrary.
    """
    assert found.rings is not None
    low, high = match.modes
    apart = np.abs(found.freq - found.freq[low]) > PERFECT * found.freq[low]
    others = np.flatnonzero(apart & (np.arange(len(apart)) != high))
    share = G[:, low, others] / (found.omega[low] ** 2 - found.omega[others] ** 2)
    radial = found.rings.amplitudes[match.n, :, 0] * found.rings.weights[:, None]
    own = found.rings.amplitudes[match.n, :, 0, low]
    turns = -2.0 * np.imag(own @ radial[:, others] / (own @ radial[:, low]))
    return np.asarray(share @ turns)


def half_split(found: AffineModes, baseline: FrequencyTable, matches: Sequence[Match]) -> float:
    """Rms of half the relative splits that manufacturing causes in the pairs of a baseline, 0 without pairs.

    A pair that is split by design, by bolts for example, has that split in the model, the modes `found`; only the
    difference counts, with its orientation if measured.
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
    """The table with the sigma that unknown couplings add to its rows after a change with modes `found`."""
    matches, _ = paired_by_shares(found, table, reach)
    share = np.zeros(len(table))
    mixed = mixing(model, tight, found)
    for match in matches:
        share[list(match.rows)] = mixed[list(match.modes)]
    return replace(table, sigma_hz=np.hypot(table.sigma_hz, c * share * table.freq_hz))
