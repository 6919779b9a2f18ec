"""Scene files of kind "patch": the shipped oscillator against its closed form, basis files, broken tables."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import contact as ct
from casingfem.cli import main
from tests.probed import numbers_of_document

SCENES = Path(__file__).parents[3] / "data" / "scenes"
OSCILLATOR = (SCENES / "coulomb_oscillator.toml").read_text()


@pytest.mark.slow
def test_the_shipped_oscillator_rests_where_and_when_the_closed_form_states():
    result = ct.run(ct.load_scene(SCENES / "coulomb_oscillator.toml"))
    x = result.state[:, 0]
    assert x[result.state_time > 5.0 * np.pi + 0.02] == pytest.approx(0.0, abs=1e-6)
    turning = x[np.searchsorted(result.state_time, np.pi * np.arange(1, 5))]
    np.testing.assert_allclose(turning, [-0.8, 0.6, -0.4, 0.2], atol=1e-4)
    assert result.sticking[0][-1] == (pytest.approx(5.0 * np.pi, abs=5e-3), pytest.approx(20.0, abs=1e-9))
    assert result.energy.friction == pytest.approx(-0.5, abs=1e-6)


@pytest.mark.slow
def test_the_command_line_runs_it(held):
    done = CliRunner().invoke(main, ["contact", str(SCENES / "coulomb_oscillator.toml"), "--json"])
    assert done.exit_code == 0
    document = json.loads(done.stdout)
    assert document["contacts"][0]["impulse"] == pytest.approx(20.0, rel=1e-3)
    assert document["energy"]["friction"] == pytest.approx(-0.5, abs=1e-6)
    held(1e-4, document=numbers_of_document(document))


def of_basis(folder, contacts, more="", scheme='kind = "exact-modal"'):
    rows = np.array([[1.0, 0.0, 0.2], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    ct.ModalBody(omega=[0.0, 1.0, 2.0], zeta=[0.0, 0.0, 0.1], channels=("n", "s", "t"), rows=rows,
                 S=np.zeros((3, 3))).save(folder / "block.npz")  # fmt: skip
    file = folder / "scene.toml"
    file.write_text(
        f'[scene]\nkind = "patch"\nt_end = 1.0\n[body]\nbasis = "block.npz"\nload = {{n = -2.0, s = 0.5}}\n'
        f"{contacts}{more}\n[scheme]\n{scheme}\ndt = 1e-2\n"
    )
    return ct.load_scene(file)


def test_an_event_driven_scene_has_its_restitution_and_refuses_friction(tmp_path):
    contact = '[[contact]]\nnormal = "n"\nclearance = 0.01\n'
    scene = of_basis(tmp_path, contact, scheme='kind = "event-driven"\nrestitution = 0.5')
    assert scene.scheme == ct.scheme.EventDriven(restitution=0.5)
    assert len(ct.run(scene).intervals[0]) > 1
    rough = '[[contact]]\nnormal = "n"\ntangent = ["s"]\nclearance = 0.01\n[ground]\nfriction = 0.4\n'
    with pytest.raises(ct.InputError, match=r"found Coulomb with friction 0\.4, expected Unilateral"):
        ct.run(of_basis(tmp_path, rough, scheme='kind = "event-driven"'))


@pytest.mark.slow
def test_a_basis_file_in_a_plane_dragged_by_the_ground(tmp_path):
    contact = '[[contact]]\nnormal = "n"\ntangent = ["s", "t"]\nslide = [0.1, -0.2]\nclearance = 0.01\n'
    scene = of_basis(tmp_path, contact, "[ground]\nfriction = 0.4")
    assert scene.law == ct.Coulomb(mu=0.4)
    assert (scene.what.dimensions, scene.what.slide.tolist(), scene.what.clearance.tolist()) == (
        3, [[0.1, -0.2]], [0.01],
    )  # fmt: skip
    np.testing.assert_allclose(scene.what.load, [-2.0, 0.5, -0.4])
    assert ct.run(scene).impulse[0] > 0.5


def test_contacts_without_tangents_have_no_friction(tmp_path):
    scene = of_basis(tmp_path, '[[contact]]\nnormal = "n"\n[[contact]]\nnormal = "t"\nclearance = 0.5\n')
    assert scene.law == ct.Unilateral()
    assert (scene.what.contacts, scene.what.dimensions) == (2, 1)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('normal = "y"', 'normal = "z"', "body: channel: found 'z', expected one of x, y"),
        ("load = {y = -1.0}", "load = {z = -1.0}", "body: channel: found 'z'"),
        ('channels = ["x", "y"]', "", "expected a basis, or omega, channels and rows"),
        ("omega = [1.0, 0.0]", 'basis = "x.npz"\nomega = [1.0, 0.0]', "basis, omega, channels, rows found"),
        (
            "rows = [[1.0, 0.0], [0.0, 1.0]]",
            "rows = [[1.0], [0.0, 1.0]]",
            "body: rows: found rows of different lengths",
        ),
        ("slide = [0.0]", "slide = [0.0, 1.0]", "contact[1]: 2 slide found, expected 1"),
        ('tangent = ["x"]', 'tangent = ["x", "x", "x"]', "contact[1].tangent"),
        ('tangent = ["x"]', "tangent = []\n#", "ground.friction found without tangents"),
        ("clearance = 0.0", "clearance = -0.1", "body: clearance: contact 1 penetrates"),
        ("displacement = [1.0, 0.0]", "displacement = [1.0]", "body: displacement"),
        ('kind = "exact-modal"', 'kind = "newmark"', "scheme.kind: found 'newmark', expected 'exact-modal'"),
        (
            'kind = "exact-modal"',
            'kind = "exact-modal"\nrestitution = 0.5',
            "restitution found with kind = 'exact-modal'",
        ),
        ("friction = 0.1", "mu = 0.1", "ground.mu: unknown key"),
    ],
)
def test_broken_tables_name_their_key(tmp_path, old, new, words):
    assert old in OSCILLATOR
    text = OSCILLATOR.replace(old, new, 1)
    if new == "tangent = []\n#":
        text = text.replace("slide = [0.0]", "slide = []")
    (tmp_path / "scene.toml").write_text(text)
    with pytest.raises(ct.scene.SceneError) as caught:
        ct.load_scene(tmp_path / "scene.toml")
    assert words in str(caught.value)


PRESSED = """[scene]
kind = "patch"
t_end = 60.0
[body]
omega = [2.0]
zeta = [0.2]
channels = ["n", "p"]
rows = [[1.0], [0.5]]
S = [[0.4, 0.1], [0.1, 0.6]]
load = {p = -3.0}
[[contact]]
normal = "n"
[scheme]
kind = "exact-modal"
dt = 2e-2
"""


@pytest.mark.slow
def test_a_load_presses_by_the_residual_compliance_too(tmp_path):
    """At rest on the ground the force is f (r_n r_p/omega^2 + S_np)/(r_n^2/omega^2 + S_nn), all of the compliance."""
    (tmp_path / "scene.toml").write_text(PRESSED)
    result = ct.run(ct.load_scene(tmp_path / "scene.toml"))
    wanted = 3.0 * (0.5 / 4.0 + 0.1) / (1.0 / 4.0 + 0.4)
    settled = result.force[result.time > 50.0]
    np.testing.assert_allclose(settled, wanted, rtol=1e-6)
