"""Tables of scene files: values at a bound and just beyond it, keys left out, keys that exclude others."""

import math
import re

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring
from tests.tables_in_files import placed, table_schema, text_of

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

DRIVE = {"channel": "x", "amplitude": 1.0, "from_hz": 1.0, "to_hz": 2.0}
RANDOM = "rim contact.random_out_of_roundness"
MODAL = {"kind": "exact-modal", "dt": 1e-5}
RIM = {
    "scene": {"kind": "rim", "t_end": 1.0}, "casing": {"basis": "c.npz"}, "blade": {"basis": "b.npz"},
    "contact": {"clearance": 1e-4}, "speed": {"hz": 5.0}, "scheme": MODAL,
}  # fmt: skip
CASING = {"pair": PAIR | {"radius": 0.5}}
DISK_RANGE = {
    "scene": {"kind": "disk"}, "casing": CASING, "disk": DISK | {"compliance": 1e-6}, "contact": {"clearance": 1e-4},
    "speed": {"from_hz": 1.0, "to_hz": 2.0},
}  # fmt: skip
# the other tables of a scene of each kind, as the schema names it
SCENES = {
    "rods": {"scene": {"kind": "rods", "t_end": 1.0}, "rod": [ROD], "scheme": {"kind": "newmark", "dt": 1e-3}},
    "beam": {
        "scene": {"kind": "beam", "t_end": 1.0}, "beam": SECTION, "circle": {"radius": 1.0},
        "scheme": {"kind": "newmark", "dt": 1e-3},
    },
    "cantilever": {
        "scene": {"kind": "cantilever", "t_end": 1.0}, "beam": SECTION, "stop": {"clearance": 0.0},
        "scheme": {"kind": "exact-modal", "modes": 3, "dt": 1e-3},
    },
    "rim": RIM,
    "rub": RIM | {"scene": {"kind": "rub", "t_end": 1.0}, "blade": [{"basis": "b.npz"}]},
    "disk": RIM | {"scene": {"kind": "disk", "t_end": 1.0}, "casing": CASING, "disk": DISK},
    "patch": {
        "scene": {"kind": "patch", "t_end": 1.0}, "body": HAND, "contact": [{"normal": "x"}],
        "scheme": {"kind": "exact-modal", "dt": 1e-3},
    },
    "pair": {"scene": {"kind": "pair"}, "casing": PAIR, "blade": MODE, "contact": {"stiffness": 1.0}, "speed": SCAN},
    "cycles": {"scene": {"kind": "patch"}, "body": HAND, "contact": [{"normal": "x"}], "drive": DRIVE},
    "cycles-disk": DISK_RANGE,
}  # fmt: skip
del SCENES["disk"]["blade"]
# the tables around those that are not at the top; None is the place of the table itself
WITHIN = {
    "rod[1]": {"rod": [None]}, "mass[1]": {"mass": [None]}, "contact[1]": {"contact": [None]},
    "casing.pair": {"casing": {"pair": None}}, "blade[1]": {"blade": [None]}, "whirl[1]": {"whirl": [None]},
    "blade[1].node[1]": {"blade": [{"basis": "b.npz", "node": [None]}]}, "wall[1]": {"wall": [None]},
    "contact.out_of_roundness[1]": {"contact": {"clearance": 0.0, "out_of_roundness": [None]}},
    "contact.random_out_of_roundness": {"contact": {"clearance": 0.0, "random_out_of_roundness": None}},
    "contact.random_out_of_roundness.spectrum[1]": {
        "contact": {"clearance": 0.0, "random_out_of_roundness": {"seed": 0, "spectrum": [None]}}
    },
}  # fmt: skip


OTHERWISE = re.compile(r"found no such file|\[checks\]")  # missing files and unusual values


