"""The renderer's uniform blocks, by the names that shaders include."""

from vrut_lite.uniform_block import UniformBlock

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
    "surface_terms_block.glsl": SURFACE_TERMS,
}
