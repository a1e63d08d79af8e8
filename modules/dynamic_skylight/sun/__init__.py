"""The sun's position, refraction, events and visible disc."""
