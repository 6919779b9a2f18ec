"""The figure of docs/theory/interaction.md: `.venv/bin/python docs/turning_casing.py` writes it (some seconds).

A cylinder's wave of eight diameters as the blade sees it, and growth of the closed contact, for either side that turns.
"""

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import casingfem as cf
import contact as ct
from casingfem.plot.style import AFTER, BEFORE, PERFECT, new_figure, png, styled
from contact.io.outfiles import write_atomic
from contact.model.gaps.permanent import ClosedContact, rim_contact
from contact.stability.closed_contact import growth
from contact.stability.waves import waves_of

HERE = Path(__file__).parent
N, MU, TURN = 8, 0.1, 2.0 * np.pi
SPEED = np.linspace(2.0, 220.0, 437)


def closed_contacts() -> dict[str, ClosedContact]:
    """The contact of docs/gallery/interaction/interaction_table.py while the casing turns, and while the blade does."""
    steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    casing = cf.Shell(
        chart=cf.Cylinder(radius=0.20, height=0.15), thickness=1.5e-3, material=steel, supports={"base": cf.Clamped()},
        mesh=cf.ShellMesh(order=6, rows=1, around=17),
    )  # fmt: skip
    blade = cf.Shell(
        chart=cf.Plate(length=0.08, width=0.03), thickness=2e-3, material=steel, supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=6, rows=2, around=2),
    )  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        rim = cf.reduce(casing, cf.Rim("top", n_max=N), modes=12, zeta=5e-4).save(Path(folder, "casing.npz"))
        tip = cf.reduce(blade, cf.Tip(), modes=2, zeta=5e-4).save(Path(folder, "blade.npz"))
        bodies = ct.ModalBody.load(rim), ct.ModalBody.load(tip)
    turning = ct.RotatingRim(*bodies, clearance=-5e-5, speed_hz=100.0, lean_deg=20.0, turning="casing")
    inside = replace(turning, turning="blades")
    return {"the casing turns": rim_contact(turning, mu=MU), "the blade turns": rim_contact(inside, mu=MU)}


def wave_and_mode(contact: ClosedContact) -> tuple[Any, float]:
    """Lowest frequency [Hz] of the waves of N diameters that the blade meets first, over `SPEED`; the blade's [Hz]."""
    omega = TURN * SPEED
    free = waves_of(contact).poles(omega, 1.0)
    assert free is not None
    against = free.casing & (free.order == N) & (free.sign > 0.0)
    return free.met(omega)[:, against].min(axis=1) / TURN, float(contact.omega[contact.casing]) / TURN


@styled
def figure_turning(contacts: dict[str, ClosedContact]) -> Figure:
    """Frequencies above, growth below."""
    figure = new_figure(7.2, 5.6)
    panels: Any = figure.subplots(2, 1, sharex=True)
    for (label, contact), color in zip(contacts.items(), (AFTER, BEFORE), strict=True):
        wave, mode = wave_and_mode(contact)
        panels[0].plot(SPEED, wave, color=color, label=label)
        panels[1].plot(SPEED, growth(contact, SPEED), color=color)
    for sign, words in ((1.0, "f_b = f_c - n f"), (-1.0, "f_b = n f - f_c")):
        panels[0].axhline(sign * mode, color=PERFECT, linestyle="--")
        panels[0].annotate(words, (SPEED[0], sign * mode), xytext=(2, 3), textcoords="offset points", fontsize=8)
    panels[0].set_ylabel(f"f_c - n f, n = {N} [Hz]")
    panels[0].legend()
    panels[1].set_yscale("symlog", linthresh=10.0)
    panels[1].set(xlabel="speed f [turns/s]", ylabel="growth [1/s]")
    return figure


if __name__ == "__main__":
    path = HERE / "theory" / "turning_casing.png"
    write_atomic(path, png(figure_turning(closed_contacts()), dpi=110))
    print(f"wrote {path}")
