"""Scenes: stacks of deformers, key frames, project files, templates, export."""
