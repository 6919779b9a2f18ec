"""Tables of scene files: values at a bound and just beyond it, keys left out, keys that exclude others."""

import math

import pytest
from pydantic import ValidationError

from contact.scene.beams import BeamTable, CantileverTable, CircleTable, RingTable, StopTable
from contact.scene.cycles import CyclesContact, DriveTable
from contact.scene.laws import CoatingTable
from contact.scene.pair import BladeModeTable, CasingPairTable, PairContact
from contact.scene.parts import RecordTable
from contact.scene.patch import GroundTable, PatchBodyTable, PatchContact
from contact.scene.rim import BladeTable, CasingTable, DiskCasingTable, DiskPairTable, DiskTable, RimContact, RimHead
from contact.scene.rods import MassTable, RodsHead, RodTable, WallTable
from contact.scene.roundness import GapTable, RandomRoundness, SpectrumLine
from contact.scene.rub import RubBlade, RubCasing, RubGravity, RubNode, RubSpeed, RubWhirl
from contact.scene.scheme import ModalScheme, ScanTable, SchemeTable, SpeedTable, Waviness
from contact.scene.turning import BasinsTable, ContinuationTable, SpeedRange, VaryTable

SECTION = {"length": 1.0, "width": 0.1, "height": 0.1, "E": 1e9, "rho": 1e3}
RING = {key: value for key, value in SECTION.items() if key != "length"}
ROD = {"length": 1.0, "area": 1.0, "E": 1.0, "rho": 1.0}
COAT = {"E": 1.0, "yield_stress": 1.0, "hardening": 1.0, "thickness": 1.0, "width": 1.0, "tip": 1.0}
DISK = {"blades": 3, "freq_hz": 1.0, "modal_mass": 1.0}
MODE = {"freq_hz": 1.0, "modal_mass": 1.0}
PAIR = {"n": 2, **MODE}
SCAN = {"from_hz": 0.0, "to_hz": 1.0}
HAND = {"omega": [1.0], "channels": ["x"], "rows": [[1.0]]}
NODE = {"span": "span", "flap": "flap"}
TINY, UNDER = 1e-25, -1e-300
BELOW_ONE, BELOW_90 = math.nextafter(1.0, 0.0), math.nextafter(90.0, 0.0)
LINE = {"p": 2, "median": 1.0, "high": 2.0}

