"""Plausibility checks of a study's numbers: checks that keys declare, and checks that need more than one key."""

import math
from collections.abc import Iterator

import numpy as np
from pydantic import BaseModel

from casingfem.errors import with_code
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.material import Material
from casingfem.structure.shell.plausible import sampled
from casingfem.structure.shell.shell import Shell
from casingfem.study.problems import Problems
from casingfem.study.tables.tasks import ParameterTable, StudyFile
from contact.io.plausible import CHECKS, Check, Implausible, declared, implausible, numbers, refused, speed_fault
from contact.io.tables import value_of

ADDRESSES = {"E": "E", "rho": "rho", "nu": "nu", "thickness": "thickness"}  # last part of a parameter's name -> check
UNITLESS = ("E", "rho", "sound", "size", "thickness")  # not asked of a study with E = rho = 1
STOUT = 0.5  # wall over the longest length of the chart


def add_implausible(tables: StudyFile, structure: Shell | Solid | MeshShell | None, problems: Problems) -> None:
    """Report all impossible numbers that the file does not allow."""
    found = [*implausible(tables), *of_chart(tables), *of_parameters(tables), *of_structure(structure)]
    if tables.rotation is not None and structure is not None and structure.rotation is not None:
        if text := speed_fault(tables.rotation.speed_hz, reach(structure)):
            found.append(Implausible("rotation.speed_hz", "speed", text))
    allow = [*tables.checks.allow, *(UNITLESS if unitless(tables) else ())]
    problems.extend(with_code("study-implausible", f"{problems.file}: {line}") for line in refused(found, allow))


def unitless(tables: StudyFile) -> bool:
    """Whether a study is in reduced units: E = rho = 1."""
    if tables.material is None:
        return False
    material = value_of(tables.material, Material)
    return material.E == material.rho == 1.0


def of_chart(tables: StudyFile) -> Iterator[Implausible]:
    """Report a chart whose lengths are all too short, or a wall as thick as the structure is long."""
    if tables.chart is None:
        return
    size = CHECKS["size"]
    lengths = {f"chart.{key}": abs(x) for key, x in of_check(tables.chart, size)}
    if not lengths:
        return
    key, longest = max(lengths.items(), key=lambda item: item[1])
    if longest < size.lower and (text := size.fault(longest)):
        yield Implausible(key, "size", text)
    wall = None if tables.shell is None else tables.shell.thickness
    if wall is not None and wall > STOUT * longest and CHECKS["thickness"].fault(wall) is None:
        expected = f"at most {STOUT:g} of {key} = {longest:g} m"
        asked = f"; in mm? {wall:g} mm are {1e-3 * wall:.4g} m"
        yield Implausible("shell.thickness", "thickness", f"found {wall:g} m, expected {expected}{asked}")


def of_check(table: BaseModel, check: Check) -> Iterator[tuple[str, float]]:
    """The numbers of a table and of its nested tables whose keys declare a check of this name."""
    for field, info in type(table).model_fields.items():
        for part in value if isinstance(value := getattr(table, field), list) else ():
            if isinstance(part, BaseModel):
                yield from of_check(part, check)
        if any(mark.name == check.name for mark in declared(info)):
            for place, number in numbers(getattr(table, field), (field,)):
                yield str(place[0]), number


def of_parameters(tables: StudyFile) -> Iterator[Implausible]:
    """Parameters that start outside the plausible range, or whose bounds exclude all of it."""
    for k, parameter in enumerate(() if tables.update is None else tables.update.parameter, 1):
        if name := ADDRESSES.get(parameter.name.rpartition(".")[2]):
            yield from of_parameter(parameter, CHECKS[name], f"update.parameter[{k}]")


def of_parameter(parameter: ParameterTable, check: Check, key: str) -> Iterator[Implausible]:
    """Fault of one parameter's start value or bounds."""
    if parameter.start is not None and (text := check.fault(parameter.start)):
        yield Implausible(f"{key}.start", check.name, text)
    for bound, outside in (("lower", parameter.lower > check.upper), ("upper", parameter.upper < check.lower)):
        if outside and (text := check.fault(getattr(parameter, bound))):
            yield Implausible(f"{key}.{bound}", check.name, text)


def of_structure(structure: Shell | Solid | MeshShell | None) -> Iterator[Implausible]:
    """Report an imported mesh that is too large or too small."""
    if isinstance(structure, Solid | MeshShell) and (text := CHECKS["size"].fault(structure.mesh.size)):
        where = "solid.mesh" if isinstance(structure, Solid) else "shell.mesh"
        yield Implausible(where, "size", f'{text}; give scale or units of the file, as units = "mm-t-s"')


def reach(structure: Shell | Solid | MeshShell) -> float:
    """Largest distance of a structure's points from its axis of rotation [m]."""
    rotation = structure.rotation
    assert rotation is not None
    if isinstance(structure, Shell):
        (a0, a1), _ = np.real(np.array(structure.chart.bounds))
        points = sampled(structure, np.linspace(a0, a1, 9)).x.reshape(3, -1)
    else:
        points = structure.mesh.points.T
    axis = np.asarray(rotation.axis, dtype=float) / math.hypot(*rotation.axis)
    arm = points - np.asarray(rotation.centre, dtype=float)[:, None]
    return float(np.linalg.norm(arm - np.outer(axis, axis @ arm), axis=0).max())
