"""Combine the modes of several set-ups: match them, search again for missing ones, and average.

A set-up of few channels may show two close modes as one. If the other set-ups show both, it is fitted again with both.
A pole is kept if the data determine it near the frequency and damping that the other set-ups predict.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.circle.orientation import Circle
from casingfem.experiment.frf.sensor_grid import SensorGrid
from casingfem.experiment.identify.groups import SetUp, fitted_group, groups
from casingfem.experiment.identify.matching import Matching, Row, matching
from casingfem.experiment.identify.mode import Found, Mode, Residues, Sensors, found_in, mode_of, reasons
from casingfem.experiment.identify.pole_fit import PoleFit
from casingfem.experiment.identify.shared_shape import Member, Shapes
from casingfem.experiment.identify.thresholds import USUAL, Thresholds
from casingfem.io.arrays import Array, FloatArray, IntArray

UNLIKE = 2.5  # a mode whose spread over the set-ups exceeds the usual one by this factor may be two modes
LOOKS = 2  # searches for modes that a set-up lacks
EXPECTED = 0.02  # probability that noise adds a pole that other set-ups predict
OPEN = 0.4  # largest deviation of such a pole's frequency in bandwidths, and of its ln zeta
PREDICTED = 3.0, 0.4  # largest distance from its place: in scatters of ln f between set-ups; in ln zeta


class Track(NamedTuple):
    """One mode over the set-ups: the mean, its frequencies [Hz], and the reasons why it is doubtful."""

    found: Found
    freqs: FloatArray
    reason: str


class Tracks(NamedTuple):
    """Modes of several set-ups, each once, ascending; and the set-ups with the modes of the second search."""

    parts: list[SetUp]
    tracks: list[Track]

    @property
    def shift(self) -> float:
        """Standard deviation of ln frequency between set-ups."""
        spread = [float(np.var(np.log(track.freqs), ddof=1)) for track in self.tracks if len(track.freqs) > 1]
        return float(np.sqrt(np.mean(spread))) if spread else 0.0

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on a test with several set-ups."""
        if not self.tracks:
            return ()
        most = max(len(track.freqs) for track in self.tracks)
        return (
            f"peaks lie at different frequencies in {most} groups of channels (a roving mass, a moved hammer): each was"
            f" identified alone. Frequencies are means; they differ by {100.0 * self.shift:.2g} % (standard"
            " deviation), and sigma is what one more set-up would show",
        )

    def modes(self, sensors: Sensors) -> list[Mode]:
        """Modes with the verdict of all set-ups."""
        return [replace(mode_of(track.found, sensors), reason=track.reason) for track in self.tracks]


def tracked(alone: list[SetUp], grid: SensorGrid, circle: Circle | None, rules: Thresholds = USUAL) -> Tracks:
    """Match the modes of the set-ups, search again for missing ones, and average."""
    channels = [part.channels for part in alone]
    for look in range(LOOKS + 1):
        members = [_members(part, rules) for part in alone]
        match = matching(members, Shapes.of(members, channels, grid, circle))
        if look < LOOKS:
            alone = [_searched(part, _expected(match, members, s), match, rules) for s, part in enumerate(alone)]
    clear = _clear(match, members)
    tracks = [_track(k, match, members, channels, clear[k], rules) for k in range(len(match.rows))]
    return Tracks(alone, sorted(tracks, key=lambda track: track.found.freq))


def _members(part: SetUp, rules: Thresholds) -> list[Member]:
    found = []
    for fit in part.fits:
        poles = found_in(fit, part.data.noise, rules)
        found += [Member(pole, why) for pole, why in zip(poles, reasons(fit, [1.0] * len(fit), rules), strict=True)]
    return sorted(found, key=lambda member: member.found.freq)


def _expected(match: Matching, members: list[list[Member]], setup: int) -> Array:
    """Start values of poles [rad/s] for a set-up that lacks modes which other set-ups show."""
    starts = []
    for number, (row, middle) in enumerate(zip(match.rows, match.middle, strict=True)):
        if row[setup] < 0 and not _of_a_neighbour(match, number):
            freq = np.exp(middle + match.shifts.at(setup, middle))
            zeta = np.exp(np.mean([np.log(members[s][k].found.zeta) for s, k in enumerate(row) if k >= 0]))
            starts.append(2.0 * np.pi * freq * (-zeta + 1j * np.sqrt(1.0 - zeta**2)))
    return np.array(starts, complex)


