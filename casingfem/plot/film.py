"""A rub that plays: rim and tips, force and gap beside, drawn by `scripts/film.js` from numbers in 16 bits."""

from itertools import pairwise
from typing import Any

import numpy as np

from casingfem.io.arrays import Array
from casingfem.plot.contact import Run, thinned
from casingfem.plot.page import Picture, coded, island, packed

DRAWN = 0.13  # of the radius: the largest deviation drawn
ROUND = (1.0, 2.0, 5.0)
TRACE = 1500  # points of force and gap over the whole run


def rub_film(film: Any, run: Run) -> Picture:
    """A film, as `contact.film.RubFilm` holds it, as a picture of the page: a slider, the whole run's force and gap."""
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
    """How many times deviations are drawn: a round number, so that the largest of rim and tips is well seen."""
    rim = float(np.abs(film.profile).max(initial=0.0) + np.sqrt(film.cos**2 + film.sin**2).sum(axis=1).max(initial=0.0))
    most = max(rim, float(np.abs(film.gap).max(initial=0.0)), 1e-12)
    wanted = DRAWN * film.radius / most
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step for step in ROUND if step * power <= wanted * (1.0 + 1e-9)) * power)


def trace(name: str, time: Array, values: Array) -> dict[str, Any]:
    """A curve over the whole run, thinned so that no peak is lost."""
    t, y = thinned(time, values, TRACE)
    return {"name": name, "time": coded(t.astype("<f4")), "values": packed(y)}


def listed(numbers: list[int]) -> str:
    """Whole numbers in words, runs of three or more as from .. to.

    >>> listed([0, 2, 3, 4, 5, 9])
    '0, 2 to 5, 9'
    """
    cuts = [k for k, (a, b) in enumerate(pairwise(numbers), 1) if b != a + 1]
    runs = [numbers[a:b] for a, b in pairwise([0, *cuts, len(numbers)])]
    parts = [f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs]
    return ", ".join(parts)


def caption(film: Any, scale: float) -> str:
    """What is drawn, how much larger than it is, and what is left out."""
    rate = 1.0 / float(np.diff(film.time[: film.stretches[1] if len(film.stretches) > 1 else None]).mean())
    whole = (
        "the whole run"
        if len(film.stretches) == 1
        else f"{len(film.stretches)} stretches spread over the run, {len(film.time)} frames in all"
    )
    return (
        f"The rim (line) and the tips before it (dots, dark red where they touch), seen along the axis; deflection, "
        f"out-of-roundness and gap are drawn {scale:,.0f} times. {whole[0].upper()}{whole[1:]} at {rate:,.0f} frames a "
        f"second, with the harmonics n = {listed(film.n.tolist())}. The tick on the rim turns with the "
        "casing; beside, force and least gap of the whole run."
        + (f" {film.left_out} tips before other lines of the rim are not drawn." if film.left_out else "")
    )
