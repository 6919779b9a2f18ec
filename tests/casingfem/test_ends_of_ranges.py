"""Numbers at the ends of what is allowed: the last one that is taken, and the next one that is not."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
PLATE = cf.Shell(
    chart=cf.Plate(length=0.2, width=0.05),
    thickness=3e-3,
    material=STEEL,
    supports={"root": cf.Clamped()},
    mesh=cf.ShellMesh(order=4, rows=1, around=1),
)
SPECTRUM = cf.field.Spectrum.between({2: 0.01}, {2: 0.02})
LAMINA = cf.shell.Lamina(E1=25e9, E2=1e9, nu12=0.25, G12=0.5e9, G13=0.5e9, G23=0.2e9, rho=1500.0)
RIGS = {"omega": [1.0, 2.0], "zeta": [0.1, 0.1], "rows": [[1.0, 1.0]]}
BELOW, ABOVE = np.nextafter(1.0, 0.0), np.nextafter(1.0, 2.0)


def points(value):
    theta = np.arange(36) * np.pi / 18.0
    return cf.SurveyField.from_points(theta, np.zeros(36), np.full(36, value))


def gap(degrees):
    """A survey of points all around, but for one gap."""
    theta = np.radians(np.linspace(0.0, 360.0 - degrees, 60))
    return cf.SurveyField.from_points(theta, np.zeros(60), np.full(60, 0.5), n_max=1)


def responses(lines=40, off=0.0):
    """Frequency responses over lines, of which one is off by a part of the step."""
    x = 100.0 + 0.1 * np.arange(lines)
    x[lines // 2] += 0.1 * off
    H = 1.0 / (102.0**2 - x**2 + 2j * 0.004 * 102.0 * x)
    frfs = cf.frf.FrfSet.from_arrays(kind="frf", x=x, responses=[H, 0.5 * H], unit="m/N", response_point=[1, 2])
    return cf.identify(frfs)


def alone(samples):
    y = np.random.default_rng(1).standard_normal((3, samples))
    records = cf.frf.FrfSet.from_arrays(
        kind="time", x=np.arange(samples) / 500.0, responses=y, unit="m", response_point=[1, 2, 3]
    )
    return cf.identify(records)


def recorded(fs):
    """At least 2.56 samples in a period of the highest frequency."""
    rig = cf.rig.Rig.of(omega=[900.0], zeta=[0.01], rows=[[1.0]])
    noise = [cf.rig.Random(rms=1.0, band=(60.0, 700.0))]
    return cf.rig.record(rig, noise, drives=[0], sensors=[0], fs=fs, block=64, blocks=1, seed=1)


def sized(metres):
    """A solid that warns of its size in metres."""
    mesh = cf.imported.grid_mesh("hexahedron20", (3, 1, 1), lambda u: u * metres / np.sqrt(3.0))
    return cf.Solid(mesh=mesh, material=STEEL).assembled()


def surveyed(part):
    """A casing whose radius is off the survey's mean by this part."""
    return cf.Shell(
        chart=cf.Cylinder(radius=0.5 / (1.0 + part), height=0.1), thickness=3e-3, material=STEEL,
        radius_defect=points(0.5), mesh=cf.ShellMesh(order=4, rows=1, around=8),
    )  # fmt: skip


def scan(**changes):
    given = {"fs": 10.0, "velocity": np.zeros(4), "angle": np.arange(4.0), "tones": (1.0, 2.0)}
    return cf.circle.ScanRecord(**given | changes)


def shapes(**changes):
    given = {
        "freq_hz": [1.0, 2.0],
        "values": np.ones((1, 2)),
        "points": np.zeros((1, 3)),
        "directions": [[0.0, 0.0, 1.0]],
    }
    return cf.correlation.MeasuredShapes.from_arrays(**given | changes)


