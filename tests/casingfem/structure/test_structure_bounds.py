"""Bounds of what a structure may say: the value just inside is taken, the one just outside refused in words."""

import math
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.field.survey.fit import _check_coverage
from casingfem.structure.geometry.chart_checks import check_chart
from casingfem.structure.geometry.rotation import axis_frame
from casingfem.structure.geometry.survey_check import check_survey
from casingfem.structure.imported.grid import cube_cells

INF, NAN = math.inf, math.nan
PLATE, TUBE = cf.Plate(length=0.3, width=0.1), cf.Cylinder(radius=1.0, height=1.0)


def field(**changes):
    return cf.FourierField(**{"p": [0, 2], "cos": [[1.0], [2.0]], "sin": [[0.0], [3.0]]} | changes)


def spectrum(**changes):
    return cf.field.Spectrum(**{"p": [1, 2], "median": [0.1, 0.2], "high": [0.3, 0.4]} | changes)


def drawn(**changes):
    return cf.field.RandomField(**{"spectrum": spectrum(), "seed": 7} | changes)


def tetra(**changes):
    given = {"kind": "tetra", "points": np.vstack([np.zeros(3), np.eye(3)]), "cells": np.arange(4)[None]}
    return cf.imported.MeshData(**given | changes)


def hung(node):
    return tetra(attachments=cf.imported.Attachments(masses=(cf.imported.PointMass(node=node, mass=1.0),)))


def covered(gap=10.0, n_max=None, degree=None):
    _check_coverage(SimpleNamespace(path="survey.csv"), gap, n_max, degree)


def surveyed(quantity="radius", mean=0.5, thickness=None, z=(0.0, 0.2), of="radius"):
    """Of a casing between z = 0 and 0.2 m."""
    chart = cf.Frustum(r_base=0.5, r_top=0.5, height=0.2) if quantity == "radius" else None
    survey = SimpleNamespace(
        path="a/rig.csv",
        quantity=quantity if of == "radius" else of,
        mean=[mean],
        mean_radius=lambda z: mean,
        heights=2,
        z_range=z,
        outside="fit",
    )
    check_survey(survey, quantity, chart, thickness)


def bent(radius):
    """A way of 0.2 m along an arc."""
    piece = cf.geometry.Piece(to=(0.5, 0.2), radius=radius)
    return cf.geometry.PiecewiseMeridian(start=(0.5, 0.0), pieces=(piece,))


def of_bounds(bounds):
    check_chart(SimpleNamespace(bounds=bounds, edges={}, periodic=False, surface=PLATE.surface))


def holed(part, value):
    """A plate with something added to one part of its surface, at one point."""

    def surface(a, b, defect):
        whole = PLATE.surface(a, b, defect)
        return whole._replace(**{part: getattr(whole, part) + np.where(np.arange(a.size) == 9, value, 0.0)})

    check_chart(SimpleNamespace(bounds=PLATE.bounds, edges={}, periodic=False, surface=surface))


def wound(gap):
    """A cylinder of 1.28 m from corner to corner that rises by a gap around."""
    cylinder, rise = cf.Cylinder(radius=0.4, height=0.6), gap / (2.0 * math.pi)

    def surface(a, b, defect):
        s, up = cylinder.surface(a, b, defect), np.array([[0.0], [0.0], [rise]])
        return s._replace(x=s.x + up * b, x2=s.x2 + up)

    check_chart(SimpleNamespace(bounds=cylinder.bounds, edges={}, periodic=True, surface=surface))


def walled(chart, thickness):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cf.errors.ModelWarning)
        cf.Shell(chart=chart, thickness=thickness, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={})


