"""The uniform block of the air's shaders."""

from vrut_lite.uniform_block import UniformBlock

BLOCK = "air_block.glsl"
AIR = UniformBlock(
    "Air",
    "air",
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
        "picture_px": ("vec2", "width and height"),
        "glow_cosines": ("vec2", "of the angles to the sun where glow begins and is whole"),
        "shadow_from_eye": ("mat4", "into the shadow map, from positions relative to the eye"),
    },
)
