"""Where the surfaces of a scene lie in its light map.

In reading order: `welding` joins corners, `facing_groups` and `merging` cut a mesh into groups of
triangles, `projection` flattens each, `overlaps` separates triangles that would share texels,
`unwrapping`
makes charts of them, `mesh_shapes` and `part_shapes` choose their sizes, `rectangle_packing` places
them, and `layout` puts all parts into one map.
"""
