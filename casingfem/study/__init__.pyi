from .imported import MeshStudy
from .load import Study, load_shell_study, load_study
from .problems import StudyError
from .tables.tasks import schema
from .updated import perfect, updated_toml

__all__ = [
    "MeshStudy",
    "Study",
    "StudyError",
    "load_shell_study",
    "load_study",
    "perfect",
    "schema",
    "updated_toml",
]
