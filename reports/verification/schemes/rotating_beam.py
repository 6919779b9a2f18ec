"""A hinged beam turned by a torque inside an eccentric circle: rigid closed forms, refinement, implicit, flexible ring.

`python -m reports.verification.schemes.rotating_beam [--quick] [--out DIR]` prints the tables and writes
rotating_beam.csv and rotating_beam.png: tip path, snapshots in the circle, hinge angle, gap, force and energies of the
1 N m case.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

import contact as ct
from casingfem.io.arrays import FloatArray
from casingfem.plot.style import AFTER, BEFORE, GREEN, new_figure, png, styled
from contact.io.outfiles import write_atomic
from contact.loop.beam.beam import strain_energy_and_forces
from contact.record.record import samples
from contact.scheme.beam.beam_stepper import BeamStepper, ImplicitBeamStepper
from reports.tables import Row, command_line, show, write

BEAM = ct.bodies.HingedBeam(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, torque=1.0)
CIRCLE = ct.bodies.BeamInCircle(BEAM, radius=0.502, offset=6e-3)
RING = ct.bodies.ThinRing(radius=0.502, width=0.02, height=0.005, E=210e9, rho=7800.0, k_r=1e6, k_t=1e5)
EXPLICIT = ct.CentralDifference()
PAIRS = ((0.5, 0.55), (0.25, 0.55), (0.25, 0.5))


class Run(NamedTuple):
    """A run and balances that only its stepper computes; `failed` is the reason why it ended early."""

    stepper: BeamStepper | ImplicitBeamStepper
    result: ct.Result
    momentum_error: float
    failed: str


def run(
    scene: ct.bodies.BeamInCircle, scheme: ct.CentralDifference | ct.scheme.Newmark, t_end: float, **step: float
) -> Run:
    """Run a scene; its angular momentum is read from a second stepper taken through the same steps."""
    failed = ""
    try:
        result = ct.run(scene, scheme=scheme, t_end=t_end, record=ct.Record(every=1, state_every=4), **step)
    except ct.NumericsError as error:
        failed, result = str(error).partition(":")[0], error.result
    stepper = scheme.prepare(scene, ct.Unilateral(), dt=result.dt, courant=None)
    assert isinstance(stepper, BeamStepper | ImplicitBeamStepper)
    buffers = samples(ct.Record(every=10**7), result.steps, stepper.sums.closed.size, stepper.size)
    stepper.advance(buffers, 0, result.steps)
    momentum, impulse = stepper.angular_momentum()
    late = 0.5 if isinstance(stepper, BeamStepper) else 0.0  # explicit velocities stand half a step back
    turned = scene.beam.torque * (result.steps - late) * result.dt
    return Run(stepper, result, abs(momentum - turned - impulse) / turned, failed)


def row_of(name: str, scene: ct.bodies.BeamInCircle, found: Run) -> Row:
    """One line of a table."""
    result = found.result
    rigid_time, rigid_angle = scene.first_contact_time, scene.first_contact_angle
    first = min((pairs[0][0] for pairs in result.intervals if pairs), default=math.nan)
    row: Row = {"run": name, "steps": result.steps, "us/step": 1e6 * result.seconds / result.steps}
    row["first contact %"] = 100.0 * (first / rigid_time - 1.0)
    if not math.isnan(first):
        k = min(int(np.searchsorted(result.state_time, first)), len(result.state) - 1)
        tip = result.state[k].reshape(-1, 3)[-1]
        row["its angle %"] = 100.0 * (math.atan2(tip[1], tip[0]) / rigid_angle - 1.0)
    energy = result.energy
    row |= {
        "impulse [N s]": float(result.impulse.sum()), "peak [N]": float(result.peak_force.max()),
        "lost in contact [J]": energy.lost_in_contact, "penetration [m]": float(result.max_penetration.max()),
        "residual [m]": float(result.residual.max()), "unaccounted": abs(energy.unaccounted) / energy.scale,
        "ang. momentum": found.momentum_error, "": found.failed,
    }  # fmt: skip
    return row


def refinement(quick: bool) -> Iterator[Row]:
    """Mesh and step refinement of the explicit run, to 1.6 times the first contact."""
    for elements in (5, 10) if quick else (10, 20, 40, 80):
        for courant in (0.5,) if quick else (0.9, 0.5, 0.25):
            scene = replace(CIRCLE, beam=replace(BEAM, elements=elements))
            found = run(scene, EXPLICIT, 1.6 * CIRCLE.first_contact_time, courant=courant)
            yield row_of(f"{elements} elements, courant {courant:g}", scene, found)


def before_contact(quick: bool) -> Iterator[Row]:
    """T + U against the work W of the torque, until shortly before contact."""
    for courant in (0.5, 0.25) if quick else (0.5, 0.25, 0.125):
        scene = replace(CIRCLE, beam=replace(BEAM, elements=10 if quick else 20))
        energy = run(scene, EXPLICIT, 0.95 * scene.first_contact_time, courant=courant).result.energy
        work = energy.start.potential - energy.end.potential
        gain = energy.end.total - energy.start.total
        yield {
            "courant": courant,
            "T + U [J]": energy.end.kinetic + energy.end.strain,
            "W [J]": work,
            "error": gain / work,
        }


def implicit(quick: bool) -> Iterator[Row]:
    """Newmark's parameters compared with the explicit run."""
    scene = replace(CIRCLE, beam=replace(BEAM, elements=10 if quick else 20))
    t_end = (1.1 if quick else 1.6) * scene.first_contact_time
    yield row_of("central difference, courant .5", scene, run(scene, EXPLICIT, t_end, courant=0.5))
    for beta, gamma in PAIRS[:1] if quick else PAIRS:
        for dt in (2e-4,) if quick else (2e-4, 1e-4, 2e-5):
            scheme = ct.scheme.Newmark(beta=beta, gamma=gamma)
            yield row_of(f"Newmark ({beta:g}, {gamma:g}), dt {dt:g} s", scene, run(scene, scheme, t_end, dt=dt))


