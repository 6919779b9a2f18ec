"""Rings and point masses as parameters: numbers by name, exact derivatives, and back into a study."""

from dataclasses import replace

import pytest

import casingfem as cf
from tests.casingfem.slopes import assert_slopes
from tests.casingfem.study.study_texts import THIN, written

STUDY = (
    THIN
    + """
[support.base]
kind = "ring"
width = 0.03
depth = 0.02
material = {E = 200e9, nu = 0.3, rho = 7800.0}
[support.base.support]
kind = "elastic"
k_r = 3e8
k_theta = 2e8
k_z = 4e8
[[mass]]
edge = "base"
angle_deg = 10.0
mass = 0.1
[[mass]]
edge = "top"
angle_deg = 20.0
mass = 0.02
"""
)


@pytest.fixture
def study(tmp_path):
    return cf.load_study(written(tmp_path, STUDY))


def test_a_rectangle_stays_one():
    ring = cf.edge.Section.rectangle(width=0.03, depth=0.02).with_number("width", 0.04)
    assert ring == cf.edge.Section.rectangle(width=0.04, depth=0.02)
    assert cf.edge.Section.circle(diameter=0.02).with_number("diameter", 0.03) == cf.edge.Section.circle(diameter=0.03)


def test_a_section_by_its_numbers_changes_one_of_them():
    free = replace(cf.edge.Section.rectangle(width=0.03, depth=0.02), J=1e-8)
    assert free.with_number("width", 0.04) == replace(free, width=0.04)
    with pytest.raises(KeyError, match="a section are width, depth, area"):
        free.number("diameter")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("mass.top.2.mass", "this shell: 1 on 'base', 1 on 'top'"),
        ("mass.top.1.weight", "expected mass.<edge>.<number>.mass or .angle"),
        ("support.base.section.colour", "a section are width"),
        ("support.base.material.G", "this ring are section.width, ..., material.E"),
    ],
)
def test_numbers_that_do_not_exist_are_refused(study, name, words):
    with pytest.raises(cf.errors.InputError) as caught:
        cf.updating.get_value(study.shell, name)
    assert words in str(caught.value)


@pytest.mark.slow
def test_derivatives_equal_central_differences(study):
    """A number of the section reaches the ring's stiffness and its inertia, alone or with those that follow it."""
    waves = cf.FourierField.of({8: (0.002, 0.001), 3: 0.001})
    shell = replace(study.shell, radius_defect=waves, mesh=cf.ShellMesh(order=5, rows=1, around=9))
    found = cf.modes(shell, 8)
    for ring, masses in (
        (("section.width", "material.E", "material.rho"), ("mass.base.1.mass", "mass.top.1.mass", "mass.top.1.angle")),
        (("section.area", "section.I_r", "section.I_z", "section.J"), ()),
    ):
        names = [*(f"support.base.{name}" for name in ring), *masses]
        vary = [cf.Parameter(name=name, lower=1e-30, upper=1e30) for name in names]
        assert_slopes(shell, found, vary, part=3e-5, within=1e-7)
