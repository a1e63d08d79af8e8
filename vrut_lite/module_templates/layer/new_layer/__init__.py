"""New layer: the rainbow of the sun in rain, drawn over the sky."""
