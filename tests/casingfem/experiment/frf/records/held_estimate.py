"""Numbers of estimated frequency responses to hold."""

import numpy as np

from tests.probed import numbers_of_notes, probed


def numbers_of_estimate(found):
    """Columns of an estimate: responses and coherence at some lines, channels, hits, notes and the block shown."""
    frfs, step = found.frfs, max(1, len(found.frfs.x) // 29)
    columns = {
        "x": frfs.x[[0, 1, -1]],
        "H": frfs.responses[:, ::step],
        "places": [frfs.response_point, frfs.response_direction, frfs.reference_point, frfs.reference_direction],
        "averages": [found.averages, found.left, len(found.kept)],
        "hits": [x for hit in found.hits for x in (hit.time, hit.peak, hit.width, hit.left, bool(hit.fault))],
        "notes": numbers_of_notes(*found.notes, *frfs.card, *(hit.fault for hit in found.hits)),
        "rows": [value for row in found.records() for value in row.values() if isinstance(value, int | float)],
    }
    if found.coherence is not None:
        columns["coherence"] = found.coherence.responses.real[:, ::step]
    if found.shown is not None:
        columns["shown"] = np.array([probed(np.atleast_2d(part)) for part in found.shown])
    return columns
