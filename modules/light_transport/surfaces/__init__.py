"""A scene for light transport: triangles, their reflectance and emission."""