TAKEN_REFUSED = {
    "survey": (points, 1e-9, 0.0),
    "order of a mesh": (lambda x: cf.ShellMesh(order=x), 2, 1),
    "largest order of a mesh": (lambda x: cf.ShellMesh(order=x), 20, 21),
    "elements around": (lambda x: cf.ShellMesh(around=x), 1, 0),
    "rows": (lambda x: cf.ShellMesh(rows=x), 1, 0),
    "breaks": (lambda x: cf.ShellMesh(rows=(0.0, x, 1.0)), 1e-9, 0.0),
    "Poisson's ratio": (lambda x: replace(STEEL, nu=x), 0.5 * BELOW, 0.5),
    "least Poisson's ratio": (lambda x: replace(STEEL, nu=x), -BELOW, -1.0),
    "modulus": (lambda x: replace(STEEL, E=x), 1e25, 1e25 * ABOVE),
    "least density": (lambda x: replace(STEEL, rho=x), 1e-25, 1e-25 * BELOW),
    "bolts": (lambda x: cf.Bolts(count=x, k=1e6), 1, 0),
    "most bolts": (lambda x: cf.Bolts(count=x, k=1e6), 1000, 1001),
    "stiffness of bolts": (lambda x: cf.Bolts(count=4, k=(1e6, x, 1e6)), 0.0, -1e-9),
    "loose bolt": (lambda x: cf.Bolts(count=4, k=1e6, loose={x: 0.5}), 4, 5),
    "first loose bolt": (lambda x: cf.Bolts(count=4, k=1e6, loose={x: 0.5}), 1, 0),
    "width of bolts": (lambda x: cf.Bolts(count=4, k=1e6, width=x), 1e-3, 0.0),
    "widest bolts": (lambda x: cf.Bolts(count=4, k=1e6, width=x), 0.5 * np.pi, 0.5 * np.pi * (1.0 + 1e-11)),
    "mass on an edge": (lambda x: cf.edge.EdgeMass(angle=0.0, mass=x), 0.0, -1e-9),
    "section": (lambda x: cf.edge.Section.rectangle(width=x, depth=0.01), 1e-6, 0.0),
    "springs of an edge": (lambda x: cf.ElasticEdge(k_r=1.0, k_z=x), 0.0, -1e-9),
    "harmonic": (lambda x: cf.FourierField.of({x: 1e-3}), 0, -1),
    "height of a series": (
        lambda x: cf.FourierField(p=np.array([2]), cos=np.ones((1, 1)), sin=np.ones((1, 1)), z_half=x),
        1e-9,
        0.0,
    ),
    "harmonic of a spectrum": (lambda x: cf.field.Spectrum(p=np.array([x]), median=np.ones(1), high=np.ones(1)), 1, 0),
    "median of a spectrum": (
        lambda x: cf.field.Spectrum(p=np.array([2]), median=np.array([x]), high=np.ones(1)),
        1e-9,
        0.0,
    ),
    "high of a spectrum": (
        lambda x: cf.field.Spectrum(p=np.array([2]), median=np.ones(1), high=np.array([x])),
        1.0,
        BELOW,
    ),
    "order of a spectrum": (lambda x: cf.field.Spectrum(p=np.array([2, x]), median=np.ones(2), high=np.ones(2)), 3, 2),
    "draw": (lambda x: cf.field.RandomField(spectrum=SPECTRUM, seed=1, draw=x), 0, -1),
    "intervals": (lambda x: cf.field.Spline(z_low=0.0, z_high=1.0, intervals=x), 1, 0),
    "degree": (lambda x: cf.field.Spline(z_low=0.0, z_high=1.0, intervals=1, degree=x), 2, 1),
    "heights of a spline": (lambda x: cf.field.Spline(z_low=0.0, z_high=x, intervals=1), 1e-9, 0.0),
    "radius": (lambda x: cf.Cylinder(radius=x, height=0.1), 1e-9, 0.0),
    "angle of a panel": (lambda x: cf.Panel(radius=1.0, length=0.1, angle=x), 2.0 * np.pi * BELOW, 2.0 * np.pi),
    "camber": (lambda x: cf.Blade(length=0.2, chord=0.1, camber=x), 2.0 * np.pi * BELOW, 2.0 * np.pi),
    "thickness of a ply": (lambda x: cf.shell.Ply(thickness=x), 1e-9, 0.0),
    "modulus of a lamina": (lambda x: replace(LAMINA, E1=x), 1e25, 1e25 * ABOVE),
    "least density of a lamina": (lambda x: replace(LAMINA, rho=x), 1e-25, 1e-25 * BELOW),
    "ratio of a lamina": (lambda x: replace(LAMINA, nu12=x), 5.0 * BELOW * BELOW, 5.0),
    "lower bound": (lambda x: cf.Parameter(name="material.E", lower=x, upper=2.0), 2.0 * BELOW, 2.0),
    "bound of a logarithm": (lambda x: cf.Parameter(name="material.E", lower=x, upper=2.0, log=True), 1e-9, 0.0),
    "prior": (lambda x: cf.Parameter(name="material.E", lower=1.0, upper=2.0, sigma=x), 1e-9, 0.0),
    "frequencies of a rig": (lambda x: cf.rig.Rig.of(**{**RIGS, "omega": [x, 2.0]}), 1e-9, 0.0),
    "order of a rig": (lambda x: cf.rig.Rig.of(**{**RIGS, "omega": [1.0, x]}), 1.0, BELOW),
    "damping of a rig": (lambda x: cf.rig.Rig.of(**{**RIGS, "zeta": [0.1, x]}), BELOW, 1.0),
    "least damping of a rig": (lambda x: cf.rig.Rig.of(**{**RIGS, "zeta": [0.1, x]}), 1e-9, 0.0),
    "bits": (lambda x: cf.rig.Converter(bits=x, full_scale=1.0), 4, 3),
    "most bits": (lambda x: cf.rig.Converter(bits=x, full_scale=1.0), 32, 33),
    "full scale": (lambda x: cf.rig.Converter(bits=8, full_scale=x), 1e-9, 0.0),
    "shift of set-ups": (lambda x: cf.rig.Troubles(shift=x), 0.05, 0.0501),
    "set-ups": (lambda x: cf.rig.Troubles(setups=x), 1, 0),
    "dead sensors": (lambda x: cf.rig.Troubles(dead=x), 0, -1),
    "part of a burst": (lambda x: cf.rig.BurstRandom(rms=1.0, band=(1.0, 2.0), part=x), BELOW, 1.0),
    "band": (lambda x: cf.rig.Random(rms=1.0, band=(x, 2.0)), 2.0 * BELOW, 2.0),
    "lower end of a band": (lambda x: cf.rig.Random(rms=1.0, band=(x, 2.0)), 0.0, -1e-9),
    "level": (lambda x: cf.rig.Random(rms=x, band=(1.0, 2.0)), 1e-9, 0.0),
    "width of a hit": (lambda x: cf.rig.Impact(peak=1.0, width=x), 1e-9, 0.0),
    "steps of a sine": (lambda x: cf.rig.StepSine(freq=(x,), amplitude=1.0), 1e-9, 0.0),
    "sampling of a scan": (lambda x: scan(fs=x), 10.0, 0.0),
    "tone": (lambda x: scan(tones=(x,)), 1e-9, 0.0),
    "order of tones": (lambda x: scan(tones=(1.0, x)), ABOVE, 1.0),
    "frequency of a shape": (lambda x: shapes(freq_hz=[x, 2.0]), 1e-9, 0.0),
    "modes": (lambda x: cf.modes(PLATE, x), 1, 0),
    "band of modes": (lambda x: cf.modes(PLATE, band=(x, 90.0)), 0.0, -1e-9),
    "damping of a basis": (lambda x: cf.reduce(PLATE, cf.Tip(), modes=1, zeta=x), BELOW, 1.0),
    "least damping of a basis": (lambda x: cf.reduce(PLATE, cf.Tip(), modes=1, zeta=x), 0.0, -1e-9),
    "modes of a basis": (lambda x: cf.reduce(PLATE, cf.Tip(), modes=x), 1, 0),
    "nodes of a tip": (lambda x: cf.reduce(PLATE, cf.TipNodes("tip", x), modes=1), 1, 0),
    "side of a strain": (
        lambda x: cf.reduce(PLATE, cf.Tip(), modes=1, outputs=(cf.modal.Strain(name="e", at=(0.1, 0.0), side=x),)),
        1.0,
        ABOVE,
    ),
    "largest harmonic": (lambda x: cf.FourierField.of({x: 1e-9}), 10_000, 10_001),
    "stations of a chord": (lambda x: cf.Blade(length=0.2, chord=(0.1,) * x), 8, 9),
    "gap of a survey": (gap, 89.9, 90.1),
    "lines of responses": (responses, 30, 29),
    "uneven lines": (lambda x: responses(off=x), 0.049, 0.051),
    "samples of responses alone": (alone, 2000, 1999),
    "sampling of a record": (recorded, 2.56 * 700.0, 2.559 * 700.0),
    "unknowns of a mesh": (lambda x: cf.ShellMesh(order=2, rows=1, around=x), 100_000, 100_001),
    "upper end of a band of modes": (lambda x: cf.modes(PLATE, band=(1.0, x)), 90.0, 1e15),
    "nodal size": (sized, 24.9, 25.1),
    "radius beside a survey": (surveyed, 0.099, 0.101),
    "radius above a survey": (surveyed, -0.09, -0.1),
    "speeds of meetings": (lambda x: cf.interactions({8: [300.0]}, [120.0], speed_hz=(x, 90.0)), 0.0, -1e-9),
    "frequencies of meetings": (lambda x: cf.interactions({8: [x]}, [120.0], speed_hz=(0.0, 90.0)), 1e-9, 0.0),
    "frequencies of a blade": (lambda x: cf.interactions({8: [300.0]}, [x], speed_hz=(0.0, 90.0)), 1e-9, 0.0),
}


@pytest.mark.parametrize("name", TAKEN_REFUSED)
def test_the_last_number_is_taken_and_the_next_is_not(name):
    make, taken, refused = TAKEN_REFUSED[name]
    make(taken)
    with pytest.raises((cf.errors.InputError, cf.errors.ModelError, cf.errors.ModelWarning, ValueError)):
        make(refused)