def load(folder, place, table, **others):
    """The scene of a kind with a table at a path, "kind path", and other tables."""
    kind, _, path = place.partition(" ")
    file = folder / "scene.toml"
    file.write_text(text_of(SCENES[kind] | placed(WITHIN.get(path, {path: None}), table) | others), encoding="utf-8")
    read = {"pair": ct.scene.load_stability, "cycles": ct.scene.load_cycles}.get(kind.partition("-")[0], ct.load_scene)
    return read(file)


def problems(folder, place, table):
    """What is refused of such a scene at the table or within it, each beginning with its key."""
    try:
        load(folder, place, table)
    except ct.InputError as error:
        path = place.partition(" ")[2]
        found = [line.partition("scene.toml: ")[2] for line in str(error).splitlines()]
        return [
            line
            for line in found
            if line.startswith((f"{path}.", f"{path}:", f"{path}[")) and not OTHERWISE.search(line)
        ]
    return []


# table, other keys, key, what may be there, what may not
BOUNDS = [
    *((place, SECTION, key, [TINY], [0.0, -1.0]) for place in ("beam beam", "cantilever beam") for key in SECTION),
    ("beam beam", SECTION, "elements", [1], [0]),
    ("cantilever beam", SECTION, "zeta", [0.0, BELOW_ONE], [UNDER, 1.0]),
    ("beam circle", {"radius": 1.0}, "offset", [0.0], [UNDER]),
    ("beam circle", {}, "radius", [TINY], [0.0]),
    ("cantilever stop", {}, "clearance", [0.0], [UNDER]),
    *(("beam ring", RING, key, [0.0], [UNDER]) for key in ("k_r", "k_t", "zeta")),
    *(("beam ring", RING, key, [TINY], [0.0]) for key in ("width", "height", "E", "rho")),
    ("beam ring", RING, "n_max", [1, 200], [0, 201]),
    *(("rim coating", COAT, key, [TINY], [0.0]) for key in ("E", "yield_stress", "thickness", "width", "tip")),
    *(("rim coating", COAT, key, [0.0], [UNDER]) for key in ("hardening", "machined")),
    ("rim coating", COAT, "bars", [1, 10_000], [0, 10_001]),
    ("cycles contact[1]", {"normal": "n"}, "stiffness", [TINY], [0.0]),
    ("cycles contact[1]", {"normal": "n"}, "restitution", [0.0, 1.0], [UNDER, 1.0000001]),
    ("disk disk", DISK, "blades", [2, 1000], [1, 1001]),
    *(("disk disk", DISK, key, [TINY], [0.0]) for key in ("freq_hz", "modal_mass")),
    *(("disk disk", DISK, key, [0.0], [UNDER]) for key in ("coupling", "compliance")),
    ("disk disk", DISK, "zeta", [0.0, BELOW_ONE], [UNDER, 1.0]),
    ("disk disk", DISK, "lean_deg", [BELOW_90, -BELOW_90], [90.0, -90.0]),
    ("disk casing.pair", PAIR, "radius", [TINY], [0.0]),
    ("pair casing", PAIR, "n", [1], [0]),
    *(("pair blade", MODE, key, [TINY], [0.0]) for key in ("freq_hz", "modal_mass")),
    ("pair blade", MODE, "zeta", [0.0, BELOW_ONE], [UNDER, 1.0]),
    *(("pair contact", {}, key, [TINY], [0.0]) for key in ("stiffness", "compliance")),
    ("pair contact", {"stiffness": 1.0}, "friction", [0.0], [UNDER]),
    ("pair contact", {"stiffness": 1.0}, "lean_deg", [BELOW_90, -BELOW_90], [90.0, -90.0]),
    ("patch ground", {}, "friction", [0.0], [UNDER]),
    ("patch body", {"channels": ["x"], "rows": [[1.0]]}, "omega", [[0.0]], [[UNDER]]),
    ("patch body", HAND, "zeta", [[0.0, BELOW_ONE]], [[UNDER], [1.0]]),
    ("patch contact[1]", {"normal": "n"}, "tangent", [[], ["s"], ["s", "t"]], [["s", "t", "u"]]),
    ("rods record", {}, "every", [1], [0]),
    ("rods record", {}, "state_every", [0], [-1]),
    ("rods record", {}, "at", [[0.0]], [[], [UNDER]]),
    ("rods record", {"state_every": 1}, "channels", [[[1.0]]], [[], [[1.0], [1.0, 2.0]]]),
    ("rim casing", {"basis": "b"}, "scatter", [0.0, 0.2], [UNDER, 0.2000001]),
    ("rim casing", {"basis": "b"}, "seed", [0], [-1]),
    ("rim blade", {"basis": "b"}, "freq_hz", [TINY], [0.0, 0.9 * TINY]),
    ("rim blade", {}, "basis", ["b"], [""]),
    ("rim blade", {"basis": "b"}, "lean_deg", [BELOW_90, -BELOW_90], [90.0, -90.0]),
    (f"{RANDOM}.spectrum[1]", LINE, "p", [1, 1000], [0, 1001]),
    (f"{RANDOM}.spectrum[1]", LINE, "median", [TINY, 2.0], [0.0, 2.0000001]),
    (f"{RANDOM}.spectrum[1]", LINE, "high", [1.0], [0.9999999]),
    (RANDOM, {"seed": 0, "rms": 1.0}, "harmonics", [[1], [2, 1000]], [[], [0], [1001], [3, 2], [2, 2]]),
    (RANDOM, {"seed": 0}, "spectrum", [[LINE]], [[], [LINE, LINE], [LINE, {**LINE, "p": 1}]]),
    (RANDOM, {"seed": 0, "harmonics": [2]}, "rms", [TINY], [0.0]),
    (RANDOM, {"harmonics": [2], "rms": 1.0}, "seed", [0], [-1]),
    ("disk contact", {"clearance": 0.0}, "friction", [0.0], [UNDER]),
    ("disk contact", {"clearance": 0.0, "random_out_of_roundness": {"seed": 0, "spectrum": [LINE]}}, "draw", [0], [-1]),
    ("rub casing", {"basis": "b"}, "thickness", [TINY], [0.0]),
    ("rub blade[1].node[1]", NODE, "line", [0], [-1]),
    ("rub blade[1].node[1]", NODE, "track", [0], [-1]),
    ("rub blade[1]", {"basis": "b"}, "count", [1, 1000], [0, 1001]),
    ("rub blade[1]", {"basis": "b"}, "lean_deg", [BELOW_90, -BELOW_90], [90.0, -90.0]),
    ("rub gravity", {}, "acceleration", [0.0], [UNDER]),
    ("rub gravity", {}, "down_deg", [-360.0, 360.0], [-360.1, 360.1, 1e30]),
    ("rim contact", {"clearance": 0.0}, "angle_deg", [-360.0, 360.0], [-360.1, 360.1, 1e30]),
    ("rub whirl[1]", {}, "amplitude", [0.0], [UNDER]),
    ("rub speed", {"time": [0.0, 1.0]}, "hz", [[1.0, 2.0]], [1.0, [1.0], [1.0, 2.0, 3.0]]),
    ("rub speed", {}, "hz", [1.0], [[1.0], []]),
    ("pair speed", SCAN, "steps", [2, 1_000_000], [1, 1_000_001]),
    ("pair speed", SCAN, "to_hz", [TINY], [0.0, -1.0]),
    ("rim contact.out_of_roundness[1]", {}, "p", [0, 1000], [-1, 1001]),
    ("rim scheme", {"kind": "exact-modal"}, "dt", [TINY], [0.0]),
    ("rim scene", {"kind": "rim"}, "t_end", [TINY], [0.0]),
    ("rods scheme", {"kind": "newmark"}, "dt", [TINY], [0.0]),
    ("rods scheme", {"kind": "newmark"}, "courant", [TINY], [0.0]),
    *(("rods scheme", {"kind": "newmark", "dt": 1.0}, key, [TINY], [0.0]) for key in ("beta", "gamma")),
    ("rods scheme", {"kind": "penalty", "dt": 1.0}, "stiffness", [TINY], [0.0]),
    ("rods scheme", {"kind": "exact-modal"}, "modes", [1], [0]),
    ("rods scheme", {"kind": "hht", "dt": 1.0, "law": "augmented-lagrangian", "stiffness": 1.0}, "updates", [1], [0]),
    ("rods scheme", {"kind": "moreau-jean", "dt": 1.0}, "theta", [0.0, 1.0], [UNDER, 1.0000001]),
    ("rods scheme", {"kind": "nonsmooth-alpha", "dt": 1.0}, "rho_inf", [0.0, 1.0], [UNDER, 1.0000001]),
    *(("rods rod[1]", ROD, key, [TINY, 1e25], [0.0, 1.1e25]) for key in ROD),
    ("rods rod[1]", ROD, "elements", [1], [0]),
    *(("rods rod[1]", ROD, key, [0.0], [UNDER]) for key in ("end_mass", "damping")),
    ("rods mass[1]", {}, "mass", [TINY], [0.0]),
    *(("rods mass[1]", {"mass": 1.0}, key, [0.0], [UNDER]) for key in ("stiffness", "damping", "force_hz")),
    ("rods scene", {"kind": "rods"}, "t_end", [TINY], [0.0]),
    ("cycles continuation", {}, "longest_step", [1e-6, 1.0], [0.0, 0.9e-6, 1.0000001]),
    ("cycles continuation", {}, "most_points", [2, 10_000_000], [1, 10_000_001]),
    ("cycles continuation", {}, "looks", [8], [7]),
    ("cycles continuation", {}, "doublings", [0], [-1]),
    ("cycles basins", {"at": 1.0, "seed": 0}, "starts", [1, 100_000], [0, 100_001]),
    ("cycles basins", {"at": 1.0, "seed": 0}, "settle", [1], [0]),
    ("cycles basins", {"at": 1.0, "seed": 0}, "spread", [TINY, 1e3], [0.0, 1001.0]),
    ("cycles basins", {"at": 1.0}, "seed", [0], [-1]),
    ("cycles-disk vary", {}, "clearance", [[-1.0, 1.0], [1.0, -1.0]], [[], [1.0], [1.0, 1.0], [1.0, 2.0, 3.0]]),
    ("cycles-disk vary", {}, "friction", [[0.0, 1.0]], [[UNDER, 1.0], [0.5, 0.5], [0.5]]),
]  # fmt: skip


