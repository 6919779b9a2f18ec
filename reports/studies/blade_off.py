"""A blade-off: 36 flexible blades on a gyroscopic shaft, a casing of 60 modes on mounts, fifteen seconds.

`python -m reports.studies.blade_off [--quick] [--out DIR]` reduces casing.toml and blade.toml of
data/scenes/blade_off, takes a blade away after 10 ms and lets friction slow the rotor. Tables: runs with 1, 12 and 36
blades with their time a step; a thicker casing, a larger clearance, a coating; ten draws of mistuned blades; modes,
residual compliance, the sense of whirl and the step against the run's own finest choice. DIR/blade_off/index.html shows
rotor, tips and casing as a film, and speed, orbit and forces over the fifteen seconds. Times are processor times.
"""

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import casingfem as cf
import contact as ct
from casingfem.plot.contact import rub_film
from casingfem.plot.page import Picture, Section, Table, Verdict, render_page
from casingfem.plot.pages.scene import CAPTIONS
from casingfem.plot.rotor import figure_rotor_run
from casingfem.study.load import load_shell_study
from contact.io.outfiles import write_atomic
from contact.on_rotor import RotorHistory, rotor_history
from contact.recovery.histories import rub_film as film_of
from reports.tables import DATA, Row, command_line, show_all, text

SPEED, LOST, INERTIA = 100.0, 3e-2, 0.8  # turns/s, kg m, kg m^2
CLEARANCE, WIDER, THICKER = 5e-4, 1e-3, 12e-3  # m
FRICTION, DT, END, SHORT = 0.1, 2e-5, 15.0, 0.5  # s
SEEDS, MISTUNED, LEAN = 10, 0.02, -10.0  # draws; standard deviation of blade frequencies; degrees, tips trail
COATING = ct.Abradable(E=4e8, yield_stress=2e6, hardening=4e7, thickness=3e-3, width=0.04, tip=4e-3)
EVERY = 5  # steps


@dataclass(frozen=True, kw_only=True)
class Case:
    """The quantities that vary from one run to the next."""

    blades: int = 36
    thickness: float = 8e-3
    clearance: float = CLEARANCE
    modes: int = 60
    residual: bool = True
    hz: float = SPEED
    dt: float = DT
    law: ct.Coulomb | ct.Abradable = ct.Coulomb(mu=FRICTION)  # noqa: RUF009
    seed: int | None = None
    lean: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Ran:
    """One run: what was run, its result, its history, processor time of its steps [s]."""

    rub: ct.Rub
    result: ct.Result
    history: RotorHistory
    seconds: float


