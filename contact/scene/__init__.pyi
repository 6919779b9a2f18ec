from .cycles import load_cycles
from .load import load_scene
from .problems import SceneError, SceneWarning
from .schema import scene_schema
from .stability import load_interactions, load_stability

__all__ = [
    "SceneError",
    "SceneWarning",
    "load_cycles",
    "load_interactions",
    "load_scene",
    "load_stability",
    "scene_schema",
]
