"""Modes of real responses that others published, compared with the peaks that a person sees.

`python -m reports.verification.updating.public_sets --folder FOLDER` identifies each set whose files are in FOLDER,
with default options, and compares the modes with the peaks of data/experiments/public_sets.csv, which were read by eye.
The sets are not in this repository. The report prints the command that gets each missing one:

    git clone https://github.com/OWNER/NAME FOLDER/OWNER/NAME

A peak is sure, doubtful or a pair (one mode, marked as an unresolved pair) if such a mode lies within the reading's
`within_hz`; a sure mode has precedence over a doubtful one. Of the kinds of peaks, "peak" and "pair" are 6 dB above
their surroundings and 20 dB above the noise: they must have a mode. "other sure" counts sure modes away from all peaks,
"twice" sure modes beyond the first within one reading. Times are processor seconds of the identification.
"""

import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.identify.identification import identify
from casingfem.experiment.identify.identified import Identified
from casingfem.io.strict_csv import read
from reports.tables import DATA, OUT, Row, command_line, show, write
from reports.verification.updating.public_sets_read import (
    analyser,
    array_of_samples,
    bridge,
    columns,
    logger,
    named,
    real_and_imaginary,
    ringing,
    table_of_samples,
    tables,
    two_directions,
)

READINGS = DATA / "experiments" / "public_sets.csv"
FOLDER = OUT / "public_sets"
NEEDED = ("peak", "pair")  # kinds of peaks that must have a mode
NONE = "none stated"
GPL, BSD, MIT = "GPL 3", "BSD 3-clause", "MIT"


class PublicSet(NamedTuple):
    """A set: its name, owner/name of its repository, licence there, files (a pattern), reader, band [Hz], origin."""

    name: str
    repository: str
    licence: str
    files: str
    read: Callable[[list[Path]], FrfSet]
    band: tuple[float, float] | None = None
    computed: bool = False


def _one(reader: Callable[..., FrfSet], *args: object, **more: object) -> Callable[[list[Path]], FrfSet]:
    """A reader of the first file."""
    return lambda paths: reader(paths[0], *args, **more)


CASES = "vibrationtesting/data/case{}.mat"
PROBED = {"freq_hz": "Freq_domain", "frf": "Hf_chan_2"}
SETS = (
    PublicSet("beam", "ladisk/pyuff", MIT, "data/meas_point_?.txt", partial(columns, step=1.0), (20.0, 1000.0)),
    PublicSet("rail wheel", "Alessandra200107/Advanced_Dynamic_Project", NONE, "Assignment 1/Data.mat", _one(named)),
    PublicSet(
        "aircraft model", "VictorRenkin/MECA0062-1_vibration_testing", NONE, "data/sec_lab/DPsv*.mat",
        partial(analyser, channels=(2, 3, 4)),
    ),
    PublicSet("beam of 51 s", "alxhslm/ModeLAB", GPL, "Example/SignalCalc/*/Hxysv*.txt", tables),
    PublicSet("ruler", "torebutlin/pydvma", BSD, "data/examples/ruler_grid_acc_3.mat", _one(logger), (3.0, 600.0)),
    PublicSet("case 1", "Vibration-Testing/vibrationtesting", MIT, CASES.format(1), _one(named, **PROBED)),
    PublicSet("case 2", "Vibration-Testing/vibrationtesting", MIT, CASES.format(2), _one(named, **PROBED)),
    PublicSet(
        "three masses", "Vibration-Testing/vibrationtesting", MIT, "vibrationtesting/data/mckiddat.mat",
        _one(named, freq_hz="Freq", frf="Recep"), computed=True,
    ),
    PublicSet(
        "coarse lines", "KIT-FAST/modalAnalysis-OMA-EMA", GPL, "modalAnalysis/records/EMA_records_demo.mat",
        _one(named, freq_hz="frequencyBand", frf="FRF"),
    ),
    PublicSet(
        "machine tool", "leekunhwee/Dynamics", NONE, "Cutting/Stability/FrequencyDomain/Milling/FRF.mat",
        _one(two_directions), computed=True,
    ),
    PublicSet(
        "tool holder", "leekunhwee/Vibration-Signal-Processing", NONE, "FRFGeneration/H00.mat",
        _one(real_and_imaginary, "H00"), computed=True,
    ),
    PublicSet(
        "mast", "pyOMA-dev/pyOMA", GPL, "tests/files/measurement_1/measurement_1.npy",
        _one(array_of_samples, fs=256.0, channels=5),
    ),
    PublicSet("bridge", "ECheynet/SSICOV", BSD, "BridgeData.mat", _one(bridge), computed=True),
    PublicSet(
        "frame", "EnriqueGarMac/ModalAnalysis", NONE,
        "Class_V_Operational Modal Analysis/OMA_COV_SSI/Random_Test_200Hz.csv", _one(table_of_samples, fs=200.0),
        computed=True,
    ),
    PublicSet(
        "singing bowl", "jfisher-usgs/meditate", "CC Sampling Plus 1.0", "data-raw/bowl-struck.wav",
        _one(ringing, 18.0, (300.0, 3000.0)),
    ),
    PublicSet(
        "temple bell", "jfisher-usgs/meditate", "CC0 1.0", "data-raw/bell-kyoto.wav",
        _one(ringing, 6.0, (900.0, 2800.0)),
    ),
)  # fmt: skip


