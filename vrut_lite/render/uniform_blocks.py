"""The renderer's uniform blocks, by the names that shaders include."""

from vrut_lite.messages.lamps import MOST_DRAWN
from vrut_lite.uniform_block import UniformBlock

AIR = UniformBlock(
    "Air",
    "air",
    binding=0,
    fields={
        "sun_direction": ("vec3", "of the body whose shadows the scene casts"),
        "reach_m": ("float", "how much of a ray's air the slices span at most"),
        "sun_azimuth": ("vec2", "unit vector, world x and z"),
        "second_direction": ("vec3", "of the other body"),
        "second_azimuth": ("vec2", "unit vector, world x and z"),
        "horizon_depth": ("float", "1 + mu of the tables' horizon"),
        "depth_above_horizon": ("float", "from there to their highest row"),
        "slices": ("float", "by distance"),
        "rows_above": ("float", "above the horizon"),
        "rows_below": ("float", "below it"),
        "columns": ("float", "by azimuth"),
        "radiance_scale": ("float", "from texels to W m^-2 sr^-1"),
        "observer_radius_m": ("float", "from the planet's middle"),
        "top_radius_m": ("float", "of the edge of the air"),
        "above_top_m": ("float", "of the observer; negative inside the air"),
        "evenness": ("float", "of slices"),
        "start_radius_m": ("float", "of where rays begin in the air"),
        "tangent_below_m2": ("float", "squared, from there to the deepest sphere"),
        "tangent_above_m2": ("float", "minus the squared tangent to the edge of the air"),
        "shortest_span_m": ("float", "of a ray's air"),
        "ground_radius_m": ("float", "of the ground behind the scene"),
        "above_ground_m": ("float", "of the eye"),
        "horizon_height": ("float", "mu that parts that ground from the sky"),
        "ground_is_bare": ("float", "1: air is drawn before it"),
        "rows_down": ("vec3", "crowding, x and place of the row that is moved: air_rows.py"),
        "shadow_from_eye": ("mat4", "into the shadow map, from positions relative to the eye"),
    },
)
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
LAMPS = UniformBlock(
    "Lamps",
    "lamps",
    binding=4,
    fields={
        "lamps": (
            f"mat4[{MOST_DRAWN}]",
            "columns: place from the eye and slope of the cone's ramp; axis and cosine of its end; "
            "direction of a table's angle 0 and number of the table, or -1; intensity and the sign "
            "of the direction of 90 degrees",
        ),
        "tiles": ("vec2", "of the shadow maps, across and down"),
        "count": ("float", "of the lamps"),
        "depth_scale": ("float", "of depth in the shadow maps"),
        "depth_offset": ("float", "over the distance along a face's axis"),
        "face_share": ("float", "of a tile that the cube's face takes"),
        "texel": ("float", "width of a texel of the maps a metre away, in metres"),
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
    "air_block.glsl": AIR,
    "lamp_block.glsl": LAMPS,
    "surface_light_block.glsl": SURFACE_LIGHT,
    "surface_terms_block.glsl": SURFACE_TERMS,
}
