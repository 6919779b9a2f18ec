"""Numbers of identified modes to hold: columns, shapes, residues, responses, and the numbers in notes and reasons."""

import numpy as np

from tests.probed import numbers_in, numbers_of_notes, probed


def numbers_of_modes(found):
    """Columns for `held`; signs of shapes and residues are fixed, since the largest entry of a shape is positive."""
    columns = {str(name): np.asarray(column) for name, column in found.columns().items()}
    numeric = {name: column for name, column in columns.items() if column.dtype.kind in "iufb" and column.size}
    there = ~np.isnan(found.fitted).any(axis=0)
    return {
        **numeric,
        "residue_scale": found.residue_scale,
        "size": [len(found), found.shift, found.deviation, *np.ravel(found.doublets), *found.unresolved],
        "sensors": list(numbers_in(found.sensors)),
        "residues": np.concatenate([probed(found.residues[:, :, k]) for k in range(len(found))], axis=None),
        "shapes": probed(found.shapes),
        "sigma_shapes": probed(found.sigma_shapes),
        "lines": [found.lines[0], found.lines[-1], len(found.lines), np.count_nonzero(there)],
        "responses": [np.linalg.norm(part[:, there]) for part in (found.fitted, found.measured)],
        "words": numbers_of_notes(*found.notes, *found.doubtful()),
    }
