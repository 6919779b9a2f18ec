"""Parameter paths: reading, replacing, and every way a name can be wrong."""

import numpy as np
import pytest

import casingfem as cf

PATHS = {
    "material.E": 210e9,
    "material.nu": 0.3,
    "material.rho": 7800.0,
    "shell.thickness": 3e-3,
    "chart.r_base": 0.5,
    "chart.r_top": 0.45,
    "chart.height": 0.25,
    "radius.p8.cos": 0.002,
    "radius.p8.sin": -0.001,
    "radius.p5.cos": 0.0,
    "thickness.p2.cos": 0.03,
    "thickness.p3.sin": 0.0,
    "support.base.k_face": 5e12,
    "support.base.k_r": 1e8,
    "support.base.k_theta": 0.0,
    "support.base.k_z": 0.0,
    "support.base.k_rot": 0.0,
    "support.base.k_face.p4.cos": 0.2,
    "support.base.k_r.p4.sin": 0.1,
    "support.base.around.p4.cos": 0.2,
    "modulus.p4.cos": 0.02,
    "density.p2.sin": 0.03,
    "support.base.k_face.p6.sin": 0.0,
}


@pytest.fixture(scope="module")
def casing(frustum):
    edge = cf.ElasticEdge(k_face=5e12, k_r=1e8, around=cf.FourierField.of({4: (0.2, 0.1)}))
    return frustum(
        supports={"base": edge, "top": cf.Clamped()},
        radius_defect=cf.FourierField.of({8: (0.002, -0.001), 3: 0.001}),
        thickness_defect=cf.FourierField.of({2: 0.03}),
        modulus_defect=cf.FourierField.of({4: 0.02}),
        density_defect=cf.FourierField.of({2: (0.0, 0.03)}),
        mesh=cf.ShellMesh(order=3, rows=1, around=7),
    )


@pytest.mark.parametrize("name", PATHS)
def test_value_is_read(casing, name):
    assert cf.updating.get_value(casing, name) == PATHS[name]


@pytest.mark.parametrize("name", PATHS)
def test_value_is_replaced_and_nothing_else_changes(casing, name):
    value = 0.4 if name == "material.nu" else 1.1 * PATHS[name] + 1e-4
    changed = cf.updating.with_value(casing, name, value)
    assert cf.updating.get_value(changed, name) == pytest.approx(value, rel=1e-15)
    for other, expected in PATHS.items():
        if other != name and not one_pattern(name, other):
            assert cf.updating.get_value(changed, other) == expected, other
    assert cf.updating.get_value(casing, name) == PATHS[name]
    assert changed.mesh is casing.mesh


def one_pattern(name, other):
    """Whether one of two patterns' names is "around", which moves and reads all springs, and the harmonic the same."""
    first, second = name.split("."), other.split(".")
    return first[0] == second[0] == "support" and first[3:] == second[3:] != [] and "around" in (first[2], second[2])


def test_a_spring_leaves_the_pattern_it_shared(casing):
    changed = cf.updating.with_value(casing, "support.base.k_r.p4.cos", 0.5)
    values = [cf.updating.get_value(changed, f"support.base.{k}.p4.cos") for k in ("k_r", "k_face", "k_z")]
    assert values == [0.5, 0.2, 0.2]
    with pytest.raises(cf.errors.InputError, match="the springs of this edge, expected one value for all; name one"):
        cf.updating.get_value(changed, "support.base.around.p4.cos")
    both = cf.updating.with_value(changed, "support.base.around.p4.sin", 0.3)
    assert (
        cf.updating.get_value(both, "support.base.around.p4.sin")
        == cf.updating.get_value(both, "support.base.k_z.p4.sin")
        == 0.3
    )


def test_a_shell_without_fields_gets_one(frustum):
    shell = cf.updating.with_value(frustum(), "radius.p4.sin", 0.001)
    assert cf.updating.get_value(frustum(), "radius.p4.sin") == 0.0
    theta = np.linspace(0, 6, 7)
    np.testing.assert_allclose(shell.radius_defect.derivatives(0.1, theta).value, 0.001 * np.sin(4 * theta), atol=1e-18)
    assert cf.updating.with_value(frustum(), "thickness.p2.cos", 0.1).thickness_defect is not None


def test_a_survey_is_varied_through_its_fit(frustum):
    theta = np.tile(np.arange(0, 360, 5.0), 2)
    z = np.repeat([0.0, 0.25], 72)
    radius = (0.5 - 0.2 * z) * (1 + 0.002 * np.cos(np.radians(4 * theta)))
    survey = cf.SurveyField.from_points(np.radians(theta), z, radius)
    shell = frustum(radius_defect=survey)
    assert cf.updating.get_value(shell, "radius.p4.cos") == pytest.approx(0.002, rel=1e-6)
    assert cf.updating.get_value(cf.updating.with_value(shell, "radius.p4.cos", 0.003), "radius.p4.cos") == 0.003


