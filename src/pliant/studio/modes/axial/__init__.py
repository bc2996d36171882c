"""Handles on the canvas for deformers along an axis: where they are, and what dragging them means."""