@pytest.mark.filterwarnings("ignore")  # of values that are allowed and not usual
@pytest.mark.parametrize(
    ("place", "others", "key", "good", "bad"), BOUNDS, ids=[f"{case[0]}-{case[2]}" for case in BOUNDS]
)
def test_values_up_to_their_bounds_are_taken_and_none_beyond(place, others, key, good, bad, tmp_path):
    at = f"{place.partition(' ')[2]}.{key}"
    for value in good:
        found = problems(tmp_path, place, others | {key: value})
        assert [line for line in found if line.startswith(at)] == [], value
    for value in bad:
        found = problems(tmp_path, place, others | {key: value})
        assert any(line.startswith((at, f"{place.partition(' ')[2]}:")) for line in found), value


LEFT_OUT = [
    ("beam beam", {"elements": 40, "torque": 0.0, "angle_deg": 0.0, "spin": 0.0}),
    ("beam circle", {"offset": 0.0}),
    ("cantilever beam", {"zeta": 0.0, "load": 0.0, "velocity": 0.0}),
    ("beam ring", {"k_r": 0.0, "k_t": 0.0, "zeta": 0.0, "n_max": 20, "width": None, "E": None}),
    ("rim coating", {"bars": 6, "machined": 0.0}),
    ("cycles contact[1]", {"slide": 0.0, "clearance": 0.0, "stiffness": None, "restitution": 0.0}),
    ("disk casing.pair", {"kick": 0.0, "zeta": 0.0, "thickness": None}),
    ("disk disk", {"coupling": 0.0, "mistuning": None, "zeta": 0.0, "compliance": 0.0, "lean_deg": 0.0}),
    ("pair contact", {"friction": 0.0, "lean_deg": 0.0}),
    ("patch ground", {"friction": 0.0}),
    ("patch contact[1]", {"tangent": [], "clearance": 0.0, "slide": []}),
    ("rods record", {"every": 1, "state_every": 0, "at": None, "channels": None}),
    ("rim casing", {"scatter": 0.0, "seed": 0}),
    ("rim blade", {"freq_hz": None, "lean_deg": 0.0}),
    ("rim contact", {"angle_deg": 0.0, "friction": 0.0, "out_of_roundness": [], "draw": None}),
    ("rub blade[1].node[1]", {"axial": None, "angle_deg": 0.0, "line": 0, "clearance": 0.0, "track": None}),
    ("rub blade[1]", {"angle_deg": 0.0, "count": 1, "lean_deg": 0.0, "axial": False, "stiffening": False}),
    ("rub speed", {"time": None, "turning": None, "scan": None}),
    ("rub whirl[1]", {"per_rev": 0.0, "hz": 0.0, "phase_deg": 0.0, "shakes": None}),
    ("rub gravity", {"acceleration": 9.80665, "down_deg": -90.0, "axial": 0.0, "settled": True}),
    ("rim scene", {"on_limit": "stop"}),
    ("pair speed", {"steps": 401}),
    ("rim scheme", {"law": "auto"}),
    ("rim speed", {"turning": None, "scan": None}),
    ("rim contact.out_of_roundness[1]", {"cos": 0.0, "sin": 0.0}),
    ("rods rod[1]", {"elements": 100, "x": 0.0, "velocity": 0.0, "fixed": "none", "end_mass": 0.0, "damping": 0.0}),
    ("rods mass[1]", {"x": 0.0, "velocity": 0.0, "stiffness": 0.0, "anchor": None, "damping": 0.0}),
    ("rods mass[1]", {"force": 0.0, "force_hz": 0.0, "force_deg": 0.0}),
    ("rods wall[1]", {"x": 0.0}),
    ("rods scene", {"gravity": 0.0}),
    ("cycles continuation", {"longest_step": 0.02, "most_points": 1000, "looks": None, "doublings": 0, "channels": []}),
    ("cycles basins", {"starts": 100, "spread": 1.0, "settle": 300}),
]


