"""Radiance (LBNL) as a second truth of light between surfaces: irradiance at points of a scene.

python -m tools.radiance.table    grids in three scenes, some minutes
"""
