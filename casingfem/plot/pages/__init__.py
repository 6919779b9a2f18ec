"""Pages, one module for each kind: a study, an update, an identification, contact (a scene, a sweep, cycles)."""
