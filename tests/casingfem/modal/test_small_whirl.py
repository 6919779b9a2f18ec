"""Rotating parts of a few elements: every mode solves its quadratic problem; waves run as their shapes say."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
CHART = cf.Plate(length=0.2, width=0.06)
COUNT = 3


def blade():
    return cf.Shell(
        chart=CHART, thickness=3e-3, material=STEEL, supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=4, rows=1, around=1), rotation=cf.Rotation.of_blade(CHART, omega=400.0, hub_radius=0.3),
    )  # fmt: skip


def drum(turning=1.0):
    return cf.Shell(
        chart=cf.Cylinder(radius=0.2, height=0.1), thickness=10e-3, material=STEEL, supports={"base": cf.Clamped()},
        mesh=cf.ShellMesh(order=4, rows=1, around=7), rotation=cf.Rotation(omega=turning * 900.0),
    )  # fmt: skip


def ring(turning=1.0, **rotation):
    wall = cf.imported.revolved((0.2, 0.2), (0.0, 0.1), 0.01)
    mesh = cf.imported.grid_mesh(
        "quad9", (11, 1), lambda u: wall(np.insert(u, 0, 0.5, axis=1)), groups={"base": (1, 0.0)}, wrap=0
    )
    return cf.MeshShell(
        mesh=mesh, thickness=10e-3, material=STEEL, supports={"base": cf.Clamped()},
        rotation=cf.Rotation(omega=turning * 900.0, **rotation),
    )  # fmt: skip


PARTS = {"blade": blade, "drum": drum, "ring": ring}


@pytest.fixture(scope="module")
def found():
    return {name: cf.whirl_modes(make(), COUNT) for name, make in PARTS.items()}


@pytest.mark.parametrize("make", [drum, ring])
def test_a_part_that_turns_the_other_way_has_its_waves_the_other_way(found, make):
    """Seen with the rotation it is the same."""
    other = cf.whirl_modes(make(-1.0), COUNT)
    modes = found[make.__name__]
    np.testing.assert_allclose(other.freq, modes.freq, rtol=1e-8)
    assert np.array_equal(other.nodal_diameters, modes.nodal_diameters)
    assert np.array_equal(other.sense, modes.sense)


@pytest.mark.slow
@pytest.mark.parametrize("rotation", [{"axis": (1.0, 0.0, 0.0)}, {"centre": (0.01, 0.0, 0.0)}])
def test_a_ring_that_does_not_turn_about_its_own_axis_has_no_waves(rotation):
    modes = cf.whirl_modes(ring(0.01, **rotation), 2)
    assert modes.nodal_diameters.tolist() == [-1, -1]
    assert modes.sense.tolist() == [0, 0]


def test_a_blade_has_no_waves_and_the_same_frequencies_for_all_observers(found):
    modes = found["blade"]
    assert modes.nodal_diameters.tolist() == [-1] * COUNT
    assert modes.sense.tolist() == [0] * COUNT
    np.testing.assert_array_equal(modes.freq_fixed, modes.freq)
    told = modes.columns()
    assert told["mode"] == [1, 2, 3]
    assert list(told) == ["mode", "freq_hz", "freq_fixed_hz", "n", "sense"]


def test_a_shell_at_rest_is_refused():
    for part in (blade(), ring()):
        with pytest.raises(cf.errors.ModelError, match="rotation-none"):
            cf.whirl_modes(replace(part, rotation=None), 1)
