"""Axes in kHz and kN where their numbers reach ten thousand Hz or N."""

from typing import Any

from matplotlib.ticker import FuncFormatter

LEAST = 1e4  # of an axis: from here on its numbers are thousands
UNITS = ("Hz", "N")


class Thousands(FuncFormatter):
    """Tick labels in thousands of the axis' unit; the data stay in the unit."""

    def __init__(self) -> None:
        super().__init__(lambda value, _: f"{1e-3 * value:g}".replace("-", "\N{MINUS SIGN}"))


def in_thousands(axis: Any, *beside: Any) -> None:
    """Label a linear axis in [Hz] or [N] that reaches LEAST in [kHz] or [kN], with the axes `beside` of its quantity.

    `casingfem.plot.style.styled` does so for every axis of a figure.

    >>> from matplotlib.figure import Figure
    >>> axes = Figure().add_subplot(xlim=(0.0, 2e4), xlabel="frequency [Hz]", ylim=(0.0, 900.0), ylabel="force [N]")
    >>> in_thousands(axes.xaxis)
    >>> in_thousands(axes.yaxis)
    >>> axes.get_xlabel(), axes.xaxis.get_major_formatter()(12500.0), axes.get_ylabel()
    ('frequency [kHz]', '12.5', 'force [N]')
    """
    name = axis.get_label_text()
    unit = next((unit for unit in UNITS if f"[{unit}]" in name), None)
    if unit is None or axis.get_scale() != "linear" or max(abs(end) for end in axis.get_view_interval()) < LEAST:
        return
    axis.set_label_text(name.replace(f"[{unit}]", f"[k{unit}]"))
    for one in (axis, *beside):
        one.set_major_formatter(Thousands())


def shown_factor(axis: Any) -> float:
    """Factor from the data of an axis to the numbers of its labels."""
    return 1e-3 if isinstance(axis.get_major_formatter(), Thousands) else 1.0
