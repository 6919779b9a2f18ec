"""The columns of the points of a branch; the columns of parameter and amplitudes have the scene's names."""

from __future__ import annotations

import numpy as np

from contact.cycles.shooting import Orbit
from contact.io.columns import Column, Columns, mark

Numbered = tuple[int, Orbit]  # branch, from 1, and one of its points
PARAMETERS = {
    "speed_hz": ("speed", "Hz"),
    "freq_hz": ("frequency", "Hz"),
    "amplitude": ("force", "N"),
    "clearance": ("clearance", "m"),
    "friction": ("coefficient of friction", "-"),
}
POINTS = (
    Column("branch", "Number of the branch, from 1.", lambda points: [number for number, _ in points], format="d"),
    Column("periods", "Number of forcing periods after which the motion repeats.",
           lambda points: [point.periods for _, point in points], format="d"),
    Column("multiplier", "Largest magnitude of a Floquet multiplier; above 1 the motion is unstable.",
           lambda points: [point.multiplier for _, point in points], format=".6g"),
    Column("growth_1_s", "Growth rate of a small disturbance: logarithm of the largest multiplier, divided by the "
                         "period.",
           lambda points: [point.growth for _, point in points], head="growth", unit="1/s", format=".4g"),
    Column("stable", "Whether the motion is stable.", lambda points: [point.stable for _, point in points],
           format=mark("stable")),
    Column("contacts", "Number of contacts that close.", lambda points: [point.contacts for _, point in points],
           format="d"),
    Column("closings", "Number of closings of all contacts in all periods.",
           lambda points: [sum(point.closings) for _, point in points], format="d"),
    Column("gap", "Smallest gap.", lambda points: [float(point.gap.min(initial=np.inf)) for _, point in points],
           head="least gap", unit="m", format=".4g"),
    Column("force", "Largest contact force.",
           lambda points: [float(point.force.max(initial=0.0)) for _, point in points], unit="N", format=".5g"),
)  # fmt: skip


def point_columns(parameter: str, channels: tuple[str, ...]) -> Columns:
    """The columns of a branch over this parameter, with the amplitudes of these channels."""
    head, unit = PARAMETERS.get(parameter, (parameter, ""))
    values = Column(parameter, "Parameter of the branch.", lambda points: [point.value for _, point in points],
                    head=head, unit=unit, format=".8g")  # fmt: skip
    branch, periods, *others = POINTS
    return [branch, values, periods, *map(amplitude, channels), *others]


def amplitude(channel: str) -> Column:
    """The column of the amplitude of a channel."""
    text = "Largest displacement of the channel over all periods."
    return Column(f"amplitude_{channel}", text, lambda points: [point.amplitude[channel] for _, point in points],
                  head=f"largest {channel}", unit="m", format=".6g")  # fmt: skip
