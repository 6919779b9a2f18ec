"""The recorded numbers of a run: sums over all its steps, its ledger, and some of its samples."""

from dataclasses import asdict

import numpy as np


def numbers_of(result, rows: int = 9) -> dict[str, object]:
    """Columns for `held`; runs must be short enough that no bounce magnifies the last bit of the one before."""
    energy = asdict(result.energy)
    at = np.unique(np.linspace(0, len(result.time) - 1, rows).astype(int))
    states = np.unique(np.linspace(0, max(len(result.state) - 1, 0), rows).astype(int)) if len(result.state) else []
    return {
        "size": [
            result.steps,
            result.every,
            len(result.time),
            len(result.state),
            *result.contact_steps,
            *result.reversals,
        ],
        "step": [result.dt, result.window],
        "energy": [*(x for part in ("start", "end") for x in energy.pop(part).values()), *energy.values()],
        "unaccounted": [result.energy.unaccounted / result.energy.scale > 1e-9, result.energy.scale],
        "impulse": result.impulse,
        "peak": result.peak_force,
        "deepest": result.max_penetration > 1e-12,
        "force": result.force[at],
        "impulses": result.impulse_history[at],
        "gap": np.where(np.abs(result.gap[at]) > 1e-12, result.gap[at], 0.0),  # a closed one is zero to round-off
        "windowed": result.windowed_force()[at] if result.every else [],
        "state": np.hstack([result.state, result.tip_force])[states] if len(states) else [],
        "closed": [t for times in result.intervals for interval in times[:6] for t in interval],
        "stuck": [t for times in result.sticking for interval in times[:6] for t in interval],
        "motions": [x for motion in result.motions for x in (motion.mean_velocity, motion.momentum)],
        "heat": [*np.ravel(result.notes.heat), *np.ravel(result.notes.drive)],
        "worn": [
            x
            for wear in result.tracks
            for x in (*wear.worn[::97], wear.volume, wear.stated, wear.dissipated, wear.bare)
        ],
    }
