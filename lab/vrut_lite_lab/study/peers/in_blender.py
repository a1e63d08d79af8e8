"""Renders skies of Blender as panoramas; run by a Python that has the package bpy, not ours.

    python in_blender.py JOBS.json

The jobs are objects with file, kind, sun_deg, altitude_m, turbidity, albedo
and rounds. Prints a line of
JSON with the CPU seconds of each, one thread, the least of its rounds.
"""

import json
import math
import sys
import time
from pathlib import Path

import bpy

SIZE = 512, 256
jobs = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples, scene.cycles.use_denoising = 1, False
# One ray through the middle of each pixel.
scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
scene.render.threads_mode, scene.render.threads = "FIXED", 1
scene.render.resolution_x, scene.render.resolution_y = SIZE
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
camera = bpy.data.cameras.new("camera")
camera.type, camera.panorama_type = "PANO", "EQUIRECTANGULAR"
# It looks to +Y, where a sun of rotation 0 is.
eye = bpy.data.objects.new("camera", camera)
eye.rotation_euler = (math.pi / 2, 0.0, 0.0)
scene.collection.objects.link(eye)
scene.camera = eye
world = bpy.data.worlds.new("world")
scene.world = world
if world.node_tree is None:
    world.use_nodes = True
sky = world.node_tree.nodes.new("ShaderNodeTexSky")
world.node_tree.links.new(sky.outputs[0], world.node_tree.nodes["Background"].inputs[0])

spent_s = []
for job in jobs:
    sky.sky_type = job["kind"]
    elevation = math.radians(job["sun_deg"])
    sky.sun_disc, sky.sun_elevation, sky.altitude = False, elevation, job["altitude_m"]
    sky.sun_direction = (0.0, math.cos(elevation), math.sin(elevation))
    sky.turbidity, sky.ground_albedo = job["turbidity"], job["albedo"]
    least = math.inf
    for _ in range(job["rounds"]):
        scene.render.filepath = job["file"]
        start = time.process_time()
        bpy.ops.render.render(write_still=True)
        least = min(least, time.process_time() - start)
    spent_s.append(least)
print(json.dumps({"version": bpy.app.version_string, "cpu_s": spent_s}))
