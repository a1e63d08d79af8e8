"""Where the rays of a scene end, traced once.

In reading order: `tree` and `trace` find what a ray meets, `ray_starts` says where rays begin,
`sky_nodes` and `patches` are what they end on, `ray_table` keeps the counts, and `mirror_rays` does
the same for the cube maps of glossy parts.
"""
