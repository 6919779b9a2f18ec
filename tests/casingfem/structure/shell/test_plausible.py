"""Which shells are doubted and which are refused: both sides of each threshold."""

import warnings

import pytest

import casingfem as cf

MESH = cf.ShellMesh(order=4, rows=1, around=9)
BAR = cf.edge.Section.rectangle(width=0.02, depth=0.01)


def shell(chart=None, thickness=2e-3, E=210e9, nu=0.3, rho=7800.0, **parts):
    chart = cf.Plate(length=0.3, width=0.1) if chart is None else chart
    parts = {"mesh": MESH if "mesh" not in parts else parts["mesh"]} | parts
    return cf.Shell(chart=chart, thickness=thickness, material=cf.Material(E=E, nu=nu, rho=rho), **parts)


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        (
            {"supports": {"left": cf.Ring(section=BAR)}},
            r"support\.left: found a ring on an edge that runs along the axis",
        ),
        (
            {"supports": {"root": cf.Ring(section=BAR), "left": cf.Clamped()}},
            "a ring that ends on the fixed edge 'left'",
        ),
        ({"supports": {"top": cf.Clamped()}}, "this chart has no edge 'top'; it has root, tip, left, right"),
        ({"supports": {"root": 3.0}}, "expected Clamped, .*, Ring, found float"),
        (
            {"masses": {"bas": [cf.edge.EdgeMass(angle=0.0, mass=1.0)]}},
            r"masses\.bas: found \[EdgeMass\(angle=0\.0, mass=1\.0\)\], expected values EdgeMass, on one of root, tip",
        ),
        ({"masses": {"root": [0.1]}}, r"masses\.root: found \[0\.1\], expected values EdgeMass, on one of root"),
        (
            {"strips": (cf.Strip(start=0.2, end=0.31, thickness=1e-3),)},
            r"strip\[1\] from 0\.2 to 0\.31 m reaches beyond the shell",
        ),
        (
            {"stiffeners": (cf.edge.Stiffener(at=0.1, section=BAR, offset=(0.01, 0.0)),)},
            "found an open shell, expected a clo",
        ),
        ({"thickness": 0.0}, "shell.thickness must be positive"),
        ({"shear_correction": 0.0}, "shell.shear_correction must be positive"),
        (
            {"supports": {"root": cf.Bolts(count=2, k=1.0, spacing=0.06, first_angle=-0.03, width=0.05)}},
            "from -0.055 to",
        ),
    ],
)
def test_parts_that_cannot_belong_together(parts, words):
    with pytest.raises(ValueError, match=words):
        shell(**parts)


def test_what_may_are_beside_a_ring():
    shell(supports={"root": cf.Ring(section=BAR), "tip": cf.Clamped()})
    shell(supports={"root": cf.Ring(section=BAR), "left": cf.ElasticEdge(k_r=1e6)})
    shell(supports={"left": cf.edge.Symmetry()}, masses={"left": [cf.edge.EdgeMass(angle=0.1, mass=1.0)]})


@pytest.mark.parametrize(("deepest", "refused"), [(-0.999, False), (-1.0, False), (-1.001, True)])
def test_springs_may_vanish_and_not_push(deepest, refused):
    def made():
        edge = cf.ElasticEdge(k_r=1e6, k_z=1e6, around={"k_z": cf.FourierField.of({0: deepest})})
        return shell(supports={"root": edge})

    if refused:
        with pytest.raises(
            ValueError,
            match=r"support.root.around.*multiply k_z by -0\.001",
        ):
            made()
    else:
        assert made().supports["root"].k_z == 1e6


@pytest.mark.parametrize(("value", "refused"), [(-0.89, ""), (-0.9, "-0.9"), (9.0, ""), (9.01, "9.01")])
def test_a_field_may_run_from_a_tenth_to_ten(value, refused):
    def made():
        return shell(thickness=1e-4, thickness_defect=cf.FourierField.of({0: value}))

    if refused:
        with pytest.raises(ValueError, match=f"the field reaches {refused}, expected values from -0.9 to 9"):
            made()
    else:
        made()


