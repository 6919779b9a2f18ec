"""Read scene.toml with [chance]; returns the random model, or reports every problem of the file at once."""

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from casingfem.chance.fields import RandomSeries
from casingfem.chance.laws import Law
from casingfem.chance.tables import ChanceTable
from casingfem.modal.family.family import is_family, terms_of
from casingfem.modal.interface.kinds import Rim
from casingfem.structure.field.random import is_random
from casingfem.study.load import Study, load_shell_study
from casingfem.study.problems import StudyError
from contact.base.errors import InputError
from contact.io.brief import brief
from contact.io.infiles import pipes_read_once, read_bytes
from contact.io.outfiles import json_text
from contact.io.toml import entries
from contact.model.gaps.gap import RotatingRim
from contact.model.gaps.rub import Rub
from contact.model.law import Unilateral
from contact.prepared import Scene
from contact.scene.load import read_scene, scene_data, scene_of
from contact.scene.problems import Problems, SceneError, validated
from contact.scene.stability import load_interactions
from contact.version import versions

KINDS = ("rim", "rub")
ROOM = 3  # points of a mesh around for each wave of the highest harmonic


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ChanceScene:
    """The scene of a chance calculation: the random quantities and the model that they vary.

    Attributes
    ----------
    path, table : the scene file and its [chance]
    study : of the casing
    scene : with the casing and blade of its own bases
    speed_hz : speeds examined [turns/s], ascending
    laws, means : of the scene's random numbers, by name; the scene's own values
    source : names, hashes and versions; each draw depends on all of them except the hash of the file
    """

    path: Path
    table: ChanceTable
    study: Study
    scene: Scene
    speed_hz: Any
    laws: dict[str, Law]
    means: dict[str, float]
    source: dict[str, Any]

    __repr__ = brief

    @property
    def groups(self) -> int:
        """Number of random inputs: fields, one for each quantity, and numbers."""
        return len(RandomSeries.of(self.study.shell).groups) + len(self.laws)

    @property
    def rim(self) -> Rim:
        """The rim of the casing's study."""
        assert isinstance(self.study.interface, Rim)
        return self.study.interface


@pipes_read_once()
def load_chance(path: str | Path) -> ChanceScene:
    """Read a scene file of kind "rim" or "rub" with [chance], and the study that it names.

    Raises
    ------
    SceneError
        With all problems, one on each line: file: key: found, expected.
    """
    file = Path(path)
    data, text = scene_data(file)
    given = data.pop("chance", None)
    if entries(given) is not given:
        raise SceneError([f"{file}: chance: missing, expected [chance] with the study of the casing and a seed"])
    problems = Problems(file)
    table = attempted(problems, lambda: validated(ChanceTable, given, file, "chance"))
    head = attempted(problems, lambda: read_scene(file)[0])
    if head is not None and head.scene.kind not in KINDS:
        problems.append(f"{file}: scene.kind: found {head.scene.kind!r}, expected 'rim' or 'rub'")
        head = None
    study = None if table is None else attempted(problems, lambda: study_of(file, table.study))
    if table is not None and study is not None:
        problems.extend(faults_of_study(file, table, study))
    scene = None if head is None else attempted(problems, lambda: scene_of(data, file))
    if head is not None and table is not None:
        problems.extend(faults_of_laws(file, head, table))
    if scene is not None and isinstance(scene.what, Rub) and len(scene.what.tips) > 1:
        problems.append(f"{file}: blade: found {len(scene.what.tips)} contact points, expected one")
    if scene is not None and study is not None:
        problems.extend(faults_of_both(file, scene, study))
    problems.check()
    assert table is not None
    assert study is not None
    assert scene is not None
    assert head is not None
    speeds = load_interactions(file).speed_hz
    fixed = {key: part for key, part in given.items() if key not in ("draws", "runs", "turns", "worst", "importance")}
    contents = [read_bytes(file.parent / name) for name in head.files()]
    source = {
        "scene": file.name, "sha256": hashlib.sha256(text).hexdigest(), "study": study.source, "versions": versions(),
        "defines": hashlib.sha256(b"\0".join([json_text([data, fixed]).encode(), *contents])).hexdigest(),
    }  # fmt: skip
    return ChanceScene(
        path=file, table=table, study=study, scene=scene, speed_hz=np.asarray(speeds), laws=table.laws,
        means=means_of(head), source=source,
    )  # fmt: skip