@pytest.mark.parametrize(("place", "said"), LEFT_OUT)
def test_keys_left_out_have_the_values_that_the_manual_lists(place, said):
    kind, _, path = place.partition(" ")
    keys = table_schema(ct.scene.scene_schema()[kind], path)["properties"]
    assert {key: keys[key].get("default", []) for key in said} == said


def sweep(low, high):
    return {"from_hz": low, "to_hz": high}


BASIS_OR_HAND = "found, expected a basis, or omega, channels and rows"
DRIVES = "found, expected amplitude, from_hz and to_hz, or freq_hz, from_n and to_n"
REFUSED = [
    ("cycles-disk speed", {}, "nothing found, expected from_hz and to_hz, or hz"),
    ("cycles-disk speed", {"hz": 0.0}, "nothing found"),
    ("cycles-disk speed", {"hz": 5.0, **sweep(1.0, 2.0)}, "from_hz, to_hz, hz found"),
    ("cycles-disk speed", {"hz": 5.0, "to_hz": 2.0}, "to_hz, hz found"),
    ("cycles-disk speed", {"hz": 5.0, "from_hz": 2.0}, "from_hz, hz found"),
    ("cycles-disk speed", {"from_hz": 2.0}, "from_hz found"),
    ("cycles-disk speed", {"to_hz": 2.0}, "to_hz found"),
    ("cycles-disk speed", sweep(-1.0, 2.0),
     "from_hz = -1 and to_hz = 2 found, expected two different speeds of one sense"),
    ("cycles-disk speed", sweep(0.0, 2.0), "from_hz = 0 and to_hz = 2 found"),
    ("cycles-disk speed", sweep(2.0, 2.0), "from_hz = 2 and to_hz = 2 found"),
    ("cycles-disk vary", {}, "expected one of clearance and friction"),
    ("cycles-disk vary", {"clearance": [1.0, 2.0], "friction": [1.0, 2.0]}, "expected one of clearance and friction"),
    ("cycles drive", {"channel": "x"}, f"nothing {DRIVES}"),
    ("cycles drive", {"channel": "x", "amplitude": 1.0, "from_hz": 1.0}, f"amplitude, from_hz {DRIVES}"),
    ("cycles drive", {"channel": "x", "amplitude": 1.0, "from_n": 1.0, "to_n": 2.0},
     f"amplitude, from_n, to_n {DRIVES}"),
    ("cycles drive", {"channel": "x", "amplitude": 1.0, **sweep(2.0, 2.0)}, "two equal ends of the range found"),
    ("cycles drive", {"channel": "x", "freq_hz": 1.0, "from_n": 2.0, "to_n": 2.0}, "two equal ends of the range found"),
    ("pair contact", {}, "neither stiffness nor compliance given"),
    ("pair contact", {"stiffness": 1.0, "compliance": 1.0}, "stiffness and compliance both given"),
    ("disk casing", {}, "nothing found, expected one of basis and pair"),
    ("disk casing", {"basis": "b", "pair": {**PAIR, "radius": 1.0}}, "basis and pair found, expected one"),
    ("patch body", {}, f"nothing {BASIS_OR_HAND}"),
    ("patch body", {"basis": "b", "zeta": [0.0]}, f"basis, zeta {BASIS_OR_HAND}"),
    ("patch body", {"basis": "b", **HAND}, f"basis, omega, channels, rows {BASIS_OR_HAND}"),
    *(("patch body", {k: v for k, v in HAND.items() if k != key}, BASIS_OR_HAND) for key in HAND),
    ("patch contact[1]", {"normal": "n", "tangent": ["t"], "slide": [1.0, 2.0]}, "2 slide found, expected 1"),
    ("rods record", {"channels": [[1.0]]}, "channels found without state_every or at"),
    (RANDOM, {"seed": 0}, "spectrum and harmonics: found neither, expected one"),
    (RANDOM, {"seed": 0, "spectrum": [LINE], "harmonics": [2]}, "spectrum and harmonics: found both"),
    (RANDOM, {"seed": 0, "harmonics": [2]}, "harmonics found without rms"),
    ("rods scheme", {"kind": "newmark", "dt": 1.0, "courant": 1.0}, "courant and dt both given"),
    ("rods scheme", {"kind": "newmark"}, "neither courant nor dt given"),
    ("rods scheme", {"kind": "penalty", "dt": 1.0}, "stiffness missing"),
    ("rods scheme", {"kind": "hht", "dt": 1.0, "law": "penalty"}, "stiffness missing"),
    ("rods scheme", {"kind": "hht", "dt": 1.0, "stiffness": 1.0}, "stiffness found"),
    ("rods scheme", {"kind": "exact-modal", "law": "penalty"}, "law 'penalty' found with kind = 'exact-modal'"),
    ("rods scheme", {"kind": "exact-modal", "stiffness": 1.0}, "stiffness found with kind = 'exact-modal'"),
]  # fmt: skip


