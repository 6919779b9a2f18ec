"""The text of an updated study: the tables of the study, each changed number at its key, paths from the new folder."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.study.study_texts import FRUSTUM, STEEL, written

STUDIES = Path(__file__).parents[3] / "data" / "studies"
WHOLE = [file for file in sorted(STUDIES.glob("*.toml")) if "[chain]" not in file.read_text()]
WAVE = cf.FourierField.of({4: (0.3, 0.0)})
SURVEYED = f"""{FRUSTUM}[shell]
thickness = 3e-3
[[imperfection]]
of = "radius"
survey = "{(STUDIES.parent / "surveys" / "rig_casing.csv").as_posix()}"
[[imperfection]]
of = "radius"
harmonics = [{{p = 2, cos = 0.001}}]
[[imperfection]]
of = "thickness"
harmonics = [{{p = 5, cos = 0.01}}]
[[imperfection]]
of = "radius"
harmonics = [{{p = 3, cos = 0.0002}}]
[support.base]
"""
TWO_SPRINGS = 'kind = "elastic"\nk_r = 3e8\nk_z = 4e8\naround = [{p = 2, cos = 0.1}]\n'
MESH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 2 "the root"
1 3 "fuß"
2 1 "wall"
$EndPhysicalNames
$Nodes
4
1 0 0 0
2 0.1 0 0
3 0.1 0.1 0
4 0 0.1 0
$EndNodes
$Elements
3
1 1 2 2 1 1 2
2 1 2 3 2 3 4
3 3 2 1 1 1 2 3 4
$EndElements
"""

pytestmark = pytest.mark.filterwarnings("ignore")  # of coarse meshes and thick walls


def tables_of(study, values, folder):
    """Tables of the updated study."""
    return tomllib.loads(cf.study.updated_toml(study, values, folder))


@pytest.mark.parametrize("file", WHOLE, ids=lambda file: file.stem)
def test_a_study_without_a_change_has_the_same_tables_without_start_values(file):
    study, own = cf.load_study(file), tomllib.loads(file.read_text(encoding="utf-8"))
    for parameter in own.get("update", {}).get("parameter", []):
        parameter.pop("start", None)
    assert tables_of(study, {}, file.parent) == own


@pytest.mark.parametrize("name", ["rig_casing", "bench_model"])
def test_paths_are_relative_to_the_new_folder(name, tmp_path):
    study = cf.load_study(STUDIES / f"{name}.toml")
    text = cf.study.updated_toml(study, {}, tmp_path)
    assert text.startswith(
        f"# {name}.toml (sha256 {study.source['sha256']}) as updated by casingfem {cf.__version__}\n"
    )
    tables = tomllib.loads(text)
    given = [*tables.get("imperfection", []), tables.get("update", {})]
    paths = [part[key] for part in given for key in ("survey", "table", "shapes") if key in part]
    assert paths
    assert all((tmp_path / path).is_file() and not Path(path).is_absolute() for path in paths)
    again = cf.load_study(written(tmp_path, text))
    assert again.source["sha256"] != study.source["sha256"]
    z, theta = np.full(9, 0.1), np.linspace(0.0, 6.0, 9)
    if study.shell.radius_defect is not None:
        radii = [one.shell.radius_defect.derivatives(z, theta).value for one in (study, again)]
        np.testing.assert_array_equal(*radii)


def test_an_imported_study_has_the_path_of_its_mesh_and_names_that_toml_must_quote(tmp_path):
    (tmp_path / "old").mkdir()
    (tmp_path / "new").mkdir()
    (tmp_path / "old" / "wall.msh").write_text(MESH, encoding="utf-8")
    text = f'{STEEL}[shell]\nmesh = "wall.msh"\nthickness = 1e-3\n'
    text += '[support."the root"]\nkind = "clamped"\n[support."fuß"]\nkind = "clamped"\n[modes]\nelastic_only = true\n'
    text += "[checks]\n"
    study = cf.load_study(written(tmp_path / "old", text))
    new = cf.study.updated_toml(study, {"shell.thickness": 2e-3}, tmp_path / "new")
    tables = tomllib.loads(new)
    assert tables["shell"] == {"mesh": "../old/wall.msh", "thickness": 2e-3}
    assert tables["support"] == tomllib.loads(text)["support"]
    assert (tables["modes"], tables["checks"]) == ({"elastic_only": True}, {})
    again = cf.load_study(written(tmp_path / "new", new)).structure
    assert (again.thickness, set(again.supports)) == (2e-3, {"the root", "fuß"})


