"""Every report in turn.

`python -m reports.run [--quick] [--out DIR]`. The rig comes last: it takes longest and writes report.html.
"""

import importlib
import time
from pathlib import Path

from reports.tables import command_line

REPORTS = (
    "frustum_convergence", "cylinder", "contact_accuracy", "rods", "rod_wall", "work_precision", "stability",
    "sparse_body", "contact_targets", "contact_physics", "interaction", "interaction_map", "rotating_beam", "hertz",
    "section_44", "wear", "bladed_disk", "rub_convergence", "rub_checks", "bases", "identification", "rig_measure",
    "start_up", "speed", "sweep_speed", "sweep_kills", "loose_bolts", "steel_ring", "loose_bolt_search", "pairing",
    "mistuning", "verification", "imported", "sturm", "locking", "modal_speed", "solid_solvers", "broken_models",
    "uff_mutations", "model_updating", "update_checks", "update_twin", "rig",
)  # fmt: skip


def main(out: Path, quick: bool = False) -> dict[str, float]:
    """Run them all; returns the seconds each took."""
    seconds = {}
    for name in REPORTS:
        print(f"\n=== reports.{name}")
        started = time.perf_counter()
        importlib.import_module(f"reports.{name}").main(out, quick=quick)
        seconds[name] = time.perf_counter() - started
    print("\n" + "  ".join(f"{name} {value:.0f} s" for name, value in seconds.items()))
    return seconds


if __name__ == "__main__":
    command_line(__doc__, main)
