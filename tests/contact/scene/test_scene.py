"""Scene files: the shipped ones run, the broken ones list every problem with file and key."""

from pathlib import Path

import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring

SCENES = Path(__file__).parents[3] / "data" / "scenes"
# a pair has poles and no run; the first rub needs bases that `casingfem new` tells how to make
RUNS = sorted(
    set(SCENES.glob("*.toml")) - {SCENES / "pair.toml", SCENES / "first_rub.toml"}
    | {SCENES / "blade_off" / "rigid.toml"}
)
COLD = {"beam_in_ring.toml", "bladed_disk.toml", "coulomb_oscillator.toml", "rotating_beam.toml"}  # to compile
IMPULSE = {
    "two_rods.toml": 6.60205, "two_rods_sweep.toml": 6.60205,
    "rod_on_wall.toml": 200.0, "bouncing_bar.toml": 533.333, "mass_on_rod.toml": 1.687619,
    "modal_rod_on_wall.toml": 200.0, "two_rods_penalty.toml": 6.60205, "unequal_rods.toml": 3.68896,
    "mass_on_free_rod.toml": 0.864665, "mass_on_two_rods.toml": 0.499832, "grazing_bar.toml": 0.0,
    "bouncing_ball.toml": 49.05, "impact_oscillator.toml": 34.641, "driven_oscillator.toml": 79.094880,
    "cantilever_on_stop.toml": 4.966, "coulomb_oscillator.toml": 20.0,
    "bladed_disk.toml": 4.923,
    "rigid.toml": 169.5,  # of an explicit penalty model with steps of 2e-7 s
}  # fmt: skip

BEAMS = {
    "rotating_beam.toml": 141.7,
    "beam_in_ring.toml": 15.7,
}  # reports.verification.schemes.rotating_beam, finer and implicit

RODS = """
[scene]
kind = "rods"
t_end = 1.0
[[rod]]
length = 1.0
area = 1.0
E = 1.0
rho = 1.0
velocity = -1.0
[wall]
x = -0.1
[scheme]
kind = "forward-lagrange"
courant = 0.9
"""

RIM = """
[scene]
kind = "rim"
t_end = 0.02
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 10.0
[contact]
clearance = -1e-5
friction = 0.3
out_of_roundness = [{p = 2, cos = 2e-5}, {p = 3, cos = 5e-6}]
[speed]
hz = 5.0
[scheme]
kind = "exact-modal"
law = "averaged"
dt = 1e-5
"""


def problems(tmp_path, text):
    file = tmp_path / "scene.toml"
    file.write_text(text)
    with pytest.raises(ct.scene.SceneError) as caught:
        ct.load_scene(file)
    assert all("scene.toml" in problem for problem in caught.value.problems)
    return caught.value.problems


@pytest.mark.slow
@pytest.mark.parametrize(
    "file", [pytest.param(file, marks=[pytest.mark.slow] * (file.name in COLD), id=file.name) for file in RUNS]
)
def test_shipped_scenes_run(file):
    result = ct.run(ct.load_scene(file))
    if file.name in BEAMS:
        assert len(result.intervals[-1]) > 1
        assert result.impulse.sum() == pytest.approx(BEAMS[file.name], rel=0.02)
    elif file.stem == "jeffcott":  # nothing touches
        assert result.impulse.size == 0
        assert abs(result.energy.unaccounted) < 1e-9 * result.energy.scale
    else:
        assert result.impulse[0] == pytest.approx(IMPULSE[file.name], rel=0.012, abs=1e-12)
    assert result.source["scene"] == file.name
    assert len(result.source["sha256"]) == 64


@pytest.mark.slow
def test_rim_scene(tmp_path):
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    (tmp_path / "scene.toml").write_text(RIM)
    result = ct.run(ct.load_scene(tmp_path / "scene.toml"))
    assert result.steps == 2000
    assert "averaged law" in result.scheme
    assert result.impulse[0] > 0.0
    assert result.energy.friction != 0.0


