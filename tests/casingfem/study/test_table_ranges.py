"""Keys of study.toml: the last value that is taken and the first that is not; what represents keys left out."""

import pytest

import casingfem as cf
from tests.casingfem.study.study_tables import problems_at, study_with
from tests.tables_in_files import table_schema

# codes of problems that are not of a range: unusual values, missing files, keys for other structures
OTHERWISE = ("[study-implausible]", "[study-file]", "[study-key]")
DRIVE = {"height": 0.1}
PARAMETER = {"name": "material.E", "lower": 1e11, "upper": 3e11}
# what each table cannot do without
LEAST = {
    "material": {"E": 2e11, "nu": 0.3, "rho": 7800.0},
    "chart cylinder": {"kind": "cylinder", "radius": 0.5, "height": 0.2},
    "chart panel": {"kind": "panel", "radius": 0.5, "length": 0.2, "angle": 1.0},
    "chart dome": {"kind": "dome", "radius": 0.5, "start_deg": 0.0, "end_deg": 60.0},
    "chart.piece[1]": {"to": [0.5, 0.2]},
    "chart meridian": {"kind": "meridian", "start": [0.5, 0.0], "piece": [{"to": [0.5, 0.2]}]},
    "chart twisted-plate": {"kind": "twisted-plate", "length": 0.2, "width": 0.1, "twist_deg": 30.0},
    "chart blade": {"kind": "blade", "length": 0.2, "chord": 0.1},
    "taper": {},
    "solid.tie[1]": {"follower": "a", "master": "b"},
    "solid": {"mesh": "a.inp"},
    "shell.plies[1]": {"thickness": 1e-3},
    "shell": {"thickness": 3e-3},
    "strip[1]": {"from": 0.0, "to": 0.1, "thickness": 3e-3},
    "mass[1]": {"edge": "top", "angle_deg": 0.0, "mass": 0.1},
    "mesh": {},
    "rotation": {"speed_hz": 100.0},
    "imperfection[1].harmonics[1]": {"p": 2},
    "imperfection[1].random[1]": {"p": 2, "median": 0.1},
    "imperfection[1]": {"of": "radius", "survey": "a.csv"},
    "support.base elastic": {"kind": "elastic"},
    "support.base fixed": {"kind": "fixed", "directions": ["x"]},
    "support.base.loose[1]": {"bolt": 1, "factor": 0.5},
    "support.base bolts": {"kind": "bolts", "count": 4, "k": 1e8},
    "support.base ring": {"kind": "ring", "diameter": 0.01},
    "stiffener[1]": {"at": 0.1, "offset": [0.01, 0.0], "diameter": 0.01},
    "modes": {},
    "update.parameter[1]": PARAMETER,
    "update": {"table": "a.csv", "shapes": "a.uff", "parameter": [PARAMETER]},
    "reduce.output[1]": {"name": "root", "at": [0.0, 0.1], "strain": "11"},
    "reduce": {"interface": "top"},
    "cyclic": {"sectors": 6},
    "rig.drive[1]": {"height": 0.1},
    "rig.sensor[1]": {"height": 0.1},
    "rig.test.troubles": {},
    "rig.test": {"kind": "random", "band_hz": [10.0, 20.0], "resolution_hz": 1.0},
    "rig.scan": {"height": 0.1, "tones_hz": [10.0], "seconds": 1.0, "fs": 100.0, "orders": 5},
    "rig": {"seed": 0, "zeta": 0.01, "drive": [DRIVE]},
}  # fmt: skip
POSITIVE = [(1e-25, 0.999e-25), (1e25, 1.001e25)]
NOT_NEGATIVE = [(0.0, -1e-30), (1e-25, 1e-300), (1e25, 1.001e25)]
LENGTH = [(1e-7, 0.999e-7), (1e3, 1000.001)]
TURN = [(-360.0, -360.001), (360.0, 360.001)]
RELATIVE = [(-1.0, -1.0001), (1.0, 1.0001)]
SHARE = [(0.0, -1e-9), (1.0, 1.0001)]
BELOW_1 = [(0.0, -1e-9), (0.9999, 1.0)]
PAIR = [([1.0, 2.0], [1.0]), ([1.0, 2.0], [1.0, 2.0, 3.0])]
THREE = [([1.0, 2.0, 3.0], [1.0, 2.0]), ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0, 4.0])]
COUNT_1000 = [(1, 0), (1000, 1001)]
STATIONS = [([1.0], []), ([1.0] * 8, [1.0] * 9)]
ENDS = {
    "material": {"E": POSITIVE, "nu": [(-0.999, -1.0), (0.499, 0.5)], "rho": POSITIVE},
    "chart cylinder": {"radius": LENGTH, "height": LENGTH},
    "chart panel": {"angle": [(1e-25, 0.0), (6.28318, 6.283185307179586)]},
    "chart dome": {"start_deg": TURN, "end_deg": TURN, "r0": [(-1e3, -1000.1), (1e3, 1000.1)]},
    "chart.piece[1]": {"to": PAIR, "radius": [(-1e3, -1000.1), (1e3, 1000.1)], "thickness": LENGTH, "fillet": LENGTH},
    "chart meridian": {"start": PAIR, "piece": [([{"to": [1.0, 2.0]}], [])]},
    "chart twisted-plate": {"twist_deg": TURN},
    "chart blade": {
        "chord": [*STATIONS, *LENGTH, ([1e-7], [0.0])],
        "twist_deg": [*TURN, *STATIONS], "camber_deg": [*TURN, *STATIONS],
    },
    "taper": {"along": [*STATIONS, (1e-3, 0.0), (1e3, 1001.0)], "across": STATIONS},
    "shell.plies[1]": {"angle_deg": TURN},
    "solid.tie[1]": {"follower": [("a", "")], "master": [("b", "")], "tolerance": POSITIVE},
    "solid": {"mesh": [("a", "")], "scale": POSITIVE, "join": NOT_NEGATIVE},
    "shell": {"mesh": [("a", "")], "thickness": LENGTH},
    "strip[1]": {"from": [(-1e3, -1000.1), (0.0999, 0.1)], "to": [(0.0001, 0.0), (1e3, 1000.1)]},
    "mass[1]": {"edge": [("base", "")], "angle_deg": TURN, "mass": NOT_NEGATIVE},
    "mesh": {"order": [(2, 1), (20, 21)], "rows": COUNT_1000, "around": [(1, 0), (10_000, 10_001)]},
    "rotation": {
        "speed_hz": [(0.0, -1e-9), (1e5, 100_000.1)], "hub_radius": [(0.0, -1e-9), (1e3, 1000.1)],
        "stagger_deg": TURN, "axis": THREE, "centre": THREE,
    },
    "imperfection[1].harmonics[1]": {"p": [(0, -1), (1000, 1001)], "cos": RELATIVE, "sin": RELATIVE},
    "imperfection[1].random[1]": {
        "p": COUNT_1000, "median": [(1e-9, 0.9e-9), (1.0, 1.0001)], "high": [(1e-9, 0.0), (1.0, 1.0001)]
    },
    "imperfection[1]": {"survey": [("a", "")], "n_max": COUNT_1000, "degree": [(0, -1), (20, 21)]},
    "support.base elastic": {"k_r": NOT_NEGATIVE},
    "support.base fixed": {"directions": [(["z"], [])]},
    "support.base.loose[1]": {"bolt": COUNT_1000, "factor": [(0.0, -1e-9), (1e6, 1.001e6)]},
    "support.base bolts": {
        "count": COUNT_1000, "first_angle_deg": TURN, "width_deg": [(1e-3, 0.9e-3), (360.0, 360.001)],
        "spacing_deg": [(1e-3, 0.9e-3), (360.0, 360.001)],
    },
    "support.base ring": {"offset": PAIR, "foot": PAIR},
    "stiffener[1]": {"at": [(-1e3, -1000.1), (1e3, 1000.1)], "offset": PAIR},
    "modes": {"count": [(1, 0), (100_000, 100_001)], "band_hz": PAIR},
    "update.parameter[1]": {"name": [("a", "")], "sigma": POSITIVE},
    "update": {
        "table": [("a", "")], "shapes": [("b.uff", "")], "sigma": [(1e-25, 0.0), (0.9999, 1.0)], "reach": POSITIVE,
        "count": [(1, 0), (100_000, 100_001)], "model_error": BELOW_1, "shape_error": BELOW_1,
        "parameter": [([PARAMETER], [])],
    },
    "reduce.output[1]": {"name": [("a", "")], "at": PAIR, "side": RELATIVE},
    "reduce": {
        "interface": [("base", "")], "n_max": COUNT_1000, "nodes": [(1, 0), (100, 101)],
        "modes": [(1, 0), (100_000, 100_001)], "zeta": BELOW_1, "out": [("a.npz", "b/a.npz"), ("a.npz", "a.npy")],
    },
    "cyclic": {
        "sectors": [(2, 1), (1000, 1001)], "nodal_diameters": [([0], [])], "tolerance": POSITIVE, "point": THREE,
        "faces": [(["a", "b"], ["a"]), (["a", "b"], ["a", "b", "c"])],
    },
    "rig.drive[1]": {"height": NOT_NEGATIVE, "angle_deg": TURN, "mass": [(0.0, -1e-9), (10.0, 10.001)]},
    "rig.sensor[1]": {"count": COUNT_1000},
    "rig.test.troubles": {
        "colour": [(-2.0, -2.001), (4.0, 4.001)], "coherent": SHARE, "setups": COUNT_1000,
        "shift": [(0.0, -1e-9), (0.05, 0.0501)], "dead": [(0, -1)], "noisy": [(0, -1)], "swapped": [(0, -1)],
        "flipped": [(0, -1)], "double_hit": [(0.0, -1e-9), (0.99, 0.991)], "exponential": NOT_NEGATIVE,
        "pre_trigger": NOT_NEGATIVE, "fixture": [(0, -1), (100, 101)], "phase_deg": [(0.0, -1e-9), (90.0, 90.001)],
    },
    "rig.test": {
        "band_hz": PAIR, "blocks": [(1, 0), (10_000, 10_001)], "force": POSITIVE, "part": [(1e-9, 0.0), (0.999, 1.0)],
        "width": POSITIVE, "snr_db": [(-60.0, -60.001), (300.0, 300.001)], "bits": [(4, 3), (32, 33)],
        "resolution_hz": [(10.0, 10.0001), (1e-5, 0.9999e-5)],
    },
    "rig.scan": {
        "tones_hz": [([1.0], []), ([1.0] * 100, [1.0] * 101)], "drive": [(1, 0)], "mirror_hz": [(-1000.0, -1000.1),
        (1000.0, 1000.1)], "casing_hz": [(-1000.0, -1000.1), (1000.0, 1000.1)], "orders": [(0, -1), (200, 201)],
        "points": [(3, 2), (1000, 1001)], "wander": [(0.0, -1e-9), (0.1, 0.1001)], "speckle": NOT_NEGATIVE,
        "runout": [([[1.0, 2.0]], [[1.0]])],
    },
    "rig": {
        "seed": [(0, -1)], "zeta": [(1e-9, 0.9e-9), (0.999, 1.0)], "zeta_spread": [(0.0, -1e-9), (1.999, 2.0)],
        "drive": [([DRIVE], [])],
    },
}  # fmt: skip


