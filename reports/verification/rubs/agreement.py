"""Agreement of the interaction table, poles and runs, for three casings and blades at sixty speeds each.

`python -m reports.verification.rubs.agreement [--quick] [--out DIR]`. The bands of `ct.stability.peaks` (from its map
of 301 speeds), eigenvalues of the full state matrix, and runs in time whose contact is pressed closed. One row a pair:
number of speeds at which all three have the same sign, and the error of the growth of runs if |growth| > 0.5 1/s. A run
of two seconds cannot show the sign of a growth below 0.05 1/s: these speeds are counted separately.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.plot.interaction import figure_stability
from casingfem.plot.style import png
from contact.io.outfiles import write_atomic
from contact.model.gaps.permanent import HandPair
from contact.stability.closed_contact import poles
from contact.stability.peaks import Peaks
from contact.stability.split_casing import mean_contact
from reports.tables import Row, command_line, show, write
from reports.verification.interaction import digging
from reports.verification.rubs.bases import casing, make_casing, steel_strip
from reports.verification.rubs.closed_run import confirming_run

SPEEDS, SEEN, SMALL = 60, 0.5, 0.05  # speeds a pair; 1/s that a run shows to 5 %; 1/s of no sign
Pair = tuple[ct.RotatingRim | HandPair, float, tuple[float, float]]


def pairs(folder: Path) -> dict[str, Pair]:
    """Rim and blade, friction, and the range of speeds [turns/s]."""
    frustum = make_casing(folder, 20, 1)
    thick, thin = (blade(folder, thickness) for thickness in (5.4615e-3, 4.0e-3))
    imperfect = replace(casing(), radius_defect=cf.FourierField.of({16: 2e-4}))
    split = ct.ModalBody.load(
        cf.reduce(imperfect, cf.Rim("top", n_max=20), modes=40, zeta=0.002).save(folder / "split.npz")
    )
    return {
        "hand pair, digging": (digging(0.3, 10.0, zeta=4e-4), 0.0, (22.0, 23.5)),
        "frustum and strip, 384 Hz, digging": (rim(frustum, thick, 10.0), 0.3, (1.0, 12.0)),
        "imperfect frustum and thin strip, trailing": (rim(split, thin, -10.0), 0.2, (30.0, 90.0)),
    }


def blade(folder: Path, thickness: float) -> ct.ModalBody:
    """The strip of the rig with its two lowest modes."""
    basis = cf.reduce(steel_strip(thickness), cf.Tip(), modes=4, zeta=0.002)
    body = ct.ModalBody.load(basis.save(folder / f"strip_{1e6 * thickness:.0f}.npz"))
    return body.truncated(float(np.sort(body.omega)[1]) * 1.01)


def rim(body: ct.ModalBody, tip: ct.ModalBody, lean_deg: float) -> ct.RotatingRim:
    """Pressed together by 10 um."""
    return ct.RotatingRim(body, tip, clearance=-1e-5, speed_hz=1.0, lean_deg=lean_deg)


def compared(
    what: ct.RotatingRim | HandPair,
    mu: float,
    found: Peaks,
    speeds: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> list[Row]:
    """Each speed by its band, by eigenvalues, and by a run."""
    contact = what.contact() if isinstance(what, HandPair) else mean_contact(what, mu=mu)[0]
    by_poles = poles(contact, speeds).real.max(axis=1)
    rows: list[Row] = []
    for hz, rate in zip(speeds, by_poles, strict=True):
        inside = any(low <= hz <= high for low, high in found.map.bands_hz)
        run = confirming_run(what, float(hz), mu=mu)
        told = min(abs(float(rate)), abs(run.run)) > SMALL
        rows.append({
            "speed Hz": float(hz), "in a band": inside, "pole 1/s": float(rate), "run 1/s": run.run,
            "off %": 100.0 * (run.run / float(rate) - 1.0), "told": told,
            "agree": inside == (rate > 0.0) and (not told or (run.run > 0.0) == inside),
        })  # fmt: skip
    return rows


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print one row a pair, write all speeds and a picture of each pair."""
    folder = out / "agreement"
    folder.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    for number, (name, (what, mu, (low, high))) in enumerate(pairs(folder).items(), 1):
        found = ct.stability.peaks(what, np.linspace(low, high, 61 if quick else 301), mu=mu)
        speeds = np.linspace(low, high, (6 if quick else SPEEDS) + 2)[1:-1]
        every = compared(what, mu, found, speeds)
        write(folder / f"speeds_{number}.csv", every)
        shown = [abs(float(str(row["off %"]))) for row in every if abs(float(str(row["pole 1/s"]))) > SEEN]
        agree = sum(bool(row["agree"]) for row in every)
        worst = confirming_run(what, found.map.peak_speed_hz, mu=mu)
        rows.append({
            "pair": name, "speeds": len(every), "in bands": sum(bool(row["in a band"]) for row in every),
            "told by runs": sum(bool(row["told"]) for row in every), "agree": agree,
            "growth off at most %": max(shown, default=0.0), "of": len(shown), "worst Hz": found.map.peak_speed_hz,
            "growth there 1/s": worst.poles, "run there 1/s": worst.run,
            "verdict": "agree" if agree >= len(every) - 1 and max(shown, default=0.0) < 5.0 else "NOT",
        })  # fmt: skip
        write_atomic(folder / f"growth_{number}.png", png(figure_stability(found.map)))
    show("Interactions, eigenvalues and runs", rows)
    write(out / "agreement.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
