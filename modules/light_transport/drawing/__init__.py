"""The light map in the picture: its frame part, textures, shaders and their twin on the CPU."""
