"""Check of the verdict of a run on growth: random rubs are compared with long runs at a tenth of the step.

`python -m reports.verification.rubs.run_growth [--count 200] [--first 0] [--fresh 1100] [--quick] [--out DIR]` draws a
steel ring of up to five nodal diameters before one blade, several blades or a bladed disk: with and without friction,
damping, clearance, lean and out-of-roundness. It draws two sets: from the seed `--first`, on which constants were set,
and from the seed `--fresh`, on which none was set. A run of half a second gives its verdict. If a longer run may change
it (`contact.speed_verdict.times_longer`), the run is repeated two or four times as long, up to sixteen times, as runs
of `casingfem interactions` are. "grows later" counts motions that grow only in the longer run.

A run three times as long at a tenth of the step, which continues to a tenth of the radius, shows the further motion.
Its level is sqrt(mean omega^2 (q - mean q)^2) of all modes over windows of 1/480 of it. The motion grows if the rim
passes half its wall. If it does not, but the level at the end is more than e^0.5 times that at the end of the short
run, the run is repeated four times as long; a run above 25 s is not repeated, its second half is taken. The motion then
grows if the rim passes half its wall, or if the level rises by e^0.5 again. It decays if the level at the end is below
e^-0.5 times that of the short run. Otherwise it is bounded, because levels of irregular motions vary by as much. A
growth that half the step calls numerical counts as no growth, and so does an undecided verdict; the table has the
number of both.

The growth rates of both runs in the last stretch are compared if three conditions hold: the short run grows by e or
more there, its interval is within 10 %, and half the step gives the same growth. Contacts that stay closed and contacts
that open are listed separately.

A run that passed half its wall or a tenth of the radius before its growth could be fitted grows ("passed").

Each difference is tested. "start": a change of the start by 1e-9 to 3e-9 of it changes the verdict of the short run, or
that of the long one, so that neither run decides; a table has both for each change. "later": in the last stretch of the
short run the level of the long run does what the verdict states; it changes afterwards. "escapes": at the step of the
short run too the motion keeps its level, within e^0.5, for a quarter of the short run's length after its end, and grows
to half the wall before the end of the long run. The time of this depends on the start and the step. "step": the short
run at its half step has the verdict of the long one. "short": the run states that it is too short. A difference that no
test explains is a FAIL, and so is a set of draws of which fewer than 99 % have the same sign.
"""

import math
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import contact as ct
from casingfem.io.arrays import FloatArray
from contact.model.gaps.rub import rub_of
from contact.record.record import prime_stride
from contact.speed_runs import LONGEST as REPEATED
from contact.speed_verdict import judged, times_longer
from contact.stability.peaks import growth_at
from reports.tables import Row, command_line, show, text, write

KINDS = ("rim", "rub", "disk")
RADIUS, WALL = 0.25, 4e-3
END, STEP = 0.5, 2e-5  # s
LONGER, FINER, GOES_ON = 3, 10, 4
LONGEST = 25.0  # s: a longer run is not repeated
KEPT = 75_000  # states of a long run
SIGNS, MANY = 0.99, 100  # of the draws must have the sign of the long run, where there are so many
WINDOWS, CHANGED, SAME = 480, 0.5, 0.3
WITHIN, CLOSED = 0.1, 0.99
COPIES, MOVED = 3, 1e-9
SOME = 100  # states of a rate
AFTER = 0.25  # of the short run: time for which a motion that escapes later keeps its level
STATES = ("grows", "passed", "irregular", "numerical", "bounded", "decays", "undecided", "at rest")
NO_GROWTH = ("bounded", "decays")
EACH = ("seed", "kind", "verdict", "long run", "sign agrees", "off", "why")  # printed after each draw


def ring(rng: np.random.Generator) -> ct.ModalBody:
    """A steel ring on springs, its modes of up to five nodal diameters, the others as compliance."""
    thin = ct.bodies.ThinRing(
        radius=RADIUS, width=0.05, height=WALL, E=210e9, rho=7800.0, k_r=float(rng.uniform(5e6, 4e7)),
        k_t=2e6, zeta=float(10.0 ** rng.uniform(-3.3, -1.7)),
    )  # fmt: skip
    return replace(ct.bodies.ring_modes(thin, 5).truncated(2.5e4), thickness=WALL)


