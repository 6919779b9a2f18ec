"""Waiting times: each command on shipped inputs and on six ordinary ones, with and without machine code.

`python -m reports.benchmarks.waiting [--quick] [--out DIR] [--beside CHECKOUT] [--only WORD]`. Processor seconds (user
and system, children included) and seconds by the clock of the whole command as a user types it: "first" with an empty
cache of machine code, "next" with a full one, the least of `ROUNDS` runs. A checkout beside is run in turns with this
one, by the same Python; "ratio" is this one's over that one's next run. Inputs that a command needs are made before and
not counted. Responses are SYNTHETIC.
"""

import shutil
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import casingfem as cf
from casingfem.examples import examples
from reports.benchmarks.first_use import CACHE, spent
from reports.tables import ROOT, Row, command_line, show, write
from reports.verification.rubs.beside import WALL

ROUNDS = 2
QUICK = ("rods", "rods, files")
REST = ("", "commands with one of these words in their name, between commas")
SEED = 12301
BOLTED = (
    "# titanium, cylinder, cone and flange, bolted at its base\n"
    + WALL
    + """[support.base]
kind = "bolts"
count = 36
k = 1e8
k_rot = 1e4
[modes]
count = 30
"""
)
LOOSE = BOLTED.replace("k_rot = 1e4\n", "k_rot = 1e4\nloose = [{bolt = 3, factor = 0.3}, {bolt = 4, factor = 0.1}]\n")
ORBITS = """[scene]
kind = "patch"
[body]
omega = [1.0, 2.6]
zeta = [0.01, 0.01]
channels = ["x"]
rows = [[1.0, 0.8]]
[[contact]]
normal = "x"
clearance = 1.0
stiffness = 20.0
[drive]
channel = "x"
amplitude = 0.1
from_hz = 0.10
to_hz = 0.50
"""


@dataclass(frozen=True, slots=True)
class Wait:
    """One command to time: how its input is made in a folder, and an example that it needs."""

    name: str
    command: str
    example: str = ""
    make: Callable[[Path], None] | None = None


def responses(sensors: int, count: int) -> Callable[[Path], None]:
    """A maker of frfs.npz: accelerance of ten pairs around a rim, so many sensors, lines, noise 40 dB below."""

    def made(folder: Path) -> None:
        rng = np.random.default_rng(SEED)
        at = 2.0 * np.pi * np.arange(sensors) / sensors
        freq = np.repeat(300.0 * np.cumprod(1.0 + rng.uniform(0.05, 0.15, 10)), 2) * (1.0 + np.tile([0.0, 4e-3], 10))
        n = np.repeat(rng.integers(2, 10, 10), 2)
        turn = np.repeat(rng.uniform(0.0, 2.0 * np.pi, 10), 2) + np.tile([0.0, 0.5 * np.pi], 10)
        shapes, driven = np.cos(np.outer(n, at) - turn[:, None]), np.cos(n * 0.3 - turn)
        w, own = 2.0 * np.pi * np.linspace(0.97 * freq[0], 1.03 * freq[-1], count), 2.0 * np.pi * freq[:, None]
        H = (shapes * driven[:, None]).T @ (-(w**2) / (own**2 - w**2 + 2e-3j * own * w))
        noise = rng.standard_normal((2, sensors, count)) * 1e-2 * np.sqrt(0.5 * np.mean(np.abs(H) ** 2))
        points = np.arange(1, sensors + 1)
        cf.frf.FrfSet.from_arrays(
            kind="frf", x=w / (2.0 * np.pi), responses=H + noise[0] + 1j * noise[1], unit="(m/s^2)/N",
            response_point=points, response_direction=np.ones_like(points),
            reference_point=np.full_like(points, sensors + 1), reference_direction=np.ones_like(points),
        ).save(folder / "frfs.npz")  # fmt: skip

    return made


def plate(folder: Path) -> None:
    """A steel plate of 20 x 20 x 3 eight-node bricks as an Abaqus file, and its study."""
    n, t = 20, 3
    x, y, z = (a.ravel() for a in np.meshgrid(np.arange(n + 1), np.arange(n + 1), np.arange(t + 1), indexing="ij"))
    number = np.arange(x.size).reshape(n + 1, n + 1, t + 1) + 1
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = np.stack([number[i : i + n, j : j + n, k : k + t].ravel() for i, j, k in corners], axis=1)
    nodes = [
        f"{k + 1}, {0.01 * a:g}, {0.01 * b:g}, {2e-3 * c:g}" for k, (a, b, c) in enumerate(zip(x, y, z, strict=True))
    ]
    lines = ["*NODE", *nodes, "*ELEMENT, TYPE=C3D8I, ELSET=PLATE"]
    lines += [", ".join(map(str, (k + 1, *cell))) for k, cell in enumerate(cells.tolist())]
    (folder / "plate.inp").write_text("\n".join(lines) + "\n", encoding="utf-8")
    study = '[material]\nE = 210e9\nnu = 0.3\nrho = 7800.0\n[solid]\nmesh = "plate.inp"\n'
    (folder / "plate.toml").write_text(study + "[modes]\ncount = 20\n", encoding="utf-8")


