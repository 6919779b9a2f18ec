"""Numbers held: shells with all that they may have, wheels in air, splits, chances, circle scans, hammer records."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.circle.test_circle_scan import ring_rig
from tests.probed import finite, numbers_of_result, probed

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
MESH = cf.ShellMesh(order=5, rows=2, around=9)
SMALL = cf.ShellMesh(order=5, rows=2, around=2)
CARBON = cf.shell.Lamina(E1=140e9, E2=10e9, nu12=0.3, G12=5e9, G13=4e9, G23=3e9, rho=1600.0)
BAR = cf.edge.Section.rectangle(width=0.012, depth=0.02)
FRUSTUM = cf.Frustum(r_base=0.50, r_top=0.45, height=0.25)
LOOSE = cf.Bolts(count=9, k=(2e8, 1e8, 3e8), k_rot=1e4, first_angle=0.1, loose={3: 0.4})
CORNER, TOP = cf.geometry.Piece(to=(0.3, 0.1)), cf.geometry.Piece(to=(0.2, 0.2))
DRUM = cf.geometry.PiecewiseMeridian(start=(0.3, 0.0), pieces=(CORNER, TOP), fillet=0.02)
PLACES = tuple(at / DRUM.length for at in DRUM.lines)
PLIES = tuple(cf.shell.Ply(thickness=1e-3, angle_deg=angle, lamina=CARBON) for angle in (0.0, 40.0, -70.0))


SHELLS = {
    "bolted": {
        "chart": FRUSTUM, "supports": {"base": LOOSE},
        "masses": {"top": [cf.edge.EdgeMass(angle=0.4, mass=0.3)]},
    },
    "ringed": {
        "chart": cf.Cylinder(radius=0.4, height=0.2),
        "supports": {"base": cf.Ring(section=BAR, support=LOOSE), "top": cf.ElasticEdge(k_r=1e7, k_theta=2e6, k_z=3e6)},
    },
    "stiffened": {
        "chart": FRUSTUM, "supports": {"base": cf.Clamped()},
        "stiffeners": (cf.edge.Stiffener(at=0.12, section=BAR, offset=(0.01, 0.002)),),
        "mesh": cf.ShellMesh(order=5, rows=(0.0, 0.48, 0.6, 0.88, 1.0), around=9),
        "strips": (cf.Strip(start=0.15, end=0.22, thickness=5e-3),),
    },
    "laminated": {
        "chart": cf.Cylinder(radius=0.4, height=0.2), "supports": {"base": cf.ShearDiaphragm(), "top": cf.Clamped()},
        "plies": PLIES, "wall": "linear",
    },
    "drum": {
        "chart": cf.Revolved(profile=DRUM),
        "supports": {"base": cf.Clamped()}, "mesh": cf.ShellMesh(order=4, rows=PLACES, around=7),
    },
    "bell": {
        "chart": cf.Revolved(profile=cf.geometry.SmoothMeridian(points=((0.30, 0.0), (0.29, 0.1), (0.25, 0.2)))),
        "supports": {"base": cf.Clamped()}, "thickness_defect": cf.FourierField.of({2: (1e-4, 5e-5), 5: 2e-4}),
        "radius_defect": cf.FourierField.of({3: 1e-3, 4: (0.0, 5e-4)}),
    },
    "panel": {
        "chart": cf.Panel(radius=0.5, length=0.3, angle=0.8), "mesh": SMALL,
        "supports": {"left": cf.Clamped(), "right": cf.ShearDiaphragm()},
    },
    "blade": {
        "chart": cf.Blade(length=0.2, chord=(0.06, 0.05), camber=0.3, twist=(0.1, 0.5)), "mesh": SMALL,
        "supports": {"root": cf.Clamped()}, "rotation": cf.Rotation(omega=150.0),
    },
    "twisted": {
        "chart": cf.geometry.TwistedPlate(length=0.3, width=0.1, twist=0.5), "mesh": SMALL,
        "supports": {"root": cf.ElasticEdge(k_face=2e11)},
    },
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
@pytest.mark.parametrize("name", SHELLS)
def test_numbers_of_a_shell(name, held):
    """Frequencies, and deflections under a load on the surface, a pressure, a load along an edge and one at a point."""
    shell = cf.Shell(**{"material": STEEL, "mesh": MESH, "thickness": 3e-3, **SHELLS[name]})
    found = cf.modes(shell, 5, method="shell")
    edge, middle = list(shell.chart.edges)[-1], [0.5 * (low + high) for low, high in shell.chart.bounds]
    acting = [
        cf.loads.SurfaceLoad(force=(20.0, -60.0, 200.0)),
        cf.loads.Pressure(pressure=2e3),
        cf.loads.EdgeLoad(edge=edge, force=(50.0, 20.0, -30.0)),
        cf.loads.PointLoad(at=tuple(middle), force=(3.0, 5.0, -7.0)),
    ]
    moved = [cf.solve_static(shell, [load]) for load in acting] if "rotation" not in SHELLS[name] else []
    held(
        1e-5,
        freq=found.freq,
        elastic=finite(found.nodal_diameters) if hasattr(found, "nodal_diameters") else [],
        energy=[one.energy for one in moved],
        place=[x for one in moved for x in one.at(*middle)],
        fields=[np.linalg.norm(one.fields[:, k]) for one in moved for k in range(3)],
        sums=[probed(np.atleast_2d(one.fields[:, k])) for one in moved for k in range(one.fields.shape[1])],
        **numbers_of_result(found, "modes "),
        **{key: column for k, one in enumerate(moved) for key, column in numbers_of_result(one, f"moved {k} ").items()},
    )


def test_numbers_of_wheels_in_air(held):
    """A chain of ten blades with influence coefficients of the air, tuned and with blades of different stiffness."""
    air = cf.modal.Influence(offset=[-1, 0, 1], stiffness=[20.0, 100.0, -20.0], damping=[0.02, 0.3, -0.01])
    wheel = cf.modal.BladedWheel.chain(blades=10, freq_hz=100.0, mass=0.2, coupling=0.02)
    speeds, uneven = np.linspace(30.0, 36.0, 7), 0.01 * np.cos(np.arange(10) ** 2)
    tuned = cf.modal.engine_order_response(wheel, 3, speeds, force=2.0, zeta=1e-3, influence=air)
    mixed = cf.modal.engine_order_response(wheel, 13, speeds / 4.0, force=2.0, zeta=1e-3, deviations=uneven)
    drawn = cf.modal.amplification(wheel, 2, sigma=0.01, draws=12, seed=5, zeta=1e-3)
    told = {
        **numbers_of_result(tuned, "tuned "),
        **numbers_of_result(mixed, "mixed "),
        **numbers_of_result(drawn, "drawn "),
    }
    held(1e-5, wheel=finite(wheel), tuned=finite(tuned), mixed=finite(mixed), drawn=finite(drawn), **told)


@pytest.mark.slow
def test_numbers_of_split_maps(held):
    lab = cf.field.RandomField.example(thickness=0.01, radius=0.5, seed=7, scale=0.1, p_max=8)
    tube = cf.Shell(
        chart=cf.Cylinder(radius=0.5, height=0.3), thickness=0.01, supports={"base": cf.Clamped()}, material=STEEL,
        radius_defect=lab, mesh=cf.ShellMesh(order=5, rows=1, around=9),
    )  # fmt: skip
    own = cf.modal.SplitMap.of(tube, 8)
    found = own.splits(own.series([{"radius": lab.redrawn(k)} for k in range(4)]))
    held(1e-5, n=own.n, freq=own.freq, split=finite(found.split), mean=finite(found))


def test_numbers_of_estimates_of_chance(held):
    at = cf.chance.points(7, range(256), 3)
    rare = cf.chance.subset_simulation(lambda u: u.sum(axis=1), 4, 6.0, seed=7)
    weights = np.array([2.0, 1.0, 0.5])
    shares = cf.chance.importance(lambda u: (u @ weights)[:, None], {"a": slice(0, 1), "b": slice(1, 3)}, 3, seed=7)
    held(
        1e-6,
        points=probed(at),
        share=finite([cf.chance.probability(at.sum(axis=1) < level) for level in (0.4, 1.2, 2.0)]),
        interval=[x for hits in (0, 1, 5, 50) for x in cf.chance.clopper_pearson(hits, 50)],
        middle=finite([cf.chance.quantile(at[:, 0], level) for level in (0.1, 0.5, 0.9)]),
        rare=finite(rare),
        shares=finite([list(rows) for rows in shares]),
    )


def test_numbers_of_a_pair_seen_by_a_scan(held):
    """Two members 0.4 % apart with other damping, noise in every line."""
    f, rng = np.linspace(96.0, 104.0, 41), np.random.default_rng(12)
    low, high = (
        1j * f / (f0**2 - f**2 + 2j * zeta * f0 * f) * size
        for f0, zeta, size in ((99.8, 2e-3, 1.0), (100.2, 3e-3, 0.6))
    )
    V = np.stack([low + 1j * high, low - 1j * high], axis=1) / 2.0
    V = V + 1e-3 * np.abs(V).max() * (rng.standard_normal(V.shape) + 1j * rng.standard_normal(V.shape))
    sigma = np.full(V.shape, 1e-3 * np.abs(V).max())
    scan = cf.circle.CircleScan(tones=f, n=np.array([-3, 3]), V=V, sigma=sigma, floor=sigma, rate=2.0, left=1.0)
    held(1e-5, pair=finite(cf.circle.split_pair(scan, 3)))


def test_numbers_of_hammer_records(held):
    """Five hits on a structure of two modes, one of them a double hit, with noise on both channels."""
    fs, count, rng = 1024.0, 2048, np.random.default_rng(3)
    t = np.arange(5 * count) / fs
    force = sum(
        size * np.exp(-(((t - at) / 1.2e-3) ** 2))
        for at, size in [(0.1, 3.0), (2.1, 2.5), (4.1, 3.2), (4.14, 1.0), (6.1, 2.8), (8.1, 3.1)]
    )
    ring = np.exp(-3.0 * t) * np.sin(500.0 * t) + 0.5 * np.exp(-5.0 * t) * np.sin(900.0 * t)
    moved = np.convolve(force, ring)[: len(t)] / fs
    force, moved = force + 1e-3 * rng.standard_normal(len(t)), moved + 1e-6 * rng.standard_normal(len(t))
    sets = [
        cf.frf.FrfSet.from_arrays(kind="time", x=t, responses=[y], unit=unit)
        for y, unit in ((moved, "m"), (force, "N"))
    ]
    found = cf.frf.estimate(cf.frf.Take(response=sets[0], force=sets[1]))
    held(
        1e-5,
        H=found.frfs.responses[0][5:500:9],
        coherence=found.coherence.responses[0][5:500:9],
        averages=[found.averages],
        hits=finite(found.hits),
    )


@pytest.mark.slow
def test_numbers_of_a_correlation(held):
    """Twenty-four sensors on a wavy cylinder see noisy shapes of a softer one; one sensor is turned over."""

    def tube(E):
        return cf.Shell(
            chart=cf.Cylinder(radius=0.3, height=0.1), thickness=4e-3, supports={"base": cf.Clamped()},
            material=cf.Material(E=E, nu=0.3, rho=7800.0), mesh=cf.ShellMesh(order=6, rows=1, around=9),
            radius_defect=cf.FourierField.of({2: 5e-4, 8: 3e-4, 10: 4e-4}),
        )  # fmt: skip

    model, real = cf.modes(tube(210e9), 6, method="shell"), cf.modes(tube(205e9), 6, method="shell")
    theta, rng = np.arange(24) * np.pi / 12, np.random.default_rng(6)
    out = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    at = np.column_stack([0.3 * out[:, :2], np.full(24, 0.1)])
    n = real.nodal_diameters[:4]
    values = np.column_stack([np.cos(m * theta + 0.3 * k) for k, m in enumerate(n)])
    values = values + 0.02 * rng.standard_normal(values.shape)
    values[5] *= -1.0
    shapes = cf.correlation.MeasuredShapes.from_arrays(freq_hz=real.freq[:4], values=values, points=at, directions=out)
    held(1e-4, found=finite(cf.correlate(model, shapes).to_json()))


def test_numbers_of_a_scan(held):
    """Velocities that the rig's scan of two pairs gives, their lines, and the waves in them."""
    rig, circle = ring_rig(split=0.8)
    made = cf.rig.scan(
        rig, cf.rig.Turning(mirror=1.7), [cf.rig.Tone(370.2, 2.0, 0.3)], circle=circle, drive=5, fs=1000.0,
        seconds=2.0, seed=5,
    )  # fmt: skip
    waves = cf.circle.demodulate(made.record, 9).waves()
    held(
        1e-5,
        V=made.V,
        waves=[x for one in waves for x in (one.amplitude, one.amplitude * one.travelling)],
        velocity=made.record.velocity[::97],
        angle=made.record.angle[::97],
    )
