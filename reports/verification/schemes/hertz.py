"""A two-dimensional elastic disc on rigid ground, assembled with scikit-fem and passed to `contact` as arrays.

`python -m reports.verification.schemes.hertz [--quick] [--out DIR]` compares the pressure with Hertz's line contact
(plane strain, disc of radius R under P per length on rigid ground; Johnson, Contact Mechanics, 1985, 4.2):

    E* = E/(1 - nu^2),  a = sqrt(4 P R/(pi E*)),  p(x) = 2 P/(pi a) sqrt(1 - (x/a)^2).

The laws and schemes are those of the rods; `contact` gets only M, C, K and the rows of the boundary's nodes. A strongly
damped implicit run lowers the disc until it rests.
"""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.sparse import diags_array
from skfem import Basis, ElementTriP1, ElementVector, MeshTri, asm
from skfem.models.elasticity import lame_parameters, linear_elasticity
from skfem.models.poisson import mass

import contact as ct
from casingfem.io.arrays import FloatArray
from casingfem.plot.style import AFTER, BEFORE, new_figure, png, styled
from contact.io.outfiles import write_atomic
from reports.tables import Row, command_line, show, write

RADIUS, E, NU, RHO, LOAD = 0.05, 210e9, 0.3, 7800.0, 2e6  # m, Pa, -, kg/m^3, N/m


class Disc(NamedTuple):
    """Arrays of the lower half of a disc per metre of length, candidates sorted by x, and their share of arc."""

    body: ct.LinearBody
    x: FloatArray
    width: FloatArray
    unknowns: int


def hertz(load: float) -> tuple[float, float]:
    """Half width of the contact [m] and the largest pressure [Pa]."""
    a = math.sqrt(4.0 * load * RADIUS / (math.pi * E / (1.0 - NU**2)))
    return a, 2.0 * load / (math.pi * a)


def half_disc(finest: float, core: float) -> MeshTri:
    """Lower half disc, cells of size `finest` within `core` of the lowest point, growing outside."""
    mesh = MeshTri.init_circle(4)
    mesh = MeshTri(RADIUS * mesh.p, mesh.t)
    mesh = mesh.remove_elements(np.flatnonzero(mesh.p[1, mesh.t].mean(axis=0) > 0.0))
    for _ in range(40):
        centre = mesh.p[:, mesh.t].mean(axis=1)
        size = np.sqrt(np.abs(np.linalg.det((mesh.p[:, mesh.t[1:]] - mesh.p[:, mesh.t[:1]]).transpose(2, 0, 1))))
        distance = np.hypot(centre[0], centre[1] + RADIUS)
        large = np.flatnonzero(size > np.maximum(finest, 0.25 * (distance - core)))
        if not len(large):
            break
        mesh = mesh.refined(large)
        rim = np.unique(mesh.facets[:, mesh.boundary_facets()])
        rim = rim[mesh.p[1, rim] < -1e-9]
        p = mesh.p.copy()
        p[:, rim] *= RADIUS / np.linalg.norm(p[:, rim], axis=0)
        mesh = MeshTri(p, mesh.t)
    return mesh


