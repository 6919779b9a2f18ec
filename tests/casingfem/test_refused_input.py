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
    "an address": (lambda: cf.updating.get_value(PLATE, "wing.span"), "wing.span"),
    "an address within the chart": (lambda: cf.updating.get_value(PLATE, "chart.radius"), "chart.radius"),
    "an address of no number": (lambda: cf.updating.get_value(PLATE, "support.root.k_r"), "support.root"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_input_is_refused(name):
    make, words = REFUSED[name]
    with pytest.raises((cf.errors.InputError, cf.errors.ModelError, ValueError)) as caught:
        make()
    assert words in str(caught.value)


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
