"""Moving shapes and rims: what is drawn is the mode, and the page that carries it stays small."""

import base64
import io
import json
import re

import numpy as np
import pytest
from PIL import Image

import casingfem as cf
from casingfem.plot.body.shapes import PHASES, Painter, figure_shapes, frames, moving_picture, moving_shapes, view_from
from casingfem.plot.body.surface import skin, surface_of
from casingfem.plot.body.turning import turning_shapes
from casingfem.plot.modes import around, figure_rim, groups, most_moving


@pytest.fixture(scope="module")
def casing(frustum, coarse) -> cf.Modes:
    return cf.modes(frustum(thickness=20e-3, mesh=coarse, radius_defect=cf.FourierField.of({6: 0.01})), 6)


@pytest.fixture(scope="module")
def moving(casing) -> bytes:
    return moving_picture(frames(casing, [0, 2]))


@pytest.mark.slow
def test_the_picture_swings_and_comes_back(moving):
    picture = Image.open(io.BytesIO(moving))
    assert (picture.format, picture.n_frames, picture.info["loop"]) == ("PNG", PHASES, 0)
    seen = []
    for k in range(PHASES):
        picture.seek(k)
        seen.append(np.asarray(picture.convert("RGB")).astype(int))
    assert np.all(seen[0][0, 0] == 255)
    for k in range(1, PHASES // 2):
        assert np.array_equal(seen[k], seen[PHASES - k])
    assert np.abs(seen[0] - seen[PHASES // 2]).max() > 100
    assert len({picture.tobytes() for picture in seen}) == PHASES // 2 + 1


@pytest.mark.slow
def test_a_page_with_moving_shapes_stays_small(casing, moving):
    picture = moving_shapes(casing, [0, 2], "Two shapes.")
    assert len(picture.html) < 1.4e6
    assert re.findall(r"data:image/(png|svg)", picture.html) == ["png", "png"]
    assert picture.html.index("<details") < picture.html.index('<div class="still">')
    assert len(moving) < 5e5


def test_faces_are_painted_from_the_back_and_coloured_by_displacement(casing):
    painter = Painter(casing, 0, view_from(38.0, -60.0), surface_of(casing, coarse=True))
    painter.show(1.0)
    corners = painter.corners(1.0)
    depth = corners.mean(axis=1) @ painter.view.near
    drawn = np.array([path.vertices[:4] for path in painter.faces.get_paths()])
    assert np.allclose(drawn, painter.flat(corners)[np.argsort(depth)])
    red, _, blue, _ = painter.faces.get_facecolor()[np.argsort(np.argsort(depth))].T
    strong = np.abs(painter.shade) > 0.3
    assert strong.any()
    assert np.all((red > blue)[strong] == (painter.shade > 0.0)[strong])


def test_no_shape_is_drawn_further_than_a_twentieth_of_the_size(casing):
    painter = Painter(casing, 3, view_from(38.0, -60.0), surface_of(casing, coarse=True))
    size = np.linalg.norm(np.ptp(painter.still, axis=(0, 1)))
    assert np.linalg.norm(painter.swing, axis=2).max() == pytest.approx(0.05 * size, rel=1e-3)


def data_of(html: str) -> dict:
    return json.loads(re.search(r'<script type="application/json">(.*?)</script>', html)[1])


def integers(coded: str, kind: str = "<i2") -> np.ndarray:
    return np.frombuffer(base64.b64decode(coded), kind)


@pytest.mark.slow
def test_shapes_to_be_turned_are_those_of_the_modes(casing):
    """Geometry once, every shape in 16 bits: to a part in 32,767 what the modes have at these nodes."""
    picture = turning_shapes(casing, [0, 4], "Two shapes and the radius.")
    data, surface = data_of(picture.html), surface_of(casing)
    assert picture.scripts == ("shapes",)
    assert len(picture.html) < 1.5e6
    centre = 0.5 * (surface.points.min(axis=0) + surface.points.max(axis=0))
    points = integers(data["points"]).reshape(-1, 3) / 32767 * data["reach"] + centre
    np.testing.assert_allclose(points, surface.points, atol=2 * data["reach"] / 32767)
    names = [shape["name"] for shape in data["shapes"]]
    assert names[0].startswith("mode 1: ")
    assert names[2:] == ["radius imperfection"]
    for mode, shape in zip((0, 4), data["shapes"], strict=False):
        u = casing.fields[surface.nodes, :3, mode]
        drawn = integers(shape["move"]).reshape(-1, 3) / 32767 * np.linalg.norm(u, axis=1).max()
        np.testing.assert_allclose(drawn, u, atol=np.abs(u).max() / 16000)
    faces = integers(data["faces"], "<u2").reshape(-1, 3)
    assert np.array_equal(faces, surface.triangles)
    assert faces.max() == len(points) - 1
    radius = data["shapes"][2]
    assert (radius["still"], radius["unit"]) == (True, "µm")
    assert radius["most"] == pytest.approx(0.01 * 500e3, rel=0.02)  # of the widest end, in micrometres
    w = np.sum(integers(radius["move"]).reshape(-1, 3) / 32767 * surface.out, axis=1) * radius["metres"]
    theta, r = np.arctan2(points[:, 1], points[:, 0]), np.hypot(points[:, 0], points[:, 1])
    np.testing.assert_allclose(w, 0.01 * np.cos(6 * theta) * r, atol=2e-5)


def test_an_imported_part_is_drawn_by_its_skin():
    wall = cf.imported.grid_mesh(
        "hexahedron20", (2, 24, 3), cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.04), wrap=1
    )
    whole = skin(wall)
    assert len(whole.triangles) == 2 * (2 * 24 * 3 + 2 * 24 * 2)  # inside, outside, two ends
    a, b, c = (whole.points[whole.triangles[:, k]] for k in range(3))
    volume = np.sum(a * np.cross(b, c)) / 6.0  # of a closed surface, positive where every face looks outward
    assert volume == pytest.approx(0.25 * 0.04 * 2 * np.pi * 0.475, rel=0.03)
    x, y, z = whole.points.T
    beyond = np.hypot(x, y) - (0.5 - 0.2 * z)  # the middle of the wall
    along = np.sum(whole.out[:, :2] * whole.points[:, :2], axis=1) / np.hypot(x, y)
    flat = np.abs(along) > 0.3
    assert flat.sum() > 100
    assert np.all((along * beyond)[flat] > 0.0)
    few = skin(wall, most=120)
    assert 30 < len(few.points) <= 120
    assert len(few.triangles) > 60
    span = np.ptp(whole.points, axis=0)
    np.testing.assert_allclose(np.ptp(few.points, axis=0), span, atol=0.2 * span.max())


def test_shapes_share_one_scale(casing):
    limits = {axes.get_xlim() + axes.get_ylim() for axes in figure_shapes(casing, [0, 1, 2, 3]).axes}
    assert len(limits) == 1


def test_rims_mark_the_antinode_and_draw_the_circle(casing):
    shown = groups(casing, 3)
    figure = figure_rim(casing, shown)
    for axes, group in zip(figure.axes, shown, strict=True):
        circle, *lines = axes.lines
        assert np.all(circle.get_ydata() == 1.0)
        waves = [line for line in lines if len(line.get_xdata()) > 2]
        marks = [line.get_xdata()[0] for line in lines if len(line.get_xdata()) == 2]
        assert len(waves) == len(group)
        turned = [mode for mode in group if np.isfinite(casing.angle_deg[mode])]
        assert marks == np.radians(casing.angle_deg[turned]).tolist()
        for mode in turned:
            wave = around(casing, mode, "top", np.linspace(0.0, 2.0 * np.pi, 721))
            at_mark = around(casing, mode, "top", np.radians(casing.angle_deg[[mode]]))
            assert abs(at_mark[0]) > 0.9 * np.abs(wave).max()
        words = " ".join(text.get_text() for text in axes.texts)
        assert all(f"{casing.freq[mode]:.2f} Hz" in words for mode in group)
    assert any(np.isfinite(casing.angle_deg[mode]) for group in shown for mode in group)


def test_the_rim_shown_is_the_one_that_moves(steel, coarse):
    held = cf.Shell(
        chart=cf.Frustum(r_base=0.45, r_top=0.50, height=0.25),
        thickness=20e-3,
        material=steel,
        supports={"top": cf.Clamped()},
        mesh=coarse,
    )
    modes = cf.modes(held, 2)
    assert most_moving(modes, [0, 1]) == "base"
    wave = next(line for line in figure_rim(modes, groups(modes, 1)).axes[0].lines if line.get_linestyle() == "--")
    assert np.ptp(wave.get_ydata()) > 0.4
