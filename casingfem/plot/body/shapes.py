"""Shapes in space: surfaces in a fixed parallel projection, painted from back to front, still or animated."""

import io
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from PIL import Image

from casingfem.io.arrays import Array, FloatArray
from casingfem.modal.mode_set import ModeSet
from casingfem.plot.body.surface import Surface, surface_of
from casingfem.plot.modes import title
from casingfem.plot.page import Picture
from casingfem.plot.style import DIVERGING, embed, image, new_figure, styled

EXAGGERATION = 0.05  # largest displacement drawn, as a part of the structure's diagonal
PHASES = 20  # pictures in a period
SECONDS = 1.6  # a period on the page
COLOURS = 64  # of a moving picture
VIEWS = {True: (38.0, -60.0), False: (38.0, -40.0)}  # elevation, azimuth [deg], by whether the surface is closed


class View(NamedTuple):
    """Axes of a parallel projection: right, up, and towards the viewer, each (3,)."""

    right: FloatArray
    up: FloatArray
    near: FloatArray


def view_from(elevation: float, azimuth: float) -> View:
    """The view from an elevation above the x-y plane and an azimuth from x [degrees], with z upward.

    >>> view_from(0.0, 90.0).right.round(3).tolist()
    [-1.0, 0.0, 0.0]
    """
    e, a = np.radians([elevation, azimuth])
    near = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return View(right, np.cross(near, right), near)


class Painter:
    """One mode on its surface: `show(part)` paints it at displacement part * u, part in [-1, 1]."""

    def __init__(self, modes: ModeSet, mode: int, view: View, surface: Surface) -> None:
        u = modes.fields[surface.nodes, :3, mode]
        most = np.linalg.norm(u, axis=1).max()
        self.still = surface.points[surface.faces]
        self.swing = (EXAGGERATION * surface.size / most * u)[surface.faces]
        self.shade = (np.sum(u * surface.out, axis=1) / most)[surface.faces].mean(axis=1)
        self.view = view
        self.faces: Any = PolyCollection([], linewidth=0.4)

    def corners(self, part: float) -> Array:
        """Corners of the faces in space, (faces, 3 or 4, 3)."""
        return np.asarray(self.still + part * self.swing)

    def flat(self, corners: Array) -> Array:
        """Corners of the faces on the page, (faces, 3 or 4, 2)."""
        return corners @ np.stack([self.view.right, self.view.up], axis=-1)

    def reach(self) -> Array:
        """Lower left and upper right corner of the painted area, (2, 2)."""
        extremes = np.concatenate([self.flat(self.corners(part)).reshape(-1, 2) for part in (-1.0, 1.0)])
        return np.stack([extremes.min(axis=0), extremes.max(axis=0)])

    def show(self, part: float) -> None:
        """Paint the faces from back to front: hue by displacement, darker where they face away from the viewer."""
        corners = self.corners(part)
        order = np.argsort(corners.mean(axis=1) @ self.view.near)
        normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
        facing = np.abs(normals @ self.view.near) / np.linalg.norm(normals, axis=1)
        colours = colormaps[DIVERGING](0.5 + 0.5 * part * self.shade)
        colours[:, :3] *= (0.72 + 0.28 * facing)[:, None]
        self.faces.set_verts(self.flat(corners)[order])
        self.faces.set(facecolor=colours[order], edgecolor=colours[order])


def stage(modes: ModeSet, which: Sequence[int], columns: int) -> tuple[Figure, list[Painter]]:
    """A figure with axes for each mode, all at one scale, and the function that draws them."""
    surface = surface_of(modes, coarse=True)
    view = view_from(*VIEWS[surface.closed])
    found = [Painter(modes, mode, view, surface) for mode in which]
    reaches = np.array([painter.reach() for painter in found])
    low, high = reaches[:, 0].min(axis=0), reaches[:, 1].max(axis=0)
    width, height = high - low
    rows = -(-len(which) // columns)
    figure = new_figure(8.4, (8.4 / columns * float(np.clip(height / width, 0.3, 1.5)) + 0.35) * rows)
    for k, (mode, painter) in enumerate(zip(which, found, strict=True)):
        axes: Any = figure.add_subplot(rows, columns, k + 1)
        axes.add_collection(painter.faces)
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        axes.set_axis_off()
        axes.set_title(title(modes, mode))
    return figure, found


@styled
def figure_shapes(modes: ModeSet, which: Sequence[int], columns: int = 3) -> Figure:
    """Shapes of some modes (indices) with exaggerated displacement, coloured by its radial (or normal) part."""
    figure, shown = stage(modes, which, columns)
    for painter in shown:
        painter.show(1.0)
    return figure


@styled
def frames(modes: ModeSet, which: Sequence[int], columns: int = 3) -> list[Array]:
    """Pictures of half a period, from one extreme to the other, each (height, width, 3) of bytes."""
    figure, shown = stage(modes, which, columns)
    canvas: Any = FigureCanvasAgg(figure)
    pictures = []
    for k in range(PHASES // 2 + 1):
        for painter in shown:
            painter.show(float(np.cos(2.0 * np.pi * k / PHASES)))
        canvas.draw()
        figure.set_layout_engine("none")  # what the first picture settled stays
        pictures.append(np.asarray(canvas.buffer_rgba())[:, :, :3].copy())
    return pictures


def moving_picture(pictures: Sequence[Array]) -> bytes:
    """An animated PNG that repeats half a period forth and back, in a few colours."""
    sample = Image.fromarray(np.concatenate([pictures[0], pictures[len(pictures) // 2], pictures[-1]]))
    palette = sample.quantize(COLOURS, dither=Image.Dither.NONE)
    once = [Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    for picture in once:
        whiten(picture)
    period = [*once, *once[-2:0:-1]]
    buffer = io.BytesIO()
    duration = round(1000.0 * SECONDS / len(period))
    period[0].save(buffer, "PNG", save_all=True, append_images=period[1:], loop=0, duration=duration)
    return buffer.getvalue()


def whiten(picture: Image.Image) -> None:
    """Make the colour of the upper left corner white."""
    colours = np.array(picture.getpalette()).reshape(-1, 3)
    colours[np.asarray(picture)[0, 0]] = 255
    picture.putpalette(colours.ravel().tolist())


def moving_shapes(modes: ModeSet, which: Sequence[int], caption: str) -> Picture:
    """The animated shapes, with a still picture for print and for readers who prefer no motion."""
    moving = image(moving_picture(frames(modes, which)), "png", f"Moving: {caption}")
    still = embed(figure_shapes(modes, which), caption, kind="png")
    opened = f'<details class="motion" open><summary>moving</summary>{moving}</details>'
    return Picture(f'{opened}<div class="still">{still}</div>', caption)