def blade(rng: np.random.Generator) -> ct.ModalBody:
    """Two modes of a blade and its compliance."""
    hz = float(rng.uniform(150.0, 600.0))
    return ct.ModalBody(
        omega=[2.0 * np.pi * hz, 2.0 * np.pi * 5.0 * hz], zeta=[float(10.0 ** rng.uniform(-3.3, -2.0))] * 2,
        channels=("span", "flap"), rows=[[0.1, 0.2], [2.0, 0.5]], S=[[2e-8, 0.0], [0.0, 6e-8]],
    )  # fmt: skip


def drawn(seed: int) -> tuple[ct.RotatingRim | ct.Rub, float]:
    """A problem of a kind that the seed selects, and its friction."""
    rng, kind = np.random.default_rng(seed), KINDS[seed % len(KINDS)]
    casing, speed = ring(rng), float(rng.uniform(20.0, 200.0))
    mu = float(rng.uniform(0.05, 0.35)) if rng.random() < 0.6 else 0.0
    lean = float(rng.uniform(0.0, 25.0))
    rough = [{"p": int(rng.integers(2, 6)), "cos": float(10.0 ** rng.uniform(-5.5, -4.0))}]
    rough = rough if rng.random() < 0.6 else []
    clearance = float(rng.uniform(-5e-5, 0.0)) if rng.random() < 0.6 else float(rng.uniform(0.0, 5e-5))
    kick = 0.02 * rng.standard_normal(casing.omega.size)
    if kind == "rim":
        return ct.RotatingRim(
            casing, blade(rng), clearance=clearance, speed_hz=speed, lean_deg=lean, out_of_roundness=rough,
            casing_velocity=kick,
        ), mu  # fmt: skip
    profile = ct.gaps.RimProfile.fourier(rough)
    start = ct.gaps.Start(velocity=kick)
    given = {"clearance": clearance, "speed": ct.Speed.constant(speed), "profile": profile, "casing_start": start}
    if kind == "rub":
        count = int(rng.integers(2, 5))
        one = blade(rng)
        tips = tuple(ct.ContactPoint(blade=b, angle_deg=360.0 * b / count, lean_deg=lean) for b in range(count))
        return ct.Rub(casing, (one,) * count, tips, **given), mu
    disk = ct.gaps.BladedDisk(
        blades=int(rng.integers(5, 10)), freq_hz=float(rng.uniform(150.0, 500.0)), modal_mass=0.3,
        coupling=float(rng.uniform(0.0, 0.05)), zeta=1e-3, compliance=5e-8, lean_deg=max(lean, 2.0),
    )  # fmt: skip
    return ct.Rub(casing, (disk.body(),), disk.tips(), **given), mu


def ended(what: ct.RotatingRim | ct.Rub, mu: float, end: float, step: float, **more: object) -> ct.Result:
    """The result of a run, up to where it diverged."""
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    try:
        return ct.run(what, law=law, t_end=end, dt=step, **more)
    except ct.NumericsError as error:
        if error.result is None:
            raise
        return error.result


def levels(what: ct.RotatingRim | ct.Rub, result: ct.Result, windows: int) -> tuple[FloatArray, FloatArray]:
    """Middles of windows [s] and the level of all modes in them."""
    bodies = (what.casing, what.blade) if isinstance(what, ct.RotatingRim) else what.bodies
    omega = np.concatenate([body.omega for body in bodies])
    parts = np.array_split(np.arange(result.state_time.size), windows)
    scaled = result.state[:, : omega.size] * omega
    level = [math.sqrt(float(np.sum(np.var(scaled[part], axis=0)))) for part in parts]
    return np.array([float(result.state_time[part].mean()) for part in parts]), np.array(level)


def far(long: ct.Result) -> bool:
    """Whether the rim passed half its wall."""
    return long.divergence is not None or long.notes.deflection > 0.5 * WALL


