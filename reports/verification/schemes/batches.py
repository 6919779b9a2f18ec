"""Does a run give the same numbers in a batch as alone? Random lists of scenes through `run_many` and sweeps.

`python -m reports.verification.schemes.batches [--count 2000] [--first 0] [--quick] [--out DIR]` draws lists of two to
ten scenes: rims with and without friction, of any number of modes, with coatings, several tips, whirl, speed ramps,
patches and rods, with different starts, records, steps, schemes and limits. Every fifth draw is a sweep over a scene
file. Each outcome of a batch must equal the run alone to 1e-12 of the largest value. It must equal a batch of only this
scene to the last bit, for any other scenes in the list.
"""

import itertools
import tempfile
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import contact as ct
from contact.model.bodies.channels import rim_channels
from contact.model.gaps.rub_laws import Whirl
from contact.run_many import Outcome
from contact.scene.load import scene_of
from contact.sweep.plan import load_sweep
from contact.sweep.row import row_of, sweep_record
from contact.sweep.sweep import run_sweep
from reports.tables import Row, command_line, show, write

Recipe = Mapping[str, Any]
N_MAX = 6
ROUND = 2e-5  # out-of-roundness of all rims [m]
CLOSE = 1e-12  # of the largest value of a quantity: the round-off of sums that are added in another order
ARRAYS = ("state", "force", "gap", "impulse_history", "impulse", "peak_force", "time", "state_time")
COUNTS = ("steps", "scheme", "every", "blocks", "flags")
CHOICES: dict[str, tuple[Any, ...]] = {
    "kind": ("rim", "rim", "rim", "rim", "rim", "rim", "coated", "rub", "patch", "rods"),
    "pairs": (1, 2, 3, 5), "blade": (1, 2, 3, 4), "mu": (0.0, 0.0, 0.1, 0.3), "S": (0.0, 1e-8),
    "imperfect": (0.0, 0.05), "zeta": (0.0, 0.01), "clearance": (-2e-5, 5e-5, 1e-3), "lean": (-10.0, 0.0, 10.0, 25.0),
    "hz": (-18.0, 0.1, 5.0, 20.0), "ahead": (0.0, 45.0), "start": (0.0, 0.5), "law": ("auto", "forward"),
    "skip": (True, False), "record": ("every", "some", "states", "instants", "channels"), "dt": (1e-5, 2e-5),
    "steps": (40, 150, 400), "tips": (1, 2), "whirl": (False, True), "ramp": (False, True),
    "on_limit": ("stop", "flag"), "elements": (5, 8), "scheme": ("CentralDifference", "MoreauJean", "Newmark"),
}  # fmt: skip
VARIED: dict[str, tuple[Any, ...]] = {
    "casing.basis": ("1.npz", "2.npz", "3.npz"), "blade.basis": ("1b.npz", "2b.npz", "3b.npz"),
    "contact.friction": (0.0, 0.1, 0.2), "contact.clearance": (-2e-5, 5e-5), "blade.lean_deg": (0.0, 10.0),
    "speed.hz": (-5.0, 0.1, 20.0), "scheme.dt": (1e-5, 2e-5),
}  # fmt: skip
SWEPT = """
[scene]
kind = "rim"
t_end = 3e-3
[casing]
basis = "1.npz"
[blade]
basis = "1b.npz"
lean_deg = 10.0
[contact]
clearance = -2e-5
friction = 0.1
[speed]
hz = 5.0
[scheme]
kind = "exact-modal"
dt = 1e-5
[sweep]
"""


def ring(pairs: int, *, S: float = 1e-8, zeta: float = 0.01, imperfect: float = 0.0) -> ct.ModalBody:
    """Pairs of inextensional modes n = 2, 3, ... of a rim; `imperfect` mixes harmonics into each."""
    size = 2 * N_MAX + 1
    rows, omega = np.zeros((2 * size, 2 * pairs)), np.zeros(2 * pairs)
    for k in range(pairs):
        n = 2 + k
        rows[[n, size + N_MAX + n], 2 * k] = np.array([1.0, -1.0 / n]) / np.hypot(1.0, 1.0 / n)
        rows[[N_MAX + n, size + n], 2 * k + 1] = np.array([1.0, 1.0 / n]) / np.hypot(1.0, 1.0 / n)
        omega[[2 * k, 2 * k + 1]] = 2.0 * np.pi * 60.0 * (n * n - 1) * np.array([1.0, 1.0 + imperfect])
    if imperfect:
        rows += imperfect * np.random.default_rng(7).standard_normal(rows.shape)
    return ct.ModalBody(
        omega=omega, zeta=np.full(2 * pairs, zeta), channels=rim_channels(N_MAX), rows=rows,
        S=np.diag([S] * size + [0.5 * S] * size), kind="rim", n_max=N_MAX, radius=0.45,
    )  # fmt: skip


