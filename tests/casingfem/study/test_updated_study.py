"""An updated study is the study with one other number: each by its address, written, read again, and compared."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.study.study_texts import FRUSTUM, STEEL, written

CASING = f"""{FRUSTUM}[shell]
thickness = 3e-3
[mesh]
order = 4
around = 6
[[strip]]
from = 0.0
to = 0.1
thickness = 4e-3
[[strip]]
from = 0.1
to = 0.15
thickness = 6e-3
material = {{E = 190e9, nu = 0.29, rho = 7900.0}}
[[mass]]
edge = "top"
angle_deg = 20.0
mass = 0.2
[[mass]]
edge = "top"
angle_deg = 50.0
mass = 0.3
[[imperfection]]
of = "radius"
harmonics = [{{p = 2, cos = 0.004}}, {{p = 3, cos = 0.001, sin = -0.002}}]
[[imperfection]]
of = "radius"
harmonics = [{{p = 5, cos = 0.0001}}]
[[imperfection]]
of = "thickness"
harmonics = [{{p = 1, cos = 0.1}}]
"""
BOLTS = """[support.base]
kind = "bolts"
count = 6
k_r = 1e8
k_theta = 2e8
k_z = 4e8
k_rot = 7.0
loose = [{bolt = 2, factor = 0.5}, {bolt = 5, factor = 0.1}]
"""
SPRINGS = """[support.base]
kind = "elastic"
k_r = 3e8
k_z = 4e8
k_rot = 1e5
around = [{p = 2, cos = 0.1}, {p = 4, cos = 0.2, sin = -0.1}]
"""
RING = """[support.top]
kind = "ring"
width = 0.03
depth = 0.02
material = {E = 200e9, nu = 0.3, rho = 8000.0}
[support.top.support]
kind = "elastic"
k_r = 3e8
"""
RING_ON_BOLTS = """[support.base]
kind = "ring"
width = 0.03
depth = 0.02
[support.base.support]
kind = "bolts"
count = 4
k = 1e8
"""
BLADE = f"""{STEEL}[chart]
kind = "blade"
length = 0.3
chord = [0.1, 0.09, 0.07]
camber_deg = 30.0
twist_deg = [5.0, 25.0]
[shell]
thickness = 3e-3
[taper]
along = [0.9, 0.5]
[mesh]
order = 4
rows = 1
around = 1
[support.root]
kind = "clamped"
"""
TEXTS = {
    "bolts": CASING + BOLTS, "springs": CASING + SPRINGS + RING, "a ring on bolts": CASING + RING_ON_BOLTS,
    "a blade": BLADE,
}  # fmt: skip


@pytest.mark.filterwarnings("ignore")  # of coarse meshes and thick walls
@pytest.mark.parametrize("text", TEXTS)
def test_each_number_of_an_updated_study_is_the_new_one_and_the_others_stay(text, tmp_path):
    study = cf.load_study(written(tmp_path, TEXTS[text]))
    names = [str(name) for name in cf.updating.parameters(study.structure).name]
    before = {name: float(cf.updating.get_value(study.structure, name)) for name in names}
    assert len(names) > 8
    for name in names:
        if name == "chart.height" or name.rpartition(".section.")[2] in ("area", "I_r", "I_z", "J"):
            continue  # elements end where strips do; and these follow from width and depth
        value = 1.07 * before[name] if before[name] else 0.003
        again = cf.load_study(written(tmp_path, cf.study.updated_toml(study, {name: value}, tmp_path))).structure
        exact = cf.updating.with_value(study.structure, name, value)
        assert cf.updating.get_value(again, name) == pytest.approx(value, rel=1e-12)
        for other in names:
            assert cf.updating.get_value(again, other) == pytest.approx(
                cf.updating.get_value(exact, other), rel=1e-12, abs=1e-15
            ), (name, other)
    moved = {name: value for name, value in before.items() if "thickness" in name}
    both = cf.load_study(
        written(tmp_path, cf.study.updated_toml(study, {k: 1.1 * v for k, v in moved.items()}, tmp_path))
    )
    for name, value in moved.items():
        assert cf.updating.get_value(both.structure, name) == pytest.approx(1.1 * value, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "section", "words"),
    [
        ("area", "width = 0.03\ndepth = 0.02", "expected a number that the study states: width or depth"),
        ("width", "diameter = 0.02", "expected a number that the study states: diameter"),
    ],
)
def test_a_number_of_a_section_that_the_study_does_not_state_is_not_updated(name, section, words, tmp_path):
    cf.FrequencyTable.from_arrays(freq_hz=[370.0], sigma_hz=1.0).to_csv(tmp_path / "table.csv")
    text = CASING + SPRINGS + RING.replace("width = 0.03\ndepth = 0.02", section) + "[update]\ntable = 'table.csv'\n"
    text += f'[[update.parameter]]\nname = "support.top.section.{name}"\nlower = 1e-9\nupper = 1.0\n'
    with pytest.raises(cf.errors.InputError, match=rf"name: found support\.top\.section\.{name}, {words}"):
        cf.load_study(written(tmp_path, text))
    cf.load_study(written(tmp_path, text.replace(f"section.{name}", f"section.{words.split()[-1]}")))


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("name", "value"),
    [("radius.p7.cos", 0.003), ("radius.p2.sin", -0.001), ("thickness.p4.sin", 0.02), ("modulus.p2.cos", 0.05)],
)
def test_a_harmonic_that_the_study_does_not_have_is_added(name, value, tmp_path):
    study = cf.load_study(written(tmp_path, CASING + SPRINGS))
    again = cf.load_study(written(tmp_path, cf.study.updated_toml(study, {name: value}, tmp_path))).structure
    exact = cf.updating.with_value(study.structure, name, value)
    z, theta = np.full(7, 0.1), np.linspace(0.0, 6.0, 7)
    of = name.partition(".")[0]
    fields = [getattr(shell, f"{of}_defect").derivatives(z, theta).value for shell in (again, exact)]
    np.testing.assert_allclose(*fields, rtol=1e-12, atol=1e-15)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", ["support.base.k_r.p4.cos", "support.base.k_z.p6.sin", "support.base.k_rot.p4.sin"])
def test_a_pattern_of_one_spring_leaves_the_other_springs_as_they_are(name, tmp_path):
    study = cf.load_study(written(tmp_path, CASING + SPRINGS))
    again = cf.load_study(written(tmp_path, cf.study.updated_toml(study, {name: 0.05}, tmp_path))).structure
    exact = cf.updating.with_value(study.structure, name, 0.05)
    for spring in ("k_r", "k_z", "k_rot"):
        for part in ("p4.cos", "p4.sin", "p6.sin"):
            address = f"support.base.{spring}.{part}"
            assert cf.updating.get_value(again, address) == cf.updating.get_value(exact, address), address
