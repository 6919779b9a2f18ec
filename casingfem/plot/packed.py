"""Numbers as a page's scripts read them: small integers and a scale, in base64."""

import base64
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

SIXTEEN, EIGHT = 32767, 127


def packed(values: ArrayLike, *, most: float | None = None, bits: int = 16) -> dict[str, Any]:
    """Values as integers of so many bits, little-endian, and what their largest is worth; `most` if that is given.

    >>> packed([0.5, -1.0, 0.25])
    {'data': '/z8BgP8f', 'most': 1.0}
    """
    array = np.asarray(values, dtype=float)
    worth = float(np.abs(array).max(initial=0.0)) if most is None else most
    whole = SIXTEEN if bits == 16 else EIGHT
    steps = np.clip(np.trunc(whole / (worth or 1.0) * array), -whole, whole)
    return {"data": coded(steps.astype("<i2" if bits == 16 else "i1")), "most": worth}


def coded(array: np.ndarray[Any, Any]) -> str:
    """The bytes of an array in base64."""
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode("ascii")


def island(script: str, data: Mapping[str, Any] | list[Any], inside: str = "") -> str:
    r"""The element that a script of this name finds, with its data; `inside` shows where scripts do not run.

    >>> island("shapes", {"a": "</script>"})
    '<div class="live" data-live="shapes"><script type="application/json">{"a":"\\u003c/script>"}</script></div>'
    """
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
    return f'<div class="live" data-live="{script}"><script type="application/json">{text}</script>{inside}</div>'
