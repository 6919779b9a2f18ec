"""What is drawn is what the result holds, number for number, and every axis has its unit."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
import contact as ct
from tests.casingfem.plot.drawings import drawn, require_units, same

ROD = {"length": 0.254, "area": 6.4516e-4, "E": 206.8427e9, "rho": 7844.181}


@pytest.mark.slow
def test_a_run_of_rods_shows_forces_in_newtons_gaps_and_displacements_in_mm_over_ms():
    rods = [ct.Rod(**ROD, elements=8, x=-0.254254, velocity=5.13588), ct.Rod(**ROD, elements=8)]
    result = ct.run(rods, t_end=2e-4, courant=0.9, record=ct.Record(state_every=1))
    figure = result.plot()
    require_units(SimpleNamespace(axes=figure.axes[:3]))
    force, gap, state = figure.axes[:3]
    assert same(force.lines[0], 1e3 * result.time, result.windowed_force()[:, 0])
    assert same(gap.lines[1], 1e3 * result.time, 1e3 * result.gap[:, 0])
    assert (state.get_xlabel(), state.get_ylabel()) == ("time [ms]", "displacement [mm]")
    ends = {"rod 1, left end": 0, "rod 1, right end": 8, "rod 2, left end": 9, "rod 2, right end": 17}
    assert {line.get_label() for line in state.lines} == set(ends)
    for name, place in ends.items():
        assert np.array_equal(drawn(state, name), (1e3 * result.state_time, 1e3 * result.state[:, place]))


@pytest.mark.slow
def test_a_run_of_modes_shows_modal_coordinates_as_such():
    body = ct.ModalBody(omega=[40.0, 60.0], zeta=[0.01] * 2, channels=("x", "y"), rows=np.eye(2), S=np.zeros((2, 2)))
    patch = ct.Patch(body=body, normal=("y",), load=[0.3, -1.0])
    result = ct.run(patch, t_end=0.05, dt=1e-3, record=ct.Record(state_every=1))
    figure = result.plot()
    require_units(SimpleNamespace(axes=figure.axes[:3]))
    assert figure.axes[2].get_ylabel() == "modal coordinate\n[√kg m]"
    for k in range(2):
        assert np.array_equal(
            drawn(figure.axes[2], f"{result.blocks[0][0]}, mode {k + 1}"), (1e3 * result.state_time, result.state[:, k])
        )


@pytest.mark.slow
def test_growth_over_speed_is_that_of_the_map_and_of_the_table():
    pair = ct.gaps.HandPair(casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
                    blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)  # fmt: skip
    found = ct.interactions(pair, np.linspace(52.0, 54.0, 11))
    closed = found.peaks.map
    for figure, speed, values in (
        (closed.plot(), closed.speed_hz, closed.growth),
        (found.plot(), closed.seen_hz, closed.seen_growth),
    ):
        require_units(figure)
        assert same(figure.axes[-1].lines[1], speed, values)
    peak = closed.plot().axes[0].lines[2]
    assert (peak.get_xdata()[0], peak.get_ydata()[0]) == (closed.peak_speed_hz, closed.peak_growth)


@pytest.fixture(scope="module")
def identified():
    theta, x = np.arange(8) * np.pi / 4, np.arange(80.0, 120.0, 0.1)
    H = np.cos(2 * theta)[:, None] * 100.0**2 / (100.0**2 - x**2 + 2j * 0.004 * 100.0 * x)
    frfs = cf.frf.FrfSet.from_arrays(kind="frf", x=x, responses=H, unit="m/N", response_point=np.arange(8))
    return frfs, cf.identify(frfs, angles=dict(enumerate(np.degrees(theta))))


@pytest.mark.slow
def test_responses_and_fits_are_those_of_the_identification(identified):
    _, found = identified
    figure = found.plot()
    require_units(figure)
    rms = np.sqrt(np.mean(np.abs(found.measured - found.fitted) ** 2, axis=0))
    assert np.array_equal(drawn(figure.axes[1], "residual"), (found.lines, rms), equal_nan=True)


@pytest.fixture(scope="module")
def modes():
    casing = cf.Shell(
        chart=cf.Frustum(r_base=0.2, r_top=0.18, height=0.2), thickness=2e-3,
        material=cf.Material(E=2e11, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()},
    )  # fmt: skip
    return cf.modes(casing, 6)


@pytest.mark.slow
def test_frequencies_are_drawn_over_their_nodal_diameters(modes):
    figure = modes.plot()
    require_units(figure)
    assert np.array_equal(drawn(figure.axes[0], "this structure"), (modes.nodal_diameters, modes.freq))
