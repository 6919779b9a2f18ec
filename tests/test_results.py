"""Every kind of result becomes a table, a picture, a cell of a notebook, a file, a copy: each kind once."""

import copy
import json
import pickle
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pandas as pd
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy.sparse import csc_array

import casingfem as cf
import contact as ct
from casingfem.experiment.circle.record import turning
from casingfem.modal.harmonics import Rings
from casingfem.modal.mistuning import Pair
from casingfem.plot.results import PICTURES
from casingfem.updating.uncertainty.prediction import Prediction
from contact.io.reported import Reported
from contact.io.stored import StoredError, load_value, read_only, save_value
from contact.record.wear import Wear
from contact.sweep.plan import load_sweep
from contact.sweep.sweep import run_sweep

DATA = Path(__file__).parents[1] / "data"
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
MESH = cf.ShellMesh(order=5, rows=1, around=9)
SWEEP = """
[sweep]
[[sweep.vary]]
key = "rod[1].velocity"
values = [4.5, 5.0]
"""


def frustum(**changes):
    chart = cf.Frustum(r_base=0.5, r_top=0.45, height=0.25)
    parts = {"chart": chart, "thickness": 3e-3, "material": STEEL, "supports": {"base": cf.Clamped()}, "mesh": MESH}
    return cf.Shell(**parts | changes)


def strip(**changes):
    parts = {
        "chart": cf.Plate(length=0.2, width=0.04), "thickness": 3e-3, "material": STEEL,
        "supports": {"root": cf.Clamped()}, "mesh": cf.ShellMesh(order=5, rows=1, around=1),
    }  # fmt: skip
    return cf.Shell(**parts | changes)


def solid():
    beam = cf.imported.grid_mesh(
        "hexahedron20", (3, 1, 1), lambda u: u * [1.0, 0.1, 0.1], groups={"root": (0, 0.0), "tip": (0, 1.0)}
    )
    return cf.Solid(mesh=beam, material=STEEL, supports={"root": cf.Clamped()})


def turned_strip():
    return strip(rotation=cf.Rotation(omega=100.0, axis=(0.0, 1.0, 0.0), centre=(-0.3, 0.0, 0.0)))


def correlated():
    casing = frustum()
    theta = 2.0 * np.pi * np.arange(16) / 16
    out = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    computed = cf.modes(casing, 6)
    values = np.stack([np.cos(n * (theta - 0.1)) for n in computed.nodal_diameters[::2]], axis=1)
    measured = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=computed.freq[::2], values=values, points=0.45 * out + [0.0, 0.0, 0.25], directions=out
    )
    return cf.correlate(computed, measured)


def updated():
    start, truth = strip(), strip(thickness=3.1e-3)
    freq = cf.modes(truth, 5).freq
    table = cf.FrequencyTable.from_arrays(freq_hz=freq, sigma_hz=1e-3 * freq)
    vary = [cf.Parameter(name="shell.thickness", lower=2e-3, upper=4e-3),
            cf.Parameter(name="material.rho", lower=7e3, upper=9e3, sigma=50.0)]  # fmt: skip
    return cf.update(start, table, vary)


def estimated():
    t = np.arange(512) / 256.0
    pulse = np.where(np.abs(t - 0.1) < 0.02, np.cos(25.0 * np.pi * (t - 0.1)) ** 2, 0.0)
    ring = np.convolve(pulse, np.exp(-3.0 * t) * np.sin(200.0 * t))[:512]
    force, response = (
        cf.frf.FrfSet.from_arrays(kind="time", x=t, responses=[values], unit=unit)
        for values, unit in ((pulse, "N"), (ring, "m"))
    )
    return cf.frf.estimate(cf.frf.Take(response=response, force=force))


def scanned():
    theta = turning(3.0, 2000.0, 8000)
    seen = np.cos(5 * (theta - 0.1)) * np.cos(2.0 * np.pi * 401.7 * np.arange(8000) / 2000.0)
    return cf.circle.demodulate(cf.circle.ScanRecord(fs=2000.0, velocity=seen, angle=theta, tones=(401.7,)), 6)


