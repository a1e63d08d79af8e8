"""Where the surfaces of a scene lie in its light map.

In reading order: `facing_groups` cuts a mesh into groups of triangles, `overlaps` separates those
that would share texels, `unwrapping` makes charts of them, `mesh_shapes` and `part_shapes` choose
their sizes, `rectangle_packing` places them, `layout` puts all parts into one map, and `seams`
finds the texels at which charts meet.
"""
