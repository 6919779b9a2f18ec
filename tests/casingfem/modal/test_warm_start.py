"""Modes restarted from those of a neighbour, on a plate: right, counted, and refused where they cannot be."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.modal.neighbour import guarded, restarted_modes


def plate(nu=0.3, order=4):
    return cf.Shell(
        chart=cf.Plate(length=0.2, width=0.07), thickness=3e-3, material=cf.Material(E=210e9, nu=nu, rho=7800.0),
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=order, rows=1, around=1),
    )  # fmt: skip


@pytest.fixture(scope="module")
def known():
    return cf.modes(plate(), guarded(4), method="shell")


def test_a_restart_is_complete_and_right(known):
    found = restarted_modes(plate(0.32), known, 4)
    np.testing.assert_allclose(found.freq, cf.modes(plate(0.32), 4, method="shell").freq, rtol=1e-7)
    assert found.sturm_count == len(found) == 4
    assert found.dofs == known.dofs
    assert found.shell.material.nu == 0.32
    assert set(found.seconds) == {"assemble", "solve", "label"}
    assert all(0.0 <= spent < 100.0 for spent in found.seconds.values())


def test_a_restart_needs_four_modes_more_than_it_gives_on_the_same_mesh(known):
    few = cf.modes(plate(), 8, method="shell")
    np.testing.assert_allclose(restarted_modes(plate(0.31), few, 4).freq, cf.modes(plate(0.31), 4).freq, rtol=1e-6)
    words = "a restart of 5 modes needs 9 or more, of a shell on the same mesh"
    with pytest.raises(ValueError, match=words):
        restarted_modes(plate(0.31), few, 5)
    with pytest.raises(ValueError, match="a restart of 4 modes needs 8 or more"):
        restarted_modes(plate(order=3), known, 4)


def test_a_mode_that_the_start_does_not_hold_is_missed_in_the_count(known):
    """All but the lowest, and no steps that would find it."""
    rest = replace(known, freq=known.freq[1:], fields=known.fields[:, :, 1:], own=known.own[:, 1:])
    with pytest.raises(cf.errors.NumericsError, match=r"5 modes lie below [\d.]+ Hz, 4 were found"):
        restarted_modes(plate(), rest, 4, steps=0)
    found = restarted_modes(plate(), known, 4, steps=0)
    np.testing.assert_allclose(found.freq, known.freq[:4], rtol=1e-9)
