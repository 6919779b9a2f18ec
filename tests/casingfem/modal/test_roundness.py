"""A measured radius is the same series from the shell to the gap."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
import contact as ct

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
WAVES = {2: (1e-3, -4e-4), 5: (0.0, 2e-4), 8: (3e-4, 0.0)}
FIELD = cf.FourierField.of(WAVES)
CASING = cf.Shell(
    chart=cf.Frustum(r_base=0.5, r_top=0.4, height=0.2), thickness=3e-3, material=STEEL,
    supports={"base": cf.Clamped()}, radius_defect=FIELD, mesh=cf.ShellMesh(order=6, rows=1, around=8),
)  # fmt: skip
TOP = cf.Rim("top", n_max=10)
SCENE = """[scene]
kind = "rim"
t_end = 1e-3
[casing]
basis = "casing.npz"
[blade]
basis = "blade.npz"
[contact]
clearance = 1e-3
out_of_roundness = {}
[speed]
turning = "blades"
hz = 5.0
[scheme]
kind = "exact-modal"
dt = 1e-5
"""


def at(terms, theta):
    return sum(t["cos"] * np.cos(t["p"] * theta) + t["sin"] * np.sin(t["p"] * theta) for t in terms)


def test_it_is_the_radius_of_the_surface_less_its_mean():
    theta = np.linspace(0.0, 6.0, 41)
    x = CASING.geometry(np.full(theta.size, 0.2), theta).surface.x
    np.testing.assert_allclose(
        at(cf.modal.out_of_roundness(CASING, TOP), theta), np.hypot(x[0], x[1]) - 0.4, atol=1e-15
    )


def test_it_grows_with_the_defect_and_turns_with_it():
    """Twice the defect, turned by an angle: a cos p(theta - angle) + b sin p(theta - angle)."""
    theta, angle = np.linspace(0.0, 6.0, 41), 0.7
    turned = {}
    for p, (a, b) in WAVES.items():
        c, s = np.cos(p * angle), np.sin(p * angle)
        turned[p] = (2.0 * (a * c - b * s), 2.0 * (a * s + b * c))
    fields = FIELD, cf.FourierField.of(turned)
    one, two = (cf.modal.out_of_roundness(replace(CASING, radius_defect=field), TOP) for field in fields)
    np.testing.assert_allclose(at(two, theta), 2.0 * at(one, theta - angle), atol=1e-15)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    where = tmp_path_factory.mktemp("bases")
    cf.reduce(CASING, TOP, modes=6).save(where / "casing.npz")
    strip = cf.Shell(
        chart=cf.Plate(length=0.11, width=0.04), thickness=5e-3, material=STEEL, supports={"root": cf.Clamped()}
    )
    cf.reduce(strip, cf.Tip(), modes=2).save(where / "blade.npz")
    return where


@pytest.mark.slow
def test_the_basis_carries_it_to_the_scene(folder):
    terms = cf.modal.out_of_roundness(CASING, TOP)
    assert ct.ModalBody.load(folder / "casing.npz").roundness() == terms
    (folder / "scene.toml").write_text(SCENE.format('"basis"'))
    given = ", ".join(f"{{p = {t['p']}, cos = {t['cos']!r}, sin = {t['sin']!r}}}" for t in terms)
    (folder / "given.toml").write_text(SCENE.format(f"[{given}]"))
    named, listed = (ct.load_scene(folder / name).what for name in ("scene.toml", "given.toml"))
    assert list(named.out_of_roundness) == list(listed.out_of_roundness) == terms


def test_a_basis_without_it_is_refused_with_the_key(folder, tmp_path):
    body = replace(ct.ModalBody.load(folder / "casing.npz"), out_of_roundness=None)
    body.save(tmp_path / "casing.npz")
    (tmp_path / "blade.npz").write_bytes((folder / "blade.npz").read_bytes())
    (tmp_path / "scene.toml").write_text(SCENE.format('"basis"'))
    with pytest.raises(ct.InputError, match=r"scene\.toml: out_of_roundness: found none in the basis, expected"):
        ct.load_scene(tmp_path / "scene.toml")
    (tmp_path / "scene.toml").write_text(SCENE.format('"survey"'))
    with pytest.raises(ct.InputError, match=r"contact\.out_of_roundness"):
        ct.load_scene(tmp_path / "scene.toml")


def test_arrays_that_do_not_fit_are_refused(folder):
    body = ct.ModalBody.load(folder / "casing.npz")
    with pytest.raises(ct.InputError, match=r"out_of_roundness: found shape \(1, 5\), expected \(1, 21\)"):
        replace(body, out_of_roundness=np.zeros((1, 5)))
