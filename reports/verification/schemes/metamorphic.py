"""Related contact problems must have related solutions: random patches and rims, each with exact relations.

`python -m reports.verification.schemes.metamorphic [--count 400] [--first 0] [--quick] [--out DIR]` runs a random
problem and its variants: in other units (powers of two: equal to the last bit), with modes of the opposite sign, with
its contacts in another order, mirrored, with an additional distant contact, with every contact split into two of half
the stiffness, over a shorter time, and started earlier by some steps without contact. Forces of redundant contacts
without compliance are not unique: the motion and the total impulse are compared.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import contact as ct
from casingfem.io.arrays import FloatArray
from contact.model.bodies.channels import rim_channels
from reports.tables import Row, command_line, show, write

EXACT, CLOSE = 0.0, 1e-9  # of the largest value; CLOSE leaves room for round-off that impacts amplify
STEPS, DT = 300, 1e-4
N_MAX = 3
LENGTH, TIME, ROOT_MASS = 2.0**-7, 2.0**5, 2.0**4  # new units of m, s and sqrt(kg)
EARLIER = 20  # steps without contact


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Numbers:
    """A patch as plain arrays: k contacts of d directions, normal first."""

    omega: FloatArray
    zeta: FloatArray
    rows: FloatArray  # (k, d, m)
    S: FloatArray  # (k, d, k, d)
    clearance: FloatArray  # (k,)
    slide: FloatArray  # (k, d - 1)
    velocity: FloatArray
    load: FloatArray
    mu: float
    dt: float
    steps: int = STEPS

    @property
    def unique(self) -> bool:
        """Whether each contact has its own compliance, so that its force is determined."""
        return bool(self.S.any())

    def run(self) -> ct.Result:
        """Result of a run with every step stored."""
        k, d, m = self.rows.shape
        names = tuple(f"c{i}.{j}" for i in range(k) for j in range(d))
        body = ct.ModalBody(
            omega=self.omega, zeta=self.zeta, channels=names, rows=self.rows.reshape(-1, m),
            S=self.S.reshape(k * d, k * d),
        )  # fmt: skip
        pairs = tuple(names[i * d + 1 : (i + 1) * d] for i in range(k)) if d > 1 else ()
        patch = ct.Patch(
            body=body, normal=names[::d], tangent=pairs, clearance=self.clearance, velocity=self.velocity,
            load=self.load, slide=self.slide if d > 1 else 0.0,
        )  # fmt: skip
        return ct.run(
            patch, law=ct.Coulomb(mu=self.mu) if self.mu else ct.Unilateral(), t_end=self.steps * self.dt, dt=self.dt,
            record=ct.Record(state_every=1),
        )  # fmt: skip


def random_patch(seed: int) -> Numbers:
    """A body of one rigid and up to five elastic modes, thrown at one to 72 contacts."""
    rng = np.random.default_rng(seed)
    d, k, m = int(rng.integers(1, 4)), int(rng.integers(1, 13)), int(rng.integers(2, 7))
    k = min(k, 4) if d > 1 else 6 * k if seed % 5 == 0 else k
    rows = 0.3 * rng.standard_normal((k, d, m))
    rows[:, 0, 0] = 1.0
    S = np.zeros((k * d, k * d))
    kind = seed % 3 if d == 1 else 1 + seed % 2
    if kind > 0:
        S = np.diag(10.0 ** rng.uniform(-7.0, -5.0, k * d))
    if kind == 2:
        mixing = 1e-3 * rng.standard_normal((k * d, k * d))
        S = S + mixing @ mixing.T
    return Numbers(
        omega=np.r_[0.0, np.sort(rng.uniform(200.0, 3000.0, m - 1))], zeta=np.r_[0.0, rng.uniform(0.0, 0.02, m - 1)],
        rows=rows, S=S.reshape(k, d, k, d), clearance=rng.uniform(0.0, 5e-4, k),
        slide=rng.uniform(-1.0, 1.0, (k, max(d - 1, 1)))[:, : d - 1],
        velocity=np.r_[-rng.uniform(0.1, 1.0), np.zeros(m - 1)],
        load=np.r_[-rng.uniform(0.0, 20.0), np.zeros(m - 1)], mu=0.3 if d > 1 else 0.0, dt=DT,
    )  # fmt: skip


def gone(one: FloatArray, other: FloatArray) -> float:
    """Largest difference relative to the largest value of the first."""
    if one.shape != other.shape:
        return np.inf
    scale = float(np.abs(one).max(initial=0.0))
    return float(np.abs(one - other).max(initial=0.0)) / scale if scale > 0.0 else float(np.abs(other).max(initial=0.0))


def units(p: Numbers, a: ct.Result) -> float:
    """Other units of length, time and mass."""
    speed, force = LENGTH / TIME, ROOT_MASS**2 * LENGTH / TIME**2
    modal = LENGTH * ROOT_MASS
    b = replace(
        p, omega=p.omega / TIME, rows=p.rows / ROOT_MASS, S=p.S * (LENGTH / force), clearance=p.clearance * LENGTH,
        slide=p.slide * speed, velocity=p.velocity * modal / TIME, load=p.load * modal / TIME**2, dt=p.dt * TIME,
    ).run()  # fmt: skip
    return max(gone(a.gap, b.gap / LENGTH), gone(a.force, b.force / force), gone(a.state, b.state / modal))


def signs(p: Numbers, a: ct.Result) -> float:
    """Every second mode with the opposite sign."""
    sign = np.where(np.arange(p.omega.size) % 2, -1.0, 1.0)
    b = replace(p, rows=p.rows * sign, velocity=p.velocity * sign, load=p.load * sign).run()
    return max(gone(a.state, b.state * sign), gone(a.force, b.force) if p.unique else 0.0)


def order(p: Numbers, a: ct.Result) -> float:
    """Contacts from the last to the first."""
    b = replace(
        p, rows=p.rows[::-1], S=p.S[::-1, :, ::-1], clearance=p.clearance[::-1], slide=p.slide[::-1]
    ).run()  # fmt: skip
    return max(gone(a.state, b.state), gone(a.force, b.force[:, ::-1]) if p.unique else 0.0)


def mirrored(p: Numbers, a: ct.Result) -> float:
    """The first tangent with the opposite sign."""
    if p.rows.shape[1] == 1:
        return 0.0
    sign = np.where(np.arange(p.rows.shape[1]) == 1, -1.0, 1.0)
    b = replace(
        p, rows=p.rows * sign[:, None], S=p.S * sign[:, None, None] * sign, slide=p.slide * sign[1:]
    ).run()  # fmt: skip
    return max(gone(a.state, b.state), gone(a.force, b.force))


def far(p: Numbers, a: ct.Result) -> float:
    """A contact 1 km away is added."""
    k, d, m = p.rows.shape
    S = np.zeros((k + 1, d, k + 1, d))
    S[:k, :, :k] = p.S
    if p.unique:
        S[k, :, k] = 1e-6 * np.eye(d)
    b = replace(
        p, rows=np.concatenate([p.rows, np.ones((1, d, m))]), S=S, clearance=np.r_[p.clearance, 1e3],
        slide=np.concatenate([p.slide, np.zeros((1, d - 1))]),
    ).run()  # fmt: skip
    return max(gone(a.state, b.state), gone(a.force, b.force[:, :k]) if p.unique else 0.0)


def split(p: Numbers, a: ct.Result) -> float:
    """Every contact becomes two at the same point with twice its compliance: each has half of the force."""
    k, d, _ = p.rows.shape
    own = np.einsum("idid->id", p.S)
    if not p.unique or np.any(p.S.reshape(k * d, -1) - np.diag(own.ravel())):
        return 0.0
    S = np.diag(2.0 * np.concatenate([own, own]).ravel()).reshape(2 * k, d, 2 * k, d)
    b = replace(
        p, rows=np.concatenate([p.rows, p.rows]), S=S, clearance=np.r_[p.clearance, p.clearance],
        slide=np.concatenate([p.slide, p.slide]),
    ).run()  # fmt: skip
    return max(gone(a.state, b.state), gone(a.force, b.force[:, :k] + b.force[:, k:]))


def shorter(p: Numbers, a: ct.Result) -> float:
    """Half of the steps: the first half of the run."""
    half = p.steps // 2
    b = replace(p, steps=half).run()
    return max(gone(a.state[:half], b.state), gone(a.force[:half], b.force))


RELATIONS: dict[str, tuple[Callable[[Numbers, ct.Result], float], float]] = {
    "other units": (units, EXACT), "opposite modes": (signs, EXACT), "contacts reordered": (order, CLOSE),
    "mirror": (mirrored, EXACT), "far contact": (far, CLOSE), "split contacts": (split, CLOSE),
    "half of the time": (shorter, EXACT),
}  # fmt: skip


def rim_scene(seed: int, *, mirror: bool = False, earlier: int = 0) -> ct.Scene:
    """A random rim that first touches its blade after some time; `mirror`: with the opposite sense of rotation."""
    rng, sign = np.random.default_rng(seed), -1.0 if mirror else 1.0
    size, modes = 2 * N_MAX + 1, int(rng.integers(2, 7))
    rows, mixing = rng.standard_normal((2 * size, modes)), 1e-4 * rng.standard_normal((2 * size, 2 * size))
    across = np.where(np.arange(size) > N_MAX, sign, 1.0)  # radial: sines
    turn = np.concatenate([across, sign * across])
    casing = ct.ModalBody(
        omega=np.sort(rng.uniform(500.0, 5000.0, modes)), zeta=rng.uniform(0.0, 0.02, modes),
        channels=rim_channels(N_MAX), rows=rows * turn[:, None], S=(mixing @ mixing.T) * turn * turn[:, None],
        kind="rim", n_max=N_MAX, radius=0.4,
    )  # fmt: skip
    flap = np.array([1.0, sign])
    tip = ct.ModalBody(
        omega=np.sort(rng.uniform(500.0, 5000.0, 2)), zeta=np.full(2, 0.002), channels=("span", "flap"),
        rows=rng.standard_normal((2, 2)) * flap[:, None], S=1e-8 * np.array([[1.0, 0.2 * sign], [0.2 * sign, 2.0]]),
    )  # fmt: skip
    hz, dt, mu = float(rng.uniform(5.0, 30.0)), 2e-5, float(rng.choice([0.0, 0.1]))
    angle = float(rng.uniform(47.0, 50.0)) - 360.0 * hz * dt * earlier
    lean = float(rng.uniform(0.0, 20.0))
    rim = ct.RotatingRim(
        casing, tip, clearance=5e-5, speed_hz=-hz * sign, lean_deg=sign * lean,
        angle_deg=sign * angle,
        out_of_roundness=[{"p": 2, "cos": 2e-4}, {"p": 3, "sin": 1e-5 * sign}],
    )  # fmt: skip
    return ct.Scene(
        what=rim, law=ct.Coulomb(mu=mu) if mu else ct.Unilateral(), t_end=(500 + earlier) * dt, dt=dt,
        record=ct.Record(state_every=1),
    )  # fmt: skip


def rim_rows(seed: int) -> list[Row]:
    """A rim compared with its mirror image, and with itself started earlier."""
    one, image, late = (ct.run(rim_scene(seed, **more)) for more in ({}, {"mirror": True}, {"earlier": EARLIER}))
    touches = bool(one.contact_steps.any())
    reflected = max(gone(one.force, image.force), gone(one.state, image.state))
    shifted = max(gone(one.force, late.force[EARLIER:]), gone(one.state, late.state[EARLIER:]))
    return [
        {"problem": seed, "relation": "rim in a mirror", "touches": touches, "found": reflected,
         "allowed": CLOSE},
        {"problem": seed, "relation": "rim started earlier", "touches": touches, "found": shifted, "allowed": CLOSE},
    ]  # fmt: skip


def patch_rows(seed: int) -> list[Row]:
    """A patch compared with its variants."""
    p = random_patch(seed)
    a = p.run()
    touches = bool(a.contact_steps.any())
    return [
        {"problem": seed, "relation": name, "touches": touches, "found": related(p, a), "allowed": allowed}
        for name, (related, allowed) in RELATIONS.items()
    ]


def main(out: Path, quick: bool = False, count: int = 400, first: int = 0) -> list[Row]:
    """Print the largest difference of each relation; write a row for each problem and relation."""
    rows: list[Row] = []
    began = time.process_time()
    for seed in range(first, first + (min(count, 12) if quick else count)):
        try:
            rows += rim_rows(seed) if seed % 4 == 3 else patch_rows(seed)
        except (ct.InputError, ct.NumericsError) as error:
            rows.append({"problem": seed, "relation": "all run", "touches": True, "found": np.inf, "allowed": 0.0})
            print(f"problem {seed}: {error}")
    table: list[Row] = []
    for name in dict.fromkeys(str(row["relation"]) for row in rows):
        mine = [row for row in rows if row["relation"] == name]
        found = np.array([float(str(row["found"])) for row in mine])
        allowed = float(str(mine[0]["allowed"]))
        for row in mine:
            if not float(str(row["found"])) <= allowed:
                print(f"differs: {row}")
        table.append({
            "relation": name, "problems": len(mine), "with contact": sum(bool(row["touches"]) for row in mine),
            "largest difference": float(found.max()), "allowed": allowed, "failed": int(np.sum(~(found <= allowed))),
        })  # fmt: skip
    show(f"Relations between random contact problems, in {time.process_time() - began:.0f} s", table)
    write(out / "metamorphic.csv", rows)
    return table


if __name__ == "__main__":
    command_line(__doc__, main, count=(400, "how many problems"), first=(0, "seed of the first"))
