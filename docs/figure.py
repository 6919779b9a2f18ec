"""The README's figure: `.venv/bin/python docs/figure.py` writes docs/casing.png (half a minute).

The rig's casing before and after updating, against its SYNTHETIC frequency table: frequencies, splits, orientations.
"""

from pathlib import Path

import casingfem as cf
from casingfem.plot.style import png
from casingfem.plot.update import Paired, figure_comparison
from casingfem.study import load_study, perfect
from casingfem.study.tasks import run_update
from contact.io.outfiles import write_atomic

HERE = Path(__file__).parent


def main() -> None:
    """Update the casing and draw it."""
    study = load_study(HERE.parent / "data" / "studies" / "rig_casing.toml")
    fit = run_update(study)
    ideal = cf.modes(perfect(study.start), len(fit.before))
    models = {
        "perfect": Paired(ideal, cf.correlation.pair(ideal, fit.table)),
        "imperfect": Paired(fit.before, fit.pairing_before),
        "updated": Paired(fit.after, fit.pairing),
    }
    path = HERE / "casing.png"
    write_atomic(path, png(figure_comparison(fit.table, models), dpi=120))
    print(f"wrote {path}")


if __name__ == "__main__":
    main()
