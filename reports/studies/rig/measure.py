"""The virtual test rig, from the bench to the updated model: measurement, identification, scans and predictions.

`python -m reports.studies.rig.measure [--quick] [--out DIR]`. Everything it measures is SYNTHETIC: a casing on a steel
ring with loose bolts, with a finer mesh, true radius and spread damping, and a blade; the updater has neither model.
"""

import time
from pathlib import Path

import numpy as np

import casingfem as cf
from casingfem.experiment.rig.files import rig_angles, write_rig_uff
from casingfem.plot.experiment import figure_deflections, figure_responses, figure_scan
from casingfem.plot.style import png
from casingfem.study.rig import RigTest
from contact.io.outfiles import write_atomic
from reports.studies.rig.bench import BLADE_MODES, ORDERS, SEED, blade_test, casing_test, pair_from_scan, scan_at
from reports.studies.rig.predict import blade_model, casing_models, predict, rms, with_repeatability
from reports.tables import Row, command_line, show, write

USED = (5, 7, 9, 11, 13)  # nodal diameters that an update sees; it predicts the others
BLADE_USED = 5  # lowest modes of the blade that an update sees
SNR = (40.0, 20.0, 0.0)  # dB over the whole band of a scan
DRAWS = 20


def agreement(test: RigTest) -> Row:
    """Responses from time records against the rig's own responses, which are exact for its modes."""
    assert test.frfs is not None
    layout = test.layout
    exact = test.rig.frfs(test.frfs.x, sensors=layout.sensors, drives=layout.drives, quantity="mobility").responses
    error = np.linalg.norm(test.frfs.responses - exact, axis=1) / np.linalg.norm(exact, axis=1)
    return {"channels": len(error), "lines": len(test.frfs.x), "median error %": 100.0 * float(np.median(error)),
            "worst %": 100.0 * float(error.max())}  # fmt: skip


def nearest(truth: cf.FrequencyTable, freq: float) -> int:
    """The true row that is nearest to a frequency."""
    return int(np.abs(truth.freq_hz - freq).argmin())


def turn(angle: float, other: float, n: int) -> float:
    """Difference of two antinodes [deg], at most 90/n."""
    period = 180.0 / n
    return abs((angle - other + period / 2.0) % period - period / 2.0)


def identified(found: cf.Identified, truth: cf.FrequencyTable) -> tuple[list[Row], Row]:
    """Identified modes against the truth, mode by mode, and a summary in one line."""
    rows: list[Row] = []
    for k, freq in enumerate(found.freq.tolist()):
        at = nearest(truth, freq)
        n = int(truth.n[at])
        rows.append(
            {
                "true Hz": float(truth.freq_hz[at]),
                "found Hz": freq,
                "error %": 100.0 * (freq / float(truth.freq_hz[at]) - 1.0),
                "n true": n if n >= 0 else None,
                "n": int(found.n[k]) if n >= 0 else None,
                "angle error deg": turn(float(found.angle_deg[k]), float(truth.angle_deg[at]), n) if n > 0 else None,
                "zeta error %": 100.0 * float(found.zeta[k] / truth.zeta[at] - 1.0),
            }
        )
    low, high = found.lines[[0, -1]].tolist()
    there = int(np.sum((truth.freq_hz > low) & (truth.freq_hz < high)))
    found_of = {float(str(row["true Hz"])) for row in rows}
    angles = [float(str(row["angle error deg"])) for row in rows if row["angle error deg"] is not None]
    return rows, {
        "modes in band": there,
        "found": len(found_of),
        "spurious": len(rows) - len(found_of),
        "wrong n": sum(row["n"] != row["n true"] for row in rows),
        "largest error %": max(abs(float(str(row["error %"]))) for row in rows),
        "largest angle error deg": max(angles) if angles else None,
        "largest zeta error %": max(abs(float(str(row["zeta error %"]))) for row in rows),
    }


def scan_accuracy(test: RigTest, quick: bool) -> list[Row]:
    """Orientation, amplitude and travelling part of the strongest wave at each tone, over draws of the noise."""
    pairs = (7, 8, 6)
    tones = [round(float(test.truth.freq_hz[test.truth.n == n][:2].mean()), 3) for n in pairs]
    rows: list[Row] = []
    for snr in SNR:
        off: dict[str, list[float]] = {"angle": [], "sigma": [], "amplitude": [], "travel": [], "rate": []}
        for draw in range(2 if quick else DRAWS):
            made = scan_at(test, snr, sorted(tones), seed=SEED + draw)
            found = cf.circle.demodulate(made.record, ORDERS)
            clean = cf.circle.CircleScan(tones=found.tones, n=made.n, V=made.V, sigma=np.ones(made.V.shape),
                                  floor=np.ones(made.V.shape), rate=found.rate, left=1.0)  # fmt: skip
            for tone, n in enumerate(n for _, n in sorted(zip(tones, pairs, strict=True))):
                got, true = found.wave(tone, n), clean.wave(tone, n)
                error = turn(got.angle_deg, true.angle_deg, n)
                off["angle"].append(error)
                off["sigma"].append(got.angle_sigma_deg)
                off["rate"].append(error / got.angle_sigma_deg)
                off["amplitude"].append(100.0 * (got.amplitude / true.amplitude - 1.0))
                off["travel"].append(got.travelling - true.travelling)
        rows.append(
            {
                "SNR dB": snr,
                "waves": len(off["angle"]),
                "angle rms deg": rms(off["angle"]),
                "sigma said deg": rms(off["sigma"]),
                "error/sigma rms": rms(off["rate"]),
                "amplitude rms %": rms(off["amplitude"]),
                "travelling rms": rms(off["travel"]),
            }
        )
    return rows