def blade(modes: int, *, S: float = 1e-8, zeta: float = 0.01) -> ct.ModalBody:
    """Modes of a blade seen at its tip."""
    span = 0.1 / np.arange(1.0, modes + 1.0)
    return ct.ModalBody(
        omega=2.0 * np.pi * 150.0 * np.arange(1.0, modes + 1.0) ** 2, zeta=np.full(modes, zeta),
        channels=("span", "flap"), rows=[span, 10.0 * span], S=S * np.array([[1.0, 0.25], [0.25, 3.0]]),
    )  # fmt: skip


def random_recipe(rng: np.random.Generator) -> Recipe:
    """One value of each choice."""
    return {name: values[int(rng.integers(len(values)))] for name, values in CHOICES.items()}


def scene_from(r: Recipe) -> ct.Scene:
    """The scene of a recipe, without choices that its kind does not have."""
    law: Any = ct.Coulomb(mu=r["mu"]) if r["mu"] else ct.Unilateral()
    if r["kind"] == "coated":
        law = ct.Abradable(E=1e9, yield_stress=5e6, hardening=1e8, thickness=2e-3, width=0.02, tip=2e-3, mu=r["mu"])
    what, modes = WHATS[r["kind"]](r)
    scene = ct.Scene(
        what=what, law=law, t_end=r["steps"] * r["dt"], dt=r["dt"], record=record_of(r, modes),
        scheme=ct.ExactModal(law=r["law"], skip=r["skip"]), on_limit=r["on_limit"],
    )  # fmt: skip
    if r["kind"] == "rods":
        return replace(scene, law=None, dt=None, courant=0.5, t_end=2.0, scheme=getattr(ct.scheme, r["scheme"])())
    return scene


def record_of(r: Recipe, modes: int) -> ct.Record:
    """The record of a run with a number of modes."""
    end = 0.5 * r["steps"] * r["dt"] if r["kind"] != "rods" else 1.0
    if r["record"] == "channels":
        return ct.Record(state_every=5, channels=np.eye(2, modes))
    return {
        "every": ct.Record(), "some": ct.Record(every=7), "states": ct.Record(every=3, state_every=6),
        "instants": ct.Record(at=[0.0, 0.5 * end, end]),
    }[r["record"]]  # fmt: skip


def bodies(r: Recipe) -> tuple[ct.ModalBody, ct.ModalBody]:
    """Casing and blade."""
    more = {"S": r["S"], "zeta": r["zeta"]}
    return ring(r["pairs"], imperfect=r["imperfect"], **more), blade(r["blade"], **more)


def rim_of(r: Recipe) -> tuple[Any, int]:
    """One blade at a rotating rim, and the number of entries of its state."""
    casing, tip = bodies(r)
    rim = ct.RotatingRim(
        casing, tip, clearance=r["clearance"], speed_hz=r["hz"], lean_deg=r["lean"], angle_deg=r["ahead"],
        out_of_roundness=[{"p": 2, "cos": ROUND}], blade_velocity=[r["start"]] + [0.0] * (r["blade"] - 1),
    )  # fmt: skip
    return rim, 2 * r["pairs"] + r["blade"] + (2 if r["mu"] else 1)