def text_of(name: str, text: str) -> Callable[[Path], None]:
    """A maker of one file."""

    def made(folder: Path) -> None:
        (folder / name).write_text(text, encoding="utf-8")

    return made


def rods(folder: Path) -> None:
    """The sweep of two rods that is shipped, over 1,000 speeds."""
    text = (ROOT / "data" / "scenes" / "two_rods_sweep.toml").read_text(encoding="utf-8")
    head = text[: text.index("[[sweep.vary]]")]
    vary = '[[sweep.vary]]\nkey = "rod[1].velocity"\nfrom = 4.0\nto = 6.4\nsteps = 1000\n'
    (folder / "thousand.toml").write_text(head + vary, encoding="utf-8")


WAITS = (
    Wait("modes, frustum", "casingfem modes data/studies/frustum.toml --json", "frustum"),
    Wait("modes, bolted ring", "casingfem modes data/studies/bolted_ring.toml --json", "bolted_ring"),
    Wait("modes, bolted casing", "casingfem modes bolted.toml --json", make=text_of("bolted.toml", BOLTED)),
    Wait("modes, two loose bolts", "casingfem modes bolted.toml --json", make=text_of("bolted.toml", LOOSE)),
    Wait("modes, solid", "casingfem modes plate.toml --json", make=plate),
    Wait("mistune, 40 draws", "casingfem mistune data/studies/mistuning.toml --draws 40 --json", "mistuning"),
    Wait("update", "casingfem update data/studies/rig_casing.toml --json", "rig_casing"),
    Wait("report", "casingfem report data/studies/rig_casing.toml --out page", "rig_casing"),
    Wait("rig", "casingfem rig data/studies/rig_test.toml --out test", "rig_test"),
    Wait("identify, 16 x 1000", "casingfem identify frfs.npz --json", make=responses(16, 1000)),
    Wait("identify, 120 x 15000", "casingfem identify frfs.npz --json", make=responses(120, 15_000)),
    Wait("first rub", "casingfem rub data/scenes/first_rub.toml --json", "first_rub"),
    Wait("first rub, files", "casingfem rub data/scenes/first_rub.toml --out run", "first_rub"),
    Wait("disk", "casingfem rub data/scenes/bladed_disk.toml --json", "bladed_disk"),
    Wait("rods", "casingfem contact data/scenes/two_rods.toml --json", "two_rods"),
    Wait("rods, files", "casingfem contact data/scenes/two_rods.toml --out run", "two_rods"),
    Wait("sweep, 1000 runs", "casingfem sweep thousand.toml --out rows", make=rods),
    Wait("cycles, two modes", "casingfem cycles orbits.toml --json", make=text_of("orbits.toml", ORBITS)),
)


def prepared(wait: Wait, folder: Path, checkout: Path) -> None:
    """The input of a command, made in `folder`."""
    folder.mkdir(parents=True)
    if wait.make is not None:
        wait.make(folder)
    if wait.example:
        spent(f"casingfem example {wait.example}", folder, checkout)
        for command in examples()[wait.example].commands(Path("data"))[:-1]:
            spent(command, folder, checkout)


def row_of(wait: Wait, folder: Path, checkouts: Sequence[Path]) -> Row:
    """First and next run by this checkout, and by the other one; a failure is stated in the row."""
    row: Row = {"command": wait.name}
    least = np.full((len(checkouts), 4), np.inf)
    failed = ""
    folders = [folder / str(k) for k in range(len(checkouts))]
    try:
        for place, checkout in zip(folders, checkouts, strict=True):
            prepared(wait, place, checkout)
        for _ in range(ROUNDS):
            for k, (place, checkout) in enumerate(zip(folders, checkouts, strict=True)):
                shutil.rmtree(place / CACHE, ignore_errors=True)
                first, following = spent(wait.command, place, checkout), spent(wait.command, place, checkout)
                least[k] = np.minimum(least[k], [*first, *following])
    except RuntimeError as error:
        failed = str(error)
    for k, found in enumerate(least.tolist()):
        name = ", beside" if k else ""
        names = (f"first{name} [s]", f"first{name}, clock [s]", f"next{name} [s]", f"next{name}, clock [s]")
        row |= {key: value if np.isfinite(value) else None for key, value in zip(names, found, strict=True)}
    if len(checkouts) > 1:
        row["ratio"] = float(least[0, 2] / least[1, 2]) if np.isfinite(least[:, 2]).all() else None
    return row | {"failed": failed or None}


def main(out: Path, quick: bool = False, beside: Path = ROOT, only: str = "") -> list[Row]:
    """Print each row as it comes, and the table; returns its rows."""
    checkouts = tuple(dict.fromkeys((ROOT, beside.resolve())))
    waits = [
        wait for wait in WAITS if (wait.name in QUICK if quick else any(word in wait.name for word in only.split(",")))
    ]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for k, wait in enumerate(waits):
            row = row_of(wait, Path(folder) / str(k), checkouts)
            rows.append(row)
            words = (f"{name} {value:.3g}" for name, value in row.items() if isinstance(value, float))
            print(wait.name, *words, row["failed"] or "", flush=True)
    show("Processor seconds, and seconds by the clock, of what a person waits for", rows)
    write(out / "waiting.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(
        __doc__,
        main,
        beside=(ROOT, "checkout to run in turns with this one"),
        only=REST,
    )
