"""Rules between the keys of a table of study.toml: what goes together, what does not, and where the bounds are."""

import re

import pytest

import casingfem as cf
from tests.casingfem.study.study_tables import TEST, problems_at, study_with

PARAMETER = {"name": "material.E", "lower": 1.0, "upper": 2.0}
WAVES = [{"p": 2, "median": 0.1}]
PLY = {"thickness": 1e-3}
CARBON = {"E1": 1e11, "E2": 1e10, "nu12": 0.3, "G12": 1e9, "G13": 1e9, "G23": 1e9, "rho": 1500.0}


@pytest.mark.parametrize(
    ("path", "keys"),
    [
        ("imperfection[1]", {"of": "density", "harmonics": []}),
        ("imperfection[1]", {"of": "radius", "survey": "a.csv", "n_max": 3, "degree": 0, "robust": False,
                             "centred": False}),
        ("imperfection[1]", {"of": "radius", "random": "example", "seed": 0, "scale": 2.0, "p_max": 9}),
        ("imperfection[1]", {"of": "thickness", "random": WAVES, "seed": 0}),
        ("rig.test", TEST | {"resolution_hz": 10.0}),
        ("rig.test", TEST | {"resolution_hz": 1e-5}),
        ("rig.test", TEST | {"snr_db": 0.0, "troubles": {}}),
        ("rig.test", TEST | {"kind": "random", "bits": 12, "keep_records": True}),
        ("rig.drive[1]", {"at": [0.0, 0.0]}),
        ("support.base", {"kind": "bolts", "count": 4, "k": 0.0}),
        ("support.base", {"kind": "bolts", "count": 4, "k_theta": 0.0}),
        ("shell", {"thickness": 2e-3, "plies": [PLY, PLY]}),
        ("shell", {"thickness": 2e-3, "plies": [PLY, {"thickness": 1.0000019e-3}]}),
        ("shell", {"thickness": 2e-3, "plies": [PLY, {"thickness": 0.9999981e-3}]}),
        ("shell", {"thickness": 1e-3, "plies": [PLY | {"lamina": "carbon"}], "lamina": {"carbon": CARBON}}),
        ("shell", {"thickness": 1e-3, "mesh": "a.inp", "scale": 1e-3, "join": 0.0, "angle_from": "x"}),
        ("reduce.output[1]", {"name": "a", "at": [0.0, 0.0], "strain": "12", "side": 0.0}),
        ("reduce.output[1]", {"name": "a", "node": 0, "strain": "yz"}),
        ("reduce", {"at": [3]}),
        ("cyclic", {"sectors": 2, "mistuning": [0.0, 0.1], "blade": "vane"}),
        ("rotation", {"speed_hz": 0.0, "centre": [0.0, 0.0, 0.0]}),
        ("rotation", {"speed_hz": 0.0, "point": [0.0, 0.0, 0.0]}),
    ],
)  # fmt: skip
def test_these_keys_go_together(path, keys, tmp_path):
    """No rule refuses them; a file that a key names may be missing, and a chart has no nodes."""
    assert [problem for problem in problems_at(tmp_path, path, keys) if "[study-value]" in problem] == []


OF = {"of": "radius"}
BOLTS = {"kind": "bolts", "count": 4}


