"""Numbers held: what the shipped scenes say, as the program has it."""

from pathlib import Path

import pytest

import contact as ct
from tests.probed import numbers_in

SCENES = Path(__file__).parents[3] / "data" / "scenes"
FILES = [file for file in sorted(SCENES.glob("*.toml")) if file.stem not in ("pair", "first_rub")]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_numbers_of_scenes(file, held):
    held(said=list(numbers_in(ct.load_scene(file))))
