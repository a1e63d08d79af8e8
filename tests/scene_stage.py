"""A square and a light for the backend, in one call each: what the tests of the frame share."""

import io
import json

import numpy as np
from light_messages import light_messages
from PIL import Image

from vrut_lite.messages.camera import MoveCamera
from vrut_lite.messages.view_light import StillAsked, ViewLightChanged

CORNERS = np.array([[-0.5, 0, 0.5], [0.5, 0, 0.5], [0.5, 0, -0.5], [-0.5, 0, -0.5]])
UV = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float)
ORDER = (0, 1, 2, 0, 2, 3)


def square(
    folder,
    material=None,
    images=(),
    attributes=None,
    nodes=None,
    corners=CORNERS,
    order=ORDER,
    sampler=None,
):
    """A glTF of one square; extra attributes are (4, n) arrays, images (h, w, c) uint8."""
    arrays = {"POSITION": corners, "TEXCOORD_0": UV, **(attributes or {})}
    blob, views, accessors = io.BytesIO(), [], []
    for values in [*arrays.values(), np.array(order)]:
        indices = values.ndim == 1
        data = values.astype("<u2" if indices else "<f4")
        views.append({"buffer": 0, "byteOffset": blob.tell(), "byteLength": data.nbytes})
        kind = "SCALAR" if indices else f"VEC{values.shape[1]}"
        accessors.append(
            {
                "bufferView": len(views) - 1,
                "componentType": 5123 if indices else 5126,
                "count": len(values),
                "type": kind,
            }
        )
        blob.write(data.tobytes())
    (folder / "square.bin").write_bytes(blob.getvalue())
    for number, image in enumerate(images):
        Image.fromarray(np.asarray(image, np.uint8)).save(folder / f"{number}.png")
    primitive = {
        "attributes": {name: number for number, name in enumerate(arrays)},
        "indices": len(arrays),
        "material": 0,
    }
    nodes = nodes or [{"mesh": 0}]
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": [{"primitives": [primitive]}],
        "materials": [material or {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"uri": "square.bin", "byteLength": len(blob.getvalue())}],
        "images": [{"uri": f"{number}.png"} for number in range(len(images))],
        "textures": [{"source": number, "sampler": 0} for number in range(len(images))],
        "samplers": [sampler or {}],
    }
    path = folder / "square.gltf"
    path.write_text(json.dumps(document))
    return path


def surface(metallic, roughness, albedo=1.0):
    """The glTF material of a plain surface."""
    return {
        "pbrMetallicRoughness": {
            "baseColorFactor": [albedo, albedo, albedo, 1],
            "metallicFactor": metallic,
            "roughnessFactor": roughness,
        }
    }


def light(backend, cube, **sun):
    """Light the scene with a cube map (6, n, n, 3) and a sun, as `light_messages` takes them."""
    background, key_light, ambient = light_messages(cube, **sun)
    backend.change(background=background, key_light=key_light, ambient=ambient)


def look(backend, eye, target, field_of_view_rad=0.6, still=True):
    """The picture from there."""
    backend.change(
        moved_camera=MoveCamera(
            eye_m=tuple(map(float, eye)),
            target_m=tuple(map(float, target)),
            vertical_field_of_view_rad=field_of_view_rad,
        )
    )
    return backend.draw(still)


def look_finished(backend, eye, target, field_of_view_rad=0.6):
    """The finished still from there, with no light of its own: what the map says stays."""
    camera = MoveCamera(
        eye_m=tuple(map(float, eye)),
        target_m=tuple(map(float, target)),
        vertical_field_of_view_rad=field_of_view_rad,
    )
    asked = StillAsked(camera=camera, size_px=backend.state.size_px)
    points = ViewLightChanged.without_points(asked, "none", 1, "test")
    own = {**backend.state.parts["light_transport"], ViewLightChanged: points}
    backend.change(moved_camera=camera, parts={**backend.state.parts, "light_transport": own})
    return backend.draw()