def pairs_by_scan(test: RigTest, quick: bool) -> list[Row]:
    """Close pairs, both members excited: one scan at 13 tones, 30 dB."""
    rows: list[Row] = []
    for n in (8,) if quick else (8, 7, 6):
        at = np.flatnonzero(test.truth.n == n)[:2]
        pair = pair_from_scan(test, n, 30.0)
        freq, zeta = test.truth.freq_hz[at], test.truth.zeta[at]
        rows.append(
            {
                "n": n,
                "true split Hz": float(np.ptp(freq)),
                "found split Hz": pair.split,
                "+- Hz": pair.split_sigma,
                "in bandwidths": float(np.ptp(freq) / (2.0 * np.mean(zeta * freq))),
                "angle errors deg": max(
                    turn(float(a), float(b), n) for a, b in zip(pair.angle_deg, test.truth.angle_deg[at], strict=True)
                ),
                "zeta errors %": 100.0 * float(np.abs(pair.zeta / zeta - 1.0).max()),
            }
        )
    return rows


def marked(rows: list[Row]) -> list[Row]:
    """Rows with a column for their origin."""
    return [{"data": "SYNTHETIC", **row} for row in rows]


def pictures(out: Path, test: RigTest, found: cf.Identified) -> None:
    """Responses with identified lines, the scan's spectrum and its deflections."""
    assert test.frfs is not None
    assert test.scan is not None
    assert test.waves is not None
    firsts = np.r_[True, np.diff(found.n) != 0].tolist()
    labels = [f"n={n}" if first else "" for n, first in zip(found.n.tolist(), firsts, strict=True)]
    responses = figure_responses(test.frfs, marks=found.freq, labels=labels, coherence=test.coherence)
    figures = {
        "rig_measure_responses.png": responses,
        "rig_measure_scan.png": figure_scan(test.scan.record, test.waves),
        "rig_measure_deflections.png": figure_deflections(
            test.waves, [(tone, abs(int(test.waves.n[np.abs(V).argmax()]))) for tone, V in enumerate(test.waves.V)]
        ),
    }
    for name, figure in figures.items():
        write_atomic(out / name, png(figure))


def blade_chain() -> tuple[list[Row], Row, Row]:
    """The blade: hammer, identification, update on its lowest modes; predictions, identification, summary."""
    blade = blade_test()
    found = cf.identify(blade.frfs)
    rows, test = identified(found, blade.truth)
    show("Blade: identified from a hammer test against true", rows)
    show("Blade: identification in one line", [test])
    start, vary = blade_model()
    used = np.arange(len(found.freq)) < BLADE_USED
    rows, summary, fit = predict("blade", start, vary, with_repeatability(found), used, BLADE_MODES)
    print(f"\nblade\n{fit}")
    return rows, test, summary


def main(out: Path, quick: bool = False) -> dict[str, Row]:
    """Run the chain; returns the summaries."""
    started = time.perf_counter()
    out.mkdir(parents=True, exist_ok=True)
    print("SYNTHETIC: every measurement below is made by a model that the updater does not have")
    test = casing_test(quick)
    assert test.frfs is not None
    write_rig_uff(out / "rig_measure_casing.uff", test.rig, [test.frfs])
    summaries: dict[str, Row] = {"records": agreement(test)}
    show("Casing: responses from burst-random records (40 dB, 16 bits, H1) against the modes'", [summaries["records"]])

    found = cf.identify(test.frfs, angles=rig_angles(test.rig))
    rows, summaries["casing"] = identified(found, test.truth)
    show("Casing: identified against true", rows)
    show("Casing: identification in one line", [summaries["casing"]])
    write(out / "rig_measure_identified.csv", marked(rows))

    accuracy = scan_accuracy(test, quick)
    show(
        "Circle scan: three pairs driven at once, between their members, for 20 s; over draws of the noise",
        accuracy,
    )
    summaries |= {f"scan {row['SNR dB']:g} dB": row for row in accuracy}
    pairs = pairs_by_scan(test, quick)
    show("Circle scan: close pairs, both members excited by 13 tones, 30 dB", pairs)
    pictures(out, test, found)

    table = with_repeatability(found)
    table.to_csv(out / "rig_measure_casing.csv")
    predicted: list[Row] = []
    for name, (start, vary) in casing_models(quick).items():
        rows, summaries[name], fit = predict(name, start, vary, table, np.isin(table.n, USED), 30)
        print(f"\n{name}\n{fit}")
        predicted += rows

    if not quick:
        rows, summaries["blade test"], summaries["blade"] = blade_chain()
        predicted += rows
    show("Frequencies that were not used, in sigma of the test (0.04 %)", predicted)
    short = [row for row in summaries.values() if "unseen" in row]
    show("The same in one line each", short)
    write(out / "rig_measure_summary.csv", marked(short))
    write(out / "rig_measure.csv", marked(predicted))
    print(f"\n{time.perf_counter() - started:.0f} s")
    return summaries


if __name__ == "__main__":
    command_line(__doc__, main)
