"""A rub on a line inside a casing: the radius of the line, not that of an edge, gives sliding speed and heat."""

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
import contact as ct
from casingfem.cli import main

TITANIUM = cf.Material(E=114e9, nu=0.34, rho=4430.0)
LINE, EDGE = 0.58, 0.54  # radii [m] of the wall at z = 0.15 m and at the top
MU, HZ = 0.15, 20.0


@pytest.fixture(scope="module")
def track():
    casing = cf.Shell(
        chart=cf.Frustum(r_base=0.62, r_top=EDGE, height=0.3), thickness=3.5e-3, material=TITANIUM,
        supports={"base": cf.Clamped()}, strips=(cf.Strip(start=0.2, end=0.3, thickness=5e-3),),
        mesh=cf.ShellMesh(order=4, rows=(0.0, 0.5, 2 / 3, 1.0), around=13),
    )  # fmt: skip
    return cf.reduce(casing, cf.Rim(lines=(0.15,), n_max=5), modes=10, zeta=0.1)


@pytest.fixture(scope="module")
def tip():
    plate = cf.Shell(
        chart=cf.Plate(length=0.15, width=0.06), thickness=4e-3, material=TITANIUM, supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=4, rows=1, around=1),
    )  # fmt: skip
    return ct.ModalBody.of(cf.reduce(plate, cf.Tip("tip"), modes=2, zeta=0.1))


def heat_over_expected(rub, radius):
    """Heat of a run over mu N 2 pi f R t, N t the impulse of the contact."""
    run = ct.run(rub, law=ct.Coulomb(mu=MU), scheme=ct.ExactModal(), t_end=0.05, dt=2e-5)
    assert run.impulse[0] > 0.0
    return float(run.notes.heat.sum()) / (MU * float(run.impulse[0]) * 2.0 * np.pi * HZ * radius)


def rubs(casing, tip):
    """The same rub as a rim and one blade, and as a rub of one tip."""
    yield ct.RotatingRim(casing, tip, clearance=-5e-5, speed_hz=HZ, lean_deg=15.0)
    yield ct.Rub(casing, (tip,), tips=(ct.ContactPoint(lean_deg=15.0),), clearance=-5e-5, speed=ct.Speed.constant(HZ))


@pytest.mark.slow
def test_heat_of_a_rub_on_a_line_is_that_of_the_line_s_radius(track, tip, tmp_path):
    body = ct.ModalBody.load(track.save(tmp_path / "casing.npz"))
    assert (body.line_radius(0), body.line_wall(0)) == (pytest.approx(LINE, rel=1e-12), pytest.approx(3.5e-3))
    assert track.radius == pytest.approx(LINE, rel=1e-12)
    for rub in rubs(body, tip):
        assert heat_over_expected(rub, LINE) == pytest.approx(1.0, abs=2e-3)  # the rest is the tip's own swing


@pytest.mark.slow
def test_a_basis_with_one_radius_for_all_lines_still_reads(track, tip):
    """As bases were before lines had radii and walls."""
    arrays = {name: value for name, value in track.arrays().items() if name not in ("lines", "line_thickness")}

    class Old:
        def arrays(self):
            return arrays | {"radius": np.array(EDGE)}

    old = ct.ModalBody.of(Old())
    assert (old.line_radius(0), old.line_wall(0)) == (EDGE, pytest.approx(3.5e-3))
    for rub in rubs(old, tip):
        assert heat_over_expected(rub, EDGE) == pytest.approx(1.0, abs=2e-3)


def test_walls_of_lines_fit_the_lines(track):
    with pytest.raises(ct.InputError, match=r"line_thickness: found shape \(2,\), expected \(1,\)"):
        ct.ModalBody.of(Changed(track, line_thickness=np.array([1e-3, 1e-3])))
    with pytest.raises(ct.InputError, match=r"line_thickness: found 0\.0, expected a finite number > 0"):
        ct.ModalBody.of(Changed(track, line_thickness=np.zeros(1)))


class Changed:
    """A basis with some arrays replaced."""

    def __init__(self, basis, **arrays):
        self.values = basis.arrays() | arrays

    def arrays(self):
        return self.values


STUDY = """[material]
E = 114e9
nu = 0.34
rho = 4430.0
[chart]
kind = "frustum"
r_base = 0.62
r_top = 0.54
height = 0.3
[shell]
thickness = 3.5e-3
[support.base]
kind = "clamped"
[reduce]
lines = [{at}]
n_max = 5
modes = 10
zeta = 0.01
[mesh]
order = 4
rows = 2
around = 13
"""


@pytest.mark.slow
def test_lines_alone_name_an_interface_of_a_study(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(STUDY.format(at=0.15))
    done = CliRunner().invoke(main, ["reduce", str(file), "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    assert ct.ModalBody.load(next(tmp_path.glob("*.npz"))).line_radius(0) == pytest.approx(LINE, rel=1e-12)
    file.write_text(STUDY.format(at=0.35))
    refused = CliRunner().invoke(main, ["reduce", str(file), "--out", str(tmp_path)])
    assert refused.exit_code == 2
    assert "reduce: lines: found 0.35 m, expected places from 0 to 0.3 m" in " ".join(refused.output.split())
