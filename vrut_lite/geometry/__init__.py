"""Cube-map faces, frames of reference, panoramas, spherical harmonics and colour."""