@pytest.mark.parametrize(("place", "given", "words"), REFUSED)
def test_keys_that_exclude_or_need_one_another_are_refused(place, given, words, tmp_path):
    assert words in "\n".join(problems(tmp_path, place, given))


def test_ranges_have_the_ends_and_the_parameter_that_are_given(tmp_path):
    def between(place, table, **others):
        scene = load(tmp_path, place, table, **others)
        return scene.family.name, scene.between

    force = {"channel": "x", "amplitude": 1.0, "from_hz": 3.0, "to_hz": 2.0}
    assert between("cycles drive", force) == ("freq_hz", (3.0, 2.0))
    force = {"channel": "x", "freq_hz": 7.0, "from_n": 4.0, "to_n": 5.0}
    assert between("cycles drive", force) == ("amplitude", (4.0, 5.0))
    assert between("cycles-disk speed", {"from_hz": -2.0, "to_hz": -1.0}) == ("speed_hz", (-2.0, -1.0))
    one = {"speed": {"hz": -2.0}}
    assert between("cycles-disk vary", {"clearance": [2e-4, 1e-4]}, **one) == ("clearance", (2e-4, 1e-4))
    assert between("cycles-disk vary", {"friction": [0.0, 0.3]}, **one) == ("friction", (0.0, 0.3))