def mistuned():
    rows = [Pair(draw, 8, 1, 370.0 + draw, 1e-3 * draw, 10.0) for draw in range(1, 6)]
    return cf.modal.Mistuning.of(rows, [Pair(0, 8, 1, 371.0, 0.0, np.nan)])


def sampled():
    samples = np.random.default_rng(3).normal(size=(200, 2))
    return cf.updating.PosteriorSamples(
        names=("shell.thickness", "support.base.k_face"), log=(False, True), samples=samples,
        gauss_newton=np.ones(2), acceptance=0.4, autocorrelation=20.0, gap=0.01,
    )  # fmt: skip


def orbit(value, size):
    return ct.cycles.Orbit(
        name="freq_hz", value=value, period=1.0 / value, periods=1, start=0.0, x=np.array([size, 0.0]),
        multipliers=np.array([0.5 + 0.1j, 0.5 - 0.1j]), amplitude={"tip": size}, gap=np.array([0.0]),
        force=np.array([1.0]), closings=(1,), rests=(0,), touching=(), M=np.eye(2), iterations=3,
    )  # fmt: skip


def orbits():
    points = tuple(orbit(value, 0.1 * value) for value in (1.0, 1.1, 1.2))
    fold = ct.cycles.Special(kind="fold", orbit=points[2], before=points[1])
    return ct.cycles.Cycles(name="freq_hz", branches=(ct.cycles.Branch(points=points, specials=(fold,)),), seconds=0.1)


def basins():
    motion = ct.cycles.Attractor(states=np.ones((1, 2)), amplitude={"tip": 0.1}, share=1.0)
    return ct.cycles.Basins(name="freq_hz", value=1.0, attractors=(motion,), starts=np.zeros((3, 2)), reached=(0, 0, 0))


def worn():
    angle, none = np.linspace(0.0, 6.0, 20), np.zeros(20)
    depth = 1e-5 * (1.0 + np.cos(angle))
    return Wear(
        angle=angle, made=none, cut=none, worn=depth, map_time=np.array([0.0, 1.0]), map=np.stack([none, depth]),
        volume=1e-9, stated=0.1, dissipated=0.1, bare=0,
    )  # fmt: skip


def interacting():
    pair = ct.gaps.HandPair(
        casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5),
        blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4),
        compliance=1e-4,
    )
    return ct.interactions(pair, np.linspace(50.0, 55.0, 11))


def run():
    rods = [
        ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20, x=-1.1, velocity=1.0),
        ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20),
    ]
    return ct.run(rods, scheme=ct.CentralDifference(), t_end=4.0, courant=0.9)


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    text = (DATA / "scenes" / "two_rods.toml").read_text(encoding="utf-8")
    file = tmp_path_factory.mktemp("sweep") / "two_rods.toml"
    file.write_text(text + SWEEP, encoding="utf-8")
    return run_sweep(load_sweep(file))


KINDS = {
    "modes": lambda: cf.modes(frustum(), 6),
    "modes of a mesh": lambda: cf.modes(solid(), 4),
    "whirl modes": lambda: cf.whirl_modes(turned_strip(), 3),
    "Campbell": lambda: cf.campbell(turned_strip(), [0.0, 100.0], count=3),
    "coincidences": lambda: cf.interactions({8: [370.0]}, [90.0], speed_hz=(30.0, 70.0)),
    "mistuning": mistuned,
    "basis": lambda: cf.reduce(strip(), cf.Tip(), modes=3),
    "deflection": lambda: cf.solve_static(strip(), [cf.loads.EdgeLoad(edge="tip", force=(0.0, 0.0, 10.0))]),
    "deflection of a mesh": lambda: cf.solve_static(solid(), [cf.loads.EdgeLoad(edge="tip", force=(0.0, 0.0, 10.0))]),
    "frequency table": lambda: cf.FrequencyTable.from_arrays(freq_hz=[367.9, 368.4], sigma_hz=0.2, n=[8, 8]),
    "identified": lambda: cf.Identified.load(DATA / "experiments" / "bench.npz"),
    "responses of records": estimated,
    "correlation": correlated,
    "circle scan": scanned,
    "update": updated,
    "identifiability": lambda: updated().identifiability,
    "pairing": lambda: correlated().pairing,
    "samples": sampled,
    "left out": lambda: cf.updating.LeftOut(
        rows=(Prediction(mode=1, n=8, measured_hz=371.0, predicted_hz=372.0, sigma_hz=0.5),)
    ),
    "Laplace": lambda: cf.updating.Laplace(
        names=("material.E",), log=(False,), covariance=np.eye(1), gauss_newton=np.ones(1), bend=np.zeros(1)
    ),
    "run": run,
    "stability": lambda: interacting().peaks.map,
    "peaks of growth": lambda: interacting().peaks,
    "interactions": interacting,
    "cycles": orbits,
    "basins": basins,
    "wear": worn,
}


