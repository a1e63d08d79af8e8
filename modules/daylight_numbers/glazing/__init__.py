"""Transmission of panes: clear glass by angle, measured glazing by Window XML."""