# table, other keys, key, what may be there, what may not
BOUNDS = [
    *((SectionOf, SECTION, key, [TINY], [0.0, -1.0]) for SectionOf in (BeamTable, CantileverTable) for key in SECTION),
    (BeamTable, SECTION, "elements", [1], [0]),
    (CantileverTable, SECTION, "zeta", [0.0, BELOW_ONE], [UNDER, 1.0]),
    (CircleTable, {"radius": 1.0}, "offset", [0.0], [UNDER]),
    (CircleTable, {}, "radius", [TINY], [0.0]),
    (StopTable, {}, "clearance", [0.0], [UNDER]),
    *((RingTable, RING, key, [0.0], [UNDER]) for key in ("k_r", "k_t", "zeta")),
    *((RingTable, RING, key, [TINY], [0.0]) for key in ("width", "height", "E", "rho")),
    (RingTable, RING, "n_max", [1, 200], [0, 201]),
    *((CoatingTable, COAT, key, [TINY], [0.0]) for key in ("E", "yield_stress", "thickness", "width", "tip")),
    *((CoatingTable, COAT, key, [0.0], [UNDER]) for key in ("hardening", "machined")),
    (CoatingTable, COAT, "bars", [1, 10_000], [0, 10_001]),
    (CyclesContact, {"normal": "n"}, "stiffness", [TINY], [0.0]),
    (CyclesContact, {"normal": "n"}, "restitution", [0.0, 1.0], [UNDER, 1.0000001]),
    (DiskTable, DISK, "blades", [2, 1000], [1, 1001]),
    *((DiskTable, DISK, key, [TINY], [0.0]) for key in ("freq_hz", "modal_mass")),
    *((DiskTable, DISK, key, [0.0], [UNDER]) for key in ("coupling", "compliance")),
    (DiskTable, DISK, "zeta", [0.0, BELOW_ONE], [UNDER, 1.0]),
    (DiskTable, DISK, "lean_deg", [BELOW_90, -BELOW_90], [90.0, -90.0]),
    (DiskPairTable, PAIR, "radius", [TINY], [0.0]),
    (CasingPairTable, PAIR, "n", [1], [0]),
    *((BladeModeTable, MODE, key, [TINY], [0.0]) for key in ("freq_hz", "modal_mass")),
    (BladeModeTable, MODE, "zeta", [0.0, BELOW_ONE], [UNDER, 1.0]),
    *((PairContact, {}, key, [TINY], [0.0]) for key in ("stiffness", "compliance")),
    (PairContact, {"stiffness": 1.0}, "friction", [0.0], [UNDER]),
    (PairContact, {"stiffness": 1.0}, "lean_deg", [BELOW_90, -BELOW_90], [90.0, -90.0]),
    (GroundTable, {}, "friction", [0.0], [UNDER]),
    (PatchBodyTable, {"channels": ["x"], "rows": [[1.0]]}, "omega", [[0.0]], [[UNDER]]),
    (PatchBodyTable, HAND, "zeta", [[0.0, BELOW_ONE]], [[UNDER], [1.0]]),
    (PatchContact, {"normal": "n"}, "tangent", [[], ["s"], ["s", "t"]], [["s", "t", "u"]]),
    (RecordTable, {}, "every", [1], [0]),
    (RecordTable, {}, "state_every", [0], [-1]),
    (RecordTable, {}, "at", [[0.0]], [[], [UNDER]]),
    (RecordTable, {"state_every": 1}, "channels", [[[1.0]]], [[], [[1.0], [1.0, 2.0]]]),
    (CasingTable, {"basis": "b"}, "scatter", [0.0, 0.2], [UNDER, 0.2000001]),
    (CasingTable, {"basis": "b"}, "seed", [0], [-1]),
    (BladeTable, {"basis": "b"}, "freq_hz", [TINY], [0.0, 0.9 * TINY]),
    (BladeTable, {}, "basis", ["b"], [""]),
    (BladeTable, {"basis": "b"}, "lean_deg", [BELOW_90, -BELOW_90], [90.0, -90.0]),
    (SpectrumLine, LINE, "p", [1, 1000], [0, 1001]),
    (SpectrumLine, LINE, "median", [TINY, 2.0], [0.0, 2.0000001]),
    (SpectrumLine, LINE, "high", [1.0], [0.9999999]),
    (RandomRoundness, {"seed": 0, "rms": 1.0}, "harmonics", [[1], [2, 1000]], [[], [0], [1001], [3, 2], [2, 2]]),
    (RandomRoundness, {"seed": 0}, "spectrum", [[LINE]], [[], [LINE, LINE], [LINE, {**LINE, "p": 1}]]),
    (RandomRoundness, {"seed": 0, "harmonics": [2]}, "rms", [TINY], [0.0]),
    (RandomRoundness, {"harmonics": [2], "rms": 1.0}, "seed", [0], [-1]),
    (GapTable, {"clearance": 0.0}, "friction", [0.0], [UNDER]),
    (GapTable, {"clearance": 0.0, "random_out_of_roundness": {"seed": 0, "spectrum": [LINE]}}, "draw", [0], [-1]),
    (RubCasing, {"basis": "b"}, "thickness", [TINY], [0.0]),
    (RubNode, NODE, "line", [0], [-1]),
    (RubNode, NODE, "track", [0], [-1]),
    (RubBlade, {"basis": "b"}, "count", [1, 1000], [0, 1001]),
    (RubBlade, {"basis": "b"}, "lean_deg", [BELOW_90, -BELOW_90], [90.0, -90.0]),
    (RubGravity, {}, "acceleration", [0.0], [UNDER]),
    (RubGravity, {}, "down_deg", [-360.0, 360.0], [-360.1, 360.1, 1e30]),
    (RimContact, {"clearance": 0.0}, "angle_deg", [-360.0, 360.0], [-360.1, 360.1, 1e30]),
    (RubWhirl, {}, "amplitude", [0.0], [UNDER]),
    (RubSpeed, {"time": [0.0, 1.0]}, "hz", [[1.0, 2.0]], [1.0, [1.0], [1.0, 2.0, 3.0]]),
    (RubSpeed, {}, "hz", [1.0], [[1.0], []]),
    (ScanTable, SCAN, "steps", [2, 1_000_000], [1, 1_000_001]),
    (ScanTable, SCAN, "to_hz", [TINY], [0.0, -1.0]),
    (Waviness, {}, "p", [0, 1000], [-1, 1001]),
    (ModalScheme, {"kind": "exact-modal"}, "dt", [TINY], [0.0]),
    (RimHead, {"kind": "rim"}, "t_end", [TINY], [0.0]),
    (SchemeTable, {"kind": "newmark"}, "dt", [TINY], [0.0]),
    (SchemeTable, {"kind": "newmark"}, "courant", [TINY], [0.0]),
    *((SchemeTable, {"kind": "newmark", "dt": 1.0}, key, [TINY], [0.0]) for key in ("beta", "gamma")),
    (SchemeTable, {"kind": "penalty", "dt": 1.0}, "stiffness", [TINY], [0.0]),
    (SchemeTable, {"kind": "exact-modal"}, "modes", [1], [0]),
    (SchemeTable, {"kind": "hht", "dt": 1.0, "law": "augmented-lagrangian", "stiffness": 1.0}, "updates", [1], [0]),
    (SchemeTable, {"kind": "moreau-jean", "dt": 1.0}, "theta", [0.0, 1.0], [UNDER, 1.0000001]),
    (SchemeTable, {"kind": "nonsmooth-alpha", "dt": 1.0}, "rho_inf", [0.0, 1.0], [UNDER, 1.0000001]),
    *((RodTable, ROD, key, [TINY, 1e25], [0.0, 1.1e25]) for key in ROD),
    (RodTable, ROD, "elements", [1], [0]),
    *((RodTable, ROD, key, [0.0], [UNDER]) for key in ("end_mass", "damping")),
    (MassTable, {}, "mass", [TINY], [0.0]),
    *((MassTable, {"mass": 1.0}, key, [0.0], [UNDER]) for key in ("stiffness", "damping", "force_hz")),
    (RodsHead, {"kind": "rods"}, "t_end", [TINY], [0.0]),
    (ContinuationTable, {}, "longest_step", [1e-6, 1.0], [0.0, 0.9e-6, 1.0000001]),
    (ContinuationTable, {}, "most_points", [2, 10_000_000], [1, 10_000_001]),
    (ContinuationTable, {}, "looks", [8], [7]),
    (ContinuationTable, {}, "doublings", [0], [-1]),
    (BasinsTable, {"at": 1.0, "seed": 0}, "starts", [1, 100_000], [0, 100_001]),
    (BasinsTable, {"at": 1.0, "seed": 0}, "settle", [1], [0]),
    (BasinsTable, {"at": 1.0, "seed": 0}, "spread", [TINY, 1e3], [0.0, 1001.0]),
    (BasinsTable, {"at": 1.0}, "seed", [0], [-1]),
    (VaryTable, {}, "clearance", [[-1.0, 1.0], [1.0, -1.0]], [[], [1.0], [1.0, 1.0], [1.0, 2.0, 3.0]]),
    (VaryTable, {}, "friction", [[0.0, 1.0]], [[UNDER, 1.0], [0.5, 0.5], [0.5]]),
]  # fmt: skip


