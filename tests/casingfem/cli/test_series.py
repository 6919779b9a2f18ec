"""A rub for ParaView: the whole casing moves as its rim does, and the tips are where they press."""

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
import contact as ct
from casingfem.cli import main
from tests.casingfem.export.played import steps_of

N_MAX, FRAMES = 6, 100
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
CASING = cf.Shell(
    chart=cf.Cylinder(radius=0.3, height=0.2), thickness=2e-3, material=STEEL, supports={"base": cf.Clamped()},
    mesh=cf.ShellMesh(order=5, rows=1, around=9),
)  # fmt: skip
SCENE = """
[scene]
kind = "rim"
t_end = 0.02
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
[contact]
clearance = 1e-4
out_of_roundness = [{p = 2, cos = 1.5e-4}]
[speed]
turning = "blades"
hz = 20.0
[scheme]
kind = "exact-modal"
dt = 2e-5
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A scene whose bases recover their nodes."""
    found = tmp_path_factory.mktemp("series")
    blade = cf.Shell(
        chart=cf.Plate(length=0.1, width=0.04), thickness=3e-3, material=STEEL, supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=4, rows=1, around=1),
    )  # fmt: skip
    cf.reduce(CASING, cf.Rim("top", n_max=N_MAX), modes=20, recovery=True).save(found / "casing.npz")
    cf.reduce(blade, cf.Tip(), modes=3, recovery=True).save(found / "blade.npz")
    (found / "rub.toml").write_text(SCENE, encoding="utf-8")
    return found


@pytest.fixture(scope="module")
def written(folder):
    """What the command writes: its folder, and the result."""
    out = folder / "out"
    result = CliRunner().invoke(main, ["rub", str(folder / "rub.toml"), "--vtu", "--out", str(out)])
    assert result.exit_code == 0, result.output
    return out / "vtu", ct.Result.load(out / "rub.npz")


@pytest.mark.slow
def test_the_tips_are_on_the_rim_and_turn_against_the_casing(written):
    out, result = written
    frames = steps_of(out / "tips.vtkhdf")
    places = np.array([frame.points[0] for frame in frames])
    np.testing.assert_allclose(np.hypot(places[:, 0], places[:, 1]), 0.3, rtol=1e-6)
    np.testing.assert_allclose(places[:, 2], 0.2, rtol=1e-6)  # the edge "top"
    angle = np.unwrap(np.arctan2(places[:, 1], places[:, 0]))
    times = np.array([frame.time for frame in frames])
    np.testing.assert_allclose(angle - angle[0], -2.0 * np.pi * 20.0 * (times - times[0]), atol=1e-3)
    force = [float(frame.point_data["normal_force_N"][0]) for frame in frames]
    k = int(np.argmax(force))
    near = np.abs(result.time - times[k]) < 1e-4
    assert force[k] == pytest.approx(result.force[near].max(), rel=0.1)


@pytest.mark.slow
def test_a_body_is_drawn_with_its_displacement_times_the_stated_factor_and_at_rest_with_1(folder, written):
    """The largest displacement is drawn as a twentieth of the body's diagonal."""
    rest = ct.ModalBody.load(folder / "casing.npz").recovery_points
    frames = steps_of(written[0] / "casing.vtkhdf")
    (factor,) = {float(frame.field_data["exaggeration"]) for frame in frames}
    moved = np.array([frame.point_data["displacement"] for frame in frames])
    np.testing.assert_allclose([frame.points for frame in frames], rest + factor * moved, atol=1e-6)
    diagonal = np.linalg.norm(np.ptp(rest, axis=0))
    assert factor * np.linalg.norm(moved, axis=2).max() == pytest.approx(0.05 * diagonal, rel=1e-5)
    (folder / "apart.toml").write_text(SCENE.replace("clearance = 1e-4", "clearance = 1e-3"), encoding="utf-8")
    result = CliRunner().invoke(main, ["rub", str(folder / "apart.toml"), "--vtu", "--out", str(folder / "apart")])
    assert result.exit_code == 0, result.output
    for frame in steps_of(folder / "apart" / "vtu" / "casing.vtkhdf"):
        assert frame.field_data["exaggeration"] == 1.0
        np.testing.assert_allclose(frame.points, rest, atol=1e-7)
