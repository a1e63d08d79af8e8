"""Clouds: a layer of them, made of noise and carried by the wind."""
