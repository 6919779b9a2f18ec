"""A stabilisation diagram in which the reader chooses poles, and every channel with its fit (`scripts/poles.js`)."""

from typing import Any

import numpy as np

from casingfem.experiment.identify.identified import Identified
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.plot.identify import indicator
from casingfem.plot.page import Picture, coded, island, packed

MOST_LINES = 3000  # of a curve; a longer one shows the largest value of each group of lines
MOST_VALUES = 400_000  # lines times channels
TINY = 1e-300


def picking_diagram(found: Identified, name: str, caption: str, still: Picture, *, pick: bool) -> Picture:
    """The diagram of responses in a file of this name; `still` is shown if scripts do not run.

    With `pick`, clicks choose poles, and a button saves them as the table for `casingfem identify --pick`.
    """
    curves = indicator(found)
    at = drawn_lines(curves[0])
    channels = drawn_channels(found, len(at))
    diagram = found.diagram
    there = ~np.isnan(found.fitted[:, at]).any(axis=0)
    data: dict[str, Any] = {
        "name": name,
        "pick": pick,
        "unit": "",
        "lines": coded(found.lines[at].astype("<f4")),
        "curves": [packed(logarithm(curve[at])) for curve in curves],
        "freq": coded(diagram.freq.astype("<f4")),
        "zeta": coded(diagram.zeta.astype("<f4")),
        "order": coded(np.clip(diagram.order, 0, 255).astype("u1")),
        "stable": coded(diagram.stable.astype("u1")),
        "fit": coded(there.astype("u1")),
        "modes": [
            {"freq": float(f"{freq:.8g}"), "zeta": float(f"{zeta:.5g}"), "sure": sure}
            for freq, zeta, sure in zip(found.freq.tolist(), found.zeta.tolist(), found.sure.tolist(), strict=True)
        ],
        "channels": [channel(found, k, at) for k in channels.tolist()],
    }
    left = len(found.measured) - len(channels)
    more = f" The {len(channels)} strongest of {len(found.measured)} channels are shown." if left else ""
    part = f" {len(at)} of {len(found.lines)} lines are drawn, with those at the peaks." if len(at) < len(
        found.lines) else ""  # fmt: skip
    return Picture(island("poles", data, f'<div class="still">{still.html}</div>'), caption + more + part, ("poles",))


def drawn_lines(curve: FloatArray) -> IntArray:
    """Lines to draw: from each group the one with the largest value of a curve, and the ends.

    >>> drawn_lines(np.ones(10)).tolist()
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]
    """
    every = -(-len(curve) // MOST_LINES)
    starts = np.arange(0, len(curve), every)
    best = [int(start + np.argmax(curve[start : start + every])) for start in starts.tolist()]
    return np.unique([0, *best, len(curve) - 1])


def drawn_channels(found: Identified, lines: int) -> IntArray:
    """Channels to draw: all, or the strongest, in the order of the set."""
    most = max(1, MOST_VALUES // max(lines, 1))
    strength = np.linalg.norm(found.measured, axis=1)
    return np.sort(np.argsort(-strength, kind="stable")[:most])


def channel(found: Identified, k: int, at: IntArray) -> dict[str, Any]:
    """Name, magnitudes and phases of a channel and of its fit."""
    sensor, force = np.argwhere(found.sensors.channels == k)[0].tolist()
    point, direction = int(found.sensors.points[sensor]), int(found.sensors.directions[sensor])
    reference = int(found.sensors.references[force, 0])
    measured, fitted = found.measured[k, at], np.nan_to_num(found.fitted[k, at])
    return {
        "name": f"point {point}{f', direction {direction:+d}' if direction else ''}, reference {reference}",
        "size": packed(logarithm(measured)),
        "fitted": packed(logarithm(fitted)),
        "phase": packed(degrees(measured), most=180.0, bits=8),
        "turned": packed(degrees(fitted), most=180.0, bits=8),
    }


def logarithm(values: Array) -> FloatArray:
    """Decimal logarithm of magnitudes; 0 is replaced by the smallest other one."""
    size = np.abs(values)
    least = float(size[size > 0.0].min(initial=1.0)) if np.any(size > 0.0) else 1.0
    return np.asarray(np.log10(np.maximum(size, max(least, TINY))))


def degrees(values: Array) -> FloatArray:
    """Phases [deg]."""
    return np.asarray(np.degrees(np.angle(values)))
