"""Scene files: scene.toml -> Scene, with every problem of the file reported at once."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from contact.base.errors import InputError
from contact.io.toml import entries, read_toml, written
from contact.model.bodies.beam import BeamInCircle, HingedBeam
from contact.model.bodies.body import Body, PointMass, Rod, Wall
from contact.model.bodies.chain import assemble
from contact.model.bodies.modal_body import ModalBody
from contact.model.bodies.ring_modes import ThinRing, ring_modes
from contact.model.gaps.cantilever import Cantilever
from contact.model.gaps.gap import RotatingRim
from contact.model.law import Coulomb, Unilateral
from contact.record.record import Record
from contact.run import Scene
from contact.scheme.modal.exact_modal import ExactModal
from contact.scheme.modal.rub_tracks import track_tips

if TYPE_CHECKING:
    from pydantic import BaseModel

    from contact.scene.disk import DiskFile
    from contact.scene.patch import PatchFile
    from contact.scene.record import RecordTable
    from contact.scene.rub import RubFile
    from contact.scene.tables import BeamFile, CantileverFile, File, PairFile, RimFile, RingTable, RodsFile

Built = TypeVar("Built")


class SceneError(InputError):
    """A scene file that cannot be run: `problems` lists them all, each with file and key."""

    def __init__(self, problems: list[str]) -> None:
        self.problems = problems
        super().__init__("\n".join(problems))


def load_scene(path: str | Path) -> Scene:
    """Read a scene file of any kind but "pair"; basis files are found relative to it.

    Raises SceneError, which lists every problem with file, key, what was found and what is expected.
    """
    file = Path(path)
    table, text = read_scene(file)
    return _built(table, file, text)


def scene_of(data: dict[str, Any], file: Path) -> Scene:
    """Build a scene from the tables of a file, changed or not; `file` says where bases are and stands in messages.

    Raises SceneError.
    """
    text = json.dumps(data, sort_keys=True).encode("utf-8")
    return _built(_validated(data, file), file, text)


def _built(table: File, file: Path, text: bytes) -> Scene:
    build: Callable[[Any, Path, bytes], Scene] = BUILDERS[table.scene.kind]
    return build(table, file, text)


def read_scene(file: Path) -> tuple[File, bytes]:
    """Read and validate a scene file of any kind, its [sweep] aside: its tables and its text. Raises SceneError."""
    data, text = scene_data(file)
    return _validated({key: part for key, part in data.items() if key != "sweep"}, file), text


def scene_data(file: Path) -> tuple[dict[str, Any], bytes]:
    """Read a scene file as it stands: its tables and its text. Raises SceneError."""
    try:
        text, data = read_toml(file)
        return data, text
    except OSError as error:
        raise SceneError([f"{file}: cannot be read ({error.strerror}), expected a scene.toml"]) from error
    except ValueError as error:
        raise SceneError([f"{file}: {error}"]) from error


def _validated(data: dict[str, Any], file: Path) -> File:
    from pydantic import ValidationError

    from contact.scene.tables import FILES

    kind = entries(data.get("scene")).get("kind")
    if str(kind) not in FILES:
        found = "nothing" if kind is None else repr(kind)
        raise SceneError([f"{file}: scene.kind: found {found}, expected one of {', '.join(map(repr, FILES))}"])
    model = FILES[str(kind)]
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise SceneError([problem_text(file, detail, data, model) for detail in error.errors()]) from error


def problem_text(file: Path, detail: Any, data: Any, model: type[BaseModel], table: str = "") -> str:
    """Write one pydantic error of a table's `data`, by its model, as file: key: found, expected."""
    from contact.io.tables import keys, models_at, resolved, unknown

    path = resolved(detail["loc"], detail["type"], data)
    models = models_at([model], path[:-1], data)
    meaning = next((keys(m)[str(path[-1])].description for m in models if path and str(path[-1]) in keys(m)), None)
    key = written((table, *path) if table else path)
    if detail["type"] == "extra_forbidden":
        return f"{file}: {key}: unknown key, {unknown(str(path[-1]), models)}"
    if detail["type"] == "missing":
        return f"{file}: {key}: missing{f', expected {meaning}' if meaning else ''}"
    message = detail["msg"].removeprefix("Value error, ")
    if isinstance(detail["input"], dict):
        return f"{file}: {key}: {message}"
    expected = message.removeprefix("Input should be ")
    return f"{file}: {key}: found {detail['input']!r}, expected {expected}{f' ({meaning})' if meaning else ''}"