def flexible(quick: bool) -> Iterator[Row]:
    """The circle as an elastic ring: modes, finite elements, and stiffening towards the rigid circle."""
    scene = replace(CIRCLE, beam=replace(BEAM, elements=10 if quick else 20))
    t_end = 1.2 * scene.first_contact_time
    rings: list[tuple[str, ct.ModalBody | None]] = [
        ("rigid", None),
        ("ring, modes to n = 20", ct.bodies.ring_modes(RING, 20)),
    ]
    if not quick:
        rings += [
            ("ring, modes to n = 40", ct.bodies.ring_modes(RING, 40)),
            ("ring, 60 elements seen to n = 20", ct.bodies.ring_elements(RING, 60, 20)),
            ("ring, 90 elements seen to n = 40", ct.bodies.ring_elements(RING, 90, 40)),
        ]
    for factor in (1e4,) if quick else (1e1, 1e2, 1e4, 1e6):
        stiff = replace(RING, E=factor * RING.E, k_r=factor * RING.k_r, k_t=factor * RING.k_t)
        rings.append((f"ring {factor:g} times as stiff, modes to n = 20", ct.bodies.ring_modes(stiff, 20)))
    for name, ring in rings:
        changed = replace(scene, ring=ring)
        yield row_of(name, changed, run(changed, EXPLICIT, t_end, courant=0.5))


def torques(quick: bool) -> Iterator[tuple[Row, Run]]:
    """With a small torque the beam rebounds; a large torque buckles it and pushes it past the narrowest point."""
    for torque in (1.0,) if quick else (1.0, 10.0):
        scene = replace(CIRCLE, beam=replace(BEAM, elements=10 if quick else 40, torque=torque))
        found = run(scene, EXPLICIT, (1.4 if quick else 2.5) * scene.first_contact_time, courant=0.5)
        row = row_of(f"{torque:g} N m", scene, found)
        angle = np.degrees(found.result.state[:, 2])
        row |= {"hinge angle at the end [deg]": float(angle[-1]), "largest [deg]": float(angle.max())}
        yield row, found


