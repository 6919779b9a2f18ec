"""SYNTHETIC test data of the rig casing: a survey and a frequency table that nobody measured.

There is no public frequency table of the original rig. This script makes one from a model that the updater does
not have: a finer mesh; radius harmonics that change along the axis and go beyond the survey's fit; a wall whose
thickness varies around; an embedding with harmonics outside the updated family; noise on both records. The
spectrum of the radius follows the medians of the example spectrum (`casingfem.structure.field.random`, amplitude over
wall thickness), scaled to a machined casing.

    python -m reports.studies.rig.synthetic          writes data/surveys/rig_casing.csv and
    data/experiments/rig_casing.csv
"""

import argparse

import numpy as np

import casingfem as cf
from casingfem.structure.field.random import EXAMPLE
from reports.tables import DATA

SEED = 20261

HEIGHT, THICKNESS = 0.25, 3e-3  # m, of the drawing
CHART = cf.Frustum(r_base=0.50, r_top=0.45, height=HEIGHT)
MACHINED = 0.35  # amplitudes of a machined casing over those of the example
HIGHEST = 32  # harmonics of the true surface; those above 12 continue as p^-2
SURVEY_SIGMA = 8e-6  # m
FREQ_SIGMA = 4e-4  # relative standard uncertainty of a measured frequency
HIGHEST_FREQ = 640.0  # Hz


def true_radius(rng: np.random.Generator) -> cf.FourierField:
    """The casing's radius defect: all harmonics 2 to 32, each with its own phase and trend along the axis."""
    p = np.arange(2, HIGHEST + 1)
    measured = np.array([EXAMPLE.get(int(k), np.nan) for k in p])
    known = np.isfinite(measured)
    level = np.exp(np.interp(np.log(p), np.log(p[known]), np.log(measured[known])))
    level[p > 12] = EXAMPLE[12] * (12.0 / p[p > 12]) ** 2
    amplitude = MACHINED * level * THICKNESS / 0.475
    phase = rng.uniform(0.0, 2.0 * np.pi, len(p))
    trend = rng.normal(0.0, 0.3, (len(p), 2))
    along = np.column_stack([np.ones(len(p)), trend])
    cos, sin = amplitude * np.cos(phase), amplitude * np.sin(phase)
    return cf.FourierField(p=p, cos=cos[:, None] * along, sin=sin[:, None] * along, z_mid=HEIGHT / 2, z_half=HEIGHT / 2)


def true_casing(radius: cf.FourierField) -> cf.Shell:
    """The casing that the records are made from; none of its numbers is known to the updater."""
    embedding = cf.ElasticEdge(
        k_face=9e12,
        around=cf.FourierField.of(
            {1: (0.08, -0.05), 2: (0.05, 0.04), 4: (0.06, 0.03), 8: (0.22, 0.12), 16: (0.04, -0.03)}
        ),
    )
    return cf.Shell(
        chart=CHART,
        thickness=3.05e-3,
        material=cf.Material(E=206.5e9, nu=0.29, rho=7820.0),
        supports={"base": embedding},
        radius_defect=radius,
        thickness_defect=cf.FourierField.of({1: (0.004, 0.002), 3: (0.0, 0.003), 5: 0.002}),
        mesh=cf.ShellMesh(order=8, rows=(0.0, 0.03, 0.5, 0.97, 1.0), around=41),
    )


def survey_lines(radius: cf.FourierField, rng: np.random.Generator) -> list[str]:
    """Five rings of 144 radii of the mid-surface, with noise."""
    lines = [
        "# SYNTHETIC: made by `python -m reports.studies.rig.synthetic`, not measured",
        "# Radii of the mid-surface of the rig casing on five rings of 144 points; standard deviation "
        f"{1e6 * SURVEY_SIGMA:.0f} um.",
        "theta_deg,z_mm,radius_mm",
    ]
    for z in np.linspace(0.01, 0.249, 5):
        theta = np.radians(np.arange(0.0, 360.0, 2.5))
        r = CHART.radius(np.array(z)) * (1.0 + radius.derivatives(z, theta).value)
        r = r + rng.normal(0.0, SURVEY_SIGMA, len(theta))
        lines += [f"{np.degrees(a):.1f},{1e3 * z:.3f},{1e3 * value:.4f}" for a, value in zip(theta, r, strict=True)]
    return lines


def measured_pair(f: np.ndarray, n: int, angle_deg: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A doublet as measured: noise on the mean and on both components of the split vector."""
    mean, split = f.mean(), f[1] - f[0]
    sigma = FREQ_SIGMA * mean
    mean = mean + rng.normal(0.0, sigma / np.sqrt(2.0))
    phase = 2.0 * n * np.radians(angle_deg)
    vector = split * np.array([np.cos(phase), np.sin(phase)]) + rng.normal(0.0, np.sqrt(2.0) * sigma, 2)
    split, angle = np.hypot(*vector), np.mod(np.degrees(np.arctan2(vector[1], vector[0]) / (2.0 * n)), 180.0 / n)
    freq = mean + split * np.array([-0.5, 0.5])
    return freq, np.mod([angle, angle + 90.0 / n], 180.0 / n)


def measured_table(truth: cf.Modes, rng: np.random.Generator) -> cf.FrequencyTable:
    """The doublets below HIGHEST_FREQ, with noise, mode by mode."""
    rows: list[tuple[float, int, float]] = []
    for low, high in truth.doublets:
        if truth.freq[high] < HIGHEST_FREQ:
            n = int(truth.nodal_diameters[low])
            freq, angle = measured_pair(truth.freq[[low, high]], n, float(truth.angle_deg[low]), rng)
            rows += [(float(f), n, float(a)) for f, a in zip(freq, angle, strict=True)]
    rows.sort()
    freq = np.array([f for f, _, _ in rows])
    return cf.FrequencyTable.from_arrays(
        freq_hz=np.round(freq, 3),
        sigma_hz=np.round(FREQ_SIGMA * freq, 3),
        n=[n for _, n, _ in rows],
        angle_deg=np.round([a for _, _, a in rows], 2),
        zeta=0.002,
        synthetic=True,
        card=(
            "SYNTHETIC: made by `python -m reports.studies.rig.synthetic`, not measured",
            "Frustum .50 -> .45 m, height .25 m, 3 mm steel, elastically embedded base, free top.",
            "Made from a finer model with thickness variations, radius harmonics up to 32 and embedding",
            "harmonics that the updated model does not have; noise of 0.04 % a frequency.",
        ),
    )


def main() -> None:
    """Write the survey and the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    rng = np.random.default_rng(SEED)
    radius = true_radius(rng)
    survey = DATA / "surveys" / "rig_casing.csv"
    survey.parent.mkdir(parents=True, exist_ok=True)
    survey.write_text("\n".join(survey_lines(radius, rng)) + "\n", encoding="utf-8")
    truth = cf.modes(true_casing(radius), 40)
    print(truth)
    table = measured_table(truth, rng)
    table.to_csv(DATA / "experiments" / "rig_casing.csv")
    print(table)


if __name__ == "__main__":
    main()
