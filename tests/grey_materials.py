"""The materials of a scene whose one material is white, dielectric and without maps."""

import numpy as np

from vrut_lite.array import Array
from vrut_lite.messages.scene_content import MAP_NAMES, SceneMaterials
from vrut_lite.messages.surface_terms import SurfaceTerms, as_row


def grey_materials():
    return SceneMaterials(
        names=Array(np.frombuffer(b"grey", np.uint8)), base_colour_rgba=Array(np.ones((1, 4))),
        metallic=Array(np.zeros(1)), roughness=Array(np.ones(1)),
        emission_rgb=Array(np.zeros((1, 3))), alpha_mode=Array(np.zeros(1, np.uint8)),
        alpha_cutoff=Array(np.ones(1)), double_sided=Array(np.zeros(1, bool)),
        normal_scale=Array(np.ones(1)), occlusion_strength=Array(np.ones(1)),
        terms=Array(as_row(SurfaceTerms())[None].copy()),
        map_image=Array(np.full((1, len(MAP_NAMES)), -1, np.int32)),
        map_uv_layer=Array(np.zeros((1, len(MAP_NAMES)), np.uint8)),
        map_sampler=Array(np.zeros((1, len(MAP_NAMES), 3), np.uint8)),
        images=Array(np.zeros((0, 4), np.int64)), texels=Array(np.zeros(0, np.uint8)),
    )  # fmt: skip
