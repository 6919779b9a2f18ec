"""Ring stiffeners: the shell is its harmonics, a ring at the end is one on the edge, bricks, refusals, studies."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.study.study_texts import STEEL

BAR = cf.edge.Section.rectangle(width=0.012, depth=0.004)
OUTSIDE = (0.0075, 0.0)


def firsts(shell):
    """The lowest frequency of each number of nodal diameters [Hz]."""
    found = cf.modes(shell, 40, method="fourier")
    return {int(n): found.freq[found.nodal_diameters == n][0] for n in np.unique(found.nodal_diameters)}


@pytest.fixture
def casing(steel):
    def made(*places, offset=OUTSIDE, **parts):
        rings = tuple(cf.edge.Stiffener(at=at, section=BAR, offset=offset) for at in places)
        parts = {"chart": cf.Cylinder(radius=0.3, height=0.25), "supports": {"base": cf.Clamped()}} | parts
        return cf.Shell(thickness=3e-3, material=steel, stiffeners=rings, **parts)

    return made


@pytest.mark.slow
def test_the_shell_with_stiffeners_is_its_harmonics(casing):
    """A cone with two rings, one of them inside the wall."""
    shell = casing(0.05, 0.15, chart=cf.Frustum(r_base=0.3, r_top=0.26, height=0.2))
    shell = replace(shell, stiffeners=(shell.stiffeners[0], replace(shell.stiffeners[1], offset=(-0.008, 0.001))))
    shell = replace(shell, mesh=cf.ShellMesh(order=5, rows=shell.mesh.rows, around=13))
    exact, found = cf.modes(shell, 4), cf.modes(shell, 4, method="shell")
    np.testing.assert_allclose(found.freq, exact.freq, rtol=2e-4)
    np.testing.assert_array_equal(found.nodal_diameters, exact.nodal_diameters)
    assert found.splits.max() < 1e-10
    assert exact.own.shape[0] == 2 * 5 * exact.shell.mesh.around  # each ring turns about the normal by itself


@pytest.mark.slow
def test_a_stiffener_at_the_end_is_a_ring_on_the_edge(casing):
    near = casing(0.25 - 1e-5)
    edge = casing(supports={"base": cf.Clamped(), "top": near.rings["stiffener 1"]})
    end, on_edge, bare = map(firsts, (near, edge, casing()))
    for n in (3, 6, 8):
        assert end[n] == pytest.approx(on_edge[n], rel=1e-3)
        assert abs(end[n] / bare[n] - 1) > 0.01


@pytest.mark.slow
def test_eccentric_stiffeners_are_those_of_three_dimensional_bricks(casing):
    """Two rings of 12 x 4 mm outside or inside: bricks of `reports.verification.modes.stiffeners`, settled to 0.05 %.

    The beam touches the wall in a line, the web along 4 mm: the beam's frequencies are low, by up to 0.7 %.
    """
    bricks = {1.0: {2: 1152.0, 4: 645.3, 6: 680.4, 8: 863.0}, -1.0: {2: 1136.0, 4: 622.5, 6: 729.9, 8: 907.6}}
    for side, table in bricks.items():
        found = firsts(casing(0.08, 0.16, offset=(0.0075 * side, 0.0)))
        error = np.array([found[n] / exact - 1 for n, exact in table.items()])
        assert np.all((error < 0.0) & (error > -7e-3))
    centred = firsts(casing(0.08, 0.16, offset=(0.0, 0.0)))
    assert centred[6] < 0.8 * bricks[1.0][6]  # eccentricity matters


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"places": (0.0,)}, "stiffener-place"),
        ({"places": (0.25,)}, "stiffener-place"),
        ({"places": (0.1, 0.1)}, "stiffener-place"),
        ({"places": (np.nan,)}, "stiffener-place"),
        ({"places": (0.1,), "offset": None}, "ring-offset"),
        ({"places": (0.1,), "offset": (np.inf, 0.0)}, "ring-offset"),
        ({"places": (0.1,), "mesh": cf.ShellMesh(order=6, rows=2, around=21)}, "stiffener-off-line"),
        ({"places": (0.1,), "chart": cf.Panel(radius=0.3, length=0.25, angle=1.0), "supports": {}}, "stiffener-place"),
    ],
)
def test_refusals_name_the_stiffener(change, code, casing):
    parts = dict(change)
    with pytest.raises(cf.errors.ModelError, match=code):
        casing(*parts.pop("places"), **parts)


STUDY = f"""{STEEL}[chart]
kind = "cylinder"
radius = 0.3
height = 0.25
[shell]
thickness = 3e-3
[support.base]
kind = "clamped"
[[stiffener]]
at = 0.08
width = 0.012
depth = 0.004
offset = [0.0075, 0.0]
[[stiffener]]
at = AT
diameter = 0.01
offset = [-0.0065, 0.0]
material = {{E = 70e9, nu = 0.33, rho = 2700.0}}
"""


def test_a_study_has_stiffeners(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(STUDY.replace("AT", "0.16"))
    bar, wire = cf.load_study(file).structure.stiffeners
    assert (bar.at, bar.section, bar.offset, bar.material) == (0.08, BAR, OUTSIDE, None)
    assert (wire.section, wire.material.E) == (cf.edge.Section.circle(diameter=0.01), 70e9)
    file.write_text(STUDY.replace("AT", "0.5"))
    with pytest.raises(ValueError, match=r"stiffener\[2\].at: found 0.5 m.*stiffener-place"):
        cf.load_study(file)