def drawn(folder, draw=0, given=(), **random):
    """Harmonics of a rim by number: given ones and a draw."""
    ring().save(folder / "c.npz")
    blade().save(folder / "b.npz")
    contact = {"clearance": 1e-4, "out_of_roundness": list(given), "random_out_of_roundness": random, "draw": draw}
    terms = load(folder, "rim contact", contact).what.out_of_roundness
    return [(term["p"], complex(term["cos"], term["sin"])) for term in terms]


def test_equal_harmonics_are_a_spectrum_of_the_ratio_of_a_rayleigh_distribution(tmp_path):
    """P(a > x) = exp(-x^2/2s^2): its 90th percentile over its median is sqrt(ln 10/ln 2)."""
    high = 1e-5 * math.sqrt(math.log(10.0) / math.log(2.0))
    lines = [{"p": p, "median": 1e-5, "high": high} for p in (2, 3, 5)]
    for draw in (0, 4):
        equal = drawn(tmp_path, draw, seed=7, harmonics=[2, 3, 5], rms=1e-4)
        assert equal == [(p, pytest.approx(a)) for p, a in drawn(tmp_path, draw, seed=7, spectrum=lines, rms=1e-4)]
        assert sum(abs(a) ** 2 for _, a in equal) / 2.0 == pytest.approx(1e-8)  # of cos^2 around the rim: 1/2
    assert drawn(tmp_path, 0, seed=7, harmonics=[2], rms=1e-4) != drawn(tmp_path, 1, seed=7, harmonics=[2], rms=1e-4)


