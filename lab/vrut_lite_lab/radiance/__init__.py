"""Radiance (LBNL) as a second truth of light between surfaces: irradiance at points of a scene.

python -m vrut_lite_lab.radiance.table    grids in three scenes, some minutes
"""
