"""What draws moving pictures where a processor is the renderer: `device` decides."""