def attempted(problems: Problems, made: Any) -> Any:
    """The value of `made`, or None if it raises an input error, which is collected."""
    try:
        return made()
    except (SceneError, StudyError) as error:
        problems.extend(error.problems)
    except (InputError, ValueError) as error:
        problems.append(f"{problems.file}: {error}")
    return None


def study_of(file: Path, name: str) -> Study:
    """The study of the casing."""
    path = file.parent / name
    if not path.is_file():
        raise SceneError([f"{file}: chance.study: {path}: found no such file, expected the study of the casing"])
    return load_shell_study(path)


def faults_of_study(file: Path, table: ChanceTable, study: Study) -> list[str]:
    """Reasons why no random casings can be drawn for the casing's study."""
    shell, key, found = study.shell, f"{file}: chance.study: {study.path.name}", []
    if study.file.reduce is None or not isinstance(study.interface, Rim):
        found.append(f"{key}: reduce: found no rim of a casing, expected [reduce] with interface and n_max")
    elif study.file.reduce.method != "free":
        found.append(f"{key}: reduce.method: found {study.file.reduce.method!r}, expected 'free'")
    if not any(is_random(field) for field in shell.defects.values()):
        found.append(f"{key}: imperfection: found no random one, expected [[imperfection]] with random and seed")
    elif not is_family(shell):
        expected = (
            "a casing of revolution, Fourier series around that are even along the axis, free, clamped or elastic"
        )
        found.append(f"{key}: found a casing that needs a full solution for each draw, expected {expected} edges")
    around = shell.mesh.order * shell.mesh.columns
    for number, field in enumerate(shell.defects.items(), 1):
        name, own = field
        p = max((int(term.p.max()) for term in terms_of(own) or ()), default=0)
        if p * ROOM > around:
            most = around // ROOM
            found.append(
                f"{key}: imperfection[{number}]: found harmonic {p} of the {name}, expected at most {most} on the "
                f"{around} points around of its mesh: reduce p_max, or increase mesh.around"
            )
    if not found and table.importance and RandomSeries.of(shell).dimension == 0:
        found.append(f"{key}: imperfection: found no random quantity, expected at least one")
    return found


def faults_of_laws(file: Path, head: Any, table: ChanceTable) -> list[str]:
    """Faults of random numbers that may take impossible values."""
    means, found = means_of(head), []
    for name, law in table.laws.items():
        if name not in means:
            found.append(f"{file}: chance.{name}: found it, but the scene has no [{name}] with one `by`")
            continue
        centre, lowest = law.centre(means[name]), law.lowest(means[name])
        words = f"a {law.law} law of mean {centre:g} and standard deviation {law.deviation:g}"
        if law.law == "lognormal":  # all its values are above 0
            if not centre > 0.0:
                found.append(f"{file}: chance.{name}: found {words}, expected a mean above 0")
        elif name == "blade" and not lowest > 0.0:
            found.append(f"{file}: chance.{name}: found {words}, which reaches {lowest:.3g}, expected ratios above 0")
        elif name != "blade" and lowest < 0.0 <= centre:
            expected = 'values >= 0: reduce the deviation, or use law = "lognormal"'
            found.append(f"{file}: chance.{name}: found {words}, which reaches {lowest:.3g}, expected {expected}")
    return found


def faults_of_both(file: Path, scene: Scene, study: Study) -> list[str]:
    """Differences between the scene's casing and that of the study."""
    what = scene.what
    if not isinstance(what, RotatingRim | Rub) or study.file.reduce is None or not isinstance(study.interface, Rim):
        return []
    casing, own = what.casing, study.interface
    found = []
    if casing.n_max != own.n_max or casing.rim_lines > 1:
        expected = f"n_max = {own.n_max} and one line: reduce the study of [chance]"
        found.append(
            f"{file}: casing.basis: found n_max = {casing.n_max}, {casing.rim_lines} lines, expected {expected}"
        )
    mu = (scene.law or Unilateral()).mu
    if not np.isfinite(mu):
        found.append(f"{file}: contact.friction: found {mu}, expected a finite number")
    return found


def means_of(head: Any) -> dict[str, float]:
    """The scene's own values of the random numbers, and the closing if the scene has one."""
    found = {"blade": 1.0, "clearance": float(head.contact.clearance), "friction": float(head.contact.friction)}
    closing = getattr(head, "closing", None)
    if closing is not None and np.ndim(closing.by) == 0:
        found["closing"] = float(closing.by)
    return found