@pytest.fixture(scope="module", params=[*KINDS, "sweep"])
def result(request):
    return request.getfixturevalue("swept") if request.param == "sweep" else KINDS[request.param]()


def arrays_in(value, seen=None):
    """All arrays of a value, at any depth."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, dict):
        yield from (array for entry in value.values() for array in arrays_in(entry))
    elif isinstance(value, tuple | list):
        yield from (array for entry in value for array in arrays_in(entry))
    elif is_dataclass(value):
        yield from (array for field in fields(value) for array in arrays_in(getattr(value, field.name)))


def assert_same(one, other):
    assert type(one) is type(other)
    assert repr(one) == repr(other)
    pairs = list(zip(arrays_in(one), arrays_in(other), strict=True))
    for a, b in pairs:
        if a.dtype.kind in "fc":  # what a class normalises once more may turn its last bit
            np.testing.assert_allclose(a, b, rtol=1e-14, atol=0.0)
        else:
            np.testing.assert_array_equal(a, b)
        assert not b.flags.writeable


def assert_whole(result, folder):
    """All that a result can do, at once: for kinds whose making takes long."""
    assert len(result.to_dataframe().columns)
    assert result.plot().axes
    assert "<table>" in result._repr_html_()
    assert_same(result, pickle.loads(pickle.dumps(result)))
    assert_same(result, type(result).load(result.save(folder / "result.npz")))


def test_it_is_a_result_that_is_drawn(result):
    assert isinstance(result, Reported)
    assert any(f"{kind.__module__}.{kind.__qualname__}" in PICTURES for kind in type(result).__mro__)


def test_it_becomes_a_table(result):
    table = result.to_dataframe()
    assert isinstance(table, pd.DataFrame)
    assert len(table)
    assert list(table) == list(result.columns())


@pytest.mark.slow
def test_it_draws_itself_alone_or_beside_others(result):
    figure = result.plot()
    assert isinstance(figure, Figure)
    assert any(axes.has_data() for axes in figure.axes)
    whole = Figure(figsize=(8.0, 4.0), layout="constrained", dpi=20)
    left, right = whole.subplots(1, 2)
    right.plot([0.0, 1.0])
    assert result.plot(ax=left) is whole
    assert right in whole.axes
    assert any(axes.has_data() for axes in whole.axes if axes is not right)
    FigureCanvasAgg(whole).draw()  # what savefig does, but once: that one draws for the layout and then for the file


def test_a_notebook_shows_a_table_and_the_words(result):
    page = result._repr_html_()
    assert page.count("<tr>") == page.count("</tr>") >= 2
    assert "nan<" not in page
    assert "<pre>" in page


def test_copies_and_pickles_are_the_same_and_read_only(result):
    for other in (copy.copy(result), copy.deepcopy(result), pickle.loads(pickle.dumps(result))):
        assert_same(result, other)


def test_its_own_arrays_cannot_be_written(result):
    direct = [getattr(result, field.name) for field in fields(result)]
    assert not any(value.flags.writeable for value in direct if isinstance(value, np.ndarray))
    with pytest.raises((AttributeError, TypeError)):
        setattr(result, fields(result)[0].name, 1)


def test_it_is_read_from_its_file(result, tmp_path):
    path = result.save(tmp_path / "result.npz")
    assert_same(result, type(result).load(path))


@pytest.mark.slow
def test_print_of_any_value_is_a_line():
    part, casing = solid(), frustum(radius_defect=cf.FourierField.of({8: 0.002}))
    rods = ct.load_scene(DATA / "scenes" / "two_rods.toml")
    values = [
        part, part.mesh, part.assembled(), casing, casing.mesh, cf.shell.assemble(strip()), correlated().sensors, rods,
        cf.Bolts(count=24, k=2e8, loose={3: 0.5}), cf.ElasticEdge(k_face=1e9, around=cf.FourierField.of({3: 0.1})),
        orbits().branches[0], load_sweep(DATA / "scenes" / "two_rods_sweep.toml"), updated().given,
    ]  # fmt: skip
    lines = [str(value).replace(str(DATA), "data") for value in values]
    assert [line for line in lines if "\n" in line or len(line) > 600 or "array([" in line] == []
    assert str(part.mesh) == "MeshData(grid: 3 hexahedron20, 44 nodes, 1 x 0.1 x 0.1 m; groups root, tip)"
    assert "thickness=0.003" in str(casing)
    assert "loose={3: 0.5}" in str(values[8])


def test_every_number_that_may_be_varied_is_listed():
    support = cf.ElasticEdge(k_face=1e9, around=cf.FourierField.of({3: (0.1, 0.2)}))
    casing = frustum(supports={"base": cf.Bolts(count=3, k=2e8), "top": support})
    found = cf.updating.parameters(casing)
    known = dict(zip(found.name, zip(found.value, found.unit, strict=True), strict=True))
    assert known["support.top.around.p3.sin"] == (0.2, "-")
    assert known["support.base.bolts.3.k"] == (2e8, "N/m")
    assert known["support.base.k_rot"] == (0.0, "N m/rad")
    assert known["chart.r_base"] == (0.5, "m")
    assert all(cf.Parameter(name=name, lower=-1e12, upper=1e12) for name in known)
    assert list(found.to_dataframe()) == ["name", "value", "unit"]
    assert "solid.material" not in str(cf.updating.parameters(solid()))
    with pytest.raises(cf.errors.InputError, match=r"did you mean support.top.k_face\?"):
        cf.updating.update(
            casing, KINDS["frequency table"](), [cf.Parameter(name="support.top.k_fac", lower=0.0, upper=1.0)]
        )


def test_a_file_makes_nothing_but_values_of_the_packages(tmp_path):
    table = KINDS["frequency table"]()
    path = table.save(tmp_path / "table.npz")
    arrays = dict(np.load(path))
    for found, said in (
        ("os:system", "expected a value of casingfem or contact"),
        ("casingfem.errors:warn", "dataclass"),
        ("contact.io.stored:Packing", "expected a dataclass or a named tuple"),
    ):
        document = str(arrays["document"]).replace("casingfem.experiment.frequency_table:FrequencyTable", found)
        np.savez(path, **arrays | {"document": document})
        with pytest.raises(StoredError, match=rf"table.npz: found no value .*{said}.*, expected a FrequencyTable"):
            cf.FrequencyTable.load(path)


def test_a_file_of_something_else_is_refused_by_its_name(tmp_path):
    path = KINDS["left out"]().save(tmp_path / "other.npz")
    with pytest.raises(StoredError, match=r"other.npz: found a LeftOut, expected a FrequencyTable"):
        cf.FrequencyTable.load(path)
    np.savez(path, freq_hz=np.ones(3))
    with pytest.raises(StoredError, match=r"other.npz: found a NoneType, expected a FrequencyTable"):
        cf.FrequencyTable.load(path)
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(StoredError, match=r"other.npz: found no value that can be read"):
        cf.FrequencyTable.load(path)
    wrong = KINDS["frequency table"]().save(path)
    np.savez(path, **dict(np.load(wrong)) | {"sigma_hz": np.array([-1.0, 0.2])})
    with pytest.raises(StoredError, match=r"sigma_hz"):  # its own checks
        cf.FrequencyTable.load(path)


def test_what_a_file_cannot_keep_is_named(tmp_path):
    class Mine(cf.Frustum):
        """A chart of the user's."""

    modes = cf.modes(frustum(chart=Mine(r_base=0.5, r_top=0.45, height=0.25)), 2)
    with pytest.raises(StoredError, match=r"shell.chart: found .*Mine, expected numbers, text, or values of casingfem"):
        modes.save(tmp_path / "modes.npz")
    assert not (tmp_path / "modes.npz").exists()


