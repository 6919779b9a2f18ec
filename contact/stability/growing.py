"""Growth of closed contact over speed, and a description of the growing motion, from the poles at the peaks.

A wave that the blade overtakes can satisfy f_c + f_b = n f, where both motions grow without friction. If the blade
overtakes no wave, closed contact grows only with friction.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from contact.base.arrays import Array
from contact.io.threads import with_one_thread
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.permanent import ClosedContact
from contact.stability.growth_map import StabilityMap, ascending
from contact.stability.peaks import Peak, growth_map, peaks_of
from contact.stability.split_casing import AVERAGED, mean_contact
from contact.stability.waves import waves_of

AT_REST = 1e-6  # of the frequency in the casing's frame: a slower motion is at rest in the blade's


@with_one_thread
def of_contact(contact: ClosedContact, speed_hz: Array) -> StabilityMap:
    """Growth map of a perfect casing; its text describes the growing motion in each unstable band.

    Raises InputError unless there are at least two ascending speeds [turns/s].

    >>> from contact.model.gaps.permanent import HandPair, ModalPair
    >>> pair = HandPair(casing=ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
    ...                 blade=ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)
    >>> of_contact(pair.contact(), np.linspace(40.0, 50.0, 11)).words
    'Closed contact is stable from 40 to 50 Hz (2,400 to 3,000 rpm): nothing grows.'
    """
    found = growth_map(contact, ascending(speed_hz))
    words = [
        _verdict(found),
        *_motions(contact, found),
        *_without_friction(contact, found),
        *_overtakes(contact, found),
    ]
    return replace(found, words=" ".join(words))


@with_one_thread
def of_rim(rim: RotatingRim, speed_hz: Array, *, mu: float = 0.0) -> StabilityMap:
    """Growth map of a rim against its blade in closed contact; the rim's own speed is not used.

    Split pairs of the casing are replaced by their mean, as for the peaks of `ct.interactions`. Its runs have the split
    pairs. `ct.stability.floquet_growth` has the exact growth of a split casing at single speeds.

    >>> import contact as ct
    >>> casing = ct.gaps.pair_rim(ct.gaps.ModalPair(n=2, freq_hz=100.0, modal_mass=1.0), radius=0.5)
    >>> seen = {"channels": ("span", "flap"), "rows": [[0.0], [1.0]], "S": 1e-8 * np.eye(2)}
    >>> rim = ct.RotatingRim(casing, ct.ModalBody(omega=[900.0], zeta=[0.01], **seen), clearance=0.0, speed_hz=5.0)
    >>> of_rim(rim, np.array([20.0, 21.0]), mu=0.1).diverges
    True
    """
    contact, averaged = mean_contact(rim, mu=mu)
    found = of_contact(contact, speed_hz)
    if not averaged:
        return found
    return replace(found, words=f"{found.words} {AVERAGED} `casingfem interactions` runs the scene with split pairs.")


def _verdict(found: StabilityMap) -> str:
    """Whether closed contact is stable over the range, or the unstable bands."""
    span = _span(float(found.speed_hz[0]), float(found.speed_hz[-1]))
    if not found.diverges:
        return f"Closed contact is stable from {span}: nothing grows."
    bands = ", ".join(f"from {_span(*band)}" for band in found.bands_hz)
    return f"Closed contact is unstable {bands}."


def _span(low: float, high: float) -> str:
    return f"{low:.5g} to {high:.5g} Hz ({60.0 * low:,.5g} to {60.0 * high:,.5g} rpm)"


def _rate(growth: float, speed_hz: float) -> str:
    return f"{growth:.4g} 1/s at {speed_hz:.5g} Hz ({60.0 * speed_hz:,.5g} rpm)"


def _motions(contact: ClosedContact, found: StabilityMap) -> list[str]:
    """The growing motions at all peaks, the highest first."""
    if not found.diverges:
        return []
    rows = sorted(peaks_of(contact, found), key=lambda peak: -peak.growth)
    return [sentence for peak in rows for sentence in _motion(peak)]


def _motion(peak: Peak) -> list[str]:
    """The growing motion at one peak: shape, energy and frequencies."""
    travels = "stands" if peak.wave == "standing" else f"travels {peak.wave} the direction of the blade"
    grows = f"n = {peak.n} grows by {_rate(peak.growth, peak.speed_hz)} and {travels}."
    share = f"The casing has {100.0 * peak.casing_share:.0f} % of the energy."
    if peak.wave == "standing":
        return [grows, share, f"The blade vibrates at {peak.freq_hz:.4g} Hz."]
    turned = f"n f = {peak.n * abs(peak.speed_hz):.4g} Hz"
    if peak.freq_hz < AT_REST * peak.casing_hz:
        return [grows, share, f"It is at rest in the blade's frame, f_c = {turned}."]
    frames = f"f_c = {peak.casing_hz:.4g} Hz in the casing's frame and f_b = {peak.freq_hz:.4g} Hz in the blade's"
    if peak.overtaken:
        return [grows, share, f"It has {frames}: f_c + f_b = n f. The blade overtakes the wave, {turned} > f_c."]
    sign = "-" if peak.wave == "with" else "+"
    return [grows, share, f"It has {frames}: f_b = f_c {sign} n f, {turned}."]


def _without_friction(contact: ClosedContact, found: StabilityMap) -> list[str]:
    """Growth of the same contact without friction, if a motion grows with friction."""
    if not found.diverges or not contact.mu > 0.0:
        return []
    calm = growth_map(replace(contact, mu=0.0), found.speed_hz)
    if not calm.diverges:
        return ["Without friction nothing grows in this range."]
    return [f"Without friction the highest growth is {_rate(calm.peak_growth, calm.peak_speed_hz)}."]


def _overtakes(contact: ClosedContact, found: StabilityMap) -> list[str]:
    """Whether the blade overtakes no wave of the casing in the range, and the wave nearest to that."""
    nearest = (0.0, 0.0, 0.0)  # n f/f_c, n f, f_c
    for sense in (1.0, -1.0):
        omega = 2.0 * math.pi * found.speed_hz[found.speed_hz * sense > 0.0]
        free = waves_of(contact).poles(omega, sense) if omega.size else None
        if free is None:
            continue
        waves = free.casing & (free.sign > 0.0) & (free.order * sense > 0.0)
        turned, own = np.multiply.outer(omega, free.order)[:, waves], free.own(omega)[:, waves]
        if not own.size:
            continue
        k = np.unravel_index(int((turned / own).argmax()), own.shape)
        turn = 2.0 * math.pi
        nearest = max(nearest, (float(turned[k] / own[k]), float(turned[k]) / turn, float(own[k]) / turn))
    ratio, turned_hz, casing_hz = nearest
    if not 0.0 < ratio < 1.0:
        return []
    below = f"n f = {turned_hz:.4g} Hz < f_c = {casing_hz:.4g} Hz"
    return [f"The blade overtakes no wave of the casing in this range: {below}.", "f_c + f_b = n f cannot be met."]
