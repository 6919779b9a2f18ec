"""Rules between the keys of a table of study.toml: what goes together, what does not, and where the bounds are."""

import pytest
from pydantic import ValidationError

import casingfem as cf
from casingfem.study.tables.fields import CyclicTable, ImperfectionTable
from casingfem.study.tables.rig import PlaceTable, ResponsesTable
from casingfem.study.tables.shapes import RotationTable, ShellTable
from casingfem.study.tables.supports import BoltsTable, ElasticTable, RingTable
from casingfem.study.tables.tasks import ModesTable, OutputTable, ReduceTable, UpdateTable

PARAMETER = {"name": "material.E", "lower": 1.0, "upper": 2.0}
WAVES = [{"p": 2, "median": 0.1}]
TEST = {"kind": "exact", "band_hz": [10.0, 20.0], "resolution_hz": 1.0}
PLY = {"thickness": 1e-3}
CARBON = {"E1": 1e11, "E2": 1e10, "nu12": 0.3, "G12": 1e9, "G13": 1e9, "G23": 1e9, "rho": 1500.0}


@pytest.mark.parametrize(
    ("table", "keys"),
    [
        (ImperfectionTable, {"of": "density", "harmonics": []}),
        (ImperfectionTable, {"of": "radius", "survey": "a.csv", "n_max": 3, "degree": 0, "robust": False,
                             "centred": False}),
        (ImperfectionTable, {"of": "radius", "random": "example", "seed": 0, "scale": 2.0, "p_max": 9}),
        (ImperfectionTable, {"of": "thickness", "random": WAVES, "seed": 0}),
        (ResponsesTable, TEST | {"resolution_hz": 10.0}),
        (ResponsesTable, TEST | {"resolution_hz": 1e-5}),
        (ResponsesTable, TEST | {"snr_db": 0.0, "troubles": {}}),
        (ResponsesTable, TEST | {"kind": "random", "bits": 12, "keep_records": True}),
        (PlaceTable, {"at": [0.0, 0.0]}),
        (BoltsTable, {"kind": "bolts", "count": 4, "k": 0.0}),
        (BoltsTable, {"kind": "bolts", "count": 4, "k_theta": 0.0}),
        (ShellTable, {"thickness": 2e-3, "plies": [PLY, PLY]}),
        (ShellTable, {"thickness": 2e-3, "plies": [PLY, {"thickness": 1.0000019e-3}]}),
        (ShellTable, {"thickness": 2e-3, "plies": [PLY, {"thickness": 0.9999981e-3}]}),
        (ShellTable, {"thickness": 1e-3, "plies": [PLY | {"lamina": "carbon"}], "lamina": {"carbon": CARBON}}),
        (ShellTable, {"thickness": 1e-3, "mesh": "a.inp", "scale": 1e-3, "join": 0.0, "angle_from": "x"}),
        (OutputTable, {"name": "a", "at": [0.0, 0.0], "strain": "12", "side": 0.0}),
        (OutputTable, {"name": "a", "node": 0, "strain": "yz"}),
        (ReduceTable, {"at": [3]}),
        (CyclicTable, {"sectors": 2, "mistuning": [0.0, 0.1], "blade": "vane"}),
        (RotationTable, {"speed_hz": 0.0, "centre": [0.0, 0.0, 0.0]}),
        (RotationTable, {"speed_hz": 0.0, "point": [0.0, 0.0, 0.0]}),
    ],
)  # fmt: skip
def test_these_keys_go_together(table, keys):
    table.model_validate(keys)


OF = {"of": "radius"}
BOLTS = {"kind": "bolts", "count": 4}


