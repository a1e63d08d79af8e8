"""Where the rays of a scene end, traced once.

In reading order: `tree` and `trace` find what a ray meets, `ray_starts` makes the rays' starts,
`sky_nodes` and `patches` are their ends, `ray_table` keeps the counts, and `mirror_rays` does
the same for the cube maps of glossy parts.
"""