@styled
def picture(found: Run, path: Path) -> None:
    """Tip path and snapshots in the circle; hinge angle, tip gap, force and energies over time."""
    result, scene = found.result, found.stepper.problem
    nodes = result.state.reshape(len(result.state), -1, 3)
    t = 1e3 * result.state_time
    figure = new_figure(11.0, 6.0)
    grid = figure.add_gridspec(4, 2, width_ratios=[1.15, 1.0])
    left = figure.add_subplot(grid[:, 0])
    turn = np.linspace(0.0, 2.0 * np.pi, 400)
    left.plot(scene.offset + scene.radius * np.cos(turn), scene.radius * np.sin(turn), color="0.4", lw=1.0)
    for k in np.linspace(0, len(nodes) - 1, 12).astype(int):
        left.plot(nodes[k, :, 0], nodes[k, :, 1], color=BEFORE, lw=1.0, alpha=0.6)
    left.plot(nodes[:, -1, 0], nodes[:, -1, 1], color=AFTER, lw=1.0, label="tip path")
    left.plot(0.0, 0.0, "o", color="black", ms=4, label="hinge")
    left.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title="Snapshots in the circle")
    left.legend(loc="upper left")
    axes = [figure.add_subplot(grid[0, 1])]
    axes += [figure.add_subplot(grid[row, 1], sharex=axes[0]) for row in range(1, 4)]
    axes[0].plot(t, np.degrees(nodes[:, 0, 2]), color=BEFORE)
    axes[0].set(ylabel="hinge [deg]")
    axes[1].plot(1e3 * result.time, 1e3 * result.gap[:, -1], color=GREEN, lw=0.9)
    axes[1].set(ylabel="tip gap [mm]")
    axes[2].plot(1e3 * result.time, 1e-3 * result.windowed_force(1e-4)[:, -1], color=AFTER, lw=0.9)
    axes[2].set(ylabel="tip force\nover .1 ms [kN]")
    kinetic, strain = energies(found)
    axes[3].plot(t, kinetic, color=BEFORE, lw=0.9, label="kinetic")
    axes[3].plot(t, strain, color=AFTER, lw=0.9, label="strain")
    axes[3].plot(t, scene.beam.torque * nodes[:, 0, 2], color="black", lw=0.9, ls="--", label="work of the torque")
    axes[3].set(ylabel="energy [J]", xlabel="time [ms]")
    axes[3].legend(loc="center left", fontsize=8)
    write_atomic(path, png(figure))


def energies(found: Run) -> tuple[FloatArray, FloatArray]:
    """Kinetic and strain energy of the beam at the stored states, (states,) each [J]."""
    result, beam = found.result, found.stepper.problem.beam
    nodes = result.state.reshape(len(result.state), -1, 3)
    velocity = np.gradient(nodes, result.state_time, axis=0)
    kinetic = 0.5 * np.einsum("tij,ij->t", velocity**2, beam.lumped())
    rest, EA, EI = beam.length / beam.elements, beam.E * beam.area, beam.E * beam.second_moment
    work = np.zeros(nodes.shape[1:])
    strain = np.array([strain_energy_and_forces(np.ascontiguousarray(x), rest, EA, EI, work) for x in nodes])
    return kinetic, strain


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the tables, write them and the picture."""
    out.mkdir(parents=True, exist_ok=True)
    turned = list(torques(quick))
    angle, time = math.degrees(CIRCLE.first_contact_angle), CIRCLE.first_contact_time
    print(f"Rigid beam: first contact at {angle:.3f} deg, {1e3 * time:.2f} ms (both per cents below refer to it)")
    tables = {
        "Mesh and step": list(refinement(quick)), "Before contact": list(before_contact(quick)),
        "Implicit and explicit": list(implicit(quick)), "Flexible ring": list(flexible(quick)),
        "Torque": [row for row, _ in turned],
    }  # fmt: skip
    for title, rows in tables.items():
        show(title, rows)
    picture(turned[0][1], out / "rotating_beam.png")
    shared = [{"table": title, **row} for title, rows in tables.items() if title != "Before contact" for row in rows]
    write(out / "rotating_beam.csv", [{**dict.fromkeys(shared[-1]), **row} for row in shared])
    return shared


if __name__ == "__main__":
    command_line(__doc__, main)
