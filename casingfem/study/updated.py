"""An updated study, written as a study again; and the perfect structure behind an imperfect one."""

import json
import math
import os
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import Any

from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.support import ElasticEdge, Support
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.shell.shell import Shell
from casingfem.study.imported import MeshStudy
from casingfem.study.load import Study
from casingfem.updating.addresses import address_of, get_value
from casingfem.updating.numbers import FieldHarmonic, HeldNumber, Plain, SpringHarmonic

ANGLES = ("twist", "camber")  # of a chart, in radians; a study has them in degrees
TABLES = {"thickness": ("shell", "thickness"), "strips": ("strip",), "supports": ("support",)}  # where a file has them


def perfect(shell: Shell) -> Shell:
    """The same shell without imperfections: no fields, uniform springs along edges; the mesh is kept.

    >>> from casingfem import Frustum, FourierField, Material
    >>> casing = Shell(chart=Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3,
    ...                material=Material(E=210e9, nu=0.3, rho=7800.0), radius_defect=FourierField.of({8: 0.004}))
    >>> perfect(casing).axisymmetric
    True
    """
    supports = {edge: even(support) for edge, support in shell.supports.items()}
    none: dict[str, Any] = {f"{quantity}_defect": None for quantity in shell.defects}
    return replace(shell, supports=supports, **none)


def even(support: Support) -> Support:
    """The same support, uniform along its edge, with equally tight bolts."""
    if isinstance(support, ElasticEdge):
        return replace(support, around=None)
    if isinstance(support, Ring) and support.support is not None:
        return replace(support, support=even(support.support))  # type: ignore[arg-type]
    return replace(support, loose={}) if isinstance(support, Bolts) else support


def updated_toml(study: Study | MeshStudy, values: Mapping[str, float], folder: Path) -> str:
    """Write a study with other values of its parameters as the text of a study.toml.

    A harmonic from a survey is changed by a separate [[imperfection]] that is added to it.

    Parameters
    ----------
    study
        The study as it was read.
    values
        New values by address, such as "material.E" (`cf.updating.parameters` lists the addresses), in SI units.
    folder
        Folder of the new file: paths to surveys, tables and meshes are relative to it.

    Raises
    ------
    InputError
        The structure has no number at an address.

    Examples
    --------
    >>> import casingfem as cf
    >>> study = cf.load_study("data/studies/frustum.toml")
    >>> text = updated_toml(study, {"shell.thickness": 2.9e-3}, study.path.parent)
    >>> [line for line in text.splitlines() if "thickness" in line]
    ['thickness = 0.0029']
    """
    tables = study.file.model_dump(by_alias=True, exclude_none=True, exclude_unset=True)
    for name, value in values.items():
        put(tables, study.structure, name, value)
    parts = [tables.get(name, {}) for name in ("update", "solid", "shell")]
    for owner in [*tables.get("imperfection", []), *parts]:
        for key in owner.keys() & {"survey", "table", "shapes", "mesh"}:
            owner[key] = Path(os.path.relpath(study.path.parent / owner[key], folder)).as_posix()
    for entry in tables.get("update", {}).get("parameter", []):
        entry.pop("start", None)
    version, digest = study.source["versions"]["casingfem"], study.source["sha256"]
    head = f"# {study.path.name} (sha256 {digest}) as updated by casingfem {version}\n"
    return head + toml(tables)


def put(tables: dict[str, Any], shell: Shell | Solid | MeshShell, name: str, value: float) -> None:
    """Set one parameter in the tables of a study file."""
    match address_of(shell, name):
        case FieldHarmonic(of, p, part):
            add_harmonic(tables.setdefault("imperfection", []), of, p, part, value - float(get_value(shell, name)))
        case SpringHarmonic(edge, spring, p, part):
            for waves in pattern_lists(tables["support"][edge], spring):
                entry_of(waves, "p", p)[part] = value
        case HeldNumber(edge, ("bolts", bolt, _)):
            loosen(holding(tables, edge), int(bolt), value)
        case HeldNumber(edge, ("k",)):
            tighten(holding(tables, edge), value)
        case HeldNumber(edge, ("section", key)):
            tables["support"][edge][key] = value
        case HeldNumber(edge, ("material", key)):
            tables["support"][edge]["material"][key] = value
        case HeldNumber(edge, path):
            holding(tables, edge)[path[-1]] = value
        case Plain(("masses", edge, number, key)):
            masses = [entry for entry in tables["mass"] if entry["edge"] == edge]
            masses[int(number)].update({"angle_deg": math.degrees(value)} if key == "angle" else {key: value})
        case Plain(("chart", str(key), *station)) if key in ANGLES:
            put_at(tables, ("chart", f"{key}_deg", *station), math.degrees(value))
        case Plain(("materials" | "thicknesses", *_)):  # of groups of an imported part: the address is the place
            put_at(tables, name.split("."), value)
        case Plain((first, *rest)):
            put_at(tables, (*TABLES.get(str(first), (first,)), *rest), value)