def _neighbours(match: Matching, number: int) -> list[Row]:
    """Rows of other modes so near that members may be exchanged between them."""
    near = np.abs(match.middle - match.middle[number]) < PREDICTED[0] * match.scatter
    return [match.rows[k] for k in np.flatnonzero(near).tolist() if k != number]


def _of_a_neighbour(match: Matching, number: int) -> bool:
    """Whether a pole of one set-up may belong to a nearby mode that only the other set-ups show."""
    own = [s for s, k in enumerate(match.rows[number]) if k >= 0]
    rows = _neighbours(match, number)
    return len(own) == 1 and any(row[own[0]] < 0 and sum(k >= 0 for k in row) > 1 for row in rows)


def _too_many(match: Matching, number: int) -> bool:
    """Whether a missing mode of a set-up lies among more nearby modes than any set-up shows.

    Modes of less than half of the set-ups do not count: they are doubtful anyway.
    """
    own = match.rows[number]
    rows = [row for row in (own, *_neighbours(match, number)) if 2 * sum(k >= 0 for k in row) > len(row)]
    return min(own) < 0 and len(rows) > int(np.sum(np.array(rows) >= 0, axis=0).max())


def _searched(part: SetUp, starts: Array, match: Matching, rules: Thresholds) -> SetUp:
    """Search a set-up again at the poles that other set-ups predict; keep those that its data determine."""
    low, high = 2.0 * np.pi * part.data.freq[[0, -1]]
    starts = starts[(starts.imag > low) & (starts.imag < high)]
    if not len(starts):
        return part
    lax = replace(rules, chance=EXPECTED, same_shape=1.1, known_freq=OPEN, known_zeta=OPEN)
    both = part.modes.with_poles(starts)
    fits = []
    for group in groups(both.poles, part.data.step, rules):
        fresh = group[np.isin(both.poles[group], starts)]
        fit = fitted_group(part.data, both, group, False if len(fresh) else None, lax if len(fresh) else rules)
        if len(fresh) and not _at_their_places(fit, both.poles[fresh], match.scatter):
            kept = np.setdiff1d(np.arange(len(both.poles)), fresh)
            there = np.flatnonzero(np.isin(kept, group))
            if not len(there):
                continue
            fit = fitted_group(part.data, both.without(fresh), there, None, rules)
        fits.append(fit)
    return part._replace(fits=fits)


def _at_their_places(fit: PoleFit, starts: Array, scatter: float) -> bool:
    """Whether a pole was found at each predicted place."""
    free = list(range(len(fit)))
    for start in starts:
        off = [
            max(
                abs(np.log(fit.poles[k].imag / start.imag)) / (PREDICTED[0] * scatter + 1e-9),
                abs(np.log(fit.poles[k].real / start.real)) / PREDICTED[1],
            )
            for k in free
        ]
        if not off or min(off) > 1.0:
            return False
        free.pop(int(np.argmin(off)))
    return True


def _clear(match: Matching, members: list[list[Member]]) -> list[list[bool]]:
    """For each row the set-ups that show its mode separately.

    A set-up that lacks another mode within a bandwidth does not count: its pole may represent both.
    """
    clear = [[k >= 0 for k in row] for row in match.rows]
    for i, row in enumerate(match.rows):
        for s, k in enumerate(row):
            if k < 0:
                continue
            found = members[s][k].found
            for j, other in enumerate(match.rows):
                if other[s] >= 0 or sum(each >= 0 for each in other) < 2:
                    continue
                expected = match.middle[j] + match.shifts.at(s, match.middle[j])
                if abs(np.log(found.freq) - expected) < 2.0 * found.zeta + match.scatter:
                    clear[i][s] = False
    return [mine if any(mine) else [k >= 0 for k in row] for mine, row in zip(clear, match.rows, strict=True)]


