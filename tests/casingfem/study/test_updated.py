"""An updated study is written back key by key: bolts, springs, harmonics, paths; and its text is TOML again."""

import tomllib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.study.tables.tasks import StudyFile
from casingfem.study.updated import (
    add_harmonic,
    bare,
    entry_of,
    even,
    holding,
    literal,
    loosen,
    nested,
    pattern_lists,
    perfect,
    put,
    tighten,
    toml,
    updated_toml,
)

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
WAVE = cf.FourierField.of({4: (0.3, 0.0)})
CASING = cf.Shell(
    chart=cf.Frustum(r_base=0.5, r_top=0.4, height=0.25), thickness=3e-3, material=STEEL,
    mesh=cf.ShellMesh(order=3, rows=1, around=9),
)  # fmt: skip


def test_a_bolt_is_loosened_by_its_share_of_the_tight_ones():
    support = {"kind": "bolts", "k_r": 2e8, "k_z": 5e7}
    loosen(support, 3, 1e8)
    loosen(support, 5, 4e7)
    loosen(support, 3, 2e7)
    assert support["loose"] == [{"bolt": 3, "factor": 0.1}, {"bolt": 5, "factor": 0.2}]


def test_tight_bolts_get_another_stiffness_and_loose_ones_keep_theirs():
    support = {"k_r": 2e8, "k_theta": 5e7, "loose": [{"bolt": 3, "factor": 0.5}]}
    tighten(support, 4e8)
    assert support == {"k_r": 4e8, "k_theta": 1e8, "loose": [{"bolt": 3, "factor": 0.25}]}
    alone = {"k": 1e8}
    tighten(alone, 3e8)
    assert alone == {"k": 3e8}


def test_what_keeps_an_edge_under_a_ring_is_the_rings_own_support():
    own = {"kind": "bolts"}
    tables = {"support": {"base": {"kind": "ring", "support": own}, "top": {"kind": "elastic"}}}
    assert holding(tables, "base") is own
    assert holding(tables, "top") is tables["support"]["top"]


def test_a_pattern_of_one_spring_is_split_off_from_that_of_all():
    waves = [{"p": 2, "cos": 0.1}]
    support = {"k_r": 1.0, "k_z": 2.0, "k_rot": 0.0, "around": waves}
    (mine,) = pattern_lists(support, "k_z")
    mine.append({"p": 3})
    assert support["around"] == {"k_r": waves, "k_z": [*waves, {"p": 3}]}
    assert [id(part) for part in pattern_lists(support, "around")] == [id(part) for part in support["around"].values()]
    (new,) = pattern_lists(support, "k_face")
    assert (new, support["around"]["k_face"]) == ([], [])


@pytest.mark.parametrize(
    ("support", "spring"),
    [({"k_z": 2.0, "around": []}, "k_z"), ({"k_z": 2.0, "k_r": 0.0}, "k_z"), ({"k_z": 2.0, "k_r": 1.0}, "around")],
)
def test_a_pattern_of_the_only_spring_or_of_all_stays_one_list(support, spring):
    (waves,) = pattern_lists(support, spring)
    assert waves is support["around"]
    assert waves == []


def test_a_change_of_a_harmonic_adds_to_where_it_is():
    first = {"of": "radius", "harmonics": [{"p": 2, "cos": 0.1}]}
    second = {"of": "radius", "harmonics": [{"p": 3, "cos": 0.2}]}
    imperfections = [{"of": "radius", "survey": "a.csv"}, first, {"of": "thickness", "harmonics": [{"p": 5}]}, second]
    add_harmonic(imperfections, "radius", 2, "cos", 0.05)
    add_harmonic(imperfections, "radius", 2, "sin", -0.01)
    add_harmonic(imperfections, "radius", 5, "cos", 0.03)
    add_harmonic(imperfections, "density", 1, "sin", 0.07)
    assert first["harmonics"][0] == {"p": 2, "cos": pytest.approx(0.15, rel=1e-15), "sin": -0.01}
    assert second["harmonics"] == [{"p": 3, "cos": 0.2}, {"p": 5, "cos": 0.03}]
    assert imperfections[2]["harmonics"] == [{"p": 5}]
    assert imperfections[4:] == [{"of": "density", "harmonics": [{"p": 1, "sin": 0.07}]}]
    waves = [{"p": 2}]
    assert entry_of(waves, "p", 2) is waves[0]
    assert entry_of(waves, "p", 7) is waves[1]