@pytest.mark.slow
def test_complex_values_pass(casing):
    for name in PATHS:
        step = cf.updating.with_value(casing, name, PATHS[name] + 1e-30j)
        assert np.imag(cf.updating.get_value(step, name)) == 1e-30, name


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("E", "a parameter"),
        ("", "a parameter"),
        ("material.G", r"'material\.G': found no 'G' in material, expected one of E, nu, rho"),
        ("chart.radius", r"'chart\.radius': found no 'radius' in chart, expected one of r_base, r_top, height"),
        ("shell.mesh", r"'shell\.mesh': found no 'mesh' in shell, expected one of thickness"),
        ("shell.thickness.p2", "expected nothing after it, as it is one number"),
        ("bolts.3.k", "0 edges with bolts"),
        ("radius.8.cos", "expected a harmonic such as p8.cos, found '8.cos'"),
        ("radius.p8.tan", "expected a harmonic such as p8.cos"),
        ("radius.p8", "starts with material"),
        ("support.base", "starts with material"),
        (
            "support.base.E",
            r"an elastic edge, expected one of k_r, k_theta, k_z, k_rot, k_face \(did you mean support\.base\.k_z\?\)",
        ),
        ("support.base.k_face.p4", "an elastic edge"),
        ("support.base.k_face.4.cos", "expected a harmonic"),
        ("support.rim.k_face", "found no support"),
        ("support.top.k_face", "edge 'top', expected an elastic edge"),
    ],
)
def test_names_that_are_none(casing, name, message):
    with pytest.raises(cf.errors.InputError, match=message):
        cf.updating.get_value(casing, name)
    with pytest.raises(cf.errors.InputError, match=message):
        cf.updating.with_value(casing, name, 1.0)


class Ripple:
    def derivatives(self, z, theta):
        zero = np.zeros(np.broadcast(z, theta).shape)
        return cf.field.FieldValues(*[zero] * 6)

    def rotated(self, angle):
        return self


def test_a_field_that_is_no_series_has_no_harmonics(frustum):
    shell = frustum(radius_defect=Ripple())
    with pytest.raises(cf.errors.InputError, match=r"a Fourier series \(FourierField\)"):
        cf.updating.get_value(shell, "radius.p8.cos")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"lower": 2.0, "upper": 1.0}, "lower < upper"),
        ({"lower": 1.0, "upper": 1.0}, "lower < upper"),
        ({"lower": float("nan"), "upper": 1.0}, "bounds must be finite"),
        ({"lower": 0.0, "upper": float("inf")}, "bounds must be finite"),
        ({"lower": 0.0, "upper": 1.0, "log": True}, "found lower ="),
        ({"lower": 1.0, "upper": 2.0, "sigma": 0.0}, "sigma must be positive"),
        ({"lower": 1.0, "upper": 2.0, "sigma": -1.0}, "sigma must be positive"),
        ({"lower": 1.0, "upper": 2.0, "sigma": float("nan")}, "sigma must be positive"),
    ],
)
def test_refuses_bounds_and_priors_that_are_none(values, message):
    with pytest.raises(cf.errors.InputError, match=message):
        cf.Parameter(name="material.E", **values)


@pytest.mark.parametrize("value", [1e-6, 0.3, 1.0, 7.0, 1e14])
def test_log_parameters_are_varied_in_decades(value):
    parameter = cf.Parameter(name="support.base.k_face", lower=1e-7, upper=1e15, log=True)
    assert parameter.from_internal(parameter.to_internal(value)) == pytest.approx(value, rel=1e-12)
    assert parameter.to_internal(10 * value) - parameter.to_internal(value) == pytest.approx(1.0, rel=1e-12)
    plain = cf.Parameter(name="material.E", lower=0.0, upper=1.0)
    assert plain.from_internal(plain.to_internal(value)) == value


def test_a_profile_is_no_number(steel):
    """It was handed on as one, and the program ended in a traceback."""
    bowl = cf.Shell(
        chart=cf.Revolved(profile=cf.geometry.Arc(radius=0.5, start=0.0, end=1.0)), thickness=3e-3, material=steel
    )
    with pytest.raises(cf.errors.InputError, match=r"'chart\.profile': found no 'profile'"):
        cf.updating.get_value(bowl, "chart.profile")


def test_bolts_without_stiffness_have_none_to_change(frustum):
    """Three stiffnesses keep their ratios, which zeros do not have; `k_rot` is one number."""

    def bolted(frustum, k):
        return frustum(supports={"base": cf.Bolts(count=4, k=k, k_rot=1e3)})

    some = cf.updating.with_value(bolted(frustum, (0.0, 0.0, 1e-9)), "support.base.k", 2.0)
    np.testing.assert_allclose(some.supports["base"].stiffness, [0.0, 0.0, 2.0])
    for name in ("support.base.k", "support.base.bolts.3.k"):
        with pytest.raises(cf.errors.InputError, match=f"'{name}': found bolts with k = 0"):
            cf.updating.with_value(bolted(frustum, 0.0), name, 1e6)
    assert cf.updating.with_value(bolted(frustum, 0.0), "support.base.k_rot", 2e3).supports["base"].k_rot == 2e3