def rub_of(r: Recipe) -> tuple[Any, int]:
    """One or two blades at a rim that may whirl and whose speed may grow."""
    casing, tip = bodies(r)
    end, k = r["steps"] * r["dt"], r["tips"]
    rub = ct.Rub(
        casing, (tip,) * k, [ct.ContactPoint(blade=j, angle_deg=90.0 * j, lean_deg=r["lean"]) for j in range(k)],
        clearance=r["clearance"], profile=ct.gaps.RimProfile.fourier([{"p": 2, "cos": ROUND}]),
        speed=ct.Speed(time=[0.0, end], hz=[r["hz"], 2.0 * r["hz"]]) if r["ramp"] else ct.Speed.constant(r["hz"]),
        whirl=[Whirl(amplitude=3e-5, per_rev=1.0)] if r["whirl"] else [],
    )  # fmt: skip
    return rub, 2 * r["pairs"] + k * r["blade"] + k * (2 if r["mu"] else 1)


def patch_of(r: Recipe) -> tuple[Any, int]:
    """A beam's modes above several contacts."""
    modes, k = r["blade"] + 1, 2 * r["pairs"]
    rows = np.random.default_rng(11).standard_normal((2 * k, modes))
    names = [f"{way}{i}" for way in "nt" for i in range(k)]
    body = ct.ModalBody(
        omega=np.r_[0.0, 500.0 * np.arange(1.0, modes)], zeta=np.full(modes, r["zeta"]), channels=names, rows=rows,
        S=r["S"] * np.eye(2 * k),
    )  # fmt: skip
    load = -20.0 * rows[:k].sum(axis=0)
    return ct.Patch(
        body=body, normal=names[:k], tangent=tuple((name,) for name in names[k:]), clearance=abs(r["clearance"]),
        slide=0.1, load=load, velocity=r["start"] * load / np.linalg.norm(load),
    ), modes  # fmt: skip


def rods_of(r: Recipe) -> tuple[Any, int]:
    """A rod that meets a wall."""
    rod = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=r["elements"], x=2.0, velocity=-10.0)
    return [rod, ct.Wall()], r["elements"] + 1


WHATS = {"rim": rim_of, "coated": rim_of, "rub": rub_of, "patch": patch_of, "rods": rods_of}


def alone(scene: ct.Scene) -> Outcome:
    """The result of `ct.run`, or the error that it raises."""
    try:
        return ct.run(scene)
    except (ct.InputError, ct.NumericsError) as error:
        return error


def floors(r: Recipe) -> dict[str, float]:
    """Least scales for differences: the clearance, whose round-off every gap has, and its forces.

    A force is the gap without contact over the compliance of one step, at least dt^2 over the modal masses, plus S.
    """
    gap = abs(r["clearance"]) + ROUND
    force = gap / (2.0 * r["dt"] ** 2 + r["S"])
    impulse = force * r["dt"]
    sizes = {"gap": gap, "state": gap, "force": force, "peak_force": force}
    return sizes | {"impulse": impulse, "impulse_history": impulse}


def apart(one: Outcome, other: Outcome, least: Mapping[str, float]) -> float:
    """Largest difference of two outcomes, each quantity over its largest value; infinity for two of another kind."""
    if type(one) is not type(other):
        return np.inf
    if not isinstance(one, ct.Result) or not isinstance(other, ct.Result):
        if str(one) != str(other):
            return np.inf
        pair = getattr(one, "result", None), getattr(other, "result", None)
        return 0.0 if pair[0] is None and pair[1] is None else apart(*pair, least)  # type: ignore[arg-type]
    if any(getattr(one, name) != getattr(other, name) for name in COUNTS):
        return np.inf
    if not np.array_equal(one.contact_steps, other.contact_steps):
        return np.inf
    return max(distance(getattr(one, name), getattr(other, name), least.get(name, 0.0)) for name in ARRAYS)


def distance(a: NDArray[np.float64], b: NDArray[np.float64], least: float) -> float:
    """Largest difference over the largest value, at least `least`; infinity for other shapes."""
    if a.shape != b.shape:
        return np.inf
    scale, gap = float(np.abs(a).max(initial=least)), float(np.abs(a - b).max(initial=0.0))
    return gap / scale if gap > 0.0 else 0.0


