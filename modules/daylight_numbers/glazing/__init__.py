"""What panes pass: clear glass by its angles, measured glazing by Window XML."""