def test_a_field_needs_two_nodes_a_wave():
    """Four times nine nodes around carry 18 waves."""
    tube = cf.Cylinder(radius=0.4, height=0.3)
    shell(chart=tube, radius_defect=cf.FourierField.of({18: 1e-3}))
    with pytest.raises(ValueError, match="radius_defect: 19 waves on 36 nodes around; the mesh resolves 18 at most"):
        shell(chart=tube, radius_defect=cf.FourierField.of({19: 1e-3}))
    shell(chart=cf.Panel(radius=0.4, length=0.3, angle=1.0), radius_defect=cf.FourierField.of({19: 1e-3}))


SPRING = {"root": cf.ElasticEdge(k_r=1e9, k_theta=1e9, k_z=1e9)}
TUBE = cf.Cylinder(radius=0.1, height=0.3)
MASS = cf.edge.EdgeMass(angle=0.0, mass=1.0)
DOUBTS = {
    "shell-thick", "shell-thin", "shear-correction", "support-soft", "mass-held", "material-units", "chart-units",
    "material-density-units", "material-poisson-negative", "chart-aspect", "chart-near-closed",
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("parts", "code"),
    [
        ({"chart": TUBE, "thickness": 0.0199}, ""),
        ({"chart": TUBE, "thickness": 0.0201}, "shell-thick"),  # 0.2 of the radius of curvature
        ({"chart": cf.Panel(radius=0.1, length=0.3, angle=1.0), "thickness": 0.0201}, "shell-thick"),
        ({"thickness": 0.0599}, ""),
        ({"thickness": 0.0601}, "shell-thick"),  # 0.6 of the side of 0.1 m
        ({"thickness": 3.3e-6}, ""),
        ({"thickness": 3.1e-6}, "shell-thin"),  # 1e-5 of the diagonal of 0.316 m
        ({"shear_correction": 0.5}, ""),
        ({"shear_correction": 1.0}, ""),
        ({"shear_correction": 1.01}, "shear-correction"),
        ({"shear_correction": 9.9}, "shear-correction"),
        ({"shear_correction": 10.0}, ""),
        ({"shear_correction": 0.49}, "shear-correction"),
        ({"shear_correction": 1.1}, "shear-correction"),
        ({"supports": {"root": cf.ElasticEdge(k_r=211.0)}}, ""),
        ({"supports": {"root": cf.ElasticEdge(k_r=209.0)}}, "support-soft"),  # 1e-9 of E
        (
            {"supports": {"root": cf.Clamped()}, "masses": {"root": [cf.edge.EdgeMass(angle=0.0, mass=1.0)]}},
            "mass-held",
        ),
        ({"E": 7800.0 * 200.0**2}, ""),
        ({"E": 7800.0 * 199.9**2}, "material-units"),  # sound at 200 m/s
        ({"E": 7800.0 * 20000.0**2}, ""),
        ({"E": 7800.0 * 20001.0**2}, "material-units"),
        ({"E": 1e6, "rho": 1.0}, ""),
        ({"E": 1e6, "rho": 0.99}, "material-density-units"),
        ({"E": 1e5, "rho": 0.01}, "material-density-units"),
        ({"E": 2e5, "rho": 0.009}, ""),
        ({"E": 25000.0 * 4000.0**2, "rho": 25000.0}, ""),
        ({"E": 25000.0 * 4000.0**2, "rho": 25001.0}, "material-density-units"),
        ({"nu": 0.0}, ""),
        ({"nu": -0.01}, "material-poisson-negative"),
        ({"chart": cf.Plate(length=24.0, width=7.0), "thickness": 0.05}, ""),
        ({"chart": cf.Plate(length=24.1, width=7.0), "thickness": 0.05}, "chart-units"),  # 25 m across
        ({"chart": cf.Plate(length=10.0, width=0.01), "thickness": 2e-3}, ""),
        ({"chart": cf.Plate(length=10.01, width=0.01), "thickness": 2e-3}, "chart-aspect"),  # 1000 to 1
        ({"chart": cf.Panel(radius=0.1, length=0.3, angle=6.22)}, ""),
        ({"chart": cf.Panel(radius=0.1, length=0.3, angle=6.221)}, "chart-near-closed"),  # 0.99 of a turn
    ],
)
def test_what_is_hardly_meant_is_doubted_on_one_side_of_its_bound(parts, code):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        cf.modes(shell(**({"supports": SPRING if "chart" not in parts else {}} | parts)), 2)
    found = {str(w.message).rpartition("[")[2].rstrip("]") for w in caught}
    assert found & DOUBTS == ({code} if code else set())
