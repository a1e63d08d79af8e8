"""A layer of clouds, made of noise and moved by the wind."""