def test_a_change_of_a_harmonic_is_added_to_where_it_is(tmp_path):
    study = cf.load_study(written(tmp_path, SURVEYED + TWO_SPRINGS))
    before = {name: cf.updating.get_value(study.structure, f"radius.{name}") for name in ("p2.cos", "p3.cos", "p5.sin")}
    values = {
        "radius.p2.cos": before["p2.cos"] + 5e-4, "radius.p2.sin": -1e-3, "radius.p3.cos": before["p3.cos"] - 1e-4,
        "radius.p5.sin": before["p5.sin"] + 2e-3, "density.p1.sin": 0.07,
    }  # fmt: skip
    text = cf.study.updated_toml(study, values, tmp_path)
    assert "\nharmonics = [{p = 5, cos = 0.01}]\n" in text  # waves are within a line
    survey, two, thickness, three, density = tomllib.loads(text)["imperfection"]
    assert "harmonics" not in survey
    assert two["harmonics"][0]["cos"] == pytest.approx(1.5e-3, rel=1e-12)
    assert thickness["harmonics"] == [{"p": 5, "cos": 0.01}]
    assert [wave["p"] for wave in three["harmonics"]] == [3, 5]
    assert three["harmonics"][0]["cos"] == pytest.approx(1e-4, rel=1e-9)
    assert three["harmonics"][1]["sin"] == pytest.approx(2e-3, rel=1e-9)
    assert density == {"of": "density", "harmonics": [{"p": 1, "sin": 0.07}]}


def test_a_bolt_is_loosened_by_its_share_of_the_largest_stiffness_and_loose_ones_keep_theirs(tmp_path):
    bolts = 'kind = "bolts"\ncount = 6\nk_r = 2e8\nk_z = 5e7\nloose = [{bolt = 5, factor = 0.5}]\n'
    study = cf.load_study(written(tmp_path, SURVEYED + bolts))
    values = {"support.base.bolts.3.k": 2e7, "support.base.bolts.5.k": 4e7}
    assert tables_of(study, values, tmp_path)["support"]["base"]["loose"] == [
        {"bolt": 5, "factor": pytest.approx(0.2, rel=1e-12)}, {"bolt": 3, "factor": pytest.approx(0.1, rel=1e-12)},
    ]  # fmt: skip
    base = tables_of(study, {"support.base.k": 4e8}, tmp_path)["support"]["base"]
    assert (base["k_r"], base["k_z"]) == (4e8, 1e8)
    assert base["loose"] == [{"bolt": 5, "factor": 0.25}]


@pytest.mark.parametrize(
    ("support", "spring", "around"),
    [
        (TWO_SPRINGS, "around", [{"p": 2, "cos": 0.3}]),
        (TWO_SPRINGS, "k_z", {"k_r": [{"p": 2, "cos": 0.1}], "k_z": [{"p": 2, "cos": 0.3}]}),
        (TWO_SPRINGS.replace("k_r = 3e8\n", ""), "k_z", [{"p": 2, "cos": 0.3}]),
    ],
)
def test_the_pattern_of_all_springs_or_of_the_only_one_stays_one_list(support, spring, around, tmp_path):
    study = cf.load_study(written(tmp_path, SURVEYED + support))
    changed = tables_of(study, {f"support.base.{spring}.p2.cos": 0.3}, tmp_path)
    assert changed["support"]["base"]["around"] == around


def test_the_perfect_shell_has_no_fields_and_even_supports():
    casing = cf.Shell(
        chart=cf.Frustum(r_base=0.5, r_top=0.4, height=0.25), thickness=3e-3,
        mesh=cf.ShellMesh(order=3, rows=1, around=9), material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
        radius_defect=WAVE, density_defect=WAVE,
    )  # fmt: skip
    elastic, bolts = cf.ElasticEdge(k_r=1e8, around=WAVE), cf.Bolts(count=4, k=1e8, loose={2: 0.5})
    section = cf.edge.Section.circle(diameter=0.02)

    def even(support):
        return cf.study.perfect(replace(casing, supports={"base": support})).supports["base"]

    assert even(elastic) == cf.ElasticEdge(k_r=1e8)
    assert dict(even(bolts).loose) == {}
    assert even(cf.Clamped()) == cf.Clamped()
    assert dict(even(cf.Ring(section=section, support=bolts)).support.loose) == {}
    assert even(cf.Ring(section=section)).support is None
    same = cf.study.perfect(casing)
    assert (same.radius_defect, same.density_defect, same.mesh) == (None, None, casing.mesh)
