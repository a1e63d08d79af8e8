"""A scene for light transport: triangles, their reflectance and emission, and the texels on
them."""
