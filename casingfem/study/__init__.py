"""study.toml: its schema, reading, and writing of updated studies."""

from casingfem.study.imported import MeshStudy
from casingfem.study.load import Study, load_shell_study, load_study
from casingfem.study.problems import StudyError
from casingfem.study.tables.tasks import schema
from casingfem.study.updated import perfect, updated_toml

__all__ = ["MeshStudy", "Study", "StudyError", "load_shell_study", "load_study", "perfect", "schema", "updated_toml"]
