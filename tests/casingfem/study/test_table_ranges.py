"""Keys of study.toml: the last value that is taken and the first that is not; what represents keys left out."""

import pytest
from pydantic import ValidationError

from casingfem.study.tables.fields import CyclicTable, Harmonic, ImperfectionTable, Wave
from casingfem.study.tables.rig import PlaceTable, ResponsesTable, RigTable, ScanTable, SensorTable, TroublesTable
from casingfem.study.tables.shapes import (
    BladeTable,
    CylinderTable,
    DomeTable,
    LaminaTable,
    MassTable,
    MaterialTable,
    MeridianTable,
    MeshTable,
    PanelTable,
    PieceTable,
    PlyTable,
    RotationTable,
    ShellTable,
    SolidTable,
    StripTable,
    TaperTable,
    TieTable,
    TwistedPlateTable,
)
from casingfem.study.tables.supports import (
    BoltsTable,
    ElasticTable,
    FixedTable,
    LooseTable,
    RingTable,
    SpringsAround,
    StiffenerTable,
)
from casingfem.study.tables.tasks import ModesTable, OutputTable, ParameterTable, ReduceTable, UpdateTable

DRIVE = {"height": 0.1}
PARAMETER = {"name": "material.E", "lower": 1.0, "upper": 2.0}
# what each table cannot do without
LEAST = {
    MaterialTable: {"E": 2e11, "nu": 0.3, "rho": 7800.0},
    CylinderTable: {"kind": "cylinder", "radius": 0.5, "height": 0.2},
    PanelTable: {"kind": "panel", "radius": 0.5, "length": 0.2, "angle": 1.0},
    DomeTable: {"kind": "dome", "radius": 0.5, "start_deg": 0.0, "end_deg": 60.0},
    PieceTable: {"to": [0.5, 0.2]},
    MeridianTable: {"kind": "meridian", "start": [0.5, 0.0], "piece": [{"to": [0.5, 0.2]}]},
    TwistedPlateTable: {"kind": "twisted-plate", "length": 0.2, "width": 0.1, "twist_deg": 30.0},
    BladeTable: {"kind": "blade", "length": 0.2, "chord": 0.1},
    TaperTable: {},
    TieTable: {"follower": "a", "master": "b"},
    SolidTable: {"mesh": "a.inp"},
    LaminaTable: {"E1": 1e11, "E2": 1e10, "nu12": 0.3, "G12": 1e9, "G13": 1e9, "G23": 1e9, "rho": 1500.0},
    PlyTable: {"thickness": 1e-3},
    ShellTable: {"thickness": 3e-3},
    StripTable: {"from": 0.0, "to": 0.1, "thickness": 3e-3},
    MassTable: {"edge": "top", "angle_deg": 0.0, "mass": 0.1},
    MeshTable: {},
    RotationTable: {"speed_hz": 100.0},
    Harmonic: {"p": 2},
    Wave: {"p": 2, "median": 0.1},
    ImperfectionTable: {"of": "radius", "survey": "a.csv"},
    SpringsAround: {},
    ElasticTable: {"kind": "elastic"},
    FixedTable: {"kind": "fixed", "directions": ["x"]},
    LooseTable: {"bolt": 1, "factor": 0.5},
    BoltsTable: {"kind": "bolts", "count": 4, "k": 1e8},
    RingTable: {"kind": "ring", "diameter": 0.01},
    StiffenerTable: {"at": 0.1, "offset": [0.01, 0.0], "diameter": 0.01},
    ModesTable: {},
    ParameterTable: PARAMETER,
    UpdateTable: {"table": "a.csv", "shapes": "a.uff", "parameter": [PARAMETER]},
    OutputTable: {"name": "root", "at": [0.0, 0.1], "strain": "11"},
    ReduceTable: {"interface": "top"},
    CyclicTable: {"sectors": 6},
    PlaceTable: {"height": 0.1},
    SensorTable: {"height": 0.1},
    TroublesTable: {},
    ResponsesTable: {"kind": "random", "band_hz": [10.0, 20.0], "resolution_hz": 1.0},
    ScanTable: {"height": 0.1, "tones_hz": [10.0], "seconds": 1.0, "fs": 100.0, "orders": 5},
    RigTable: {"seed": 0, "zeta": 0.01, "drive": [DRIVE]},
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
    MaterialTable: {"E": POSITIVE, "nu": [(-0.999, -1.0), (0.499, 0.5)], "rho": POSITIVE},
    CylinderTable: {"radius": LENGTH, "height": LENGTH},
    PanelTable: {"angle": [(1e-25, 0.0), (6.28318, 6.283185307179586)]},
    DomeTable: {"start_deg": TURN, "end_deg": TURN, "r0": [(-1e3, -1000.1), (1e3, 1000.1)]},
    PieceTable: {"to": PAIR, "radius": [(-1e3, -1000.1), (1e3, 1000.1)], "thickness": LENGTH, "fillet": LENGTH},
    MeridianTable: {"start": PAIR, "piece": [([{"to": [1.0, 2.0]}], [])]},
    TwistedPlateTable: {"twist_deg": TURN},
    BladeTable: {
        "chord": [*STATIONS, *LENGTH, ([1e-7], [0.0])],
        "twist_deg": [*TURN, *STATIONS], "camber_deg": [*TURN, *STATIONS],
    },
    TaperTable: {"along": [*STATIONS, (1e-3, 0.0), (1e3, 1001.0)], "across": STATIONS},
    PlyTable: {"angle_deg": TURN},
    TieTable: {"follower": [("a", "")], "master": [("b", "")], "tolerance": POSITIVE},
    SolidTable: {"mesh": [("a", "")], "scale": POSITIVE, "join": NOT_NEGATIVE},
    ShellTable: {"mesh": [("a", "")], "thickness": LENGTH},
    StripTable: {"from": [(-1e3, -1000.1), (0.0999, 0.1)], "to": [(0.0001, 0.0), (1e3, 1000.1)]},
    MassTable: {"edge": [("a", "")], "angle_deg": TURN, "mass": NOT_NEGATIVE},
    MeshTable: {"order": [(2, 1), (20, 21)], "rows": COUNT_1000, "around": [(1, 0), (10_000, 10_001)]},
    RotationTable: {
        "speed_hz": [(0.0, -1e-9), (1e5, 100_000.1)], "hub_radius": [(0.0, -1e-9), (1e3, 1000.1)],
        "stagger_deg": TURN, "axis": THREE, "centre": THREE,
    },
    Harmonic: {"p": [(0, -1), (1000, 1001)], "cos": RELATIVE, "sin": RELATIVE},
    Wave: {"p": COUNT_1000, "median": [(1e-9, 0.9e-9), (1.0, 1.0001)], "high": [(1e-9, 0.0), (1.0, 1.0001)]},
    ImperfectionTable: {"survey": [("a", "")], "n_max": COUNT_1000, "degree": [(0, -1), (20, 21)]},
    ElasticTable: {"k_r": NOT_NEGATIVE},
    FixedTable: {"directions": [(["z"], [])]},
    LooseTable: {"bolt": COUNT_1000, "factor": [(0.0, -1e-9), (1e6, 1.001e6)]},
    BoltsTable: {
        "count": COUNT_1000, "first_angle_deg": TURN, "width_deg": [(1e-3, 0.9e-3), (360.0, 360.001)],
        "spacing_deg": [(1e-3, 0.9e-3), (360.0, 360.001)],
    },
    RingTable: {"offset": PAIR, "foot": PAIR},
    StiffenerTable: {"at": [(-1e3, -1000.1), (1e3, 1000.1)], "offset": PAIR},
    ModesTable: {"count": [(1, 0), (100_000, 100_001)], "band_hz": PAIR},
    ParameterTable: {"name": [("a", "")], "sigma": POSITIVE},
    UpdateTable: {
        "table": [("a", "")], "shapes": [("a", "")], "sigma": [(1e-25, 0.0), (0.9999, 1.0)], "reach": POSITIVE,
        "count": [(1, 0), (100_000, 100_001)], "model_error": BELOW_1, "shape_error": BELOW_1,
        "parameter": [([PARAMETER], [])],
    },
    OutputTable: {"name": [("a", "")], "at": PAIR, "side": RELATIVE},
    ReduceTable: {
        "interface": [("a", "")], "n_max": COUNT_1000, "nodes": [(1, 0), (100, 101)],
        "modes": [(1, 0), (100_000, 100_001)], "zeta": BELOW_1, "out": [("a.npz", "b/a.npz"), ("a.npz", "a.npy")],
    },
    CyclicTable: {
        "sectors": [(2, 1), (1000, 1001)], "nodal_diameters": [([0], [])], "tolerance": POSITIVE, "point": THREE,
        "faces": [(["a", "b"], ["a"]), (["a", "b"], ["a", "b", "c"])],
    },
    PlaceTable: {"height": NOT_NEGATIVE, "angle_deg": TURN, "mass": [(0.0, -1e-9), (10.0, 10.001)]},
    SensorTable: {"count": COUNT_1000},
    TroublesTable: {
        "colour": [(-2.0, -2.001), (4.0, 4.001)], "coherent": SHARE, "setups": COUNT_1000,
        "shift": [(0.0, -1e-9), (0.05, 0.0501)], "dead": [(0, -1)], "noisy": [(0, -1)], "swapped": [(0, -1)],
        "flipped": [(0, -1)], "double_hit": [(0.0, -1e-9), (0.99, 0.991)], "exponential": NOT_NEGATIVE,
        "pre_trigger": NOT_NEGATIVE, "fixture": [(0, -1), (100, 101)], "phase_deg": [(0.0, -1e-9), (90.0, 90.001)],
    },
    ResponsesTable: {
        "band_hz": PAIR, "blocks": [(1, 0), (10_000, 10_001)], "force": POSITIVE, "part": [(1e-9, 0.0), (0.999, 1.0)],
        "width": POSITIVE, "snr_db": [(-60.0, -60.001), (300.0, 300.001)], "bits": [(4, 3), (32, 33)],
        "resolution_hz": [(10.0, 10.0001), (1e-5, 0.9999e-5)],
    },
    ScanTable: {
        "tones_hz": [([1.0], []), ([1.0] * 100, [1.0] * 101)], "drive": [(1, 0)], "mirror_hz": [(-1000.0, -1000.1),
        (1000.0, 1000.1)], "casing_hz": [(-1000.0, -1000.1), (1000.0, 1000.1)], "orders": [(0, -1), (200, 201)],
        "points": [(3, 2), (1000, 1001)], "wander": [(0.0, -1e-9), (0.1, 0.1001)], "speckle": NOT_NEGATIVE,
        "runout": [([[1.0, 2.0]], [[1.0]])],
    },
    RigTable: {
        "seed": [(0, -1)], "zeta": [(1e-9, 0.9e-9), (0.999, 1.0)], "zeta_spread": [(0.0, -1e-9), (1.999, 2.0)],
        "drive": [([DRIVE], [])],
    },
}  # fmt: skip


