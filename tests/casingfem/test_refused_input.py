"""Input that no other test refuses: each fault says what was found where, and what is expected."""

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
BEAM = cf.Solid(
    mesh=cf.imported.grid_mesh(
        "hexahedron20", (2, 1, 1), lambda u: u * [0.2, 0.05, 0.01], groups={"root": (0, 0.0), "tip": (0, 1.0)}
    ),
    material=STEEL,
    supports={"root": cf.Clamped()},
)
ONE = cf.rig.Rig.of(omega=[900.0], zeta=[0.01], rows=[[1.0]])
POINTS, OUT = np.array([[0.1, 0.0, 0.0]]), np.array([[0.0, 0.0, 1.0]])


def recorded():
    return cf.rig.record(
        ONE,
        [cf.rig.Random(rms=1.0, band=(60.0, 700.0))],
        drives=[0],
        sensors=[0],
        fs=2048.0,
        block=256,
        blocks=2,
        seed=1,
    )


def updated(**options):
    table = cf.FrequencyTable.from_arrays(freq_hz=cf.modes(PLATE, 2).freq, sigma_hz=0.1)
    return cf.update(PLATE, table, [cf.Parameter(name="material.E", lower=1e11, upper=3e11)], **options)


def output(kind):
    interface = cf.Tip() if isinstance(kind, cf.modal.Displacement | cf.modal.Strain) else cf.TipNodes("tip", 2)
    part = PLATE if isinstance(kind, cf.modal.Displacement | cf.modal.Strain) else BEAM
    return cf.reduce(part, interface, modes=1, outputs=(kind,))


TUBE = replace(
    PLATE, chart=cf.Cylinder(radius=0.3, height=0.2), supports={"base": cf.Clamped()},
    mesh=cf.ShellMesh(order=4, rows=1, around=5),
)  # fmt: skip


def troubled(lines, sensors, **troubles):
    rig = cf.rig.Rig.of(omega=[900.0, 1000.0], zeta=[0.01, 0.02], rows=np.eye(2))
    return cf.rig.troubled_frfs(rig, lines, cf.rig.Troubles(**troubles), sensors=sensors, drives=[1], seed=1)


def functions(**changes):
    return cf.frf.FrfSet.from_arrays(**({"kind": "frf", "x": [1.0], "responses": [[1j]], "unit": "m/N"} | changes))


def shapes(values):
    return cf.correlation.MeasuredShapes.from_arrays(freq_hz=[100.0], values=values, points=POINTS, directions=OUT)