def _rods(table: RodsFile, file: Path, text: bytes) -> Scene:
    bodies: list[Body] = [
        *(PointMass(**mass.model_dump()) for mass in table.mass),
        *(Rod(**rod.model_dump()) for rod in table.rod),
        *(Wall(**wall.model_dump()) for wall in table.wall),
    ]
    problems: list[str] = []
    _tried(lambda: assemble(bodies, gravity=table.scene.gravity), file, problems)
    method = _tried(table.scheme.method, file, problems, "scheme")
    if method is None or problems:
        raise SceneError(problems)
    law, scheme = method
    return Scene(
        what=bodies, law=law, scheme=scheme, t_end=table.scene.t_end, dt=table.scheme.dt,
        courant=table.scheme.courant, gravity=table.scene.gravity, record=_record(table.record, file),
        source=_source(file, text),
    )  # fmt: skip


def _record(table: RecordTable | None, file: Path) -> Record | None:
    if table is None:
        return None
    problems: list[str] = []
    record = _tried(lambda: table.record(file.parent), file, problems, "record")
    if record is None:
        raise SceneError(problems)
    return record


def _rim(table: RimFile, file: Path, text: bytes) -> Scene:
    from contact.scene.coating import contact_law

    problems: list[str] = []
    paths = {"casing.basis": file.parent / table.casing.basis, "blade.basis": file.parent / table.blade.basis}
    casing = _tried(partial(_casing, table, paths["casing.basis"]), file, problems, "casing.basis")
    blade = _tried(partial(_blade, table, paths["blade.basis"]), file, problems, "blade.basis")
    if casing is None or blade is None:
        raise SceneError(problems)
    contact = table.contact
    rim = _tried(
        lambda: RotatingRim(
            casing, blade, clearance=contact.clearance, speed_hz=table.speed.hz,
            lean_deg=table.blade.lean_deg,
            out_of_roundness=contact.terms(casing),
            angle_deg=contact.angle_deg,
        ),
        file, problems,
    )  # fmt: skip
    law = _tried(lambda: contact_law(table.coating, contact.friction), file, problems, "coating")
    if rim is None or law is None:
        raise SceneError(problems)
    return Scene(
        what=rim, law=law,
        scheme=ExactModal(law=table.scheme.law), t_end=table.scene.t_end, dt=table.scheme.dt,
        record=_record(table.record, file),
        source=_source(file, text, *(path.read_bytes() for path in paths.values())), on_limit=table.scene.on_limit,
    )  # fmt: skip


def _casing(table: RimFile, path: Path) -> ModalBody:
    body, scatter = _basis(path), table.casing.scatter
    return body.detuned(scatter, seed=table.casing.seed) if scatter > 0.0 else body


def _blade(table: RimFile, path: Path) -> ModalBody:
    body, freq_hz = _basis(path), table.blade.freq_hz
    return body if freq_hz is None else body.retuned(freq_hz)


def _basis(path: Path) -> ModalBody:
    """A basis file, read once as long as it stays the same."""
    try:
        stat = path.stat()
    except (OSError, ValueError):  # the latter of a name with a zero byte
        return ModalBody.load(path)  # which says what is wrong
    return _basis_as(path, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=32)
def _basis_as(path: Path, _changed: int, _size: int) -> ModalBody:
    return ModalBody.load(path)


def _beam(table: BeamFile, file: Path, text: bytes) -> Scene:
    problems: list[str] = []
    beam = _tried(lambda: HingedBeam(**table.beam.model_dump()), file, problems, "beam")
    ring = None if table.ring is None else _tried(partial(_ring, table.ring, table, file), file, problems, "ring")
    method = _tried(table.scheme.method, file, problems, "scheme")
    if beam is None or method is None or problems:
        raise SceneError(problems)
    circle = table.circle
    what = _tried(lambda: BeamInCircle(beam, radius=circle.radius, offset=circle.offset, ring=ring), file, problems)
    if what is None:
        raise SceneError(problems)
    law, scheme = method
    basis = [] if table.ring is None or table.ring.basis is None else [(file.parent / table.ring.basis).read_bytes()]
    return Scene(
        what=what, law=law, scheme=scheme, t_end=table.scene.t_end, dt=table.scheme.dt, courant=table.scheme.courant,
        record=_record(table.record, file), source=_source(file, text, *basis),
    )  # fmt: skip