TAKEN, REFUSED = 0, 1
REVOLVED, BOWL = cf.geometry.RevolvedPanel, cf.geometry.Arc(radius=1.0, start=0.0, end=1.2)
BOUNDS = {
    "panel": (lambda k: cf.Panel(radius=1.0, length=1.0, angle=(6.28, 2.0 * math.pi)[k]), "chart.angle must be below"),
    "sector": (lambda k: REVOLVED(profile=BOWL, angle=(6.28, 2.0 * math.pi)[k]), "chart.angle must be below"),
    "bounds.order": (lambda k: of_bounds(((0.0, (0.3, 0.0)[k]), (-0.05, 0.05))), "chart.bounds: found"),
    "bounds.across": (lambda k: of_bounds(((0.0, 0.3), (-0.05, (0.05, -0.05)[k]))), "chart.bounds: found"),
    "bounds.nan": (lambda k: of_bounds(((0.0, 0.3), (-0.05, (0.05, INF)[k]))), "chart.bounds: found"),
    "chart.place": (lambda k: holed("x", (0.0, NAN)[k]), "surface or its derivatives are not finite somewhere"),
    "chart.last": (lambda k: holed("x22", (0.0, INF)[k]), "surface or its derivatives are not finite somewhere"),
    "chart.seam": (lambda k: wound((1.2e-9, 1.4e-9)[k]), "said to be periodic, its ends lie 1.4e-09 m apart"),
    "field.sum": (lambda k: cf.field.SumField((field(),)[k:]), "SumField needs at least one field"),
    "field.three": (
        lambda k: cf.FourierField.of({2: (0.1, 0.2, 0.3)[: 2 + k]}),
        "one number .cos. or a pair .cos, sin.",
    ),
    "field.one": (lambda k: cf.FourierField.of({2: (0.1, 0.2)[k:]}), "each harmonic is one number .cos. or a pair"),
    "field.z_half": (lambda k: field(z_half=(1e-9, 0.0)[k]), "z_half > 0, not 0.0, 0.0"),
    "field.z_mid": (lambda k: field(z_mid=(1e9, INF)[k]), "need finite z_mid, z_half > 0, not inf"),
    "field.z_inf": (lambda k: field(z_half=(1e9, INF)[k]), "need finite z_mid, z_half > 0, not 0.0, inf"),
    "field.sine": (lambda k: field(sin=[[(0.0, 1e-9)[k]], [3.0]]), "use cos for the mean"),
    "field.rows": (lambda k: field(cos=[[1.0], [2.0]][: 2 - k]), "must both be .harmonics, degrees., with one row for"),
    "field.both": (lambda k: field(p=[0, 2, 3][: 2 + k]), "with one row for each of the 3 harmonics"),
    "seed": (lambda k: drawn(seed=(0, -1)[k]), "found seed -1, draw 0, stream 0"),
    "draw": (lambda k: drawn(draw=(0, -1)[k]), "found seed 7, draw -1, stream 0"),
    "stream": (lambda k: drawn(stream=(0, -1)[k]), "found seed 7, draw 0, stream -1"),
    "spectrum.first": (lambda k: spectrum(p=[(1, 0)[k], 2]), r"ascend from 1 or more, found \[0, 2\]"),
    "spectrum.order": (lambda k: spectrum(p=[1, (2, 1)[k]]), r"ascend from 1 or more, found \[1, 1\]"),
    "spectrum.median": (lambda k: spectrum(median=[(1e-9, 0.0)[k], 0.2]), "need 0 < median <= high < inf"),
    "spectrum.high": (lambda k: spectrum(high=[0.3, (0.2, 0.199)[k]]), "need 0 < median <= high < inf"),
    "spectrum.inf": (lambda k: spectrum(high=[0.3, (1e9, INF)[k]]), "need 0 < median <= high < inf"),
    "spectrum.sizes": (lambda k: spectrum(median=[0.1, 0.2][: 2 - k]), r"p \(2,\), median \(1,\), high \(2,\) must be"),
    "spectrum.none": (
        lambda k: spectrum(p=[1][k:], median=[0.1][k:], high=[0.2][k:]),
        r"p \(0,\), median \(0,\), high \(0,\) must be",
    ),
    "coverage.n_max": (lambda k: covered(n_max=(1, 0)[k]), "n_max must be a whole number >= 1, not 0"),
    "coverage.whole": (lambda k: covered(n_max=(2, 2.5)[k]), "n_max must be a whole number >= 1, not 2.5"),
    "coverage.degree": (lambda k: covered(degree=(0, -1)[k]), "degree must be a whole number >= 0, not -1"),
    "coverage.radians": (lambda k: covered(gap=(10.0, 350.1)[k]), r"a gap of 350.1 deg in theta \(are these radians"),
    "coverage.gap": (lambda k: covered(gap=(10.0, 350.0)[k]), "a gap of 350 deg in theta; expected"),
    "coverage.order": (lambda k: covered(gap=(30.0, 30.1)[k], n_max=6), "30.1"),
    "survey.mean": (lambda k: surveyed(mean=(0.549, 0.56)[k]), "a mean radius of 0.56 m, expected about 0.5 m"),
    "survey.small": (lambda k: surveyed(mean=(0.451, 0.449)[k]), "^rig.csv: found a mean radius of 0.449 m, expected"),
    "survey.of": (lambda k: surveyed(of=("radius", "thickness")[k]), "found a survey of thickness, expected"),
    "survey.high": (lambda k: surveyed(z=((0.099, 0.101)[k], 0.3)), "found points at z from 0.101 to 0.3 m, 50% of"),
    "survey.low": (lambda k: surveyed(z=(-0.1, (0.101, 0.099)[k])), "expected at least half of it or a rule"),
    "survey.wall": (
        lambda k: surveyed("thickness", (3e-3, 6e-3)[k], 3e-3),
        "a mean thickness of 0.006 m, expected about 0.003 m",
    ),
    "mesh.points": (lambda k: tetra(points=np.ones((4, 3 + k))), r"points have shape \(4, 4\), expected \(nodes, 3\)"),
    "mesh.cells": (lambda k: tetra(cells=np.arange(4 + k)[None]), r"cells have shape \(1, 5\), expected \(at least 1"),
    "mesh.none": (lambda k: tetra(cells=np.zeros((1 - k, 4), int)), r"cells have shape \(0, 4\), expected \(at least"),
    "mesh.high": (lambda k: tetra(cells=[[0, 1, 2, 3 + k]]), "cells name nodes outside 0 to 3"),
    "mesh.low": (lambda k: tetra(cells=[[0, 1, 2, (0, -1)[k]]]), "cells name nodes outside 0 to 3"),
    "mesh.hung": (lambda k: hung(3 + k), "attachments name nodes outside 0 to 3"),
    "mesh.first": (lambda k: hung((0, -1)[k]), "attachments name nodes outside 0 to 3"),
    "mesh.kind": (lambda k: tetra(kind=("tetra", "tet")[k]), "cells of kind 'tet', expected one of"),
    "grid": (lambda k: cube_cells("hexahedron", 3 - k), "hexahedron has 3 dimensions, counts has 2"),
    "hub": (lambda k: cf.Rotation.of_blade(PLATE, omega=1.0, hub_radius=(0.0, -1e-9)[k]), "found hub_radius -1e-09"),
    "stagger": (
        lambda k: cf.Rotation.of_blade(PLATE, omega=1.0, hub_radius=0.1, stagger=(9.0, INF)[k]),
        "0.1, stagger inf",
    ),
    "hub.closed": (
        lambda k: cf.Rotation.of_blade((PLATE, TUBE)[k], omega=1.0, hub_radius=0.1),
        "a stagger on a closed casing",
    ),
    "wall.long": (
        lambda k: walled(cf.Plate(length=0.25, width=0.125), (0.249, 0.25)[k]),
        "the wall is 0.25 m thick on a surface 0.25 m long",
    ),
    "wall.wide": (
        lambda k: walled(cf.Plate(length=0.125, width=0.25), (0.249, 0.25)[k]),
        "the wall is 0.25 m thick on a surface 0.25 m long",
    ),
    "wall.bent": (lambda k: walled(TUBE, (1.0, 1.01)[k]), "1.01 times its smallest radius of curvature"),
    "bend": (lambda k: bent((0.1001, 0.1)[k]), r"chart.piece\[1\].radius: found 0.1 m for a way of 0.2 m"),
    "bend.back": (lambda k: bent((-0.1001, -0.1)[k]), r"chart.piece\[1\].radius: found -0.1 m for a way of 0.2 m"),
}


@pytest.mark.parametrize("name", BOUNDS)
def test_just_inside_is_taken_and_just_outside_refused(name):
    made, words = BOUNDS[name]
    made(TAKEN)
    with pytest.raises(ValueError, match=words):
        made(REFUSED)


@pytest.mark.parametrize("axis", [(0, 0, 2), (1, 0.2, 0.3), (-1, 0.9, 0.9), (0.5, -1, 0.1), (0.7, 0.7, 0), (-1, 0, 0)])
def test_an_axis_has_a_right_handed_frame_near_x_or_near_y(axis):
    e1, e2, a = axis_frame(axis)
    np.testing.assert_allclose([e1 @ e1, e2 @ e2, e1 @ e2, e1 @ a, e2 @ a], [1.0, 1.0, 0.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(np.cross(e1, e2), a, atol=1e-15)
    np.testing.assert_allclose(a, np.array(axis) / np.linalg.norm(axis), atol=1e-15)
    along_x = abs(a[0]) > max(abs(a[1]), abs(a[2]))
    near = np.eye(3)[1 if along_x else 0]
    np.testing.assert_allclose(e1, (near - (near @ a) * a) / np.linalg.norm(near - (near @ a) * a), atol=1e-15)
