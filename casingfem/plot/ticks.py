"""Tick labels with powers of ten in plain characters, since mathematical type takes ten times as long to draw."""

import re
from typing import Any

from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, ScalarFormatter

from casingfem.plot.page import raised

NARROW = 100.0  # ratio of both ends of an axis under which its labels are plain numbers
SHORT, FEW = 5.0, 3  # the same for which two of 1, 2, 5, 10 may not fit, and the most intervals of its labels then
POWER = re.compile(r"1e-?\d+")


class Powers(ScalarFormatter):
    """Numbers with a common power of ten for the whole axis if they are outside 10^low and 10^high."""

    def __init__(self, low: int, high: int) -> None:
        super().__init__(useMathText=False)
        self.set_powerlimits((low, high))

    def get_offset(self) -> str:
        """The power of ten in the usual notation.

        >>> ticks = Powers(-3, 4)
        >>> from matplotlib.figure import Figure
        >>> axes = Figure().add_subplot(ylim=(0.0, 4e-5))
        >>> axes.yaxis.set_major_formatter(ticks)
        >>> ticks.format_ticks([0.0, 2e-5, 4e-5]), ticks.get_offset()
        (['0', '2', '4'], '×10⁻⁵')
        """
        text = str(super().get_offset())
        plain = text.replace("\N{MINUS SIGN}", "-")
        return f"×{raised(plain)}" if POWER.fullmatch(plain) else text


def label_decades(axis: Any) -> None:
    """Label the decades of a logarithmic axis; of an axis under two decades 1, 2 and 5 of each, as plain numbers.

    An axis that is too short for two of these has a few equally spaced numbers.

    >>> from matplotlib.figure import Figure
    >>> axes = Figure().add_subplot(yscale="log", ylim=(1e-5, 1.0))
    >>> label_decades(axes.yaxis)
    >>> axes.yaxis.get_major_formatter()(1e-3), len(axes.yaxis.get_minorticklocs())
    ('10⁻³', 0)
    >>> narrow = Figure().add_subplot(yscale="log", ylim=(0.04, 2.0))
    >>> label_decades(narrow.yaxis)
    >>> narrow.yaxis.get_major_formatter().format_ticks(narrow.get_yticks())[2:7]
    ['0.05', '0.1', '0.2', '0.5', '1']
    >>> short = Figure().add_subplot(yscale="log", ylim=(1.05, 3.1))
    >>> label_decades(short.yaxis)
    >>> [float(at) for at in short.get_yticks() if 1.05 < at < 3.1]
    [2.0, 3.0]
    """
    axis.minorticks_off()
    low, high = sorted(axis.get_view_interval())
    if high < NARROW * low:
        few = high < SHORT * low
        axis.set_major_locator(MaxNLocator(FEW, steps=[1, 2, 5, 10]) if few else LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        return
    axis.set_major_formatter(FuncFormatter(lambda value, _: raised(f"{value:.0e}")))
