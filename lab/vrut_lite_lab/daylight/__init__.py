"""Scripts that measure and draw daylight numbers."""
