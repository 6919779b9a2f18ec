"""The worst casings as self-contained folders: a study of the casing, its basis, its blade, its scene."""

from collections.abc import Callable
from typing import Any

import numpy as np

from casingfem.chance.evaluate import Drawing
from casingfem.chance.result import Chance
from casingfem.chance.rubs import retuned
from casingfem.io.arrays import Array
from casingfem.study.updated import toml
from contact.io.outfiles import Content
from contact.model.gaps.rub import Rub
from contact.scene.load import scene_data

SMALL = 1e-12  # of a relative field: a harmonic that is none


def worst_files(found: Chance, own: Drawing, progress: Callable[[int], None]) -> dict[str, Content]:
    """Files of the worst casings by their names below the folder of results.

    Each folder has casing.toml (casingfem reduce solves it in full), the basis casing.npz from the family, the blade,
    and scene.toml at the speed of the largest growth.
    """
    files: dict[str, Content] = {}
    for rank, draw in enumerate(found.worst.tolist(), 1):
        folder = f"worst/{rank:02d}"
        u = own.point(draw)
        series = own.series(u)[0]
        (body,), blade = own.casings.bodies(series[None]), blade_of(own, float(own.inputs(u)["blade"][0]))
        files[f"{folder}/casing.toml"] = study_text(own, series, draw)
        files[f"{folder}/casing.npz"] = body.save
        files[f"{folder}/blade.npz"] = blade.save
        files[f"{folder}/scene.toml"] = scene_text(found, own, u, series, draw)
        progress(rank)
    return files


def blade_of(own: Drawing, ratio: float) -> Any:
    """The blade with its frequencies multiplied by a ratio."""
    what = own.perfect
    return retuned(what.blades[0] if isinstance(what, Rub) else what.blade, ratio)


def study_text(own: Drawing, series: Array, draw: int) -> str:
    """The casing's study with the drawn harmonics as imperfections."""
    given = own.given
    tables = given.study.file.model_dump(by_alias=True, exclude_none=True, exclude_unset=True)
    top = series.shape[1] // 2
    tables["imperfection"] = [
        {
            "of": name,
            "harmonics": [
                {"p": p, "cos": 2.0 * float(line[top + p].real), "sin": -2.0 * float(line[top + p].imag)}
                for p in range(1, top + 1)
                if abs(line[top + p]) > SMALL
            ],
        }
        for name, line in zip(own.casings.random.quantities, series, strict=True)
    ]
    tables.setdefault("reduce", {})["out"] = "casing.npz"
    tables.pop("update", None)
    mesh = given.study.shell.mesh
    rows, around = (part if isinstance(part, int) else list(part) for part in (mesh.rows, mesh.around))
    tables["mesh"] = {"order": mesh.order, "rows": rows, "around": around}
    return f"# Draw {draw} of {given.path.name}, seed {given.table.seed}\n{toml(tables)}"


def scene_text(found: Chance, own: Drawing, u: Any, series: Array, draw: int) -> str:
    """The scene with the drawn numbers, at the speed of the largest growth."""
    given = own.given
    data, _ = scene_data(given.path)
    for name in ("chance", "sweep"):
        data.pop(name, None)
    numbers = {name: float(value[0]) for name, value in own.inputs(u).items()}
    speed = float(np.asarray(given.speed_hz)[found.drawn.lot["growth"][draw].argmax()])
    data["casing"] = {key: value for key, value in data["casing"].items() if key not in ("scatter", "seed")}
    data["casing"]["basis"] = "casing.npz"
    blades = data["blade"] if isinstance(data["blade"], list) else [data["blade"]]
    blades[0].pop("freq_hz", None)
    blades[0]["basis"] = "blade.npz"
    data["contact"] |= {"clearance": numbers["clearance"], "friction": numbers["friction"]}
    d = own.casings.deviation(series[None])[0]
    what = own.perfect
    fixed = what.profile.terms if isinstance(what, Rub) else what.terms
    sums: dict[int, complex] = {p: complex(value) for p, value in enumerate(d.tolist()) if abs(value) > 0.0}
    for p, cos, sin in fixed:
        sums[p] = sums.get(p, 0.0) + complex(cos, -sin)
    data["contact"].pop("random_out_of_roundness", None)
    data["contact"].pop("draw", None)
    data["contact"]["out_of_roundness"] = [
        {"p": p, "cos": value.real, "sin": -value.imag} for p, value in sorted(sums.items())
    ]
    data["speed"] = {key: value for key, value in data["speed"].items() if key not in ("time", "scan")}
    data["speed"]["hz"] = speed
    if "closing" in numbers:
        data["closing"]["by"] = numbers["closing"]
    head = f"# Draw {draw} of {given.path.name}, seed {given.table.seed}: casing {found.worst.tolist().index(draw) + 1}"
    return f"{head} of the worst\n{toml(data)}"
