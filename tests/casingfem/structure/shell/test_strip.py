"""Strips: exact solutions, the meridian against the shell, mass and springs side by side, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from reports.verification import strips as verify_strips
from reports.verification.strips import ALUMINIUM, exact, found, refined, stepped
from tests.casingfem.slopes import assert_slopes

STRIPS = (
    cf.Strip(start=0.24, end=0.25, thickness=12e-3),
    cf.Strip(start=0.1, end=0.15, thickness=5e-3, material=ALUMINIUM),
)


@pytest.mark.parametrize(("n", "m", "within"), [(0, 1, 1e-9), (2, 2, 1e-6), (5, 1, 1e-6)])
def test_a_stepped_cylinder_is_its_exact_solution(n, m, within):
    shell = refined(stepped(), 14)
    omega = found(shell, n, m)[m - 1]
    assert omega == pytest.approx(exact(n, m, omega), rel=within)


def test_every_verification_row_passes_on_the_default_mesh():
    rows = verify_strips.rows(quick=True)
    assert {row["verdict"] for row in rows} == {"pass"}
    assert len(rows) == 7


@pytest.mark.slow
@pytest.mark.parametrize(
    "edge",
    [cf.Clamped(), cf.ElasticEdge(k_face=1e12)],
    ids=["clamped", "elastic"],
)
def test_the_shell_agrees_with_its_meridian(frustum, edge):
    casing = frustum(
        chart=cf.Frustum(r_base=0.2, r_top=0.18, height=0.3), thickness=10e-3, supports={"top": edge},
        strips=(cf.Strip(start=0.2, end=0.3, thickness=14e-3, material=ALUMINIUM),),
        mesh=cf.ShellMesh(order=10, rows=(0.0, 2 / 3, 1.0), around=7),
    )  # fmt: skip
    shell, meridian = (cf.modes(casing, 6, method=method) for method in ("shell", "fourier"))
    np.testing.assert_allclose(shell.freq, meridian.freq, rtol=1e-9)
    np.testing.assert_array_equal(shell.nodal_diameters, meridian.nodal_diameters)


@pytest.fixture(scope="module")
def uneven(frustum):
    """A casing of strips with a radius field, and its modes."""
    mesh = cf.ShellMesh(order=5, rows=(0.0, 0.4, 0.6, 0.96, 1.0), around=9)
    casing = frustum(strips=STRIPS, mesh=mesh, radius_defect=cf.FourierField.of({8: 0.002, 3: 0.001}))
    return casing, cf.modes(casing, 6)


@pytest.mark.slow
def test_derivatives_equal_central_differences(uneven):
    names = ("strip.1.thickness", "strip.2.thickness", "strip.2.material.E", "strip.2.material.rho", "material.E")
    vary = [cf.Parameter(name=name, lower=1e-4, upper=1e12) for name in names]
    assert_slopes(*uneven, vary, part=1e-4, within=2e-7, of=lambda values: values.reshape(3, 2).mean(axis=1))


def test_the_default_mesh_has_a_line_at_each_end(frustum, steel):
    casing = frustum(strips=STRIPS)
    assert {0.4, 0.6, 0.96} <= {round(x, 12) for x in casing.mesh.rows}
    plate = cf.Shell(chart=cf.Plate(length=1.0, width=0.5), thickness=0.01, material=steel,
                     strips=(cf.Strip(start=0.0, end=0.1, thickness=0.02),))  # fmt: skip
    assert 0.1 in [round(x, 12) for x in plate.mesh.rows]


@pytest.mark.parametrize(
    ("strips", "code"),
    [
        ([(0.2, 0.3)], "strip-outside"),
        ([(-0.1, 0.1)], "strip-outside"),
        ([(0.1, 0.2), (0.05, 0.11)], "strip-overlap"),
        ([(0.1, 0.2), (0.1, 0.2)], "strip-overlap"),
    ],
)
def test_refuses_strips_that_do_not_fit(frustum, strips, code):
    with pytest.raises(cf.errors.ModelError, match=r"strip\[\d\] from") as caught:
        frustum(strips=[cf.Strip(start=a, end=b, thickness=1e-3) for a, b in strips])
    assert caught.value.code == code


def test_refuses_a_mesh_that_would_smear_a_strip(frustum):
    with pytest.raises(
        cf.errors.ModelError, match=r"strip\[2\] from 0.1 to 0.15 m: no element line at 0.1 m"
    ) as caught:
        frustum(strips=STRIPS, mesh=cf.ShellMesh(order=4, rows=4, around=9))
    assert caught.value.code == "strip-off-line"


@pytest.mark.parametrize("ends", [(0.2, 0.1), (0.1, 0.1), (np.nan, 0.1), (0.1, np.inf)])
def test_refuses_ends_that_are_none(ends):
    with pytest.raises(cf.errors.ModelError, match="strip: found start") as caught:
        cf.Strip(start=ends[0], end=ends[1], thickness=1e-3)
    assert caught.value.code == "strip-extent"


@pytest.mark.parametrize("thickness", [0.0, -1e-3, np.nan])
def test_refuses_a_strip_without_a_wall(thickness):
    with pytest.raises(cf.errors.ModelError, match=r"strip\.thickness must be positive"):
        cf.Strip(start=0.0, end=0.1, thickness=thickness)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("strip.3.thickness", "expected a number from 1 to 2"),
        ("strip.0.thickness", "expected a number from 1 to 2"),
        ("strip.x.thickness", "found strip 'x'"),
        ("strip.1.start", "of a strip, expected one of thickness"),
        ("strip.2.material.G", "of a strip, expected one of thickness"),
        ("strip.1.material.E", "a material of its own"),
    ],
)
def test_names_what_a_strip_has(frustum, name, message):
    with pytest.raises(cf.errors.InputError, match=message):
        cf.updating.get_value(frustum(strips=STRIPS), name)


def test_a_strip_without_a_material_follows_the_wall(frustum):
    stiff = cf.updating.with_value(frustum(strips=STRIPS), "material.E", 1e11)
    at = stiff.geometry(np.array([0.05, 0.12, 0.245]), np.zeros(3))
    assert at.E.tolist() == [1e11, ALUMINIUM.E, 1e11]
    assert at.thickness.tolist() == [3e-3, 5e-3, 12e-3]
    assert at.rho.tolist() == [7800.0, 2700.0, 7800.0]
    assert replace(stiff, strips=()).geometry(np.array([0.12]), np.zeros(1)).nu.tolist() == [0.3]
