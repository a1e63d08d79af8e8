"""A scene's light by Cycles; run by a Python that has the package bpy, not ours.

    python in_cycles.py SCENE.npz WORLD.exr OUT.npz SAMPLES SEED

SCENE has corners (T, 3, 3), paint (T,), colours (M, 3), the sun (3,) and its irradiance (3,), z up,
and places (P, 3), or a view: pose (4, 4), size (2,) and angle, upright, in radians. A panorama at
each place, weighed by the cosine from the zenith, is its irradiance: a lamp is unseen by cameras,
so that the sun's own light is left out. OUT gets irradiance (P, 3) or picture (height, width, 3),
through the middles of pixels, and the CPU seconds.
"""

import math
import sys
import time
from typing import Any

import bpy
import mathutils
import numpy as np

HEIGHT = 64
scene_file, world_file, out_file, samples, seed = sys.argv[1:]
given = np.load(scene_file)

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
mesh = bpy.data.meshes.new("scene")
corners = given["corners"].reshape(-1, 3)
mesh.from_pydata(corners.tolist(), [], np.arange(len(corners)).reshape(-1, 3).tolist())
for number, colour in enumerate(given["colours"]):
    paint = bpy.data.materials.new(f"m{number}")
    if paint.node_tree is None:
        paint.use_nodes = True
    nodes = paint.node_tree.nodes
    nodes.clear()
    matte, out = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    matte.inputs["Color"].default_value = (*colour.tolist(), 1.0)
    paint.node_tree.links.new(matte.outputs[0], out.inputs["Surface"])
    mesh.materials.append(paint)
mesh.polygons.foreach_set("material_index", given["paint"].astype(np.int32))
scene.collection.objects.link(bpy.data.objects.new("scene", mesh))

world = bpy.data.worlds.new("world")
scene.world = world
if world.node_tree is None:
    world.use_nodes = True
image = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
image.image = bpy.data.images.load(world_file)
image.image.colorspace_settings.name = "Linear Rec.709"
world.node_tree.links.new(image.outputs[0], world.node_tree.nodes["Background"].inputs[0])

lamp = bpy.data.lights.new("sun", "SUN")
strength = float(given["irradiance"].max())
lamp.energy, lamp.angle = strength, math.radians(0.53)
lamp.color = (given["irradiance"] / max(strength, 1e-30)).tolist()
sun = bpy.data.objects.new("sun", lamp)
x, y, z = given["sun"]
sun.rotation_euler = (math.acos(z), 0.0, math.atan2(x, -y))
scene.collection.objects.link(sun)

scene.render.engine = "CYCLES"
cycles = scene.cycles
cycles.samples, cycles.seed, cycles.use_denoising = int(samples), int(seed), False
cycles.use_adaptive_sampling = False
cycles.max_bounces = cycles.diffuse_bounces = 32
cycles.sample_clamp_indirect = 0.0
scene.render.threads_mode, scene.render.threads = "FIXED", 1
scene.render.use_persistent_data = True
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.filepath = out_file + ".exr"
camera = bpy.data.cameras.new("camera")
camera.clip_start, camera.clip_end = 1e-4, 1e5
eye = bpy.data.objects.new("camera", camera)
scene.collection.objects.link(eye)
scene.camera = eye


def rendered(width: int, height: int) -> np.ndarray:
    """Pixels (height, width, 3); rows of an image in memory begin at the bottom."""
    scene.render.resolution_x, scene.render.resolution_y = width, height
    bpy.ops.render.render(write_still=True)
    seen = bpy.data.images.load(scene.render.filepath)
    seen.colorspace_settings.name = "Linear Rec.709"
    pixels = np.array(seen.pixels[:]).reshape(height, width, -1)[..., :3]
    bpy.data.images.remove(seen)
    return pixels


found: dict[str, Any]
start = time.process_time()
if "pose" in given:
    camera.sensor_fit, camera.angle = "VERTICAL", float(given["angle"])
    eye.matrix_world = mathutils.Matrix(given["pose"].tolist())
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 0.01
    found = {"picture": rendered(*given["size"].tolist())[::-1]}
else:
    camera.type, camera.panorama_type = "PANO", "EQUIRECTANGULAR"
    eye.rotation_euler = (math.pi / 2, 0.0, 0.0)
    edges = np.sin(np.linspace(-np.pi / 2, np.pi / 2, HEIGHT + 1))
    weight = np.maximum(edges, 0.0) ** 2
    weight = (weight[1:] - weight[:-1]) * np.pi / (2 * HEIGHT)
    light = []
    for place in given["places"]:
        eye.location = place.tolist()
        light.append(np.einsum("r,rcn->n", weight, rendered(2 * HEIGHT, HEIGHT)))
    found = {"irradiance": np.array(light)}
np.savez(out_file, cpu_s=time.process_time() - start, **found)
