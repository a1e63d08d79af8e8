"""What a scene is to light: triangles, what they reflect and emit, and the texels on them."""
