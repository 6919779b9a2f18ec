"""Stability of a rotor over its speed: internal damping and cross-coupled bearings."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from contact.base.arrays import Array
from contact.io.threads import with_one_thread
from contact.model.rotor.rotor import Rotor
from contact.model.rotor.whirl import growth, modes_at, sense_of
from contact.stability.closed_contact import FLOOR
from contact.stability.growth_map import StabilityMap, ascending, scan
from contact.stability.peaks import Peak, Peaks

WHIRLS = 8  # whirl frequencies of a picture


@with_one_thread
def of_rotor(rotor: Rotor, speed_hz: Array) -> StabilityMap:
    """Largest growth of a rotor's free motion over speed, with the edges of the unstable bands as roots.

    Raises InputError unless there are at least two ascending speeds [turns/s].

    >>> import numpy as np
    >>> from contact.model.rotor import Jeffcott
    >>> rotor = Rotor.of(Jeffcott(mass=1.0, stiffness=100.0, zeta=0.02, zeta_internal=0.01), 1.0)
    >>> found = of_rotor(rotor, np.linspace(0.0, 10.0, 21))
    >>> f"{2.0 * np.pi * found.bands_hz[0][0]:.4f} rad/s"  # 10 rad/s (1 + 0.02/0.01)
    '30.0000 rad/s'
    """
    floor = FLOOR * max(float(rotor.body.omega.max(initial=0.0)), 1.0)
    found = scan(lambda at: growth(rotor, at), ascending(speed_hz), floor=floor)
    if not found.diverges:
        words = f"The rotor is stable from {found.speed_hz[0]:.5g} to {found.speed_hz[-1]:.5g} Hz."
    else:
        low, high = found.bands_hz[0]
        words = f"The free motion grows from {low:.6g} to {high:.6g} Hz ({60.0 * low:,.5g} to {60.0 * high:,.5g} rpm)."
    return replace(found, words=words)


def rotor_peaks(rotor: Rotor, speed_hz: Array) -> Peaks:
    """Peaks of the growth of a rotor without contact, one in each unstable band, and its whirl frequencies.

    >>> from contact.model.rotor import Jeffcott
    >>> rotor = Rotor.of(Jeffcott(mass=1.0, stiffness=100.0, zeta=0.02, zeta_internal=0.01), 1.0)
    >>> (peak,) = rotor_peaks(rotor, np.linspace(1.0, 6.0, 11)).rows
    >>> peak.wave, round(2.0 * np.pi * peak.freq_hz, 2), round(2.0 * np.pi * peak.from_hz, 2)
    ('forward', 10.0, 30.0)
    """
    found = of_rotor(rotor, speed_hz)
    rows = []
    for low, high in found.bands_hz:
        inside = (found.seen_hz >= low) & (found.seen_hz <= high)
        at = float(found.seen_hz[inside][found.seen_growth[inside].argmax()]) if inside.any() else 0.5 * (low + high)
        s, shape = modes_at(rotor, 2.0 * math.pi * at)
        k = int(s.real.argmax()) if s.size else 0
        sense = sense_of(rotor, shape[:, k : k + 1])[0] if s.size else "planar"
        rows.append(
            Peak(speed_hz=at, growth=float(growth(rotor, at)[0]), from_hz=low, to_hz=high, n=1, wave=sense,
                 casing_share=0.0, freq_hz=float(s[k].imag) / (2.0 * math.pi) if s.size else 0.0, overtaken=False)
        )  # fmt: skip
    each = [modes_at(rotor, 2.0 * math.pi * hz)[0].imag / (2.0 * math.pi) for hz in found.speed_hz.tolist()]
    kept = min(WHIRLS, *(len(one) for one in each))
    return Peaks(
        rows=tuple(rows), map=found, averaged=False, blade_hz=(), rotor=True,
        wave_hz=np.array([one[:kept] for one in each]),
    )  # fmt: skip
