"""What `casingfem rub --vtu` writes: the motion of every body whose basis recovers its nodes, and of the tips."""

from typing import TYPE_CHECKING

import numpy as np

from contact.io.outfiles import Content

if TYPE_CHECKING:
    from contact.model.gaps.gap import RotatingRim
    from contact.model.gaps.rub import Rub
    from contact.result import Result


def series_files(what: "Rub | RotatingRim", result: "Result") -> dict[str, Content]:
    """vtu/casing.pvd, vtu/blade.pvd, ... of the bodies in their own frames, and vtu/tips.pvd in the casing's.

    Raises InputError where no body's basis has a recovery, and where no states were stored.
    """
    from casingfem.export.meshes import frames, motion_files, point_files
    from contact.base.errors import InputError
    from contact.model.gaps.rub import rub_of
    from contact.recovery import at_points, rub_forces

    rub: Rub = rub_of(what)
    drawn = {name: body for name, body in zip(rub.names, rub.bodies, strict=True) if body.recovery_cells is not None}
    if not drawn:
        expected = "recovery = true in [reduce] of the study that makes it"
        raise InputError(f"basis: found none that recovers the motion of its nodes, expected {expected}")
    shown = frames(len(result.state_time))
    time = result.state_time[shown]
    files: dict[str, Content] = {}
    for name, body in drawn.items():
        forces = rub_forces(rub, result, name)[1][shown]
        moved = at_points(body, result.state_of(name)[shown], forces).reshape(len(shown), -1, 3)
        assert body.recovery_points is not None
        assert body.recovery_cells is not None
        files |= motion_files(name.replace(" ", "_"), body.recovery_points, body.recovery_cells, time, moved)
    turned = np.array([rub.speed.angle(float(t)) for t in time])
    angle = np.radians([tip.angle_deg for tip in rub.tips]) - turned[:, None]
    lines = [
        rub.casing.lines[tip.line] if rub.casing.lines is not None else (0.0, rub.casing.radius) for tip in rub.tips
    ]
    axial, radius = np.array(lines).T
    places = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.broadcast_to(axial, angle.shape)], axis=-1)
    force = result.state_of("tips")[shown].reshape(len(shown), len(rub.tips), -1)[:, :, 0]
    files |= point_files("tips", time, places, {"normal_force_N": force})
    return {f"vtu/{name}": content for name, content in files.items()}