@pytest.mark.parametrize(
    ("table", "others", "key", "good", "bad"), BOUNDS, ids=[f"{case[0].__name__}-{case[2]}" for case in BOUNDS]
)
def test_values_up_to_their_bounds_are_taken_and_none_beyond(table, others, key, good, bad):
    for value in good:
        assert key in table.model_validate({**others, key: value}).model_fields_set
    for value in bad:
        with pytest.raises(ValidationError):
            table.model_validate({**others, key: value})


LEFT_OUT = [
    (BeamTable(**SECTION), {"elements": 40, "torque": 0.0, "angle_deg": 0.0, "spin": 0.0}),
    (CircleTable(radius=1.0), {"offset": 0.0}),
    (CantileverTable(**SECTION), {"zeta": 0.0, "load": 0.0, "velocity": 0.0}),
    (RingTable(basis="b"), {"k_r": 0.0, "k_t": 0.0, "zeta": 0.0, "n_max": 20, "width": None, "E": None}),
    (CoatingTable(**COAT), {"bars": 6, "machined": 0.0}),
    (CyclesContact(normal="n"), {"slide": 0.0, "clearance": 0.0, "stiffness": None, "restitution": 0.0}),
    (DiskPairTable(**PAIR, radius=1.0), {"kick": 0.0, "zeta": 0.0, "thickness": None}),
    (DiskTable(**DISK), {"coupling": 0.0, "mistuning": None, "zeta": 0.0, "compliance": 0.0, "lean_deg": 0.0}),
    (PairContact(stiffness=1.0), {"friction": 0.0, "lean_deg": 0.0}),
    (GroundTable(), {"friction": 0.0}),
    (PatchContact(normal="n"), {"tangent": [], "clearance": 0.0, "slide": []}),
    (RecordTable(), {"every": 1, "state_every": 0, "at": None, "channels": None}),
    (CasingTable(basis="b"), {"scatter": 0.0, "seed": 0}),
    (BladeTable(basis="b"), {"freq_hz": None, "lean_deg": 0.0}),
    (RimContact(clearance=1.0), {"angle_deg": 0.0, "friction": 0.0, "out_of_roundness": [], "draw": None}),
    (RubNode(**NODE), {"axial": None, "angle_deg": 0.0, "line": 0, "clearance": 0.0, "track": None}),
    (RubBlade(basis="b"), {"angle_deg": 0.0, "count": 1, "lean_deg": 0.0, "axial": False, "stiffening": False}),
    (RubSpeed(hz=1.0), {"time": None, "turning": None, "scan": None}),
    (RubWhirl(amplitude=1.0), {"per_rev": 0.0, "hz": 0.0, "phase_deg": 0.0, "shakes": None}),
    (RubGravity(), {"acceleration": 9.80665, "down_deg": -90.0, "axial": 0.0, "settled": True}),
    (RimHead(kind="rim", t_end=1.0), {"on_limit": "stop"}),
    (ScanTable(**SCAN), {"steps": 401}),
    (ModalScheme(kind="exact-modal", dt=1.0), {"law": "auto"}),
    (SpeedTable(hz=1.0), {"turning": None, "scan": None}),
    (Waviness(p=2), {"cos": 0.0, "sin": 0.0}),
    (RodTable(**ROD), {"elements": 100, "x": 0.0, "velocity": 0.0, "fixed": "none", "end_mass": 0.0, "damping": 0.0}),
    (MassTable(mass=1.0), {"x": 0.0, "velocity": 0.0, "stiffness": 0.0, "anchor": None, "damping": 0.0}),
    (MassTable(mass=1.0), {"force": 0.0, "force_hz": 0.0, "force_deg": 0.0}),
    (WallTable(), {"x": 0.0}),
    (RodsHead(kind="rods", t_end=1.0), {"gravity": 0.0}),
    (ContinuationTable(), {"longest_step": 0.02, "most_points": 1000, "looks": None, "doublings": 0, "channels": []}),
    (BasinsTable(at=1.0, seed=0), {"starts": 100, "spread": 1.0, "settle": 300}),
]