@pytest.mark.parametrize(
    ("table", "keys", "words"),
    [
        (ImperfectionTable, OF, "found neither harmonics nor survey nor random, expected one of harmonics, "),
        (ImperfectionTable, OF | {"harmonics": [], "survey": "a"}, "found harmonics beside survey, expected"),
        (ImperfectionTable, OF | {"harmonics": [], "n_max": 3}, "found n_max beside harmonics, expected with survey "),
        (ImperfectionTable, OF | {"harmonics": [], "degree": 0}, "found degree beside harmonics"),
        (ImperfectionTable, OF | {"harmonics": [], "robust": False}, "found robust beside harmonics"),
        (ImperfectionTable, OF | {"random": "example", "seed": 1, "centred": False}, "found centred beside random"),
        (ImperfectionTable, OF | {"survey": "a", "seed": 0, "scale": 1.0, "p_max": 2},
         "found seed, scale, p_max beside survey, expected with random only"),
        (ImperfectionTable, OF | {"random": "example"}, "found random without seed"),
        (ImperfectionTable, {"of": "modulus", "random": "example", "seed": 1}, 'found random = "example" of modulus'),
        (ResponsesTable, TEST | {"band_hz": [20.0, 20.0]}, "expected two frequencies in order"),
        (ResponsesTable, TEST | {"resolution_hz": 10.0001}, "expected 2 to 1,000,000 lines"),
        (ResponsesTable, TEST | {"resolution_hz": 0.99999e-5}, "expected 2 to 1,000,000 lines"),
        (ResponsesTable, TEST | {"troubles": {}}, 'found troubles, expected kind = "exact" and snr_db'),
        (ResponsesTable, TEST | {"kind": "impact", "snr_db": 9.0, "troubles": {}}, "found troubles, expected kind"),
        (ResponsesTable, TEST | {"bits": 12}, "found bits with exact responses"),
        (ResponsesTable, TEST | {"keep_records": True}, "found keep_records with exact responses"),
        (PlaceTable, {}, "found height and at, or neither"),
        (PlaceTable, {"height": 0.0, "at": [0.0, 0.0]}, "found height and at, or neither"),
        (BoltsTable, BOLTS, "found neither k nor k_r, k_theta, k_z, expected one of the two"),
        (BoltsTable, BOLTS | {"k": 1.0, "k_z": 0.0}, "found k beside k_z, expected one of the two"),
        (BoltsTable, BOLTS | {"k": 1.0, "width_deg": 1.0, "width_m": 0.1}, "found both width_deg and width_m"),
        (BoltsTable, BOLTS | {"k": 1.0, "loose": [{"bolt": 2, "factor": 0.0}] * 2}, r"found bolts \[2, 2\], expected"),
        (RingTable, {"kind": "ring"}, "found no section, expected width and depth, or diameter"),
        (RingTable, {"kind": "ring", "width": 0.1, "depth": 0.1, "diameter": 0.1}, "found width, depth, diameter"),
        (RingTable, {"kind": "ring", "diameter": 0.1, "support": {"kind": "clamped"}}, "support"),
        (ElasticTable, {"kind": "elastic", "around": {"k_q": []}}, "k_q"),
        (ShellTable, {"thickness": 2e-3, "plies": [PLY]}, "found plies of 0.001 m in a wall of 0.002 m"),
        (ShellTable, {"thickness": 2e-3, "plies": [PLY, {"thickness": 1.000003e-3}]}, "found plies of"),
        (ShellTable, {"thickness": 2e-3, "plies": [PLY, {"thickness": 0.999997e-3}]}, "found plies of"),
        (ShellTable, {"thickness": 1e-3, "plies": [PLY | {"lamina": "tin"}]}, "expected one of: none"),
        (ShellTable, {"thickness": 1e-3, "join": 0.0}, "expected them with a mesh only"),
        (ShellTable, {"thickness": 1e-3, "thicknesses": {}}, "expected them with a mesh only"),
        (ModesTable, {"count": 40, "band_hz": [1.0, 2.0]}, "found count and band_hz"),
        (ModesTable, {"band_hz": [2.0, 2.0]}, "expected two frequencies in order"),
        (UpdateTable, {"table": "a", "parameter": [PARAMETER], "shape_sigma": 0.1, "shape_reach": 1e-3},
         "found shape_reach, shape_sigma without shapes"),
        (OutputTable, {"name": "a", "at": [0.0, 0.0]}, "do not go together"),
        (OutputTable, {"name": "a", "at": [0.0, 0.0], "strain": "11", "direction": "x"}, "do not go together"),
        (OutputTable, {"name": "a", "at": [0.0, 0.0], "direction": "x", "side": 1.0}, "do not go together"),
        (OutputTable, {"name": "a", "strain": "11"}, "found at and node, or neither"),
        (OutputTable, {"name": "a", "at": [0.0, 0.0], "node": 1, "strain": "11"}, "found at and node, or neither"),
        (OutputTable, {"name": "a", "at": [0.0, 0.0], "stress": "xx"}, "found 'xx' at a place of a chart"),
        (OutputTable, {"name": "a", "at": [0.0, 0.0], "strain": "xy"}, "found 'xy' at a place of a chart"),
        (OutputTable, {"name": "a", "node": 1, "strain": "22"}, "found a strain of the wall at a node"),
        (OutputTable, {"name": "a", "node": 1, "strain": "xx", "side": 0.0}, "found a strain of the wall at a node"),
        (ReduceTable, {}, "found none of interface, lines and at, expected one"),
        (ReduceTable, {"interface": "top", "at": [1]}, "found interface and at, expected one"),
        (CyclicTable, {"sectors": 2, "blade": "vane"}, "found blade without mistuning"),
        (RotationTable, {"speed_hz": 0.0, "centre": [0.0] * 3, "point": [0.0] * 3}, "found centre and point"),
    ],
)  # fmt: skip
def test_these_keys_do_not_go_together(table, keys, words):
    with pytest.raises(ValidationError, match=words):
        table.model_validate(keys)


@pytest.mark.parametrize(
    ("keys", "output"),
    [
        ({"node": 0, "direction": "y"}, cf.modal.NodeDisplacement(name="a", node=0, direction="y")),
        ({"node": 7, "strain": "yz"}, cf.modal.NodeStrain(name="a", node=7, component="yz")),
        ({"node": 7, "stress": "xx"}, cf.modal.NodeStress(name="a", node=7, component="xx")),
        ({"at": [0.1, 0.2], "direction": "normal"}, cf.modal.Displacement(name="a", at=(0.1, 0.2), direction="normal")),
        ({"at": [0.1, 0.2], "strain": "22"}, cf.modal.Strain(name="a", at=(0.1, 0.2), component="22", side=1.0)),
        (
            {"at": [0.1, 0.2], "strain": "12", "side": 0.0},
            cf.modal.Strain(name="a", at=(0.1, 0.2), component="12", side=0.0),
        ),
        (
            {"at": [0.1, 0.2], "strain": "11", "side": -1.0},
            cf.modal.Strain(name="a", at=(0.1, 0.2), component="11", side=-1.0),
        ),
    ],
)
def test_an_output_is_what_its_keys_state(keys, output):
    assert OutputTable(name="a", **keys).output() == output


def test_patterns_of_springs_are_one_list_or_one_for_each():
    every = ElasticTable(kind="elastic", around=[{"p": 3, "cos": 0.5}])
    assert [(wave.p, wave.cos) for wave in every.around] == [(3, 0.5)]
    each = ElasticTable(kind="elastic", around={"k_z": [{"p": 4}]})
    assert ([wave.p for wave in each.around.k_z], each.around.k_r) == ([4], [])
