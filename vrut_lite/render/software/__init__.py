"""Moving pictures where a processor is the renderer, as `device` decides."""