def _cantilever(table: CantileverFile, file: Path, text: bytes) -> Scene:
    problems: list[str] = []
    beam, scheme = table.beam, table.scheme
    gap = _tried(
        lambda: Cantilever(**beam.model_dump(exclude={"load", "velocity"})).before_stop(
            clearance=table.stop.clearance, load=beam.load, velocity=beam.velocity, modes=scheme.modes or 20
        ),
        file, problems,
    )  # fmt: skip
    method = _tried(scheme.method, file, problems, "scheme")
    if gap is None or method is None:
        raise SceneError(problems)
    return Scene(
        what=gap, law=method[0], scheme=method[1], t_end=table.scene.t_end, dt=scheme.dt, courant=scheme.courant,
        record=_record(table.record, file), source=_source(file, text),
    )  # fmt: skip


def _patch(table: PatchFile, file: Path, text: bytes) -> Scene:
    problems: list[str] = []
    what = _tried(lambda: table.patch(file.parent), file, problems, "body")
    if what is None:
        raise SceneError(problems)
    basis = [] if table.body.basis is None else [(file.parent / table.body.basis).read_bytes()]
    mu = table.ground.friction
    return Scene(
        what=what, law=Coulomb(mu=mu) if mu else Unilateral(), scheme=ExactModal(), t_end=table.scene.t_end,
        dt=table.scheme.dt, record=_record(table.record, file), source=_source(file, text, *basis),
        on_limit=table.scene.on_limit,
    )  # fmt: skip


def _rub(table: RubFile | DiskFile, file: Path, text: bytes) -> Scene:
    from contact.scene.coating import contact_law

    problems: list[str] = []
    what = _tried(lambda: table.rub(file.parent), file, problems)
    law = _tried(lambda: contact_law(table.coating, table.contact.friction), file, problems, "coating")
    if what is None or law is None:
        raise SceneError(problems)
    if law.coating is not None:
        length = law.coating.tip
        if _tried(lambda: track_tips(what, length), file, problems) is None:
            raise SceneError(problems)
    return Scene(
        what=what, law=law, scheme=ExactModal(law=table.scheme.law),
        t_end=table.scene.t_end, dt=table.scheme.dt, record=_record(table.record, file),
        source=_source(file, text, *(path.read_bytes() for path in table.files(file.parent))),
        on_limit=table.scene.on_limit,
    )  # fmt: skip


def _no_pair(table: PairFile, file: Path, text: bytes) -> Scene:
    raise SceneError([f"{file}: scene.kind: found 'pair', which casingfem stability takes"])


BUILDERS: dict[str, Callable[..., Scene]] = {
    "rods": _rods, "rim": _rim, "rub": _rub, "disk": _rub, "beam": _beam, "cantilever": _cantilever, "patch": _patch,
    "pair": _no_pair,
}  # fmt: skip


def _ring(ring: RingTable, table: BeamFile, file: Path) -> ModalBody:
    """The ring of a [ring] table: from its file, or by its section on the circle's radius."""
    if ring.basis is not None:
        return ModalBody.load(file.parent / ring.basis)
    section = ring.model_dump(exclude={"basis", "n_max"})
    return ring_modes(ThinRing(radius=table.circle.radius, **section), ring.n_max)


def _tried(build: Callable[[], Built], file: Path, problems: list[str], key: str = "") -> Built | None:
    """Build a part; on bad input add the problem, with file and key, and return None."""
    try:
        return build()
    except InputError as error:
        problems.append(f"{file}: {key}: {error}" if key else f"{file}: {error}")
        return None


def _source(file: Path, *contents: bytes) -> dict[str, str]:
    """Name and hash of the input, for the result."""
    return {"scene": file.name, "sha256": hashlib.sha256(b"\0".join(contents)).hexdigest()}
