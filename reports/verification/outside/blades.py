"""Blades: NASA rotors 37 and 67 and a twisted blade in CalculiX, a measured fan blade.

The fan blade is Olson and Lindberg's (AFFDL-TR-68-150, 1968), a cantilevered panel: data/studies/olson_lindberg.toml
has its nominal modulus and thickness.
"""

import warnings

import numpy as np
import pandas as pd

from casingfem.modal.modes import modes
from casingfem.study import load_study
from reports.tables import DATA, Row
from reports.verification.modes import calculix, nasa_rotors
from reports.verification.outside.columns import row

FAN = DATA / "experiments" / "olson_lindberg.csv"
TWISTED = DATA / "reference" / "imported_blade_calculix.csv"
SAME = 0.01  # %, of another program on the same mesh
OPEN = "the spread of the test (two quotations differ by 1 Hz), thickness and clamp as built"
REASON = "nominal thickness and modulus: a thickness fitted to all seven leaves 1.9 % RMS of the 2.6 %"


def fan() -> list[Row]:
    """Seven measured frequencies of the fan blade."""
    measured = pd.read_csv(FAN, comment="#")["freq_hz"]
    found = modes(load_study(DATA / "studies" / "olson_lindberg.toml").structure, len(measured)).freq
    return [
        row("measured", f"fan blade, mode {k}", "Olson and Lindberg 1968", value, ours, 1.2,
            gap=5.0, reason=REASON, open_=OPEN)
        for k, (value, ours) in enumerate(zip(measured, found, strict=True), 1)
    ]  # fmt: skip


def rotors(quick: bool) -> list[Row]:
    """The worst of six frequencies of each rotor, at rest and at speed, on one mesh."""
    cells, allowed = (nasa_rotors.COARSE, 0.02) if quick else (nasa_rotors.CELLS, SAME)
    grid = " x ".join(map(str, cells))
    table = pd.read_csv(nasa_rotors.TABLE, comment="#")
    result = []
    for (name, rpm), part in table[table["cells"] == grid].groupby(["rotor", "rpm"]):
        exact = part["freq_hz"].to_numpy()
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message=".*mesh-(thin-curved|coarse|distorted-cell)")
            found = modes(nasa_rotors.blade(str(name), cells, float(rpm)), len(exact)).freq
        k = int(np.abs(found / exact - 1.0).argmax())
        case = f"NASA {name} at {rpm:.0f} rpm, {grid} bricks, worst of {len(exact)}: mode {k + 1}"
        result.append(row("program", case, "CalculiX 2.20", exact[k], found[k], allowed))
    return result


def twisted(quick: bool) -> list[Row]:
    """The worst of eight frequencies of a twisted blade, at rest and at speed."""
    table = pd.read_csv(TWISTED, comment="#")
    result = []
    for kind in list(calculix.MESHES)[: 1 if quick else None]:
        for rpm in calculix.RPM:
            part = table[(table["cells"] == kind) & (table["quantity"] == f"freq_hz at {rpm} rpm")]
            exact = part["value"].to_numpy()
            found = modes(calculix.blade(kind, rpm), len(exact)).freq
            k = int(np.abs(found / exact - 1.0).argmax())
            case = f"twisted blade of {kind}, {rpm} rpm, worst of {len(exact)}: mode {k + 1}"
            result.append(row("program", case, "CalculiX", exact[k], found[k], SAME))
    return result


def rows(quick: bool) -> list[Row]:
    """All rows of blades."""
    return [*fan(), *rotors(quick), *twisted(quick)]