def test_arguments_override_the_file(tmp_path):
    (tmp_path / "scene.toml").write_text(RODS)
    scene = ct.load_scene(tmp_path / "scene.toml")
    assert ct.run(scene, t_end=0.5, courant=0.1).steps == 500
    assert (
        "penalty"
        in ct.run(scene, law=ct.Penalty(stiffness=10.0), scheme=ct.scheme.PenaltyDifference(), on_limit="flag").scheme
    )


def test_every_problem_is_reported_at_once(tmp_path):
    text = RODS.replace("t_end = 1.0", "t_end = -1.0").replace("area = 1.0", 'area = -2.0\ncolour = "red"')
    found = "\n".join(problems(tmp_path, text))
    for words in (
        "scene.t_end: found -1.0, expected",
        "rod[1].area: found -2.0, expected",
        "rod[1].colour: unknown",
    ):
        assert words in found


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('kind = "rods"', 'kind = "disks"', "scene.kind: found 'disks', expected one of 'rods', 'rim'"),
        ("rho = 1.0", "", "rod[1].rho: missing"),
        ("E = 1.0", 'E = "stiff"', "rod[1].E: found 'stiff', expected"),
        ("t_end = 1.0", "t_end = inf", "scene.t_end: found inf, expected a finite number"),
        ("x = -0.1", "x = 0.5", "overlap by 0.5 m"),
        ("courant = 0.9", "courant = 0.9\ndt = 0.1", "courant and dt both given"),
        ("courant = 0.9", "", "neither courant nor dt given"),
        ('"forward-lagrange"', '"penalty"', "stiffness missing, expected one in N/m with kind = 'penalty'"),
        ('"forward-lagrange"', '"magic"', "scheme.kind: found 'magic', expected"),
        ('"forward-lagrange"', '"newmark"\nbeta = 3.0', "scheme: beta: found 3.0, expected at most 1"),
        ('"forward-lagrange"', '"newmark"\nlaw = "energy"', "law 'energy' found with kind = 'newmark'"),
        ('"forward-lagrange"', '"hht"\nrestitution = 0.5', "restitution found with kind = 'hht', expected"),
        ('"forward-lagrange"', '"cd-lagrange"\nrestitution = 1.5', "scheme.restitution: found 1.5, expected"),
        ("courant = 0.9", "courant = 0.9\nmodes = 5", "modes found with kind = 'forward-lagrange', expected"),
        ('[scheme]\nkind = "forward-lagrange"\ncourant = 0.9', "", "scheme: missing"),
        ("[wall]\nx = -0.1", "", "expected at least two"),
        ("[scene]", "[scene", "not TOML"),
        ("t_end = 1.0", "t_end = .5", ": t_end = .5; write digits on both sides of the decimal point"),
        ("t_end = 1.0", "t_end = 1.", ": t_end = 1.; write digits on both sides of the decimal point"),
        ("t_end = 1.0", "t_end = 1,5", ": t_end = 1,5; write a decimal point, not a comma"),
        ("t_end = 1.0", "t_end = True", ": t_end = True; write true and false in lower case"),
        ('kind = "rods"', "kind = rods", ": kind = rods; write text in quotes"),
        ("t_end = 1.0", "t_end = 1.0 s", r"column 13): t_end = 1.0 s"),
        ("t_end = 1.0", f"t_end = {'[1.0 ' * 20}", f"): t_end = {'[1.0 ' * 20}"[:63] + " ..."),
    ],
)
def test_broken_rod_scenes(tmp_path, old, new, words):
    assert old in RODS
    assert words in "\n".join(problems(tmp_path, RODS.replace(old, new)))