def test_drawn_amplitudes_have_their_median_and_their_90th_percentile(tmp_path):
    """Of 400 numbers, half are above the median and a tenth above the high value, within three deviations of either."""
    lines, size = [{"p": p, "median": 1e-5, "high": 4e-5} for p in range(2, 22)], 400
    values = np.array([a for k in range(20) for _, a in drawn(tmp_path, k, seed=1, spectrum=lines)])
    assert values.size == size
    assert abs(np.mean(abs(values) > 1e-5) - 0.5) < 3.0 * math.sqrt(0.25 / size)
    assert abs(np.mean(abs(values) > 4e-5) - 0.1) < 3.0 * math.sqrt(0.09 / size)
    assert abs(np.mean(values / abs(values))) < 3.0 / math.sqrt(size)  # phases are uniform
    assert np.ptp(np.angle(values)) > 6.2
    ratio = np.log(abs(values) / 1e-5)  # a normal distribution, whose 90th percentile is 1.2816 deviations
    assert np.std(ratio) == pytest.approx(math.log(4.0) / 1.2816, rel=0.12)


def test_given_harmonics_come_before_drawn_ones(tmp_path):
    given = {"p": 2, "cos": 1e-5, "sin": -2e-5}
    alone = drawn(tmp_path, 3, seed=2, harmonics=[2, 4], rms=1e-5)
    assert drawn(tmp_path, 3, [given], seed=2, harmonics=[2, 4], rms=1e-5) == [(2, 1e-5 - 2e-5j), *alone]
