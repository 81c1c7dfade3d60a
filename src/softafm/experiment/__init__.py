"""Experiment files: from TOML to the objects a Python user would build."""
