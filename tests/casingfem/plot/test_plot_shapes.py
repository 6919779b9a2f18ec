"""Moving shapes and rims: what is drawn is the mode, and the page that carries it stays small."""

import io
import re

import numpy as np
import pytest
from PIL import Image

import casingfem as cf
from casingfem.plot.modes import around, figure_rim, groups, most_moving
from casingfem.plot.shapes import PHASES, Painter, figure_shapes, frames, moving_picture, moving_shapes, view_from


@pytest.fixture(scope="module")
def casing(frustum, coarse) -> cf.Modes:
    return cf.modes(frustum(thickness=20e-3, mesh=coarse, radius_defect=cf.FourierField.of({6: 0.01})), 6)


@pytest.fixture(scope="module")
def moving(casing) -> bytes:
    return moving_picture(frames(casing, [0, 2]))


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


def test_a_page_with_moving_shapes_stays_small(casing, moving):
    picture = moving_shapes(casing, [0, 2], "Two shapes.")
    assert len(picture.html) < 1.4e6
    assert re.findall(r"data:image/(png|svg)", picture.html) == ["png", "png"]
    assert picture.html.index("<details") < picture.html.index('<div class="still">')
    assert len(moving) < 5e5


def test_faces_are_painted_from_the_back_and_coloured_by_displacement(casing):
    painter = Painter(casing, 0, view_from(38.0, -60.0), (15, 181))
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
    painter = Painter(casing, 3, view_from(38.0, -60.0), (99, 999))
    size = np.linalg.norm(np.ptp(painter.still, axis=(1, 2)))
    assert np.linalg.norm(painter.swing, axis=0).max() == pytest.approx(0.05 * size, rel=1e-3)


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
