"""[reduce] of a study for rubs: axial rims on lines, tips in pieces, outputs by name; and what it cannot mean."""

from pathlib import Path

import pytest

import casingfem as cf

SCENES = Path(__file__).parents[3] / "data" / "scenes" / "rub"


def changed(folder: Path, name: str, old: str, new: str) -> Path:
    text = (SCENES / name).read_text()
    assert old in text
    (folder / name).write_text(text.replace(old, new, 1))
    return folder / name


def test_the_studies_of_the_rub_name_their_interfaces(tmp_path):
    assert cf.load_study(SCENES / "casing.toml").interface == cf.Rim("top", n_max=20, axial=True)
    lined = changed(tmp_path, "casing.toml", "axial = true", "axial = true\nlines = [0.24, 0.25]")
    assert cf.load_study(lined).interface == cf.Rim("top", n_max=20, axial=True, lines=(0.24, 0.25))
    blade = cf.load_study(SCENES / "blade.toml")
    assert blade.interface == cf.TipNodes("tip", count=5)
    outputs = [table.output() for table in blade.file.reduce.output]
    assert outputs[0] == cf.modal.Strain(name="root strain", at=(0.004, 0.0))
    assert outputs[1] == cf.modal.Displacement(name="tip flap", at=(0.110, 0.0), direction="normal")


@pytest.mark.parametrize(
    ("name", "old", "new", "words"),
    [
        ("casing.toml", "axial = true", "nodes = 3", "reduce.nodes: found 3"),
        ("blade.toml", "nodes = 5", "nodes = 0", "reduce.nodes: found 0"),
        ("blade.toml", "nodes = 5", "axial = true", "reduce.axial: found True"),
        ("blade.toml", 'strain = "11"', 'strain = "33"', "reduce.output[1].strain: found '33'"),
        ("blade.toml", 'strain = "11"', 'direction = "up"', "reduce.output[1].direction: found 'up'"),
        ("blade.toml", 'strain = "11"', 'strain = "11"\nside = 3.0', "reduce.output[1].side: found 3.0"),
        ("blade.toml", 'strain = "11"', "", "expected direction, or strain"),
        ("blade.toml", "at = [0.004, 0.0]", "at = [0.004]", "reduce.output[1].at"),
    ],
)
def test_bad_reductions_are_named_by_key(tmp_path, name, old, new, words):
    with pytest.raises(cf.errors.InputError) as caught:
        cf.load_study(changed(tmp_path, name, old, new))
    assert words in str(caught.value)
