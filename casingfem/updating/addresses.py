"""The address of a number of a shell, such as `support.base.k_face.p8.cos`, and its interpretation.

material.E | nu | rho, shell.thickness, chart.<field>; radius.p8.cos, thickness.p2.sin, modulus.p4.cos, density.p2.sin
(relative harmonics); strip.2.thickness, strip.2.material.E (the second strip; one without a material of its own follows
the wall's); support.<edge>.k_face | k_r | k_theta | k_z | k_rot; support.<edge>.k_face.p4.cos (how that spring varies
along its edge, relative) and support.<edge>.around.p4.cos (all springs of the edge together). Bolts have
support.<edge>.k | k_rot | bolts.3.k, where k is the largest of a bolt's three stiffnesses and the others keep their
ratios; bolts.3.k alone where one edge has bolts. chart.chord.2, taper.along.1: a station of a law, the root's first.
mass.top.1.mass | angle: the first mass on an edge. Under a ring the same names are those of the ring's own support
(support.<edge>.support.k, as a study nests it, is support.<edge>.k); the ring itself has support.<edge>.section.width |
depth | diameter | area | I_r | I_z | J and, if it has one, support.<edge>.material.E | nu | rho.
"""

import re
from typing import Any, TypeVar

from casingfem.errors import InputError
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.support import ElasticEdge, outer_support
from casingfem.structure.field.field import Field
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.imported.assembly import MeshStructure
from casingfem.structure.shell.parts import DEFECTS, ShellParts
from casingfem.updating import numbers
from contact.io.names import hint

Structure = TypeVar("Structure", bound=ShellParts | MeshStructure)

HARMONIC = re.compile(r"p(\d+)$")


def address_of(shell: ShellParts | MeshStructure, name: str) -> numbers.Address:
    """Find the number that a name means on this shell or imported part.

    Raises
    ------
    InputError
        If the structure has no such number; the message names the most similar one.
    """
    try:
        return mesh_address(shell, name) if not isinstance(shell, ShellParts) else shell_address(shell, name)
    except InputError as error:
        raise InputError(f"{error}{hint(name, list(numbers.named_numbers(shell)))}") from None


def mesh_address(structure: MeshStructure, name: str) -> numbers.Plain:
    """The number that a name means on an imported part."""
    known = numbers.mesh_numbers(structure)
    if name not in known:
        raise InputError(f"{name!r}: found no such number of an imported part, expected one of {', '.join(known)}")
    return known[name]


def shell_address(shell: ShellParts, name: str) -> numbers.Address:
    """The number that a name means on a shell."""
    parts = name.split(".")
    if len(parts) < 2:
        raise InputError(f"{name!r}: found no name of a parameter, expected a path such as material.E")
    if parts[0] == "bolts":
        bolted = [edge for edge, support in shell.supports.items() if isinstance(outer_support(support), Bolts)]
        if len(bolted) != 1:
            found = f"found {len(bolted)} edges with bolts, expected one; name the edge as support.<edge>.{name}"
            raise InputError(f"{name!r}: {found}")
        parts = ["support", bolted[0], *parts]
    if parts[0] in DEFECTS and len(parts) == 3:
        require_series(name, shell.defects.get(parts[0]))
        return numbers.FieldHarmonic(parts[0], *harmonic_of(name, parts[1:]))
    if parts[0] == "support" and len(parts) > 2:
        if not isinstance(shell.supports.get(parts[1]), Bolts | Ring):
            return of_elastic_edge(shell, name, parts)
        on_ring = isinstance(shell.supports.get(parts[1]), Ring) and parts[2] == "support" and len(parts) > 3
        held = numbers.HeldNumber(parts[1], tuple(parts[3 if on_ring else 2 :]))
        try:
            held.value(shell)
        except KeyError as error:
            raise InputError(f"{name!r}: {error.args[0]}") from None
        return held
    if parts[0] == "strip":
        return of_strip(shell, name, parts)
    return of_mass(shell, name, parts) if parts[0] == "mass" else of_part(shell, name, parts)


def of_elastic_edge(shell: ShellParts, name: str, parts: list[str]) -> numbers.Plain | numbers.SpringHarmonic:
    """support.<edge>.<spring> and support.<edge>.<spring or around>.p4.cos."""
    support = shell.supports.get(parts[1])
    if not isinstance(support, ElasticEdge):
        found = "no support" if support is None else type(support).__name__
        raise InputError(f"{name!r}: found {found} on edge {parts[1]!r}, expected an elastic edge, bolts or a ring")
    known = ElasticEdge.stiffness_names + ((numbers.SHARED,) if len(parts) == 5 else ())
    if len(parts) not in (3, 5) or parts[2] not in known:
        raise InputError(f"{name!r}: found no such number of an elastic edge, expected one of {', '.join(known)}")
    if len(parts) == 3:
        return numbers.Plain(("supports", parts[1], parts[2]))
    found_at = numbers.SpringHarmonic(parts[1], parts[2], *harmonic_of(name, parts[3:]))
    for one in found_at.each:
        require_series(name, support.pattern(one.spring))
    values = found_at.values(shell)
    if any(value != values[0] for value in values):
        found = "found different values for the springs of this edge, expected one value for all"
        raise InputError(f"{name!r}: {found}; name one spring, such as {ElasticEdge.stiffness_names[0]}")
    return found_at


