"""Final gather: light at a still's visible points, by rays that end on the map's patches.

In reading order: `view_light` has the steps, `point_light` traces what falls on points,
`view_reflections` what coats and metals mirror there, `view_smoothing` removes noise.
"""