@pytest.mark.parametrize(
    ("path", "keys", "words"),
    [
        ("imperfection[1]", OF, "found neither harmonics nor survey nor random, expected one of harmonics, "),
        ("imperfection[1]", OF | {"harmonics": [], "survey": "a"}, "found harmonics beside survey, expected"),
        ("imperfection[1]", OF | {"harmonics": [], "n_max": 3}, "found n_max beside harmonics, expected with survey "),
        ("imperfection[1]", OF | {"harmonics": [], "degree": 0}, "found degree beside harmonics"),
        ("imperfection[1]", OF | {"harmonics": [], "robust": False}, "found robust beside harmonics"),
        ("imperfection[1]", OF | {"random": "example", "seed": 1, "centred": False}, "found centred beside random"),
        ("imperfection[1]", OF | {"survey": "a", "seed": 0, "scale": 1.0, "p_max": 2},
         "found seed, scale, p_max beside survey, expected with random only"),
        ("imperfection[1]", OF | {"random": "example"}, "found random without seed"),
        ("imperfection[1]", {"of": "modulus", "random": "example", "seed": 1}, 'found random = "example" of modulus'),
        ("rig.test", TEST | {"band_hz": [20.0, 20.0]}, "expected two frequencies in order"),
        ("rig.test", TEST | {"resolution_hz": 10.0001}, "expected 2 to 1,000,000 lines"),
        ("rig.test", TEST | {"resolution_hz": 0.99999e-5}, "expected 2 to 1,000,000 lines"),
        ("rig.test", TEST | {"troubles": {}}, 'found troubles, expected kind = "exact" and snr_db'),
        ("rig.test", TEST | {"kind": "impact", "snr_db": 9.0, "troubles": {}}, "found troubles, expected kind"),
        ("rig.test", TEST | {"bits": 12}, "found bits with exact responses"),
        ("rig.test", TEST | {"keep_records": True}, "found keep_records with exact responses"),
        ("rig.drive[1]", {}, "found height and at, or neither"),
        ("rig.drive[1]", {"height": 0.0, "at": [0.0, 0.0]}, "found height and at, or neither"),
        ("support.base", BOLTS, "found neither k nor k_r, k_theta, k_z, expected one of the two"),
        ("support.base", BOLTS | {"k": 1.0, "k_z": 0.0}, "found k beside k_z, expected one of the two"),
        ("support.base", BOLTS | {"k": 1.0, "width_deg": 1.0, "width_m": 0.1}, "found both width_deg and width_m"),
        ("support.base", BOLTS | {"k": 1.0, "loose": [{"bolt": 2, "factor": 0.0}] * 2},
         r"found bolts \[2, 2\], expected"),
        ("support.base", {"kind": "ring"}, "found no section, expected width and depth, or diameter"),
        ("support.base", {"kind": "ring", "width": 0.1, "depth": 0.1, "diameter": 0.1}, "found width, depth, diameter"),
        ("support.base", {"kind": "ring", "diameter": 0.1, "support": {"kind": "clamped"}}, "support"),
        ("support.base", {"kind": "elastic", "around": {"k_q": []}}, "k_q"),
        ("shell", {"thickness": 2e-3, "plies": [PLY]}, "found plies of 0.001 m in a wall of 0.002 m"),
        ("shell", {"thickness": 2e-3, "plies": [PLY, {"thickness": 1.000003e-3}]}, "found plies of"),
        ("shell", {"thickness": 2e-3, "plies": [PLY, {"thickness": 0.999997e-3}]}, "found plies of"),
        ("shell", {"thickness": 1e-3, "plies": [PLY | {"lamina": "tin"}]}, "expected one of: none"),
        ("shell", {"thickness": 1e-3, "join": 0.0}, "expected them with a mesh only"),
        ("shell", {"thickness": 1e-3, "thicknesses": {}}, "expected them with a mesh only"),
        ("modes", {"count": 40, "band_hz": [1.0, 2.0]}, "found count and band_hz"),
        ("modes", {"band_hz": [2.0, 2.0]}, "expected two frequencies in order"),
        ("update", {"table": "a", "parameter": [PARAMETER], "shape_sigma": 0.1, "shape_reach": 1e-3},
         "found shape_reach, shape_sigma without shapes"),
        ("reduce.output[1]", {"name": "a", "at": [0.0, 0.0]}, "do not go together"),
        ("reduce.output[1]", {"name": "a", "at": [0.0, 0.0], "strain": "11", "direction": "x"}, "do not go together"),
        ("reduce.output[1]", {"name": "a", "at": [0.0, 0.0], "direction": "x", "side": 1.0}, "do not go together"),
        ("reduce.output[1]", {"name": "a", "strain": "11"}, "found at and node, or neither"),
        ("reduce.output[1]", {"name": "a", "at": [0.0, 0.0], "node": 1, "strain": "11"},
         "found at and node, or neither"),
        ("reduce.output[1]", {"name": "a", "at": [0.0, 0.0], "stress": "xx"}, "found 'xx' at a place of a chart"),
        ("reduce.output[1]", {"name": "a", "at": [0.0, 0.0], "strain": "xy"}, "found 'xy' at a place of a chart"),
        ("reduce.output[1]", {"name": "a", "node": 1, "strain": "22"}, "found a strain of the wall at a node"),
        ("reduce.output[1]", {"name": "a", "node": 1, "strain": "xx", "side": 0.0},
         "found a strain of the wall at a node"),
        ("reduce", {}, "found none of interface, lines and at, expected one"),
        ("reduce", {"interface": "top", "at": [1]}, "found interface and at, expected one"),
        ("cyclic", {"sectors": 2, "blade": "vane"}, "found blade without mistuning"),
        ("rotation", {"speed_hz": 0.0, "centre": [0.0] * 3, "point": [0.0] * 3}, "found centre and point"),
    ],
)  # fmt: skip
def test_these_keys_do_not_go_together(path, keys, words, tmp_path):
    assert re.search(words, "\n".join(problems_at(tmp_path, path, keys)))


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
def test_an_output_is_what_its_keys_state(keys, output, tmp_path):
    (found,) = study_with(tmp_path, "reduce.output[1]", {"name": "a", **keys}).file.reduce.output
    assert found.output() == output


def test_patterns_of_springs_are_one_list_or_one_for_each(tmp_path):
    elastic = {"kind": "elastic", "k_r": 1e8, "k_z": 1e8}
    every = study_with(tmp_path, "support.base", elastic | {"around": [{"p": 3, "cos": 0.5}]}).structure.supports[
        "base"
    ]
    assert (every.around.p.tolist(), every.around.cos.ravel().tolist()) == ([3], [0.5])
    each = study_with(tmp_path, "support.base", elastic | {"around": {"k_z": [{"p": 4}]}}).structure.supports["base"]
    assert list(each.around) == ["k_z"]
    assert each.around["k_z"].p.tolist() == [4]
