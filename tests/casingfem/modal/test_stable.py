"""What is too little below zero to tell a turning structure from a free one."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.linalg.eigen import EigenResult
from casingfem.modal.mesh_modes import require_stable


def test_round_off_of_a_rigid_motion_is_no_instability():
    """Two masses of 2 on a spring of 1: x = (1/2, 1/2), |x|^T |K| |x| = 1, so round-off is one unit."""
    K, unit = np.array([[1.0, -1.0], [-1.0, 1.0]]), np.finfo(float).eps

    def lowest(value):
        return EigenResult(np.array([value]), np.full((2, 1), 0.5), None)

    for value in (-0.99 * unit, 0.0, 1.0):
        require_stable(K, lowest(value))
    with pytest.raises(
        cf.errors.ModelError, match=r"modes: found omega\^2 = -2.243e-16 rad\^2/s\^2 here: .*rotation-unstable"
    ):
        require_stable(K, lowest(-1.01 * unit), " here")
    require_stable(K, EigenResult(np.zeros(0), np.zeros((2, 0)), 0))