@pytest.mark.parametrize(("table", "said"), LEFT_OUT, ids=[type(case[0]).__name__ for case in LEFT_OUT])
def test_keys_left_out_have_the_values_that_the_manual_lists(table, said):
    assert {key: getattr(table, key) for key in said} == said


def sweep(low, high):
    return {"from_hz": low, "to_hz": high}


BASIS_OR_HAND = "found, expected a basis, or omega, channels and rows"
DRIVES = "found, expected amplitude, from_hz and to_hz, or freq_hz, from_n and to_n"
REFUSED = [
    (SpeedRange, {}, "nothing found, expected from_hz and to_hz, or hz"),
    (SpeedRange, {"hz": 0.0}, "nothing found"),
    (SpeedRange, {"hz": 5.0, **sweep(1.0, 2.0)}, "from_hz, to_hz, hz found"),
    (SpeedRange, {"hz": 5.0, "to_hz": 2.0}, "to_hz, hz found"),
    (SpeedRange, {"hz": 5.0, "from_hz": 2.0}, "from_hz, hz found"),
    (SpeedRange, {"from_hz": 2.0}, "from_hz found"),
    (SpeedRange, {"to_hz": 2.0}, "to_hz found"),
    (SpeedRange, sweep(-1.0, 2.0), "from_hz = -1 and to_hz = 2 found, expected two different speeds of one sense"),
    (SpeedRange, sweep(0.0, 2.0), "from_hz = 0 and to_hz = 2 found"),
    (SpeedRange, sweep(2.0, 2.0), "from_hz = 2 and to_hz = 2 found"),
    (VaryTable, {}, "expected one of clearance and friction"),
    (VaryTable, {"clearance": [1.0, 2.0], "friction": [1.0, 2.0]}, "expected one of clearance and friction"),
    (DriveTable, {"channel": "x"}, f"nothing {DRIVES}"),
    (DriveTable, {"channel": "x", "amplitude": 1.0, "from_hz": 1.0}, f"amplitude, from_hz {DRIVES}"),
    (DriveTable, {"channel": "x", "amplitude": 1.0, "from_n": 1.0, "to_n": 2.0}, f"amplitude, from_n, to_n {DRIVES}"),
    (DriveTable, {"channel": "x", "amplitude": 1.0, **sweep(2.0, 2.0)}, "two equal ends of the range found"),
    (DriveTable, {"channel": "x", "freq_hz": 1.0, "from_n": 2.0, "to_n": 2.0}, "two equal ends of the range found"),
    (PairContact, {}, "neither stiffness nor compliance given"),
    (PairContact, {"stiffness": 1.0, "compliance": 1.0}, "stiffness and compliance both given"),
    (DiskCasingTable, {}, "nothing found, expected one of basis and pair"),
    (DiskCasingTable, {"basis": "b", "pair": {**PAIR, "radius": 1.0}}, "basis and pair found, expected one"),
    (PatchBodyTable, {}, f"nothing {BASIS_OR_HAND}"),
    (PatchBodyTable, {"basis": "b", "zeta": [0.0]}, f"basis, zeta {BASIS_OR_HAND}"),
    (PatchBodyTable, {"basis": "b", **HAND}, f"basis, omega, channels, rows {BASIS_OR_HAND}"),
    *((PatchBodyTable, {k: v for k, v in HAND.items() if k != key}, BASIS_OR_HAND) for key in HAND),
    (PatchContact, {"normal": "n", "tangent": ["t"], "slide": [1.0, 2.0]}, "2 slide found, expected 1"),
    (RecordTable, {"channels": [[1.0]]}, "channels found without state_every or at"),
    (RandomRoundness, {"seed": 0}, "spectrum and harmonics: found neither, expected one"),
    (RandomRoundness, {"seed": 0, "spectrum": [LINE], "harmonics": [2]}, "spectrum and harmonics: found both"),
    (RandomRoundness, {"seed": 0, "harmonics": [2]}, "harmonics found without rms"),
    (SchemeTable, {"kind": "newmark", "dt": 1.0, "courant": 1.0}, "courant and dt both given"),
    (SchemeTable, {"kind": "newmark"}, "neither courant nor dt given"),
    (SchemeTable, {"kind": "penalty", "dt": 1.0}, "stiffness missing"),
    (SchemeTable, {"kind": "hht", "dt": 1.0, "law": "penalty"}, "stiffness missing"),
    (SchemeTable, {"kind": "hht", "dt": 1.0, "stiffness": 1.0}, "stiffness found"),
    (SchemeTable, {"kind": "exact-modal", "law": "penalty"}, "law 'penalty' found with kind = 'exact-modal'"),
    (SchemeTable, {"kind": "exact-modal", "stiffness": 1.0}, "stiffness found with kind = 'exact-modal'"),
]  # fmt: skip


@pytest.mark.parametrize(("table", "given", "words"), REFUSED)
def test_keys_that_exclude_or_need_one_another_are_refused(table, given, words):
    with pytest.raises(ValidationError, match=words):
        table.model_validate(given)


def test_ranges_have_the_ends_and_the_parameter_that_are_given():
    assert DriveTable(channel="x", amplitude=1.0, from_hz=3.0, to_hz=2.0).between == (3.0, 2.0)
    force = DriveTable(channel="x", freq_hz=7.0, from_n=4.0, to_n=5.0)
    assert (force.parameter, force.between) == ("amplitude", (4.0, 5.0))
    assert DriveTable(channel="x", amplitude=1.0, from_hz=3.0, to_hz=2.0).parameter == "freq_hz"
    assert SpeedRange(from_hz=-2.0, to_hz=-1.0).to_hz == -1.0
    assert SpeedRange(hz=-2.0).hz == -2.0
    assert VaryTable(clearance=[2.0, 1.0]).between == (2.0, 1.0)
    assert VaryTable(friction=[0.0, 0.3]).between == (0.0, 0.3)