class Reading(NamedTuple):
    """A peak that a person sees: frequency [Hz], reach [Hz] of the reading, kind."""

    freq: float
    within: float
    kind: str


def readings(path: Path = READINGS) -> dict[str, list[Reading]]:
    """Peaks of each set."""
    csv = read(path)
    rows = zip(csv.cells["set"], csv.numbers("freq_hz"), csv.numbers("within_hz"), csv.cells["kind"], strict=True)
    found: dict[str, list[Reading]] = {}
    for name, freq, within, kind in rows:
        found.setdefault(name, []).append(Reading(float(freq), float(within), kind))
    return found


def outcome(found: Identified, peak: Reading) -> str:
    """Outcome of a peak: sure, pair, doubtful or missed."""
    near = np.flatnonzero(np.abs(found.freq - peak.freq) <= peak.within)
    if not len(near):
        return "missed"
    if any(k in found.unresolved and found.sure[k] for k in near.tolist()):
        return "pair"
    return "sure" if found.sure[near].any() else "doubtful"


def judged(found: Identified, peaks: Sequence[Reading]) -> tuple[Row, list[Row]]:
    """Counts over the peaks of a set, and a row for each peak."""
    ends = [outcome(found, peak) for peak in peaks]
    needed = [end for end, peak in zip(ends, peaks, strict=True) if peak.kind in NEEDED]
    far = np.array([np.abs(found.freq - peak.freq) > peak.within for peak in peaks])
    at = [int(np.sum(found.sure & ~row)) for row in far]
    counts: Row = {
        "seen": len(needed), **{word: needed.count(word) for word in ("sure", "pair", "doubtful", "missed")},
        "weaker": len(peaks) - len(needed), "with a mode": sum(end != "missed" for end in ends) - len(needed)
        + needed.count("missed"),
        "twice": sum(max(0, count - 1) for count in at), "other sure": int(np.sum(found.sure & far.all(axis=0))),
        "other doubtful": int(np.sum(~found.sure & far.all(axis=0))),
    }  # fmt: skip
    rows: list[Row] = [
        {"freq_hz": peak.freq, "kind": peak.kind, "outcome": end, "mode_hz": _nearest(found, peak)}
        for peak, end in zip(peaks, ends, strict=True)
    ]
    return counts, rows


def _nearest(found: Identified, peak: Reading) -> float | None:
    """Frequency of the mode at a peak: the nearest sure one, or the nearest doubtful one."""
    near = np.flatnonzero(np.abs(found.freq - peak.freq) <= peak.within)
    best = near[found.sure[near]] if found.sure[near].any() else near
    return float(min(found.freq[best], key=lambda freq: abs(freq - peak.freq))) if len(best) else None


def run(each: PublicSet, folder: Path, peaks: Sequence[Reading]) -> tuple[Row, list[Row]] | None:
    """The rows of a set; None where its files are missing."""
    paths = sorted((folder / each.repository).glob(each.files))
    if not paths:
        return None
    data = each.read(paths)
    started = time.process_time()
    found = identify(data, band=each.band)
    seconds = time.process_time() - started
    counts, rows = judged(found, peaks)
    size = f"{len(data)} x {len(data.x)} {'lines' if data.kind == 'frf' else 'samples'}"
    about = {"set": each.name, "origin": "computed" if each.computed else "measured", "channels": size}
    return {**about, **counts, "seconds": round(seconds, 1)}, [{"set": each.name, **row} for row in rows]


def main(out: Path, quick: bool = False, folder: Path = FOLDER) -> list[Row]:
    """Identify the sets that are in the folder and compare; returns a row for each set. `quick` takes two sets."""
    seen = readings()
    done, peaks, missing = list[Row](), list[Row](), list[PublicSet]()
    for each in SETS[:2] if quick else SETS:
        ended = run(each, folder, seen[each.name])
        if ended is None:
            missing.append(each)
            continue
        done.append(ended[0])
        peaks += ended[1]
        print(f"{each.name}: {ended[0]['missed']} of {ended[0]['seen']} peaks missed", flush=True)
    if done:
        show("Public sets: peaks that a person sees, and modes", done)
        show("Each peak", peaks)
        write(out / "public_sets.csv", done)
        write(out / "public_sets_peaks.csv", peaks)
    for each in missing:
        address = f"https://github.com/{each.repository}"
        print(f"{each.name} (licence: {each.licence}) is missing: git clone {address} '{folder / each.repository}'")
    return done


if __name__ == "__main__":
    command_line(__doc__, main, folder=(FOLDER, "folder with clones of the repositories, as FOLDER/OWNER/NAME"))
