"""What is drawn is what the result holds, number for number, and every axis has its unit."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
import contact as ct
from casingfem.plot.contact import figure_contact, figure_wear
from casingfem.plot.cycles import figure_cycles
from casingfem.plot.experiment import figure_responses as figure_frfs
from casingfem.plot.identify import figure_fit, figure_responses, figure_stabilisation
from casingfem.plot.interaction import figure_interactions, figure_speeds, figure_stability
from casingfem.plot.modes import figure_frequencies
from casingfem.plot.motion import figure_energy, figure_orbit, figure_spectrum
from casingfem.plot.records import figure_peaks
from casingfem.plot.sweep import figure_sweep
from casingfem.plot.update import Paired, figure_errors
from contact.sweep.plan import load_sweep
from contact.sweep.sweep import run_sweep
from tests.casingfem.plot.drawings import drawn, require_units, same

ROD = {"length": 0.254, "area": 6.4516e-4, "E": 206.8427e9, "rho": 7844.181}


@pytest.mark.slow
def test_a_run_of_rods_shows_forces_in_newtons_gaps_and_displacements_in_mm_over_ms():
    rods = [ct.Rod(**ROD, elements=8, x=-0.254254, velocity=5.13588), ct.Rod(**ROD, elements=8)]
    result = ct.run(rods, t_end=2e-4, courant=0.9, record=ct.Record(state_every=1))
    figure = figure_contact(result)
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
    figure = figure_contact(result)
    require_units(SimpleNamespace(axes=figure.axes[:3]))
    assert figure.axes[2].get_ylabel() == "modal coordinate\n[√kg m]"
    for k in range(2):
        assert np.array_equal(
            drawn(figure.axes[2], f"{result.blocks[0][0]}, mode {k + 1}"), (1e3 * result.state_time, result.state[:, k])
        )


def test_energies_and_strain_energies_are_those_of_the_ledger():
    ledger, time = {"start": 2.0, "friction": -0.5, "end": 1.5}, np.linspace(0.0, 1.0, 5)
    strain = {"casing": time**2, "blade": 2.0 * time}
    figure = figure_energy(ledger, time, strain)
    require_units(SimpleNamespace(axes=figure.axes[1:]))
    names = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert dict(zip(names, (bar.get_width() for bar in figure.axes[0].patches), strict=True)) == ledger
    assert re.search(r"\[J\]", figure.axes[0].get_xlabel())
    for name, energy in strain.items():
        assert np.array_equal(drawn(figure.axes[1], name), (time, energy))


def test_a_spectrum_has_the_amplitude_of_its_sine_at_its_frequency():
    time = 1e-3 * np.arange(4000)
    figure = figure_spectrum(time, 3.0 * np.sin(2.0 * np.pi * 50.0 * time), label="force", unit="N")
    require_units(figure)
    for label in ("whole run", "last quarter"):
        freq, amplitude = drawn(figure.axes[0], label)
        assert (freq[amplitude.argmax()], amplitude.max()) == (50.0, pytest.approx(3.0, rel=1e-2))


def test_an_orbit_is_drawn_in_micrometres_along_the_rim_and_outwards():
    phase = np.linspace(0.0, 6.0, 40)
    motion = SimpleNamespace(time=phase, tip=1e-5 * np.stack([np.cos(phase), np.sin(phase)], axis=1),
                             rim=2e-6 * np.stack([np.sin(phase), phase], axis=1))  # fmt: skip
    figure = figure_orbit(motion)
    require_units(figure)
    for axes, values in zip(figure.axes, (motion.tip, motion.rim), strict=True):
        assert np.array_equal(drawn(axes, "whole run"), (1e6 * values[:, 1], 1e6 * values[:, 0]))


@pytest.mark.slow
def test_growth_over_speed_is_that_of_the_map_and_of_the_table():
    pair = ct.gaps.HandPair(casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
                    blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4), compliance=1e-4)  # fmt: skip
    found = ct.interactions(pair, np.linspace(52.0, 54.0, 11))
    closed = found.peaks.map
    for figure, speed, values in (
        (figure_stability(closed), closed.speed_hz, closed.growth),
        (figure_interactions(found), closed.seen_hz, closed.seen_growth),
    ):
        require_units(figure)
        assert same(figure.axes[-1].lines[1], speed, values)
    peak = figure_stability(closed).axes[0].lines[2]
    assert (peak.get_xdata()[0], peak.get_ydata()[0]) == (closed.peak_speed_hz, closed.peak_growth)


def test_cycles_are_drawn_from_their_rows_branch_by_branch():
    rows = [{"branch": 1, "speed_hz": 5.0 + k, "stable": k < 2, "amplitude_casing": 1e-5 * k} for k in range(4)]
    figure = figure_cycles(rows, [{"kind": "fold", "branch": 1, "speed_hz": 7.0, "amplitude_casing": 2e-5}])
    require_units(figure)
    kept, lost = [line for line in figure.axes[0].lines if len(line.get_xdata()) > 1]
    for line, shown in ((kept, rows[:3]), (lost, rows[2:])):
        assert same(line, [row["speed_hz"] for row in shown], [row["amplitude_casing"] for row in shown])
    assert np.array_equal(drawn(figure.axes[0], "fold"), ([7.0], [2e-5]))


@pytest.mark.slow
def test_a_sweep_is_drawn_over_its_key_and_the_key_has_its_unit(tmp_path):
    scene = tmp_path / "sweep.toml"
    rod = "".join(f"{name} = {value!r}\n" for name, value in ROD.items())
    scene.write_text(
        f'[scene]\nkind = "rods"\nt_end = 1e-4\n[[rod]]\n{rod}elements = 4\nvelocity = 1.0\n[wall]\nx = 0.2541\n'
        '[scheme]\nkind = "forward-lagrange"\ncourant = 0.9\n[sweep]\n[[sweep.vary]]\nkey = "rod[1].velocity"\n'
        "values = [3.0, 1.0, 2.0]\n"
    )
    found = run_sweep(load_sweep(scene), folder=tmp_path / "runs", jobs=1)
    plan = found.plan
    assert plan.labels == ("rod[1].velocity [m/s]",)
    values = np.array([run.values for run in plan.runs])
    figure = figure_sweep(plan.labels, values, found.rows)
    require_units(figure)
    order = np.argsort(values[:, 0])
    amplitude = np.array([row["amplitude_m"] for row in found.rows])
    assert same(figure.axes[0].lines[0], values[order, 0], 1e3 * amplitude[order])  # mm


def test_the_wear_of_a_coating_is_drawn_over_its_angle():
    angle = np.linspace(0.0, 2.0 * np.pi, 9)[:-1]
    worn = SimpleNamespace(angle=angle, made=1e-5 * np.cos(angle), before=2e-5 * np.sin(angle), after=3e-5 * angle,
                           map_time=np.array([0.0, 1.0]), map=1e-6 * np.arange(16.0).reshape(2, 8))  # fmt: skip
    figure = figure_wear(worn)
    require_units(figure)
    for label, values in (("as made", worn.made), ("before the run", worn.before), ("after", worn.after)):
        assert np.array_equal(drawn(figure.axes[0], label), (np.degrees(angle), 1e6 * values))
    assert np.array_equal(figure.axes[1].images[0].get_array(), 1e6 * worn.map)


@pytest.fixture(scope="module")
def identified():
    theta, x = np.arange(8) * np.pi / 4, np.arange(80.0, 120.0, 0.1)
    H = np.cos(2 * theta)[:, None] * 100.0**2 / (100.0**2 - x**2 + 2j * 0.004 * 100.0 * x)
    frfs = cf.frf.FrfSet.from_arrays(kind="frf", x=x, responses=H, unit="m/N", response_point=np.arange(8))
    return frfs, cf.identify(frfs, angles=dict(enumerate(np.degrees(theta))))


@pytest.mark.slow
def test_responses_and_fits_are_those_of_the_identification(identified):
    frfs, found = identified
    figure = figure_responses(found, channel=2)
    require_units(figure)
    for label, values in (("measured", found.measured), ("fitted", found.fitted)):
        assert np.array_equal(drawn(figure.axes[0], label), (found.lines, np.abs(values[2])), equal_nan=True)
    figure = figure_fit(found)
    require_units(figure)
    rms = np.sqrt(np.mean(np.abs(found.measured - found.fitted) ** 2, axis=0))
    assert np.array_equal(drawn(figure.axes[1], "residual"), (found.lines, rms), equal_nan=True)
    figure = figure_frfs(frfs)
    require_units(figure)
    assert figure.axes[0].get_ylabel() == "|H| [m/N]"
    channels = zip(figure.axes[0].lines[: len(frfs)], np.abs(frfs.responses), strict=True)
    assert all(same(line, frfs.x, size) for line, size in channels)
    poles, order = drawn(figure_stabilisation(found).axes[0], "stable pole")
    stable = found.diagram.stable
    assert np.array_equal((poles, order), (found.diagram.freq[stable], found.diagram.order[stable]))


def test_hits_are_drawn_by_their_peaks():
    hits = [SimpleNamespace(peak=-3.0, left=0.02, fault=""), SimpleNamespace(peak=5.0, left=0.5, fault="clipped")]
    figure = figure_peaks(SimpleNamespace(hits=hits))
    require_units(figure)
    assert np.array_equal(drawn(figure.axes[0], "used"), ([1.0], [3.0]))
    assert np.array_equal(drawn(figure.axes[1], "left out"), ([2.0], [50.0]))


@pytest.fixture(scope="module")
def modes():
    casing = cf.Shell(
        chart=cf.Frustum(r_base=0.2, r_top=0.18, height=0.2), thickness=2e-3,
        material=cf.Material(E=2e11, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()},
    )  # fmt: skip
    return cf.modes(casing, 6)


@pytest.mark.slow
def test_frequencies_are_drawn_over_their_nodal_diameters(modes):
    figure = figure_frequencies(modes)
    require_units(figure)
    assert np.array_equal(drawn(figure.axes[0], "this structure"), (modes.nodal_diameters, modes.freq))


@pytest.mark.slow
def test_errors_of_frequencies_are_relative_in_per_cent(modes):
    table = cf.FrequencyTable.from_arrays(
        freq_hz=1.01 * modes.freq[[0, 2]], sigma_hz=0.5, n=modes.nodal_diameters[[0, 2]], mode=[1, 2]
    )
    paired = cf.correlation.pair(modes, table)
    figure = figure_errors(table, {"imperfect": Paired(modes, paired)})
    require_units(figure)
    x, y = drawn(figure.axes[0], "imperfect")
    rows = [row for match in paired.matches for row in match.rows]
    kept = [mode for match in paired.matches for mode in match.modes]
    assert np.array_equal(np.round(x), rows)
    assert np.allclose(y, 100.0 * (modes.freq[kept] / table.freq_hz[rows] - 1.0), rtol=1e-12)


def test_a_campbell_diagram_shows_each_mode_over_speed():
    freq = np.array([[90.0 + k, 120.0 - k] for k in range(6)])
    found = SimpleNamespace(speed_hz=np.linspace(0.0, 50.0, 6), freq=freq, crossings=lambda order: [])
    figure = figure_speeds(found, orders=2)
    require_units(figure)
    first, second = figure.axes[0].lines[2:4]
    assert same(first, found.speed_hz, found.freq[:, 0])
    assert same(second, found.speed_hz, found.freq[:, 1])