class Bases:
    """Casing and blade, each reduced once."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.made: dict[tuple[str, float, int], ct.ModalBody] = {}

    def body(self, name: str, thickness: float | None = None, modes: int | None = None) -> ct.ModalBody:
        """The basis of a study with another wall or another number of modes."""
        study = load_shell_study(DATA / "scenes" / "blade_off" / f"{name}.toml")
        assert study.interface is not None
        assert study.file.reduce is not None
        key = name, thickness or 0.0, modes or study.file.reduce.modes
        if key not in self.made:
            shell = study.shell if thickness is None else replace(study.shell, thickness=thickness)
            basis = cf.reduce(shell, study.interface, modes=key[2], zeta=study.file.reduce.zeta)
            self.made[key] = ct.ModalBody.load(basis.save(self.folder / f"{name}_{len(self.made)}.npz"))
        return self.made[key]


def rotor_of(hz: float) -> ct.rotor.Rotor:
    """A disk of 20 kg on a shaft between two bearings, its first blade lost after 10 ms."""
    R = ct.rotor
    bearing = {"kxx": 2e7, "cxx": 2e3}
    shaft = R.Shaft(
        pieces=[R.Piece(length=0.6, diameter=0.06, elements=6)],
        disks=[R.Disk(at=0.4, mass=20.0, polar=0.4, diametral=0.22)],
        bearings=[R.Bearing(at=0.0, **bearing), R.Bearing(at=0.6, **bearing)],
    )
    release = R.Release(time=0.01, moment=LOST)
    return R.Rotor.of(shaft, hz, unbalance=R.Unbalance(moment=1e-4, release=release), modes=16)


def scene(bases: Bases, case: Case) -> ct.Rub:
    """The rotor in its casing, without the blade at 0 degrees where there are several."""
    casing, blade = bases.body("casing", case.thickness, case.modes), bases.body("blade")
    if not case.residual:
        casing = replace(casing, S=np.zeros_like(casing.S))
    blades = [blade] * case.blades
    if case.seed is not None:
        off = 1.0 + MISTUNED * np.random.default_rng(case.seed).standard_normal(case.blades)
        blades = [replace(blade, omega=factor * blade.omega) for factor in off.tolist()]
    kept = range(1 if case.blades > 1 else 0, case.blades)
    tips = [ct.gaps.ContactPoint(blade=j, angle_deg=360.0 * j / case.blades, lean_deg=case.lean) for j in kept]
    return ct.rotor.rotor_rub(
        rotor_of(case.hz), casing, blades, tips, clearance=case.clearance, spin=ct.rotor.Spin(inertia=INERTIA)
    )


def ran(bases: Bases, case: Case, end: float) -> Ran:
    """Run a case to `end` [s]."""
    rub = scene(bases, case)
    ct.run(rub, law=case.law, t_end=2e-3, dt=case.dt, on_limit="flag")  # compiles
    record = ct.Record(every=EVERY, state_every=EVERY * max(1, round(end / case.dt / EVERY / 15_000)))
    began = time.process_time()
    result = ct.run(rub, law=case.law, t_end=end, dt=case.dt, record=record, on_limit="flag")
    seconds, history = time.process_time() - began, rotor_history(rub, result)
    assert history is not None
    return Ran(rub=rub, result=result, history=history, seconds=seconds)


def row(name: str, one: Ran) -> Row:
    """Results of a run, and its time."""
    result, history, spin = one.result, one.history, one.result.notes.spin
    assert spin is not None
    assert history.bearings is not None
    assert history.mounts is not None
    force = result.windowed_force().sum(axis=1)
    return {
        "run": name, "time a step [us]": 1e6 * one.seconds / result.steps,
        "steps in contact [%]": 100.0 * float((result.force > 0.0).any(axis=1).mean()),
        "largest force [kN]": 1e-3 * float(force.max()),
        "bearings [kN]": 1e-3 * float(np.hypot(*history.bearings.T).max()),
        "mounts [kN]": 1e-3 * float(np.hypot(*history.mounts.T).max()),
        "orbit [mm]": 1e3 * float(np.hypot(*history.disk.T).max()),
        "casing [mm]": 1e3 * float(np.hypot(*history.casing.T).max()),
        "speed at the end [Hz]": float(history.speed_hz[-1]), "to friction [kJ]": -1e-3 * spin.friction,
        "unaccounted": abs(spin.unaccounted) / spin.start,
    }  # fmt: skip


def bent(one: Ran) -> float:
    """Largest motion of a tip along its flap [m]."""
    rows = enumerate(one.rub.blades, 1)
    return max(float(np.abs(one.result.state_of(f"blade {k}") @ body.rows[1]).max()) for k, body in rows)


def variants(quick: bool) -> Mapping[str, Case]:
    """Runs of the whole fifteen seconds."""
    found = {
        "36 blades": Case(), "12 blades": Case(blades=12), "1 blade": Case(blades=1),
        "wall of 12 mm": Case(thickness=THICKER), "clearance of 1 mm": Case(clearance=WIDER),
        "coating": Case(law=replace(COATING, mu=FRICTION)),
    }  # fmt: skip
    return {name: found[name] for name in ("12 blades", "1 blade")} if quick else found


def choices(quick: bool) -> Mapping[str, Case]:
    """Runs of half a second, each with one choice changed; the first is what they are compared with."""
    found = {
        "60 modes, step of 5 us": Case(dt=5e-6), "step of 10 us": Case(dt=1e-5), "step of 20 us": Case(),
        "40 modes": Case(modes=40), "20 modes": Case(modes=20),
        "10 modes": Case(modes=10), "no residual compliance": Case(residual=False),
        "10 modes, no residual": Case(modes=10, residual=False), "turning the other sense": Case(hz=-SPEED),
    }  # fmt: skip
    return dict(list(found.items())[2:4]) if quick else found


def compared(runs: Mapping[str, Ran]) -> Iterator[Row]:
    """Errors of speed, impulse and orbit of each run against the first, and its time."""
    first = next(iter(runs.values()))
    fallen, impulse = abs(first.history.speed_hz[-1]) - SPEED, first.result.impulse.sum()
    orbit = np.hypot(*first.history.disk.T).max()
    for name, one in runs.items():
        yield {
            "choice": name, "seconds": one.seconds,
            "fall of speed [%]": 100.0 * ((abs(one.history.speed_hz[-1]) - SPEED) / fallen - 1.0),
            "impulse [%]": 100.0 * (one.result.impulse.sum() / impulse - 1.0),
            "orbit [%]": 100.0 * (np.hypot(*one.history.disk.T).max() / orbit - 1.0),
            "largest force [%]": 100.0 * (windowed(one) / windowed(first) - 1.0),
        }  # fmt: skip


def windowed(one: Ran) -> float:
    """Largest contact force of all tips together [N]."""
    return float(one.result.windowed_force().sum(axis=1).max())


@contextmanager
def told(name: str) -> Iterator[None]:
    """Print which run is under way, and its time."""
    began = time.perf_counter()
    yield
    print(f"{name}: {time.perf_counter() - began:.0f} s", flush=True)


def page(tables: Mapping[str, tuple[str, list[Row]]], runs: Mapping[str, Ran]) -> str:
    """The page: a verdict, the film, the histories of all long runs, the tables."""
    sections, first = list[Section](), next(iter(runs.values()))
    film = film_of(first.rub, first.result)
    films = () if film is None else (rub_film(film, first.result),)
    for name, one in runs.items():
        drawn = Picture.of(figure_rotor_run(one.history, one.rub.clearance), f"{name}. {CAPTIONS['rotor']}", kind="png")
        sections.append(Section(name.capitalize(), figures=(*(films if one is first else ()), drawn)))
    for title, rows in tables.values():
        cells = tuple(tuple(text(value) for value in one.values()) for one in rows)
        sections.append(Section(title, tables=(Table(title + ".", tuple(rows[0]), cells),)))
    seen = row("", first)
    verdict = Verdict(
        found=f"The rotor slows from {SPEED:g} to {seen['speed at the end [Hz]']:.3g} Hz and rubs in "
        f"{seen['steps in contact [%]']:.3g} % of all steps.",
        sure=f"The energy of the spin is accounted for to {seen['unaccounted']:.1e} of itself.",
        further="Compare the histories of the other casings below.",
        facts=(
            ("Mounts", f"The largest force on the casing's mounts is {seen['mounts [kN]']:.4g} kN."),
            ("Bearings", f"The largest force on the bearings is {seen['bearings [kN]']:.4g} kN."),
        ),
    )  # fmt: skip
    return render_page("Blade-off", sections, verdict=verdict, source="python -m reports.studies.blade_off")


def main(out: Path, quick: bool = False) -> list[Row]:
    """Run all, print the tables, write the page; returns all rows."""
    folder = out / "blade_off"
    folder.mkdir(parents=True, exist_ok=True)
    bases, long, short = Bases(folder), dict[str, Ran](), dict[str, Ran]()
    for name, case in variants(quick).items():
        with told(name):
            long[name] = ran(bases, case, 0.05 if quick else END)
    drawn: list[Row] = []
    for seed in range(11, 11 + (2 if quick else SEEDS)):
        with told(f"draw {seed}"):
            one = ran(bases, Case(seed=seed, lean=LEAN), 0.02 if quick else SHORT)
            cells = row(f"draw {seed}", one)
            del cells["time a step [us]"]
            drawn.append(cells | {"blade [mm]": 1e3 * bent(one)})
    for name, case in choices(quick).items():
        with told(name):
            short[name] = ran(bases, case, 0.02 if quick else SHORT)
    tables = {
        "runs": ("Fifteen seconds after a blade is lost", [row(name, one) for name, one in long.items()]),
        "seeds": ("Half a second with mistuned blades that lean back by 10 degrees", drawn),
        "choices": ("Half a second by modes, compliance, sense and step", list(compared(short))),
    }
    rows = show_all(out, "blade_off_", tables)
    write_atomic(folder / "index.html", page(tables, long))
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