def of_strip(shell: ShellParts, name: str, parts: list[str]) -> numbers.Plain:
    """strip.<number>.thickness and strip.<number>.material.<E, nu or rho>."""
    place = place_in(parts[1], len(shell.strips))
    if not place:
        raise InputError(f"{name!r}: found strip {parts[1]!r}, expected a number from 1 to {len(shell.strips)}")
    if parts[2:] != ["thickness"]:
        if len(parts) != 4 or parts[2] != "material" or parts[3] not in numbers.CONSTANTS:
            numbered = "thickness, material.E, material.nu, material.rho"
            raise InputError(f"{name!r}: found no such number of a strip, expected one of {numbered}")
        if shell.strips[place - 1].material is None:
            found = f"found strip {place} without a material of its own; vary material.{parts[3]}, that of the shell"
            raise InputError(f"{name!r}: {found}")
    return numbers.Plain(("strips", place - 1, *parts[2:]))


def of_mass(shell: ShellParts, name: str, parts: list[str]) -> numbers.Plain:
    """mass.<edge>.<number>.mass and .angle."""
    known = shell.masses.get(parts[1], ()) if len(parts) == 4 and parts[3] in ("mass", "angle") else ()
    place = place_in(parts[2], len(known)) if known else 0
    if not place:
        has = ", ".join(f"{len(masses)} on {edge!r}" for edge, masses in shell.masses.items()) or "none"
        expected = f"expected mass.<edge>.<number>.mass or .angle, of the masses of this shell: {has}"
        raise InputError(f"{name!r}: found no such mass, {expected}")
    return numbers.Plain(("masses", parts[1], place - 1, parts[3]))


def of_part(shell: ShellParts, name: str, parts: list[str]) -> numbers.Plain:
    """shell.thickness, and the numbers of material, chart and taper, with the number of a station for laws."""
    parts_of = {"material": shell.material, "chart": shell.chart, "taper": shell.taper, "shell": shell}
    owners = {word: owner for word, owner in parts_of.items() if owner is not None}
    owner = owners.get(parts[0])
    if owner is None or len(parts) not in (2, 3):
        starts = ", ".join([*owners, *DEFECTS])
        raise InputError(
            f"{name!r}: found no such parameter, expected a name that starts with {starts}, strip, mass or support"
        )
    known = ["thickness"] if owner is shell else numbers.numbers_of(owner)
    if parts[1] not in known:
        raise InputError(f"{name!r}: found no {parts[1]!r} in {parts[0]}, expected one of {', '.join(known) or 'none'}")
    path = ("thickness",) if owner is shell else (parts[0], parts[1])
    law = getattr(owner, parts[1])
    count = len(law) if isinstance(law, tuple) else 0
    if count == 0 and not parts[2:]:
        return numbers.Plain(path)
    place = place_in(parts[2], count) if parts[2:] else 0
    if not place:
        wanted = f"the number of a station after it, 1 to {count}" if count else "nothing after it, as it is one number"
        raise InputError(f"{name!r}: expected {wanted}")
    return numbers.Plain((*path, place - 1))


def place_in(word: str, count: int) -> int:
    """An index counted from 1 to `count`; 0 if the word is no such index."""
    return int(word) if word.isdecimal() and 1 <= int(word) <= count else 0


def harmonic_of(name: str, parts: list[str]) -> tuple[int, str]:
    """Order and part of p8.cos."""
    match = HARMONIC.match(parts[0]) if len(parts) == 2 else None
    if match is None or parts[1] not in ("cos", "sin"):
        raise InputError(f"{name!r}: expected a harmonic such as p8.cos, found {'.'.join(parts)!r}")
    return int(match[1]), parts[1]


def require_series(name: str, field: Field | None) -> None:
    """Refuse a field that has no harmonics."""
    if not isinstance(numbers.series(field), FourierField):
        found = "no field" if field is None else f"a {type(field).__name__}"
        raise InputError(f"{name!r}: found {found}, expected a Fourier series (FourierField) with harmonics to vary")


def get_value(shell: ShellParts | MeshStructure, name: str) -> Any:
    """Current value of a named number of a shell or an imported part.

    Raises
    ------
    InputError
        If the structure has no such number.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=1.0, width=0.5), thickness=0.01,
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"root": cf.Clamped()})
    >>> cf.updating.get_value(plate, "shell.thickness")
    0.01
    """
    return address_of(shell, name).value(shell)


def with_value(shell: Structure, name: str, value: Any) -> Structure:
    """The same shell or imported part with one named number replaced; its mesh is kept.

    Raises
    ------
    InputError
        If the structure has no such number.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=1.0, width=0.5), thickness=0.01,
    ...                  material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"root": cf.Clamped()})
    >>> cf.updating.with_value(plate, "material.E", 200e9).material.E
    200000000000.0
    """
    try:
        new: Structure = address_of(shell, name).renewed(shell, value)
    except KeyError as error:
        raise InputError(f"{name!r}: {error.args[0]}") from None
    return new