@pytest.mark.parametrize(
    ("array", "found"),
    [
        (np.array([None, 1.0]), "object"),
        (np.array(["2026-01-01"], dtype="datetime64[D]"), r"datetime64\[D\]"),
        (np.array([b"abc"]), r"\|S3"),
    ],
)
def test_an_array_that_no_file_can_store_is_named(tmp_path, array, found):
    with pytest.raises(StoredError, match=rf"^a\.2: found an array of {found}, expected one of numbers or text$"):
        save_value(tmp_path / "value.npz", {"a": [1.0, array]})
    assert not (tmp_path / "value.npz").exists()


def test_a_sparse_matrix_keeps_its_shape_and_no_other_kind_is_taken_for_it(tmp_path):
    matrix = csc_array(np.array([[0.0, 1.0, 0.0], [2.0, 0.0, 3.0]]))
    save_value(tmp_path / "value.npz", (matrix, matrix))
    one, other = load_value(tmp_path / "value.npz", tuple)
    assert one is other
    np.testing.assert_array_equal(one.toarray(), matrix.toarray())
    with pytest.raises(StoredError, match=r"found scipy\.sparse.*csr_array, expected numbers"):
        save_value(tmp_path / "value.npz", (matrix.tocsr(),))


def test_arrays_whose_paths_are_the_same_are_both_kept(tmp_path):
    one, other = np.array([1.0]), np.array([2.0])
    path = save_value(tmp_path / "value.npz", {"a": [one], "a.1": other}, beside={"more": np.array([3.0])})
    assert load_value(path, dict) == {"a": [one], "a.1": other}
    np.testing.assert_array_equal(np.load(path)["more"], [3.0])
    path = save_value(path, one)
    np.testing.assert_array_equal(load_value(path, np.ndarray), one)
    np.testing.assert_array_equal(np.load(path)["value"], one)