def folds_of(what: ct.RotatingRim | ct.Rub, long: ct.Result, begin: float, end: float) -> float:
    """Change of the level in e-folds from the stretch `begin` to `end` [s] to the last tenth of a run."""
    t, level = levels(what, long, WINDOWS)
    now = level[(t > begin) & (t <= end)].mean()
    later = level[t > 0.9 * t[-1]].mean()
    return math.log(later / now) if now > 0.0 and later > 0.0 else 0.0


def fate(what: ct.RotatingRim | ct.Rub, mu: float, planned: float, end: float) -> tuple[str, float, ct.Result]:
    """The motion after `end` [s] in a word, the change of its level in e-folds, and the run that shows it."""
    long = long_run(what, mu, planned)
    if far(long):
        return "grows", math.inf, long
    folds = folds_of(what, long, 0.8 * end, end)
    if folds < -CHANGED:
        return "decays", folds, long
    if folds < CHANGED:
        return "bounded", folds, long
    more, reached = long, 0.5 * LONGER * planned
    if GOES_ON * LONGER * planned < LONGEST:
        more, reached = long_run(what, mu, GOES_ON * planned), LONGER * planned
    again = math.inf if far(more) else folds_of(what, more, 0.9 * reached, reached)
    return ("grows" if again > CHANGED else "bounded"), again, long


def rate_in(what: ct.RotatingRim | ct.Rub, long: ct.Result, begin: float, end: float) -> float:
    """Growth of the level of a run between two instants [1/s], by least squares; nan if the run ends before."""
    t, here = long.state_time, (long.state_time >= begin) & (long.state_time <= end)
    if np.count_nonzero(here) < SOME:
        return math.nan
    part = replace(long, state_time=t[here], state=long.state[here])
    middle, level = levels(what, part, 12)
    moves = np.isfinite(level) & (level > 0.0)
    return float(np.polyfit(middle[moves], np.log(level[moves]), 1)[0]) if moves.all() else math.nan


def long_run(what: ct.RotatingRim | ct.Rub, mu: float, end: float = END) -> ct.Result:
    """The long run that shows the further motion after a run that is planned for `end` [s]."""
    every = max(FINER, prime_stride(round(LONGER * end * FINER / STEP), KEPT))
    record = ct.Record(every=every, state_every=every)
    return ended(what, mu, LONGER * end, STEP / FINER, record=record, on_limit="flag")


def decided(what: ct.RotatingRim | ct.Rub, mu: float) -> list[tuple[ct.Result, float]]:
    """Runs and their planned ends [s]: half a second, and longer ones while a longer run may change the verdict."""
    hz = float(np.max(rub_of(what).speed.hz))
    pole = float(growth_at(what, np.array([hz]), mu=mu)[0])
    runs = [(ended(what, mu, END, STEP), END)]
    while True:
        run = judged(what, runs[-1][0], hz, pole, exact=True)
        planned = times_longer(run, END, exact=True) * runs[-1][1]
        if not 0.0 < planned <= REPEATED * END:
            return runs
        runs.append((ended(what, mu, planned, STEP), planned))


def settled(runs: Sequence[tuple[ct.Result, float]]) -> tuple[ct.Result, float]:
    """The run that gives the verdict: the last one, or one that grows if the longer ones do not decide."""
    growing = [run for run in runs if grows(verdict_of(run[0]))]
    return growing[-1] if growing and verdict_of(runs[-1][0]) == "undecided" else runs[-1]


def verdict_of(result: ct.Result) -> str:
    """End state by a short run, or the reason why its growth does not count."""
    grown = result.growth
    assert grown is not None
    passed = result.divergence is not None and result.divergence.limit in ("wall", "radius")
    if passed and grown.state != "grows":
        return "passed"
    return "irregular" if grown.check == "irregular" else grown.outcome


def grows(verdict: str) -> bool:
    """Whether a verdict is growth."""
    return verdict in ("grows", "irregular", "passed")


