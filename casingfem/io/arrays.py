"""Array types shared by every floor.

Most arrays are real. Those that a sensitivity passes through may be complex (complex step), and are
annotated `Array`.
"""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[Any]
FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]


def frozen(values: Array) -> Array:
    """Return a read-only copy of an array, for the fields of frozen dataclasses.

    >>> frozen(np.zeros(2)).flags.writeable
    False
    """
    copy = np.array(values)
    copy.setflags(write=False)
    return copy
