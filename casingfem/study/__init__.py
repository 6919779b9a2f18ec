"""study.toml: its schema, how it is read, and how an updated one is written."""

from casingfem.study.load import Study, load_study
from casingfem.study.problems import StudyError
from casingfem.study.schema import schema
from casingfem.study.updated import perfect, updated_toml

__all__ = ["Study", "StudyError", "load_study", "perfect", "schema", "updated_toml"]
