"""Maps beyond their edges in the path tracer, as the frame has them."""

import json

import numpy as np
import pytest
from light_messages import light_messages
from path_tracer.backend import PathTracedBackend
from path_tracer.settings import PathTracerSettings
from path_tracer_here import mitsuba_or_skip
from scene_stage import UV, look, square
from stateful_backend import StatefulBackend, opened

mitsuba_or_skip()
CODES = {"repeat": 10497, "clamp": 33071, "mirror": 33648}
# Four quarters of a colour each.
QUARTERS = np.uint8([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]])


def wrapped(numbers, wrap):
    """Which of two halves lies at steps of a half along a map."""
    inside = {"repeat": numbers % 2, "clamp": np.clip(numbers, 0, 1)}
    return inside.get(wrap, np.where(numbers % 4 < 2, numbers % 2, 1 - numbers % 2))


def seen(path):
    """The square from above under an even sky of 1: (12, 12, 3)."""
    settings = PathTracerSettings(spp=2, max_bounces=1, variant="scalar")
    backend = StatefulBackend(PathTracedBackend(settings), size_px=(12, 12))
    backend.change(scene=opened(path))
    background, key_light, ambient = light_messages(np.ones((6, 8, 8, 3)))
    backend.change(background=background, key_light=key_light, ambient=ambient)
    return look(backend, (0, 5, 1e-5), (0, 0, 0), 2 * np.arctan(0.1)).radiance


@pytest.mark.parametrize("u", CODES)
@pytest.mark.parametrize("v", CODES)
def test_each_axis_goes_on_by_itself(tmp_path, u, v):
    """Three tiles each way around the map: every half-tile has the colour that glTF gives it."""
    pbr = {"metallicFactor": 1.0, "roughnessFactor": 0.1, "baseColorTexture": {"index": 0}}
    path = square(
        tmp_path,
        {"pbrMetallicRoughness": pbr},
        [QUARTERS],
        attributes={"TEXCOORD_0": UV * 3 - 1},
        sampler={"wrapS": CODES[u], "wrapT": CODES[v], "magFilter": 9728},
    )
    picture = seen(path)
    shown = picture.reshape(6, 2, 6, 2, 3).mean(axis=(1, 3))
    halves = np.arange(-2, 4)
    expected = QUARTERS[wrapped(halves, v)][:, wrapped(halves, u)] / 255.0
    np.testing.assert_allclose(shown, expected, atol=0.15)


def test_a_map_without_coordinates_is_left_out(tmp_path):
    """As in the frame: mitsuba would lay it over each triangle."""
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0.0}}
    black = [np.zeros((2, 2, 3), np.uint8)]
    path = square(tmp_path, material, black)
    document = json.loads(path.read_text())
    del document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"]
    path.write_text(json.dumps(document))
    assert seen(path).mean() > 0.8
