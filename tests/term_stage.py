"""Materials with glTF's extensions, and what stands behind them."""

from vrut_lite.messages.ground_disc import GroundDisc

# A level below, whose radiance under the sky of 1 is its albedo.
GROUND = GroundDisc((0.0, 0.0), -1.0, 500.0)
ALBEDO = 0.3
# Schlick's reflectance at normal incidence of an index of 1.5.
F0 = 0.04


def material(colour=(1.0, 1.0, 1.0), roughness=0.0, metallic=0.0, **extensions):
    """A glTF material with KHR_materials_* by their last words."""
    return {
        "pbrMetallicRoughness": {
            "baseColorFactor": [*colour, 1.0],
            "roughnessFactor": roughness,
            "metallicFactor": metallic,
        },
        "extensions": {f"KHR_materials_{name}": values for name, values in extensions.items()},
    }