def test_the_text_of_a_file_is_json_for_any_program(tmp_path):
    """Which has no word for numbers that are not finite."""
    value = {"of python": np.inf, "of numpy": np.float64("nan"), "both": MappingProxyType({1: complex(0.0, -np.inf)})}
    path = save_value(tmp_path / "value.npz", value)
    assert json.loads(str(np.load(path)["document"]), parse_constant=pytest.fail)
    assert repr(load_value(path, dict)) == repr(value | {"of numpy": np.nan})


def test_arrays_at_any_depth_are_read_only():
    deep = [np.zeros(2) for _ in range(5)]
    read_only(({"a": deep[0]}, [deep[1]], MappingProxyType({"b": (deep[2],)}), Rings(*deep[3:])))
    assert not any(array.flags.writeable for array in deep)


@pytest.mark.slow
def test_any_program_reads_the_arrays_by_their_paths_and_each_is_there_once(tmp_path):
    fit = updated()
    arrays = dict(np.load(fit.save(tmp_path / "fit.npz")))
    np.testing.assert_array_equal(arrays["after.freq"], fit.after.freq)
    np.testing.assert_array_equal(arrays["table.freq_hz"], fit.table.freq_hz)
    read = cf.updating.UpdateResult.load(tmp_path / "fit.npz")
    assert read.after.shell is read.structure  # one object before, one object after
    plain = ["a", 1, 2.5, np.nan, -np.inf, 1 + 2j, None, True, ("b", [Path("c")]), {(1, "d"): frozenset({2})}]
    save_value(tmp_path / "plain.npz", plain)
    assert repr(load_value(tmp_path / "plain.npz", list)) == repr(plain)


@pytest.mark.slow
def test_what_comes_after_an_update_works_on_one_that_was_kept():
    """No live problem: the Laplace approximation of an update and of its pickle are the same to round-off."""
    fit = updated()
    one, other = (cf.updating.laplace(known) for known in (fit, pickle.loads(pickle.dumps(fit))))
    np.testing.assert_allclose(one.sigma, other.sigma, rtol=1e-12)
    np.testing.assert_allclose(one.sigma, fit.stated_sigma, rtol=0.02)
