"""Specular-glossiness means the same surface as its metallic-roughness twin."""

import base64
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from loaded_scenes import WriteScene, material_of
from PIL import Image

from vrut_lite.errors import UserError
from vrut_lite.scene.loading import load_scene

NAME = "KHR_materials_pbrSpecularGlossiness"


def _with(**values: Any) -> Any:
    def edit(document: dict[str, Any]) -> None:
        document["extensionsUsed"] = document["extensionsRequired"] = [NAME]
        document["materials"][0]["extensions"] = {NAME: values}
        texels = np.array([[[10, 20, 30, 0], [40, 50, 60, 255]]], np.uint8)
        out = BytesIO()
        Image.fromarray(texels).save(out, "PNG")
        uri = "data:image/png;base64," + base64.b64encode(out.getvalue()).decode()
        document["images"] = [{"uri": uri}]
        document["textures"] = [{"source": 0}]

    return edit


def test_factors_become_those_of_a_tinted_dielectric(write_square: WriteScene) -> None:
    """Diffuse is the base colour, roughness 1 less glossiness; the reflection is the
    specular colour at normal incidence."""
    scene = load_scene(
        write_square(
            _with(diffuseFactor=[0.1, 0.2, 0.3, 1], specularFactor=[0.5, 0.4, 0.3],
                  glossinessFactor=0.7)
        )
    )  # fmt: skip
    material = material_of(scene)
    np.testing.assert_allclose(material.baseColorFactor, [0.1, 0.2, 0.3, 1])
    assert (material.metallicFactor, material.roughnessFactor) == (0.0, pytest.approx(0.3))
    np.testing.assert_allclose(material.terms.f0_rgb, [0.5, 0.4, 0.3], rtol=1e-5)
    assert scene.notices == ()


def test_glossiness_in_a_map_becomes_roughness(write_square: WriteScene) -> None:
    """Alpha is glossiness times its factor; the colours of the same map tint the reflection."""
    material = material_of(
        load_scene(
            write_square(_with(specularGlossinessTexture={"index": 0}, glossinessFactor=0.5))
        )
    )
    np.testing.assert_array_equal(
        np.asarray(material.metallicRoughnessTexture)[0, :, 1], [255, 128]
    )
    assert (material.metallicFactor, material.roughnessFactor) == (0.0, 1.0)
    colours = np.asarray(material.further_maps["specular_colour"])
    np.testing.assert_array_equal(colours[0, :, :3], [[10, 20, 30], [40, 50, 60]])


def test_a_broken_extension_is_refused(write_square: WriteScene) -> None:
    """A factor that is no number gives one sentence."""
    with pytest.raises(UserError, match="pbrSpecularGlossiness is not valid"):
        load_scene(write_square(_with(glossinessFactor="high")))