@pytest.mark.parametrize("table", ENDS, ids=lambda table: table.__name__)
def test_a_key_takes_its_last_value_and_not_the_next(table):
    for key, ends in ENDS[table].items():
        for taken, refused in ends:
            table.model_validate({**LEAST[table], key: taken})
            with pytest.raises(ValidationError) as caught:
                table.model_validate({**LEAST[table], key: refused})
            assert caught.value.errors()[0]["loc"][:1] in ((key,), ()), (key, refused)


def test_nodes_of_an_interface_are_one_to_a_thousand():
    for count in (1, 1000):
        assert ReduceTable(at=[1] * count).at == [1] * count
    for count in (0, 1001):
        with pytest.raises(ValidationError, match="at"):
            ReduceTable(at=[1] * count)


LEFT_OUT = {
    PieceTable: {"radius": None, "fillet": None, "thickness": None, "material": None},
    DomeTable: {"r0": 0.0},
    BladeTable: {"camber_deg": 0.0, "twist_deg": 0.0, "sweep": 0.0, "lean": 0.0},
    TaperTable: {"along": 1.0, "across": 1.0},
    SolidTable: {
        "scale": 1.0, "join": 0.0, "units": None, "tie": [], "material": {}, "sections": None, "cells": [24, 20, 1],
        "disk": None,
    },
    PlyTable: {"angle_deg": 0.0, "lamina": None},
    RotationTable: {"hub_radius": None, "stagger_deg": 0.0, "axis": None, "centre": None, "point": None},
    Harmonic: {"cos": 0.0, "sin": 0.0},
    ElasticTable: {"k_r": 0.0, "k_theta": 0.0, "k_z": 0.0, "k_rot": 0.0, "k_face": 0.0, "around": []},
    BoltsTable: {
        "k_r": None, "k_theta": None, "k_z": None, "k_rot": 0.0, "first_angle_deg": 0.0, "width_deg": None,
        "width_m": None, "spacing_deg": None, "loose": [],
    },
    ModesTable: {"count": 40, "band_hz": None, "elastic_only": False, "method": "auto"},
    ParameterTable: {"sigma": None, "log": False, "start": None},
    UpdateTable: {
        "sigma": None, "outliers": "set-aside", "reach": 0.5, "count": None, "model_error": 0.0, "shape_sigma": None,
        "shape_error": 0.0, "shape_reach": 1e-3, "regularise": None, "regularised": [],
    },
    ReduceTable: {
        "at": None, "n_max": None, "axial": False, "lines": [], "nodes": None, "axis": None, "point": None,
        "recovery": False, "output": [], "modes": 40, "method": "free", "zeta": 0.0, "out": None,
    },
    CyclicTable: {
        "axis": None, "point": None, "faces": None, "tolerance": None, "nodal_diameters": None, "coriolis": False,
        "mistuning": None, "blade": None,
    },
    SensorTable: {"angle_deg": 0.0, "at": None, "direction": "radial", "mass": 0.0, "count": 1},
    TroublesTable: {
        "colour": 0.0, "coherent": 0.0, "setups": 1, "shift": 0.0, "half_rim": False, "dead": 0, "noisy": 0,
        "swapped": 0, "flipped": 0, "double_hit": 0.0, "exponential": 0.0, "cut_off": False, "pre_trigger": 0.0,
        "leakage": False, "fixture": 0, "phase_deg": 0.0,
    },
    ResponsesTable: {
        "blocks": 20, "force": 1.0, "part": 0.4, "width": None, "snr_db": None, "bits": None, "keep_records": False,
        "estimator": "H1", "troubles": None,
    },
    ScanTable: {
        "force": 1.0, "drive": 1, "fixed_in": "casing", "mirror_hz": 0.0, "casing_hz": 0.0, "points": None,
        "snr_db": None, "wander": 0.0, "speckle": 0.0, "runout": [],
    },
    RigTable: {"zeta_spread": 0.0, "quantity": "accelerance", "sensor": [], "test": None, "scan": None},
}  # fmt: skip


@pytest.mark.parametrize("table", LEFT_OUT, ids=lambda table: table.__name__)
def test_a_key_that_is_left_out_has_what_the_manual_states(table):
    whole = table.model_validate(LEAST[table])
    assert {key: getattr(whole, key) for key in type(whole).model_fields if key not in whole.model_fields_set} == (
        LEFT_OUT[table]
    )
