"""Outliers of surveys: a plain fit warns of them by default, and clean surveys give no alarm.

`python -m reports.verification.robustness.stray_points [--quick] [--out DIR]`. SYNTHETIC surveys of a cone with
harmonics 2 to 20 of a random field and a taper, 3 heights of 120 points, noise of 20 um, fitted by default. In one half
of them 1 to 5 points are off by 0.2 to 1 mm, anywhere. Named: all of them. Further points of these surveys, and points
of the clean ones, are false alarms. Two passes: each place measured twice, the second time 0.1 mm larger, or turned by
2 deg.
"""

import warnings
from pathlib import Path

import numpy as np

import casingfem as cf
from casingfem.io.arrays import FloatArray
from reports.tables import Row, command_line, show, write

DRAWS, QUICK = 200, 5
NOISE, SMALLEST, LARGEST, MOST = 2e-5, 2e-4, 1e-3, 5
HEIGHTS = (0.0, 0.125, 0.25)
Survey = tuple[FloatArray, FloatArray, FloatArray]


def survey(rng: np.random.Generator, turned_deg: float = 0.0, passes: int = 1) -> Survey:
    """The plain fit, and the points named in its warnings."""
    theta, z = (part.ravel() for part in np.meshgrid(2.0 * np.pi * np.arange(120) / 120, HEIGHTS))
    p = np.arange(2, 21)
    a, b = rng.normal(size=(2, p.size)) * 1e-3 / p

    def radius(at: FloatArray) -> FloatArray:
        defect = np.cos(at[:, None] * p) @ a + np.sin(at[:, None] * p) @ b
        return np.asarray((0.5 - 0.2 * z) * (1.0 + defect))

    values = [radius(theta + np.radians(turned_deg) * k) + NOISE * rng.standard_normal(z.size) for k in range(passes)]
    return np.tile(theta, passes), np.tile(z, passes), np.concatenate(values)


def warned(points: Survey) -> tuple[cf.SurveyField, list[str]]:
    """The plain fit and what it warns of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = cf.SurveyField.from_points(*points)
    return found, [str(entry.message) for entry in caught]


def strays(seed: int, count: int) -> tuple[int, int]:
    """Numbers of outliers that were named, and of other points that were named."""
    rng = np.random.default_rng([20262, seed])
    theta, z, value = survey(rng)
    wrong = rng.choice(z.size, count, replace=False)
    value[wrong] += rng.choice([-1.0, 1.0], count) * rng.uniform(SMALLEST, LARGEST, count)
    named = {(round(t, 6), z) for t, z, _ in warned((theta, z, value))[0].doubted}
    true = {(round(float(np.degrees(theta[k])), 6), float(z[k])) for k in wrong}
    return len(named & true), len(named - true)


def disagreement(seed: int, offset: float, turned: float) -> bool:
    """Whether the warning states that two passes differ."""
    points = survey(np.random.default_rng([20263, seed]), turned, passes=2)
    points[2][points[2].size // 2 :] += offset
    return any("survey-passes" in words for words in warned(points)[1])


def main(out: Path, quick: bool = False) -> list[Row]:
    """Draw, fit, count."""
    draws = QUICK if quick else DRAWS
    rows: list[Row] = []
    for count in range(MOST + 1):
        found = [strays(1000 * count + k, count) for k in range(draws if count == 0 else draws // MOST)]
        rows.append(
            {
                "case": f"{count} stray points", "surveys": len(found),
                "found %": float(100.0 * np.mean([named == count for named, _ in found])) if count else None,
                "false alarms %": float(100.0 * np.mean([others > 0 for _, others in found])),
            }
        )  # fmt: skip
    passes = {"two passes alike": (0.0, 0.0), "two passes 0.1 mm apart": (1e-4, 0.0), "turned by 2 deg": (0.0, 2.0)}
    for name, (offset, turned) in passes.items():
        share = float(100.0 * np.mean([disagreement(k, offset, turned) for k in range(draws)]))
        alike = name.endswith("alike")
        rows.append({"case": name, "surveys": draws, "found %": None if alike else share,
                     "false alarms %": share if alike else None})  # fmt: skip
    for row in rows:
        good = float(str(row["found %"] or 100.0)) >= 99.0 and float(str(row["false alarms %"] or 0.0)) <= 5.0
        row["verdict"] = "pass" if good else "MISSED"
    show("Surveys with stray points", rows)
    write(out / "stray_points.csv", rows)
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