REFUSED = {
    "no pieces": (
        lambda: cf.geometry.PiecewiseMeridian(start=(0.3, 0.0), pieces=()),
        "chart.piece: found none, expected one or more",
    ),
    "a small arc": (
        lambda: cf.geometry.PiecewiseMeridian(
            start=(0.3, 0.0), pieces=(cf.geometry.Piece(to=(0.3, 0.1), radius=0.05),)
        ),
        "chart.piece[1].radius: found 0.05 m for an arc whose ends are 0.1 m",
    ),
    "large fillets": (
        lambda: cf.geometry.PiecewiseMeridian(
            start=(0.3, 0.0), fillet=0.2, pieces=(cf.geometry.Piece(to=(0.3, 0.1)), cf.geometry.Piece(to=(0.2, 0.1)))
        ),
        "chart.piece[2].fillet: found 0.2 m, expected a smaller radius, so that both pieces",
    ),
    "fillets that leave nothing between": (
        lambda: cf.geometry.PiecewiseMeridian(
            start=(0.3, 0.0),
            fillet=0.06,
            pieces=(
                cf.geometry.Piece(to=(0.3, 0.1)),
                cf.geometry.Piece(to=(0.2, 0.1)),
                cf.geometry.Piece(to=(0.2, 0.3)),
            ),
        ),
        "chart.piece[2]: found fillets that are longer than the piece of 0.1 m",
    ),
    "a mesh too large": (lambda: cf.ShellMesh(order=20, rows=1000, around=10_000), "mesh: some 2e+10 unknowns"),
    "an unknown edge": (lambda: replace(PLATE, supports={"rim": cf.Clamped()}), "rim"),
    "no support": (lambda: replace(PLATE, supports={"root": 3.0}), "support.root: expected"),
    "a place off the surface": (
        lambda: cf.solve_static(PLATE, [cf.loads.Pressure(pressure=1e3)]).at(0.5, 0.0),
        "at: found [0.5], outside the surface; expected 0 to 0.2",
    ),
    "a seed below 0": (
        lambda: cf.field.RandomField(spectrum=cf.field.Spectrum.between({2: 0.01}, {2: 0.02}), seed=-1),
        "RandomField: found seed -1, draw 0, stream 0",
    ),
    "directions": (
        lambda: cf.imported.Fixed(directions=("x", "x")),
        "directions must name some of x, y, z, each once, found ('x', 'x')",
    ),
    "a direction of an output": (
        lambda: output(cf.modal.Displacement(name="u", at=(0.1, 0.0), direction="up")),
        "output 'u': found direction 'up'",
    ),
    "a component of an output": (
        lambda: output(cf.modal.Strain(name="e", at=(0.1, 0.0), component="13")),
        "output 'e': found",
    ),
    "a node's direction": (
        lambda: output(cf.modal.NodeDisplacement(name="u", node=20, direction="up")),
        "output 'u': found direction 'up'",
    ),
    "a node's component": (
        lambda: output(cf.modal.NodeStrain(name="e", node=20, component="13z")),
        "output 'e': found component '13z'",
    ),
    "alike shapes": (
        lambda: cf.correlation.subspace_mac(np.ones((4, 2)), np.eye(4)[:, :2]),
        "the shapes of a plane must be linearly independent",
    ),
    "values of too few channels": (lambda: shapes(np.ones((2, 1))), "expected"),
    "a shape of zeros": (lambda: shapes(np.zeros((1, 1))), "zero everywhere"),
    "a window": (lambda: cf.rig.estimate(recorded(), window="flat"), "window: found 'flat', expected"),
    "an estimator": (lambda: cf.rig.estimate(recorded(), estimator="H3"), "estimator: found 'H3', expected"),
    "a mass below zero at a sensor": (
        lambda: cf.rig.Place(at=(0.1, 0.0), mass=-1.0),
        "mass: found -1.0 kg, expected 0 or more",
    ),
    "a direction of a sensor": (
        lambda: cf.rig.Place(at=(0.1, 0.0), direction="up"),
        "direction: found 'up', expected one of",
    ),
    "a method of charts for an imported part": (
        lambda: cf.modes(BEAM, 2, method="shell"),
        "method: found 'shell', expected \"auto\" for an imported structure",
    ),
    "no places": (
        lambda: cf.rig.rig_of(cf.modes(PLATE, 2), [], zeta=0.01),
        "places: found none, expected at least one",
    ),
    "damping of one": (
        lambda: cf.rig.rig_of(cf.modes(PLATE, 2), [cf.rig.Place(at=(0.1, 0.0))], zeta=1.0),
        "zeta: found 1, expected damping ratios from 1e-09 to below 1, not per cent",
    ),
    "as many dead channels as there are": (
        lambda: troubled(np.arange(120.0, 180.0), [0], dead=1),
        "troubles.dead: found 1; expected less than the 1 channels",
    ),
    "a fixture beside no mode": (
        lambda: troubled(np.arange(420.0, 480.0), [0, 1], fixture=1),
        "troubles.fixture: found no mode of the structure from 420 to 479 Hz; expected one in the band",
    ),
    "a form": (lambda: functions(unit="", form="inertance"), "form 'inertance'; expected receptance or mobility or"),
    "a complex record": (lambda: functions(kind="time"), "found a complex time record; expected real values"),
    "an abscissa that turns back": (
        lambda: functions(x=[3.0, 2.0], responses=[[1j, 2j]]),
        "found 2 after 3; expected an abscissa that ascends",
    ),
    "parts of points": (lambda: functions(response_point=[1.5]), "response_point that are not whole numbers"),
    "shapes at other dofs": (
        lambda: cf.correlation.mac(np.ones((3, 2)), np.ones((4, 2))),
        "shapes to compare need the same dofs, not 3 and 4",
    ),
    "air of too few blades": (
        lambda: cf.modal.Influence(offset=[0, 1], stiffness=[1.0], damping=[1.0, 2.0]),
        "expected one stiffness and one damping for each offset",
    ),
    "air of parts of blades": (
        lambda: cf.modal.Influence(offset=[0.5, 1], stiffness=[1.0, 2.0], damping=[1.0, 2.0]),
        "influence: found shapes {(2,)}; expected one stiffness",
    ),
    "a chain of one blade": (
        lambda: cf.modal.BladedWheel.chain(blades=1, freq_hz=100.0, mass=0.2, coupling=0.02),
        "chain: found blades = 1, freq_hz = 100, mass = 0.2, coupling = 0.02, expected 2 or more blades",
    ),
    "a chain that pushes": (
        lambda: cf.modal.BladedWheel.chain(blades=3, freq_hz=100.0, mass=0.2, coupling=-0.02),
        "coupling = -0.02, expected 2 or more blades, positive numbers",
    ),
    "a line beside the rim's": (
        lambda: cf.modal.out_of_roundness(TUBE, cf.Rim("top", n_max=3), line=1),
        "line must lie between 0 and 0 here, found 1",
    ),
    "a sum of no fields": (lambda: cf.field.SumField(fields=()), "SumField: found no fields, expected at least one"),
    "a wall as thick as its surface is long": (
        lambda: replace(PLATE, thickness=0.3),
        "the wall is 0.3 m thick on a surface 0.2 m long",
    ),
    "a steady shape at rest": (
        lambda: BEAM.steady_shape(),
        "steady_shape: found a structure without rotation, expected one with",
    ),
    "bolts of an edge without": (
        lambda: cf.search_model(PLATE, cf.FrequencyTable.from_arrays(freq_hz=[100.0], sigma_hz=0.1)),
        "locate among bolts: found 0 edges with bolts, expected one",
    ),
    "a field as large as the wall": (
        lambda: replace(TUBE, thickness_defect=cf.FourierField.of({2: (0.95, 0.0)})),
        "the field reaches -0.95, expected values from -0.9 to 9",
    ),
    "a field ten times as large as the wall": (
        lambda: replace(TUBE, thickness_defect=cf.FourierField.of({0: (9.5, 0.0), 2: (0.25, 0.0)})),
        "the field reaches 9.75, expected values from -0.9 to 9",
    ),
    "few further evaluations": (
        lambda: cf.chance.subset_simulation(lambda u: u.sum(axis=1), 4, 2.0, seed=7, more=99),
        "dimension 4, size 1000, more 99, expected at least 1 number, 100 evaluations a level, and 0 or at least 100",
    ),
    "few evaluations of a level": (
        lambda: cf.chance.subset_simulation(lambda u: u.sum(axis=1), 4, 2.0, seed=7, size=99),
        "dimension 4, size 99, more",
    ),
    "responses of no number": (
        lambda: cf.chance.subset_simulation(lambda u: np.nan * u.sum(axis=1), 4, 6.0, seed=7),
        "subset_simulation: found responses (1000,) or not finite, expected (1000,) finite",
    ),
    "an empty band": (lambda: cf.rig.estimate(recorded(), band=(1.0, 2.0)), "found 1 to 2 Hz without a line"),
    "bits": (lambda: cf.rig.Converter(bits=1, full_scale=1.0), "bits: found 1, expected"),
    "a quantity": (
        lambda: ONE.frfs([10.0], sensors=[0], drives=[0], quantity="velocity"),
        "quantity: found 'velocity', expected",
    ),
    "a shift": (lambda: cf.rig.Troubles(shift=0.5), "shift: found 0.5, expected 0 to 0.05"),
    "no setups": (lambda: cf.rig.Troubles(setups=0), "setups: found 0"),
    "a rule": (lambda: cf.updating.Regularisation(rule="strong"), "regularise: found 'strong', expected"),
    "a name that is not varied": (
        lambda: updated(regularise=cf.updating.Regularisation(names=("material.rho",))),
        "regularise: found 'material.rho', expected varied parameters: material.E",
    ),
    "what becomes of outliers": (
        lambda: updated(outliers="drop"),
        'outliers: found \'drop\', expected "set-aside" or "keep"',
    ),
    "no modes to expand": (
        lambda: cf.correlation.expand(np.ones((4, 1)), np.eye(4)[:, :2], np.arange(4), modes=[]),
        "expand: 0 modes on 4 channels",
    ),
    "more modes to expand than channels": (
        lambda: cf.correlation.expand(np.ones((2, 1)), np.ones((2, 3)), np.arange(2), modes=[0, 1, 2]),
        "expand: 3 modes on 2 channels",
    ),
    "modes to expand that look alike": (
        lambda: cf.correlation.expand(np.ones((4, 1)), np.ones((4, 2)), np.arange(4), modes=[0, 1]),
        "expand: 2 modes cannot be distinguished on 4 channels",
    ),
    "paired shapes of other sizes": (
        lambda: cf.correlation.comac(np.ones((3, 2)), np.ones((3, 1))),
        "paired shapes need equal sizes (channels, modes), not (3, 2) and (3, 1)",
    ),
    "paired shapes in a row": (
        lambda: cf.correlation.comac(np.ones(3), np.ones(3)),
        "paired shapes need equal sizes (channels, modes), not (3,) and (3,)",
    ),
    "no paired shapes": (
        lambda: cf.correlation.comac(np.ones((3, 0)), np.ones((3, 0))),
        "paired shapes need equal sizes (channels, modes), not (3, 0) and (3, 0)",
    ),
    "a paired shape of zeros": (
        lambda: cf.correlation.comac(np.ones((3, 2)), np.eye(3)[:, :2] * [1.0, 0.0]),
        "paired shapes: one is zero at every channel",
    ),
    "a measured shape of zeros": (
        lambda: cf.correlation.comac(np.eye(3)[:, :2] * [1.0, 0.0], np.ones((3, 2))),
        "paired shapes: one is zero at every channel",
    ),
    "a mass that lifts": (
        lambda: cf.rig.loaded(cf.rig.Rig.of(omega=[900.0], zeta=[0.01], rows=[[1.0], [0.5]]), [0, 1], [0.1, -0.1]),
        "mass: found -0.1 kg, expected masses of 0 kg or more",
    ),
    "a mass of no number": (
        lambda: cf.rig.loaded(cf.rig.Rig.of(omega=[900.0], zeta=[0.01], rows=[[1.0], [0.5]]), [0, 1], [0.1, np.inf]),
        "expected masses of 0 kg or more",
    ),
    "sections of other sizes": (
        lambda: cf.imported.BladeSections.cylindrical(*[np.ones((3, 5))] * 3, np.ones((3, 4))),
        "sections: found z (3, 5), r (3, 5), theta_1 (3, 5), theta_2 (3, 4); expected four arrays (sections, stations)",
    ),
    "sections of no number": (
        lambda: cf.imported.BladeSections.cylindrical(
            np.ones((3, 5)), np.ones((3, 5)), np.full((3, 5), [0.0, 0.0, np.nan, 0.0, 0.0]), np.ones((3, 5))
        ),
        "sections: found nan or inf in theta_1; expected finite numbers",
    ),
    "the thickness of a survey of radii": (
        lambda: cf.SurveyField.from_points(np.linspace(0.0, 6.2, 40), np.zeros(40), np.ones(40)).mean_thickness,
        "a radius survey has no mean thickness; see mean_radius",
    ),
    "an order below 1": (lambda: cf.ShellMesh(order=0, rows=1, around=1), "order"),
    "an address": (lambda: cf.updating.get_value(PLATE, "wing.span"), "wing.span"),
    "an address within the chart": (lambda: cf.updating.get_value(PLATE, "chart.radius"), "chart.radius"),
    "an address within no structure": (
        lambda: cf.updating.get_value(3.0, "material.E"),
        "update: found float, expected a Solid or MeshShell",
    ),
    "an address of no number": (lambda: cf.updating.get_value(PLATE, "support.root.k_r"), "support.root"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_input_is_refused(name):
    make, words = REFUSED[name]
    with pytest.raises((cf.errors.InputError, cf.errors.ModelError, cf.errors.NumericsError, ValueError)) as caught:
        make()
    assert words in str(caught.value)


def test_responses_that_the_rig_did_not_make_are_not_written_as_its_own(tmp_path):
    frfs = replace(ONE.frfs([100.0, 110.0], sensors=[0], drives=[0]), card=("MEASURED: mine",))
    with pytest.raises(
        ValueError, match="found a set whose card does not begin with SYNTHETIC, expected the rig's own"
    ):
        cf.rig.write_rig_uff(tmp_path / "rig.uff", ONE, [frfs])


def test_an_empty_set_of_a_universal_file_is_named_with_its_line(tmp_path):
    (tmp_path / "e.uff").write_text("    -1\n  2411\n\n    -1\n")
    with pytest.raises(
        cf.errors.InputError, match=r"e\.uff, line 3, set 2411 .*: found an empty set; expected at least"
    ):
        cf.uff.read_uff(tmp_path / "e.uff")


def test_a_table_of_influence_has_its_three_columns(tmp_path):
    (tmp_path / "i.csv").write_text("offset,stiffness\n0,1\n")
    with pytest.raises(cf.errors.InputError, match="found offset,stiffness; expected offset,stiffness,damping"):
        cf.modal.Influence.from_csv(tmp_path / "i.csv")


def test_uneven_records_of_responses_alone_are_refused():
    rng = np.random.default_rng(1)
    records = cf.frf.FrfSet.from_arrays(
        kind="time", x=(np.arange(4000) / 500.0) ** 1.01, responses=rng.standard_normal((3, 4000)), unit="m",
        response_point=[1, 2, 3],
    )  # fmt: skip
    with pytest.raises(cf.errors.InputError, match="found uneven instants; expected even steps"):
        cf.identify(records)


def test_the_fewest_evaluations_of_subset_simulation_are_taken():
    assert (
        0.0 < cf.chance.subset_simulation(lambda u: u.sum(axis=1), 4, 2.0, seed=7, size=100, more=100).probability < 1.0
    )


def test_nothing_to_write_is_no_universal_file(tmp_path):
    with pytest.raises(ValueError, match="found no data"):
        cf.uff.write_uff(tmp_path / "empty.uff")


INP = "*NODE\n" + "".join(
    f"{k}, {x}, {y}, {z}\n"
    for k, (x, y, z) in enumerate(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], 1
    )
)
CELL = "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
FILES = {
    "kinematic alone": (
        INP + CELL + "*KINEMATIC\n1, 3\n",
        "*KINEMATIC without *COUPLING, expected *COUPLING before it",
    ),
    "distributing alone": (
        INP + CELL + "*DISTRIBUTING\n1, 3\n",
        "*DISTRIBUTING without *COUPLING, expected *COUPLING before it",
    ),
    "too few numbers": (
        INP + "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7\n",
        "numbers, expected a multiple of 9: element",
    ),
    "no such surface": (
        INP + CELL + "*COUPLING, REF NODE=1, SURFACE=S, CONSTRAINT NAME=C\n*KINEMATIC\n1, 3\n",
        "no surface",
    ),
}


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_refused_with_its_line(name, tmp_path):
    text, words = FILES[name]
    path = tmp_path / "part.inp"
    path.write_text(text)
    with pytest.raises(cf.errors.ModelError) as caught:
        cf.read_mesh(path)
    assert words in str(caught.value)
    assert "part.inp" in str(caught.value)
