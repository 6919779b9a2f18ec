"""Force-depth laws as step loops call them: (depth [m], rate [m/s], values) -> (force [N], slope [N/m]), depth > 0.

Plain functions of numbers, which Python calls too.
"""

from __future__ import annotations

from contact.base.arrays import Array


def spring(depth: float, rate: float, values: Array) -> tuple[float, float]:
    """Linear spring and dashpot, force = k depth + c rate; `values` k [N/m], c [N s/m]."""
    return values[0] * depth + values[1] * rate, values[0]


def hertz(depth: float, rate: float, values: Array) -> tuple[float, float]:
    """Force = k depth^p (1 + a rate) (Hertz; Hunt, Crossley, J. Appl. Mech. 42, 1975, 440); `values` k, p, a [s/m]."""
    force = values[0] * depth ** values[1] * (1.0 + values[2] * rate)
    return force, values[1] * force / depth


def table(depth: float, rate: float, values: Array) -> tuple[float, float]:
    """Straight lines between points, the last goes on; `values` depths from 0 [m], then as many forces [N]."""
    n = values.size // 2
    low, high = 0, n - 1
    while high - low > 1:
        middle = (low + high) // 2
        if values[middle] <= depth:
            low = middle
        else:
            high = middle
    slope = (values[n + high] - values[n + low]) / (values[high] - values[low])
    return values[n + low] + slope * (depth - values[low]), slope