def moved(what: ct.RotatingRim | ct.Rub, by: float) -> ct.RotatingRim | ct.Rub:
    """The same problem, its start changed by a fraction of it."""
    if isinstance(what, ct.RotatingRim):
        return replace(what, casing_velocity=(1.0 + by) * np.asarray(what.casing_velocity))
    start = what.casing_start
    return replace(what, casing_start=replace(start, velocity=(1.0 + by) * np.asarray(start.velocity)))


def by_start(what: ct.RotatingRim | ct.Rub, mu: float) -> list[tuple[str, str]]:
    """Verdict of the short run, repeated as `decided` does, and fate of the long one, for each changed start."""
    found = []
    for one in (moved(what, k * MOVED) for k in range(1, COPIES + 1)):
        short, planned = settled(decided(one, mu))
        found.append((verdict_of(short), fate(one, mu, planned, short.steps * short.dt)[0]))
    return found


def escapes(what: ct.RotatingRim | ct.Rub, mu: float, end: float, planned: float) -> bool:
    """Whether the motion at the step of the short run keeps its level after `end` [s] and grows later."""
    more = ended(what, mu, LONGER * planned, STEP, record=ct.Record(every=FINER, state_every=FINER), on_limit="flag")
    t, level = levels(what, more, WINDOWS)
    now, after = level[(t > 0.8 * end) & (t <= end)], level[(t > end) & (t <= (1.0 + AFTER) * end)]
    if not (far(more) and after.size and now.mean() > 0.0):
        return False
    return bool(np.abs(np.log(after / now.mean())).max() < CHANGED)


def explained(
    what: ct.RotatingRim | ct.Rub, mu: float, short: ct.Result, long: ct.Result, verdict: str, becomes: str,
    planned: float,
) -> tuple[str, list[tuple[str, str]]]:  # fmt: skip
    """Reason why a verdict differs from the further motion, as in the module, or "NOT"; and `by_start`."""
    grown, end = short.growth, short.steps * short.dt
    assert grown is not None
    if verdict == "undecided" and becomes != "grows":
        return "short", []
    others = by_start(what, mu)
    if grows(verdict) != (becomes == "grows"):
        same = all(grows(one) == grows(verdict) and (after == "grows") == (becomes == "grows") for one, after in others)
    else:
        same = all((one, after) == (verdict, becomes) for one, after in others)
    if not same:
        return "start", others
    if verdict == "undecided":
        return "short", others
    if float(long.state_time[-1]) >= end:
        folds = rate_in(what, long, grown.since, end) * (end - grown.since)
        if verdict == ("grows" if folds > SAME else "decays" if folds < -SAME else "bounded"):
            return "later", others
    if becomes == "grows" and not grows(verdict) and escapes(what, mu, end, planned):
        return "escapes", others
    fine = verdict_of(ended(what, mu, planned, 0.5 * STEP))
    return ("step" if (grows(fine) and becomes == "grows") or fine == becomes else "NOT"), others


def compared(seed: int) -> Row:
    """Verdict of a short run, and the motion of the long one."""
    what, mu = drawn(seed)
    started = time.perf_counter()
    runs = decided(what, mu)
    short, planned = settled(runs)
    seconds = time.perf_counter() - started
    grown = short.growth
    assert grown is not None
    verdict, end = verdict_of(short), short.steps * short.dt
    becomes, folds, long = fate(what, mu, planned, end)
    row: Row = {
        "seed": seed, "kind": KINDS[seed % len(KINDS)], "mu": mu,
        "planned s": planned, "first verdict": verdict_of(runs[0][0]), "verdict": verdict,
        "long run": becomes,
        "folds": folds if math.isfinite(folds) else None, "growth 1/s": grown.rate, "low": grown.low,
        "high": grown.high, "since s": grown.since, "end s": end, "fine 1/s": None, "off": None,
        "check": grown.check, "half step 1/s": grown.half_step, "check share": grown.check_share,
        "closed": grown.cause.closed if grown.cause else None, "body": grown.body, "n": grown.nodal_diameters,
        "seconds": seconds,
    }  # fmt: skip
    linear = grown.check == "converged" and grown.rate * (end - grown.since) > 1.0
    if linear and 0.5 * (grown.high - grown.low) < WITHIN * grown.rate:
        fine = rate_in(what, long, grown.since, min(end, float(long.state_time[-1])))
        row |= {"fine 1/s": fine, "off": grown.rate / fine - 1.0}
    same = grows(verdict) == (becomes == "grows")
    agrees = same and (grows(verdict) or verdict == becomes)
    why, others = ("", []) if agrees else explained(what, mu, short, long, verdict, becomes, planned)
    changed = "; ".join(f"{one} / {after}" for one, after in others)
    return row | {"sign agrees": same, "agrees": agrees, "why": why, "changed start": changed}


