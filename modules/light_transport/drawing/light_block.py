"""The uniform block of the light map's shaders."""

from vrut_lite.uniform_block import UniformBlock

BLOCK = "surface_light_block.glsl"
SURFACE_LIGHT = UniformBlock(
    "SurfaceLight",
    "surface",
    # "Level" is world x and z.
    fields={
        "open_ground": ("vec3", "irradiance of level ground under the open sky"),
        "radiance_scale": ("float", "from texels to W m^-2"),
        "texel": ("vec2", "one over the map's width and height"),
        "ground_first": ("vec2", "middle of the first texel of the ground's chart"),
        "ground_eye_m": ("vec2", "level, from the middle of the ground disc to the eye"),
        "ground_half_width_m": ("float", "of the chart"),
        "ground_warp": ("float", "how much finer it is in the middle"),
        "ground_slope": ("float", "hyperbolic sine of that"),
        "probes_eye": ("vec3", "the eye, in steps from the first probe"),
        "ground_steps": ("float", "from its first texel to its last"),
        "probes_per_m": ("vec3", "one over the step"),
        "probe_counts": ("vec3", "along x, y and z"),
        "scene_m": ("float", "across the scene"),
        "view_edge_px": ("float", "of the squares of pixels that share a point of the view"),
        "view_height_px": ("float", "of the picture"),
        "view_scale": ("float", "from the light of these points to W m^-2"),
    },
)
