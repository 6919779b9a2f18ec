"""The page about a scene: results of the run, dangerous speeds, limits of the rim."""

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from casingfem.cli.pictures import figures, speed_figures, turn_of
from casingfem.examples import first_sentence
from casingfem.io.side_by_side import aside, usable_cores
from contact.io.infiles import read_bytes, text_of

if TYPE_CHECKING:
    from casingfem.plot.page import Page, Picture
    from casingfem.plot.pages.scene import Ran
    from contact.interacting import Interactions
    from contact.prepared import Scene
    from contact.recovery.around_rim import RimMotion
    from contact.result import Result


def page(scene: "Scene", result: "Result", file: Path, say: Callable[[str], None]) -> "Page":
    """The page about a scene; for rims, rubs and disks with the table of dangerous speeds and a film.

    A second process draws the run while this one runs the scene at other speeds.
    """
    from contact.version import versions

    rubs, found, why = turns(scene.what), None, ""
    with aside(rubs and usable_cores() > 1) as start:
        drawn = start(partial(motion_of, scene, result))
        if rubs:
            say("interactions")
            found, why = table_of(file)
        say("drawing")
        from casingfem.plot.pages.scene import scene_page

        speeds = {} if found is None else speed_figures(scene, found, turn_of(scene.what))
        rim, motion = drawn()
    ran = run_numbers(scene, result, rim)
    text = text_of(read_bytes(file))
    described = first_sentence(text)
    return scene_page(
        file.stem, text, ran, motion, speeds=speeds, found=found, why=why,
        lead=described if described.endswith(".") else "", source={**scene.source, **versions()},
    )  # fmt: skip


def turns(what: object) -> bool:
    """Whether a scene's problem has a rim before blades, and therefore dangerous speeds."""
    from contact.model.gaps.gap import RotatingRim
    from contact.model.gaps.rub import Rub

    return isinstance(what, RotatingRim | Rub)


def motion_of(scene: "Scene", result: "Result") -> "tuple[RimMotion | None, list[Picture]]":
    """Motion of the rim in a run, the run's film and pictures."""
    from casingfem.plot.contact import rub_film as film_of
    from casingfem.plot.pages.scene import motion_pictures
    from contact.recovery.around_rim import rim_motion
    from contact.recovery.histories import rub_film

    rim = rim_motion(scene.what, result)
    film = rub_film(scene.what, result)
    pictures = motion_pictures(figures(scene, result, rim), rubs=turns(scene.what))
    return rim, pictures if film is None else [film_of(film, result), *pictures]


def table_of(file: Path) -> "tuple[Interactions | None, str]":
    """The table of dangerous speeds of a scene, or the reason why there is none."""
    from contact.base.errors import InputError
    from contact.scene.stability import load_interactions

    try:
        return load_interactions(file).solve(processes=usable_cores()), ""
    except InputError as error:
        return None, str(error)


def run_numbers(scene: "Scene", result: "Result", rim: "RimMotion | None") -> "Ran":
    """Results of a run for the page, all contacts together."""
    from casingfem.plot.pages.scene import Ran
    from contact.on_rotor import rotor_history

    energy, windowed = result.energy, result.windowed_force()
    least = result.least_gap
    return Ran(
        rubs=turns(scene.what), steps=result.steps, dt=result.dt, span=result.steps * result.dt, window=result.window,
        contacts=list(result.records()), contact_columns=result.described(), force=float(windowed.max(initial=0.0)),
        impulse=float(result.impulse.sum()), closed=float(result.contact_steps.max(initial=0)) * result.dt,
        closings=sum(map(len, result.intervals)), least_gap=float(least.min()) if least.size else math.nan,
        residual=float(result.residual.max(initial=0.0)),
        unaccounted=abs(energy.unaccounted) / energy.scale if energy.scale else 0.0,
        flags=tuple(result.flags), divergence=result.divergence, growth=result.growth, rim=rim,
        speed_hz=turn_of(scene.what), tracks=tuple(result.tracks), scheme=result.scheme, seconds=result.seconds,
        rotor=rotor_history(scene.what, result),
    )  # fmt: skip
