"""A model-updating script to copy: a measured table, a model, its free parameters, and the reliability of the answer.

`python -m reports.studies.fan_blade [--quick] [--out DIR]`. The fan blade of Olson and Lindberg (MEASURED), its
thickness and its clamp. Replace the table, the shell and the parameters by your own.
"""

from pathlib import Path

import casingfem as cf
from reports.tables import DATA, Row, command_line


def main(out: Path, quick: bool = False) -> list[Row]:
    """Fit, judge, predict the rows left out; write the answer."""
    table = cf.FrequencyTable.from_csv(DATA / "experiments" / "olson_lindberg.csv")
    blade = cf.Shell(
        chart=cf.Panel(radius=0.6096, length=0.3048, angle=0.5),
        thickness=3.048e-3,
        material=cf.Material(E=206.85e9, nu=0.3, rho=7857.2),
        supports={"root": cf.ElasticEdge(k_face=1e14)},  # N/m^3 on the end face
    )
    vary = [
        cf.Parameter(name="shell.thickness", lower=2.9e-3, upper=3.3e-3, sigma=5e-5),
        cf.Parameter(name="support.root.k_face", lower=1e12, upper=1e17, sigma=1.0, log=True),
    ]
    fit = cf.update(blade, table, vary, model_error=0.01)
    print(fit)  # values, sigma, before and after, bounds, what the model itself is off by
    print(fit.identifiability)  # which directions the table determines
    print(cf.updating.laplace(fit))  # whether the sigma are those of a Gaussian
    rows: list[Row] = [{"RMS before": fit.rms_before, "RMS after": fit.rms_after, "own error": fit.model_floor}]
    if not quick:
        left = cf.updating.leave_one_out(fit)
        print(left)  # every row, predicted by an update that has not seen it
        rows[0]["RMS left out"] = left.rms
    out.mkdir(parents=True, exist_ok=True)
    (out / "model_updating.txt").write_text(repr(fit) + "\n", encoding="utf-8")
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
