"""[law] of scene files: springs, Hertz and tables in rims, rubs and patches, and what stability makes of them."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring

RIM = """
[scene]
kind = "rim"
t_end = 0.004
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
lean_deg = 12.0
[contact]
clearance = -1e-6
friction = 0.1
[speed]
hz = 5.0
scan = {from_hz = 2.0, to_hz = 40.0, steps = 39}
[scheme]
kind = "exact-modal"
dt = 5e-6
"""
PATCH = """
[scene]
kind = "patch"
t_end = 0.02
[body]
omega = [0.0]
zeta = [0.0]
channels = ["z"]
rows = [[0.5]]
load = {z = -10.0}
[[contact]]
normal = "z"
clearance = 1e-4
[scheme]
kind = "exact-modal"
dt = 1e-5
"""
COATING = "[coating]\nE = 1e9\nyield_stress = 5e6\nhardening = 1e8\nthickness = 2e-3\nwidth = 0.04\ntip = 2e-3\n"
SPRING = '[law]\nkind = "spring"\nstiffness = 3e7\n'


@pytest.fixture
def folder(tmp_path):
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    return tmp_path


def scene(folder, text):
    path = folder / "scene.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("law", "same"),
    [
        (SPRING, ct.laws.ForceLaw(ct.Penalty(stiffness=3e7).response, mu=0.1)),
        ('[law]\nkind = "hertz"\nk = 1e10\ndissipation = 0.1\n', ct.laws.Hertz(k=1e10, dissipation=0.1, mu=0.1)),
        (
            '[law]\nkind = "table"\ndepth = [0.0, 1e-5, 1e-4]\nforce = [0.0, 10.0, 1e4]\n',
            ct.laws.ForceTable(depth=[0.0, 1e-5, 1e-4], force=[0.0, 10.0, 1e4], mu=0.1),
        ),
    ],
)  # fmt: skip
def test_a_law_of_a_scene_is_that_of_python(folder, law, same):
    stated = ct.load_scene(scene(folder, RIM + law))
    found, own = ct.run(stated), ct.run(stated, law=same)
    assert float(found.peak_force[0]) > 0.0
    np.testing.assert_array_equal(found.force, own.force)


def test_a_patch_rests_on_its_springs(folder):
    stated = ct.load_scene(scene(folder, PATCH + SPRING.replace("3e7", "1e5\ndamping = 200.0")))
    result = ct.run(stated, t_end=0.5)
    assert float(result.force[-1, 0]) == pytest.approx(10.0, rel=1e-4)
    assert float(result.gap[-1, 0]) == pytest.approx(-1e-4, rel=1e-4)


def test_stability_has_the_slope_of_the_law_as_a_spring_at_the_tip(folder):
    """As the blade with 1/k more compliance along the normal; of a curve the slope at the depth that the file gives."""
    rigid = ct.load_scene(scene(folder, RIM)).what
    a = np.radians(12.0)
    normal = np.array([np.cos(a), np.sin(a)])
    softer = replace(rigid.blade, S=rigid.blade.S + np.outer(normal, normal) / 3e7)
    expected = ct.stability.of_rim(replace(rigid, blade=softer), np.linspace(2.0, 40.0, 39), mu=0.1)
    depth = (3e7 / (1.5 * 1e10)) ** 2
    table = '[law]\nkind = "table"\ndepth = [0.0, 1e-5, 2e-5]\nforce = [0.0, 100.0, 400.0]\nclosed_depth = 1.2e-5\n'
    for law in (SPRING, f'[law]\nkind = "hertz"\nk = 1e10\nclosed_depth = {depth!r}\n', table):
        found = ct.scene.load_stability(scene(folder, RIM + law)).solve()
        np.testing.assert_allclose(found.growth, expected.growth, rtol=1e-9, atol=1e-9)
    assert np.ptp(expected.growth) > 0.0


@pytest.mark.parametrize(
    ("law", "words"),
    [
        ('[law]\nkind = "hertz"\nk = 1e10\n', r"law.closed_depth: found none with Hertz.*expected the mean depth"),
        ('[law]\nkind = "table"\ndepth = [0.0, 1e-4]\nforce = [0.0]\n', r"law.*force"),
        ('[law]\nkind = "table"\ndepth = [0.0, 1e-4]\nforce = [0.0, -1.0]\n', r"law.*force"),
        ('[law]\nkind = "table"\ndepth = [0.0, 1e-4, 1e-4]\nforce = [0.0, 1.0, 2.0]\n', r"law.*depth: found 0.0001 at"),
        ('[law]\nkind = "rubber"\n', r"law.kind.*'rubber'.*spring"),
        ("[law]\nstiffness = 1e6\n", r"law.kind: missing, expected one of spring, hertz, table"),
        (SPRING + COATING, r"law and coating found"),
    ],
)  # fmt: skip
def test_laws_that_cannot_be_meant_are_refused(folder, law, words):
    with pytest.raises(ct.InputError, match=words):
        ct.scene.load_stability(scene(folder, RIM + law))
