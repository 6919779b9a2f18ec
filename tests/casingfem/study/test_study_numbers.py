"""Numbers held: what the shipped studies say, as the program has it."""

from pathlib import Path

import pytest

import casingfem as cf
from tests.probed import numbers_in

STUDIES = sorted((Path(__file__).parents[3] / "data" / "studies").glob("*.toml"))
STUDIES = [file for file in STUDIES if file.stem != "rig"]  # a chain of studies, which reports.studies.rig reads


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")
@pytest.mark.parametrize("file", STUDIES, ids=lambda file: file.stem)
def test_numbers_of_studies(file, held):
    held(said=list(numbers_in(cf.load_study(file))))
