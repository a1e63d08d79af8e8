"""Uniform blocks: one description makes both the GLSL and the bytes, so that they always agree.

Fields are laid out by the rules of std140 (OpenGL 4.3, section 7.6.2.2).
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from vrut_lite.messages.lamps import MOST_DRAWN

# Floats of a type, and the multiple of floats at which it begins.
_LAYOUT = {
    "float": (1, 1),
    "vec2": (2, 2),
    "vec3": (3, 4),
    "vec4": (4, 4),
    "mat4": (16, 4),
    f"mat4[{MOST_DRAWN}]": (16 * MOST_DRAWN, 4),
}


class UniformBlock(NamedTuple):
    """A block `name`, whose fields shaders read as `instance.field`.

    `fields` gives each field's GLSL type and its meaning.
    """

    name: str
    instance: str
    binding: int
    fields: Mapping[str, tuple[str, str]]

    @property
    def size_bytes(self) -> int:
        """Size of the buffer behind it."""
        return 4 * self._places()[1]

    def glsl(self) -> str:
        """Its declaration."""
        lines = [f"    {kind} {name};  // {text}" for name, (kind, text) in self.fields.items()]
        head = f"layout(std140, binding = {self.binding}) uniform {self.name} {{"
        return "\n".join([head, *lines, f"}} {self.instance};\n"])

    def packed(self, **values: Any) -> bytes:
        """The bytes of a value for each field; matrices (..., 4, 4) as mathematics writes them.

        Raises:
            ValueError: a field lacks a value, a value lacks a field, or has the wrong length.
        """
        if values.keys() != self.fields.keys():
            odd = sorted(values.keys() ^ self.fields.keys())
            raise ValueError(f"the uniform block {self.name} and its values differ in {odd}")
        places, length = self._places()
        block = np.zeros(length, np.float32)
        for name, value in values.items():
            kind, _ = self.fields[name]
            numbers = np.asarray(value, np.float64)
            if numbers.size != _LAYOUT[kind][0]:
                raise ValueError(f"{name} of the uniform block {self.name} must be a {kind}")
            # GLSL keeps matrices column by column.
            columns = np.swapaxes(numbers, -1, -2) if numbers.ndim > 1 else numbers
            block[places[name] : places[name] + numbers.size] = columns.ravel()
        return block.tobytes()

    def _places(self) -> tuple[dict[str, int], int]:
        """Where each field begins, in floats, and the block's length."""
        places, end = {}, 0
        for name, (kind, _) in self.fields.items():
            size, multiple = _LAYOUT[kind]
            places[name] = -(-end // multiple) * multiple
            end = places[name] + size
        return places, -(-end // 4) * 4


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
CLOUDS = UniformBlock(
    "Clouds",
    "clouds",
    binding=1,
    # Positions count from the eye; "level" is world x and z.
    fields={
        "sun_direction": ("vec3", "towards the sun"),
        "eye_radius_m": ("float", "from the planet's middle"),
        "base_m": ("float", "altitude of the layer's base"),
        "thickness_m": ("float", "of the layer"),
        "extinction_per_m": ("float", "of a cloud's full density"),
        "threshold": ("float", "of the weather, above which there is cloud"),
        "weather_origin": ("vec4", "the eye in the two views of the weather, in periods"),
        "noise_origin": ("vec4", "the eye in shape and detail, in periods"),
        "diffused": ("float", "share of extinction that counts, after delta-M"),
        "pixel_rad": ("float", "what a pixel of the cloud picture spans"),
        "top_squares_m2": ("float", "squared radius less the eye's, of the layer's top"),
        "base_squares_m2": ("float", "the same of its base"),
        "ground_squares_m2": ("float", "the same of the ground"),
        "eye_altitude_m": ("float", "the eye's y"),
        "light_from_above": ("vec3", "mean radiance of the upper hemisphere"),
        "light_from_below": ("vec3", "radiance of the ground"),
        "covered_share": ("float", "of the sky's zenith that is cloud"),
        "shadow_origin_m": ("vec2", "the eye on the shadow map's plane"),
        "shadow_near_m": ("float", "how far from the middle texels begin to grow"),
        "shadow_growth": ("float", "of texels away from the middle"),
        "ground_by_sun": ("vec3", "of the light of open, level ground, what the sun gives"),
        "sun_slope": ("float", "least sine of the sun's height that shadows are cast by"),
        "ground_by_sky": ("vec3", "of the same, what sky and clouds give"),
        "shadow_texels": ("float", "along a side of the map"),
        # The layer's form: messages/clouds.py.
        "weather_periods_m": ("vec2", "of the two copies of the weather"),
        "noise_periods_m": ("vec2", "of shape and detail"),
        "warp_origin": ("vec4", "the eye in the waves that warp shape and weather, in periods"),
        "second_share": ("float", "of the second copy of the weather"),
        "stretch": ("float", "of noise along its x axis"),
        "lean": ("float", "of that axis with the height"),
        "growth": ("float", "weather over which clouds grow to full height"),
        "least_height": ("float", "of the smallest cloud, of the thickness"),
        "side_fade": ("float", "weather over which sides fade in"),
        "anvil": ("float", "how far tops spread, in side fades"),
        "base_fade": ("float", "of a cloud's height"),
        "top_fade": ("float", "of a cloud's height"),
        "fraying": ("float", "weight of the detail"),
        "sharpness": ("float", "of edges"),
        # Of weather and noise in a sample: clouds/cloud_spread.py.
        "spread_most": ("vec2", "half their range in a wide one"),
        "spread_log_half": ("vec2", "binary logarithm of the width at which it is half that, m"),
        "spread_power": ("vec2", "of the width"),
        "volume_near_m": ("float", "of the light volume, as shadow_near_m"),
        "volume_growth": ("float", "of its columns away from the middle"),
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
    "cloud_block.glsl": CLOUDS,
    "lamp_block.glsl": LAMPS,
    "surface_light_block.glsl": SURFACE_LIGHT,
    "surface_terms_block.glsl": SURFACE_TERMS,
}
