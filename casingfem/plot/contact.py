"""Pictures of a contact run: force, gap and amplitudes over time, the wear of a coating; an animated rub.

`scripts/film.js` draws the film (rim and tips, with force and gap) from numbers in 16 bits.
"""

from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from matplotlib.figure import Figure

from casingfem.io.arrays import Array
from casingfem.plot.history import Panel, closeup_of, figure_history, thinned
from casingfem.plot.page import Picture, coded, island, packed
from casingfem.plot.style import AFTER, BEFORE, GREEN, PERFECT, PURPLE, SKY, new_figure, styled

COLOURS = (BEFORE, AFTER, GREEN, PURPLE, SKY)
DRAWN = 0.13  # of the radius: the largest deviation drawn
ROUND = (1.0, 2.0, 5.0)
TRACE = 1500  # points of force and gap over the whole run


class _Run(Protocol):
    """Plot data of a contact result: a column for each contact, states by coordinate, the ends of each body.

    Times [s], (n,), gaps [m] and forces averaged over the model's shortest period, `window` [s], in newtons, (n,
    contacts); times of the states [s], (ns,), and coordinates, (ns, N).
    """

    @property
    def time(self) -> Array: ...

    @property
    def gap(self) -> Array: ...

    @property
    def state_time(self) -> Array: ...

    @property
    def state(self) -> Array: ...

    @property
    def blocks(self) -> tuple[tuple[str, int, int], ...]: ...

    @property
    def scheme(self) -> str: ...

    @property
    def window(self) -> float: ...

    def windowed_force(self) -> Array: ...


def figure_contact(result: _Run, contact: int = 0, *, coordinates: int = 4, rim: Any = None) -> Figure:
    """Force, gap and motion of one run over time, and a close-up of its largest force.

    Motion is the rim's largest deflection if `rim`, a `contact.recovery.around_rim.RimMotion`, is given; else that of
    the coordinates that move most, with the names of their bodies.
    """
    force = result.windowed_force()[:, contact]
    panels = [
        Panel(label="force, averaged [N]", time=result.time, curves=[("", force, AFTER)], from_zero=True),
        Panel(label="gap [mm]", time=result.time, curves=[("", 1e3 * result.gap[:, contact], BEFORE)], level=(0.0, "")),
    ]
    if rim is not None:
        panels.append(deflection_panel(rim))
    elif len(result.state_time) > 1:
        panels += _coordinates(result, coordinates)
    least = 4.0 * result.window
    return figure_history(panels, closeup_of(result.time, force, max(least, 20.0 * _step(result.time))))


def _step(time: Array) -> float:
    return float(time[-1] - time[0]) / (len(time) - 1) if len(time) > 1 else 0.0


def deflection_panel(rim: Any) -> Panel:
    """Largest deflection around the rim, with the limit of the linear model if it is close."""
    allowed = 1e3 * float(rim.allowed)
    near = np.isfinite(allowed) and 1e3 * rim.largest > 0.2 * allowed
    return Panel(
        label="rim deflection [mm]", time=rim.time, curves=[("", 1e3 * rim.deflection, GREEN)], from_zero=True,
        level=(allowed, "half the wall: limit of the linear model") if near else None,
    )  # fmt: skip


def _coordinates(result: _Run, most: int) -> list[Panel]:
    """The coordinates that move most: modes, ends of rods, masses; no panel for bodies without such names."""
    modal = "modal" in result.scheme
    names = {
        start + k: name
        for body, start, end in result.blocks
        for k, name in named_coordinates(body, end - start, modal=modal).items()
    }
    if not names:
        return []
    known = np.array(list(names))
    size = np.abs(result.state[:, known]).max(axis=0)
    chosen = known[np.argsort(-size, kind="stable")[:most]].tolist()
    scale, unit = (1.0, "modal coordinate\n[√kg m]") if modal else (1e3, "displacement [mm]")
    curves = [(names[k], scale * result.state[:, k], colour) for k, colour in zip(chosen, COLOURS, strict=False)]
    return [Panel(label=unit, time=result.state_time, curves=curves)]


def named_coordinates(body: str, count: int, *, modal: bool) -> dict[int, str]:
    """Names of those coordinates of a body that have one, by index.

    >>> named_coordinates("blade", 2, modal=True), named_coordinates("rod 1", 101, modal=False)
    ({0: 'blade, mode 1', 1: 'blade, mode 2'}, {0: 'rod 1, left end', 100: 'rod 1, right end'})
    """
    if modal:
        return {k: f"{body}, mode {k + 1}" for k in range(count)}
    if body.startswith("rod"):
        return {0: f"{body}, left end", count - 1: f"{body}, right end"}
    return {0: body.replace("pointmass", "mass")} if body.startswith("pointmass") else {}


