"""Identified modes made by hand: the numbers they give, their file, and files that do not fit."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.frf.sensor_grid import SensorGrid
from casingfem.experiment.identify.lscf import Stabilisation

LINES = np.array([90.0, 100.0, 110.0])


def identified(**changes):
    """Three modes at two sensors; the first two are a pair, the third holds two shapes and is doubtful."""
    each = np.arange(1.0, 4.0)
    channels, places = np.array([[0], [1]]), np.zeros((2, 3))
    grid = SensorGrid(points=np.array([4, 7]), directions=np.ones(2, int), theta=np.array([0.1, 2.0]),
                      references=np.array([[9, 1]]), channels=channels, places=places)  # fmt: skip
    diagram = Stabilisation(freq=np.array([99.0]), zeta=np.array([0.01]), order=np.array([3]), stable=np.array([True]))
    measured = np.array([[1.0 + 1j, 2.0, 3.0], [0.0, 1j, 1.0]])
    fitted = np.array([[1.0, 2.0 - 1j, np.nan], [0.0, 2j, np.nan]])
    given = {
        "freq": np.array([100.0, 102.0, 130.0]), "sigma_freq": 0.3 * each, "zeta": 1e-3 * each,
        "sigma_zeta": 1e-4 * each, "n": np.array([2, 2, -1]), "purity": 0.1 * each, "angle_deg": 10.0 * each,
        "sigma_angle": 0.5 * each, "shapes": np.ones((2, 3)),
        "sigma_shapes": 0.1 * np.ones((2, 3)), "residues": np.ones((2, 1, 3)) + 0j,
        "residue_scale": 100.0 * each, "collinearity": 0.2 * each, "signal": 7.0 * each, "doublets": ((0, 1),),
        "unresolved": (2,), "split_bound": 0.01 * each, "sensors": grid, "lines": LINES, "fitted": fitted,
        "measured": measured, "diagram": diagram, "reasons": ("", "", "why"), "notes": ("a", "b"), "card": ("c",),
        "seconds": 3.5, "shift": 4e-3,
    }  # fmt: skip
    return cf.Identified(**given | changes)


def test_numbers_of_pairs_set_ups_and_what_is_sure():
    found = identified()
    np.testing.assert_allclose(found.splits, [2.0 / 101.0], rtol=1e-12)
    np.testing.assert_allclose(found.sigma_setup, np.hypot([0.3, 0.6, 0.9], [0.4, 0.408, 0.52]), rtol=1e-12)
    assert [found.doublet_of(k) for k in range(3)] == [0, 0, -1]
    assert found.sure.tolist() == [True, True, False]
    assert identified(reasons=()).sure.tolist() == [True, True, True]
    assert found.doubtful() == ("mode 3 is doubtful: why",)
    off = np.array([1j, 1j, 0.0, -1j])
    assert found.deviation == pytest.approx(np.linalg.norm(off) / np.sqrt(2.0 + 4.0 + 1.0), rel=1e-12)
    assert np.isnan(identified(fitted=np.full((2, 3), np.nan)).deviation)


def test_records_and_the_table_have_the_numbers_of_each_mode():
    first, _, last = identified().records()
    assert first["sigma_hz"] == pytest.approx(0.5)
    assert (first["mode"], first["n"], first["doublet"], first["unresolved_pair"]) == (1, 2, 1, False)
    assert (last["mode"], last["n"], last["doublet"], last["unresolved_pair"]) == (3, None, None, True)
    assert (first["verdict"], first["reason"], last["verdict"], last["reason"]) == ("sure", "", "doubtful", "why")
    numbers = ("freq_hz", "sigma_mean_hz", "zeta", "sigma_zeta", "n_purity", "angle_deg", "sigma_angle_deg",
               "split_bound_rel", "collinearity", "signal_to_noise")  # fmt: skip
    want = [130.0, 0.9, 3e-3, 3e-4, 0.3, 30.0, 1.5, 0.03, 0.6, 21.0]
    assert [last[name] for name in numbers] == pytest.approx(want, rel=1e-12)
    table = identified(n=np.array([2, 2, 3])).table(["mine"])
    assert table.card[:2] == ("c", "mine")
    assert table.card[-3:] == ("mode 3 is doubtful: why", "a", "b")
    np.testing.assert_allclose(table.sigma_hz, identified().sigma_setup)


def test_every_field_of_the_file_comes_back(tmp_path):
    found = identified()
    again = cf.Identified.load(found.save(tmp_path / "found.npz"))
    assert repr(again) == repr(found)
    for name in ("doublets", "unresolved", "reasons", "notes", "card", "seconds", "shift"):
        assert getattr(again, name) == getattr(found, name)
    assert again.diagram.stable.tolist() == [True]
    assert again.sensors.points.tolist() == [4, 7]
    bare = cf.Identified.load(found.save(tmp_path / "bare.npz", responses=False))
    assert (bare.measured.shape, bare.fitted.shape, bare.lines.size, bare.diagram.order.size) == ((2, 0), (2, 0), 0, 0)
    assert (bare.diagram.order.dtype.kind, bare.diagram.stable.dtype.kind) == ("i", "b")
    alone = replace(found, doublets=(), unresolved=(), reasons=(), notes=())
    assert cf.Identified.load(alone.save(tmp_path / "alone.npz")).doublets == ()


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"seconds": np.zeros(1)}, r"seconds of shape \(1,\); expected one number"),
        ({"shift": np.zeros(0)}, r"shift of shape \(0,\); expected one number"),
        ({"card": np.array([["a"]])}, r"card of shape \(1, 1\); expected 1 dimensions"),
        ({"doublets": np.array([0, 1])}, r"doublets of shape \(2,\); expected 2 dimensions"),
        ({"sensors.theta": np.zeros(3)}, r"sensors.theta of shape \(3,\); expected \(2,\) for 3 modes at 2 sensors"),
        ({"sensors.places": np.zeros((2, 2))}, r"sensors.places of shape \(2, 2\); expected \(2, 3\)"),
        ({"sigma_shapes": np.zeros((3, 2))}, r"sigma_shapes of shape \(3, 2\)"),
        ({"residue_scale": np.zeros(2)}, r"residue_scale of shape \(2,\); expected \(3,\)"),
        ({"reasons": np.array(["a", "b"])}, "2 reasons; expected one for each of 3 modes"),
        ({"freq": np.array([1.0, np.inf, 2.0])}, "freq with nan or infinity"),
        ({"sigma_freq": np.array([0.0, np.nan, 0.0])}, "sigma_freq with nan or infinity"),
        ({"zeta": np.array([0.0, np.inf, 0.0])}, "zeta with nan or infinity"),
        ({"sigma_shapes": np.full((2, 3), np.inf)}, "sigma_shapes with nan or infinity"),
        ({"doublets": np.array([[0, 3]])}, "mode 4 in a pair; expected modes 1 to 3"),
        ({"unresolved": np.array([-1])}, "mode 0 in a pair"),
        ({"doublets": np.array([[0, 1, 2]])}, "mode 1 in a pair; expected modes 1 to 3, two in each pair"),
        ({"zeta": np.array(["a", "b", "c"])}, "zeta"),
        ({"notes": np.zeros(2)}, "notes"),
    ],
)
def test_a_file_that_does_not_fit_is_refused(tmp_path, arrays, words):
    path = identified().save(tmp_path / "found.npz")
    with np.load(path) as archive:
        stored = {name: archive[name] for name in archive.files}
    np.savez(path, **stored | arrays)
    with pytest.raises(cf.errors.InputError, match=words):
        cf.Identified.load(path)
