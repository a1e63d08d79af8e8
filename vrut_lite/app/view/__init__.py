"""The picture, its camera controls and its overlays."""