def main(out: Path, quick: bool = False, count: int = 200, first: int = 0, fresh: int = 1100) -> list[Row]:
    """Print the verdicts that differ and how many agree, by set and kind; write a row for each draw."""
    size = min(count, 6) if quick else count
    rows: list[Row] = []
    for seed in (begin + k for begin in (first, fresh) for k in range(size)):
        rows.append(compared(seed))
        print(*(f"{name} {text(rows[-1][name])}" for name in EACH), sep=", ", flush=True)
        write(out / "run_growth.csv", rows)
    sets = {first: rows[:size], fresh: rows[size:]}
    different = [row for row in rows if not row["agrees"]]
    shown = ("seed", "kind", "mu", "planned s", "verdict", "long run", "folds", "growth 1/s", "low", "high", "since s",
             "end s", "closed", "sign agrees", "why")  # fmt: skip
    if different:
        show("Verdicts that differ from the long run", [{name: row[name] for name in shown} for row in different])
    starts = [row for row in different if row["why"] == "start"]
    if starts:
        names = ("seed", "kind", "verdict", "long run", "changed start")
        show(
            "Short / long run, the start changed by 1, 2 and 3e-9",
            [{name: row[name] for name in names} for row in starts],
        )
    table: list[Row] = []
    for begin, part in sets.items():
        seeds = f"{begin} to {begin + size - 1}"
        for kind in (*KINDS, "all"):
            table.append(
                {"seeds": seeds, "kind": kind} | counted([row for row in part if kind in (row["kind"], "all")])
            )
    show("Runs of half a second and longer against runs three times as long at a tenth of the step", table)
    return table


def counted(rows: Sequence[Row]) -> Row:
    """How many draws agree, how many are undecided, and how many growths are within 10 %."""
    off = [(abs(float(str(row["off"]))), float(str(row["closed"])) > CLOSED) for row in rows if row["off"] is not None]
    checked = [row for row in rows if row["check"]]
    unlike = [row for row in rows if not row["sign agrees"]]
    unexplained = sum(row["why"] == "NOT" for row in rows)
    wide, few = any(value > WITHIN for value, _ in off), len(unlike) > (1.0 - SIGNS) * len(rows) and len(rows) >= MANY
    return {
        "draws": len(rows), **{state: sum(row["verdict"] == state for row in rows) for state in STATES},
        "undecided after 0.5 s": sum(row["first verdict"] == "undecided" for row in rows),
        "repeated": sum(row["planned s"] != END for row in rows),
        "grows later": sum(row["first verdict"] in NO_GROWTH and grows(str(row["verdict"])) for row in rows),
        "same sign": len(rows) - len(unlike), "other sign by start": sum(row["why"] == "start" for row in unlike),
        "same end": sum(bool(row["agrees"]) for row in rows), "unexplained": unexplained,
        "closed": sum(closed for _, closed in off),
        "within 10 %": sum(closed and value <= WITHIN for value, closed in off),
        "opens": sum(not closed for _, closed in off),
        "opens, within 10 %": sum(not closed and value <= WITHIN for value, closed in off),
        "checked": len(checked), "converged": sum(row["check"] == "converged" for row in checked),
        "verdict": "FAIL" if unexplained or wide or few else "pass",
    }  # fmt: skip


if __name__ == "__main__":
    command_line(
        __doc__, main, count=(200, "how many draws of each set"), first=(0, "seed of the first draw"),
        fresh=(1100, "seed of the first draw that no constant was set on"),
    )  # fmt: skip