class _Worn(Protocol):
    """Material removed from a coating, by angle of its bars [rad].

    Deviations of the radius [m] as manufactured, before and after a run, (cells,); worn depths [m] at the times [s] of
    the map, (times, cells).
    """

    @property
    def angle(self) -> Array: ...

    @property
    def made(self) -> Array: ...

    @property
    def before(self) -> Array: ...

    @property
    def after(self) -> Array: ...

    @property
    def map_time(self) -> Array: ...

    @property
    def map(self) -> Array: ...


@styled
def figure_wear(wear: _Worn) -> Figure:
    """Profile of the coating's surface (top), and the map of its wear (bottom); larger radius upwards."""
    figure = new_figure(8.0, 6.0)
    axes: Any = figure.subplots(2, 1, sharex=True)
    degrees = np.degrees(wear.angle)
    axes[0].plot(degrees, 1e6 * wear.made, color=PERFECT, linestyle=":", label="as made")
    axes[0].plot(degrees, 1e6 * wear.before, color=BEFORE, label="before the run")
    axes[0].plot(degrees, 1e6 * wear.after, color=AFTER, label="after")
    axes[0].set_ylabel("deviation of the\nradius [µm]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=3, fontsize=8)
    extent = (0.0, 360.0, float(wear.map_time[0]), float(wear.map_time[-1]))
    axes[1].grid(False)
    image = axes[1].imshow(
        1e6 * wear.map, aspect="auto", origin="lower", extent=extent, cmap="magma_r", interpolation="nearest"
    )
    figure.colorbar(image, ax=axes[1], label="worn depth [µm]")
    axes[1].set(ylabel="time [s]", xlabel="angle on the casing [deg]")
    return figure


def rub_film(film: Any, run: _Run) -> Picture:
    """A film, a `contact.recovery.histories.RubFilm`, for a page, with a slider, force and gap of the whole run."""
    scale = exaggeration(film)
    data: dict[str, Any] = {
        "time": coded(film.time.astype("<f4")), "turned": coded(film.turned.astype("<f4")),
        "stretches": film.stretches.tolist(), "n": film.n.tolist(), "radius": film.radius, "scale": scale,
        "cos": packed(film.cos), "sin": packed(film.sin), "profile": packed(film.profile),
        "angle": film.angle.round(6).tolist(), "gap": packed(film.gap), "force": packed(film.force),
        "traces": [
            trace("force of all tips [N]", run.time, run.windowed_force().sum(axis=1)),
            trace("least gap [mm]", run.time, 1e3 * run.gap.min(axis=1)),
        ],
    }  # fmt: skip
    still = '<p class="still">Force and gap of this run are drawn below; the film needs a browser with scripts.</p>'
    return Picture(island("film", data, still), caption(film, scale), ("film",))


def exaggeration(film: Any) -> float:
    """Magnification of drawn deviations: a round number that makes the largest of rim and tips visible."""
    rim = float(np.abs(film.profile).max(initial=0.0) + np.sqrt(film.cos**2 + film.sin**2).sum(axis=1).max(initial=0.0))
    most = max(rim, float(np.abs(film.gap).max(initial=0.0)), 1e-12)
    wanted = DRAWN * film.radius / most
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step for step in ROUND if step * power <= wanted * (1.0 + 1e-9)) * power)


def trace(name: str, time: Array, values: Array) -> dict[str, Any]:
    """A curve over the whole run, thinned without losing peaks."""
    t, y = thinned(time, values, TRACE)
    return {"name": name, "time": coded(t.astype("<f4")), "values": packed(y)}


def listed(numbers: list[int]) -> str:
    """Whole numbers as text, with runs of three or more as from .. to.

    >>> listed([0, 2, 3, 4, 5, 9])
    '0, 2 to 5, 9'
    """
    cuts = [k for k, (a, b) in enumerate(pairwise(numbers), 1) if b != a + 1]
    runs = [numbers[a:b] for a, b in pairwise([0, *cuts, len(numbers)])]
    parts = [f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs]
    return ", ".join(parts)


def caption(film: Any, scale: float) -> str:
    """Caption: contents of the picture, magnification, and omitted parts."""
    rate = 1.0 / float(np.diff(film.time[: film.stretches[1] if len(film.stretches) > 1 else None]).mean())
    whole = (
        "the whole run"
        if len(film.stretches) == 1
        else f"{len(film.stretches)} stretches spread over the run, {len(film.time)} frames in all"
    )
    return (
        f"The rim (line) and the tips near it (dots, dark red where they touch), seen along the axis; deflection, "
        f"out-of-roundness and gap are magnified {scale:,.0f} times. {whole[0].upper()}{whole[1:]} at {rate:,.0f} "
        f"frames a second, with the harmonics n = {listed(film.n.tolist())}. The tick on the rim turns with the "
        "casing. The curves are the force and the least gap over the whole run."
        + (f" {film.left_out} tips at other lines of the rim are not drawn." if film.left_out else "")
    )
