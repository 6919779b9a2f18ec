"""Implausible numbers of a study are refused with the unit that was probably meant, unless the file allows them."""

import pytest

import casingfem as cf
from reports.verification.modes.mesh_files import WRITERS

STUDY = """
[material]
E = 210e9
nu = 0.3
rho = 7800.0
[chart]
kind = "cylinder"
radius = 0.45
height = 0.25
[shell]
thickness = 3e-3
[support.base]
kind = "clamped"
[rotation]
speed_hz = 80.0
[reduce]
interface = "top"
zeta = 0.002
"""
WRONG = [
    ("E = 210e9", "E = 210.0", "E", "material.E: found 210 Pa, expected 1e+06 to 1.3e+12 Pa", "210 GPa are 2.1e+11 Pa"),
    ("E = 210e9", "E = 210000.0", "E", "material.E: found 210000 Pa", "in MPa? 210000 MPa are 2.1e+11 Pa"),
    ("E = 210e9", "E = 30e6", "sound", "material.E: 3e+07 Pa, rho 7800 kg/m^3: sound found 62.0174", "in psi?"),
    ("= 7800.0", "= 7.8", "rho", "material.rho: found 7.8 kg/m^3", "7.8 g/cm^3 are 7800 kg/m^3"),
    ("= 7800.0", "= 7.8e-9", "rho", "material.rho: found 7.8e-09 kg/m^3", "7.8e-09 t/mm^3 are 7800 kg/m^3"),
    ("nu = 0.3", "nu = -0.3", "nu", "material.nu: found -0.3, expected 0 to 0.5", ""),
    ("= 0.45", "= 450.0", "size", "chart.radius: found 450 m", "450 mm are 0.45 m"),
    ("= 3e-3", "= 3.0", "thickness", "shell.thickness: found 3 m", "3 mm are 0.003 m"),
    ("= 3e-3", "= 0.3", "thickness", "shell.thickness: found 0.3 m, expected at most 0.5 of chart.radius", "in mm?"),
    ("= 0.002", "= 0.5", "zeta", "reduce.zeta: found 0.5, expected 0 to 0.2", "0.5 percent are 0.005"),
    ("= 80.0", "= 4800.0", "speed", "rotation.speed_hz: found 4800 Hz = 288,000 rpm", "4800 rpm are 80 Hz"),
]


def problems_of(file):
    try:
        cf.load_study(file)
    except cf.errors.InputError as error:
        return str(error)
    return ""


@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
@pytest.mark.parametrize(("old", "new", "name", "key", "slip"), WRONG)
def test_a_number_in_another_unit_is_refused_with_the_slip_and_taken_where_allowed(tmp_path, old, new, name, key, slip):
    file = tmp_path / "study.toml"
    file.write_text(STUDY.replace(old, new))
    with pytest.raises(cf.errors.InputError) as caught:
        cf.load_study(file)
    found = str(caught.value)
    assert key in found
    assert slip in found
    assert "study-implausible" in caught.value.codes
    file.write_text(f'{file.read_text()}[checks]\nallow = ["{name}"]\n')
    assert f'allow = ["{name}"]' not in problems_of(file)  # a rim of 450 m is too fast at 80 turns/s


@pytest.mark.parametrize(
    ("E", "rho", "radius", "refused"),
    [
        (1.0, 1.0, 450.0, ""),
        (1.0, 1.0, 0.45, ""),
        (2.0, 2.0, 0.45, "material.E: found 2 Pa"),
        (2.0, 1.0, 0.45, "material.E: found 2 Pa"),
        (7800.0, 7800.0, 0.45, "material.E: found 7800 Pa"),
    ],
)
def test_a_study_whose_modulus_and_density_are_1_has_no_units(E, rho, radius, refused, tmp_path):
    """Lengths, modulus, density and speed of sound are not checked then, and only then."""
    text = (
        STUDY.replace("E = 210e9", f"E = {E}").replace("rho = 7800.0", f"rho = {rho}").replace("= 0.45", f"= {radius}")
    )
    (tmp_path / "study.toml").write_text(text.replace("speed_hz = 80.0", "speed_hz = 1e-5"))
    found = problems_of(tmp_path / "study.toml")
    assert refused in found
    assert ("plausible" in found or "allow" in found) == bool(refused), found


def test_a_percentage_that_the_schema_refuses_is_named_too(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(STUDY.replace("= 0.002", "= 2.0"))
    with pytest.raises(
        cf.errors.InputError, match=r"reduce.zeta: found 2.0, expected less than 1 .*2 percent are 0.02"
    ):
        cf.load_study(file)


SOLID = """
[material]
E = 210e9
nu = 0.3
rho = 7800.0
[solid]
mesh = "MESH"
[support.root]
kind = "clamped"
[rotation]
speed_hz = 80.0
"""


@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
@pytest.mark.parametrize(
    ("axis", "centre", "refused"),
    [
        ("[0.0, 0.0, 2.0]", "[0.0, 0.0, 0.0]", False),  # 30 m along the axis is no radius
        ("[0.0, 0.0, -1.0]", "[0.2, 0.0, -90.0]", False),
        ("[1.0, 0.0, 0.0]", "[0.0, 0.0, 0.0]", True),
        ("[1.0, 0.0, 0.0]", "[0.0, 0.0, 30.0]", False),
        ("[0.0, 0.0, 1.0]", "[30.0, 0.0, 0.0]", True),
    ],
)
def test_the_speed_of_the_tip_is_that_at_its_distance_from_the_axis(axis, centre, refused, tmp_path):
    file, write = WRITERS["Gmsh 2.2, text"]
    ends = {"root": (0, 0.0), "tip": (0, 1.0)}
    place = cf.imported.grid_mesh("hexahedron20", (2, 1, 1), lambda u: u * [0.2, 0.05, 0.01] + [0, 0, 30], groups=ends)
    write(place, tmp_path / file)
    study = tmp_path / "study.toml"
    study.write_text(SOLID.replace("MESH", file) + f"axis = {axis}\ncentre = {centre}\n")
    assert ("rotation" in problems_of(study)) is refused
