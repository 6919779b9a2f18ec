"""Scene files: scene.toml to what runs."""
