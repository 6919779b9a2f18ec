"""Pages, one module for each kind: a study, an update, an identification, a scene, a sweep, periodic motions."""
