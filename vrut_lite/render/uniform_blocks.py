"""The renderer's uniform blocks, by the names that shaders include."""

from vrut_lite.uniform_block import UniformBlock

SURFACE_LIGHT = UniformBlock(
    "SurfaceLight",
    "surface",
    binding=2,
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
SURFACE_TERMS = UniformBlock(
    "SurfaceTerms",
    "terms",
    binding=3,
    fields={
        "f0": ("vec3", "reflectance at normal incidence of what is no metal"),
        "f90": ("float", "and at grazing angles"),
        "sheen_rgb": ("vec3", "colour of fibres"),
        "sheen_roughness": ("float", "of them"),
        "extinction_per_m": ("vec3", "of a body of glass"),
        "thickness_m": ("float", "of the body, 0 for a pane"),
        "ior": ("float", "index of refraction"),
        "transmission": ("float", "share that lets light through"),
        "clearcoat": ("float", "share under a second coat"),
        "clearcoat_roughness": ("float", "of that coat"),
        "anisotropy": ("float", "how much highlights are stretched"),
        "anisotropy_rad": ("float", "which way, from the first texture coordinate"),
        "iridescence": ("float", "share under a thin film"),
        "specular_layer": ("float", "of texture coordinates, for each map"),
        "specular_colour_layer": ("float", "of the map of f0's colour"),
        "clearcoat_layer": ("float", "of the map of the second coat"),
        "transmission_layer": ("float", "of the map of glass"),
        "iridescence_layer": ("float", "of the map of a thin film"),
        "iridescence_thickness_layer": ("float", "of the map of its thickness"),
    },
)
# By the names that shaders include.
BLOCK_FILES = {
    "surface_light_block.glsl": SURFACE_LIGHT,
    "surface_terms_block.glsl": SURFACE_TERMS,
}