def put_at(tables: Any, path: Sequence[str | int], value: float) -> None:
    """Set the value at a path of keys and indices."""
    *way, last = path
    for step in way:
        tables = tables[step]
    tables[last] = value


def holding(tables: dict[str, Any], edge: str) -> dict[str, Any]:
    """The table of an edge's support from outside: for a ring, of the ring's own support."""
    support: dict[str, Any] = tables["support"][edge]
    return support["support"] if support["kind"] == "ring" else support


def stiffnesses(support: dict[str, Any]) -> dict[str, float]:
    """Stiffnesses k of a [support] table of bolts: one number, or up to three."""
    return {name: support[name] for name in ("k", "k_r", "k_theta", "k_z") if name in support}


def loosen(support: dict[str, Any], bolt: int, value: float) -> None:
    """Give one bolt its own stiffness, as a factor of the tight ones'."""
    entry_of(support.setdefault("loose", []), "bolt", bolt)["factor"] = value / max(stiffnesses(support).values())


def tighten(support: dict[str, Any], value: float) -> None:
    """Give the tight bolts a new largest stiffness; loose ones keep theirs."""
    part = value / max(stiffnesses(support).values())
    support |= {name: k * part for name, k in stiffnesses(support).items()}
    for entry in support.get("loose", []):
        entry["factor"] /= part


def pattern_lists(support: dict[str, Any], spring: str) -> list[list[dict[str, Any]]]:
    """The lists of harmonics that a pattern's parameter changes: of one spring, or of "around" for all."""
    around = support.setdefault("around", [])
    if isinstance(around, list):
        if spring == "around" or not any(support.get(k) for k in ElasticEdge.stiffness_names if k != spring):
            return [around]
        around = {k: deepcopy(around) for k in ElasticEdge.stiffness_names if support.get(k)}
        support["around"] = around
    springs = [k for k in ElasticEdge.stiffness_names if support.get(k)] if spring == "around" else [spring]
    return [around.setdefault(k, []) for k in springs]


def add_harmonic(imperfections: list[dict[str, Any]], of: str, p: int, part: str, change: float) -> None:
    """Add to a harmonic of the study, or to a new imperfection if it has none."""
    same = [entry for entry in imperfections if entry["of"] == of and "harmonics" in entry]
    owner = next((entry for entry in same if any(h["p"] == p for h in entry["harmonics"])), None)
    owner = owner or (same[-1] if same else None)
    if owner is None:
        owner = {"of": of, "harmonics": []}
        imperfections.append(owner)
    wave = entry_of(owner["harmonics"], "p", p)
    wave[part] = wave.get(part, 0.0) + change


def entry_of(entries: list[dict[str, Any]], key: str, value: int) -> dict[str, Any]:
    """The entry with this value of a key (a bolt or harmonic p), created if needed."""
    found = next((entry for entry in entries if entry[key] == value), None)
    if found is None:
        found = {key: value}
        entries.append(found)
    return found


def toml(tables: Mapping[str, Any], path: str = "") -> str:
    """Nested tables as TOML; lists of tables of plain numbers stay inline.

    >>> print(toml({"modes": {"count": 4}, "imperfection": [{"of": "radius", "harmonics": [{"p": 8}]}]}))
    [modes]
    count = 4
    <BLANKLINE>
    [[imperfection]]
    of = "radius"
    harmonics = [{p = 8}]
    <BLANKLINE>
    """
    plain = {key: value for key, value in tables.items() if not nested(value)}
    lines = [f"{bare(key)} = {literal(value)}" for key, value in plain.items()]
    blocks = ["\n".join(lines) + "\n"] if lines else []
    for key, value in tables.items():
        name = f"{path}{bare(key)}"
        if isinstance(value, Mapping):
            own = any(not nested(entry) for entry in value.values()) or not value
            blocks.append((f"[{name}]\n" if own else "") + toml(value, f"{name}."))
        elif nested(value):
            blocks += [f"[[{name}]]\n" + toml(entry, f"{name}.") for entry in value]
    return "\n".join(blocks)


def nested(value: object) -> bool:
    """Whether a value is written as one or several tables."""
    if isinstance(value, list) and value and isinstance(value[0], Mapping):
        return "p" not in value[0]
    return isinstance(value, Mapping)


def bare(key: str) -> str:
    """A key in TOML syntax."""
    plain = key.replace("-", "").replace("_", "")
    return key if plain.isascii() and plain.isalnum() else json.dumps(key)


def literal(value: object) -> str:
    """A plain value in TOML syntax."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{bare(key)} = {literal(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(literal, value)) + "]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str | bool) else repr(value)
