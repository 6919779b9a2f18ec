from .load import SceneError, load_scene, scene_schema
from .stability import load_stability

__all__ = [
    "SceneError",
    "load_scene",
    "load_stability",
    "scene_schema",
]