KEYS = {
    "newmark": "beta = 0.5\ngamma = 0.55", "hht": "alpha = -0.2", "moreau-jean": "theta = 0.6\nrestitution = 0.5",
    "cd-lagrange": "restitution = 0.5", "paoli-schatzman": "restitution = 0.5", "massless-boundary": "",
    "stabilised-newmark": "", "nonsmooth-alpha": "rho_inf = 0.9\nrestitution = 0.5",
    "projected-alpha": "rho_inf = 0.9\nrestitution = 0.5", "event-driven": "modes = 20\nrestitution = 0.5",
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("kind", KEYS)
def test_every_scheme_has_its_kind_and_keys(tmp_path, kind):
    (tmp_path / "scene.toml").write_text(RODS.replace('"forward-lagrange"', f'"{kind}"\n{KEYS[kind]}'))
    scene = ct.load_scene(tmp_path / "scene.toml")
    for line in KEYS[kind].splitlines():
        name, value = line.split(" = ")
        assert getattr(scene.scheme, name) == float(value)
    assert ct.run(scene).impulse[0] > 0.5
    found = "\n".join(problems(tmp_path, RIM.replace("exact-modal", kind)))
    assert f"scheme.kind: found '{kind}', expected 'exact-modal'" in found


@pytest.mark.parametrize("law", ["penalty", "augmented-lagrangian"])
def test_laws_of_implicit_schemes(tmp_path, law):
    (tmp_path / "scene.toml").write_text(
        RODS.replace('"forward-lagrange"', f'"newmark"\nlaw = "{law}"\nstiffness = 9.0')
    )
    scene = ct.load_scene(tmp_path / "scene.toml")
    assert type(scene.law) is {"penalty": ct.Penalty, "augmented-lagrangian": ct.laws.AugmentedLagrangian}[law]
    assert scene.law.stiffness == 9.0


@pytest.mark.slow
def test_record_table(tmp_path):
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    for text in (RODS, RIM):
        file = tmp_path / "scene.toml"
        file.write_text(text)
        assert ct.load_scene(file).record is None
        file.write_text(text + "[record]\nevery = 5\nstate_every = 10\n")
        scene = ct.load_scene(file)
        assert (scene.record.every, scene.record.state_every) == (5, 10)
        result = ct.run(scene)
        assert result.every == 5
        assert result.state.shape[0] == (result.steps - 1) // 10 + 1
        assert ct.run(scene, record=ct.Record()).time.size == result.steps


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("every = 0", "record.every: found 0, expected greater than or equal to 1"),
        ("state_every = -1", "record.state_every: found -1, expected"),
        ("every = 2\nstate_every = 3", "record: state_every: found 3, expected 0 or a multiple of every = 2"),
        ("often = 2", "record.often: unknown key"),
    ],
)
def test_broken_record_tables(tmp_path, lines, words):
    assert words in "\n".join(problems(tmp_path, f"{RODS}[record]\n{lines}\n"))


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("friction = 0.3", "friction = true", "contact.friction: found True, expected a valid number"),
        ("hz = 5.0", 'hz = "5.0"', "speed.hz: found '5.0', expected a valid number"),
        ("p = 2,", "p = 2.0,", "contact.out_of_roundness[1].p: found 2.0, expected a valid integer"),
        ("p = 2,", "p = true,", "contact.out_of_roundness[1].p: found True, expected a valid integer"),
        ("lean_deg = 10.0", "lean_deg = nan", "blade.lean_deg: found nan, expected a finite number"),
        ("[{p = 2, cos = 2e-5}, {p = 3, cos = 5e-6}]", "2.0", "contact.out_of_roundness: found 2.0, expected 'basis'"),
        ('basis = "blade.npz"', "basis = 7", "blade.basis: found 7, expected a valid string"),
    ],
)  # fmt: skip
def test_values_of_another_type_are_refused_as_in_studies(tmp_path, old, new, key):
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    file = tmp_path / "rim.toml"
    file.write_text(RIM.replace(old, new, 1))
    with pytest.raises(ct.InputError) as caught:
        ct.load_scene(file)
    assert [key in problem for problem in caught.value.problems] == [True]
    file.write_text(RIM.replace("hz = 5.0", "hz = 5").replace("t_end = 0.02", "t_end = 1"))
    assert ct.load_scene(file).t_end == 1.0  # a whole number is a number