def difference(recipes: list[Recipe]) -> tuple[float, float]:
    """Largest differences of the outcomes of a batch from single runs, and from batches of one scene."""
    scenes = [scene_from(recipe) for recipe in recipes]
    many = ct.run_many(scenes)
    rows = list(zip(scenes, many, map(floors, recipes), strict=True))
    beside = max(apart(alone(scene), outcome, least) for scene, outcome, least in rows)
    single = max(apart(ct.run_many([scene])[0], outcome, least) for scene, outcome, least in rows)
    return beside, single


def save_bases(folder: Path) -> None:
    """Bases that `VARIED` names."""
    for k in (1, 2, 3):
        ring(k).save(folder / f"{k}.npz")
        blade(k).save(folder / f"{k}b.npz")


def sweep_of(rng: np.random.Generator) -> str:
    """A scene file that varies two keys, with two or three values each."""
    text = SWEPT
    for key in rng.choice(list(VARIED), 2, replace=False).tolist():
        values = [value if isinstance(value, str) else float(value) for value in VARIED[key]]
        text += f'[[sweep.vary]]\nkey = "{key}"\nvalues = {values}\n'
    return text


def swept_difference(text: str, folder: Path) -> float:
    """Largest difference of the rows of a sweep from single runs; infinity if a word differs."""
    file = folder / "scene.toml"
    file.write_text(text)
    plan, worst = load_sweep(file), 0.0
    for run, row in zip(plan.runs, run_sweep(plan).rows, strict=True):
        scene = scene_of(plan.data(run), file)
        steps = int(row["steps"])
        own = row_of(scene, alone(replace(scene, record=sweep_record(steps))))
        for name, value in own.items():
            if isinstance(value, float) and isinstance(row[name], float):
                worst = max(worst, abs(value - row[name]) / max(abs(value), SCALES.get(name, 0.0)) if value else 0.0)
            elif value != row[name]:
                return np.inf
    return worst


SCALES = {  # least scales for differences of a sweep's columns, as `floors`
    "unaccounted_rel": 1.0, "growth_1_s": 1.0, "growth_low_1_s": 1.0,
    "growth_high_1_s": 1.0, "lost_in_contact_J": 1e-3, "max_penetration_m": 1e-6,
    "residual_m": 1e-6, "blade_rms_m": 1e-6, "dominant_rms_m": 1e-6, "amplitude_m": 1e-6,
    "rotation_J": 1e-3, "friction_J": 1e-3, "damping_J": 1e-3,
}  # fmt: skip


def drawn(seed: int, folder: Path) -> Row:
    """One draw: the scenes, and the largest differences."""
    rng = np.random.default_rng(seed)
    if seed % 5 == 4:
        return {"draw": seed, "kind": "sweep", "from alone": swept_difference(sweep_of(rng), folder), "from one": 0.0}
    recipes = [random_recipe(rng) for _ in range(int(rng.integers(2, 11)))]
    beside, single = difference(recipes)
    return {"draw": seed, "kind": "run_many", "from alone": beside, "from one": single}


def main(out: Path, quick: bool = False, count: int = 2000, first: int = 0) -> list[Row]:
    """Print the differences of batches from single runs; write a row for each draw."""
    rows: list[Row] = []
    began = time.process_time()
    with tempfile.TemporaryDirectory() as name:
        save_bases(Path(name))
        for seed in range(first, first + (min(count, 20) if quick else count)):
            rows.append(drawn(seed, Path(name)))
            if not float(str(rows[-1]["from alone"])) <= CLOSE or rows[-1]["from one"] != 0.0:
                print(f"differs: {rows[-1]}")
    table: list[Row] = []
    for kind, part in itertools.groupby(sorted(rows, key=lambda row: str(row["kind"])), key=lambda row: row["kind"]):
        mine = list(part)
        beside = np.array([float(str(row["from alone"])) for row in mine])
        single = np.array([float(str(row["from one"])) for row in mine])
        table.append({
            "batch": kind, "draws": len(mine), "largest difference from the run alone": float(beside.max()),
            "from the batch of one": float(single.max()), "failed": int(np.sum((beside > CLOSE) | (single > 0.0))),
        })  # fmt: skip
    show(f"Batches beside single runs, in {time.process_time() - began:.0f} s", table)
    write(out / "batches.csv", rows)
    return table


if __name__ == "__main__":
    command_line(__doc__, main, count=(2000, "how many draws"), first=(0, "seed of the first"))