def disc(finest: float, load: float = LOAD) -> Disc:
    """The disc over the ground it just touches, P spread over its flat top, free to sink but not to slide."""
    a, _ = hertz(load)
    mesh = half_disc(finest, 1.2 * a)
    basis = Basis(mesh, ElementVector(ElementTriP1()), intorder=2)
    K = asm(linear_elasticity(*lame_parameters(E, NU)), basis)
    scalar = Basis(mesh, ElementTriP1(), intorder=2)
    M = RHO * np.asarray(asm(mass, scalar).sum(axis=1)).ravel()
    top = np.flatnonzero(mesh.p[1] > -1e-9)
    share = np.gradient(np.sort(mesh.p[0, top]))[np.argsort(np.argsort(mesh.p[0, top]))]
    force = np.zeros(K.shape[0])
    force[2 * top + 1] = -load * share / share.sum()
    rim = np.unique(mesh.facets[:, mesh.boundary_facets()])
    touch = rim[(mesh.p[1, rim] < 0.0) & (np.abs(mesh.p[0, rim]) < 2.0 * a)]
    touch = touch[np.argsort(mesh.p[0, touch])]
    free = np.delete(np.arange(K.shape[0]), 2 * top)  # the top slides down without spreading
    Q = np.zeros((len(touch), K.shape[0]))
    Q[np.arange(len(touch)), 2 * touch + 1] = 1.0
    lumped = np.repeat(M, 2)[free]
    body = ct.LinearBody(
        M=lumped, K=K[free][:, free], C=diags_array(2.0 * pace(M.sum(), load) * lumped), Q=Q[:, free],
        gap0=mesh.p[1, touch] + RADIUS, load=force[free],
    )  # fmt: skip
    x = mesh.p[0, touch]
    return Disc(body, x, np.gradient(x), len(free))


def pace(weight: float, load: float) -> float:
    """Approximate frequency of the disc on its contact [rad/s]: it sinks by some thousandths of its radius."""
    return math.sqrt(load / (1e-3 * RADIUS) / weight)


def pressed(model: Disc) -> ct.Result:
    """Apply the load until the disc rests."""
    period = 2.0 * math.pi / pace(0.5 * math.pi * RADIUS**2 * RHO, LOAD)
    return ct.run(model.body, scheme=ct.scheme.Newmark(beta=0.6, gamma=1.0), t_end=40.0 * period, dt=0.1 * period)


def case(finest_part: float) -> tuple[Row, FloatArray, FloatArray]:
    """One mesh: cells of `finest_part` half widths where it touches; its row, x and the pressure."""
    a, peak = hertz(LOAD)
    model = disc(finest_part * a)
    result = pressed(model)
    force = result.force[-1]
    pressure = force / model.width
    exact = peak * np.sqrt(np.maximum(1.0 - (model.x / a) ** 2, 0.0))
    touching = model.x[force > 0.0]
    miss, whole = (float(np.sum(p**2 * model.width)) for p in (pressure - exact, exact))
    row: Row = {
        "cell/a": finest_part, "unknowns": model.unknowns, "candidates": len(model.x), "touching": len(touching),
        "sum of forces/P": float(force.sum() / LOAD), "half width/a": float(np.ptp(touching) / 2.0 / a),
        "largest pressure/p0": float(pressure.max() / peak),
        "pressure L2 %": 100.0 * math.sqrt(miss / whole),
        "penetration/a": float(result.max_penetration.max() / a), "seconds": result.seconds,
    }  # fmt: skip
    return row, model.x / a, pressure / peak


@styled
def picture(x: FloatArray, pressure: FloatArray, path: Path) -> None:
    """Pressure at the nodes over Hertz's half ellipse."""
    figure = new_figure(6.4, 3.6)
    axes = figure.add_subplot()
    fine = np.linspace(-1.0, 1.0, 400)
    axes.plot(fine, np.sqrt(1.0 - fine**2), color=BEFORE, label="Hertz")
    axes.plot(x, pressure, "o", ms=3.5, color=AFTER, label="nodal forces over their width")
    axes.set(xlabel="x/a", ylabel="pressure / p0", title="A disc on rigid ground")
    axes.legend(loc="lower center")
    write_atomic(path, png(figure))


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print the table, write it and the picture of the finest mesh."""
    found = [case(part) for part in ((0.2,) if quick else (0.2, 0.1, 0.05))]
    rows = [row for row, _, _ in found]
    a, peak = hertz(LOAD)
    show(f"Hertz: a = {1e3 * a:.4g} mm ({a / RADIUS:.3f} R), p0 = {1e-9 * peak:.4g} GPa", rows)
    write(out / "hertz.csv", rows)
    picture(*found[-1][1:], out / "hertz.png")
    return rows


if __name__ == "__main__":
    command_line(__doc__, main)