@pytest.mark.parametrize("clearance", ["0.0451", "-1.0"])
def test_a_clearance_in_the_wrong_unit(tmp_path, clearance):
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    found = problems(tmp_path, RIM.replace("clearance = -1e-5", f"clearance = {clearance}"))
    assert f"contact.clearance: found {float(clearance):g} m, expected -0.01 to 0.01 m" in found[0]
    allowed = RIM.replace("clearance = -1e-5", f"clearance = {clearance}") + '[checks]\nallow = ["clearance"]\n'
    assert (
        f"clearance: found {float(clearance):g} m, expected between -0.045 and 0.045 m"
        in problems(tmp_path, allowed)[0]
    )


def test_missing_bases_are_all_named(tmp_path):
    found = problems(tmp_path, RIM)
    assert len(found) == 2
    assert "casing.basis" in found[0]
    assert "blade.npz: found no such file" in found[1]


def test_swapped_bases(tmp_path):
    ring().save(tmp_path / "blade.npz")
    blade().save(tmp_path / "casing.npz")
    assert "casing: found a basis of kind 'point', expected 'rim'" in problems(tmp_path, RIM)[0]


def test_no_such_file(tmp_path):
    with pytest.raises(ct.scene.SceneError, match=r"none.toml: found no such file"):
        ct.load_scene(tmp_path / "none.toml")


def test_schema_is_there_for_every_kind():
    schema = ct.scene.scene_schema()
    kinds = {"rods", "rim", "rub", "disk", "rotor", "patch", "beam", "cantilever", "pair"}
    assert set(schema) == kinds | {"cycles", "cycles-rim", "cycles-rub", "cycles-disk"}
    assert "scheme" in schema["rods"]["properties"]


BEAM = (SCENES / "beam_in_ring.toml").read_text().replace("t_end = 0.4", "t_end = 0.36").replace("= 10\n", "= 5\n")


@pytest.mark.slow
def test_a_beam_in_a_ring_runs_from_its_file(tmp_path):
    (tmp_path / "scene.toml").write_text(BEAM)
    scene = ct.load_scene(tmp_path / "scene.toml")
    assert scene.what.ring.omega.size == 82
    result = ct.run(scene)
    assert result.intervals[-1][0][0] == pytest.approx(scene.what.first_contact_time, rel=0.02)
    ct.bodies.ring_modes(ct.bodies.ThinRing(radius=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0), 5).save(
        tmp_path / "ring.npz"
    )
    start, end = BEAM.index("[ring]"), BEAM.index("[scheme]")
    (tmp_path / "scene.toml").write_text(BEAM[:start] + '[ring]\nbasis = "ring.npz"\n' + BEAM[end:])
    assert ct.load_scene(tmp_path / "scene.toml").what.ring.n_max == 5


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("E = 210e9\nrho = 7800.0\nk_r", "k_r", "ring: width, height found, expected a basis, or all of"),
        ("[ring]\n", '[ring]\nbasis = "ring.npz"\n', "ring: width, height, E, rho found, expected a basis"),
        ("radius = 0.502", "radius = 0.4", "starts"),
        ("elements = 5", "elements = 0", "beam.elements: found 0"),
        ("torque = 1.0", "torque = nan", "beam.torque: found nan"),
    ],
)
def test_broken_beam_scenes(tmp_path, old, new, words):
    assert old in BEAM
    assert words in "\n".join(problems(tmp_path, BEAM.replace(old, new, 1)))


def test_a_coated_rim_from_a_file(tmp_path):
    from tests.contact.synthetic_rim import blade, ring

    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    coating = "[coating]\nE = 1e9\nyield_stress = 2e4\nhardening = 1e6\nthickness = 1e-3\nwidth = 0.02\ntip = 6e-3\n"
    file = tmp_path / "scene.toml"
    file.write_text(RIM + coating)
    scene = ct.load_scene(file)
    assert scene.law == ct.Abradable(
        E=1e9, yield_stress=2e4, hardening=1e6, thickness=1e-3, width=0.02, tip=6e-3, mu=scene.law.mu
    )
    assert scene.law.mu == 0.3
    file.write_text(RIM + coating + "machined = 2e-3\n")
    with pytest.raises(ct.scene.SceneError, match=r"coating: machined: found 0\.002 m, expected at most the thickness"):
        ct.load_scene(file)