def _track(
    number: int, match: Matching, members: list[list[Member]], parts: list[IntArray], clear: list[bool],
    rules: Thresholds,
) -> Track:  # fmt: skip
    """Mean of a row with equal weights of its set-ups, since each set-up shifts the frequency."""
    row = match.rows[number]
    some = [(s, members[s][k]) for s, k in enumerate(row) if k >= 0]
    used = [(s, member) for s, member in some if clear[s]]
    found = [member.found for _, member in used]
    freqs = np.array([member.found.freq for _, member in some])
    count, whole = len(used), len(row)
    logs = np.log([each.freq for each in found])
    common = np.mean([match.shifts.at(s, logs.mean()) for s, _ in used])  # zero where all set-ups are used
    freq = float(np.exp(logs.mean() - common))
    own = float(np.sqrt(np.sum([each.sigma_freq**2 for each in found]))) / count
    lacking = match.scatter * freq * float(np.sqrt((whole - count) / (whole * count)))
    unclear = freq * float(np.sqrt(match.unclear[number]))
    weights = np.array([each.sigma_zeta for each in found]) ** -2.0
    zeta = float(weights @ [each.zeta for each in found] / weights.sum())
    scatter = float(np.sum(weights * (np.array([each.zeta for each in found]) - zeta) ** 2)) / max(count - 1, 1)
    sigma_zeta = float(np.sqrt(max(scatter, 1.0) / weights.sum()))
    mean = Found(
        freq, float(np.linalg.norm([own, lacking, unclear])), zeta, sigma_zeta, _residues(some, parts),
        max(each.signal for each in found), max(each.split_bound for each in found),
    )  # fmt: skip
    share = own / (2.0 * zeta * freq)
    own_logs = np.log(freqs) - [float(match.shifts.at(s, logs.mean())) for s, _ in some]
    why = _reasons(some, whole, share, rules) + _exchanged(match, number, own_logs)
    if _too_many(match, number):
        why.append(
            "there are more modes nearby than any set-up shows: are two of them one? Give the sensors' angles, or"
            " measure in one set-up"
        )
    return Track(mean, freqs, "; ".join(why))


def _residues(some: list[tuple[int, Member]], parts: list[IntArray]) -> Residues:
    """Residues of a row at all channels, 0 where the row has none."""
    channels = sum(len(part) for part in parts)
    values, direct, moved = np.zeros(channels, complex), np.zeros(channels), []
    for setup, member in some:
        residues, at = member.found.residues, parts[setup]
        values[at], direct[at] = residues.values, residues.direct
        each = np.zeros((channels, residues.moved.shape[1]), complex)
        each[at] = residues.moved
        moved.append(each)
    return Residues(values, direct, np.concatenate(moved, axis=1))


def _exchanged(match: Matching, number: int, logs: FloatArray) -> list[str]:
    """Reason why two modes may be exchanged between set-ups; `logs` are ln f without the common shifts.

    A mode without another mode within its own spread cannot be exchanged.
    """
    spread = float(np.std(logs, ddof=1)) if len(logs) > 1 else 0.0
    other = np.delete(np.abs(match.middle - match.middle[number]), number).min(initial=np.inf)
    if spread <= UNLIKE * match.scatter or other > UNLIKE * spread:
        return []
    return [
        f"its frequency differs by {100.0 * spread:.2g} % between set-ups beyond their common shift, other modes' by"
        f" {100.0 * match.scatter:.2g} %: two modes exchanged? Give the sensors' angles, or measure in one set-up"
    ]


def _reasons(some: list[tuple[int, Member]], whole: int, share: float, rules: Thresholds) -> list[str]:
    """Reasons why a mode is doubtful; `share` is the deviation of its mean frequency in bandwidths."""
    reasons, count = [], len(some)
    if 2 * count <= whole:
        reasons.append(f"it is seen in {count} of {whole} set-ups: a local mode, or one that two share? Measure again")
    if share > rules.sure_freq:
        reasons.append(
            f"the mean of its frequencies is known to {100.0 * share:.0f} % of its bandwidth only: measure longer, or"
            " more averages"
        )
    own = [member.reason for _, member in some if member.reason]
    return reasons + (own[:1] if len(own) == count else [])  # one set-up that shows it clearly is enough
