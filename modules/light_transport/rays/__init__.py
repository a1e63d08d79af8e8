"""Where the rays of a scene end, traced once.

In reading order: `tree` and `trace` find what a ray meets, `map_texels`, `groups` and `ray_starts`
are where rays begin, `sky_nodes` and `patches` where they end, `ray_table` keeps the counts,
`mirror_rays` does the same for the cube maps of glossy parts, `ray_scene` holds all of a scene.
"""