def out_of_range(folder, path, table):
    """Problems with values of a table: those that are not excused."""
    return [problem for problem in problems_at(folder, path, table) if not problem.endswith(OTHERWISE)]


@pytest.mark.filterwarnings("ignore")  # of values that are allowed and not usual
@pytest.mark.parametrize("name", ENDS)
def test_a_key_takes_its_last_value_and_not_the_next(name, tmp_path):
    """A table is named by its path, and by its kind where it has one."""
    path = name.partition(" ")[0]
    for key, ends in ENDS[name].items():
        for taken, refused in ends:
            allowed = out_of_range(tmp_path, path, LEAST[name] | {key: taken})
            assert [problem for problem in allowed if problem.startswith(f"{path}.{key}")] == [], (key, taken)
            found = out_of_range(tmp_path, path, LEAST[name] | {key: refused})
            assert any(problem.startswith((f"{path}.{key}", f"{path}:")) for problem in found), (key, refused)


@pytest.mark.parametrize(("count", "refused"), [(1, False), (1000, False), (0, True), (1001, True)])
def test_nodes_of_an_interface_are_one_to_a_thousand(count, refused, tmp_path):
    assert bool(out_of_range(tmp_path, "reduce", {"at": [1] * count})) is refused


LEFT_OUT = {
    "chart.piece[1]": {"radius": None, "fillet": None, "thickness": None, "material": None},
    "chart dome": {"r0": 0.0},
    "chart blade": {"camber_deg": 0.0, "twist_deg": 0.0, "sweep": 0.0, "lean": 0.0},
    "taper": {"along": 1.0, "across": 1.0},
    "solid": {
        "scale": 1.0, "join": 0.0, "units": None, "tie": [], "material": {}, "sections": None, "cells": [24, 20, 1],
        "disk": None,
    },
    "shell.plies[1]": {"angle_deg": 0.0, "lamina": None},
    "rotation": {"hub_radius": None, "stagger_deg": 0.0, "axis": None, "centre": None, "point": None},
    "imperfection[1].harmonics[1]": {"cos": 0.0, "sin": 0.0},
    "support.base elastic": {"k_r": 0.0, "k_theta": 0.0, "k_z": 0.0, "k_rot": 0.0, "k_face": 0.0, "around": []},
    "support.base bolts": {
        "k_r": None, "k_theta": None, "k_z": None, "k_rot": 0.0, "first_angle_deg": 0.0, "width_deg": None,
        "width_m": None, "spacing_deg": None, "loose": [],
    },
    "modes": {"count": 40, "band_hz": None, "elastic_only": False, "method": "auto"},
    "update.parameter[1]": {"sigma": None, "log": False, "start": None},
    "update": {
        "sigma": None, "outliers": "set-aside", "reach": 0.5, "count": None, "model_error": 0.0, "shape_sigma": None,
        "shape_error": 0.0, "shape_reach": 1e-3, "regularise": None, "regularised": [],
    },
    "reduce": {
        "at": None, "n_max": None, "axial": False, "lines": None, "nodes": None, "axis": None, "point": None,
        "recovery": False, "output": None, "modes": 40, "method": "free", "zeta": 0.0, "out": None,
    },
    "cyclic": {
        "axis": None, "point": None, "faces": None, "tolerance": None, "nodal_diameters": None, "coriolis": False,
        "mistuning": None, "blade": None,
    },
    "rig.sensor[1]": {"angle_deg": 0.0, "at": None, "direction": "radial", "mass": 0.0, "count": 1},
    "rig.test.troubles": {
        "colour": 0.0, "coherent": 0.0, "setups": 1, "shift": 0.0, "half_rim": False, "dead": 0, "noisy": 0,
        "swapped": 0, "flipped": 0, "double_hit": 0.0, "exponential": 0.0, "cut_off": False, "pre_trigger": 0.0,
        "leakage": False, "fixture": 0, "phase_deg": 0.0,
    },
    "rig.test": {
        "blocks": 20, "force": 1.0, "part": 0.4, "width": None, "snr_db": None, "bits": None, "keep_records": False,
        "estimator": "H1", "troubles": None,
    },
    "rig.scan": {
        "force": 1.0, "drive": 1, "fixed_in": "casing", "mirror_hz": 0.0, "casing_hz": 0.0, "points": None,
        "snr_db": None, "wander": 0.0, "speckle": 0.0, "runout": [],
    },
    "rig": {"zeta_spread": 0.0, "quantity": "accelerance", "sensor": [], "test": None, "scan": None},
}  # fmt: skip


@pytest.mark.parametrize("name", LEFT_OUT)
def test_a_key_that_is_left_out_has_what_the_manual_states(name):
    path, _, kind = name.partition(" ")
    kind = kind or ("bolts" if "loose" in path else "meridian" if "piece" in path else "")
    keys = table_schema(cf.study.schema(), path, kind)["properties"]
    given = {key for key in keys if key in LEAST[name]}
    assert {key: part.get("default") for key, part in keys.items() if key not in given} == LEFT_OUT[name]


def test_a_casing_is_reduced_without_lines_and_outputs_that_the_study_does_not_name(tmp_path):
    reduced = study_with(tmp_path, "reduce", {"interface": "top", "n_max": 6}).file.reduce
    assert (reduced.lines, reduced.output) == ([], [])
