"""Lamps of the scene, drawn with their shadows."""
