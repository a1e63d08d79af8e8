"""Sensors, and the matrix of their light over the sky's cells and the scene's patches."""