def test_every_kind_of_parameter_goes_to_its_key():
    ring = cf.Ring(
        section=cf.edge.Section.rectangle(width=0.04, depth=0.03), material=STEEL, support=cf.ElasticEdge(k_face=1e12)
    )
    shell = replace(
        CASING, supports={"base": ring, "top": cf.ElasticEdge(k_r=1e8, around=WAVE)},
        strips=(cf.Strip(start=0.0, end=0.25, thickness=4e-3, material=STEEL),), radius_defect=WAVE,
        masses={"top": [cf.edge.EdgeMass(angle=0.0, mass=0.1), cf.edge.EdgeMass(angle=1.0, mass=0.2)]},
    )  # fmt: skip
    tables = {
        "material": {"E": 210e9}, "shell": {"thickness": 3e-3}, "strip": [{"thickness": 4e-3, "material": {"nu": 0.3}}],
        "support": {"base": {"kind": "ring", "width": 0.04, "material": {"rho": 7800.0}, "support": {
            "kind": "elastic", "k_face": 1e12}},
            "top": {"kind": "elastic", "k_r": 1e8, "around": [{"p": 4, "cos": 0.3}]}},
        "mass": [{"edge": "top", "angle_deg": 0.0, "mass": 0.1}, {"edge": "base"},
                 {"edge": "top", "angle_deg": 57.3, "mass": 0.2}],
    }  # fmt: skip
    values = {
        "material.E": 2e11, "shell.thickness": 2e-3, "strip.1.thickness": 5e-3, "strip.1.material.nu": 0.25,
        "support.base.k_face": 2e12, "support.base.section.width": 0.05, "support.base.material.rho": 8000.0,
        "support.top.k_r": 3e8, "support.top.k_r.p4.sin": 0.2, "radius.p4.cos": 0.35,
        "mass.top.2.angle": 0.5 * np.pi, "mass.top.1.mass": 0.4,
    }  # fmt: skip
    for name, value in values.items():
        put(tables, shell, name, value)
    base, top = tables["support"]["base"], tables["support"]["top"]
    assert (tables["material"]["E"], tables["shell"]["thickness"]) == (2e11, 2e-3)
    assert tables["strip"] == [{"thickness": 5e-3, "material": {"nu": 0.25}}]
    assert (base["width"], base["material"]["rho"], base["support"]["k_face"]) == (0.05, 8000.0, 2e12)
    assert (top["k_r"], top["around"]) == (3e8, [{"p": 4, "cos": 0.3, "sin": 0.2}])
    (found,) = tables["imperfection"]
    assert found == {"of": "radius", "harmonics": [{"p": 4, "cos": pytest.approx(0.05, rel=1e-12)}]}
    assert tables["mass"] == [
        {"edge": "top", "angle_deg": 0.0, "mass": 0.4}, {"edge": "base"},
        {"edge": "top", "angle_deg": pytest.approx(90.0, rel=1e-14), "mass": 0.2},
    ]  # fmt: skip


