"""What holds an edge, from its table: degrees and metres become angles, edges without angles take none."""

import re
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf
from casingfem.study.problems import Problems
from casingfem.study.supports import (
    build_masses,
    build_stiffeners,
    build_support,
    build_supports,
    require_angle,
    series,
)
from casingfem.study.tables.fields import Harmonic
from casingfem.study.tables.shapes import MassTable
from casingfem.study.tables.supports import BoltsTable, ElasticTable, RingTable, StiffenerTable
from casingfem.study.tables.tasks import StudyFile

FRUSTUM = cf.Frustum(r_base=0.5, r_top=0.4, height=0.25)
PANEL = cf.Panel(radius=0.3, length=0.2, angle=0.5)
BOLTS = {"kind": "bolts", "count": 3, "k": 1e8}


def support(table, edge="base", chart=FRUSTUM):
    return build_support(table, edge, chart)


def test_each_kind_of_support():
    tables = StudyFile.model_validate(
        {"support": {name: {"kind": name} for name in ("clamped", "shear-diaphragm", "symmetry")}}
    ).support
    kinds = [type(support(table)) for table in tables.values()]
    assert kinds == [cf.Clamped, cf.ShearDiaphragm, cf.edge.Symmetry]


def test_bolts_have_their_angles_in_radians():
    table = BoltsTable(**BOLTS, k_rot=2.0, first_angle_deg=-90.0, width_deg=9.0, spacing_deg=20.0)
    bolts = support(table)
    assert (bolts.count, bolts.k, bolts.k_rot) == (3, 1e8, 2.0)
    turns = (-np.pi / 2, np.pi / 20, np.pi / 9)
    assert (bolts.first_angle, bolts.width, bolts.spacing) == pytest.approx(turns, rel=1e-14)
    plain = support(BoltsTable(**BOLTS))
    assert (plain.first_angle, plain.width, plain.spacing, dict(plain.loose)) == (0.0, None, None, {})


@pytest.mark.parametrize(
    ("given", "k"), [({"k_r": 1.0}, (1.0, 0.0, 0.0)), ({"k_theta": 2.0, "k_z": 3.0}, (0.0, 2.0, 3.0))]
)
def test_stiffnesses_of_bolts_that_are_left_out_are_none(given, k):
    assert support(BoltsTable(kind="bolts", count=3, **given)).k == k


@pytest.mark.parametrize(("edge", "radius"), [("base", 0.5), ("top", 0.4)])
def test_a_width_in_metres_is_an_angle_on_the_radius_of_its_edge(edge, radius):
    bolts = support(BoltsTable(**BOLTS, width_m=0.06), edge)
    assert bolts.width == pytest.approx(0.06 / radius, rel=1e-14)


@pytest.mark.parametrize("chart", [PANEL, None])
def test_a_width_in_metres_wants_a_closed_casing(chart):
    with pytest.raises(ValueError, match="width_m: found an open edge, expected a closed casing; give width_deg"):
        support(BoltsTable(**BOLTS, width_m=0.06), "root", chart)


@pytest.mark.parametrize(
    ("chart", "edge", "angles"),
    [
        (None, "tip", True),
        (FRUSTUM, "top", True),
        (PANEL, "root", True),
        (PANEL, "left", False),
        (cf.Plate(length=0.2, width=0.1), "root", False),
        (cf.TwistedPlate(length=0.2, width=0.1, twist=0.1), "root", False),
    ],
)
def test_angles_are_for_edges_that_run_around_an_axis(chart, edge, angles):
    if angles:
        require_angle(chart, edge, "bolts")
        return
    with pytest.raises(ValueError, match=f"bolts: found an edge without angles, '{edge}', expected one that runs"):
        require_angle(chart, edge, "bolts")


