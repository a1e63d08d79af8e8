"""Pictures as files and for display: exposure, white balance, tone map; no GL."""