def test_paths_are_seen_from_the_new_folder_and_starts_are_gone():
    file = StudyFile.model_validate({
        "imperfection": [{"of": "radius", "survey": "surveys/a.csv"}, {"of": "radius", "harmonics": [{"p": 2}]}],
        "update": {"table": "t.csv", "shapes": "../s.uff", "parameter": [
            {"name": "material.E", "lower": 1.0, "upper": 2.0, "start": 1.5}]},
        "solid": {"mesh": "m.inp"}, "shell": {"thickness": 1e-3, "mesh": "n.inp"},
    })  # fmt: skip
    source = {"versions": {"casingfem": "9.9"}, "sha256": "abc"}
    study = SimpleNamespace(file=file, path=Path("work/old/s.toml"), source=source, structure=None)
    text = updated_toml(study, {}, Path("work/new"))
    assert text.startswith("# s.toml (sha256 abc) as updated by casingfem 9.9\n")
    tables = tomllib.loads(text)
    assert [entry.get("survey") for entry in tables["imperfection"]] == ["../old/surveys/a.csv", None]
    assert (tables["update"]["table"], tables["update"]["shapes"]) == ("../old/t.csv", "../s.uff")
    assert tables["update"]["parameter"] == [{"name": "material.E", "lower": 1.0, "upper": 2.0}]
    assert (tables["solid"]["mesh"], tables["shell"]["mesh"]) == ("../old/m.inp", "../old/n.inp")


def test_even_takes_the_variation_of_each_support_and_nothing_else():
    elastic = cf.ElasticEdge(k_r=1e8, around=WAVE)
    bolts = cf.Bolts(count=4, k=1e8, loose={2: 0.5})
    section = cf.edge.Section.circle(diameter=0.02)
    assert even(elastic) == cf.ElasticEdge(k_r=1e8)
    assert dict(even(bolts).loose) == {}
    assert even(cf.Clamped()) == cf.Clamped()
    assert dict(even(cf.Ring(section=section, support=bolts)).support.loose) == {}
    assert even(cf.Ring(section=section)).support is None
    shell = replace(CASING, supports={"base": elastic}, radius_defect=WAVE, density_defect=WAVE)
    same = perfect(shell)
    assert (same.radius_defect, same.density_defect, same.supports["base"].around) == (None, None, None)
    assert same.mesh == shell.mesh


@pytest.mark.parametrize(
    ("value", "own"),
    [({}, True), ({"p": 1}, True), ([{"k": 1}], True), ([{"p": 1}], False), ([], False), ([1.0], False), ("p", False)],
)
def test_tables_are_under_their_names_but_waves_within_a_line(value, own):
    assert nested(value) is own


def test_toml_writes_every_table_where_it_belongs():
    tables = {
        "a": 1, "b": {"c": {"d": 2.5}}, "e": {"f": True, "g": {"h": "i"}}, "j": [{"k": 1, "l": {"m": 2}}, {"k": 3}],
        "n": {}, "o": {"q": [[1, 2], [3]], "r": ({"p": 1, "cos": 0.5},)},
    }  # fmt: skip
    text = toml(tables)
    assert text == (
        'a = 1\n\n[b.c]\nd = 2.5\n\n[e]\nf = true\n\n[e.g]\nh = "i"\n\n[[j]]\nk = 1\n\n[j.l]\nm = 2\n\n[[j]]\nk = 3\n'
        "\n[n]\n\n[o]\nq = [[1, 2], [3]]\nr = [{p = 1, cos = 0.5}]\n"
    )
    assert tomllib.loads(text)["j"] == tables["j"]


@pytest.mark.parametrize(("key", "text"), [("k-z_1", "k-z_1"), ("a b", '"a b"'), ("é", '"\\u00e9"'), ("-_", '"-_"')])
def test_a_key_is_bare_where_toml_allows_it(key, text):
    assert bare(key) == text
    assert tomllib.loads(f"{bare(key)} = 1") == {key: 1}


def test_values_are_as_toml_writes_them():
    values = [True, "é", 1, 0.1, [1, "a"], {"p": 2, "a b": [False]}]
    assert [literal(value) for value in values] == [
        "true", '"é"', "1", "0.1", '[1, "a"]', '{p = 2, "a b" = [false]}'
    ]  # fmt: skip