def test_a_ring_has_its_section_offset_foot_and_support():
    ring = support(RingTable(kind="ring", width=0.04, depth=0.03, offset=[0.01, -0.02], foot=[0.03, 0.04],
                             support=ElasticTable(kind="elastic", k_z=5.0)))  # fmt: skip
    assert (ring.section, ring.material) == (cf.edge.Section.rectangle(width=0.04, depth=0.03), None)
    assert (ring.offset, ring.foot, ring.support) == ((0.01, -0.02), (0.03, 0.04), cf.ElasticEdge(k_z=5.0))
    bare = support(RingTable(kind="ring", diameter=0.02))
    assert (bare.section, bare.offset, bare.foot, bare.support) == (
        cf.edge.Section.circle(diameter=0.02),
        None,
        None,
        None,
    )


def test_springs_of_an_elastic_edge_go_by_their_names():
    k = {"k_r": 1.0, "k_theta": 2.0, "k_z": 3.0, "k_rot": 4.0, "k_face": 5.0}
    edge = support(ElasticTable(kind="elastic", **k, around={"k_theta": [{"p": 2, "sin": 0.1}], "k_z": []}))
    assert {name: getattr(edge, name) for name in k} == k
    assert {name: field.coefficients(2) for name, field in edge.around.items()} == {"k_theta": (0.0, 0.1)}
    for empty in ([], {"k_r": []}):
        assert support(ElasticTable(kind="elastic", k_r=1.0, around=empty)).around is None


@pytest.mark.parametrize(
    ("numbers", "least", "expected"),
    [
        ([5, 3], 0, None),
        ([3, 1], 1, None),
        ([], 1, None),
        ([3, 3], 0, "around: found harmonics [3, 3], expected each p once"),
        ([0, 3], 1, "around: found harmonics [0, 3], expected each p >= 1 once"),
        ([2, 2], 1, "around: found harmonics [2, 2], expected each p >= 1 once"),
    ],
)
def test_a_series_has_each_harmonic_once(numbers, least, expected):
    waves = [Harmonic(p=p, cos=0.1, sin=0.2) for p in numbers]
    if expected is None:
        field = series(waves, "around", least=least)
        assert [field.coefficients(p) for p in numbers] == [(0.1, 0.2)] * len(numbers)
        return
    with pytest.raises(ValueError, match=re.escape(expected)):
        series(waves, "around", least=least)


def test_a_series_may_have_a_mean_where_nothing_is_said():
    assert series([Harmonic(p=0, cos=0.1)], "harmonics").coefficients(0) == (0.1, 0.0)


def test_edges_without_a_chart_are_not_judged():
    problems = Problems(Path("s.toml"))
    tables = StudyFile.model_validate({"support": {"rim": {"kind": "clamped"}}}).support
    assert list(build_supports(tables, None, problems)) == ["rim"]
    masses = build_masses([MassTable(edge="rim", angle_deg=180.0, mass=0.5)], None, problems)
    assert [(mass.angle, mass.mass) for mass in masses["rim"]] == [(np.pi, 0.5)]
    assert problems == []


def test_a_wrong_edge_does_not_hide_the_right_one():
    problems = Problems(Path("s.toml"))
    tables = StudyFile.model_validate({"support": {"topp": {"kind": "clamped"}, "base": {"kind": "clamped"}}}).support
    assert list(build_supports(tables, FRUSTUM, problems)) == ["base"]
    (problem,) = problems
    assert problem.startswith("s.toml: support.topp: found edge 'topp', expected one of the chart's edges base, top")
    assert "top?" in problem
    assert problem.endswith("[support-edge]")
    problems.clear()
    masses = [MassTable(edge=edge, angle_deg=0.0, mass=0.5) for edge in ("rim", "top")]
    assert list(build_masses(masses, FRUSTUM, problems)) == ["top"]
    assert problems == ["s.toml: mass[1].edge: found 'rim', expected one of the chart's edges base, top [study-value]"]


def test_rings_on_the_wall_are_judged_where_there_is_a_wall():
    ring = StiffenerTable(at=0.3, offset=[0.02, 0.0], diameter=0.01)
    problems = Problems(Path("s.toml"))
    assert build_stiffeners([ring], None, problems)[0].at == 0.3
    assert problems == []
    build_stiffeners([ring], FRUSTUM, problems)
    assert [problem.partition(" m")[0] for problem in problems] == ["s.toml: stiffener: stiffener[1].at: found 0.3"]
