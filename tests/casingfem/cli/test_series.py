"""A rub for ParaView: the whole casing moves as its rim does, and the tips stand where they press."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
import contact as ct
from casingfem.cli import main
from casingfem.cli.pictures import series_files
from casingfem.structure.mesh.shell_mesh import make_grid
from contact.io.outfiles import write_files
from contact.model.trig import harmonics
from contact.recovery import at_channels, rub_forces
from tests.casingfem.export.played import steps_of
from tests.contact.record.test_result_numbers import MADE
from tests.contact.synthetic_rub import nodes, rim3, tips

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
def test_the_casing_moves_as_its_rim(folder, written):
    """Its Fourier coefficients by the edge's quadrature are the rim's channels: kept modes and residual compliance."""
    out, result = written
    frames = steps_of(out / "casing.vtkhdf")
    assert len(frames) == FRAMES
    assert result.force.max() > 1.0
    rub = ct.load_scene(folder / "rub.toml").what
    channels = at_channels(rub.casing, result.state_of("casing"), rub_forces(rub, result, "casing")[1])
    points, edge = rub.casing.recovery_points, make_grid(CASING.chart, CASING.mesh).edges["top"]
    top = edge.nodes
    theta = np.arctan2(points[top, 1], points[top, 0])
    size = 2 * N_MAX + 1
    waves = harmonics(N_MAX, theta) * (edge.weights / np.pi)[:, None]
    waves[:, 0] /= 2.0
    for mesh in frames[-30::7]:  # from the first touch on
        k = int(np.argmin(np.abs(result.state_time - mesh.time)))
        moved = mesh.point_data["displacement"]
        radial = moved[top, 0] * np.cos(theta) + moved[top, 1] * np.sin(theta)
        np.testing.assert_allclose(radial @ waves, channels[k, :size], atol=3e-4 * np.abs(channels[k]).max())
        away = np.linalg.norm(mesh.points - points, axis=1)
        ratio = away[top] / np.linalg.norm(moved[top], axis=1)
        assert ratio == pytest.approx(np.full(len(top), ratio[0]), rel=1e-2)  # drawn larger, all alike
    assert set(mesh.kinds.tolist()) == {9}
    assert len(mesh.cells) == 9 * 25


@pytest.mark.slow
def test_the_tips_stand_on_the_rim_and_turn_against_the_casing(written):
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


def test_each_tip_stands_on_its_line_at_its_angle_and_bodies_move_as_their_modes(tmp_path):
    """Three tips on two lines; the states are made up, all numbers different."""
    rng = np.random.default_rng(17)
    recovery = rng.standard_normal((9, 10))
    casing = replace(
        rim3(), lines=np.array([[0.1, 0.4], [0.25, 0.43]]), recovery=recovery, recovery_points=np.eye(3),
        recovery_cells=np.array([[5, 0, 1, 2]]),
    )  # fmt: skip
    rub = ct.Rub(casing, [nodes(3)], tips(3), clearance=1e-5, speed=ct.Speed.constant(5.0))
    states = 205
    result = replace(
        MADE, state_time=1e-4 * np.arange(states),
        state=rng.standard_normal((states, 13)), tip_force=rng.standard_normal((states, 9)),
        channels=np.zeros((0, 22)),
        blocks=(("casing", 0, 10), ("blade", 10, 13)),
    )  # fmt: skip
    write_files(tmp_path, series_files(rub, result))
    assert {path.name for path in (tmp_path / "vtu").iterdir()} == {"casing.vtkhdf", "tips.vtkhdf"}
    shown, casing_shown = (steps_of(tmp_path / "vtu" / f"{name}.vtkhdf") for name in ("tips", "casing"))
    assert len(shown) == FRAMES
    for at in (0, 41, FRAMES - 1):
        found, time = shown[at], shown[at].time
        k = int(np.argmin(np.abs(result.state_time - time)))
        assert time == result.state_time[k]
        angle = np.radians([10.0, 10.5, 11.0]) - 2.0 * np.pi * 5.0 * time
        radius, axial = np.array([0.4, 0.43, 0.4]), [0.1, 0.25, 0.1]
        np.testing.assert_allclose(
            found.points,
            np.stack([radius * np.cos(angle), radius * np.sin(angle), axial], axis=1),
            rtol=1e-6,
            atol=1e-7,
        )
        np.testing.assert_allclose(found.point_data["normal_force_N"], result.tip_force[k, ::3], rtol=1e-6)
        moved = casing_shown[at].point_data["displacement"]
        np.testing.assert_allclose(moved.ravel(), recovery @ result.state[k, :10], rtol=1e-5, atol=1e-5)
    assert shown[-1].time == result.state_time[-1]


@pytest.mark.slow
def test_what_is_missing_is_said(folder, written):
    rim = ct.load_scene(folder / "rub.toml").what
    bodies = (replace(body, recovery=None, recovery_S=None, recovery_cells=None) for body in (rim.casing, rim.blade))
    without = ct.RotatingRim(*bodies, clearance=1e-4, speed_hz=20.0)
    with pytest.raises(ct.InputError, match=r"recovery = true in \[reduce\]"):
        series_files(without, written[1])
    alone = CliRunner().invoke(main, ["rub", str(folder / "rub.toml"), "--vtu"])
    assert alone.exit_code == 2
    assert "--vtu without --out" in alone.stderr
